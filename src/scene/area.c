/* area.c -- the light `diffuse`: a shape that shines with radiance L from its front, alike in all
 * directions.
 *
 * Source      [Cline07 4.4.2, (4.6)] area to solid angle; [Shirley96] the cone of a sphere.
 * Sampling    Meshes and tessellations: a triangle by area, then a uniform point. Discs: uniform
 *             by area. Whole spheres, from outside: uniform in the cone they fill; else uniform by
 *             area.
 * Invariants  pdf_w is the density of `sample` for every direction that meets the shape. */
#include "sampling/table.h"
#include "sampling/warp.h"
#include "scene/scene.h"

typedef struct {
    Light base;
    Rgb   L;
    bool  two_sided;
    const Scene *scene;         /* borrowed */
    uint32_t geometry, shape;
    float area;
    Table triangles;            /* owned; if there are any: by area */
    V3   *normals;              /* owned; of each triangle, by the order of its corners */
    float power_wanted;         /* by luminance; 0: L is as given */
} Area;

static const Geometry *geometry_of(const Area *l) { return &l->scene->geometries[l->geometry]; }
static const Shape *shape_of(const Area *l) { return &geometry_of(l)->shapes[l->shape]; }

static Light *make(const Making *m, const Opts *o)
{
    Area *l = arena_take(&m->scene->arena, 1, sizeof *l);
    if (!l)
        return NULL;
    l->scene = m->scene;
    l->geometry = m->geometry;
    l->shape = m->shape;
    l->L = rgb_mul(opt_rgb(o, "L"), opt_rgb(o, "scale"));
    l->two_sided = opt_bool(o, "twosided");
    l->power_wanted = opt_float(o, "power");
    return &l->base;
}

/* Triangle i of the lamp, whatever order an accelerator has put them into. */
static uint32_t lamp_triangle(const Shape *s, size_t i)
{
    if (s->kind == SHAPE_TESSELLATION)
        return s->as.tessellation->first_face + (uint32_t)i;
    return s->first + (s->place ? s->place[i] : (uint32_t)i);
}

static double triangle_area(const Geometry *g, uint32_t prim)
{
    V3 c[3];
    geometry_face(g, prim, c);
    return 0.5 * v_len(v_cross(v_sub(c[1], c[0]), v_sub(c[2], c[0])));
}

static bool prepare_triangles(Area *l, const Shape *s)
{
    uint32_t n = s->kind == SHAPE_MESH ? s->count : tessellation_faces(s->as.tessellation);
    float *weight = MEM_ARRAY(float, n);
    double sum = 0;
    bool ok;

    l->normals = MEM_ARRAY(V3, n);
    if (!weight || !l->normals) {
        mem_free(weight);
        return false;
    }
    for (uint32_t i = 0; i < n; i++) {
        double a = triangle_area(geometry_of(l), lamp_triangle(s, i));
        weight[i] = (float)a;
        l->normals[i] = geometry_normal(geometry_of(l), lamp_triangle(s, i));
        sum += a;
    }
    l->area = (float)sum;
    ok = table_init(&l->triangles, weight, n);
    mem_free(weight);
    return ok;
}

static bool prepare(Light *base, const Scene *scene)
{
    Area *l = (Area *)base;
    const Shape *s = shape_of(l);
    float lum;

    (void)scene;
    switch (s->kind) {
    case SHAPE_MESH:
    case SHAPE_TESSELLATION:
        if (!prepare_triangles(l, s))
            return false;
        break;
    case SHAPE_SPHERE:
        l->area = s->as.sphere.phimax * s->as.sphere.radius *
                  (s->as.sphere.zmax - s->as.sphere.zmin);
        break;
    case SHAPE_DISK:
        l->area = 0.5f * s->as.disk.phimax *
                  (f_sqr(s->as.disk.radius) - f_sqr(s->as.disk.inner));
        break;
    case SHAPE_INSTANCE:
        break;
    }
    lum = rgb_lum(l->L) * PI_F * l->area * (l->two_sided ? 2.0f : 1.0f);
    if (l->power_wanted > 0.0f && lum > 0.0f)
        l->L = rgb_scale(l->L, l->power_wanted / lum);
    return true;
}

static void clear(Light *base)
{
    Area *l = (Area *)base;
    table_clear(&l->triangles);
    mem_free(l->normals);
}

/* ---- points on shapes; each gives point, error, front normal ---- */

