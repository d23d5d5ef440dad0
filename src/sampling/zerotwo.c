/* zerotwo.c -- the sampler `zerotwo`: for each decision and pixel its own (0,2)-sequence.
 *
 * Source      [Cline07 4.5.5, 4.5.6]; the order by hashing is [LaineKarras11] with the constants
 *             and the shuffled index of [Burley20]; the scrambling of digits is [TezukaFaure03].
 * Idea        The first two dimensions of Sobol's sequence put, of any 2^k samples that begin at a
 *             multiple of 2^k, one in each cell of every division of the square into 2^k equal
 *             cells by powers of two. Scrambling keeps that property and makes each point uniform,
 *             and of two points in different cells each is placed in its own by itself. To join
 *             decisions without patterns between them, each takes the samples in an order of its
 *             own: the index is scrambled too, by hashing its digits, which permutes within every
 *             aligned block of 2^k, and so keeps the blocks' sets.
 * Digits      The first digit of a number in [0, 1) is its highest bit; the first digit of its
 *             radical inverse is the lowest bit of an index. So an index with its bits in reverse
 *             is its radical inverse, and nothing has to be turned round here but the sample's
 *             index, once.
 * Departs     Owen's scrambling changes a digit by any function of the digits before it; this one
 *             by a linear one, at half the cost. Errors of pictures are the same.
 * Counts      Any; powers of two are best, since then the blocks are whole. */
#include "sampling/sampler.h"

static uint32_t reverse_bits(uint32_t x)
{
    x = (uint32_t)(SWAP_BYTES((uint64_t)x) >> 32);
    x = (x & 0x0F0F0F0Fu) << 4 | (x >> 4 & 0x0F0F0F0Fu);
    x = (x & 0x33333333u) << 2 | (x >> 2 & 0x33333333u);
    return (x & 0x55555555u) << 1 | (x >> 1 & 0x55555555u);
}

/* A hash in which each bit depends on the bits below it only: on an index in reverse that is a
 * nested swap of halves. [Burley20 listing 1] */
static uint32_t hash_upwards(uint32_t x, uint32_t seed)
{
    x ^= x * 0x3D20ADEAu;
    x += seed;
    x *= (seed >> 16) | 1u;
    x ^= x * 0x05526C56u;
    x ^= x * 0x53A22864u;
    return x;
}

/* The second dimension of Sobol's sequence from the first: the digits of the index times Pascal's
 * triangle modulo 2. C(j,i) is odd when the bits of i are among those of j [Lucas], so digit i is
 * the sum of the digits j that hold i: a sum over supersets, in five steps. */
static uint32_t pascal(uint32_t x)
{
    x ^= x << 1 & 0xAAAAAAAAu;
    x ^= x << 2 & 0xCCCCCCCCu;
    x ^= x << 4 & 0xF0F0F0F0u;
    x ^= x << 8 & 0xFF00FF00u;
    return x ^ x << 16;
}

/* To each digit of x the sum, modulo 2, of those digits before it that `choice` picks by their
 * distance; then of a digit of `shift`. Two numbers that differ in some digit first are apart by
 * each of the 2^k differences of the next k digits alike often, over all choices. */
static float scrambled(uint32_t x, uint32_t choice, uint32_t shift)
{
    uint64_t sums = carryless_product(x, choice | 0x80000000u) >> 31;
    return unit_of((uint32_t)sums ^ shift);
}

/* The second 64 random bits of a decision. */
#define SECOND ((uint64_t)1 << 32)

static float one(Sampler *s, Decision d)
{
    uint64_t a = draw64(s->pixel, d), b = draw64(s->pixel, d | SECOND);
    uint32_t x = hash_upwards(s->reversed, (uint32_t)a);
    return scrambled(x, (uint32_t)(a >> 32), (uint32_t)b);
}

static V2 two(Sampler *s, Decision d)
{
    uint64_t a = draw64(s->pixel, d), b = draw64(s->pixel, d | SECOND);
    uint32_t x = hash_upwards(s->reversed, (uint32_t)a), y = pascal(x);
    return (V2){ scrambled(x, (uint32_t)(a >> 32), (uint32_t)(b >> 32)),
                 scrambled(y, (uint32_t)(a >> 16), (uint32_t)b) };
}

/* The index with its bits in reverse is wanted by every decision of the sample. */
static void start(Sampler *s) { s->reversed = reverse_bits(s->index); }

const SamplerKind sampler_zerotwo = {
    .info = { "zerotwo", "Cline07 4.5.5-6; TezukaFaure03",
              "(0,2)-sequence, scrambled, for each decision; powers of two are best", NULL },
    .start = start, .one = one, .two = two
};
