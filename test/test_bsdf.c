/* test_bsdf.c -- every model of bsdfs[] samples what it states, keeps energy and reciprocity, and
 * equals a naive twin of its formula. */
#include "base/file.h"
#include "base/mem.h"
#include "base/number.h"
#include "base/random.h"
#include "bsdf/bsdf.h"
#include "bsdf/fresnel.h"
#include "bsdf/ggx.h"
#include "bsdf/merl.h"
#include "sampling/warp.h"
#include "test/chi2.h"
#include "test/test.h"

#include <stdio.h>
#include <string.h>

/* ---- what is tested: models with parameters, directions ---- */

typedef struct { const char *kind, *options; } Case;

/* A kind that is not here is tested with its defaults. */
static const Case cases[] = {
    { "diffuse", "reflectance=1" },
    { "diffuse", "reflectance=0.9/0.2/0" },
    { "phong", "reflectance=0,specular=1,exponent=0" },
    { "phong", "reflectance=0,specular=1,exponent=1" },
    { "phong", "reflectance=0.5,specular=0.5/0.2/0.4,exponent=10" },
    { "phong", "reflectance=0,specular=1,exponent=100" },
    { "phong", "reflectance=0.3/0/0.1,specular=0.7,exponent=1000" },
    { "phong", "reflectance=0.9/0.8/1,specular=0.9,exponent=30.5" },     /* more than 1 */
    { "mirror", "reflectance=0.8/0.9/1" },
    { "dielectric", "eta=1.5" },
    { "dielectric", "eta=0.75,reflectance=0.5/1/0.2,transmittance=0.3/0.9/1" },
    { "dielectric", "eta=1.5,roughness=0.3,remaproughness=false" },
    { "dielectric", "eta=1.33,roughness=1" },
    { "dielectric", "eta=0.6,roughness=0.1,reflectance=0.5/1/0.2,transmittance=0.3/0.9/1" },
    { "dielectric", "eta=2.4,uroughness=0.6,vroughness=0.1,remaproughness=false" },
    { "thindielectric", "eta=1.5" },
    { "thindielectric", "eta=2.2,reflectance=0.5/1/0.2,transmittance=0.3/0.9/1" },
    { "orennayar", "reflectance=1,sigma=15" },
    { "orennayar", "reflectance=1,sigma=30" },
    { "orennayar", "reflectance=0.8/0.5/0.1,sigma=80" },
    { "diffusetransmission", "reflectance=0.6,transmittance=0.4" },
    { "diffusetransmission", "reflectance=0.9/0.2/0.1,transmittance=0.3/0.9/0.8" },   /* more */
    { "diffusetransmission", "reflectance=0,transmittance=0.7/0.1/0" },
    { "ashikhminshirley", "reflectance=1,specular=0,nu=0,nv=0" },
    { "ashikhminshirley", "reflectance=1,specular=0.1,nu=5,nv=5" },
    { "ashikhminshirley", "reflectance=0.5/0.2/1,specular=0.5/0.1/0,nu=10,nv=1000" },
    { "ashikhminshirley", "reflectance=0,specular=0.9,nu=2000,nv=1" },
    { "ashikhminshirley", "reflectance=1,specular=0.05,uroughness=0.1,vroughness=0.4" },
    { "ward", "reflectance=0,specular=1,roughness=0.5" },
    { "ward", "reflectance=0.3/0.5/0,specular=0.7/0.2/1,uroughness=0.05,vroughness=0.3" },
    { "ward", "reflectance=0,specular=1,uroughness=1,vroughness=0.02" },
    { "ward", "reflectance=0.5,specular=0.5,roughness=0.08" },
    { "blinn", "reflectance=0,specular=1,exponent=0" },
    { "blinn", "reflectance=0,specular=1,exponent=50" },
    { "blinn", "reflectance=0.6/0.2/0.9,specular=0.9,exponent=1000,eta=1.5" },
    { "blinn", "reflectance=0,specular=1,exponent=5,eta=2" },
    { "lafortune", "reflectance=0.4;-1 -1 1 20 .5 .4 .3" },
    { "lafortune", "reflectance=0;-1 -1 .8 30 .5 .4 .3  1 1 1 8 .1 .2 .1  -.9 -.5 .7 3 .2 .1 .1" },
    { "lafortune", "reflectance=0.9/0.3/0;-1.2 -1.2 .9 12 1 1 1  0 0 1 5 .1 .1 .1" },
    { "lafortune", "reflectance=0.1;1 1 1 500 .9 .9 .9  -1 -1 -.2 4 .3 .3 .3" },
    { "measured", "" },
    { "mix", "amount=0.3/0.9/0;phong:exponent=50;diffuse:reflectance=0.9" },
    { "mix", "amount=0.6;dielectric:roughness=0.2;diffusetransmission:" },
    { "mix", "amount=0.5;mirror:;coateddiffuse:roughness=0.3" },
    { "mix", "amount=0.7;conductor:uroughness=0.5,vroughness=0.02;orennayar:" },
    { "conductor", "roughness=1,reflectance=1" },
    { "conductor", "roughness=0.25" },
    { "conductor", "roughness=0.05,remaproughness=false,reflectance=0.9/0.5/0.1" },
    { "conductor", "uroughness=0.7,vroughness=0.1,remaproughness=false" },
    { "conductor", "uroughness=0.03,vroughness=0.5,remaproughness=false,eta=1.5,k=0" },
    { "conductor", "roughness=0.02,remaproughness=false,reflectance=1" },
    { "conductor", "roughness=0,eta=0.2/0.9/1.1,k=3.9/2.4/2.1" },
    { "coateddiffuse", "reflectance=1,roughness=0" },
    { "coateddiffuse", "reflectance=1,roughness=1" },
    { "coateddiffuse", "reflectance=0.8/0.2/0,roughness=0.1,eta=1.3" },
    { "coateddiffuse", "reflectance=0.5,roughness=0.05,remaproughness=false,eta=2.5" },
    { "coateddiffuse", "reflectance=1,uroughness=0.6,vroughness=0.1,remaproughness=false" },
    { "coateddiffuse", "reflectance=0.9,roughness=0.2,specular=0.3/0/0.1" },
    { "coateddiffuse", "reflectance=0,roughness=0.3,remaproughness=false" },
    { "coatedconductor", "" },
    { "coatedconductor", "conductor.roughness=0.05" },
    { "coatedconductor", "conductor.roughness=1,reflectance=1" },
    { "coatedconductor", "interface.roughness=0.1,interface.eta=1.3,reflectance=0.9/0.3/0.1" },
    { "coatedconductor", "interface.roughness=0.3,conductor.roughness=0.4,reflectance=1" },
    { "coatedconductor", "conductor.uroughness=0.02,conductor.vroughness=0.5,interface.eta=2" },
    { "coatedconductor", "interface.uroughness=0.5,interface.vroughness=0.05,remaproughness=off" },
};
enum { NCASES = sizeof cases / sizeof *cases, NWO = 20, MOST = 128 };

typedef struct {
    Bsdf b, part[2];
    char name[200];
    float eta;                  /* of what is below the surface, if that is another medium */
} Model;

static const BsdfKind *kind_of(const char *kind, const char *options, Arena *arena, Opts *o,
                               Rgb *value)
{
    const BsdfKind *k = kind_find(bsdfs, kind);

    REQUIRE(k, "no model %s", kind);
    opts_default(o, k->info.options);
    REQUIRE(opts_parse(o, kind, options, arena), "options of %s", kind);
    for (int i = 0; o->defs && o->defs[i].key; i++)
        value[i] = o->defs[i].type == OPT_RGB ? o->value[i].rgb : rgb_all((float)o->value[i].num);
    return k;
}