static bool point_on_triangles(const Area *l, V2 u, LightSample *s)
{
    const Geometry *g = geometry_of(l);
    const Shape *shape = shape_of(l);
    size_t i;
    V3 b;

    if (!table_sample(&l->triangles, u.x, &i, NULL, &u.x))
        return false;
    b = warp_triangle(u);
    if (shape->n) {                             /* the file's normals say which side shines */
        Ray none = { .d = { 0, 0, 1 } };
        Hit h = { 0, b.y, b.z, NO_PRIM, lamp_triangle(shape, i) };
        Surface sf;
        geometry_surface(g, &none, &h, &sf);
        s->p = sf.p;
        s->err = sf.err;
        s->n = sf.ng;
        return true;
    }
    geometry_point(g, lamp_triangle(shape, i), b.y, b.z, &s->p, &s->err);
    s->n = shape->flip ? v_neg(l->normals[i]) : l->normals[i];
    return true;
}

/* By Archimedes, z is uniform on a sphere. */
static bool point_on_sphere(const Shape *shape, V2 u, LightSample *s)
{
    const Sphere *sp = &shape->as.sphere;
    float z = sp->zmin + u.y * (sp->zmax - sp->zmin);
    float r = sqrtf(f_max(0.0f, (sp->radius - z) * (sp->radius + z))), sn, cs;
    V3 d;

    m_sincos_turn(u.x * (sp->phimax / (2.0f * PI_F)), &sn, &cs);
    d = v_unit(frame_out(&sp->frame, v3(r * cs, r * sn, z)));
    s->p = v_mad(d, sp->radius, sp->centre);
    s->err = v_scale(v_add(v_all(sp->radius), v_abs(sp->centre)), ROUNDINGS(6));
    s->n = shape->flip ? v_neg(d) : d;
    return true;
}

static bool point_on_disk(const Shape *shape, V2 u, LightSample *s)
{
    const Disk *d = &shape->as.disk;
    V2 q;

    if (d->inner == 0.0f && d->phimax >= 2.0f * PI_F) {
        q = warp_disk_concentric(u);
        q = (V2){ q.x * d->radius, q.y * d->radius };
    } else {                                    /* r^2 uniform between the two rims */
        float i2 = f_sqr(d->inner), r = sqrtf(i2 + u.x * (f_sqr(d->radius) - i2)), sn, cs;
        m_sincos_turn(u.y * (d->phimax / (2.0f * PI_F)), &sn, &cs);
        q = (V2){ r * cs, r * sn };
    }
    s->p = v_mad(d->frame.s, q.x, v_mad(d->frame.t, q.y, d->centre));
    s->err = v_scale(v_add(v_all(d->radius), v_abs(d->centre)), ROUNDINGS(6));
    s->n = shape->flip ? v_neg(d->frame.n) : d->frame.n;
    return true;
}

/* ---- the cone of a sphere ---- */

/* Height 1 - cos of the cone that the sphere fills from a point outside; 0 if inside or on it. A
 * point on the sphere is off by sphere_surface's error of each coordinate, six roundings of radius
 * and centre: sixteen cover its length and the roundings here. */
static float cone_height(const Sphere *sp, V3 from, V3 *to_centre, float *dist2)
{
    float r = sp->radius, reach = r + (r + v_max3(v_abs(sp->centre))) * ROUNDINGS(16);

    *to_centre = v_sub(sp->centre, from);
    *dist2 = v_len2(*to_centre);
    if (!sp->whole || !(*dist2 > reach * reach))
        return 0.0f;
    return warp_cone_height(r * r / *dist2);
}

/* The near point where direction w, at cosine c to the axis, meets the sphere. In double from the
 * centre: from afar the sphere can be smaller than the roundings of its place. */
static void near_point(const Sphere *sp, const Shape *shape, V3 to_centre, LightSample *s)
{
    double x = to_centre.x, y = to_centre.y, z = to_centre.z, r2 = (double)sp->radius * sp->radius;
    double b = x * s->wi.x + y * s->wi.y + z * s->wi.z, d2 = x * x + y * y + z * z;
    double disc = b * b - d2 + r2, t = b - sqrt(disc > 0 ? disc : 0);
    V3 d = v_unit(v3((float)(t * s->wi.x - x), (float)(t * s->wi.y - y),
                     (float)(t * s->wi.z - z)));
    float away = v_dot(d, s->wi);

    if (away > 0.0f)                    /* rounding at the rim: the like normal that faces us */
        d = v_mad(s->wi, -2.0f * away, d);
    s->p = v_mad(d, sp->radius, sp->centre);
    s->err = v_scale(v_add(v_all(sp->radius), v_abs(sp->centre)), ROUNDINGS(6));
    s->n = shape->flip ? v_neg(d) : d;
    s->dist = (float)t;
}

