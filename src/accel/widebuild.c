/* widebuild.c -- the tree of `wide`: runs of primitives divided by the surface area heuristic until
 * a node has eight.
 *
 * Threads     The upper part is made by one thread; the runs of less than a sixteenth of all below
 *             it are parts by themselves, for any thread. What is a part does not depend on how
 *             many there are, and parts are put together in their order: so the tree is the same.
 * Leaf order  The leaves of a node come first in its run. So they follow each other, and sorting
 *             is all it takes: in the end the order of the refs is that of the leaves. */
#include "accel/wide.h"

#include "base/mem.h"
#include "base/work.h"

/* The lean form tests 2^2 triangles at a time, the fast one 2^3. */
enum { ENOUGH = 2, LEAN_GROUP = 2, FAST_GROUP = 3, PARTS = 16, PART_LEAST = 4096 };

/* Some refs, what they are like, and how deep. */
typedef struct { Extent extent; uint32_t first, count; int depth; } Run;

/* Some nodes of the tree, numbered from 0: that on top is the first. */
typedef struct {
    Run run;                            /* all that is below */
    Below at;                           /* where the first node goes in the upper part */
    void *nodes;                        /* owned; grows */
    TriangleBlock *blocks;              /* owned; grows */
    size_t nnodes, cap_nodes, nblocks, cap_blocks;
    uint64_t leaves;
    int   depth;
    bool  ok;
} Part;

typedef struct {
    Wide *wide;
    Ref  *refs;                         /* owned */
    Part  upper;
    Part *part;                         /* owned */
    size_t nparts, cap_parts;
    uint32_t part_most;                 /* refs of a run below the upper part */
} Build;

static size_t node_size(const Wide *w) { return w->lean ? sizeof(LeanNode) : sizeof(FastNode); }

/* A leaf takes triangles as they are and odd primitives one by one. */
static bool fits_leaf(const Build *b, const Run *r)
{
    if (r->count > LEAF)
        return false;
    for (uint32_t i = r->first; r->count > 1 && i < r->first + r->count; i++)
        if (!geometry_is_tri(b->wide->base.geo, b->refs[i].prim))
            return false;
    return true;
}

static void split_run(const Build *b, Run *r, Run *right)
{
    Ref *refs = b->refs + r->first;
    Extent half[2];
    uint32_t k, first = r->first, count = r->count;
    int shift = b->wide->lean ? LEAN_GROUP : FAST_GROUP;
    int depth = r->depth + 1;

    if (r->depth < REFS_DEPTH_SAH)
        k = (uint32_t)refs_split_sah(refs, count, &r->extent, 0, shift, half);
    else {
        k = (uint32_t)refs_split_median(refs, count, r->extent.centres);
        half[0] = refs_extent(refs, k);
        half[1] = refs_extent(refs + k, count - k);
    }
    *r = (Run){ half[0], first, k, depth };
    *right = (Run){ half[1], first + k, count - k, depth };
}

/* Divides the largest of the runs until there are eight. While there is room, runs are divided that
 * would fit a leaf: their boxes then keep rays away from most of what they would not hit, and to
 * look closely at a triangle costs more than to pass over a box. */
static int divide(const Build *b, Run run[WIDTH])
{
    int n = 1;

    while (n < WIDTH) {
        int at = -1;
        for (int k = 0; k < n; k++)
            if ((run[k].count > ENOUGH || !fits_leaf(b, &run[k])) &&
                (at < 0 || box_area(run[k].extent.box) > box_area(run[at].extent.box)))
                at = k;
        if (at < 0)
            break;
        split_run(b, &run[at], &run[n++]);
    }
    return n;
}

/* Sorts the runs by their places. */
static void sort_runs(Run run[WIDTH], int n)
{
    for (int i = 1; i < n; i++) {
        Run r = run[i];
        int k = i;
        for (; k > 0 && run[k - 1].first > r.first; k--)
            run[k] = run[k - 1];
        run[k] = r;
    }
}

