/* test_direct_weights.c -- weights of direct light, exactly: no noise.
 *
 * Partition   One event, a direction in which a light is met, can come about by asking the light or
 *             by scattering. Its two weights add up to 1, with either heuristic, any numbers of
 *             samples, points or directions, on surfaces and in media. (That each is the right one
 *             is asked in test_physics_weights.c, by densities from first principles.)
 * Kept        Given the tentative samples, the mean over what resampling keeps is the plain
 *             estimate by all of them. The one decision between them has few outcomes, which are
 *             gone through, see enumerate.h.
 * Toy         Errata 4.1: which probabilities make resampling quiet, and which make it 56 times
 *             worse; and that the program has the right ones. */
#include "base/random.h"
#include "integrators/lighting.h"
#include "test/enumerate.h"
#include "test/physics.h"

#include <stdio.h>
#include <string.h>

/* ---- partition ---- */

typedef struct { const char *options; float nl, ns; bool directions, all; } Weighing;

static Rgb striped(V3 w) { return rgb_all(w.z > 0.6f && w.x > 0 ? 0.9f : 0.1f); }

static void add_lights(Lab *l, bool picture)
{
    uint32_t black = lab_material(l, "diffuse", "reflectance=0");

    lab_shine(l, lab_quad(l, v3(-1, -1, 1), v3(0, 1.2f, 0), v3(1.2f, 0, 0), black),
              "L=1,sampling=solidangle");
    lab_shine(l, lab_quad(l, v3(-2, -2, 2), v3(0, 3, 0), v3(3, 0, 0), black), "L=1");
    lab_shine(l, lab_sphere(l, v3(1.2f, 1, 1), 0.5f, black, false), "L=1");
    lab_shine(l, lab_disk(l, v3(-1, 1.5f, 1), v3(0, 0, -1), 0.6f, 0, black), "L=1,twosided=true");
    if (picture)
        lab_sky(l, 16, 8, striped, NULL);
    else
        lab_light(l, "infinite", "L=0.05", NULL);
}

static float part(const Candidate *c, const Candidate *whole)
{
    return rgb_lum(c->c) / rgb_lum(whole->c);
}

/* By a sample of a light: both weights of what it has found. False: it is hidden, or black. */
static bool weights_of(const Lighting *it, const Weighing *w, const Turn *u, const Draw *draw,
                       Tracer *t, float *asked, float *met)
{
    Candidate c, alone, way, way_alone;
    float pdf_w;
    Rgb f_cos;
    V3 wi;

    if (!candidate_by_light(it, u, draw, w->nl, w->ns, t, &c) ||
        !candidate_by_light(it, u, draw, w->nl, 0, t, &alone))
        return false;
    *asked = part(&c, &alone);
    wi = v_unit(alone.ray.d);
    if (!c.known && !tracer_passes(t, &alone.ray, alone.medium, &alone.c))
        return false;
    if (!turn_f_cos(u, wi, &f_cos, &pdf_w) ||
        !candidate_along(it, u, wi, f_cos, w->ns * pdf_w, w->nl, t, &way) ||
        !candidate_along(it, u, wi, f_cos, w->ns * pdf_w, 0, t, &way_alone))
        return false;
    *met = part(&way, &way_alone);
    return true;
}

/* The sum of both weights, for many numbers; how many were of use. */
static int expect_partition(const Lighting *it, const Weighing *w, const Turn *u, Tracer *t,
                            const char *where)
{
    int n = 0;

    for (uint64_t i = 0; i < 400; i++) {
        uint64_t a = draw64(key_with(0, 7), i), b = draw64(key_with(0, 8), i);
        Draw draw = { unit_of((uint32_t)a), { unit_of((uint32_t)(a >> 32)),
                                              unit_of((uint32_t)b) } };
        float asked, met;
        if (!weights_of(it, w, u, &draw, t, &asked, &met))
            continue;
        n++;
        EXPECT(fabs((double)asked + met - 1) < 2e-5, "%s, %s, %g and %g samples%s: weights %.7g "
               "and %.7g", where, w->options, (double)w->nl, (double)w->ns,
               w->directions ? ", directions" : "", (double)asked, (double)met);
    }
    return n;
}

