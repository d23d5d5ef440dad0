/* triangle.h -- a ray against a triangle, watertight.
 *
 * Source      [Woop13] sections 3.1-3.3 and appendix A.
 * Idea        Translate the triangle by the ray's origin, permute the axes so that z is the
 *             largest component of the direction, shear so that the ray is the +z axis. What is
 *             left is whether the origin lies in a 2-D triangle: three edge functions. An edge
 *             that two triangles share gives both the same two products, subtracted in opposite
 *             order, so no ray can slip between them. An edge function that comes out 0 is computed
 *             again in double, where the products are exact.
 * Invariants  Bits depend on the ray and the corners alone, so every accelerator that calls this
 *             gives the same t. No contraction into fused multiply-adds (the build sees to it).
 * Error       t is the mean of the corners' sheared depths with weights U, V, W of one sign, so it
 *             lies between the least and the largest depth whatever the error of the weights. Only
 *             a triangle that straddles the plane through the origin can yield a t > 0 which in
 *             truth is not; there t must exceed the bound of its error, [PBRT4 6.8.7].
 *             The result is then put between the entry and the exit of the triangle's own box, see
 *             slabs() in ray.h: what lets every accelerator find just the same hits.
 * Departs     No culling of back faces, hence no swap of axes to keep the winding. */
#ifndef GEOMETRY_TRIANGLE_H
#define GEOMETRY_TRIANGLE_H

#include "geometry/geometry.h"

/* V3 is three floats in a row, so a component can be picked by number without a branch. */
typedef char v3_is_three_floats[sizeof(V3) == 3 * sizeof(float) ? 1 : -1];
INLINE float v_pick(const V3 *v, int k) { return (&v->x)[k]; }

/* The box of a triangle, widened by what the edge functions can err across a large triangle seen
 * from near (relative to its extent) and by one step of the coordinates at least. */
INLINE Box triangle_box(V3 a, V3 b, V3 c)
{
    V3 lo = v_min(a, v_min(b, c)), hi = v_max(a, v_max(b, c));
    float e = ROUNDINGS(8) * v_max3(v_sub(hi, lo));
    V3 m = v_mad(v_max(v_abs(lo), v_abs(hi)), ROUNDINGS(2), v_all(e));
    return (Box){ v_sub(lo, m), v_add(hi, m) };
}

/* Puts t between where the ray enters and leaves the box. False: it never does, or not within the
 * range of floats, where the tests of boxes could not tell entry from exit. */
static inline bool hit_in_box(const Probe *p, Box box, float *t)
{
    float b[8] = { box.lo.x, box.lo.y, box.lo.z, 0, box.hi.x, box.hi.y, box.hi.z, 0 }, near, far;

    if (!slabs(p, b, INFINITY, &near, &far))
        return false;
    *t = *t < near ? near : *t > far ? far : *t;
    return *t < INFINITY;
}

/* Bound of the absolute error of t, from the sheared coordinates a, b, c of the corners, the edge
 * functions e and 1/det: [PBRT4 6.8.7]. */
static inline float triangle_t_error(V3 a, V3 b, V3 c, V3 e, float inv_det)
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
static inline V3 triangle_edges_exact(V3 a, V3 b, V3 c)
{
    return v3((float)((double)c.x * b.y - (double)c.y * b.x),
              (float)((double)a.x * c.y - (double)a.y * c.x),
              (float)((double)b.x * a.y - (double)b.y * a.x));
}

/* The corner as the ray sees it: x, y across, z along it (in units of t). */
INLINE V3 triangle_shear(const Probe *r, const V3 *p)
{
    float z = v_pick(p, r->kz) - r->oz;
    return v3((v_pick(p, r->kx) - r->ox) - r->sx * z, (v_pick(p, r->ky) - r->oy) - r->sy * z,
              r->sz * z);
}

/* True if triangle `prim` is hit at a t in (0, h->t), or at t == h->t and prim < h->outer; then *h
 * is set. */
INLINE bool triangle_nearest(const Geometry *g, uint32_t prim, const Probe *r, Hit *h)
{
    const Tri *tri = &g->tri[prim];
    const V3 *pa = &g->p[tri->v[0]], *pb = &g->p[tri->v[1]], *pc = &g->p[tri->v[2]];
    V3 a = triangle_shear(r, pa), b = triangle_shear(r, pb), c = triangle_shear(r, pc);
    V3 e = v3(c.x * b.y - c.y * b.x, a.x * c.y - a.y * c.x, b.x * a.y - b.y * a.x);
    float det, inv, t, near;

    if (UNLIKELY(e.x == 0.0f || e.y == 0.0f || e.z == 0.0f))
        e = triangle_edges_exact(a, b, c);
    if ((e.x < 0.0f || e.y < 0.0f || e.z < 0.0f) && (e.x > 0.0f || e.y > 0.0f || e.z > 0.0f))
        return false;
    det = e.x + e.y + e.z;
    if (det == 0.0f)
        return false;
    inv = 1.0f / det;
    t = (e.x * a.z + e.y * b.z + e.z * c.z) * inv;
    near = f_min(a.z, f_min(b.z, c.z));
    if (UNLIKELY(near <= 0.0f) && !(t > triangle_t_error(a, b, c, e, inv)))
        return false;
    if (!hit_in_box(r, triangle_box(*pa, *pb, *pc), &t))
        return false;
    if (!(t > 0.0f) || t > h->t || (t == h->t && prim >= h->outer))
        return false;
    h->t = t;
    h->u = e.y * inv;
    h->v = e.z * inv;
    h->outer = h->prim = prim;
    return true;
}

#endif
