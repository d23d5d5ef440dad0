/* bvh.c -- a binary tree of boxes.
 *
 * Source      [Cline07 2.2.3, 3.2.3] the tree and its 32-byte node; [Wald07] binned surface area
 *             heuristic; slab test [Ize13], see geometry/ray.h.
 * Layout      Nodes in one array, the two children of a node side by side (so they share a line of
 *             64 bytes); the primitives of a leaf are a run of `order`.
 * Invariants  A node's box holds the boxes of all primitives below it: validate() checks. Depth is
 *             at most DEPTH_SAH + 32, whatever the input: below DEPTH_SAH only halves are made.
 * Departs     [Cline07] stores two child pointers; neighbours need one, which leaves room for the
 *             count of a leaf. Leaves hold up to `leaf` primitives instead of one. */
#include "accel/accel.h"
#include "accel/prim.h"
#include "base/mem.h"

#include <stdio.h>
#include <string.h>

typedef struct {
    float    lo[3];
    uint32_t first;             /* inner: the left child, the right one follows; leaf: in order */
    float    hi[3];
    uint32_t count;             /* primitives of a leaf; 0: inner */
} Node;
typedef char node_has_32_bytes[sizeof(Node) == 32 ? 1 : -1];

typedef struct {
    Accel base;
    Node *nodes;                /* owned; [0] is the root */
    uint32_t *order;            /* owned */
    size_t nnodes, cap_nodes;
} Bvh;

enum { BINS = 16, DEPTH_SAH = 48, STACK = DEPTH_SAH + 34 };

/* ---- building ---- */

typedef struct { Box box; uint32_t prim; } Ref;         /* a primitive being sorted into the tree */

typedef struct {
    Bvh  *bvh;
    Ref  *refs;
    bool  sah;
    uint32_t leaf;              /* most primitives of a leaf */
} Build;

typedef struct { uint32_t node, first, count; int depth; } Task;

static void node_set_box(Node *n, Box b)
{
    n->lo[0] = b.lo.x;
    n->lo[1] = b.lo.y;
    n->lo[2] = b.lo.z;
    n->hi[0] = b.hi.x;
    n->hi[1] = b.hi.y;
    n->hi[2] = b.hi.z;
}

static Box node_box(const Node *n)
{
    return (Box){ v3(n->lo[0], n->lo[1], n->lo[2]), v3(n->hi[0], n->hi[1], n->hi[2]) };
}

static int longest_axis(Box b)
{
    V3 d = v_sub(b.hi, b.lo);
    return d.x >= d.y && d.x >= d.z ? 0 : d.y >= d.z ? 1 : 2;
}

static float ref_centre(const Ref *r, int axis)
{
    return 0.5f * v_axis(r->box.lo, axis) + 0.5f * v_axis(r->box.hi, axis);
}

/* Ties are settled by the primitive's number, so the tree does not depend on the order of refs. */
static bool ref_before(const Ref *a, const Ref *b, int axis)
{
    float x = ref_centre(a, axis), y = ref_centre(b, axis);
    return x < y || (x == y && a->prim < b->prim);
}

/* Hoare's selection: afterwards refs[0..k) come before refs[k..n) along the axis. */
static void select_refs(Ref *refs, size_t n, size_t k, int axis)
{
    size_t lo = 0, hi = n;

    while (hi - lo > 1) {
        Ref pivot = refs[lo + (hi - lo) / 2];
        size_t i = lo, j = hi - 1;
        for (;;) {
            Ref swap;
            while (ref_before(&refs[i], &pivot, axis))
                i++;
            while (ref_before(&pivot, &refs[j], axis))
                j--;
            if (i >= j)
                break;
            swap = refs[i];
            refs[i++] = refs[j];
            refs[j--] = swap;
        }
        if (k <= j)                             /* [lo..j] <= pivot <= [j+1..hi) */
            hi = j + 1;
        else
            lo = j + 1;
        if (lo >= k && hi <= k + 1)
            break;
    }
}

static size_t split_median(Ref *refs, size_t n, Box centres)
{
    select_refs(refs, n, n / 2, longest_axis(centres));
    return n / 2;
}

typedef struct { Box box; uint32_t n; } Bin;

static int bin_of(const Ref *r, int axis, float lo, float scale)
{
    int b = (int)((ref_centre(r, axis) - lo) * scale);
    return b < 0 ? 0 : b >= BINS ? BINS - 1 : b;
}

