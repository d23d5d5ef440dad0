/* test_media.c -- media and masks: absorption without noise, phase functions against their own
 * density, white furnaces, single scattering against quadrature, three ways of completing paths
 * against each other, and surfaces that let a part of the rays pass. */
#include "scene/medium.h"
#include "test/chi2.h"
#include "test/physics.h"

#include <stdio.h>

/* ---- parts of scenes ---- */

static const Texture *constant(Lab *l, float value)
{
    Texture *t = arena_take(&l->scene->arena, 1, sizeof *t);
    REQUIRE(t, "memory");
    t->kind = TEXTURE_CONSTANT;
    t->value = rgb_all(value);
    return t;
}

static uint32_t masked(Lab *l, const char *kind, const char *options, const Texture *opacity)
{
    uint32_t m = lab_material(l, kind, options);
    l->scene->materials[m].opacity = opacity;
    return m;
}

static uint32_t unseen(Lab *l) { return masked(l, "diffuse", "", constant(l, 0)); }

static uint32_t medium(Lab *l, Rgb absorption, Rgb scattering, float g)
{
    Medium m = { "", absorption, scattering, g };
    uint32_t index;
    REQUIRE(scene_add_medium(l->scene, &m, &index), "memory");
    return index;
}

static void border(Lab *l, uint32_t shape, uint32_t inside, uint32_t outside)
{
    Shape *s = &l->scene->geometries[0].shapes[shape];
    s->separates = true;
    s->inside = inside;
    s->outside = outside;
}

static void measure(Lab *l, const char *options, Ray ray, uint64_t n, Meter *m)
{
    Gauge g = { ray_fixed, NULL, 0, 17, 0 };

    g.of = &ray;
    g.n = n;
    lab_open(l, options);
    lab_measure(l, &g, m);
}

/* ---- absorption ---- */

/* Two spheres about one centre, a medium in each: the sky through them fades by the lengths of both
 * chords; that in the middle also where it is bordered by glass without refraction. */
static void absorbs(void)
{
    static const float b[] = { 0.0f, 0.3f, 0.55f, 0.8f };
    const Rgb outer = { 0.3f, 0.9f, 1.5f }, inner = { 2.0f, 0.1f, 0.0f };
    Lab l;

    lab_init(&l);
    border(&l, lab_sphere(&l, v3(0, 0, 0), 1, unseen(&l), false),
           medium(&l, outer, rgb_all(0), 0), NO_MEDIUM);
    border(&l, lab_sphere(&l, v3(0, 0, 0), 0.5f, lab_material(&l, "dielectric", "eta=1"), false),
           medium(&l, inner, rgb_all(0), 0), 0);
    lab_light(&l, "infinite", "", NULL);
    lab_build(&l);
    for (int i = 0; i < 4; i++) {
        double chord = 2 * sqrt(1 - (double)b[i] * b[i]);
        double in = b[i] < 0.5f ? 2 * sqrt(0.25 - (double)b[i] * b[i]) : 0, out = chord - in;
        double truth[3] = { exp(-outer.r * out - inner.r * in), exp(-outer.g * out - inner.g * in),
                            exp(-outer.b * out - inner.b * in) };
        Ray ray = { .o = { b[i], 0, -3 }, .d = { 0, 0, 1 }, .tmax = INFINITY };
        Meter m;
        measure(&l, "", ray, 1000, &m);
        for (int c = 0; c < 3; c++)
            EXPECT(fabs(meter_radiance(&m)[c].mean / truth[c] - 1) < 1e-5, "at %g, channel %d: %g, "
                   "it is %g", b[i], c, meter_radiance(&m)[c].mean, truth[c]);
    }
    lab_clear(&l);
}

/* A lamp seen by a white floor through a slab: what explicit paths lose is the slab's transmittance
 * along the slanted way. One direction: a distant light. */
