/* adaptive.c -- figure 5.9 of [Cline07]: one scene with 16 samples a pixel on average, for all
 * pixels alike and by each policy; sigma/mu is the deviation of the pixels over RUNS seeds. The
 * source's scene, in Galileo's Tomb, is not at hand: ours is scenes/swarm-probe.pbrt. Policies that
 * take more samples than they were asked for are compared by sigma/mu times the root of them. */
#include "bench/bench.h"

#include <stdio.h>
#include <string.h>

enum { RUNS = 8, SIDE = 128, SPP = 16 };

typedef struct { double *sum, *squares; Image im; } Moments;

static bool add_run(Moments *m, const Film *f)
{
    film_picture(f, 0, &m->im);
    for (size_t i = 0; i < (size_t)SIDE * SIDE; i++) {
        double v = rgb_lum(m->im.pixels[i]);
        m->sum[i] += v;
        m->squares[i] += v * v;
    }
    return true;
}

static void row(SceneFile *f, const char *sampler, const char *policy, const char *printed)
{
    double variance = 0, mean = 0, spp = 0, cpu = 0, stated = 0;
    size_t n = (size_t)SIDE * SIDE;
    RenderRequest q;
    RenderSettings s;
    RenderReport report;
    Moments m = { MEM_ARRAY(double, n), MEM_ARRAY(double, n), { 0 } };
    Film film;
    bool ok;

    memset(&q, 0, sizeof q);
    q.sampler = sampler;
    q.adaptive = policy;
    q.spp = SPP;
    q.w = q.h = SIDE;
    q.threads = 1;
    q.max_pixels = n;
    ok = m.sum && m.squares && image_init(&m.im, SIDE, SIDE) && settings_resolve(&s, &q, f);
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
    }
    mem_free(m.sum);
    mem_free(m.squares);
    image_clear(&m.im);
}

void bench_adaptive(void)
{
    static const char *const samplers_of[] = { "random", "zerotwo" };
    ReadLimits limits = READ_LIMITS_DEFAULT;
    const AccelKind *accel = kind_find(accels, ACCEL_DEFAULT);
    SceneFile f;
    Opts o;

    opts_default(&o, accel->info.options);
    if (!scenefile_read(&f, "scenes/swarm-probe.pbrt", &limits))
        return;
    if (scene_build(f.scene, accel, &o, 1)) {
        printf("figure 5.9 on scenes/swarm-probe.pbrt, %dx%d, %d seeds\n", SIDE, SIDE, RUNS);
        printf("%-8s %-26s %8s %9s %8s %8s %8s   printed: sigma/mu, seconds\n", "sampler",
               "policy", "samples", "sigma/mu", "stated", "* root", "CPU s");
        for (int k = 0; k < 2; k++) {
            row(&f, samplers_of[k], "none", k ? "" : "0.0446, 25.5");
            row(&f, samplers_of[k], "variable", k ? "" : "0.0409, 25.9");
            row(&f, samplers_of[k], "variable:rerender=true", k ? "" : "0.0366, 27.3");
            row(&f, samplers_of[k], "neighbours", "");
        }
    }
    scenefile_clear(&f);
}
