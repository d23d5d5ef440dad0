/* hammersley.c -- the sampler `hammersley`: for each decision the points (i / N, phi(i)).
 *
 * Source      [Cline07 4.5.5, 4.5.6]; with rotation it is the pattern of [Cline07 5].
 * Idea        Where N is known beforehand, one coordinate can be perfectly even, and the other a
 *             radical inverse in base 2: the discrepancy is less than that of any sequence.
 * Joining     Each decision has the set for itself, in an order of its own; 1-D ones have i / N.
 * Scrambling  Rotation keeps i / N a lattice; Owen's scrambling places each of N = 2^k points in
 *             its cell of each division of the square.
 * Counts      Any, but a good guess is wanted: the set of N points is whole after N only. */
#include "sampling/pattern.h"

static bool init(Sampler *s, const Opts *o, uint32_t *spp)
{
    s->way = (int)randomize_of(o);
    s->fixed = s->way == FIXED;
    plan_blocks(s, *spp, 0);
    return true;
}

/* i / N, to 32 bits. */
static uint32_t even(const Sampler *s, uint32_t i)
{
    return (uint32_t)(((uint64_t)i << 32) / s->size);
}

static float one(Sampler *s, Decision d)
{
    uint32_t i = permuted(s->at, s->size, draw64(s->pattern, d | THIRD));
    uint32_t key = (uint32_t)draw64(s->pattern, ~(uint64_t)d);
    return unit_of(randomized((Randomize)s->way, even(s, i), key));
}

static V2 two(Sampler *s, Decision d)
{
    uint32_t i = permuted(s->at, s->size, draw64(s->pattern, d));
    uint64_t key = draw64(s->pattern, d | SECOND);
    return (V2){ unit_of(randomized((Randomize)s->way, even(s, i), (uint32_t)(key >> 32))),
                 unit_of(randomized((Randomize)s->way, reverse_bits(i), (uint32_t)key)) };
}

static const OptDef options[] = {
    RANDOMIZE_OPTION("rotation"),
    { .key = NULL }
};

const SamplerKind sampler_hammersley = {
    .info = { "hammersley", "Cline07 4.5.5-6",
              "i / N and a radical inverse, rotated, for each decision; any sample count that is "
              "known beforehand", options },
    .plans = true, .init = init, .start = pattern_start, .one = one, .two = two
};
