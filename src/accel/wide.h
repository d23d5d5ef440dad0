/* wide.h -- the inside of the accelerator `wide`: what its build, its queries of one ray and those
 * of many share. wide.c says what it is. */
#ifndef ACCEL_WIDE_H
#define ACCEL_WIDE_H

#include "accel/accel.h"
#include "accel/planes.h"
#include "accel/prim.h"
#include "accel/refs.h"
#include "accel/waiting.h"
#include "base/simd.h"

#include <string.h>

enum { WIDTH = 8, LEAF = 8 };

/* What is below: a node, a leaf of 1 to 8 triangles, or one odd primitive. The two upper bits tell;
 * of a leaf the next three are the count less 1, the others its block, or where it begins in leaf
 * order. */
typedef uint32_t Below;
#define BELOW_LEAF ((Below)2 << 30)
#define BELOW_ODD  ((Below)3 << 30)
#define LEAF_SHIFT 27                                   /* place and number: below 2^27 */

INLINE bool  is_node(Below b) { return b >> 31 == 0; }
INLINE bool  is_odd(Below b) { return b >> 30 == 3; }
INLINE int   leaf_count(Below b) { return (int)(b >> LEAF_SHIFT & 7) + 1; }
INLINE Below leaf_place(Below b) { return b & (((Below)1 << LEAF_SHIFT) - 1); }

/* Form fast: planes as they are. */
typedef struct {
    float    plane[2][3][WIDTH];        /* [lower, upper][axis][child] */
    Below    child[WIDTH];
    uint32_t present;                   /* bit k: child k exists */
    uint32_t unused[7];
} FastNode;
typedef char fast_node_fills_four_lines[sizeof(FastNode) == 256 ? 1 : -1];

/* Form lean: plane q of an axis is lo + q step, in float. Leaves come before other children. Their
 * primitives follow each other in leaf order, and so do the nodes of the others. */
typedef struct {
    float    lo[3], step[3];
    unsigned char plane[2][3][WIDTH];
    uint32_t nodes, prims;              /* the first of each */
    unsigned char end[WIDTH + 1];       /* leaf k: end[k] to end[k + 1], counted from prims */
    unsigned char present, leaves;      /* bit k: child k exists; how many are leaves */
} LeanNode;
typedef char lean_node_is_small[sizeof(LeanNode) == 92 ? 1 : -1];

typedef struct {
    Accel base;
    bool  lean;
    void *memory;                       /* owned; holds nodes and blocks, */
    FastNode *fast_nodes;               /* which begin at multiples of MEM_LINE in it; one of */
    LeanNode *lean_nodes;               /* these two is NULL */
    TriangleBlock *blocks;              /* of form fast: a leaf's copies of its triangles */
    uint32_t *order;                    /* owned; of form lean: primitives in leaf order; NULL: as
                                         * they are */
    size_t nnodes, nblocks;
    Below root;
} Wide;

/* Makes the tree of w, whose form is chosen; the lean one with its list. False: reported. */
bool wide_build(Wide *w, const Geometry *g, int threads);

/* A plane of a lean node. In lanes, see node_enter. */
INLINE float lean_plane(const LeanNode *n, int axis, unsigned char q)
{
    return plane_at(n->lo[axis], n->step[axis], q);
}

/* ---- steps of a query ---- */

/* Where in a node the planes stand that a ray meets first and last, by the signs of its direction
 * (bit k: axis k downwards). */
typedef struct { int near[3], far[3]; } PlaneOrder;
extern const PlaneOrder wide_plane_orders[8];

typedef struct {
    F8 o[3], inv[3];
    const PlaneOrder *order;
} NodeProbe;

INLINE void node_probe_init(NodeProbe *q, const Probe *p)
{
    V3 o = p->ray->o, d = p->ray->d, inv = p->inv;

    q->o[0] = f8_all(o.x);
    q->o[1] = f8_all(o.y);
    q->o[2] = f8_all(o.z);
    q->inv[0] = f8_all(inv.x);
    q->inv[1] = f8_all(inv.y);
    q->inv[2] = f8_all(inv.z);
    q->order = &wide_plane_orders[f4_signs(f4(d.x, d.y, d.z, 0.0f))];
}

/* The planes of all children at `place` of an axis. */
INLINE F8 node_planes(const Wide *w, bool lean, Below at, int axis, int place)
{
    const LeanNode *n;

    if (!lean)
        return f8_load(w->fast_nodes[at].plane[0][0] + place);
    n = &w->lean_nodes[at];
    return f8_add(f8_all(n->lo[axis]),
                  f8_mul(f8_load_u8(n->plane[0][0] + place), f8_all(n->step[axis])));
}

/* The plane at `place`, of one child. */
INLINE float node_plane(const Wide *w, bool lean, Below at, int axis, int place)
{
    return lean ? lean_plane(&w->lean_nodes[at], axis, *(w->lean_nodes[at].plane[0][0] + place))
                : *(w->fast_nodes[at].plane[0][0] + place);
}

/* Bit k: child k exists. */
INLINE int node_present(const Wide *w, bool lean, Below at)
{
    return lean ? w->lean_nodes[at].present : (int)w->fast_nodes[at].present;
}

