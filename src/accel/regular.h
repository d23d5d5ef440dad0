/* regular.h -- lightweight bounding volumes over a regular tessellation.
 *
 * Source      [Cline07 3.3.3, 3.3.4].
 * Regions     A node bounds a region (x, y, d) of the grid: rectangular, d by d cells from (x, y)
 *             on; triangular, the triangle of the points (x, y), (x, y + d), (x + d, y + d), which
 *             lies upside down if d < 0. Four children have half the side. A region of
 *             the least side is a leaf, and its triangles follow from x, y and d.
 * Layout      Nothing but planes (see planes.h): those of four siblings stand side by side, and
 *             which four is reckoned. As in a heap, the children of group q are groups 4 q + 1 to
 *             4 q + 4; but where a rectangular grid needs fewer than that, the groups of each level
 *             stand in rows, and x, y and d tell which.
 * Build       Bottom-up, from the points of leaves; nothing is sorted.
 * Departs     Sides are not bound to 2^k cells: what lies outside of the grid is empty. Near
 *             children first. */
#ifndef ACCEL_REGULAR_H
#define ACCEL_REGULAR_H

#include "accel/accel.h"

/* Of t, which stays borrowed. A node takes 12 or 6 bytes. A leaf holds as many of 2, 8, 32 ... or,
 * triangular, 1, 4, 16 ... triangles as f.leaf admits, at least the first. NULL: no memory,
 * reported. */
Regular *regular_new(const Tessellation *t, RegularForm f);
void     regular_free(Regular *r);              /* NULL is allowed */
size_t   regular_bytes(const Regular *r);
uint64_t regular_nodes(const Regular *r);       /* four a group, and the root */
uint64_t regular_leaves(const Regular *r);      /* those that hold a triangle */

/* The triangles against a ray: *h and the result as for triangle_nearest, prim and outer being the
 * number of the triangle within t. True at the first one if `any` will do. r NULL: a plain loop
 * over all triangles of t. */
bool regular_hits(const Regular *r, const Tessellation *t, const Probe *p, Hit *h, bool any,
                  Steps *steps);

/* Every box as decoded holds those of its children and triangles, every triangle is in one leaf,
 * and every group of siblings is reached once. False: *why says what is not so. */
bool regular_validate(const Regular *r, char *why, size_t room);

#endif
