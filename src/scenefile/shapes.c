/* shapes.c -- the Shape directive: triangle meshes written out or in files, spheres and discs, and
 * the table of all shapes. Curved shapes that become triangles are in tessellated.c, those for
 * modelling by hand in modelled.c, those that stay grids of points in tessellations.c.
 *
 * Space       Points go to world space here (inside ObjectBegin: to the object's). A sphere or disc
 *             that the transform does not keep one becomes triangles.
 * Front       Meshes with normals: the side of the normals, which ReverseOrientation turns round.
 *             Without: where the corners run counter-clockwise, turned round by ReverseOrientation
 *             and, so that a mirrored mesh keeps its outside, by transforms that swap hands.
 *             Spheres and discs: outwards and along +z of their own space, turned round by
 *             ReverseOrientation. [PBRT4 6.1.4, and Sample of Sphere and Disk] */
#include "scenefile/shapes.h"

#include <string.h>

/* ---- meshes into the scene ---- */

bool shape_not_finite(Place at, const char *what, size_t i)
{
    return err_at(at, "%s %lu is not finite after the current transform", what, (unsigned long)i);
}

static bool to_world(const Reader *r, Place at, Mesh *m)
{
    const Transform *t = &r->state.ctm;
    bool same = xf_is_identity(t);

    for (uint32_t i = 0; i < m->nverts; i++) {
        if (!same)
            m->p[i] = xf_point(t, m->p[i]);
        if (!v_finite(m->p[i]))
            return shape_not_finite(at, "the point", i);
    }
    for (uint32_t i = 0; m->n && i < m->nverts; i++) {
        V3 n = same ? m->n[i] : xf_normal(t, m->n[i]);
        n = v_unit(n);
        m->n[i] = r->state.reverse ? v_neg(n) : n;
    }
    return true;
}

static bool add_mesh(Reader *r, Place at, Mesh *m, uint32_t material, const AreaLight *area)
{
    ShapeTraits traits = { 0, NO_LIGHT, false };
    uint32_t shape, dropped;

    if (!surface_material(r, material, &traits.material) || !to_world(r, at, m))
        return false;
    dropped = mesh_drop_degenerate(m);
    if (dropped && !r->degenerate)
        r->degenerate_at = at;
    r->degenerate += dropped;
    if (m->ntris == 0)
        return true;
    traits.flip = r->state.reverse != xf_swaps_hands(&r->state.ctm);
    return geometry_add_mesh(&r->scene->geometries[r->object], m, traits, &shape) &&
           surface_finish(r, area, shape, at);
}

bool shape_add_mesh(Reader *r, Place at, Mesh *m, uint32_t material, const AreaLight *area)
{
    bool ok = surface_left_out(r, material) || add_mesh(r, at, m, material, area);
    mesh_clear(m);
    return ok;
}

static bool add_current(Reader *r, Place at, Mesh *m)
{
    return shape_add_mesh(r, at, m, r->state.material, r->state.area);
}

/* ---- meshes written out ---- */

bool shape_points(const Params *ps, Place at, Mesh *m)
{
    const Param *p = params_find(ps, "P", NULL);
    const double *v;

    if (!p)
        return err_at(at, "the shape needs its points, \"point3 P\"");
    if (p->kind != PARAM_FLOAT || p->n % 3 || p->n / 3 > MESH_MAX)
        return err_at(p->at, "\"P\" is not right, expected groups of three numbers");
    m->nverts = (uint32_t)(p->n / 3);
    m->p = MEM_ARRAY(V3, m->nverts);
    if (!m->p)
        return false;
    v = p->numbers;
    for (uint32_t i = 0; i < m->nverts; i++, v += 3)
        m->p[i] = v3((float)v[0], (float)v[1], (float)v[2]);
    return true;
}

