/* cmj.c -- the sampler `cmj`: correlated multi-jittered patterns, for any sample count.
 *
 * Source      [Kensler13], with the hash of pattern.c.
 * Idea        As `multijittered`, but one permutation orders the samples of all columns, and one
 *             those of all rows: points of neighbouring cells then keep more of a distance. N that
 *             is no product of two numbers takes some cells of a grid only: sample s of N is in row
 *             s / m of cells and in row s of N fine ones, so y is fully stratified, and x but for
 *             the cells of the last row that are not there.
 * Counts      Any. */
#include "sampling/pattern.h"

static bool init(Sampler *s, const Opts *o, uint32_t *spp)
{
    uint32_t m = 1;

    s->fixed = opt_is(o, "randomize", "none");
    plan_blocks(s, *spp, 0);
    if (s->block) {
        while ((uint64_t)(m + 1) * (m + 1) <= s->block)
            m++;
        s->nx = m;
        s->ny = (s->block - 1) / m + 1;
    }
    return true;
}

static V2 two(Sampler *s, Decision d)
{
    uint64_t key = draw64(s->pattern, d | SECOND), place = draw64(s->key, d);
    uint32_t k = permuted(s->at, s->size, draw64(s->pattern, d));
    uint32_t column = permuted(k % s->nx, s->nx, key);
    uint32_t row = permuted(k / s->nx, s->ny, mix64(key));
    uint64_t x = (uint64_t)column * s->ny + row, cells = (uint64_t)s->nx * s->ny;

    return (V2){ in_stratum(x, cells, (uint32_t)(place >> 32)),
                 in_stratum(k, s->size, (uint32_t)place) };
}

static const OptDef options[] = { PIXEL_OPTION, { .key = NULL } };

const SamplerKind sampler_cmj = {
    .info = { "cmj", "Kensler13",
              "correlated multi-jittered: one sample a cell, row and column; any sample count",
              options },
    .plans = true, .init = init, .start = pattern_start, .one = stratified_one, .two = two
};
