/* area.c -- the light `diffuse`: a shape that shines from its front with radiance L, times a
 * picture over its (u, v), times cos^exponent of the angle to its normal: exponent 0 shines alike
 * in all directions, higher ones are focused about the normal.
 *
 * Source      [Cline07 4.4.2, (4.6)] area to solid angle; [Shirley96] the cone of a sphere; [GIRT
 *             appendix B] the exponent.
 * Sampling    Meshes and tessellations: a triangle by area, then a uniform point. Discs: uniform
 *             by area. Whole spheres, from outside: uniform in the cone they fill; else uniform by
 *             area.
 *             With sampling=solidangle, lamps of few triangles: see area_solid.c.
 *             Rectangles with a picture can be asked for their points one by one, see
 *             area_rectangle.c.
 * Masks       Of a shape that lets a part of the rays pass, points shine by what is left of it
 *             there, as the rays do that meet it. Its far side shows through: no cones then.
 * Invariants  pdf_w is the density of `sample` for every direction that meets the shape. */
#include "sampling/warp.h"
#include "scene/area.h"

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
    l->exponent = opt_float(o, "exponent");
    l->solid = opt_is(o, "sampling", "solidangle");
    if (opt_string(o, "filename")[0]) {
        l->base.textured = true;
        l->picture.kind = TEXTURE_IMAGE;
        l->picture.value = rgb_all(1.0f);
        l->picture.map.su = l->picture.map.sv = 1.0f;
        l->picture.image = scene_image(m->scene, m, opt_string(o, "filename"));
        if (!l->picture.image)
            return NULL;
    }
    return &l->base;
}

static double triangle_area(const Geometry *g, uint32_t prim)
{
    V3 c[3];
    geometry_face(g, prim, c);
    return 0.5 * v_len(v_cross(v_sub(c[1], c[0]), v_sub(c[2], c[0])));
}

static bool prepare_triangles(Area *l, const Shape *s)
{
    uint32_t n = lamp_triangles(s);
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
    l->solid = l->solid && n <= SOLID_MOST && !s->n ? n : 0;
    ok = table_init(&l->triangles, weight, n);
    mem_free(weight);
    return ok;
}

static Rgb shining(const Area *l);

/* The integral of cos^(exponent + 1) is 2 pi / (exponent + 2). */
static Rgb power(const Light *base)
{
    const Area *l = (const Area *)base;
    float all = PI_F * l->area * (l->two_sided ? 2.0f : 1.0f) / (0.5f * l->exponent + 1.0f);
    return rgb_scale(rgb_mul(l->L, l->mean), all);
}

static bool prepare(Light *base, const Scene *scene)
{
    Area *l = (Area *)base;
    const Shape *s = shape_of(l);

    l->mask = scene->materials[s->material].opacity;
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
    l->mean = shining(l);
    l->L = rgb_scale(l->L, power_factor(l->power_wanted, power(base)));
    area_prepare_estimate(l);
    area_prepare_rectangle(l);
    return true;
}

static void clear(Light *base)
{
    Area *l = (Area *)base;
    table_clear(&l->triangles);
    mem_free(l->normals);
}

/* ---- points on shapes ---- */

static void point_of(Surface *sf, AreaPoint *s)
{
    s->p = sf->p;
    s->err = sf->err;
    s->n = sf->ng;
    s->uv = sf->uv;
}

static bool looks_at_uv(const Area *l) { return l->base.textured || l->mask; }

void area_on_triangle(const Area *l, uint32_t i, float b1, float b2, AreaPoint *s)
{
    const Geometry *g = geometry_of(l);
    const Shape *shape = shape_of(l);
    uint32_t prim = lamp_triangle(shape, i);

    s->uv = (V2){ 0, 0 };
    if (shape->n || looks_at_uv(l)) {           /* the file's normals say which side shines */
        Ray none = { .d = { 0, 0, 1 } };
        Hit h = { 0, b1, b2, NO_PRIM, prim };
        Surface sf;
        geometry_surface(g, &none, &h, &sf);
        point_of(&sf, s);
        return;
    }
    geometry_point(g, prim, b1, b2, &s->p, &s->err);
    s->n = shape->flip ? v_neg(l->normals[i]) : l->normals[i];
}

