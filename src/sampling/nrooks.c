/* nrooks.c -- the sampler `nrooks`: Latin hypercubes.
 *
 * Source      [Cline07 4.5.4], after [Shirley91].
 * Idea        Each coordinate of each decision is stratified by itself, N strata with one sample in
 *             each, and the strata are associated by random permutations: as rooks on a board that
 *             cannot take each other. It costs no more samples in more dimensions, and removes the
 *             part of the variance that is a sum of functions of one coordinate each.
 * Counts      Any. */
#include "sampling/pattern.h"

static bool init(Sampler *s, const Opts *o, uint32_t *spp)
{
    s->fixed = opt_is(o, "randomize", "none");
    plan_blocks(s, *spp, 0);
    return true;
}

static V2 two(Sampler *s, Decision d)
{
    uint64_t place = draw64(s->key, d);
    uint32_t column = permuted(s->at, s->size, draw64(s->pattern, d));
    uint32_t row = permuted(s->at, s->size, draw64(s->pattern, d | SECOND));

    return (V2){ in_stratum(column, s->size, (uint32_t)(place >> 32)),
                 in_stratum(row, s->size, (uint32_t)place) };
}

static const OptDef options[] = { PIXEL_OPTION, { .key = NULL } };

const SamplerKind sampler_nrooks = {
    .info = { "nrooks", "Cline07 4.5.4",
              "Latin hypercube: one sample a row and a column; any sample count", options },
    .plans = true, .init = init, .start = pattern_start, .one = stratified_one, .two = two
};
