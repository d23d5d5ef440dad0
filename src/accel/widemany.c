/* widemany.c -- queries of many rays through `wide`: several rays in flight.
 *
 * Idea    One ray waits: each step needs what the last one found, and memory. So several are on
 *         their way at a time, a step of each in turn, and what the next step of a ray will read is
 *         fetched while the others take theirs. */
#include "accel/wide.h"

/* Fewer rays in flight leave memory waiting, more take the cache from each other. UNTRIED: groups
 * that are not tried after one that was no gain. */
enum { FLIGHT = 16, UNTRIED = 7 };

/* A ray on its way. */
typedef struct {
    NodeProbe q;
    Probe   p;
    Hit     h;
    size_t  number;                     /* in the batch */
    Below   at;
    Waiting *top;                       /* of those that wait */
    Waiting stack[WIDE_STACK];          /* the first says that there are no more */
} Walk;

#define DONE UINT32_MAX                 /* no odd primitive has that number */

/* Rays that are at nodes, and rays that are at leaves. */
typedef struct { Walk *x[FLIGHT]; size_t n; } Queue;

static const uint32_t lanes[WIDTH] = { 0, 1, 2, 3, 4, 5, 6, 7 };

/* What the children are: node_child in lanes. */
INLINE I8 node_children(const Wide *w, bool lean, Below at)
{
    const LeanNode *n = &w->lean_nodes[at];
    I8 rank, begin, count, leaf;

    if (!lean)
        return i8_load(w->fast_nodes[at].child);
    rank = i8_sub(i8_load(lanes), i8_all(n->leaves));      /* less than 0: a leaf */
    begin = i8_load_u8(n->end);
    count = i8_sub(i8_load_u8(n->end + 1), begin);
    leaf = i8_add(i8_left(count, LEAF_SHIFT), i8_all(BELOW_LEAF - ((Below)1 << LEAF_SHIFT)));
    leaf = i8_add(leaf, i8_add(begin, i8_all(n->prims)));
    return i8_if_top(rank, leaf, i8_add(rank, i8_all(n->nodes)));
}

INLINE void walk_begin(Walk *x, const Wide *w, const Ray *r, size_t number)
{
    hit_none(&x->h, r[number].tmax);
    probe_init(&x->p, &r[number]);
    node_probe_init(&x->q, &x->p);
    x->number = number;
    x->at = w->root;
    x->stack[0] = DONE;
    x->top = x->stack + 1;
}

/* Where things are that the next step reads, picked without a branch. */
INLINE void fetch(const Wide *w, bool lean, Below at)
{
    uintptr_t node = lean ? (uintptr_t)&w->lean_nodes[at] : (uintptr_t)&w->fast_nodes[at];
    uintptr_t leaf = !lean ? (uintptr_t)&w->blocks[leaf_place(at)]
                     : w->order ? (uintptr_t)&w->order[leaf_place(at)]
                                : (uintptr_t)&w->base.geo->tri[leaf_place(at)];
    uintptr_t is_leaf = (uintptr_t)0 - (at >> 31);
    const char *next = (const char *)((leaf & is_leaf) | (node & ~is_leaf));

    for (int k = 0; k < (lean ? 2 : 4); k++)
        PREFETCH(next + 64 * k);
}

/* Takes from the stack until something is not beyond the hit, and goes there. */
INLINE void walk_on(Walk *x, const Wide *w, bool lean, Waiting next)
{
    while (UNLIKELY(waiting_near(next) > x->h.t))
        next = *--x->top;
    x->at = (Below)next;
    fetch(w, lean, x->at);
}

/* Without a branch on what is met, which would be taken at random. Where any hit will do the last
 * child is next, else the nearest; where none is met, what waits on top. */
INLINE void step_node(Walk *x, const Wide *w, bool lean, bool any)
{
    F8 near;
    int bits = node_enter(w, lean, x->at, &x->q, x->h.t, &near);
    Keys8 keys = keys8(near, node_children(w, lean, x->at));
    Waiting least, met = (Waiting)0 - (bits != 0);

    if (any) {
        keys8_store(x->top, keys, bits);
        x->top += COUNT_BITS(bits) - 1;
        walk_on(x, w, lean, *x->top);
        return;
    }
    least = keys8_least(keys, bits);
    keys8_store(x->top, keys, keys8_others(keys, bits, least));
    x->top += COUNT_BITS(bits) - 1;
    walk_on(x, w, lean, (least & met) | (*x->top & ~met));
}

