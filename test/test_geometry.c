/* test_geometry.c -- the primitives of a space: which shape each belongs to, and what shading
 * learns of a triangle: point and its error, normals, texture coordinates. */
#include "test/ray_help.h"

#include <string.h>

static const ShapeTraits plain = { 0, NO_LIGHT, false }, flipped = { 0, NO_LIGHT, true };

/* ---- tables ---- */

static void any_mesh(Mesh *m, uint32_t ntris)
{
    mesh_of(m, ntris + 2, ntris);
    for (uint32_t i = 0; i < ntris; i++) {
        m->tri[i] = (Tri){ { i, i + 1, i + 2 } };
        m->p[i].x = (float)i;
    }
}

static void add_any(Geometry *g, Rng *rng)
{
    Transform t = xf_identity();
    Sphere s;
    Disk d;
    Mesh m;
    bool ok = true;

    REQUIRE(sphere_init(&s, &t, 1, -1, 1, 360) && disk_init(&d, &t, 0, 1, 0, 360), "identity");
    switch (rng_below(rng, 5)) {
    case 0:
    case 1:
        any_mesh(&m, rng_below(rng, 3) ? rng_below(rng, 20) : 0);
        ok = geometry_add_mesh(g, &m, plain, NULL);
        break;
    case 2: ok = geometry_add_sphere(g, &s, plain, NULL); break;
    case 3: ok = geometry_add_disk(g, &d, plain, NULL); break;
    case 4: ok = geometry_add_instance(g, 1, &t, NULL); break;
    }
    REQUIRE(ok, "memory");
}

/* Each primitive belongs to one shape, and geometry_shape finds that one. */
static void check_shapes(const Geometry *g)
{
    uint64_t total = 0;

    for (size_t i = 0; i < g->nshapes; i++) {
        const Shape *s = &g->shapes[i];
        total += s->count;
        for (uint32_t k = s->first; k < s->first + s->count; k++)
            EXPECT(geometry_shape(g, k) == s, "primitive %lu of %lu shapes", (unsigned long)k,
                   (unsigned long)g->nshapes);
        EXPECT((s->kind == SHAPE_MESH) == (s->first + s->count <= g->ntris) || !s->count,
               "triangles come first");
    }
    EXPECT(total == geometry_prims(g), "%lu primitives, shapes hold %lu",
           (unsigned long)geometry_prims(g), (unsigned long)total);
}

static void shapes(void)
{
    Rng rng = rng_seed(51);

    for (uint32_t n = 0; n < 200; n++) {
        Geometry g;
        memset(&g, 0, sizeof g);
        for (uint32_t i = 0; i < n % 40; i++)
            add_any(&g, &rng);
        REQUIRE(geometry_finish(&g), "memory");
        check_shapes(&g);
        add_any(&g, &rng);                      /* going on and finishing again is allowed */
        REQUIRE(geometry_finish(&g), "memory");
        check_shapes(&g);
        geometry_clear(&g);
    }
}

/* ---- normals and texture coordinates of triangles ---- */

/* The triangle (0,0,0) (1,0,0) (0,1,0), whose front is +z, after another so that offsets count. */
static void two_triangles(Geometry *g, const V3 *n, bool with_uv, ShapeTraits traits)
{
    Mesh m;

    memset(g, 0, sizeof *g);
    any_mesh(&m, 4);
    REQUIRE(geometry_add_mesh(g, &m, plain, NULL), "memory");
    mesh_of(&m, 3, 1);
    m.p[1] = v3(1, 0, 0);
    m.p[2] = v3(0, 1, 0);
    m.tri[0] = (Tri){ { 0, 1, 2 } };
    if (n) {
        m.n = MEM_ARRAY(V3, 3);
        REQUIRE(m.n, "memory");
        for (int k = 0; k < 3; k++)
            m.n[k] = n[k];
    }
    if (with_uv) {
        m.uv = MEM_ARRAY(V2, 3);
        REQUIRE(m.uv, "memory");
        m.uv[0] = (V2){ 10, 20 };
        m.uv[1] = (V2){ 30, 20 };
        m.uv[2] = (V2){ 10, 60 };
    }
    REQUIRE(geometry_add_mesh(g, &m, traits, NULL) && geometry_finish(g), "memory");
}

static Surface surface_at(const Geometry *g, uint32_t prim, float u, float v)
{
    Ray r = { .o = { 0, 0, 0 }, .d = { 0, 0, 1 }, .tmax = 1 };
    Hit h = { 0, u, v, prim, prim };
    Surface s;
    geometry_surface(g, &r, &h, &s);
    return s;
}