/* Least cost of a split between bins: sum over sides of area times count. *cut: first bin of the
 * right side. */
static float best_cut(const Bin *bins, int *cut)
{
    float cost[BINS], best = INFINITY;
    Box b = box_empty();
    uint32_t n = 0;

    for (int i = BINS - 1; i > 0; i--) {
        b = box_join(b, bins[i].box);
        n += bins[i].n;
        cost[i] = n ? box_area(b) * (float)n : INFINITY;
    }
    b = box_empty();
    n = 0;
    for (int i = 1; i < BINS; i++) {
        b = box_join(b, bins[i - 1].box);
        n += bins[i - 1].n;
        if (n && box_area(b) * (float)n + cost[i] < best) {
            best = box_area(b) * (float)n + cost[i];
            *cut = i;
        }
    }
    return best;
}

/* Splits by the heuristic, or returns 0 if a leaf is cheaper. A visit of a node is taken to cost as
 * much as the test of a primitive. */
static size_t split_sah(Ref *refs, size_t n, Box box, Box centres, uint32_t leaf)
{
    Bin bins[3][BINS];
    float scale[3], lo[3], best = INFINITY;
    int axis = -1, cut = 0;
    size_t i = 0, j = n;

    for (int k = 0; k < 3; k++) {
        float extent = v_axis(centres.hi, k) - v_axis(centres.lo, k);
        lo[k] = v_axis(centres.lo, k);
        scale[k] = extent > 0.0f && is_finite((float)BINS / extent) ? (float)BINS / extent : 0.0f;
        for (int b = 0; b < BINS; b++)
            bins[k][b] = (Bin){ box_empty(), 0 };
    }
    for (size_t r = 0; r < n; r++)
        for (int k = 0; k < 3; k++) {
            Bin *b = &bins[k][bin_of(&refs[r], k, lo[k], scale[k])];
            b->box = box_join(b->box, refs[r].box);
            b->n++;
        }
    for (int k = 0; k < 3; k++) {
        int at = 0;
        float cost = scale[k] > 0.0f ? best_cut(bins[k], &at) : INFINITY;
        if (cost < best) {
            best = cost;
            axis = k;
            cut = at;
        }
    }
    if (n <= leaf && !(best + box_area(box) < box_area(box) * (float)n))
        return 0;
    if (axis < 0)                               /* all centres in one place, or no area at all */
        return split_median(refs, n, centres);
    while (i < j) {
        if (bin_of(&refs[i], axis, lo[axis], scale[axis]) < cut)
            i++;
        else {
            Ref swap = refs[i];
            refs[i] = refs[--j];
            refs[j] = swap;
        }
    }
    return i > 0 && i < n ? i : split_median(refs, n, centres);
}

static void make_leaf(Build *b, Node *node, const Task *t)
{
    node->first = t->first;
    node->count = t->count;
    for (uint32_t i = 0; i < t->count; i++)
        b->bvh->order[t->first + i] = b->refs[t->first + i].prim;
    b->bvh->base.leaves++;
    if (t->depth > b->bvh->base.depth)
        b->bvh->base.depth = t->depth;
}

/* Sets the node of the task and, unless it became a leaf, gives the tasks of its children. */
static bool make_node(Build *b, Task t, Task child[2], bool *inner)
{
    Ref *refs = b->refs + t.first;
    Box box = box_empty(), centres = box_empty();
    size_t left = 0;
    uint32_t at;

    for (uint32_t i = 0; i < t.count; i++) {
        box = box_join(box, refs[i].box);
        centres = box_point(centres, box_centre(refs[i].box));
    }
    node_set_box(&b->bvh->nodes[t.node], box);
    if (t.count > 1 && (b->sah || t.count > b->leaf))
        left = b->sah && t.depth < DEPTH_SAH ? split_sah(refs, t.count, box, centres, b->leaf)
                                             : t.count > b->leaf ? split_median(refs, t.count, centres)
                                                                 : 0;
    *inner = left > 0;
    if (!left) {
        make_leaf(b, &b->bvh->nodes[t.node], &t);
        return true;
    }
    at = (uint32_t)b->bvh->nnodes;
    if (!mem_grow(&b->bvh->nodes, &b->bvh->cap_nodes, b->bvh->nnodes + 2, sizeof(Node)))
        return false;
    b->bvh->nnodes += 2;
    b->bvh->nodes[t.node].first = at;
    b->bvh->nodes[t.node].count = 0;
    child[0] = (Task){ at, t.first, (uint32_t)left, t.depth + 1 };
    child[1] = (Task){ at + 1, t.first + (uint32_t)left, t.count - (uint32_t)left, t.depth + 1 };
    return true;
}

