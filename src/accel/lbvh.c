/* lbvh.c -- lightweight bounding volumes: complete trees, their planes small whole numbers.
 *
 * Source      [Cline07 3.3, 3.4.2]; see forest.h for the shape of the trees.
 * Layout      A plane is a whole number of 16 or 8 bits, a fraction of the tree's box: 12 or 6
 *             bytes a node. With 8 bits a box divided by 255 is coarse for a large mesh: pieces=
 *             divides that first.
 * Rounding    Planes are rounded outwards, so that the box as decoded, in float, holds those of the
 *             triangles: validate() checks. Rays stay in world space and meet decoded planes; with
 *             [Cline07]'s ray in the space of the fractions its roundings would need bounds. */
#include "accel/forest.h"
#include "accel/prim.h"
#include "base/simd.h"

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

/* Node j from its triangles. An empty one gets planes that no ray is between. */
static void encode_leaf(Forest *f, const Tree *t, uint32_t j)
{
    uint32_t from, to, range = forest_range(f);
    Box b;

    leaf_range(t, f->form.leaf, j, &from, &to);
    b = tree_box(f->base.geo, t->first + from, to - from);
    for (int k = 0; k < 3; k++) {
        forest_plane_set(f, forest_plane_at(f, t, j, 0, k),
                  from < to ? encode(t, k, v_axis(b.lo, k), range, false) : range);
        forest_plane_set(f, forest_plane_at(f, t, j, 1, k),
                  from < to ? encode(t, k, v_axis(b.hi, k), range, true) : 0);
    }
}

/* The same from its children: what is rounded outwards stays in order. */
static void join_children(Forest *f, const Tree *t, uint32_t j)
{
    for (int k = 0; k < 3; k++) {
        uint32_t lo = forest_range(f), hi = 0;
        for (uint32_t c = f->form.arity * j + 1; c <= f->form.arity * j + f->form.arity; c++) {
            uint32_t a = forest_plane_get(f, forest_plane_at(f, t, c, 0, k));
            uint32_t b = forest_plane_get(f, forest_plane_at(f, t, c, 1, k));
            lo = a < lo ? a : lo;
            hi = b > hi ? b : hi;
        }
        forest_plane_set(f, forest_plane_at(f, t, j, 0, k), lo);
        forest_plane_set(f, forest_plane_at(f, t, j, 1, k), hi);
    }
}

static void encode_trees(Forest *f)
{
    for (size_t i = 0; i < f->ntrees; i++)
        for (uint32_t j = f->trees[i].nodes - 1; j > 0; j--) {
            if (j >= f->trees[i].inner)
                encode_leaf(f, &f->trees[i], j);
            else
                join_children(f, &f->trees[i], j);
        }
}

static Form form_of(const Opts *o)
{
    return (Form){ (uint32_t)opt_int(o, "arity"), (uint32_t)opt_int(o, "leaf"),
                   (uint32_t)opt_int(o, "pieces") };
}

static Accel *build(const Geometry *g, const Opts *o, int threads)
{
    Forest *f = forest_new(g, form_of(o), opt_is(o, "bits", "8") ? 8 : 16, "lbvh");

    (void)threads;
    if (!f)
        return NULL;
    encode_trees(f);
    return &f->base;
}

static Accel *arrange(Geometry *g, const Opts *o, int threads)
{
    return forest_arrange(g, form_of(o)) ? build(g, o, threads) : NULL;
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
                          float tmax, float near[FOREST_ARITY_MOST])
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

/* True: the query may end. Of the children that are met the nearest is next. */
INLINE bool tree_hits(const Forest *f, const Tree *t, const Probe *p, Hit *h, bool any,
                      Steps *steps, int bits)
{
    Waiting stack[STACK], *top = stack;
    const unsigned char *planes = f->planes + t->planes;
    size_t group = 6 * f->form.arity * ((size_t)bits / 8);
    uint32_t at = 0;
    TreeProbe q;

    tree_probe_init(&q, p, t);
    for (;;) {
        if (steps)
            steps->nodes++;
        if (at < t->inner) {
            float near[FOREST_ARITY_MOST];
            int hits = siblings_enter(&q, planes + at * group, f->form.arity, bits, h->t, near), k;
            if (hits) {
                Waiting next;
                k = LOWEST_BIT(hits);
                next = (Waiting){ near[k], f->form.arity * at + 1 + (uint32_t)k };
                while ((hits &= hits - 1) != 0) {
                    Waiting other;
                    k = LOWEST_BIT(hits);
                    other = (Waiting){ near[k], f->form.arity * at + 1 + (uint32_t)k };
                    *top++ = other.near < next.near ? next : other;
                    next = other.near < next.near ? other : next;
                }
                at = next.node;
                continue;
            }
        } else if (tree_leaf_hits(f, t, at, p, h, any, steps))
            return true;
        do {
            if (top == stack)
                return false;
            top--;
        } while (top->near > h->t);
        at = top->node;
    }
}

static bool tree_hits_16(const Forest *f, const Tree *t, const Probe *p, Hit *h, bool any,
                         Steps *steps)
{
    return UNLIKELY(steps != NULL) ? tree_hits(f, t, p, h, any, steps, 16)
                                   : tree_hits(f, t, p, h, any, NULL, 16);
}

static bool tree_hits_8(const Forest *f, const Tree *t, const Probe *p, Hit *h, bool any,
                        Steps *steps)
{
    return UNLIKELY(steps != NULL) ? tree_hits(f, t, p, h, any, steps, 8)
                                   : tree_hits(f, t, p, h, any, NULL, 8);
}

static bool nearest(const Accel *a, const Ray *r, Hit *h, Steps *steps)
{
    const Forest *f = (const Forest *)a;
    return forest_query(f, r, h, false, steps, f->bits == 8 ? tree_hits_8 : tree_hits_16);
}

static bool blocked(const Accel *a, const Ray *r, Steps *steps)
{
    const Forest *f = (const Forest *)a;
    Hit h;
    return forest_query(f, r, &h, true, steps, f->bits == 8 ? tree_hits_8 : tree_hits_16);
}

/* ---- checking ---- */

/* The box of node j as a ray sees it. */
static Box node_box(const Forest *f, const Tree *t, uint32_t j)
{
    float p[2][3];

    for (int side = 0; side < 2; side++)
        for (int k = 0; k < 3; k++)
            p[side][k] = decode(t, k, j ? forest_plane_get(f, forest_plane_at(f, t, j, side, k))
                                        : side ? forest_range(f) : 0);
    return (Box){ v3(p[0][0], p[0][1], p[0][2]), v3(p[1][0], p[1][1], p[1][2]) };
}

static bool validate(const Accel *a, char *why, size_t room)
{
    return forest_validate((const Forest *)a, node_box, why, room);
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
    .validate = validate, .free = forest_free
};
