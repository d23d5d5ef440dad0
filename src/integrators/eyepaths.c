/* eyepaths.c -- the code of `eyepaths.h`. */
#include "integrators/eyepaths.h"

void eyepath_begins(const Scene *s, LightPath *p, Tracer *t)
{
    float u = scene_blurs(s) ? sample_1d(&t->sampler, DECISION(DECIDE_TIME, 0)) : 0.0f;

    p->time = scene_time(s, u);
    p->lens = s->camera->has_lens ? sample_2d(&t->sampler, DECISION(DECIDE_LENS, 0))
                                  : (V2){ 0, 0 };
}

double eyepath_turns(LightPath *p, int i, Walk *w, Tracer *t)
{
    const PathVertex *v = &p->v[i];
    BsdfSample s;
    uint32_t event;
    float chance = chance_draws(v->at, v->wo, false, i, t, &event, &s);

    if (!(chance > 0.0f) ||
        !(event == EVENT_SMOOTH ? path_turns_to(p, i, frame_out(&v->at->frame, s.wi), w)
                                : path_turns_by(p, i, event, w)))
        return 0.0;
    return chance;
}

/* Of what the vertex does: a density, or the probability of a delta event. */
static float chance_at(const PathVertex *v)
{
    return chance_of(v->at, v->wo, v->wi, v->event);
}

/* ---- asking for a light ---- */

/* The density with which vertex i asks for the end that follows it. */
static float asked_pdf(const EyePaths *it, const LightPath *p, int i)
{
    const PathVertex *v = &p->v[i];
    const PathEnd *e = &p->end;
    V3 from = v->at->s.p;
    V3 up = vertex_up_from(v->at, v->wo);
    float pmf = it->lights->kind->pmf(it->lights, from, up, e->light);

    if (e->light->kind->delta)
        return pmf;
    return pmf * e->light->kind->pdf_w(e->light, from, e->to.wi,
                                       e->light->kind->infinite ? NULL : &e->s);
}

enum { PLACE_DIGITS = 1000 };           /* to which a ray must meet the point that was asked for */

bool eyepath_meets_point(LightPath *p, const Light *l, V3 point, float dist, Walk *w, Tracer *t)
{
    Surface s;

    if (!ray_meets(t, &w->ray, &w->medium, &w->passes, &s) ||
        scene_light_of(t->scene, &s) != l)
        return false;
    return v_len(v_sub(s.p, point)) * PLACE_DIGITS < dist && path_ends(p, l, &s, w);
}

/* Vertex i asks for a light, which becomes the end; its chance is asked_pdf. False: none, or it is
 * hidden. */
static bool asks(const EyePaths *it, LightPath *p, int i, Tracer *t)
{
    PathVertex *v = &p->v[i];
    float u = it->scene->nlights > 1 ? sample_1d(&t->sampler, DECISION(DECIDE_LIGHT, i)) : 0.0f;
    V2 point = sample_2d(&t->sampler, DECISION(DECIDE_LIGHT_POINT, i));
    V3 up = vertex_up_from(v->at, v->wo);
    float pmf, left;
    const Light *l = it->lights->kind->pick(it->lights, v->at->s.p, up, u, &pmf, &left);
    LightSample ls;
    Walk w;

    if (!(v->at->b->flags & BSDF_SMOOTH) || !l ||
        !l->kind->sample(l, v->at->s.p, point, &ls))
        return false;
    w = (Walk){ vertex_ray(v->at, ls.wi), medium_beyond(&v->at->s, ls.wi, v->medium),
                { 1, 1, 1 }, -1.0f };
    if (lamp_is_shape(l))
        return eyepath_meets_point(p, l, ls.p, ls.dist, &w, t) && path_joins(p, i) &&
               path_colours(p);
    return path_ends(p, l, NULL, &w) && path_joins(p, i) && path_is_clear(p, i, t) &&
           path_colours(p);
}

/* ---- the whole of a path ---- */

/* Meets light l after vertex edges-1, whose chance was this: the density before it is `before`. */
static void completes_by_meeting(const EyePaths *it, LightPath *p, const Light *l,
                                 const Surface *s, const Walk *w, double before,
                                 double chance, Tracer *t, EyePathFound *found, void *ctx)
{
    int last = p->edges - 1;
    float other = 0.0f;

    if (!path_ends(p, l, s, w) || !path_colours(p))
        return;
    if (last > 0 && path_vertex_is_smooth(&p->v[last]))
        other = asked_pdf(it, p, last);
    found(ctx, p, BY_EYE, 1.0 / (before * (chance + other)), t);
}

static void completes_by_asking(const EyePaths *it, LightPath *p, double before, Tracer *t,
                                EyePathFound *found, void *ctx)
{
    int last = p->edges - 1;
    float other = 0.0f;

    if (!asks(it, p, last, t))
        return;
    if (!p->end.light->kind->delta)
        other = chance_at(&p->v[last]);
    found(ctx, p, BY_EYE, 1.0 / (before * ((double)asked_pdf(it, p, last) + other)), t);
}

