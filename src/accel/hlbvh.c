/* hlbvh.c -- hierarchical lightweight bounding volumes: complete trees, the box of a node told in
 * bytes as a part of its parent's.
 *
 * Source      The trees are those of [Cline07 3.3], see forest.h; ours are the nested boxes.
 * Layout      Six bytes a node, as many as lbvh with 8 bits takes. That divides the box of the
 *             whole tree by 255; here it is the parent's that is divided by 256, so planes are as
 *             close to what they bound, for its size, in the deepest row as in the first.
 * Planes      With step = (hi - lo) / 256 of the parent's box as decoded, a lower plane is
 *             lo + q step and an upper one hi - q step: both count inwards from the parent's side,
 *             q = 0 is that side itself, and no q leads out of it, since q step >= 0 and rounding
 *             keeps order. So there always is a plane that will do, boxes are nested whatever is
 *             rounded, and errors do not add up: q is the last one that does not cut the node's own
 *             box, by search over the values as they are decoded, hence at most a step away.
 *             All of it is one float expression each, the same here and in the lanes of siblings.h,
 *             so what validate() finds true is what a ray meets.
 * Empty       A node without triangles has its planes pass each other, lo + 255 step above
 *             hi - 255 step, and nodes below it have just its box. Where the parent is so thin that
 *             they do not pass, the node is met for nothing.
 * Range       The division of an extent by 256 is exact, or, for the smallest extents, rounds to a
 *             step of 0 or some other that serves as well. The root's box is set by forest.c. */
#include "accel/siblings.h"
#include "base/mem.h"

/* ---- boxes ---- */

/* The range of an axis of a box, seen from the lower or the upper side; from there planes count in
 * the same way, because floats round alike with both signs turned. */
typedef struct { float base, step; } Side;

static Side side_of(Box b, int axis, int side)
{
    float lo = v_axis(b.lo, axis), hi = v_axis(b.hi, axis);
    return (Side){ side ? -hi : lo, (hi - lo) * NESTED_STEP };
}

/* The box of a node within its parent's, as a ray sees it. */
static Box box_within(Sibling node, Box parent)
{
    float p[2][3];

    for (int side = 0; side < 2; side++)
        for (int k = 0; k < 3; k++) {
            Side s = side_of(parent, k, side);
            float x = plane_at(s.base, s.step, sibling_plane(node, side, k));
            p[side][k] = side ? -x : x;
        }
    return (Box){ v3(p[0][0], p[0][1], p[0][2]), v3(p[1][0], p[1][1], p[1][2]) };
}

/* ---- building ---- */

/* The planes of a node, which must hold b, within its parent's box. */
static void encode(Sibling node, Box b, Box parent)
{
    uint32_t none = box_is_empty(parent) ? 0 : 255;

    for (int side = 0; side < 2; side++)
        for (int k = 0; k < 3; k++) {
            Side s = side_of(parent, k, side);
            float x = side ? -v_axis(b.hi, k) : v_axis(b.lo, k);
            sibling_plane_set(node, side, k,
                              box_is_empty(b) ? none
                                              : planes_below(s.base, s.step, x, 255, true) - 1);
        }
}

/* The boxes of all nodes by their triangles, from the last to the root. */
static void bound_nodes(const Forest *f, const Tree *t, Box *box)
{
    uint32_t from, to;

    for (uint32_t j = t->nodes; j-- > 0;) {
        box[j] = box_empty();
        if (j < t->inner)
            for (uint32_t c = f->form.arity * j + 1; c <= f->form.arity * (j + 1); c++)
                box[j] = box_join(box[j], box[c]);
        else {
            leaf_range(t, f->form.leaf, j, &from, &to);
            box[j] = tree_box(f->base.geo, t->first + from, to - from);
        }
    }
}

/* Parents come before their children, so their boxes are decoded when they are asked for. */
static void encode_tree(Forest *f, const Tree *t, Box *box)
{
    bound_nodes(f, t, box);
    box[0] = fractions_box(&t->box, planes_range(f->bits));
    for (uint32_t j = 1; j < t->nodes; j++) {
        Box parent = box[(j - 1) / f->form.arity];
        encode(forest_node(f, t, j), box[j], parent);
        box[j] = box_within(forest_node(f, t, j), parent);
    }
}

static bool encode_trees(Forest *f)
{
    uint32_t most = 0;
    Box *box;

    for (size_t i = 0; i < f->ntrees; i++)
        most = f->trees[i].nodes > most ? f->trees[i].nodes : most;
    box = MEM_ARRAY(Box, most);
    for (size_t i = 0; box && i < f->ntrees; i++)
        if (f->trees[i].inner)
            encode_tree(f, &f->trees[i], box);
    mem_free(box);
    return box != NULL;
}

static Accel *build(const Geometry *g, const Opts *o, int threads)
{
    Forest *f = forest_new(g, forest_form(o), 8, "hlbvh");

    (void)threads;
    if (f && !encode_trees(f)) {
        forest_free(&f->base);
        return NULL;
    }
    return f ? &f->base : NULL;
}

static Accel *arrange(Geometry *g, const Opts *o, int threads)
{
    return forest_arrange(g, forest_form(o)) ? build(g, o, threads) : NULL;
}

/* ---- queries ---- */

static bool tree_hits(const Forest *f, const Tree *t, const Probe *p, Hit *h, bool any,
                      Steps *steps)
{
    return UNLIKELY(steps != NULL) ? tree_walk(f, t, p, h, any, steps, 8, true)
                                   : tree_walk(f, t, p, h, any, NULL, 8, true);
}

static bool nearest(const Accel *a, const Ray *r, Hit *h, Steps *steps)
{
    return forest_query((const Forest *)a, r, h, false, steps, tree_hits);
}

static bool blocked(const Accel *a, const Ray *r, Steps *steps)
{
    Hit h;
    return forest_query((const Forest *)a, r, &h, true, steps, tree_hits);
}

/* ---- checking ---- */

/* From the root down to node j. */
static Box node_box(const Forest *f, const Tree *t, uint32_t j)
{
    return j ? box_within(forest_node(f, t, j), node_box(f, t, (j - 1) / f->form.arity))
             : fractions_box(&t->box, planes_range(f->bits));
}

static bool validate(const Accel *a, char *why, size_t room)
{
    return forest_validate((const Forest *)a, node_box, why, room);
}

static const OptDef options[] = { FOREST_OPTIONS, { .key = NULL } };

const AccelKind accel_hlbvh = {
    .info = { "hlbvh", "Cline07 3.3", "complete trees, each box in bytes as a part of its parent's",
              options },
    .arrange = arrange, .build = build, .nearest = nearest, .blocked = blocked,
    .validate = validate, .free = forest_free
};
