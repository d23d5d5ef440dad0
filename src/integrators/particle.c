/* particle.c -- see particle.h. */
#include "integrators/particle.h"

/* Lights beyond the scene shine through what is all around: of a medium without end nothing is
 * left. */
static bool place(Particle *p, const Scene *s, const Light *l, const Emission *e, float time)
{
    p->medium = s->around;
    if (LIKELY(!s->nmedia))
        return true;
    if (lamp_is_beyond(l))
        return s->around == NO_MEDIUM;
    p->medium = scene_medium_at(s, emission_ray(e, time).o, time);
    return true;
}

const Light *particle_leaves(Particle *p, const LightSampler *by, float time, Tracer *t,
                             Emission *e)
{
    const Scene *s = t->scene;
    float u = s->nlights > 1 ? sample_1d(&t->sampler, DECISION(DECIDE_LIGHT, 0)) : 0.0f;
    float pmf, left;
    const Light *l = by->kind->pick(by, v_all(0.0f), v_all(0.0f), u, &pmf, &left);

    if (!l || !l->kind->emit(l, sample_2d(&t->sampler, DECISION(DECIDE_LIGHT_POINT, 0)),
                             sample_2d(&t->sampler, DECISION(DECIDE_DIRECTION, 0)), e))
        return NULL;
    p->ray = emission_ray(e, time);
    p->flux = rgb_scale(e->L, e->cosine / (pmf * e->pdf_a * e->pdf_w));         /* [Cline07 7.2] */
    p->first = rgb_max(p->flux);
    p->depth = 0;
    p->deltas = true;
    return p->first > 0.0f && place(p, s, l, e, time) ? l : NULL;
}

bool particle_samples(const Particle *p, const Vertex *v, Tracer *t, BsdfSample *s, V3 *local)
{
    V2 u = { 0, 0 };
    float lobe = 0.0f;

    if (v->b->flags & BSDF_LOBES)
        lobe = sample_1d(&t->sampler, DECISION(DECIDE_LOBE, p->depth + 1));
    if (v->b->flags & BSDF_SMOOTH)
        u = sample_2d(&t->sampler, DECISION(DECIDE_DIRECTION, p->depth + 1));
    if (!v->b->kind->sample(v->b, v->wo, lobe, u, true, s))
        return false;
    *local = s->wi;
    return vertex_turns(v, s);
}

bool particle_turns(Particle *p, const Vertex *v, const BsdfSample *s, V3 local)
{
    p->flux = rgb_scale(rgb_mul(p->flux, s->weight), vertex_skew(v, s->wi, local));
    p->ray = vertex_ray(v, s->wi);
    p->medium = medium_beyond(&v->s, s->wi, p->medium);
    p->deltas = p->deltas && s->pdf_w == 0.0f;
    p->depth++;
    return !rgb_black(p->flux);
}

bool particle_scatters(Particle *p, const Vertex *v, Tracer *t)
{
    BsdfSample s;
    V3 local;

    return particle_samples(p, v, t, &s, &local) && particle_turns(p, v, &s, local);
}

void particle_scatters_within(Particle *p, V3 at, Tracer *t)
{
    p->ray.d = phase_sample(t->scene->media[p->medium].g, p->ray.d,
                            sample_2d(&t->sampler, DECISION(DECIDE_DIRECTION, p->depth + 1)));
    p->ray.o = at;
    p->ray.tmax = INFINITY;
    p->deltas = false;
    p->depth++;
}

bool particle_survives(Particle *p, int roulette, Tracer *t)
{
    float q = rgb_max(p->flux) / p->first;

    if (p->depth < roulette || q >= 1.0f)
        return true;
    if (!(q > 0.0f) || sample_1d(&t->sampler, DECISION(DECIDE_ROULETTE, p->depth + 1)) >= q)
        return false;
    p->flux = rgb_scale(p->flux, 1.0f / q);
    return true;
}
