/* test_cli_state.c -- long jobs as a user has them: pictures and states that are written now and
 * then, renders that are killed, disks that are full, shares that are added up. */
#include "base/file.h"
#include "base/random.h"
#include "cli/args.h"
#include "integrators/integrator.h"
#include "test/cli_help.h"

#include <errno.h>
#include <math.h>
#include <signal.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <time.h>

static bool is_there(const char *name)
{
    size_t n;
    return cli_read(name, &n) != NULL;
}

static void nap(double seconds)
{
    double whole = floor(seconds);
    const struct timespec t = { (time_t)whole, (long)(1e9 * (seconds - whole)) };
    nanosleep(&t, NULL);
}

/* ---- states ---- */

static void autosave(void)
{
    cli_scene();
    CLI_WORKS("tiny.pbrt --quiet --size 70x50 --spp 24 -o a.pfm --aov normal=n.pfm");
    EXPECT(!is_there("a.part"), "a state that nobody asked for");
    CLI_WORKS("tiny.pbrt --quiet --size 70x50 --spp 24 -o b.pfm --aov normal=m.pfm "
              "--autosave 0.001");
    EXPECT(cli_same_file("a.pfm", "b.pfm") && cli_same_file("n.pfm", "m.pfm") && is_there("b.part"),
           "autosave changes the picture, or writes no state");
    CLI_WORKS("tiny.pbrt --quiet --size 70x50 --spp 24 -o c.pfm --aov normal=k.pfm "
              "--resume b.part --threads 1");
    EXPECT(cli_same_file("a.pfm", "c.pfm") && cli_same_file("n.pfm", "k.pfm"), "nothing to do");
    CLI_WORKS("tiny.pbrt --quiet --size 70x50 --spp 40 -o a.pfm --aov normal=n.pfm");
    CLI_WORKS("tiny.pbrt --quiet --size 70x50 --spp 40 -o c.pfm --aov normal=k.pfm "
              "--resume b.part -o d.part");
    EXPECT(cli_same_file("a.pfm", "c.pfm") && cli_same_file("n.pfm", "k.pfm"), "more samples");
    CLI_WORKS("merge d.part --quiet -o e.pfm");
    EXPECT(cli_same_file("a.pfm", "e.pfm"), "the picture of a state");
}

/* Each says why. */
static void refused(void)
{
    static const struct { const char *args, *says; } OTHER[] = {
        { "--seed 1", "a.part: is of another render: it has 'seed 0', this one 'seed 1'" },
        { "--integrator ao", NULL },
        { "--size 20x10", "a.part: is of another render: it has 'picture 16x12 window 0,0,16,12', "
          "this one 'picture 20x10 window 0,0,20,10'" },
        { "--aov normal=n.pfm",
          "a.part: is of another render: it has 'layers', this one 'layers normal'" },
        { "--shard 1/2", NULL },
        { "--adaptive variable", NULL },
    };
    char *bytes;
    size_t n;
    Cli c;

    cli_scene();
    CLI_WORKS("tiny.pbrt --quiet -o a.part");
    for (size_t i = 0; i < sizeof OTHER / sizeof *OTHER; i++)
        CLI_FAILS(STATUS_INPUT, OTHER[i].says, "tiny.pbrt --quiet %s --resume a.part%s",
                  OTHER[i].args, strstr(OTHER[i].args, "shard") ? "" : " -o b.pfm");
    CLI_FAILS(STATUS_INPUT, "sky.pfm: is not the state of a render",
              "tiny.pbrt --quiet -o b.pfm --resume sky.pfm");
    bytes = cli_read("a.part", &n);
    for (int k = 0; k < 2; k++) {       /* a bit that is another, and a byte that is not there */
        bytes[n / 2] = (char)(bytes[n / 2] ^ 4);
        cli_write("d.part", bytes, n - (size_t)k);
        CLI_FAILS(STATUS_INPUT, "d.part: is damaged or not whole",
                  "tiny.pbrt --quiet -o b.pfm --resume d.part");
    }
    CLI_FAILS(STATUS_INPUT, "c.part: cannot be opened: No such file or directory",
              "tiny.pbrt --quiet -o b.pfm --resume c.part");
    CLI_FAILS(STATUS_USAGE, "--shard '0/4' is not right, expected I/N with I from 1 to N",
              "tiny.pbrt --quiet --shard 0/4");
    CLI_FAILS(STATUS_USAGE, "--shard: 2 samples a pixel cannot be shared among 3",
              "tiny.pbrt --quiet --shard 1/3");
    cli_write_text("wood.ppm", "P3\n1 1\n255\n200 120 60\n");
    c = CLI_FAILS(STATUS_INPUT, "a.part: is of another scene, or a file of the scene has changed "
                  "since", "tiny.pbrt --quiet --resume a.part -o b.pfm");
    EXPECT(!is_there("b.pfm"), "a picture of it: %s", c.err);
}