/* The primitives of a leaf; then what waits. */
INLINE void step_leaf(Walk *x, const Wide *w, bool lean, bool any)
{
    leaf_meets(w, lean, x->at, x->p.ray, &x->p, true, &x->h, any, NULL);
    if (any && x->h.outer != NO_PRIM)
        x->at = DONE;
    else
        walk_on(x, w, lean, *--x->top);
}

/* Into the queue of what it is at: written to both, counted in one, without a branch. */
INLINE void queue_up(Queue *nodes, Queue *leaves, Walk *x)
{
    nodes->x[nodes->n] = x;
    nodes->n += is_node(x->at);
    leaves->x[leaves->n] = x;
    leaves->n += !is_node(x->at);
}

/* h is NULL where any hit will do. */
INLINE void fly_as(const Wide *w, bool lean, bool any, const Ray *r, Hit *h, bool *hit, size_t n)
{
    Walk walk[FLIGHT];
    Queue nodes, leaves;
    size_t next = n < FLIGHT ? n : FLIGHT;

    nodes.n = leaves.n = 0;
    for (size_t k = 0; k < next; k++) {
        walk_begin(&walk[k], w, r, k);
        queue_up(&nodes, &leaves, &walk[k]);
    }
    while (nodes.n + leaves.n) {
        size_t count = nodes.n;
        nodes.n = 0;
        for (size_t k = 0; k < count; k++) {
            Walk *x = nodes.x[k];
            step_node(x, w, lean, any);
            queue_up(&nodes, &leaves, x);
        }
        count = leaves.n;
        leaves.n = 0;
        for (size_t k = 0; k < count; k++) {
            Walk *x = leaves.x[k];
            if (x->at != DONE)
                step_leaf(x, w, lean, any);
            if (x->at == DONE) {
                hit[x->number] = answer(&x->h, x->p.ray, any ? NULL : &h[x->number]);
                if (next == n)
                    continue;
                walk_begin(x, w, r, next++);
            }
            queue_up(&nodes, &leaves, x);
        }
    }
}

static void fly(const Wide *w, const Ray *r, Hit *h, bool *hit, size_t n)
{
    if (w->lean && h)
        fly_as(w, true, false, r, h, hit, n);
    else if (w->lean)
        fly_as(w, true, true, r, NULL, hit, n);
    else if (h)
        fly_as(w, false, false, r, h, hit, n);
    else
        fly_as(w, false, true, r, NULL, hit, n);
}

/* Rays that go the same way as their neighbours fly as a group, the others run by run. Where a
 * group was no gain the next ones are not tried. */
static void many(const Wide *w, const Ray *r, Hit *h, bool *hit, size_t n)
{
    size_t from = 0, at = 0;

    for (; at + WIDE_GROUP <= n; at += WIDE_GROUP) {
        if (!wide_group_coheres(r + at))
            continue;
        if (!wide_group(w, r + at, h ? h + at : NULL, hit + at)) {
            at += UNTRIED * WIDE_GROUP;
            continue;
        }
        fly(w, r + from, h ? h + from : NULL, hit + from, at - from);
        from = at + WIDE_GROUP;
    }
    fly(w, r + from, h ? h + from : NULL, hit + from, n - from);
}

void wide_nearest_many(const Accel *a, const Ray *r, Hit *h, bool *hit, size_t n)
{
    if (a->leaves)
        many((const Wide *)a, r, h, hit, n);
    else
        for (size_t i = 0; i < n; i++)
            hit[i] = hit_none(&h[i], r[i].tmax);
}

void wide_blocked_many(const Accel *a, const Ray *r, bool *blocked, size_t n)
{
    if (a->leaves)
        many((const Wide *)a, r, NULL, blocked, n);
    else
        memset(blocked, 0, n * sizeof *blocked);
}
