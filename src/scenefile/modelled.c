/* modelled.c -- shapes of the scene language for modelling by hand: curves, tori, boxes, turned
 * outlines, and bodies made by rule. All become triangles. */
#include "scenefile/shapes.h"

#include "geometry/figures.h"
#include "geometry/generate.h"
#include "geometry/quadric_mesh.h"
#include "geometry/sweep.h"

#include <string.h>

/* ---- curves ---- */

static bool curve_normals(Place at, const Params *ps, uint32_t segments, V3 **out)
{
    const Param *p = params_find(ps, "N", NULL);

    *out = NULL;
    if (!p)
        return err_at(at, "a ribbon needs its normals, \"normal N\"");
    if (p->kind != PARAM_FLOAT || p->n != 3 * ((size_t)segments + 1))
        return err_at(p->at, "\"N\" is not right, expected %lu normals for a ribbon of %lu "
                      "segments", (unsigned long)segments + 1, (unsigned long)segments);
    *out = MEM_ARRAY(V3, segments + (size_t)1);
    for (size_t i = 0; *out && i <= segments; i++)
        (*out)[i] = v3((float)p->numbers[3 * i], (float)p->numbers[3 * i + 1],
                       (float)p->numbers[3 * i + 2]);
    return *out != NULL;
}

static bool sweep(Reader *r, Place at, const Sweep *s)
{
    Mesh m;

    memset(&m, 0, sizeof m);
    if (!reader_generate(r, at, sweep_triangles(s)))
        return false;
    if (!sweep_mesh(&m, s)) {
        mesh_clear(&m);
        return false;
    }
    if (m.ntris == 0) {
        mesh_clear(&m);
        return warn_at(at, "the curve has no length or no width; it is left out");
    }
    return shape_finish(r, at, &m, true);
}

static bool read_curve(Reader *r, Place at, const Params *ps, const Opts *o)
{
    Sweep s = { NULL, 0, (uint32_t)opt_int(o, "degree"), opt_is(o, "basis", "bspline"), NULL,
                opt_float(o, "width0"), opt_float(o, "width1") };
    V3 *normals = NULL;
    uint32_t segments;
    Mesh points;
    bool ok;

    if (!opt_given(o, "width0"))
        s.width0 = opt_float(o, "width");
    if (!opt_given(o, "width1"))
        s.width1 = opt_float(o, "width");
    memset(&points, 0, sizeof points);
    if (!shape_points(ps, at, &points))
        return false;
    s.p = points.p;
    s.n = points.nverts;
    segments = sweep_segments(&s);
    ok = segments != 0 ||
         err_at(at, "a %s curve of degree %lu cannot have %lu points, expected %s",
                s.bspline ? "bspline" : "bezier", (unsigned long)s.degree, (unsigned long)s.n,
                s.bspline ? "more than the degree" : "one more than a multiple of the degree");
    if (ok && opt_is(o, "type", "ribbon")) {
        ok = curve_normals(at, ps, segments, &normals);
        s.normals = normals;
    }
    ok = ok && sweep(r, at, &s);
    mem_free(normals);
    mesh_clear(&points);
    return ok;
}

static const OptDef curve_options[] = {
    { .key = "type", .type = OPT_CHOICE, .str = "flat", .choices = "flat cylinder ribbon",
      .help = "a ribbon has normals N at the ends of segments; the others are tubes" },
    { .key = "basis", .type = OPT_CHOICE, .str = "bezier", .choices = "bezier bspline",
      .help = "of the points P" },
    { .key = "degree", .type = OPT_INT, .num = 3, .lo = 2, .hi = 3, .help = "of its polynomials" },
    { .key = "width", .type = OPT_FLOAT, .num = 1, .lo = 0, .hi = 1e30, .help = "diameter" },
    { .key = "width0", .type = OPT_FLOAT, .num = 1, .lo = 0, .hi = 1e30,
      .help = "diameter where it begins; if not given, width" },
    { .key = "width1", .type = OPT_FLOAT, .num = 1, .lo = 0, .hi = 1e30,
      .help = "diameter where it ends; if not given, width" },
    { .key = "splitdepth", .type = OPT_FLOAT, .num = 3, .help = "read, without effect" },
    { .key = NULL }
};
const ShapeReader shape_curve = {
    { "curve", "PBRT4 6.7", "a tube or a ribbon along a curve: point3 P; of triangles",
      curve_options },
    read_curve
};

/* ---- tori ---- */

static bool read_torus(Reader *r, Place at, const Params *ps, const Opts *o)
{
    Quadric q;

    (void)ps;
    memset(&q, 0, sizeof q);
    q.kind = QUADRIC_TORUS;
    q.radius = opt_float(o, "radius");
    q.inner = opt_float(o, "minorradius");
    q.phimax = opt_float(o, "phimax");
    if (!(q.inner < q.radius))
        return err_at(at, "the torus meets itself, expected minorradius below radius");
    return shape_add_quadric(r, at, &q);
}

