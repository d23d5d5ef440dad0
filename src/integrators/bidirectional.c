/* bidirectional.c -- the half of bidirectional.h that begins at the eye, and joins the two. */
#include "integrators/ends.h"
#include "integrators/lightstore.h"

static void tally_radius(Tracer *t, int i, Rgb c)
{
    if (t->tally)
        t->tally->radius[i] = rgb_add(t->tally->radius[i], c);
}

/* See Lens in bidirectional.h. */
static const float SHOWN = 1.0f / 3.0f;

/* ---- the eye's path ---- */

/* Of a split path: what it is before its next vertex tells whether all parts of it go on. */
typedef enum { WHOLE, FIRST_PART, OTHER_PART } Part;

typedef struct {
    Beam beam;
    V3   p, up;                 /* its last vertex, as lamps are asked from there */
    Odds odds;                  /* before the ray arrives */
    float found;                /* so far, by joining: largest channels */
    float share;                /* of all rays that it was split into */
    Part  part;
} Eye;

static Eye eye_begin(const Bidirectional *b, const Ray *r)
{
    const Camera *c = b->scene->camera;
    Eye e = { .beam = beam_from_eye(r, b->scene), .p = r->o, .share = 1.0f };
    CameraView view;
    float pdf;

    if (b->techniques.connects && c->kind->view(c, r, &view)) {
        pdf = c->parallel ? view.we : view.pdf_w;
        e.odds.last = raised(&b->techniques, b->shown / pdf);
    }
    return e;
}

/* As it counts: c, what a technique of so many lamp vertices brings without weight and share. */
static Rgb weighed(const Bidirectional *b, const Eye *e, Rivals r, Rgb c, int vertices, Tracer *t)
{
    static const Strategy strategy[] = { STRATEGY_IMPLICIT, STRATEGY_EXPLICIT, STRATEGY_CONNECT };
    float weight = rivals_connected(r, &b->techniques, b->techniques.eta);
    Rgb counts;

    c = rgb_scale(c, e->share);
    counts = rgb_scale(c, weight);
    if (LIKELY(!t->tally))
        return counts;
    tracer_tally(t, e->beam.depth + 1 + vertices, strategy[vertices < 2 ? vertices : 2], counts);
    tracer_technique(t, vertices, e->beam.depth + 2, weight, c);
    for (int i = 0; i < b->radii; i++)
        tally_radius(t, i, rgb_scale(c, rivals_connected(r, &b->techniques, b->by[i].eta)));
    return counts;
}

/* Of having met the lamp; cosine: at the lamp, 1 if it is beyond the scene. */
static Rivals rivals_of_meeting(const Bidirectional *b, const Eye *e, const Light *l,
                                const Surface *hit, float cosine)
{
    const Techniques *q = &b->techniques;
    V3 d = e->beam.ray.d;
    float sent;
    Rivals r;

    if (e->beam.depth == 0 || b->joins != JOINS_ALL)
        return (Rivals){ 0.0f, 0.0f };
    sent = raised(q, cosine > 0.0f ? sent_pdf(b, l, hit, v_neg(d)) / cosine : 0.0f);
    r = (Rivals){ sent * e->odds.early,
                  sent * (q->straight ? e->odds.merged + e->odds.latest : e->odds.merged) };
    if (e->odds.last > 0.0f)
        r.connect += raised(q, asked_pdf(b, l, e->p, e->up, d, hit)) * e->odds.last;
    return r;
}

static Rgb implicit_light(const Bidirectional *b, const Eye *e, const Light *l, const Surface *hit,
                          float cosine, Tracer *t)
{
    Rgb c = rgb_mul(e->beam.throughput, l->kind->radiance(l, e->beam.ray.d, hit));

    if (rgb_black(c) || !tracer_makes(t, e->beam.depth + 1, 0, true))
        return rgb_all(0.0f);
    return weighed(b, e, rivals_of_meeting(b, e, l, hit, cosine), c, 0, t);
}

