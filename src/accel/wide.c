/* wide.c -- a tree of up to eight children a node, whose boxes are bytes.
 *
 * Source      [Wald08] wide nodes from a binary surface area build; [Ylitie17] boxes of children as
 *             bytes relative to their parent's; the triangles of a leaf in lanes side by side.
 * Layout      A node has the lower corner and the step of a lattice of 256 planes on each axis, and
 *             for each child the planes of its box, rounded outwards: one test of eight lanes does
 *             for all. A leaf is a block of up to eight triangles, copied, or one odd primitive.
 * Invariants  The decoded box of a child holds the boxes of all primitives below it: validate()
 *             checks. Each node splits off less than it was given, and below REFS_DEPTH_SAH splits
 *             in half, so depth and stack are bounded whatever the input.
 * Order       Of the children that are met the nearest is next and the others wait with their
 *             entries, unsorted: they are dropped when a hit lies before them. Entries are 64-bit
 *             numbers, the bits of the distance above those of the reference, so that comparing
 *             takes no branch: they would be taken at random. */
#include "accel/accel.h"
#include "accel/prim.h"
#include "accel/refs.h"
#include "base/mem.h"
#include "base/simd.h"

#include <float.h>
#include <stdio.h>
#include <string.h>

enum { WIDTH = 8, LEAF = 8 };

/* What is below: a node, a block of 1 to 8 triangles, or one odd primitive. The two upper bits tell;
 * of a block the next three are the count less 1. */
typedef uint32_t Below;
#define BELOW_BLOCK ((Below)2 << 30)
#define BELOW_ODD   ((Below)3 << 30)
#define BLOCK_SHIFT 27
#define MOST_BELOW  ((Below)1 << BLOCK_SHIFT)           /* more nodes or blocks cannot be numbered */

static bool  is_node(Below b) { return b >> 31 == 0; }
static bool  is_odd(Below b) { return b >> 30 == 3; }
static int   block_count(Below b) { return (int)(b >> BLOCK_SHIFT & 7) + 1; }
static Below block_of(Below b) { return b & (MOST_BELOW - 1); }

typedef struct {
    float   origin[3], step[3];         /* plane = origin + byte * step, in float */
    uint8_t plane[2][3][WIDTH];         /* [lower, upper][axis][child] */
    Below   child[WIDTH];
    uint8_t present;                    /* bit k: child k exists */
} Node;

typedef struct {
    Accel base;
    Node *nodes;                        /* owned */
    void *memory;                       /* owned; holds the blocks, */
    TriangleBlock *blocks;              /* which begin at a multiple of 64 in it */
    size_t nnodes, nblocks;
    Below root;
} Wide;

/* ---- the lattice of a node ---- */

static float plane_at(const Node *n, int axis, int byte)
{
    return n->origin[axis] + (float)byte * n->step[axis];
}

static float next_up(float x)           /* x >= 0 */
{
    uint32_t bits;
    memcpy(&bits, &x, 4);
    bits++;
    memcpy(&x, &bits, 4);
    return x;
}

/* Beyond the largest float no box can be told from another. */
static float within(float x) { return f_min(f_max(x, -FLT_MAX), FLT_MAX); }

/* The least step for which plane 255 is not below hi; the roundings of product and sum can ask for
 * one or two floats more than the division says. */
static void set_lattice(Node *n, int axis, float lo, float hi)
{
    float extent = within(hi) - within(lo);

    n->origin[axis] = within(lo);
    n->step[axis] = is_finite(extent) ? extent / 255.0f
                                      : within(hi) / 255.0f - within(lo) / 255.0f;
    while (plane_at(n, axis, 255) < within(hi))
        n->step[axis] = next_up(n->step[axis]);
}

/* The planes of child k on the axis, as near as the lattice has them, and not inside. */
static void set_planes(Node *n, int k, int axis, float lo, float hi)
{
    float o = n->origin[axis], s = n->step[axis];
    int a = s > 0.0f ? (int)f_min((within(lo) - o) / s, 255.0f) : 0;
    int b = s > 0.0f ? (int)f_min((within(hi) - o) / s, 255.0f) : 0;

    for (a = a < 0 ? 0 : a; a > 0 && plane_at(n, axis, a) > within(lo);)
        a--;
    while (a < 255 && plane_at(n, axis, a + 1) <= within(lo))
        a++;
    for (b = b < 0 ? 0 : b; b < 255 && plane_at(n, axis, b) < within(hi);)
        b++;
    while (b > 0 && plane_at(n, axis, b - 1) >= within(hi))
        b--;
    n->plane[0][axis][k] = (uint8_t)a;
    n->plane[1][axis][k] = (uint8_t)b;
}

