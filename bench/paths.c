/* paths.c -- path tracing: throughput, and error against a reference. */
#include "bench/bench.h"
#include "image/compare.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Many short runs: other work on the machine only ever makes one slower, so the best of them is
 * what the program can do, and the median what it did. */
enum { RUNS = 15 };

bool bench_text_picture(const char *name, const char *text, const RenderRequest *asked, Image *im,
                        RenderReport *report)
{
    ReadLimits limits = READ_LIMITS_DEFAULT;
    RenderRequest q = *asked;
    RenderSettings s;
    SceneFile f;
    Film film;
    bool ok;

    q.seed_given = true;
    q.max_pixels = limits.max_pixels;
    if (text ? !scenefile_parse(&f, name, text, strlen(text), &limits)
             : !scenefile_read(&f, name, &limits))
        return false;
    ok = settings_resolve(&s, &q, &f) && scene_build(f.scene, s.accel, &s.accel_opts, q.threads) &&
         render(f.scene, &s, &film, report);
    if (ok) {
        ok = !im || image_init(im, film.w, film.h);
        if (ok && im)
            film_picture(&film, s.naovs ? 1 : 0, im);
        film_clear(&film);
    }
    scenefile_clear(&f);
    return ok;
}

bool bench_picture(const char *scene, const RenderRequest *asked, Image *im, RenderReport *report)
{
    return bench_text_picture(scene, NULL, asked, im, report);
}

bool bench_render(const char *scene, const char *integrator, const char *sampler, uint32_t side,
                  uint32_t spp, int threads, uint64_t seed, Image *im, RenderReport *report)
{
    RenderRequest q;

    memset(&q, 0, sizeof q);
    q.integrator = integrator;
    q.sampler = sampler;
    q.spp = spp;
    q.w = q.h = side;
    q.threads = threads;
    q.seed = seed;
    return bench_picture(scene, &q, im, report);
}

static double most(const double *v, int n)
{
    double m = v[0];
    for (int i = 1; i < n; i++)
        m = v[i] > m ? v[i] : m;
    return m;
}

static void throughput(const char *scene, const char *integrator, const char *sampler,
                       const char *peer)
{
    double paths[RUNS], rays[RUNS];
    RenderReport r;

    for (int k = -1; k < RUNS; k++) {
        if (!bench_render(scene, integrator, sampler, 0, 8, 1, 0, NULL, &r))
            return;
        if (k >= 0) {
            paths[k] = (double)r.samples * 1e-6 / r.cpu_seconds;
            rays[k] = (double)r.rays * 1e-6 / r.cpu_seconds;
        }
    }
    printf("paths\t%s\t%s\t%s\tMpaths a CPU-second: best %.3f, median %.3f\t"
           "Mrays a CPU-second: best %.2f, median %.2f\t%s\n", scene, integrator, sampler,
           most(paths, RUNS), median(paths, RUNS), most(rays, RUNS), median(rays, RUNS), peer);
}

/* Roulette from the first bounce and independent samples are what the SmallVCM program has; Mitsuba
 * waits for the fifth bounce. */
void bench_paths(void)
{
    throughput("scenes/s5.pbrt", "path:maxdepth=9,roulette=1", "random", "peer: SmallVCM 0.79");
    throughput("scenes/s5.pbrt", "path:maxdepth=9,roulette=1", "zerotwo", "");
    throughput("scenes/s5.pbrt", "path:maxdepth=9,roulette=5", "random", "peer: Mitsuba 0.6 1.03");
    throughput("scenes/s5.pbrt", "path:maxdepth=9,roulette=5", "zerotwo", "");
    throughput("scenes/s5.pbrt", "path", "zerotwo", "beside the next");
    throughput("scenes/s5.pbrt", "sppm", "zerotwo", "a path of the eye and a photon's: asked for "
               "half of the above");
    throughput("scenes/s5.pbrt", "bdpt:roulette=1", "random", "asked 0.6; peer: SmallVCM 0.30");
    throughput("scenes/s5.pbrt", "vcm:roulette=1", "random", "asked 0.5; peer: SmallVCM 0.24");
    throughput("scenes/s4.pbrt", "path:maxdepth=9", "zerotwo", "");
    throughput("scenes/cornell.pbrt", "path:maxdepth=12", "zerotwo", "");
}

double paired_relmse(const Image *a, const Image *r, const Image *q)
{
    double sum = 0;
    size_t n = (size_t)a->w * a->h;

    for (size_t i = 0; i < n; i++) {
        const float *x = &a->pixels[i].r, *y = &r->pixels[i].r, *z = &q->pixels[i].r;
        for (int k = 0; k < 3; k++)
            sum += ((double)x[k] - y[k]) * ((double)x[k] - z[k]) / ((double)y[k] * y[k] + 0.01);
    }
    return sum / (3.0 * (double)n);
}

/* Error falls as one over the number of samples (faster for stratified ones): so it is measured at
 * the count that 20 CPU-seconds allow. The second reference is our own, of another seed. */
static void error_after(const char *scene, const char *reference, const char *peer)
{
    const char *root = getenv("RUSHLIGHT_DATA");
    Image im = { 0 }, ref = { 0 }, own = { 0 };
    char path[600];
    ImageDifference d;
    RenderReport r, unused;
    uint32_t spp;

    snprintf(path, sizeof path, "%s/%s", root ? root : "../shared/data", reference);
    if (bench_render(scene, NULL, NULL, 0, 16, 1, 0, NULL, &r) &&
        image_read(&ref, path, IMAGE_PIXELS_DEFAULT)) {
        spp = (uint32_t)(16 * 20.0 / r.cpu_seconds);
        if (bench_render(scene, NULL, NULL, 0, spp, processors(), 0, &im, &r) &&
            bench_render(scene, NULL, NULL, 0, 4 * spp, processors(), 99, &own, &unused) &&
            image_compare(&im, scene, &ref, path, &d)) {
            double e = paired_relmse(&im, &ref, &own);
            printf("error\t%s\tspp %lu\tCPU-seconds %.1f\trelMSE %.6f\tscaled to 20 s %.6f\t"
                   "mean ratio %.5f\t%s\n", scene, (unsigned long)spp, r.cpu_seconds, e,
                   e * r.cpu_seconds / 20, d.ratio, peer);
        }
    }
    image_clear(&im);
    image_clear(&ref);
    image_clear(&own);
}

void bench_error(void)
{
    error_after("scenes/s4.pbrt", "smallvcm-s4.pfm", "peers: Cycles 0.0007, Mitsuba 0.0008");
    error_after("scenes/s1.pbrt", "smallvcm-s1.pfm", "peers: Mitsuba 0.0393");
}
