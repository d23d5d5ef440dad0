/* ray_zoo.c -- meshes that rays are shot at: a few tame ones, and every way of being degenerate
 * that has broken a ray tracer. See ray_help.h. */
#include "test/ray_help.h"

#include <string.h>

const Where places_sane[PLACES_SANE] = {
    { 1, { 0, 0, 0 } }, { 1e-6, { 0, 0, 0 } }, { 1e6, { 0, 0, 0 } }, { 1, { 10, -20, 30 } },
    { 1, { 148376, 1234, -223423 } }, { 1e3, { 1e6f, 0, -1e6f } }, { 1e-3, { 0, 5, 0.1f } }
};

void mesh_of(Mesh *m, uint32_t nverts, uint32_t ntris)
{
    memset(m, 0, sizeof *m);
    m->p = MEM_ARRAY(V3, nverts);
    m->tri = MEM_ARRAY(Tri, ntris);
    REQUIRE(m->p && m->tri, "memory");
    m->nverts = nverts;
    m->ntris = ntris;
}

void mesh_place(Mesh *m, double scale, V3 offset)
{
    for (uint32_t i = 0; i < m->nverts; i++)
        m->p[i] = v3((float)(scale * m->p[i].x + offset.x), (float)(scale * m->p[i].y + offset.y),
                     (float)(scale * m->p[i].z + offset.z));
}

void geometry_of(Geometry *g, Mesh *m)
{
    ShapeTraits plain = { 0, NO_LIGHT, false };
    memset(g, 0, sizeof *g);
    REQUIRE(geometry_add_mesh(g, m, plain, NULL) && geometry_finish(g), "memory");
}

/* ---- tame ---- */

#define TAME(name, call) \
    static void name(Mesh *m) { memset(m, 0, sizeof *m); REQUIRE(call, "memory"); }
TAME(cube, mesh_cube(m))
TAME(room, mesh_room(m))
TAME(grid, mesh_grid(m, 10, 10))
TAME(icosphere, mesh_icosphere(m, 3))
TAME(uvsphere, mesh_uvsphere(m, 16, 7))
TAME(torus, mesh_torus(m, 14, 7, 1.0f, 0.4f))
TAME(bumpy, mesh_bumpy(m, 3, 7))
TAME(blob, mesh_blob(m, 3))
TAME(soup, mesh_soup(m, 180, 0.4f, 5))
TAME(dust, mesh_soup(m, 300, 0.02f, 6))

const ZooMesh zoo_tame[] = {
    { "cube", cube }, { "room", room }, { "grid", grid }, { "icosphere", icosphere },
    { "uvsphere", uvsphere }, { "torus", torus }, { "bumpy", bumpy }, { "blob", blob },
    { "soup", soup }, { "dust", dust }, { NULL, NULL }
};

/* ---- wild ---- */

/* n triangles with corners of their own. */
static void separate(Mesh *m, uint32_t n)
{
    mesh_of(m, 3 * n, n);
    for (uint32_t i = 0; i < n; i++)
        m->tri[i] = (Tri){ { 3 * i, 3 * i + 1, 3 * i + 2 } };
}

static V3 in_cube(Rng *rng) { return rng_in_box(rng, (Box){ v_all(-1.0f), v_all(1.0f) }); }

/* Long edge about 1, height about `height`; the third corner near the first (a needle) or along the
 * edge (a flat roof). */
static void thin(Mesh *m, float height, bool roof)
{
    Rng rng = rng_seed(roof ? 11 : 12);
    separate(m, 150);
    for (uint32_t i = 0; i < m->nverts; i += 3) {
        V3 a = in_cube(&rng), b = in_cube(&rng);
        float w = roof ? rng_unit(&rng) : 0.0f;
        m->p[i] = a;
        m->p[i + 1] = b;
        m->p[i + 2] = v_mad(in_cube(&rng), height, v_lerp(a, b, w));
    }
}
static void slivers(Mesh *m) { thin(m, 1e-3f, true); }
static void roofs(Mesh *m) { thin(m, 1e-5f, true); }
static void needles(Mesh *m) { thin(m, 1e-5f, false); }

/* Two corners equal, all three equal, all on a line exactly. */
static void collapsed(Mesh *m)
{
    Rng rng = rng_seed(13);
    separate(m, 120);
    for (uint32_t i = 0; i < m->nverts; i += 3) {
        V3 a = in_cube(&rng), b = v3(0.25f * a.y, a.z, 0.5f);
        uint32_t how = i / 3 % 4;
        m->p[i] = a;
        m->p[i + 1] = how == 0 ? a : b;
        m->p[i + 2] = how < 2 ? a : how == 2 ? b : v_sub(v_scale(b, 2.0f), a);
    }
}

/* Each triangle five times, with its corners turned, mirrored and numbered apart. */
static void duplicates(Mesh *m)
{
    static const int turn[5][3] = { { 0, 1, 2 }, { 1, 2, 0 }, { 2, 1, 0 }, { 0, 1, 2 },
                                    { 0, 2, 1 } };
    Rng rng = rng_seed(14);
    separate(m, 150);
    for (uint32_t i = 0; i < 30; i++) {
        V3 c[3];
        for (int k = 0; k < 3; k++)
            c[k] = in_cube(&rng);
        for (uint32_t copy = 0; copy < 5; copy++)
            for (uint32_t k = 0; k < 3; k++)
                m->p[3 * (30 * copy + i) + k] = c[turn[copy][k]];
    }
}

