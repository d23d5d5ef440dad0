/* wide.c -- a tree of up to eight children a node.
 *
 * Source      [Wald08] wide nodes from a binary surface area build, tested in lanes side by side.
 * Layout      A node has the planes of its children's boxes, one lane a child, so that one test
 *             does for all. A leaf is up to eight triangles, or one odd primitive. The triangles
 *             are either copied into blocks, one lane a triangle, or a run of `order`, which leads
 *             to the mesh: a seventh of the memory at half (rays at random through a million
 *             triangles) to nine tenths of the speed (leaves=copied, shared; auto copies what is
 *             small enough to stay in a cache).
 * Invariants  The box of a child holds the boxes of all primitives below it: validate() checks.
 *             Below REFS_DEPTH_SAH runs are halved, so depth and stack are bounded whatever the
 *             input.
 * Order       Of the children that are met the nearest is next and the others wait with their
 *             entries, unsorted: they are dropped when a hit lies before them. Entries are 64-bit
 *             numbers, the bits of the distance above those of the reference, so that comparing
 *             takes no branch: it would be taken at random. */
#include "accel/accel.h"
#include "accel/prim.h"
#include "accel/refs.h"
#include "base/mem.h"
#include "base/simd.h"

#include <float.h>
#include <string.h>

enum { WIDTH = 8, LEAF = 8, ENOUGH = 2 };

/* What is below: a node, a leaf of 1 to 8 triangles, or one odd primitive. The two upper bits tell;
 * of a leaf the next three are the count less 1, the others its block or where its run begins. */
typedef uint32_t Below;
#define BELOW_LEAF ((Below)2 << 30)
#define BELOW_ODD  ((Below)3 << 30)
#define LEAF_SHIFT 27
#define MOST_PRIMS ((Below)1 << LEAF_SHIFT)             /* more cannot be told apart */

static bool  is_node(Below b) { return b >> 31 == 0; }
static bool  is_odd(Below b) { return b >> 30 == 3; }
static int   leaf_count(Below b) { return (int)(b >> LEAF_SHIFT & 7) + 1; }
static Below leaf_place(Below b) { return b & (MOST_PRIMS - 1); }

typedef struct {
    float   plane[2][3][WIDTH];         /* [lower, upper][axis][child] */
    Below   child[WIDTH];
    uint32_t present;                   /* bit k: child k exists */
    uint32_t unused[7];
} Node;
typedef char node_fills_four_lines[sizeof(Node) == 256 ? 1 : -1];

typedef struct {
    Accel base;
    void *memory;                       /* owned; holds the nodes and blocks, */
    Node *nodes;                        /* which begin at multiples of 64 in it */
    TriangleBlock *blocks;              /* of leaves=copied */
    uint32_t *order;                    /* owned; of leaves=shared, else NULL */
    size_t nnodes, nblocks;
    Below root;
} Wide;

static void set_box(Node *n, int k, Box b)
{
    for (int axis = 0; axis < 3; axis++) {
        n->plane[0][axis][k] = v_axis(b.lo, axis);
        n->plane[1][axis][k] = v_axis(b.hi, axis);
    }
}

