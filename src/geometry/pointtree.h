/* pointtree.h -- points in space, found by where they are: the k nearest to a place, or all within
 * a distance.
 *
 * Source      [Bentley75]; [Cline07 7.7.1] and [GIRT 2.3.2.1] for photons.
 * Points      are the caller's records of any size that begin with three finite floats. Building
 *             puts them in order, in place; what they are numbered by is their place thereafter.
 * Tree        without pointers: a heap of 2^levels - 1 planes, each across the longest side of its
 *             points' box, with half of them on either side. Below plane number i of level l are
 *             the points from i n >> l up to (i + 1) n >> l, so at the end each leaf knows its 4 to
 *             8 neighbours in memory. Planes take 5 bytes each: less than 1.3 a point.
 * Order       Nearer is: by squared distance in float, then by number. All answers are exact in
 *             that order, as a search through all points would give them: no bound by which the
 *             tree passes points over can round up past them, for it rounds as the distance does,
 *             and rounding keeps order. */
#ifndef GEOMETRY_POINTTREE_H
#define GEOMETRY_POINTTREE_H

#include "base/vec.h"

#include <stddef.h>
#include <stdint.h>

typedef struct {
    unsigned char *points;      /* borrowed: n records of `size` bytes, a multiple of 4 */
    size_t   size;
    uint32_t n;
    int      levels;
    float   *plane;             /* owned: from 1 on; children of i are 2 i and 2 i + 1 */
    uint8_t *axis;              /* owned */
} PointTree;

/* Room for the tree; a tree without points is legal. False: reported. */
bool pointtree_init(PointTree *t, void *points, uint32_t n, size_t size);
void pointtree_clear(PointTree *t);
size_t pointtree_bytes(const PointTree *t);             /* beside the points */

/* Puts the points in order: first pointtree_start, then each of the units, in any order or at the
 * same time, each once. pointtree_build does all that. */
void     pointtree_start(PointTree *t);
uint32_t pointtree_units(const PointTree *t);
void     pointtree_finish(PointTree *t, uint32_t unit);
void     pointtree_build(PointTree *t);

INLINE V3 pointtree_at(const PointTree *t, uint32_t i)
{
    const float *p = (const float *)(const void *)(t->points + (size_t)i * t->size);
    return v3(p[0], p[1], p[2]);
}

typedef struct { float d2; uint32_t i; } Near;          /* squared distance, number */

/* The k nearest of those with d2 <= r2, and how many they are: in no order, but if there are k, the
 * first is the farthest. Of some: of those that `takes` takes. */
typedef bool PointTakes(const void *ctx, uint32_t i);
uint32_t pointtree_nearest(const PointTree *t, V3 from, float r2, uint32_t k, Near *found);
uint32_t pointtree_nearest_of_some(const PointTree *t, V3 from, float r2, uint32_t k, Near *found,
                                   PointTakes *takes, const void *ctx);

/* Looks at points with d2 <= r2, in an order that depends on nothing but the points; visit gives
 * the r2 to go on with, which is no larger than before; negative: enough. */
typedef float PointVisit(void *ctx, uint32_t i, float d2, float r2);
void pointtree_within(const PointTree *t, V3 from, float r2, PointVisit *visit, void *ctx);

#endif
