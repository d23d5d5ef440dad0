/* wide.c -- a tree of up to eight children a node.
 *
 * Source      [Wald08] wide nodes from a binary surface area build, tested in lanes side by side;
 *             [Ylitie17] planes in bytes relative to the node.
 * Layout      A node has the planes of its children's boxes, one lane a child, so that one test
 *             does for all. A leaf is up to eight triangles, or one odd primitive. Two forms:
 *             lean  a plane is a byte, a fraction of the node's box, rounded outwards: 92 bytes a
 *                   node. Triangles stay in the mesh, in leaf order if it is the only one of the
 *                   geometry; else a list says which they are. 4 to 6 bytes a triangle,
 *                   and 4 for the list.
 *             fast  planes as they are, 256 bytes a node, and leaves with copies of their
 *                   triangles, one lane each. 100 to 130 bytes a triangle.
 *             auto takes fast for what is small enough to stay in a cache.
 * Invariants  The box of a child holds the boxes of all primitives below it: validate() checks.
 *             Below REFS_DEPTH_SAH runs are halved, so depth and stack are bounded whatever the
 *             input.
 * Order       Of the children that are met the nearest is next and the others wait with their
 *             entries, unsorted: they are dropped when a hit lies before them. */
#include "accel/wide.h"

#include "base/mem.h"

#define PLANE_ORDER(x, y, z)                                                                     \
    { { 3 * WIDTH * (x),       WIDTH + 3 * WIDTH * (y),       2 * WIDTH + 3 * WIDTH * (z) },     \
      { 3 * WIDTH * (1 - (x)), WIDTH + 3 * WIDTH * (1 - (y)), 2 * WIDTH + 3 * WIDTH * (1 - (z)) } }
const PlaneOrder wide_plane_orders[8] = {
    PLANE_ORDER(0, 0, 0), PLANE_ORDER(1, 0, 0), PLANE_ORDER(0, 1, 0), PLANE_ORDER(1, 1, 0),
    PLANE_ORDER(0, 0, 1), PLANE_ORDER(1, 0, 1), PLANE_ORDER(0, 1, 1), PLANE_ORDER(1, 1, 1)
};

/* ---- building ---- */

static void drop(Accel *a)
{
    Wide *w = (Wide *)a;
    mem_free(w->memory);
    mem_free(w->order);
    mem_free(w);
}

/* Nodes and blocks of so many primitives, about 8 MB, stay in the caches of today's processors. */
enum { FAST_MOST = 1 << 16 };

static Accel *build(const Geometry *g, const Opts *o, int threads)
{
    Wide *w = MEM_NEW(Wide);

    if (!w)
        return NULL;
    w->base.geo = g;
    w->lean = opt_is(o, "form", "lean") ||
              (opt_is(o, "form", "auto") && geometry_prims(g) > FAST_MOST);
    if (accel_counts("wide", geometry_prims(g), LEAF_SHIFT) && wide_build(w, g, threads))
        return &w->base;
    drop(&w->base);
    return NULL;
}

/* The order of the leaves is that of the triangles then, if there is but one mesh. */
static Accel *arrange(Geometry *g, const Opts *o, int threads)
{
    Accel *a = build(g, o, threads);
    Wide *w = (Wide *)a;

    if (!a || !w->order || g->nmeshes != 1 || g->nodd > 0)
        return a;
    if (!geometry_arrange(g, g->mesh_shapes[0], w->order)) {
        drop(a);
        return NULL;
    }
    mem_free(w->order);
    w->order = NULL;
    a->bytes -= g->ntris * sizeof *w->order;
    return a;
}

/* ---- queries of one ray ---- */

/* Of the children in `bits`, one at least, the last is returned, the others are put on the stack,
 * with no distance: where any hit will do that is of no concern. */