/* Data that load() made stays with the process: cases are short-lived. */
static void bsdf_of(Bsdf *b, const char *kind, const char *options, const Param *extra)
{
    Arena arena = { 0 };
    Opts o;
    Rgb value[OPT_MAX] = { { 0 } };
    void *data = NULL;
    const BsdfKind *k = kind_of(kind, options, &arena, &o, value);

    for (int i = 0; extra && o.defs[i].key; i++)
        if (!strcmp(o.defs[i].key, extra->name))
            o.value[i].param = extra;
    if (k->load)
        REQUIRE(k->load(&o, NULL, &data), "load of %s", kind);
    bsdf_make(b, k, value, data);
    arena_clear(&arena);
}

/* The options of a lafortune are "its own;numbers of lobes". */
static void lafortune_of(Model *m, const char *options)
{
    static double v[105];
    Param p = { .name = "lobes", .type = "float", .kind = PARAM_FLOAT, .numbers = v };
    const char *s = strchr(options, ';'), *end = options + strlen(options);
    char own[200];

    snprintf(own, sizeof own, "%.*s", (int)(s - options), options);
    for (s++; s < end; p.n++) {
        while (*s == ' ')
            s++;
        REQUIRE(p.n < 105, "lobes");
        s += number_double(s, end, &v[p.n]);
        while (*s == ' ')
            s++;
    }
    bsdf_of(&m->b, "lafortune", own, &p);
}

/* ---- a measured table, of a made-up surface ---- */

enum { MERL_H = 40, MERL_D = 30, MERL_P = 24, MERL_BYTES = 12 + 24 * MERL_H * MERL_D * MERL_P };

static double merl_truth(double theta_h, double theta_d, double phi_d)
{
    double s = md_sin(theta_d);
    return 0.1 + 0.35 * md_exp(-theta_h * theta_h / 0.09) * (1.0 + 0.5 * theta_d) +
           0.03 * md_cos(2.0 * phi_d) * s * s;
}

static void put_u32(unsigned char *b, uint32_t v)
{
    for (int i = 0; i < 4; i++)
        b[i] = (unsigned char)(v >> 8 * i);
}

static void put_double(unsigned char *b, double x)
{
    uint64_t bits;
    memcpy(&bits, &x, sizeof bits);
    put_u32(b, (uint32_t)bits);
    put_u32(b + 4, (uint32_t)(bits >> 32));
}

static void merl_fill(unsigned char *b)
{
    static const double scale[3] = { 1500.0, 0.5 * 1500.0 / 1.15, 0.25 * 1500.0 / 1.66 };
    size_t i = 12;

    put_u32(b, MERL_H);
    put_u32(b + 4, MERL_D);
    put_u32(b + 8, MERL_P);
    for (int c = 0; c < 3; c++)
        for (int h = 0; h < MERL_H; h++)
            for (int d = 0; d < MERL_D; d++)
                for (int p = 0; p < MERL_P; p++, i += 8) {
                    double root = (h + 0.5) / MERL_H;
                    put_double(b + i, scale[c] * merl_truth(0.5 * PI * root * root,
                                   0.5 * PI * (d + 0.5) / MERL_D, PI * (p + 0.5) / MERL_P));
                }
}

static void measured_of(Bsdf *b)
{
    static unsigned char bytes[MERL_BYTES];
    static const BsdfFiles files = { "", 1 << 30 };
    const BsdfKind *k = kind_find(bsdfs, "measured");
    char path[500];
    void *data;
    Opts o;

    merl_fill(bytes);
    snprintf(path, sizeof path, "%s/made-up.binary", test_folder());
    REQUIRE(file_write(path, bytes, sizeof bytes), "cannot write");
    opts_default(&o, k->info.options);
    o.value[0].str = path;
    REQUIRE(k->load(&o, &files, &data), "refused");
    bsdf_make(b, k, NULL, data);
}

/* The options of a mix are "its own;kind:options;kind:options". */
static void mix_of(Model *m, const char *options)
{
    char text[200], *semicolon, *colon = NULL;

    snprintf(text, sizeof text, "%s", options);
    for (int k = 1; k >= 0; k--) {
        semicolon = strrchr(text, ';');
        REQUIRE(semicolon && (colon = strchr(semicolon, ':')), "a mix without parts: %s", options);
        *semicolon = *colon = 0;
        bsdf_of(&m->part[k], semicolon + 1, colon + 1, NULL);
    }
    bsdf_of(&m->b, "mix", text, NULL);
    mix_parts(&m->b, &m->part[0], &m->part[1]);
}

static float eta_in(const char *text)
{
    double v = 0.0;
    REQUIRE(number_double(text, text + strlen(text), &v), "eta");
    return (float)v;
}

static void model_make(Model *m, const char *kind, const char *options)
{
    const char *eta = strstr(options, "eta=");

    if (!strcmp(kind, "measured"))
        measured_of(&m->b);
    else if (!strcmp(kind, "mix"))
        mix_of(m, *options ? options : "amount=0.4;phong:;diffuse:");
    else if (strchr(options, ';'))
        lafortune_of(m, options);
    else
        bsdf_of(&m->b, kind, options, NULL);
    m->eta = 1.0f;
    if (!strcmp(kind, "dielectric") || strstr(options, ";dielectric:"))
        m->eta = eta ? eta_in(eta + 4) : 1.5f;
    snprintf(m->name, sizeof m->name, "%s:%s", kind, options);
}

/* All cases, and the defaults of kinds that have none. */
static int models_make(Model *m)
{
    int n = 0;
    for (; n < NCASES; n++)
        model_make(&m[n], cases[n].kind, cases[n].options);
    for (int k = 0; bsdfs[k]; k++) {
        bool have = false;
        for (int i = 0; i < NCASES; i++)
            have = have || !strcmp(cases[i].kind, bsdfs[k]->info.name);
        if (!have && n < MOST)
            model_make(&m[n++], bsdfs[k]->info.name, "");
    }
    return n;
}

/* From the normal to 89.9 degrees, three from below. */
static V3 wo_of(int k)
{
    static const float theta[NWO] = {
        0, 10, 20, 30, 40, 50, 60, 65, 70, 75, 80, 83, 85, 87, 88.5f, 89.5f, 89.9f, 100, 130, 170
    };
    float t = theta[k] * PI_F / 180.0f, phi = 0.7f + (float)k;
    return v_unit(v3(m_sin(t) * m_cos(phi), m_sin(t) * m_sin(phi), k ? m_cos(t) : 1.0f));
}

/* Which of them model i is tried from: all in long tests, else every fifth, the first another one
 * for each model. */
static bool looks_from(int i, int k) { return test_is_long() || k % 5 == i % 5; }

static V2 unit2(Rng *rng)
{
    float x = rng_unit(rng);
    return (V2){ x, rng_unit(rng) };
}

static V3 any_direction(Rng *rng) { return v_unit(warp_sphere(unit2(rng))); }

static bool is_delta(const Model *m)
{
    return !(m->b.flags & BSDF_SMOOTH);
}

