/* regular.c -- lightweight bounding volumes over a regular tessellation. See regular.h. */
#include "accel/regular.h"

#include "accel/planes.h"
#include "base/mem.h"
#include "geometry/triangle.h"

#include <stdio.h>
#include <stdlib.h>

enum { ARITY = 4, LEVELS = 32 };

struct Regular {
    const Tessellation *t;      /* borrowed */
    Fractions box;
    int       bits, levels;     /* levels below the root; 0: the root is a leaf */
    int       shift;            /* the side of leaves is 2^shift */
    bool      heap;             /* else in rows, and then: */
    size_t    first[LEVELS];    /* the first group of siblings of regions of each level above the
                                 * leaves, which are level 0 */
    size_t    groups;
    uint64_t  leaves;
    unsigned char *planes;      /* owned; of the groups */
};

/* A region with d = +- 2^(shift + level), and the group of its children, if it is no leaf. */
typedef struct { uint32_t x, y; int32_t d; int level; size_t group; } Region;

/* ---- what a region is ---- */

static uint32_t rows_of(const Tessellation *t) { return t->nv - 1; }

/* How many regions of side 2^shift it takes to cover so many points. */
INLINE size_t cover(uint32_t points, int shift) { return (size_t)((points - 2) >> shift) + 1; }

INLINE Region region_root(const Regular *r)
{
    return (Region){ 0, 0, (int32_t)1 << (r->shift + r->levels), r->levels,
                     r->heap ? 0 : r->first[r->levels] };
}

/* The least row of the triangles of a region. */
INLINE uint32_t region_row(const Regular *r, const Region *g)
{
    return r->t->triangular && g->d < 0 ? g->y - (uint32_t)-g->d : g->y;
}

/* Nothing of the grid is in it. */
INLINE bool region_is_empty(const Regular *r, const Region *g)
{
    return region_row(r, g) >= rows_of(r->t) || (!r->t->triangular && g->x >= r->t->nu - 1);
}

/* Child k of a region that is no leaf. The group of an empty one does not exist. */
INLINE Region region_child(const Regular *r, const Region *g, uint32_t k)
{
    Region c = *g;
    uint32_t half;

    c.d = g->d / 2;                     /* towards 0, exactly: |d| is a power of two */
    c.level = g->level - 1;
    half = (uint32_t)c.d;               /* modulo 2^32, so that adding a negative one works */
    if (r->t->triangular) {             /* corner, corner, the upside down middle, corner */
        c.x += k >= 2 ? half : 0;
        c.y += k == 0 ? 0 : k == 2 ? 2 * half : half;
        c.d = k == 2 ? -c.d : c.d;
    } else {
        c.x += k & 1 ? half : 0;
        c.y += k & 2 ? half : 0;
    }
    if (r->heap)
        c.group = ARITY * g->group + 1 + k;
    else {
        int shift = r->shift + c.level;
        c.group = r->first[c.level] + (c.y >> shift) * cover(r->t->nu, shift) + (c.x >> shift);
    }
    return c;
}

/* Row `row` of a region: triangles at positions from .. to of the strip (see tessellation.h). */
typedef struct { uint32_t row, from, to; } Strip;

INLINE uint32_t region_rows(const Regular *r, const Region *g)
{
    uint32_t first = region_row(r, g), side = (uint32_t)abs(g->d), left = rows_of(r->t) - first;
    return side < left ? side : left;
}

INLINE Strip region_strip(const Regular *r, const Region *g, uint32_t k)
{
    uint32_t side = (uint32_t)abs(g->d), end;
    Strip s = { region_row(r, g) + k, 2 * g->x, 0 };

    if (!r->t->triangular) {
        end = r->t->nu - 1 - g->x;
        s.to = 2 * (g->x + (side < end ? side : end));
    } else if (g->d > 0)
        s.to = 2 * (g->x + k) + 1;
    else {
        s.from = 2 * (g->x - side + k) + 1;
        s.to = 2 * g->x;
    }
    return s;
}

/* ---- building ---- */

static Sibling node_of(const Regular *r, size_t group, uint32_t k)
{
    return (Sibling){ r->planes + group * siblings_bytes(ARITY, r->bits), ARITY, k, r->bits };
}

/* Holds triangle_box of every triangle of a leaf: it is widened by more, in the same steps. But no
 * box need be larger than all. */
static Box leaf_box(const Regular *r, const Region *g)
{
    Box b = box_empty(), all = r->t->bounds;

    for (uint32_t k = 0; k < region_rows(r, g); k++) {
        Strip s = region_strip(r, g, k);
        for (uint32_t i = s.from; i < s.to + 2; i++)
            b = box_point(b, tessellation_strip(r->t, s.row, i));
    }
    b = triangle_box(b.lo, b.hi, b.lo);
    return (Box){ v_max(b.lo, all.lo), v_min(b.hi, all.hi) };
}

