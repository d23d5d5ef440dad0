/* geometry.c -- the primitives of one space: adding, copying, listing, looking up. See
 * geometry.h. */
#include "geometry/geometry.h"

#include "base/mem.h"
#include "geometry/triangle.h"

#include <string.h>

void geometry_clear(Geometry *g)
{
    for (size_t i = 0; i < g->nshapes; i++) {
        mem_free(g->shapes[i].n);
        mem_free(g->shapes[i].uv);
        mem_free(g->shapes[i].place);
        if (g->shapes[i].kind == SHAPE_TESSELLATION && g->shapes[i].as.tessellation) {
            tessellation_clear(g->shapes[i].as.tessellation);
            mem_free(g->shapes[i].as.tessellation);
        }
        if (g->shapes[i].kind == SHAPE_INSTANCE && g->shapes[i].as.instance) {
            mem_free(g->shapes[i].as.instance->motion);
            mem_free(g->shapes[i].as.instance);
        }
    }
    mem_free(g->p);
    mem_free(g->tri);
    mem_free(g->shapes);
    mem_free(g->odd);
    mem_free(g->firsts);
    mem_free(g->mesh_shapes);
    mem_free(g->tessellated);
    memset(g, 0, sizeof *g);
}

static void *copy_of(const void *array, size_t n, size_t size, bool *ok)
{
    void *copy = array && *ok ? mem_array(n, size) : NULL;

    if (copy && n)
        memcpy(copy, array, n * size);
    *ok = *ok && (copy || !array);
    return copy;
}

static Instance *copy_of_instance(const Instance *in, bool *ok)
{
    Instance *copy = copy_of(in, 1, sizeof *copy, ok);

    if (copy)
        copy->motion = copy_of(in->motion, 1, sizeof *copy->motion, ok);
    return copy;
}

static Tessellation *copy_of_tessellation(const Tessellation *t, bool *ok)
{
    Tessellation *copy = *ok ? MEM_NEW(Tessellation) : NULL;

    *ok = copy && tessellation_copy(copy, t);
    return copy;
}

bool geometry_copy(Geometry *to, const Geometry *from)
{
    size_t end = from->nverts;          /* of the vertices of a mesh: where the next one's begin */
    bool ok = true;

    *to = *from;
    to->p = copy_of(from->p, from->nverts, sizeof *to->p, &ok);
    to->tri = copy_of(from->tri, from->ntris, sizeof *to->tri, &ok);
    to->odd = copy_of(from->odd, from->nodd, sizeof *to->odd, &ok);
    to->firsts = copy_of(from->firsts, from->nmeshes, sizeof *to->firsts, &ok);
    to->mesh_shapes = copy_of(from->mesh_shapes, from->nmeshes, sizeof *to->mesh_shapes, &ok);
    to->tessellated = copy_of(from->tessellated, from->ntessellated, sizeof *to->tessellated, &ok);
    to->shapes = copy_of(from->shapes, from->nshapes, sizeof *to->shapes, &ok);
    to->cap_p = from->nverts;
    to->cap_tri = from->ntris;
    to->cap_odd = from->nodd;
    to->cap_shapes = from->nshapes;
    to->cap_tessellated = from->ntessellated;
    if (!to->shapes)
        to->nshapes = 0;
    for (size_t i = to->nshapes; i-- > 0; ) {
        Shape *s = &to->shapes[i];
        if (s->kind == SHAPE_INSTANCE)
            s->as.instance = copy_of_instance(s->as.instance, &ok);
        if (s->kind == SHAPE_TESSELLATION)
            s->as.tessellation = copy_of_tessellation(s->as.tessellation, &ok);
        if (s->kind != SHAPE_MESH)
            continue;
        s->n = copy_of(s->n, end - s->first_vertex, sizeof *s->n, &ok);
        s->uv = copy_of(s->uv, end - s->first_vertex, sizeof *s->uv, &ok);
        s->place = copy_of(s->place, s->count, sizeof *s->place, &ok);
        end = s->first_vertex;
    }
    if (!ok)
        geometry_clear(to);
    return ok;
}

