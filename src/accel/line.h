/* line.h -- where a ray may be, for structures that divide space: the margins by which no hit is
 * lost.
 *
 * Structures of boxes need no care: a box that holds a primitive's box is never passed over, see
 * slabs() in geometry/ray.h. Cells are not such boxes; they cut primitives. But the tests of
 * primitives accept a hit at t only if o + t d is within 30 roundings of t d (26 of them
 * SLAB_WIDEN) of the primitive's own box, and so of the box of the part that is met, and the test
 * of a triangle errs by no more than 8 roundings of its extent besides; its box is larger than it
 * by that and by two roundings of the coordinates. So whoever looks into every cell within 34
 * roundings of t d and `slack`, 16 roundings of the whole extent and 4 of the coordinates, of
 * o + t d, for all t, finds it. All in double, whose own roundings are nothing to these. */
#ifndef ACCEL_LINE_H
#define ACCEL_LINE_H

#include "geometry/geometry.h"

typedef struct { double o[3], d[3], slack; } Line;

/* Slack for coordinates within the box. */
double line_slack(Box b);

/* False: a direction with a component so small that floats have no inverse of it. The tests of
 * boxes take such a component for 0, and then the ray is not where t d says: no cell may be passed
 * over. Also where anything is no number. */
bool line_init(Line *l, const Ray *r, double slack);

/* How far from the point at t along the axis. The second term is for t and products that are too
 * small to have all their digits. */
INLINE double line_margin(const Line *l, int axis, double t)
{
    double d = fabs(l->d[axis]);
    return 34 * 0x1p-24 * fabs(t) * d + 0x1p-146 * d + l->slack;
}

/* How much earlier or later than at t a plane across the axis may be met: the margin in units of t.
 * d[axis] is not 0. */
INLINE double line_doubt(const Line *l, int axis, double t)
{
    double least = 2 * l->slack / fabs(l->d[axis]) + 0x1p-140;
    return least + 64 * 0x1p-24 * (fabs(t) + least);
}

#endif
