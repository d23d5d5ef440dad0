/* lens.h -- light that is shown to the lens: the last edge of a path from a lamp.
 *
 * Source      [Cline07 7.6, fig. 7.9; errata 7.2], [Veach97 8.3].
 * Splat       With the flux F of a particle, wi the way to the lens and We, pdf_w of that way (see
 *             CameraSample), a vertex adds F f* |cos| We / pdf_w to the mean of all pixels. */
#ifndef INTEGRATORS_LENS_H
#define INTEGRATORS_LENS_H

#include "integrators/vertex.h"

/* A way from the point to the lens, by decision LENS of that number. False: there is none. */
INLINE bool lens_from(V3 p, float time, int at, Tracer *t, CameraSample *c)
{
    const Camera *camera = t->scene->camera;
    V2 u = { 0, 0 };

    if (camera->has_lens)
        u = sample_2d(&t->sampler, DECISION(DECIDE_LENS, at));
    return camera->kind->sample(camera, p, u, time, c);
}

/* What the lens sees of F f* |cos| at the point, unless anything stands in the way. */
INLINE Rgb lens_sees(const CameraSample *c, const Surface *from, uint32_t medium, Rgb flux,
                     Tracer *t)
{
    LightSample to = { .wi = c->wi, .dist = c->dist, .p = c->p };
    Ray r = shadow_ray(from, &to);
    Rgb sent = rgb_scale(flux, c->we / c->pdf_w);

    if (t->canvas)
        film_awaits_splat(t->canvas->film, c->pixel);
    return !rgb_black(sent) && tracer_passes(t, &r, medium, &sent) ? sent : rgb_all(0.0f);
}

/* Shows it, by a path of so many edges. */
INLINE void lens_shows(const CameraSample *c, const Surface *from, uint32_t medium, Rgb flux,
                       int edges, Tracer *t)
{
    tracer_splat(t, c->pixel, edges, STRATEGY_LENS, lens_sees(c, from, medium, flux, t));
}

#endif
