/* lbvh.c -- lightweight bounding volumes: complete trees without a pointer, in small whole numbers.
 *
 * Source      [Cline07 3.3, 3.4.2]; figs 3.1 and 3.4, eqs 3.1 and 3.2; eq. 3.3 corrected.
 * Layout      Nodes are counted as in a heap: the children of node q are arity q + 1 to arity q +
 *             arity. The planes of siblings stand side by side, so that one test does for all; the
 *             root's are those of the tree's box. A plane is a whole number of 16 or 8 bits, a
 *             fraction of that box. Leaves hold `leaf` triangles, which arrange() has put into
 *             their order: nothing says which, it is reckoned.
 * Leaves      Of N = arity I + 1 nodes the first I are inner ones. From left to right come first
 *             the leaves of the deepest row, l_b to N - 1, then those of the row above, I to
 *             l_b - 1. So leaf j is the number j - l_b, or j - l_b + m if that is negative, of the
 *             m leaves. (Eq. 3.3 has m - 1 and another condition: wrong triangles.)
 * Rounding    Planes are rounded outwards, so that the box as decoded, in float, holds those of the
 *             triangles: validate() checks. Rays stay in world space and meet decoded planes; with
 *             [Cline07]'s ray in the space of the fractions its roundings would need bounds.
 * Two levels  Each mesh has its tree, and over these and the odd primitives stands one of skip.h. A
 *             mesh of more than `pieces` triangles has a tree for each such piece: a box divided by
 *             255 is coarse for a large mesh. */
#include "accel/accel.h"
#include "accel/prim.h"
#include "accel/refs.h"
#include "accel/skip.h"
#include "base/mem.h"
#include "base/simd.h"

#include <stdio.h>
#include <string.h>

enum { ARITY_MOST = 8, PAD = 32 };      /* PAD: eight lanes are read where there may be fewer */

typedef struct {
    float    lo[3], step[3];            /* plane q of an axis is lo + q step */
    uint32_t first, count;              /* triangles */
    uint32_t inner, nodes, deepest;     /* I, N, l_b */
    size_t   planes;                    /* where those of its first siblings are, in bytes */
} Tree;

typedef struct {
    Accel    base;
    Tree    *trees;                     /* owned */
    unsigned char *planes;              /* owned */
    SkipNode *top;                      /* owned; over the trees and, after them, odd primitives */
    uint32_t *item;                     /* owned; in the order of top's leaves */
    size_t   ntrees, ntop, nplanes;     /* nplanes: in bytes */
    uint32_t arity, leaf;
    int      bits;
} Lbvh;

/* ---- the shape of a tree ---- */

typedef struct { uint32_t arity, leaf, pieces; int bits; } Form;

static Form form_of(const Opts *o)
{
    return (Form){ (uint32_t)opt_int(o, "arity"), (uint32_t)opt_int(o, "leaf"),
                   (uint32_t)opt_int(o, "pieces"), opt_is(o, "bits", "8") ? 8 : 16 };
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

/* Bounds of piece i of the n that a mesh of `count` triangles is divided into. */
static uint32_t pieces_of(Form f, uint32_t count)
{
    return f.pieces ? (uint32_t)(((uint64_t)count + f.pieces - 1) / f.pieces) : 1;
}
static uint32_t piece_begin(uint32_t count, uint32_t n, uint32_t i)
{
    return (uint32_t)((uint64_t)count * i / n);
}

/* The triangles of leaf j: *from .. *to, counted from the tree's first. */
INLINE void leaf_range(const Tree *t, uint32_t leaf, uint32_t j, uint32_t *from, uint32_t *to)
{
    uint32_t leaves = t->nodes - t->inner;
    uint64_t place = j >= t->deepest ? j - t->deepest : j - t->deepest + leaves;
    uint64_t begin = place * leaf, end = begin + leaf;

    *from = begin < t->count ? (uint32_t)begin : t->count;      /* some leaves may be empty */
    *to = end < t->count ? (uint32_t)end : t->count;
}

/* The same of any node: from its leftmost to its rightmost leaf. */
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
    Box box, centres;

    if (from == to) {
        if (from < t->inner)
            arrange_siblings(t, f, refs, f.arity * from + 1, f.arity * from + f.arity);
        return;
    }
    node_range(t, f, from, &begin, &unused);
    node_range(t, f, half, &unused, &middle);
    node_range(t, f, to, &unused, &end);
    if (begin < middle && middle < end) {
        refs_bounds(refs + begin, end - begin, &box, &centres);
        refs_divide(refs + begin, end - begin, middle - begin, centres);
    }
    arrange_siblings(t, f, refs, from, half);
    arrange_siblings(t, f, refs, half + 1, to);
}

