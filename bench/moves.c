/* moves.c -- chains of explicit paths: their speed, their error beside that of path tracing in
 * equal time, and the pictures of chapters 7 and 8 of [Cline07] as numbers.
 *
 * Errors    Of a method's picture against two independent references, see paired_relmse; runs end
 *           near a number of CPU-seconds, and errors are scaled to it as if they fell as 1 / t.
 *           spikes: the part of the error that the twenty worst pixels have. mean: over that of the
 *           references.
 * Printed   is what the document says of its picture, in words: it has no numbers. */
#include "bench/bench.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

typedef struct {
    const char *scene;
    uint32_t w, h, crop[4];             /* crop all 0: none */
    const char *truth;                  /* method of the references, */
    double truth_seconds, seconds;      /* CPU-seconds of each, and of a method */
} Contest;

static bool run_for(const Contest *c, const char *method, double seconds, uint64_t seed, Image *im,
                    RenderReport *r)
{
    RenderRequest q;

    memset(&q, 0, sizeof q);
    q.integrator = method;
    q.w = c->w;
    q.h = c->h;
    q.crop_given = c->crop[2] > 0;
    memcpy(q.crop, c->crop, sizeof q.crop);
    q.threads = processors();
    q.seed = seed;
    q.spp = 1;
    if (!bench_picture(c->scene, &q, NULL, r))
        return false;
    q.spp = (uint32_t)(4 * seconds / (4 * r->cpu_seconds + seconds)) + 1;
    if (!bench_picture(c->scene, &q, NULL, r))
        return false;
    q.spp = (uint32_t)(q.spp * seconds / r->cpu_seconds + 0.5);
    q.spp = q.spp ? q.spp : 1;
    return bench_picture(c->scene, &q, im, r);
}

static double mean_of(const Image *im)
{
    double sum = 0;

    for (size_t i = 0; i < (size_t)im->w * im->h; i++)
        sum += rgb_lum(im->pixels[i]);
    return sum / ((double)im->w * im->h);
}

static int descending(const void *a, const void *b)
{
    double x = *(const double *)a, y = *(const double *)b;
    return (x < y) - (x > y);
}

/* Of the twenty worst pixels, on the scale of paired_relmse. */
static double spikes(const Image *a, const Image *r, const Image *q)
{
    size_t n = (size_t)a->w * a->h;
    double *e = malloc(n * sizeof *e), sum = 0;

    if (!e)
        return 0;
    for (size_t i = 0; i < n; i++) {
        Image x = *a, y = *r, z = *q;
        x.pixels += i;
        y.pixels += i;
        z.pixels += i;
        x.w = x.h = y.w = y.h = z.w = z.h = 1;
        e[i] = paired_relmse(&x, &y, &z);
    }
    qsort(e, n, sizeof *e, descending);
    for (size_t i = 0; i < 20 && i < n; i++)
        sum += e[i] / (double)n;
    free(e);
    return sum;
}

typedef struct { const char *method, *says; } Row;

/* All rows, up to one without a method. */
static void contest(const Contest *c, const Row *row)
{
    Image r = { 0 }, q = { 0 };
    RenderReport report;

    if (run_for(c, c->truth, c->truth_seconds, 101, &r, &report) &&
        run_for(c, c->truth, c->truth_seconds, 102, &q, &report))
        for (; row->method; row++) {
            Image im = { 0 };
            if (run_for(c, row->method, c->seconds, 7, &im, &report)) {
                double e = paired_relmse(&im, &r, &q), scale = report.cpu_seconds / c->seconds;
                printf("moves\t%s\t%s\tspp %.0f\tCPU-seconds %.1f\trelMSE %.5f\tscaled to %g s "
                       "%.5f\tspikes %.5f\tmean %.4f\t%s\n", c->scene, row->method, report.spp,
                       report.cpu_seconds, e, c->seconds, e * scale, spikes(&im, &r, &q),
                       2 * mean_of(&im) / (mean_of(&r) + mean_of(&q)), row->says);
                fflush(stdout);
            }
            image_clear(&im);
        }
    image_clear(&r);
    image_clear(&q);
}

/* ---- against the peers ---- */

enum { RUNS = 5 };

void bench_moves_speed(void)
{
    double best = 0;
    RenderReport r;

    for (int k = 0; k < RUNS; k++) {
        if (!bench_render("scenes/s5.pbrt", "mlt:direct=no,mutations=8", NULL, 0, 8, 1, 0, NULL,
                          &r))
            return;
        if ((double)r.samples / r.cpu_seconds > best)
            best = (double)r.samples / r.cpu_seconds;
    }
    printf("moves\tscenes/s5.pbrt\tmlt:direct=no\tMmutations a CPU-second: best %.3f\t"
           "peer: Mitsuba 0.6 1.08; asked for 1.5\n", best * 1e-6);
}

void bench_moves_error(void)
{
    static const Contest s5 = { "scenes/s5.pbrt", 256, 256, { 0 }, "bdpt", 120, 20 },
                         s0 = { "scenes/s0.pbrt", 256, 256, { 0 }, "bdpt", 60, 20 },
                         s2 = { "scenes/s2.pbrt", 256, 256, { 0 }, "bdpt", 60, 20 };
    static const Row caustics[] = {
        { "path:maxdepth=9", "" },
        { "mlt", "peer: Mitsuba 0.6 0.0345; must 0.025, aim 0.015" },
        { "erpt", "peer: Mitsuba 0.6 0.0137; must 0.011, aim 0.007" }, { NULL, NULL }
    }, deltas[] = {
        { "mlt", "peer: Mitsuba 0.6 3.65; must 0.05, aim 0.02" }, { "erpt", "the same" },
        { NULL, NULL }
    };

    contest(&s5, caustics);
    contest(&s0, deltas);
    contest(&s2, deltas);
}

/* ---- the document's figures ---- */

void bench_moves_figures(void)
{
    static const Contest zoom = { "scenes/s5.pbrt", 1024, 1024, { 640, 760, 704, 824 }, "path", 30,
                                  3 },
                         ball = { "scenes/three-spheres.pbrt", 96, 64, { 0 }, "bdpt", 20, 3 },
                         gallery = { "scenes/gallery.pbrt", 96, 64, { 0 }, "bdpt", 20, 3 },
                         weight = { "scenes/paperweight.pbrt", 96, 64, { 0 }, "bdpt", 20, 3 };
    static const Row zoomed[] = {
        { "bdpt", "7.29 below, left: noise" },
        { "mlt:direct=no", "7.29 below, right: \"a much smoother result\"" }, { NULL, NULL }
    }, rules[] = {
        { "erpt:flow=detailed", "8.10 left: \"works poorly\"" },
        { "erpt:flow=iterated", "8.10 middle: \"works better\"" },
        { "erpt:flow=equal", "8.10 right: \"more evenly\"" },
        { "erpt:length=10", "8.11: chains of 10" }, { "erpt:length=100", "8.11: of 100" },
        { NULL, NULL }
    }, equal_time[] = {
        { "path", "8.13 to 8.15: \"very noisy\"" }, { "mlt", "much better" },
        { "erpt", "as good as mlt or better" }, { "erpt:even=box,repeats=20", "smoother, biased" },
        { "erpt:even=median,repeats=20", "" }, { NULL, NULL }
    };

    contest(&zoom, zoomed);
    contest(&ball, rules);
    contest(&ball, equal_time);
    contest(&gallery, equal_time);
    contest(&weight, equal_time);
}
