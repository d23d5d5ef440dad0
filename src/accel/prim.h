/* prim.h -- one primitive of any kind against a ray: what the leaves of every accelerator call. */
#ifndef ACCEL_PRIM_H
#define ACCEL_PRIM_H

#include "accel/accel.h"
#include "geometry/triangle.h"

/* Spheres, discs, tessellations, instances: out of line, so that the loop over triangles stays
 * small. */
bool odd_nearest(const Accel *a, uint32_t prim, const Ray *r, const Probe *p, Hit *h,
                 Steps *steps);
bool odd_blocks(const Accel *a, uint32_t prim, const Ray *r, const Probe *p, Steps *steps);

/* Primitive `prim` of a's geometry against the ray; *h as for triangle_nearest. */
INLINE bool prim_nearest(const Accel *a, uint32_t prim, const Ray *r, const Probe *p, Hit *h,
                         Steps *steps)
{
    if (LIKELY(geometry_is_tri(a->geo, prim)))
        return triangle_nearest(a->geo, prim, p, h);
    return odd_nearest(a, prim, r, p, h, steps);
}

/* True if the primitive is hit at 0 < t <= r->tmax. */
INLINE bool prim_blocks(const Accel *a, uint32_t prim, const Ray *r, const Probe *p,
                        Steps *steps)
{
    if (LIKELY(geometry_is_tri(a->geo, prim))) {
        Hit h;
        hit_none(&h, r->tmax);
        return triangle_nearest(a->geo, prim, p, &h);
    }
    return odd_blocks(a, prim, r, p, steps);
}

/* The one or the other: *h is set unless `any` hit at t <= h->t will do, and then a part of it. */
INLINE bool prim_meets(const Accel *a, uint32_t prim, const Ray *r, const Probe *p, Hit *h,
                       bool any, Steps *steps)
{
    if (LIKELY(geometry_is_tri(a->geo, prim)))
        return triangle_nearest(a->geo, prim, p, h);
    if (!any)
        return odd_nearest(a, prim, r, p, h, steps);
    if (odd_blocks(a, prim, r, p, steps)) {
        h->outer = prim;
        return true;
    }
    return false;
}

#endif
