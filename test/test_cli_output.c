/* test_cli_output.c -- writing that fails, and renders that are interrupted: an old file stays as
 * it is until a new one is whole, nothing lies beside it, and what was rendered is not lost. */
#include "base/clock.h"
#include "cli/args.h"
#include "image/image.h"
#include "integrators/integrator.h"
#include "test/terminal.h"

#include <errno.h>
#include <fcntl.h>
#include <signal.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

#define SCENE_FILES "roof.ply sky.pfm tiny.pbrt wood.ppm "

static bool holds(const char *name, const char *text)
{
    size_t n;
    char *bytes = cli_read(name, &n);
    return bytes && n == strlen(text) && !memcmp(bytes, text, n);
}

static void expect_folder(const char *want)
{
    EXPECT(!strcmp(cli_folder(), want), "the folder holds %snot %s", cli_folder(), want);
}

/* ---- places that cannot be written ---- */

/* The file's own folder is a file, is not there, or the name is a folder's: told before rendering,
 * whatever the number of samples. */
static void unwritable(void)
{
    cli_scene();
    REQUIRE(mkdir(cli_path("sub.pfm"), 0777) == 0, "mkdir");
    CLI_FAILS(STATUS_OUTPUT, "wood.ppm/a.pfm: cannot be written: Not a directory",
              "tiny.pbrt --quiet --spp 4000000000 -o wood.ppm/a.pfm");
    CLI_FAILS(STATUS_OUTPUT, "nosuch/a.pfm: cannot be written: No such file or directory",
              "tiny.pbrt --quiet --spp 4000000000 -o b.pfm -o nosuch/a.pfm");
    CLI_FAILS(STATUS_OUTPUT, "sub.pfm: cannot be written: it is a folder",
              "tiny.pbrt --quiet --spp 4000000000 -o sub.pfm");
    CLI_FAILS(STATUS_OUTPUT, "nosuch/n.pfm: cannot be written: No such file or directory",
              "tiny.pbrt --quiet --spp 4000000000 -o b.pfm --aov normal=nosuch/n.pfm");
    expect_folder("roof.ply sky.pfm sub.pfm tiny.pbrt wood.ppm ");
}

/* Root may write anywhere, so it becomes somebody else. */
static void lose_rights(void)
{
    if (geteuid() == 0 && setuid(65534))
        _exit(96);
}

static void read_only_folder(void)
{
    Cli c;

    cli_scene();
    cli_write_text("a.pfm", "old");
    REQUIRE(chmod(test_folder(), 0555) == 0, "chmod");
    c = cli_start(lose_rights, "tiny.pbrt --quiet -o a.pfm");
    cli_wait(&c);
    REQUIRE(chmod(test_folder(), 0755) == 0, "chmod");
    EXPECT_CLI(c, STATUS_OUTPUT, "rushlight: a.pfm: cannot be written: Permission denied\n");
    EXPECT(holds("a.pfm", "old"), "the old file is another");
    expect_folder("a.pfm " SCENE_FILES);
}

static void long_names(void)
{
    char name[400];

    cli_scene();
    memset(name, 'x', sizeof name);
    strcpy(name + 300, ".pfm");
    EXPECT(cli("tiny.pbrt --quiet -o %s", name).status == STATUS_OUTPUT, "300 letters");
    strcpy(name + 251, ".pfm");                 /* 255 with its extension, but not with ".part" */
    EXPECT(cli("tiny.pbrt --quiet -o %s", name).status == STATUS_OUTPUT, "255 letters");
    CLI_WORKS("tiny.pbrt --quiet -o d\xC3\xBCnn\xFF.pfm");
    expect_folder("d\xC3\xBCnn\xFF.pfm " SCENE_FILES);
}

/* ---- no room ---- */

enum { ROOM = 1000 };

static void little_room(void)
{
    const struct rlimit most = { ROOM, ROOM };
    setrlimit(RLIMIT_FSIZE, &most);
}

static void expect_no_room(const char *line)
{
    char name[40];
    Cli c;

    snprintf(name, sizeof name, "%.*s", (int)strcspn(strstr(line, "a."), " "), strstr(line, "a."));
    cli_write_text(name, "old");
    c = cli_start(little_room, "%s", line);
    cli_wait(&c);
    EXPECT(c.status == STATUS_OUTPUT && cli_lines(c.err) == 1 &&
           strstr(c.err, ": cannot be written: File too large\n"), "'%s': %d %s", line, c.status,
           c.err);
    EXPECT(holds(name, "old"), "'%s': the old file is another", line);
    remove(cli_path(name));
}

/* The limit of a file's size stands for a disk that fills up in the middle of a write. */
static void no_room(void)
{
    char line[200];

    cli_scene();
    CLI_WORKS("tiny.pbrt --quiet --size 64x48 -o big.pfm");
    for (const ImageFormat *const *f = image_formats; *f; f++)
        if ((*f)->write) {
            snprintf(line, sizeof line, "convert big.pfm a.%s", (*f)->info.name);
            expect_no_room(line);
            snprintf(line, sizeof line, "tiny.pbrt --quiet --size 64x48 -o a.%s",
                     (*f)->info.name);
            expect_no_room(line);
        }
    expect_no_room("compare big.pfm big.pfm --diff a.pfm");
    expect_folder("big.pfm " SCENE_FILES);
}

