/* lightpath.c -- the code of `lightpath.h`. */
#include "integrators/lightpath.h"

#include <stddef.h>

/* ---- one vertex ---- */

/* Names are the same from both sides: what reflects, or transmits, in the order of the model. */
int path_deltas(const Vertex *at, V3 wo, BsdfSample s[BSDF_DELTAS], uint32_t name[BSDF_DELTAS])
{
    int n = bsdf_deltas(at->b, wo, s);
    uint32_t reflect = 0, transmit = 0;

    for (int k = 0; k < n; k++)
        name[k] = s[k].flags & BSDF_TRANSMIT ? BSDF_TRANSMIT + (transmit++ << 2)
                                             : BSDF_REFLECT + (reflect++ << 2);
    return n;
}

static bool delta_named(const PathVertex *v, uint32_t event, BsdfSample *found)
{
    BsdfSample s[BSDF_DELTAS];
    uint32_t name[BSDF_DELTAS];

    for (int k = path_deltas(v->at, v->wo, s, name); k-- > 0;)
        if (name[k] == event) {
            *found = s[k];
            return true;
        }
    return false;
}

/* The eye's side: a ray of direction d has come so far. */
static void seen_along(PathVertex *v, V3 d, float dist)
{
    v->wo = frame_in(&v->at->frame, v_neg(d));
    v->cos_o = v_absdot(v->at->s.ng, d);
    v->dist = dist;
}

/* The light's side. False: light from there would pass through the surface. */
static bool goes_along(PathVertex *v, V3 way, V3 local)
{
    float cosine = v_dot(way, v->at->s.ng);

    v->way = way;
    v->wi = local;
    v->cos_i = fabsf(cosine);
    return cosine * local.z > 0.0f;
}

/* Both directions are there. False: the smooth part gives nothing. */
static bool scatters(PathVertex *v)
{
    const Bsdf *b = v->at->b;

    if (!(b->flags & BSDF_SMOOTH))
        return false;
    v->event = EVENT_SMOOTH;
    v->eta = 1.0f;
    v->scatters = rgb_scale(b->kind->eval(b, v->wo, v->wi, false), fabsf(v->wi.z));
    return !rgb_black(v->scatters);
}

static bool glints(PathVertex *v, const BsdfSample *s, uint32_t event)
{
    v->event = event;
    v->eta = s->eta;
    v->scatters = s->weight;
    return !rgb_black(s->weight);
}

/* ---- growing ---- */

Walk path_leaves_eye(LightPath *p, const Scene *s)
{
    Walk w = { s->camera->kind->ray(s->camera, p->pixel, p->lens, p->time), s->around,
               { 1, 1, 1 }, 0.0f };

    p->eye = w.ray.o;
    p->way = w.ray.d;
    return w;
}

static V3 point_of(const LightPath *p, int i) { return i ? p->v[i].at->s.p : p->eye; }

bool path_arrives(LightPath *p, int i, Walk *w, Vertex *room, Tracer *t)
{
    PathVertex *v = &p->v[i];
    float dist;

    if (!ray_meets(t, &w->ray, &w->medium, &w->passes, &room->s))
        return false;
    dist = v_len(v_sub(room->s.p, point_of(p, i - 1)));
    if (w->way >= 0.0f) {
        w->way += dist;
        room->s.width = w->way * t->spread;
    }
    vertex_make(room, t->scene, w->ray.d);
    v->at = room;
    seen_along(v, w->ray.d, dist);
    v->medium = w->medium;
    v->passes = w->passes;
    return true;
}

static void walk_on(Walk *w, const PathVertex *v)
{
    w->ray = vertex_ray(v->at, v->way);
    w->medium = medium_beyond(&v->at->s, v->way, v->medium);
    w->passes = rgb_all(1.0f);
}

bool path_turns_by(LightPath *p, int i, uint32_t event, Walk *w)
{
    PathVertex *v = &p->v[i];
    BsdfSample s;

    if (!delta_named(v, event, &s) || !glints(v, &s, event) ||
        !goes_along(v, frame_out(&v->at->frame, s.wi), s.wi))
        return false;
    walk_on(w, v);
    return true;
}

