/* pathstate.c -- paths of lightpath.h in files, so that chains of them can go on another day.
 *
 * Idea        All numbers of a path are written, and read back bit by bit: followed again from
 *             fewer, its last digits might be others. Models are no numbers, but functions of
 *             their surface, from which they are made again as path_copies does it.
 * Invariants  Whatever stands in a file, a path that was read names nothing that is not there. */
#include "integrators/lightpath.h"

static void save_v2(Saving *s, V2 v)
{
    save_float(s, v.x);
    save_float(s, v.y);
}
static V2 load_v2(Loading *l)
{
    float x = load_float(l);
    return (V2){ x, load_float(l) };
}

static void save_v3(Saving *s, V3 v)
{
    save_float(s, v.x);
    save_float(s, v.y);
    save_float(s, v.z);
}
static V3 load_v3(Loading *l)
{
    float x = load_float(l), y = load_float(l);
    return (V3){ x, y, load_float(l) };
}

static void save_rgb(Saving *s, Rgb c) { save_v3(s, v3(c.r, c.g, c.b)); }
static Rgb load_rgb(Loading *l)
{
    V3 v = load_v3(l);
    return rgb(v.x, v.y, v.z);
}

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
    save_v3(to, p->p);
    save_v3(to, p->err);
    save_v3(to, p->ng);
    save_v3(to, p->ns);
    save_v2(to, p->uv);
    save_v3(to, p->dpdu);
    save_v3(to, p->dpdv);
    save_float(to, p->width);
    save_float(to, p->time);
}

static bool load_surface(Surface *p, const Scene *s, Loading *l)
{
    uint32_t g = load_u32(l), prim = load_u32(l);

    if (g >= s->ngeometries || prim >= prims_and_faces(&s->geometries[g]))
        return false;
    p->shape = geometry_shape(&s->geometries[g], prim);
    p->prim = prim;
    p->p = load_v3(l);
    p->err = load_v3(l);
    p->ng = load_v3(l);
    p->ns = load_v3(l);
    p->uv = load_v2(l);
    p->dpdu = load_v3(l);
    p->dpdv = load_v3(l);
    p->width = load_float(l);
    p->time = load_float(l);
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
    save_v3(to, v->wo);
    save_v3(to, v->wi);
    save_v3(to, v->way);
    save_float(to, v->cos_o);
    save_float(to, v->cos_i);
    save_float(to, v->dist);
    save_u32(to, v->event);
    save_float(to, v->eta);
    save_rgb(to, v->scatters);
    save_rgb(to, v->passes);
    save_u32(to, v->medium);
}

static bool load_vertex(PathVertex *v, Vertex *room, const Scene *s, Loading *l)
{
    if (!load_surface(&room->s, s, l))
        return false;
    v->at = room;
    v->wo = load_v3(l);
    v->wi = load_v3(l);
    v->way = load_v3(l);
    v->cos_o = load_float(l);
    v->cos_i = load_float(l);
    v->dist = load_float(l);
    v->event = load_u32(l);
    v->eta = load_float(l);
    v->scatters = load_rgb(l);
    v->passes = load_rgb(l);
    v->medium = load_u32(l);
    vertex_make(room, s, v->way);
    return medium_is_there(s, v->medium);
}

/* ---- ends ---- */

static bool is_shape(const Light *l) { return !l->kind->infinite && !l->kind->delta; }

static void save_sample(const LightSample *to, Saving *s)
{
    save_v3(s, to->wi);
    save_rgb(s, to->L);
    save_float(s, to->pdf_w);
    save_float(s, to->dist);
    save_v3(s, to->p);
    save_v3(s, to->err);
    save_v3(s, to->n);
}

static void load_sample(LightSample *to, Loading *l)
{
    to->wi = load_v3(l);
    to->L = load_rgb(l);
    to->pdf_w = load_float(l);
    to->dist = load_float(l);
    to->p = load_v3(l);
    to->err = load_v3(l);
    to->n = load_v3(l);
}

static void save_lit(const PathEnd *e, const Scene *s, Saving *to)
{
    save_u32(to, e->light->index);
    if (is_shape(e->light))
        save_surface(&e->s, s, to);
    save_v3(to, e->d);
    save_sample(&e->to, to);
    save_float(to, e->cosine);
    save_rgb(to, e->passes);
    save_u32(to, e->medium);
}

static bool load_lit(PathEnd *e, const Scene *s, Loading *l)
{
    uint32_t light = load_u32(l);

    if (light >= s->nlights)
        return false;
    e->light = s->lights[light];
    if (is_shape(e->light) &&
        (!load_surface(&e->s, s, l) || scene_light_of(s, &e->s) != e->light))
        return false;
    e->d = load_v3(l);
    load_sample(&e->to, l);
    e->cosine = load_float(l);
    e->passes = load_rgb(l);
    e->medium = load_u32(l);
    return medium_is_there(s, e->medium);
}

/* ---- the whole ---- */

void path_save(const LightPath *p, const Scene *s, Saving *to)
{
    save_u32(to, (uint32_t)p->edges);
    save_v2(to, p->pixel);
    save_v2(to, p->lens);
    save_v3(to, p->eye);
    save_v3(to, p->way);
    save_float(to, p->time);
    for (int i = 1; i < p->edges; i++)
        save_vertex(&p->v[i], s, to);
    save_lit(&p->end, s, to);
    save_rgb(to, p->colour);
}

bool path_load(LightPath *p, int most, const Scene *s, Loading *l)
{
    uint32_t edges = load_u32(l);

    if (edges < 1 || edges > (uint32_t)most)
        return false;
    p->edges = (int)edges;
    p->pixel = load_v2(l);
    p->lens = load_v2(l);
    p->eye = load_v3(l);
    p->way = load_v3(l);
    p->time = load_float(l);
    for (int i = 1; i < p->edges; i++)
        if (!load_vertex(&p->v[i], p->v[i].at, s, l))
            return false;
    if (!load_lit(&p->end, s, l))
        return false;
    p->colour = load_rgb(l);
    return !l->beyond;
}