static void partition(void)
{
    static const Weighing ways[] = {
        { "heuristic=power", 1, 1, false, false }, { "heuristic=balance", 1, 1, false, false },
        { "heuristic=power", 3, 2, false, false }, { "heuristic=balance", 1, 7, false, false },
        { "heuristic=power", 1, 1, true, false }, { "heuristic=balance", 5, 2, true, false },
    };
    static const char *const floors[][2] = {
        { "diffuse", "reflectance=0.8" }, { "phong", "reflectance=0.3,specular=0.4,exponent=30" },
        { "conductor", "roughness=0.2" }, { "coateddiffuse", "roughness=0.3" },
        { "diffusetransmission", "reflectance=0.3,transmittance=0.4" },
    };

    for (size_t f = 0; f < sizeof floors / sizeof floors[0]; f++) {
        Ray r = ray_towards(v3(-1.1f, -0.5f, 0.9f), v3(0.1f, 0.2f, 0));
        Vertex v;
        Tracer t;
        Lab l;
        memset(&t, 0, sizeof t);
        lab_init(&l);
        lab_quad(&l, v3(-3, -3, 0), v3(6, 0, 0), v3(0, 6, 0),
                 lab_material(&l, floors[f][0], floors[f][1]));
        add_lights(&l, f & 1);
        lab_build(&l);
        t.scene = l.scene;
        REQUIRE(vertex_meet(&v, &r, &t), "the floor");
        for (size_t k = 0; k < sizeof ways / sizeof ways[0]; k++) {
            Turn on = turn_on(&v, r.d, NO_MEDIUM, 0);
            Turn within = { NULL, v3(0.1f, 0.2f, 0.4f), { 0, 0, 0 }, r.d, 0.6f, 0, NO_MEDIUM, 0,
                            { 1, 1, 1 } };
            Lighting it;
            Opts o;
            char method[100];
            int n;
            snprintf(method, sizeof method, "direct:%s", ways[k].options);
            lab_method(&l, method, &o);
            REQUIRE(lighting_init(&it, l.scene, &o, false, ways[k].directions), "lighting");
            lighting_shares(&it, (int)ways[k].nl, (int)ways[k].ns);
            n = expect_partition(&it, &ways[k], &on, &t, floors[f][0]);
            EXPECT(n > 100, "%s: only %d of 400", floors[f][0], n);
            n = f ? 200 : expect_partition(&it, &ways[k], &within, &t, "a medium");
            EXPECT(n > 100, "a medium: only %d of 400", n);
            lighting_clear(&it);
        }
        lab_clear(&l);
    }
}

/* ---- kept ---- */

/* What is tried has the numbers of what is done: lobe and direction. */
static float one(Sampler *s, Decision d)
{
    Sampler *of = s->state;
    bool tried = d % DECIDE_KINDS == DECIDE_TRY_LOBE;
    return sample_1d(of, tried ? d - DECIDE_TRY_LOBE + DECIDE_LOBE : d);
}
static V2 two(Sampler *s, Decision d)
{
    Sampler *of = s->state;
    bool tried = d % DECIDE_KINDS == DECIDE_TRY_DIRECTION;
    return sample_2d(of, tried ? d - DECIDE_TRY_DIRECTION + DECIDE_DIRECTION : d);
}
static const SamplerKind renamed = { .info = { "renamed", "", "", NULL }, .one = one, .two = two };

typedef struct { Lab *lab; Ray ray; } Look;

static void radiance(void *of, Sampler *s, double *values)
{
    const Look *x = of;
    Tracer t;
    Rgb c;

    memset(&t, 0, sizeof t);
    t.scene = x->lab->scene;
    t.sampler.kind = &renamed;
    t.sampler.state = s;
    c = x->lab->integrator->kind->radiance(x->lab->integrator, &x->ray, &t);
    values[0] = (double)c.r;
    values[1] = (double)c.g;
    values[2] = (double)c.b;
}