/* True if the two agree to `part` of the larger. */
static bool close(double a, double b, double part)
{
    return fabs(a - b) <= part * (fabs(a) > fabs(b) ? fabs(a) : fabs(b));
}
static bool close_rgb(Rgb a, Rgb b, double part)
{
    double most = rgb_max(a) > rgb_max(b) ? rgb_max(a) : rgb_max(b);
    return fabs(a.r - b.r) <= part * most && fabs(a.g - b.g) <= part * most &&
           fabs(a.b - b.b) <= part * most;
}

static Rgb eval(const Model *m, V3 wo, V3 wi) { return m->b.kind->eval(&m->b, wo, wi, false); }
static float pdf_w(const Model *m, V3 wo, V3 wi) { return m->b.kind->pdf_w(&m->b, wo, wi); }

static bool sample(const Model *m, V3 wo, Rng *rng, BsdfSample *s)
{
    float lobe = rng_unit(rng);
    return m->b.kind->sample(&m->b, wo, lobe, unit2(rng), false, s);
}

/* ---- S6: the sampler against its density ---- */

typedef struct { const Model *m; V3 wo; } View;

static bool draw(const void *of, Rng *rng, V3 *w)
{
    const View *v = of;
    BsdfSample s;
    if (!sample(v->m, v->wo, rng, &s) || (s.flags & BSDF_SPECULAR))
        return false;
    *w = s.wi;
    return true;
}
static double density(const void *of, V3 w)
{
    const View *v = of;
    return pdf_w(v->m, v->wo, w);
}

/* Where the density of what is refracted jumps: facets end where they stand upright, and the sum of
 * wo and eta wi, their normal, is level where wi.z = -wo.z / eta; nowhere if that is below -1. */
static float jump_of(const View *v)
{
    float eta = v->wo.z > 0.0f ? v->m->eta : 1.0f / v->m->eta;
    return -v->wo.z / eta;
}

/* The draws that find a fault of a given size grow with the square root of the number of bins: a
 * fourth of the bins does with half as many. */
static void check_chi2(int from, int step, uint64_t draws)
{
    static Model m[MOST];
    int n = models_make(m), rows = test_is_long() ? 64 : 32;
    for (int i = from; i < n * NWO; i += step) {
        View v = { &m[i / NWO], wo_of(i % NWO) };
        int halvings = !strcmp(v.m->b.kind->info.name, "measured") ? 2          /* jumps */
                       : v.m->eta == 1.0f ? 0 : fabsf(v.wo.z) > 0.02f ? 2 : 3;
        char what[300];
        if (is_delta(v.m) || !looks_from(i / NWO, i % NWO))
            continue;
        snprintf(what, sizeof what, "%s from direction %d", v.m->name, i % NWO);
        chi2_expect(&(Chi2){ draw, density, &v, .draws = draws, .seed = (uint64_t)i,
                             .rows = rows, .cols = 2 * rows,
                             .halvings = halvings, .jump = jump_of(&v) }, what);
    }
}

/* In parts, for more processors and shorter cases. */
static void test_chi2_0(void) { check_chi2(0, 3, 100000); }
static void test_chi2_1(void) { check_chi2(1, 3, 100000); }
static void test_chi2_2(void) { check_chi2(2, 3, 100000); }
static void test_chi2_long_0(void) { check_chi2(0, 4, 4000000); }
static void test_chi2_long_1(void) { check_chi2(1, 4, 4000000); }
static void test_chi2_long_2(void) { check_chi2(2, 4, 4000000); }
static void test_chi2_long_3(void) { check_chi2(3, 4, 4000000); }

/* Each sample: its density is what pdf_w says, its weight f cos / pdf, its direction unit and on
 * the side its flags say. */
static void test_samples_agree(void)
{
    static Model m[MOST];
    int n = models_make(m), draws = test_is_long() ? 1000000 : 20000;
    for (int i = 0; i < n; i++) {
        Rng rng = rng_seed((uint64_t)i);
        for (int k = 0; k < draws; k++) {
            V3 wo = k % 2 ? wo_of(k / 2 % NWO) : any_direction(&rng);
            BsdfSample s;
            Rgb want;
            float pdf;
            if (!sample(&m[i], wo, &rng, &s))
                continue;
            EXPECT(fabsf(v_len(s.wi) - 1.0f) < 2e-6f, "%s: length %.9g", m[i].name, v_len(s.wi));
            EXPECT(same_side(wo, s.wi) == !(s.flags & BSDF_TRANSMIT), "%s: side", m[i].name);
            EXPECT((s.flags & ~m[i].b.flags) == 0, "%s: flags %d", m[i].name, s.flags);
            EXPECT((s.flags & BSDF_TRANSMIT) || s.eta == 1.0f, "%s: eta %g", m[i].name, s.eta);
            if (s.flags & BSDF_SPECULAR) {
                EXPECT(s.pdf_w == 0.0f, "%s: density of a delta", m[i].name);
                continue;
            }
            pdf = pdf_w(&m[i], wo, s.wi);
            want = rgb_scale(eval(&m[i], wo, s.wi), fabsf(s.wi.z) / pdf);
            EXPECT(close(s.pdf_w, pdf, 1e-5), "%s: sampled with %.9g, pdf_w %.9g", m[i].name,
                   s.pdf_w, pdf);
            EXPECT(close_rgb(s.weight, want, 1e-5), "%s: weight %.9g %.9g %.9g, f cos / pdf %.9g "
                   "%.9g %.9g", m[i].name, s.weight.r, s.weight.g, s.weight.b, want.r, want.g,
                   want.b);
        }
    }
}

/* Who does not say BSDF_LOBES makes no use of the number that chooses. */
static void test_lobes(void)
{
    static Model m[MOST];
    int n = models_make(m);
    for (int i = 0; i < n; i++)
        for (int k = 0; k < NWO && !(m[i].b.flags & BSDF_LOBES); k++) {
            BsdfSample s, t;
            V2 u = { 0.3f, 0.6f };
            bool a = m[i].b.kind->sample(&m[i].b, wo_of(k), 0.0f, u, false, &s);
            bool b = m[i].b.kind->sample(&m[i].b, wo_of(k), ONE_MINUS_ULP, u, false, &t);
            EXPECT(a == b && (!a || v_len(v_sub(s.wi, t.wi)) == 0.0f), "%s chooses", m[i].name);
        }
}

/* ---- delta events one by one ---- */

/* What specular samples bring on average towards wi (anywhere if NULL), by a fine grid of lobes. */
static Rgb delta_mean(const Model *m, V3 wo, const V3 *wi)
{
    enum { GRID = 4000 };
    double sum[3] = { 0, 0, 0 };
    for (int k = 0; k < GRID; k++) {
        BsdfSample s;
        float lobe = ((float)k + 0.5f) / GRID;
        if (!m->b.kind->sample(&m->b, wo, lobe, (V2){ 0.3f, 0.6f }, false, &s) ||
            !(s.flags & BSDF_SPECULAR) || (wi && v_len(v_sub(*wi, s.wi)) > 1e-5f))
            continue;
        sum[0] += s.weight.r;
        sum[1] += s.weight.g;
        sum[2] += s.weight.b;
    }
    return rgb((float)(sum[0] / GRID), (float)(sum[1] / GRID), (float)(sum[2] / GRID));
}

/* A grid may miss half a step, of a weight that is over a chance. */
static bool near_rgb(Rgb a, Rgb b)
{
    return fabsf(a.r - b.r) + fabsf(a.g - b.g) + fabsf(a.b - b.b) < 2e-3f * (1.0f + rgb_max(b));
}

