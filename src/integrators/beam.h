/* beam.h -- what is followed back from the eye: a ray, with all that its next surface needs to know
 * of its past. For methods that ignore light scattered by media, but not what these take away. */
#ifndef INTEGRATORS_BEAM_H
#define INTEGRATORS_BEAM_H

#include "integrators/vertex.h"

typedef struct {
    Ray   ray;
    Rgb   throughput;           /* what of the light along the ray gets to the eye */
    float eta2;                 /* product of squared index ratios: the scale of radiance */
    float way;                  /* from the eye, by delta events only; below 0: there were others */
    int   depth;                /* scattering events so far */
    uint32_t medium;            /* that the ray starts in, or NO_MEDIUM */
} Beam;

INLINE Beam beam_from_eye(const Ray *r, const Scene *s)
{
    return (Beam){ *r, { 1, 1, 1 }, 1.0f, 0.0f, 0, s->around };
}

/* What the beam meets, through borders of media; throughput loses what these take on the way.
 * False: it leaves the scene, or nothing is left of it. */
bool beam_meets(Beam *b, Surface *s, Tracer *t);

/* Goes on from the vertex by that event, s->wi of the world. */
void beam_turn(Beam *b, const Vertex *v, const BsdfSample *s);

/* How much of a unit of energy is left, whatever the index it is in. */
INLINE float beam_strength(const Beam *b) { return rgb_max(b->throughput) * b->eta2; }

#endif
