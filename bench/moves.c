/* moves.c -- chains of explicit paths: their speed, their error beside that of path tracing in
 * equal time, and the pictures of chapters 7 and 8 of [Cline07] as numbers.
 *
 * Errors    Of a method's picture against two independent references, see paired_relmse; runs end
 *           near a number of CPU-seconds, and errors are scaled to it as if they fell as 1 / t.
 *           spikes: the part of the error that the twenty worst pixels have. mean: over that of the
 *           references.
 * Printed   is what the document says of its picture, in words: it has no numbers. */
#include "bench/bench.h"
#include "bench/report.h"
#include "render/plot.h"

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

/* Light that hardly any path finds: equal time, against path. */
void bench_moves_narrow(void)
{
    static const Contest door = { "scenes/ajar-door.pbrt", 96, 64, { 0 }, "bdpt:maxdepth=9", 12,
                                  4 },
                         weight = { "scenes/paperweight.pbrt", 96, 64, { 0 }, "pssmlt:maxdepth=9",
                                    12, 4 };
    static const Row rows[] = {
        { "path:maxdepth=9", "" }, { "pssmlt:maxdepth=9", "asked: a third of path's" },
        { "mlt", "" }, { "erpt", "asked: a third of path's" }, { NULL, NULL }
    };

    contest(&door, rows);
    contest(&weight, rows);
}

/* ---- convergence: figure 8.15 ---- */

enum { TIMES = 4, METHODS = 5 };
static const double times[TIMES] = { 0.75, 1.5, 3, 6 };
static const char *const methods[METHODS] = {
    "path", "mlt", "erpt", "erpt:even=box,repeats=20", "erpt:even=median,repeats=20"
};

typedef struct { double seconds[METHODS][TIMES], error[METHODS][TIMES]; } Curves;

static void one_curve(const Contest *c, int m, const Image *r, const Image *q, Curves *to)
{
    for (int k = 0; k < TIMES; k++) {
        RenderReport report;
        Image im = { 0 };
        if (run_for(c, methods[m], times[k], 7, &im, &report)) {
            to->seconds[m][k] = report.cpu_seconds;
            to->error[m][k] = paired_relmse(&im, r, q);
            printf("\t%.2f s %.5f", report.cpu_seconds, to->error[m][k]);
            fflush(stdout);
        }
        image_clear(&im);
    }
}

static void plot_curves(const Curves *of, const char *scene, const char *file)
{
    PlotCurve curve[METHODS];
    PlotPanel panel = { "CPU-seconds", "relMSE", curve, METHODS, -1, "1 / t" };

    for (int m = 0; m < METHODS; m++)
        curve[m] = (PlotCurve){ methods[m], NULL, of->seconds[m], of->error[m], TIMES };
    if (plot_write(file, scene, &panel, 1))
        report_picture(file);
}

static void curves(const Contest *c, const char *file)
{
    Image r = { 0 }, q = { 0 };
    RenderReport report;
    Curves of;

    memset(&of, 0, sizeof of);
    if (run_for(c, c->truth, c->truth_seconds, 101, &r, &report) &&
        run_for(c, c->truth, c->truth_seconds, 102, &q, &report)) {
        for (int m = 0; m < METHODS; m++) {
            printf("curves\t%s\t%s", c->scene, methods[m]);
            one_curve(c, m, &r, &q, &of);
            printf("\n");
        }
        plot_curves(&of, c->scene, file);
    }
    image_clear(&r);
    image_clear(&q);
}

void bench_moves_curves(void)
{
    static const Contest ball = { "scenes/three-spheres.pbrt", 96, 64, { 0 }, "bdpt", 20, 0 },
                         gallery = { "scenes/gallery.pbrt", 96, 64, { 0 }, "bdpt", 20, 0 },
                         weight = { "scenes/paperweight.pbrt", 96, 64, { 0 }, "pssmlt", 20, 0 };

    curves(&ball, "curves-ball.svg");
    curves(&gallery, "curves-gallery.svg");
    curves(&weight, "curves-paperweight.svg");
}

/* ---- stratification: figure 8.12 ---- */

/* A yellow dragon on a red plane, both lit by the board above alone, which the lamp under a shade
 * shines at: all light is indirect. */
