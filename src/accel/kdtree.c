/* kdtree.c -- space divided by planes across the axes, two halves a node.
 *
 * Source      [Cline07 2.2.2, 3.2.3] the node of 8 bytes; [WaldHavran06] the surface area heuristic
 *             and the clipping of triangles to cells; mailboxes [Amanatides87].
 * Layout      A node has its plane and where the upper child is; the lower child is the next node.
 *             A leaf has a run of `entry`, which lists the primitives that are in its cell.
 * Split       Of the planes beside the boxes of the primitives that one is taken for which the sum
 *             over sides of area times primitives is least; cells with nothing in them are worth a
 *             fifth more. Cells of many primitives look at 32 planes an axis only.
 * No hit lost A primitive is in all cells that it touches but for `slack`, and a ray is in all
 *             those that line.h says it may be in: so no hit at the border of a cell is missed,
 *             however the plane is rounded. The first hit that is found is not the last word: the
 *             walk goes on until cells begin behind it. */
#include "accel/accel.h"
#include "accel/cells.h"
#include "accel/line.h"
#include "accel/prim.h"
#include "base/d3.h"
#include "base/mem.h"

#include <float.h>
#include <string.h>

/* PLANES: that are tried along an axis where there are more than FEW primitives. ENTRIES_MOST: of
 * lists, for each primitive; after that cells are divided no more. */
enum { PLANES = 32, FEW = 64, DEPTH_MOST = 64, ENTRIES_MOST = 12, NODES_MOST = 1 << 29 };

/* The kind is the axis of the plane, or LEAF. */
typedef struct {
    union { float plane; uint32_t first; } at;  /* first: of a leaf, in `entry` */
    uint32_t link;              /* kind + 4 * (inner: the upper child; leaf: its primitives) */
} Node;
typedef char node_has_8_bytes[sizeof(Node) == 8 ? 1 : -1];
enum { LEAF = 3 };

static int kind_of(const Node *n) { return (int)(n->link & 3); }
static uint32_t number_of(const Node *n) { return n->link >> 2; }

typedef struct {
    Accel  base;
    Box    box;                 /* of everything */
    double slack;
    Node  *nodes;               /* owned */
    uint32_t *entry;            /* owned */
    size_t nnodes, nentries, cap_nodes, cap_entries;
} KdTree;

/* ---- building ---- */

/* The part of a primitive that is in a cell. */
typedef struct { Box box; uint32_t prim; } Part;

typedef struct {
    KdTree *tree;
    double  visit;              /* what it costs to pass a node, in tests of primitives */
    uint32_t leaf;              /* cells with so few are not divided */
    int     depth;              /* the most that is sensible */
    size_t  entries_most;
    Part   *part;               /* owned; a stack of lists: a node's on top of its parent's */
    size_t  nparts, cap_parts;
} Build;

/* A plane and its cost; axis < 0: none is better than a leaf. */
typedef struct { int axis; float plane; double cost; } Choice;

static void axis_set(Box *b, bool upper, int axis, float x)
{
    float *p = upper ? &b->hi.x : &b->lo.x;
    p[axis] = x;
}

/* One axis of a cell whose planes are compared. The area of the part below a plane at x is in
 * proportion to across + around (x - lo), that of the whole being 1. */
typedef struct {
    int    axis;
    float  lo, hi;
    double from, to;            /* planes are between these */
    double across, around;
} Range;

/* Cells thinner than 4 slack are of no use: rays would have to look into their neighbours, too. */
static Range range_of(const KdTree *t, Box cell, int axis)
{
    int l = (axis + 1) % 3, m = (axis + 2) % 3;
    double x = (double)v_axis(cell.hi, l) - v_axis(cell.lo, l);
    double y = (double)v_axis(cell.hi, m) - v_axis(cell.lo, m);
    Range r = { axis, v_axis(cell.lo, axis), v_axis(cell.hi, axis), 0, 0, 0, 0 };
    double area = x * y + (x + y) * ((double)r.hi - r.lo);

    r.from = r.lo + 4 * t->slack;
    r.to = r.hi - 4 * t->slack;
    r.across = x * y / area;
    r.around = (x + y) / area;
    return r;
}

/* The cost of the plane with so many primitives below and above it. */
static void consider(const Build *b, const Range *r, float plane, size_t below, size_t above,
                     Choice *best)
{
    double lower = r->across + r->around * ((double)plane - r->lo);
    double upper = r->across + r->around * ((double)r->hi - plane);
    double cost = b->visit + lower * (double)below + upper * (double)above;

    if (below == 0 || above == 0)
        cost *= 0.8;
    if (plane > r->from && plane < r->to && cost < best->cost)
        *best = (Choice){ r->axis, plane, cost };
}

