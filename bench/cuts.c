/* cuts.c -- direct light by point lights: what clusters and counted rays are worth.
 *
 * Source      [Wang09] figures 4, 5, 7 and 8: five scenes; light alone, the surface alone, and both
 *             at equal time; and sampling importance resampling.
 * Measured    One place in each pixel, so that all noise is of the lights; of the scenes with light
 *             of one bounce, that alone. Errors are against the method's own truth: of point lights
 *             the sum over all of them, as in the source; of the surface alone very many samples.
 *             Time is CPU time of rendering. First the samples of the source for bidirectional;
 *             then as many of the others as take the same time, by the straight line through two
 *             counts of samples.
 * Bias        What the points themselves are off by: one truth against the other.
 * The scenes  are ours, and so is the probe: the source's are not to be had. */
#include "bench/bench.h"
#include "image/compare.h"
#include "lightsampling/lighttree.h"

#include <stdio.h>
#include <string.h>

enum { W = 96, H = 72, RUNS = 3 };

typedef struct {
    const char *name, *scene;
    bool bounce;                /* light of one bounce, and nothing else */
    int  samples;               /* of the source, bidirectional */
    int  resample;              /* fig. 8: kept of 800, and of as many clusters; 0: not in it */
    const char *said;
} CutScene;

static const CutScene cut_scenes[] = {
    { "Hebe", "scenes/hebe.pbrt", false, 32, 32, "64 K faces, cut 420, N 160 / 40 / 32 in 10 s" },
    { "Car", "scenes/car.pbrt", false, 128, 32,
      "30 K faces, cut 648, N 256 / 128 / 128 in 27 / 28 / 28 s" },
    { "Box", "scenes/projected-box.pbrt", true, 128, 0,
      "20 K faces, cut 267, N 240 / 128 / 128 in 27 s" },
    { "Plate", "scenes/projected-plate.pbrt", true, 128, 0,
      "1 K faces, cut 492, N 260 / 128 / 128 in 28 / 27 / 29 s" },
    { "Bedroom", "scenes/bedroom.pbrt", true, 256, 0,
      "95 K faces, cut 986, N - / - / 256 in 69 s" },
};

/* options: of direct, with %d for the samples of each; NULL: by the surface alone. */
typedef struct { const char *what, *options; } CutMethod;

static bool picture(const CutScene *s, const CutMethod *m, int samples, uint64_t seed, Image *im,
                    double *seconds)
{
    char text[200], how[160];
    RenderRequest q;
    RenderReport report;

    memset(&q, 0, sizeof q);
    q.integrator = text;
    q.filter = "box:xradius=0.001,yradius=0.001";
    q.spp = 1;
    q.threads = 1;
    q.seed = seed;
    q.w = W;
    q.h = H;
    if (s->bounce)
        q.aovs[q.naovs++] = "length:3=none.pfm";
    if (!m->options && s->bounce) {
        snprintf(text, sizeof text, "path:maxdepth=2");
        q.spp = (uint32_t)samples;
    } else {
        snprintf(how, sizeof how, m->options ? m->options : "strategy=brdf,bsdfsamples=%d",
                 samples);
        snprintf(text, sizeof text, "direct:%s%s", how,
                 m->options && s->bounce ? ",indirect=only" : "");
    }
    if (!bench_picture(s->scene, &q, im, &report))
        return false;
    *seconds = report.cpu_seconds;
    return true;
}

/* Of all samples, and the time of the best run. */
typedef struct { double relmse, variance, seconds; } Measured;

static bool measure(const CutScene *s, const CutMethod *m, int samples, const Image *truth,
                    Measured *r)
{
    memset(r, 0, sizeof *r);
    r->seconds = 1e30;
    for (int k = 0; k < RUNS; k++) {
        Image im = { 0 };
        ImageDifference d;
        double seconds;
        if (!picture(s, m, samples, (uint64_t)k, &im, &seconds) ||
            !image_compare(&im, m->what, truth, "truth", &d))
            return false;
        r->relmse += d.relmse / RUNS;
        r->variance += d.sigma_over_mu * d.sigma_over_mu / RUNS;
        r->seconds = seconds < r->seconds ? seconds : r->seconds;
        image_clear(&im);
    }
    return true;
}

static void print(const CutScene *s, const CutMethod *m, int samples, const Measured *r,
                  const char *said)
{
    printf("%s\t%-22s\tN %5d\tCPU s %6.2f\trelMSE %.6f\tsigma/mu %.4f\trelMSE x CPU s %.6f\t%s\n",
           s->name, m->what, samples, r->seconds, r->relmse, sqrt(r->variance),
           r->relmse * r->seconds, said);
    fflush(stdout);
}

/* How many samples take as long. */
static bool as_long(const CutScene *s, const CutMethod *m, int samples, double seconds, int *wanted)
{
    double t[2], each;

    for (int k = 0; k < 2; k++) {
        Image im = { 0 };
        if (!picture(s, m, samples << k, 0, &im, &t[k]))
            return false;
        image_clear(&im);
    }
    each = d_max(t[1] - t[0], 0.05 * t[0]) / samples;
    *wanted = (int)d_max(1, d_min(4096, samples + (seconds - t[0]) / each));
    return true;
}

