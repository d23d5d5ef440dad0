/* widemany.c -- queries of many rays through `wide`: several rays in flight.
 *
 * Idea    One ray waits: each step needs what the last one found, and memory. So several are on
 *         their way at a time, a step of each in turn, and what the next step of a ray will read is
 *         fetched while the others take theirs. The answers are those of single rays: each ray's
 *         own steps are the same. */
#include "accel/wide.h"

enum { FLIGHT = 8 };

/* A ray on its way. */
typedef struct {
    NodeProbe q;
    Probe   p;
    Hit     h;
    size_t  number;                     /* in the batch */
    Below   at;
    Waiting *top;                       /* of those that wait */
    Waiting stack[WIDE_STACK];
} Walk;

INLINE void walk_begin(Walk *x, const Wide *w, const Ray *r, size_t number)
{
    hit_none(&x->h, r[number].tmax);
    probe_init(&x->p, &r[number]);
    node_probe_init(&x->q, &x->p);
    x->number = number;
    x->at = w->root;
    x->top = x->stack;
}

/* What the next step reads. */
INLINE void fetch(const Wide *w, bool lean, Below at)
{
    if (is_node(at)) {
        const char *node = lean ? (const char *)&w->small[at] : (const char *)&w->fast[at];
        PREFETCH(node);
        PREFETCH(node + 64);
        if (!lean) {
            PREFETCH(node + 128);
            PREFETCH(node + 192);
        }
    } else if (!lean) {
        const char *block = (const char *)&w->blocks[leaf_place(at)];
        for (int k = 0; k < 5; k++)
            PREFETCH(block + 64 * k);
    } else if (w->order)
        PREFETCH(&w->order[leaf_place(at)]);
    else
        PREFETCH(&w->base.geo->tri[leaf_place(at)]);
}

/* One node or leaf. False: the walk is over. */
INLINE bool walk_step(Walk *x, const Wide *w, bool lean, bool any)
{
    Waiting next;

    if (is_node(x->at)) {
        F8 near;
        int bits = node_enter(w, lean, x->at, &x->q, x->h.t, &near);
        if (bits) {
            x->at = (Below)nearest_child(w, lean, x->at, bits, near, &x->top);
            fetch(w, lean, x->at);
            return true;
        }
    } else {
        leaf_meets(w, lean, x->at, x->p.ray, &x->p, &x->h, any, NULL);
        if (any && x->h.outer != NO_PRIM)
            return false;
    }
    do {
        if (x->top == x->stack)
            return false;
        next = *--x->top;
    } while (waiting_near(next) > x->h.t);
    x->at = (Below)next;
    fetch(w, lean, x->at);
    return true;
}

/* h is NULL where any hit will do. */
INLINE void many(const Wide *w, bool lean, bool any, const Ray *r, Hit *h, bool *hit, size_t n)
{
    Walk walk[FLIGHT], *flying[FLIGHT];
    size_t active = n < FLIGHT ? n : FLIGHT, next = active;

    for (size_t k = 0; k < active; k++) {
        flying[k] = &walk[k];
        walk_begin(flying[k], w, r, k);
    }
    while (active)
        for (size_t k = 0; k < active;) {
            Walk *x = flying[k];
            if (walk_step(x, w, lean, any)) {
                k++;
                continue;
            }
            hit[x->number] = x->h.outer != NO_PRIM;
            if (!any)
                h[x->number] = x->h;
            if (next < n)
                walk_begin(x, w, r, next++);
            else
                flying[k] = flying[--active];
        }
}

void wide_nearest_many(const Accel *a, const Ray *r, Hit *h, bool *hit, size_t n)
{
    const Wide *w = (const Wide *)a;

    if (a->leaves == 0)
        for (size_t i = 0; i < n; i++)
            hit[i] = hit_none(&h[i], r[i].tmax);
    else if (w->lean)
        many(w, true, false, r, h, hit, n);
    else
        many(w, false, false, r, h, hit, n);
}

void wide_blocked_many(const Accel *a, const Ray *r, bool *blocked, size_t n)
{
    const Wide *w = (const Wide *)a;

    if (a->leaves == 0)
        memset(blocked, 0, n * sizeof *blocked);
    else if (w->lean)
        many(w, true, true, r, NULL, blocked, n);
    else
        many(w, false, true, r, NULL, blocked, n);
}