static bool front(const Area *l, const LightSample *s)
{
    return l->two_sided || v_dot(s->n, s->wi) < 0.0f;
}

static bool sample(const Light *base, V3 from, V2 u, LightSample *s)
{
    const Area *l = (const Area *)base;
    const Shape *shape = shape_of(l);
    bool ok = false;
    float d2, cosine;
    V3 d;

    if (shape->kind == SHAPE_SPHERE) {
        float h = cone_height(&shape->as.sphere, from, &d, &d2);
        if (h > 0.0f) {
            Frame axis = frame_about(v_unit(d));
            s->wi = frame_out(&axis, warp_cone(u, h));
            s->pdf_w = warp_cone_pdf(h);
            s->L = l->L;
            near_point(&shape->as.sphere, shape, d, s);
            return l->two_sided || !shape->flip;        /* we see the outside */
        }
    }
    switch (shape->kind) {
    case SHAPE_MESH:
    case SHAPE_TESSELLATION: ok = point_on_triangles(l, u, s); break;
    case SHAPE_SPHERE:   ok = point_on_sphere(shape, u, s); break;
    case SHAPE_DISK:     ok = point_on_disk(shape, u, s); break;
    case SHAPE_INSTANCE: break;
    }
    if (!ok)
        return false;
    d = v_sub(s->p, from);
    d2 = v_len2(d);
    if (!(d2 > 0.0f))
        return false;
    s->dist = sqrtf(d2);
    s->wi = v_scale(d, 1.0f / s->dist);
    cosine = v_absdot(s->n, s->wi);
    if (!front(l, s) || !(cosine > 0.0f))
        return false;
    s->L = l->L;
    s->pdf_w = d2 / (cosine * l->area);                 /* [Cline07 (4.6)] */
    return is_finite(s->pdf_w);
}

static float pdf_w(const Light *base, V3 from, V3 wi, const Surface *hit)
{
    const Area *l = (const Area *)base;
    const Shape *shape = shape_of(l);
    float d2, cosine;
    V3 d;

    if (shape->kind == SHAPE_SPHERE) {
        float h = cone_height(&shape->as.sphere, from, &d, &d2);
        if (h > 0.0f)
            return warp_cone_pdf(h);
    }
    cosine = v_absdot(hit->ng, wi);
    d2 = v_len2(v_sub(hit->p, from));
    return cosine > 0.0f && l->area > 0.0f ? d2 / (cosine * l->area) : 0.0f;
}

static Rgb radiance(const Light *base, V3 wi, const Surface *hit)
{
    const Area *l = (const Area *)base;
    return l->two_sided || v_dot(hit->ng, wi) < 0.0f ? l->L : rgb_all(0.0f);
}

static Rgb power(const Light *base)
{
    const Area *l = (const Area *)base;
    return rgb_scale(l->L, PI_F * l->area * (l->two_sided ? 2.0f : 1.0f));
}

static const OptDef options[] = {
    { .key = "L", .type = OPT_RGB, .num = 1, .help = "radiance, W/(m^2 sr)" },
    { .key = "scale", .type = OPT_RGB, .num = 1, .help = "factor of L" },
    { .key = "power", .type = OPT_FLOAT, .num = 0, .lo = 0, .hi = 1e30,
      .help = "W (by luminance); sets L if above 0" },
    { .key = "twosided", .type = OPT_BOOL, .help = "shines from the back too" },
    { .key = "samples", .type = OPT_INT, .num = 1, .lo = 1, .hi = 1e9, .also = "nsamples",
      .help = "read for old scene files, without effect" },
    { .key = NULL }
};

const LightKind light_diffuse = {
    .info = { "diffuse", "Cline07 4.4.2; Shirley96", "a shape that shines (AreaLightSource)",
              options },
    .make = make, .prepare = prepare, .clear = clear, .sample = sample, .pdf_w = pdf_w,
    .radiance = radiance, .power = power
};