bool path_turns_to(LightPath *p, int i, V3 d, Walk *w)
{
    PathVertex *v = &p->v[i];

    if (!goes_along(v, d, frame_in(&v->at->frame, d)) || !scatters(v))
        return false;
    walk_on(w, v);
    w->way = -1.0f;
    return true;
}

/* ---- growing from the light ---- */

bool path_arrives_back(LightPath *p, int i, Walk *w, Vertex *room, Tracer *t)
{
    if (!ray_meets(t, &w->ray, &w->medium, &w->passes, &room->s))
        return false;
    *(i + 1 < p->edges ? &p->v[i + 1].passes : &p->end.passes) = w->passes;
    p->v[i].at = room;
    return true;
}

void path_goes_back(LightPath *p, int i, V3 d, Walk *w)
{
    PathVertex *v = &p->v[i];

    w->ray = vertex_ray(v->at, d);
    w->medium = v->medium = medium_beyond(&v->at->s, d, w->medium);
    w->passes = rgb_all(1.0f);
}

bool path_reaches_lens(LightPath *p, Places where, const Walk *w, CameraSample *c, Tracer *t)
{
    const Camera *camera = t->scene->camera;
    PathVertex *v = &p->v[1];
    Surface *s = &v->at->s;
    LightSample to;
    Ray ray;

    if (!camera->kind->sample(camera, s->p, p->lens, p->time, c) || !places_hold(where, c->pixel))
        return false;
    s->width = c->dist * t->spread;
    vertex_make(v->at, t->scene, w->ray.d);
    v->medium = medium_beyond(s, c->wi, w->medium);
    v->passes = rgb_all(1.0f);
    to = (LightSample){ .wi = c->wi, .dist = c->dist, .p = c->p };
    ray = shadow_ray(s, &to);
    return tracer_passes(t, &ray, v->medium, &v->passes);
}

/* ---- ends ---- */

/* As seen from a point. False: black. */
static bool end_shows(PathEnd *e, V3 from)
{
    LightSample *to = &e->to;
    V3 way;

    e->cosine = 1.0f;
    if (e->light->kind->delta)
        return e->light->kind->sample(e->light, from, (V2){ 0, 0 }, to);
    if (e->light->kind->infinite) {
        *to = (LightSample){ .wi = e->d, .L = e->light->kind->radiance(e->light, e->d, NULL),
                             .dist = INFINITY };
        return !rgb_black(to->L);
    }
    way = v_sub(e->s.p, from);
    *to = (LightSample){ .wi = v_unit(way), .dist = v_len(way), .p = e->s.p, .err = e->s.err,
                         .n = e->s.ng };
    e->cosine = v_absdot(e->s.ng, to->wi);
    to->L = e->light->kind->radiance(e->light, to->wi, &e->s);
    return !rgb_black(to->L);
}

bool path_ends(LightPath *p, const Light *l, const Surface *s, const Walk *w)
{
    PathEnd *e = &p->end;

    e->light = l;
    if (s)
        e->s = *s;
    e->d = w->ray.d;
    e->passes = w->passes;
    e->medium = w->medium;
    return end_shows(e, point_of(p, p->edges - 1));
}

/* ---- joining ---- */

/* What follows vertex i, as it is seen from there; if that is a vertex, it is turned to i. */
static bool shown_next(LightPath *p, int i, LightSample *to)
{
    V3 from = point_of(p, i);
    PathVertex *v = &p->v[i + 1];

    if (i + 1 == p->edges) {
        if (!end_shows(&p->end, from))
            return false;
        if (lamp_is_shape(p->end.light))
            p->end.medium = medium_beyond(&p->end.s, v_neg(p->end.to.wi), p->end.medium);
        *to = p->end.to;
        return true;
    }
    *to = (LightSample){ .wi = v_unit(v_sub(v->at->s.p, from)), .p = v->at->s.p,
                         .dist = v_len(v_sub(v->at->s.p, from)), .err = v->at->s.err,
                         .n = v->at->s.ng };
    seen_along(v, to->wi, to->dist);
    v->medium = medium_beyond(&v->at->s, v_neg(to->wi), v->medium);
    return true;
}