/* Indices in groups of `corners`; without any, the points are one group. */
bool shape_indices(const Params *ps, Place at, size_t corners, uint32_t nverts, const Param **out)
{
    const Param *p = params_find(ps, "indices", NULL);

    *out = p;
    if (!p)
        return nverts == corners || err_at(at, "the shape needs \"integer indices\"");
    if ((p->kind != PARAM_INT && p->kind != PARAM_FLOAT) || p->n % corners ||
        p->n / corners > MESH_MAX)
        return err_at(p->at, "\"indices\" is not right, expected groups of %lu whole numbers",
                      (unsigned long)corners);
    for (size_t i = 0; i < p->n; i++)
        if (!(p->numbers[i] >= 0 && p->numbers[i] < nverts) ||
            p->numbers[i] != floor(p->numbers[i]))
            return err_at(p->at, "index %lu of \"indices\" is %.0f, expected a whole number from "
                          "0 to %lu", (unsigned long)i, p->numbers[i], (unsigned long)nverts - 1);
    return true;
}

bool shape_triangles(const Params *ps, Place at, Mesh *m)
{
    const Param *p;

    if (!shape_indices(ps, at, 3, m->nverts, &p))
        return false;
    m->ntris = p ? (uint32_t)(p->n / 3) : 1;
    m->tri = MEM_ARRAY(Tri, m->ntris);
    if (!m->tri)
        return false;
    for (uint32_t i = 0; i < m->ntris; i++)
        for (uint32_t k = 0; k < 3; k++)
            m->tri[i].v[k] = p ? (uint32_t)p->numbers[3 * (size_t)i + k] : k;
    return true;
}

/* An array of `group` numbers a vertex. *p NULL: not given, or of a wrong length and warned of. */
static bool per_vertex(const Params *ps, const char *name, const char *also, size_t group,
                       uint32_t nverts, const Param **p)
{
    *p = params_find(ps, name, also);
    if (!*p)
        return true;
    if ((*p)->kind != PARAM_FLOAT)
        return err_at((*p)->at, "\"%s\" is not right, expected numbers", (*p)->name);
    if ((*p)->n == group * nverts)
        return true;
    if (!warn_at((*p)->at, "\"%s\" has %lu numbers, expected %lu for %lu points; it is left out",
                 (*p)->name, (unsigned long)(*p)->n, (unsigned long)(group * nverts),
                 (unsigned long)nverts))
        return false;
    *p = NULL;
    return true;
}

bool shape_normals(const Params *ps, Mesh *m)
{
    const Param *n, *uv;

    if (!per_vertex(ps, "N", NULL, 3, m->nverts, &n) ||
        !per_vertex(ps, "uv", "st", 2, m->nverts, &uv))
        return false;
    if (n && !(m->n = MEM_ARRAY(V3, m->nverts)))
        return false;
    if (uv && !(m->uv = MEM_ARRAY(V2, m->nverts)))
        return false;
    for (size_t i = 0; n && i < m->nverts; i++)
        m->n[i] = v3((float)n->numbers[3 * i], (float)n->numbers[3 * i + 1],
                     (float)n->numbers[3 * i + 2]);
    for (size_t i = 0; uv && i < m->nverts; i++)
        m->uv[i] = (V2){ (float)uv->numbers[2 * i], (float)uv->numbers[2 * i + 1] };
    return true;
}

bool shape_finish(Reader *r, Place at, Mesh *m, bool ok)
{
    if (ok)
        return add_current(r, at, m);
    mesh_clear(m);
    return false;
}

static bool read_trianglemesh(Reader *r, Place at, const Params *ps, const Opts *o)
{
    Mesh m;
    bool ok;

    (void)o;
    memset(&m, 0, sizeof m);
    params_find(ps, "S", "faceIndices");        /* tangents, numbers of faces: no use here */
    ok = shape_points(ps, at, &m) && shape_triangles(ps, at, &m) && shape_normals(ps, &m);
    return shape_finish(r, at, &m, ok);
}

/* ---- meshes in files ---- */

static bool needs_file(Place at, const Opts *o)
{
    return *opt_string(o, "filename") || err_at(at, "the shape needs a \"string filename\"");
}

