/* tessellations.c -- shapes of the scene language that stay grids of points: height fields and
 * geometry images. No list of triangles is made of them; see geometry/tessellation.h. */
#include "scenefile/shapes.h"

#include "base/maths.h"
#include "geometry/image_shapes.h"

/* A triangle of these takes less than a quarter of the memory of one of a mesh. */
enum { CHEAPER = 4 };

static bool is_triangular(const Opts *o) { return opt_is(o, "subdivision", "triangular"); }
static int bits_of(const Opts *o) { return opt_int(o, "bits") < 32 ? 16 : 32; }

#define SUBDIVISION \
    { .key = "subdivision", .type = OPT_CHOICE, .str = "rectangular", \
      .choices = "rectangular triangular", .help = "of the grid" }
#define NUMBER_BITS \
    { .key = "bits", .type = OPT_INT, .num = 32, .lo = 16, .hi = 32, \
      .help = "of a number of a point: 32, or 16 for fractions of their range" }

/* Adds it with the material and light of the moment; takes it over. Fronts are as for meshes
 * without normals, see shapes.c. */
static bool add(Reader *r, Place at, Tessellation *t, bool smooth)
{
    ShapeTraits traits;
    uint32_t shape;
    bool ok = shape_traits(r, &traits);

    t->smooth = smooth;
    for (uint32_t y = 0; ok && y < t->nv; y++)
        for (uint32_t x = 0; ok && x < (t->triangular ? y + 1 : t->nu); x++)
            if (!v_finite(tessellation_point(t, x, y)))
                ok = shape_not_finite(at, "the point", tessellation_index(t, x, y));
    traits.flip = r->state.reverse != xf_swaps_hands(&r->state.ctm);
    if (ok && !surface_left_out(r, r->state.material))
        ok = geometry_add_tessellation(&r->scene->geometries[r->object], t, traits, &shape) &&
             surface_finish(r, r->state.area, shape, at);
    tessellation_clear(t);
    return ok;
}

/* ---- height fields ---- */

static bool is_affine(const Transform *t)
{
    return t->m[3][0] == 0 && t->m[3][1] == 0 && t->m[3][2] == 0 && t->m[3][3] == 1;
}

/* Hills about 0.2 high over the unit square: waves of eight lengths, each half of the one before,
 * in directions that turn, so that none lies along the grid. */
static double hills(V2 at)
{
    double u = 2 * PI * at.x, v = 2 * PI * at.y, h = 0, size = 0.06;

    for (int k = 0; k < 8; k++) {
        double turned = 0.8 * u + 0.6 * v;
        h += size * md_sin(turned + k) * md_cos(v - 0.7 * u);
        v = 2 * (0.8 * v - 0.6 * u);
        u = 2 * turned;
        size *= 0.5;
    }
    return h;
}

/* p NULL: by rule. A map with perspective makes heights points: a geometry image. */
static void fill(Tessellation *t, const Transform *map, const Param *p)
{
    size_t i = 0;

    for (uint32_t y = 0; y < t->nv; y++)
        for (uint32_t x = 0; x < (t->triangular ? y + 1 : t->nu); x++, i++) {
            V2 uv = tessellation_uv(t, x, y);
            float height = (float)(p ? p->numbers[i] : hills(uv));
            if (t->heights)
                t->values[i] = height;
            else {
                V3 q = xf_point(map, v3(uv.x, uv.y, height));
                t->values[3 * i] = q.x;
                t->values[3 * i + 1] = q.y;
                t->values[3 * i + 2] = q.z;
            }
        }
}

/* *p NULL: they are made by rule. */
static bool find_heights(Reader *r, Place at, const Params *ps, const Opts *o, const Param **p)
{
    uint64_t nu = (uint64_t)opt_int(o, "nu"), nv = (uint64_t)opt_int(o, "nv");
    bool triangular = is_triangular(o);

    *p = params_find(ps, "Pz", NULL);
    if (nu < 2 || nv < 2)
        return err_at(at, "a heightfield needs \"integer nu\" and \"integer nv\", at least 2 each");
    if (triangular && nu != nv)
        return err_at(at, "a triangular heightfield needs \"integer nu\" and \"integer nv\" alike");
    if (!*p && opt_is(o, "rule", "hills"))
        return reader_generate(r, at, (triangular ? 1 : 2) * nu * nv / CHEAPER);
    if (!*p || (*p)->kind != PARAM_FLOAT || (triangular ? nu * (nu + 1) / 2 : nu * nv) != (*p)->n)
        return err_at(*p ? (*p)->at : at, "a heightfield needs its heights, %s \"float Pz\"",
                      triangular ? "nu times nu + 1 by 2" : "nu times nv");
    return true;
}

