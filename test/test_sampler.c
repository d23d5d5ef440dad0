/* test_sampler.c -- the samplers: what all of them promise (a pure function of seed, pixel, index
 * and decision; numbers in [0, 1); every point uniform over pixels; decisions, pixels and seeds
 * independent), and the elementary intervals of `zerotwo`, each of which holds just one sample.
 *
 * Bounds of means are 5.6 standard errors: 2e-8, as for the chi-squared tests of chi2.h. */
#include "sampling/sampler.h"
#include "test/chi2.h"
#include "test/test.h"

#include <string.h>

#define SIGMAS 5.6

static Sampler sampler_of(const SamplerKind *kind, uint64_t seed)
{
    uint32_t spp = 16;
    Sampler s;
    Opts o;

    opts_default(&o, kind->info.options);
    memset(&s, 0, sizeof s);
    REQUIRE(sampler_init(&s, kind, &o, seed, &spp), "%s", kind->info.name);
    return s;
}

static V2 point_at(Sampler *s, uint32_t pixel, uint32_t index, Decision d)
{
    sampler_pixel(s, pixel % 1024, pixel / 1024);
    sampler_start(s, index);
    return sample_2d(s, d);
}

static float number_at(Sampler *s, uint32_t pixel, uint32_t index, Decision d)
{
    sampler_pixel(s, pixel % 1024, pixel / 1024);
    sampler_start(s, index);
    return sample_1d(s, d);
}

/* ---- all samplers ---- */

static bool canonical(float x)
{
    return x >= 0.0f && x < 1.0f && x * 0x1p24f == floorf(x * 0x1p24f);
}

static void range(void)
{
    for (int k = 0; samplers[k]; k++) {
        Sampler s = sampler_of(samplers[k], 1);
        for (uint32_t i = 0; i < 300000; i++) {
            V2 u = point_at(&s, i, i % 97, i % 64);
            float x = sample_1d(&s, i % 61);
            EXPECT(canonical(u.x) && canonical(u.y) && canonical(x), "%s gave %a, %a and %a",
                   samplers[k]->info.name, (double)u.x, (double)u.y, (double)x);
        }
        sampler_clear(&s);
    }
    EXPECT(unit_of(UINT32_MAX) == ONE_MINUS_ULP, "the largest number is %a",
           (double)unit_of(UINT32_MAX));
}

/* The same question has the same answer, whatever was asked before, also of a copy. */
static void pure(void)
{
    Rng rng = rng_seed(71);

    for (int k = 0; samplers[k]; k++) {
        Sampler a = sampler_of(samplers[k], 9), b = sampler_of(samplers[k], 9), c;
        for (int i = 0; i < 20000; i++) {
            uint32_t pixel = rng_below(&rng, 4), index = rng_below(&rng, 8);
            Decision d = rng_below(&rng, 40);
            V2 u = point_at(&a, pixel, index, d), v, w;
            float x = sample_1d(&a, d), y;
            point_at(&b, rng_below(&rng, 4), rng_below(&rng, 8), rng_below(&rng, 40));
            v = point_at(&b, pixel, index, d);
            sample_2d(&b, d + 1);
            y = sample_1d(&b, d);
            c = a;
            w = sample_2d(&c, d);
            EXPECT(u.x == v.x && u.y == v.y && x == y && u.x == w.x && u.y == w.y,
                   "%s: two answers", samplers[k]->info.name);
        }
        sampler_clear(&a);
        sampler_clear(&b);
    }
}

/* ---- uniformity ---- */

enum { CELLS = 64 };

static uint32_t cell(float x) { return (uint32_t)(x * CELLS); }

static void expect_even(const uint64_t *count, size_t n, uint64_t draws, const char *sampler,
                        const char *what)
{
    static double expected[CELLS * CELLS];
    double p;

    for (size_t i = 0; i < n; i++)
        expected[i] = (double)draws / (double)n;
    p = chi2_counts(expected, count, n);
    EXPECT(p >= CHI2_P_MIN, "%s, %s: p = %g", sampler, what, p);
}