static bool read_plymesh(Reader *r, Place at, const Params *ps, const Opts *o)
{
    char *path;
    FileBytes f;
    Mesh m;
    bool ok;

    (void)ps;
    if (!needs_file(at, o))
        return false;
    path = reader_path(r, at, opt_string(o, "filename"));
    ok = path && reader_file(r, at, path, &f);
    if (ok) {
        ok = ply_read(&m, path, (const unsigned char *)f.bytes, f.size);
        file_clear(&f);
    }
    mem_free(path);
    return ok && add_current(r, at, &m);
}

static bool read_obj(Reader *r, Place at, const Params *ps, const Opts *o)
{
    char *path;
    bool ok;

    (void)ps;
    if (!needs_file(at, o))
        return false;
    path = reader_path(r, at, opt_string(o, "filename"));
    ok = path && objfile_add(r, at, path);
    mem_free(path);
    return ok;
}

/* ---- spheres and discs ---- */

bool shape_traits(Reader *r, ShapeTraits *traits)
{
    *traits = (ShapeTraits){ 0, NO_LIGHT, r->state.reverse };
    return surface_material(r, r->state.material, &traits->material);
}

static bool read_sphere(Reader *r, Place at, const Params *ps, const Opts *o)
{
    float radius = opt_float(o, "radius");
    float zmin = opt_given(o, "zmin") ? opt_float(o, "zmin") : -radius;
    float zmax = opt_given(o, "zmax") ? opt_float(o, "zmax") : radius;
    ShapeTraits traits;
    uint32_t shape;
    Sphere s;

    (void)ps;
    if (!(zmin < zmax && zmin < radius && zmax > -radius))
        return err_at(at,
                      "the sphere is empty, expected zmin < zmax, both about -radius to radius");
    if (!sphere_init(&s, &r->state.ctm, radius, zmin, zmax, opt_float(o, "phimax")))
        return shape_distorted_sphere(r, at, o, zmin, zmax) &&
               warn_at(at, "the transform makes the sphere an ellipsoid; triangles are used");
    if (!v_finite(s.centre) || !is_finite(s.radius) || !(s.radius > 0))
        return err_at(at, "the sphere is not finite, or has no size, after the current transform");
    return surface_left_out(r, r->state.material) ||
           (shape_traits(r, &traits) &&
            geometry_add_sphere(&r->scene->geometries[r->object], &s, traits, &shape) &&
            surface_finish(r, r->state.area, shape, at));
}

static bool read_disk(Reader *r, Place at, const Params *ps, const Opts *o)
{
    float radius = opt_float(o, "radius"), inner = opt_float(o, "innerradius");
    ShapeTraits traits;
    uint32_t shape;
    Disk d;

    (void)ps;
    if (!(inner < radius))
        return err_at(at, "the disc is empty, expected innerradius below radius");
    if (!disk_init(&d, &r->state.ctm, opt_float(o, "height"), radius, inner,
                   opt_float(o, "phimax")))
        return shape_distorted_disk(r, at, o) &&
               warn_at(at, "the transform makes the disc an ellipse; triangles are used");
    if (!v_finite(d.centre) || !is_finite(d.radius) || !(d.radius > 0))
        return err_at(at, "the disc is not finite, or has no size, after the current transform");
    return surface_left_out(r, r->state.material) ||
           (shape_traits(r, &traits) &&
            geometry_add_disk(&r->scene->geometries[r->object], &d, traits, &shape) &&
            surface_finish(r, r->state.area, shape, at));
}

/* ---- the table ---- */

#define RADIUS { .key = "radius", .type = OPT_FLOAT, .num = 1, .lo = 1e-30, .hi = 1e30, \
                 .help = "scene units" }
#define PHIMAX { .key = "phimax", .type = OPT_FLOAT, .num = 360, .lo = 1e-3, .hi = 360, \
                 .help = "how far round it goes, degrees" }
#define FILENAME { .key = "filename", .type = OPT_STRING, .str = "", \
                   .help = "the file, as seen from that of the scene" }
#define ZRANGE(key_, num_, help_) \
    { .key = key_, .type = OPT_FLOAT, .num = num_, .lo = -1e30, .hi = 1e30, .help = help_ }

#define SUBDIVISION \
    { .key = "subdivision", .type = OPT_CHOICE, .str = "rectangular", \
      .choices = "rectangular triangular", .help = "of the grid" }