/* Each event of the list weighs what `sample` brings towards its direction on average. */
static void check_event(const Model *m, V3 wo, const BsdfSample *s, int count, int e)
{
    Rgb there = rgb_all(0.0f), mean = delta_mean(m, wo, &s[e].wi);

    for (int f = 0; f < count; f++)             /* events of one direction add up */
        if (v_len(v_sub(s[e].wi, s[f].wi)) <= 1e-5f)
            there = rgb_add(there, s[f].weight);
    EXPECT(near_rgb(there, mean), "%s from z %g: event %d weighs %g, samples %g", m->name, wo.z, e,
           there.g, mean.g);
    EXPECT(s[e].pdf_w == 0.0f && (s[e].flags & BSDF_SPECULAR) && !(s[e].flags & ~m->b.flags) &&
           same_side(wo, s[e].wi) == !(s[e].flags & BSDF_TRANSMIT), "%s: event %d", m->name, e);
    EXPECT((s[e].flags & BSDF_TRANSMIT) || s[e].eta == 1.0f, "%s: eta %g", m->name, s[e].eta);
}

/* And there are no others than those of the list. */
static void test_deltas(void)
{
    static Model m[MOST];
    int n = models_make(m), seen = 0;
    for (int i = 0; i < n; i++)
        for (int k = 0; k < NWO && (m[i].b.flags & BSDF_SPECULAR); k++) {
            BsdfSample s[BSDF_DELTAS];
            int count = bsdf_deltas(&m[i].b, wo_of(k), s);
            Rgb all = rgb_all(0.0f), mean = delta_mean(&m[i], wo_of(k), NULL);
            for (int e = 0; e < count; e++) {
                check_event(&m[i], wo_of(k), s, count, e);
                all = rgb_add(all, s[e].weight);
            }
            EXPECT(near_rgb(all, mean), "%s from %d: all events weigh %g, samples %g", m[i].name,
                   k, all.g, mean.g);
            seen += count;
        }
    EXPECT(seen > 50, "%d delta events", seen);
}

/* ---- S7: integrals ---- */

static double f_cos(const void *of, V3 w)
{
    const View *v = of;
    Rgb f = v->m->b.kind->eval(&v->m->b, v->wo, w, true);       /* energy, not radiance */
    return ((double)f.r + f.g + f.b) / 3.0 * fabsf(w.z);
}

static double mean_of(Rgb c) { return ((double)c.r + c.g + c.b) / 3.0; }

/* The delta part of the albedo: what specular samples bring on average, by a fine grid of lobes. */
static double delta_albedo(const Model *m, V3 wo)
{
    enum { GRID = 20000 };
    double sum = 0.0;
    for (int k = 0; k < GRID; k++) {
        BsdfSample s;
        float lobe = ((float)k + 0.5f) / GRID;
        if (m->b.kind->sample(&m->b, wo, lobe, (V2){ 0.3f, 0.6f }, true, &s) &&
            (s.flags & BSDF_SPECULAR))
            sum += mean_of(s.weight);
    }
    return sum / GRID;
}

static double albedo_of(const Model *m, V3 wo)
{
    View v = { m, wo };
    double smooth = is_delta(m) ? 0.0 : chi2_integral(f_cos, &v, false, jump_of(&v), 32, 64);
    return smooth + (m->b.flags & BSDF_SPECULAR ? delta_albedo(m, wo) : 0.0);
}

/* Integral of f cos against 1, against the mean weight of samples, and albedo() against it: that is
 * an estimate, and roulette is well served if it is right to a quarter. */
static void test_albedo(void)
{
    static Model m[MOST];
    int n = models_make(m);
    for (int i = 0; i < n; i++)
        for (int k = 0; k < NWO; k++) {
            enum { DRAWS = 20000 };
            V3 wo = wo_of(k);
            double a, said = mean_of(m[i].b.kind->albedo(&m[i].b, wo));
            double sum = 0.0, sum2 = 0.0, error;
            Rng rng = rng_seed((uint64_t)k);
            if (!looks_from(i, k))
                continue;
            a = albedo_of(&m[i], wo);
            EXPECT(a <= 1.0 + 1e-4, "%s from %d: albedo %.6f", m[i].name, k, a);
            EXPECT(fabs(said - a) <= 0.25, "%s from %d: albedo() %.3f, is %.3f", m[i].name, k,
                   said, a);
            for (int d = 0; d < DRAWS; d++) {
                BsdfSample s;
                float lobe = rng_unit(&rng);
                double w = m[i].b.kind->sample(&m[i].b, wo, lobe, unit2(&rng), true, &s)
                           ? mean_of(s.weight) : 0.0;
                sum += w;
                sum2 += w * w;
            }
            sum /= DRAWS;
            error = sqrt(fabs(sum2 / DRAWS - sum * sum) / DRAWS);
            EXPECT(fabs(sum - a) <= 5.6 * error + 2e-4, "%s from %d: samples bring %.5f, the "
                   "integral is %.5f", m[i].name, k, sum, a);
        }
}

/* Energy over a grid of roughness, index and direction, white: at most 1 + 1e-4. */
static void check_energy(const char *kind, const char *format, int nwo, int nrough, int nior)
{
    static Model m;
    for (int r = 0; r < nrough; r++)
        for (int e = 0; e < nior; e++) {
            /* alpha from 0.01 to 1, dense at the small end; eta from 1.1 to 3 */
            double alpha = 0.01 + 0.99 * r * r / ((nrough - 1.0) * (nrough - 1.0));
            double eta = 1.1 + 1.9 * e * e / ((nior - 1.0) * (nior - 1.0));
            int rows = alpha < 0.05 ? 128 : 32;         /* as narrow as the lobes */
            char options[200];
            snprintf(options, sizeof options, format, (int)(alpha * 1e6), (int)(eta * 1e6));
            model_make(&m, kind, options);
            for (int k = 0; k < nwo; k++) {
                float c = ((float)k + 0.3f) / (float)nwo;       /* the first one grazes */
                float a = 0.05f + (float)(k % 5) * 0.38f, sine = sqrtf(1.0f - c * c);
                V3 wo = v3(sine * m_cos(a), sine * m_sin(a), c);
                View v = { &m, wo };
                double sum = chi2_integral(f_cos, &v, false, 0.0f, rows, 2 * rows);
                EXPECT(sum <= 1.0 + 1e-4, "%s, cosine %g: albedo %.6f", m.name, c, sum);
            }
        }
}