static bool point_on_triangles(const Area *l, V2 u, AreaPoint *s)
{
    size_t i;
    V3 b;

    if (!table_sample(&l->triangles, u.x, &i, NULL, &u.x))
        return false;
    b = warp_triangle(u);
    area_on_triangle(l, (uint32_t)i, b.y, b.z, s);
    return true;
}

/* By solid angle. *pdf_w: 0, if that is not to be from there. False: no point. */
static bool point_by_angle(const Area *l, V3 from, V2 u, AreaPoint *s, float *pdf_w)
{
    double sum[SOLID_MOST], all = l->solid ? area_solid_angles(l, from, sum) : 0.0;
    uint32_t i;
    float b1, b2;

    *pdf_w = 0.0f;
    if (all == 0.0)
        return true;
    if (!area_solid_sample(l, from, u, sum, &i, &b1, &b2))
        return false;
    area_on_triangle(l, i, b1, b2, s);
    *pdf_w = (float)(1.0 / all);
    return true;
}

/* (u, v) of a point of a sphere or disc, as a ray that ends there finds it. */
static V2 uv_at(const Area *l, V3 p)
{
    Ray none = { .o = p };
    Hit h = { 0, 0, 0, NO_PRIM, shape_of(l)->first };
    Surface sf;

    if (!looks_at_uv(l))
        return (V2){ 0, 0 };
    geometry_surface(geometry_of(l), &none, &h, &sf);
    return sf.uv;
}

static void point_on_round(const Area *l, V3 centre, float radius, V3 n, AreaPoint *s)
{
    s->err = v_scale(v_add(v_all(radius), v_abs(centre)), ROUNDINGS(6));
    s->n = shape_of(l)->flip ? v_neg(n) : n;
    s->uv = uv_at(l, s->p);
}

/* By Archimedes, z is uniform on a sphere. */
static void point_on_sphere(const Area *l, const Sphere *sp, V2 u, AreaPoint *s)
{
    float z = sp->zmin + u.y * (sp->zmax - sp->zmin);
    float r = sqrtf(f_max(0.0f, (sp->radius - z) * (sp->radius + z))), sn, cs;
    V3 d;

    m_sincos_turn(u.x * (sp->phimax / (2.0f * PI_F)), &sn, &cs);
    d = v_unit(frame_out(&sp->frame, v3(r * cs, r * sn, z)));
    s->p = v_mad(d, sp->radius, sp->centre);
    point_on_round(l, sp->centre, sp->radius, d, s);
}

static void point_on_disk(const Area *l, const Disk *d, V2 u, AreaPoint *s)
{
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
    point_on_round(l, d->centre, d->radius, d->frame.n, s);
}

bool area_point(const Area *l, V2 u, AreaPoint *s)
{
    const Shape *shape = shape_of(l);

    s->uv = (V2){ 0, 0 };
    switch (shape->kind) {
    case SHAPE_MESH:
    case SHAPE_TESSELLATION: return point_on_triangles(l, u, s);
    case SHAPE_SPHERE:   point_on_sphere(l, &shape->as.sphere, u, s); return true;
    case SHAPE_DISK:     point_on_disk(l, &shape->as.disk, u, s); return true;
    case SHAPE_INSTANCE: break;
    }
    return false;
}

Rgb area_emitted(const Area *l, V2 uv, float c)
{
    Rgb L = l->L;

    if (l->exponent > 0.0f)
        L = rgb_scale(L, m_pow(f_min(c, 1.0f), l->exponent));
    if (l->base.textured) {
        Surface at = surface_at(v_all(0.0f), v_all(0.0f), v_all(0.0f), uv);
        L = rgb_mul(L, texture_eval(&l->picture, &at));
    }
    return L;
}

Rgb area_masked(const Area *l, const AreaPoint *s, Rgb L)
{
    Surface at;

    if (LIKELY(!l->mask))
        return L;
    at = surface_at(s->p, s->err, s->n, s->uv);
    return rgb_scale(L, clamp01(texture_alpha(l->mask, &at)));
}