static const char dragon[] =
    "Scale -1 1 1\nLookAt 0 -4.2 1.6  0 0 0.75  0 0 1\n"
    "Camera \"perspective\" \"float fov\" 36\n"
    "Film \"rgb\" \"integer xresolution\" 192 \"integer yresolution\" 128\n"
    "WorldBegin\n"
    "LightSource \"spot\" \"point3 from\" [ -2.2 -0.5 2.2 ] \"point3 to\" [ -1 0 6 ]"
    " \"float coneangle\" 30 \"rgb I\" [ 900 900 900 ]\n"
    "Material \"diffuse\" \"rgb reflectance\" [ 0.8 0.8 0.8 ]\n"
    "Shape \"bilinearmesh\" \"point3 P\" [ -4 -3 6  4 -3 6  -4 3 6  4 3 6 ]\n"
    "Material \"diffuse\" \"rgb reflectance\" [ 0.7 0.1 0.08 ]\n"
    "Shape \"bilinearmesh\" \"point3 P\" [ -9 -9 0  9 -9 0  -9 9 0  9 9 0 ]\n"
    "Material \"diffuse\" \"rgb reflectance\" [ 0.75 0.65 0.1 ]\n"
    "Scale 1.2 1.2 1.2\n"
    "Shape \"generated\" \"string kind\" \"dragon\" \"integer triangles\" 20000\n";

static bool dragon_by(const char *method, uint32_t spp, uint64_t seed, Image *im)
{
    RenderRequest q;
    RenderReport r;

    memset(&q, 0, sizeof q);
    q.integrator = method;
    q.spp = spp;
    q.seed = seed;
    q.threads = processors();
    return bench_text_picture("dragon", dragon, &q, im, &r);
}

enum { BLOCK = 8 };

/* Each square of so many pixels becomes its mean: *to is smaller. */
static bool means_of_blocks(const Image *im, Image *to)
{
    if (!image_init(to, im->w / BLOCK, im->h / BLOCK))
        return false;
    for (size_t i = 0; i < (size_t)to->w * to->h * BLOCK * BLOCK; i++) {
        size_t y = i / (to->w * BLOCK), x = i % (to->w * BLOCK);
        Rgb *sum = &to->pixels[y / BLOCK * to->w + x / BLOCK];
        *sum = rgb_add(*sum, rgb_scale(im->pixels[y * im->w + x], 1.0f / (BLOCK * BLOCK)));
    }
    return true;
}

static void uneven(const char *method, const Image *ref, const Image *even, const char *says)
{
    Image im = { 0 }, blocks = { 0 };

    if (dragon_by(method, 1, 7, &im) && means_of_blocks(&im, &blocks))
        printf("strata\tdragon\t%s\trelMSE of pixels %.4f\tof means of %d x %d %.5f\t%s\n",
               method, paired_relmse(&im, ref, ref), BLOCK, BLOCK,
               paired_relmse(&blocks, even, even), says);
    fflush(stdout);
    image_clear(&im);
    image_clear(&blocks);
}

void bench_moves_strata(void)
{
    Image ref = { 0 }, even = { 0 };

    if (dragon_by("path", 4096, 101, &ref) && means_of_blocks(&ref, &even)) {
        uneven("mlt:mutations=2", &ref, &even, "8.12 middle: \"more bright artifacts\"");
        uneven("erpt:mutations=1", &ref, &even, "8.12 right: \"more faithfully\"");
        uneven("path", &ref, &even, "");
    }
    image_clear(&ref);
    image_clear(&even);
}

/* ---- the document's figures ---- */

void bench_moves_figures(void)
{
    static const Contest zoom = { "scenes/s5.pbrt", 1024, 1024, { 640, 760, 704, 824 }, "path", 30,
                                  3 },
                         ball = { "scenes/three-spheres.pbrt", 96, 64, { 0 }, "bdpt", 20, 3 },
                         gallery = { "scenes/gallery.pbrt", 96, 64, { 0 }, "bdpt", 20, 3 },
                         weight = { "scenes/paperweight.pbrt", 96, 64, { 0 }, "pssmlt", 20, 3 };
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
