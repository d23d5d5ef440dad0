/* indirect.c -- caches and photon maps after equal time: error against two references by path,
 * whose own noise cancels (see paired_relmse); and the three spheres by every method, on one
 * sheet. */
#include "bench/bench.h"

#include <stdio.h>
#include <string.h>

typedef struct {
    const char *scene, *method;
    double seconds;             /* CPU-seconds */
    const char *asked;
} Case;

/* Root of mean squares over the mean, free of the references' noise. */
static double sigma_over_mu(const Image *a, const Image *r, const Image *q)
{
    size_t n = (size_t)a->w * a->h;
    double sum = 0, mean = 0;

    for (size_t i = 0; i < n; i++) {
        double x = (double)rgb_lum(a->pixels[i]);
        sum += (x - (double)rgb_lum(r->pixels[i])) * (x - (double)rgb_lum(q->pixels[i]));
        mean += (double)rgb_lum(q->pixels[i]);
    }
    return sqrt(d_max(sum, 0) * (double)n) / mean;
}

static double mean_ratio(const Image *a, const Image *r, const Image *q)
{
    double own = 0, truth = 0;

    for (size_t i = 0; i < (size_t)a->w * a->h; i++) {
        own += (double)rgb_lum(a->pixels[i]);
        truth += 0.5 * ((double)rgb_lum(r->pixels[i]) + (double)rgb_lum(q->pixels[i]));
    }
    return own / truth;
}

/* Rows of the picture from this one on: 0, or below the lamp. */
static bool rendered(const Case *c, uint32_t from_row, uint32_t spp, uint64_t seed, Image *im,
                     RenderReport *r)
{
    RenderRequest q;

    memset(&q, 0, sizeof q);
    q.integrator = c->method;
    q.spp = spp;
    q.threads = processors();
    q.seed = seed;
    q.crop_given = from_row > 0;
    q.crop[1] = from_row;
    q.crop[2] = q.crop[3] = 256;
    return bench_picture(c->scene, &q, im, r);
}

static bool references(const char *scene, uint32_t from_row, uint32_t spp, Image ref[2])
{
    Case path = { scene, "path", 0, "" };
    RenderReport r;

    return rendered(&path, from_row, spp, 77, &ref[0], &r) &&
           rendered(&path, from_row, spp, 78, &ref[1], &r);
}

/* As many samples as take so many CPU-seconds, of which some come before the first; at least 1. */
static uint32_t samples_for(const Case *c, uint32_t from_row)
{
    enum { FEW = 2, MORE = 10 };
    RenderReport few, more;
    double each;

    if (!rendered(c, from_row, FEW, 5, NULL, &few) || !rendered(c, from_row, MORE, 5, NULL, &more))
        return 0;
    each = d_max(1e-4, (more.cpu_seconds - few.cpu_seconds) / (MORE - FEW));
    return (uint32_t)d_max(1, FEW + (c->seconds - few.cpu_seconds) / each);
}

static void after(const Case *c, const Image ref[2])
{
    uint32_t spp = samples_for(c, 0);
    Image im = { 0 };
    RenderReport r;

    if (spp && rendered(c, 0, spp, 1, &im, &r))
        printf("indirect\t%s\t%s\tspp %lu\tCPU-seconds %.1f\trelMSE %.5f\tmean %.4f\t%s\n",
               c->scene, c->method, (unsigned long)spp, r.cpu_seconds,
               paired_relmse(&im, &ref[0], &ref[1]), mean_ratio(&im, &ref[0], &ref[1]), c->asked);
    fflush(stdout);
    image_clear(&im);
}

static void row(const Case *c, uint32_t spp, const RenderReport *r, const Image *im,
                const Image ref[2])
{
    printf("indirect\t%s, without its lamp\t%s\tspp %lu\tCPU-seconds %.2f\tsigma/mu %.4f\t%s\n",
           c->scene, c->method, (unsigned long)spp, r->cpu_seconds,
           sigma_over_mu(im, &ref[0], &ref[1]), c->asked);
}

