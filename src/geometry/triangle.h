/* triangle.h -- a ray against a triangle, watertight.
 *
 * Source      [Woop13] sections 3.1-3.3 and appendix A.
 * Idea        Translate the triangle by the ray's origin, permute the axes so that z is the
 *             largest component of the direction, shear so that the ray is the +z axis. What is
 *             left is whether the origin lies in a 2-D triangle: three edge functions. An edge
 *             that two triangles share gives both the same two products, subtracted in opposite
 *             order, so no ray can slip between them. A sign that float cannot tell is settled in
 *             double, where the products are exact.
 * Invariants  Bits depend on the ray and the corners alone, so every accelerator that calls this
 *             gives the same t. No contraction into fused multiply-adds (the build sees to it).
 * Error       The point that is met is one of the true triangle, no farther off the ray than the
 *             roundings of its corners as the ray sees them: along each axis two of the corner's
 *             distance and four of the shear. t is its depth, a mean of the corners' depths with
 *             weights of one sign, in double: needles are as good as other triangles. A triangle
 *             before and behind the origin at once needs more care, see triangle.c.
 *             The result is then put between the entry and the exit of the triangle's own box, see
 *             slabs() in ray.h: what lets every accelerator find just the same hits.
 * Departs     No culling of back faces, hence no swap of axes to keep the winding. */
#ifndef GEOMETRY_TRIANGLE_H
#define GEOMETRY_TRIANGLE_H

#include "geometry/geometry.h"

#include <string.h>

/* The box of a triangle, widened by what the edge functions can err across a large triangle seen
 * from near (relative to its extent) and by one step of the coordinates at least. */
INLINE Box triangle_box(V3 a, V3 b, V3 c)
{
    V3 lo = v_min(a, v_min(b, c)), hi = v_max(a, v_max(b, c));
    float e = ROUNDINGS(8) * v_max3(v_sub(hi, lo));
    V3 m = v_mad(v_max(v_abs(lo), v_abs(hi)), ROUNDINGS(2), v_all(e));
    return (Box){ v_sub(lo, m), v_add(hi, m) };
}

/* The lower and upper corner of a box, for arithmetic of all three axes at once. */
typedef struct { F4 lo, hi; } BoxF4;

/* The same of the same bits. */
INLINE BoxF4 triangle_box_f4(F4 a, F4 b, F4 c)
{
    F4 lo = f4_min(a, f4_min(b, c)), hi = f4_max(a, f4_max(b, c));
    F4 m, e = f4_all(ROUNDINGS(8) * f4_max_three(f4_sub(hi, lo)));

    m = f4_add(f4_mul(f4_max(f4_abs(lo), f4_abs(hi)), f4_all(ROUNDINGS(2))), e);
    return (BoxF4){ f4_sub(lo, m), f4_add(hi, m) };
}

/* Puts t between where the ray enters and leaves the box: slabs() of ray.h, in the same arithmetic.
 * False: it never does, or not within the range of floats, where boxes could not tell entry from
 * exit. */
INLINE bool hit_in_box(const Probe *p, BoxF4 b, float *t)
{
    V3 at = p->ray->o;
    F4 o = f4(at.x, at.y, at.z, 0.0f), inv = f4(p->inv.x, p->inv.y, p->inv.z, 0.0f);
    F4 n = f4_mul(f4_sub(f4_if_negative(inv, b.hi, b.lo), o), inv);
    F4 f = f4_mul(f4_sub(f4_if_negative(inv, b.lo, b.hi), o), inv);
    float near = f4_max_three(f4_max(n, f4_all(0.0f)));
    float far = f4_min_three(f4_min(f, f4_all(INFINITY))) * SLAB_WIDEN;

    *t = f_min(f_max(*t, near), far);
    return (near <= far) & (*t < INFINITY);
}

/* The corner as the ray sees it: x, y across, z along it, in units of the direction's largest
 * component (times r->sz: in units of t). */
INLINE V3 triangle_across(const Probe *r, const V3 *p)
{
    float z = v_pick(p, r->kz) - r->oz;
    return v3((v_pick(p, r->kx) - r->ox) - r->sx * z, (v_pick(p, r->ky) - r->oy) - r->sy * z, z);
}

/* Twice the areas that the ray makes with the edges b-c, c-a, a-b: the weights of a, b, c. Their
 * signs, where they are not 0, are certain. */
INLINE V3 triangle_edges(V3 a, V3 b, V3 c)
{
    return v3(c.x * b.y - c.y * b.x, a.x * c.y - a.y * c.x, b.x * a.y - b.y * a.x);
}

/* The corners of a triangle as the ray sees them. */
typedef struct { V3 a, b, c; } TriangleView;

