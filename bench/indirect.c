/* indirect.c -- caches and photon maps after equal time: error against two references by path, whose
 * own noise cancels (see paired_relmse); and the three spheres by every method, on one sheet. */
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

static bool references(const char *scene, uint32_t spp, Image ref[2])
{
    RenderReport r;

    for (uint64_t k = 0; k < 2; k++)
        if (!bench_render(scene, "path", NULL, 0, spp, processors(), 77 + k, &ref[k], &r))
            return false;
    return true;
}

/* As many samples as take so many CPU-seconds, of which some come before the first; at least 1. */
static uint32_t samples_for(const Case *c)
{
    enum { FEW = 2, MORE = 10 };
    RenderReport few, more;
    double each;

    if (!bench_render(c->scene, c->method, NULL, 0, FEW, processors(), 5, NULL, &few) ||
        !bench_render(c->scene, c->method, NULL, 0, MORE, processors(), 5, NULL, &more))
        return 0;
    each = d_max(1e-4, (more.cpu_seconds - few.cpu_seconds) / (MORE - FEW));
    return (uint32_t)d_max(1, FEW + (c->seconds - few.cpu_seconds) / each);
}

static void after(const Case *c, const Image ref[2])
{
    uint32_t spp = samples_for(c);
    Image im = { 0 };
    RenderReport r;

    if (spp && bench_render(c->scene, c->method, NULL, 0, spp, processors(), 1, &im, &r))
        printf("indirect\t%s\t%s\tspp %lu\tCPU-seconds %.1f\trelMSE %.5f\tmean %.4f\t%s\n",
               c->scene, c->method, (unsigned long)spp, r.cpu_seconds,
               paired_relmse(&im, &ref[0], &ref[1]), mean_ratio(&im, &ref[0], &ref[1]), c->asked);
    fflush(stdout);
    image_clear(&im);
}

/* The gather in a third of the time that path takes for 64 samples a pixel. */
static void gather_or_paths(const Image ref[2])
{
    Case gather = { "scenes/s4.pbrt", "photonmap:caustics=0,gather=4,photons=50000", 0,
                    "sigma/mu no higher than that" };
    Image path = { 0 };
    RenderReport r;

    if (bench_render(gather.scene, "path", NULL, 0, 64, processors(), 1, &path, &r)) {
        Image im = { 0 };
        double sigma = sigma_over_mu(&path, &ref[0], &ref[1]), seconds = r.cpu_seconds;
        uint32_t spp;
        gather.seconds = seconds / 3;
        spp = samples_for(&gather);
        if (spp && bench_render(gather.scene, gather.method, NULL, 0, spp, processors(), 1, &im, &r))
            printf("indirect\t%s\tpath, 64 samples: %.2f CPU-seconds, sigma/mu %.4f\t%s, %lu "
                   "samples: %.2f CPU-seconds, sigma/mu %.4f; asked: %.4f in %.2f\n", gather.scene,
                   seconds, sigma, gather.method, (unsigned long)spp, r.cpu_seconds,
                   sigma_over_mu(&im, &ref[0], &ref[1]), sigma, seconds / 3);
        image_clear(&im);
    }
    image_clear(&path);
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

    if (references("scenes/s4.pbrt", 512, ref)) {
        gather_or_paths(ref);
        for (size_t i = 0; i < sizeof diffuse / sizeof *diffuse; i++)
            after(&diffuse[i], ref);
    }
    image_clear(&ref[0]);
    image_clear(&ref[1]);
    if (references("scenes/s5.pbrt", 1024, ref))
        for (size_t i = 0; i < sizeof caustic / sizeof *caustic; i++)
            after(&caustic[i], ref);
    image_clear(&ref[0]);
    image_clear(&ref[1]);
}

/* ---- a sheet ---- */

enum { WIDE = 300, COLUMNS = 4, METHODS_MOST = 64, SAMPLES = 64 };

/* In the order of the list. Photons that fly about until the lens counts them get more time. */
void bench_methods(void)
{
    static Image im[METHODS_MOST];
    uint32_t n = 0;

    for (size_t k = 0; kind_info(integrators, k) && n < METHODS_MOST; k++) {
        const char *name = kind_info(integrators, k)->name;
        RenderReport r;
        if (!bench_render("scenes/three-spheres.pbrt", name, NULL, WIDE, SAMPLES, processors(), 1,
                          &im[n], &r))
            break;
        n++;
        printf("methods\t%lu\t%s\tspp %.0f\tCPU-seconds %.1f\n", (unsigned long)n, name, r.spp,
               r.cpu_seconds);
        fflush(stdout);
    }
    if (n && sheet_of(im, n, COLUMNS, WIDE, WIDE, "three-spheres.png"))
        printf("methods\tthree-spheres.png has them in rows of %d\n", COLUMNS);
    for (uint32_t k = 0; k < n; k++)
        image_clear(&im[k]);
}