/* The mean over the shape of the picture times the mask, by points that are evenly spread: what the
 * shape shows of the unit square of (u, v), and how large, only it knows. */
static Rgb shining(const Area *l)
{
    enum { SIDE = 128 };
    Rgb sum = rgb_all(0.0f), one;
    AreaPoint at;

    if (!looks_at_uv(l))
        return rgb_all(1.0f);
    for (int i = 0; i < SIDE * SIDE; i++) {
        V2 u = { ((float)(i % SIDE) + 0.5f) / SIDE, ((float)(i / SIDE) + 0.5f) / SIDE };
        Surface s;
        if (!area_point(l, u, &at))
            return rgb_all(0.0f);
        s = surface_at(at.p, at.err, at.n, at.uv);
        one = l->base.textured ? texture_eval(&l->picture, &s) : rgb_all(1.0f);
        sum = rgb_add(sum, area_masked(l, &at, one));
    }
    return rgb_scale(sum, 1.0f / (SIDE * SIDE));
}

/* ---- the cone of a sphere ---- */

/* Height 1 - cos of the cone that the sphere fills from a point outside; 0 if inside or on it. A
 * point on the sphere is off by sphere_surface's error of each coordinate, six roundings of radius
 * and centre: sixteen cover its length and the roundings here. */
static float cone_height(const Area *l, const Sphere *sp, V3 from, V3 *to_centre, float *dist2)
{
    float r = sp->radius, reach = r + (r + v_max3(v_abs(sp->centre))) * ROUNDINGS(16);

    *to_centre = v_sub(sp->centre, from);
    *dist2 = v_len2(*to_centre);
    if (!sp->whole || l->mask || !(*dist2 > reach * reach))
        return 0.0f;
    return warp_cone_height(r * r / *dist2);
}

/* The near point where direction wi meets the sphere. In double from the centre: from afar the
 * sphere can be smaller than the roundings of its place. */
static void near_point(const Area *l, const Sphere *sp, V3 to_centre, LightSample *s)
{
    double x = to_centre.x, y = to_centre.y, z = to_centre.z, r2 = (double)sp->radius * sp->radius;
    double b = x * s->wi.x + y * s->wi.y + z * s->wi.z, d2 = x * x + y * y + z * z;
    double disc = b * b - d2 + r2, t = b - sqrt(disc > 0 ? disc : 0);
    V3 d = v_unit(v3((float)(t * s->wi.x - x), (float)(t * s->wi.y - y),
                     (float)(t * s->wi.z - z)));
    float away = v_dot(d, s->wi);
    AreaPoint at;

    if (away > 0.0f)                    /* rounding at the rim: the like normal that faces us */
        d = v_mad(s->wi, -2.0f * away, d);
    at.p = v_mad(d, sp->radius, sp->centre);
    point_on_round(l, sp->centre, sp->radius, d, &at);
    s->p = at.p;
    s->err = at.err;
    s->n = at.n;
    s->L = area_emitted(l, at.uv, v_absdot(at.n, s->wi));
    s->dist = (float)t;
}

static bool front(const Area *l, const LightSample *s)
{
    return l->two_sided || v_dot(s->n, s->wi) < 0.0f;
}

bool area_seen(const Area *l, const AreaPoint *at, V3 from, LightSample *s)
{
    V3 d = v_sub(at->p, from);
    float d2 = v_len2(d), cosine;

    s->p = at->p;
    s->err = at->err;
    s->n = at->n;
    if (!(d2 > 0.0f))
        return false;
    s->dist = sqrtf(d2);
    s->wi = v_scale(d, 1.0f / s->dist);
    cosine = v_absdot(s->n, s->wi);
    if (!front(l, s) || !(cosine > 0.0f))
        return false;
    s->L = area_masked(l, at, area_emitted(l, at->uv, cosine));
    s->pdf_w = d2 / (cosine * l->area);                 /* [Cline07 (4.6)] */
    return is_finite(s->pdf_w);
}

