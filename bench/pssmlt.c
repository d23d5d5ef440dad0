/* pssmlt.c -- chains of samples against the samples alone: error at equal time, and speed.
 *
 * Error       relMSE against two independent references, whose noise falls out (paired_relmse);
 *             the CPU time of each run is what was asked for, but for a tenth, to which
 *             the figure is scaled. `worst` is the largest share of the error that a pixel has:
 *             near 1, it rules the picture.
 * References  By a method that finds all the light of the scene, of several times the time. */
#include "bench/bench.h"

#include <stdio.h>
#include <string.h>

typedef struct { const char *scene, *truth; uint32_t w, h; double seconds, times; } Field;

static bool picture(const Field *f, const char *method, uint32_t spp, uint64_t seed, Image *im,
                    RenderReport *r)
{
    RenderRequest q;

    memset(&q, 0, sizeof q);
    q.integrator = method;
    q.spp = spp;
    q.w = f->w;
    q.h = f->h;
    q.threads = processors();
    q.seed = seed;
    return bench_picture(f->scene, &q, im, r);
}

/* A picture of so many CPU-seconds: first a short one, to know what a sample takes. */
static bool timed(const Field *f, const char *method, double seconds, uint64_t seed, Image *im,
                  RenderReport *r)
{
    enum { TRIAL = 16 };

    return picture(f, method, TRIAL, seed, NULL, r) &&
           picture(f, method, (uint32_t)d_max(1, TRIAL * seconds / r->cpu_seconds + 0.5), seed, im,
                   r);
}

/* The largest share that a pixel has of the squared relative error. */
static double worst(const Image *a, const Image *r)
{
    double sum = 0, most = 0;

    for (size_t i = 0; i < (size_t)a->w * a->h; i++) {
        double x = rgb_lum(a->pixels[i]), y = rgb_lum(r->pixels[i]);
        double e = (x - y) * (x - y) / (y * y + 0.01);
        sum += e;
        most = d_max(most, e);
    }
    return most / sum;
}

static void line(const Field *f, const Image ref[2], const char *method, const char *asked)
{
    RenderReport r;
    Image im;

    if (!timed(f, method, f->seconds, 1, &im, &r))
        return;
    printf("pssmlt\t%-24s%-28s%7.1f samples a pixel  relMSE %.5f  worst %.3f\t%s\n", f->scene + 7,
           method, r.spp, paired_relmse(&im, &ref[0], &ref[1]) * r.cpu_seconds / f->seconds,
           worst(&im, &ref[0]), asked);
    fflush(stdout);
    image_clear(&im);
}

static void compare(const Field *f, const char *const *methods, const char *asked)
{
    Image ref[2] = { { 0 }, { 0 } };
    RenderReport r;

    if (timed(f, f->truth, f->times * f->seconds, 1000, &ref[0], &r) &&
        timed(f, f->truth, f->times * f->seconds, 2000, &ref[1], &r))
        for (int k = 0; methods[k]; k++)
            line(f, ref, methods[k], strncmp(methods[k], "pssmlt", 6) ? "" : asked);
    image_clear(&ref[0]);
    image_clear(&ref[1]);
}

static void speed(const char *method, const char *asked)
{
    static const Field f = { "scenes/s5.pbrt", "", 256, 256, 0, 0 };
    RenderReport r;

    if (picture(&f, method, 8, 0, NULL, &r))
        printf("pssmlt\t%-24s%-28s%.3f million samples or steps a CPU-second\t%s\n", f.scene + 7,
               method, (double)r.samples * 1e-6 / r.cpu_seconds, asked);
    fflush(stdout);
}

void bench_pssmlt(void)
{
    static const char *const all[] = { "path", "bdpt", "pssmlt:over=path", "pssmlt", NULL };
    static const Field s5 = { "scenes/s5.pbrt", "bdpt", 256, 256, 20, 2 };
    static const Field s0 = { "scenes/s0.pbrt", "vcm", 256, 256, 20, 2 };
    static const Field s2 = { "scenes/s2.pbrt", "vcm", 256, 256, 20, 2 };
    static const Field glass = { "scenes/paperweight.pbrt", "pssmlt", 120, 80, 10, 2 };
    static const Field door = { "scenes/ajar-door.pbrt", "pssmlt", 120, 80, 10, 2 };

    speed("path", "");
    speed("bdpt", "");
    speed("pssmlt:over=path,direct=0", "");
    speed("pssmlt:direct=0", "asked for 0.5 million");
    compare(&s5, all, "asked for 0.008, aim 0.005; the best peer 0.0107");
    compare(&s0, all, "asked for 0.05, aim 0.02");
    compare(&s2, all, "asked for 0.05, aim 0.02");
    compare(&glass, all, "asked for a third of path's error: relMSE a ninth");
    compare(&door, all, "asked for a third of path's error: relMSE a ninth");
}