static Box child_box(const Node *n, int k)
{
    return (Box){ v3(plane_at(n, 0, n->plane[0][0][k]), plane_at(n, 1, n->plane[0][1][k]),
                     plane_at(n, 2, n->plane[0][2][k])),
                  v3(plane_at(n, 0, n->plane[1][0][k]), plane_at(n, 1, n->plane[1][1][k]),
                     plane_at(n, 2, n->plane[1][2][k])) };
}

/* ---- building ---- */

/* A run of refs, and where what it becomes is to be written. */
typedef struct {
    Box box, centres;
    uint32_t first, count;
    int depth;
} Run;

typedef struct {
    Wide *wide;
    Ref  *refs;                         /* owned */
    Node *nodes;                        /* owned; grows */
    TriangleBlock *blocks;              /* owned; grows */
    size_t nnodes, cap_nodes, nblocks, cap_blocks;
} Build;

static Run run_of(const Build *b, uint32_t first, uint32_t count, int depth)
{
    Run r = { box_empty(), box_empty(), first, count, depth };
    refs_bounds(b->refs + first, count, &r.box, &r.centres);
    return r;
}

/* A leaf takes triangles as they are and odd primitives one by one. */
static bool fits_leaf(const Build *b, const Run *r)
{
    if (r->count > LEAF)
        return false;
    for (uint32_t i = r->first; r->count > 1 && i < r->first + r->count; i++)
        if (!geometry_is_tri(b->wide->base.geo, b->refs[i].prim))
            return false;
    return true;
}

static void split_run(const Build *b, Run *r, Run *right)
{
    Ref *refs = b->refs + r->first;
    size_t k = r->depth < REFS_DEPTH_SAH
                   ? refs_split_sah(refs, r->count, r->box, r->centres, 0, LEAF)
                   : refs_split_median(refs, r->count, r->centres);
    uint32_t first = r->first, count = r->count;
    int depth = r->depth + 1;

    *r = run_of(b, first, (uint32_t)k, depth);
    *right = run_of(b, first + (uint32_t)k, count - (uint32_t)k, depth);
}

/* Divides the largest of the runs until there are eight or all are leaves. */
static int divide(const Build *b, Run run[WIDTH])
{
    int n = 1;

    while (n < WIDTH) {
        int at = -1;
        for (int k = 0; k < n; k++)
            if (!fits_leaf(b, &run[k]) &&
                (at < 0 || box_area(run[k].box) > box_area(run[at].box)))
                at = k;
        if (at < 0)
            break;
        split_run(b, &run[at], &run[n++]);
    }
    return n;
}

static bool make_leaf(Build *b, const Run *r, Below *below)
{
    const Geometry *g = b->wide->base.geo;
    uint32_t prims[LEAF];

    b->wide->base.leaves++;
    if (r->depth > b->wide->base.depth)
        b->wide->base.depth = r->depth;
    if (!geometry_is_tri(g, b->refs[r->first].prim)) {
        *below = BELOW_ODD | b->refs[r->first].prim;
        return true;
    }
    if (!mem_grow(&b->blocks, &b->cap_blocks, b->nblocks + 1, sizeof *b->blocks))
        return false;
    for (uint32_t i = 0; i < r->count; i++)
        prims[i] = b->refs[r->first + i].prim;
    triangle_block_init(&b->blocks[b->nblocks], g, prims, (int)r->count);
    *below = BELOW_BLOCK | (r->count - 1) << BLOCK_SHIFT | (Below)b->nblocks++;
    return true;
}

static bool make_node(Build *b, const Run *whole, Below *below);

static bool make_below(Build *b, const Run *r, Below *below)
{
    return fits_leaf(b, r) ? make_leaf(b, r, below) : make_node(b, r, below);
}

