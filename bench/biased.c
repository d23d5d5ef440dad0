/* biased.c -- how far off is what says of itself that it is biased: guesses at shadows, lamps as
 * points, patterns alike in all pixels, pixels that end by their own samples, bounds of virtual
 * lights.
 *
 * Mean      of the picture over that of the reference; then the root mean square over the pixels of
 *           what is not noise, in units of the reference's mean. For two renders a, b of the method
 *           by different seeds, and two of the reference r, s, the mean of (a - r)(b - s) has the
 *           expectation of the squared bias, whatever their noise: so a method without bias shows a
 *           root near 0 (of either sign: the root of a negative mean is printed negative). Where
 *           patterns are the same for all seeds, their error is bias. */
#include "bench/bench.h"

#include <stdio.h>
#include <string.h>

enum { SIDE = 96, MANY = 1024 };

typedef struct {
    const char *name, *scene;
    const char *truth;          /* the reference's integrator */
    const char *integrator, *sampler, *adaptive;
    double   error;
    uint32_t spp;
} Case;

static double mean_of(const Image *im)
{
    size_t n = (size_t)im->w * im->h;
    double sum = 0;
    for (size_t i = 0; i < n; i++)
        sum += (double)rgb_lum(im->pixels[i]) / (double)n;
    return sum;
}

static double bias_of(const Image *a, const Image *b, const Image *r, const Image *s)
{
    size_t n = (size_t)a->w * a->h;
    double sum = 0;

    for (size_t i = 0; i < n; i++)
        sum += ((double)rgb_lum(a->pixels[i]) - (double)rgb_lum(r->pixels[i])) *
               ((double)rgb_lum(b->pixels[i]) - (double)rgb_lum(s->pixels[i])) / (double)n;
    return sum < 0 ? -sqrt(-sum) : sqrt(sum);
}

static bool pair(const Case *c, bool truth, Image im[2])
{
    RenderReport unused;
    RenderRequest q;

    for (uint64_t k = 0; k < 2; k++) {
        memset(&q, 0, sizeof q);
        q.integrator = truth ? c->truth : c->integrator;
        q.sampler = truth ? NULL : c->sampler;
        q.adaptive = truth ? NULL : c->adaptive;
        q.error = truth ? 0 : c->error;
        q.spp = truth ? MANY : c->spp;
        q.w = q.h = SIDE;
        q.threads = processors();
        q.seed = k + (truth ? 1000 : 1);
        if (!bench_picture(c->scene, &q, &im[k], &unused))
            return false;
    }
    return true;
}

/* The reference serves all cases of a scene that follow each other. */
static void table(const Case *c, int n)
{
    Image ref[2] = { { 0 }, { 0 } }, im[2] = { { 0 }, { 0 } };
    const char *of = "", *truth = "";

    for (int i = 0; i < n; i++) {
        double mean, se;
        if (strcmp(of, c[i].scene) || strcmp(truth, c[i].truth)) {
            image_clear(&ref[0]);
            image_clear(&ref[1]);
            if (!pair(&c[i], true, ref))
                return;
            of = c[i].scene;
            truth = c[i].truth;
        }
        if (!pair(&c[i], false, im))
            return;
        mean = 0.5 * (mean_of(&ref[0]) + mean_of(&ref[1]));
        se = 0.5 * fabs(mean_of(&im[0]) - mean_of(&im[1])) / mean;
        printf("bias\t%-52s\t%-16s\tmean %+7.2f %% +- %.2f\tpixels %6.2f %%\n", c[i].name,
               strncmp(c[i].scene, "scenes/", 7) ? c[i].scene : c[i].scene + 7,
               100 * (0.5 * (mean_of(&im[0]) + mean_of(&im[1])) / mean - 1), 100 * se,
               100 * bias_of(&im[0], &im[1], &ref[0], &ref[1]) / mean);
        fflush(stdout);
        image_clear(&im[0]);
        image_clear(&im[1]);
    }
    image_clear(&ref[0]);
    image_clear(&ref[1]);
}

#define ALL "direct:strategy=light,lights=all"
#define WARD(t) "lights=ward, tolerance " #t, "scenes/nine-lights.pbrt", ALL,                   \
                "direct:strategy=light,lights=ward,tolerance=" #t, NULL, NULL, 0, 64
#define SPOTS(t) "lights=ward, tolerance " #t, "scenes/five-spots.pbrt", ALL,                   \
                 "direct:strategy=light,lights=ward,tolerance=" #t, NULL, NULL, 0, 64
#define TREES(scene) "whitted", "scenes/" scene ".pbrt", "path", "whitted", NULL, NULL, 0, 16
#define TREES_SPREAD(scene) "distributed", "scenes/" scene ".pbrt", "path", "distributed",\
                            NULL, NULL, 0, 64
#define ALIKE(sampler, n) sampler, "scenes/s4.pbrt", "path", "path", sampler, NULL, 0, n
#define ENDS(policy, x) policy ", --error " #x, "scenes/swarm-probe.pbrt", "path", "path", \
                        NULL, policy, x, 0
#define SPENT(policy, n) policy, "scenes/swarm-probe.pbrt", "path", "path", NULL, policy, 0, n
/* Of two sets of lights of 1000 paths each: its mean is uncertain as theirs is. */
#define VIRTUAL(options) "instantradiosity:" options, "scenes/cornell.pbrt", "path",            \
                         "instantradiosity:lights=1000," options, NULL, NULL, 0, 2

void bench_bias(void)
{
    static const Case cases[] = {
        { WARD(0.1) }, { WARD(0.4) }, { WARD(0.9) }, { SPOTS(0.1) }, { SPOTS(0.4) }, { SPOTS(0.9) },
        { TREES("s4") }, { TREES_SPREAD("s4") }, { TREES("nine-lights") },
        { TREES_SPREAD("nine-lights") }, { TREES("floor-diffuse") },
        { TREES_SPREAD("floor-diffuse") }, { TREES("three-spheres") },
        { TREES_SPREAD("three-spheres") },
        { ALIKE("zerotwo", 16) }, { ALIKE("zerotwo:randomize=none", 16) },
        { ALIKE("halton:randomize=none", 16) }, { ALIKE("poisson:randomize=none", 16) },
        { ALIKE("stratified:randomize=none", 16) }, { ALIKE("stratified:jitter=false", 16) },
        { ENDS("own", 0.2) }, { ENDS("own", 0.05) }, { ENDS("neighbours", 0.2) },
        { ENDS("neighbours", 0.05) }, { ENDS("none", 0.05) },
        { SPENT("variable:rerender=true", 16) }, { SPENT("variable", 16) },
        { SPENT("neighbours", 16) },
        { VIRTUAL("clamp=0,cut=0.02") }, { VIRTUAL("clamp=100,cut=0.02") },
        { VIRTUAL("clamp=10,cut=0.02") }, { VIRTUAL("clamp=1,cut=0.02") },
        { VIRTUAL("clamp=10,compensate=true,cut=0.02") },
    };
    printf("# bias in %d x %d pixels: of the mean; of the pixels, root mean square\n", SIDE, SIDE);
    table(cases, (int)(sizeof cases / sizeof cases[0]));
}
