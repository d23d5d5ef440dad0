/* direct_ris.c -- direct light by resampled importance sampling. See resample.c.
 * Source: [Cline07 4.4.4]; 64 tentative samples of which 8 are kept are those of figure 4.10. */
#include "integrators/direct.h"

static bool open_ris(Direct *it, const Opts *o)
{
    if (opt_int(o, "tentative") > TENTATIVE_MOST)
        return err_usage("direct: strategy=ris has at most %d tentative samples", TENTATIVE_MOST);
    it->resampling = resampling_of((int)opt_int(o, "tentative"), (int)opt_int(o, "samples"),
                                   opt_float(o, "lightshare"));
    lighting_shares(&it->lighting, it->resampling.by_light, it->resampling.by_scattering);
    return true;
}

static Rgb light(const Direct *it, const Turn *u, Tracer *t)
{
    return resample(&it->lighting, &it->resampling, u, t);
}

const DirectStrategy direct_ris = {
    .name = "ris", .finds_deltas = true, .open = open_ris, .light = light
};