static void test_energy(void)
{
    bool all = test_is_long();
    for (int k = 0; k < (all ? 11 : 3); k++) {
        char options[200];
        double Rs = all ? 0.1 * k : 0.02 + 0.3 * k;
        snprintf(options, sizeof options, "reflectance=1,specular=%g,remaproughness=off,roughness="
                 "%%de-6", Rs);
        check_energy("ashikhminshirley", options, all ? 64 : 4, all ? 16 : 3, 2);
        snprintf(options, sizeof options, "reflectance=1,specular=%g,remaproughness=off,uroughness="
                 "%%de-6,vroughness=0.9", Rs);
        check_energy("ashikhminshirley", options, all ? 64 : 4, all ? 16 : 3, 2);
    }
    check_energy("ward", "reflectance=0,specular=1,roughness=%de-6", all ? 32 : 4, all ? 16 : 4, 2);
    check_energy("ward", "reflectance=0,specular=1,uroughness=%de-6,vroughness=0.8", all ? 32 : 4,
                 all ? 16 : 4, 2);
    check_energy("coateddiffuse", "reflectance=1,remaproughness=off,roughness=%de-6,eta=%de-6",
                 all ? 64 : 6, all ? 16 : 4, all ? 8 : 4);
    check_energy("coateddiffuse",
                 "reflectance=1,remaproughness=off,uroughness=%de-6,eta=%de-6,vroughness=0.1",
                 all ? 64 : 6, all ? 16 : 4, all ? 8 : 3);
    check_energy("coatedconductor", "remaproughness=off,conductor.eta=0.01,conductor.k=1000,"
                 "conductor.roughness=%de-6,interface.eta=%de-6,interface.roughness=0.3",
                 all ? 32 : 4, all ? 16 : 4, all ? 8 : 3);
    check_energy("coatedconductor", "remaproughness=off,conductor.eta=0.01,conductor.k=1000,"
                 "interface.uroughness=%de-6,interface.eta=%de-6,interface.vroughness=0.2,"
                 "conductor.roughness=0.4", all ? 32 : 4, all ? 16 : 4, all ? 8 : 3);
    check_energy("conductor", "reflectance=1,remaproughness=off,roughness=%de-6", all ? 64 : 6,
                 all ? 16 : 5, 2);
    check_energy("conductor", "reflectance=1,remaproughness=off,uroughness=%de-6,vroughness=0.3",
                 all ? 64 : 6, all ? 16 : 5, 2);
}

/* A white base under a smooth coat: nothing is lost. What the quadrature in setup keeps back for
 * safety is at most 2e-4. */
static void test_smooth_coat_is_white(void)
{
    static Model m;
    for (int e = 0; e < 6; e++) {
        char options[100];
        snprintf(options, sizeof options, "reflectance=1,roughness=0,eta=%g", 1.1 + 0.37 * e);
        model_make(&m, "coateddiffuse", options);
        for (int k = 0; k < NWO; k++) {
            double a = albedo_of(&m, wo_of(k));
            EXPECT(fabs(a - 1.0) < 2e-4, "%s from %d: albedo %.6f", m.name, k, a);
        }
    }
}

/* f(wo, wi) / n_o^2 = f(wi, wo) / n_i^2, the adjoint is f with its directions exchanged, and all is
 * the same from below as from above, unless there is another index below. */
static void test_reciprocity(void)
{
    static Model m[MOST];
    int n = models_make(m), pairs = test_is_long() ? 1000000 : 50000;
    for (int i = 0; i < n; i++) {
        Rng rng = rng_seed(300 + (uint64_t)i);
        double n2 = (double)m[i].eta * m[i].eta;
        for (int k = 0; k < pairs && !is_delta(&m[i]); k++) {
            V3 wo = any_direction(&rng), wi = any_direction(&rng);
            Rgb f, g, a;
            if (!(m[i].b.flags & BSDF_TRANSMIT))
                wi.z = wi.z * wo.z < 0.0f && k % 16 ? -wi.z : wi.z;
            f = eval(&m[i], wo, wi);
            g = eval(&m[i], wi, wo);
            a = m[i].b.kind->eval(&m[i].b, wi, wo, true);
            EXPECT(close_rgb(f, a, 1e-5), "%s: f %.9g, its adjoint %.9g", m[i].name, f.r, a.r);
            if (wo.z * wi.z < 0.0f && strncmp(m[i].name, "mix", 3))     /* a sum of several rules */
                g = rgb_scale(g, (float)(wo.z > 0.0f ? 1.0 / n2 : n2));
            else if (wo.z * wi.z < 0.0f)
                continue;
            EXPECT(close_rgb(f, g, 1e-5), "%s: f %.9g one way, %.9g the other", m[i].name,
                   f.r, g.r);
            wo.z = -wo.z;
            wi.z = -wi.z;
            g = eval(&m[i], wo, wi);
            EXPECT(m[i].eta != 1.0f || close_rgb(f, g, 1e-6), "%s: f %.9g on one side, %.9g on "
                   "the other", m[i].name, f.r, g.r);
        }
    }
}

/* Directions that graze to any degree and numbers at the ends of [0,1): all stays finite, weights
 * are not negative, and no direction is below the surface by mistake. */
static void test_edges(void)
{
    static const float tiny[] = { 0.0f, 1e-45f, 1e-38f, 1e-30f, 1e-20f, 1e-10f, 1e-7f, 1e-4f, 1 };
    static const float end[] = { 0.0f, 1e-30f, 0x1p-24f, 0.25f, 0.5f, 0.75f, ONE_MINUS_ULP };
    static Model m[MOST];
    int n = models_make(m);
    for (int i = 0; i < n; i++) {
        for (int k = 0; k < 9 * 2 * 343; k++) {
            float z = tiny[k % 9], phi = (float)(k % 7);
            V3 wo = v_unit(v3(m_cos(phi), m_sin(phi), k / 9 % 2 ? z : -z));
            V2 u = { end[k / 18 % 7], end[k / 126 % 7] };
            BsdfSample s;
            Rgb a = m[i].b.kind->albedo(&m[i].b, wo);
            EXPECT(rgb_finite(a) && rgb_max(a) <= 1.0f + 1e-5f, "%s: albedo %g", m[i].name, a.r);
            if (!m[i].b.kind->sample(&m[i].b, wo, end[k / 882 % 7], u, k % 2, &s))
                continue;
            EXPECT(v_finite(s.wi) && rgb_finite(s.weight) && is_finite(s.pdf_w) && is_finite(s.eta),
                   "%s: not finite, z %g", m[i].name, wo.z);
            EXPECT(s.weight.r >= 0.0f && s.weight.g >= 0.0f && s.weight.b >= 0.0f, "%s: weight < 0",
                   m[i].name);
            EXPECT((s.flags & BSDF_SPECULAR) ? s.pdf_w == 0.0f : s.pdf_w > 0.0f, "%s: pdf %g",
                   m[i].name, s.pdf_w);
        }
        for (int k = 0; k < 81 * 4; k++) {
            float zo = tiny[k % 9], zi = tiny[k / 9 % 9], phi = (float)(k / 81) * PI_F / 3.0f;
            V3 wo = v_unit(v3(1, 0, zo)), wi = v_unit(v3(m_cos(phi), m_sin(phi), zi));
            Rgb f = eval(&m[i], wo, wi);
            EXPECT(rgb_finite(f) && f.r >= 0.0f && f.g >= 0.0f && f.b >= 0.0f, "%s: f %g at z %g "
                   "%g", m[i].name, f.r, zo, zi);
            EXPECT(is_finite(pdf_w(&m[i], wo, wi)), "%s: pdf at z %g %g", m[i].name, zo, zi);
            wi.z = -1e-3f;
            EXPECT(zo == 0.0f || (m[i].b.flags & BSDF_TRANSMIT) || pdf_w(&m[i], wo, wi) == 0.0f,
                   "%s: passes the surface", m[i].name);
        }
    }
}