/* ---- full disks ---- */

static void little_room(void)
{
    const struct rlimit most = { 30000, 30000 };
    signal(SIGXFSZ, SIG_IGN);
    setrlimit(RLIMIT_FSIZE, &most);
}

/* Pictures fit, states do not: the last one that did stays, and is good. */
static void full_disk(void)
{
    char *old;
    size_t n;
    Cli c;

    cli_scene();
    CLI_WORKS("tiny.pbrt --quiet --size 32x24 --spp 64 -o a.pfm");
    CLI_WORKS("tiny.pbrt --quiet --size 32x24 --spp 8 -o b.pfm -o b.part");
    old = cli_read("b.part", &n);
    cli_write("c.part", old, n);
    c = cli_start(little_room, "tiny.pbrt --quiet --size 32x24 --spp 64 -o b.pfm --resume b.part "
                  "--autosave 0.002");
    cli_wait(&c);
    EXPECT(c.status == STATUS_OUTPUT && strstr(c.err, "rushlight: b.part: cannot be written: File "
                                               "too large\n") == c.err, "%d: %s", c.status, c.err);
    EXPECT(cli_same_file("b.part", "c.part") && cli_same_file("a.pfm", "b.pfm"),
           "the state is another, or the picture");
    CLI_WORKS("tiny.pbrt --quiet --size 32x24 --spp 64 -o b.pfm --resume b.part");
    EXPECT(cli_same_file("a.pfm", "b.pfm"), "it does not go on");
}

static unsigned long fault_at;
static void fail_once(void) { file_fail_at(fault_at, false, ENOSPC); }

/* A state that could not be written, but the next one could: told, and forgiven. */
static void full_for_a_moment(void)
{
    int forgiven = 0;

    cli_scene();
    CLI_WORKS("tiny.pbrt --quiet --size 32x24 --spp 64 --threads 1 -o a.pfm");
    for (fault_at = 20; fault_at < 60; fault_at += 3) {
        Cli c = cli_start(fail_once, "tiny.pbrt --quiet --size 32x24 --spp 64 --threads 1 -o b.pfm "
                          "--autosave 0.001");
        cli_wait(&c);
        if (!strstr(c.err, "b.part: cannot be written") || c.status == STATUS_OUTPUT)
            continue;
        forgiven++;
        EXPECT(c.status == 0 && cli_same_file("a.pfm", "b.pfm"), "%d: %s", c.status, c.err);
    }
    EXPECT(forgiven > 0, "no state failed");
}

/* ---- kill -9 ---- */