/* Moves runs that become leaves before the others, and their refs with them. Returns how many. */
static int leaves_first(const Build *b, Run run[WIDTH], int n)
{
    Ref moved[WIDTH * LEAF];
    Run sorted[WIDTH];
    uint32_t nmoved = 0, at = run[0].first + run[0].count;
    int leaves = 0, inner = n;

    for (int k = 1; k < n; k++)
        at = run[k].first + run[k].count > at ? run[k].first + run[k].count : at;
    sort_runs(run, n);
    for (int k = n - 1; k >= 0; k--)
        if (fits_leaf(b, &run[k])) {
            memcpy(moved + nmoved, b->refs + run[k].first, run[k].count * sizeof *moved);
            nmoved += run[k].count;
        } else {
            at -= run[k].count;
            memmove(b->refs + at, b->refs + run[k].first, run[k].count * sizeof *moved);
            sorted[--inner] = run[k];
            sorted[inner].first = at;
            run[k].count = 0;                           /* said to be no leaf */
        }
    at -= nmoved;
    memcpy(b->refs + at, moved, nmoved * sizeof *moved);
    for (int k = n - 1; k >= 0; k--)
        if (run[k].count) {
            sorted[leaves] = run[k];
            sorted[leaves++].first = at;
            at += run[k].count;
        }
    memcpy(run, sorted, (size_t)n * sizeof *run);
    return leaves;
}

/* ---- nodes ---- */

/* The leaf of the fast form. */
static bool make_block(Build *b, Part *p, const Run *r, Below *below)
{
    uint32_t prims[LEAF];

    for (uint32_t i = 0; i < r->count; i++)
        prims[i] = b->refs[r->first + i].prim;
    if (!geometry_is_tri(b->wide->base.geo, prims[0])) {
        *below = BELOW_ODD | prims[0];
        return true;
    }
    if (!mem_grow(&p->blocks, &p->cap_blocks, p->nblocks + 1, sizeof *p->blocks))
        return false;
    *below = BELOW_LEAF | (r->count - 1) << LEAF_SHIFT | (Below)p->nblocks;
    triangle_block_init(&p->blocks[p->nblocks++], b->wide->base.geo, prims, (int)r->count);
    return true;
}

static bool make_fast(Build *b, Part *p, Below at, const Run run[WIDTH], int n, int leaves,
                      Below nodes)
{
    FastNode node;

    memset(&node, 0, sizeof node);
    node.present = (1u << n) - 1;
    for (int k = 0; k < n; k++) {
        Box box = run[k].extent.box;
        for (int axis = 0; axis < 3; axis++) {
            node.plane[0][axis][k] = v_axis(box.lo, axis);
            node.plane[1][axis][k] = v_axis(box.hi, axis);
        }
        node.child[k] = nodes + (Below)(k - leaves);
        if (k < leaves && !make_block(b, p, &run[k], &node.child[k]))
            return false;
    }
    ((FastNode *)p->nodes)[at] = node;
    return true;
}

/* Sets where planes are counted from: the last is outside for sure. An axis without an end gets
 * planes that are no numbers, by which no child is passed over. */
static void set_steps(LeanNode *n, Box b)
{
    for (int k = 0; k < 3; k++) {
        double extent = (double)v_axis(b.hi, k) - v_axis(b.lo, k);
        n->lo[k] = v_axis(b.lo, k);
        n->step[k] = (float)(extent / 255);
        while (is_finite(n->lo[k]) && is_finite(n->step[k]) &&
               lean_plane(n, k, 255) < v_axis(b.hi, k))
            n->step[k] = f_max(n->step[k] * (1.0f + ROUNDINGS(4)), n->step[k] + 0x1p-149f);
        if (!is_finite(n->lo[k]) || !is_finite(n->step[k])) {
            n->lo[k] = -INFINITY;
            n->step[k] = INFINITY;
        }
    }
}

/* The plane that is at x or near it. */
static int plane_near(const LeanNode *n, int axis, float x)
{
    double q = ((double)x - n->lo[axis]) / n->step[axis];
    return q >= 255 ? 255 : q > 0 ? (int)q : 0;
}

/* The largest plane not above x, or the least not below it. */
static unsigned char lower_plane(const LeanNode *n, int axis, float x)
{
    int at = plane_near(n, axis, x);

    while (at > 0 && lean_plane(n, axis, (unsigned char)at) > x)
        at--;
    return (unsigned char)at;
}
static unsigned char upper_plane(const LeanNode *n, int axis, float x)
{
    int at = plane_near(n, axis, x);

    while (at < 255 && lean_plane(n, axis, (unsigned char)at) < x)
        at++;
    return (unsigned char)at;
}