INLINE Below any_child(const Wide *w, bool lean, Below at, int bits, Waiting **top)
{
    for (; bits; bits &= bits - 1)
        *(*top)++ = node_child(w, lean, at, LOWEST_BIT(bits));
    return (Below)*--*top;
}

/* The nearest is returned. */
INLINE Below nearest_child(const Wide *w, bool lean, Below at, int bits, F8 near, Waiting **top)
{
    Waiting next;
    float lane[WIDTH];
    int k = LOWEST_BIT(bits);

    f8_store(lane, near);
    next = waiting(lane[k], node_child(w, lean, at, k));
    while ((bits &= bits - 1) != 0) {
        Waiting other;
        k = LOWEST_BIT(bits);
        other = waiting(lane[k], node_child(w, lean, at, k));
        *(*top)++ = other > next ? other : next;
        next = other > next ? next : other;
    }
    return (Below)next;
}

/* `steps` is NULL in all calls but one, and then the counting costs nothing. */
INLINE bool query(const Wide *w, bool lean, const Ray *r, Hit *h, bool any, Steps *steps)
{
    Waiting stack[WIDE_STACK], *top = stack, next;
    Below at = w->root;
    NodeProbe q;
    Probe p;

    hit_none(h, r->tmax);
    probe_init(&p, r);
    node_probe_init(&q, &p);
    for (;;) {
        if (is_node(at)) {
            F8 near;
            int bits = node_enter(w, lean, at, &q, h->t, &near);
            if (steps)
                steps->nodes++;
            if (bits) {
                at = any ? any_child(w, lean, at, bits, &top)
                         : nearest_child(w, lean, at, bits, near, &top);
                continue;
            }
        } else {
            if (steps)
                steps->prims += leaf_prims(at);
            leaf_meets(w, lean, at, r, &p, false, h, any, steps);
            if (any && h->outer != NO_PRIM)
                return true;
        }
        do {
            if (top == stack)
                return h->outer != NO_PRIM;
            next = *--top;
        } while (waiting_near(next) > h->t);
        at = (Below)next;
    }
}

static bool nearest(const Accel *a, const Ray *r, Hit *h, Steps *steps)
{
    const Wide *w = (const Wide *)a;
    if (UNLIKELY(a->leaves == 0))
        return hit_none(h, r->tmax);
    if (UNLIKELY(steps != NULL))
        return query(w, w->lean, r, h, false, steps);
    return w->lean ? query(w, true, r, h, false, NULL) : query(w, false, r, h, false, NULL);
}

static bool blocked(const Accel *a, const Ray *r, Steps *steps)
{
    const Wide *w = (const Wide *)a;
    Hit h;
    if (UNLIKELY(a->leaves == 0))
        return false;
    if (UNLIKELY(steps != NULL))
        return query(w, w->lean, r, &h, true, steps);
    return w->lean ? query(w, true, r, &h, true, NULL) : query(w, false, r, &h, true, NULL);
}

/* ---- checking ---- */

typedef struct {
    const Wide *wide;
    unsigned char *seen;                /* of each primitive */
    size_t nodes, blocks;               /* met so far */
    char  *why;
    size_t room;
} Check;

static bool check_prim(Check *c, uint32_t prim, Box box)
{
    if (prim >= geometry_prims(c->wide->base.geo) || c->seen[prim]++)
        return accel_bad(c->why, c->room, "no such primitive, or it stands twice,", prim);
    if (!box_holds(box, geometry_box(c->wide->base.geo, prim)))
        return accel_bad(c->why, c->room, "a primitive sticks out of its leaf", prim);
    return true;
}

/* The copies of triangle `prim` in lane k are its corners. */
static bool check_lane(Check *c, const TriangleBlock *b, int k, uint32_t prim)
{
    V3 corner[3];

    geometry_corners(c->wide->base.geo, prim, corner);
    for (int i = 0; i < 3; i++)
        for (int axis = 0; axis < 3; axis++)
            if (b->p[i][axis][k] != v_axis(corner[i], axis))
                return accel_bad(c->why, c->room, "a corner is not the triangle's", prim);
    return true;
}

