/* test_faults.c -- every allocation, every file operation and every thread that can fail does, in
 * turn, once and from then on, in whole runs of the program.
 *
 * Whatever fails, a run ends in one of two ways: as if nothing had failed, with the bytes of an
 * undisturbed run, or with one line that says what could not be done and the status of its class.
 * Either way each output is whole, the old one or not there, nothing lies beside the files, and no
 * block of memory and no descriptor is left. Where two outputs both fail, each has its line. */
#include "base/file.h"
#include "base/mem.h"
#include "base/work.h"
#include "cli/args.h"
#include "integrators/integrator.h"
#include "test/cli_help.h"

#include <errno.h>
#include <fcntl.h>
#include <signal.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

enum { WORDS = 40, OUTPUTS = 5 };

typedef struct {
    const char *line;
    const char *outputs[OUTPUTS];       /* names in the folder; NULL ends */
    unsigned long least;                /* allocations that there are at least */
} Scenario;

/* What is armed, for the one handler of crashes. */
static const Scenario *current;
static const char *what;
static unsigned long at_k;

static void on_crash(int sig)
{
    char line[300];
    int n = snprintf(line, sizeof line, "crash: '%s', %s %lu\n", current ? current->line : "", what,
                     at_k);
    if (write(1, line, (size_t)n) < 0)
        _exit(95);
    signal(sig, SIG_DFL);
    raise(sig);
}

/* ---- one run in this process ---- */

typedef struct {
    int  status;
    char err[2000];
    char before[1000];          /* the folder, and what it may hold besides: outputs */
    char *reference[OUTPUTS];
    size_t size[OUTPUTS];
    long blocks;
    int  descriptors;
} Run;

static int open_descriptors(void)
{
    int n = 0;
    for (int fd = 0; fd < 64; fd++)
        n += fcntl(fd, F_GETFD) >= 0;
    return n;
}

/* Standard error goes to a file outside the folder, standard output nowhere. */
static void run_line(Run *r, const char *line)
{
    static FILE *err;
    char copy[600], *words[WORDS] = { (char *)"rushlight" };
    int n = 1, out1 = dup(1), out2 = dup(2), null = open("/dev/null", O_WRONLY);
    size_t got;

    if (!err)
        err = tmpfile();
    REQUIRE(err && out1 >= 0 && out2 >= 0 && null >= 0, "streams");
    snprintf(copy, sizeof copy, "%s", line);
    for (char *p = strtok(copy, " "); p && n < WORDS - 1; p = strtok(NULL, " "))
        words[n++] = p;
    fflush(stdout);
    rewind(err);
    REQUIRE(ftruncate(fileno(err), 0) == 0 && dup2(null, 1) >= 0 && dup2(fileno(err), 2) >= 0,
            "streams");
    r->status = cli_run(n, words);
    fflush(stdout);
    dup2(out1, 1);
    dup2(out2, 2);
    close(out1);
    close(out2);
    close(null);
    rewind(err);
    got = fread(r->err, 1, sizeof r->err - 1, err);
    r->err[got] = 0;
}

/* Runs it undisturbed and keeps what it writes. */
static void prepare(Run *r, const Scenario *s)
{
    current = s;
    for (int i = 0; i < OUTPUTS && s->outputs[i]; i++)
        remove(cli_path(s->outputs[i]));
    snprintf(r->before, sizeof r->before, "%s", cli_folder());
    r->descriptors = open_descriptors();
    run_line(r, s->line);
    r->descriptors = open_descriptors();
    r->blocks = mem_blocks();
    REQUIRE(r->status == 0 && !r->err[0], "'%s': %d: %s", s->line, r->status, r->err);
    for (int i = 0; i < OUTPUTS && s->outputs[i]; i++) {
        r->reference[i] = cli_read(s->outputs[i], &r->size[i]);
        REQUIRE(r->reference[i], "'%s' wrote no %s", s->line, s->outputs[i]);
    }
}

/* Every second time there is an old file to keep. */
static void lay_out(const Scenario *s, unsigned long k)
{
    for (int i = 0; i < OUTPUTS && s->outputs[i]; i++) {
        remove(cli_path(s->outputs[i]));
        if (k % 2)
            cli_write_text(s->outputs[i], "old");
    }
}

