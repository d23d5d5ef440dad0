/* triangle.c -- the rare part of the triangle test: a ray that passes between the edges, or may.
 * See triangle.h. */
#include "geometry/triangle.h"

/* slabs() of ray.h for a box by value: the same arithmetic, without a way through memory. */
bool hit_in_box(const Probe *p, Box box, float *t)
{
    bool x = p->neg[0], y = p->neg[1], z = p->neg[2];
    float nx = ((x ? box.hi.x : box.lo.x) - p->o.x) * p->inv.x;
    float ny = ((y ? box.hi.y : box.lo.y) - p->o.y) * p->inv.y;
    float nz = ((z ? box.hi.z : box.lo.z) - p->o.z) * p->inv.z;
    float fx = ((x ? box.lo.x : box.hi.x) - p->o.x) * p->inv.x;
    float fy = ((y ? box.lo.y : box.hi.y) - p->o.y) * p->inv.y;
    float fz = ((z ? box.lo.z : box.hi.z) - p->o.z) * p->inv.z;
    float n = f_max(nz, f_max(ny, f_max(nx, 0.0f)));
    float f = f_min(fz, f_min(fy, f_min(fx, INFINITY))) * SLAB_WIDEN;

    if (!(n <= f))
        return false;
    *t = *t < n ? n : *t > f ? f : *t;
    return true;
}

/* Bound of the absolute error of t, from the sheared coordinates a, b, c of the corners, the edge
 * functions e and 1/det: [PBRT4 6.8.7]. */
static float t_error(V3 a, V3 b, V3 c, V3 e, float inv_det)
{
    float mx = f_max(fabsf(a.x), f_max(fabsf(b.x), fabsf(c.x)));
    float my = f_max(fabsf(a.y), f_max(fabsf(b.y), fabsf(c.y)));
    float mz = f_max(fabsf(a.z), f_max(fabsf(b.z), fabsf(c.z)));
    float dx = ROUNDINGS(5) * (mx + mz), dy = ROUNDINGS(5) * (my + mz), dz = ROUNDINGS(3) * mz;
    float de = 2.0f * (ROUNDINGS(2) * mx * my + dy * mx + dx * my);
    float me = v_max3(v_abs(e));
    return 3.0f * (ROUNDINGS(3) * me * mz + de * mz + dz * me) * fabsf(inv_det);
}

/* The edge functions in double: products of two floats are exact there. [Woop13 3.3] */
static V3 edges_exact(V3 a, V3 b, V3 c)
{
    return v3((float)((double)c.x * b.y - (double)c.y * b.x),
              (float)((double)a.x * c.y - (double)a.y * c.x),
              (float)((double)b.x * a.y - (double)b.y * a.x));
}

NOINLINE bool triangle_accept(const Geometry *g, uint32_t prim, const Probe *r, TriangleView *v,
                              Hit *h)
{
    const Tri *tri = &g->tri[prim];
    V3 a = v->a, b = v->b, c = v->c, e = v->e;
    float det, inv, t;

    if (e.x == 0.0f || e.y == 0.0f || e.z == 0.0f) {
        e = edges_exact(a, b, c);
        if (f_min(e.x, f_min(e.y, e.z)) < 0.0f && f_max(e.x, f_max(e.y, e.z)) > 0.0f)
            return false;
    }
    det = e.x + e.y + e.z;
    if (det == 0.0f)
        return false;
    a.z *= r->sz;
    b.z *= r->sz;
    c.z *= r->sz;
    inv = 1.0f / det;
    t = (e.x * a.z + e.y * b.z + e.z * c.z) * inv;
    if (f_min(a.z, f_min(b.z, c.z)) <= 0.0f && !(t > t_error(a, b, c, e, inv)))
        return false;
    if (!hit_in_box(r, triangle_box(g->p[tri->v[0]], g->p[tri->v[1]], g->p[tri->v[2]]), &t))
        return false;
    if (!(t > 0.0f) || t > h->t || (t == h->t && prim >= h->outer))
        return false;
    h->t = t;
    h->u = e.y * inv;
    h->v = e.z * inv;
    h->outer = h->prim = prim;
    return true;
}
