/* bidirectional.c -- paths from both ends: pairs a second, and error after equal time on the scenes
 * that other programs were measured on.
 *
 * Reference   two pictures by methods that miss nothing of the scene, see paired_relmse: where
 *             delta lamps are seen by way of glass that is vcm with a radius a third of its own.
 * Time        Samples are as many as 20 CPU-seconds allow, by what a few of them take. */
#include "bench/bench.h"

#include <stdio.h>
#include <string.h>

typedef struct { const char *scene, *method, *reference, *asked; } Case;

#define BOTH "bdpt"
#define ALL "vcm:share=0.001"

static const Case cases[] = {
    { "scenes/s5.pbrt", "bdpt", BOTH, "asked 0.006, aim 0.004; SmallVCM 0.0082" },
    { "scenes/s5.pbrt", "vcm", BOTH, "asked 0.003, aim 0.002; SmallVCM 0.0041" },
    { "scenes/s5.pbrt", "path", BOTH, "Mitsuba 0.027" },
    { "scenes/s5.pbrt", "bpm", BOTH, "SmallVCM 0.0320" },
    { "scenes/s1.pbrt", "vcm", BOTH, "asked 0.0025, aim 0.0017; SmallVCM 0.0034" },
    { "scenes/s1.pbrt", "bdpt", BOTH, "SmallVCM 0.0171" },
    { "scenes/s0.pbrt", "vcm", ALL, "asked 0.012, aim 0.008; SmallVCM 0.0168" },
    { "scenes/s2.pbrt", "vcm", ALL, "asked 0.0035, aim 0.0023; SmallVCM 0.0046" },
    { "scenes/s2.pbrt", "bdpt", ALL, "asked 0.0035, aim 0.0023; SmallVCM 0.0049" },
};

static void after(const Case *c, const Image ref[2])
{
    enum { FEW = 16 };
    RenderReport r;
    Image im = { 0 };
    uint32_t spp;

    if (!bench_render(c->scene, c->method, NULL, 0, FEW, 1, 5, NULL, &r))
        return;
    spp = (uint32_t)d_max(1, FEW * 20.0 / r.cpu_seconds);
    if (bench_render(c->scene, c->method, NULL, 0, spp, processors(), 1, &im, &r)) {
        double e = paired_relmse(&im, &ref[0], &ref[1]);
        printf("bidirectional\t%s\t%s\tspp %lu\tCPU-seconds %.1f\trelMSE %.5f\tscaled to 20 s "
               "%.5f\t%s\n", c->scene, c->method, (unsigned long)spp, r.cpu_seconds, e,
               e * r.cpu_seconds / 20, c->asked);
    }
    fflush(stdout);
    image_clear(&im);
}

void bench_bidirectional(void)
{
    Image ref[2] = { { 0 }, { 0 } };
    const Case *last = NULL;
    RenderReport r;

    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        const Case *c = &cases[i];
        if (!last || strcmp(last->scene, c->scene))
            for (uint64_t k = 0; k < 2; k++) {
                image_clear(&ref[k]);
                if (!bench_render(c->scene, c->reference, NULL, 0, 128, processors(), 77 + k,
                                  &ref[k], &r))
                    return;
            }
        after(c, ref);
        last = c;
    }
    image_clear(&ref[0]);
    image_clear(&ref[1]);
}
