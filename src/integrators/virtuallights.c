/* virtuallights.c -- making virtual lights. See virtuallights.h. */
#include "integrators/virtuallights.h"

#include "base/mem.h"
#include "integrators/event.h"
#include "scene/area.h"

#include <stdlib.h>

enum { UNIT = 64 };                     /* paths */

/* ---- one light ---- */

/* A lamp that shines alike on all sides is matt, whatever its picture: at a point that is one
 * value. Else its L is looked at for each direction. What a mask leaves of the point is in e->L,
 * but not in what rays see. */
static bool of_lamp(VirtualLight *l, const Light *lamp, const Emission *e, float weight)
{
    Surface at = surface_at(e->p, e->err, e->n, e->uv);
    Rgb seen = lamp->kind->radiance(lamp, v_neg(e->d), &at);
    float all = rgb_lum(seen), left = rgb_lum(e->L);
    const Area *area = (const Area *)lamp;

    if (!(all > 0.0f) || !(left > 0.0f))
        return false;
    *l = (VirtualLight){ .p = e->p, .err = e->err, .n = e->n, .ns = e->n, .lamp = lamp,
                         .uv = e->uv };
    if (lamp->kind == &light_diffuse && area->exponent == 0.0f) {
        l->kind = VIRTUAL_MATT;
        l->two_sided = area->two_sided;
        l->power = rgb_scale(e->L, weight);
    } else {
        l->kind = VIRTUAL_LAMP;
        l->power = rgb_all(weight * left / all);
    }
    return true;
}

/* f* |cos| of a matt surface is f |wi.ng| |wo.ns| / |wo.ng|, see vertex_f_cos_of_light. */
static void matt(VirtualLight *l, const Vertex *v, Rgb flux)
{
    float over = fabsf(v_dot(frame_out(&v->frame, v->wo), v->s.ng));
    Rgb f = v->b->kind->eval(v->b, v->wo, v->wo, true);

    l->kind = VIRTUAL_MATT;
    if (v->wo.z < 0.0f) {
        l->n = v_neg(l->n);
        l->ns = v_neg(l->ns);
    }
    l->power = over > 0.0f ? rgb_scale(rgb_mul(flux, f), fabsf(v->wo.z) / over) : rgb_all(0.0f);
}

static void of_vertex(VirtualLight *l, const Vertex *v, Rgb flux)
{
    *l = (VirtualLight){ .p = v->s.p, .err = v->s.err, .n = v->s.ng, .ns = v->frame.n,
                         .kind = VIRTUAL_GLOSSY, .power = flux };
    if (v->b->kind == &bsdf_diffuse)
        matt(l, v, flux);
}

Rgb virtuallight_intensity(const VirtualLights *it, const VirtualLight *l, V3 d)
{
    float c = v_dot(l->n, d);
    Surface at;
    V3 local;

    switch (l->kind) {
    case VIRTUAL_MATT:
        if (l->two_sided)
            return rgb_scale(l->power, fabsf(c));
        return c > 0.0f && v_dot(l->ns, d) > 0.0f ? rgb_scale(l->power, c) : rgb_all(0.0f);
    case VIRTUAL_LAMP:
        at = surface_at(l->p, l->err, l->n, l->uv);
        return rgb_scale(rgb_mul(l->power, l->lamp->kind->radiance(l->lamp, v_neg(d), &at)),
                         fabsf(c));
    case VIRTUAL_GLOSSY:
        if (vertex_local(&it->vertex[l->vertex], d, &local))
            return rgb_mul(l->power,
                           vertex_f_cos_of_light(&it->vertex[l->vertex], d, local));
        break;
    }
    return rgb_all(0.0f);
}

bool virtuallight_reaches(const VirtualLights *it, const VirtualLight *l, const Vertex *at,
                          float bound, Rgb *c, Ray *r)
{
    V3 d = v_sub(l->p, at->s.p), local;
    float d2 = v_len2(d);
    LightSample to;
    Rgb intensity;

    if (!(d2 > 0.0f))
        return false;
    to.dist = sqrtf(d2);
    to.wi = v_scale(d, 1.0f / to.dist);
    if (!vertex_local(at, to.wi, &local))
        return false;
    intensity = virtuallight_intensity(it, l, v_neg(to.wi));
    if (rgb_black(intensity))
        return false;
    *c = rgb_scale(rgb_mul(vertex_f_cos(at, local), intensity),
                   bound_leaves(bound, at->s.ng, l->n, to.wi, d2) / d2);
    if (rgb_black(*c))
        return false;
    to.p = l->p;
    to.err = l->err;
    to.n = l->n;
    *r = shadow_ray(&at->s, &to);
    return true;
}

/* ---- one path ---- */

/* Where a path puts what it leaves: to be counted, or kept. */
typedef struct {
    VirtualLights *it;
    uint32_t path;
    bool     counts;
    size_t   light, vertex;     /* places of the next ones */
} Leaves;

static void leave(Leaves *to, const VirtualLight *l, int depth, const Vertex *v, V3 d)
{
    VirtualLights *it = to->it;

    if (to->counts) {
        it->count[0][to->path]++;
        it->count[1][to->path] += l->kind == VIRTUAL_GLOSSY;
        return;
    }
    it->light[to->light] = *l;
    it->light[to->light].depth = (uint32_t)depth;
    it->light[to->light].number = (uint32_t)to->light;
    if (l->kind == VIRTUAL_GLOSSY) {    /* where it stays, since models point into their room */
        Vertex *own = &it->vertex[to->vertex];
        it->light[to->light].vertex = (uint32_t)to->vertex++;
        own->s = v->s;
        vertex_make(own, it->scene, d);
    }
    to->light++;
}

