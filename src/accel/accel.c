/* accel.c -- the list of accelerators, and what they share: odd primitives, instances, surfaces of
 * hits, and the plain twins of the batched queries. */
#include "accel/accel.h"

#include "accel/prim.h"
#include "accel/regular.h"
#include "base/mem.h"

#include <stdio.h>

#define ACCELS(X)                                                              \
    X(brute)                    /* the reference */                            \
    X(bvh)                      /* binary tree of boxes */                     \
    X(grid)                     /* equal cells, grids within dense ones */     \
    X(hlbvh)                    /* the same as lbvh, each box a part of its parent's */ \
    X(kdtree)                   /* space divided by planes */                  \
    X(lbvh)                     /* complete trees without pointers */          \
    X(wide)                     /* eight children a node; the default */
#define DECLARE(name) extern const AccelKind accel_##name;
#define ENTRY(name) &accel_##name,
ACCELS(DECLARE)
const AccelKind *const accels[] = { ACCELS(ENTRY) NULL };

static const Tessellation *tessellation_of(const Geometry *g, size_t i)
{
    return g->shapes[g->tessellated[i]].as.tessellation;
}

static bool bound_tessellations(Accel *a, RegularForm form)
{
    const Geometry *g = a->geo;

    a->regular = MEM_ARRAY(Regular *, g->ntessellated);
    for (size_t i = 0; a->regular && i < g->ntessellated; i++) {
        Regular *r = a->regular[i] = regular_new(tessellation_of(g, i), form);
        if (!r)
            return false;
        a->bytes += sizeof *a->regular + regular_bytes(r);
        a->nodes += regular_nodes(r);
        a->leaves += regular_leaves(r);
    }
    return a->regular != NULL;
}

static Accel *finish(Accel *a, const AccelKind *kind, const Opts *o)
{
    RegularForm usual = { 16, 4 };

    if (!a)
        return NULL;
    a->kind = kind;
    if (!kind->plain && a->geo->ntessellated &&
        !bound_tessellations(a, kind->regular ? kind->regular(o) : usual)) {
        accel_free(a);
        return NULL;
    }
    return a;
}

Accel *accel_build(const AccelKind *kind, Geometry *g, const Opts *o, int threads)
{
    return finish(kind->arrange ? kind->arrange(g, o, threads) : kind->build(g, o, threads), kind,
                  o);
}

Accel *accel_build_as_is(const AccelKind *kind, const Geometry *g, const Opts *o, int threads)
{
    return finish(kind->build(g, o, threads), kind, o);
}

void accel_free(Accel *a)
{
    if (!a)
        return;
    for (size_t i = 0; a->regular && i < a->geo->ntessellated; i++)
        regular_free(a->regular[i]);
    mem_free(a->regular);
    a->kind->free(a);
}

bool accel_validate(const Accel *a, char *why, size_t room)
{
    for (size_t i = 0; a->regular && i < a->geo->ntessellated; i++)
        if (!regular_validate(a->regular[i], why, room))
            return false;
    return a->kind->validate(a, why, room);
}

void accel_nearest_many(const Accel *a, const Ray *r, Hit *h, bool *hit, size_t n)
{
    if (a->kind->nearest_many) {
        a->kind->nearest_many(a, r, h, hit, n);
        return;
    }
    for (size_t i = 0; i < n; i++)
        hit[i] = a->kind->nearest(a, &r[i], &h[i], NULL);
}

void accel_blocked_many(const Accel *a, const Ray *r, bool *blocked, size_t n)
{
    if (a->kind->blocked_many) {
        a->kind->blocked_many(a, r, blocked, n);
        return;
    }
    for (size_t i = 0; i < n; i++)
        blocked[i] = a->kind->blocked(a, &r[i], NULL);
}

bool accel_bad(char *why, size_t room, const char *what, size_t where)
{
    snprintf(why, room, "%s at %lu", what, (unsigned long)where);
    return false;
}

bool accel_counts(const char *name, size_t n, int bits)
{
    return n >> bits == 0 ||
           err_at((Place){ NULL, 0, 0 }, "%lu primitives in one object are too many for \"%s\", "
                  "expected less than %lu", (unsigned long)n, name, 1ul << bits);
}

/* ---- odd primitives ---- */

/* The direction is not made unit again, so t means the same in both spaces. */
static Ray into_space(const Affine *to_object, const Ray *r, float tmax)
{
    return (Ray){ .o = affine_point(to_object, r->o), .d = affine_vector(to_object, r->d),
                  .tmax = tmax, .time = r->time };
}

static Ray into_instance(const Instance *in, const Ray *r, float tmax)
{
    Affine to_world, to_object;

    if (LIKELY(!in->motion))
        return into_space(&in->to_object, r, tmax);
    motion_at(in->motion, r->time, &to_world, &to_object);
    return into_space(&to_object, r, tmax);
}

/* Where the ray enters the instance's bounds; false: not before tmax, or beyond all floats. */
static bool instance_entry(const Instance *in, const Probe *p, float tmax, float *near)
{
    float far;
    return box_slabs(p, in->bounds, tmax, near, &far) && *near < INFINITY;
}

/* t from inside is raised to the entry of the instance's bounds, so that boxes around those are
 * never passed over for it; see slabs() in ray.h. It is not lowered to their exit: a bound on t
 * that the query inside does not know of would make the answer depend on what was met before. */
