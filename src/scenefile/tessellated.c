/* tessellated.c -- shapes of the scene language that become triangles: shapes of revolution, Loop
 * subdivision, bilinear patches. Their number is bounded for the whole scene, so that a few words
 * cannot ask for all memory. */
#include "scenefile/shapes.h"

#include "geometry/loop.h"

#include <string.h>

/* ---- shapes of revolution ---- */

static const char *fault(const Quadric *q)
{
    switch (q->kind) {
    case QUADRIC_PARABOLOID:
        return q->zmin >= 0 && q->zmin < q->zmax ? NULL : "expected 0 <= zmin < zmax";
    case QUADRIC_CYLINDER:
        return q->zmin != q->zmax ? NULL : "expected zmin unlike zmax";
    case QUADRIC_CONE:
        return q->height != 0 ? NULL : "expected a height that is not 0";
    case QUADRIC_SPHERE: case QUADRIC_DISK: case QUADRIC_HYPERBOLOID: case QUADRIC_TORUS:
        break;
    }
    return NULL;
}

bool shape_add_quadric(Reader *r, Place at, const Quadric *q)
{
    const char *why = fault(q);
    Mesh m;

    if (why)
        return err_at(at, "the shape is empty, %s", why);
    if (!reader_generate(r, at, quadric_triangles(q)))
        return false;
    memset(&m, 0, sizeof m);
    return shape_finish(r, at, &m, quadric_mesh(&m, q));
}

static Quadric quadric(QuadricKind kind, const Opts *o)
{
    Quadric q;
    memset(&q, 0, sizeof q);
    q.kind = kind;
    q.phimax = opt_float(o, "phimax");
    q.radius = 1;
    return q;
}

bool shape_distorted_sphere(Reader *r, Place at, const Opts *o, float zmin, float zmax)
{
    Quadric q = quadric(QUADRIC_SPHERE, o);
    q.radius = opt_float(o, "radius");
    q.zmin = zmin;
    q.zmax = zmax;
    return shape_add_quadric(r, at, &q);
}

bool shape_distorted_disk(Reader *r, Place at, const Opts *o)
{
    Quadric q = quadric(QUADRIC_DISK, o);
    q.radius = opt_float(o, "radius");
    q.inner = opt_float(o, "innerradius");
    q.height = opt_float(o, "height");
    return shape_add_quadric(r, at, &q);
}

static bool read_cylinder(Reader *r, Place at, const Params *ps, const Opts *o)
{
    Quadric q = quadric(QUADRIC_CYLINDER, o);
    (void)ps;
    q.radius = opt_float(o, "radius");
    q.zmin = f_min(opt_float(o, "zmin"), opt_float(o, "zmax"));
    q.zmax = f_max(opt_float(o, "zmin"), opt_float(o, "zmax"));
    return shape_add_quadric(r, at, &q);
}

static const OptDef cylinder_options[] = {
    SHAPE_RADIUS, SHAPE_ALONG_Z("zmin", -1, "lower end"), SHAPE_ALONG_Z("zmax", 1, "upper end"),
    SHAPE_PHIMAX, { .key = NULL }
};
const ShapeReader shape_cylinder = {
    { "cylinder", "PBRT4 6.3", "round z, open at the ends; of triangles", cylinder_options },
    read_cylinder
};

static bool read_cone(Reader *r, Place at, const Params *ps, const Opts *o)
{
    Quadric q = quadric(QUADRIC_CONE, o);
    (void)ps;
    q.radius = opt_float(o, "radius");
    q.height = opt_float(o, "height");
    return shape_add_quadric(r, at, &q);
}

static const OptDef cone_options[] = {
    SHAPE_RADIUS, SHAPE_ALONG_Z("height", 1, "of the tip"), SHAPE_PHIMAX, { .key = NULL }
};
const ShapeReader shape_cone = {
    { "cone", "PBRT3 3.5", "round z, open below; of triangles", cone_options }, read_cone
};

static bool read_paraboloid(Reader *r, Place at, const Params *ps, const Opts *o)
{
    Quadric q = quadric(QUADRIC_PARABOLOID, o);
    (void)ps;
    q.radius = opt_float(o, "radius");
    q.zmin = opt_float(o, "zmin");
    q.zmax = opt_float(o, "zmax");
    return shape_add_quadric(r, at, &q);
}

static const OptDef paraboloid_options[] = {
    SHAPE_RADIUS, SHAPE_ALONG_Z("zmin", 0, "lower end"),
    SHAPE_ALONG_Z("zmax", 1, "upper end, where radius holds"),
    SHAPE_PHIMAX, { .key = NULL }
};
const ShapeReader shape_paraboloid = {
    { "paraboloid", "PBRT3 3.5", "round z; of triangles", paraboloid_options },
    read_paraboloid
};

static bool read_hyperboloid(Reader *r, Place at, const Params *ps, const Opts *o)
{
    Quadric q = quadric(QUADRIC_HYPERBOLOID, o);
    (void)ps;
    q.p1 = opt_point(o, "p1");
    q.p2 = opt_point(o, "p2");
    return shape_add_quadric(r, at, &q);
}

static const OptDef hyperboloid_options[] = {
    { .key = "p1", .type = OPT_POINT, .num = 0, .help = "one end of the line that turns" },
    { .key = "p2", .type = OPT_POINT, .str = "1 1 1", .help = "its other end" },
    SHAPE_PHIMAX, { .key = NULL }
};
const ShapeReader shape_hyperboloid = {
    { "hyperboloid", "PBRT3 3.5", "a line turned round z; of triangles", hyperboloid_options },
    read_hyperboloid
};

/* ---- Loop subdivision ---- */