static Rgb implicit_sky(const Bidirectional *b, const Eye *e, Tracer *t)
{
    Rgb sum = rgb_all(0.0f);

    for (size_t i = 0; i < b->scene->ninfinite; i++)
        sum = rgb_add(sum, implicit_light(b, e, b->scene->infinite[i], NULL, 1.0f, t));
    return sum;
}

/* ---- joining ---- */

/* What the eye's vertex says of a direction: f |cos|, and densities of going that way and, coming
 * from there, of going back to where it was seen from. False: nothing. */
typedef struct { Rgb f_cos; float forth, back, cosine; } Seen;

static bool see(const Vertex *v, V3 wi, Seen *s)
{
    V3 local;

    if (!vertex_local(v, wi, &local))
        return false;
    s->f_cos = vertex_f_cos(v, local);
    if (rgb_black(s->f_cos))
        return false;
    s->forth = vertex_pdf_w(v, local);
    s->back = v->b->kind->pdf_w(v->b, local, v->wo);
    s->cosine = v_absdot(v->s.ng, wi);
    return true;
}

/* Of the vertex where the eye's path is. */
static bool merges_here(const Bidirectional *b, const Eye *e)
{
    return b->techniques.first || e->beam.depth > 0;
}

/* What brings little beside what the sample has found is worth a ray by chance only: c then stands
 * for those that were left out. The chance looks at what is known before the ray, so the mean is
 * what it was. False: no ray. [Cline07 7.9.2] */
static bool tries(const Bidirectional *b, const Eye *e, float weight, int vertices, Rgb *c,
                  Tracer *t)
{
    float least = b->little * e->found, brings = rgb_max(*c) * weight * e->share;

    if (brings >= least)
        return true;
    if (sample_1d(&t->sampler, DECISION(DECIDE_KEEP, e->beam.depth * (DEPTH_MOST + 1) + vertices)) *
        least >= brings)
        return false;
    *c = rgb_scale(*c, least / brings);
    return true;
}

/* c as it counts, by an edge to the last of so many vertices from the lamp, if nothing stands in
 * the way. */
static Rgb join(const Bidirectional *b, Eye *e, const Vertex *z, const LightSample *to, Rivals r,
                Rgb c, int vertices, Tracer *t)
{
    Ray ray;

    if (!tries(b, e, rivals_connected(r, &b->techniques, b->techniques.eta), vertices, &c, t))
        return rgb_all(0.0f);
    t->work.joins++;
    ray = shadow_ray(&z->s, to);
    if (!tracer_passes(t, &ray, medium_beyond(&z->s, to->wi, e->beam.medium), &c))
        return rgb_all(0.0f);
    c = weighed(b, e, r, c, vertices, t);
    e->found += rgb_max(c);
    return c;
}

static Rgb ask(const Bidirectional *b, Eye *e, const Vertex *z, Tracer *t)
{
    float u = b->scene->nlights > 1 ? sample_1d(&t->sampler, DECISION(DECIDE_LIGHT, e->beam.depth))
                                    : 0.0f;
    float pmf, left, pdf, d2;
    V3 up = vertex_up(z);
    const Light *l = b->asked->kind->pick(b->asked, z->s.p, up, u, &pmf, &left);
    LightSample ls;
    Surface there;
    Rivals r;
    Seen s;

    if (!l || !light_sample(l, b->beside, z->s.p,
                            sample_2d(&t->sampler, DECISION(DECIDE_LIGHT_POINT, e->beam.depth)),
                            &ls) || !see(z, ls.wi, &s))
        return rgb_all(0.0f);
    there = surface_at(ls.p, ls.err, ls.n, (V2){ 0, 0 });
    pdf = pmf * ls.pdf_w;
    d2 = lamp_is_beyond(l) ? 1.0f : ls.dist * ls.dist;
    r = rivals_at(&e->odds, &b->techniques, s.back,
                  b->techniques.straight && merges_here(b, e),
                  sent_pdf(b, l, &there, v_neg(ls.wi)) * s.cosine /
                      (d2 * per_area(l, pdf, ls.n, ls.wi, d2)));
    if (!l->kind->delta)
        r.connect += raised(&b->techniques, s.forth / pdf);
    return join(b, e, z, &ls, r,
                rgb_scale(rgb_mul(rgb_mul(e->beam.throughput, s.f_cos), ls.L), 1.0f / pdf), 1, t);
}