static void make_lean(Part *p, Below at, const Run run[WIDTH], int n, int leaves, Below nodes)
{
    LeanNode node;
    Box all = box_empty();
    uint32_t end = 0;

    for (int k = 0; k < n; k++)
        all = box_join(all, run[k].extent.box);
    memset(&node, 0, sizeof node);
    set_steps(&node, all);
    for (int k = 0; k < n; k++) {
        Box b = run[k].extent.box;
        for (int axis = 0; axis < 3; axis++) {
            node.plane[0][axis][k] = lower_plane(&node, axis, v_axis(b.lo, axis));
            node.plane[1][axis][k] = upper_plane(&node, axis, v_axis(b.hi, axis));
        }
        end += k < leaves ? run[k].count : 0;
        node.end[k + 1] = (unsigned char)end;
    }
    node.present = (unsigned char)((1u << n) - 1);
    node.leaves = (unsigned char)leaves;
    node.nodes = nodes;
    node.prims = leaves ? run[0].first : 0;
    ((LeanNode *)p->nodes)[at] = node;
}

static bool make_node(Build *b, Part *p, Below at, const Run *whole);

/* What is below the run becomes node `at` of the part, or a part by itself. */
static bool make_below(Build *b, Part *p, Below at, const Run *run)
{
    if (p != &b->upper || run->count > b->part_most)
        return make_node(b, p, at, run);
    if (!mem_grow(&b->part, &b->cap_parts, b->nparts + 1, sizeof *b->part))
        return false;
    memset((char *)p->nodes + at * node_size(b->wide), 0, node_size(b->wide));
    memset(&b->part[b->nparts], 0, sizeof *b->part);
    b->part[b->nparts].run = *run;
    b->part[b->nparts++].at = at;
    return true;
}

/* By recursion: no deeper than the tree. */
static bool make_node(Build *b, Part *p, Below at, const Run *whole)
{
    Run run[WIDTH];
    Below nodes = (Below)p->nnodes;
    int n, leaves;

    run[0] = *whole;
    n = divide(b, run);
    leaves = leaves_first(b, run, n);
    if (!mem_grow(&p->nodes, &p->cap_nodes, p->nnodes + (size_t)(n - leaves), node_size(b->wide)))
        return false;
    p->nnodes += (size_t)(n - leaves);
    if (b->wide->lean)
        make_lean(p, at, run, n, leaves, nodes);
    else if (!make_fast(b, p, at, run, n, leaves, nodes))
        return false;
    p->leaves += (uint64_t)leaves;
    for (int k = 0; k < leaves; k++)
        p->depth = run[k].depth > p->depth ? run[k].depth : p->depth;
    for (int k = leaves; k < n; k++)
        if (!make_below(b, p, nodes + (Below)(k - leaves), &run[k]))
            return false;
    return true;
}

/* The tree of a part; the first node is that on top. */
static bool make_part(Build *b, Part *p)
{
    if (!mem_grow(&p->nodes, &p->cap_nodes, 1, node_size(b->wide)))
        return false;
    p->nnodes = 1;
    return make_node(b, p, 0, &p->run);
}

static void make_part_number(void *ctx, uint64_t i, int worker)
{
    Build *b = ctx;
    (void)worker;
    b->part[i].ok = make_part(b, &b->part[i]);
}

static bool make_parts(Build *b, int threads)
{
    Work work = { b->nparts, make_part_number, NULL, b };

    if (work_run(&work, threads) != b->nparts)
        return false;
    for (size_t i = 0; i < b->nparts; i++)
        if (!b->part[i].ok)
            return false;
    return true;
}

/* ---- putting together ---- */

/* Node k of the part, whose second goes to `nodes` and whose first block to `blocks`. */
static void copy_node(const Wide *w, const Part *p, size_t k, size_t to, Below nodes, Below blocks)
{
    if (w->lean) {
        w->lean_nodes[to] = ((const LeanNode *)p->nodes)[k];
        w->lean_nodes[to].nodes += nodes;
        return;
    }
    w->fast_nodes[to] = ((const FastNode *)p->nodes)[k];
    for (int c = 0; c < WIDTH && w->fast_nodes[to].present >> c & 1; c++)
        if (!is_odd(w->fast_nodes[to].child[c]))
            w->fast_nodes[to].child[c] += is_node(w->fast_nodes[to].child[c]) ? nodes : blocks;
}