/* A primitive is below a plane if its part begins at most `slack` above it. The planes that are
 * tried stand off the ends of parts, so that what ends there is on one side only. Each part is
 * compared with all planes: while there are FEW, lanes side by side are done sooner than sorting,
 * which branches at random. */
static void consider_ends(const Build *b, const Range *r, const Part *part, size_t n,
                          Choice *best)
{
    float plane[2 * FEW], above[2 * FEW], below[2 * FEW], slack = (float)b->tree->slack;
    int32_t begun[2 * FEW] = { 0 }, ended[2 * FEW] = { 0 };     /* parts, before each plane */
    int planes = 2 * (int)n;

    for (size_t i = 0; i < n; i++) {
        plane[2 * i] = v_axis(part[i].box.lo, r->axis) - 2 * slack;
        plane[2 * i + 1] = v_axis(part[i].box.hi, r->axis) + 2 * slack;
    }
    for (int k = 0; k < planes; k++) {
        above[k] = plane[k] + slack;
        below[k] = plane[k] - slack;
    }
    for (size_t i = 0; i < n; i++) {
        float lo = v_axis(part[i].box.lo, r->axis), hi = v_axis(part[i].box.hi, r->axis);
        for (int k = 0; k < planes; k++) {
            begun[k] += lo <= above[k];
            ended[k] += hi < below[k];
        }
    }
    for (int k = 0; k < planes; k++)
        consider(b, r, plane[k], (size_t)begun[k], n - (size_t)ended[k], best);
}

/* The slice of a cell that holds x, of PLANES + 1. */
static int slice_of(float x, float from, float per)
{
    float i = (x - from) * per;
    return i >= PLANES ? PLANES : i > 0 ? (int)i : 0;
}

/* Planes at equal distances. */
static void consider_slices(const Build *b, const Range *r, const Part *part, size_t n,
                            Choice *best)
{
    float from = r->lo, step = (r->hi - from) / (PLANES + 1);
    size_t begin[PLANES + 1] = { 0 }, end[PLANES + 1] = { 0 }, below = 0, above = n;

    for (size_t i = 0; i < n; i++) {
        begin[slice_of(v_axis(part[i].box.lo, r->axis), from, 1 / step)]++;
        end[slice_of(v_axis(part[i].box.hi, r->axis), from, 1 / step)]++;
    }
    for (int i = 0; i < PLANES; i++) {
        below += begin[i];
        above -= end[i];
        consider(b, r, from + (float)(i + 1) * step, below, above, best);
    }
}

/* A convex polygon: four corners, and one more for each of two cuts. */
typedef struct { double p[6][3]; int n; } Polygon;

/* Keeps what lies below x on the axis (sign 1) or above it (-1). */
static void cut(Polygon *g, int axis, double x, double sign)
{
    Polygon out;

    out.n = 0;
    for (int i = 0; i < g->n; i++) {
        const double *a = g->p[i], *b = g->p[(i + 1) % g->n];
        double in_a = sign * (x - a[axis]), in_b = sign * (x - b[axis]);
        if (in_a >= 0 && out.n < 6)
            memcpy(out.p[out.n++], a, sizeof out.p[0]);
        if ((in_a >= 0) != (in_b >= 0) && out.n < 6) {
            double *p = out.p[out.n++], f = in_a / (in_a - in_b);
            for (int k = 0; k < 3; k++)
                p[k] = a[k] + f * (b[k] - a[k]);
            p[axis] = x;
        }
    }
    *g = out;
}

/* The plane of a triangle over the sides of a box that it faces. *axis is that which it stands
 * across most. False: it has no plane. */
static bool plane_over(const V3 c[3], Box b, Polygon *g, int *axis)
{
    D3 normal = d3_normal(c[0], c[1], c[2]);
    double n[3] = { normal.x, normal.y, normal.z }, most = 0;
    int l, m;

    for (int k = 0; k < 3; k++)
        if (fabs(n[k]) > most) {
            most = fabs(n[k]);
            *axis = k;
        }
    if (!(most > 0 && most < DBL_MAX))
        return false;
    l = (*axis + 1) % 3;
    m = (*axis + 2) % 3;
    g->n = 4;
    for (int i = 0; i < 4; i++) {
        double *p = g->p[i];
        p[l] = v_axis(i == 0 || i == 3 ? b.lo : b.hi, l);
        p[m] = v_axis(i < 2 ? b.lo : b.hi, m);
        p[*axis] = v_axis(c[0], *axis) - (n[l] * (p[l] - v_axis(c[0], l)) +
                                          n[m] * (p[m] - v_axis(c[0], m))) / n[*axis];
    }
    return true;
}

