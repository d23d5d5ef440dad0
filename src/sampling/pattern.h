/* pattern.h -- what the patterns share: blocks of samples, strata, permutations and scrambling by
 * hashing.
 *
 * Blocks      A pattern of N points is used up after N samples; the next N take another. Where the
 *             number of samples is not known beforehand, blocks have 1, 1, 2, 4, 8, ... samples,
 *             so that whole patterns end where the driver's passes do, and at most half of all
 *             samples are of a pattern that is not whole.
 * Order       Decisions take the points of their patterns each in an order of its own. Else sample
 *             i would be in stratum i of all of them, and no sample would join, say, the left of
 *             the pixel with the right of a light. Also the first decision has its order, so that a
 *             pattern which is cut short is unbiased. (The word for that is padding.)
 * Draws       Of the key `pattern` of a pixel and block come the orders and scramblings of a
 *             decision, of the key of the sample its place within a stratum. */
#ifndef SAMPLING_PATTERN_H
#define SAMPLING_PATTERN_H

#include "sampling/sampler.h"

/* ---- ways of randomizing sequences ---- */

typedef enum { OWEN, ROTATION, FIXED, DIGITS } Randomize;

#define RANDOMIZE_OPTION(usual)                                                                   \
    { .key = "randomize", .type = OPT_CHOICE, .str = usual, .also = "randomization",              \
      .choices = "owen fastowen permutedigits rotation none",                                     \
      .help = "in each pixel: by Owen's scrambling (two names), all digits of a place alike, by " \
              "Cranley and Patterson's rotation; not at all" }

Randomize randomize_of(const Opts *o);

/* Of strata, which are random within a pixel anyhow: `none` makes Sampler.fixed. */
#define PIXEL_OPTION                                                                              \
    { .key = "randomize", .type = OPT_CHOICE, .str = "pixel", .choices = "pixel none",            \
      .help = "a pattern for each pixel; or the same one for all" }

/* ---- blocks and strata ---- */

/* Before the first sample: N planned samples are one block, or several, as equal as can be, if N is
 * above `most` (0: any). */
void plan_blocks(Sampler *s, uint32_t spp, uint32_t most);
/* The same with strata: *spp is rounded up to a product of two numbers of which one is at most
 * twice the other, but for 3; that is said by a note. */
void plan_strata(Sampler *s, uint32_t *spp);
/* After a sample's index is set: place, block, and strata if the number is not known. */
void pattern_start(Sampler *s);

/* Draws of a decision: the second and third 64 bits. */
#define SECOND ((uint64_t)1 << 32)
#define THIRD  ((uint64_t)2 << 32)

/* Where i of 0 .. n-1 comes in the order that the key chooses, in 0 .. n-1. */
uint32_t permuted(uint32_t i, uint32_t n, uint64_t key);

/* The number at `bits` (of 32) of the way through stratum k of n. Exactly uniform if k and bits
 * are: k 2^24 + bits is one of n 2^24 numbers, and n of them round down to each result. */
INLINE float in_stratum(uint64_t k, uint64_t n, uint32_t bits)
{
    return (float)((k << 24 | bits >> 8) / n) * 0x1p-24f;
}

/* What most patterns have for 1-D decisions: strata, one sample each. */
float stratified_one(Sampler *s, Decision d);

/* ---- digits in base 2: the first digit of a number in [0, 1) is its highest bit ---- */

INLINE uint32_t reverse_bits(uint32_t x)
{
    x = (uint32_t)(SWAP_BYTES((uint64_t)x) >> 32);
    x = (x & 0x0F0F0F0Fu) << 4 | (x >> 4 & 0x0F0F0F0Fu);
    x = (x & 0x33333333u) << 2 | (x >> 2 & 0x33333333u);
    return (x & 0x55555555u) << 1 | (x >> 1 & 0x55555555u);
}

/* Moved round the unit interval: Cranley and Patterson's rotation. */
INLINE float moved_round(float x, float by)
{
    x += by;
    return f_min(x < 1.0f ? x : x - 1.0f, ONE_MINUS_ULP);
}

/* Point i of Hammersley's n, moved round the unit square. */
INLINE V2 hammersley_moved(uint32_t i, uint32_t n, V2 by)
{
    return (V2){ moved_round((float)i / (float)n, by.x),
                 moved_round(unit_of(reverse_bits(i)), by.y) };
}

/* A hash in which each bit depends on the bits below it only. On an index in reverse that is a
 * nested swap of halves, which permutes within every aligned block of 2^k.
 * [Burley20 listing 1] */
INLINE uint32_t hash_upwards(uint32_t x, uint32_t seed)
{
    x ^= x * 0x3D20ADEAu;
    x += seed;
    x *= (seed >> 16) | 1u;
    x ^= x * 0x05526C56u;
    x ^= x * 0x53A22864u;
    return x;
}

/* Owen's scrambling: each digit changed by a function of the digits before it. The hash makes the
 * lowest bits of x its first digits, so x is turned round twice. [LaineKarras11; Burley20] */
INLINE uint32_t owen_scrambled(uint32_t x, uint32_t seed)
{
    return reverse_bits(hash_upwards(reverse_bits(x), seed));
}

/* The second dimension of Sobol's sequence from the first: the digits of the index times Pascal's
 * triangle modulo 2. C(j,i) is odd when the bits of i are among those of j [Lucas], so digit i is
 * the sum of the digits j that hold i: a sum over supersets, in five steps. */
INLINE uint32_t pascal(uint32_t x)
{
    x ^= x << 1 & 0xAAAAAAAAu;
    x ^= x << 2 & 0xCCCCCCCCu;
    x ^= x << 4 & 0xF0F0F0F0u;
    x ^= x << 8 & 0xFF00FF00u;
    return x ^ x << 16;
}

/* A number of base 2 in one of these ways. */
INLINE uint32_t randomized(Randomize way, uint32_t x, uint32_t key)
{
    return way == OWEN ? owen_scrambled(x, key)
           : way == ROTATION ? x + key
           : way == DIGITS ? x ^ key : x;
}

/* ---- joint dimensions ---- */

/* A sequence of many dimensions gives its first, best ones to the decisions that matter most, two
 * at a time where a decision is 2-D. The first dimension of decision d if it and, for two, the one
 * after it are below `dimensions`; else -1: the decision has a pattern of its own. A decision has
 * dimensions only as what it is, 1-D or 2-D. */
int joint_dimension(Decision d, bool two, int dimensions);

extern const SamplerKind sampler_zerotwo;       /* what `sobol` has for all others */

#endif