/* Bit k: the ray enters the box of child k before it leaves it and not beyond tmax; lane k of *near
 * says where. The arithmetic of each lane is that of slabs() in geometry/ray.h. */
INLINE int node_enter(const Wide *w, bool lean, Below at, const NodeProbe *q, float tmax, F8 *near)
{
    F8 enter = f8_all(0.0f), leave = f8_all(INFINITY);

    for (int k = 0; k < 3; k++) {
        F8 a = node_planes(w, lean, at, k, q->order->near[k]);
        F8 b = node_planes(w, lean, at, k, q->order->far[k]);
        enter = f8_max(f8_mul(f8_sub(a, q->o[k]), q->inv[k]), enter);
        leave = f8_min(f8_mul(f8_sub(b, q->o[k]), q->inv[k]), leave);
    }
    *near = enter;
    return f8_at_most(enter, f8_mul(leave, f8_all(SLAB_WIDEN))) &
           f8_at_most(enter, f8_all(tmax)) & node_present(w, lean, at);
}

/* What child k is. */
INLINE Below node_child(const Wide *w, bool lean, Below at, int k)
{
    const LeanNode *n = &w->lean_nodes[at];

    if (!lean)
        return w->fast_nodes[at].child[k];
    if (k >= n->leaves)
        return n->nodes + (Below)(k - n->leaves);
    return BELOW_LEAF + (((Below)n->end[k + 1] - n->end[k] - 1) << LEAF_SHIFT) + n->prims +
           n->end[k];
}

INLINE void block_meets(const TriangleBlock *b, int n, const Probe *p, bool always, Hit *best)
{
    BlockView v;
    int bits = triangle_block_test(b, n, p, always, &v);

    for (; bits; bits &= bits - 1)
        triangle_block_accept(b, LOWEST_BIT(bits), p, &v, best);
}

/* Primitive k of a leaf of form lean; the last of its n for what is beyond. */
INLINE uint32_t lean_prim(const Wide *w, Below at, int n, int k)
{
    Below i = leaf_place(at) + (Below)(k < n ? k : n - 1);
    return w->order ? w->order[i] : i;
}

/* A leaf of more than four triangles. */
INLINE void lean_block_meets(const Wide *w, Below at, int n, const Probe *p, bool always, Hit *best)
{
    uint32_t prim[LEAF];
    TriangleBlock b;

    for (int k = 0; k < LEAF; k++)
        prim[k] = lean_prim(w, at, n, k);
    triangle_block_fetch(&b, w->base.geo, prim, n);
    block_meets(&b, n, p, always, best);
}

/* A leaf of form lean: its triangles are fetched from the mesh. Most have four at most. */
INLINE void lean_leaf_meets(const Wide *w, Below at, const Ray *r, const Probe *p, bool always,
                            Hit *best, bool any, Steps *steps)
{
    int n = leaf_count(at);
    uint32_t prim[4];

    if (UNLIKELY(n > 4)) {
        lean_block_meets(w, at, n, p, always, best);
        return;
    }
    for (int k = 0; k < 4; k++)
        prim[k] = lean_prim(w, at, n, k);
    if (LIKELY(geometry_is_tri(w->base.geo, prim[0])))
        triangle_four_nearest(w->base.geo, prim, n, p, always, best);
    else
        prim_meets(&w->base, prim[0], r, p, best, any, steps);
}

/* What is in a leaf against the ray: *best as for prim_meets. always: see triangle_lanes.h. */
INLINE void leaf_meets(const Wide *w, bool lean, Below at, const Ray *r, const Probe *p,
                       bool always, Hit *best, bool any, Steps *steps)
{
    if (lean)
        lean_leaf_meets(w, at, r, p, always, best, any, steps);
    else if (UNLIKELY(is_odd(at)))
        prim_meets(&w->base, at & ~BELOW_ODD, r, p, best, any, steps);
    else
        block_meets(&w->blocks[leaf_place(at)], leaf_count(at), p, always, best);
}

/* How many primitives are looked at there. */
INLINE uint64_t leaf_prims(Below at) { return is_odd(at) ? 1 : (uint64_t)leaf_count(at); }

/* Each level leaves at most seven children waiting; eight places more may be written. */
enum { WIDE_STACK = (WIDTH - 1) * (REFS_DEPTH_SAH + 34) + WIDTH };

/* ---- many rays ---- */

/* Whether *best is a hit; *h, if it is wanted, becomes what the ray found. */
INLINE bool answer(const Hit *best, const Ray *r, Hit *h)
{
    bool hit = best->outer != NO_PRIM;

    if (h && hit)
        *h = *best;
    else if (h)
        hit_none(h, r->tmax);
    return hit;
}

/* The batched queries of accel.h, see widemany.c. */
void wide_nearest_many(const Accel *a, const Ray *r, Hit *h, bool *hit, size_t n);
void wide_blocked_many(const Accel *a, const Ray *r, bool *blocked, size_t n);

/* The same of so many rays that go the same way, see widegroup.c; and whether they do. h is NULL
 * where any hit will do. w has leaves. False: they had better go singly. */
enum { WIDE_GROUP = 16 };
bool wide_group_coheres(const Ray *r);
bool wide_group(const Wide *w, const Ray *r, Hit *h, bool *hit);

#endif