/* The sample of one index and decision, over pixels. */
static void uniform(void)
{
    static const uint32_t index[6] = { 0, 1, 2, 5, 100, 4095 };
    const uint32_t PIXELS = test_is_long() ? 1000000 : 100000;

    for (int k = 0; samplers[k]; k++)
        for (int i = 0; i < 6; i++) {
            static uint64_t one[CELLS], two[CELLS * CELLS];
            Sampler s = sampler_of(samplers[k], 3);
            Decision d = DECISION(DECIDE_DIRECTION, i);
            memset(one, 0, sizeof one);
            memset(two, 0, sizeof two);
            for (uint32_t pixel = 0; pixel < PIXELS; pixel++) {
                V2 u = point_at(&s, pixel, index[i], d);
                two[cell(u.y) * CELLS + cell(u.x)]++;
                one[cell(sample_1d(&s, DECISION(DECIDE_LOBE, i)))]++;
            }
            expect_even(one, CELLS, PIXELS, samplers[k]->info.name, "1-D");
            expect_even(two, CELLS * CELLS, PIXELS, samplers[k]->info.name, "2-D");
            sampler_clear(&s);
        }
}

/* ---- independence ---- */

/* Sums of (x - 1/2)(y - 1/2): of independent uniform numbers the product has variance 1/144. */
typedef struct { double sum; uint64_t n; uint64_t cells[CELLS * CELLS]; } Pairing;

static void pair_up(Pairing *p, float x, float y)
{
    p->sum += (x - 0.5) * (y - 0.5);
    p->n++;
    p->cells[cell(y) * CELLS + cell(x)]++;
}

static void expect_unrelated(const Pairing *p, const char *sampler, const char *what)
{
    double z = p->sum * 12 / sqrt((double)p->n);
    EXPECT(fabs(z) < SIGMAS, "%s, %s: correlated by %g standard errors", sampler, what, z);
    expect_even(p->cells, CELLS * CELLS, p->n, sampler, what);
}

/* Two numbers that must have nothing to do with each other, `turn` of many such pairs. */
enum { RELATIONS = 9 };
static const char *const relations[RELATIONS] = {
    "decisions of a bounce", "bounces of a decision", "1-D and 2-D of a decision",
    "x and y of a point", "neighbouring pixels", "neighbouring seeds",
    "different samples of different decisions", "1-D decisions of a bounce",
    "bounces of a 1-D decision"
};

static void relate(Pairing *p, int relation, Sampler *s, Sampler *other, uint32_t pixel)
{
    uint32_t i = pixel % 7;
    V2 u = point_at(s, pixel, i, DECISION(DECIDE_DIRECTION, 1));

    switch (relation) {
    case 0: pair_up(p, u.x, sample_2d(s, DECISION(DECIDE_LIGHT_POINT, 1)).x); break;
    case 1: pair_up(p, u.y, sample_2d(s, DECISION(DECIDE_DIRECTION, 2)).y); break;
    case 2: pair_up(p, sample_1d(s, DECISION(DECIDE_LOBE, 1)), u.y); break;
    case 3: pair_up(p, u.x, u.y); break;
    case 4: pair_up(p, u.x, point_at(s, pixel + 1, i, DECISION(DECIDE_DIRECTION, 1)).x); break;
    case 5: pair_up(p, u.y, point_at(other, pixel, i, DECISION(DECIDE_DIRECTION, 1)).y); break;
    case 6: pair_up(p, u.x, number_at(s, pixel, i + 1, DECISION(DECIDE_LIGHT, 1))); break;
    case 7: pair_up(p, sample_1d(s, DECISION(DECIDE_LOBE, 1)),
                    sample_1d(s, DECISION(DECIDE_ROULETTE, 1))); break;
    case 8: pair_up(p, sample_1d(s, DECISION(DECIDE_LOBE, 1)),
                    sample_1d(s, DECISION(DECIDE_LOBE, 2))); break;
    }
}

