/* widegroup.c -- queries of neighbours through `wide`: sixteen rays that go the same way, together.
 *
 * Idea    Such rays visit the same nodes. So a node is asked once for all: bounds of their origins
 *         and inverse directions give an entry that is no later, and an exit that is no earlier,
 *         than that of any of them. The box of a leaf is then tested by each ray, eight in lanes,
 *         and its triangles by those that enter.
 * Truth   Every step of the bounds is monotonic, in floating point too: where a ray enters by the
 *         test of geometry/ray.h, the bounds do. So no ray loses a hit, and what it finds does not
 *         depend on its company. */
#include "accel/wide.h"

/* NODES_MOST: where triangles are finer than the rays are apart, a group is no gain. */
enum { GROUP = WIDE_GROUP, HALVES = GROUP / 8, NODES_MOST = 48 };

/* What waits, and which rays may go there. */
typedef struct { float near; Below below; uint32_t rays; } Stop;

typedef struct {
    F8 enter_o[3], leave_o[3];          /* the origins that enter first and leave last */
    F8 inv[2][3];                       /* [least, most] */
    const PlaneOrder *order;
    float o[3][GROUP], i[3][GROUP], t[GROUP];   /* of each ray: origin, inverse, what is beyond */
    float tmax;                         /* the largest t */
    uint32_t open;                      /* bit k: ray k is not done */
    Probe  p[GROUP];
    Hit    h[GROUP];
} Group;

/* How far directions may differ, in parts of the largest component. */
#define SPREAD 0.125f

bool wide_group_coheres(const Ray *r)
{
    F4 least = f4_all(INFINITY), most = f4_all(-INFINITY), apart, size;

    for (int k = 0; k < GROUP; k++) {
        F4 d = f4_load_three(&r[k].d.x);
        least = f4_min(d, least);
        most = f4_max(d, most);
    }
    apart = f4_sub(most, least);
    size = f4_max(f4_abs(least), f4_abs(most));
    return f4_max_three(apart) <= SPREAD * f4_max_three(size) &&
           f4_min_three(f4_mul(least, most)) > 0x1p-60f &&      /* one sign, inverses are finite */
           f4_max_three(size) < 0x1p60f;
}

static void group_init(Group *g, const Ray *r)
{
    F4 o_lo = f4_all(INFINITY), o_hi = f4_all(-INFINITY), i_lo = o_lo, i_hi = o_hi;
    V3 d = r->d;
    int signs = f4_signs(f4(d.x, d.y, d.z, 0.0f));

    g->tmax = 0.0f;
    g->open = (1u << GROUP) - 1;
    g->order = &wide_plane_orders[signs];
    for (int k = 0; k < GROUP; k++) {
        F4 o = f4_load_three(&r[k].o.x), i;
        hit_none(&g->h[k], r[k].tmax);
        probe_init(&g->p[k], &r[k]);
        i = f4_load_three(&g->p[k].inv.x);
        o_lo = f4_min(o, o_lo);
        o_hi = f4_max(o, o_hi);
        i_lo = f4_min(i, i_lo);
        i_hi = f4_max(i, i_hi);
        for (int axis = 0; axis < 3; axis++) {
            g->o[axis][k] = f4_lane(o, axis);
            g->i[axis][k] = f4_lane(i, axis);
        }
        g->t[k] = r[k].tmax;
        g->tmax = f_max(g->tmax, r[k].tmax);
    }
    for (int axis = 0; axis < 3; axis++) {
        F8 lo = f8_all(f4_lane(o_lo, axis)), hi = f8_all(f4_lane(o_hi, axis));
        g->enter_o[axis] = signs >> axis & 1 ? lo : hi;
        g->leave_o[axis] = signs >> axis & 1 ? hi : lo;
        g->inv[0][axis] = f8_all(f4_lane(i_lo, axis));
        g->inv[1][axis] = f8_all(f4_lane(i_hi, axis));
    }
}

