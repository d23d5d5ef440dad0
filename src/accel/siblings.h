/* siblings.h -- the walk through a complete tree of forest.h: a ray against the boxes of all
 * children of a node at once, one lane a child.
 *
 * Planes      Plane q is base + q step. For planes that are fractions of the tree's box (lbvh)
 *             these are the tree's. If they are nested, fractions of the parent's box as decoded
 *             (hlbvh), they are made anew in each node, see hlbvh.c.
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

/* Sides: 0 is the one that the ray meets first, 1 the other. */
typedef struct {
    F8 o[3], inv[3];
    F8 base[2][3], step[2][3];
    size_t row[2][3];                   /* where in a group of siblings the planes are, in bytes */
} Siblings;

/* Decoded planes of siblings, by side and axis. */
typedef union { float plane[2][3][FOREST_ARITY_MOST]; F8 align; } Decoded;

/* A tree of 2^31 leaves has 31 rows below its root if binary, and fewer if of larger arity, where
 * at most 7 wait in each. */
enum { TREE_ROWS = 32, TREE_STACK = 96 };

/* The root's box is decoded as that of child 0 of row 0. */
INLINE void siblings_init(Siblings *s, const Forest *f, const Tree *t, const Probe *p,
                          Decoded *root, bool nested)
{
    const float *o = &p->ray->o.x, *inv = &p->inv.x;
    size_t row = f->form.arity * ((size_t)f->bits / 8);

    for (int k = 0; k < 3; k++) {
        int down = inv[k] < 0.0f;
        s->o[k] = f8_all(o[k]);
        s->inv[k] = f8_all(inv[k]);
        for (int side = 0; side < 2; side++) {
            s->row[side][k] = (size_t)(3 * (side ^ down) + k) * row;
            s->base[side][k] = f8_all(t->lo[k]);
            s->step[side][k] = f8_all(t->step[k]);
        }
        if (nested) {
            root->plane[down][k][0] = t->lo[k];
            root->plane[!down][k][0] = plane_at(t->lo[k], t->step[k], forest_range(f));
        }
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

/* Eight planes decoded, of which `arity` are of use. */
INLINE F8 planes_load(const Siblings *s, const unsigned char *group, int side, int axis, int bits)
{
    const unsigned char *p = group + s->row[side][axis];
    F8 whole = bits == 8 ? f8_load_u8(p) : f8_load_u16((const uint16_t *)(const void *)p);
    return f8_add(s->base[side][axis], f8_mul(whole, s->step[side][axis]));
}

/* Bit k: the ray enters child k before it leaves it and not beyond tmax; near[k] says where. The
 * arithmetic on decoded planes is that of slabs() in geometry/ray.h. `keep` gets them; or NULL. */
INLINE int siblings_enter(const Siblings *s, const unsigned char *group, uint32_t arity, int bits,
                          float tmax, float near[FOREST_ARITY_MOST], Decoded *keep)
{
    F8 enter = f8_all(0.0f), leave = f8_all(INFINITY);

    for (int k = 0; k < 3; k++) {
        F8 a = planes_load(s, group, 0, k, bits), b = planes_load(s, group, 1, k, bits);
        enter = f8_max(f8_mul(f8_sub(a, s->o[k]), s->inv[k]), enter);
        leave = f8_min(f8_mul(f8_sub(b, s->o[k]), s->inv[k]), leave);
        if (keep) {
            f8_store(keep->plane[0][k], a);
            f8_store(keep->plane[1][k], b);
        }
    }
    f8_store(near, enter);
    return f8_at_most(enter, f8_mul(leave, f8_all(SLAB_WIDEN))) &
           f8_at_most(enter, f8_all(tmax)) & ((1 << arity) - 1);
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
    size_t group = 6 * arity * ((size_t)bits / 8);
    uint32_t at = 0, place = 0;
    Siblings s;

    siblings_init(&s, f, t, p, rows, nested);
    for (;;) {
        if (steps)
            steps->nodes++;
        if (at < t->inner) {
            Decoded *row = nested ? &rows[place >> 3] : NULL;
            float near[FOREST_ARITY_MOST];
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
