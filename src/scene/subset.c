/* subset.c -- some of the shapes of a world. See subset.h. */
#include "scene/subset.h"

#include "base/mem.h"

/* A mesh of its own of the triangles of a shape. */
static bool copy_mesh(Mesh *m, const Geometry *g, const Shape *s)
{
    uint32_t least = UINT32_MAX, most = 0;

    for (uint32_t i = 0; i < s->count; i++)
        for (int k = 0; k < 3; k++) {
            uint32_t v = g->tri[s->first + i].v[k];
            least = v < least ? v : least;
            most = v > most ? v : most;
        }
    if (!mesh_alloc(m, most - least + (size_t)1, s->count, s->n != NULL, s->uv != NULL))
        return false;
    m->nverts = most - least + 1;
    m->ntris = s->count;
    memcpy(m->p, g->p + least, m->nverts * sizeof *m->p);
    if (s->n)
        memcpy(m->n, s->n + (least - s->first_vertex), m->nverts * sizeof *m->n);
    if (s->uv)
        memcpy(m->uv, s->uv + (least - s->first_vertex), m->nverts * sizeof *m->uv);
    for (uint32_t i = 0; i < s->count; i++)
        for (int k = 0; k < 3; k++)
            m->tri[i].v[k] = g->tri[s->first + i].v[k] - least;
    return true;
}

static bool add_copy(Geometry *to, const Geometry *from, const Shape *s)
{
    ShapeTraits traits = { s->material, s->light, s->flip };
    Mesh m = { 0 };
    uint32_t index;
    bool ok;

    switch (s->kind) {
    case SHAPE_MESH:
        if (s->count == 0)
            return true;
        ok = copy_mesh(&m, from, s) && geometry_add_mesh(to, &m, traits, &index);
        mesh_clear(&m);
        break;
    case SHAPE_SPHERE:
        ok = geometry_add_sphere(to, &s->as.sphere, traits, &index);
        break;
    case SHAPE_DISK:
        ok = geometry_add_disk(to, &s->as.disk, traits, &index);
        break;
    default:
        return true;
    }
    if (ok)
        to->shapes[index].plain = s->plain;
    return ok;
}

bool shape_shines(const Scene *s, const Shape *shape)
{
    (void)s;
    return shape->light != NO_LIGHT;
}

bool shape_glints(const Scene *s, const Shape *shape)
{
    return material_glints(&s->materials[shape->material]);
}

/* Of an instance: any of its shapes. */
static bool holds(const Subset *l, const Shape *shape)
{
    const Geometry *in;

    if (shape->kind != SHAPE_INSTANCE)
        return l->has(l->scene, shape);
    in = shape->as.instance->accel->geo;
    for (size_t i = 0; i < in->nshapes; i++)
        if (holds(l, &in->shapes[i]))
            return true;
    return false;
}

bool subset_init(Subset *l, const Scene *s, SubsetHas *has)
{
    const AccelKind *kind = kind_find(accels, ACCEL_DEFAULT);
    const Geometry *world = &s->geometries[0];
    bool ok = true, copied = true;
    Opts o;

    memset(l, 0, sizeof *l);
    l->scene = s;
    l->has = has;
    l->none = true;
    for (size_t i = 0; i < world->nshapes; i++)
        if (holds(l, &world->shapes[i])) {
            l->none = false;
            copied = copied && world->shapes[i].kind != SHAPE_TESSELLATION &&
                     world->shapes[i].kind != SHAPE_INSTANCE;
        }
    if (l->none || !copied)
        return true;
    for (size_t i = 0; i < world->nshapes && ok; i++)
        if (holds(l, &world->shapes[i]))
            ok = add_copy(&l->geometry, world, &world->shapes[i]);
    opts_default(&o, kind->info.options);
    ok = ok && geometry_finish(&l->geometry);
    l->accel = ok ? accel_build_as_is(kind, &l->geometry, &o, 1) : NULL;
    if (!l->accel)
        subset_clear(l);
    return l->accel != NULL;
}

void subset_clear(Subset *l)
{
    accel_free(l->accel);
    geometry_clear(&l->geometry);
    memset(l, 0, sizeof *l);
}

bool subset_next(const Subset *l, Ray *r, Surface *s)
{
    const Accel *a;
    Hit h;

    if (l->none)
        return false;
    a = l->accel ? l->accel : l->scene->accel;
    while (accel_nearest(a, r, &h)) {
        accel_surface(a, r, &h, s);
        r->o = ray_origin(s->p, s->err, s->ng, r->d);
        if (l->has(l->scene, s->shape))
            return true;
    }
    return false;
}

bool subset_near(const Subset *l, const Ray *r)
{
    return !l->none && (!l->accel || accel_blocked(l->accel, r));
}
