/* lbvh.c -- lightweight bounding volumes: complete trees, their planes small whole numbers.
 *
 * Source      [Cline07 3.3, 3.4.2]; see forest.h for the shape of the trees.
 * Layout      A plane is a whole number of 16 or 8 bits, a fraction of the tree's box: 12 or 6
 *             bytes a node. With 8 bits a box divided by 255 is coarse for a large mesh: pieces=
 *             divides that first. See planes.h for how they are rounded. */
#include "accel/siblings.h"

/* ---- building ---- */

/* Node j from its triangles. An empty one gets planes that no ray is between. */
static void encode_leaf(Forest *f, const Tree *t, uint32_t j)
{
    uint32_t from, to, range = planes_range(f->bits);
    Box b;

    leaf_range(t, f->form.leaf, j, &from, &to);
    b = tree_box(f->base.geo, t->first + from, to - from);
    for (int k = 0; k < 3; k++) {
        forest_plane_set(f, forest_plane_at(f, t, j, 0, k),
                  from < to ? plane_encode(&t->box, k, v_axis(b.lo, k), range, false) : range);
        forest_plane_set(f, forest_plane_at(f, t, j, 1, k),
                  from < to ? plane_encode(&t->box, k, v_axis(b.hi, k), range, true) : 0);
    }
}

/* The same from its children: what is rounded outwards stays in order. */
static void join_children(Forest *f, const Tree *t, uint32_t j)
{
    for (int k = 0; k < 3; k++) {
        uint32_t lo = planes_range(f->bits), hi = 0;
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

static int bits_of(const Opts *o) { return opt_is(o, "bits", "8") ? 8 : 16; }

static RegularForm regular(const Opts *o)
{
    return (RegularForm){ bits_of(o), (uint32_t)opt_int(o, "leaf") };
}

static Accel *build(const Geometry *g, const Opts *o, int threads)
{
    Forest *f = forest_new(g, forest_form(o), bits_of(o), "lbvh");

    (void)threads;
    if (!f)
        return NULL;
    encode_trees(f);
    return &f->base;
}

static Accel *arrange(Geometry *g, const Opts *o, int threads)
{
    return forest_arrange(g, forest_form(o)) ? build(g, o, threads) : NULL;
}

/* ---- queries ---- */

static bool tree_hits_16(const Forest *f, const Tree *t, const Probe *p, Hit *h, bool any,
                         Steps *steps)
{
    return UNLIKELY(steps != NULL) ? tree_walk(f, t, p, h, any, steps, 16, false)
                                   : tree_walk(f, t, p, h, any, NULL, 16, false);
}

static bool tree_hits_8(const Forest *f, const Tree *t, const Probe *p, Hit *h, bool any,
                        Steps *steps)
{
    return UNLIKELY(steps != NULL) ? tree_walk(f, t, p, h, any, steps, 8, false)
                                   : tree_walk(f, t, p, h, any, NULL, 8, false);
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
    uint32_t range = planes_range(f->bits);
    float p[2][3];

    for (int side = 0; side < 2; side++)
        for (int k = 0; k < 3; k++) {
            uint32_t whole = side ? range : 0;
            uint32_t q = j ? forest_plane_get(f, forest_plane_at(f, t, j, side, k)) : whole;
            p[side][k] = plane_at(t->box.lo[k], t->box.step[k], q);
        }
    return (Box){ v3(p[0][0], p[0][1], p[0][2]), v3(p[1][0], p[1][1], p[1][2]) };
}

static bool validate(const Accel *a, char *why, size_t room)
{
    return forest_validate((const Forest *)a, node_box, why, room);
}

static const OptDef options[] = {
    { .key = "bits", .type = OPT_CHOICE, .str = "16", .choices = "16 8",
      .help = "of a plane: 12 or 6 bytes a node" },
    FOREST_OPTIONS,
    { .key = NULL }
};

const AccelKind accel_lbvh = {
    .info = { "lbvh", "Cline07 3.3", "complete trees without pointers, planes of 16 or 8 bits",
              options },
    .arrange = arrange, .build = build, .nearest = nearest, .blocked = blocked,
    .validate = validate, .regular = regular, .free = forest_free
};
