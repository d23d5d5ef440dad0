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

static const OptDef file_options[] = {
    { .key = "filename", .type = OPT_STRING, .str = "",
      .help = "the file, as seen from that of the scene" },
    { .key = NULL }
};
static const OptDef sphere_options[] = {
    SHAPE_RADIUS, SHAPE_ALONG_Z("zmin", -1, "cut off below; if not given, at -radius"),
    SHAPE_ALONG_Z("zmax", 1, "cut off above; if not given, at radius"), SHAPE_PHIMAX,
    { .key = NULL }
};
static const OptDef disk_options[] = {
    SHAPE_RADIUS, SHAPE_ALONG_Z("height", 0, "along z"),
    { .key = "innerradius", .type = OPT_FLOAT, .num = 0, .lo = 0, .hi = 1e30,
      .help = "of the hole" },
    SHAPE_PHIMAX, { .key = NULL }
};

static const ShapeReader trianglemesh = {
    { "trianglemesh", "PBRT4 6.5", "triangles: point3 P, integer indices, normal N, point2 uv",
      NULL },
    read_trianglemesh
};
static const ShapeReader plymesh = {
    { "plymesh", "Turk94", "a mesh in a PLY file", file_options }, read_plymesh
};
static const ShapeReader obj = {
    { "obj", "Wavefront", "an OBJ file with its materials", file_options }, read_obj
};
static const ShapeReader sphere = {
    { "sphere", "PBRT4 6.2", "a sphere, or a part of one", sphere_options }, read_sphere
};
static const ShapeReader disk = {
    { "disk", "PBRT4 6.4", "a disc, a ring or a sector of one", disk_options }, read_disk
};
static const ShapeReader nurbs = {
    { "nurbs", "PBRT3 3.8", "not supported: left out with a warning", NULL }, NULL
};

const ShapeReader *const shape_readers[] = {
    &trianglemesh, &plymesh, &obj, &shape_loopsubdiv, &sphere, &disk, &shape_cylinder, &shape_cone,
    &shape_paraboloid, &shape_hyperboloid, &shape_bilinearmesh, &shape_heightfield,
    &shape_geometryimage, &shape_curve, &shape_torus, &shape_box, &shape_lathe, &shape_generated,
    &nurbs, NULL
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
