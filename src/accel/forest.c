/* forest.c -- complete trees without pointers. See forest.h. */
#include "accel/forest.h"

#include "accel/prim.h"
#include "accel/refs.h"
#include "base/mem.h"

#include <string.h>

/* ---- the shape of a tree ---- */

Form forest_form(const Opts *o)
{
    return (Form){ (uint32_t)opt_int(o, "arity"), (uint32_t)opt_int(o, "leaf"),
                   (uint32_t)opt_int(o, "pieces") };
}

/* A tree over so many triangles. */
static Tree tree_of(Form f, uint32_t first, uint32_t count)
{
    Tree t;
    uint32_t leaves = (uint32_t)(((uint64_t)count + f.leaf - 1) / f.leaf);

    memset(&t, 0, sizeof t);
    t.first = first;
    t.count = count;
    t.inner = leaves > 1 ? (leaves - 2) / (f.arity - 1) + 1 : 0;
    t.nodes = f.arity * t.inner + 1;
    for (uint64_t row = 0; row < t.nodes; row = f.arity * row + 1)
        t.deepest = (uint32_t)row;
    return t;
}

/* Rows of nodes below the root. */
static int rows_of(Form f, const Tree *t)
{
    int rows = 0;
    for (uint64_t j = 0; j < t->inner; j = f.arity * j + 1)
        rows++;
    return rows;
}

/* How many pieces a mesh of `count` triangles is divided into. */
static uint32_t pieces_of(Form f, uint32_t count)
{
    return f.pieces ? (uint32_t)(((uint64_t)count + f.pieces - 1) / f.pieces) : 1;
}

/* Where piece i of the n begins. */
static uint32_t piece_begin(uint32_t count, uint32_t n, uint32_t i)
{
    return (uint32_t)((uint64_t)count * i / n);
}

uint64_t forest_nodes(Form f, uint32_t count)
{
    uint32_t n = pieces_of(f, count);
    uint64_t nodes = 0;

    for (uint32_t i = 0; i < n; i++)
        nodes += tree_of(f, 0, piece_begin(count, n, i + 1) - piece_begin(count, n, i)).nodes;
    return nodes;
}

/* The triangles of any node: from its leftmost to its rightmost leaf. */
static void node_range(const Tree *t, Form f, uint32_t j, uint32_t *from, uint32_t *to)
{
    uint32_t left = j, right = j, unused;

    while (left < t->inner)
        left = f.arity * left + 1;
    while (right < t->inner)
        right = f.arity * right + f.arity;
    leaf_range(t, f.leaf, left, from, &unused);
    leaf_range(t, f.leaf, right, &unused, to);
}

/* ---- arranging ---- */

/* Sorts the refs of the siblings from..to and of all below them; refs are those of the whole tree.
 * The siblings are halved, and their primitives with them, until each has its own. [Cline07 fig.
 * 3.1, step 5] */
static void arrange_siblings(const Tree *t, Form f, Ref *refs, uint32_t from, uint32_t to)
{
    uint32_t begin, middle, end, unused, half = from + (to - from) / 2;

    if (from == to) {
        if (from < t->inner)
            arrange_siblings(t, f, refs, f.arity * from + 1, f.arity * from + f.arity);
        return;
    }
    node_range(t, f, from, &begin, &unused);
    node_range(t, f, half, &unused, &middle);
    node_range(t, f, to, &unused, &end);
    if (begin < middle && middle < end) {
        Extent e = refs_extent(refs + begin, end - begin);
        refs_divide(refs + begin, end - begin, middle - begin, e.centres);
    }
    arrange_siblings(t, f, refs, from, half);
    arrange_siblings(t, f, refs, half + 1, to);
}

/* Sorts the refs of pieces from..to of the n, then those of each. */
static void arrange_pieces(Form f, Ref *refs, uint32_t count, uint32_t n, uint32_t from,
                           uint32_t to)
{
    uint32_t begin = piece_begin(count, n, from), end = piece_begin(count, n, to + 1), middle;
    Extent e;

    if (from == to) {
        Tree t = tree_of(f, 0, end - begin);
        if (t.inner)
            arrange_siblings(&t, f, refs + begin, 1, f.arity);
        return;
    }
    middle = piece_begin(count, n, from + (to - from) / 2 + 1);
    e = refs_extent(refs + begin, end - begin);
    refs_divide(refs + begin, end - begin, middle - begin, e.centres);
    arrange_pieces(f, refs, count, n, from, from + (to - from) / 2);
    arrange_pieces(f, refs, count, n, from + (to - from) / 2 + 1, to);
}

