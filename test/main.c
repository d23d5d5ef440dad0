/* main.c -- the test runner: test [--long] [--list] [--times] [--jobs N] [--except TEXT]
 * [TEXT...]. Runs the cases whose suite/name contains a TEXT, but not that of --except, each in a
 * process of its own with a limit of time. --times: a line for each, with its seconds of processor
 * time. Last line: N passed, N failed. */
#include "test/test.h"

#include "base/bits.h"
#include "base/random.h"

#include <errno.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <signal.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#define SUITES(X) X(maths) X(number) X(base) X(simd) X(sampling) X(bsdf) X(layers) \
    X(principled) X(image) \
    X(image_png) X(image_pngread) X(image_exr) X(textures) X(relief) X(mtl) \
    X(statistics) X(image_noise) \
    X(image_compare) X(image_hostile) X(mesh) X(mesh_ply) X(mesh_data) X(mesh_hostile) X(polygon) \
    X(generate) X(figures) X(scenes) X(scenefile) X(scenefile_errors) X(scenefile_things) \
    X(scenefile_shapes) X(scenefile_lights) X(scenefile_hostile) \
    X(cli) X(cli_images) X(cli_render) X(cli_output) X(cli_cast) X(cli_race) \
    X(cli_state) X(completion) X(race) \
    X(race_file) \
    X(physics_furnace) X(physics_irradiance) X(physics_specular) X(physics_agree) \
    X(physics_exact) X(physics_weights) X(lights) X(panorama) X(probes) X(emission) \
    X(lightsampling) X(direct) X(direct_weights) X(beside) X(partition) X(twostage) \
    X(twostage_lamp) X(twostage_sky) X(visibility) X(triple) X(truth) X(cut) X(cut_light) \
    X(cameras) X(driver) X(state) X(adaptive) X(film) X(filters) \
    X(motion) X(cameras_we) X(bugs) X(faults) X(malformed) X(bytes) X(builds) \
    X(rays) X(rays_closed) X(rays_leave) X(rays_lights) X(rays_trees) X(tessellation) X(geometry) \
    X(geometry_round) X(film_sums) X(sampler) X(patterns) X(tables) X(media) X(references) \
    X(whitted) X(distributed) X(splats) X(light) X(pointtree) X(photonmap) X(instantradiosity) \
    X(pointgrid) X(progressive) X(irradiance) X(irradiancecache) X(bidirectional) X(aov) \
    X(chains) X(pssmlt) X(radiance) X(tonemap) X(denoise) X(mutations) X(mlt) X(learned) \
    X(swarm) X(swarm_subsets) X(preview) X(view_http) X(view) X(browser)
#define DECLARE(name) extern const TestCase test_##name[];
#define ENTRY(name) { #name, test_##name },
SUITES(DECLARE)
static const TestSuite suites[] = { SUITES(ENTRY) { NULL, NULL } };

enum { EXIT_FAILED = 1, EXIT_SKIPPED = 77, SECONDS = 600, SECONDS_LONG = 7200, JOBS_MAX = 16 };

static char running[160];
static int failures;
static bool is_long;
static char folder[200];

void test_fail(const char *file, int line, const char *fmt, ...)
{
    va_list args;
    if (++failures > 10)
        return;
    printf("%s:%d: %s: ", file, line, running);
    va_start(args, fmt);
    vprintf(fmt, args);
    va_end(args);
    printf("\n");
}

uint64_t test_hash(uint64_t h, const float *x, size_t n)
{
    for (size_t i = 0; i < n; i++)
        h = key_with(h, bits_of_float(x[i]));
    return h;
}

static void remove_folder(void)
{
    char cmd[300];
    if (!folder[0])
        return;
    snprintf(cmd, sizeof cmd, "rm -rf '%s'", folder);
    if (system(cmd))
        printf("%s: cannot remove %s\n", running, folder);
}

void test_stop(void)
{
    remove_folder();
    fflush(stdout);
    exit(failures ? EXIT_FAILED : 0);
}

void test_skip(const char *fmt, ...)
{
    va_list args;
    printf("%s: skipped: ", running);
    va_start(args, fmt);
    vprintf(fmt, args);
    va_end(args);
    printf("\n");
    remove_folder();
    fflush(stdout);
    exit(failures ? EXIT_FAILED : EXIT_SKIPPED);
}

bool test_is_long(void) { return is_long; }

const char *test_data(const char *name)
{
    static char path[4][600];
    static int turn;
    const char *root = getenv("RUSHLIGHT_DATA");
    struct stat st;
    char *p = path[turn++ & 3];
    snprintf(p, sizeof path[0], "%s/%s", root ? root : "../shared/data", name);
    if (stat(p, &st))
        test_skip("%s is not here", p);
    return p;
}

const char *test_folder(void)
{
    if (!folder[0]) {
        const char *tmp = getenv("TMPDIR");
        snprintf(folder, sizeof folder, "%.150s/rushlight-test-XXXXXX", tmp ? tmp : "/tmp");
        if (!mkdtemp(folder)) {
            printf("%s: cannot make %s: %s\n", running, folder, strerror(errno));
            exit(EXIT_FAILED);
        }
    }
    return folder;
}