/* By recursion: no deeper than the tree. */
static bool make_node(Build *b, const Run *whole, Below *below)
{
    Run run[WIDTH];
    size_t at = b->nnodes;
    Node node;
    int n;

    run[0] = *whole;
    n = divide(b, run);
    if (!mem_grow(&b->nodes, &b->cap_nodes, at + 1, sizeof *b->nodes))
        return false;
    b->nnodes++;
    memset(&node, 0, sizeof node);
    node.present = (uint8_t)((1 << n) - 1);
    for (int axis = 0; axis < 3; axis++) {
        set_lattice(&node, axis, v_axis(whole->box.lo, axis), v_axis(whole->box.hi, axis));
        for (int k = 0; k < n; k++)
            set_planes(&node, k, axis, v_axis(run[k].box.lo, axis), v_axis(run[k].box.hi, axis));
    }
    for (int k = 0; k < n; k++)
        if (!make_below(b, &run[k], &node.child[k]))
            return false;
    b->nodes[at] = node;
    *below = (Below)at;
    return true;
}

/* Moves the blocks to memory of just their size, each at the begin of a line of the cache. */
static bool settle(Build *b)
{
    Wide *w = b->wide;
    size_t bytes = b->nblocks * sizeof *b->blocks;

    w->nodes = MEM_ARRAY(Node, b->nnodes);
    w->memory = mem_array(bytes + 63, 1);
    if (!w->nodes || !w->memory)
        return false;
    w->blocks = (TriangleBlock *)((char *)w->memory + (64 - (uintptr_t)w->memory % 64) % 64);
    if (b->nblocks)
        memcpy(w->blocks, b->blocks, bytes);
    if (b->nnodes)
        memcpy(w->nodes, b->nodes, b->nnodes * sizeof(Node));
    w->nnodes = b->nnodes;
    w->nblocks = b->nblocks;
    w->base.nodes = b->nnodes;
    w->base.bytes = sizeof *w + b->nnodes * sizeof(Node) + bytes;
    return true;
}

static void drop(Accel *a)
{
    Wide *w = (Wide *)a;
    mem_free(w->nodes);
    mem_free(w->memory);
    mem_free(w);
}

static Accel *build(const Geometry *g, const Opts *o, int threads)
{
    uint32_t n = geometry_prims(g);
    Build b = { MEM_NEW(Wide), NULL, NULL, NULL, 0, 0, 0, 0 };
    bool ok = false;

    (void)o;
    (void)threads;
    if (!b.wide)
        return NULL;
    b.wide->base.geo = g;
    b.refs = MEM_ARRAY(Ref, n);
    if (b.refs) {
        Run all;
        refs_init(b.refs, g);
        all = run_of(&b, 0, n, 0);
        ok = (n == 0 || make_below(&b, &all, &b.wide->root)) && settle(&b);
    }
    mem_free(b.refs);
    mem_free(b.nodes);
    mem_free(b.blocks);
    if (!ok) {
        drop(&b.wide->base);
        return NULL;
    }
    return &b.wide->base;
}

/* ---- queries ---- */

/* Each level leaves at most seven children waiting. */
enum { STACK = (WIDTH - 1) * (REFS_DEPTH_SAH + 34) };

typedef struct {
    F8  o[3], inv[3];
    int near[3];                        /* which of the two planes is met first: 0, 1 */
} NodeProbe;

INLINE void node_probe_init(NodeProbe *q, const Probe *p)
{
    for (int k = 0; k < 3; k++) {
        q->o[k] = f8_all((&p->o.x)[k]);
        q->inv[k] = f8_all((&p->inv.x)[k]);
        q->near[k] = p->neg[k];
    }
}

/* Bit k: the ray enters the box of child k before it leaves it and not beyond tmax, near[k] says
 * where. The arithmetic of each lane is that of slabs() in geometry/ray.h. */
INLINE int node_enter(const NodeProbe *q, const Node *n, float tmax, float near[WIDTH])
{
    F8 enter = f8_all(0.0f), leave = f8_all(INFINITY);

    for (int k = 0; k < 3; k++) {
        F8 origin = f8_all(n->origin[k]), step = f8_all(n->step[k]);
        F8 a = f8_add(origin, f8_mul(f8_bytes(n->plane[q->near[k]][k]), step));
        F8 b = f8_add(origin, f8_mul(f8_bytes(n->plane[1 - q->near[k]][k]), step));
        enter = f8_max(f8_mul(f8_sub(a, q->o[k]), q->inv[k]), enter);
        leave = f8_min(f8_mul(f8_sub(b, q->o[k]), q->inv[k]), leave);
    }
    leave = f8_min(f8_mul(leave, f8_all(SLAB_WIDEN)), f8_all(tmax));
    f8_store(near, enter);
    return f8_at_most(enter, leave) & n->present;
}