/* The part's nodes after the first, and its blocks, come next; the first goes to its place. */
static void append_part(Wide *w, Part *p)
{
    Below nodes = (Below)w->nnodes - 1, blocks = (Below)w->nblocks;

    for (size_t k = 1; k < p->nnodes; k++)
        copy_node(w, p, k, w->nnodes++, nodes, blocks);
    if (p->nnodes)
        copy_node(w, p, 0, p->at, nodes, blocks);
    if (p->nblocks)
        memcpy(w->blocks + blocks, p->blocks, p->nblocks * sizeof *p->blocks);
    w->nblocks += p->nblocks;
    w->base.leaves += p->leaves;
    w->base.depth = p->depth > w->base.depth ? p->depth : w->base.depth;
    mem_free(p->nodes);
    mem_free(p->blocks);
    p->nodes = NULL;
    p->blocks = NULL;
}

/* Moves nodes and blocks to memory of just their size, from the begin of a line of the cache on. */
static bool settle(Build *b)
{
    Wide *w = b->wide;
    size_t nodes = b->upper.nnodes, blocks = b->upper.nblocks, bytes;
    char *at;

    for (size_t i = 0; i < b->nparts; i++) {
        nodes += b->part[i].nnodes - 1;
        blocks += b->part[i].nblocks;
    }
    bytes = nodes * node_size(w) + blocks * sizeof(TriangleBlock);
    w->memory = mem_array(bytes + MEM_LINE - 1, 1);
    if (!w->memory)
        return false;
    at = mem_line(w->memory);
    w->lean_nodes = w->lean ? (LeanNode *)(void *)at : NULL;
    w->fast_nodes = w->lean ? NULL : (FastNode *)(void *)at;
    w->blocks = (TriangleBlock *)(void *)(at + nodes * node_size(w));
    w->nnodes = b->upper.nnodes ? 1 : 0;                /* a place for the first */
    append_part(w, &b->upper);
    for (size_t i = 0; i < b->nparts; i++)
        append_part(w, &b->part[i]);
    w->base.nodes = w->nnodes;
    w->base.bytes = sizeof *w + bytes +
                    (w->order ? geometry_prims(w->base.geo) * sizeof *w->order : 0);
    return true;
}

/* One leaf of all, or a node on top. */
static bool make_tree(Build *b, uint32_t n, int threads)
{
    Wide *w = b->wide;
    Part *p = &b->upper;

    p->run = (Run){ refs_extent(b->refs, n), 0, n, 0 };
    if (!fits_leaf(b, &p->run))
        return make_part(b, p) && make_parts(b, threads);
    p->leaves = 1;
    w->root = BELOW_LEAF | (n - 1) << LEAF_SHIFT;
    return w->lean || make_block(b, p, &p->run, &w->root);
}

static bool keep_order(Build *b, uint32_t n)
{
    Wide *w = b->wide;

    w->order = MEM_ARRAY(uint32_t, n);
    for (uint32_t i = 0; w->order && i < n; i++)
        w->order[i] = b->refs[i].prim;
    return w->order != NULL;
}

bool wide_build(Wide *w, const Geometry *g, int threads)
{
    uint32_t n = geometry_prims(g), share = n / PARTS;
    Build b;
    bool ok;

    memset(&b, 0, sizeof b);
    b.wide = w;
    b.part_most = share > PART_LEAST ? share : PART_LEAST;
    b.refs = MEM_ARRAY(Ref, n);
    ok = b.refs != NULL;
    if (ok) {
        refs_init(b.refs, g);
        ok = n == 0 || make_tree(&b, n, threads);
    }
    ok = ok && (!w->lean || keep_order(&b, n));
    mem_free(b.refs);
    ok = ok && settle(&b);
    mem_free(b.upper.nodes);
    mem_free(b.upper.blocks);
    for (size_t i = 0; i < b.nparts; i++) {
        mem_free(b.part[i].nodes);
        mem_free(b.part[i].blocks);
    }
    mem_free(b.part);
    return ok;
}