static Rgb connect(const Bidirectional *b, Eye *e, const Vertex *z, const LightVertex *y,
                   Tracer *t)
{
    const Techniques *q = &b->techniques;
    V3 way = v_sub(y->v.s.p, z->s.p), wi, local;
    float d2 = v_dot(way, way);
    LightSample to;
    Rivals r;
    Seen s;
    Rgb c;

    if (!(d2 > 0.0f))
        return rgb_all(0.0f);
    wi = v_scale(way, 1.0f / sqrtf(d2));
    if (!vertex_local(&y->v, v_neg(wi), &local) || !see(z, wi, &s))
        return rgb_all(0.0f);
    c = rgb_mul(rgb_mul(e->beam.throughput, s.f_cos),
                rgb_mul(y->flux, vertex_f_cos_of_light(&y->v, v_neg(wi), local)));
    if (rgb_black(c))
        return c;
    r = rivals_add(rivals_at(&y->odds, q, y->v.b->kind->pdf_w(y->v.b, local, y->v.wo),
                             merges_light(b, y->edges),
                             s.forth * v_absdot(y->v.s.ng, wi) / d2),
                   rivals_at(&e->odds, q, s.back, merges_here(b, e),
                             vertex_pdf_w(&y->v, local) * s.cosine / d2));
    to = (LightSample){ .wi = wi, .dist = sqrtf(d2), .p = y->v.s.p, .err = y->v.s.err,
                        .n = y->v.s.ng };
    return join(b, e, z, &to, r, rgb_scale(c, 1.0f / d2), y->edges + 1, t);
}

enum { GATHERED = 16 };

/* What of the light path's vertex goes to the eye, without weight and density, and the techniques
 * beside. False: nothing. */
static bool merge(const Bidirectional *b, const Eye *e, const Vertex *z, const KeptVertex *k,
                  Rgb *c, Rivals *r)
{
    const Techniques *q = &b->techniques;
    V3 wi = v_neg(kept_way(k)), local;
    Odds light = kept_odds(k);

    if ((int)k->edges + e->beam.depth > b->maxdepth || !vertex_local(z, wi, &local))
        return false;
    *c = rgb_mul(z->b->kind->eval(z->b, z->wo, local, false),
                 rgb(k->flux[0], k->flux[1], k->flux[2]));
    if (rgb_black(*c))
        return false;
    *c = rgb_scale(rgb_mul(e->beam.throughput, *c),
                   e->share * fabsf(local.z) / v_absdot(wi, z->s.ng));
    *r = (Rivals){ 0.0f, 0.0f };
    if (b->joins == JOINS_ALL)
        *r = rivals_add(rivals_before(&light, q, vertex_pdf_w(z, local)),
                        rivals_before(&e->odds, q, z->b->kind->pdf_w(z->b, local, z->wo)));
    return true;
}

/* A vertex of a light path that is near: the place, and the rest sent for. */
typedef struct { const KeptVertex *k; float d2; } Near;

static int gather(const Bidirectional *b, PointWalk *w, Near near[GATHERED])
{
    const PlacedPoint *found;
    float d2;
    int n = 0;

    while (n < GATHERED && (found = pointgrid_next(w, &d2))) {
        near[n] = (Near){ arrivals_record(&b->store->arrivals, found->id), d2 };
        PREFETCH(near[n].k);
        n++;
    }
    return n;
}

