/* main.c -- the benchmarks: bench [TEXT] runs those whose name contains TEXT. Lines with tabs, or
 * tables, on standard output; figures of the best peers, and of the document, stand beside ours
 * where there are any. Each figure is the median of several runs after a warm-up, in CPU time of
 * the process; what was computed is checked, and a line that fails its check says WRONG.
 * `bench sheet ...` measures nothing: it puts pictures side by side, for `make gallery`. */
#include "bench/bench.h"

#include <stdio.h>
#include <string.h>
#include <sys/utsname.h>

static const struct { const char *name; void (*run)(void); } benches[] = {
    { "load", bench_load }, { "rays", bench_rays }, { "paths", bench_paths },
    { "error", bench_error }, { "memory", bench_memory }, { "speed", bench_speed },
    { "arity", bench_arity }, { "adaptive", bench_adaptive }, { "zoneplate", bench_zoneplate },
    { "jitter", bench_jitter },
    { "patterns", bench_patterns }, { "samplers", bench_samplers },
    { "direct", bench_direct }, { "twostage", bench_twostage },
    { "twostage cost", bench_twostage_cost }, { "triple", bench_triple },
    { "swarm", bench_swarm },
    { "cuts", bench_cuts }, { "direct lamps", bench_lamps }, { "bias", bench_bias },
};

static void machine(void)
{
    struct utsname u;
    const char *compiler =
#if defined(__clang__)
        "clang " __clang_version__;
#elif defined(__GNUC__)
        "gcc " __VERSION__;
#else
        "another compiler";
#endif
    uname(&u);
    printf("# %s %s, %s, %d processors\n", u.sysname, u.machine, compiler, processors());
}

int main(int argc, char **argv)
{
    const char *text = argc > 1 ? argv[1] : "";

    if (!strcmp(text, "sheet"))
        return sheet(argc - 2, argv + 2);
    messages_quiet(true);
    machine();
    for (size_t i = 0; i < sizeof benches / sizeof benches[0]; i++)
        if (strstr(benches[i].name, text))
            benches[i].run();
    return err_status();
}
