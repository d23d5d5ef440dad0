/* main.c -- the benchmarks: bench [TEXT] runs those whose name contains TEXT. Lines with tabs, or
 * tables, on standard output; figures of the best peers, and of the document, stand beside ours
 * where there are any. Each figure is the median of several runs after a warm-up, in CPU time of
 * the process; what was computed is checked, and a line that fails its check says WRONG.
 * `bench report OUT.html [TEXT]` puts all of that, and what they draw, on one page. `bench sheet
 * ...` measures nothing: it puts pictures side by side, for `make gallery`. */
#include "bench/bench.h"
#include "bench/report.h"

#include <stdio.h>
#include <string.h>
#include <sys/utsname.h>

static const struct { const char *name; void (*run)(void); } benches[] = {
    { "load", bench_load }, { "rays", bench_rays }, { "paths", bench_paths },
    { "error", bench_error }, { "memory", bench_memory }, { "speed", bench_speed },
    { "arity", bench_arity }, { "adaptive", bench_adaptive }, { "zoneplate", bench_zoneplate },
    { "denoise", bench_denoise }, { "jitter", bench_jitter }, { "copyimage", bench_copyimage },
    { "pssmlt", bench_pssmlt },
    { "patterns", bench_patterns }, { "samplers", bench_samplers },
    { "direct", bench_direct }, { "twostage", bench_twostage },
    { "twostage cost", bench_twostage_cost }, { "triple", bench_triple },
    { "swarm table", bench_swarm_table }, { "swarm lens", bench_swarm_lens },
    { "swarm large", bench_swarm_large }, { "swarm cost", bench_swarm_cost },
    { "cuts", bench_cuts }, { "direct lamps", bench_lamps }, { "bias", bench_bias },
    { "photons", bench_photons }, { "indirect", bench_indirect }, { "methods", bench_methods },
    { "bidirectional", bench_bidirectional }, { "bidirectional rooms", bench_bidirectional_rooms },
    { "bidirectional pass", bench_bidirectional_pass },
    { "moves speed", bench_moves_speed }, { "moves error", bench_moves_error },
    { "moves narrow", bench_moves_narrow },
    { "moves figures", bench_moves_figures }, { "moves strata", bench_moves_strata },
    { "moves curves", bench_moves_curves }, { "view", bench_view },
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

/* Whether a bench has the text in its name; else it is said which there are. */
static bool is_some(const char *text)
{
    for (size_t i = 0; i < sizeof benches / sizeof benches[0]; i++)
        if (strstr(benches[i].name, text))
            return true;
    fprintf(stderr, "bench: none has '%s' in its name; there are:", text);
    for (size_t i = 0; i < sizeof benches / sizeof benches[0]; i++)
        fprintf(stderr, "%s %s", i ? "," : "", benches[i].name);
    fprintf(stderr, ", sheet\n");
    return false;
}

int main(int argc, char **argv)
{
    bool reports = argc > 2 && !strcmp(argv[1], "report");
    const char *text = reports ? (argc > 3 ? argv[3] : "") : argc > 1 ? argv[1] : "";

    if (!strcmp(text, "sheet"))
        return sheet(argc - 2, argv + 2);
    if (!is_some(text))
        return STATUS_USAGE;
    messages_quiet(true);
    if (reports && !report_begin(argv[2]))
        return err_status();
    if (reports)
        report_section("machine", machine);
    else
        machine();
    for (size_t i = 0; i < sizeof benches / sizeof benches[0]; i++)
        if (!strstr(benches[i].name, text))
            continue;
        else if (reports)
            report_section(benches[i].name, benches[i].run);
        else
            benches[i].run();
    if (reports)
        report_end();
    return err_status();
}