static void absorbs_light(void)
{
    const Rgb s = { 0.5f, 1.0f, 2.0f };
    Ray ray = { .o = { 0, 0, 0.5f }, .d = { 0, 0, -1 }, .tmax = INFINITY };
    double cosine = 0.6, truth[3];
    uint32_t in, clear;
    Meter m;
    Lab l;

    lab_init(&l);
    in = medium(&l, s, rgb_all(0), 0);
    clear = unseen(&l);
    lab_quad(&l, v3(-9, -9, 0), v3(18, 0, 0), v3(0, 18, 0),
             lab_material(&l, "diffuse", "reflectance=1"));
    border(&l, lab_quad(&l, v3(-9, -9, 2), v3(18, 0, 0), v3(0, 18, 0), clear), in, NO_MEDIUM);
    border(&l, lab_quad(&l, v3(-9, -9, 1), v3(0, 18, 0), v3(18, 0, 0), clear), in, NO_MEDIUM);
    lab_light(&l, "distant", "from=0.8/0/0.6,to=0/0/0,L=1", NULL);
    lab_build(&l);
    measure(&l, "maxdepth=1", ray, 1000, &m);
    truth[0] = exp(-0.5 / cosine) * cosine / PI;
    truth[1] = exp(-1.0 / cosine) * cosine / PI;
    truth[2] = exp(-2.0 / cosine) * cosine / PI;
    for (int c = 0; c < 3; c++)
        EXPECT(fabs(meter_radiance(&m)[c].mean / truth[c] - 1) < 1e-5, "channel %d: %g, it is %g",
               c, meter_radiance(&m)[c].mean, truth[c]);
    lab_clear(&l);
}

/* ---- phase functions ---- */

typedef struct { float g; V3 from; } Phase;

static bool phase_draw(const void *of, Rng *rng, V3 *w)
{
    const Phase *p = of;
    V2 u;
    u.x = rng_unit(rng);
    u.y = rng_unit(rng);
    *w = phase_sample(p->g, p->from, u);
    return true;
}

static double phase_density(const void *of, V3 w)
{
    const Phase *p = of;
    return (double)phase_pdf_w(p->g, p->from, w);
}

static void phase(void)
{
    static const float g[] = { 0.0f, 0.3f, -0.3f, 0.8f, -0.9f, 0.97f };

    for (int i = 0; i < 6; i++) {
        Phase p = { g[i], { 0, 0, 0 } };
        Chi2 c = { phase_draw, phase_density, NULL, false, 200000, 5, 32, 64, 0, 0 };
        Rng rng = rng_seed(11);
        double sum = 0, n = 20000;
        char what[40];
        p.from = v_unit(v3(0.3f, -0.5f, 0.7f));
        c.of = &p;
        snprintf(what, sizeof what, "g = %g", g[i]);
        chi2_expect(&c, what);
        for (int k = 0; k < (int)n; k++) {
            V3 w;
            phase_draw(&p, &rng, &w);
            sum += (double)v_dot(w, p.from);
        }
        /* The cosine's variance is at most 1: five standard errors and more. */
        EXPECT(fabs(sum / n - g[i]) < 5.6 / sqrt(n), "the mean cosine is %g for g = %g", sum / n,
               g[i]);
    }
}

/* ---- scattering ---- */

/* Where nothing is lost, a medium under a sky of radiance 1 looks like that sky, whatever it does
 * to directions. Colours differ in density only. */
static void furnace(void)
{
    static const struct { Rgb s; float g; } kinds[] = {
        { { 1, 1, 1 }, 0 }, { { 0.5f, 2, 6 }, 0 }, { { 3, 1, 0.25f }, 0.8f },
        { { 2, 4, 0 }, -0.6f }
    };
    const double white[3] = { 1, 1, 1 };

    for (size_t i = 0; i < sizeof kinds / sizeof *kinds; i++) {
        Ray ray = { .o = { 0.4f, 0.1f, -3 }, .d = { 0, 0, 1 }, .tmax = INFINITY };
        char what[40];
        Meter m;
        Lab l;
        lab_init(&l);
        border(&l, lab_sphere(&l, v3(0, 0, 0), 1, unseen(&l), false),
               medium(&l, rgb_all(0), kinds[i].s, kinds[i].g), NO_MEDIUM);
        lab_light(&l, "infinite", "", NULL);
        lab_build(&l);
        measure(&l, "maxdepth=1000,strategy=mis", ray, 20000, &m);
        snprintf(what, sizeof what, "furnace %lu", (unsigned long)i);
        stat_expect_rgb(meter_radiance(&m), white, 0.1, what);
        lab_clear(&l);
    }
}

/* One scattering of a point light's rays in fog without end, by quadrature along the ray:
 *   L = int s p(cos) I / d^2 exp(-(t + d) e) dt. */