static Rgb merge_all(const Bidirectional *b, const Eye *e, const Vertex *z, PointWalk *w, Tracer *t)
{
    const Techniques *q = &b->techniques;
    Rgb sum = rgb_all(0.0f);
    Near near[GATHERED];
    int n;

    while ((n = gather(b, w, near)))
        for (int i = 0; i < n; i++) {
            Rgb c, counts;
            Rivals r;
            if (!merge(b, e, z, near[i].k, &c, &r))
                continue;
            t->work.mergers++;
            counts = rgb_scale(c, rivals_merged(r, q, q->eta) / q->eta);       /* [GIRT (3.5)] */
            tracer_tally(t, (int)near[i].k->edges + e->beam.depth + 1, STRATEGY_MERGE, counts);
            for (int j = 0; j < b->radii; j++)
                if (near[i].d2 < b->by[j].radius * b->by[j].radius)
                    tally_radius(t, j, rgb_scale(c, rivals_merged(r, q, b->by[j].eta) /
                                                    b->by[j].eta));
            sum = rgb_add(sum, counts);
        }
    return sum;
}

static Rgb connect_all(const Bidirectional *b, Eye *e, const Vertex *z, const LightVertex *path,
                       int n, Tracer *t)
{
    Rgb sum = rgb_all(0.0f);

    if (tracer_makes(t, e->beam.depth + 1, 0, false))
        sum = ask(b, e, z, t);
    for (int i = 0; i < n && e->beam.depth + 1 + path[i].edges <= b->maxdepth; i++)
        if (tracer_makes(t, e->beam.depth + 1, path[i].edges, false))
            sum = rgb_add(sum, connect(b, e, z, &path[i], t));
    return sum;
}

static Rgb join_all(const Bidirectional *b, Eye *e, const Vertex *z, const LightVertex *path,
                    int n, Tracer *t)
{
    bool merges = b->store && b->techniques.eta > 0.0f && merges_here(b, e);
    Rgb sum = rgb_all(0.0f);
    PointWalk w;

    if (merges)                 /* begun early: see pointgrid.c */
        w = pointgrid_walk(&b->store->arrivals.grid, z->s.p, b->store->radius);
    if (b->techniques.connects)
        sum = connect_all(b, e, z, path, n, t);
    return merges ? rgb_add(sum, merge_all(b, e, z, &w, t)) : sum;
}

/* ---- the eye's path, from event to event ---- */

static bool go_on(const Bidirectional *b, Eye *e, const Vertex *z, Tracer *t)
{
    BsdfSample s;
    float cosine;
    V3 local;

    if (!vertex_sample(z, t, e->beam.depth, &s) ||
        (b->joins == JOINS_FIRST_MERGER && s.pdf_w > 0.0f))
        return false;
    cosine = v_absdot(z->s.ng, s.wi);
    local = frame_in(&z->frame, s.wi);
    if (s.pdf_w > 0.0f)
        odds_scatter(&e->odds, &b->techniques, cosine, s.pdf_w,
                     z->b->kind->pdf_w(z->b, local, z->wo), merges_here(b, e));
    else
        odds_turn(&e->odds, &b->techniques, cosine);
    e->p = z->s.p;
    e->up = vertex_up(z);
    beam_turn(&e->beam, z, &s);
    return beam_survives(&e->beam, b->roulette, t);
}

/* The first vertex of its path that is no delta is seen by way of such. */
static bool splits(const Bidirectional *b, const Eye *e, const Vertex *z)
{
    return b->split > 1 && e->beam.depth > 0 && e->beam.way >= 0.0f && vertex_is_smooth(z);
}

/* At the next vertex after splitting. False: this part ends, others stand for it. */
static bool part_counts(const Bidirectional *b, Eye *e, const Vertex *z)
{
    Part part = e->part;

    e->part = WHOLE;
    if (part == WHOLE || vertex_is_smooth(z))
        return part != OTHER_PART;
    e->share /= (float)b->split;
    return true;
}

/* What a vertex that is a lamp, or scatters, brings. */
static Rgb found_at(const Bidirectional *b, Eye *e, const Vertex *z, const LightVertex *path, int n,
                    Tracer *t)
{
    float cosine = v_absdot(z->s.ng, e->beam.ray.d);
    Rgb sum = rgb_all(0.0f);
    float d2;

    if (z->s.shape->light != NO_LIGHT)
        sum = implicit_light(b, e, scene_light_of(b->scene, &z->s), &z->s, cosine, t);
    if (e->beam.depth >= b->maxdepth || b->joins == JOINS_LENS)
        return sum;
    d2 = e->beam.depth == 0 && b->scene->camera->parallel ? 1.0f
                                                          : v_len2(v_sub(z->s.p, e->p));
    odds_arrive(&e->odds, &b->techniques, d2, cosine);
    return vertex_is_smooth(z) ? rgb_add(sum, join_all(b, e, z, path, n, t)) : sum;
}

