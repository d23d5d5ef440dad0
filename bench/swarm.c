/* swarm.c -- sample swarming: table 9.2 of [Cline07], and what it costs.
 *
 * Error is sigma/mu: the root of the mean squared difference of two independent pictures, over
 * sqrt(2) and over their mean; no reference is needed. Where the document chooses evenly between
 * lights, and between reflecting and refracting, so do both methods here, and skies are asked for
 * all of their light; what our path tracing does by itself stands beside it as `path`. The scenes
 * are ours, made after the figures. */
#include "bench/bench.h"
#include "image/compare.h"

#include <stdio.h>
#include <string.h>

typedef struct { double error, seconds; } Measured;

/* w and h 0: the size that the scene says; sampler NULL: the default. */
static bool measure_by(const char *sampler, const char *scene, const char *method, uint32_t spp,
                       uint32_t w, uint32_t h, Measured *m)
{
    double squares = 0, sum = 0;
    Image im[2];

    m->seconds = 0;
    for (int k = 0; k < 2; k++) {
        RenderRequest q;
        RenderReport r;
        memset(&q, 0, sizeof q);
        q.integrator = method;
        q.sampler = sampler;
        q.spp = spp;
        q.w = w;
        q.h = h;
        q.threads = processors();
        q.seed = (uint64_t)k + 1;
        if (!bench_picture(scene, &q, &im[k], &r))
            return false;
        m->seconds += 0.5 * r.cpu_seconds;
    }
    for (size_t i = 0; i < (size_t)im[0].w * im[0].h; i++) {
        double a = rgb_lum(im[0].pixels[i]), b = rgb_lum(im[1].pixels[i]);
        squares += (a - b) * (a - b);
        sum += a + b;
    }
    m->error = sqrt(0.5 * squares / ((double)im[0].w * im[0].h)) /
               (0.5 * sum / ((double)im[0].w * im[0].h));
    image_clear(&im[0]);
    image_clear(&im[1]);
    return true;
}

static bool measure(const char *scene, const char *method, uint32_t spp, uint32_t w, uint32_t h,
                    Measured *m)
{
    return measure_by(NULL, scene, method, spp, w, h, m);
}

/* The error that path tracing would have in the time of the other: at N^-1/2. */
static double at_equal_time(const Measured *path, const Measured *swarm)
{
    return path->error * sqrt(path->seconds / swarm->seconds) / swarm->error;
}

typedef struct {
    const char *map, *scene;
    uint32_t spp;
    double path, swarm;         /* as printed; 0: it is not */
    const char *by_path, *by_swarm, *by_itself; /* the document's path tracing; swarming; ours */
} Row;

static const Row rows[] = {
    { "time", "swarm-time", 16, 1.045, 0.207, "path", "swarm:band=64,direction=0,point=0,light=0,"
      "time=128", "path" },
    { "lens", "swarm-lens", 32, 3.185, 0.539, "path", "swarm:band=64,direction=0,point=0,light=0",
      "path" },
    { "direction", "swarm-caustic", 32, 2.025, 0.822, "path:maxdepth=4",
      "swarm:band=64,maxdepth=4,point=0,light=0,direction=64,share=0.7", "path:maxdepth=4" },
    { "light", "swarm-lights", 6, 0.904, 0.312, "path:lightsampler=uniform",
      "swarm:band=64,lightsampler=uniform,direction=0", "path" },
    { "bifurcation", "swarm-glass", 16, 3.924, 0.920,
      "swarm:band=64,coin=true,share=0,maxdepth=12,direction=0,point=0,light=0",
      "swarm:band=64,coin=true,maxdepth=12,direction=0,point=0,light=0,share=0.9",
      "path:maxdepth=12" },
    { "distance", "swarm-fog", 32, 4.944, 1.481, "path:lightsampler=uniform,maxdepth=1",
      "swarm:band=64,lightsampler=uniform,maxdepth=1", "path:maxdepth=1" },
    { "point", "swarm-probe", 32, 0.429, 0.166, "path:sky=all",
      "swarm:band=64,sky=all,direction=0,point=64,share=0.75", "path" },
};
static const Row large[] = {
    { "fig. 9.11", "hare", 64, 0, 0, "path:maxdepth=10", "swarm:maxdepth=10,light=0",
      "path:maxdepth=10" },
    { "fig. 9.12", "paperweight", 256, 0, 0, "path:maxdepth=16",
      "swarm:maxdepth=16,point=0,light=0",
      "path:maxdepth=16" },
    { "fig. 9.13", "glasses", 128, 0, 0, "path:maxdepth=24", "swarm:maxdepth=24,point=0,light=0",
      "path:maxdepth=24" },
    { "fig. 9.14", "iguana", 64, 0, 0, "path:maxdepth=8", "swarm:maxdepth=8,direction=0",
      "path:maxdepth=8" },
};

