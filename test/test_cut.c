/* test_cut.c -- point lights, their tree, and cuts through it.
 *
 * Points      the light of the sky and of lamps is all there; so is what surfaces send on.
 * Tree        boxes, sums and squares against sums over each node's lights.
 * Cut         every light once; the rule of sizes; the rule of squares.
 * Chance      the pmf adds up to 1 and is what choices do, for six surfaces and three normals,
 *             whatever the way within clusters; boxes against a naive test of all of them. */
#include "base/mem.h"
#include "base/random.h"
#include "lightsampling/lightcut.h"
#include "test/chi2.h"
#include "test/physics.h"

#include <string.h>

static Rgb one_pixel(V3 w)
{
    return w.z > 0.9f && w.x > 0.25f && w.x < 0.3f && w.y > 0.1f && w.y < 0.14f
               ? rgb(5000, 4000, 3000) : rgb_all(0);
}

static Rgb uneven(V3 w)
{
    float c = f_max(0, 0.6f * w.x + 0.8f * w.z);
    return rgb_scale(rgb(0.5f, 0.7f, 1), w.z > 0 ? 0.5f + 30 * f_sqr(f_sqr(f_sqr(c))) : 0.05f);
}

/* A floor, a glossy ball, a lamp with two sides; all under a sky. */
static void add_all(Lab *l)
{
    uint32_t black;

    lab_init(l);
    black = lab_material(l, "diffuse", "reflectance=0");
    lab_quad(l, v3(-2, -2, 0), v3(4, 0, 0), v3(0, 4, 0),
             lab_material(l, "diffuse", "reflectance=0.5/0.4/0.3"));
    lab_sphere(l, v3(0, 0.3f, 0.6f), 0.6f, lab_material(l, "conductor", "roughness=0.3"), false);
    lab_shine(l, lab_quad(l, v3(-1.5f, -1, 1.5f), v3(0, 1, 0), v3(1, 0, 0.2f), black),
              "L=3/2/1,twosided=true");
    lab_shine(l, lab_sphere(l, v3(1.2f, -0.8f, 1.2f), 0.2f, black, false), "L=9/8/7");
    lab_sky(l, 64, 32, uneven, NULL);
}

static void points_of(PointLights *p, Lab *l, size_t n, bool jitter, Indirect which)
{
    REQUIRE(pointlights_init(p, l->scene, n, jitter, which), "memory");
}

/* ---- points ---- */

static double light_of(const PointLights *p, PointKind kind)
{
    double sum = 0;

    for (size_t i = 0; i < p->n; i++)
        if (p->p[i].kind == kind)
            sum += (double)rgb_lum(p->p[i].L) * (double)p->p[i].size;
    return sum;
}

static void expect_light(double is, double truth, double tolerance, const char *what)
{
    EXPECT(fabs(is / truth - 1) < tolerance, "%s: %.9g, not %.9g", what, is, truth);
}

static void points(void)
{
    double omega, sun = 0;
    PointLights p;
    uint32_t black;
    Lab l;

    lab_init(&l);                       /* a sun of one pixel */
    lab_sky(&l, 256, 128, one_pixel, NULL);
    lab_build(&l);
    for (uint32_t y = 0; y < 128; y++)
        for (uint32_t x = 0; x < 256; x++) {
            Rgb c = l.scene->images[0]->image.pixels[y * 256 + x];
            omega = 2 * PI / 256 * (md_cos(PI * y / 128) - md_cos(PI * (y + 1) / 128));
            sun += omega * (double)rgb_lum(c);
        }
    points_of(&p, &l, 4096, false, INDIRECT_NO);
    expect_light(light_of(&p, POINT_BEYOND), sun, 2e-3, "a small sun");
    for (size_t i = 0; i < p.n; i++)
        EXPECT(v_dot(p.p[i].p, v_unit(v3(0.275f, 0.12f, 0.9539f))) > 0.998f, "a sun elsewhere");
    pointlights_clear(&p);
    lab_clear(&l);
    lab_init(&l);                       /* 4 pi L, and 4 pi r^2 L */
    black = lab_material(&l, "diffuse", "reflectance=0");
    lab_shine(&l, lab_sphere(&l, v3(0, 0, 3), 0.5f, black, false), "L=2");
    lab_light(&l, "infinite", "L=0.5", NULL);
    lab_build(&l);
    points_of(&p, &l, 2000, false, INDIRECT_NO);
    expect_light(light_of(&p, POINT_BEYOND), 2 * PI, 1e-3, "an even sky");
    expect_light(light_of(&p, POINT_ON_LAMP), 2 * PI, 1e-4, "a ball");
    pointlights_clear(&p);
    points_of(&p, &l, 2000, false, INDIRECT_ONLY);
    EXPECT(p.n == 0, "a black ball sends light on");
    pointlights_clear(&p);
    lab_clear(&l);
}