/* Whether a triangle that reaches from behind the origin to before it is met before it. *t may be
 * set to a better one. See triangle.c. */
bool triangle_astride(V3 pa, V3 pb, V3 pc, const TriangleView *v, const Probe *r, float *t);

/* What is left to do once the ray may pass between the edges: weights, depth, box, order. The
 * corners as they were given, and as the ray sees them. */
INLINE bool triangle_accept(V3 pa, V3 pb, V3 pc, const TriangleView *v, uint32_t prim,
                            const Probe *r, Hit *h)
{
    V3 a = v->a, b = v->b, c = v->c;
    double ea = (double)c.x * b.y - (double)c.y * b.x;          /* exact but for one rounding */
    double eb = (double)a.x * c.y - (double)a.y * c.x;
    double ec = (double)b.x * a.y - (double)b.y * a.x;
    double least = d_min(ea, d_min(eb, ec)), most = d_max(ea, d_max(eb, ec));
    double det = ea + eb + ec, along = v_pick(&r->ray->d, r->kz);
    float t;
    bool ok;

    if (((least < 0) & (most > 0)) | (det == 0))        /* & and |: to branch once, not thrice */
        return false;
    t = (float)((ea * a.z + eb * b.z + ec * c.z) / (det * along));
    if (!(t > 0.0f))
        return false;
    if (f_min(a.z, f_min(b.z, c.z)) <= 0.0f && f_max(a.z, f_max(b.z, c.z)) >= 0.0f &&
        !triangle_astride(pa, pb, pc, v, r, &t))
        return false;
    ok = hit_in_box(r, triangle_box_f4(f4(pa.x, pa.y, pa.z, 0.0f), f4(pb.x, pb.y, pb.z, 0.0f),
                                       f4(pc.x, pc.y, pc.z, 0.0f)), &t);
    ok = ok & (t > 0.0f) & ((t < h->t) | ((t == h->t) & (prim < h->outer)));
    h->t = ok ? t : h->t;               /* chosen: a branch would be taken at random */
    h->u = ok ? (float)(eb / det) : h->u;
    h->v = ok ? (float)(ec / det) : h->v;
    h->outer = ok ? prim : h->outer;
    h->prim = ok ? prim : h->prim;
    return ok;
}

/* The same for a triangle of a mesh; not inlined, since most rays pass it by. */
bool triangle_accept_prim(const Geometry *g, uint32_t prim, const Probe *r, const TriangleView *v,
                          Hit *h);

/* ---- several at once ---- */

#define LANES 4
#include "geometry/triangle_lanes.h"
#define LANES 8
#include "geometry/triangle_lanes.h"

/* Copies of up to eight triangles, the lanes that are not used zero. */
typedef struct {
    float    p[3][3][8];        /* [corner][axis][triangle] */
    uint32_t prim[8];
} TriangleBlock;

void triangle_block_init(TriangleBlock *b, const Geometry *g, const uint32_t *prims, int n);

/* Rows of coordinates of the k-th corners of four triangles. Of the points four floats are loaded:
 * see MEM_BEYOND. */
INLINE void triangle_rows(const Geometry *g, const uint32_t prim[4], int k, F4 row[3])
{
    f4_transpose(f4_load_any(&g->p[g->tri[prim[0]].v[k]].x),
                 f4_load_any(&g->p[g->tri[prim[1]].v[k]].x),
                 f4_load_any(&g->p[g->tri[prim[2]].v[k]].x),
                 f4_load_any(&g->p[g->tri[prim[3]].v[k]].x), row);
}

/* The same on the way of a query: prims must have eight entries, whatever n. The lanes that are not
 * used have copies of others. */
INLINE void triangle_block_fetch(TriangleBlock *b, const Geometry *g, const uint32_t prims[8],
                                 int n)
{
    for (int k = 0; k < 3; k++) {
        F4 low[3], high[3];
        triangle_rows(g, prims, k, low);
        if (n > 4)
            triangle_rows(g, prims + 4, k, high);
        for (int axis = 0; axis < 3; axis++)
            f8_store(b->p[k][axis], f8_join(low[axis], n > 4 ? high[axis] : low[axis]));
    }
    memcpy(b->prim, prims, sizeof b->prim);
}

/* The corners of a block as the ray sees them. */
typedef union { float lane[3][3][8]; F8 align; } BlockView;    /* [corner][x, y, z][triangle] */