/* Sorts the refs of pieces from..to of the n, then those of each. */
static void arrange_pieces(Form f, Ref *refs, uint32_t count, uint32_t n, uint32_t from,
                           uint32_t to)
{
    uint32_t begin = piece_begin(count, n, from), end = piece_begin(count, n, to + 1), middle;
    Box box, centres;

    if (from == to) {
        Tree t = tree_of(f, 0, end - begin);
        if (t.inner)
            arrange_siblings(&t, f, refs + begin, 1, f.arity);
        return;
    }
    middle = piece_begin(count, n, from + (to - from) / 2 + 1);
    refs_bounds(refs + begin, end - begin, &box, &centres);
    refs_divide(refs + begin, end - begin, middle - begin, centres);
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

static bool arrange(Geometry *g, const Opts *o)
{
    for (size_t s = 0; s < g->nshapes; s++)
        if (g->shapes[s].kind == SHAPE_MESH && g->shapes[s].count &&
            !arrange_mesh(g, form_of(o), s))
            return false;
    return true;
}

/* ---- building ---- */

static float decode(const Tree *t, int axis, uint32_t q)
{
    return t->lo[axis] + (float)q * t->step[axis];
}

/* How many of the planes 0 .. range are below x or, if so wanted, equal to it. */
static uint32_t planes_below(const Tree *t, int axis, float x, uint32_t range, bool equal)
{
    uint32_t lo = 0, hi = range + 1;

    while (lo < hi) {
        uint32_t mid = (lo + hi) / 2;
        float plane = decode(t, axis, mid);
        if (plane < x || (equal && plane == x))
            lo = mid + 1;
        else
            hi = mid;
    }
    return lo;
}

/* The largest plane not above x, or the least not below it. Both exist for x in the tree's box. */
static uint32_t encode(const Tree *t, int axis, float x, uint32_t range, bool upper)
{
    return upper ? planes_below(t, axis, x, range, false)
                 : planes_below(t, axis, x, range, true) - 1;
}

static uint32_t range_of(const Lbvh *l) { return l->bits == 8 ? 255 : 65535; }

/* Where plane `side` of an axis of node j > 0 stands; in bytes. */
static size_t plane_at(const Lbvh *l, const Tree *t, uint32_t j, int side, int axis)
{
    size_t group = (j - 1) / l->arity, k = (j - 1) % l->arity;
    return t->planes + ((group * 6 + (size_t)side * 3 + (size_t)axis) * l->arity + k) *
                           ((size_t)l->bits / 8);
}

static uint32_t plane_get(const Lbvh *l, size_t at)
{
    uint16_t q;

    if (l->bits == 8)
        return l->planes[at];
    memcpy(&q, l->planes + at, 2);
    return q;
}

static void plane_set(Lbvh *l, size_t at, uint32_t q)
{
    uint16_t wide = (uint16_t)q;

    if (l->bits == 8)
        l->planes[at] = (unsigned char)q;
    else
        memcpy(l->planes + at, &wide, 2);
}

/* The box of a tree, and its steps: a little larger than that needs, so that the last plane is
 * outside for sure (eq. 3.2 takes one from the range for that). False: a box without an end, which
 * cannot be divided. */
static bool set_box(const Lbvh *l, Tree *t, Box b)
{
    for (int k = 0; k < 3; k++) {
        double extent = (double)v_axis(b.hi, k) - v_axis(b.lo, k);
        t->lo[k] = v_axis(b.lo, k);
        t->step[k] = (float)(extent / (range_of(l) - 1));
        while (is_finite(t->lo[k]) && is_finite(t->step[k]) &&
               decode(t, k, range_of(l)) < v_axis(b.hi, k))
            t->step[k] = f_max(t->step[k] * 1.01f, 0x1p-120f);  /* no denormal number grows */
        if (!is_finite(t->lo[k]) || !is_finite(t->step[k]))
            return false;
    }
    return true;
}

static Box tree_box(const Geometry *g, uint32_t first, uint32_t count)
{
    Box b = box_empty();
    for (uint32_t i = first; i < first + count; i++)
        b = box_join(b, geometry_box(g, i));
    return b;
}

/* Node j from its triangles. An empty one gets planes that no ray is between. */
static void encode_leaf(Lbvh *l, const Tree *t, uint32_t j)
{
    uint32_t from, to, range = range_of(l);
    Box b;

    leaf_range(t, l->leaf, j, &from, &to);
    b = tree_box(l->base.geo, t->first + from, to - from);
    for (int k = 0; k < 3; k++) {
        plane_set(l, plane_at(l, t, j, 0, k),
                  from < to ? encode(t, k, v_axis(b.lo, k), range, false) : range);
        plane_set(l, plane_at(l, t, j, 1, k),
                  from < to ? encode(t, k, v_axis(b.hi, k), range, true) : 0);
    }
}

/* The same from its children: what is rounded outwards stays in order. */
static void join_children(Lbvh *l, const Tree *t, uint32_t j)
{
    for (int k = 0; k < 3; k++) {
        uint32_t lo = range_of(l), hi = 0;
        for (uint32_t c = l->arity * j + 1; c <= l->arity * j + l->arity; c++) {
            uint32_t a = plane_get(l, plane_at(l, t, c, 0, k));
            uint32_t b = plane_get(l, plane_at(l, t, c, 1, k));
            lo = a < lo ? a : lo;
            hi = b > hi ? b : hi;
        }
        plane_set(l, plane_at(l, t, j, 0, k), lo);
        plane_set(l, plane_at(l, t, j, 1, k), hi);
    }
}

/* Lays out the trees of all meshes; their boxes go to refs. */
static void lay_out(Lbvh *l, Form f, Ref *refs)
{
    const Geometry *g = l->base.geo;

    for (size_t m = 0; m < g->nmeshes; m++) {
        const Shape *s = &g->shapes[g->mesh_shapes[m]];
        uint32_t n = pieces_of(f, s->count);
        for (uint32_t i = 0; i < n; i++) {
            uint32_t begin = piece_begin(s->count, n, i), end = piece_begin(s->count, n, i + 1);
            Tree *t = &l->trees[l->ntrees];
            Box b = tree_box(g, s->first + begin, end - begin);
            *t = tree_of(f, s->first + begin, end - begin);
            if (!set_box(l, t, b))
                t->inner = 0;                           /* one leaf of all */
            t->nodes = l->arity * t->inner + 1;
            t->planes = l->nplanes;
            l->nplanes += (size_t)(t->nodes - 1) * 6 * ((size_t)l->bits / 8);
            l->base.nodes += t->nodes;
            l->base.leaves += t->nodes - t->inner;
            refs[l->ntrees] = (Ref){ b, (uint32_t)l->ntrees };
            l->ntrees++;
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
static bool build_top(Lbvh *l, Ref *refs)
{
    const Geometry *g = l->base.geo;
    size_t n = l->ntrees + g->nodd;

    for (size_t i = 0; i < g->nodd; i++)
        refs[l->ntrees + i] = (Ref){ geometry_box(g, (uint32_t)(g->ntris + i)),
                                     (uint32_t)(l->ntrees + i) };
    l->top = MEM_ARRAY(SkipNode, n ? 2 * n - 1 : 0);
    l->item = MEM_ARRAY(uint32_t, n);
    if (!l->top || !l->item)
        return false;
    l->ntop = skip_build(l->top, refs, (uint32_t)n);
    for (size_t i = 0; i < n; i++)
        l->item[i] = refs[i].prim;
    l->base.nodes += l->ntop;
    l->base.leaves += g->nodd;
    return true;
}

static void drop(Accel *a)
{
    Lbvh *l = (Lbvh *)a;
    mem_free(l->trees);
    mem_free(l->planes);
    mem_free(l->top);
    mem_free(l->item);
    mem_free(l);
}

static Accel *build(const Geometry *g, const Opts *o, int threads)
{
    Form f = form_of(o);
    Lbvh *l = MEM_NEW(Lbvh);
    size_t trees = count_trees(g, f);
    Ref *refs = MEM_ARRAY(Ref, trees + g->nodd);
    bool ok = l && refs;

    (void)threads;
    if (ok) {
        l->base.geo = g;
        l->arity = f.arity;
        l->leaf = f.leaf;
        l->bits = f.bits;
        l->trees = MEM_ARRAY(Tree, trees);
        ok = l->trees != NULL;
    }
    if (ok) {
        lay_out(l, f, refs);
        l->planes = MEM_ARRAY(unsigned char, l->nplanes + PAD);
        ok = l->planes && build_top(l, refs);
    }
    mem_free(refs);
    if (!ok) {
        if (l)
            drop(&l->base);
        return NULL;
    }
    for (size_t i = 0; i < l->ntrees; i++)
        for (uint32_t j = l->trees[i].nodes - 1; j > 0; j--) {
            if (j >= l->trees[i].inner)
                encode_leaf(l, &l->trees[i], j);
            else
                join_children(l, &l->trees[i], j);
        }
    l->base.depth = 0;
    l->base.bytes = sizeof *l + l->ntrees * sizeof *l->trees + l->nplanes + PAD +
                    l->ntop * sizeof *l->top + (l->ntrees + g->nodd) * sizeof *l->item;
    return &l->base;
}

/* ---- queries ---- */

typedef struct {
    F8  o[3], inv[3], lo[3], step[3];
    int near[3];                        /* 0 or 1: the side that is met first */
} TreeProbe;

INLINE void tree_probe_init(TreeProbe *q, const Probe *p, const Tree *t)
{
    const float *o = &p->ray->o.x, *inv = &p->inv.x;

    for (int k = 0; k < 3; k++) {
        q->o[k] = f8_all(o[k]);
        q->inv[k] = f8_all(inv[k]);
        q->lo[k] = f8_all(t->lo[k]);
        q->step[k] = f8_all(t->step[k]);
        q->near[k] = inv[k] < 0.0f;
    }
}

/* Eight planes decoded, of which `arity` are of use. */
INLINE F8 planes_load(const TreeProbe *q, const unsigned char *p, int axis, int bits)
{
    F8 whole = bits == 8 ? f8_load_u8(p) : f8_load_u16((const uint16_t *)(const void *)p);
    return f8_add(q->lo[axis], f8_mul(whole, q->step[axis]));
}

/* Bit k: the ray enters child k before it leaves it and not beyond tmax; near[k] says where. The
 * arithmetic on decoded planes is that of slabs() in geometry/ray.h. */
INLINE int siblings_enter(const TreeProbe *q, const unsigned char *group, uint32_t arity, int bits,
                          float tmax, float near[ARITY_MOST])
{
    F8 enter = f8_all(0.0f), leave = f8_all(INFINITY);
    size_t row = arity * ((size_t)bits / 8);

    for (int k = 0; k < 3; k++) {
        F8 a = planes_load(q, group + (size_t)(3 * q->near[k] + k) * row, k, bits);
        F8 b = planes_load(q, group + (size_t)(3 * !q->near[k] + k) * row, k, bits);
        enter = f8_max(f8_mul(f8_sub(a, q->o[k]), q->inv[k]), enter);
        leave = f8_min(f8_mul(f8_sub(b, q->o[k]), q->inv[k]), leave);
    }
    f8_store(near, enter);
    return f8_at_most(enter, f8_mul(leave, f8_all(SLAB_WIDEN))) &
           f8_at_most(enter, f8_all(tmax)) & ((1 << arity) - 1);
}

typedef struct { float near; uint32_t node; } Waiting;

/* A binary tree of 2^32 leaves has 32 rows; of larger arity fewer, and at most 7 wait in each. */
enum { STACK = 96 };

/* Triangles of leaf j. True: one was hit, and any will do. */
INLINE bool leaf_hits(const Lbvh *l, const Tree *t, uint32_t j, const Probe *p, Hit *h, bool any,
                      Steps *steps)
{
    uint32_t from = 0, to = t->count;

    if (t->inner)
        leaf_range(t, l->leaf, j, &from, &to);
    for (uint32_t i = from; i < to; i++) {
        if (steps)
            steps->prims++;
        if (triangle_nearest(l->base.geo, t->first + i, p, h) && any)
            return true;
    }
    return false;
}

/* True: the query may end. Of the children that are met the nearest is next. */
INLINE bool tree_hits(const Lbvh *l, const Tree *t, const Probe *p, Hit *h, bool any, Steps *steps,
                      int bits)
{
    Waiting stack[STACK], *top = stack;
    const unsigned char *planes = l->planes + t->planes;
    size_t group = 6 * l->arity * ((size_t)bits / 8);
    uint32_t at = 0;
    TreeProbe q;

    tree_probe_init(&q, p, t);
    for (;;) {
        if (steps)
            steps->nodes++;
        if (at < t->inner) {
            float near[ARITY_MOST];
            int hits = siblings_enter(&q, planes + at * group, l->arity, bits, h->t, near), k;
            if (hits) {
                Waiting next;
                k = LOWEST_BIT(hits);
                next = (Waiting){ near[k], l->arity * at + 1 + (uint32_t)k };
                while ((hits &= hits - 1) != 0) {
                    Waiting other;
                    k = LOWEST_BIT(hits);
                    other = (Waiting){ near[k], l->arity * at + 1 + (uint32_t)k };
                    *top++ = other.near < next.near ? next : other;
                    next = other.near < next.near ? other : next;
                }
                at = next.node;
                continue;
            }
        } else if (leaf_hits(l, t, at, p, h, any, steps))
            return true;
        do {
            if (top == stack)
                return false;
            top--;
        } while (top->near > h->t);
        at = top->node;
    }
}

INLINE bool query(const Lbvh *l, const Ray *r, Hit *h, bool any, Steps *steps, int bits)
{
    const Geometry *g = l->base.geo;
    Probe p;

    hit_none(h, r->tmax);
    probe_init(&p, r);
    for (size_t k = 0; k < l->ntop;) {
        const SkipNode *n = &l->top[k];
        bool leaf = n->first != SKIP_INNER;
        uint32_t item;
        if (steps)
            steps->nodes++;
        if (!skip_enters(n, &p, h->t)) {
            k = leaf ? k + 1 : n->next;
            continue;
        }
        k++;
        if (!leaf)
            continue;
        item = l->item[n->first];
        if (item < l->ntrees) {
            if (tree_hits(l, &l->trees[item], &p, h, any, steps, bits))
                return true;
        } else {
            if (steps)
                steps->prims++;
            if (odd_nearest(g, (uint32_t)(g->ntris + item - l->ntrees), r, &p, h, steps) && any)
                return true;
        }
    }
    return h->outer != NO_PRIM;
}

static bool nearest(const Accel *a, const Ray *r, Hit *h, Steps *steps)
{
    const Lbvh *l = (const Lbvh *)a;
    return l->bits == 8 ? query(l, r, h, false, steps, 8) : query(l, r, h, false, steps, 16);
}

static bool blocked(const Accel *a, const Ray *r, Steps *steps)
{
    const Lbvh *l = (const Lbvh *)a;
    Hit h;
    return l->bits == 8 ? query(l, r, &h, true, steps, 8) : query(l, r, &h, true, steps, 16);
}

/* ---- checking ---- */

static bool bad(char *why, size_t room, const char *what, size_t where)
{
    snprintf(why, room, "%s at %lu", what, (unsigned long)where);
    return false;
}

/* The box of node j as a ray sees it. */
static Box node_box(const Lbvh *l, const Tree *t, uint32_t j)
{
    float p[2][3];

    for (int side = 0; side < 2; side++)
        for (int k = 0; k < 3; k++)
            p[side][k] = decode(t, k, j ? plane_get(l, plane_at(l, t, j, side, k))
                                        : side ? range_of(l) : 0);
    return (Box){ v3(p[0][0], p[0][1], p[0][2]), v3(p[1][0], p[1][1], p[1][2]) };
}

static bool check_tree(const Lbvh *l, const Tree *t, uint32_t *next, char *why, size_t room)
{
    uint32_t leaves = t->nodes - t->inner, sum = 0;

    if (t->first != *next)
        return bad(why, room, "triangles that no tree holds", *next);
    *next += t->count;
    for (uint32_t j = 1; t->inner && j < t->nodes; j++) {
        Box b = node_box(l, t, j);
        uint32_t from, to;
        if (j < t->inner || t->inner == 0) {
            for (uint32_t c = l->arity * j + 1; c <= l->arity * j + l->arity; c++)
                if (!box_is_empty(node_box(l, t, c)) && !box_holds(b, node_box(l, t, c)))
                    return bad(why, room, "a child's box sticks out of node", j);
            continue;
        }
        leaf_range(t, l->leaf, j, &from, &to);
        sum += to - from;
        for (uint32_t i = from; i < to; i++)
            if (!box_holds(b, geometry_box(l->base.geo, t->first + i)))
                return bad(why, room, "a triangle sticks out of leaf", j);
    }
    if (t->inner && (sum != t->count || (uint64_t)leaves * l->leaf < t->count))
        return bad(why, room, "leaves do not hold all triangles of the tree that begins", t->first);
    return true;
}

/* The boxes of trees and odd primitives are those of the level above. */
static bool check_item(const Lbvh *l, const SkipNode *n, char *why, size_t room)
{
    const Geometry *g = l->base.geo;
    uint32_t item = l->item[n->first];
    Box b = item < l->ntrees ? tree_box(g, l->trees[item].first, l->trees[item].count)
                             : geometry_box(g, (uint32_t)(g->ntris + item - l->ntrees));

    return box_holds(skip_box(n), b) || bad(why, room, "a tree sticks out of its box", item);
}

static bool validate(const Accel *a, char *why, size_t room)
{
    const Lbvh *l = (const Lbvh *)a;
    uint32_t next = 0;
    size_t items = 0;

    for (size_t i = 0; i < l->ntrees; i++)
        if (l->trees[i].first + (size_t)l->trees[i].count > a->geo->ntris ||
            !check_tree(l, &l->trees[i], &next, why, room))
            return bad(why, room, "a tree of other triangles", i);
    if (next != a->geo->ntris)
        return bad(why, room, "triangles that no tree holds", next);
    for (size_t k = 0; k < l->ntop; k++)
        if (l->top[k].first != SKIP_INNER) {
            items++;
            if (!check_item(l, &l->top[k], why, room))
                return false;
        }
    return items == l->ntrees + a->geo->nodd || bad(why, room, "items missing, have", items);
}

static const OptDef options[] = {
    { .key = "bits", .type = OPT_CHOICE, .str = "16", .choices = "16 8",
      .help = "of a plane: 12 or 6 bytes a node" },
    { .key = "arity", .type = OPT_INT, .num = 4, .lo = 2, .hi = 8, .help = "children a node" },
    { .key = "leaf", .type = OPT_INT, .num = 4, .lo = 1, .hi = 64, .help = "triangles a leaf" },
    { .key = "pieces", .type = OPT_INT, .num = 0, .lo = 0, .hi = 1 << 30,
      .help = "most triangles of a tree; 0: a mesh has one" },
    { .key = NULL }
};

const AccelKind accel_lbvh = {
    .info = { "lbvh", "Cline07 3.3", "complete trees without pointers, planes of 16 or 8 bits",
              options },
    .arrange = arrange, .build = build, .nearest = nearest, .blocked = blocked,
    .validate = validate, .free = drop
};