/* Makes the part's box that of what the cell has of it; false: nothing. Of a triangle that is what
 * its plane has within its box, not the triangle: of a ray that runs within the plane any point of
 * it in the box may be said to be met. A cell counts as `slack` larger, twice that for what is
 * rounded here. */
static bool part_in(const KdTree *t, Box cell, Part *part)
{
    float slack = 2 * (float)t->slack;
    Box all = geometry_box(t->base.geo, part->prim), in = box_empty();
    Polygon g;
    V3 c[3];
    int axis = 0;

    all.lo = v_max(all.lo, v_sub(cell.lo, v_all(slack)));
    all.hi = v_min(all.hi, v_add(cell.hi, v_all(slack)));
    if (box_is_empty(all))
        return false;
    part->box = all;
    if (!geometry_is_tri(t->base.geo, part->prim))
        return true;
    geometry_corners(t->base.geo, part->prim, c);
    if (!plane_over(c, all, &g, &axis))
        return true;
    cut(&g, axis, v_axis(all.hi, axis) + (double)slack, 1);
    cut(&g, axis, v_axis(all.lo, axis) - (double)slack, -1);
    for (int i = 0; i < g.n; i++)
        in = box_point(in, v3((float)g.p[i][0], (float)g.p[i][1], (float)g.p[i][2]));
    if (box_is_empty(in))
        return false;
    part->box.lo = v_max(in.lo, all.lo);
    part->box.hi = v_min(in.hi, all.hi);
    return true;
}

/* Puts the parts on one side of a plane, in their cell, on the stack. What the plane does not cut
 * has the box that it had. */
static bool push_parts(Build *b, size_t first, size_t n, Choice c, Box cell, bool upper)
{
    double slack = b->tree->slack;

    if (!mem_grow(&b->part, &b->cap_parts, b->nparts + n, sizeof *b->part))
        return false;
    for (size_t i = first; i < first + n; i++) {
        Part p = b->part[i];
        bool is_above = v_axis(p.box.hi, c.axis) >= c.plane - slack;
        bool is_below = v_axis(p.box.lo, c.axis) <= c.plane + slack;
        if ((upper ? is_above : is_below) &&
            (!(is_above && is_below) || part_in(b->tree, cell, &p)))
            b->part[b->nparts++] = p;
    }
    return true;
}

static Choice choose(const Build *b, const Part *part, size_t n, Box cell)
{
    Choice best = { -1, 0, (double)n };

    for (int axis = 0; axis < 3; axis++) {
        Range r = range_of(b->tree, cell, axis);
        if (n <= FEW)
            consider_ends(b, &r, part, n, &best);
        else
            consider_slices(b, &r, part, n, &best);
    }
    return best;
}

static bool make_leaf(Build *b, size_t at, const Part *part, size_t n, int depth)
{
    KdTree *t = b->tree;

    if (!mem_grow(&t->entry, &t->cap_entries, t->nentries + n, sizeof *t->entry))
        return false;
    t->nodes[at].at.first = (uint32_t)t->nentries;
    t->nodes[at].link = LEAF | (uint32_t)n << 2;
    for (size_t i = 0; i < n; i++)
        t->entry[t->nentries++] = part[i].prim;
    t->base.leaves++;
    t->base.depth = depth > t->base.depth ? depth : t->base.depth;
    return true;
}

/* The node of the parts from `first` to the top of the stack, and all below it. By recursion: no
 * deeper than the tree. */
static bool make_node(Build *b, size_t first, Box cell, int depth)
{
    KdTree *t = b->tree;
    size_t at = t->nnodes, n = b->nparts - first, upper = b->nparts, lower;
    Box lower_cell = cell, upper_cell = cell;
    Choice c = { -1, 0, 0 };

    if (!mem_grow(&t->nodes, &t->cap_nodes, at + 1, sizeof *t->nodes))
        return false;
    t->nnodes++;
    if (n > b->leaf && depth < b->depth && t->nentries + n < b->entries_most &&
        t->nnodes < NODES_MOST)
        c = choose(b, b->part + first, n, cell);
    if (c.axis < 0)
        return make_leaf(b, at, b->part + first, n, depth);
    axis_set(&lower_cell, true, c.axis, c.plane);
    axis_set(&upper_cell, false, c.axis, c.plane);
    if (!push_parts(b, first, n, c, upper_cell, true))
        return false;
    lower = b->nparts;
    if (!push_parts(b, first, n, c, lower_cell, false) ||
        !make_node(b, lower, lower_cell, depth + 1))
        return false;
    b->nparts = lower;
    t->nodes[at].at.plane = c.plane;
    t->nodes[at].link = (uint32_t)c.axis | (uint32_t)t->nnodes << 2;
    if (!make_node(b, upper, upper_cell, depth + 1))
        return false;
    b->nparts = upper;
    return true;
}