static void trace(Leaves *to, Tracer *t)
{
    const VirtualLights *it = to->it;
    float each = 1.0f / (float)it->paths;
    VirtualLight l;
    const Light *lamp;
    Particle p;
    Emission e;

    lamp = particle_leaves(&p, it->by, scene_time(it->scene, 0.5f), t, &e);
    if (!lamp || it->maxdepth < 1)
        return;
    if (lamp_is_shape(lamp) &&
        of_lamp(&l, lamp, &e, rgb_max(p.flux) / (rgb_max(e.L) * e.cosine) * e.pdf_w * each))
        leave(to, &l, 0, NULL, e.d);
    while (p.depth + 1 < it->maxdepth) {
        Vertex v;
        if (!ray_meets(t, &p.ray, &p.medium, &p.flux, &v.s))
            return;
        vertex_make(&v, it->scene, p.ray.d);
        if (vertex_is_smooth(&v)) {
            of_vertex(&l, &v, rgb_scale(p.flux, each));
            leave(to, &l, p.depth + 1, &v, p.ray.d);
        }
        if (!particle_scatters(&p, &v, t) || !particle_survives(&p, it->roulette, t))
            return;
    }
}

/* ---- phases ---- */

/* Paths [unit * UNIT, ...), each by the numbers of its place in its set. */
static void trace_unit(VirtualLights *it, uint64_t unit, bool counts, Tracer *t)
{
    uint64_t end = (unit + 1) * UNIT, all = (uint64_t)it->paths * it->sets;

    for (uint64_t i = unit * UNIT; i < end && i < all; i++) {
        Leaves to = { it, (uint32_t)i, counts, 0, 0 };
        if (!counts) {
            to.light = it->count[0][i];
            to.vertex = it->count[1][i];
        }
        sampler_pixel(&t->sampler, UINT32_MAX, (uint32_t)(i / it->paths));
        sampler_start(&t->sampler, (uint32_t)(i % it->paths));
        trace(&to, t);
    }
}

/* Counts become places: of the first light, the first vertex. */
static bool make_room(VirtualLights *it)
{
    for (uint32_t k = 0; k < it->sets; k++) {
        it->set[k].first = it->n;
        for (uint32_t i = k * it->paths; i < (k + 1) * it->paths; i++) {
            uint32_t n = it->count[0][i], nvertices = it->count[1][i];
            it->count[0][i] = (uint32_t)it->n;
            it->count[1][i] = (uint32_t)it->nvertices;
            it->n += n;
            it->nvertices += nvertices;
        }
        it->set[k].n = it->n - it->set[k].first;
    }
    if (it->n > UINT32_MAX) {
        it->n = 0;
        return err_usage("%lu light paths leave too many virtual lights; fewer paths or a smaller "
                         "maxdepth will do", (unsigned long)it->paths * it->sets);
    }
    it->light = MEM_ARRAY(VirtualLight, it->n);
    if (it->light)
        it->vertex = MEM_ARRAY(Vertex, it->nvertices);
    return it->light && it->vertex;
}

static int by_depth(const void *a, const void *b)
{
    const VirtualLight *x = a, *y = b;

    if (x->depth != y->depth)
        return x->depth < y->depth ? -1 : 1;
    return x->number < y->number ? -1 : x->number > y->number;
}

uint64_t virtuallights_units(const VirtualLights *it, int phase)
{
    uint64_t paths = (uint64_t)it->paths * it->sets;
    return phase == 1 ? 1 : phase == 3 ? it->sets : (paths + UNIT - 1) / UNIT;
}

bool virtuallights_run(VirtualLights *it, int phase, uint64_t unit, Tracer *t)
{
    const LightRun *run;

    switch (phase) {
    case 1: return make_room(it);
    case 3:
        run = &it->set[unit];
        if (run->n)
            qsort(it->light + run->first, run->n, sizeof *it->light, by_depth);
        return true;
    default: trace_unit(it, unit, phase == 0, t); return true;
    }
}

/* ---- making and clearing ---- */

bool virtuallights_init(VirtualLights *it, const Scene *s, uint32_t paths, uint32_t sets,
                        int maxdepth, int roulette)
{
    memset(it, 0, sizeof *it);
    it->scene = s;
    it->paths = paths;
    it->sets = sets;
    it->maxdepth = maxdepth;
    it->roulette = roulette;
    if ((uint64_t)paths * sets > VIRTUAL_PATHS)
        return err_usage("%lu sets of %lu light paths are more than %d in all",
                         (unsigned long)sets, (unsigned long)paths, VIRTUAL_PATHS);
    it->by = lightsampler_open("power", s);
    it->set = MEM_ARRAY(LightRun, sets);
    for (int k = 0; k < 2; k++)
        it->count[k] = MEM_ARRAY(uint32_t, (size_t)paths * sets);
    if (it->by && it->set && it->count[0] && it->count[1])
        return true;
    virtuallights_clear(it);
    return false;
}

void virtuallights_clear(VirtualLights *it)
{
    lightsampler_close(it->by);
    mem_free(it->set);
    mem_free(it->count[0]);
    mem_free(it->count[1]);
    mem_free(it->light);
    mem_free(it->vertex);
    memset(it, 0, sizeof *it);
}