static void expect_outputs(const Run *r, const Scenario *s, unsigned long k)
{
    int others = 0, names = 0;
    const char *folder = cli_folder();

    for (int i = 0; i < OUTPUTS && s->outputs[i]; i++) {
        size_t n;
        char *bytes = cli_read(s->outputs[i], &n);
        bool whole = bytes && n == r->size[i] && !memcmp(bytes, r->reference[i], n);
        bool old = k % 2 ? bytes && n == 3 && !memcmp(bytes, "old", 3) : !bytes;
        EXPECT(whole || (old && r->status), "'%s', %s %lu: %s is broken", s->line, what, k,
               s->outputs[i]);
        others += bytes != NULL;
    }
    for (const char *p = folder; *p; p++)
        names += *p == ' ';
    for (const char *p = r->before; *p; p++)
        names -= *p == ' ';
    EXPECT(names == others, "'%s', %s %lu: something lies beside: %s", s->line, what, k, folder);
}

/* After a run that was disturbed: what must hold in any case. */
static void expect_clean(const Run *r, const Scenario *s, unsigned long k)
{
    expect_outputs(r, s, k);
    EXPECT(mem_blocks() == r->blocks, "'%s', %s %lu: %ld blocks are left", s->line, what, k,
           mem_blocks() - r->blocks);
    EXPECT(open_descriptors() == r->descriptors, "'%s', %s %lu: a descriptor is left", s->line,
           what, k);
    EXPECT((r->status == 0) == !r->err[0], "'%s', %s %lu: status %d, and it says: %s", s->line,
           what, k, r->status, r->err);
}

static void start(Run *r, const Scenario *s, unsigned long k)
{
    lay_out(s, k);
    at_k = k;
    r->status = -1;
}

/* ---- memory ---- */

static void memory_faults(const Scenario *s)
{
    Run r;

    prepare(&r, s);
    for (int on = 0; on < 2; on++) {
        what = on ? "no memory from allocation" : "allocation";
        for (unsigned long k = 1;; k++) {
            bool reached;
            start(&r, s, k);
            mem_fail_at(k, on != 0);
            run_line(&r, s->line);
            reached = mem_calls() >= k;
            mem_fail_at(0, false);
            expect_clean(&r, s, k);
            if (!reached) {
                EXPECT(r.status == 0 && k > s->least, "'%s': only %lu allocations, status %d",
                       s->line, k - 1, r.status);
                break;
            }
            EXPECT(r.status == STATUS_OUTPUT || r.status == 0, "'%s', %s %lu: status %d: %s",
                   s->line, what, k, r.status, r.err);
            EXPECT(r.status == 0 || (cli_lines(r.err) == 1 && strstr(r.err, "out of memory")),
                   "'%s', %s %lu: it says: %s", s->line, what, k, r.err);
        }
    }
}

/* ---- files ---- */

/* Each line is about a file that could not be read, or about an output, each at most once; the
 * status is that of the first. */
static void expect_file_lines(const Run *r, const Scenario *s, unsigned long k)
{
    bool first_writes = false, seen[OUTPUTS] = { false };
    int lines = cli_lines(r->err), about = 0;

    for (int i = 0; i < OUTPUTS && s->outputs[i]; i++) {
        char begin[100];
        const char *at;
        snprintf(begin, sizeof begin, "rushlight: %s: cannot be written: ", s->outputs[i]);
        at = strstr(r->err, begin);
        seen[i] = at != NULL;
        about += seen[i];
        first_writes = first_writes || at == r->err;
        EXPECT(!at || !strstr(at + 1, begin), "'%s', %s %lu: twice: %s", s->line, what, k, r->err);
    }
    if (!first_writes)
        about += strstr(r->err, ": cannot be opened: ") || strstr(r->err, ": cannot be read: ");
    EXPECT(about == lines && lines > 0, "'%s', %s %lu: it says: %s", s->line, what, k, r->err);
    EXPECT(r->status == (first_writes ? STATUS_OUTPUT : STATUS_INPUT),
           "'%s', %s %lu: status %d: %s", s->line, what, k, r->status, r->err);
}

static void file_faults(const Scenario *s)
{
    static const struct { int code; bool on; const char *what; } WAYS[] = {
        { EIO, false, "EIO at operation" }, { EIO, true, "EIO from operation" },
        { ENOSPC, false, "ENOSPC at operation" }, { ENOSPC, true, "ENOSPC from operation" },
        { EINTR, false, "EINTR at operation" },
    };
    Run r;

    prepare(&r, s);
    for (size_t w = 0; w < sizeof WAYS / sizeof *WAYS; w++)
        for (unsigned long k = 1;; k++) {
            bool reached;
            what = WAYS[w].what;
            start(&r, s, k);
            file_fail_at(k, WAYS[w].on, WAYS[w].code);
            run_line(&r, s->line);
            reached = file_calls() >= k;
            file_fail_at(0, false, 0);
            expect_clean(&r, s, k);
            if (!reached || WAYS[w].code == EINTR)
                EXPECT(r.status == 0, "'%s', %s %lu: status %d: %s", s->line, what, k, r.status,
                       r.err);
            else
                expect_file_lines(&r, s, k);
            if (!WAYS[w].on && r.status)
                EXPECT(cli_lines(r.err) == 1, "'%s', %s %lu: it says: %s", s->line, what, k, r.err);
            if (!reached) {
                EXPECT(k > 3, "'%s': only %lu operations", s->line, k - 1);
                break;
            }
        }
}