static void expect_surface(const char *what, const V3 *n, ShapeTraits traits, float ng, V3 ns)
{
    Geometry g;
    Surface s;

    two_triangles(&g, n, false, traits);
    s = surface_at(&g, 4, 0.25f, 0.5f);
    EXPECT(s.ng.x == 0 && s.ng.y == 0 && s.ng.z == ng, "%s: ng %g %g %g", what, (double)s.ng.x,
           (double)s.ng.y, (double)s.ng.z);
    EXPECT(v_len(v_sub(s.ns, v_unit(ns))) < ROUNDINGS(8), "%s: ns %g %g %g", what, (double)s.ns.x,
           (double)s.ns.y, (double)s.ns.z);
    EXPECT(s.shape == &g.shapes[1] && s.prim == 4, "%s: shape", what);
    EXPECT(s.p.x == 0.25f && s.p.y == 0.5f && s.p.z == 0, "%s: point", what);
    EXPECT(s.uv.x == 0.25f && s.uv.y == 0.5f, "%s: uv are the weights", what);
    geometry_clear(&g);
}

static void normals(void)
{
    const V3 up[3] = { { 0, 0, 1 }, { 0.6f, 0, 0.8f }, { 0, 0.6f, 0.8f } }, none[3] = { { 0 } };
    V3 down[3], mean = { 0.15f, 0.3f, 0.85f };

    for (int k = 0; k < 3; k++)
        down[k] = v_neg(up[k]);
    expect_surface("no normals", NULL, plain, 1, v3(0, 0, 1));
    expect_surface("turned", NULL, flipped, -1, v3(0, 0, -1));
    expect_surface("normals of the file", up, plain, 1, mean);
    expect_surface("the file's front is behind", down, plain, -1, v_neg(mean));
    expect_surface("normals that are none", none, plain, 1, v3(0, 0, 1));
    expect_surface("none, turned", none, flipped, -1, v3(0, 0, -1));
}

static void texture_of_triangles(void)
{
    Geometry g;
    Surface s;

    two_triangles(&g, NULL, true, plain);
    s = surface_at(&g, 4, 0.25f, 0.5f);
    EXPECT(s.uv.x == 15 && s.uv.y == 40, "uv %g %g", (double)s.uv.x, (double)s.uv.y);
    g.shapes[1].plain = true;
    s = surface_at(&g, 4, 0.25f, 0.5f);
    EXPECT(s.uv.x == 0 && s.uv.y == 0, "uv where nobody looks: %g %g", (double)s.uv.x,
           (double)s.uv.y);
    geometry_clear(&g);
}

/* ---- the error of points ---- */

/* p is within err, in each coordinate, of the point of the triangle that its weights mean, and so
 * off the plane by at most |n| . err. Rounded weights do not add up to 1: their ratios count. */
static void triangle_errors(void)
{
    Rng rng = rng_seed(52);
    uint64_t bad = 0, off = 0;

    for (uint32_t i = 0; i < 100000; i++) {
        const Where *at = &places_sane[i % PLACES_SANE];
        V3 c[3], w = rng_barycentric(&rng), p, err;
        Box unit = { { -1, -1, -1 }, { 1, 1, 1 } };
        Tri tri = { { 0, 1, 2 } };
        double sum;
        Geometry g;
        D3 q, normal;

        for (int k = 0; k < 3; k++)
            c[k] = v_mad(rng_in_box(&rng, unit), (float)at->scale, at->offset);
        if (i % 5 == 0)
            c[2] = v_mad(v_sub(c[2], c[0]), 1e-4f, c[0]);
        if (i % 7 == 0)
            w = v3(0.0f, float_after(w.y), 1.0f - w.y);
        w.x = f_max(0.0f, 1.0f - w.y - w.z);
        sum = (double)w.x + w.y + w.z;
        memset(&g, 0, sizeof g);
        g.p = c;
        g.tri = &tri;
        g.ntris = 1;
        geometry_point(&g, 0, w.y, w.z, &p, &err);
        normal = d3_cross(d3_sub(d3(c[1]), d3(c[0])), d3_sub(d3(c[2]), d3(c[0])));
        off += !(fabs(d3_dot(normal, d3_sub(d3(p), d3(c[0])))) <= d3_reach(normal, d3(err)));
        q = (D3){ p.x - ((double)w.x * c[0].x + (double)w.y * c[1].x + (double)w.z * c[2].x) / sum,
                  p.y - ((double)w.x * c[0].y + (double)w.y * c[1].y + (double)w.z * c[2].y) / sum,
                  p.z - ((double)w.x * c[0].z + (double)w.y * c[1].z + (double)w.z * c[2].z) / sum
        };
        bad += fabs(q.x) > err.x || fabs(q.y) > err.y || fabs(q.z) > err.z;
    }
    EXPECT(!bad && !off, "of 100000 points %lu are in error by more, %lu off the plane by more",
           (unsigned long)bad, (unsigned long)off);
}

const TestCase test_geometry[] = {
    { "shapes", shapes, false }, { "normals", normals, false },
    { "texture_of_triangles", texture_of_triangles, false },
    { "triangle_errors", triangle_errors, false },
    { NULL, NULL, false }
};
