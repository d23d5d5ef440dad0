/* triple.c -- figures 6.7 and 6.8 of the document: what maps of visibility add to two stage
 * importance sampling.
 *
 * Error is sigma/mu [Cline07 (4.13)] without the noise of the reference: for two references r and q
 * that know nothing of each other, by different methods, the mean of (a - r)(a - q) has the
 * expectation of the squared error. It is told for all pixels and for the darker half of them by
 * itself, over the mean of those. "equal time" is two stage's error over the method's own, if both
 * had the same CPU seconds: sigma falls as one over the root of time, so it is
 * sqrt(t e^2 of two stage / t e^2). Seconds hold the making of maps, but not the reading of files
 * nor the building of trees. Curves go to build/triple-*.svg. */
#include "bench/bench.h"
#include "bench/report.h"

#include "base/mem.h"
#include "render/plot.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { SIDE = 128, LOOKS = 3, METHODS_MOST = 8, ROUNDS = 2 };

typedef struct { const char *label, *integrator; } Method;

/* At 1, 2, 4 ... samples a pixel: seconds, squared errors of all pixels and of the dark ones. */
typedef struct { double seconds[LOOKS], error[2][LOOKS], mean; } Result;

typedef struct {
    Image r, q;                         /* references */
    unsigned char *dark;                /* of each pixel */
    double mean[2];                     /* of all, of the dark ones */
} Reference;

static int by_size(const void *a, const void *b)
{
    float x = *(const float *)a, y = *(const float *)b;
    return (x > y) - (x < y);
}

static double lum_at(const Reference *t, size_t i)
{
    return 0.5 * ((double)rgb_lum(t->r.pixels[i]) + (double)rgb_lum(t->q.pixels[i]));
}

static bool split_dark(Reference *t)
{
    size_t n = (size_t)t->r.w * t->r.h, dark = 0;
    float *lum = MEM_ARRAY(float, n);

    t->dark = MEM_ARRAY(unsigned char, n);
    if (!lum || !t->dark)
        return false;
    for (size_t i = 0; i < n; i++)
        lum[i] = (float)lum_at(t, i);
    qsort(lum, n, sizeof lum[0], by_size);
    t->mean[0] = t->mean[1] = 0;
    for (size_t i = 0; i < n; i++) {
        t->dark[i] = (float)lum_at(t, i) <= lum[n / 2];
        t->mean[0] += lum_at(t, i) / (double)n;
        t->mean[1] += t->dark[i] ? lum_at(t, i) : 0;
        dark += t->dark[i];
    }
    t->mean[1] /= (double)dark;
    mem_free(lum);
    return true;
}

/* By luminance, over the squared mean. */
static double squared_error(const Image *a, const Reference *t, bool dark, double *mean)
{
    size_t n = (size_t)a->w * a->h, count = 0;
    double sum = 0;

    *mean = 0;
    for (size_t i = 0; i < n; i++) {
        double x = (double)rgb_lum(a->pixels[i]);
        if (dark && !t->dark[i])
            continue;
        sum += (x - (double)rgb_lum(t->r.pixels[i])) * (x - (double)rgb_lum(t->q.pixels[i]));
        *mean += x;
        count++;
    }
    *mean /= (double)count * t->mean[dark];
    return sum / (double)count / (t->mean[dark] * t->mean[dark]);
}

static bool measure(const char *scene, const Method *m, const Reference *t, Result *res)
{
    memset(res, 0, sizeof *res);
    for (int k = 0; k < LOOKS; k++) {
        double least = 1e30, mean;
        for (int round = 0; round < ROUNDS; round++) {
            Image im = { 0 };
            RenderReport r;
            if (!bench_render(scene, m->integrator, NULL, SIDE, 1u << k, 1, (uint64_t)round, &im,
                              &r))
                return false;
            least = r.cpu_seconds < least ? r.cpu_seconds : least;
            for (int dark = 1; dark >= 0; dark--)
                res->error[dark][k] += squared_error(&im, t, dark, &mean) / ROUNDS;
            if (k == LOOKS - 1)
                res->mean += mean / ROUNDS;
            image_clear(&im);
        }
        res->seconds[k] = least;
    }
    return true;
}