/* ---- threads ---- */

static void thread_faults(const Scenario *s)
{
    Run r;

    prepare(&r, s);
    what = "thread";
    for (unsigned long k = 1; k <= 24; k++) {
        start(&r, s, k);
        work_fail_at(k);
        run_line(&r, s->line);
        work_fail_at(0);
        expect_clean(&r, s, k);
        EXPECT(r.status == 0, "'%s', thread %lu: status %d: %s", s->line, k, r.status, r.err);
    }
}

/* ---- scenarios ---- */

static const Scenario RENDER = {
    "tiny.pbrt --quiet --threads 2 -o a.png -o a.pfm --aov normal=n.ppm "
    "--aov strategy:explicit=e.pfm",
    { "a.png", "a.pfm", "n.ppm", "e.pfm" }, 60
};
static const Scenario OTHERS[] = {
    { "room.pbrt --quiet --threads 1 --size 4x4 --spp 1", { "room.png" }, 20 },
    { "roof.ply --quiet --threads 1 --size 4x4 --spp 1", { "roof.png" }, 20 },
    { "tiny.pbrt --quiet --threads 2 --size 4x4 --spp 2 --integrator sppm:photons=3000 -o s.pfm",
      { "s.pfm" }, 30 },
    { "tiny.pbrt --quiet --threads 2 --size 4x4 --spp 2 -o s.pfm "
      "--integrator pssmlt:chains=2,bootstrap=999", { "s.pfm" }, 30 },
    { "info tiny.pbrt", { NULL }, 30 },
    { "info sky.pfm", { NULL }, 1 },
    { "convert sky.pfm a.png", { "a.png" }, 4 },
    { "convert wood.ppm a.hdr --exposure 1", { "a.hdr" }, 4 },
    { "convert sky.pfm sky2.ppm --tonemap reinhard", { "sky2.ppm" }, 4 },
    { "tiny.pbrt --quiet --threads 1 --size 4x4 --spp 1 -o a.exr --aov variance:direct=a.exr",
      { "a.exr" }, 20 },
    { "tiny.pbrt --quiet --threads 1 --size 4x4 --spp 1 -o a.pfm --denoise guided --fireflies 2",
      { "a.pfm" }, 20 },
    { "tiny.pbrt --quiet --threads 1 --size 4x4 --spp 1 -o a.pfm --denoise direct=nlmeans "
      "--denoise indirect=bilateral --fireflies 2", { "a.pfm" }, 20 },
    { "convert sky.pfm a.png --tonemap local --auto-exposure average --denoise nlmeans",
      { "a.png" }, 4 },
    { "convert sky.pfm a.pfm --denoise gaussian --guide albedo=sky.pfm", { "a.pfm" }, 4 },
    { "convert sky.pfm a.exr", { "a.exr" }, 4 },
    { "compare sky.pfm sky.pfm --diff d.pfm", { "d.pfm" }, 4 },
    { "cast roof.ply --quiet --size 2x2 --runs 0 --threads 1 --rays-out r",
      { "r.primary.rays", "r.bounce.rays", "r.shadow.rays", "r.ao.rays", "r.random.rays" }, 60 },
    { "cast roof.ply --quiet --runs 0 --csv --rays one.rays", { NULL }, 40 },
};
/* A ray along z, in the little-endian order. */
static const unsigned char one_ray[88] = { 'R', 'A', 'Y', 'S', 1, [32] = 1, [78] = 0x80,
                                           [79] = 0x3F, [87] = 0x3F };
enum { OTHERS_N = sizeof OTHERS / sizeof *OTHERS };

