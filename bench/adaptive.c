/* adaptive.c -- figure 5.9 of [Cline07]: one scene with 16 samples a pixel on average, for all
 * pixels alike and by each policy; sigma/mu is the deviation of the pixels over RUNS seeds. The
 * source's scene, in Galileo's Tomb, is not at hand: ours is scenes/swarm-probe.pbrt. Policies that
 * take more samples than they were asked for are compared by sigma/mu times the root of them.
 *
 * Then --error X: what a picture has that stops there, and what it states, in small pictures and
 * larger ones; scenes/s5.pbrt has spikes that few pixels meet. */
#include "bench/bench.h"

#include <stdio.h>
#include <string.h>

enum { RUNS = 16, SIDE = 128, SPP = 16 };

typedef struct { double *sum, *squares; Image im; } Moments;

static bool add_run(Moments *m, const Film *f)
{
    film_picture(f, 0, &m->im);
    for (size_t i = 0; i < (size_t)m->im.w * m->im.h; i++) {
        double v = rgb_lum(m->im.pixels[i]);
        m->sum[i] += v;
        m->squares[i] += v * v;
    }
    return true;
}

/* With an error to reach, or with SPP samples. integrator NULL: the scene's. */
static void row_by(SceneFile *f, const char *integrator, const char *sampler, const char *policy,
                   double error, uint32_t side, const char *printed)
{
    double variance = 0, mean = 0, spp = 0, cpu = 0, stated = 0;
    size_t n = (size_t)side * side;
    RenderRequest q;
    RenderSettings s;
    RenderReport report;
    Moments m = { MEM_ARRAY(double, n), MEM_ARRAY(double, n), { 0 } };
    Film film;
    bool ok;

    memset(&q, 0, sizeof q);
    q.integrator = integrator;
    q.sampler = sampler;
    q.adaptive = policy;
    q.spp = error > 0 ? 0 : SPP;
    q.error = error;
    q.w = q.h = side;
    q.threads = 1;
    q.max_pixels = n;
    ok = m.sum && m.squares && image_init(&m.im, side, side) && settings_resolve(&s, &q, f);
    for (int r = 0; ok && r < RUNS; r++) {
        s.seed = (uint64_t)r + 1;
        ok = render(f->scene, &s, &film, &report) && add_run(&m, &film);
        spp += (double)report.samples / (double)n / RUNS;
        cpu += report.cpu_seconds / RUNS;
        stated += ok ? film_error(&film) / RUNS : 0;
        film_clear(&film);
    }
    for (size_t i = 0; ok && i < n; i++) {
        variance += (m.squares[i] - m.sum[i] * m.sum[i] / RUNS) / (RUNS - 1);
        mean += m.sum[i] / RUNS;
    }
    if (ok) {
        double e = sqrt(variance * (double)n) / mean;
        printf("%-8s %-26s %8.1f %9.4f %8.4f %8.3f %8.2f   %s\n", sampler, policy, spp, e, stated,
               e * sqrt(spp), cpu, printed);
        fflush(stdout);
    }
    mem_free(m.sum);
    mem_free(m.squares);
    image_clear(&m.im);
}

static void row(SceneFile *f, const char *sampler, const char *policy, double error, uint32_t side,
                const char *printed)
{
    row_by(f, NULL, sampler, policy, error, side, printed);
}

static bool scene_open(SceneFile *f, const char *path)
{
    ReadLimits limits = READ_LIMITS_DEFAULT;
    const AccelKind *accel = kind_find(accels, ACCEL_DEFAULT);
    Opts o;

    opts_default(&o, accel->info.options);
    if (!scenefile_read(f, path, &limits))
        return false;
    if (scene_build(f->scene, accel, &o, 1))
        return true;
    scenefile_clear(f);
    return false;
}

static void head(const char *what)
{
    printf("%s\n%-8s %-26s %8s %9s %8s %8s %8s\n", what, "sampler", "policy", "samples", "sigma/mu",
           "stated", "* root", "CPU s");
}

static void errors(const char *scene, const double *asked, int n, uint32_t side)
{
    static const char *const policies[] = { "none", "neighbours", "variable", "own" };
    char text[120];
    SceneFile f;

    if (!scene_open(&f, scene))
        return;
    for (int k = 0; k < n; k++) {
        snprintf(text, sizeof text, "--error %g on %s, %lux%lu, %d seeds", asked[k], scene,
                 (unsigned long)side, (unsigned long)side, RUNS);
        head(text);
        for (int i = 0; i < 4; i++)
            row(&f, "zerotwo", policies[i], asked[k], side, "");
    }
    scenefile_clear(&f);
}

void bench_variable(const char *scene, const char *integrator)
{
    char text[200];
    SceneFile f;

    if (!scene_open(&f, scene))
        return;
    snprintf(text, sizeof text, "figure 5.9 by %s on %s; printed: sigma/mu, seconds", integrator,
             scene);
    head(text);
    row_by(&f, integrator, "zerotwo", "none", 0, SIDE, "0.0446, 25.5");
    row_by(&f, integrator, "zerotwo", "variable", 0, SIDE, "0.0409, 25.9");
    row_by(&f, integrator, "zerotwo", "variable:rerender=true", 0, SIDE, "0.0366, 27.3");
    scenefile_clear(&f);
}

void bench_adaptive(void)
{
    static const char *const samplers_of[] = { "random", "zerotwo" };
    static const double asked[] = { 0.3, 0.15 };
    SceneFile f;

    if (!scene_open(&f, "scenes/swarm-probe.pbrt"))
        return;
    head("figure 5.9 on scenes/swarm-probe.pbrt, 128x128, 16 seeds; printed: sigma/mu, seconds");
    for (int k = 0; k < 2; k++) {
        row(&f, samplers_of[k], "none", 0, SIDE, k ? "" : "0.0446, 25.5");
        row(&f, samplers_of[k], "variable", 0, SIDE, k ? "" : "0.0409, 25.9");
        row(&f, samplers_of[k], "variable:rerender=true", 0, SIDE, k ? "" : "0.0366, 27.3");
        row(&f, samplers_of[k], "neighbours", 0, SIDE, "");
    }
    scenefile_clear(&f);
    if (!scene_open(&f, "scenes/s5.pbrt"))
        return;
    head("the same on scenes/s5.pbrt, whose noise is rare bright samples");
    row(&f, "zerotwo", "none", 0, SIDE, "");
    row(&f, "zerotwo", "variable", 0, SIDE, "");
    row(&f, "zerotwo", "neighbours", 0, SIDE, "");
    scenefile_clear(&f);
    errors("scenes/swarm-probe.pbrt", asked + 1, 1, 64);
    errors("scenes/s5.pbrt", asked, 2, 32);
    errors("scenes/s5.pbrt", asked, 2, 64);
    errors("scenes/s5.pbrt", asked + 1, 1, 128);
}
