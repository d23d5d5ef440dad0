/* test_truth.c -- every strategy for direct light with every sampler gives the same picture, on
 * four scenes: a grid of strategies x samplers x scenes, each cell against path:maxdepth=1 by
 * random numbers, tile by tile and as a whole.
 *
 * Scenes      lamps of triangles over glossy things; balls and discs; a picture of the sky; many
 *             small lamps in fog, seen through a lens. None has delta lights, which two of the
 *             strategies cannot find (test_direct.c has those).
 * Lights      The lamps of one kind of the first scene are sampled by area or by solid angle, the
 *             sky by any of its ways: that is part of the scene here, so it has variants. In the
 *             first of them, the sky is asked for its bright parts by those that find the others.
 * Grid        All cells are slow. A diagonal of it is not: there cell k is strategy k and sampler
 *             k, both counted round, on scene k modulo 4.
 * Biased      What says of itself that it is biased is no part of the grid: lights=ward, fixed
 *             median cut, samplers without randomization, adaptive stopping by own samples. How
 *             far off they are is measured: in test_direct.c and test_adaptive.c, and by `make
 *             bench T=bias`. */
#include "integrators/direct.h"
#include "test/pictures.h"

#include <stdio.h>
#include <string.h>

enum { SIDE = 32, SCENES = 4, VARIANTS = 3 };

/* delta: the bias that is surely found, times that of the scene. variant: of the scene's light. */
typedef struct { const char *method; uint32_t spp; double delta; int variant; } Way;

static const Way ways[] = {
    { "direct:strategy=uniform,bsdfsamples=16", 1, 4, 0 },
    { "direct:strategy=brdf,bsdfsamples=8", 1, 3, 0 },
    { "direct:strategy=light,lightsampler=uniform,lightsamples=2", 1, 2, 0 },
    { "direct:strategy=light,lightsampler=power,lightsamples=2", 1, 2, 1 },
    { "direct:strategy=light,lightsampler=contribution", 1, 1, 2 },
    { "direct:strategy=light,lights=all", 1, 1, 1 },
    { "direct:strategy=light,lights=shirley", 1, 1, 2 },
    { "direct:strategy=light,lights=shirley,tolerance=0.8", 1, 1, 0 },
    { "direct:strategy=light,occlusion=directions,lightsampler=power", 1, 1, 2 },
    { "direct:strategy=mis", 1, 1, 1 },
    { "direct:strategy=mis,heuristic=balance,lightsamples=1,bsdfsamples=2", 1, 1, 0 },
    { "direct:strategy=mis,lights=all,bsdfsamples=2", 1, 1, 0 },
    { "direct:strategy=mis,occlusion=directions,lightsampler=uniform", 1, 1, 0 },
    { "direct:strategy=ris,tentative=8,samples=2", 1, 1, 2 },
    { "direct:strategy=ris,tentative=8,samples=8,heuristic=balance,lightshare=0.75", 1, 1, 1 },
    { "direct:strategy=ris,tentative=8,samples=1,lightshare=1,lightsampler=uniform", 1, 2, 0 },
    { "direct:strategy=ris,tentative=16,samples=2,lightshare=0", 1, 3, 0 },
    { "direct:strategy=ris,tentative=8,samples=2,occlusion=directions", 1, 1, 0 },
    { "direct:strategy=twostage,samples=4", 1, 1, 0 },
    { "direct:strategy=triple,samples=4", 1, 1, 2 },
    { "direct:strategy=cut,points=1000,clusters=32,rays=16,samples=2", 1, 2, 0 },
    { "direct:strategy=sir,points=1000,tentative=16,samples=4", 1, 2, 1 },
    { "path:maxdepth=1", 2, 1, 0 },
    { "path:sky=all,maxdepth=1", 2, 1, 0 },
    { "path:strategy=explicit,maxdepth=1", 2, 1, 0 },
    { "path:strategy=ris,maxdepth=1", 2, 1, 0 },
    { "path:strategy=twostage,maxdepth=1", 2, 1, 1 },
};
enum { WAYS = sizeof ways / sizeof ways[0] };

/* Every sampler, some in more than one way. */
static const char *const patterns[] = {
    "random", "zerotwo", "zerotwo:randomize=rotation", "stratified", "uncorrelated",
    "uncorrelated:match=permuted", "nrooks", "multijittered", "cmj", "poisson",
    "poisson:method=darts,relax=4,randomize=tile", "halton", "halton:randomize=permutedigits",
    "hammersley", "hammersley:randomize=owen", "sobol", "sobol:randomize=rotation,dimensions=12"
};
enum { PATTERNS = sizeof patterns / sizeof patterns[0],
       CELLS = (int)WAYS > (int)PATTERNS ? (int)WAYS : (int)PATTERNS };

/* ---- scenes ---- */