static bool ends_at(const Bidirectional *b, const Eye *e, const Tracer *t)
{
    return e->beam.depth >= b->maxdepth || b->joins == JOINS_LENS ||
           (t->only && e->beam.depth + 1 >= t->only->eye);
}

static Rgb follow(const Bidirectional *b, Eye *e, const LightVertex *path, int n, Tracer *t);

/* What the other parts of the path bring, which is split at z: not again. */
static Rgb follow_others(const Bidirectional *b, const Eye *e, const Vertex *z,
                         const LightVertex *path, int n, Tracer *t)
{
    Sampler whole = t->sampler, others = whole;
    uint32_t parts = (uint32_t)b->split - 1;
    Rgb sum = rgb_all(0.0f);

    sampler_other(&others, PATH_SPLIT);
    for (uint32_t k = 0; k < parts; k++) {
        Eye other = *e;
        other.part = OTHER_PART;
        t->sampler = sampler_part(&others, parts, k);
        if (go_on(b, &other, z, t))
            sum = rgb_add(sum, follow(b, &other, path, n, t));
    }
    t->sampler = whole;
    return sum;
}

/* The path from its next event on. */
static Rgb follow(const Bidirectional *b, Eye *e, const LightVertex *path, int n, Tracer *t)
{
    Rgb sum = rgb_all(0.0f);

    for (;;) {
        Vertex z;
        if (!beam_meets(&e->beam, &z.s, t))
            return e->part == OTHER_PART ? sum : rgb_add(sum, implicit_sky(b, e, t));
        t->work.eye_edges++;
        vertex_make(&z, b->scene, e->beam.ray.d);
        if (!part_counts(b, e, &z))
            return sum;
        sum = rgb_add(sum, found_at(b, e, &z, path, n, t));
        if (ends_at(b, e, t))
            return sum;
        if (splits(b, e, &z)) {
            sum = rgb_add(sum, follow_others(b, e, &z, path, n, t));
            e->part = FIRST_PART;
        }
        if (!go_on(b, e, &z, t))
            return sum;
    }
}

Rgb bidirectional_look(const Bidirectional *b, const Ray *r, const LightVertex *path, int n,
                       Tracer *t)
{
    Eye e = eye_begin(b, r);

    t->work.from_eye++;
    return t->only && t->only->eye == 0 ? rgb_all(0.0f) : follow(b, &e, path, n, t);
}

/* ---- opening ---- */

bool bidirectional_open(Bidirectional *b, const char *name, const Scene *s, const Opts *o)
{
    b->scene = s;
    b->maxdepth = (int)opt_int(o, "maxdepth");
    b->roulette = (int)opt_int(o, "roulette");
    b->split = (int)opt_int(o, "split");
    b->little = opt_float(o, "little");
    b->techniques.heuristic = opt_is(o, "weights", "power")     ? HEURISTIC_POWER
                              : opt_is(o, "weights", "balance") ? HEURISTIC_BALANCE
                                                                : HEURISTIC_UNIFORM;
    b->techniques.connects = true;
    /* a count of techniques has to know which can make a path: what one leaves to others can't be
     * told */
    b->beside = b->techniques.heuristic != HEURISTIC_UNIFORM;
    b->shown = SHOWN;
    b->asked = lightsampler_open(opt_string(o, "lightsampler"), s);
    b->sending = lightsampler_open("power", s);
    return b->asked && b->sending && warn_of_scattering(s, name);
}

void bidirectional_clear(Bidirectional *b)
{
    lightsampler_close(b->asked);
    lightsampler_close(b->sending);
}