/* All nodes below a region that is no leaf; the leaves first. */
static void encode_below(Regular *r, const Region *g)
{
    for (uint32_t k = 0; k < ARITY; k++) {
        Sibling node = node_of(r, g->group, k);
        Region c = region_child(r, g, k);
        if (region_is_empty(r, &c))
            sibling_encode(node, &r->box, box_empty());
        else if (c.level == 0) {
            sibling_encode(node, &r->box, leaf_box(r, &c));
            r->leaves++;
        } else {
            encode_below(r, &c);
            sibling_join(node, node_of(r, c.group, 0));
        }
    }
}

/* The side of leaves, the levels, and how many groups there are. A box that cannot be divided makes
 * one leaf of all. */
static void lay_out(Regular *r, uint32_t leaf)
{
    const Tessellation *t = r->t;
    uint32_t cells = t->nu > t->nv ? t->nu - 1 : t->nv - 1;
    uint64_t a_cell = t->triangular ? 1 : 2;
    size_t heap = 0;
    bool whole = !fractions_init(&r->box, t->bounds, planes_range(r->bits));

    while ((whole || a_cell << 2 * (r->shift + 1) <= leaf) && (uint32_t)1 << r->shift < cells)
        r->shift++;
    while ((uint32_t)1 << (r->shift + r->levels) < cells) {
        int shift = r->shift + ++r->levels;
        r->first[r->levels] = r->groups;
        r->groups += cover(t->nu, shift) * cover(t->nv, shift);
        heap = ARITY * heap + 1;
    }
    r->heap = t->triangular || r->groups == heap;
    r->groups = r->heap ? heap : r->groups;
}

Regular *regular_new(const Tessellation *t, RegularForm f)
{
    Regular *r = MEM_NEW(Regular);
    Region root;

    if (!r)
        return NULL;
    r->t = t;
    r->bits = f.bits;
    lay_out(r, f.leaf);
    r->planes = MEM_ARRAY(unsigned char, regular_bytes(r) - sizeof *r);
    if (!r->planes) {
        mem_free(r);
        return NULL;
    }
    root = region_root(r);
    if (r->levels)
        encode_below(r, &root);
    else
        r->leaves = 1;
    return r;
}

void regular_free(Regular *r)
{
    if (r)
        mem_free(r->planes);
    mem_free(r);
}

size_t regular_bytes(const Regular *r)
{
    return sizeof *r + r->groups * siblings_bytes(ARITY, r->bits) + SIBLINGS_PAD;
}

uint64_t regular_nodes(const Regular *r) { return ARITY * (uint64_t)r->groups + 1; }
uint64_t regular_leaves(const Regular *r) { return r->leaves; }

/* ---- queries ---- */

/* The strip's triangles, each of its points decoded once. True: one was hit, and any will do. */
INLINE bool strip_hits(const Tessellation *t, Strip s, const Probe *p, Hit *h, bool any)
{
    V3 at[3], view[3];

    for (uint32_t k = s.from; k < s.to + 2; k++) {
        at[0] = at[1];
        at[1] = at[2];
        view[0] = view[1];
        view[1] = view[2];
        at[2] = tessellation_strip(t, s.row, k);
        view[2] = triangle_across(p, &at[2]);
        if (k >= s.from + 2) {
            uint32_t position = k - 2;
            int a = !(position & 1), c = position & 1;          /* corners a, 2, c */
            if (triangle_may_hit(view[a], view[2], view[c])) {
                TriangleView v;
                v.a = view[a];
                v.b = view[2];
                v.c = view[c];
                if (triangle_accept(at[a], at[2], at[c], &v, tessellation_face(t, s.row, position),
                                    p, h) && any)
                    return true;
            }
        }
    }
    return false;
}

INLINE bool leaf_hits(const Regular *r, const Region *g, const Probe *p, Hit *h, bool any,
                      Steps *steps)
{
    uint32_t rows = region_rows(r, g);

    for (uint32_t k = 0; k < rows; k++) {
        Strip s = region_strip(r, g, k);
        if (steps)
            steps->prims += s.to - s.from;
        if (strip_hits(r->t, s, p, h, any))
            return true;
    }
    return false;
}

typedef struct { float near; Region at; } Pending;

/* Three wait on each level. */
enum { STACK = 3 * LEVELS };

/* The children of *at that are met: the nearest becomes *at, the others wait. False: none is. */
INLINE bool enter_children(const Regular *r, const Siblings *s, Region *at, float tmax, int bits,
                           Pending **top)
{
    const unsigned char *siblings = r->planes + at->group * siblings_bytes(ARITY, bits);
    float near[SIBLINGS_MOST];
    int hits = siblings_enter(s, siblings, ARITY, bits, tmax, near, NULL);
    Pending next = { INFINITY, *at };
    bool found = false;

    for (; hits; hits &= hits - 1) {
        uint32_t k = (uint32_t)LOWEST_BIT(hits);
        Pending child;
        child.near = near[k];
        child.at = region_child(r, at, k);
        if (region_is_empty(r, &child.at))
            continue;
        if (found)
            *(*top)++ = child.near < next.near ? next : child;
        if (!found || child.near < next.near)
            next = child;
        found = true;
    }
    *at = next.at;
    return found;
}