static void print(const char *name, const Method *m, const Result *r, const Result *first)
{
    for (int k = 0; k < LOOKS; k++) {
        printf("%s\t%-22s\tspp %d\tCPU s %6.2f\tsigma/mu %.4f\tdark half %.4f\tequal time: %.2f, "
               "dark half %.2f", name, m->label, 1 << k, r->seconds[k], sqrt(r->error[0][k]),
               sqrt(r->error[1][k]),
               sqrt(first->seconds[k] * first->error[0][k] / (r->seconds[k] * r->error[0][k])),
               sqrt(first->seconds[k] * first->error[1][k] / (r->seconds[k] * r->error[1][k])));
        if (k == LOOKS - 1)
            printf("\tmean %.4f", r->mean);
        printf("\n");
    }
    fflush(stdout);
}

static void draw(const char *name, const Method *m, const Result *r, int n)
{
    static const char *const what[2] = { "sigma/mu", "sigma/mu of the darker half" };
    double root[2][METHODS_MOST][LOOKS];
    PlotCurve curve[2][METHODS_MOST];
    PlotPanel panel[2];
    char path[100];

    memset(panel, 0, sizeof panel);
    memset(curve, 0, sizeof curve);
    for (int dark = 0; dark < 2; dark++) {
        for (int i = 0; i < n; i++) {
            for (int k = 0; k < LOOKS; k++)
                root[dark][i][k] = sqrt(r[i].error[dark][k]);
            curve[dark][i] = (PlotCurve){ m[i].label, NULL, r[i].seconds, root[dark][i], LOOKS };
        }
        panel[dark] = (PlotPanel){ "CPU seconds", what[dark], curve[dark], n, 0, NULL };
    }
    snprintf(path, sizeof path, "build/triple-%s.svg", name);
    if (plot_write(path, name, panel, 2))
        report_picture(path);
}

/* m[0] is two stage, by which all are measured. */
static void figure(const char *name, const char *scene, const Method *m, int n)
{
    const char *triple = "direct:strategy=triple,samples=32,maxdepth=1";
    const char *two = "direct:strategy=twostage,samples=32,maxdepth=1";
    Result r[METHODS_MOST];
    RenderReport report;
    Reference t;
    bool ok;

    memset(&t, 0, sizeof t);
    ok = bench_render(scene, triple, NULL, SIDE, 32, processors(), 1001, &t.r, &report) &&
         bench_render(scene, two, NULL, SIDE, 32, processors(), 1002, &t.q, &report) &&
         split_dark(&t);
    for (int i = 0; ok && i < n; i++) {
        ok = measure(scene, &m[i], &t, &r[i]);
        if (ok)
            print(name, &m[i], &r[i], &r[0]);
    }
    if (ok)
        draw(name, m, r, n);
    image_clear(&t.r);
    image_clear(&t.q);
    mem_free(t.dark);
}

void bench_triple(void)
{
    static const Method all[] = {
        { "two stage", "direct:strategy=twostage,samples=32,maxdepth=1" },
        { "triple", "direct:strategy=triple,samples=32,maxdepth=1" },
        { "triple lazy", "direct:strategy=triple,samples=32,maxdepth=1,lazy=true" },
        { "triple, world", "direct:strategy=triple,samples=32,maxdepth=1,space=world" },
        { "triple biased", "direct:strategy=triple,samples=32,maxdepth=1,biased=true" },
        { "triple biased, world",
          "direct:strategy=triple,samples=32,maxdepth=1,biased=true,space=world" },
        { "triple, specks dim", "direct:strategy=triple,samples=32,maxdepth=1,dim=true" },
    };
    printf("# said: unbiased preimage about half the error of two stage at equal time, more in low "
           "light;\n# preimage better than world space; lazy about the same\n");
    figure("hare", "scenes/hare.pbrt", all, 7);
    printf("# said: a good gain without bump maps\n");
    figure("colonnade", "scenes/colonnade.pbrt", all, 3);
    printf("# said: little gain with bump maps, but no worse\n");
    figure("colonnade-bumps", "scenes/colonnade-bumps.pbrt", all, 3);
}