static void set_up(void)
{
    static const int CRASHES[] = { SIGSEGV, SIGABRT, SIGFPE, SIGILL, SIGBUS };

    cli_scene();
    cli_write_text("room.obj", "mtllib room.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 0.2\nvt 0 0\n"
                   "usemtl red\nf 1/1 2/1 3/1\nusemtl lamp\nf 2 4 3\n");
    cli_write_text("room.mtl", "newmtl red\nKd 1 0 0\nmap_Kd wood.ppm\nnewmtl lamp\nKe 1 1 1\n");
    cli_write_text("room.pbrt", "LookAt 0.5 0.5 3  0.5 0.5 0  0 1 0\nCamera \"perspective\"\n"
                   "WorldBegin\nShape \"obj\" \"string filename\" \"room.obj\"\n");
    cli_write("one.rays", one_ray, sizeof one_ray);
    REQUIRE(chdir(test_folder()) == 0, "chdir");
    for (size_t i = 0; i < sizeof CRASHES / sizeof *CRASHES; i++)
        signal(CRASHES[i], on_crash);
}

static void memory_render(void)
{
    set_up();
    memory_faults(&RENDER);
}

static void memory_others(void)
{
    set_up();
    for (int i = 0; i < OTHERS_N; i++)
        memory_faults(&OTHERS[i]);
}

/* Methods that by themselves trace many thousand paths before the first pixel: with fewer. */
static const char *with_few(const char *method)
{
    return !strcmp(method, "photonmap") ? ":photons=200,caustics=50"
           : !strcmp(method, "pssmlt") || !strcmp(method, "mlt") ? ":bootstrap=999" : "";
}

/* Every method and every structure: what each of them takes for itself. */
static void memory_methods(void)
{
    char line[200];
    Scenario s = { line, { "a.pfm" }, 40 };

    set_up();
    for (size_t k = 0; kind_info(integrators, k); k++) {
        snprintf(line, sizeof line, "tiny.pbrt --quiet --threads 2 --size 4x4 --spp 1 -o a.pfm "
                 "--integrator %s%s", kind_info(integrators, k)->name,
                 with_few(kind_info(integrators, k)->name));
        memory_faults(&s);
    }
    for (size_t k = 0; kind_info(accels, k); k++) {
        snprintf(line, sizeof line, "tiny.pbrt --quiet --threads 2 --size 4x4 --spp 1 -o a.pfm "
                 "--accel %s", kind_info(accels, k)->name);
        memory_faults(&s);
    }
    for (size_t k = 0; kind_info(samplers, k); k++) {
        snprintf(line, sizeof line, "tiny.pbrt --quiet --threads 2 --size 4x4 --spp 1 -o a.pfm "
                 "--sampler %s", kind_info(samplers, k)->name);
        memory_faults(&s);
    }
}

static void files_render(void)
{
    set_up();
    file_faults(&RENDER);
}

static void files_others(void)
{
    set_up();
    for (int i = 0; i < OTHERS_N; i++)
        file_faults(&OTHERS[i]);
}

static void threads(void)
{
    Scenario s = { "tiny.pbrt --quiet --threads 7 --size 70x50 --spp 1 -o a.pfm", { "a.pfm" }, 0 };
    set_up();
    thread_faults(&s);
}

/* cli_run may be called again and again: what one line asks for is forgotten by the next. */
static void lines_after_lines(void)
{
    Run r;

    set_up();
    cli_write_text("dark.pbrt", "Camera \"perspective\"\nWorldBegin\nShape \"sphere\"\n"
                   "LightSource \"point\" \"rgb I\" [ 0 0 0 ]\n");
    run_line(&r, "tiny.pbrt --quiet --size 1000x1000 --max-memory 8 -o a.ppm");
    EXPECT(r.status == STATUS_OUTPUT, "--max-memory: %d: %s", r.status, r.err);
    run_line(&r, "tiny.pbrt --quiet --size 1000x1000 --spp 1 -o a.ppm");
    EXPECT(r.status == 0 && !r.err[0], "no limit: %d: %s", r.status, r.err);
    run_line(&r, "dark.pbrt --quiet --strict --size 4x4 --spp 1 -o a.ppm");
    EXPECT(r.status == STATUS_INPUT, "--strict: %d: %s", r.status, r.err);
    run_line(&r, "dark.pbrt --size 4x4 --spp 1 -o a.ppm");
    EXPECT(r.status == 0 && cli_lines(r.err) == 3 && strstr(r.err, "warning: "), "a warning, and "
           "not quiet: %d: %s", r.status, r.err);
    EXPECT(mem_blocks() == 0, "%ld blocks are left", mem_blocks());
}

const TestCase test_faults[] = {
    { "memory_render", memory_render, false },
    { "memory_others", memory_others, false },
    { "memory_methods", memory_methods, false },
    { "files_render", files_render, false },
    { "files_others", files_others, false },
    { "threads", threads, false },
    { "lines_after_lines", lines_after_lines, false },
    { NULL, NULL, false }
};