bool path_joins(LightPath *p, int i)
{
    PathVertex *v = &p->v[i];
    LightSample to;

    return shown_next(p, i, &to) && (i + 1 == p->edges || scatters(&p->v[i + 1])) &&
           goes_along(v, to.wi, frame_in(&v->at->frame, to.wi)) && scatters(v);
}

bool path_is_clear(LightPath *p, int i, Tracer *t)
{
    const PathVertex *v = &p->v[i], *next = &p->v[i + 1];
    LightSample to = p->end.to;
    Rgb *passes = i + 1 < p->edges ? &p->v[i + 1].passes : &p->end.passes;
    Ray r;

    if (i + 1 < p->edges)
        to = (LightSample){ .wi = v->way, .dist = next->dist, .p = next->at->s.p,
                            .err = next->at->s.err, .n = next->at->s.ng };
    r = shadow_ray(&v->at->s, &to);
    *passes = rgb_all(1.0f);
    return tracer_passes(t, &r, medium_beyond(&v->at->s, v->way, v->medium), passes);
}

bool path_colours(LightPath *p)
{
    Rgb c = rgb_mul(p->end.to.L, p->end.passes);

    for (int i = 1; i < p->edges; i++)
        c = rgb_mul(c, rgb_mul(p->v[i].scatters, p->v[i].passes));
    p->colour = c;
    return rgb_lum(c) > 0.0f && rgb_finite(c);
}

/* What happens at a vertex that is known but for the weights: by the name of its event. */
static bool acts(PathVertex *v)
{
    BsdfSample s;

    if (path_vertex_is_smooth(v))
        return scatters(v);
    return delta_named(v, v->event, &s) && glints(v, &s, v->event);
}

/* To what follows, whatever happens at the vertex. */
static bool acts_towards_next(LightPath *p, int i)
{
    PathVertex *v = &p->v[i];
    LightSample to;

    return shown_next(p, i, &to) && goes_along(v, to.wi, frame_in(&v->at->frame, to.wi)) &&
           acts(v);
}

bool path_turned_round(LightPath *p, int first, int last, const CameraSample *c)
{
    if (first == 1) {
        p->eye = c->p;
        p->way = v_neg(c->wi);
        p->pixel = c->pixel;
        seen_along(&p->v[1], p->way, c->dist);
    } else if (!acts_towards_next(p, first - 1))
        return false;
    for (int i = first; i <= last; i++)
        if (!acts_towards_next(p, i))
            return false;
    return last + 1 == p->edges || scatters(&p->v[last + 1]);
}

void path_shows(const LightPath *p, double luminance, Tracer *t)
{
    if (luminance > 0.0)
        tracer_splat(t, p->pixel, p->edges, STRATEGY_EXPLICIT,
                     rgb_scale(p->colour, (float)(luminance / rgb_lum(p->colour))));
}

bool path_is_direct(const LightPath *p)
{
    for (int i = 1; i + 1 < p->edges; i++)
        if (path_vertex_is_smooth(&p->v[i]))
            return false;
    return true;
}

/* ---- copies ---- */

void path_shares(LightPath *y, const LightPath *x)
{
    size_t used = offsetof(LightPath, v) + (size_t)x->edges * sizeof x->v[0];

    memcpy(y, x, used);
    y->end = x->end;
    y->colour = x->colour;
}

void path_moves(LightPath *x, const LightPath *y, Vertex **rooms)
{
    for (int i = 1; i < y->edges; i++)
        if (y->v[i].at == rooms[i])
            rooms[i] = x->v[i].at;
    path_shares(x, y);
}

void path_copies(LightPath *y, const LightPath *x, Vertex *const *rooms, const Scene *s)
{
    path_shares(y, x);
    for (int i = 1; i < x->edges; i++) {
        rooms[i]->s = x->v[i].at->s;
        vertex_make(rooms[i], s, v_neg(frame_out(&x->v[i].at->frame, x->v[i].wo)));
        y->v[i].at = rooms[i];
    }
}
