/* refs.h -- primitives being sorted into a tree: what the builders of trees share.
 *
 * Source  [Cline07 3.2.3] the median of the objects; [Wald07] the binned surface area heuristic. */
#ifndef ACCEL_REFS_H
#define ACCEL_REFS_H

#include "geometry/geometry.h"

typedef struct { Box box; uint32_t prim; } Ref;

/* Of some refs: the box of their boxes, and that of the middles of these. */
typedef struct { Box box, centres; } Extent;

/* Below this depth trees halve their primitives, so that no input makes them deeper than this and
 * the 32 halvings of 2^32 primitives. */
enum { REFS_DEPTH_SAH = 48 };

/* The boxes of all primitives of g in refs[0 .. geometry_prims(g)). */
void refs_init(Ref *refs, const Geometry *g);

Extent refs_extent(const Ref *refs, size_t n);

/* Each divides refs[0..n) into refs[0..k) and refs[k..n) and returns k, 0 < k < n; n >= 2. The
 * outcome does not depend on the order they come in. */

/* Afterwards refs[0..k) come before refs[k..n), 0 < k < n, on the longest axis of the centres. */
void refs_divide(Ref *refs, size_t n, size_t k, Box centres);

/* The middle object on the longest axis of the centres. */
size_t refs_split_median(Ref *refs, size_t n, Box centres);

/* The middle of the longest axis of the centres; the middle object where all are on one side. */
size_t refs_split_middle(Ref *refs, size_t n, Box centres);

/* Between two of at most 16 bins on the axis where the sum over sides of area times cost is least;
 * the cost of m primitives is that of m / 2^shift groups, rounded up. 0: one leaf, where n <= leaf
 * and no split is cheaper than that; a visit of a node is taken to cost as much as a group. Else
 * half says what the two are like. */
size_t refs_split_sah(Ref *refs, size_t n, const Extent *whole, size_t leaf, int shift,
                      Extent half[2]);

#endif
