/* zerotwo.c -- the sampler `zerotwo`: for each decision and pixel its own (0,2)-sequence.
 *
 * Source      [Cline07 4.5.5, 4.5.6]; the scrambling by hashing is [LaineKarras11] with the
 *             constants and the shuffled index of [Burley20].
 * Idea        The first two dimensions of Sobol's sequence put, of any 2^k samples that begin at a
 *             multiple of 2^k, one in each cell of every division of the square into 2^k equal
 *             cells by powers of two. Owen scrambling (a random swap of halves at every level,
 *             chosen by hashing the digits above) keeps that property and makes each point uniform,
 *             so the estimate is unbiased. To join decisions without patterns between them, each
 *             takes the samples in an order of its own: the index is scrambled in the same way,
 *             which permutes within every aligned block of 2^k, and so keeps the blocks' sets.
 * Counts      Any; powers of two are best, since then the blocks are whole. */
#include "sampling/sampler.h"

/* All 64 bits in reverse: bytes, then the bits in each. */
static uint64_t reverse_all(uint64_t x)
{
    x = SWAP_BYTES(x);
    x = (x & 0x0F0F0F0F0F0F0F0Fu) << 4 | (x >> 4 & 0x0F0F0F0F0F0F0F0Fu);
    x = (x & 0x3333333333333333u) << 2 | (x >> 2 & 0x3333333333333333u);
    return (x & 0x5555555555555555u) << 1 | (x >> 1 & 0x5555555555555555u);
}

static uint32_t reverse_bits(uint32_t x) { return (uint32_t)(reverse_all(x) >> 32); }

/* A hash in which each bit depends on the bits below it only: on a number with its bits reversed
 * that is a nested swap of halves. [Burley20 listing 1] */
static uint32_t hash_upwards(uint32_t x, uint32_t seed)
{
    x ^= x * 0x3D20ADEAu;
    x += seed;
    x *= (seed >> 16) | 1u;
    x ^= x * 0x05526C56u;
    x ^= x * 0x53A22864u;
    return x;
}

/* The second dimension of Sobol's sequence, bits reversed: the digits of the index times Pascal's
 * triangle modulo 2. C(j,i) is odd when the bits of i are among those of j [Lucas], so digit i is
 * the sum of the digits j that hold i: a sum over supersets, in five steps. */
static uint32_t pascal(uint32_t x)
{
    x ^= x >> 1 & 0x55555555u;
    x ^= x >> 2 & 0x33333333u;
    x ^= x >> 4 & 0x0F0F0F0Fu;
    x ^= x >> 8 & 0x00FF00FFu;
    x ^= x >> 16;
    return x;
}

/* The sample's index in the order of this decision. */
static uint32_t shuffled(const Sampler *s, uint32_t seed)
{
    return reverse_bits(hash_upwards(s->reversed, seed));
}

/* The radical inverse of the index, scrambled: hashing works on the digits with the first one
 * lowest, so the number is turned round only once. */
static float one(Sampler *s, Decision d)
{
    uint64_t seeds = draw64(s->pixel, d);
    uint32_t i = shuffled(s, (uint32_t)seeds);
    return unit_of(reverse_bits(hash_upwards(i, (uint32_t)(seeds >> 32))));
}

static V2 two(Sampler *s, Decision d)
{
    uint64_t seeds = draw64(s->pixel, d), both;
    uint32_t i = shuffled(s, (uint32_t)seeds);
    uint32_t x = hash_upwards(i, (uint32_t)(seeds >> 32));
    uint32_t y = hash_upwards(pascal(i), (uint32_t)(seeds >> 16) * 0x9E3779B9u);

    both = reverse_all((uint64_t)y << 32 | x);          /* which also changes their places */
    return (V2){ unit_of((uint32_t)(both >> 32)), unit_of((uint32_t)both) };
}

/* The index with its bits reversed is wanted by every decision of the sample. */
static void start(Sampler *s) { s->reversed = reverse_bits(s->index); }

const SamplerKind sampler_zerotwo = {
    .info = { "zerotwo", "Cline07 4.5.5-6; Burley20",
              "(0,2)-sequence, Owen scrambled, for each decision; powers of two are best", NULL },
    .start = start, .one = one, .two = two
};