/* Triangles on top of each other in three planes, corners on a coarse lattice: exact ties. */
static void overlapping(Mesh *m)
{
    Rng rng = rng_seed(15);
    separate(m, 150);
    for (uint32_t i = 0; i < m->nverts; i++) {
        float x = 0.25f * (float)rng_below(&rng, 9), y = 0.25f * (float)rng_below(&rng, 9);
        m->p[i] = i % 9 < 3 ? v3(x, y, 0.5f) : i % 9 < 6 ? v3(0.5f, x, y) : v3(x, 1.0f, y);
    }
}

/* The boxes of all have one centre: nothing to divide by. */
static void concentric(Mesh *m)
{
    Rng rng = rng_seed(16);
    separate(m, 130);
    for (uint32_t i = 0; i < m->nverts; i += 3) {
        V3 a = in_cube(&rng);
        m->p[i] = a;
        m->p[i + 1] = v_neg(a);
        m->p[i + 2] = v3(a.x, -a.y, a.z);
    }
}

static void identical(Mesh *m)
{
    separate(m, 100);
    for (uint32_t i = 0; i < m->nverts; i++)
        m->p[i] = i % 3 == 0 ? v3(0, 0, 0) : i % 3 == 1 ? v3(1, 0.5f, 0) : v3(0.5f, 1, 0.25f);
}

static void single(Mesh *m)
{
    separate(m, 1);
    m->p[1] = v3(1, 0, 0.5f);
    m->p[2] = v3(0, 1, -0.25f);
}

static void empty(Mesh *m) { mesh_of(m, 0, 0); }

/* Rectangles across the axes, some in the same plane: boxes without thickness. */
static void sheets(Mesh *m)
{
    mesh_of(m, 4 * 60, 2 * 60);
    for (uint32_t i = 0; i < 60; i++) {
        float at = (float)(i % 20) / 16.0f;
        uint32_t v = 4 * i;
        for (uint32_t k = 0; k < 4; k++) {
            float x = k & 1 ? 1.25f : 0.0f, y = k & 2 ? 1.25f : 0.0f;
            m->p[v + k] = i < 20 ? v3(x, y, at) : i < 40 ? v3(at, x, y) : v3(y, at, x);
        }
        m->tri[2 * i] = (Tri){ { v, v + 1, v + 3 } };
        m->tri[2 * i + 1] = (Tri){ { v, v + 3, v + 2 } };
    }
}

/* Cubes face to face: every inner face twice, every vertex in up to eight cubes. */
static void bricks(Mesh *m)
{
    enum { SIDE = 3, N = SIDE * SIDE * SIDE };
    Mesh one;
    cube(&one);
    mesh_of(m, N * one.nverts, N * one.ntris);
    for (uint32_t i = 0; i < N; i++) {
        V3 at = v3((float)(i % SIDE), (float)(i / SIDE % SIDE), (float)(i / SIDE / SIDE));
        for (uint32_t k = 0; k < one.nverts; k++)
            m->p[i * one.nverts + k] = v_add(one.p[k], at);
        for (uint32_t k = 0; k < 3 * one.ntris; k++)
            m->tri[i * one.ntris + k / 3].v[k % 3] = i * one.nverts + one.tri[k / 3].v[k % 3];
    }
    mesh_clear(&one);
}

/* One triangle a million times larger than the others, and another as much larger than that. */
static void mixed_sizes(Mesh *m)
{
    memset(m, 0, sizeof *m);
    REQUIRE(mesh_soup(m, 120, 0.2f, 17), "memory");
    for (uint32_t k = 0; k < 3; k++) {
        m->p[3 * 60 + k] = v_scale(m->p[3 * 60 + k], 1e6f);
        m->p[3 * 90 + k] = v_scale(m->p[3 * 90 + k], 1e12f);
    }
}

/* Sizes and places from 2^-100 to 2^100: every cut between bins takes off one. */
static void series(Mesh *m)
{
    float x = 0x1p-100f;
    separate(m, 201);
    for (uint32_t i = 0; i < 201; i++, x *= 2.0f) {
        m->p[3 * i] = v3(x, 0, 0);
        m->p[3 * i + 1] = v3(x, x, 0);
        m->p[3 * i + 2] = v3(x, 0, x);
    }
}

static void scaled_soup(Mesh *m, double scale)
{
    soup(m);
    mesh_place(m, scale, v_all(0.0f));
}
static void denormal(Mesh *m) { scaled_soup(m, 1e-40); }
static void minute(Mesh *m) { scaled_soup(m, 1e-18); }
static void giant(Mesh *m) { scaled_soup(m, 1e18); }
static void overflowing(Mesh *m) { scaled_soup(m, 3e38); }

const ZooMesh zoo_wild[] = {
    { "slivers", slivers }, { "roofs", roofs }, { "needles", needles }, { "collapsed", collapsed },
    { "duplicates", duplicates }, { "overlapping", overlapping }, { "concentric", concentric },
    { "identical", identical }, { "single", single }, { "empty", empty }, { "sheets", sheets },
    { "bricks", bricks }, { "mixed sizes", mixed_sizes }, { "series", series },
    { "denormal", denormal }, { "minute", minute }, { "giant", giant },
    { "overflowing", overflowing }, { NULL, NULL }
};
