/* bpm.c -- bidirectional photon mapping: photons are gathered at every vertex of the eye's path,
 * and these estimates weighed against each other.
 *
 * Source      [GIRT 2.3.5], [Vorba11]. It is vcm without connections: see vcm.h and odds.h. Lamps
 *             that the eye's path meets count as one technique more. */
#include "integrators/vcm.h"

static Integrator *open_bpm(const Scene *s, const Opts *o)
{
    Vcm *it = (Vcm *)vcm_open("bpm", s, o);

    if (!it)
        return NULL;
    it->both.techniques.connects = false;
    it->both.techniques.straight = true;
    return &it->base;
}

static const OptDef options[] = { VCM_OPTIONS, { .key = NULL } };

const IntegratorKind integrator_bpm = {
    .info = { "bpm", "GIRT 2.3.5", "photons gathered at all vertices of the eye's paths", options },
    .truth = CONSISTENT, .misses = "light that media scatter",
    .open = open_bpm, .close = vcm_close, .prepare = vcm_prepare, .radiance = vcm_radiance,
    .anew = true, .moment = vcm_moment, .phases = LIGHTSTORE_PHASES, .units = vcm_units,
    .run = vcm_run
};