INLINE bool walk(const Regular *r, const Probe *p, Hit *h, bool any, Steps *steps, int bits)
{
    Pending stack[STACK], *top = stack;
    Region at = region_root(r);
    Siblings s;

    siblings_init(&s, &r->box, ARITY, bits, p);
    for (;;) {
        if (steps)
            steps->nodes++;
        if (at.level == 0) {
            if (leaf_hits(r, &at, p, h, any, steps) && any)
                return true;
        } else if (enter_children(r, &s, &at, h->t, bits, &top))
            continue;
        do {
            if (top == stack)
                return h->prim != NO_PRIM;
            top--;
        } while (top->near > h->t);
        at = top->at;
    }
}

/* What a walk must agree with. */
static bool plain_loop(const Tessellation *t, const Probe *p, Hit *h, bool any, Steps *steps)
{
    uint32_t n = tessellation_faces(t);

    for (uint32_t i = 0; i < n; i++) {
        TriangleView v;
        V3 c[3];
        if (steps)
            steps->prims++;
        tessellation_corners(t, i, c);
        v.a = triangle_across(p, &c[0]);
        v.b = triangle_across(p, &c[1]);
        v.c = triangle_across(p, &c[2]);
        if (triangle_may_hit(v.a, v.b, v.c) && triangle_accept(c[0], c[1], c[2], &v, i, p, h) &&
            any)
            return true;
    }
    return h->prim != NO_PRIM;
}

bool regular_hits(const Regular *r, const Tessellation *t, const Probe *p, Hit *h, bool any,
                  Steps *steps)
{
    h->prim = NO_PRIM;
    if (!r)
        return plain_loop(t, p, h, any, steps);
    return r->bits == 8 ? walk(r, p, h, any, steps, 8) : walk(r, p, h, any, steps, 16);
}

/* ---- checking ---- */

typedef struct {
    const Regular *r;
    unsigned char *face, *group;        /* whether each was met */
    char  *why;
    size_t room;
} Check;

static bool bad(const Check *c, const char *what, size_t where)
{
    return accel_bad(c->why, c->room, what, where);
}

static bool check_leaf(Check *c, const Region *g, Box b)
{
    const Tessellation *t = c->r->t;

    for (uint32_t k = 0; k < region_rows(c->r, g); k++) {
        Strip s = region_strip(c->r, g, k);
        for (uint32_t i = s.from; i < s.to; i++) {
            uint32_t face = tessellation_face(t, s.row, i);
            V3 p[3];
            if (face >= tessellation_faces(t) || c->face[face]++)
                return bad(c, "a triangle that does not exist or stands in two leaves", face);
            tessellation_corners(t, face, p);
            if (c->r->levels && !box_holds(b, triangle_box(p[0], p[1], p[2])))
                return bad(c, "a triangle sticks out of its leaf", face);
        }
    }
    return true;
}

static bool check_region(Check *c, const Region *g, Box b)
{
    if (g->level == 0)
        return check_leaf(c, g, b);
    if (g->group >= c->r->groups || c->group[g->group]++)
        return bad(c, "siblings that do not exist or have two parents", g->group);
    for (uint32_t k = 0; k < ARITY; k++) {
        Region child = region_child(c->r, g, k);
        Box below = sibling_box(node_of(c->r, g->group, k), &c->r->box);
        if (region_is_empty(c->r, &child)) {
            if (!box_is_empty(below))
                return bad(c, "an empty region has a box, in group", g->group);
        } else if (!box_holds(b, below))
            return bad(c, "a box sticks out of its parent's, in group", g->group);
        else if (!check_region(c, &child, below))
            return false;
    }
    return true;
}

bool regular_validate(const Regular *r, char *why, size_t room)
{
    uint32_t faces = tessellation_faces(r->t), n = 0;
    size_t groups = 0;
    Check c = { r, MEM_ARRAY(unsigned char, faces), MEM_ARRAY(unsigned char, r->groups), why,
                room };
    Region root = region_root(r);
    bool ok = c.face && c.group && check_region(&c, &root, (Box){ v_all(-INFINITY),
                                                                  v_all(INFINITY) });

    for (uint32_t i = 0; ok && i < faces; i++)
        n += c.face[i];
    for (size_t i = 0; ok && i < r->groups; i++)
        groups += c.group[i];
    if (ok && n != faces)
        ok = bad(&c, "triangles that no leaf holds, of", faces);
    if (ok && !r->t->triangular && groups != r->groups)
        ok = bad(&c, "siblings that nothing leads to, of", r->groups);
    mem_free(c.face);
    mem_free(c.group);
    return ok;
}
