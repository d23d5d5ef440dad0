/* halton.c -- the sampler `halton`: radical inverses in prime bases.
 *
 * Source      [Cline07 4.5.5, 4.5.6]; digits scrambled as by [Owen95], or all of a place alike.
 * Idea        The digits of the index in base b, mirrored at the point, are a number of [0, 1);
 *             with another prime for each dimension, all boxes of b1^-k1 by b2^-k2 by ... fill at
 *             the same rate. Small bases are good and go to the decisions that matter most, see
 *             joint_dimension; those beyond have bases 2 and 3, in an order of their own. At
 *             usual counts that is better for all but the pixel: 64 samples fill boxes of 5 x 7
 *             unevenly, and larger bases not at all.
 * Scrambling  A digit is changed by a permutation that its pixel, its dimension and the digits
 *             before it choose (`permutedigits`: its place only). Permutations are c x + d modulo
 *             b, c not 0: two digits that differ are any two with the same chance, which is all
 *             that variance depends on.
 * Digits      As many as tell the planned samples apart, or 4096 of them; what follows is random.
 *             After so many samples the digits are the same again.
 * Counts      Any. */
#include "sampling/pattern.h"

#define BASES 32
static const unsigned char primes[BASES] = {
    2, 3, 5, 7, 11, 13, 17, 19, 23, 29, 31, 37, 41, 43, 47, 53, 59, 61, 67, 71, 73, 79, 83, 89, 97,
    101, 103, 107, 109, 113, 127, 131
};
enum { COUNT_UNKNOWN = 4096 };

static bool init(Sampler *s, const Opts *o, uint32_t *spp)
{
    s->way = (int)randomize_of(o);
    s->fixed = s->way == FIXED;
    s->dimensions = (int)opt_int(o, "dimensions");
    plan_blocks(s, *spp, 0);
    return true;
}

/* x of [0, b) by one of b (b - 1) permutations. */
static uint32_t turned(uint32_t x, uint32_t b, uint64_t key)
{
    uint32_t c = 1 + (uint32_t)((key >> 32) * (b - 1) >> 32);
    uint32_t d = (uint32_t)((key & 0xFFFFFFFFu) * b >> 32);
    return (c * x + d) % b;
}

/* The radical inverse of i in base b. `tail`: what follows the digits that matter. */
static float inverse(const Sampler *s, uint32_t i, uint32_t b, uint64_t key, uint32_t tail)
{
    uint32_t plan = s->spp ? s->spp : COUNT_UNKNOWN;
    uint64_t v = 0, power = 1, prefix = key;

    for (uint32_t place = 0; power < plan; place++, power *= b) {
        uint32_t x = i % b, to = x;
        i /= b;
        if (s->way == OWEN) {
            to = turned(x, b, prefix);
            prefix = mix64(prefix + x + 1);
        } else if (s->way == DIGITS)
            to = turned(x, b, mix64(key + place));
        v = v * b + to;
    }
    if (s->way == OWEN || s->way == DIGITS)
        return (float)((v << 24 | tail >> 8) / power) * 0x1p-24f;
    for (; i; i /= b, power *= b)               /* power < 2^32 b here and below 2^40 */
        v = v * b + i % b;
    if (s->way == FIXED)
        return (float)((v << 24) / power) * 0x1p-24f;
    return unit_of((uint32_t)((v << 24) / power << 8) + (uint32_t)key);
}

/* The sample that decision d takes as its next, for a pattern of its own. */
static uint32_t next_of(const Sampler *s, uint64_t d)
{
    return s->index - s->at + permuted(s->at, s->size, draw64(s->pattern, d));
}

static float one(Sampler *s, Decision d)
{
    int k = joint_dimension(d, false, s->dimensions);
    uint64_t key = draw64(s->pixel, d | THIRD);
    uint32_t tail = (uint32_t)draw64(s->key, d | THIRD);

    if (k >= 0)
        return inverse(s, s->index, primes[k], key, tail);
    return inverse(s, next_of(s, d | THIRD), 2, key, tail);
}

static V2 two(Sampler *s, Decision d)
{
    int k = joint_dimension(d, true, s->dimensions);
    uint64_t x = draw64(s->pixel, d), y = draw64(s->pixel, d | SECOND), tail = draw64(s->key, d);
    uint32_t i = s->index;

    if (k < 0)
        i = next_of(s, d);
    return (V2){ inverse(s, i, k < 0 ? 2 : primes[k], x, (uint32_t)(tail >> 32)),
                 inverse(s, i, k < 0 ? 3 : primes[k + 1], y, (uint32_t)tail) };
}

static const OptDef options[] = {
    RANDOMIZE_OPTION("owen"),
    { .key = "dimensions", .type = OPT_INT, .num = 2, .lo = 0, .hi = BASES,
      .help = "of one sequence: pixel, then of each bounce direction, light point, light, lobe" },
    { .key = NULL }
};

const SamplerKind sampler_halton = {
    .info = { "halton", "Cline07 4.5.5-6; Owen95",
              "radical inverses in prime bases, scrambled; any sample count", options },
    .plans = true, .init = init, .start = pattern_start, .one = one, .two = two
};