/* Textures may hand over anything: no albedo above 1, nothing that is not finite. */
static void test_wild_parameters(void)
{
    static const float wild[] = { -1e30f, -1.0f, 0.0f, 1e-30f, 0.5f, 1.0f, 7.0f, 1e30f };
    Rng rng = rng_seed(9);
    for (int k = 0; bsdfs[k]; k++)
        for (int i = 0; i < 2000; i++) {
            Rgb value[OPT_MAX], a;
            V3 wo = any_direction(&rng), wi = any_direction(&rng);
            Model m;
            BsdfSample s;
            for (int o = 0; o < OPT_MAX; o++) {
                value[o].r = wild[rng_below(&rng, 8)];
                value[o].g = wild[rng_below(&rng, 8)];
                value[o].b = wild[rng_below(&rng, 8)];
            }
            bsdf_make(&m.b, bsdfs[k], value, NULL);
            a = bsdfs[k]->albedo(&m.b, wo);
            EXPECT(rgb_finite(a) && rgb_max(a) <= 1.0f + 1e-4f && a.r >= 0.0f, "%s: albedo %g %g "
                   "%g", bsdfs[k]->info.name, a.r, a.g, a.b);
            EXPECT(rgb_finite(eval(&m, wo, wi)) && is_finite(pdf_w(&m, wo, wi)), "%s: f",
                   bsdfs[k]->info.name);
            if (sample(&m, wo, &rng, &s))
                EXPECT(rgb_finite(s.weight) && v_finite(s.wi), "%s: sample", bsdfs[k]->info.name);
        }
}

/* ---- peaks ---- */

static void test_peaks(void)
{
    static Model m[MOST];
    int n = models_make(m);
    Model rough;
    for (int i = 0; i < n; i++)
        for (int k = 0; k < NWO; k++) {
            V3 wo = wo_of(k), peak[16];
            int count = m[i].b.kind->peaks(&m[i].b, wo, peak);
            EXPECT(count >= 1 && count <= 16, "%s: %d peaks", m[i].name, count);
            for (int p = 0; p < count; p++)
                EXPECT(fabsf(v_len(peak[p]) - 1.0f) < 1e-5f, "%s: peak of length %g", m[i].name,
                       v_len(peak[p]));
            for (int p = 0; p < count && !(m[i].b.flags & BSDF_TRANSMIT); p++)
                EXPECT(peak[p].z * wo.z >= -1e-6f, "%s: peak on the far side", m[i].name);
        }

    /* Facets spread along x: reflected directions keep their y, and so do the peaks. */
    model_make(&rough, "conductor", "uroughness=0.7,vroughness=0.01,remaproughness=false");
    for (int k = 1; k < 5; k++) {
        V3 wo = wo_of(k), peak[16];
        int count = rough.b.kind->peaks(&rough.b, wo, peak), near = 0, all = 0;
        Rng rng = rng_seed(3);
        EXPECT(count == 10, "%d peaks of an anisotropic metal", count);
        for (int d = 0; d < 1000; d++) {
            BsdfSample s;
            float best = 0.0f;
            if (!sample(&rough, wo, &rng, &s))
                continue;
            for (int p = 0; p < count; p++) {
                V3 q = peak[p];         /* nearest peak; they are pi/8 apart along the cone */
                best = f_max(best, v_dot(q, s.wi));
            }
            all++;
            near += best > 0.97f;       /* cos of a bit more than half of that */
        }
        EXPECT(near > 0.95 * all, "direction %d: %d of %d samples are near a peak", k, near, all);
    }
}

/* f cos, which is what [Cline07 5.2.2] calls f, is large at the peaks: not below a quarter of the
 * largest among samples. Rough facets have their largest value beyond the mirrored direction where
 * the eye grazes, so it is asked for up to 65 degrees. */
static void test_peaks_hold_the_maximum(void)
{
    static Model m[MOST];
    int n = models_make(m);
    for (int i = 0; i < n; i++)
        for (int k = 0; k < 8 && !is_delta(&m[i]); k++) {
            V3 wo = wo_of(k), peak[16];
            int count = m[i].b.kind->peaks(&m[i].b, wo, peak);
            double at_peaks = 0.0, most = 0.0;
            Rng rng = rng_seed((uint64_t)i);
            for (int p = 0; p < count; p++)
                at_peaks = d_max(at_peaks, fabsf(peak[p].z) *
                                           mean_of(eval(&m[i], wo, peak[p])));
            for (int d = 0; d < 1000; d++) {
                BsdfSample s;
                if (sample(&m[i], wo, &rng, &s) && !(s.flags & BSDF_SPECULAR))
                    most = d_max(most, fabsf(s.wi.z) * mean_of(eval(&m[i], wo, s.wi)));
            }
            EXPECT(at_peaks >= 0.25 * most, "%s from %d: f cos at peaks %g, elsewhere %g",
                   m[i].name, k, at_peaks, most);
        }
}

/* ---- naive twins ---- */

/* Reflectance of a metal by complex arithmetic, from the textbook. */
static double metal_twin(double c, double eta, double k)
{
    double re = eta * eta - k * k - (1.0 - c * c), im = 2.0 * eta * k;
    double size = sqrt(sqrt(re * re + im * im)), half = 0.5 * md_atan2(im, re);
    double a = size * md_cos(half), b = size * md_sin(half);            /* sqrt(n^2 - sin^2) */
    double nr = eta * eta - k * k, ni = 2.0 * eta * k;                  /* n^2 */
    double s = ((c - a) * (c - a) + b * b) / ((c + a) * (c + a) + b * b);
    double xr = nr * c - a, xi = ni * c - b, yr = nr * c + a, yi = ni * c + b;
    return 0.5 * (s + (xr * xr + xi * xi) / (yr * yr + yi * yi));
}

static void test_fresnel(void)
{
    Rng rng = rng_seed(21);
    for (int i = 0; i < 1000000; i++) {
        double c = rng_unit(&rng), eta = 0.3 + 3.0 * rng_unit(&rng), k = 5.0 * rng_unit(&rng);
        double t = refract_cos(c, eta), R = fresnel_with(c, t, eta), T = 0.0;
        if (t > 0.0) {                  /* transmitted power, from its own amplitudes */
            double ts = 2.0 * c / (c + eta * t), tp = 2.0 * c / (eta * c + t);
            T = eta * t / c * 0.5 * (ts * ts + tp * tp);
        }
        /* 4 ulp, of each of R and T: in grazing T the quotient t/c is as good as c */
        EXPECT(fabs(R + T - 1.0) <= 8.0 * 0x1p-52, "R + T = 1 + %g", R + T - 1.0);
        EXPECT(fabs(fresnel_conductor(c, eta, k) - metal_twin(c, eta, k)) < 1e-6, "metal %g, %g",
               (double)fresnel_conductor(c, eta, k), metal_twin(c, eta, k));
        EXPECT(eta < 1.0 || fabs(fresnel_conductor(c, eta, 0.0) - R) < 1e-6, "k = 0: %g, %g",
               (double)fresnel_conductor(c, eta, 0.0), R);
    }
    EXPECT(fabs(fresnel_dielectric(1.0, 1.5) - 0.04) < 1e-15, "glass head on");
    EXPECT(fresnel_dielectric(0.5, 1.0 / 1.5) == 1.0, "total reflection");
    EXPECT(fresnel_dielectric(0.0, 1.5) == 1.0, "grazing");
    EXPECT(fresnel_dielectric(0.3, 1.0) < 1e-30, "no interface");
}

/* D, G2 and F as they stand in the papers, in double. */
static double ggx_twin(double ax, double ay, V3 o, V3 i)
{
    double x = (double)o.x + i.x, y = (double)o.y + i.y, z = (double)o.z + i.z;
    double l = sqrt(x * x + y * y + z * z), lo, li, e;
    x /= l, y /= l, z /= l;
    e = (x * x / (ax * ax) + y * y / (ay * ay)) / (z * z) + 1.0;
    lo = (ax * ax * o.x * o.x + ay * ay * o.y * o.y) / ((double)o.z * o.z);
    li = (ax * ax * i.x * i.x + ay * ay * i.y * i.y) / ((double)i.z * i.z);
    lo = 0.5 * (sqrt(1.0 + lo) - 1.0);
    li = 0.5 * (sqrt(1.0 + li) - 1.0);
    return 1.0 / (PI * ax * ay * z * z * z * z * e * e) / (1.0 + lo + li) / (4.0 * o.z * i.z);
}

