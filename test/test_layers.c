/* test_layers.c -- models of a coat over a base against a random walk through the two layers, each
 * of them a model of bsdfs[]: what comes out of it is the truth where facets lose no light, and too
 * little where they are rough, since each meeting of the walk with facets loses what these throw
 * onto one another. */
#include "base/mem.h"
#include "base/random.h"
#include "bsdf/bsdf.h"
#include "test/test.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

static void model(Bsdf *b, const char *kind, const char *options)
{
    const BsdfKind *k = kind_find(bsdfs, kind);
    Rgb value[OPT_MAX] = { { 0 } };
    Arena arena = { 0 };
    Opts o;

    REQUIRE(k, "no model %s", kind);
    opts_default(&o, k->info.options);
    REQUIRE(opts_parse(&o, kind, options, &arena), "options of %s", kind);
    for (int i = 0; o.defs[i].key; i++)
        value[i] = o.defs[i].type == OPT_RGB ? o.value[i].rgb : rgb_all((float)o.value[i].num);
    bsdf_make(b, k, value, NULL);
    arena_clear(&arena);
}

static bool step(const Bsdf *b, V3 from, Rng *rng, Rgb *weight, V3 *to)
{
    float lobe = rng_unit(rng);
    V2 u = { rng_unit(rng), 0 };
    BsdfSample s;

    u.y = rng_unit(rng);
    if (!b->kind->sample(b, from, lobe, u, true, &s))
        return false;
    *weight = rgb_mul(*weight, s.weight);
    *to = s.wi;
    return true;
}

/* What a particle that comes from wo brings out again. */
static double walk(const Bsdf *coat, const Bsdf *base, V3 wo, Rng *rng)
{
    Rgb weight = rgb_all(1.0f);
    V3 at = wo, to;

    for (int n = 0; n < 1000; n++) {
        if (!step(coat, at, rng, &weight, &to))
            return 0;
        if (to.z > 0.0f)
            return (double)rgb_lum(weight);
        if (!step(base, v_neg(to), rng, &weight, &to))
            return 0;
        at = v_neg(to);
    }
    return 0;
}

static double once(const Bsdf *b, V3 wo, Rng *rng)
{
    Rgb weight = rgb_all(1.0f);
    V3 to;
    return step(b, wo, rng, &weight, &to) ? (double)rgb_lum(weight) : 0;
}

/* Mean of n, and its standard error. */
typedef struct { double sum, sum2; int n; } Mean;
static void add(Mean *m, double x)
{
    m->sum += x;
    m->sum2 += x * x;
    m->n++;
}
static double mean(const Mean *m) { return m->sum / m->n; }
static double error(const Mean *m)
{
    return sqrt(fabs(m->sum2 / m->n - mean(m) * mean(m)) / m->n);
}

/* The model returns what the walk does, up to `less` less and `more` more. */
static void check(const char *what, const Bsdf *coat, const Bsdf *base, const Bsdf *both,
                  double less, double more)
{
    int draws = test_is_long() ? 400000 : 10000;

    for (int k = 0; k < 5; k++) {
        float z = 1.0f - 0.2f * (float)k;
        V3 wo = { sqrtf(1.0f - z * z), 0, z };
        Rng rng = rng_seed(900 + (uint64_t)k);
        Mean is = { 0, 0, 0 }, truth = { 0, 0, 0 };
        double noise;
        for (int i = 0; i < draws; i++) {
            add(&is, once(both, wo, &rng));
            add(&truth, walk(coat, base, wo, &rng));
        }
        noise = 4.5 * hypot(error(&is), error(&truth)) + 1e-6;
        EXPECT(mean(&is) >= mean(&truth) - less - noise && mean(&is) <= mean(&truth) + more + noise,
               "%s, cosine %g: %.4f, the walk returns %.4f", what, (double)z, mean(&is),
               mean(&truth));
    }
}

/* A matt base: no angle is special, and a smooth coat loses nothing. Its facets, if it is rough,
 * lose in the walk. */
static void diffuse(void)
{
    static const struct { float rho, alpha; double more; } rows[] = {
        { 1, 0, 0.004 }, { 0.5f, 0, 0.004 }, { 0.1f, 0, 0.004 }, { 0.5f, 0.1f, 0.02 },
        { 0.1f, 0.1f, 0.01 }, { 0.1f, 0.3f, 0.01 }, { 0.5f, 0.3f, 0.06 }
    };
    for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
        char text[120], what[160];
        Bsdf coat, base, both;
        snprintf(text, sizeof text, "eta=1.5,remaproughness=off,roughness=%g", rows[i].alpha);
        model(&coat, "dielectric", text);
        snprintf(text, sizeof text, "reflectance=%g", rows[i].rho);
        model(&base, "diffuse", text);
        snprintf(text, sizeof text, "reflectance=%g,remaproughness=off,roughness=%g", rows[i].rho,
                 rows[i].alpha);
        model(&both, "coateddiffuse", text);
        snprintf(what, sizeof what, "coateddiffuse:%s", text);
        check(what, &coat, &base, &both, 0.004, rows[i].more);
    }
}

/* The metal of the walk has its index over the coat's. White ones lose light only by facets. */
static void conductor(void)
{
    static const struct { float coat, metal; bool white; double less, more; } rows[] = {
        { 0, 0, true, 0, 0 }, { 0, 0, false, 0, 0 }, { 0, 0.1f, true, 0.03, 0.02 },
        { 0, 0.1f, false, 0.01, 0.04 }, { 0.1f, 0, false, 0.01, 0.12 },
        { 0.1f, 0.1f, true, 0.01, 0.09 }, { 0, 0.3f, false, 0.01, 0.13 },
        { 0.1f, 0.3f, false, 0.01, 0.14 }, { 0.3f, 0.3f, true, 0.01, 0.34 }
    };
    for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
        char text[200], what[260];
        Bsdf coat, base, both;
        snprintf(text, sizeof text, "eta=1.6,remaproughness=off,roughness=%g", rows[i].coat);
        model(&coat, "dielectric", text);
        snprintf(text, sizeof text, "eta=%s,k=%s,remaproughness=off,roughness=%g",
                 rows[i].white ? "0.0625" : "0.125/0.5625/0.6875",
                 rows[i].white ? "500" : "2.4375/1.5/1.3125", rows[i].metal);
        model(&base, "conductor", text);
        snprintf(text, sizeof text, "conductor.eta=%s,conductor.k=%s,remaproughness=off,"
                 "interface.eta=1.6,interface.roughness=%g,conductor.roughness=%g",
                 rows[i].white ? "0.1" : "0.2/0.9/1.1", rows[i].white ? "800" : "3.9/2.4/2.1",
                 rows[i].coat, rows[i].metal);
        model(&both, "coatedconductor", text);
        snprintf(what, sizeof what, "coatedconductor:%s", text);
        check(what, &coat, &base, &both, rows[i].less, rows[i].more);
    }
}

const TestCase test_layers[] = {
    { "diffuse", diffuse, false },
    { "conductor", conductor, false },
    { NULL, NULL, false }
};
