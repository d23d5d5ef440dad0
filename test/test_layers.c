/* test_layers.c -- models of a coat over a base against random walks through the two layers, each
 * of them a model of bsdfs[]. Where facets are rough one walk comes out with too little: each
 * meeting loses what facets throw onto one another. The other walk gives that back at each meeting,
 * as if it had met no metal on its way among the facets: it comes out with too much, if anything.
 * The truth lies between the two; where all is smooth they are one. */
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

static double once(const Bsdf *b, V3 wo, Rng *rng)
{
    Rgb weight = rgb_all(1.0f);
    V3 to;
    return step(b, wo, rng, &weight, &to) ? (double)rgb_lum(weight) : 0;
}

/* What facets that absorb nothing throw back and through, by the cosine of where light comes from,
 * from behind as well. */
enum { COSINES = 16 };
typedef struct { bool smooth; double left[2][COSINES]; } Facets;

static void facets_measure(Facets *f, const Bsdf *lossless, bool smooth, int draws)
{
    Rng rng = rng_seed(77);

    f->smooth = smooth;
    for (int k = 0; !smooth && k < 2 * COSINES; k++) {
        float z = ((float)(k / 2) + 0.5f) / COSINES;
        V3 from = { sqrtf(1.0f - z * z), 0, k % 2 ? -z : z };
        double sum = 0;
        for (int i = 0; i < draws; i++)
            sum += once(lossless, from, &rng);
        f->left[k % 2][k / 2] = sum / draws;
    }
}

static double facets_left(const Facets *f, V3 from)
{
    double at = fabs((double)from.z) * COSINES - 0.5;
    int k = at < 0 ? 0 : at > COSINES - 2 ? COSINES - 2 : (int)at;
    const double *left = f->left[from.z < 0.0f];

    at = at < k ? 0 : at > k + 1 ? 1 : at - k;
    return f->smooth ? 1 : (1 - at) * left[k] + at * left[k + 1];
}

typedef struct { Bsdf coat, base; Facets coat_facets, base_facets; } Layers;

/* What a particle that comes from wo brings out again; *whole: with what facets lost given back. */
static double walk(const Layers *l, V3 wo, Rng *rng, double *whole)
{
    Rgb weight = rgb_all(1.0f);
    double back = 1;
    V3 at = wo, to;

    *whole = 0;
    for (int n = 0; n < 1000; n++) {
        back /= facets_left(&l->coat_facets, at);
        if (!step(&l->coat, at, rng, &weight, &to))
            return 0;
        if (to.z > 0.0f) {
            *whole = (double)rgb_lum(weight) * back;
            return (double)rgb_lum(weight);
        }
        back /= facets_left(&l->base_facets, v_neg(to));
        if (!step(&l->base, v_neg(to), rng, &weight, &to))
            return 0;
        at = v_neg(to);
    }
    return 0;
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

/* The model returns what lies between the walks, up to `off`. */
static void check(const char *what, const Layers *l, const Bsdf *both, double off)
{
    int draws = test_is_long() ? 400000 : 10000;

    for (int k = 0; k < 5; k++) {
        float z = 1.0f - 0.2f * (float)k;
        V3 wo = { sqrtf(1.0f - z * z), 0, z };
        Rng rng = rng_seed(900 + (uint64_t)k);
        Mean is = { 0, 0, 0 }, least = { 0, 0, 0 }, most = { 0, 0, 0 };
        for (int i = 0; i < draws; i++) {
            double whole;
            add(&is, once(both, wo, &rng));
            add(&least, walk(l, wo, &rng, &whole));
            add(&most, whole);
        }
        EXPECT(mean(&is) >= mean(&least) - off - 4.5 * hypot(error(&is), error(&least)) - 1e-6 &&
               mean(&is) <= mean(&most) + off + 4.5 * hypot(error(&is), error(&most)) + 1e-6,
               "%s, cosine %g: %.4f, the walks return %.4f and %.4f", what, (double)z, mean(&is),
               mean(&least), mean(&most));
    }
}

/* A matt base: no angle is special. */
static void diffuse(void)
{
    static const struct { float rho, alpha; } rows[] = {
        { 1, 0 }, { 0.5f, 0 }, { 0.1f, 0 }, { 0.5f, 0.1f }, { 0.1f, 0.1f }, { 0.1f, 0.3f },
        { 0.5f, 0.3f }
    };
    int draws = test_is_long() ? 40000 : 4000;

    for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
        char text[120], what[160];
        Layers l;
        Bsdf both;
        snprintf(text, sizeof text, "eta=1.5,remaproughness=off,roughness=%g", rows[i].alpha);
        model(&l.coat, "dielectric", text);
        snprintf(text, sizeof text, "reflectance=%g", rows[i].rho);
        model(&l.base, "diffuse", text);
        facets_measure(&l.coat_facets, &l.coat, rows[i].alpha == 0.0f, draws);
        facets_measure(&l.base_facets, &l.base, true, draws);
        snprintf(text, sizeof text, "reflectance=%g,remaproughness=off,roughness=%g", rows[i].rho,
                 rows[i].alpha);
        model(&both, "coateddiffuse", text);
        snprintf(what, sizeof what, "coateddiffuse:%s", text);
        check(what, &l, &both, 0.004);
    }
}

/* The metal of the walk has its index over the coat's. */
static void metal(Bsdf *b, bool white, float roughness)
{
    char text[120];

    snprintf(text, sizeof text, "eta=%s,k=%s,remaproughness=off,roughness=%g",
             white ? "0.0625" : "0.125/0.5625/0.6875", white ? "500" : "2.4375/1.5/1.3125",
             roughness);
    model(b, "conductor", text);
}

static void conductor(void)
{
    /* off: by how much the model is approximate, as its head says */
    static const struct { float coat, metal; bool white; double off; } rows[] = {
        { 0, 0, true, 0 }, { 0, 0, false, 0 }, { 0, 0.1f, true, 0.03 }, { 0, 0.1f, false, 0.04 },
        { 0.1f, 0, false, 0.09 }, { 0.1f, 0.1f, true, 0.01 }, { 0, 0.3f, false, 0.01 },
        { 0.1f, 0.3f, false, 0.01 }, { 0.3f, 0.3f, true, 0.01 }
    };
    int draws = test_is_long() ? 40000 : 4000;

    for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
        char text[200], what[260];
        Layers l;
        Bsdf both, mirror;
        snprintf(text, sizeof text, "eta=1.6,remaproughness=off,roughness=%g", rows[i].coat);
        model(&l.coat, "dielectric", text);
        metal(&l.base, rows[i].white, rows[i].metal);
        metal(&mirror, true, rows[i].metal);
        facets_measure(&l.coat_facets, &l.coat, rows[i].coat == 0.0f, draws);
        facets_measure(&l.base_facets, &mirror, rows[i].metal == 0.0f, draws);
        snprintf(text, sizeof text, "conductor.eta=%s,conductor.k=%s,remaproughness=off,"
                 "interface.eta=1.6,interface.roughness=%g,conductor.roughness=%g",
                 rows[i].white ? "0.1" : "0.2/0.9/1.1", rows[i].white ? "800" : "3.9/2.4/2.1",
                 rows[i].coat, rows[i].metal);
        model(&both, "coatedconductor", text);
        snprintf(what, sizeof what, "coatedconductor:%s", text);
        check(what, &l, &both, rows[i].off);
    }
}

const TestCase test_layers[] = {
    { "diffuse", diffuse, false },
    { "conductor", conductor, false },
    { NULL, NULL, false }
};