static void drop(Accel *a)
{
    KdTree *t = (KdTree *)a;
    mem_free(t->nodes);
    mem_free(t->entry);
    mem_free(t);
}

/* Memory of just their size. */
static bool settle(KdTree *t)
{
    Node *nodes = MEM_ARRAY(Node, t->nnodes);
    uint32_t *entry = MEM_ARRAY(uint32_t, t->nentries);

    if (!nodes || !entry) {
        mem_free(nodes);
        mem_free(entry);
        return false;
    }
    memcpy(nodes, t->nodes, t->nnodes * sizeof *nodes);
    if (t->nentries)
        memcpy(entry, t->entry, t->nentries * sizeof *entry);
    mem_free(t->nodes);
    mem_free(t->entry);
    t->nodes = nodes;
    t->entry = entry;
    t->base.nodes = t->nnodes;
    t->base.refs = t->nentries;
    t->base.bytes = sizeof *t + t->nnodes * sizeof *nodes + t->nentries * sizeof *entry;
    return true;
}

/* [WaldHavran06 4.1]: 8 + 1.3 log2 n. */
static int sensible_depth(size_t n)
{
    int bits = 0;
    while (n >> bits)
        bits++;
    return 8 + 13 * bits / 10 < DEPTH_MOST ? 8 + 13 * bits / 10 : DEPTH_MOST;
}

/* All primitives on the stack, the box and the slack of them. */
static bool begin(Build *b, const Geometry *g, uint32_t n)
{
    KdTree *t = b->tree;

    if (!mem_grow(&b->part, &b->cap_parts, n, sizeof *b->part))
        return false;
    t->box = box_empty();
    for (uint32_t i = 0; i < n; i++) {
        b->part[b->nparts++] = (Part){ geometry_box(g, i), i };
        t->box = box_join(t->box, b->part[i].box);
    }
    t->slack = line_slack(t->box);
    return true;
}

static Accel *build(const Geometry *g, const Opts *o, int threads)
{
    uint32_t n = geometry_prims(g);
    KdTree *t = MEM_NEW(KdTree);
    Build b = { t, (double)opt_float(o, "visit"), (uint32_t)opt_int(o, "leaf"), sensible_depth(n),
                ENTRIES_MOST * (size_t)n, NULL, 0, 0 };
    bool ok;

    (void)threads;
    if (!t)
        return NULL;
    t->base.geo = g;
    if (n == 0)
        return &t->base;
    ok = accel_counts("kdtree", n, 25) &&       /* nodes and entries are counted in 30 bits */
         begin(&b, g, n) && make_node(&b, 0, t->box, 0) && settle(t);
    mem_free(b.part);
    if (!ok) {
        drop(&t->base);
        return NULL;
    }
    return &t->base;
}

/* ---- queries ---- */

/* A branch that waits, and the part of the ray that may be in it. */
typedef struct { double near, far; uint32_t node; } Waiting;

/* Which children the ray may be in between near and far: the first to go on with is returned and,
 * unless there is one only, the other waits. */
INLINE uint32_t next_node(const KdTree *t, uint32_t at, const Line *l, double *near, double *far,
                          Waiting **top)
{
    const Node *n = &t->nodes[at];
    int axis = kind_of(n);
    double plane = n->at.plane, d = l->d[axis];
    double a = l->o[axis] + *near * d, b = l->o[axis] + *far * d;
    double m = d_max(line_margin(l, axis, *near), line_margin(l, axis, *far));
    uint32_t lower = at + 1, upper = number_of(n);
    double meet, doubt;

    if (a > plane + m && b > plane + m)
        return upper;
    if (a < plane - m && b < plane - m)
        return lower;
    *(*top) = (Waiting){ *near, *far, d > 0 ? upper : lower };
    if (d != 0) {
        meet = (plane - l->o[axis]) / d;
        doubt = line_doubt(l, axis, meet);
        (*top)->near = d_max(*near, meet - doubt);
        *far = d_min(*far, meet + doubt);
    }
    ++*top;
    return d > 0 ? lower : upper;
}

