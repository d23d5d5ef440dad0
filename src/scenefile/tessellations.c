/* tessellations.c -- shapes of the scene language that stay grids of points: height fields and
 * geometry images. No list of triangles is made of them; see geometry/tessellation.h. */
#include "scenefile/shapes.h"

#include "base/maths.h"
#include "geometry/image_shapes.h"

/* A triangle of these takes less than a quarter of the memory of one of a mesh. */
enum { CHEAPER = 4 };

static bool is_triangular(const Opts *o) { return opt_is(o, "subdivision", "triangular"); }
static int bits_of(const Opts *o) { return opt_int(o, "bits") < 32 ? 16 : 32; }

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

bool shape_read_heights(Reader *r, Place at, const Params *ps, const Opts *o)
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

/* ---- geometry images ---- */

bool shape_read_image(Reader *r, Place at, const Params *ps, const Opts *o)
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