static bool read_heights(Reader *r, Place at, const Params *ps, const Opts *o)
{
    const Transform *map = &r->state.ctm;
    const Param *p;
    Tessellation t;

    if (!find_heights(r, at, ps, o, &p) ||
        !tessellation_init(&t, is_triangular(o), (uint32_t)opt_int(o, "nu"),
                           (uint32_t)opt_int(o, "nv"), is_affine(map) ? map : NULL))
        return false;
    fill(&t, map, p);
    if (!tessellation_finish(&t, bits_of(o))) {
        tessellation_clear(&t);
        return false;
    }
    return add(r, at, &t, opt_bool(o, "smooth"));
}

static const OptDef height_options[] = {
    { .key = "nu", .type = OPT_INT, .num = 0, .lo = 2, .hi = 1e9, .help = "points along u" },
    { .key = "nv", .type = OPT_INT, .num = 0, .lo = 2, .hi = 1e9, .help = "points along v" },
    SUBDIVISION, NUMBER_BITS,
    { .key = "rule", .type = OPT_CHOICE, .str = "none", .choices = "none hills",
      .help = "what makes the heights, if Pz does not" },
    { .key = "smooth", .type = OPT_BOOL, .help = "shaded as a surface, not as triangles" },
    { .key = NULL }
};
const ShapeReader shape_heightfield = {
    { "heightfield", "PBRT2 3.7; Cline07 3.2.2", "nu x nv heights Pz over the unit square",
      height_options },
    read_heights
};

/* ---- geometry images ---- */

static bool read_image(Reader *r, Place at, const Params *ps, const Opts *o)
{
    ImageForm f = { is_triangular(o), (uint32_t)opt_int(o, "side"), bits_of(o), &r->state.ctm };
    uint64_t faces = (f.triangular ? 1 : 2) * (uint64_t)f.side * f.side;
    float radius = opt_float(o, "radius"), minor = opt_float(o, "minorradius");
    bool torus = opt_is(o, "surface", "torus"), ok;
    Tessellation t;

    (void)ps;
    if (torus && (f.triangular || f.side < 3))
        return err_at(at, "a torus has no such image, expected rectangular subdivision and at "
                      "least 3 cells a side");
    if (torus && !(minor < radius))
        return err_at(at, "the torus meets itself, expected minorradius below radius");
    if (!reader_generate(r, at, faces / CHEAPER))
        return false;
    if (torus)
        ok = image_torus(&t, f, radius, minor);
    else if (opt_is(o, "surface", "patch"))
        ok = image_patch(&t, f);
    else
        ok = image_sphere(&t, f, radius);
    return ok && add(r, at, &t, opt_bool(o, "smooth"));
}

static const OptDef image_options[] = {
    { .key = "surface", .type = OPT_CHOICE, .str = "sphere", .choices = "sphere torus patch",
      .help = "what it is an image of" },
    { .key = "side", .type = OPT_INT, .num = 64, .lo = 2, .hi = 1e5, .help = "cells a side" },
    SHAPE_RADIUS,
    { .key = "minorradius", .type = OPT_FLOAT, .num = 0.4, .lo = 1e-30, .hi = 1e30,
      .help = "of the tube of a torus" },
    SUBDIVISION, NUMBER_BITS,
    { .key = "smooth", .type = OPT_BOOL, .num = 1,
      .help = "shaded as a surface, not as triangles" },
    { .key = NULL }
};
const ShapeReader shape_geometryimage = {
    { "geometryimage", "Cline07 3.2.2", "a grid of points on a surface made by rule",
      image_options },
    read_image
};