/* Bit k: some ray may enter child k; no ray does so before near[k]. */
INLINE int group_enter(const Group *g, const Wide *w, bool lean, Below at, float near[WIDTH])
{
    F8 enter = f8_all(0.0f), leave = f8_all(INFINITY);

    for (int k = 0; k < 3; k++) {
        F8 a = f8_sub(node_planes(w, lean, at, k, g->order->near[k]), g->enter_o[k]);
        F8 b = f8_sub(node_planes(w, lean, at, k, g->order->far[k]), g->leave_o[k]);
        enter = f8_max(f8_min(f8_mul(a, g->inv[0][k]), f8_mul(a, g->inv[1][k])), enter);
        leave = f8_min(f8_max(f8_mul(b, g->inv[0][k]), f8_mul(b, g->inv[1][k])), leave);
    }
    f8_store(near, enter);
    return f8_at_most(enter, f8_mul(leave, f8_all(SLAB_WIDEN))) &
           f8_at_most(enter, f8_all(g->tmax)) & node_present(w, lean, at);
}

/* The rays that enter child k: slabs() of geometry/ray.h, a lane a ray. */
INLINE uint32_t rays_enter(const Group *g, const Wide *w, bool lean, Below at, int k)
{
    uint32_t rays = 0;

    for (int half = 0; half < HALVES; half++) {
        F8 enter = f8_all(0.0f), leave = f8_all(INFINITY);
        for (int axis = 0; axis < 3; axis++) {
            F8 o = f8_load(g->o[axis] + 8 * half), inv = f8_load(g->i[axis] + 8 * half);
            F8 a = f8_all(node_plane(w, lean, at, axis, g->order->near[axis] + k));
            F8 b = f8_all(node_plane(w, lean, at, axis, g->order->far[axis] + k));
            enter = f8_max(f8_mul(f8_sub(a, o), inv), enter);
            leave = f8_min(f8_mul(f8_sub(b, o), inv), leave);
        }
        rays |= (uint32_t)(f8_at_most(enter, f8_mul(leave, f8_all(SLAB_WIDEN))) &
                           f8_at_most(enter, f8_load(g->t + 8 * half))) << 8 * half;
    }
    return rays & g->open;
}

/* The children that are met; that with the first entry on top. */
INLINE Stop *push_children(const Group *g, const Wide *w, bool lean, Below at, Stop *top)
{
    float near[WIDTH];
    int bits = group_enter(g, w, lean, at, near);
    Stop *first = top;

    for (; bits; bits &= bits - 1) {
        int k = LOWEST_BIT(bits);
        Stop p = { near[k], node_child(w, lean, at, k), g->open };
        if (!is_node(p.below))
            p.rays = rays_enter(g, w, lean, at, k);
        if (!p.rays)
            continue;
        if (top > first && top[-1].near < p.near) {
            *top = top[-1];
            top[-1] = p;
        } else
            *top = p;
        top++;
    }
    return top;
}

INLINE void group_leaf(Group *g, const Wide *w, bool lean, bool any, Stop at)
{
    uint32_t rays = at.rays & g->open;

    for (; rays; rays &= rays - 1) {
        int k = LOWEST_BIT(rays);
        if (at.near > g->t[k])
            continue;
        leaf_meets(w, lean, at.below, g->p[k].ray, &g->p[k], false, &g->h[k], any, NULL);
        g->t[k] = g->h[k].t;
        if (any && g->h[k].outer != NO_PRIM)
            g->open &= ~(1u << k);
    }
    g->tmax = 0.0f;
    for (rays = g->open; rays; rays &= rays - 1)
        g->tmax = f_max(g->tmax, g->t[LOWEST_BIT(rays)]);
}

/* False: it took too long, since each ray wants nodes of its own; nothing was written. */
INLINE bool group_query(const Wide *w, bool lean, bool any, const Ray *r, Hit *h, bool *hit)
{
    Stop stack[WIDE_STACK], *top = stack;
    int nodes = 0;
    Group g;

    group_init(&g, r);
    *top++ = (Stop){ 0.0f, w->root, g.open };
    while (top > stack && g.open) {
        Stop at = *--top;
        if (at.near > g.tmax)
            continue;
        if (is_node(at.below)) {
            if (++nodes > NODES_MOST)
                return false;
            top = push_children(&g, w, lean, at.below, top);
        } else
            group_leaf(&g, w, lean, any, at);
    }
    for (int k = 0; k < GROUP; k++)
        hit[k] = answer(&g.h[k], &r[k], any ? NULL : &h[k]);
    return true;
}

bool wide_group(const Wide *w, const Ray *r, Hit *h, bool *hit)
{
    if (w->lean)
        return h ? group_query(w, true, false, r, h, hit)
                 : group_query(w, true, true, r, NULL, hit);
    return h ? group_query(w, false, false, r, h, hit) : group_query(w, false, true, r, NULL, hit);
}
