/* pointgrid.h -- which of many points are within a distance of a place: a hashed grid.
 *
 * Source      [GIRT 2.3.4, 3.2; errata 9]. A ball of radius r touches at most two cells along each
 *             axis if the edge of a cell is its diameter 2 r, so 8 of them; with an edge of r it
 *             would be 27, and 8 of these would find but 84 % of what is there.
 * Rows        Cells are hashed by y and z alone and follow each other along x. So of the 8 cells
 *             two neighbours are one run of points, and a query looks at 4 runs.
 * Right       for any radius and any edge: balls larger than that touch more cells. Where rows
 *             share a place of the table, points are told apart by their own row.
 * Order       Points are sorted by counting, in parts by the upper bits of their bucket: stable, so
 *             that what a query finds, and in which order, follows from the points and their order
 *             alone, not from who sorted what.
 * Knows       positions, and a number of the caller's for each: nothing of light. */
#ifndef GEOMETRY_POINTGRID_H
#define GEOMETRY_POINTGRID_H

#include "base/vec.h"

#include <stddef.h>

typedef struct { float x, y, z; uint32_t id; } PlacedPoint;

enum { POINTGRID_PARTS = 64 };

typedef struct {
    PlacedPoint *points;          /* owned: n, by bucket, then in the order in which they came */
    uint32_t *start;            /* owned: of each bucket, and n behind the last */
    PlacedPoint *loose;           /* owned: by part only */
    uint32_t *counts;           /* owned: [chunk][part], later where in `loose` they begin */
    size_t   n, chunks, cap_points, cap_loose, cap_start, cap_counts;
    uint32_t mask;              /* buckets - 1, a power of two less 1 */
    int      shift;             /* bucket >> shift: the part */
    float    scale;             /* 1 / edge */
} PointGrid;                    /* {0} holds nothing */

void pointgrid_clear(PointGrid *g);

/* All at once: point i at at[i], with the number i. False: reported, and nothing is in it. */
bool pointgrid_build(PointGrid *g, const V3 *at, size_t n, float edge);

/* The same by units that may run on several threads. The points are in chunks, in this order; of
 * each step all units end before the next step begins:
 *   begin      once: n points in all, in so many chunks; edge of a cell. False: reported, and
 *              nothing is in it.
 *   count      each chunk.
 *   arrange    once.
 *   place      each chunk: its point i has the number first + i.
 *   sort       each part, 0 .. POINTGRID_PARTS-1: the points of part k are then those from
 *              pointgrid_part(g, k) to pointgrid_part(g, k + 1).
 * at: three floats a point, `stride` bytes from one to the next. */
bool pointgrid_begin(PointGrid *g, size_t n, size_t chunks, float edge);
void pointgrid_count(PointGrid *g, size_t chunk, const float *at, size_t stride, size_t n);
void pointgrid_arrange(PointGrid *g);
void pointgrid_place(PointGrid *g, size_t chunk, const float *at, size_t stride, size_t n,
                     uint32_t first);
void pointgrid_sort(PointGrid *g, uint32_t part);
INLINE size_t pointgrid_part(const PointGrid *g, uint32_t part)
{
    return g->start[(size_t)part << g->shift];
}

/* ---- queries ---- */

/* A walk through the points nearer to p than r. */
typedef struct {
    const PointGrid *g;
    V3       p;
    float    r2;
    int32_t  x0, x1, y0, y1, z1;        /* cells that the ball may touch */
    int32_t  y, z;                      /* the row that it is in */
    uint32_t at, end, at2, end2;        /* the rest of its run, and what of it is at the table's
                                         * beginning */
    bool     all;                       /* every point is looked at, whatever its row */
} PointWalk;

PointWalk pointgrid_walk(const PointGrid *g, V3 p, float r);
/* For pointgrid_next: on to the next run. False: there is none. */
bool pointgrid_next_run(PointWalk *w);

/* Cells along an axis. Beyond 2^30 they are all one. */
INLINE int32_t pointgrid_cell(const PointGrid *g, float v)
{
    float c = f_min(f_max(v * g->scale, -0x1p30f), 0x1p30f);
    int32_t i = (int32_t)c;
    return i - (c < (float)i);
}

/* The next point nearer than r, and the squared distance; NULL: there is none left. */
INLINE const PlacedPoint *pointgrid_next(PointWalk *w, float *d2)
{
    do {
        while (w->at < w->end) {
            const PlacedPoint *q = &w->g->points[w->at++];
            float x = q->x - w->p.x, y = q->y - w->p.y, z = q->z - w->p.z;
            *d2 = x * x + y * y + z * z;
            if (*d2 < w->r2 && (w->all || (pointgrid_cell(w->g, q->y) == w->y &&
                                           pointgrid_cell(w->g, q->z) == w->z)))
                return q;
        }
    } while (pointgrid_next_run(w));
    return NULL;
}

#endif