static void independent(void)
{
    const uint32_t pixels = test_is_long() ? 1000000 : 100000;
    static Pairing p;

    for (int k = 0; samplers[k]; k++) {
        Sampler s = sampler_of(samplers[k], 4), other = sampler_of(samplers[k], 5);
        for (int r = 0; r < RELATIONS; r++) {
            memset(&p, 0, sizeof p);
            for (uint32_t pixel = 0; pixel < pixels; pixel++)
                relate(&p, r, &s, &other, pixel);
            expect_unrelated(&p, samplers[k]->info.name, relations[r]);
        }
        sampler_clear(&s);
        sampler_clear(&other);
    }
}

/* Within a pixel too: that each decision is stratified must not line one up with another. The sum
 * over a pixel's samples of (x - 1/2)(y - 1/2), over pixels: its mean is 0 to its own standard
 * error, and its variance that of independent pairs, n / 144, or at most twice that where samples
 * 2k and 2k + 1 lie in opposite halves of each decision. Taken in the same order by two decisions,
 * the samples would all lie on one diagonal of halves or on the other: n^2 / 256. */
static void independent_within_pixels(void)
{
    const uint32_t PIXELS = test_is_long() ? 100000 : 10000, SPP = 64;

    for (int k = 0; samplers[k]; k++) {
        Sampler s = sampler_of(samplers[k], 6);
        double sum = 0, squares = 0, z;
        for (uint32_t pixel = 0; pixel < PIXELS; pixel++) {
            double all = 0;
            for (uint32_t i = 0; i < SPP; i++) {
                V2 u = point_at(&s, pixel, i, DECISION(DECIDE_DIRECTION, 0));
                V2 v = sample_2d(&s, DECISION(DECIDE_LIGHT_POINT, 0));
                all += (u.x - 0.5) * (v.x - 0.5);
            }
            sum += all;
            squares += all * all;
        }
        z = sum / sqrt(squares);
        EXPECT(fabs(z) < SIGMAS, "%s: %g standard errors", samplers[k]->info.name, z);
        squares /= PIXELS * SPP / 144.0;
        EXPECT(squares < 2.1, "%s: %g times the variance", samplers[k]->info.name, squares);
        sampler_clear(&s);
    }
}

/* Scrambling places each sample in its stratum by itself: not all of them alike. */
static void strata_apart(void)
{
    static Pairing p;
    Sampler s = sampler_of(kind_find(samplers, "zerotwo"), 7);

    for (uint32_t other = 1; other < 16; other *= 2) {
        memset(&p, 0, sizeof p);
        for (uint32_t pixel = 0; pixel < 1000000; pixel++) {
            float a = 16 * point_at(&s, pixel, 0, DECISION(DECIDE_PIXEL, 0)).x;
            float b = 16 * point_at(&s, pixel, other, DECISION(DECIDE_PIXEL, 0)).x;
            pair_up(&p, a - floorf(a), b - floorf(b));
        }
        expect_unrelated(&p, "zerotwo", "places within strata");
    }
}

/* ---- random ---- */

/* Mean 1/2 with variance 1/12; mean square about it 1/12 with variance 1/180. */
static void moments(void)
{
    enum { N = 2000000 };
    Sampler s = sampler_of(kind_find(samplers, "random"), 8);
    double mean[3] = { 0, 0, 0 }, square[3] = { 0, 0, 0 };

    for (uint32_t i = 0; i < N; i++) {
        V2 u = point_at(&s, i / 16, i % 16, DECISION(DECIDE_PIXEL, 0));
        float v[3] = { u.x, u.y, sample_1d(&s, DECISION(DECIDE_LIGHT, 0)) };
        for (int k = 0; k < 3; k++) {
            double d = v[k] + 0x1p-25 - 0.5;            /* the middle of its cell */
            mean[k] += d;
            square[k] += d * d - 1.0 / 12;
        }
    }
    for (int k = 0; k < 3; k++)
        EXPECT(fabs(mean[k]) < SIGMAS * sqrt(N / 12.0) &&
               fabs(square[k]) < SIGMAS * sqrt(N / 180.0),
               "number %d: mean off by %g, variance by %g standard errors", k,
               mean[k] / sqrt(N / 12.0), square[k] / sqrt(N / 180.0));
}

