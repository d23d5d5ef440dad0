/* skip.c -- queries of a tree that is walked without a stack. See skip.h.
 *
 * Order   That of the array, whatever the ray: half of the rays meet the far child first, and look
 *         into more boxes than they would with a stack. That is what a stack buys. */
#include "accel/skip.h"

#include "accel/prim.h"
#include "base/mem.h"

INLINE uint32_t prim_of(const SkipTree *t, uint32_t i) { return t->order ? t->order[i] : i; }

/* By recursion: halving ends soon. */
static size_t build_run(SkipNode *nodes, Ref *refs, uint32_t first, uint32_t n, size_t at)
{
    Extent e = refs_extent(refs + first, n);
    V3 lo = e.box.lo, hi = e.box.hi;
    size_t next = at + 1, k;

    nodes[at] = (SkipNode){ { lo.x, lo.y, lo.z }, first, { hi.x, hi.y, hi.z }, 1 };
    if (n == 1)
        return next;
    k = refs_split_median(refs + first, n, e.centres);
    next = build_run(nodes, refs, first, (uint32_t)k, next);
    next = build_run(nodes, refs, first + (uint32_t)k, n - (uint32_t)k, next);
    nodes[at].first = SKIP_INNER;
    nodes[at].next = (uint32_t)next;
    return next;
}

size_t skip_build(SkipNode *nodes, Ref *refs, uint32_t n)
{
    return n ? build_run(nodes, refs, 0, n, 0) : 0;
}

static bool leaf_meets(const void *tree, const SkipNode *leaf, const Ray *r, const Probe *p, Hit *h,
                       bool any, Steps *steps)
{
    const SkipTree *t = tree;

    for (uint32_t i = 0; i < leaf->next; i++) {
        if (steps)
            steps->prims++;
        if (prim_meets(t->accel, prim_of(t, leaf->first + i), r, p, h, any, steps) && any)
            return true;
    }
    return false;
}

bool skip_nearest(const SkipTree *t, const Ray *r, Hit *h, Steps *steps)
{
    return skip_walk(t->nodes, t->n, t, leaf_meets, r, h, false, steps);
}

bool skip_blocked(const SkipTree *t, const Ray *r, Steps *steps)
{
    Hit h;
    return skip_walk(t->nodes, t->n, t, leaf_meets, r, &h, true, steps);
}

/* ---- checking ---- */

static bool check_leaf(const SkipTree *t, size_t k, unsigned char *seen, char *why, size_t room)
{
    const SkipNode *n = &t->nodes[k];
    uint32_t prims = geometry_prims(t->accel->geo);

    if (n->next > prims || n->first > prims - n->next)
        return accel_bad(why, room, "a leaf of primitives that do not exist", k);
    for (uint32_t i = n->first; i < n->first + n->next; i++) {
        uint32_t prim = prim_of(t, i);
        if (prim >= prims || seen[prim]++)
            return accel_bad(why, room, "a primitive that does not exist or stands twice in", k);
        if (!box_holds(skip_box(n), geometry_box(t->accel->geo, prim)))
            return accel_bad(why, room, "a primitive sticks out of leaf", k);
    }
    return true;
}

/* What is below node k is k + 1 to next; the box of a node held by its parent's is held by all
 * above. */
bool skip_validate(const SkipTree *t, char *why, size_t room)
{
    unsigned char *seen = MEM_ARRAY(unsigned char, geometry_prims(t->accel->geo));
    uint32_t *above = MEM_ARRAY(uint32_t, t->n);        /* the branches that node k is in */
    size_t depth = 0;
    bool ok = seen && above;

    for (size_t k = 0; ok && k < t->n; k++) {
        const SkipNode *n = &t->nodes[k];
        while (depth && t->nodes[above[depth - 1]].next <= k)
            depth--;
        if (depth && !box_holds(skip_box(&t->nodes[above[depth - 1]]), skip_box(n)))
            ok = accel_bad(why, room, "a child's box sticks out of the node", above[depth - 1]);
        else if (n->first != SKIP_INNER)
            ok = check_leaf(t, k, seen, why, room);
        else if (n->next <= k + 1 || n->next > (depth ? t->nodes[above[depth - 1]].next : t->n))
            ok = accel_bad(why, room, "a branch that ends outside of its parent's", k);
        else
            above[depth++] = (uint32_t)k;
    }
    for (uint32_t i = 0; ok && i < geometry_prims(t->accel->geo); i++)
        if (!seen[i])
            ok = accel_bad(why, room, "no leaf holds the primitive", i);
    mem_free(seen);
    mem_free(above);
    return ok;
}
