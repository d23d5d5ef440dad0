/* multijittered.c -- the sampler `multijittered`: one sample in each cell of a grid, and one in
 * each row and column of fine strata.
 *
 * Source      [Cline07 4.5.4] after Chiu, Shirley and Wang; as hashing in [Kensler13].
 * Idea        nx x ny cells; a column of cells has ny fine columns, which its ny samples share out
 *             by a permutation of that column's own, and so with rows. The result is both jittered
 *             and an N-rooks pattern.
 * Counts      Rounded up to nx x ny, as `stratified` has them. */
#include "sampling/pattern.h"

static bool init(Sampler *s, const Opts *o, uint32_t *spp)
{
    s->fixed = opt_is(o, "randomize", "none");
    plan_strata(s, spp);
    return true;
}

static V2 two(Sampler *s, Decision d)
{
    uint64_t place = draw64(s->key, d), n = s->size;
    uint32_t k = permuted(s->at, s->size, draw64(s->pattern, d));
    uint32_t column = k % s->nx, row = k / s->nx;
    uint64_t columns = key_with(draw64(s->pattern, d | SECOND), column);
    uint64_t rows = key_with(draw64(s->pattern, d | SECOND), SECOND | row);
    uint64_t x = (uint64_t)column * s->ny + permuted(row, s->ny, columns);
    uint64_t y = (uint64_t)row * s->nx + permuted(column, s->nx, rows);

    return (V2){ in_stratum(x, n, (uint32_t)(place >> 32)), in_stratum(y, n, (uint32_t)place) };
}

static const OptDef options[] = { PIXEL_OPTION, { .key = NULL } };

const SamplerKind sampler_multijittered = {
    .info = { "multijittered", "Cline07 4.5.4",
              "one sample in each cell, row and column; counts are rounded up to 3 or a "
              "product a b with a <= b <= 2 a", options },
    .plans = true, .init = init, .start = pattern_start, .one = stratified_one, .two = two
};