static const OptDef torus_options[] = {
    { .key = "radius", .type = OPT_FLOAT, .num = 1, .lo = 1e-30, .hi = 1e30,
      .help = "of the ring" },
    { .key = "minorradius", .type = OPT_FLOAT, .num = 0.4, .lo = 1e-30, .hi = 1e30,
      .help = "of its tube" },
    SHAPE_PHIMAX,
    { .key = NULL }
};
const ShapeReader shape_torus = {
    { "torus", "", "a ring about z; of triangles", torus_options }, read_torus
};

/* ---- boxes ---- */

static bool read_box(Reader *r, Place at, const Params *ps, const Opts *o)
{
    V3 a = opt_point(o, "from"), b = opt_point(o, "to");
    Mesh m;

    (void)ps;
    if (!(a.x < b.x && a.y < b.y && a.z < b.z))
        return err_at(at, "the box is empty, expected each number of from below that of to");
    return shape_finish(r, at, &m, mesh_box(&m, a, b));
}

static const OptDef box_options[] = {
    { .key = "from", .type = OPT_POINT, .num = -1, .help = "the corner of least coordinates" },
    { .key = "to", .type = OPT_POINT, .num = 1, .help = "the corner of largest coordinates" },
    { .key = NULL }
};
const ShapeReader shape_box = {
    { "box", "", "a box along the axes; of triangles", box_options }, read_box
};

/* ---- turned outlines ---- */

static bool outline_points(Place at, const Params *ps, Outline *f, V2 **out)
{
    const Param *p = params_find(ps, "P", NULL);

    *out = NULL;
    if (!p || p->kind != PARAM_FLOAT || p->n % 2 || p->n < 4 || p->n / 2 > MESH_MAX)
        return err_at(p ? p->at : at, "a lathe needs its outline, two or more \"point2 P\": "
                      "distance from the axis, height");
    *out = MEM_ARRAY(V2, p->n / 2);
    if (!*out)
        return false;
    f->p = *out;
    f->n = (uint32_t)(p->n / 2);
    for (size_t i = 0; i < p->n; i++) {
        float v = (float)p->numbers[i];
        if (i % 2 == 0 && !(v >= 0))
            return err_at(p->at, "point %lu of the outline is beyond the axis, expected 0 or more",
                          (unsigned long)(i / 2));
        if (i % 2)
            (*out)[i / 2].y = v;
        else
            (*out)[i / 2].x = v;
    }
    return true;
}

static bool read_lathe(Reader *r, Place at, const Params *ps, const Opts *o)
{
    Outline f = { NULL, 0, opt_bool(o, "smooth"), opt_float(o, "phimax"),
                  (uint32_t)opt_int(o, "around") };
    V2 *points;
    Mesh m;
    bool ok;

    memset(&m, 0, sizeof m);
    ok = outline_points(at, ps, &f, &points) && reader_generate(r, at, outline_triangles(&f)) &&
         outline_mesh(&m, &f);
    mem_free(points);
    return shape_finish(r, at, &m, ok);
}

static const OptDef lathe_options[] = {
    { .key = "smooth", .type = OPT_BOOL, .num = 1,
      .help = "a curve through the points, with corners where one is given twice; else straight" },
    { .key = "around", .type = OPT_INT, .num = 96, .lo = 3, .hi = 10000,
      .help = "steps of a full turn" },
    SHAPE_PHIMAX,
    { .key = NULL }
};
const ShapeReader shape_lathe = {
    { "lathe", "", "an outline turned about z: point2 P, radius and height; of triangles",
      lathe_options },
    read_lathe
};

/* ---- bodies made by rule ---- */

static bool read_generated(Reader *r, Place at, const Params *ps, const Opts *o)
{
    static const char *const names[] = { "rock", "knot", "skull", "statue", "hare", "dragon" };
    uint32_t ntris = (uint32_t)opt_int(o, "triangles");
    unsigned kind = 0;
    Mesh m;

    (void)ps;
    while (!opt_is(o, "kind", names[kind]))
        kind++;
    return reader_generate(r, at, ntris) &&
           shape_finish(r, at, &m, figure_mesh(&m, (FigureKind)kind, ntris,
                                               (uint64_t)opt_int(o, "seed")));
}

static const OptDef generated_options[] = {
    { .key = "kind", .type = OPT_CHOICE, .str = "rock",
      .choices = "rock knot skull statue hare dragon",
      .help = "about 1 high, on z = 0, looks to -y; the knot lies about the origin" },
    { .key = "triangles", .type = OPT_INT, .num = 20000, .lo = 1000, .hi = 4e6,
      .help = "how many; an odd number becomes one less" },
    { .key = "seed", .type = OPT_INT, .num = 1, .lo = 0, .hi = 1e9, .help = "gives other rocks" },
    { .key = NULL }
};
const ShapeReader shape_generated = {
    { "generated", "", "a closed body made by rule, of any number of triangles",
      generated_options },
    read_generated
};
