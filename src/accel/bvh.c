/* bvh.c -- a binary tree of boxes.
 *
 * Source      [Cline07 2.2.3, 3.2.3] the tree and its 32-byte node; [Wald07] binned surface area
 *             heuristic; [Goldsmith87] the tree by insertion; slab test [Ize13], see
 *             geometry/ray.h; [Smits98] the layout without a stack, see skip.h.
 * Layout      Two siblings stand in one line of 64 bytes, 32 each: their planes side by side, so
 *             that one test of four lanes does for both, then where each leads. The primitives of a
 *             leaf are a run of `order`; where leaves have one, they name it themselves.
 * Invariants  The box of a node holds the boxes of all primitives below it: validate() checks.
 *             Depth is at most REFS_DEPTH_SAH + 32, whatever the input: below that nodes are
 *             halved.
 * Departs     [Cline07] stores two child pointers; siblings need one, which leaves room for the
 *             count of a leaf. Leaves hold up to `leaf` primitives instead of one. */
#include "accel/accel.h"
#include "accel/insertion.h"
#include "accel/prim.h"
#include "accel/refs.h"
#include "accel/skip.h"
#include "base/mem.h"
#include "base/simd.h"

#include <string.h>

typedef struct {
    uint32_t first;             /* inner: the pair of its children; leaf: the first in `order`,
                                 * or the primitive itself */
    uint32_t count;             /* primitives of a leaf; 0: inner */
} Link;

typedef struct {
    float plane[3][2][2];       /* [axis][lower, upper][left, right] */
    Link  child[2];
} Pair;
typedef char node_has_32_bytes[sizeof(Pair) == 64 ? 1 : -1];

typedef struct {
    Accel base;
    void *memory;               /* owned; holds the pairs, */
    Pair *pairs;                /* which begin at a multiple of MEM_LINE in it */
    uint32_t *order;            /* owned; NULL: each leaf has one primitive and names it */
    size_t npairs;
    Box  box;                   /* of everything */
    Link root;
    SkipNode *skips;            /* owned; of layout=skip, which has no pairs; else NULL */
    size_t nskips;              /* base.nodes counts those over tessellations, too */
} Bvh;

static SkipTree skip_tree(const Bvh *b)
{
    return (SkipTree){ &b->base, b->skips, b->order, b->nskips };
}

enum { STACK = REFS_DEPTH_SAH + 34 };

/* ---- building ---- */

typedef enum { SAH, MEDIAN, MIDDLE, GS } Split;

typedef struct {
    Bvh  *bvh;
    Ref  *refs;                 /* owned */
    Pair *pairs;                /* owned; grows */
    size_t npairs, cap_pairs;
    Split split;
    uint32_t leaf;              /* most primitives of a leaf */
    uint32_t *left;             /* owned; of GS, see insertion.h */
} Build;

/* Sort refs[first .. first + count) into child `side` of a pair; the root has no pair. `place` is
 * the node's in the tree of GS. */
typedef struct { uint32_t pair; int side; uint32_t first, count; int depth; size_t place; } Task;
#define ROOT UINT32_MAX

static void pair_set_box(Pair *p, int side, Box b)
{
    for (int k = 0; k < 3; k++) {
        p->plane[k][0][side] = v_axis(b.lo, k);
        p->plane[k][1][side] = v_axis(b.hi, k);
    }
}

static Box pair_box(const Pair *p, int side)
{
    return (Box){ v3(p->plane[0][0][side], p->plane[1][0][side], p->plane[2][0][side]),
                  v3(p->plane[0][1][side], p->plane[1][1][side], p->plane[2][1][side]) };
}

static void make_leaf(Build *b, Link *link, const Task *t)
{
    *link = (Link){ b->bvh->order ? t->first : b->refs[t->first].prim, t->count };
    for (uint32_t i = 0; b->bvh->order && i < t->count; i++)
        b->bvh->order[t->first + i] = b->refs[t->first + i].prim;
    b->bvh->base.leaves++;
    if (t->depth > b->bvh->base.depth)
        b->bvh->base.depth = t->depth;
}

/* How many of the task's primitives go to the left; 0: it becomes a leaf. */
static size_t choose_split(const Build *b, const Task *t, const Extent *e)
{
    Ref *refs = b->refs + t->first;
    Extent half[2];

    if (t->count == 1)
        return 0;
    if (b->split == SAH && t->depth < REFS_DEPTH_SAH)
        return refs_split_sah(refs, t->count, e, b->leaf, 0, half);
    if (t->count <= b->leaf)
        return 0;
    if (b->split == MEDIAN || t->depth >= REFS_DEPTH_SAH)
        return refs_split_median(refs, t->count, e->centres);
    return b->split == GS ? b->left[t->place] : refs_split_middle(refs, t->count, e->centres);
}

