/* eyepaths.c -- the code of `eyepaths.h`. */
#include "integrators/eyepaths.h"

void eyepath_begins(const Scene *s, LightPath *p, Tracer *t)
{
    float u = scene_blurs(s) ? sample_1d(&t->sampler, DECISION(DECIDE_TIME, 0)) : 0.0f;

    p->time = scene_time(s, u);
    p->lens = s->camera->has_lens ? sample_2d(&t->sampler, DECISION(DECIDE_LENS, 0))
                                  : (V2){ 0, 0 };
}

/* ---- chances ---- */

/* Of each delta event, and the rest, which is that of the smooth part. */
typedef struct {
    BsdfSample event[BSDF_DELTAS];
    uint32_t name[BSDF_DELTAS];
    float chance[BSDF_DELTAS], smooth;
    int   n;
} Choices;

enum { SMOOTH_LEAST = 16 };             /* the smooth part has at least this part of the chance */

/* By energy: the square of the index ratio is no part of that. */
static void choices(const PathVertex *v, Choices *c)
{
    const Bsdf *b = v->at->b;
    float sum = 0.0f, rest = 0.0f;

    c->n = b->flags & BSDF_SPECULAR ? path_deltas(v->at, v->wo, c->event, c->name) : 0;
    for (int k = 0; k < c->n; k++) {
        c->chance[k] = rgb_lum(c->event[k].weight) * f_sqr(c->event[k].eta);
        sum += c->chance[k];
    }
    if (b->flags & BSDF_SMOOTH)
        rest = f_max(rgb_lum(b->kind->albedo(b, v->wo)) - sum, sum / (SMOOTH_LEAST - 1));
    if (sum + rest > 0.0f)
        for (int k = 0; k < c->n; k++)
            c->chance[k] /= sum + rest;
    c->smooth = sum > 0.0f ? rest / (sum + rest) : b->flags & BSDF_SMOOTH ? 1.0f : 0.0f;
}

static bool only_smooth(const PathVertex *v) { return !(v->at->b->flags & BSDF_SPECULAR); }

/* Of going in a smooth direction. */
static float smooth_pdf(const PathVertex *v, V3 wi)
{
    const Bsdf *b = v->at->b;
    Choices c;

    if (only_smooth(v))
        return b->kind->pdf_w(b, v->wo, wi);
    choices(v, &c);
    return c.smooth * b->kind->pdf_w(b, v->wo, wi);
}

/* Of what the vertex does: a density, or the probability of a delta event. */
static float chance_of(const PathVertex *v)
{
    Choices c;

    if (path_vertex_is_smooth(v))
        return smooth_pdf(v, v->wi);
    choices(v, &c);
    for (int k = 0; k < c.n; k++)
        if (c.name[k] == v->event)
            return c.chance[k];
    return 0.0f;
}

/* On by the smooth part. 0: lost. */
static float turns_smooth(LightPath *p, int i, float lobe, Walk *w, Tracer *t)
{
    const PathVertex *v = &p->v[i];
    const Bsdf *b = v->at->b;
    V2 u = sample_2d(&t->sampler, DECISION(DECIDE_DIRECTION, i));
    BsdfSample s;

    if (!b->kind->sample(b, v->wo, lobe, u, false, &s) || !(s.pdf_w > 0.0f) ||
        !path_turns_to(p, i, frame_out(&v->at->frame, s.wi), w))
        return 0.0f;
    return s.pdf_w;
}

/* Vertex i does something by chance, and the walk goes on; gives the chance. 0: it ends. What is
 * left of the number that chose, chooses within the smooth part. */
static float turns(LightPath *p, int i, Walk *w, Tracer *t)
{
    const PathVertex *v = &p->v[i];
    float u = v->at->b->flags & BSDF_LOBES ? sample_1d(&t->sampler, DECISION(DECIDE_LOBE, i)) : 0;
    Choices c;

    if (only_smooth(v))
        return turns_smooth(p, i, u, w, t);
    choices(v, &c);
    for (int k = 0; k < c.n; u -= c.chance[k++])
        if (u < c.chance[k])
            return path_turns_by(p, i, c.name[k], w) ? c.chance[k] : 0.0f;
    if (!(c.smooth > 0.0f))
        return 0.0f;
    return c.smooth * turns_smooth(p, i, f_min(f_max(u, 0) / c.smooth, ONE_MINUS_ULP), w, t);
}

