/* prim.h -- one primitive of any kind against a ray: what the leaves of every accelerator call. */
#ifndef ACCEL_PRIM_H
#define ACCEL_PRIM_H

#include "accel/accel.h"
#include "geometry/triangle.h"

/* Spheres, discs, instances: out of line, so that the loop over triangles stays small. */
bool odd_nearest(const Geometry *g, uint32_t prim, const Ray *r, const Probe *p, Hit *h,
                 Steps *steps);
bool odd_blocks(const Geometry *g, uint32_t prim, const Ray *r, const Probe *p, Steps *steps);

/* Primitive `prim` against the ray; *h as for triangle_nearest. */
INLINE bool prim_nearest(const Geometry *g, uint32_t prim, const Ray *r, const Probe *p, Hit *h,
                         Steps *steps)
{
    if (LIKELY(geometry_is_tri(g, prim)))
        return triangle_nearest(g, prim, p, h);
    return odd_nearest(g, prim, r, p, h, steps);
}

/* True if the primitive is hit at 0 < t <= r->tmax. */
INLINE bool prim_blocks(const Geometry *g, uint32_t prim, const Ray *r, const Probe *p,
                        Steps *steps)
{
    if (LIKELY(geometry_is_tri(g, prim))) {
        Hit h;
        h.t = r->tmax;
        h.outer = NO_PRIM;
        return triangle_nearest(g, prim, p, &h);
    }
    return odd_blocks(g, prim, r, p, steps);
}

/* The one or the other: *h is set unless `any` hit at t <= h->t will do, and then a part of it. */
INLINE bool prim_meets(const Geometry *g, uint32_t prim, const Ray *r, const Probe *p, Hit *h,
                       bool any, Steps *steps)
{
    if (LIKELY(geometry_is_tri(g, prim)))
        return triangle_nearest(g, prim, p, h);
    if (!any)
        return odd_nearest(g, prim, r, p, h, steps);
    if (odd_blocks(g, prim, r, p, steps)) {
        h->outer = prim;
        return true;
    }
    return false;
}

#endif