/* What is left of a unit of energy, for roulette. */
static double strength(const LightPath *p, int last, double density)
{
    double left = 1.0 / density;

    for (int i = 1; i <= last; i++)
        left *= (double)f_sqr(p->v[i].eta) * rgb_max(rgb_mul(p->v[i].scatters, p->v[i].passes));
    return left;
}

/* The probability of going on beyond vertex i. 0: it ends. */
static double survives(const EyePaths *it, const LightPath *p, int i, double density, Tracer *t)
{
    double q;

    if (i < it->roulette)
        return 1.0;
    q = strength(p, i, density);
    if (q >= 1.0)
        return 1.0;
    return sample_1d(&t->sampler, DECISION(DECIDE_ROULETTE, i)) < q ? q : 0.0;
}

void eyepath_traced(const EyePaths *it, LightPath *p, Vertex *const *rooms, Tracer *t,
                    EyePathFound *found, void *ctx, EyeTrace *how)
{
    const Scene *s = it->scene;
    Walk w = path_leaves_eye(p, s);
    double before = 1.0, chance = 1.0, lets = 1.0;      /* of all but the last event, and of that */

    how->met = 0;
    for (int i = 1;; i++) {
        const Surface *at = &rooms[i]->s;
        bool arrived = path_arrives(p, i, &w, rooms[i], t);
        p->edges = i;
        for (size_t k = 0; !arrived && k < s->ninfinite; k++)
            completes_by_meeting(it, p, s->infinite[k], NULL, &w, before, chance, t, found, ctx);
        if (arrived && at->shape->light != NO_LIGHT)
            completes_by_meeting(it, p, scene_light_of(s, at), at, &w, before, chance, t, found,
                                 ctx);
        if (!arrived || i > it->maxdepth)
            return;
        how->met = i;
        how->let[i] = lets;
        before *= chance;
        p->edges = i + 1;
        completes_by_asking(it, p, before, t, found, ctx);
        chance = eyepath_turns(p, i, &w, t);
        if (!(chance > 0.0))
            return;
        lets = survives(it, p, i, before * chance, t);
        before *= lets;
        lets *= how->let[i];
        if (!(before > 0.0))
            return;
    }
}

/* ---- a single new path ---- */

/* The walk meets a light at once. */
static bool meets_light(const EyePaths *it, LightPath *p, Walk *w, Tracer *t)
{
    const Scene *s = it->scene;
    size_t which = 0;
    Surface at;

    if (ray_meets(t, &w->ray, &w->medium, &w->passes, &at))
        return at.shape->light != NO_LIGHT && path_ends(p, scene_light_of(s, &at), &at, w);
    if (!s->ninfinite)
        return false;
    if (s->ninfinite > 1)
        which = (size_t)(sample_1d(&t->sampler, DECISION(DECIDE_LIGHT, p->edges)) *
                         (float)s->ninfinite);
    return path_ends(p, s->infinite[which], NULL, w);
}

static bool is_asking(const PathVertex *v, Tracer *t)
{
    return (v->at->b->flags & BSDF_SMOOTH) &&
           sample_1d(&t->sampler, DECISION(DECIDE_KEEP, 0)) < 0.5f;
}

bool eyepath_new(const EyePaths *it, LightPath *p, Vertex *const *rooms, Tracer *t)
{
    Walk w = path_leaves_eye(p, it->scene);
    int last = p->edges - 1;

    for (int i = 1; i <= last; i++) {
        if (!path_arrives(p, i, &w, rooms[i], t))
            return false;
        if (i == last && is_asking(&p->v[i], t))
            return asks(it, p, i, t);
        if (!(eyepath_turns(p, i, &w, t) > 0.0))
            return false;
    }
    return meets_light(it, p, &w, t) && path_colours(p);
}

/* Of meeting the end, when a walk goes that way: lights beyond the scene are met together. */
static double met(const EyePaths *it, const LightPath *p)
{
    const LightKind *k = p->end.light->kind;
    return k->delta ? 0.0 : k->infinite ? 1.0 / (double)it->scene->ninfinite : 1.0;
}

double eyepath_whole_density(const EyePaths *it, const LightPath *p, double before)
{
    int last = p->edges - 1;
    double meets = p->end.light->kind->delta ? 0.0 : last ? (double)chance_at(&p->v[last]) : 1.0;

    return before *
           (meets + (last && path_vertex_is_smooth(&p->v[last]) ? asked_pdf(it, p, last) : 0.0));
}

double eyepath_density(const EyePaths *it, const LightPath *p, double before)
{
    int last = p->edges - 1;
    double meets = met(it, p);

    if (!last)
        return meets;
    if (meets > 0.0)
        meets *= chance_at(&p->v[last]);
    if (!(p->v[last].at->b->flags & BSDF_SMOOTH))
        return before * meets;
    return before * (0.5 * meets +
                     (path_vertex_is_smooth(&p->v[last]) ? 0.5 * asked_pdf(it, p, last) : 0.0));
}