static bool sample(const Light *base, V3 from, V2 u, LightSample *s)
{
    const Area *l = (const Area *)base;
    const Shape *shape = shape_of(l);
    float d2, by_angle;
    AreaPoint at;
    V3 d;

    if (shape->kind == SHAPE_SPHERE) {
        float h = cone_height(l, &shape->as.sphere, from, &d, &d2);
        if (h > 0.0f) {
            Frame axis = frame_about(v_unit(d));
            s->wi = frame_out(&axis, warp_cone(u, h));
            s->pdf_w = warp_cone_pdf(h);
            near_point(l, &shape->as.sphere, d, s);
            return l->two_sided || !shape->flip;        /* we see the outside */
        }
    }
    if (!point_by_angle(l, from, u, &at, &by_angle) ||
        (by_angle == 0.0f && !area_point(l, u, &at)) || !area_seen(l, &at, from, s))
        return false;
    if (by_angle > 0.0f)
        s->pdf_w = by_angle;
    return true;
}

static float pdf_w(const Light *base, V3 from, V3 wi, const Surface *hit)
{
    const Area *l = (const Area *)base;
    const Shape *shape = shape_of(l);
    float d2, cosine;
    V3 d;

    cosine = -v_dot(hit->ng, wi);                       /* above 0: the front is met */
    if (shape->kind == SHAPE_SPHERE) {
        float h = cone_height(l, &shape->as.sphere, from, &d, &d2);
        if (h > 0.0f)                                   /* of points that face us, see near_point */
            return shape->flip == (cosine < 0.0f) && (l->two_sided || !shape->flip)
                       ? warp_cone_pdf(h) : 0.0f;
    }
    if (l->two_sided)
        cosine = fabsf(cosine);
    if (l->solid && cosine > 0.0f) {
        double sum[SOLID_MOST], all = area_solid_angles(l, from, sum);
        if (all > 0.0)
            return (float)(1.0 / all);
    }
    d2 = v_len2(v_sub(hit->p, from));
    return cosine > 0.0f && l->area > 0.0f ? d2 / (cosine * l->area) : 0.0f;
}

static Rgb radiance(const Light *base, V3 wi, const Surface *hit)
{
    const Area *l = (const Area *)base;
    float c = -v_dot(hit->ng, wi);

    if (!l->two_sided && !(c > 0.0f))
        return rgb_all(0.0f);
    return area_emitted(l, hit->uv, fabsf(c));
}

static const OptDef options[] = {
    { .key = "L", .type = OPT_RGB, .num = 1, .help = "radiance along the normal, W/(m^2 sr)" },
    { .key = "scale", .type = OPT_RGB, .num = 1, .help = "factor of L" },
    { .key = "power", .type = OPT_FLOAT, .num = 0, .lo = 0, .hi = 1e30,
      .help = "W (by luminance); sets L if above 0" },
    { .key = "twosided", .type = OPT_BOOL, .help = "shines from the back too" },
    { .key = "exponent", .type = OPT_FLOAT, .num = 0, .lo = 0, .hi = 1e6,
      .help = "of the cosine to the normal; 0 shines alike in all directions" },
    { .key = "filename", .type = OPT_STRING, .str = "",
      .help = "picture over (u, v), a factor of L" },
    { .key = "sampling", .type = OPT_CHOICE, .str = "area", .choices = "area solidangle",
      .help = "triangles: points by area, or by the solid angle that they fill; spheres always" },
    { .key = "samples", .type = OPT_INT, .num = 1, .lo = 1, .hi = 1e9, .also = "nsamples",
      .help = "read for old scene files, without effect" },
    { .key = NULL }
};

const LightKind light_diffuse = {
    .info = { "diffuse", "Cline07 4.4.2; Shirley96; GIRT B",
              "a shape that shines (AreaLightSource)", options },
    .make = make, .prepare = prepare, .clear = clear, .sample = sample, .pdf_w = pdf_w,
    .radiance = radiance, .emit = area_emit, .emit_pdf = area_emit_pdf,
    .power = power, .estimate = area_estimate, .places = &area_places
};