static bool too_many(void)
{
    return err_at((Place){ NULL, 0, 0 },
                  "too many primitives or vertices: at most %lu are possible",
                  (unsigned long)UINT32_MAX - 1);
}

/* The new shape; it has the index *index, which may be NULL. NULL: reported. */
static Shape *add_shape(Geometry *g, ShapeKind kind, ShapeTraits traits, uint32_t *index)
{
    Shape *s;

    if (g->nshapes >= UINT32_MAX - 1 || g->nodd >= UINT32_MAX - 1 - g->nfaces - g->ntris) {
        too_many();
        return NULL;
    }
    if (!mem_grow(&g->shapes, &g->cap_shapes, g->nshapes + 1, sizeof *g->shapes))
        return NULL;
    s = &g->shapes[g->nshapes];
    memset(s, 0, sizeof *s);
    s->kind = kind;
    s->material = traits.material;
    s->light = traits.light;
    s->flip = traits.flip;
    if (kind != SHAPE_MESH &&
        !MEM_PUSH(g->odd, g->nodd, g->cap_odd, (uint32_t)g->nshapes))
        return NULL;
    if (index)
        *index = (uint32_t)g->nshapes;
    g->nshapes++;
    return s;
}

/* The first mesh gives its arrays away, so that one large mesh is never copied. */
static bool take_vertices(Geometry *g, Mesh *m)
{
    uint32_t base = (uint32_t)g->nverts;

    if (g->nverts == 0 && g->ntris == 0) {
        mem_free(g->p);
        mem_free(g->tri);
        g->p = m->p;
        g->tri = m->tri;
        g->nverts = g->cap_p = m->nverts;
        g->ntris = g->cap_tri = m->ntris;
        m->p = NULL;
        m->tri = NULL;
        return true;
    }
    if (!mem_grow(&g->p, &g->cap_p, g->nverts + m->nverts, sizeof *g->p) ||
        !mem_grow(&g->tri, &g->cap_tri, g->ntris + m->ntris, sizeof *g->tri))
        return false;
    if (m->nverts)
        memcpy(g->p + base, m->p, m->nverts * sizeof *g->p);
    for (uint32_t i = 0; i < m->ntris; i++)
        for (int k = 0; k < 3; k++)
            g->tri[g->ntris + i].v[k] = m->tri[i].v[k] + base;
    g->nverts += m->nverts;
    g->ntris += m->ntris;
    return true;
}

bool geometry_add_mesh(Geometry *g, Mesh *m, ShapeTraits traits, uint32_t *shape)
{
    uint32_t first = (uint32_t)g->ntris, first_vertex = (uint32_t)g->nverts;
    Shape *s;

    if (m->nverts > UINT32_MAX - 1 - g->nverts ||
        m->ntris > UINT32_MAX - 1 - g->ntris - g->nodd - g->nfaces)
        return too_many();
    s = add_shape(g, SHAPE_MESH, traits, shape);
    if (!s || !take_vertices(g, m))
        return false;
    s->first = first;
    s->count = m->ntris;
    s->first_vertex = first_vertex;
    s->n = m->n;
    s->uv = m->uv;
    m->n = NULL;
    m->uv = NULL;
    mesh_clear(m);
    g->nmeshes++;
    return true;
}

bool geometry_add_sphere(Geometry *g, const Sphere *s, ShapeTraits traits, uint32_t *shape)
{
    Shape *own = add_shape(g, SHAPE_SPHERE, traits, shape);

    if (own)
        own->as.sphere = *s;
    return own != NULL;
}

bool geometry_add_disk(Geometry *g, const Disk *d, ShapeTraits traits, uint32_t *shape)
{
    Shape *own = add_shape(g, SHAPE_DISK, traits, shape);

    if (own)
        own->as.disk = *d;
    return own != NULL;
}