static double scattered_once(double s, double e, double g, V3 light, double intensity)
{
    const int n = 20000;
    double sum = 0, far = 30;

    for (int i = 0; i < n; i++) {
        double t = far * (i + 0.5) / n, x = light.x, z = light.z - t, d = sqrt(x * x + z * z);
        double q = 1 + g * g - 2 * g * z / d;   /* z / d: the cosine */
        sum += s * 0.25 / PI * (1 - g * g) / (q * sqrt(q)) * intensity / (d * d) *
               exp(-e * (t + d)) * far / n;
    }
    return sum;
}

static void single_scattering(void)
{
    static const float g[] = { 0.0f, 0.5f, -0.7f };
    const V3 lamp = { 1.0f, 0, 2.0f };
    const Rgb absorption = { 0.1f, 0.3f, 0.0f }, scattering = { 0.5f, 0.5f, 0.2f };

    for (int i = 0; i < 3; i++) {
        Ray ray = { .o = { 0, 0, 0 }, .d = { 0, 0, 1 }, .tmax = INFINITY };
        double truth[3];
        char what[40];
        Meter m;
        Lab l;
        lab_init(&l);
        l.scene->around = medium(&l, absorption, scattering, g[i]);
        lab_light(&l, "point", "from=1/0/2,I=5", NULL);
        lab_build(&l);
        measure(&l, "maxdepth=1", ray, 40000, &m);
        truth[0] = scattered_once(0.5, 0.6, g[i], lamp, 5);
        truth[1] = scattered_once(0.5, 0.8, g[i], lamp, 5);
        truth[2] = scattered_once(0.2, 0.2, g[i], lamp, 5);
        snprintf(what, sizeof what, "scattered once, g = %g", g[i]);
        stat_expect_rgb(meter_radiance(&m), truth, 0.2, what);
        lab_clear(&l);
    }
}

/* A lamp, a floor, fog in a box, and a ball of glass with another medium in it. */
static void ways_agree(void)
{
    Ray ray = { .o = { 0.2f, -2.5f, 0.7f }, .d = { 0, 0, 0 }, .tmax = INFINITY };
    uint32_t fog, milk;
    Meter a, b, c;
    Lab l;

    ray.d = v_unit(v3(-0.05f, 1, -0.2f));
    lab_init(&l);
    fog = medium(&l, rgb(0.05f, 0.1f, 0.2f), rgb(0.4f, 0.3f, 0.2f), 0.4f);
    milk = medium(&l, rgb(0.2f, 0.1f, 0.1f), rgb(1, 2, 3), 0);
    lab_quad(&l, v3(-4, -4, 0), v3(8, 0, 0), v3(0, 8, 0),
             lab_material(&l, "diffuse", "reflectance=0.6"));
    border(&l, lab_sphere(&l, v3(0, 0, 0), 2, unseen(&l), false), fog, NO_MEDIUM);
    border(&l, lab_sphere(&l, v3(0, 0, 0.4f), 0.35f, lab_material(&l, "dielectric", ""), false),
           milk, fog);
    lab_shine(&l, lab_sphere(&l, v3(0.8f, 0.3f, 1.2f), 0.4f, 0, false), "L=4/3/2");
    lab_build(&l);
    measure(&l, "maxdepth=6,strategy=mis", ray, 70000, &a);
    measure(&l, "maxdepth=6,strategy=implicit", ray, 200000, &b);
    measure(&l, "maxdepth=6,strategy=mis,glints=4", ray, 70000, &c);
    for (int k = 0; k < 3; k++) {
        stat_expect_same(&meter_radiance(&a)[k], &meter_radiance(&b)[k], 0.2, "mis and implicit");
        stat_expect_same(&meter_radiance(&c)[k], &meter_radiance(&b)[k], 0.2, "with glints");
    }
    lab_clear(&l);
}

static void explicit_in_fog(void)
{
    Ray ray = { .o = { 0, -3, 1 }, .d = { 0, 1, 0 }, .tmax = INFINITY };
    Meter a, b;
    Lab l;

    lab_init(&l);
    l.scene->around = medium(&l, rgb(0.05f, 0.1f, 0.2f), rgb(0.3f, 0.2f, 0.1f), 0.5f);
    lab_quad(&l, v3(-4, -4, 0), v3(8, 0, 0), v3(0, 8, 0),
             lab_material(&l, "diffuse", "reflectance=0.6"));
    lab_shine(&l, lab_sphere(&l, v3(0.8f, 0.3f, 1.6f), 0.4f, 0, false), "L=4/3/2");
    lab_build(&l);
    measure(&l, "maxdepth=4,strategy=explicit", ray, 50000, &a);
    measure(&l, "maxdepth=4,strategy=implicit", ray, 120000, &b);
    for (int k = 0; k < 3; k++)
        stat_expect_same(&meter_radiance(&a)[k], &meter_radiance(&b)[k], 0.2,
                         "explicit and implicit");
    lab_clear(&l);
}