static bool build_nodes(Build *b, uint32_t n)
{
    Task stack[STACK];
    int top = 0;

    if (!mem_grow(&b->bvh->nodes, &b->bvh->cap_nodes, 1, sizeof(Node)))
        return false;
    b->bvh->nnodes = 1;
    stack[top++] = (Task){ 0, 0, n, 0 };
    while (top) {
        Task child[2];
        bool inner;
        if (!make_node(b, stack[--top], child, &inner))
            return false;
        if (inner) {
            ASSERT(top + 2 <= STACK);
            stack[top++] = child[1];
            stack[top++] = child[0];
        }
    }
    return true;
}

static void drop(Accel *a)
{
    Bvh *b = (Bvh *)a;
    mem_free(b->nodes);
    mem_free(b->order);
    mem_free(b);
}

/* Frees what growing by halves left over. Keeping it is no error, so a failure is none. */
static void trim_nodes(Bvh *b)
{
    Node *nodes;
    if (b->cap_nodes == b->nnodes)
        return;
    nodes = MEM_ARRAY(Node, b->nnodes);
    if (!nodes)
        return;
    memcpy(nodes, b->nodes, b->nnodes * sizeof *nodes);
    mem_free(b->nodes);
    b->nodes = nodes;
    b->cap_nodes = b->nnodes;
}

static Accel *build(const Geometry *g, const Opts *o, int threads)
{
    uint32_t n = geometry_prims(g);
    Build b = { MEM_NEW(Bvh), NULL, opt_is(o, "split", "sah"), (uint32_t)opt_int(o, "leaf") };
    bool ok = false;

    (void)threads;
    if (!b.bvh)
        return NULL;
    b.bvh->base.geo = g;
    b.refs = MEM_ARRAY(Ref, n);
    b.bvh->order = MEM_ARRAY(uint32_t, n);
    if (b.refs && b.bvh->order) {
        for (uint32_t i = 0; i < n; i++)
            b.refs[i] = (Ref){ geometry_box(g, i), i };
        ok = n == 0 || build_nodes(&b, n);
    }
    mem_free(b.refs);
    if (!ok) {
        drop(&b.bvh->base);
        return NULL;
    }
    trim_nodes(b.bvh);
    b.bvh->base.nodes = b.bvh->nnodes;
    b.bvh->base.bytes = sizeof *b.bvh + b.bvh->cap_nodes * sizeof(Node) + n * sizeof(uint32_t);
    return &b.bvh->base;
}

/* ---- queries ---- */

typedef struct { uint32_t node; float near; } Waiting;

INLINE bool enters(const Probe *p, const Node *n, float tmax, float *near)
{
    float far;
    return slabs(p, (const float *)n, tmax, near, &far);
}

/* The nearer child first; the other waits with its entry, and is dropped when a hit lies before
 * that. `steps` is NULL in all calls but one, and then the counting costs nothing. */
INLINE bool nearest_steps(const Bvh *b, const Ray *r, Hit *h, Steps *steps)
{
    const Geometry *g = b->base.geo;
    const Node *nodes = b->nodes, *n = nodes;
    Waiting stack[STACK];
    Probe p = probe_of(r);
    Hit best = { r->tmax, 0, 0, NO_PRIM, NO_PRIM };
    int top = 0;
    float near;

    if (!b->nnodes || !enters(&p, n, best.t, &near))
        return false;
    for (;;) {
        if (steps)
            steps->nodes++;
        if (n->count == 0) {
            const Node *left = nodes + n->first, *right = left + 1;
            float tl, tr;
            bool in_left = enters(&p, left, best.t, &tl), in_right = enters(&p, right, best.t, &tr);
            if (in_left && in_right) {
                bool swap = tr < tl;
                stack[top].node = swap ? n->first : n->first + 1;
                stack[top++].near = swap ? tl : tr;
                n = swap ? right : left;
                continue;
            }
            if (in_left || in_right) {
                n = in_left ? left : right;
                continue;
            }
        } else {
            const uint32_t *prim = b->order + n->first;
            if (steps)
                steps->prims += n->count;
            for (uint32_t i = 0; i < n->count; i++)
                prim_nearest(g, prim[i], r, &p, &best, steps);
        }
        do {
            if (top == 0) {
                if (best.outer == NO_PRIM)
                    return false;
                *h = best;
                return true;
            }
            top--;
        } while (stack[top].near > best.t);
        n = nodes + stack[top].node;
    }
}

