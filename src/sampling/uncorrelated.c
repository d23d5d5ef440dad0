/* uncorrelated.c -- the sampler `uncorrelated`: strata of the pixel matched with those of lens,
 * time and lights by permutation, one ray for each.
 *
 * Source      [Shirley91 5.4.1], figures 5.6 to 5.9, after Cook's distributed ray tracing.
 * Idea        With N strata of the pixel and N of the lens there would be N^2 rays to fire. N do,
 *             if every stratum of either has one: they are matched by a permutation, another in
 *             each pixel, since any consistent mapping would show. Here every decision is matched
 *             with the pixel by a permutation of its own.
 * Restricted  Cook left out mappings that join one part of the pixel with one part of the lens too
 *             often; [Shirley91] could not tell whether that is unbiased. Here it is: with m x m
 *             strata, m = a b, the pixel has m parts, a x b, of b x a strata each, and so has each
 *             decision. The strata (c, f), part and stratum in it, are matched as
 *                 c' = p_c(f),  f' = q_c'(c)
 *             with p and q random permutations of m things: of each part of the pixel one sample
 *             goes to each part of the decision, and to one stratum of it each part of the pixel
 *             at most once. Any stratum is matched with any other equally often, so the mean is
 *             right [Shirley91: "equal opportunity"].
 * Counts      Rounded up: to a square for restricted mappings, else as `stratified` has them. */
#include "sampling/pattern.h"

enum { RESTRICTED, PERMUTED, INDEPENDENT };

/* m = a b, as near to each other as can be, a <= b. */
static uint32_t factor(uint32_t m)
{
    uint32_t a = 1;

    for (uint32_t k = 2; (uint64_t)k * k <= m; k++)
        if (m % k == 0)
            a = k;
    return a;
}

static bool init(Sampler *s, const Opts *o, uint32_t *spp)
{
    uint32_t n = *spp, m = 1;

    s->way = opt_is(o, "match", "restricted") ? RESTRICTED
             : opt_is(o, "match", "permuted") ? PERMUTED : INDEPENDENT;
    s->fixed = opt_is(o, "randomize", "none");
    if (s->way == RESTRICTED && n <= 1u << 30) {
        while ((uint64_t)m * m < n)
            m++;
        *spp = n ? m * m : 0;
        if (*spp > n)
            note("uncorrelated: %lu samples a pixel instead of %lu, for %lu x %lu strata",
                 (unsigned long)*spp, (unsigned long)n, (unsigned long)m, (unsigned long)m);
    }
    plan_strata(s, spp);
    return true;
}

static void start(Sampler *s)
{
    uint32_t size = s->size;

    pattern_start(s);
    if (s->size != size)
        s->parts = factor(s->nx);
}

/* The stratum that decision d has with stratum p of the pixel. */
static uint32_t matched(const Sampler *s, Decision d, uint32_t p)
{
    uint64_t key = draw64(s->pattern, d | THIRD);
    uint32_t m = s->nx, c, f, part;

    if (s->way != RESTRICTED || s->nx != s->ny)
        return permuted(p, s->size, key);
    c = p / m;
    f = p % m;
    part = permuted(f, m, key_with(key, c));
    return part * m + permuted(c, m, key_with(key, SECOND | part));
}

static uint32_t pixel_stratum(const Sampler *s)
{
    return permuted(s->at, s->size, draw64(s->pattern, SECOND));
}

#define ONE_D 0x80000000u       /* a decision's 1-D numbers have nothing to do with its 2-D ones */

static float one(Sampler *s, Decision d)
{
    uint32_t place = (uint32_t)draw64(s->key, d | THIRD);

    if (s->way == INDEPENDENT)
        return unit_of(place);
    return in_stratum(matched(s, d ^ ONE_D, pixel_stratum(s)), s->size, place);
}

/* Column and row of stratum (c, f). */
static V2 in_cell(const Sampler *s, uint32_t k, uint64_t place)
{
    uint32_t column = k % s->nx, row = k / s->nx;

    if (s->way == RESTRICTED && s->nx == s->ny) {
        uint32_t m = s->nx, a = s->parts, b = m / a, c = k / m, f = k % m;
        column = c % a * b + f % b;
        row = c / a * a + f / b;
    }
    return (V2){ in_stratum(column, s->nx, (uint32_t)(place >> 32)),
                 in_stratum(row, s->ny, (uint32_t)place) };
}

static V2 two(Sampler *s, Decision d)
{
    uint64_t place = draw64(s->key, d);
    uint32_t p;

    if (s->way == INDEPENDENT && d != DECISION(DECIDE_PIXEL, 0))
        return (V2){ unit_of((uint32_t)(place >> 32)), unit_of((uint32_t)place) };
    p = pixel_stratum(s);
    return in_cell(s, d == DECISION(DECIDE_PIXEL, 0) ? p : matched(s, d, p), place);
}

static const OptDef options[] = {
    { .key = "match", .type = OPT_CHOICE, .str = "restricted",
      .choices = "restricted permuted independent",
      .help = "all parts of the pixel with all parts of a decision; any permutation; or only the "
              "pixel has strata" },
    PIXEL_OPTION,
    { .key = NULL }
};

const SamplerKind sampler_uncorrelated = {
    .info = { "uncorrelated", "Shirley91 5.4.1",
              "uncorrelated jittering: strata of the pixel matched with those of each decision; "
              "counts are rounded up to a square", options },
    .plans = true, .init = init, .start = start, .one = one, .two = two
};