/* ---- masks ---- */

/* Three sheets of opacity 0.3, 0.5 and 0 before a lamp; rays differ, since the rule is made of
 * their bits. A floor lit through them gets the same part of the light. */
static Ray jittered(const void *of, Sampler *s)
{
    V2 u = sample_2d(s, DECISION(DECIDE_PIXEL, 0));
    (void)of;
    return (Ray){ .o = { u.x - 0.5f, u.y - 0.5f, -1 }, .d = { 0, 0, 1 }, .tmax = INFINITY };
}

static void masks(void)
{
    static const float opacity[3] = { 0.3f, 0.5f, 0.0f };
    Gauge g = { jittered, NULL, 40000, 3, 0 };
    const double seen[3] = { 0.35, 0.35, 0.35 };
    uint32_t black;
    Meter m;
    Lab l;

    lab_init(&l);
    black = lab_material(&l, "diffuse", "reflectance=0");
    for (int i = 0; i < 3; i++)
        lab_quad(&l, v3(-2, -2, (float)i), v3(4, 0, 0), v3(0, 4, 0),
                 masked(&l, "diffuse", "reflectance=0", constant(&l, opacity[i])));
    lab_shine(&l, lab_quad(&l, v3(-3, -3, 4), v3(0, 6, 0), v3(6, 0, 0), black), "L=1");
    lab_build(&l);
    lab_open(&l, "");
    lab_measure(&l, &g, &m);
    stat_expect_rgb(meter_radiance(&m), seen, 0.1, "a lamp behind masks");
    lab_clear(&l);
}

static void masks_shadow(void)
{
    Gauge g = { jittered, NULL, 40000, 3, 0 };
    double truth = 0.7 * 2 / PI, lit[3];
    Meter m;
    Lab l;

    lab_init(&l);
    lab_quad(&l, v3(-2, -2, 0), v3(4, 0, 0), v3(0, 4, 0),
             lab_material(&l, "diffuse", "reflectance=1"));
    lab_quad(&l, v3(-2, -2, -3), v3(4, 0, 0), v3(0, 4, 0),
             masked(&l, "diffuse", "reflectance=0", constant(&l, 0.3f)));
    lab_light(&l, "distant", "from=0/0/-5,to=0/0/0,L=2", NULL);
    lab_build(&l);
    lab_open(&l, "maxdepth=1");
    lab_measure(&l, &g, &m);
    lit[0] = lit[1] = lit[2] = truth;
    stat_expect_rgb(meter_radiance(&m), lit, 0.1, "a floor behind a mask");
    lab_clear(&l);
}

/* A lamp with holes, met by chance or asked for. */
static void masks_lamp(void)
{
    static const char *const ways[] = { "maxdepth=1,strategy=implicit",
                                        "maxdepth=1,strategy=explicit" };
    Gauge g = { jittered, NULL, 250000, 3, 0 };
    Meter m[2];

    for (int i = 0; i < 2; i++) {
        Lab l;
        lab_init(&l);
        lab_quad(&l, v3(-2, -2, 0), v3(4, 0, 0), v3(0, 4, 0),
                 lab_material(&l, "diffuse", "reflectance=1"));
        lab_shine(&l, lab_sphere(&l, v3(1.0f, 0, -1.5f), 0.6f,
                                 masked(&l, "diffuse", "reflectance=0", constant(&l, 0.4f)), false),
                  "L=3,twosided=true");
        lab_build(&l);
        lab_open(&l, ways[i]);
        lab_measure(&l, &g, &m[i]);
        lab_clear(&l);
    }
    stat_expect_same(meter_radiance(&m[0]), meter_radiance(&m[1]), 0.1, "a lamp with holes");
}

const TestCase test_media[] = {
    { "absorbs", absorbs, false },
    { "absorbs_light", absorbs_light, false },
    { "phase", phase, false },
    { "furnace", furnace, false },
    { "single_scattering", single_scattering, false },
    { "ways_agree", ways_agree, false },
    { "explicit_in_fog", explicit_in_fog, false },
    { "masks", masks, false },
    { "masks_shadow", masks_shadow, false },
    { "masks_lamp", masks_lamp, false },
    { NULL, NULL, false }
};