static void add_lamps(Lab *l, int variant)
{
    static const char *const how[VARIANTS] = { "area", "solidangle", "solidangle" };
    uint32_t black = lab_material(l, "diffuse", "reflectance=0");
    char text[80];

    lab_quad(l, v3(-3, -3, 0), v3(6, 0, 0), v3(0, 6, 0),
             lab_material(l, "phong", "reflectance=0.4/0.3/0.2,specular=0.4,exponent=20"));
    lab_sphere(l, v3(0, 0.3f, 0.6f), 0.6f, lab_material(l, "conductor", "roughness=0.3"), false);
    snprintf(text, sizeof text, "L=1/1/1.5,sampling=%s", how[variant]);
    lab_shine(l, lab_quad(l, v3(-2, -1.5f, 2.2f), v3(0, 3, 0), v3(3, 0, 0.5f), black), text);
    snprintf(text, sizeof text, "L=3/4/4,sampling=%s", how[variant]);
    lab_shine(l, lab_quad(l, v3(-1, -0.5f, 1.6f), v3(0, 0.7f, 0), v3(0.8f, 0, 0), black), text);
    lab_camera(l, v3(0, -4, 2), v3(0, 0, 0.4f), 45, "");
}

static void add_balls(Lab *l, int variant)
{
    uint32_t black = lab_material(l, "diffuse", "reflectance=0");

    (void)variant;
    lab_quad(l, v3(-3, -3, 0), v3(6, 0, 0), v3(0, 6, 0),
             lab_material(l, "coateddiffuse", "reflectance=0.2/0.5/0.7,roughness=0.2"));
    lab_sphere(l, v3(-0.7f, 0, 0.4f), 0.4f, lab_material(l, "diffuse", "reflectance=0.7"), false);
    lab_shine(l, lab_sphere(l, v3(0.8f, 0.2f, 1), 0.4f, black, false), "L=2/3/2");
    lab_shine(l, lab_zone(l, v3(-1.2f, 0.8f, 1.2f), 0.4f, -0.4f, 0.1f, black, false), "L=1/1/2");
    lab_shine(l, lab_disk(l, v3(0, 0.6f, 1.4f), v3(0.5f, 0.3f, -1), 0.5f, 0.1f, black),
              "L=2/1/1,twosided=true");
    lab_camera(l, v3(0, -4, 2), v3(0, 0, 0.4f), 45, "");
}

static Rgb cloudy(V3 w)
{
    float c = f_max(0, 0.58f * w.x - 0.58f * w.y + 0.58f * w.z), bright = f_sqr(f_sqr(c));
    return rgb_scale(rgb(0.5f, 0.7f, 1), w.z > 0 ? 0.5f + 3 * bright : 0.05f);
}

static void add_sky(Lab *l, int variant)
{
    static const char *const how[VARIANTS] = { "sampling=cdf", "sampling=alias",
                                               "sampling=mediancut,lights=32" };
    Transform turn = xf_rotate(30, 0, 0, 1);
    uint32_t black = lab_material(l, "diffuse", "reflectance=0");

    lab_quad(l, v3(-3, -3, 0), v3(6, 0, 0), v3(0, 6, 0),
             lab_material(l, "diffuse", "reflectance=0.5/0.4/0.3"));
    lab_sphere(l, v3(-0.5f, 0, 0.6f), 0.6f, lab_material(l, "conductor", "roughness=0.2"), false);
    lab_shine(l, lab_disk(l, v3(0.9f, 0, 1.2f), v3(-0.3f, -0.2f, -1), 0.5f, 0.2f, black),
              "L=3/2/1");
    lab_light(l, "infinite", "L=0.1/0.1/0.2", NULL);            /* a second one behind it */
    lab_sky_as(l, 32, 16, cloudy, &turn, how[variant]);
    lab_camera(l, v3(0, -4, 2), v3(0, 0, 0.5f), 45, "");
}

/* The lamps are above what the eye can see: where fog that touches a lamp is seen, points of lamps
 * alone have no finite variance. */
static void add_fog(Lab *l, int variant)
{
    uint32_t black = lab_material(l, "diffuse", "reflectance=0"), fog;
    Medium air = { "air", { 0.05f, 0.1f, 0.1f }, { 0.08f, 0.08f, 0.06f }, 0.4f };

    (void)variant;
    REQUIRE(scene_add_medium(l->scene, &air, &fog), "memory");
    l->scene->around = fog;
    lab_quad(l, v3(-3, 3, 0), v3(6, 0, 0), v3(0, -6, 0),
             lab_material(l, "diffuse", "reflectance=0.5/0.4/0.3"));
    lab_quad(l, v3(-1.5f, 1, 0.1f), v3(3, 0, 0), v3(0, 0, 1),
             lab_material(l, "diffusetransmission", "reflectance=0.3,transmittance=0.5"));
    lab_sphere(l, v3(-0.4f, -0.5f, 0.5f), 0.5f, lab_material(l, "phong", "specular=0.5"), false);
    for (int i = 0; i < 6; i++)
        lab_shine(l, lab_quad(l, v3((float)i - 2.7f, 0.3f * (float)(i % 3) - 0.4f, 2.8f),
                              v3(0, 0.5f, 0), v3(0.5f, 0, 0), black), "L=12/9/6");
    lab_camera(l, v3(0, -4, 2), v3(0, 0, 0.4f), 45, "lensradius=0.1,focaldistance=4");
}