/* A sun over a floor that a plate shades: albedo E / pi of what is lit; and no points elsewhere. */
static void bounce(void)
{
    double E = 3 * 0.8, area = 4 * 4 - 1, sum = 0;
    PointLights p;
    Lab l;

    lab_init(&l);
    lab_quad(&l, v3(-2, -2, 0), v3(4, 0, 0), v3(0, 4, 0),
             lab_material(&l, "diffuse", "reflectance=0.5"));
    lab_quad(&l, v3(-0.5f, -0.5f, 0.5f), v3(1, 0, 0), v3(0, 1, 0),
             lab_material(&l, "diffuse", "reflectance=0"));
    lab_light(&l, "distant", "L=3,from=0.6/0/0.8,to=0/0/0", NULL);
    lab_build(&l);
    points_of(&p, &l, 2000, false, INDIRECT_ONLY);
    EXPECT(p.n > 1500 && p.n < 2500, "%lu points, not about 2000", (unsigned long)p.n);
    expect_light(light_of(&p, POINT_ON_SURFACE), 0.5 * E / PI * area, 0.01, "one bounce");
    for (size_t i = 0; i < p.n; i++) {
        V3 at = p.p[i].p;
        sum += (double)p.p[i].size;
        EXPECT(fabsf(at.z) < 1e-6f && p.p[i].n.z == 1, "a point at %g, normal %g", (double)at.z,
               (double)p.p[i].n.z);
        EXPECT(!(at.x < 0.12f && at.x > -0.87f && fabsf(at.y) < 0.49f), "a point in the shade");
    }
    expect_light(sum, area, 0.01, "area that is lit");
    pointlights_clear(&p);
    lab_clear(&l);
}

/* ---- the tree ---- */

static void expect_node(const LightTree *t, const LightNode *n)
{
    double sum = 0, squares = 0, size = 0, light = 0, mean;
    uint32_t end = n->first + n->count;
    Box box = box_empty();

    for (uint32_t i = n->first; i < end; i++) {
        const PointLight *p = &t->lights->p[t->order[i]];
        double v = t->running[i + 1] - t->running[i];
        sum += v;
        size += (double)p->size;
        light += (double)p->size * (double)p->lum;
        box = box_point(box, p->p);
    }
    mean = sum / n->count;
    for (uint32_t i = n->first; i < end; i++)
        squares += f_sqr((float)(t->running[i + 1] - t->running[i] - mean));
    EXPECT(fabs(n->sum - sum) <= 1e-9 * sum && fabs(n->size - size) <= 1e-9 * size &&
           fabs(n->light - light) <= 1e-9 * light, "sums of a node of %u lights", n->count);
    EXPECT(fabs(n->squares - squares) <= 1e-5 * squares + 1e-9 * sum * mean,
           "squares of a node of %u lights: %g, not %g", n->count, n->squares, squares);
    EXPECT(box_holds(n->box, box), "a light is outside of its box");
}

static void tree(void)
{
    static const size_t counts[] = { 0, 1, 2, 700 };
    unsigned char *seen;
    PointLights p;
    LightTree t;
    Lab l;

    for (size_t k = 0; k < 4; k++) {
        add_all(&l);
        lab_build(&l);
        points_of(&p, &l, counts[k], k % 2 == 0, counts[k] ? INDIRECT_YES : INDIRECT_NO);
        REQUIRE(lighttree_init(&t, &p), "memory");
        EXPECT(t.nnodes == 2 * p.n - 1, "%lu nodes", (unsigned long)t.nnodes);
        seen = MEM_ARRAY(unsigned char, p.n);
        for (size_t i = 0; i < p.n; i++)
            EXPECT(!seen[t.order[i]]++, "a light is there twice");
        for (size_t i = 0; i < t.nnodes; i++) {
            const LightNode *n = &t.node[i];
            expect_node(&t, n);
            EXPECT(n->second ? n[1].first == n->first &&
                                   t.node[n->second].first == n->first + n[1].count &&
                                   n->count == n[1].count + t.node[n->second].count
                             : n->count == 1, "children of node %lu", (unsigned long)i);
            EXPECT(i == 0 || n->beyond != n->within, "node %lu mixes kinds", (unsigned long)i);
        }
        mem_free(seen);
        lighttree_clear(&t);
        pointlights_clear(&p);
        lab_clear(&l);
    }
}

/* ---- cuts ---- */