bool geometry_add_tessellation(Geometry *g, Tessellation *t, ShapeTraits traits, uint32_t *shape)
{
    uint32_t faces = tessellation_faces(t);
    Tessellation *own;
    Shape *s;

    if (faces > UINT32_MAX - 2 - g->ntris - g->nodd - g->nfaces)
        return too_many();
    if (!mem_grow(&g->tessellated, &g->cap_tessellated, g->ntessellated + 1,
                  sizeof *g->tessellated) || !(own = MEM_NEW(Tessellation)))
        return false;
    s = add_shape(g, SHAPE_TESSELLATION, traits, shape);
    if (!s) {
        mem_free(own);
        return false;
    }
    *own = *t;
    memset(t, 0, sizeof *t);
    own->index = (uint32_t)g->ntessellated;
    g->tessellated[g->ntessellated++] = (uint32_t)(s - g->shapes);
    g->nfaces += faces;
    s->as.tessellation = own;
    return true;
}

/* Takes over motion, which may be NULL, also if it fails. */
static bool add_instance(Geometry *g, const Instance *what, Motion *motion, uint32_t *shape)
{
    ShapeTraits traits = { 0, NO_LIGHT, false };
    Instance *in = MEM_NEW(Instance);
    Shape *s = in ? add_shape(g, SHAPE_INSTANCE, traits, shape) : NULL;

    if (!s) {
        mem_free(in);
        mem_free(motion);
        return false;
    }
    *in = *what;
    in->motion = motion;
    in->bounds = box_empty();
    s->as.instance = in;
    return true;
}

bool geometry_add_instance(Geometry *g, uint32_t child, const Transform *to_world, uint32_t *shape)
{
    Instance in = { .child = child, .to_world = xf_affine(to_world),
                    .to_object = xf_affine_inverse(to_world) };
    return add_instance(g, &in, NULL, shape);
}

bool geometry_add_moving(Geometry *g, uint32_t child, const Motion *motion, uint32_t *shape)
{
    Instance in = { .child = child, .to_world = motion->to_world, .to_object = motion->to_object };
    Motion *own = MEM_NEW(Motion);

    if (!own)
        return false;
    *own = *motion;
    return add_instance(g, &in, own, shape);
}

Box instance_box(const Instance *in, Box object)
{
    return in->motion ? motion_box(in->motion, object) : affine_box(&in->to_world, object);
}

bool geometry_finish(Geometry *g)
{
    size_t n = 0;

    mem_free(g->firsts);
    mem_free(g->mesh_shapes);
    g->firsts = MEM_ARRAY(uint32_t, g->nmeshes);
    g->mesh_shapes = MEM_ARRAY(uint32_t, g->nmeshes);
    if (!g->firsts || !g->mesh_shapes)
        return false;
    for (size_t i = 0; i < g->nshapes; i++)
        if (g->shapes[i].kind == SHAPE_MESH && g->shapes[i].count) {
            g->firsts[n] = g->shapes[i].first;
            g->mesh_shapes[n++] = (uint32_t)i;
        }
    g->nmeshes = n;
    for (size_t k = 0; k < g->nodd; k++) {
        g->shapes[g->odd[k]].first = (uint32_t)(g->ntris + k);
        g->shapes[g->odd[k]].count = 1;
    }
    for (size_t k = 0, face = g->ntris + g->nodd; k < g->ntessellated; k++) {
        Tessellation *t = g->shapes[g->tessellated[k]].as.tessellation;
        t->first_face = (uint32_t)face;
        face += tessellation_faces(t);
    }
    return true;
}

/* ---- tessellations as lists ---- */