#define NUMBER_BITS \
    { .key = "bits", .type = OPT_INT, .num = 32, .lo = 16, .hi = 32, \
      .help = "of a number of a point: 32, or 16 for fractions of their range" }

static const OptDef none[] = { { .key = NULL } };
static const OptDef file_options[] = { FILENAME, { .key = NULL } };
static const OptDef sphere_options[] = {
    RADIUS, ZRANGE("zmin", -1, "cut off below; if not given, at -radius"),
    ZRANGE("zmax", 1, "cut off above; if not given, at radius"), PHIMAX, { .key = NULL }
};
static const OptDef disk_options[] = {
    RADIUS, ZRANGE("height", 0, "along z"),
    { .key = "innerradius", .type = OPT_FLOAT, .num = 0, .lo = 0, .hi = 1e30,
      .help = "of the hole" },
    PHIMAX, { .key = NULL }
};
static const OptDef cylinder_options[] = {
    RADIUS, ZRANGE("zmin", -1, "lower end"), ZRANGE("zmax", 1, "upper end"), PHIMAX, { .key = NULL }
};
static const OptDef cone_options[] = {
    RADIUS, ZRANGE("height", 1, "of the tip"), PHIMAX, { .key = NULL }
};
static const OptDef paraboloid_options[] = {
    RADIUS, ZRANGE("zmin", 0, "lower end"), ZRANGE("zmax", 1, "upper end, where radius holds"),
    PHIMAX, { .key = NULL }
};
static const OptDef hyperboloid_options[] = {
    { .key = "p1", .type = OPT_POINT, .num = 0, .help = "one end of the line that turns" },
    { .key = "p2", .type = OPT_POINT, .str = "1 1 1", .help = "its other end" },
    PHIMAX, { .key = NULL }
};
static const OptDef loop_options[] = {
    { .key = "levels", .type = OPT_INT, .num = 3, .lo = 0, .hi = 10, .also = "nlevels",
      .help = "each makes four triangles of one" },
    { .key = "scheme", .type = OPT_STRING, .str = "loop", .help = "read, without effect" },
    { .key = NULL }
};
static const OptDef height_options[] = {
    { .key = "nu", .type = OPT_INT, .num = 0, .lo = 2, .hi = 1e9, .help = "points along u" },
    { .key = "nv", .type = OPT_INT, .num = 0, .lo = 2, .hi = 1e9, .help = "points along v" },
    SUBDIVISION, NUMBER_BITS,
    { .key = "rule", .type = OPT_CHOICE, .str = "none", .choices = "none hills",
      .help = "what makes the heights, if Pz does not" },
    { .key = "smooth", .type = OPT_BOOL, .help = "shaded as a surface, not as triangles" },
    { .key = NULL }
};
static const OptDef image_options[] = {
    { .key = "surface", .type = OPT_CHOICE, .str = "sphere", .choices = "sphere torus patch",
      .help = "what it is an image of" },
    { .key = "side", .type = OPT_INT, .num = 64, .lo = 2, .hi = 1e5, .help = "cells a side" },
    RADIUS,
    { .key = "minorradius", .type = OPT_FLOAT, .num = 0.4, .lo = 1e-30, .hi = 1e30,
      .help = "of the tube of a torus" },
    SUBDIVISION, NUMBER_BITS,
    { .key = "smooth", .type = OPT_BOOL, .num = 1,
      .help = "shaded as a surface, not as triangles" },
    { .key = NULL }
};

