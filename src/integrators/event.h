/* event.h -- where a ray through media gets to: past their borders, to a surface, to a scattering
 * on the way, or out of the scene. */
#ifndef INTEGRATORS_EVENT_H
#define INTEGRATORS_EVENT_H

#include "integrators/integrator.h"

typedef enum { ESCAPES, ARRIVES, SCATTERS } Event;

/* On from r, which moves up to the last border and starts in *medium, which changes with it. u says
 * how far the light gets; *throughput takes the weight of the way. ARRIVES sets *s, SCATTERS the
 * place *p. Where there are media: else tracer_nearest is all. */
Event ray_flies(Tracer *t, Ray *r, uint32_t *medium, float u, Rgb *throughput, Surface *s, V3 *p);

/* The surface that ends the ray, past all borders; *left loses what the media take on the way. With
 * media or without. False: none. */
bool ray_sees(Tracer *t, const Ray *r, uint32_t medium, Surface *s, Rgb *left);

#endif
