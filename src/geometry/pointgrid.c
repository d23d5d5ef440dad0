/* pointgrid.c -- building hashed grids of points, and walks through them. See pointgrid.h.
 *
 * Buckets     as many as half the points, rounded up to a power of two: points are on surfaces,
 *             so a cell has several, or the table would be mostly empty.
 * Building    counting sort in two steps, as a sort by radix is: first into the parts, chunk by
 *             chunk, then each part by bucket. Both keep the order of what is alike. */
#include "geometry/pointgrid.h"

#include "base/error.h"
#include "base/mem.h"

#include <string.h>

enum { BITS_LEAST = 10, BITS_MOST = 28, PART_BITS = 6 };

void pointgrid_clear(PointGrid *g)
{
    mem_free(g->points);
    mem_free(g->start);
    mem_free(g->loose);
    mem_free(g->counts);
    memset(g, 0, sizeof *g);
}

/* Where the row begins in the table. */
INLINE uint32_t row_hash(int32_t y, int32_t z)
{
    uint32_t h = (uint32_t)y * 0x9E3779B1u ^ (uint32_t)z * 0x85EBCA77u;

    h = (h ^ h >> 15) * 0x2C1B3C6Du;
    return h ^ h >> 13;
}

INLINE uint32_t bucket_of(const PointGrid *g, const float *p)
{
    return (row_hash(pointgrid_cell(g, p[1]), pointgrid_cell(g, p[2])) +
            (uint32_t)pointgrid_cell(g, p[0])) & g->mask;
}

bool pointgrid_begin(PointGrid *g, size_t n, size_t chunks, float edge)
{
    int bits = BITS_LEAST;
    size_t buckets;

    while (bits < BITS_MOST && (size_t)1 << bits < n / 2)
        bits++;
    buckets = (size_t)1 << bits;
    if (n >= UINT32_MAX || chunks > SIZE_MAX / POINTGRID_PARTS) {
        pointgrid_clear(g);
        return err_memory(SIZE_MAX);
    }
    if (!mem_grow(&g->points, &g->cap_points, n, sizeof *g->points) ||
        !mem_grow(&g->loose, &g->cap_loose, n, sizeof *g->loose) ||
        !mem_grow(&g->start, &g->cap_start, buckets + 1, sizeof *g->start) ||
        !mem_grow(&g->counts, &g->cap_counts, chunks * POINTGRID_PARTS, sizeof *g->counts)) {
        pointgrid_clear(g);
        return false;
    }
    g->n = n;
    g->chunks = chunks;
    g->mask = (uint32_t)(buckets - 1);
    g->shift = bits - PART_BITS;
    g->scale = 1.0f / edge;
    return true;
}

void pointgrid_count(PointGrid *g, size_t chunk, const float *at, size_t stride, size_t n)
{
    uint32_t *count = g->counts + chunk * POINTGRID_PARTS;

    memset(count, 0, POINTGRID_PARTS * sizeof *count);
    for (size_t i = 0; i < n; i++, at = (const float *)((const char *)at + stride))
        count[bucket_of(g, at) >> g->shift]++;
}

/* Part by part, within a part chunk by chunk. */
void pointgrid_arrange(PointGrid *g)
{
    uint32_t sum = 0;

    for (uint32_t part = 0; part < POINTGRID_PARTS; part++) {
        g->start[(size_t)part << g->shift] = sum;
        for (size_t chunk = 0; chunk < g->chunks; chunk++) {
            uint32_t *count = &g->counts[chunk * POINTGRID_PARTS + part], n = *count;
            *count = sum;
            sum += n;
        }
    }
    g->start[(size_t)g->mask + 1] = sum;
}

void pointgrid_place(PointGrid *g, size_t chunk, const float *at, size_t stride, size_t n,
                     uint32_t first)
{
    uint32_t *next = g->counts + chunk * POINTGRID_PARTS;

    for (size_t i = 0; i < n; i++, at = (const float *)((const char *)at + stride))
        g->loose[next[bucket_of(g, at) >> g->shift]++] =
            (PlacedPoint){ at[0], at[1], at[2], first + (uint32_t)i };
}

/* start[bucket] is first the number of its points, then where they end, and where they begin when
 * all are placed, the last first. Its own first entry and that of the next part stay as they are:
 * the next part's units look at it. */