/* What waits: the bits of the distance, then the reference. Distances are not negative, so their
 * bits are in their order. */
typedef uint64_t Waiting;

INLINE Waiting waiting(float near, Below below)
{
    uint32_t bits;
    memcpy(&bits, &near, 4);
    return (Waiting)bits << 32 | below;
}
INLINE float waiting_near(Waiting w)
{
    uint32_t bits = (uint32_t)(w >> 32);
    float near;
    memcpy(&near, &bits, 4);
    return near;
}

INLINE void leaf_nearest(const Wide *w, Below at, const Ray *r, const Probe *p, Hit *best,
                         Steps *steps)
{
    const TriangleBlock *b;
    BlockView v;
    int n, bits;

    if (UNLIKELY(is_odd(at))) {
        odd_nearest(w->base.geo, at & ~BELOW_ODD, r, p, best, steps);
        return;
    }
    b = &w->blocks[block_of(at)];
    n = block_count(at);
    for (bits = triangle_block_test(b, n, p, &v); bits; bits &= bits - 1)
        triangle_block_accept(b, LOWEST_BIT(bits), p, &v, best);
}

/* `steps` is NULL in all calls but one, and then the counting costs nothing. */
INLINE bool nearest_steps(const Wide *w, const Ray *r, Hit *h, Steps *steps)
{
    Waiting stack[STACK], *top = stack, next;
    Below at = w->root;
    NodeProbe q;
    Probe p;
    Hit best = { r->tmax, 0, 0, NO_PRIM, NO_PRIM };

    probe_init(&p, r);
    node_probe_init(&q, &p);
    for (;;) {
        if (is_node(at)) {
            const Node *n = w->nodes + at;
            float near[WIDTH];
            int bits = node_enter(&q, n, best.t, near), k;
            if (steps)
                steps->nodes++;
            if (bits) {
                k = LOWEST_BIT(bits);
                next = waiting(near[k], n->child[k]);
                while ((bits &= bits - 1) != 0) {
                    Waiting other;
                    k = LOWEST_BIT(bits);
                    other = waiting(near[k], n->child[k]);
                    *top++ = other > next ? other : next;
                    next = other > next ? next : other;
                }
                at = (Below)next;
                continue;
            }
        } else {
            if (steps)
                steps->prims += is_odd(at) ? 1 : (uint64_t)block_count(at);
            leaf_nearest(w, at, r, &p, &best, steps);
        }
        do {
            if (top == stack) {
                if (best.outer == NO_PRIM)
                    return false;
                *h = best;
                return true;
            }
            next = *--top;
        } while (waiting_near(next) > best.t);
        at = (Below)next;
    }
}

INLINE bool leaf_blocks(const Wide *w, Below at, const Ray *r, const Probe *p, Steps *steps)
{
    const TriangleBlock *b;
    BlockView v;
    Hit h;
    int n, bits;

    if (UNLIKELY(is_odd(at)))
        return odd_blocks(w->base.geo, at & ~BELOW_ODD, r, p, steps);
    b = &w->blocks[block_of(at)];
    n = block_count(at);
    h.t = r->tmax;
    h.outer = NO_PRIM;
    for (bits = triangle_block_test(b, n, p, &v); bits; bits &= bits - 1)
        if (triangle_block_accept(b, LOWEST_BIT(bits), p, &v, &h))
            return true;
    return false;
}

INLINE bool blocked_steps(const Wide *w, const Ray *r, Steps *steps)
{
    Below stack[STACK], *top = stack, at = w->root;
    NodeProbe q;
    Probe p;

    probe_init(&p, r);
    node_probe_init(&q, &p);
    for (;;) {
        if (is_node(at)) {
            const Node *n = w->nodes + at;
            float near[WIDTH];
            int bits = node_enter(&q, n, r->tmax, near);
            if (steps)
                steps->nodes++;
            for (; bits; bits &= bits - 1)
                *top++ = n->child[LOWEST_BIT(bits)];
        } else {
            if (steps)
                steps->prims += is_odd(at) ? 1 : (uint64_t)block_count(at);
            if (leaf_blocks(w, at, r, &p, steps))
                return true;
        }
        if (top == stack)
            return false;
        at = *--top;
    }
}

