/* forest.h -- complete trees without pointers: their shape, the order of triangles that it asks
 * for, and the level above. What the lightweight structures share.
 *
 * Source      [Cline07 3.3]; figs 3.1 and 3.4, eqs 3.1 and 3.2; eq. 3.3 corrected.
 * Shape       Nodes are counted as in a heap: the children of node q are arity q + 1 to arity q +
 *             arity. Leaves hold `leaf` triangles, which forest_arrange() has put into their order:
 *             nothing says which, it is reckoned. Of N = arity I + 1 nodes the first I are inner
 *             ones. From left to right come first the leaves of the deepest row, l_b to N - 1, then
 *             those of the row above, I to l_b - 1. So leaf j is the number j - l_b, or j - l_b + m
 *             if that is negative, of the m leaves. (Eq. 3.3 has m - 1 and another condition: wrong
 *             triangles.)
 * Two levels  Each mesh has its tree, and over these and the odd primitives stands one of skip.h. A
 *             mesh of more than `pieces` triangles has a tree for each such piece. */
#ifndef ACCEL_FOREST_H
#define ACCEL_FOREST_H

#include "accel/accel.h"
#include "accel/planes.h"
#include "accel/skip.h"

/* pieces: 0 for one tree a mesh. */
typedef struct { uint32_t arity, leaf, pieces; } Form;

typedef struct {
    Fractions box;                      /* of the whole tree */
    uint32_t first, count;              /* triangles */
    uint32_t inner, nodes, deepest;     /* I, N, l_b */
    size_t   planes;                    /* where those of its first siblings are, in bytes */
} Tree;

typedef struct {
    Accel    base;
    Form     form;
    int      bits;                      /* of a plane: 8 or 16 */
    Tree    *trees;                     /* owned */
    unsigned char *planes;              /* owned; eight lanes may be read from any node's */
    SkipNode *top;                      /* owned; over the trees and, after them, odd primitives */
    uint32_t *item;                     /* owned; in the order of top's leaves */
    size_t   ntrees, ntop, nplanes;     /* nplanes: in bytes */
} Forest;

/* The options of a form, for tables of options, and their values. */
#define FOREST_OPTIONS                                                                          \
    { .key = "arity", .type = OPT_INT, .num = 4, .lo = 2, .hi = SIBLINGS_MOST,                  \
      .help = "children a node" },                                                              \
    { .key = "leaf", .type = OPT_INT, .num = 4, .lo = 1, .hi = 64, .help = "triangles a leaf" }, \
    { .key = "pieces", .type = OPT_INT, .num = 0, .lo = 0, .hi = 1 << 30,                       \
      .help = "most triangles of a tree; 0: a mesh has one" }
Form forest_form(const Opts *o);

/* Nodes of the trees over a mesh of so many triangles. */
uint64_t forest_nodes(Form f, uint32_t count);

/* Puts the triangles of all meshes into the order of the leaves. False: memory ran out. */
bool forest_arrange(Geometry *g, Form f);

/* Trees with their boxes, memory for their planes, and the level above: all but the planes. NULL:
 * reported. */
Forest *forest_new(const Geometry *g, Form f, int bits, const char *name);
void forest_free(Accel *a);

/* Where node j > 0 has its planes. */
Sibling forest_node(const Forest *f, const Tree *t, uint32_t j);

/* The triangles of leaf j: *from .. *to, counted from the tree's first. Some leaves are empty.
 * [Cline07 (3.3)], corrected as the head says. */
INLINE void leaf_range(const Tree *t, uint32_t leaf, uint32_t j, uint32_t *from, uint32_t *to)
{
    uint32_t leaves = t->nodes - t->inner;
    uint64_t place = j >= t->deepest ? j - t->deepest : j - t->deepest + leaves;
    uint64_t begin = place * leaf, end = begin + leaf;

    *from = begin < t->count ? (uint32_t)begin : t->count;
    *to = end < t->count ? (uint32_t)end : t->count;
}

/* The triangles of leaf j against a ray. True: one was hit, and any will do. */
bool tree_leaf_hits(const Forest *f, const Tree *t, uint32_t j, const Probe *p, Hit *h, bool any,
                    Steps *steps);

/* The box of triangles first .. first + count. */
Box tree_box(const Geometry *g, uint32_t first, uint32_t count);

/* A walk through the level above. tree_hits: sets *h; true: the query may end, any hit will do. */
typedef bool TreeHits(const Forest *f, const Tree *t, const Probe *p, Hit *h, bool any,
                      Steps *steps);
bool forest_query(const Forest *f, const Ray *r, Hit *h, bool any, Steps *steps,
                  TreeHits *tree_hits);

/* All triangles are in leaves of trees, and all is within the boxes of `node_box`, of which that of
 * node 0 is the whole tree's. */
typedef Box NodeBox(const Forest *f, const Tree *t, uint32_t j);
bool forest_validate(const Forest *f, NodeBox *node_box, char *why, size_t room);

#endif