/* One picture has no room; the other one is written all the same. */
static void no_room_for_one(void)
{
    Cli c;

    cli_scene();
    CLI_WORKS("tiny.pbrt --quiet -o b.ppm");
    cli_write_text("a.pfm", "old");
    c = cli_start(little_room, "tiny.pbrt --quiet -o a.pfm -o a.ppm");      /* 2319 bytes, 589 */
    cli_wait(&c);
    EXPECT_CLI(c, STATUS_OUTPUT, "rushlight: a.pfm: cannot be written: File too large\n");
    EXPECT(holds("a.pfm", "old") && cli_same_file("a.ppm", "b.ppm"), "the other one");
    expect_folder("a.pfm a.ppm b.ppm " SCENE_FILES);
}

static void full_device(void)
{
    struct stat st;

    if (stat("/dev/full", &st))
        test_skip("no /dev/full here");
    cli_scene();
    REQUIRE(symlink("/dev/full", cli_path("full.pfm")) == 0, "symlink");
    CLI_FAILS(STATUS_OUTPUT, "full.pfm: cannot be written: No space left on device",
              "tiny.pbrt --quiet -o full.pfm");
    CLI_FAILS(STATUS_OUTPUT, "full.pfm: cannot be written: No space left on device",
              "convert sky.pfm full.pfm");
    REQUIRE(stat("/dev/full", &st) == 0 && S_ISCHR(st.st_mode), "the device is gone");
    expect_folder("full.pfm " SCENE_FILES);
}

/* ---- over an old file ---- */

static void old_files(void)
{
    size_t n;

    cli_scene();
    CLI_WORKS("tiny.pbrt --quiet -o new.pfm");
    cli_write_text("a.pfm", "old");
    CLI_WORKS("tiny.pbrt --quiet -o a.pfm");
    EXPECT(cli_same_file("a.pfm", "new.pfm"), "not replaced");
    CLI_FAILS(STATUS_INPUT, "wood.ppm: a scene was expected: .pbrt, .obj or .ply",
              "wood.ppm --quiet -o a.pfm");
    EXPECT(cli_same_file("a.pfm", "new.pfm"), "replaced by nothing");
    cli_write_text("bad.hdr", "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 9 +X 9\nxx");
    EXPECT(cli("convert bad.hdr a.pfm").status == STATUS_INPUT, "bad.hdr");
    EXPECT(cli_same_file("a.pfm", "new.pfm"), "replaced by a broken one");
    EXPECT(cli_read("a.pfm", &n) && n == 14 + 16 * 12 * 12, "%lu bytes", (unsigned long)n);
}

/* ---- streams ---- */

static void close_output(void) { close(1); }
static void close_all(void) { close(0); close(1); close(2); }
static void full_output(void)
{
    int fd = open("/dev/full", O_WRONLY);
    dup2(fd, 1);
    close(fd);
}

/* Results that cannot be printed are an error, at once where they are the address of a viewer; a
 * command without results does not mind. */
static void closed_output(void)
{
    static const char *const TALK[] = { "list", "help", "--version", "info tiny.pbrt",
                                        "compare sky.pfm sky.pfm", "view tiny.pbrt --threads 1" };
    struct stat st;
    Cli c;

    cli_scene();
    for (size_t i = 0; i < sizeof TALK / sizeof *TALK; i++) {
        c = cli_start(close_output, "%s", TALK[i]);
        cli_wait(&c);
        EXPECT_CLI(c, STATUS_OUTPUT,
                   "rushlight: standard output: cannot be written: Bad file descriptor\n");
        if (stat("/dev/full", &st))
            continue;
        c = cli_start(full_output, "%s", TALK[i]);
        cli_wait(&c);
        EXPECT_CLI(c, STATUS_OUTPUT,
                   "rushlight: standard output: cannot be written: No space left on device\n");
    }
    c = cli_start(close_output, "tiny.pbrt --quiet -o a.pfm");
    cli_wait(&c);
    EXPECT_CLI(c, 0, "");
    c = cli_start(close_all, "tiny.pbrt -o b.pfm");
    cli_wait(&c);
    EXPECT_CLI(c, 0, "");
    EXPECT(cli_same_file("a.pfm", "b.pfm"), "another picture where streams are closed");
}

/* ---- interrupts ---- */

/* A line that would render for years, begun: it has told that the scene is built. */
static Cli start_long(void (*setup)(void), const char *output)
{
    Cli c = cli_start(setup, "tiny.pbrt --spp 4000000000 --threads 2 --size 70x50 -o %s", output);
    cli_await(&c, "built in");
    return c;
}

static void nap(void)
{
    const struct timespec t = { 0, 20000000 };
    nanosleep(&t, NULL);
}