static Box child_box(const Node *n, int k)
{
    return (Box){ v3(n->plane[0][0][k], n->plane[0][1][k], n->plane[0][2][k]),
                  v3(n->plane[1][0][k], n->plane[1][1][k], n->plane[1][2][k]) };
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

/* Divides the largest of the runs until there are eight. While there is room, runs are divided that
 * would fit a leaf: their boxes then keep rays away from most of what they would not hit, and to
 * look closely at a triangle costs more than to pass over a box. */
static int divide(const Build *b, Run run[WIDTH])
{
    int n = 1;

    while (n < WIDTH) {
        int at = -1;
        for (int k = 0; k < n; k++)
            if ((run[k].count > ENOUGH || !fits_leaf(b, &run[k])) &&
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
    Wide *w = b->wide;
    const Ref *refs = b->refs + r->first;
    uint32_t prims[LEAF];

    w->base.leaves++;
    if (r->depth > w->base.depth)
        w->base.depth = r->depth;
    if (!geometry_is_tri(w->base.geo, refs[0].prim)) {
        *below = BELOW_ODD | refs[0].prim;
        return true;
    }
    for (uint32_t i = 0; i < r->count; i++)
        prims[i] = refs[i].prim;
    *below = BELOW_LEAF | (r->count - 1) << LEAF_SHIFT;
    if (w->order) {
        *below |= r->first;
        memcpy(w->order + r->first, prims, r->count * sizeof prims[0]);
        return true;
    }
    if (!mem_grow(&b->blocks, &b->cap_blocks, b->nblocks + 1, sizeof *b->blocks))
        return false;
    *below |= (Below)b->nblocks;
    triangle_block_init(&b->blocks[b->nblocks++], w->base.geo, prims, (int)r->count);
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
    node.present = (1u << n) - 1;
    for (int k = 0; k < n; k++)
        set_box(&node, k, run[k].box);
    for (int k = 0; k < n; k++)
        if (!make_below(b, &run[k], &node.child[k]))
            return false;
    b->nodes[at] = node;
    *below = (Below)at;
    return true;
}

/* Moves nodes and blocks to memory of just their size, at begins of the cache's lines. */
static bool settle(Build *b)
{
    Wide *w = b->wide;
    size_t nodes = b->nnodes * sizeof(Node), blocks = b->nblocks * sizeof(TriangleBlock);
    char *at;

    w->memory = mem_array(nodes + blocks + 63, 1);
    if (!w->memory)
        return false;
    at = (char *)w->memory + (64 - (uintptr_t)w->memory % 64) % 64;
    w->nodes = (Node *)(void *)at;
    w->blocks = (TriangleBlock *)(void *)(at + nodes);
    if (nodes)
        memcpy(w->nodes, b->nodes, nodes);
    if (blocks)
        memcpy(w->blocks, b->blocks, blocks);
    w->nnodes = b->nnodes;
    w->nblocks = b->nblocks;
    w->base.nodes = b->nnodes;
    w->base.bytes = sizeof *w + nodes + blocks +
                    (w->order ? geometry_prims(w->base.geo) * sizeof(uint32_t) : 0);
    return true;
}

static void drop(Accel *a)
{
    Wide *w = (Wide *)a;
    mem_free(w->memory);
    mem_free(w->order);
    mem_free(w);
}

/* Blocks of this many triangles, about 6 MB, stay in the caches of today's processors. */
enum { COPIED_MOST = 1 << 16 };

static bool shares(const Geometry *g, const Opts *o)
{
    return opt_is(o, "leaves", "shared") || (opt_is(o, "leaves", "auto") && g->ntris > COPIED_MOST);
}

static Accel *build(const Geometry *g, const Opts *o, int threads)
{
    uint32_t n = geometry_prims(g);
    Build b = { MEM_NEW(Wide), NULL, NULL, NULL, 0, 0, 0, 0 };
    bool ok = false;

    (void)threads;
    if (!b.wide)
        return NULL;
    b.wide->base.geo = g;
    if (!accel_counts("wide", n, LEAF_SHIFT)) {
        drop(&b.wide->base);
        return NULL;
    }
    b.refs = MEM_ARRAY(Ref, n);
    ok = b.refs != NULL;
    if (ok && shares(g, o)) {
        b.wide->order = MEM_ARRAY(uint32_t, n);
        ok = b.wide->order != NULL;
    }
    if (ok) {
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

/* Where in a node the planes stand that a ray meets first and last, by the signs of its direction
 * (bit k: axis k downwards). */
typedef struct { int near[3], far[3]; } PlaneOrder;
#define PLANE_ORDER(x, y, z)                                                                     \
    { { 3 * WIDTH * (x),       WIDTH + 3 * WIDTH * (y),       2 * WIDTH + 3 * WIDTH * (z) },     \
      { 3 * WIDTH * (1 - (x)), WIDTH + 3 * WIDTH * (1 - (y)), 2 * WIDTH + 3 * WIDTH * (1 - (z)) } }
static const PlaneOrder plane_orders[8] = {
    PLANE_ORDER(0, 0, 0), PLANE_ORDER(1, 0, 0), PLANE_ORDER(0, 1, 0), PLANE_ORDER(1, 1, 0),
    PLANE_ORDER(0, 0, 1), PLANE_ORDER(1, 0, 1), PLANE_ORDER(0, 1, 1), PLANE_ORDER(1, 1, 1)
};

typedef struct {
    F8 o[3], inv[3];
    const PlaneOrder *order;
} NodeProbe;

INLINE void node_probe_init(NodeProbe *q, const Probe *p)
{
    V3 o = p->ray->o, d = p->ray->d, inv = p->inv;

    q->o[0] = f8_all(o.x);
    q->o[1] = f8_all(o.y);
    q->o[2] = f8_all(o.z);
    q->inv[0] = f8_all(inv.x);
    q->inv[1] = f8_all(inv.y);
    q->inv[2] = f8_all(inv.z);
    q->order = &plane_orders[f4_signs(f4(d.x, d.y, d.z, 0.0f))];
}

/* Bit k: the ray enters the box of child k before it leaves it and not beyond tmax, near[k] says
 * where. The arithmetic of each lane is that of slabs() in geometry/ray.h. */
INLINE int node_enter(const NodeProbe *q, const Node *n, float tmax, float near[WIDTH])
{
    const float *planes = n->plane[0][0];
    F8 enter = f8_all(0.0f), leave = f8_all(INFINITY);

    for (int k = 0; k < 3; k++) {
        F8 a = f8_load(planes + q->order->near[k]), b = f8_load(planes + q->order->far[k]);
        enter = f8_max(f8_mul(f8_sub(a, q->o[k]), q->inv[k]), enter);
        leave = f8_min(f8_mul(f8_sub(b, q->o[k]), q->inv[k]), leave);
    }
    f8_store(near, enter);
    return f8_at_most(enter, f8_mul(leave, f8_all(SLAB_WIDEN))) &
           f8_at_most(enter, f8_all(tmax)) & (int)n->present;
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
    Below place = leaf_place(at);
    int n = leaf_count(at);

    if (UNLIKELY(is_odd(at)))
        odd_nearest(w->base.geo, at & ~BELOW_ODD, r, p, best, steps);
    else if (w->order)
        for (int i = 0; i < n; i++)
            triangle_nearest(w->base.geo, w->order[place + (Below)i], p, best);
    else {
        BlockView v;
        int bits = triangle_block_test(&w->blocks[place], n, p, &v);
        for (; bits; bits &= bits - 1)
            triangle_block_accept(&w->blocks[place], LOWEST_BIT(bits), p, &v, best);
    }
}

/* `steps` is NULL in all calls but one, and then the counting costs nothing. */
INLINE bool nearest_steps(const Wide *w, const Ray *r, Hit *h, Steps *steps)
{
    Waiting stack[STACK], *top = stack, next;
    Below at = w->root;
    NodeProbe q;
    Probe p;

    hit_none(h, r->tmax);
    probe_init(&p, r);
    node_probe_init(&q, &p);
    for (;;) {
        if (is_node(at)) {
            const Node *n = w->nodes + at;
            float near[WIDTH];
            int bits = node_enter(&q, n, h->t, near), k;
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
                steps->prims += is_odd(at) ? 1 : (uint64_t)leaf_count(at);
            leaf_nearest(w, at, r, &p, h, steps);
        }
        do {
            if (top == stack)
                return h->outer != NO_PRIM;
            next = *--top;
        } while (waiting_near(next) > h->t);
        at = (Below)next;
    }
}

INLINE bool leaf_blocks(const Wide *w, Below at, const Ray *r, const Probe *p, Steps *steps)
{
    Hit h;

    if (UNLIKELY(is_odd(at)))
        return odd_blocks(w->base.geo, at & ~BELOW_ODD, r, p, steps);
    h.t = r->tmax;
    h.outer = NO_PRIM;
    leaf_nearest(w, at, r, p, &h, steps);
    return h.outer != NO_PRIM;
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
                steps->prims += is_odd(at) ? 1 : (uint64_t)leaf_count(at);
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
        return hit_none(h, r->tmax);
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
        return accel_bad(c->why, c->room, "a primitive that does not exist or stands twice", prim);
    if (!box_holds(box, geometry_box(c->wide->base.geo, prim)))
        return accel_bad(c->why, c->room, "a primitive sticks out of its leaf", prim);
    return true;
}

/* The copies of triangle `prim` in lane k are its corners. */
static bool check_lane(Check *c, const TriangleBlock *b, int k, uint32_t prim)
{
    V3 corner[3];

    geometry_corners(c->wide->base.geo, prim, corner);
    for (int i = 0; i < 3; i++)
        for (int axis = 0; axis < 3; axis++)
            if (b->p[i][axis][k] != v_axis(corner[i], axis))
                return accel_bad(c->why, c->room, "a corner is not the triangle's", prim);
    return true;
}

static bool check_leaf(Check *c, Below at, Box box)
{
    const Wide *w = c->wide;
    uint32_t n = geometry_prims(w->base.geo);
    Below place = leaf_place(at);
    int count = leaf_count(at);

    if (w->order ? place + (Below)count > n : place >= w->nblocks)
        return accel_bad(c->why, c->room, "a leaf that does not exist", place);
    c->blocks += !w->order;
    for (int k = 0; k < count; k++) {
        uint32_t prim = w->order ? w->order[place + (Below)k] : w->blocks[place].prim[k];
        if (!check_prim(c, prim, box))
            return false;
        if (!geometry_is_tri(w->base.geo, prim))
            return accel_bad(c->why, c->room, "an odd primitive among triangles", prim);
        if (!w->order && !check_lane(c, &w->blocks[place], k, prim))
            return false;
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
        return check_leaf(c, at, box);
    if (at >= w->nnodes || at < least)
        return accel_bad(c->why, c->room, "a node out of range", at);
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
        ok = accel_bad(why, room, "nodes or blocks that nothing leads to, after", c.nodes);
    for (uint32_t i = 0; ok && i < n; i++)
        if (!c.seen[i])
            ok = accel_bad(why, room, "no leaf holds the primitive", i);
    mem_free(c.seen);
    return ok;
}

static const OptDef options[] = {
    { .key = "leaves", .type = OPT_CHOICE, .str = "auto", .choices = "auto copied shared",
      .help = "copies of triangles are faster, sharing them with the mesh takes less memory" },
    { .key = NULL }
};

const AccelKind accel_wide = {
    .info = { "wide", "Wald08", "tree of up to eight children a node: the fastest", options },
    .build = build, .nearest = nearest, .blocked = blocked, .validate = validate, .free = drop
};
