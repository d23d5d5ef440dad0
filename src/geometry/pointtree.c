/* pointtree.c -- see pointtree.h. */
#include "geometry/pointtree.h"

#include "base/mem.h"
#include "base/random.h"

#include <string.h>

enum { LEAF = 8, TOP = 5, LEVELS = 30 };        /* points; levels of pointtree_start; most */

/* ---- room ---- */

bool pointtree_init(PointTree *t, void *points, uint32_t n, size_t size)
{
    memset(t, 0, sizeof *t);
    t->points = points;
    t->size = size;
    t->n = n;
    while (n >> t->levels > LEAF)
        t->levels++;
    t->plane = MEM_ARRAY(float, (size_t)1 << t->levels);
    t->axis = MEM_ARRAY(uint8_t, (size_t)1 << t->levels);
    if (t->plane && t->axis)
        return true;
    pointtree_clear(t);
    return false;
}

void pointtree_clear(PointTree *t)
{
    mem_free(t->plane);
    mem_free(t->axis);
    memset(t, 0, sizeof *t);
}

size_t pointtree_bytes(const PointTree *t)
{
    return t->plane ? ((size_t)1 << t->levels) * (sizeof *t->plane + sizeof *t->axis) : 0;
}

/* First point below node i of level l; the one behind its last is that of its neighbour. */
INLINE uint32_t first_of(const PointTree *t, uint64_t i, int l)
{
    return (uint32_t)((i * t->n) >> l);
}

/* ---- building ---- */

INLINE float coordinate(const PointTree *t, uint32_t i, int axis)
{
    return ((const float *)(const void *)(t->points + (size_t)i * t->size))[axis];
}

INLINE void exchange(const PointTree *t, uint32_t i, uint32_t j)
{
    uint32_t *a = (uint32_t *)(void *)(t->points + (size_t)i * t->size);
    uint32_t *b = (uint32_t *)(void *)(t->points + (size_t)j * t->size);

    for (size_t k = 0; k < t->size / 4; k++) {
        uint32_t w = a[k];
        a[k] = b[k];
        b[k] = w;
    }
}

static float middle_of_three(const PointTree *t, uint32_t lo, uint32_t hi, int axis, uint64_t *draw)
{
    float c[3];

    for (int k = 0; k < 3; k++) {
        *draw = mix64(*draw + 1);
        c[k] = coordinate(t, lo + (uint32_t)(((*draw >> 32) * (hi - lo)) >> 32), axis);
    }
    return f_max(f_min(c[0], c[1]), f_min(f_max(c[0], c[1]), c[2]));
}

/* Orders [lo, hi) until what is before `middle` is not above what stands there, and what is behind
 * is not below: in linear time, whatever the points are, but by bad luck. [Hoare61] */
static void halve(const PointTree *t, uint32_t lo, uint32_t hi, uint32_t middle, int axis)
{
    int64_t first = lo, last = (int64_t)hi - 1;
    uint64_t draw = ((uint64_t)lo << 32) + hi;

    while (first < last) {
        float pivot = middle_of_three(t, (uint32_t)first, (uint32_t)last + 1, axis, &draw);
        int64_t i = first, j = last;
        do {                    /* equals are exchanged, so that they end up on both sides */
            while (coordinate(t, (uint32_t)i, axis) < pivot)
                i++;
            while (coordinate(t, (uint32_t)j, axis) > pivot)
                j--;
            if (i <= j)
                exchange(t, (uint32_t)i++, (uint32_t)j--);
        } while (i <= j);
        if (middle <= j)
            last = j;
        else if (middle >= i)
            first = i;
        else
            return;             /* between the parts: it is the pivot's equal */
    }
}

static int longest_side(const PointTree *t, uint32_t lo, uint32_t hi)
{
    V3 least = pointtree_at(t, lo), most = least, side;

    for (uint32_t i = lo + 1; i < hi; i++) {
        V3 p = pointtree_at(t, i);
        least = v_min(least, p);
        most = v_max(most, p);
    }
    side = v3(most.x * 0.5f - least.x * 0.5f, most.y * 0.5f - least.y * 0.5f,
              most.z * 0.5f - least.z * 0.5f);          /* a side itself may be beyond floats */
    return side.x >= side.y && side.x >= side.z ? 0 : side.y >= side.z ? 1 : 2;
}

/* Node i of level l, and what is below it down to level `last`. */
static void divide(PointTree *t, uint32_t i, int l, int last)
{
    uint32_t lo = first_of(t, i, l), hi = first_of(t, (uint64_t)i + 1, l), middle;
    uint32_t node = (1u << l) + i;

    if (l >= last)
        return;
    middle = first_of(t, 2 * (uint64_t)i + 1, l + 1);
    t->axis[node] = (uint8_t)longest_side(t, lo, hi);
    halve(t, lo, hi, middle, t->axis[node]);
    t->plane[node] = coordinate(t, middle, t->axis[node]);
    divide(t, 2 * i, l + 1, last);
    divide(t, 2 * i + 1, l + 1, last);
}

