/* lbvh.c -- lightweight bounding volumes: complete trees, their planes small whole numbers.
 *
 * Source      [Cline07 3.3, 3.4.2]; see forest.h for the shape of the trees.
 * Layout      A plane is a whole number of 16 or 8 bits, a fraction of the tree's box: 12 or 6
 *             bytes a node. With 8 bits a box divided by 255 is coarse for a large mesh: pieces=
 *             divides that first. See planes.h for how they are rounded. */
#include "accel/siblings.h"

/* ---- building ---- */

/* A leaf has its box from its triangles, any other node from its children; the last come first. */
static void encode_tree(Forest *f, const Tree *t)
{
    uint32_t from, to;

    for (uint32_t j = t->nodes - 1; j > 0; j--)
        if (j < t->inner)
            sibling_join(forest_node(f, t, j), forest_node(f, t, f->form.arity * j + 1));
        else {
            leaf_range(t, f->form.leaf, j, &from, &to);
            sibling_encode(forest_node(f, t, j), &t->box,
                           tree_box(f->base.geo, t->first + from, to - from));
        }
}

static int plane_bits(const Opts *o) { return opt_is(o, "bits", "8") ? 8 : 16; }

static RegularForm regular(const Opts *o)
{
    return (RegularForm){ plane_bits(o), (uint32_t)opt_int(o, "leaf") };
}

static Accel *build(const Geometry *g, const Opts *o, int threads)
{
    Forest *f = forest_new(g, forest_form(o), plane_bits(o), "lbvh");

    (void)threads;
    if (!f)
        return NULL;
    for (size_t i = 0; i < f->ntrees; i++)
        encode_tree(f, &f->trees[i]);
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
    return j ? sibling_box(forest_node(f, t, j), &t->box)
             : fractions_box(&t->box, planes_range(f->bits));
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