static const CutMethod of_light = {
    "light alone", "strategy=cut,brdf=none,jitter=false,samples=%d"
};
static const CutMethod by_surface = { "surface alone", NULL };
static const CutMethod both = { "bidirectional", "strategy=cut,jitter=false,samples=%d" };
static const CutMethod single = {
    "single point", "strategy=cut,brdf=single,jitter=false,samples=%d"
};
static const CutMethod printed = {      /* but for errata 002.2 to 002.4; it loses light */
    "both, as printed", "strategy=cut,jitter=false,safe=0,prior=0,extent=0,within=even,boxes=true,"
    "samples=%d"
};
static const CutMethod resampled = {
    "SIR, M = 800", "strategy=sir,tentative=800,jitter=false,samples=%d"
};
static const CutMethod both_800 = {
    "both, 800 clusters", "strategy=cut,clusters=800,jitter=false,samples=%d"
};
static const CutMethod judged = {
    "both, of 4 judged", "strategy=cut,clusters=800,judged=4,jitter=false,samples=%d"
};

/* Figure 8, and both at the time that resampling takes. */
static bool figure_8(const CutScene *s, const Image *all)
{
    Measured r;
    int n;

    if (!measure(s, &both_800, s->resample, all, &r))
        return false;
    print(s, &both_800, s->resample, &r, "said (fig. 8): 26 s, 7 s");
    if (!measure(s, &judged, s->resample, all, &r))
        return false;
    print(s, &judged, s->resample, &r, "");
    if (!measure(s, &resampled, s->resample, all, &r))
        return false;
    print(s, &resampled, s->resample, &r, "said (fig. 8): 30 s, 8 s; noisier");
    if (!as_long(s, &both_800, s->resample, r.seconds, &n) || !measure(s, &both_800, n, all, &r))
        return false;
    print(s, &both_800, n, &r, "as long as SIR");
    return true;
}

static void figures_of(const CutScene *s)
{
    static const CutMethod sum = { "all", "strategy=cut,brdf=all,jitter=false,samples=%d" };
    static const CutMethod mixed = { "mis", "strategy=mis,lightsamples=2048,bsdfsamples=%d" };
    static const CutMethod *const others[] = { &of_light, &by_surface, &single, &printed };
    Image all = { 0 }, real = { 0 };
    ImageDifference d;
    Measured r;
    double seconds, bound;
    int n;

    if (!picture(s, &sum, 1, 0, &all, &seconds) ||
        !picture(s, s->bounce ? &by_surface : &mixed, s->bounce ? 8192 : 2048, 1000, &real,
                 &bound) || !image_compare(&all, "points", &real, "light", &d))
        return;
    printf("%s\tthe sum over all points takes %.0f CPU s; against all light: sigma/mu %.4f, mean "
           "%.5f, relMSE %.6f\tsaid: %s\n", s->name, seconds, d.sigma_over_mu, d.ratio, d.relmse,
           s->said);
    if (!measure(s, &both, s->samples, &all, &r))
        return;
    print(s, &both, s->samples, &r, "said: better than both others at equal time");
    bound = r.seconds;
    for (size_t k = 0; k < sizeof others / sizeof others[0]; k++)
        if (as_long(s, others[k], s->samples, bound, &n) &&
            measure(s, others[k], n, others[k]->options ? &all : &real, &r))
            print(s, others[k], n, &r, "");
    if (s->resample && !figure_8(s, &all))
        return;
    image_clear(&all);
    image_clear(&real);
}

/* Sizes of cuts by the rule of squares alone, as in the source. */
static void sizes_of(const CutScene *s)
{
    static const float sigma[] = { 1, 2, 5, 10, 20 };
    ReadLimits limits = READ_LIMITS_DEFAULT;
    uint32_t node[CUT_MOST];
    const AccelKind *kind = kind_find(accels, ACCEL_DEFAULT);
    PointLights p;
    LightTree t;
    SceneFile f;
    double start;
    Opts o;

    opts_default(&o, kind->info.options);
    if (!scenefile_read(&f, s->scene, &limits))
        return;
    if (scene_build(f.scene, kind, &o, 1) &&
        pointlights_init(&p, f.scene, 32768, false, s->bounce ? INDIRECT_ONLY : INDIRECT_NO)) {
        start = clock_cpu();
        if (lighttree_init(&t, &p)) {
            printf("%s\t%lu points, their tree in %.3f CPU s; clusters for", s->name,
                   (unsigned long)p.n, clock_cpu() - start);
            for (size_t k = 0; k < sizeof sigma / sizeof sigma[0]; k++)
                printf(" sigma %g: %lu%s", (double)sigma[k],
                       (unsigned long)lighttree_cut(&t, &(CutRule){ CUT_MOST, sigma[k], 0 }, node),
                       k + 1 < sizeof sigma / sizeof sigma[0] ? "," : "");
            printf("\tsaid, sigma 5: %s\n", s->said);
            fflush(stdout);
            lighttree_clear(&t);
        }
        pointlights_clear(&p);
    }
    scenefile_clear(&f);
}

void bench_cuts(void)
{
    for (size_t i = 0; i < sizeof cut_scenes / sizeof cut_scenes[0]; i++)
        sizes_of(&cut_scenes[i]);
    for (size_t i = 0; i < sizeof cut_scenes / sizeof cut_scenes[0]; i++)
        figures_of(&cut_scenes[i]);
}
