/* surface.c -- what shading asks of a hit: the point with the bound of its error, normals, (u, v)
 * and how the point moves with them. See geometry.h. */
#include "geometry/geometry.h"

#include "geometry/triangle.h"

static V3 weighted(V3 a, V3 b, V3 c, float wa, float wb, float wc)
{
    return v3(wa * a.x + wb * b.x + wc * c.x, wa * a.y + wb * b.y + wc * c.y,
              wa * a.z + wb * b.z + wc * c.z);
}

/* The point is interpolated, not taken along the ray: its error is then a few roundings of the
 * corners, however far the ray came from. [PBRT4 6.8.5]: gamma(7) times the sum of the terms. */
INLINE void point_of(const V3 c[3], float u, float v, V3 *p, V3 *err)
{
    float w = f_max(0.0f, 1.0f - u - v);

    *p = weighted(c[0], c[1], c[2], w, u, v);
    *err = v_scale(weighted(v_abs(c[0]), v_abs(c[1]), v_abs(c[2]), w, u, v), ROUNDINGS(7));
}

INLINE V3 normal_of(const V3 c[3])
{
    return v_unit(v_cross(v_sub(c[1], c[0]), v_sub(c[2], c[0])));
}

void geometry_face(const Geometry *g, uint32_t prim, V3 c[3])
{
    if (geometry_is_tri(g, prim))
        geometry_corners(g, prim, c);
    else {
        const Tessellation *t = geometry_shape(g, prim)->as.tessellation;
        tessellation_corners(t, prim - t->first_face, c);
    }
}

void geometry_point(const Geometry *g, uint32_t prim, float u, float v, V3 *p, V3 *err)
{
    V3 c[3];
    geometry_face(g, prim, c);
    point_of(c, u, v, p, err);
}

V3 geometry_normal(const Geometry *g, uint32_t prim)
{
    V3 c[3];
    geometry_face(g, prim, c);
    return normal_of(c);
}

INLINE V2 uv_between(V2 p, V2 q, V2 r, const Hit *h)
{
    float u = h->u, v = h->v, w = f_max(0.0f, 1.0f - u - v);
    return (V2){ w * p.x + u * q.x + v * r.x, w * p.y + u * q.y + v * r.y };
}

INLINE V3 normal_between(V3 p, V3 q, V3 r, const Hit *h)
{
    return v_unit(weighted(p, q, r, f_max(0.0f, 1.0f - h->u - h->v), h->u, h->v));
}

/* p is linear in (u, v) over a triangle: its edges e and f, and theirs in (u, v), give
 *   (dpdu dpdv) = (e f) (de df)^-1.
 * Where the three (u, v) are on a line there is no such map: the derivatives stay 0. */
static void triangle_derivatives(const V3 c[3], V2 p, V2 q, V2 r, Surface *s)
{
    V3 e = v_sub(c[1], c[0]), f = v_sub(c[2], c[0]);
    float eu = q.x - p.x, ev = q.y - p.y, fu = r.x - p.x, fv = r.y - p.y;
    float inverse = 1.0f / (eu * fv - ev * fu);

    if (!is_finite(inverse))
        return;
    s->dpdu = v_scale(v_sub(v_scale(e, fv), v_scale(f, ev)), inverse);
    s->dpdv = v_scale(v_sub(v_scale(f, eu), v_scale(e, fu)), inverse);
}

/* Apart, with corners of its own: where nothing looks at (u, v), those of the caller stay in
 * registers. */
static NOINLINE void triangle_uv(const Geometry *g, const Shape *shape, const Hit *h, Surface *s)
{
    const Tri *t = &g->tri[h->prim];
    V3 c[3];

    geometry_corners(g, h->prim, c);
    s->uv = (V2){ h->u, h->v };
    if (shape->uv) {
        const V2 *uv = shape->uv - shape->first_vertex;
        s->uv = uv_between(uv[t->v[0]], uv[t->v[1]], uv[t->v[2]], h);
        triangle_derivatives(c, uv[t->v[0]], uv[t->v[1]], uv[t->v[2]], s);
    } else {
        s->dpdu = v_sub(c[1], c[0]);
        s->dpdv = v_sub(c[2], c[0]);
    }
}

/* The shading normal where the file gives normals, which also say what is the front. */
static bool triangle_normal(const Geometry *g, const Shape *shape, const Hit *h, Surface *s)
{
    const Tri *t = &g->tri[h->prim];
    const V3 *n = shape->n - shape->first_vertex;
    V3 m = normal_between(n[t->v[0]], n[t->v[1]], n[t->v[2]], h);

    if (m.x == 0.0f && m.y == 0.0f && m.z == 0.0f)
        return false;
    if (v_dot(m, s->ng) < 0.0f)
        s->ng = v_neg(s->ng);
    s->ns = m;
    return true;
}

static void triangle_surface(const Geometry *g, const Shape *shape, const Hit *h, Surface *s)
{
    V3 c[3];

    geometry_corners(g, h->prim, c);
    point_of(c, h->u, h->v, &s->p, &s->err);
    s->ng = normal_of(c);
    if (!shape->plain)
        triangle_uv(g, shape, h, s);
    if (shape->n && triangle_normal(g, shape, h, s))
        return;
    if (shape->flip)
        s->ng = v_neg(s->ng);
    s->ns = s->ng;
}