/* The same triangles with the same corners, by their numbers. */
static bool list_faces(const Tessellation *t, Mesh *m)
{
    memset(m, 0, sizeof *m);
    if (tessellation_points(t) > UINT32_MAX - 1)
        return too_many();
    if (!mesh_alloc(m, tessellation_points(t), tessellation_faces(t), false, false))
        return false;
    m->nverts = (uint32_t)tessellation_points(t);
    m->ntris = tessellation_faces(t);
    for (uint32_t i = 0; i < m->ntris; i++) {
        GridPoint at[3];
        tessellation_places(t, i, at);
        for (int k = 0; k < 3; k++) {
            uint32_t v = (uint32_t)tessellation_index(t, at[k].x, at[k].y);
            m->tri[i].v[k] = v;
            m->p[v] = tessellation_point(t, at[k].x, at[k].y);
        }
    }
    return true;
}

/* Tessellations become meshes without primitives: where they stand in the order of meshes does not
 * matter to anyone but those who count vertices from one mesh to the next. */
static void empty_tessellations(Geometry *g)
{
    uint32_t next = (uint32_t)g->nverts;
    size_t n = 0;

    for (size_t i = g->nshapes; i-- > 0; ) {
        Shape *s = &g->shapes[i];
        if (s->kind == SHAPE_MESH)
            next = s->first_vertex;
        if (s->kind != SHAPE_TESSELLATION)
            continue;
        tessellation_clear(s->as.tessellation);
        mem_free(s->as.tessellation);
        s->kind = SHAPE_MESH;
        s->first = s->count = 0;
        s->first_vertex = next;
    }
    for (size_t k = 0; k < g->nodd; k++)
        if (g->shapes[g->odd[k]].kind != SHAPE_MESH)
            g->odd[n++] = g->odd[k];
    g->nodd = n;
    g->ntessellated = g->nfaces = 0;
}

bool geometry_list(Geometry *g)
{
    size_t n = g->ntessellated;

    for (size_t k = 0; k < n; k++) {
        const Shape *s = &g->shapes[g->tessellated[k]];
        ShapeTraits traits = { s->material, s->light, s->flip };
        Mesh m;
        g->nfaces -= tessellation_faces(s->as.tessellation);
        if (!list_faces(s->as.tessellation, &m) || !geometry_add_mesh(g, &m, traits, NULL)) {
            mesh_clear(&m);
            return false;
        }
    }
    empty_tessellations(g);
    return geometry_finish(g);
}

/* ---- looking up ---- */

/* The tessellation that a face belongs to. */
static const Shape *shape_of_face(const Geometry *g, uint32_t face)
{
    size_t lo = 0, hi = g->ntessellated;

    while (hi - lo > 1) {
        size_t middle = (lo + hi) / 2;
        if (g->shapes[g->tessellated[middle]].as.tessellation->first_face <= face)
            lo = middle;
        else
            hi = middle;
    }
    return &g->shapes[g->tessellated[lo]];
}

const Shape *geometry_shape(const Geometry *g, uint32_t prim)
{
    size_t n = g->nmeshes;
    const uint32_t *base = g->firsts;

    if (prim >= geometry_prims(g))
        return shape_of_face(g, prim);
    if (prim >= g->ntris)
        return &g->shapes[g->odd[prim - g->ntris]];
    while (n > 1) {                             /* the last first <= prim, without a branch */
        size_t half = n / 2;
        base += base[half] <= prim ? half : 0;
        n -= half;
    }
    return &g->shapes[g->mesh_shapes[base - g->firsts]];
}

Box geometry_box(const Geometry *g, uint32_t prim)
{
    const Shape *s;

    if (geometry_is_tri(g, prim)) {
        V3 c[3];
        geometry_corners(g, prim, c);
        return triangle_box(c[0], c[1], c[2]);
    }
    s = &g->shapes[g->odd[prim - g->ntris]];
    switch (s->kind) {
    case SHAPE_SPHERE:   return sphere_box(&s->as.sphere);
    case SHAPE_DISK:     return disk_box(&s->as.disk);
    case SHAPE_TESSELLATION: return s->as.tessellation->bounds;
    case SHAPE_INSTANCE: return s->as.instance->bounds;
    case SHAPE_MESH:     break;
    }
    return box_empty();
}