void pointgrid_sort(PointGrid *g, uint32_t part)
{
    size_t first = (size_t)part << g->shift, size = (size_t)1 << g->shift;
    uint32_t begin = g->start[first], end = g->start[first + size], sum = begin;
    uint32_t *start = g->start + first, of_first = 0;

    memset(start + 1, 0, (size - 1) * sizeof *start);
    for (uint32_t i = begin; i < end; i++) {
        size_t k = bucket_of(g, &g->loose[i].x) - first;
        if (k)
            start[k]++;
        else
            of_first++;
    }
    sum += of_first;
    for (size_t k = 1; k < size; k++)
        start[k] = sum += start[k];
    sum = begin + of_first;
    for (uint32_t i = end; i-- > begin;) {
        size_t k = bucket_of(g, &g->loose[i].x) - first;
        g->points[k ? --start[k] : --sum] = g->loose[i];
    }
}

bool pointgrid_build(PointGrid *g, const V3 *at, size_t n, float edge)
{
    if (!pointgrid_begin(g, n, 1, edge))
        return false;
    pointgrid_count(g, 0, &at->x, sizeof *at, n);
    pointgrid_arrange(g);
    pointgrid_place(g, 0, &at->x, sizeof *at, n, 0);
    for (uint32_t k = 0; k < POINTGRID_PARTS; k++)
        pointgrid_sort(g, k);
    return true;
}

/* ---- queries ---- */

static uint32_t first_bucket(const PointWalk *w, int32_t y, int32_t z)
{
    return (row_hash(y, z) + (uint32_t)w->x0) & w->g->mask;
}

/* The run of the row (w->y, w->z). */
static void enter(PointWalk *w)
{
    const PointGrid *g = w->g;
    uint32_t size = (uint32_t)(w->x1 - w->x0) + 1, first = first_bucket(w, w->y, w->z), last;

    last = (first + size - 1) & g->mask;
    w->at = g->start[first];
    w->at2 = w->end2 = 0;
    if (last >= first) {
        w->end = g->start[last + 1];
    } else {
        w->end = (uint32_t)g->n;
        w->end2 = g->start[last + 1];
    }
}

bool pointgrid_next_run(PointWalk *w)
{
    if (w->at2 < w->end2) {
        w->at = w->at2;
        w->end = w->end2;
        w->at2 = w->end2 = 0;
        return true;
    }
    if (w->all || (w->y == w->y1 && w->z == w->z1))
        return false;
    if (w->y < w->y1) {
        w->y++;
    } else {
        w->y = w->y0;
        w->z++;
    }
    enter(w);
    return true;
}

static double cells(int32_t lo, int32_t hi) { return (double)hi - lo + 1; }

/* Nothing of the grid is likely to be in a cache. So the first points of all runs are sent for at
 * once, and whoever has other work does it before the walk. */
static void foresee(const PointWalk *w)
{
    if (cells(w->y0, w->y1) * cells(w->z, w->z1) > 4.0)
        return;
    for (int32_t z = w->z; z <= w->z1; z++)
        for (int32_t y = w->y0; y <= w->y1; y++)
            PREFETCH(&w->g->points[w->g->start[first_bucket(w, y, z)]]);
}

/* Cells from v - r to v + r, and a little more: of a point that rounding puts at a distance below
 * r, the coordinate may lie outside by 2 units in the last place of r and of v. */
static void range(const PointGrid *g, float v, float r, int32_t *lo, int32_t *hi)
{
    float wide = r * (1.0f + 0x1p-21f) + fabsf(v) * 0x1p-22f;

    *lo = pointgrid_cell(g, v - wide);
    *hi = pointgrid_cell(g, v + wide);
}

PointWalk pointgrid_walk(const PointGrid *g, V3 p, float r)
{
    PointWalk w = { .g = g, .p = p, .r2 = r * r };
    int32_t z0;

    if (!g->n) {
        w.all = true;
        return w;
    }
    range(g, p.x, r, &w.x0, &w.x1);
    range(g, p.y, r, &w.y0, &w.y1);
    range(g, p.z, r, &z0, &w.z1);
    w.y = w.y0;
    w.z = z0;
    /* more cells than buckets: most of the table is in them, and every point is looked at once */
    if (cells(w.x0, w.x1) * cells(w.y0, w.y1) * cells(z0, w.z1) > (double)g->mask) {
        w.all = true;
        w.end = (uint32_t)g->n;
    } else {
        foresee(&w);
        enter(&w);
    }
    return w;
}