static size_t expect_cut(const LightTree *t, const CutRule *rule)
{
    uint32_t node[CUT_MOST], next = 0;
    size_t n = lighttree_cut(t, rule, node);
    bool full;

    EXPECT(n <= rule->most || n == 2, "%lu nodes", (unsigned long)n);
    full = n >= rule->most;
    for (size_t k = 0; k < n; k++) {
        const LightNode *one = &t->node[node[k]];
        EXPECT(one->first == next, "lights are missing or there twice");
        next = one->first + one->count;
        EXPECT(full || !one->second ||
                   one->squares <= (double)rule->sigma * (double)rule->sigma,
               "a node of squares %g was left", one->squares);
    }
    EXPECT(next == t->lights->n, "the cut ends early");
    return n;
}

static void cuts(void)
{
    size_t n[4];
    PointLights p;
    LightTree t;
    Lab l;

    add_all(&l);
    lab_build(&l);
    points_of(&p, &l, 3000, false, INDIRECT_YES);
    REQUIRE(lighttree_init(&t, &p), "memory");
    n[0] = expect_cut(&t, &(CutRule){ 1, 0, 0.25f });
    n[1] = expect_cut(&t, &(CutRule){ 300, 0, 0.25f });
    n[2] = expect_cut(&t, &(CutRule){ 4096, 5, 0 });
    n[3] = expect_cut(&t, &(CutRule){ 4096, 1, 0 });
    EXPECT(n[0] == 2 && n[1] == 300 && n[2] > 10 && n[3] > n[2], "cuts of %lu %lu %lu %lu",
           (unsigned long)n[0], (unsigned long)n[1], (unsigned long)n[2], (unsigned long)n[3]);
    lighttree_clear(&t);
    pointlights_clear(&p);
    lab_clear(&l);
}

/* ---- chance ---- */

static const struct { const char *kind, *options; } surfaces[] = {
    { "diffuse", "" }, { "phong", "reflectance=0.2,specular=0.6,exponent=40" },
    { "phong", "reflectance=0,specular=0.9,exponent=1000" }, { "conductor", "roughness=0.2" },
    { "orennayar", "" }, { "diffusetransmission", "reflectance=0.2,transmittance=0.6" }
};

/* Importance as by_counts of direct_cut.c makes it. */
static void weigh(const LightCut *c, const Bsdf *b, const LitPoint *at, float *weight)
{
    Frame f = frame_about(at->n);
    V3 wo = v_unit(v3(0.5f, -0.3f, 0.6f));
    Rng r = rng_seed(3);

    for (size_t k = 0; k < c->n; k++)
        weight[k] = 0;
    for (int i = 0; i < 64; i++) {
        float lobe = rng_unit(&r), x = rng_unit(&r), y = rng_unit(&r);
        BsdfSample s;
        if (b->kind->sample(b, wo, lobe, (V2){ x, y }, false, &s))
            lightcut_count(c, at->p, frame_out(&f, s.wi), rgb_lum(s.weight) / 64, weight);
    }
    lightcut_lobes(c, at->p, 1, 1.0f / 64, weight);
    for (size_t k = 0; k < c->n; k++)
        EXPECT(weight[k] >= 0, "cluster %lu has the weight %g", (unsigned long)k,
               (double)weight[k]);
    lightcut_matt(c, at->p, at->n, 0.3f, 0.1f, weight);
    lightcut_normalize(c, 0.1f, weight);
}

/* pmf_of by light of the tree's order, and how often each was chosen. */
static void expect_choice(const LightCut *c, const LitPoint *at, const float *weight,
                          const char *what)
{
    enum { DRAWS = 200000 };
    size_t n = c->tree->lights->n;
    double *expected = MEM_ARRAY(double, n), sum = 0, p;
    uint64_t *count = MEM_ARRAY(uint64_t, n);
    Rng r = rng_seed(7);

    REQUIRE(expected && count, "memory");
    for (size_t k = 0; k < c->n; k++)
        for (uint32_t i = c->first[k]; i < c->first[k + 1]; i++) {
            double pmf = (double)lightcut_pmf(c, at, weight, k, i);
            expected[c->tree->order[i]] = pmf * DRAWS;
            sum += pmf;
        }
    EXPECT(fabs(sum - 1) < 1e-5, "%s: the pmf adds up to %.9g", what, sum);
    for (int i = 0; i < DRAWS; i++) {
        double before = 0, x = (double)(rng_bits(&r) >> 11) * 0x1p-53;
        size_t k = 0, chosen;
        float pmf;
        chosen = lightcut_choose(c, at, weight, x, &k, &before, &pmf);
        count[chosen]++;
        EXPECT(fabs((double)pmf * DRAWS - expected[chosen]) <= 1e-6 * expected[chosen],
               "%s: %.9g is not the pmf", what, (double)pmf);
    }
    p = chi2_counts(expected, count, n);
    EXPECT(p >= CHI2_P_MIN, "%s: choices are not as the pmf, p = %g", what, p);
    mem_free(expected);
    mem_free(count);
}

