/* beam.h -- what is followed back from the eye: a ray, with all that its next event needs to know
 * of its past. */
#ifndef INTEGRATORS_BEAM_H
#define INTEGRATORS_BEAM_H

#include "integrators/event.h"
#include "integrators/vertex.h"

typedef struct {
    Ray   ray;
    Rgb   throughput;           /* what of the light along the ray gets to the eye */
    float eta2;                 /* product of squared index ratios, the scale of radiance; and of
                                 * how much more often a guide takes such ways */
    float way;                  /* from the eye, by delta events only; below 0: there were others */
    int   depth;                /* scattering events so far */
    uint32_t medium;            /* that the ray starts in, or NO_MEDIUM */
} Beam;

INLINE Beam beam_from_eye(const Ray *r, const Scene *s)
{
    return (Beam){ *r, { 1, 1, 1 }, 1.0f, 0.0f, 0, s->around };
}

/* The beam of a pixel is as wide as the way from the eye is long. Past an event that spreads it,
 * all beams see textures sharp: what they find there must not depend on how they came. */
INLINE void beam_widens(Beam *b, V3 from, Surface *s, const Tracer *t)
{
    if (b->way >= 0.0f) {
        b->way += v_len(v_sub(s->p, from));
        s->width = b->way * t->spread;
    }
}

/* On to the next event, see ray_flies: *s is set where it ARRIVES, *p where it SCATTERS. */
INLINE Event beam_flies(Beam *b, Surface *s, V3 *p, Tracer *t)
{
    V3 from = b->ray.o;
    Event event = ray_flies(t, &b->ray, &b->medium, b->depth, &b->throughput, s, p);

    if (event == ARRIVES)
        beam_widens(b, from, s, t);
    return event;
}

/* What the beam meets, for methods that ignore light scattered by media, but not what these take
 * away: throughput loses it. False: it leaves the scene, or nothing is left of it. */
bool beam_meets(Beam *b, Surface *s, Tracer *t);

/* What a light at the beam's end shows, or those beyond the scene: all of it, for beams whose light
 * no other way could find. */
Rgb beam_shows(const Beam *b, const Light *l, const Surface *hit, Tracer *t);
Rgb beam_shows_beyond(const Beam *b, Tracer *t);

/* Goes on from the vertex by that event, s->wi of the world. */
void beam_turn(Beam *b, const Vertex *v, const BsdfSample *s);

/* On through a mirror or a pane, by the decisions of its number. False: the event is none of delta,
 * or nothing is left. */
bool beam_turns_by_delta(Beam *b, const Vertex *v, Tracer *t);

/* ---- forks ----
 *
 * At the first mirrors or panes that the eye sees, a beam may go on by all events of delta instead
 * of one by chance: the image of a lamp in glass is then there in every sample, dim, and not in one
 * of twenty-five, bright. Dim ones are left to chance, by their strength. */

enum { FORKED = 3 };            /* events, from the eye */
typedef struct { Beam waiting[FORKED * BSDF_DELTAS]; int n; } Forks;    /* {.n = 0}: none */

/* Puts the deltas of the vertex by. False: there are none, or chance has to choose. */
bool beam_forks(Forks *f, const Beam *b, const Vertex *v, Tracer *t);
/* Roulette where there are forks, whose strength is what they bring: as long as a beam has met
 * nothing but deltas, it lasts while it is not weak. False: it ends. */
bool beam_lasts(Beam *b, int roulette, Tracer *t);
/* The next fork. False: there is none left. */
INLINE bool forks_next(Forks *f, Beam *b)
{
    if (!f->n)
        return false;
    *b = f->waiting[--f->n];
    return true;
}

/* How much of a unit of energy is left, whatever the index it is in, and whoever led it here. */
INLINE float beam_strength(const Beam *b) { return rgb_max(b->throughput) * b->eta2; }

/* Russian roulette: beyond so many events a beam goes on with the probability of its strength.
 * False: it ends. */
bool beam_survives(Beam *b, int roulette, Tracer *t);

#endif
