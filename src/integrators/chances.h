/* chances.h -- what happens at a vertex by chance, with a probability that can be told of any path,
 * also of one that was not found this way.
 *
 * Source      [Cline07 8.4.1, appendix 8A], [Veach97 11.4.2].
 * Choice      Models do not tell the probabilities of their delta events, so it is decided here:
 *             by the energy that each carries, the smooth part getting what the albedo leaves. A
 *             smooth direction that the model answers with a delta event is lost.
 * Sides       The same from the eye and from the light: only that to which side the vertex has come
 *             from differs. Names of events are those of path_deltas, the same from both. */
#ifndef INTEGRATORS_CHANCES_H
#define INTEGRATORS_CHANCES_H

#include "integrators/lightpath.h"

/* Having come from the local direction `from`: an event, by the tracer's decisions LOBE and
 * DIRECTION of that number. Gives its chance: a density, or the probability of a delta event; 0: it
 * is lost. *s: direction, local, and weight, that of light where `particle`. */
float chance_draws(const Vertex *at, V3 from, bool particle, int number, Tracer *t, uint32_t *event,
                   BsdfSample *s);

/* Of the event, to the local direction `to`. */
float chance_of(const Vertex *at, V3 from, V3 to, uint32_t event);

#endif
