/* sppm.c -- stochastic progressive photon mapping: in every pass new photons and new paths of the
 * eye, and for each pixel one radius, which shrinks.
 *
 * Source      [GIRT 2.3.4], [Hachisuka09]. All else stands in progressive.h. */
#include "base/mem.h"
#include "integrators/progressive.h"

static bool prepare(Integrator *base, const Film *f, uint64_t seed)
{
    (void)seed;
    return progressive_prepare((Progressive *)base, f, 1);
}

static Rgb radiance(const Integrator *base, const Ray *r, Tracer *t)
{
    const Progressive *it = (const Progressive *)base;
    Sampler same = t->sampler;

    return progressive_look(it, r, progressive_of(it, t, 0), &same, t);
}

static uint32_t moment(const Integrator *base, uint32_t pass)
{
    (void)base;
    return pass;
}

static void close_sppm(Integrator *base)
{
    progressive_clear((Progressive *)base);
    mem_free(base);
}

static Integrator *open_sppm(const Scene *s, const Opts *o)
{
    Progressive *it = MEM_NEW(Progressive);

    if (!it)
        return NULL;
    if (progressive_open(it, "sppm", s, o))
        return &it->base;
    close_sppm(&it->base);
    return NULL;
}

static const OptDef options[] = { PROGRESSIVE_OPTIONS, { .key = NULL } };

const IntegratorKind integrator_sppm = {
    .info = { "sppm", "GIRT 2.3.4; Hachisuka09",
              "photons gathered where eye paths end, both anew in each pass, in a radius that "
              "shrinks", options },
    .truth = CONSISTENT, .misses = "light that media scatter",
    .open = open_sppm, .close = close_sppm, .prepare = prepare, .radiance = radiance,
    .anew = true, .moment = moment, .phases = PROGRESSIVE_PHASES, .units = progressive_units,
    .run = progressive_run, .save = progressive_save, .load = progressive_load
};