static bool table_row(const Row *r, uint32_t w, uint32_t h)
{
    Measured path, swarm, own;
    char scene[80];

    snprintf(scene, sizeof scene, "scenes/%s.pbrt", r->scene);
    if (!measure(scene, r->by_path, r->spp, w, h, &path) ||
        !measure(scene, r->by_swarm, r->spp, w, h, &swarm) ||
        !measure(scene, r->by_itself, r->spp, w, h, &own))
        return false;
    printf("%s\t%s\t%lu", r->map, r->scene, (unsigned long)r->spp);
    if (r->path > 0)
        printf("\t%.3f\t%.3f\t%.1f", r->path, r->swarm, r->path / r->swarm);
    printf("\t%.3f\t%.3f\t%.2f\t%.2f\t%.3f\t%.2f\t%.2f\n", path.error, swarm.error,
           path.error / swarm.error, at_equal_time(&path, &swarm), own.error,
           own.error / swarm.error, at_equal_time(&own, &swarm));
    fflush(stdout);
    return true;
}

/* How many samples path tracing needs for the error of the lens map, by doubling. A sampler whose
 * samples are spread evenly over the lens leaves less for the map to gain. */
static void lens_fold(const char *sampler)
{
    const char *scene = "scenes/swarm-lens.pbrt";
    Measured swarm, path, last = { 0, 0 };
    uint32_t spp = 64, most = 8192;
    double slope;

    if (!measure_by(sampler, scene, rows[1].by_swarm, 32, 0, 0, &swarm) ||
        !measure_by(sampler, scene, "path", spp, 0, 0, &path))
        return;
    do {
        last = path;
        spp *= 2;
        if (!measure_by(sampler, scene, "path", spp, 0, 0, &path))
            return;
    } while (path.error > swarm.error && spp < most);
    /* between the last two counts the error goes by a power of the count */
    slope = log(last.error / path.error) / log(2.0);
    printf("lens map, %s: path tracing has its error %.3f at %.1f times the samples\tprinted: over "
           "18\n", sampler, swarm.error,
           spp / 64.0 * pow(last.error / swarm.error, 1.0 / slope));
    fflush(stdout);
}

/* What maps cost a pixel: the least time of several runs by turns, at equal samples. */
static void cost(const char *scene, const char *path, const char *swarm, uint32_t spp, uint32_t w,
                 uint32_t h)
{
    enum { RUNS = 5 };
    Measured a, b, least_a, least_b;
    char name[80];

    snprintf(name, sizeof name, "scenes/%s.pbrt", scene);
    for (int k = 0; k < RUNS; k++) {
        if (!measure(name, path, spp, w, h, &a) || !measure(name, swarm, spp, w, h, &b))
            return;
        if (k == 0 || a.seconds < least_a.seconds)
            least_a = a;
        if (k == 0 || b.seconds < least_b.seconds)
            least_b = b;
    }
    printf("%s\t%lu\t%s\t%.2f s\t%.2f s\t%.2f\terror %.4f\t%.4f\tat equal time %.2f\n", scene,
           (unsigned long)spp, swarm, least_a.seconds, least_b.seconds,
           least_b.seconds / least_a.seconds, a.error, b.error,
           1 / at_equal_time(&least_a, &least_b));
    fflush(stdout);
}

void bench_swarm_table(void)
{
    puts("# table 9.2: sigma/mu at equal samples; ratios path/swarm at equal samples, equal time");
    puts("map\tscene\tspp\tprinted path\tswarm\tratio\tits path\tswarm\tratio\tequal time\t"
         "our path\tratio\tequal time");
    for (size_t i = 0; i < sizeof rows / sizeof rows[0]; i++)
        if (!table_row(&rows[i], 0, 0))
            return;
}

void bench_swarm_lens(void)
{
    lens_fold("zerotwo");
    lens_fold("random");
}

void bench_swarm_large(void)
{
    puts("# larger scenes, at their printed counts, smaller pictures");
    for (size_t i = 0; i < sizeof large / sizeof large[0]; i++)
        if (!table_row(&large[i], 120, 80))
            return;
}

void bench_swarm_cost(void)
{
    puts("# cost: seconds of path tracing and of swarming, their ratio, errors");
    cost("iguana", "path:maxdepth=8", "swarm:maxdepth=8", 32, 240, 160);
    cost("hare", "path:maxdepth=10", "swarm:maxdepth=10", 32, 180, 180);
    cost("swarm-uncorrelated", "path", "swarm", 32, 240, 160);
}
