/* skip.h -- a binary tree of boxes without a stack: nodes in the order of a walk through all of
 * them, each with the place to go on at when its box is not met.
 *
 * Source  [Smits98], named in [Cline07 3.2.3]. */
#ifndef ACCEL_SKIP_H
#define ACCEL_SKIP_H

#include "accel/accel.h"
#include "accel/refs.h"

/* 32 bytes: the box, the first primitive in leaf order, and where to go on. */
typedef struct {
    float    lo[3];
    uint32_t first;             /* of a leaf; SKIP_INNER: no leaf */
    float    hi[3];
    uint32_t next;              /* inner: the node after all that is below; leaf: its primitives */
} SkipNode;
#define SKIP_INNER UINT32_MAX

typedef struct {
    const Accel *accel;         /* borrowed: whose tree it is */
    const SkipNode *nodes;      /* borrowed */
    const uint32_t *order;      /* borrowed; NULL: primitives are in leaf order as they are */
    size_t n;                   /* nodes; 0: nothing to meet */
} SkipTree;

/* Does the ray enter the node's box, not beyond tmax? The layout is that which slabs() wants. */
INLINE bool skip_enters(const SkipNode *n, const Probe *p, float tmax)
{
    float near, far;
    return slabs(p, n->lo, tmax, &near, &far);
}
INLINE Box skip_box(const SkipNode *n)
{
    return (Box){ v3(n->lo[0], n->lo[1], n->lo[2]), v3(n->hi[0], n->hi[1], n->hi[2]) };
}

/* A tree of leaves of one over n refs, divided by the middle object, and how many nodes it has: at
 * most 2 n - 1. refs are put into the order of the leaves: leaf.first counts in it. */
size_t skip_build(SkipNode *nodes, Ref *refs, uint32_t n);

/* What a walk does in a leaf that is met: sets *h; true: the walk may end. */
typedef bool SkipLeaf(const void *tree, const SkipNode *leaf, const Ray *r, const Probe *p, Hit *h,
                      bool any, Steps *steps);

/* From node to node, whatever is in the leaves of the tree. *h: as in accel.h, and any if that will
 * do. */
INLINE bool skip_walk(const SkipNode *nodes, size_t n, const void *tree, SkipLeaf *in_leaf,
                      const Ray *r, Hit *h, bool any, Steps *steps)
{
    Probe p;

    hit_none(h, r->tmax);
    probe_init(&p, r);
    for (size_t k = 0; k < n;) {
        const SkipNode *node = &nodes[k];
        bool leaf = node->first != SKIP_INNER;
        if (steps)
            steps->nodes++;
        if (!skip_enters(node, &p, h->t)) {
            k = leaf ? k + 1 : node->next;
            continue;
        }
        if (leaf && in_leaf(tree, node, r, &p, h, any, steps))
            return true;
        k++;
    }
    return h->outer != NO_PRIM;
}

/* The queries of accel.h. */
bool skip_nearest(const SkipTree *t, const Ray *r, Hit *h, Steps *steps);
bool skip_blocked(const SkipTree *t, const Ray *r, Steps *steps);

/* Each node's box holds what is below it, and each primitive is in one leaf. */
bool skip_validate(const SkipTree *t, char *why, size_t room);

#endif