/* Sets the box and the link of the task's node and, unless it became a leaf, gives the tasks of its
 * children. */
static bool make_node(Build *b, Task t, Task child[2], bool *inner)
{
    Extent e = refs_extent(b->refs + t.first, t.count);
    uint32_t left, pair = (uint32_t)b->npairs;
    Link *link;

    left = (uint32_t)choose_split(b, &t, &e);
    *inner = left > 0;
    if (left && !mem_grow(&b->pairs, &b->cap_pairs, b->npairs + 1, sizeof(Pair)))
        return false;
    b->npairs += left > 0;
    if (t.pair == ROOT) {
        b->bvh->box = e.box;
        link = &b->bvh->root;
    } else {
        pair_set_box(&b->pairs[t.pair], t.side, e.box);
        link = &b->pairs[t.pair].child[t.side];
    }
    if (!left) {
        make_leaf(b, link, &t);
        return true;
    }
    *link = (Link){ pair, 0 };
    child[0] = (Task){ pair, 0, t.first, left, t.depth + 1, t.place + 1 };
    child[1] = (Task){ pair, 1, t.first + left, t.count - left, t.depth + 1,
                       t.place + 2 * (size_t)left };
    return true;
}

static bool build_nodes(Build *b, uint32_t n)
{
    Task stack[STACK];
    int top = 0;

    stack[top++] = (Task){ ROOT, 0, 0, n, 0, 0 };
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

/* Moves the pairs to memory of just their size, each in a line of the cache. */
static bool settle_pairs(Build *b)
{
    Bvh *bvh = b->bvh;
    size_t bytes = b->npairs * sizeof(Pair);

    bvh->memory = mem_array(bytes + MEM_LINE - 1, 1);
    if (!bvh->memory)
        return false;
    bvh->pairs = mem_line(bvh->memory);
    if (bytes)
        memcpy(bvh->pairs, b->pairs, bytes);
    bvh->npairs = b->npairs;
    return true;
}

/* The node of the link, and all that is below it, from node `at` on; returns what comes next. */
static uint32_t write_skips(const Build *b, Link link, Box box, uint32_t at)
{
    SkipNode *node = &b->bvh->skips[at++];

    *node = (SkipNode){ { box.lo.x, box.lo.y, box.lo.z }, link.first,
                        { box.hi.x, box.hi.y, box.hi.z }, link.count };
    if (link.count)
        return at;
    for (int side = 0; side < 2; side++) {
        const Pair *pair = &b->pairs[link.first];
        at = write_skips(b, pair->child[side], pair_box(pair, side), at);
    }
    node->first = SKIP_INNER;
    node->next = at;
    return at;
}

/* The pairs as nodes in the order of a walk. By recursion: no deeper than the tree. */
static bool settle_skips(Build *b)
{
    Bvh *bvh = b->bvh;

    bvh->skips = MEM_ARRAY(SkipNode, 2 * b->npairs + 1);
    if (!bvh->skips)
        return false;
    if (bvh->base.leaves)
        write_skips(b, bvh->root, bvh->box, 0);
    return true;
}

static void drop(Accel *a)
{
    Bvh *b = (Bvh *)a;
    mem_free(b->memory);
    mem_free(b->order);
    mem_free(b->skips);
    mem_free(b);
}

static Split split_of(const Opts *o)
{
    return opt_is(o, "split", "median") ? MEDIAN : opt_is(o, "split", "middle") ? MIDDLE
           : opt_is(o, "split", "gs") ? GS : SAH;
}

/* Memory, and the order of insertion. */
static bool prepare(Build *b, const Geometry *g, uint32_t n)
{
    b->refs = MEM_ARRAY(Ref, n);
    if (b->leaf > 1)
        b->bvh->order = MEM_ARRAY(uint32_t, n);
    if (!b->refs || (b->leaf > 1 && !b->bvh->order))
        return false;
    refs_init(b->refs, g);
    if (b->split != GS || n == 0)
        return true;
    b->left = MEM_ARRAY(uint32_t, 2 * (size_t)n - 1);
    return b->left && insertion_sort(b->refs, n, b->left);
}

static Accel *build(const Geometry *g, const Opts *o, int threads)
{
    uint32_t n = geometry_prims(g);
    Build b = { MEM_NEW(Bvh), NULL, NULL, 0, 0, split_of(o), (uint32_t)opt_int(o, "leaf"), NULL };
    bool skip = opt_is(o, "layout", "skip"), ok;

    (void)threads;
    if (!b.bvh)
        return NULL;
    b.bvh->base.geo = g;
    b.bvh->box = box_empty();
    ok = accel_counts("bvh", n, 31) && prepare(&b, g, n) && (n == 0 || build_nodes(&b, n)) &&
         (skip ? settle_skips(&b) : settle_pairs(&b));
    mem_free(b.refs);
    mem_free(b.pairs);
    mem_free(b.left);
    if (!ok) {
        drop(&b.bvh->base);
        return NULL;
    }
    b.bvh->nskips = n ? 2 * b.npairs + 1 : 0;
    b.bvh->base.nodes = b.bvh->nskips;
    b.bvh->base.bytes = sizeof *b.bvh + (b.bvh->order ? n * sizeof(uint32_t) : 0) +
                        (skip ? b.bvh->base.nodes * sizeof(SkipNode) : b.npairs * sizeof(Pair));
    return &b.bvh->base;
}

/* ---- queries ---- */

/* The ray for the test of a pair: the near planes of both boxes in lanes 0 and 1, the far ones in
 * 2 and 3, the latter with their sign turned, so that one maximum takes the latest entry and the
 * earliest exit. The arithmetic of each lane is that of slabs() in geometry/ray.h. */
typedef struct {
    F4     o[3], inv[3], widen;
    F4Turn turn[3];             /* exchanges near and far planes where the direction is negative */
} PairProbe;

INLINE void pair_probe_init(PairProbe *q, const Probe *p)
{
    for (int k = 0; k < 3; k++) {
        float o = v_pick(&p->ray->o, k), i = v_pick(&p->inv, k);
        q->o[k] = f4(o, o, o, o);
        q->inv[k] = f4(i, i, -i, -i);
        q->turn[k] = f4_turn_if(i < 0.0f);
    }
    q->widen = f4(1.0f, 1.0f, SLAB_WIDEN, SLAB_WIDEN);
}

/* Bit k is set if the ray enters box k before it leaves it and not beyond tmax; then lane k of
 * *near says where. */
INLINE int pair_enter(const PairProbe *q, const Pair *p, float tmax, F4 *near)
{
    F4 t = f4(0.0f, 0.0f, -INFINITY, -INFINITY);

    for (int k = 0; k < 3; k++) {
        F4 planes = f4_turn(f4_load(&p->plane[k][0][0]), q->turn[k]);
        t = f4_max(f4_mul(f4_sub(planes, q->o[k]), q->inv[k]), t);
    }
    *near = f4_max(f4_mul(t, q->widen), f4(0.0f, 0.0f, -tmax, -tmax));
    return f4_halves_cancel(*near);
}

typedef struct { Link link; float near; uint32_t unused; } Waiting; /* 16 bytes: no multiplying */

/* Of a leaf the primitive i; see Link. */
INLINE uint32_t prim_of(const Bvh *b, uint32_t i) { return b->order ? b->order[i] : i; }

/* The nearer child first; the other waits with its entry, and is dropped when a hit lies before
 * that. `steps` is NULL in all calls but one, and then the counting costs nothing. */
INLINE bool nearest_steps(const Bvh *b, const Ray *r, Hit *h, Steps *steps)
{
    Waiting stack[STACK], *top = stack;
    Probe p;
    PairProbe q;
    Link link = b->root;

    hit_none(h, r->tmax);
    probe_init(&p, r);
    pair_probe_init(&q, &p);
    for (;;) {
        if (steps)
            steps->nodes++;
        if (link.count == 0) {
            const Pair *pair = b->pairs + link.first;
            F4 near;
            int hits = pair_enter(&q, pair, h->t, &near);
            if (hits == 3) {
                float left = f4_lane(near, 0), right = f4_lane(near, 1);
                int first = right < left;
                top->link = pair->child[first ^ 1];
                top++->near = f_max(left, right);
                link = pair->child[first];
                continue;
            }
            if (hits) {
                link = pair->child[hits >> 1];
                continue;
            }
        } else {
            if (steps)
                steps->prims += link.count;
            for (uint32_t i = link.first; i < link.first + link.count; i++)
                prim_nearest(&b->base, prim_of(b, i), r, &p, h, steps);
        }
        do {
            if (top == stack)
                return h->outer != NO_PRIM;
            top--;
        } while (top->near > h->t);
        link = top->link;
    }
}

INLINE bool blocked_steps(const Bvh *b, const Ray *r, Steps *steps)
{
    Link stack[STACK], *top = stack, link = b->root;
    Probe p;
    PairProbe q;

    probe_init(&p, r);
    pair_probe_init(&q, &p);
    for (;;) {
        if (steps)
            steps->nodes++;
        if (link.count == 0) {
            const Pair *pair = b->pairs + link.first;
            F4 near;
            int hits = pair_enter(&q, pair, r->tmax, &near);
            if (hits == 3) {
                *top++ = pair->child[1];
                link = pair->child[0];
                continue;
            }
            if (hits) {
                link = pair->child[hits >> 1];
                continue;
            }
        } else {
            for (uint32_t i = link.first; i < link.first + link.count; i++) {
                if (steps)
                    steps->prims++;
                if (prim_blocks(&b->base, prim_of(b, i), r, &p, steps))
                    return true;
            }
        }
        if (top == stack)
            return false;
        link = *--top;
    }
}

static bool nearest(const Accel *a, const Ray *r, Hit *h, Steps *steps)
{
    const Bvh *b = (const Bvh *)a;
    if (UNLIKELY(a->nodes == 0))
        return hit_none(h, r->tmax);
    if (b->skips) {
        SkipTree t = skip_tree(b);
        return skip_nearest(&t, r, h, steps);
    }
    return UNLIKELY(steps != NULL) ? nearest_steps(b, r, h, steps) : nearest_steps(b, r, h, NULL);
}

static bool blocked(const Accel *a, const Ray *r, Steps *steps)
{
    const Bvh *b = (const Bvh *)a;
    if (UNLIKELY(a->nodes == 0))
        return false;
    if (b->skips) {
        SkipTree t = skip_tree(b);
        return skip_blocked(&t, r, steps);
    }
    return UNLIKELY(steps != NULL) ? blocked_steps(b, r, steps) : blocked_steps(b, r, NULL);
}

/* ---- checking ---- */

static bool check_leaf(const Bvh *b, Link l, Box box, unsigned char *seen, char *why, size_t room)
{
    for (uint32_t k = l.first; k < l.first + l.count; k++) {
        uint32_t prim = prim_of(b, k);
        if (prim >= geometry_prims(b->base.geo) || seen[prim]++)
            return accel_bad(why, room, "no such primitive, or it stands twice, in leaf order", k);
        if (!box_holds(box, geometry_box(b->base.geo, prim)))
            return accel_bad(why, room, "a primitive sticks out of the leaf", k);
    }
    return true;
}

/* `self`: the pair that holds the link, for messages and for order; ROOT for the root. */
static bool check_link(const Bvh *b, uint32_t self, Link l, Box box, unsigned char *seen, char *why,
                       size_t room)
{
    if (l.count)
        return check_leaf(b, l, box, seen, why, room);
    if (l.first >= b->npairs || (self != ROOT && l.first <= self))
        return accel_bad(why, room, "children out of range", self);
    for (int side = 0; side < 2; side++)
        if (!box_holds(box, pair_box(&b->pairs[l.first], side)))
            return accel_bad(why, room, "a child's box sticks out of the node", l.first);
    return true;
}

static bool validate_pairs(const Bvh *b, char *why, size_t room)
{
    uint32_t n = geometry_prims(b->base.geo);
    unsigned char *seen = MEM_ARRAY(unsigned char, n);
    bool ok = seen && (n == 0 || check_link(b, ROOT, b->root, b->box, seen, why, room));

    for (uint32_t i = 0; ok && i < b->npairs; i++)
        for (int side = 0; ok && side < 2; side++)
            ok = check_link(b, i, b->pairs[i].child[side], pair_box(&b->pairs[i], side), seen, why,
                            room);
    for (uint32_t i = 0; ok && i < n; i++)
        if (!seen[i])
            ok = accel_bad(why, room, "no leaf holds the primitive", i);
    mem_free(seen);
    return ok;
}

static bool validate(const Accel *a, char *why, size_t room)
{
    const Bvh *b = (const Bvh *)a;
    SkipTree t = skip_tree(b);
    return b->skips ? skip_validate(&t, why, room) : validate_pairs(b, why, room);
}

static const OptDef options[] = {
    { .key = "split", .type = OPT_CHOICE, .str = "sah", .choices = "sah median middle gs",
      .help = "surface area heuristic; the middle object, or the middle of the longest axis; "
              "insertion" },
    { .key = "layout", .type = OPT_CHOICE, .str = "pairs", .choices = "pairs skip",
      .help = "siblings side by side, or in the order of a walk, which needs no stack" },
    { .key = "leaf", .type = OPT_INT, .num = 4, .lo = 1, .hi = 64, .also = "maxnodeprims",
      .help = "most primitives of a leaf" },
    { .key = NULL }
};

const AccelKind accel_bvh = {
    .info = { "bvh", "Cline07 2.2.3, 3.2.3; Wald07; Goldsmith87; Smits98",
              "binary tree of boxes, 32 bytes a node", options },
    .build = build, .nearest = nearest, .blocked = blocked, .validate = validate, .free = drop
};