/* ---- asking for a light ---- */

static V3 up_of(const PathVertex *v)
{
    if (v->at->b->flags & BSDF_TRANSMIT)
        return v_all(0.0f);
    return v->wo.z < 0.0f ? v_neg(v->at->frame.n) : v->at->frame.n;
}

/* The density with which vertex i asks for the end that follows it. */
static float asked_pdf(const EyePaths *it, const LightPath *p, int i)
{
    const PathVertex *v = &p->v[i];
    const PathEnd *e = &p->end;
    V3 from = v->at->s.p;
    float pmf = it->lights->kind->pmf(it->lights, from, up_of(v), e->light);

    if (e->light->kind->delta)
        return pmf;
    return pmf * e->light->kind->pdf_w(e->light, from, e->to.wi,
                                       e->light->kind->infinite ? NULL : &e->s);
}

enum { PLACE_DIGITS = 1000 };           /* to which a ray must meet the point that was asked for */

/* The point of the shape, by the ray that goes there; nothing else may be in its way. */
static bool meets_asked(LightPath *p, const Light *l, const LightSample *ls, Walk *w, Tracer *t)
{
    Surface s;

    if (!ray_meets(t, &w->ray, &w->medium, &w->passes, &s) ||
        scene_light_of(t->scene, &s) != l)
        return false;
    return v_len(v_sub(s.p, ls->p)) * PLACE_DIGITS < ls->dist && path_ends(p, l, &s, w);
}

/* Vertex i asks for a light, which becomes the end; its chance is asked_pdf. False: none, or it is
 * hidden. */
static bool asks(const EyePaths *it, LightPath *p, int i, Tracer *t)
{
    PathVertex *v = &p->v[i];
    float u = it->scene->nlights > 1 ? sample_1d(&t->sampler, DECISION(DECIDE_LIGHT, i)) : 0.0f;
    V2 point = sample_2d(&t->sampler, DECISION(DECIDE_LIGHT_POINT, i));
    float pmf, left;
    const Light *l = it->lights->kind->pick(it->lights, v->at->s.p, up_of(v), u, &pmf, &left);
    LightSample ls;
    Walk w;

    if (!(v->at->b->flags & BSDF_SMOOTH) || !l ||
        !l->kind->sample(l, v->at->s.p, point, &ls))
        return false;
    w = (Walk){ vertex_ray(v->at, ls.wi), medium_beyond(&v->at->s, ls.wi, v->medium),
                { 1, 1, 1 }, -1.0f };
    if (!l->kind->delta && !l->kind->infinite)
        return meets_asked(p, l, &ls, &w, t) && path_joins(p, i) && path_colours(p);
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
    found(ctx, p, 1.0 / (before * (chance + other)), t);
}

static void completes_by_asking(const EyePaths *it, LightPath *p, double before, Tracer *t,
                                EyePathFound *found, void *ctx)
{
    int last = p->edges - 1;
    float other = 0.0f;

    if (!asks(it, p, last, t))
        return;
    if (!p->end.light->kind->delta)
        other = smooth_pdf(&p->v[last], p->v[last].wi);
    found(ctx, p, 1.0 / (before * ((double)asked_pdf(it, p, last) + other)), t);
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
                    EyePathFound *found, void *ctx)
{
    const Scene *s = it->scene;
    Walk w = path_leaves_eye(p, s);
    double before = 1.0, chance = 1.0;          /* of all but the last event, and of that */

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
        before *= chance;
        p->edges = i + 1;
        completes_by_asking(it, p, before, t, found, ctx);
        chance = turns(p, i, &w, t);
        if (!(chance > 0.0))
            return;
        before *= survives(it, p, i, before * chance, t);
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
        if (!(turns(p, i, &w, t) > 0.0f))
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

double eyepath_density(const EyePaths *it, const LightPath *p)
{
    int last = p->edges - 1;
    double density = 1.0;

    for (int i = 1; i < last; i++)
        density *= chance_of(&p->v[i]);
    if (!last)
        return met(it, p);
    if (!(p->v[last].at->b->flags & BSDF_SMOOTH))
        return density * chance_of(&p->v[last]) * met(it, p);
    density *= 0.5 * chance_of(&p->v[last]) * met(it, p) +
               (path_vertex_is_smooth(&p->v[last]) ? 0.5 * asked_pdf(it, p, last) : 0.0);
    return density;
}