static bool arrange_mesh(Geometry *g, Form f, size_t shape)
{
    uint32_t first = g->shapes[shape].first, n = g->shapes[shape].count;
    Ref *refs = MEM_ARRAY(Ref, n);
    uint32_t *order = MEM_ARRAY(uint32_t, n);
    bool ok = refs && order;

    for (uint32_t i = 0; ok && i < n; i++)
        refs[i] = (Ref){ geometry_box(g, first + i), i };
    if (ok)
        arrange_pieces(f, refs, n, pieces_of(f, n), 0, pieces_of(f, n) - 1);
    for (uint32_t i = 0; ok && i < n; i++)
        order[i] = refs[i].prim;
    mem_free(refs);
    ok = ok && geometry_arrange(g, shape, order);
    mem_free(order);
    return ok;
}

bool forest_arrange(Geometry *g, Form f)
{
    for (size_t s = 0; s < g->nshapes; s++)
        if (g->shapes[s].kind == SHAPE_MESH && g->shapes[s].count && !arrange_mesh(g, f, s))
            return false;
    return true;
}

/* ---- boxes ---- */

Sibling forest_node(const Forest *f, const Tree *t, uint32_t j)
{
    uint32_t n = f->form.arity;
    size_t group = (j - 1) / n * siblings_bytes(n, f->bits);

    return (Sibling){ f->planes + t->planes + group, n, (j - 1) % n, f->bits };
}

Box tree_box(const Geometry *g, uint32_t first, uint32_t count)
{
    Box b = box_empty();
    for (uint32_t i = first; i < first + count; i++)
        b = box_join(b, geometry_box(g, i));
    return b;
}

/* ---- building ---- */

/* The next tree, over `count` triangles; its box goes to refs. */
static void add_tree(Forest *f, Ref *refs, uint32_t first, uint32_t count)
{
    Tree *t = &f->trees[f->ntrees];
    Box b = tree_box(f->base.geo, first, count);
    int rows;

    *t = tree_of(f->form, first, count);
    if (!fractions_init(&t->box, b, planes_range(f->bits))) {
        t->inner = 0;                                   /* one leaf of all */
        t->nodes = 1;
    }
    rows = rows_of(f->form, t);
    t->planes = f->nplanes;
    f->nplanes += t->inner * siblings_bytes(f->form.arity, f->bits);
    f->base.nodes += t->nodes;
    f->base.leaves += t->nodes - t->inner;
    f->base.depth = rows > f->base.depth ? rows : f->base.depth;
    refs[f->ntrees] = (Ref){ b, (uint32_t)f->ntrees };
    f->ntrees++;
}

/* The trees of all meshes; their boxes go to refs. */
static void lay_out(Forest *f, Ref *refs)
{
    const Geometry *g = f->base.geo;

    for (size_t m = 0; m < g->nmeshes; m++) {
        const Shape *s = &g->shapes[g->mesh_shapes[m]];
        uint32_t n = pieces_of(f->form, s->count);
        for (uint32_t i = 0; i < n; i++) {
            uint32_t begin = piece_begin(s->count, n, i), end = piece_begin(s->count, n, i + 1);
            add_tree(f, refs, s->first + begin, end - begin);
        }
    }
}

static size_t count_trees(const Geometry *g, Form f)
{
    size_t n = 0;
    for (size_t m = 0; m < g->nmeshes; m++)
        n += pieces_of(f, g->shapes[g->mesh_shapes[m]].count);
    return n;
}

/* The level above: trees, then odd primitives. */
static bool build_top(Forest *f, Ref *refs)
{
    const Geometry *g = f->base.geo;
    size_t n = f->ntrees + g->nodd;

    for (size_t i = 0; i < g->nodd; i++)
        refs[f->ntrees + i] = (Ref){ geometry_box(g, (uint32_t)(g->ntris + i)),
                                     (uint32_t)(f->ntrees + i) };
    f->top = MEM_ARRAY(SkipNode, n ? 2 * n - 1 : 0);
    f->item = MEM_ARRAY(uint32_t, n);
    if (!f->top || !f->item)
        return false;
    f->ntop = skip_build(f->top, refs, (uint32_t)n);
    for (size_t i = 0; i < n; i++)
        f->item[i] = refs[i].prim;
    f->base.nodes += f->ntop;
    f->base.leaves += g->nodd;
    return true;
}

Forest *forest_new(const Geometry *g, Form form, int bits, const char *name)
{
    size_t trees = count_trees(g, form);
    Forest *f = MEM_NEW(Forest);
    Ref *refs = MEM_ARRAY(Ref, trees + g->nodd);
    bool ok = f && refs && accel_counts(name, geometry_prims(g), 31);

    if (ok) {
        f->base.geo = g;
        f->form = form;
        f->bits = bits;
        f->trees = MEM_ARRAY(Tree, trees);
        ok = f->trees != NULL;
    }
    if (ok) {
        lay_out(f, refs);
        f->planes = MEM_ARRAY(unsigned char, f->nplanes + SIBLINGS_PAD);
        ok = f->planes && build_top(f, refs);
    }
    mem_free(refs);
    if (!ok) {
        if (f)
            forest_free(&f->base);
        return NULL;
    }
    f->base.bytes = sizeof *f + f->ntrees * sizeof *f->trees + f->nplanes + SIBLINGS_PAD +
                    f->ntop * sizeof *f->top + (f->ntrees + g->nodd) * sizeof *f->item;
    return f;
}