/* Kills a render at a random moment, over and over, and lets it go on from what is there. */
static void killed_often(const char *method, int kills, uint32_t spp)
{
    Rng rng = rng_seed(11);
    char line[300];
    struct timespec a, b;
    double whole;

    snprintf(line, sizeof line, "tiny.pbrt --quiet --size 40x30 --spp %lu --integrator %s "
             "--threads 2", (unsigned long)spp, method);
    clock_gettime(CLOCK_MONOTONIC, &a);
    CLI_WORKS("%s -o a.pfm", line);
    clock_gettime(CLOCK_MONOTONIC, &b);
    whole = (double)(b.tv_sec - a.tv_sec) + 1e-9 * (double)(b.tv_nsec - a.tv_nsec);
    for (int k = 0; k < kills; k++) {
        int status;
        Cli c;
        remove(cli_path("b.part"));
        remove(cli_path("b.pfm"));
        c = cli_start(NULL, "%s -o b.pfm --autosave 0.005", line);
        nap(1.5 * whole * (double)rng_unit(&rng));
        kill(c.pid, SIGKILL);
        REQUIRE(waitpid(c.pid, &status, 0) == c.pid, "waitpid");
        fclose(c.stream[0]);
        fclose(c.stream[1]);
        c = cli("%s -o b.pfm%s", line, is_there("b.part") ? " --resume b.part" : "");
        EXPECT_CLI(c, 0, "");
        EXPECT(cli_same_file("a.pfm", "b.pfm"), "%s: another picture after kill %d", method, k);
    }
}

static void killed(void)
{
    cli_scene();
    killed_often("path", 3, 64);
    killed_often("sppm:photons=500", 3, 16);
    killed_often("mlt:chains=20,bootstrap=200", 2, 16);
    killed_often("erpt:even=box", 2, 4);
}

/* Methods that have little in common. */
enum { FOUR = 4 };
static const char *const OTHERS[FOUR] = { "path", "vcm", "pssmlt", "swarm" };

static void killed_four(void)
{
    cli_scene();
    for (int k = 0; k < FOUR; k++)
        killed_often(OTHERS[k], 50, 32);
}

/* And all others. */
static void killed_all(void)
{
    cli_scene();
    for (int k = 0; integrators[k]; k++) {
        bool other = !integrators[k]->unkept;
        for (int i = 0; i < FOUR; i++)
            other = other && strcmp(integrators[k]->info.name, OTHERS[i]);
        if (other)
            killed_often(integrators[k]->info.name, 8, 16);
    }
}

/* ---- shares ---- */

static void shards(void)
{
    cli_scene();
    CLI_WORKS("tiny.pbrt --quiet --size 30x20 --spp 24 -o a.pfm --aov length:2=l.pfm");
    for (int i = 8; i >= 1; i--)
        CLI_WORKS("tiny.pbrt --quiet --size 30x20 --spp 24 --shard %d/8 --aov length:2=x.pfm%s", i,
                  i == 5 ? " -o five.part" : "");
    CLI_WORKS("merge tiny-3-of-8.part tiny-1-of-8.part tiny-2-of-8.part tiny-8-of-8.part five.part "
              "tiny-4-of-8.part tiny-7-of-8.part tiny-6-of-8.part --quiet -o b.pfm "
              "--aov length:2=m.pfm");
    EXPECT(cli_same_file("a.pfm", "b.pfm") && cli_same_file("l.pfm", "m.pfm"), "another sum");
    EXPECT(!is_there("x.pfm") && !is_there("tiny.png"), "a picture of a share");
    CLI_FAILS(STATUS_INPUT, "6 shares are missing: the picture has fewer samples",
              "merge five.part tiny-1-of-8.part --strict --quiet -o b.pfm");
    CLI_FAILS(STATUS_INPUT, "five.part: has the samples of another part (seed 0, share 5 of 8)",
              "merge five.part five.part --quiet -o b.pfm");
    CLI_FAILS(STATUS_USAGE, "warning: 7 shares are missing: the picture has fewer samples\n"
              "rushlight: --aov normal: the parts were rendered without it",
              "merge five.part --quiet --aov normal=n.pfm");
    CLI_FAILS(STATUS_USAGE, "--shard gives a share of a picture: -o takes FILE.part, and merge "
              "makes a.png", "tiny.pbrt --shard 1/2 -o a.png");
}

const TestCase test_cli_state[] = {
    { "autosave", autosave, false },
    { "refused", refused, false },
    { "full_disk", full_disk, false },
    { "full_for_a_moment", full_for_a_moment, false },
    { "killed", killed, false },
    { "killed_four", killed_four, true },
    { "killed_all", killed_all, true },
    { "shards", shards, false },
    { NULL, NULL, false }
};
