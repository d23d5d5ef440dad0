/* siblings.h -- the walk through a complete tree of forest.h: a ray against the boxes of all
 * children of a node at once, one lane a child.
 *
 * Planes      See planes.h. Nested ones (hlbvh) are fractions of the parent's box as decoded.
 * Rows        Boxes decoded in a row of the tree are kept until another node of the row above is
 *             entered. None is while children of the last one wait: so the boxes of all that wait
 *             are at hand, one set of siblings a row, and the stack only says which is whose.
 * Order       Of the children that are met the nearest is next. */
#ifndef ACCEL_SIBLINGS_H
#define ACCEL_SIBLINGS_H

#include "accel/forest.h"
#include "accel/waiting.h"
#include "base/simd.h"

/* The extent of a box times this is the step of planes nested in it. */
#define NESTED_STEP (1.0f / 256)

/* A tree of 2^31 leaves has 31 rows below its root if binary, and fewer if of larger arity, where
 * at most 7 wait in each. */
enum { TREE_ROWS = 32, TREE_STACK = 96 };

/* The root's box, as that of child 0 of row 0. */
INLINE void decode_root(Decoded *root, const Forest *f, const Tree *t, const Probe *p)
{
    const float *inv = &p->inv.x;

    for (int k = 0; k < 3; k++) {
        int down = inv[k] < 0.0f;
        root->plane[down][k][0] = t->box.lo[k];
        root->plane[!down][k][0] = plane_at(t->box.lo[k], t->box.step[k], planes_range(f->bits));
    }
}

/* Base and step for the children of child k of those that were decoded. Planes count inwards from
 * either side; with both signs turned, floats round alike. */
INLINE void siblings_within(Siblings *s, const Decoded *d, uint32_t k)
{
    for (int axis = 0; axis < 3; axis++) {
        F8 a = f8_all(d->plane[0][axis][k]), b = f8_all(d->plane[1][axis][k]);
        s->base[0][axis] = a;
        s->base[1][axis] = b;
        s->step[0][axis] = f8_mul(f8_sub(b, a), f8_all(NESTED_STEP));
        s->step[1][axis] = f8_sub(f8_all(-0.0f), s->step[0][axis]);
    }
}

/* A TreeHits. bits, nested and whether there are steps are constants where this is called. */
INLINE bool tree_walk(const Forest *f, const Tree *t, const Probe *p, Hit *h, bool any,
                      Steps *steps, int bits, bool nested)
{
    Waiting stack[TREE_STACK], *top = stack, next;
    unsigned char places[TREE_STACK];           /* of those: 8 row + child */
    Decoded rows[TREE_ROWS];
    const unsigned char *planes = f->planes + t->planes;
    const uint32_t arity = f->form.arity;
    size_t group = siblings_bytes(arity, bits);
    uint32_t at = 0, place = 0;
    Siblings s;

    siblings_init(&s, &t->box, arity, bits, p);
    if (nested)
        decode_root(rows, f, t, p);
    for (;;) {
        if (steps)
            steps->nodes++;
        if (at < t->inner) {
            Decoded *row = nested ? &rows[place >> 3] : NULL;
            float near[SIBLINGS_MOST];
            uint32_t first = arity * at + 1, below = (place >> 3) * 8 + 8;
            int hits;

            if (nested)
                siblings_within(&s, row, place & 7);
            hits = siblings_enter(&s, planes + at * group, arity, bits, h->t, near,
                                  nested ? row + 1 : NULL);
            if (hits) {
                int k = LOWEST_BIT(hits);
                next = waiting(near[k], first + (uint32_t)k);
                while ((hits &= hits - 1) != 0) {
                    Waiting other, later;
                    k = LOWEST_BIT(hits);
                    other = waiting(near[k], first + (uint32_t)k);
                    later = other > next ? other : next;
                    next = other > next ? next : other;
                    if (nested)
                        places[top - stack] = (unsigned char)(below + (uint32_t)later - first);
                    *top++ = later;
                }
                at = (uint32_t)next;
                place = below + at - first;
                continue;
            }
        } else if (tree_leaf_hits(f, t, at, p, h, any, steps))
            return true;
        do {
            if (top == stack)
                return false;
            next = *--top;
        } while (waiting_near(next) > h->t);
        at = (uint32_t)next;
        if (nested)
            place = places[top - stack];
    }
}

#endif