/* Bit k: triangle k of the first n has to be looked at more closely; see triangle_lanes.h. */
INLINE int triangle_block_test(const TriangleBlock *b, int n, const Probe *r, bool always,
                               BlockView *v)
{
    triangles8_View at;
    int bits;

    for (int k = 0; k < 3; k++) {
        at.x[k] = f8_sub(f8_load(b->p[k][r->kx]), f8_all(r->ox));
        at.y[k] = f8_sub(f8_load(b->p[k][r->ky]), f8_all(r->oy));
        at.z[k] = f8_sub(f8_load(b->p[k][r->kz]), f8_all(r->oz));
    }
    triangles8_shear(&at, r);
    bits = triangles8_test(&at, n, r->sz, always);
    if (bits)
        for (int k = 0; k < 3; k++) {
            f8_store(v->lane[k][0], at.x[k]);
            f8_store(v->lane[k][1], at.y[k]);
            f8_store(v->lane[k][2], at.z[k]);
        }
    return bits;
}

INLINE V3 triangle_lane(const float p[3][8], int k) { return v3(p[0][k], p[1][k], p[2][k]); }

/* triangle_accept for triangle k, which is to be looked at more closely. */
INLINE bool triangle_block_accept(const TriangleBlock *b, int k, const Probe *r,
                                  const BlockView *view, Hit *h)
{
    TriangleView v;

    v.a = triangle_lane(view->lane[0], k);
    v.b = triangle_lane(view->lane[1], k);
    v.c = triangle_lane(view->lane[2], k);
    return triangle_accept(triangle_lane(b->p[0], k), triangle_lane(b->p[1], k),
                           triangle_lane(b->p[2], k), &v, b->prim[k], r, h);
}

/* Up to four triangles of meshes against a ray, fetched on the way: *h as for triangle_nearest.
 * prims has four entries, whatever n. The axes are put into the ray's order before rows are made of
 * points: then nothing goes through memory but what is met. */
INLINE void triangle_four_nearest(const Geometry *g, const uint32_t prims[4], int n,
                                  const Probe *r, bool always, Hit *h)
{
    F4Axes axes = f4_axes(r->kx, r->ky, r->kz);
    F4 o = f4(r->ox, r->oy, r->oz, 0.0f);
    float lane[3][3][4];
    triangles4_View at;
    int bits;

    for (int k = 0; k < 3; k++) {
        F4 p[4], row[3];
        for (int i = 0; i < 4; i++)
            p[i] = f4_sub(f4_pick(f4_load_any(&g->p[g->tri[prims[i]].v[k]].x), axes), o);
        f4_transpose(p[0], p[1], p[2], p[3], row);
        at.x[k] = row[0];
        at.y[k] = row[1];
        at.z[k] = row[2];
    }
    triangles4_shear(&at, r);
    bits = triangles4_test(&at, n, r->sz, always);
    if (!bits)
        return;
    for (int k = 0; k < 3; k++) {
        f4_store_any(lane[k][0], at.x[k]);
        f4_store_any(lane[k][1], at.y[k]);
        f4_store_any(lane[k][2], at.z[k]);
    }
    for (; bits; bits &= bits - 1) {
        int i = LOWEST_BIT(bits);
        TriangleView v;
        V3 c[3];
        geometry_corners(g, prims[i], c);
        v.a = v3(lane[0][0][i], lane[0][1][i], lane[0][2][i]);
        v.b = v3(lane[1][0][i], lane[1][1][i], lane[1][2][i]);
        v.c = v3(lane[2][0][i], lane[2][1][i], lane[2][2][i]);
        triangle_accept(c[0], c[1], c[2], &v, prims[i], r, h);
    }
}

/* ---- one ---- */

/* Whether the ray may pass between the edges. Most do not: edge functions of both signs. */
INLINE bool triangle_may_hit(V3 a, V3 b, V3 c)
{
    V3 e = triangle_edges(a, b, c), size = v_abs(e);
    float least = f_min(e.x, f_min(e.y, e.z)), most = f_max(e.x, f_max(e.y, e.z));
    return !(least < 0.0f && most > 0.0f && f_min(size.x, f_min(size.y, size.z)) > 0.0f);
}

/* True if triangle `prim` is hit at a t in (0, h->t), or at t == h->t and prim < h->outer; then *h
 * is set. Most calls end in triangle_may_hit. */
INLINE bool triangle_nearest(const Geometry *g, uint32_t prim, const Probe *r, Hit *h)
{
    const Tri *tri = &g->tri[prim];
    TriangleView v;

    v.a = triangle_across(r, &g->p[tri->v[0]]);
    v.b = triangle_across(r, &g->p[tri->v[1]]);
    v.c = triangle_across(r, &g->p[tri->v[2]]);
    return triangle_may_hit(v.a, v.b, v.c) && triangle_accept_prim(g, prim, r, &v, h);
}

#endif