typedef struct {
    const char *name;
    void (*add)(Lab *l, int variant);
    bool variants;
    double delta;               /* of the first way by one sample a pixel */
} World;

static const World settings[SCENES] = {
    { "lamps", add_lamps, true, 0.04 }, { "balls", add_balls, false, 0.04 },
    { "sky", add_sky, true, 0.03 }, { "fog", add_fog, false, 0.06 },
};

/* ---- the grid ---- */

typedef struct { Lab lab[VARIANTS]; Series truth; const World *of; int scene; } Grid;

static void place_init(Grid *p, int scene)
{
    messages_quiet(true);
    p->of = &settings[scene];
    p->scene = scene;
    for (int v = 0; v < (p->of->variants ? VARIANTS : 1); v++) {
        lab_init(&p->lab[v]);
        p->of->add(&p->lab[v], v);
        lab_build(&p->lab[v]);
    }
    series_render(&p->lab[0], &p->truth, "path:maxdepth=1@random", SIDE, 16, 300);
}

static void place_clear(Grid *p)
{
    series_clear(&p->truth);
    for (int v = 0; v < (p->of->variants ? VARIANTS : 1); v++)
        lab_clear(&p->lab[v]);
}

/* more: times the samples that the way has in the grid. */
static void expect_cell(Grid *p, int way, int pattern, uint32_t more, double slack)
{
    const Way *w = &ways[way];
    Series s;
    char method[200], what[300];

    snprintf(method, sizeof method, "%s@%s", w->method, patterns[pattern]);
    snprintf(what, sizeof what, "%s, variant %d, %s", p->of->name, w->variant, method);
    series_render(&p->lab[p->of->variants ? w->variant : 0], &s, method, SIDE, w->spp * more,
                  301 + (uint64_t)(way * PATTERNS + pattern));
    series_expect_same(&s, &p->truth, w->delta * p->of->delta * slack, what);
    series_clear(&s);
}

static void diagonal(int scene)
{
    Grid p;

    place_init(&p, scene);
    for (int k = scene; k < CELLS; k += SCENES)
        expect_cell(&p, k % WAYS, k % PATTERNS, 4, 1);
    place_clear(&p);
}

/* A fourth of the diagonal's samples a cell, and 16 times as many since it is slow: random numbers
 * have half of its error then, not the quarter that is asked for. */
static void grid(int scene)
{
    Grid p;

    place_init(&p, scene);
    for (int way = 0; way < WAYS; way++)
        for (int k = 0; k < PATTERNS; k++)
            expect_cell(&p, way, k, 1, 3);
    place_clear(&p);
}

static void some_lamps(void) { diagonal(0); }
static void some_balls(void) { diagonal(1); }
static void some_sky(void) { diagonal(2); }
static void some_fog(void) { diagonal(3); }
static void all_lamps(void) { grid(0); }
static void all_balls(void) { grid(1); }
static void all_sky(void) { grid(2); }
static void all_fog(void) { grid(3); }

/* The lists are whole: every sampler and every strategy has a place in the grid. */
static void lists(void)
{
    for (int k = 0; samplers[k]; k++) {
        bool found = false;
        for (int i = 0; i < PATTERNS; i++)
            found |= strcspn(patterns[i], ":") == strlen(samplers[k]->info.name) &&
                     !strncmp(patterns[i], samplers[k]->info.name, strcspn(patterns[i], ":"));
        EXPECT(found, "the sampler %s is not in the grid", samplers[k]->info.name);
    }
    for (int k = 0; direct_strategies[k]; k++) {
        char text[60];
        bool found = false;
        snprintf(text, sizeof text, "direct:strategy=%s", direct_strategies[k]->name);
        for (int i = 0; i < WAYS; i++)
            found |= strcspn(ways[i].method, ",") == strlen(text) &&
                     !strncmp(ways[i].method, text, strlen(text));
        EXPECT(found, "%s is not in the grid", text);
    }
}

const TestCase test_truth[] = {
    { "lists", lists, false },
    { "some_lamps", some_lamps, false },
    { "some_balls", some_balls, false },
    { "some_sky", some_sky, false },
    { "some_fog", some_fog, false },
    { "all_lamps", all_lamps, true },
    { "all_balls", all_balls, true },
    { "all_sky", all_sky, true },
    { "all_fog", all_fog, true },
    { NULL, NULL, false }
};
