/* particle.h -- light on its way from a lamp: what beam.h is from the eye.
 *
 * Source      [Cline07 7.2, 7.6], [Veach97 4.5, 5.3].
 * Flux        A particle carries L cosine / (probability of the light, pdf_a, pdf_w), in watts,
 *             see Emission; at each event f* |cos| / pdf_w of that is left. So the mean over
 *             particles of what passes through anything is the flux through it.
 * Adjoint     f* is the model's f with its two directions changed, without the square of the index
 *             ratio that radiance has; and with shading normals, which make f what it is,
 *             times |wo.ns| |wi.ng| / (|wo.ng| |wi.ns|): eye paths use |wi.ns| for light that came
 *             through |wi.ng|, and of the same path light paths must make the same. */
#ifndef INTEGRATORS_PARTICLE_H
#define INTEGRATORS_PARTICLE_H

#include "integrators/event.h"
#include "integrators/vertex.h"
#include "lightsampling/lightsampler.h"

typedef struct {
    Ray   ray;
    Rgb   flux;
    float first;                /* largest channel that it began with */
    int   depth;                /* scattering events so far */
    uint32_t medium;            /* that the ray starts in, or NO_MEDIUM */
    bool  deltas;               /* all of the events were of delta */
} Particle;

/* Leaves a lamp, chosen by decisions LIGHT, LIGHT_POINT and DIRECTION number 0; by: a sampler that
 * does not look at points. *e: whence. NULL: no light this time, which counts as a particle. */
const Light *particle_leaves(Particle *p, const LightSampler *by, float time, Tracer *t,
                             Emission *e);

/* On to the next event, see ray_flies; decisions have numbers from 1 on. */
INLINE Event particle_flies(Particle *p, Surface *s, V3 *at, Tracer *t)
{
    return ray_flies(t, &p->ray, &p->medium, p->depth + 1, &p->flux, s, at);
}

/* Goes on from the vertex by chance. False: absorbed. */
bool particle_scatters(Particle *p, const Vertex *v, Tracer *t);
/* In two steps: an event, s->wi of the world and *local, and the turn to it. */
bool particle_samples(const Particle *p, const Vertex *v, Tracer *t, BsdfSample *s, V3 *local);
bool particle_turns(Particle *p, const Vertex *v, const BsdfSample *s, V3 local);
/* From a place in a medium. */
void particle_scatters_within(Particle *p, V3 at, Tracer *t);

/* Russian roulette: after so many events a particle goes on with the probability of what it has
 * left of what it began with. False: it ends. */
bool particle_survives(Particle *p, int roulette, Tracer *t);

/* ---- shading normals ---- */

/* |wo.ns| |wi.ng| / (|wo.ng| |wi.ns|). */
INLINE float vertex_skew(const Vertex *v, V3 wi, V3 local)
{
    V3 wo = frame_out(&v->frame, v->wo);
    float below = fabsf(v_dot(wo, v->s.ng) * local.z);

    return below > 0.0f ? fabsf(v->wo.z * v_dot(wi, v->s.ng)) / below : 0.0f;
}

/* f* |cos| of going on to wi, which vertex_local gives as `local`. */
INLINE Rgb vertex_f_cos_of_light(const Vertex *v, V3 wi, V3 local)
{
    return rgb_scale(v->b->kind->eval(v->b, v->wo, local, true),
                     fabsf(local.z) * vertex_skew(v, wi, local));
}

#endif