static void mean_over_kept(Look *x, const char *method, uint64_t seed, double mean[])
{
    Enumeration e;

    memset(&e, 0, sizeof e);
    e.rule[DECIDE_KEEP] = STEPS;
    e.n[DECIDE_KEEP] = 512;
    e.seed = seed;
    lab_open(x->lab, method);
    enumerate_mean(&e, radiance, x, mean);
}

static void kept(void)
{
    static const char *const pairs[][2] = {
        { "direct:strategy=ris,lightshare=1,tentative=4,samples=1",
          "direct:strategy=light,lightsamples=4" },
        { "direct:strategy=ris,lightshare=1,tentative=6,samples=3,lightsampler=uniform",
          "direct:strategy=light,lightsamples=6,lightsampler=uniform" },
        { "direct:strategy=ris,lightshare=0,tentative=5,samples=2",
          "direct:strategy=brdf,bsdfsamples=5" },
        { "direct:strategy=ris,lightshare=0.5,tentative=6,samples=4",
          "direct:strategy=mis,lightsamples=3,bsdfsamples=3" },
        { "direct:strategy=ris,lightshare=0.75,tentative=4,samples=8,heuristic=balance",
          "direct:strategy=mis,lightsamples=3,bsdfsamples=1,heuristic=balance" },
        { "direct:strategy=ris,tentative=4,samples=1,occlusion=directions",
          "direct:strategy=mis,lightsamples=2,bsdfsamples=2,occlusion=directions" },
        { "path:strategy=ris,tentative=4,lightshare=1,maxdepth=1",
          "direct:strategy=light,lightsamples=4" },
    };
    Look x;
    Lab l;

    lab_init(&l);
    lab_quad(&l, v3(-3, -3, 0), v3(6, 0, 0), v3(0, 6, 0),
             lab_material(&l, "phong", "reflectance=0.4/0.3/0.2,specular=0.4,exponent=10"));
    lab_sphere(&l, v3(0.4f, 0.4f, 0.4f), 0.3f, lab_material(&l, "diffuse", ""), false);
    add_lights(&l, false);
    lab_build(&l);
    x.lab = &l;
    x.ray = ray_towards(v3(-1.1f, -0.5f, 0.9f), v3(0.1f, 0.2f, 0));
    for (size_t k = 0; k < sizeof pairs / sizeof pairs[0]; k++) {
        int lit = 0, seeds = 30;
        for (uint64_t seed = 0; seed < (uint64_t)seeds; seed++) {
            double got[ENUMERATE_VALUES], all[ENUMERATE_VALUES];
            mean_over_kept(&x, pairs[k][0], seed, got);
            mean_over_kept(&x, pairs[k][1], seed, all);
            lit += all[1] > 0;
            for (int c = 0; c < 3; c++)
                EXPECT(fabs(got[c] - all[c]) <= 2e-5 * all[c], "%s: the mean over what is kept is "
                       "%.9g, of all %.9g", pairs[k][0], got[c], all[c]);
        }
        EXPECT(lit > seeds / 2, "%s: only %d of %d lit", pairs[k][0], lit, seeds);
    }
    lab_clear(&l);
}

/* ---- errata 4.1 ---- */

/* A peak on a plain, drawn uniformly: integral 0.1753, of the square 0.1036. */
static double peak(double x)
{
    double d = (x - 0.4) / 0.05;
    return 0.05 + md_exp(-0.5 * d * d);
}

typedef enum { RIGHT, ALIKE, PRINTED } Rule;

/* One of four tentative samples over its probability: (4.9) without visibility. */
static double resampled(Rule rule, uint64_t i)
{
    double f[4], q[4], all = 0, before = 0, x;
    int k = 0;

    for (int j = 0; j < 4; j++) {
        f[j] = peak((double)(draw64(key_with(0, 40 + (uint64_t)j), i) >> 11) * 0x1p-53);
        q[j] = rule == RIGHT ? f[j] : rule == ALIKE ? 1 : 1 / f[j];
        all += q[j];
    }
    x = (double)(draw64(key_with(0, 44), i) >> 11) * 0x1p-53 * all;
    while (k < 3 && before + q[k] <= x)
        before += q[k++];
    return 0.25 * f[k] * all / q[k];
}