static const ShapeReader trianglemesh = {
    { "trianglemesh", "PBRT4 6.5", "triangles: point3 P, integer indices, normal N, point2 uv",
      none },
    read_trianglemesh
};
static const ShapeReader plymesh = {
    { "plymesh", "Turk94", "a mesh in a PLY file", file_options }, read_plymesh
};
static const ShapeReader obj = {
    { "obj", "Wavefront", "an OBJ file with its materials", file_options }, read_obj
};
static const ShapeReader loopsubdiv = {
    { "loopsubdiv", "Loop87", "a mesh made smooth: point3 P, integer indices", loop_options },
    shape_read_loop
};
static const ShapeReader sphere = {
    { "sphere", "PBRT4 6.2", "a sphere, or a part of one", sphere_options }, read_sphere
};
static const ShapeReader disk = {
    { "disk", "PBRT4 6.4", "a disc, a ring or a sector of one", disk_options }, read_disk
};
static const ShapeReader cylinder = {
    { "cylinder", "PBRT4 6.3", "round z, open at the ends; of triangles", cylinder_options },
    shape_read_cylinder
};
static const ShapeReader cone = {
    { "cone", "PBRT3 3.5", "round z, open below; of triangles", cone_options }, shape_read_cone
};
static const ShapeReader paraboloid = {
    { "paraboloid", "PBRT3 3.5", "round z; of triangles", paraboloid_options },
    shape_read_paraboloid
};
static const ShapeReader hyperboloid = {
    { "hyperboloid", "PBRT3 3.5", "a line turned round z; of triangles", hyperboloid_options },
    shape_read_hyperboloid
};
static const ShapeReader bilinearmesh = {
    { "bilinearmesh", "PBRT4 6.6", "patches between four points; of triangles", none },
    shape_read_bilinear
};
static const ShapeReader heightfield = {
    { "heightfield", "PBRT2 3.7; Cline07 3.2.2", "nu x nv heights Pz over the unit square",
      height_options },
    shape_read_heights
};
static const ShapeReader geometryimage = {
    { "geometryimage", "Cline07 3.2.2", "a grid of points on a surface made by rule",
      image_options },
    shape_read_image
};
static const ShapeReader nurbs = {
    { "nurbs", "PBRT3 3.8", "not supported: left out with a warning", none }, NULL
};

const ShapeReader *const shape_readers[] = {
    &trianglemesh, &plymesh, &obj, &loopsubdiv, &sphere, &disk, &cylinder, &cone, &paraboloid,
    &hyperboloid, &bilinearmesh, &heightfield, &geometryimage, &shape_curve, &shape_torus,
    &shape_box, &shape_lathe, &shape_generated, &nurbs, NULL
};

/* ---- the directive ---- */

static bool unknown_shape(Place at, const char *name)
{
    enum { MOST = 32 };
    const char *names[MOST];
    char hint[HINT_MAX];
    size_t n = 0;
    for (; shape_readers[n] && n < MOST; n++)
        names[n] = shape_readers[n]->info.name;
    return warn_at(at, "unknown shape '%.60s'%s; it is left out", name,
                   hint_nearest(hint, name, names, n));
}

/* What opts_params must not call unknown: the arrays, which the readers take themselves. */
static void mark_arrays(const Params *ps, const ShapeReader *s)
{
    static const char *const arrays[] = { "P", "N", "uv", "st", "S", "indices", "faceIndices",
                                          "Pz" };
    for (size_t i = 0; i < sizeof arrays / sizeof *arrays; i++)
        if (s->info.options != file_options)
            params_find(ps, arrays[i], NULL);
}

bool do_shape(Reader *r, Place at)
{
    Token t;
    Params ps, all;
    Param list[PARAMS_MAX + DEFAULTS_MAX];
    const ShapeReader *s;
    char *name;
    bool nowhere, ok;
    Moved was;
    Opts o;

    if (!reader_string(r, "the kind of shape", &t) || !(name = reader_text(r, &t)))
        return false;
    s = kind_find(shape_readers, name);
    if (!s && !unknown_shape(t.at, name))
        return false;
    if (!params_read(r, SPECTRUM_ALBEDO, &ps))
        return false;
    if (!s || !s->read)
        return !s || warn_at(at, "the shape '%s' is not supported; it is left out", s->info.name);
    params_with_defaults(r, TARGET_SHAPE, &ps, list, &all);
    mark_arrays(&all, s);
    opts_default(&o, s->info.options);
    if (!surface_mask(r, &all, &nowhere) || !opts_params(&o, s->info.name, &all))
        return false;
    if (nowhere)
        return true;
    if (!mover_begin(r, at, &was))
        return false;
    ok = s->read(r, at, &all, &o);
    mover_end(r, &was);
    return ok;
}