/* The order of corners says what is the front; a shading normal behind it is none. */
static void tessellation_surface(const Shape *shape, const Hit *h, Surface *s)
{
    const Tessellation *t = shape->as.tessellation;
    GridPoint at[3];
    V3 c[3], n[3];
    V2 uv[3];

    tessellation_places(t, h->prim - t->first_face, at);
    for (int k = 0; k < 3; k++)
        c[k] = tessellation_point(t, at[k].x, at[k].y);
    point_of(c, h->u, h->v, &s->p, &s->err);
    s->ng = s->ns = normal_of(c);
    if (!shape->plain) {
        for (int k = 0; k < 3; k++)
            uv[k] = tessellation_uv(t, at[k].x, at[k].y);
        s->uv = uv_between(uv[0], uv[1], uv[2], h);
        triangle_derivatives(c, uv[0], uv[1], uv[2], s);
    }
    if (t->smooth) {
        for (int k = 0; k < 3; k++)
            n[k] = v_unit(tessellation_normal(t, at[k]));
        n[0] = normal_between(n[0], n[1], n[2], h);
        if (v_dot(n[0], s->ng) > 0.0f)
            s->ns = n[0];
    }
    if (shape->flip) {
        s->ng = v_neg(s->ng);
        s->ns = v_neg(s->ns);
    }
}

/* Longitude and latitude. At the poles, where u has no meaning, the derivatives stay 0. */
static void sphere_uv(const Sphere *sp, V3 d, Surface *s)
{
    V3 local = frame_in(&sp->frame, d);
    float span = PI_F, ring, turn;

    s->uv.x = m_azimuth(local.y, local.x) / sp->phimax;
    s->uv.y = m_acos(-local.z) * INV_PI;        /* 0 at the lower pole, 1 at the upper */
    if (!sp->whole) {
        float lo = m_acos(-sp->zmin / sp->radius), hi = m_acos(-sp->zmax / sp->radius);
        span = hi - lo;
        s->uv.y = (s->uv.y * PI_F - lo) / span;
    }
    ring = sqrtf(local.x * local.x + local.y * local.y);
    if (!(ring > 0.0f))
        return;
    turn = sp->phimax * sp->radius;
    s->dpdu = frame_out(&sp->frame, v3(-local.y * turn, local.x * turn, 0.0f));
    turn = span * sp->radius;
    s->dpdv = frame_out(&sp->frame, v3(-local.z * local.x / ring * turn,
                                       -local.z * local.y / ring * turn, ring * turn));
}

static void sphere_surface(const Sphere *sp, const Shape *shape, const Ray *r, const Hit *h,
                           Surface *s)
{
    V3 d = v_unit(v_sub(v_mad(r->d, h->t, r->o), sp->centre));

    /* Put back on the sphere: five roundings of the offset and one of the sum. */
    s->p = v_mad(d, sp->radius, sp->centre);
    s->err = v_scale(v_add(v_all(sp->radius), v_abs(sp->centre)), ROUNDINGS(6));
    s->ng = s->ns = shape->flip ? v_neg(d) : d;
    if (!shape->plain)
        sphere_uv(sp, d, s);
}

static void disk_surface(const Disk *d, const Shape *shape, const Ray *r, const Hit *h, Surface *s)
{
    V3 q = v_sub(v_mad(r->d, h->t, r->o), d->centre);
    float x = v_dot(q, d->frame.s), y = v_dot(q, d->frame.t);

    s->p = v_mad(d->frame.s, x, v_mad(d->frame.t, y, d->centre));
    s->err = v_scale(v_add(v_all(d->radius), v_abs(d->centre)), ROUNDINGS(6));
    s->ng = s->ns = shape->flip ? v_neg(d->frame.n) : d->frame.n;
    if (!shape->plain) {
        float rad = sqrtf(x * x + y * y);
        s->uv.x = m_azimuth(y, x) / d->phimax;
        s->uv.y = d->radius > d->inner ? (d->radius - rad) / (d->radius - d->inner) : 0.0f;
        s->dpdu = v_scale(v_sub(v_scale(d->frame.t, x), v_scale(d->frame.s, y)), d->phimax);
        if (rad > 0.0f)
            s->dpdv = v_scale(v_add(v_scale(d->frame.s, x), v_scale(d->frame.t, y)),
                              (d->inner - d->radius) / rad);
    }
}

void geometry_surface(const Geometry *g, const Ray *r, const Hit *h, Surface *s)
{
    const Shape *shape = geometry_shape(g, h->prim);

    s->shape = shape;
    s->prim = h->prim;
    s->time = r->time;
    s->uv = (V2){ 0, 0 };
    s->dpdu = s->dpdv = v_all(0.0f);
    s->width = 0.0f;
    switch (shape->kind) {
    case SHAPE_MESH:     triangle_surface(g, shape, h, s); break;
    case SHAPE_SPHERE:   sphere_surface(&shape->as.sphere, shape, r, h, s); break;
    case SHAPE_DISK:     disk_surface(&shape->as.disk, shape, r, h, s); break;
    case SHAPE_TESSELLATION: tessellation_surface(shape, h, s); break;
    case SHAPE_INSTANCE: ASSERT(!"an instance has no surface"); break;
    }
}