/* The gather in a third of the time that path takes for 64 samples a pixel. The lamp is left out:
 * its edges are as rough as samples are few, whatever shows what is inside of them. */
static void gather_or_paths(void)
{
    enum { BELOW = 64 };
    Case path = { "scenes/s4.pbrt", "path", 0, "" };
    Case gather = { "scenes/s4.pbrt", "photonmap:gather=4,photons=20000", 0,
                    "asked: no more in a third of the time" };
    Image ref[2] = { { 0 }, { 0 } }, im = { 0 };
    RenderReport r;
    uint32_t spp;

    if (references(path.scene, BELOW, 256, ref) && rendered(&path, BELOW, 64, 1, &im, &r)) {
        row(&path, 64, &r, &im, ref);
        gather.seconds = r.cpu_seconds / 3;
        image_clear(&im);
        spp = samples_for(&gather, BELOW);
        if (spp && rendered(&gather, BELOW, spp, 1, &im, &r))
            row(&gather, spp, &r, &im, ref);
    }
    image_clear(&im);
    image_clear(&ref[0]);
    image_clear(&ref[1]);
}

void bench_indirect(void)
{
    static const Case diffuse[] = {
        { "scenes/s4.pbrt", "irradiancecache", 1.8, "Mitsuba after 3.6 s: 0.0003" },
        { "scenes/s4.pbrt", "irradiancecache", 3.6, "Mitsuba after 3.6 s: 0.0003" },
    }, caustic[] = {
        { "scenes/s5.pbrt", "path", 20, "Mitsuba 0.027" },
        { "scenes/s5.pbrt", "sppm", 20, "Mitsuba 0.0024" },
        { "scenes/s5.pbrt", "photonmap", 20, "Mitsuba 0.0037; asked 0.003" },
        { "scenes/s5.pbrt", "irradiancecache:photons=300000,caustics=300000", 20,
          "Mitsuba 0.0021" },
    };
    Image ref[2] = { { 0 }, { 0 } };

    gather_or_paths();
    if (references("scenes/s4.pbrt", 0, 256, ref))
        for (size_t i = 0; i < sizeof diffuse / sizeof *diffuse; i++)
            after(&diffuse[i], ref);
    image_clear(&ref[0]);
    image_clear(&ref[1]);
    if (references("scenes/s5.pbrt", 0, 640, ref))
        for (size_t i = 0; i < sizeof caustic / sizeof *caustic; i++)
            after(&caustic[i], ref);
    image_clear(&ref[0]);
    image_clear(&ref[1]);
}

/* ---- a sheet ---- */

enum { WIDE = 240, HIGH = 160, COLUMNS = 4, METHODS_MOST = 64, SAMPLES = 16 };

/* In the order of the list. */
void bench_methods(void)
{
    static Image im[METHODS_MOST];
    uint32_t n = 0;

    for (size_t k = 0; kind_info(integrators, k) && n < METHODS_MOST; k++) {
        const char *name = kind_info(integrators, k)->name;
        RenderRequest q;
        RenderReport r;
        memset(&q, 0, sizeof q);
        q.integrator = name;
        q.w = WIDE;
        q.h = HIGH;
        q.spp = SAMPLES;
        q.threads = processors();
        if (!bench_picture("scenes/three-spheres.pbrt", &q, &im[n], &r))
            break;
        n++;
        printf("methods\t%lu\t%s\tspp %.0f\tCPU-seconds %.1f\n", (unsigned long)n, name, r.spp,
               r.cpu_seconds);
        fflush(stdout);
    }
    if (n && sheet_of(im, n, COLUMNS, WIDE, HIGH, "three-spheres.png"))
        printf("methods\tthree-spheres.png has them in rows of %d\n", COLUMNS);
    for (uint32_t k = 0; k < n; k++)
        image_clear(&im[k]);
}
