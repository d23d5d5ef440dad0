/* pathstate.c -- paths of lightpath.h in files, so that chains of them can go on another day.
 *
 * Idea        All numbers of a path are written, and read back bit by bit: followed again from
 *             fewer, its last digits might be others. Models are no numbers, but functions of
 *             their surface, from which they are made again as path_copies does it.
 * Invariants  Whatever stands in a file, a path that was read names nothing that is not there. */
#include "integrators/lightpath.h"

#include <stddef.h>

/* So many numbers of 32 bits that stand one after the other in a struct: vectors may have more for
 * their width's sake. */
typedef struct { size_t at, n; } Member;
#define ONE(type, name) { offsetof(type, name), 1 }
#define TWO(type, name) { offsetof(type, name), 2 }
#define THREE(type, name) { offsetof(type, name), 3 }
#define MEMBERS_END { 0, 0 }

static void save_members(const void *x, const Member *m, Saving *to)
{
    for (; m->n; m++)
        for (size_t k = 0; k < m->n; k++) {
            uint32_t v;
            memcpy(&v, (const char *)x + m->at + k * sizeof v, sizeof v);
            save_u32(to, v);
        }
}

static void load_members(void *x, const Member *m, Loading *l)
{
    for (; m->n; m++)
        for (size_t k = 0; k < m->n; k++) {
            uint32_t v = load_u32(l);
            memcpy((char *)x + m->at + k * sizeof v, &v, sizeof v);
        }
}

static const Member of_surface[] = {
    THREE(Surface, p), THREE(Surface, err), THREE(Surface, ng), THREE(Surface, ns),
    TWO(Surface, uv), THREE(Surface, dpdu), THREE(Surface, dpdv), ONE(Surface, width),
    ONE(Surface, time), MEMBERS_END
}, of_vertex[] = {
    THREE(PathVertex, wo), THREE(PathVertex, wi), THREE(PathVertex, way), ONE(PathVertex, cos_o),
    ONE(PathVertex, cos_i), ONE(PathVertex, dist), ONE(PathVertex, event), ONE(PathVertex, eta),
    THREE(PathVertex, scatters), THREE(PathVertex, passes), ONE(PathVertex, medium), MEMBERS_END
}, of_end[] = {
    THREE(PathEnd, d), THREE(PathEnd, to.wi), THREE(PathEnd, to.L), ONE(PathEnd, to.pdf_w),
    ONE(PathEnd, to.dist), THREE(PathEnd, to.p), THREE(PathEnd, to.err), THREE(PathEnd, to.n),
    ONE(PathEnd, cosine), THREE(PathEnd, passes), ONE(PathEnd, medium), MEMBERS_END
}, of_path[] = {
    TWO(LightPath, pixel), TWO(LightPath, lens), THREE(LightPath, eye), THREE(LightPath, way),
    ONE(LightPath, time), THREE(LightPath, colour), MEMBERS_END
};

/* ---- surfaces ---- */

static uint32_t prims_and_faces(const Geometry *g)
{
    return geometry_prims(g) + (uint32_t)g->nfaces;
}

static void save_surface(const Surface *p, const Scene *s, Saving *to)
{
    uint32_t g = 0;

    while (g < s->ngeometries && (p->prim >= prims_and_faces(&s->geometries[g]) ||
                                  geometry_shape(&s->geometries[g], p->prim) != p->shape))
        g++;
    save_u32(to, g);
    save_u32(to, p->prim);
    save_members(p, of_surface, to);
}

static bool load_surface(Surface *p, const Scene *s, Loading *l)
{
    uint32_t g = load_u32(l), prim = load_u32(l);

    if (g >= s->ngeometries || prim >= prims_and_faces(&s->geometries[g]))
        return false;
    p->shape = geometry_shape(&s->geometries[g], prim);
    p->prim = prim;
    load_members(p, of_surface, l);
    return p->shape->kind != SHAPE_INSTANCE;
}

static bool medium_is_there(const Scene *s, uint32_t medium)
{
    return medium == NO_MEDIUM || medium < s->nmedia;
}

/* ---- vertices ---- */

static void save_vertex(const PathVertex *v, const Scene *s, Saving *to)
{
    save_surface(&v->at->s, s, to);
    save_members(v, of_vertex, to);
}

static bool load_vertex(PathVertex *v, Vertex *room, const Scene *s, Loading *l)
{
    if (!load_surface(&room->s, s, l))
        return false;
    v->at = room;
    load_members(v, of_vertex, l);
    vertex_make(room, s, v->way);
    return medium_is_there(s, v->medium);
}

/* ---- ends ---- */

static void save_lit(const PathEnd *e, const Scene *s, Saving *to)
{
    save_u32(to, e->light->index);
    if (lamp_is_shape(e->light))
        save_surface(&e->s, s, to);
    save_members(e, of_end, to);
}

static bool load_lit(PathEnd *e, const Scene *s, Loading *l)
{
    uint32_t light = load_u32(l);

    if (light >= s->nlights)
        return false;
    e->light = s->lights[light];
    if (lamp_is_shape(e->light) &&
        (!load_surface(&e->s, s, l) || scene_light_of(s, &e->s) != e->light))
        return false;
    load_members(e, of_end, l);
    return medium_is_there(s, e->medium);
}

/* ---- the whole ---- */

void path_save(const LightPath *p, const Scene *s, Saving *to)
{
    save_u32(to, (uint32_t)p->edges);
    save_members(p, of_path, to);
    for (int i = 1; i < p->edges; i++)
        save_vertex(&p->v[i], s, to);
    save_lit(&p->end, s, to);
}

bool path_load(LightPath *p, int most, const Scene *s, Loading *l)
{
    uint32_t edges = load_u32(l);

    if (edges < 1 || edges > (uint32_t)most)
        return false;
    p->edges = (int)edges;
    load_members(p, of_path, l);
    for (int i = 1; i < p->edges; i++)
        if (!load_vertex(&p->v[i], p->v[i].at, s, l))
            return false;
    return load_lit(&p->end, s, l) && !l->beyond;
}
