/* ray.h -- rays, hits, and the origins of rays that leave a surface. */
#ifndef GEOMETRY_RAY_H
#define GEOMETRY_RAY_H

#include "base/vec.h"

#include <stdint.h>

/* Points o + t d with 0 < t <= tmax. d need not be unit; t is in units of its length. */
typedef struct { V3 o, d; float tmax; } Ray;

#define NO_PRIM UINT32_MAX

/* Where a ray meets a primitive. prim counts within the geometry it belongs to; outer is the
 * primitive of the top geometry: the same, or the instance that holds the hit. u, v: barycentric
 * weights of the second and third corner of a triangle; unused for other primitives. */
typedef struct { float t, u, v; uint32_t outer, prim; } Hit;

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

#endif