/* ---- zerotwo ---- */

enum { BLOCK_MOST = 8, SAMPLES = 1 << (BLOCK_MOST + 1) };

/* Each of the 2^k cells, 2^a wide and 2^(k - a) high, holds one of the 2^k points. */
static bool one_in_each(const V2 *u, int k, int a)
{
    unsigned char seen[1 << BLOCK_MOST];

    memset(seen, 0, sizeof seen);
    for (int i = 0; i < 1 << k; i++) {
        uint32_t x = (uint32_t)(u[i].x * (float)(1 << a));
        uint32_t y = (uint32_t)(u[i].y * (float)(1 << (k - a)));
        if (seen[y << a | x]++)
            return false;
    }
    return true;
}

/* Every aligned block of 2^k samples; 1-D numbers stand in x, with y = 0. */
static bool blocks_are_even(const V2 *u, bool flat)
{
    for (int k = 0; k <= BLOCK_MOST; k++)
        for (int from = 0; from < SAMPLES; from += 1 << k)
            for (int a = flat ? k : 0; a <= k; a++)
                if (!one_in_each(u + from, k, a))
                    return false;
    return true;
}

static void elementary_intervals(void)
{
    Sampler s = sampler_of(kind_find(samplers, "zerotwo"), 10);
    uint32_t pixels = test_is_long() ? 5000 : 500;

    for (uint32_t pixel = 0; pixel < pixels; pixel++)
        for (Decision d = 0; d < 4 * DECIDE_KINDS; d += 5) {
            static V2 two[SAMPLES], one[SAMPLES];
            uint32_t first = pixel % 3 * 4096;          /* also later blocks of the sequence */
            for (uint32_t i = 0; i < SAMPLES; i++) {
                two[i] = point_at(&s, pixel * 77, first + i, d);
                one[i] = (V2){ sample_1d(&s, d), 0.0f };
            }
            EXPECT(blocks_are_even(two, false) && blocks_are_even(one, true),
                   "pixel %lu, decision %lu", (unsigned long)pixel, (unsigned long)d);
        }
}

/* Of a smooth function the error falls faster than with independent numbers: the mean of 256 points
 * of x y + x^2 has less than a tenth of their variance. (Strata alone give 1/16 or so in each of
 * 16 x 16 cells; the sequence is better than that.) */
static void better_than_random(void)
{
    enum { PIXELS = 2000, SPP = 256 };
    double variance[2] = { 0, 0 }, truth = 0.25 + 1.0 / 3;
    const char *const name[2] = { "random", "zerotwo" };

    for (int k = 0; k < 2; k++) {
        Sampler s = sampler_of(kind_find(samplers, name[k]), 11);
        for (uint32_t pixel = 0; pixel < PIXELS; pixel++) {
            double sum = 0;
            for (uint32_t i = 0; i < SPP; i++) {
                V2 u = point_at(&s, pixel, i, DECISION(DECIDE_PIXEL, 0));
                sum += (double)u.x * u.y + (double)u.x * u.x;
            }
            variance[k] += (sum / SPP - truth) * (sum / SPP - truth);
        }
    }
    EXPECT(variance[1] < 0.1 * variance[0], "variance %g against %g", variance[1] / PIXELS,
           variance[0] / PIXELS);
}

const TestCase test_sampler[] = {
    { "range", range, false }, { "pure", pure, false }, { "uniform", uniform, false },
    { "independent", independent, false },
    { "independent_within_pixels", independent_within_pixels, false },
    { "strata_apart", strata_apart, false }, { "moments", moments, false },
    { "elementary_intervals", elementary_intervals, false },
    { "better_than_random", better_than_random, false },
    { NULL, NULL, false }
};
