/* direct_twostage.c -- direct light by two stage importance sampling: of the sky, directions in
 * proportion to the product of its light and what the surface makes of it; of lamps that are
 * rectangles with pictures, points in proportion to that; of other lights, by multiple importance
 * sampling.
 *
 * Source      [Cline07 5]; see lightsampling/partition.h.
 * Points      Hammersley's, moved round the unit square by chance [Cline07 5.4]: for each turn its
 *             own. They keep their strata on the way down the tree, so that there is the less noise
 *             the closer the partition comes to the product.
 * Fallback    Where no light has a map, all is as strategy=mis has it. The sun of a `sky` is one
 *             of the other lights. */
#include "integrators/direct_twostage.h"

#include "base/mem.h"
#include "sampling/pattern.h"

/* ---- the sky and the rest ---- */

bool skyrest_init(SkyAndRest *own, const Direct *it, const Opts *o)
{
    memset(own, 0, sizeof *own);
    if (!twostage_init(&own->two, it->base.scene, o, it->lighting.directions))
        return false;
    own->samples = (int)opt_int(o, "samples");
    own->rest = *it;
    own->rest.lighting = own->two.others;
    if (!own->two.lamps)
        own->rest.bsdfsamples = 0;      /* rays that could meet nothing */
    return true;
}

void skyrest_clear(SkyAndRest *own) { twostage_clear(&own->two); }

Rgb skyrest_others(const SkyAndRest *own, const Turn *u, Tracer *t)
{
    Rgb sum = twostage_asked_light(&own->two, u, own->samples, t);

    return own->two.any ? rgb_add(sum, direct_mis.light(&own->rest, u, t)) : sum;
}

/* ---- the strategy ---- */

enum { GROUP = 32 };

static bool open_twostage(Direct *it, const Opts *o)
{
    SkyAndRest *own = MEM_NEW(SkyAndRest);

    if (!own || !skyrest_init(own, it, o)) {
        mem_free(own);
        return false;
    }
    it->own = own;
    return true;
}

static void close_twostage(Direct *it)
{
    if (it->own)
        skyrest_clear(it->own);
    mem_free(it->own);
}

static Rgb sky(const SkyAndRest *own, const Turn *u, Tracer *t)
{
    Rgb sum = rgb_all(0.0f);
    PartitionSample s[GROUP];
    V2 by, point[GROUP];
    Partition p;

    if (!twostage_partition(&own->two, u, own->samples, t, &p))
        return sum;
    by = sample_2d(&t->sampler, DECISION(DECIDE_SKY, u->at));
    for (int first = 0, some; first < own->samples; first += some) {
        some = own->samples - first < GROUP ? own->samples - first : GROUP;
        for (int i = 0; i < some; i++)
            point[i] = hammersley_moved((uint32_t)(first + i), (uint32_t)own->samples, by);
        partition_warp_many(&p, point, s, some);
        for (int i = 0; i < some; i++) {
            Candidate c;
            if (twostage_candidate(&own->two, &s[i], u, (float)own->samples, &c))
                sum = rgb_add(sum, candidate_light(&c, u, t));
        }
    }
    return sum;
}

static Rgb light(const Direct *it, const Turn *u, Tracer *t)
{
    const SkyAndRest *own = it->own;

    return rgb_add(sky(own, u, t), skyrest_others(own, u, t));
}

const DirectStrategy direct_twostage = {
    .name = "twostage", .finds_deltas = true, .open = open_twostage, .close = close_twostage,
    .light = light
};