static bool check_leaf(Check *c, Below at, Box box)
{
    const Wide *w = c->wide;
    uint32_t n = geometry_prims(w->base.geo);
    Below place = leaf_place(at);
    int count = leaf_count(at);

    if (w->lean ? place + (Below)count > n : place >= w->nblocks)
        return accel_bad(c->why, c->room, "a leaf that does not exist", place);
    c->blocks += !w->lean;
    for (int k = 0; k < count; k++) {
        uint32_t i = place + (Below)k;
        uint32_t prim = !w->lean ? w->blocks[place].prim[k] : w->order ? w->order[i] : i;
        if (!check_prim(c, prim, box))
            return false;
        if (!geometry_is_tri(w->base.geo, prim) && !(w->lean && count == 1))
            return accel_bad(c->why, c->room, "an odd primitive among triangles", prim);
        if (!w->lean && !check_lane(c, &w->blocks[place], k, prim))
            return false;
    }
    return true;
}

/* As rays see it: planes that are no numbers keep none away. */
static Box child_box(const Wide *w, Below at, int k)
{
    float p[2][3];

    for (int side = 0; side < 2; side++)
        for (int axis = 0; axis < 3; axis++) {
            float x = node_plane(w, w->lean, at, axis, (3 * side + axis) * WIDTH + k);
            p[side][axis] = x == x ? x : side ? INFINITY : -INFINITY;
        }
    return (Box){ v3(p[0][0], p[0][1], p[0][2]), v3(p[1][0], p[1][1], p[1][2]) };
}

/* `box` is what the parent says of it. Nodes are reached once each: so this ends. */
static bool check_below(Check *c, Below at, Box box)
{
    const Wide *w = c->wide;

    if (!w->lean && is_odd(at))
        return check_prim(c, at & ~BELOW_ODD, box);
    if (!is_node(at))
        return check_leaf(c, at, box);
    if (at >= w->nnodes || c->nodes++ > w->nnodes)
        return accel_bad(c->why, c->room, "a node out of range, or reached twice,", at);
    for (int k = 0; k < WIDTH; k++)
        if (node_present(w, w->lean, at) >> k & 1 &&
            !check_below(c, node_child(w, w->lean, at, k), child_box(w, at, k)))
            return false;
    return true;
}

static bool validate(const Accel *a, char *why, size_t room)
{
    const Wide *w = (const Wide *)a;
    uint32_t n = geometry_prims(a->geo);
    Box all = { { -INFINITY, -INFINITY, -INFINITY }, { INFINITY, INFINITY, INFINITY } };
    Check c = { w, MEM_ARRAY(unsigned char, n), 0, 0, why, room };
    bool ok = c.seen && (n == 0 || check_below(&c, w->root, all));

    if (ok && (c.nodes != w->nnodes || c.blocks != w->nblocks))
        ok = accel_bad(why, room, "nodes or blocks that nothing leads to, after", c.nodes);
    for (uint32_t i = 0; ok && i < n; i++)
        if (!c.seen[i])
            ok = accel_bad(why, room, "no leaf holds the primitive", i);
    mem_free(c.seen);
    return ok;
}

static const OptDef options[] = {
    { .key = "form", .type = OPT_CHOICE, .str = "auto", .choices = "auto lean fast",
      .help = "about 5 bytes a triangle, 9 where it takes a list; or over 100 and faster" },
    { .key = NULL }
};

const AccelKind accel_wide = {
    .info = { "wide", "Wald08; Ylitie17", "tree of up to eight children a node: the fastest",
              options },
    .build = build, .arrange = arrange, .nearest = nearest, .blocked = blocked,
    .nearest_many = wide_nearest_many, .blocked_many = wide_blocked_many,
    .validate = validate, .free = drop
};