INLINE bool blocked_steps(const Bvh *b, const Ray *r, Steps *steps)
{
    const Geometry *g = b->base.geo;
    const Node *nodes = b->nodes, *n = nodes;
    uint32_t stack[STACK];
    Probe p = probe_of(r);
    int top = 0;
    float near;

    if (!b->nnodes || !enters(&p, n, r->tmax, &near))
        return false;
    for (;;) {
        if (steps)
            steps->nodes++;
        if (n->count == 0) {
            const Node *left = nodes + n->first, *right = left + 1;
            float tl, tr;
            bool in_left = enters(&p, left, r->tmax, &tl);
            bool in_right = enters(&p, right, r->tmax, &tr);
            if (in_left) {
                if (in_right)
                    stack[top++] = n->first + 1;
                n = left;
                continue;
            }
            if (in_right) {
                n = right;
                continue;
            }
        } else {
            const uint32_t *prim = b->order + n->first;
            for (uint32_t i = 0; i < n->count; i++) {
                if (steps)
                    steps->prims++;
                if (prim_blocks(g, prim[i], r, &p, steps))
                    return true;
            }
        }
        if (top == 0)
            return false;
        n = nodes + stack[--top];
    }
}

static bool nearest(const Accel *a, const Ray *r, Hit *h, Steps *steps)
{
    const Bvh *b = (const Bvh *)a;
    return UNLIKELY(steps != NULL) ? nearest_steps(b, r, h, steps) : nearest_steps(b, r, h, NULL);
}

static bool blocked(const Accel *a, const Ray *r, Steps *steps)
{
    const Bvh *b = (const Bvh *)a;
    return UNLIKELY(steps != NULL) ? blocked_steps(b, r, steps) : blocked_steps(b, r, NULL);
}

/* ---- checking ---- */

static bool bad(char *why, size_t room, const char *what, size_t where)
{
    snprintf(why, room, "%s at %lu", what, (unsigned long)where);
    return false;
}

static bool check_node(const Bvh *b, uint32_t i, unsigned char *seen, char *why, size_t room)
{
    const Node *n = &b->nodes[i];

    if (n->count == 0) {
        if (n->first <= i || n->first + 1 >= b->nnodes)
            return bad(why, room, "children out of range", i);
        if (!box_holds(node_box(n), node_box(n + (n->first - i))) ||
            !box_holds(node_box(n), node_box(n + (n->first + 1 - i))))
            return bad(why, room, "a child's box sticks out of the node", i);
        return true;
    }
    for (uint32_t k = n->first; k < n->first + n->count; k++) {
        uint32_t prim = b->order[k];
        if (prim >= geometry_prims(b->base.geo) || seen[prim]++)
            return bad(why, room, "a primitive that does not exist or stands twice in the leaf", i);
        if (!box_holds(node_box(n), geometry_box(b->base.geo, prim)))
            return bad(why, room, "a primitive sticks out of the leaf", i);
    }
    return true;
}

static bool validate(const Accel *a, char *why, size_t room)
{
    const Bvh *b = (const Bvh *)a;
    uint32_t n = geometry_prims(a->geo);
    unsigned char *seen = MEM_ARRAY(unsigned char, n);
    bool ok = seen != NULL;

    for (uint32_t i = 0; ok && i < b->nnodes; i++)
        ok = check_node(b, i, seen, why, room);
    for (uint32_t i = 0; ok && i < n; i++)
        if (!seen[i])
            ok = bad(why, room, "no leaf holds the primitive", i);
    mem_free(seen);
    return ok;
}

static const OptDef options[] = {
    { .key = "split", .type = OPT_CHOICE, .str = "sah", .choices = "sah median",
      .help = "where to divide: surface area heuristic, or the middle object on the longest axis" },
    { .key = "leaf", .type = OPT_INT, .num = 4, .lo = 1, .hi = 64, .also = "maxnodeprims",
      .help = "most primitives of a leaf" },
    { .key = NULL }
};

const AccelKind accel_bvh = {
    .info = { "bvh", "Cline07 2.2.3, 3.2.3; Wald07", "binary tree of boxes, 32 bytes a node", options },
    .build = build, .nearest = nearest, .blocked = blocked, .validate = validate, .free = drop
};
