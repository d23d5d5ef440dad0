/* ray.h -- rays, hits, and the origins of rays that leave a surface. */
#ifndef GEOMETRY_RAY_H
#define GEOMETRY_RAY_H

#include "base/simd.h"
#include "base/vec.h"

#include <stdint.h>

/* Points o + t d with 0 < t <= tmax. d need not be unit; t is in units of its length. time: when,
 * from 0 to 1, in a scene that moves. */
typedef struct { V3 o; float tmax; V3 d; float time; } Ray;

#define NO_PRIM UINT32_MAX

/* Where a ray meets a primitive. prim counts within the geometry it belongs to and, if that is a
 * tessellation, is the face (see geometry.h); outer is the primitive of the top geometry: the same,
 * that tessellation, or the instance that holds the hit. u, v: barycentric weights of the second
 * and third corner of a triangle; unused for other primitives. */
typedef struct { float t, u, v; uint32_t outer, prim; } Hit;

/* Nothing met so far, and nothing beyond tmax is looked for. */
INLINE bool hit_none(Hit *h, float tmax)
{
    h->t = tmax;
    h->outer = NO_PRIM;
    return false;
}

/* The origin of a ray that leaves the surface at p towards w. err bounds the error of each
 * coordinate of p, so the true point lies within e = |n| . err of p along n; p is moved by that
 * much (and by the rounding of the move, 2u |p|) to the side that w is on, and so never stands on
 * the far side of its own surface. Source: [PBRT4 6.8.6], with the rounding bounded instead of
 * stepping to the next float. */
INLINE V3 ray_origin(V3 p, V3 err, V3 n, V3 w)
{
    V3 e = v_mad(v_abs(p), ROUNDINGS(2), err);
    float d = v_dot(v_abs(n), e) * (1.0f + ROUNDINGS(6));
    if (v_dot(w, n) < 0.0f)
        d = -d;
    return v_mad(n, d, p);
}

/* A shadow ray runs from one offset point to another with t in (0, SHADOW_TMAX): t of a hit has a
 * relative error of a few roundings, so a hit on the surface that holds the end point could come
 * out at just below 1. Sixteen roundings cover the test of a triangle and the two offsets. */
#define SHADOW_TMAX (1.0f - ROUNDINGS(16))

/* The shadow ray from the surface point a to the surface point b, which lies towards w; errors and
 * normals as for ray_origin. The end is moved farther from its surface than an origin is, because a
 * ray wanders from its line by roundings of the way it goes, component by component: one in its
 * direction, and six in the test of a triangle (two in a corner's way from the origin, four in the
 * shear). With less, a small light far away would stand in its own light where it is seen at a
 * grazing angle. */
INLINE Ray ray_between(V3 a, V3 a_err, V3 a_n, V3 b, V3 b_err, V3 b_n, V3 w)
{
    V3 err = v_mad(v_abs(v_sub(b, a)), ROUNDINGS(8), b_err);
    V3 o = ray_origin(a, a_err, a_n, w), end = ray_origin(b, err, b_n, v_neg(w));
    return (Ray){ .o = o, .d = v_sub(end, o), .tmax = SHADOW_TMAX };
}

/* ---- boxes ---- */

/* The ray as the tests of boxes and triangles want it. For boxes: the inverse direction. For
 * triangles: axes permuted and sheared so that the ray runs along +z, see triangle.h. */
typedef struct {
    const Ray *ray;             /* borrowed */
    V3  inv;
    int kx, ky, kz;
    float sx, sy, sz;
    float ox, oy, oz;           /* the origin, permuted */
} Probe;

/* In place: a Probe by value would be copied whole just after its parts were written, for which
 * processors wait. No branches either: they would be taken at random. */
INLINE void probe_init(Probe *p, const Ray *r)
{
    float ax = fabsf(r->d.x), ay = fabsf(r->d.y), az = fabsf(r->d.z);
    float ix = 1.0f / r->d.x, iy = 1.0f / r->d.y, iz = 1.0f / r->d.z;
    int top = az > f_max(ax, ay);

    p->ray = r;
    p->inv = v3(ix, iy, iz);
    p->kz = ((ay > ax) & (top - 1)) | top << 1;
    p->kx = 9 >> 2 * p->kz & 3;         /* 1, 2, 0 */
    p->ky = 18 >> 2 * p->kz & 3;        /* 2, 0, 1 */
    p->sz = v_pick(&p->inv, p->kz);
    p->sx = v_pick(&r->d, p->kx) * p->sz;
    p->sy = v_pick(&r->d, p->ky) * p->sz;
    p->ox = v_pick(&r->o, p->kx);
    p->oy = v_pick(&r->o, p->ky);
    p->oz = v_pick(&r->o, p->kz);
}

/* The slab test. b holds lo.x lo.y lo.z - hi.x hi.y hi.z - (eight floats, two of them of no
 * concern here). *near: where the ray enters, at least 0. Returns whether it enters before it
 * leaves and not beyond tmax.
 *
 * Each step is monotonic in the planes, in floating point too: (lo - o) rounds to no less if lo
 * is no less. So a box that holds another is entered no later and left no earlier, as computed.
 * The tests of primitives put the t of a hit between near and far of the primitive's own box, as
 * computed here; hence no accelerator that compares near with the t of a hit can pass over one.
 *
 * far is widened for the roundings of the slabs (3 each side, [Ize13]) and those by which a
 * triangle test can move an edge against its box (below 20, relative to the way from the origin).
 * 0 times inf, from an origin in the plane of a slab that the ray runs along, is not a number:
 * the comparisons below then leave near and far as they were. */
#define SLAB_WIDEN (1.0f + ROUNDINGS(26))
INLINE bool slabs(const Probe *p, const float *b, float tmax, float *near, float *far)
{
    V3 o = p->ray->o;
    int x = (p->inv.x < 0.0f) << 2, y = (p->inv.y < 0.0f) << 2, z = (p->inv.z < 0.0f) << 2;
    float nx = (b[0 + x] - o.x) * p->inv.x, fx = (b[4 - x] - o.x) * p->inv.x;
    float ny = (b[1 + y] - o.y) * p->inv.y, fy = (b[5 - y] - o.y) * p->inv.y;
    float nz = (b[2 + z] - o.z) * p->inv.z, fz = (b[6 - z] - o.z) * p->inv.z;
    float n = 0.0f, f = INFINITY;

    n = nx > n ? nx : n;
    n = ny > n ? ny : n;
    n = nz > n ? nz : n;
    f = fx < f ? fx : f;
    f = fy < f ? fy : f;
    f = fz < f ? fz : f;
    f *= SLAB_WIDEN;
    *near = n;
    *far = f;
    return n <= f && n <= tmax;
}

/* The same for a box that is not stored that way. */
INLINE bool box_slabs(const Probe *p, Box b, float tmax, float *near, float *far)
{
    float planes[8] = { b.lo.x, b.lo.y, b.lo.z, 0, b.hi.x, b.hi.y, b.hi.z, 0 };
    return slabs(p, planes, tmax, near, far);
}

#endif
