/* event.h -- where a ray through media gets to: past their borders, to a surface, to a scattering
 * on the way, or out of the scene. */
#ifndef INTEGRATORS_EVENT_H
#define INTEGRATORS_EVENT_H

#include "integrators/integrator.h"

typedef enum { ESCAPES, ARRIVES, SCATTERS } Event;

/* What ray_flies does where there are media; u says how far the light gets. */
Event ray_flies_through_media(Tracer *t, Ray *r, uint32_t *medium, float u, Rgb *throughput,
                              Surface *s, V3 *p);

/* On from r, which moves up to the last border and starts in *medium, which changes with it; depth
 * is the number of the decision. *throughput takes the weight of the way. ARRIVES sets *s, SCATTERS
 * the place *p. */
INLINE Event ray_flies(Tracer *t, Ray *r, uint32_t *medium, int depth, Rgb *throughput, Surface *s,
                       V3 *p)
{
    Hit h;

    if (UNLIKELY(t->scene->nmedia))
        return ray_flies_through_media(t, r, medium,
                                       sample_1d(&t->sampler, DECISION(DECIDE_DISTANCE, depth)),
                                       throughput, s, p);
    if (!tracer_nearest(t, r, &h))
        return ESCAPES;
    accel_surface(t->scene->accel, r, &h, s);
    return ARRIVES;
}

/* The surface that ends the ray, which moves up to the last border, as *medium says; *left loses
 * what media take on the way. With media or without. False: none, or nothing is left. */
bool ray_hits(Tracer *t, Ray *r, uint32_t *medium, Rgb *left, Hit *h, Surface *s);
INLINE bool ray_meets(Tracer *t, Ray *r, uint32_t *medium, Rgb *left, Surface *s)
{
    Hit h;
    return ray_hits(t, r, medium, left, &h, s);
}

#endif