static double half_cos(V3 o, V3 i)
{
    double x = (double)o.x + i.x, y = (double)o.y + i.y, z = (double)o.z + i.z;
    return (o.x * x + o.y * y + o.z * z) / sqrt(x * x + y * y + z * z);
}

static void test_twins(void)
{
    static Model phong, metal, coat;
    Rng rng = rng_seed(31);
    double Tm = 0.0;

    model_make(&phong, "phong", "reflectance=0.5,specular=0.25,exponent=20");
    model_make(&metal, "conductor",
               "uroughness=0.5,vroughness=0.2,remaproughness=false,eta=0.2,k=3.9");
    model_make(&coat, "coateddiffuse", "reflectance=0.6,roughness=0,eta=1.5");
    for (int k = 0; k < 100000; k++) {          /* midpoints: 1e-9 */
        double c = (k + 0.5) / 100000;
        Tm += 2.0 * c * (1.0 - fresnel_dielectric(c, 1.5)) / 100000;
    }
    for (int k = 0; k < 100000; k++) {
        V3 wo = above(any_direction(&rng)), wi = above(any_direction(&rng)), r = mirror_z(wo);
        double a = v_dot(r, wi), want, fo, fi;

        want = 0.5 / PI + (a > 0.0 ? 0.25 * 22.0 / (2.0 * PI) * md_pow(a, 20.0) : 0.0);
        EXPECT(close(eval(&phong, wo, wi).r, want, 2e-5), "phong %g, twin %g",
               eval(&phong, wo, wi).r, want);
        if (wo.z < 1e-4f || wi.z < 1e-4f)
            continue;
        want = ggx_twin(0.5, 0.2, wo, wi) * metal_twin(half_cos(wo, wi), 0.2, 3.9);
        EXPECT(close(eval(&metal, wo, wi).r, want, 1e-4), "metal %g, twin %g",
               eval(&metal, wo, wi).r, want);
        fo = fresnel_dielectric(wo.z, 1.5);
        fi = fresnel_dielectric(wi.z, 1.5);
        want = (1.0 - fo) * (1.0 - fi) * 0.6 / PI / (2.25 * (1.0 - 0.6 * (1.0 - Tm / 2.25)));
        EXPECT(close(eval(&coat, wo, wi).r, want, 2e-4), "coat %g, twin %g",
               eval(&coat, wo, wi).r, want);
    }
}

/* The options of the metal: a colour comes back head on, roughness is squared, -1 is copper. */
static void test_conductor_options(void)
{
    Model m;
    BsdfSample s;
    V3 up = { 0, 0, 1 };
    model_make(&m, "conductor", "reflectance=0.9/0.5/0.1");
    EXPECT(m.b.kind->sample(&m.b, up, 0.5f, (V2){ 0.5f, 0.5f }, false, &s), "no sample");
    EXPECT(fabsf(s.weight.r - 0.9f) < 1e-5f && fabsf(s.weight.g - 0.5f) < 1e-5f &&
           fabsf(s.weight.b - 0.1f) < 1e-5f, "colour %g %g %g", s.weight.r, s.weight.g, s.weight.b);
    EXPECT(s.flags == (BSDF_REFLECT | BSDF_SPECULAR) && s.wi.z == 1.0f, "polished");
    model_make(&m, "conductor", "");
    EXPECT(m.b.kind->sample(&m.b, up, 0.5f, (V2){ 0.5f, 0.5f }, false, &s), "no sample");
    EXPECT(s.weight.r > 0.9f && s.weight.r > 1.3f * s.weight.b, "copper is red");
    model_make(&m, "conductor", "roughness=0.25,eta=1,k=2");
    EXPECT(close(eval(&m, up, up).r, 0.5 / (PI * 0.25 * 4.0), 1e-5), "alpha is not sqrt(0.25)");
    model_make(&m, "conductor", "roughness=0.25,eta=1,k=2,remaproughness=false");
    EXPECT(close(eval(&m, up, up).r, 0.5 / (PI * 0.0625 * 4.0), 1e-5), "alpha is not 0.25");
}

/* ---- glass ---- */

/* Snell's law, the way back, and the factor between radiance and importance. */
static void test_refraction(void)
{
    Rng rng = rng_seed(41);
    int refracted = 0;
    for (int k = 0; k < 1000000; k++) {
        Rgb value[OPT_MAX] = { rgb_all(0.4f + 2.0f * rng_unit(&rng)), rgb_all(1), rgb_all(1) };
        V3 wo = any_direction(&rng);
        float lobe = rng_unit(&rng);
        double n1 = wo.z > 0 ? 1.0 : value[0].r, n2 = wo.z > 0 ? value[0].r : 1.0, s1, s2;
        BsdfSample s, back, particle;
        Bsdf b;
        const BsdfKind *glass = kind_find(bsdfs, "dielectric");

        bsdf_make(&b, glass, value, NULL);
        if (!glass->sample(&b, wo, lobe, unit2(&rng), false, &s) || !(s.flags & BSDF_TRANSMIT))
            continue;
        refracted++;
        s1 = sqrt((double)wo.x * wo.x + (double)wo.y * wo.y);
        s2 = sqrt((double)s.wi.x * s.wi.x + (double)s.wi.y * s.wi.y);
        EXPECT(fabs(n1 * s1 - n2 * s2) <= 4 * 0x1p-24 * n1 * s1 + 1e-12, "Snell: %g",
               n1 * s1 - n2 * s2);
        EXPECT(close(s.eta, n2 / n1, 1e-6), "eta %g, not %g", s.eta, n2 / n1);
        REQUIRE(glass->sample(&b, wo, lobe, unit2(&rng), true, &particle), "importance");
        EXPECT(v_len(v_sub(s.wi, particle.wi)) == 0.0f, "the event depends on what is carried");
        EXPECT(close(particle.weight.r, 1.0, 1e-6), "particle weight %g", particle.weight.r);
        EXPECT(close(s.weight.r * s.eta * s.eta, 1.0, 1e-6), "radiance weight %g", s.weight.r);
        /* lobe next to 1: the way back refracts too, and to where it came from */
        REQUIRE(glass->sample(&b, s.wi, ONE_MINUS_ULP, unit2(&rng), false, &back), "no way back");
        if (fabsf(wo.z) > 0.01f && fabsf(s.wi.z) > 0.01f) {
            EXPECT(v_len(v_sub(back.wi, wo)) < 1e-4f, "came back by %g", v_len(v_sub(back.wi, wo)));
            EXPECT(close(back.weight.r * s.weight.r, 1.0, 1e-5), "round trip %g",
                   back.weight.r * s.weight.r);
        }
    }
    EXPECT(refracted > 500000, "only %d refracted", refracted);
}

