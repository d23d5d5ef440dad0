/* beam.c -- the code of `beam.h` */
#include "integrators/beam.h"

bool beam_meets(Beam *b, Surface *s, Tracer *t)
{
    V3 from = b->ray.o;

    if (!ray_meets(t, &b->ray, &b->medium, &b->throughput, s))
        return false;
    beam_widens(b, from, s, t);
    return true;
}

Rgb beam_shows(const Beam *b, const Light *l, const Surface *hit, Tracer *t)
{
    Rgb c = rgb_mul(b->throughput, l->kind->radiance(l, b->ray.d, hit));

    if (!rgb_black(c))
        tracer_tally(t, b->depth + 1, STRATEGY_IMPLICIT, c);
    return c;
}

Rgb beam_shows_beyond(const Beam *b, Tracer *t)
{
    Rgb sum = rgb_all(0.0f);

    for (size_t i = 0; i < t->scene->ninfinite; i++)
        sum = rgb_add(sum, beam_shows(b, t->scene->infinite[i], NULL, t));
    return sum;
}

void beam_turn(Beam *b, const Vertex *v, const BsdfSample *s)
{
    b->ray = vertex_ray(v, s->wi);
    b->throughput = rgb_mul(b->throughput, s->weight);
    b->eta2 *= s->eta * s->eta;
    if (s->flags & BSDF_SMOOTH)
        b->way = -1.0f;
    b->depth++;
    b->medium = medium_beyond(&v->s, s->wi, b->medium);
}

bool beam_turns_by_delta(Beam *b, const Vertex *v, Tracer *t)
{
    BsdfSample bs;

    if (!(v->b->flags & BSDF_SPECULAR) || !vertex_sample(v, t, b->depth, &bs) || bs.pdf_w > 0.0f)
        return false;
    beam_turn(b, v, &bs);
    return !rgb_black(b->throughput);
}

/* With probability q, so much the stronger then. False: it ends. */
static bool goes_on(Beam *b, float q, Tracer *t)
{
    if (!(q > 0.0f) || q >= 1.0f)
        return q > 0.0f;
    if (sample_1d(&t->sampler, DECISION(DECIDE_ROULETTE, b->depth)) >= q)
        return false;
    b->throughput = rgb_scale(b->throughput, 1.0f / q);
    return true;
}

/* By chance if it is weak: less than half of what glass reflects from the front. */
static bool is_taken(Beam *b, Tracer *t)
{
    const float weak = 0.02f;
    return goes_on(b, beam_strength(b) / weak, t);
}

bool beam_survives(Beam *b, int roulette, Tracer *t)
{
    return b->depth < roulette || goes_on(b, beam_strength(b), t);
}

bool beam_lasts(Beam *b, int roulette, Tracer *t)
{
    return b->way < 0.0f ? beam_survives(b, roulette, t) : is_taken(b, t);
}

bool beam_forks(Forks *f, const Beam *b, const Vertex *v, Tracer *t)
{
    BsdfSample s[BSDF_DELTAS];
    int n;

    if (b->depth >= FORKED || b->way < 0.0f || !(v->b->flags & BSDF_SPECULAR))
        return false;
    n = bsdf_deltas(v->b, v->wo, s);
    for (int k = 0; k < n; k++) {
        Beam on = *b;
        if (!vertex_turns(v, &s[k]))
            continue;
        beam_turn(&on, v, &s[k]);
        if (is_taken(&on, t))
            f->waiting[f->n++] = on;
    }
    return true;
}