static void interrupt_by(int sig)
{
    Cli c = start_long(NULL, "a.pfm");
    double start;
    Image im;

    nap();
    start = clock_wall();
    kill(c.pid, sig);
    cli_wait(&c);
    EXPECT(clock_wall() - start < 10, "it takes %.1f s to end", clock_wall() - start);
    EXPECT(c.status == STATUS_INTERRUPTED, "status %d: %s", c.status, c.err);
    EXPECT(cli_lines(c.err) == 3 && strstr(c.err, "a.pfm (interrupted): ") &&
           strstr(c.err, "--resume a.part goes on\n"), "it says: %s", c.err);
    REQUIRE(image_read(&im, cli_path("a.pfm"), IMAGE_PIXELS_DEFAULT), "no picture");
    EXPECT(im.w == 70 && im.h == 50, "%lu x %lu", (unsigned long)im.w, (unsigned long)im.h);
    image_clear(&im);
    expect_folder("a.part a.pfm " SCENE_FILES);
}

/* The first signal ends the render soon, with a whole file of what there is, and its state. */
static void interrupted(void)
{
    cli_scene();
    interrupt_by(SIGINT);
    cli_write_text("a.pfm", "old");
    interrupt_by(SIGTERM);
}

/* Whatever renders, within a second, in the middle of a pass and of what comes before the first.
 * Methods that plan may take all samples of a pixel at once. */
static void interrupted_soon(void)
{
    cli_scene();
    for (int k = 0; integrators[k]; k++)
        for (int naps = 1; naps <= 25; naps += 24) {
            const char *name = integrators[k]->info.name;
            double start;
            Cli c;
            c = cli_start(NULL, "tiny.pbrt --spp %s --threads 2 --size 320x240 "
                          "--integrator %s -o a.pfm",
                          integrators[k]->batch ? "8192" : "4000000000", name);
            cli_await(&c, "built in");
            for (int i = 0; i < naps; i++)
                nap();
            start = clock_wall();
            kill(c.pid, SIGINT);
            cli_wait(&c);
            EXPECT(c.status == STATUS_INTERRUPTED, "%s: status %d: %s", name, c.status, c.err);
            EXPECT(clock_wall() - start < 1, "%s, after %d ms: %.2f s", name, 20 * naps,
                   clock_wall() - start);
        }
}

/* An interrupted render that cannot be written is an error of writing. */
static void interrupted_unwritten(void)
{
    Cli c;

    cli_scene();
    cli_write_text("a.pfm", "old");
    c = start_long(little_room, "a.pfm");
    nap();
    kill(c.pid, SIGINT);
    cli_wait(&c);
    EXPECT(c.status == STATUS_OUTPUT &&
           strstr(c.err, "\nrushlight: a.pfm: cannot be written: File too large\n"), "%d: %s",
           c.status, c.err);
    EXPECT(holds("a.pfm", "old"), "the old file is another");
}

/* The second ends at once. The picture goes to a pipe that nobody reads, so the program waits there
 * for ever after the first; two signals that are too close count as one, hence more than two. */
static void interrupted_twice(void)
{
    struct stat st;
    int status, sent = 0;
    Cli c;

    cli_scene();
    REQUIRE(mkfifo(cli_path("pipe.pfm"), 0666) == 0, "mkfifo: %s", strerror(errno));
    c = start_long(NULL, "pipe.pfm");
    do {
        nap();
        kill(c.pid, SIGINT);
        sent++;
        nap();
    } while (sent < 100 && waitpid(c.pid, &status, WNOHANG) == 0);
    EXPECT(sent >= 2 && sent < 100, "%d signals", sent);
    EXPECT(WIFEXITED(status) && WEXITSTATUS(status) == STATUS_INTERRUPTED, "status %d", status);
    EXPECT(stat(cli_path("pipe.pfm"), &st) == 0 && S_ISFIFO(st.st_mode), "no pipe any more");
}

/* ---- a narrow terminal ---- */

/* The line of progress does not wrap: when it is cleared, nothing of it is left in other rows. */
static void narrow_terminal(void)
{
    static Terminal t;
    Cli c;

    cli_scene();
    terminal_open(&t, 44, 60, "TERM=xterm");
    c = cli_start(terminal_take, "tiny.pbrt --size 40x30 --time 0.5 -o a.pfm");
    terminal_read(&t, 0);
    cli_wait(&c);
    for (int row = 0; row < t.rows; row++)
        EXPECT(!strstr(terminal_line(&t, row), "a pixel  "), "row %d: %s", row,
               terminal_line(&t, row));
    terminal_close(&t);
}

const TestCase test_cli_output[] = {
    { "unwritable", unwritable, false },
    { "read_only_folder", read_only_folder, false },
    { "long_names", long_names, false },
    { "no_room", no_room, false },
    { "no_room_for_one", no_room_for_one, false },
    { "full_device", full_device, false },
    { "old_files", old_files, false },
    { "closed_output", closed_output, false },
    { "interrupted", interrupted, false },
    { "interrupted_soon", interrupted_soon, true },
    { "interrupted_unwritten", interrupted_unwritten, false },
    { "interrupted_twice", interrupted_twice, false },
    { "narrow_terminal", narrow_terminal, false },
    { NULL, NULL, false }
};