/* With tints: the events together bring F Kr + (1 - F) Kt, which albedo() states exactly. */
static void test_glass_energy(void)
{
    Model m;
    model_make(&m, "dielectric", "eta=1.5,reflectance=0.5/1/0.2,transmittance=0.3/0.9/1");
    for (int k = 0; k < NWO; k++) {
        V3 wo = wo_of(k);
        double c = fabsf(wo.z), F = fresnel_dielectric(c, wo.z > 0 ? 1.5 : 1.0 / 1.5);
        double want = F * 1.7 / 3.0 + (1.0 - F) * 2.2 / 3.0;
        EXPECT(fabs(delta_albedo(&m, wo) - want) < 1e-4, "from %d: %g, not %g", k,
               delta_albedo(&m, wo), want);
        EXPECT(fabs(mean_of(m.b.kind->albedo(&m.b, wo)) - want) < 1e-6, "albedo() from %d", k);
    }
    for (int side = -1; side <= 1; side += 2) {         /* one tint black: the other event only */
        BsdfSample s;
        model_make(&m, "dielectric", side > 0 ? "reflectance=0" : "transmittance=0");
        for (float lobe = 0.0f; lobe < 1.0f; lobe += 0.05f)
            EXPECT(m.b.kind->sample(&m.b, wo_of(2), lobe, (V2){ 0, 0 }, false, &s) &&
                   (s.flags & (side > 0 ? BSDF_TRANSMIT : BSDF_REFLECT)), "black event chosen");
    }
}

/* ---- measured tables ---- */

/* Angles by turning wi as the paper says: about the normal until h is in the plane of x, then until
 * it is the pole. */
static double merl_twin(V3 o, V3 i)
{
    double hx = (double)o.x + i.x, hy = (double)o.y + i.y, hz = (double)o.z + i.z;
    double theta = md_atan2(sqrt(hx * hx + hy * hy), hz);
    double phi = md_atan2(hy, hx), c = md_cos(phi), s = md_sin(phi), x, y, z, a;

    a = c * i.x + s * i.y;
    y = c * i.y - s * i.x;
    x = md_cos(theta) * a - md_sin(theta) * i.z;
    z = md_sin(theta) * a + md_cos(theta) * i.z;
    return merl_truth(theta, md_atan2(sqrt(x * x + y * y), z), md_atan2(y, x));
}

/* Bound of the error of linear interpolation: in theta_h an eighth of the second derivative, 7.8 at
 * most, times the square of a cell of 0.034, in phi_d of 0.12 times 0.13^2; theta_d is linear, but
 * constant in the outer halves of the edge cells, 0.026 wide: 0.35/2 times that. 0.006 in all. */
static void test_measured(void)
{
    Rng rng = rng_seed(51);
    Model m;
    double worst = 0.0;

    model_make(&m, "measured", "");
    for (int k = 0; k < 200000; k++) {
        V3 wo = above(any_direction(&rng)), wi = above(any_direction(&rng));
        Rgb f;
        double want = merl_twin(wo, wi);
        if (wo.z < 0.4f || wi.z < 0.4f)                 /* where nothing is scaled down */
            continue;
        f = eval(&m, wo, wi);
        worst = d_max(worst, fabs(f.r - want));
        EXPECT(fabs(f.r - want) < 0.008 && close(f.g, 0.5 * f.r, 1e-5) &&
               close(f.b, 0.25 * f.r, 1e-5), "f %g, made up %g", f.r, want);
    }
    EXPECT(worst > 0.0, "nothing was looked at");
}

/* Files cut at every kind of place, and counts that lie. */
static void test_measured_faults(void)
{
    static unsigned char bytes[MERL_BYTES];
    static const struct { uint32_t at, value; size_t size; } rows[] = {
        { 0, MERL_H, 0 }, { 0, MERL_H, 11 }, { 0, MERL_H, 12 }, { 0, MERL_H, MERL_BYTES - 1 },
        { 0, 0, MERL_BYTES }, { 0, 0xFFFFFFFF, MERL_BYTES }, { 4, MERL_D + 1, MERL_BYTES },
        { 8, 1024, MERL_BYTES }, { 8, 0x80000000, MERL_BYTES }, { 4, 1, MERL_BYTES }
    };
    Merl m;

    messages_quiet(true);
    for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
        long before = mem_blocks();
        merl_fill(bytes);
        put_u32(bytes + rows[i].at, rows[i].value);
        EXPECT(!merl_read(&m, "cut", bytes, rows[i].size) && !m.f, "row %lu was taken",
               (unsigned long)i);
        EXPECT(mem_blocks() == before, "row %lu leaks", (unsigned long)i);
    }
    merl_fill(bytes);
    put_double(bytes + 12, -1.0);                       /* not measured; infinite; nothing */
    put_double(bytes + 20, 1e300 * 1e10);
    put_u32(bytes + 28, 1);
    put_u32(bytes + 32, 0x7FF80000);
    REQUIRE(merl_read(&m, "odd", bytes, MERL_BYTES), "refused");
    EXPECT(m.f[0].r == 0.0f && m.f[1].r == 0.0f && m.f[2].r == 0.0f && m.f[3].r > 0.1f, "odd");
    merl_clear(&m);
}

/* ---- the same bits on every machine ---- */

/* A change of any model's results changes this number, and has to say so here. */
static void test_same_bits(void)
{
    static Model m[MOST];
    int n = models_make(m);
    uint64_t h = 0;
    for (int i = 0; i < n; i++) {
        Rng rng = rng_seed(500 + (uint64_t)i);
        for (int k = 0; k < 2000; k++) {
            V3 wo = any_direction(&rng), wi = any_direction(&rng);
            Rgb f = eval(&m[i], wo, wi), a = m[i].b.kind->albedo(&m[i].b, wo);
            float out[16] = { f.r, f.g, f.b, a.r, a.g, a.b, pdf_w(&m[i], wo, wi) };
            BsdfSample s;
            if (sample(&m[i], wo, &rng, &s)) {
                float more[] = { s.wi.x, s.wi.y, s.wi.z, s.weight.r, s.weight.g, s.weight.b,
                                 s.pdf_w, s.eta };
                memcpy(out + 7, more, sizeof more);
            }
            h = test_hash(h, out, 15);
        }
    }
    EXPECT(h == 0x41CAD8CC1ABBB1C7u, "hash %016llX", (unsigned long long)h);
}

const TestCase test_bsdf[] = {
    { "same_bits", test_same_bits, false },
    { "chi2_0", test_chi2_0, false },
    { "chi2_1", test_chi2_1, false },
    { "chi2_2", test_chi2_2, false },
    { "chi2_long_0", test_chi2_long_0, true },
    { "chi2_long_1", test_chi2_long_1, true },
    { "chi2_long_2", test_chi2_long_2, true },
    { "chi2_long_3", test_chi2_long_3, true },
    { "lobes", test_lobes, false },
    { "deltas", test_deltas, false },
    { "samples_agree", test_samples_agree, false },
    { "albedo", test_albedo, false },
    { "energy", test_energy, false },
    { "smooth_coat_is_white", test_smooth_coat_is_white, false },
    { "reciprocity", test_reciprocity, false },
    { "edges", test_edges, false },
    { "wild_parameters", test_wild_parameters, false },
    { "peaks", test_peaks, false },
    { "peaks_hold_the_maximum", test_peaks_hold_the_maximum, false },
    { "fresnel", test_fresnel, false },
    { "twins", test_twins, false },
    { "conductor_options", test_conductor_options, false },
    { "refraction", test_refraction, false },
    { "glass_energy", test_glass_energy, false },
    { "measured", test_measured, false },
    { "measured_faults", test_measured_faults, false },
    { NULL, NULL, false }
};
