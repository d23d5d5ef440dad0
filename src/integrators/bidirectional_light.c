/* bidirectional_light.c -- the half of bidirectional.h that begins at the lamps: a light path,
 * shown to the lens as it goes, and kept for the eye's half to join. */
#include "integrators/ends.h"
#include "integrators/lens.h"

/* How it began: what its second vertex asks about. */
typedef struct {
    const Light *lamp;
    Emission e;
    float pdf;                  /* of sending it */
} Start;

static bool leave(const Bidirectional *b, Particle *p, float time, Start *s, Odds *o, Tracer *t)
{
    const LightSampler *by = b->sending;
    float cosine;

    s->lamp = particle_leaves(p, by, time, t, &s->e);
    if (!s->lamp)
        return false;
    s->pdf = by->kind->pmf(by, v_all(0.0f), v_all(0.0f), s->lamp) * s->e.pdf_a * s->e.pdf_w;
    cosine = lamp_is_beyond(s->lamp) ? 1.0f : s->e.cosine;
    *o = (Odds){ 0.0f, s->lamp->kind->delta ? 0.0f : raised(&b->techniques, cosine / s->pdf),
                 0.0f, 0.0f };
    return true;
}

/* How the lamp would have been asked by the second vertex, instead. */
static float last_of_lamp(const Bidirectional *b, const Start *s, const Vertex *v, V3 d, float d2)
{
    Surface there = surface_at(s->e.p, s->e.err, s->e.n, s->e.uv);
    float pdf;

    if (!b->techniques.connects || !vertex_is_smooth(v))
        return 0.0f;
    pdf = asked_pdf(b, s->lamp, v->s.p, vertex_up(v), v_neg(d),
                    s->lamp->kind->infinite ? NULL : &there);
    return raised(&b->techniques, per_area(s->lamp, pdf, s->e.n, d, d2) / s->pdf);
}

/* On to the next surface, which *y then is. False: there is none. */
static bool arrive(const Bidirectional *b, Particle *p, const Start *start, V3 *from, Odds *o,
                   LightVertex *y, Tracer *t)
{
    V3 way;
    float d2;

    if (!ray_hits(t, &p->ray, &p->medium, &p->flux, &y->hit, &y->v.s))
        return false;
    vertex_make(&y->v, b->scene, p->ray.d);
    way = v_sub(y->v.s.p, *from);
    d2 = v_dot(way, way);
    if (p->depth == 0) {
        o->last = last_of_lamp(b, start, &y->v, p->ray.d, d2);
        if (lamp_is_beyond(start->lamp))
            d2 = 1.0f;
    }
    odds_arrive(o, &b->techniques, d2, v_absdot(y->v.s.ng, p->ray.d));
    *from = y->v.s.p;
    y->flux = p->flux;
    y->odds = *o;
    y->d = p->ray.d;
    y->medium = p->medium;
    y->edges = p->depth + 1;
    return true;
}

static bool scatter(const Bidirectional *b, Particle *p, const Vertex *v, Odds *o, Tracer *t)
{
    BsdfSample s;
    float cosine;
    V3 local;

    if (!particle_samples(p, v, t, &s, &local))
        return false;
    cosine = v_absdot(v->s.ng, s.wi);
    if (s.pdf_w > 0.0f)
        odds_scatter(o, &b->techniques, cosine, s.pdf_w, v->b->kind->pdf_w(v->b, local, v->wo),
                     merges_light(b, p->depth + 1));
    else
        odds_turn(o, &b->techniques, cosine);
    return particle_turns(p, v, &s, local) && particle_survives(p, b->roulette, t);
}

/* The same for those who want to know more than the picture. */
static void show_beside(const Bidirectional *b, const CameraSample *c, int edges, Rivals r,
                        float weight, Rgb seen, Tracer *t)
{
    const Canvas *k = t->canvas;

    tracer_technique(t, edges, 1, weight, seen);
    if (!k)
        return;
    if (edges < TALLY_LENGTHS)
        tracer_splat_beside(t, c->pixel, k->bare[edges], seen);
    for (int i = 0; i < b->radii; i++)
        tracer_splat_beside(t, c->pixel, k->radius[i],
                            rgb_scale(seen, rivals_connected(r, &b->techniques, b->by[i].eta)));
}

/* Shows it to the lens: c.we / c.pdf_w |cos| is the density per area with which the eye's rays find
 * the vertex, over that of the place on the lens. */
static void show(const Bidirectional *b, const LightVertex *y, Tracer *t)
{
    const Techniques *q = &b->techniques;
    const Vertex *v = &y->v;
    Rivals r = { 0.0f, 0.0f };
    CameraSample c;
    float weight;
    Rgb seen;
    V3 local;

    if (!lens_from(v->s.p, v->s.time, y->edges, t, &c) || !vertex_local(v, c.wi, &local))
        return;
    seen = rgb_mul(y->flux, vertex_f_cos_of_light(v, c.wi, local));
    if (rgb_black(seen))
        return;
    t->work.joins++;
    seen = lens_sees(&c, &v->s, medium_beyond(&v->s, c.wi, y->medium), seen, t);
    if (rgb_black(seen))
        return;
    if (b->joins == JOINS_ALL)
        r = rivals_at(&y->odds, q, v->b->kind->pdf_w(v->b, local, v->wo),
                      q->first && merges_light(b, y->edges),
                      c.we / c.pdf_w * v_absdot(v->s.ng, c.wi) / b->shown);
    weight = rivals_connected(r, q, q->eta);
    tracer_splat(t, c.pixel, y->edges + 1, STRATEGY_LENS, rgb_scale(seen, weight));
    show_beside(b, &c, y->edges + 1, r, weight, seen, t);
}

int bidirectional_light(const Bidirectional *b, float time, LightVertex *path, Tracer *t)
{
    Start start;
    Particle p;
    Odds odds;
    V3 from;
    int n = 0, most = t->only && t->only->light < b->maxdepth ? t->only->light : b->maxdepth;

    t->shots++;
    t->work.from_lamps++;
    if (most == 0 || !leave(b, &p, time, &start, &odds, t))
        return 0;
    from = start.e.p;
    while (p.depth < most) {
        LightVertex *y = &path[n];
        if (!arrive(b, &p, &start, &from, &odds, y, t))
            break;
        t->work.lamp_edges++;
        if (vertex_is_smooth(&y->v)) {
            if ((b->techniques.connects || b->joins == JOINS_LENS) &&
                tracer_makes(t, 0, y->edges, false))
                show(b, y, t);
            n++;
        }
        if (!scatter(b, &p, &y->v, &odds, t))
            break;
    }
    return n;
}