static void erratum(void)
{
    static const struct { const char *name; double variance; } rules[] = {
        { "the right ones", 0.018 }, { "all alike", 0.073 }, { "as printed", 1.016 }
    };
    enum { RUNS = 200000 };

    for (int rule = RIGHT; rule <= PRINTED; rule++) {
        Stat s = { 0, 0, 0, 0, 0 };
        double v;
        for (uint64_t i = 0; i < RUNS; i++)
            stat_add(&s, resampled((Rule)rule, i));
        v = s.squares / (s.n - 1);
        EXPECT(fabs(s.mean - 0.1753) < 5.6 * stat_error(&s), "probabilities %s: mean %.4f, it is "
               "0.1753", rules[rule].name, s.mean);
        EXPECT(fabs(v / rules[rule].variance - 1) < 0.1, "probabilities %s: variance %.4f, the "
               "errata have %.3f", rules[rule].name, v, rules[rule].variance);
    }
}

/* The toy as light: a sky whose radiance is the peak by height, 4 pi times that of the toy, seen by
 * a point that scatters alike in all directions. So f / p is peak(x), x uniform. */
static Rgb peak_sky(V3 w) { return rgb_all((float)peak(0.5 + 0.5 * (double)w.z)); }

static double scattered(const Lighting *it, const Resampling *r, Sampler *s)
{
    Turn u = { NULL, { 0, 0, 0 }, { 0, 0, 0 }, { 0, 0, 1 }, 0, 0, NO_MEDIUM, 0,
               { 1, 1, 1 } };
    Stat st = { 0, 0, 0, 0, 0 };
    Tracer t;

    memset(&t, 0, sizeof t);
    t.scene = it->scene;
    t.sampler = *s;
    for (uint32_t i = 0; i < 60000; i++) {
        sampler_start(&t.sampler, i);
        stat_add(&st, (double)rgb_lum(resample(it, r, &u, &t)));
    }
    EXPECT(fabs(st.mean - 0.1753) < 5.6 * stat_error(&st) + 0.0002, "%d of %d: mean %.4f, it is "
           "0.1753", r->kept, r->by_scattering, st.mean);
    return st.squares / (st.n - 1);
}

/* One of one is the plain estimate; of four, the right probabilities leave only the spread of the
 * sum, and strata among the four less than that. */
static void program(void)
{
    const SamplerKind *random = kind_find(samplers, "random");
    double one_of_one, one_of_four;
    Resampling r;
    Lighting it;
    uint32_t spp = 1;
    Sampler s;
    Opts o;
    Lab l;

    lab_init(&l);
    lab_sky(&l, 8, 4096, peak_sky, NULL);
    lab_build(&l);
    lab_method(&l, "direct:strategy=ris", &o);
    REQUIRE(lighting_init(&it, l.scene, &o, true, false), "lighting");
    opts_default(&o, random->info.options);
    REQUIRE(sampler_init(&s, random, &o, 5, &spp), "sampler");
    r = resampling_of(1, 1, 0);
    one_of_one = scattered(&it, &r, &s);
    EXPECT(fabs(one_of_one / 0.073 - 1) < 0.1, "one of one: variance %.4f, not 0.073", one_of_one);
    r = resampling_of(4, 1, 0);
    one_of_four = scattered(&it, &r, &s);
    EXPECT(one_of_four < 1.1 * 0.018, "one of four: variance %.4f, above 0.018", one_of_four);
    sampler_clear(&s);
    lighting_clear(&it);
    lab_clear(&l);
}

const TestCase test_direct_weights[] = {
    { "partition", partition, false },
    { "kept", kept, false },
    { "erratum", erratum, false },
    { "program", program, false },
    { NULL, NULL, false }
};
