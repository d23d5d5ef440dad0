/* jitter.c -- uncorrelated jittering against independent samples: the noise of `distributed` in a
 * picture that is a mean over pixel, lens, lamp and gloss at once, at equal numbers of samples.
 *
 * Source  [Shirley91 5.4.1]: strata of one decision are matched with those of the others by
 *         permutation, so that N samples are N strata of each.
 * Noise   sigma/mu of the picture from pairs of renders of different seeds, [Cline07 (4.14)]: half
 *         the mean squared difference is the variance. */
#include "bench/bench.h"

#include <math.h>
#include <stdio.h>

enum { SIDE = 64, PAIRS = 4 };

static double noise(const char *method, const char *sampler, uint32_t spp)
{
    double squares = 0, sum = 0;

    for (uint64_t k = 0; k < PAIRS; k++) {
        Image a = { 0 }, b = { 0 };
        RenderReport r;
        if (bench_render("bench/jitter.pbrt", method, sampler, SIDE, spp, 1, 2 * k, &a, &r) &&
            bench_render("bench/jitter.pbrt", method, sampler, SIDE, spp, 1, 2 * k + 1, &b, &r))
            for (size_t i = 0; i < (size_t)SIDE * SIDE; i++) {
                double x = rgb_lum(a.pixels[i]), y = rgb_lum(b.pixels[i]);
                squares += 0.5 * (x - y) * (x - y);
                sum += 0.5 * (x + y);
            }
        image_clear(&a);
        image_clear(&b);
    }
    return sqrt(squares * PAIRS * SIDE * SIDE) / sum;
}

/* Samplers are those that there are of these; the first is the yardstick. */
void bench_jitter(void)
{
    static const char *const names[] = { "random", "stratified", "uncorrelated", "zerotwo",
                                         "sobol" };
    static const char *const methods[] = {
        "distributed", "distributed:lightsamples=4,bsdfsamples=4" };

    printf("# sigma/mu, and that of independent samples over it; bench/jitter.pbrt, %d x %d\n",
           SIDE, SIDE);
    for (int m = 0; m < 2; m++)
        for (uint32_t spp = 4; spp <= 64; spp *= 4) {
            double random = 0;
            for (size_t k = 0; k < sizeof names / sizeof *names; k++) {
                double s;
                if (!kind_find(samplers, names[k]))
                    continue;
                s = noise(methods[m], names[k], spp);
                random = k ? random : s;
                printf("jitter\t%s\tspp %2lu\t%-12s\tsigma/mu %.4f\tgain %.2f\n", methods[m],
                       (unsigned long)spp, names[k], s, random / s);
                fflush(stdout);
            }
        }
}