static void chance(void)
{
    static const V3 normals[] = { { 0, 0, 1 }, { 0.6f, 0, 0.8f }, { 0, -1, 0 } };
    static float weight[CUT_MOST];
    PointLights p;
    LightTree t;
    Lab l;

    add_all(&l);
    lab_build(&l);
    points_of(&p, &l, 2000, true, INDIRECT_YES);
    REQUIRE(lighttree_init(&t, &p), "memory");
    for (int i = 0; i < 18; i++) {
        const CutRule rule = { i % 4 == 3 ? 1800 : 150, 0, 0.25f };
        LitPoint at = { { 0.3f, -0.5f, 0.4f }, normals[i % 3] };
        uint32_t m = lab_material(&l, surfaces[i / 3].kind, surfaces[i / 3].options);
        const Material *mat = &l.scene->materials[m];
        LightCut c;
        BsdfRoom room;
        if (i % 4 == 3)
            at.p.z = -3;                /* lights of the floor all face away */
        bsdf_make(&room.b[0], mat->kind, mat->value, mat->data);
        REQUIRE(lightcut_init(&c, &t, &rule, i % 2, (WithinCluster)(i % 5 % 3)), "memory");
        weigh(&c, &room.b[0], &at, weight);
        expect_choice(&c, &at, weight, surfaces[i / 3].kind);
        lightcut_clear(&c);
    }
    lighttree_clear(&t);
    pointlights_clear(&p);
    lab_clear(&l);
}

/* Slabs in double. Of rays that pass a box at less than a hair nothing is asked. */
static int meets(const Box *b, V3 p, V3 d, double grow)
{
    double near = 0, far = 1e300;

    for (int a = 0; a < 3; a++) {
        double lo = (double)v_axis(b->lo, a) - grow, hi = (double)v_axis(b->hi, a) + grow;
        double s = (lo - (double)v_axis(p, a)) / (double)v_axis(d, a);
        double e = (hi - (double)v_axis(p, a)) / (double)v_axis(d, a);
        near = d_max(near, d_min(s, e));
        far = d_min(far, d_max(s, e));
    }
    return near <= far;
}

static void boxes(void)
{
    static float energy[CUT_MOST];
    CutRule rule = { 333, 0, 0.25f };
    PointLights p;
    LightTree t;
    LightCut c;
    Lab l;
    Rng r = rng_seed(5);

    add_all(&l);
    lab_build(&l);
    points_of(&p, &l, 2500, false, INDIRECT_YES);
    REQUIRE(lighttree_init(&t, &p) && lightcut_init(&c, &t, &rule, true, WITHIN_EVEN), "memory");
    EXPECT(c.nbeyond > 20 && c.nbeyond + 20 < c.n, "%lu of %lu clusters are beyond",
           (unsigned long)c.nbeyond, (unsigned long)c.n);
    for (int i = 0; i < 500; i++) {
        V3 d, from = { 0.3f, -0.5f, 0.4f };
        d.x = rng_unit(&r) - 0.5f;
        d.y = rng_unit(&r) - 0.5f;
        d.z = rng_unit(&r) - 0.5f;
        d = v_unit(d);
        memset(energy, 0, sizeof energy);
        lightcut_count(&c, from, d, 1, energy);
        for (size_t k = 0; k < c.n; k++) {
            const Box *b = &t.node[c.node[k]].box;
            V3 o = k < c.nbeyond ? v_all(0) : from;
            int more = meets(b, o, d, 1e-5), less = meets(b, o, d, -1e-5);
            EXPECT(energy[k] == 0 ? !less : more && energy[k] == 1,
                   "ray %d, cluster %lu: counted %g times", i, (unsigned long)k,
                   (double)energy[k]);
        }
    }
    lightcut_clear(&c);
    lighttree_clear(&t);
    pointlights_clear(&p);
    lab_clear(&l);
}

/* Every direction is in the cell that it was drawn from. */
static void cells(void)
{
    Rng r = rng_seed(9);

    for (int i = 0; i < 100000; i++) {
        uint32_t side = 1 + (uint32_t)i % 181, cell = rng_below(&r, side * side);
        float x = 0.001f + 0.998f * rng_unit(&r), y = 0.001f + 0.998f * rng_unit(&r);
        V3 d = sphere_direction(side, cell, (V2){ x, y });
        EXPECT(sphere_cell(side, d) == cell, "cell %u of %u is taken for %u", cell, side,
               sphere_cell(side, d));
    }
}

const TestCase test_cut[] = {
    { "cells", cells, false },
    { "points", points, false },
    { "bounce", bounce, false },
    { "tree", tree, false },
    { "cuts", cuts, false },
    { "boxes", boxes, false },
    { "chance", chance, false },
    { NULL, NULL, false }
};
