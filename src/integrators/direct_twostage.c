/* direct_twostage.c -- direct light by two stage importance sampling: of the sky, directions in
 * proportion to the product of its light and what the surface makes of it; of other lights, by
 * multiple importance sampling.
 *
 * Source      [Cline07 5]; see lightsampling/partition.h.
 * Points      Hammersley's, moved round the unit square by chance [Cline07 5.4]: for each turn its
 *             own. They keep their strata on the way down the tree, so that there is the less noise
 *             the closer the partition comes to the product.
 * Fallback    Where no light beyond the scene is a picture or a constant, all is as strategy=mis
 *             has it. */
#include "base/mem.h"
#include "integrators/direct.h"
#include "integrators/twostage.h"

typedef struct {
    TwoStage two;
    Direct   rest;              /* strategy=mis for the other lights; its Lighting is that of two */
    int      samples;
} Own;

static bool open_twostage(Direct *it, const Opts *o)
{
    Own *own = MEM_NEW(Own);

    if (!own)
        return false;
    if (!twostage_init(&own->two, it->base.scene, o, it->lighting.directions)) {
        mem_free(own);
        return false;
    }
    own->samples = (int)opt_int(o, "samples");
    own->rest = *it;
    own->rest.lighting = own->two.others;
    if (!own->two.lamps)
        own->rest.bsdfsamples = 0;      /* rays that could meet nothing */
    it->own = own;
    return true;
}

static void close_twostage(Direct *it)
{
    Own *own = it->own;

    if (!own)
        return;
    twostage_clear(&own->two);
    mem_free(own);
}

/* The digits of i in base two, mirrored: in 24 bits, as canonical numbers are. */
static float mirrored(uint32_t i)
{
    float x = 0.0f, place = 0.5f;

    for (; i && place > 0x1p-25f; i >>= 1, place *= 0.5f)
        x += (float)(i & 1) * place;
    return x;
}

static float moved(float x, float by)
{
    x += by;
    return f_min(x < 1.0f ? x : x - 1.0f, ONE_MINUS_ULP);
}

enum { GROUP = 32 };

static Rgb sky(const Own *own, const Turn *u, Tracer *t)
{
    float n = (float)own->samples;
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
            point[i] = (V2){ moved((float)(first + i) / n, by.x),
                             moved(mirrored((uint32_t)(first + i)), by.y) };
        partition_warp_many(&p, point, s, some);
        for (int i = 0; i < some; i++) {
            Candidate c;
            if (twostage_candidate(&own->two, &s[i], u, n, &c))
                sum = rgb_add(sum, candidate_light(&c, u, t));
        }
    }
    return sum;
}

extern const DirectStrategy direct_mis;

static Rgb light(const Direct *it, const Turn *u, Tracer *t)
{
    const Own *own = it->own;
    Rgb sum = rgb_all(0.0f);

    if (own->two.light)
        sum = sky(own, u, t);
    return own->two.any ? rgb_add(sum, direct_mis.light(&own->rest, u, t)) : sum;
}

const DirectStrategy direct_twostage = {
    .name = "twostage", .source = "Cline07 5",
    .help = "the sky by rectangles of it, on which the surface is looked at",
    .finds_deltas = true, .open = open_twostage, .close = close_twostage, .light = light
};
