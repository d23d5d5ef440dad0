/* bdpt.c -- bidirectional path tracing: for each camera sample a path from a lamp and one from the
 * eye, joined in all ways.
 *
 * Source      [Cline07 7.9], [GIRT 2.2.3], [Veach97 10], [LafortuneWillems93]. The method stands in
 *             bidirectional.h, its weights in odds.h.
 * Misses      What is seen by way of deltas of lamps that are deltas: no technique makes it.
 * Numbers     The path from the lamp has the pixel's own numbers, but other ones: it is joined with
 *             this pixel's paths alone, and must be spread over all lamps in each pixel. */
#include "base/mem.h"
#include "integrators/bidirectional.h"

typedef struct {
    Integrator base;
    Bidirectional both;         /* owned */
} Bdpt;

static Rgb radiance(const Integrator *base, const Ray *r, Tracer *t)
{
    const Bdpt *it = (const Bdpt *)base;
    LightVertex path[DEPTH_MOST];
    Sampler eye = t->sampler;
    int n;

    sampler_other(&t->sampler, PATH_FROM_LAMP);
    n = bidirectional_light(&it->both, r->time, path, t);
    t->sampler = eye;
    return bidirectional_look(&it->both, r, path, n, t);
}

static void close_bdpt(Integrator *base)
{
    bidirectional_clear(&((Bdpt *)base)->both);
    mem_free(base);
}

static Integrator *open_bdpt(const Scene *s, const Opts *o)
{
    Bdpt *it = MEM_NEW(Bdpt);

    if (!it)
        return NULL;
    it->base.scene = s;
    if (bidirectional_open(&it->both, "bdpt", s, o))
        return &it->base;
    close_bdpt(&it->base);
    return NULL;
}

static const OptDef options[] = { BIDIRECTIONAL_OPTIONS(16), { .key = NULL } };

const IntegratorKind integrator_bdpt = {
    .info = { "bdpt", "Cline07 7.9; GIRT 2.2.3; Veach97 10",
              "paths from the lamps and from the eye, connected in all ways", options },
    .truth = UNBIASED, .misses = "point and distant lights seen through delta surfaces; light that "
                                 "media scatter",
    .splats = true, .singles = true, .open = open_bdpt, .close = close_bdpt, .radiance = radiance
};