static bool instance_nearest(const Instance *in, const Ray *r, const Probe *p, uint32_t prim,
                             Hit *h, Steps *steps)
{
    Ray local;
    float near;
    Hit inner;

    if (!instance_entry(in, p, h->t, &near))
        return false;
    local = into_instance(in, r, h->t);
    if (!in->accel->kind->nearest(in->accel, &local, &inner, steps))
        return false;
    inner.t = f_max(inner.t, near);
    if (inner.t > h->t || (inner.t == h->t && prim >= h->outer))
        return false;
    *h = inner;
    h->outer = prim;
    return true;
}

static bool instance_blocks(const Instance *in, const Ray *r, const Probe *p, Steps *steps)
{
    Ray local;
    float near;

    if (!instance_entry(in, p, r->tmax, &near))
        return false;
    local = into_instance(in, r, r->tmax);
    return in->accel->kind->blocked(in->accel, &local, steps);
}

/* Of equal t the smaller primitive, and within the tessellation the smaller triangle. */
static bool tessellation_hits(const Accel *a, const Tessellation *t, uint32_t prim, const Probe *p,
                              Hit *h, bool any, Steps *steps)
{
    Hit inner;

    inner.t = h->t;
    inner.outer = prim < h->outer ? NO_PRIM : 0;        /* 0: none is smaller */
    if (!regular_hits(a->regular ? a->regular[t->index] : NULL, t, p, &inner, any, steps))
        return false;
    *h = inner;
    h->outer = prim;
    h->prim = t->first_face + inner.prim;
    return true;
}

bool odd_nearest(const Accel *a, uint32_t prim, const Ray *r, const Probe *p, Hit *h, Steps *steps)
{
    const Geometry *g = a->geo;
    const Shape *s = &g->shapes[g->odd[prim - g->ntris]];
    float t = 0.0f;
    Box box;

    switch (s->kind) {
    case SHAPE_SPHERE:   t = sphere_cross(&s->as.sphere, r); break;
    case SHAPE_DISK:     t = disk_cross(&s->as.disk, r); break;
    case SHAPE_INSTANCE: return instance_nearest(s->as.instance, r, p, prim, h, steps);
    case SHAPE_TESSELLATION:
        return tessellation_hits(a, s->as.tessellation, prim, p, h, false, steps);
    case SHAPE_MESH:     break;
    }
    if (!(t > 0.0f))
        return false;
    box = geometry_box(g, prim);
    if (!hit_in_box(p, (BoxF4){ f4(box.lo.x, box.lo.y, box.lo.z, 0.0f),
                                f4(box.hi.x, box.hi.y, box.hi.z, 0.0f) }, &t) || t > h->t ||
        (t == h->t && prim >= h->outer))
        return false;
    h->t = t;
    h->u = h->v = 0.0f;
    h->outer = h->prim = prim;
    return true;
}

bool odd_blocks(const Accel *a, uint32_t prim, const Ray *r, const Probe *p, Steps *steps)
{
    const Geometry *g = a->geo;
    const Shape *s = &g->shapes[g->odd[prim - g->ntris]];
    Hit h;

    if (s->kind == SHAPE_INSTANCE)
        return instance_blocks(s->as.instance, r, p, steps);
    hit_none(&h, r->tmax);
    if (s->kind == SHAPE_TESSELLATION)
        return tessellation_hits(a, s->as.tessellation, prim, p, &h, true, steps);
    return odd_nearest(a, prim, r, p, &h, steps);
}

/* ---- surfaces ---- */

/* |m| v + w |translation|: what errors, and sizes, of coordinates become. */
static V3 affine_spread(const Affine *a, V3 v, float w)
{
    const float (*m)[4] = a->m;
    float out[3];

    for (int i = 0; i < 3; i++)
        out[i] = fabsf(m[i][0]) * v.x + fabsf(m[i][1]) * v.y + fabsf(m[i][2]) * v.z +
                 fabsf(m[i][3]) * w;
    return v3(out[0], out[1], out[2]);
}

/* To the error of p come four roundings of the map; and since the ray that leaves the surface has
 * to come back into the object, as many of the inverse map and one of each of the numbers of both,
 * which makes them not quite each other's inverse. */
static void surface_to_world(const Affine *to_world, const Affine *to_object, Surface *s)
{
    V3 size = affine_spread(to_world, v_abs(s->p), 1.0f);
    V3 back = affine_spread(to_object, size, 1.0f);
    V3 err = affine_spread(to_world, v_mad(back, ROUNDINGS(8), s->err), 0.0f);

    s->p = affine_point(to_world, s->p);
    s->err = v_mad(size, ROUNDINGS(8), err);
    s->ng = v_unit(affine_transposed(to_object, s->ng));
    s->ns = v_unit(affine_transposed(to_object, s->ns));
    s->dpdu = affine_vector(to_world, s->dpdu);
    s->dpdv = affine_vector(to_world, s->dpdv);
}

static void instance_surface(const Instance *in, const Ray *r, const Hit *h, Surface *s)
{
    Affine to_world, to_object;
    Hit inner = *h;
    Ray local;

    instance_at(in, r->time, &to_world, &to_object);
    local = into_space(&to_object, r, r->tmax);
    inner.outer = h->prim;
    accel_surface(in->accel, &local, &inner, s);
    surface_to_world(&to_world, &to_object, s);
}

void accel_surface(const Accel *a, const Ray *r, const Hit *h, Surface *s)
{
    const Geometry *g = a->geo;
    const Shape *top = geometry_is_tri(g, h->outer) ? NULL : geometry_shape(g, h->outer);

    if (top && top->kind == SHAPE_INSTANCE)
        instance_surface(top->as.instance, r, h, s);
    else
        geometry_surface(g, r, h, s);
}