static int top_of(const PointTree *t) { return t->levels < TOP ? t->levels : TOP; }

void pointtree_start(PointTree *t)
{
    divide(t, 0, 0, top_of(t));
}

uint32_t pointtree_units(const PointTree *t) { return 1u << top_of(t); }

void pointtree_finish(PointTree *t, uint32_t unit)
{
    divide(t, unit, top_of(t), t->levels);
}

void pointtree_build(PointTree *t)
{
    divide(t, 0, 0, t->levels);
}

/* ---- looking ---- */

/* A node to be looked at, and its cell's offsets from the place along the axes. */
typedef struct { uint32_t node; float away[3]; } Waiting;

/* The same sums as distances make, so that rounding keeps their order. */
INLINE float squared(const float d[3]) { return (d[0] * d[0] + d[1] * d[1]) + d[2] * d[2]; }

INLINE float look_at_leaf(const PointTree *t, uint32_t leaf, const float from[3], float r2,
                          PointVisit *visit, void *ctx)
{
    uint32_t end = first_of(t, (uint64_t)leaf + 1, t->levels);

    for (uint32_t i = first_of(t, leaf, t->levels); i < end; i++) {
        const float *p = (const float *)(const void *)(t->points + (size_t)i * t->size);
        float d[3] = { p[0] - from[0], p[1] - from[1], p[2] - from[2] }, d2 = squared(d);
        if (d2 <= r2)
            r2 = visit(ctx, i, d2, r2);
    }
    return r2;
}

INLINE void look(const PointTree *t, V3 place, float r2, PointVisit *visit, void *ctx)
{
    float from[3] = { place.x, place.y, place.z };
    Waiting stack[LEVELS + 1], at = { 1, { 0, 0, 0 } };
    int waiting = 0;

    if (!t->n)
        return;
    for (;;) {
        if (squared(at.away) <= r2) {
            while (at.node >> t->levels == 0) {
                int axis = t->axis[at.node];
                float d = from[axis] - t->plane[at.node];
                uint32_t near = 2 * at.node + (d > 0.0f);
                Waiting *far = &stack[waiting];
                *far = at;
                far->node = near ^ 1;
                far->away[axis] = d;
                waiting += squared(far->away) <= r2;
                at.node = near;
            }
            r2 = look_at_leaf(t, at.node - (1u << t->levels), from, r2, visit, ctx);
        }
        if (!waiting)
            return;
        at = stack[--waiting];
    }
}

void pointtree_within(const PointTree *t, V3 from, float r2, PointVisit *visit, void *ctx)
{
    look(t, from, r2, visit, ctx);
}

/* ---- the nearest: a heap whose first is the farthest ---- */

typedef struct {
    Near *found;
    uint32_t n, k;
    PointTakes *takes;
    const void *ctx;
} Nearest;

INLINE bool farther(Near a, Near b) { return a.d2 > b.d2 || (a.d2 == b.d2 && a.i > b.i); }

/* Puts x where place i is free, or below. */
INLINE void sink(Near *heap, uint32_t n, uint32_t i, Near x)
{
    for (;;) {
        uint32_t child = 2 * i + 1;
        if (child + 1 < n && farther(heap[child + 1], heap[child]))
            child++;
        if (child >= n || !farther(heap[child], x))
            break;
        heap[i] = heap[child];
        i = child;
    }
    heap[i] = x;
}

INLINE float take(void *ctx, uint32_t i, float d2, float r2)
{
    Nearest *a = ctx;
    Near x = { d2, i };

    if (a->n < a->k) {
        a->found[a->n++] = x;
        if (a->n < a->k)
            return r2;
        for (uint32_t j = a->n / 2; j-- > 0;)
            sink(a->found, a->n, j, a->found[j]);
    } else if (farther(a->found[0], x))
        sink(a->found, a->n, 0, x);
    return a->found[0].d2;
}

uint32_t pointtree_nearest(const PointTree *t, V3 from, float r2, uint32_t k, Near *found)
{
    Nearest a = { found, 0, k, NULL, NULL };

    if (k)
        look(t, from, r2, take, &a);
    return a.n;
}

static float take_some(void *ctx, uint32_t i, float d2, float r2)
{
    const Nearest *a = ctx;
    return a->takes(a->ctx, i) ? take(ctx, i, d2, r2) : r2;
}

uint32_t pointtree_nearest_of_some(const PointTree *t, V3 from, float r2, uint32_t k, Near *found,
                                   PointTakes *takes, const void *ctx)
{
    Nearest a = { found, 0, k, takes, ctx };

    if (k)
        look(t, from, r2, take_some, &a);
    return a.n;
}