/* A leaf's primitives that were not tested in another one. True: the query may end. */
INLINE bool leaf_meets(const KdTree *t, const Node *leaf, Mailbox *tested, const Ray *r,
                       const Probe *p, Hit *h, bool any, Steps *steps)
{
    for (uint32_t i = leaf->at.first; i < leaf->at.first + number_of(leaf); i++) {
        uint32_t prim = t->entry[i];
        if (!mailbox_takes(tested, prim))
            continue;
        if (steps)
            steps->prims++;
        if (prim_meets(&t->base, prim, r, p, h, any, steps) && any)
            return true;
    }
    return false;
}

static bool query(const KdTree *t, const Ray *r, Hit *h, bool any, Steps *steps)
{
    Waiting stack[DEPTH_MOST + 1], *top = stack;
    float enter, leave;
    double near, far;
    uint32_t at = 0;
    Mailbox tested;
    bool follows;
    Probe p;
    Line l;

    hit_none(h, r->tmax);
    if (t->nnodes == 0)
        return false;
    probe_init(&p, r);
    mailbox_init(&tested);
    follows = line_init(&l, r, t->slack);
    if (!box_slabs(&p, t->box, r->tmax, &enter, &leave))
        return false;
    near = enter;
    far = d_min(d_min(leave, r->tmax), FLT_MAX);
    for (;;) {
        const Node *n = &t->nodes[at];
        if (steps)
            steps->nodes++;
        if (kind_of(n) != LEAF && follows) {
            at = next_node(t, at, &l, &near, &far, &top);
            continue;
        }
        if (kind_of(n) != LEAF) {       /* no part of space may be passed over */
            *top++ = (Waiting){ near, far, number_of(n) };
            at++;
            continue;
        }
        if (leaf_meets(t, n, &tested, r, &p, h, any, steps))
            return true;
        do {
            if (top == stack)
                return h->outer != NO_PRIM;
            top--;
        } while (follows && top->near > h->t);
        at = top->node;
        near = top->near;
        far = d_min(top->far, h->t);
    }
}

static bool nearest(const Accel *a, const Ray *r, Hit *h, Steps *steps)
{
    return query((const KdTree *)a, r, h, false, steps);
}

static bool blocked(const Accel *a, const Ray *r, Steps *steps)
{
    Hit h;
    return query((const KdTree *)a, r, &h, true, steps);
}

/* ---- checking ---- */

/* Is the primitive in the leaf of the point? Points on a plane are in both. */
static bool listed_below(const KdTree *t, uint32_t at, uint32_t prim, const double p[3])
{
    const Node *n = &t->nodes[at];

    if (kind_of(n) == LEAF)
        return list_holds(t->entry + n->at.first, number_of(n), prim);
    return (p[kind_of(n)] > n->at.plane || listed_below(t, at + 1, prim, p)) &&
           (p[kind_of(n)] < n->at.plane || listed_below(t, number_of(n), prim, p));
}

static bool listed(const Accel *a, uint32_t prim, const double p[3])
{
    const KdTree *t = (const KdTree *)a;
    return t->nnodes && listed_below(t, 0, prim, p);
}

static bool check_nodes(const KdTree *t, char *why, size_t room)
{
    for (size_t i = 0; i < t->nnodes; i++) {
        const Node *n = &t->nodes[i];
        if (kind_of(n) != LEAF && (number_of(n) <= i + 1 || number_of(n) >= t->nnodes))
            return accel_bad(why, room, "a child out of range", i);
        if (kind_of(n) == LEAF && ((size_t)n->at.first + number_of(n) > t->nentries ||
                                   !list_ascends(t->entry + n->at.first, number_of(n))))
            return accel_bad(why, room, "a leaf out of range, or its list does not ascend", i);
    }
    for (size_t i = 0; i < t->nentries; i++)
        if (t->entry[i] >= geometry_prims(t->base.geo))
            return accel_bad(why, room, "a primitive that does not exist", i);
    return true;
}

static bool validate(const Accel *a, char *why, size_t room)
{
    const KdTree *t = (const KdTree *)a;
    return check_nodes(t, why, room) && cells_validate(a, t->box, listed, why, room);
}

static const OptDef options[] = {
    { .key = "visit", .type = OPT_FLOAT, .num = 1, .lo = 0, .hi = 100, .also = "traversalcost",
      .help = "what it costs to pass a node, in tests of primitives" },
    { .key = "leaf", .type = OPT_INT, .num = 2, .lo = 1, .hi = 64, .also = "maxprims",
      .help = "cells with so few primitives are not divided" },
    { .key = NULL }
};

const AccelKind accel_kdtree = {
    .info = { "kdtree", "Cline07 2.2.2, 3.2.3; WaldHavran06",
              "space divided by planes, 8 bytes a node", options },
    .build = build, .nearest = nearest, .blocked = blocked, .validate = validate, .free = drop
};