/* Time of the processor, since a machine may have other work; by the clock, which sees a case that
 * waits for ever, four times as much. */
static void limit_time(void)
{
    unsigned seconds = is_long ? SECONDS_LONG : SECONDS;
    struct rlimit r = { seconds, seconds + 5 };

    setrlimit(RLIMIT_CPU, &r);
    alarm(4 * seconds);
}

typedef struct { pid_t pid; FILE *out; char name[160]; } Job;

static Job start(const char *suite, const TestCase *c)
{
    Job j = { 0, tmpfile(), "" };
    snprintf(j.name, sizeof j.name, "%s/%s", suite, c->name);
    fflush(NULL);
    j.pid = fork();
    if (j.pid == 0) {
        snprintf(running, sizeof running, "%s", j.name);
        dup2(fileno(j.out), 1);
        dup2(fileno(j.out), 2);
        limit_time();
        c->run();
        test_stop();
    }
    return j;
}

static int passed, failed, skipped;
static bool want_times;

/* Processor time of the children that have ended since the last call, theirs included. */
static double seconds_since(void)
{
    static double before;
    struct rusage r;
    double now, since;

    getrusage(RUSAGE_CHILDREN, &r);
    now = (double)r.ru_utime.tv_sec + (double)r.ru_stime.tv_sec +
          1e-6 * ((double)r.ru_utime.tv_usec + (double)r.ru_stime.tv_usec);
    since = now - before;
    before = now;
    return since;
}

static void finish(Job *j, int status)
{
    bool ok = WIFEXITED(status) && WEXITSTATUS(status) == 0;
    bool skip = WIFEXITED(status) && WEXITSTATUS(status) == EXIT_SKIPPED;
    char line[1024];

    if (want_times)
        printf("%8.1f s %s\n", seconds_since(), j->name);
    if (!ok) {                                  /* what a passing case prints is of no interest */
        rewind(j->out);
        while (fgets(line, sizeof line, j->out))
            fputs(line, stdout);
    }
    fclose(j->out);
    if (WIFSIGNALED(status))
        printf("%s: died of signal %d%s\n", j->name, WTERMSIG(status),
               WTERMSIG(status) == SIGALRM || WTERMSIG(status) == SIGXCPU ? " (time limit)" : "");
    if (ok)
        passed++;
    else if (skip)
        skipped++;
    else {
        failed++;
        printf("FAILED %s\n", j->name);
    }
    fflush(stdout);
    j->pid = 0;
}

static void reap(Job *jobs, int njobs)
{
    int status;
    pid_t pid = wait(&status);
    for (int k = 0; k < njobs; k++)
        if (jobs[k].pid && jobs[k].pid == pid)
            finish(&jobs[k], status);
}

/* Does one of the texts occur in it, and the one not wanted not? All do if there are none. */
static bool wanted(const char *name, char **text, int n, const char *except)
{
    if (except && strstr(name, except))
        return false;
    for (int i = 0; i < n; i++)
        if (strstr(name, text[i]))
            return true;
    return n == 0;
}

int main(int argc, char **argv)
{
    Job jobs[JOBS_MAX] = { { 0, NULL, "" } };
    int njobs = 2, ntexts = 0;
    const char *except = NULL;
    bool list = false;

    for (int i = 1; i < argc; i++) {
        if (!strcmp(argv[i], "--long"))
            is_long = true;
        else if (!strcmp(argv[i], "--list"))
            list = true;
        else if (!strcmp(argv[i], "--times"))
            want_times = true;
        else if (!strcmp(argv[i], "--except") && i + 1 < argc)
            except = argv[++i];
        else if (!strcmp(argv[i], "--jobs") && i + 1 < argc)
            njobs = atoi(argv[++i]);
        else
            argv[ntexts++] = argv[i];
    }
    if (njobs < 1 || njobs > JOBS_MAX)
        njobs = 1;
    for (const TestSuite *s = suites; s->name; s++)
        for (const TestCase *c = s->cases; c->name; c++) {
            char name[160];
            int k;
            snprintf(name, sizeof name, "%s/%s", s->name, c->name);
            if (!wanted(name, argv, ntexts, except) || (c->slow && !is_long))
                continue;
            if (list) {
                printf("%s\n", name);
                continue;
            }
            for (k = 0; k < njobs && jobs[k].pid; k++)
                ;
            if (k == njobs) {
                reap(jobs, njobs);
                for (k = 0; jobs[k].pid; k++)
                    ;
            }
            jobs[k] = start(s->name, c);
        }
    for (int k = 0; k < njobs; k++)
        while (jobs[k].pid)
            reap(jobs, njobs);
    if (list)
        return 0;
    if (skipped)
        printf("%d skipped\n", skipped);
    printf("%d passed, %d failed\n", passed, failed);
    return failed || !passed ? 1 : 0;
}
