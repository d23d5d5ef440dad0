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
#include "sampling/pattern.h"

/* To each digit of x the sum, modulo 2, of those digits before it that `choice` picks by their
 * distance; then of a digit of `shift`. Two numbers that differ in some digit first are apart by
 * each of the 2^k differences of the next k digits alike often, over all choices. */
static float scrambled(uint32_t x, uint32_t choice, uint32_t shift)
{
    uint64_t sums = carryless_product(x, choice | 0x80000000u) >> 31;
    return unit_of((uint32_t)sums ^ shift);
}

static float one(Sampler *s, Decision d)
{
    uint64_t a = draw64(s->pixel, d), b = draw64(s->pixel, d | SECOND);
    uint32_t x = hash_upwards(s->reversed, (uint32_t)a);
    if (UNLIKELY(s->way != OWEN))
        return unit_of(randomized((Randomize)s->way, x, (uint32_t)b));
    return scrambled(x, (uint32_t)(a >> 32), (uint32_t)b);
}

/* In another way; or as they are, for the place on the pixel also in their order. */
static NOINLINE V2 unscrambled(const Sampler *s, Decision d, uint32_t x, uint64_t b)
{
    Randomize way = (Randomize)s->way;

    if (way == FIXED && d == DECISION(DECIDE_PIXEL, 0))
        x = s->reversed;
    return (V2){ unit_of(randomized(way, x, (uint32_t)(b >> 32))),
                 unit_of(randomized(way, pascal(x), (uint32_t)b)) };
}

static V2 two(Sampler *s, Decision d)
{
    uint64_t a = draw64(s->pixel, d), b = draw64(s->pixel, d | SECOND);
    uint32_t x = hash_upwards(s->reversed, (uint32_t)a), y = pascal(x);
    if (UNLIKELY(s->way != OWEN))
        return unscrambled(s, d, x, b);
    return (V2){ scrambled(x, (uint32_t)(a >> 32), (uint32_t)(b >> 32)),
                 scrambled(y, (uint32_t)(a >> 16), (uint32_t)b) };
}

static bool init(Sampler *s, const Opts *o, uint32_t *spp)
{
    (void)spp;
    s->way = (int)randomize_of(o);
    s->fixed = s->way == FIXED;
    return true;
}

/* The index with its bits in reverse is wanted by every decision of the sample. */
static void start(Sampler *s) { s->reversed = reverse_bits(s->index); }

static const OptDef options[] = {
    RANDOMIZE_OPTION("owen"),
    { .key = NULL }
};

const SamplerKind sampler_zerotwo = {
    .info = { "zerotwo", "Cline07 4.5.5-6; TezukaFaure03",
              "(0,2)-sequence, scrambled, for each decision; any sample count, powers of two are "
              "best", options },
    .init = init, .start = start, .one = one, .two = two
};