void forest_free(Accel *a)
{
    Forest *f = (Forest *)a;
    mem_free(f->trees);
    mem_free(f->planes);
    mem_free(f->top);
    mem_free(f->item);
    mem_free(f);
}

/* ---- queries ---- */

bool tree_leaf_hits(const Forest *f, const Tree *t, uint32_t j, const Probe *p, Hit *h, bool any,
                    Steps *steps)
{
    uint32_t from = 0, to = t->count;

    if (t->inner)
        leaf_range(t, f->form.leaf, j, &from, &to);
    for (uint32_t i = from; i < to; i++) {
        if (steps)
            steps->prims++;
        if (triangle_nearest(f->base.geo, t->first + i, p, h) && any)
            return true;
    }
    return false;
}

/* The forest, and how a ray is cast against one of its trees. */
typedef struct { const Forest *forest; TreeHits *tree_hits; } TopWalk;

static bool item_hits(const void *walk, const SkipNode *leaf, const Ray *r, const Probe *p, Hit *h,
                      bool any, Steps *steps)
{
    const TopWalk *w = walk;
    const Forest *f = w->forest;
    uint32_t item = f->item[leaf->first];

    if (item < f->ntrees)
        return w->tree_hits(f, &f->trees[item], p, h, any, steps);
    if (steps)
        steps->prims++;
    return prim_meets(&f->base, (uint32_t)(f->base.geo->ntris + item - f->ntrees), r, p, h, any,
                      steps) && any;
}

bool forest_query(const Forest *f, const Ray *r, Hit *h, bool any, Steps *steps,
                  TreeHits *tree_hits)
{
    TopWalk w = { f, tree_hits };
    return skip_walk(f->top, f->ntop, &w, item_hits, r, h, any, steps);
}

/* ---- checking ---- */

/* Children within node j; an empty one is within any. */
static bool check_inner(const Forest *f, const Tree *t, uint32_t j, NodeBox *node_box, char *why,
                        size_t room)
{
    Box b = node_box(f, t, j);

    for (uint32_t c = f->form.arity * j + 1; c <= f->form.arity * j + f->form.arity; c++) {
        Box child = node_box(f, t, c);
        if (!box_is_empty(child) && !box_holds(b, child))
            return accel_bad(why, room, "a child's box sticks out of node", j);
    }
    return true;
}

static bool check_tree(const Forest *f, const Tree *t, uint32_t *next, NodeBox *node_box, char *why,
                       size_t room)
{
    uint32_t sum = 0, from, to;

    if (t->first != *next || t->first + (size_t)t->count > f->base.geo->ntris)
        return accel_bad(why, room, "triangles that no tree holds", *next);
    *next += t->count;
    for (uint32_t j = 0; t->inner && j < t->nodes; j++) {
        Box b = node_box(f, t, j);
        if (j < t->inner) {
            if (!check_inner(f, t, j, node_box, why, room))
                return false;
            continue;
        }
        leaf_range(t, f->form.leaf, j, &from, &to);
        sum += to - from;
        for (uint32_t i = from; i < to; i++)
            if (!box_holds(b, geometry_box(f->base.geo, t->first + i)))
                return accel_bad(why, room, "a triangle sticks out of leaf", j);
    }
    if (t->inner && sum != t->count)
        return accel_bad(why, room, "leaves do not hold all triangles of the tree that begins",
                         t->first);
    return true;
}

/* The boxes of trees and odd primitives are within those of the level above. */
static bool check_item(const Forest *f, const SkipNode *n, char *why, size_t room)
{
    const Geometry *g = f->base.geo;
    uint32_t item = f->item[n->first];
    Box b = item < f->ntrees ? tree_box(g, f->trees[item].first, f->trees[item].count)
                             : geometry_box(g, (uint32_t)(g->ntris + item - f->ntrees));

    return box_holds(skip_box(n), b) || accel_bad(why, room, "a tree sticks out of its box", item);
}

bool forest_validate(const Forest *f, NodeBox *node_box, char *why, size_t room)
{
    uint32_t next = 0;
    size_t items = 0;

    for (size_t i = 0; i < f->ntrees; i++)
        if (!check_tree(f, &f->trees[i], &next, node_box, why, room))
            return false;
    if (next != f->base.geo->ntris)
        return accel_bad(why, room, "triangles that no tree holds", next);
    for (size_t k = 0; k < f->ntop; k++)
        if (f->top[k].first != SKIP_INNER) {
            items++;
            if (!check_item(f, &f->top[k], why, room))
                return false;
        }
    return items == f->ntrees + f->base.geo->nodd ||
           accel_bad(why, room, "items missing, have", items);
}