static bool nearest(const Accel *a, const Ray *r, Hit *h, Steps *steps)
{
    const Wide *w = (const Wide *)a;
    if (UNLIKELY(a->leaves == 0))
        return false;
    return UNLIKELY(steps != NULL) ? nearest_steps(w, r, h, steps) : nearest_steps(w, r, h, NULL);
}

static bool blocked(const Accel *a, const Ray *r, Steps *steps)
{
    const Wide *w = (const Wide *)a;
    if (UNLIKELY(a->leaves == 0))
        return false;
    return UNLIKELY(steps != NULL) ? blocked_steps(w, r, steps) : blocked_steps(w, r, NULL);
}

/* ---- checking ---- */

static bool bad(char *why, size_t room, const char *what, size_t where)
{
    snprintf(why, room, "%s at %lu", what, (unsigned long)where);
    return false;
}

typedef struct {
    const Wide *wide;
    unsigned char *seen;                /* of each primitive */
    size_t nodes, blocks;               /* met so far */
    char  *why;
    size_t room;
} Check;

static bool check_prim(Check *c, uint32_t prim, Box box)
{
    if (prim >= geometry_prims(c->wide->base.geo) || c->seen[prim]++)
        return bad(c->why, c->room, "a primitive that does not exist or stands twice", prim);
    if (!box_holds(box, geometry_box(c->wide->base.geo, prim)))
        return bad(c->why, c->room, "a primitive sticks out of its leaf", prim);
    return true;
}

static bool check_block(Check *c, Below at, Box box)
{
    const Wide *w = c->wide;
    const TriangleBlock *b;

    if (block_of(at) >= w->nblocks)
        return bad(c->why, c->room, "a block that does not exist", block_of(at));
    b = &w->blocks[block_of(at)];
    c->blocks++;
    for (int k = 0; k < block_count(at); k++) {
        V3 corner[3];
        if (!geometry_is_tri(w->base.geo, b->prim[k]) || !check_prim(c, b->prim[k], box))
            return bad(c->why, c->room, "a wrong triangle in the block", block_of(at));
        geometry_corners(w->base.geo, b->prim[k], corner);
        for (int i = 0; i < 3; i++)
            for (int axis = 0; axis < 3; axis++)
                if (b->p[i][axis][k] != v_axis(corner[i], axis))
                    return bad(c->why, c->room, "a corner is not the triangle's", b->prim[k]);
    }
    return true;
}

/* Children come after their parent, so this ends. `box` is what the parent says of it. */
static bool check_below(Check *c, Below at, Box box, size_t least)
{
    const Wide *w = c->wide;
    const Node *n;

    if (is_odd(at))
        return check_prim(c, at & ~BELOW_ODD, box);
    if (!is_node(at))
        return check_block(c, at, box);
    if (at >= w->nnodes || at < least)
        return bad(c->why, c->room, "a node out of range", at);
    n = &w->nodes[at];
    c->nodes++;
    for (int k = 0; k < WIDTH; k++)
        if (n->present >> k & 1 &&
            !check_below(c, n->child[k], child_box(n, k), at + 1))
            return false;
    return true;
}

static bool validate(const Accel *a, char *why, size_t room)
{
    const Wide *w = (const Wide *)a;
    uint32_t n = geometry_prims(a->geo);
    Box all = { { -INFINITY, -INFINITY, -INFINITY }, { INFINITY, INFINITY, INFINITY } };
    Check c = { w, MEM_ARRAY(unsigned char, n), 0, 0, why, room };
    bool ok = c.seen && (n == 0 || check_below(&c, w->root, all, 0));

    if (ok && (c.nodes != w->nnodes || c.blocks != w->nblocks))
        ok = bad(why, room, "nodes or blocks that nothing leads to, after", c.nodes);
    for (uint32_t i = 0; ok && i < n; i++)
        if (!c.seen[i])
            ok = bad(why, room, "no leaf holds the primitive", i);
    mem_free(c.seen);
    return ok;
}

static const OptDef options[] = {
    { .key = NULL }
};

const AccelKind accel_wide = {
    .info = { "wide", "Wald08; Ylitie17", "tree of eight children a node, boxes in bytes",
              options },
    .build = build, .nearest = nearest, .blocked = blocked, .validate = validate, .free = drop
};
