/* direct.c -- direct light: what each strategy costs for how little noise.
 *
 * A method is rendered with so many samples a pixel; sigma/mu [Cline07 (4.13)] is against a picture
 * of very many samples, in CPU seconds. "to 1 %" is the time until sigma/mu is 0.01 if the variance
 * goes as one over the samples: the product by which methods of unequal cost compare. So does
 * relMSE times CPU seconds, in which the edges of lamps that are seen count for less. */
#include "bench/bench.h"
#include "image/compare.h"

#include <stdio.h>
#include <string.h>

enum { W = 160, H = 120 };

/* A method, and the samples a pixel that it takes here. */
typedef struct { const char *integrator; uint32_t spp; } Method;

static bool picture(const char *scene, const Method *m, uint64_t seed, Image *im, double *seconds)
{
    RenderRequest q;
    RenderReport report;

    memset(&q, 0, sizeof q);
    q.integrator = m->integrator;
    q.spp = m->spp;
    q.threads = 1;
    q.seed = seed;
    q.w = W;
    q.h = H;
    if (!bench_picture(scene, &q, im, &report))
        return false;
    *seconds = report.cpu_seconds;
    return true;
}

/* One line for each method: the mean of three runs, the time of the best. */
static void table(const char *name, const char *scene, const Method *reference, const Method *m,
                  const char *const *said)
{
    Image ref = { 0 };
    double of_reference;

    if (!picture(scene, reference, 1000, &ref, &of_reference))
        return;
    for (int i = 0; m[i].integrator; i++) {
        double seconds = 0, variance = 0, least = 1e30, ratio = 0, relmse = 0;
        enum { RUNS = 3 };
        for (int k = 0; k < RUNS; k++) {
            Image im = { 0 };
            ImageDifference d;
            if (!picture(scene, &m[i], (uint64_t)k, &im, &seconds) ||
                !image_compare(&im, m[i].integrator, &ref, scene, &d))
                return;
            variance += d.sigma_over_mu * d.sigma_over_mu / RUNS;
            ratio += d.ratio / RUNS;
            relmse += d.relmse / RUNS;
            least = seconds < least ? seconds : least;
            image_clear(&im);
        }
        fflush(stdout);
        printf("%s\t%-62s\tspp %3lu\tCPU s %6.2f\tsigma/mu %.4f\tto 1 %%: %8.2f s\trelMSE %.5f\t"
               "x CPU s %.5f\tmean %.4f\t%s\n",
               name, m[i].integrator, (unsigned long)m[i].spp, least, sqrt(variance),
               least * variance / 1e-4, relmse, relmse * least, ratio, said ? said[i] : "");
    }
    image_clear(&ref);
}

/* Figure 4.10: "RIS performs better than the other techniques, even with half as many samples". */
static void figure_4_10(void)
{
    static const Method reference = { "direct:strategy=mis,lightsamples=8,bsdfsamples=8", 256 };
    static const Method m[] = {
        { "direct:strategy=uniform,bsdfsamples=16", 1 },
        { "direct:strategy=brdf,bsdfsamples=16", 1 },
        { "direct:strategy=light,lightsamples=16", 1 },
        { "direct:strategy=mis,lightsamples=8,bsdfsamples=8", 1 },
        { "direct:strategy=mis,lightsamples=8,bsdfsamples=8,heuristic=balance", 1 },
        { "direct:strategy=ris,tentative=64,samples=8", 1 },
        { "direct:strategy=ris,tentative=64,samples=8,heuristic=balance", 1 },
        { "direct:strategy=ris,tentative=32,samples=2,lightsampler=contribution", 1 },
        { NULL, 0 }
    };
    static const char *const said[] = {
        "said: how poorly, many pixels vary greatly (fig. 4.4)",
        "said: most regions very noisy, highlights much better (4.5)",
        "said: better almost everywhere but the highlight (4.6)",
        "said: the good qualities of both (4.8)", "", "said: better than all others (4.10)", "", ""
    };
    table("fig4.10", "scenes/glossy-ball.pbrt", &reference, m, said);
}

/* Figure 5.11 of [Shirley91]: one shadow ray for nine lamps, against nine; 5.12: five spots. */
static void many_lights(void)
{
    static const Method reference = { "direct:strategy=light,lights=all", 256 };
    static const Method nine[] = {
        { "direct:strategy=light,lights=all", 4 },
        { "direct:strategy=light,lightsampler=uniform", 16 },
        { "direct:strategy=light,lightsampler=power", 16 },
        { "direct:strategy=light,lightsampler=contribution", 16 },
        { "direct:strategy=light,lights=ward", 4 },
        { "direct:strategy=light,lights=shirley", 4 },
        { "direct:strategy=light,lights=ward,tolerance=0.4", 4 },
        { "direct:strategy=light,lights=shirley,tolerance=0.4", 4 },
        { "direct:strategy=ris,lightshare=1,tentative=9,samples=1", 16 },
        { NULL, 0 }
    };
    table("nine lights", "scenes/nine-lights.pbrt", &reference, nine, NULL);
    table("five spots", "scenes/five-spots.pbrt", &reference, nine, NULL);
}

/* The best single strategy, the worst, and both together, at their own costs; and together with the
 * sky asked for all of its light, not for its bright parts. */
static void equal_time(void)
{
    static const Method reference = { "direct:strategy=mis,lightsamples=4,bsdfsamples=4", 192 };
    static const Method m[] = {
        { "direct:strategy=brdf", 32 }, { "direct:strategy=light", 32 },
        { "direct:strategy=mis", 16 }, { "direct:strategy=mis,sky=all", 16 },
        { "direct:strategy=mis,heuristic=balance", 16 },
        { "direct:strategy=mis,lightsamples=2,bsdfsamples=2", 8 },
        { "direct:strategy=light,lightsampler=contribution", 32 },
        { "direct:strategy=mis,lightsampler=contribution", 16 },
        { "direct:strategy=ris,tentative=16,samples=2", 8 },
        { NULL, 0 }
    };
    static const Method room[] = {              /* where lamps are, which brdf seldom finds */
        { "direct:strategy=light", 32 }, { "direct:strategy=mis", 16 },
        { "direct:strategy=mis,heuristic=balance", 16 }, { NULL, 0 }
    };

    table("plates", "scenes/plates.pbrt", &reference, m, NULL);
    table("probe, glossy", "scenes/floor-glossy.pbrt", &reference, m, NULL);
    table("probe, matt", "scenes/floor-diffuse.pbrt", &reference, m, NULL);
    table("probe, a hole", "scenes/hare.pbrt", &reference, m, NULL);
    table("bathroom", "scenes/bathroom.pbrt", &reference, room, NULL);
    table("bedroom", "scenes/bedroom.pbrt", &reference, room, NULL);
    table("living-room", "scenes/living-room.pbrt", &reference, room, NULL);
    table("nine lights", "scenes/nine-lights.pbrt", &reference, room, NULL);
}

void bench_direct(void)
{
    figure_4_10();
    many_lights();
    equal_time();
}