static bool subdivide(Reader *r, Place at, Mesh *m, int levels)
{
    if (!reader_generate(r, at, (uint64_t)m->ntris << (2 * levels)))
        return false;
    switch (loop_subdivide(m, levels)) {
    case LOOP_DONE:         return true;
    case LOOP_NO_MEMORY:    return false;
    case LOOP_NOT_MANIFOLD: break;
    }
    return warn_at(at, "the mesh is not a manifold with one front; it is used without subdivision");
}

static bool read_loop(Reader *r, Place at, const Params *ps, const Opts *o)
{
    Mesh m;
    bool ok;

    memset(&m, 0, sizeof m);
    ok = shape_points(ps, at, &m) && shape_triangles(ps, at, &m) &&
         subdivide(r, at, &m, (int)opt_int(o, "levels"));
    return shape_finish(r, at, &m, ok);
}

static const OptDef loop_options[] = {
    { .key = "levels", .type = OPT_INT, .num = 3, .lo = 0, .hi = 10, .also = "nlevels",
      .help = "each makes four triangles of one" },
    { .key = "scheme", .type = OPT_STRING, .str = "loop", .help = "read, without effect" },
    { .key = NULL }
};
const ShapeReader shape_loopsubdiv = {
    { "loopsubdiv", "Loop87", "a mesh made smooth: point3 P, integer indices", loop_options },
    read_loop
};

/* ---- bilinear patches ---- */

static V3 bilinear(const V3 c[4], float u, float v)
{
    return v_lerp(v_lerp(c[0], c[1], u), v_lerp(c[2], c[3], u), v);
}

/* Triangles can be a patch only if it is flat and a parallelogram, or if its rim alone matters. */
static bool is_parallelogram(const V3 c[4])
{
    V3 d = v_sub(v_add(c[0], c[3]), v_add(c[1], c[2]));
    float size = v_max3(v_abs(v_sub(c[3], c[0])));
    return v_max3(v_abs(d)) <= 1e-5f * size;    /* a few roundings of numbers of seven digits */
}

enum { PATCH_STEPS = 16 };

/* Vertices and triangles of one patch with corners v, in n x n steps. */
static void add_patch(Mesh *fine, const Mesh *m, const uint32_t v[4], uint32_t n)
{
    uint32_t base = fine->nverts;
    V3 p[4], nor[4] = { { 0, 0, 0 } }, uv[4];

    for (int k = 0; k < 4; k++) {
        p[k] = m->p[v[k]];
        if (m->n)
            nor[k] = m->n[v[k]];
        uv[k] = m->uv ? v3(m->uv[v[k]].x, m->uv[v[k]].y, 0)
                      : v3((float)(k & 1), (float)(k >> 1), 0);
    }
    for (uint32_t j = 0; j <= n; j++)
        for (uint32_t i = 0; i <= n; i++) {
            float a = (float)i / (float)n, b = (float)j / (float)n;
            V3 t = bilinear(uv, a, b);
            fine->p[fine->nverts] = bilinear(p, a, b);
            fine->n[fine->nverts] = m->n ? bilinear(nor, a, b)
                : v_cross(v_lerp(v_sub(p[1], p[0]), v_sub(p[3], p[2]), b),
                          v_lerp(v_sub(p[2], p[0]), v_sub(p[3], p[1]), a));
            fine->uv[fine->nverts++] = (V2){ t.x, t.y };
        }
    for (uint32_t j = 0; j < n; j++)
        for (uint32_t i = 0; i < n; i++) {
            uint32_t a = base + j * (n + 1) + i, d = a + n + 1;
            fine->tri[fine->ntris++] = (Tri){ { a, a + 1, d + 1 } };
            fine->tri[fine->ntris++] = (Tri){ { a, d + 1, d } };
        }
}

static uint32_t patch_corners(const Mesh *m, const Param *p, uint32_t i, uint32_t v[4])
{
    V3 c[4];
    for (uint32_t k = 0; k < 4; k++) {
        v[k] = p ? (uint32_t)p->numbers[4 * (size_t)i + k] : k;
        c[k] = m->p[v[k]];
    }
    return is_parallelogram(c) ? 1 : PATCH_STEPS;
}

static bool patches(Reader *r, Place at, const Mesh *m, const Param *p, Mesh *fine)
{
    uint32_t npatches = p ? (uint32_t)(p->n / 4) : 1, v[4];
    uint64_t nverts = 0, ntris = 0;

    for (uint32_t i = 0; i < npatches; i++) {
        uint64_t n = patch_corners(m, p, i, v);
        nverts += (n + 1) * (n + 1);
        ntris += 2 * n * n;
    }
    if (!reader_generate(r, at, ntris))         /* bounds nverts too */
        return false;
    if (!mesh_alloc(fine, (size_t)nverts, (size_t)ntris, true, true))
        return false;
    for (uint32_t i = 0; i < npatches; i++) {
        uint32_t n = patch_corners(m, p, i, v);
        add_patch(fine, m, v, n);
    }
    return true;
}

static bool read_bilinear(Reader *r, Place at, const Params *ps, const Opts *o)
{
    Mesh m, fine;
    const Param *p;
    bool ok;

    (void)o;
    memset(&m, 0, sizeof m);
    memset(&fine, 0, sizeof fine);
    ok = shape_points(ps, at, &m) && shape_indices(ps, at, 4, m.nverts, &p) &&
         shape_normals(ps, &m) && patches(r, at, &m, p, &fine);
    mesh_clear(&m);
    return shape_finish(r, at, &fine, ok);
}

const ShapeReader shape_bilinearmesh = {
    { "bilinearmesh", "PBRT4 6.6", "patches between four points; of triangles", NULL },
    read_bilinear
};
