/* test_film_sums.c -- the film's sums against whole numbers of as many digits as it takes; that
 * neither order nor grouping matters to a single bit; tiles; the estimate of noise. */
#include "base/mem.h"
#include "base/random.h"
#include "image/film.h"
#include "test/test.h"

#include <stdlib.h>
#include <string.h>

/* ---- the same sum by schoolbook arithmetic: digits of 30 bits, the lowest worth 2^-60 ---- */

enum { DIGITS = 6 };
typedef struct { int64_t d[DIGITS]; } Long;

/* Half a unit is rounded away from 0. */
static void long_add(Long *sum, float v)
{
    int e, shift;
    int64_t m = (int64_t)ldexp(fabs(frexp(v, &e)), 24);         /* |v| = m 2^(e - 24) */

    shift = e - 24 + 60;
    if (shift < -30)
        return;
    for (; shift < 0; shift++)
        m = shift == -1 ? (m + 1) / 2 : m / 2;
    m <<= shift % 30;
    sum->d[shift / 30] += v < 0 ? -(m & 0x3FFFFFFF) : m & 0x3FFFFFFF;
    sum->d[shift / 30 + 1] += v < 0 ? -(m >> 30) : m >> 30;
}

/* Digits from 0 to 2^30 - 1, the top one with the sign. */
static void long_settle(Long *a)
{
    for (int i = 0; i + 1 < DIGITS; i++) {
        int64_t carry = a->d[i] >= 0 ? a->d[i] >> 30 : -((-a->d[i] + 0x3FFFFFFF) >> 30);
        a->d[i] -= carry * 0x40000000;
        a->d[i + 1] += carry;
    }
}

static bool long_is(const Long *a, const Exact *e)
{
    uint64_t d[DIGITS], lo, hi;
    for (int i = 0; i < DIGITS; i++)
        d[i] = (uint64_t)a->d[i];
    lo = d[0] | d[1] << 30 | d[2] << 60;
    hi = d[2] >> 4 | d[3] << 26 | d[4] << 56;
    return lo == e->lo && hi == e->hi;
}

/* ---- numbers of all sizes ---- */

typedef enum { USUAL, TINY, HUGE_ONES, MIXED, POSITIVE, SIZES } Sizes;
static const int least[SIZES] = { -20, -84, 30, -90, -70 }, most[SIZES] = { 10, -40, 59, 59, 59 };

static float any_number(Rng *rng, Sizes s)
{
    int e = least[s] + (int)rng_below(rng, (uint32_t)(most[s] - least[s] + 1));
    float m = 0.5f + 0.5f * rng_unit(rng);              /* below 2^e */
    if (s != POSITIVE && rng_below(rng, 2))
        m = -m;
    return (float)ldexp(m, e);
}

static int by_value(const void *a, const void *b)
{
    float x = *(const float *)a, y = *(const float *)b;
    return (x > y) - (x < y);
}

static Exact sum_of(const float *v, size_t n)
{
    Exact e = { 0, 0 };
    for (size_t i = 0; i < n; i++)
        EXPECT(exact_add(&e, v[i]), "%a was refused", (double)v[i]);
    return e;
}

/* Sums of random runs of v, joined in random order until one is left. */
static Exact sum_in_parts(const float *v, size_t n, Rng *rng)
{
    Exact part[64];
    size_t parts = 0, from = 0;

    while (from < n) {
        size_t run = parts == 63 ? n - from : 1 + rng_below(rng, (uint32_t)(n - from));
        part[parts++] = sum_of(v + from, run);
        from += run;
    }
    while (parts > 1) {
        size_t a = rng_below(rng, (uint32_t)parts), b;
        do
            b = rng_below(rng, (uint32_t)parts);
        while (b == a);
        exact_join(&part[a], &part[b]);
        part[b] = part[--parts];
    }
    return part[0];
}

static void check_sum(float *v, size_t n, Rng *rng)
{
    Exact e = sum_of(v, n), again;
    Long truth;

    memset(&truth, 0, sizeof truth);
    for (size_t i = 0; i < n; i++)
        long_add(&truth, v[i]);
    long_settle(&truth);
    EXPECT(long_is(&truth, &e), "the sum is %.17g", exact_value(&e));
    for (int turn = 0; turn < 3; turn++) {
        again = sum_in_parts(v, n, rng);
        EXPECT(again.lo == e.lo && again.hi == e.hi, "grouping matters");
    }
    qsort(v, n, sizeof *v, by_value);
    again = sum_of(v, n);
    EXPECT(again.lo == e.lo && again.hi == e.hi, "order matters");
}

/* At most 100 of them: the sum of more could pass 2^67, where the fixed point ends. */
static void sums(void)
{
    Rng rng = rng_seed(61);
    static float v[20000];

    for (int turn = 0; turn < 2000; turn++) {
        Sizes s = (Sizes)(turn % SIZES);
        size_t n = most[s] < 50 && turn < 20 ? 20000 : 1 + rng_below(&rng, 100);
        for (size_t i = 0; i < n; i++)
            v[i] = any_number(&rng, s);
        check_sum(v, n, &rng);
    }
}

/* ---- values ---- */

/* A sum of 53 bits or fewer comes back as it is, others within a rounding or two. */
static void values(void)
{
    Rng rng = rng_seed(62);

    for (int turn = 0; turn < 10000; turn++) {
        int e = -60 + (int)rng_below(&rng, 67), terms = 1 + (int)rng_below(&rng, 500);
        double sum = 0;
        Exact x = { 0, 0 };
        for (int i = 0; i < terms; i++) {
            float v = (float)ldexp((double)rng_below(&rng, 1u << 24) - (1 << 23), e);
            exact_add(&x, v);
            sum += v;                           /* multiples of 2^e below 2^(e + 33): exact */
        }
        EXPECT(exact_value(&x) == sum, "%.17g and not %.17g", exact_value(&x), sum);
    }
    for (int turn = 0; turn < 10000; turn++) {
        double big = ldexp(1 + (double)rng_unit(&rng), 50), small = -(double)rng_unit(&rng);
        Exact x = { 0, 0 };
        exact_add(&x, (float)big);
        exact_add(&x, (float)small);
        EXPECT(fabs(exact_value(&x) - ((float)big + (double)(float)small)) <= 0x1p-51 * big,
               "%.17g and %.17g", big, small);
    }
}

static void limits(void)
{
    const float no[6] = { NAN, INFINITY, -INFINITY, 0x1p61f, -0x1p61f, 3.4e38f };
    static const float yes[6] = { 0x1.fffffep59f, -0x1.fffffep59f, 0x1p-60f, -0x1p-61f, 0.0f,
                                  -0.0f };
    static const float nothing[5] = { 0x1p-149f, -0x1p-126f, 0x1.fffffep-62f, 0.0f, -0.0f };

    for (int i = 0; i < 6; i++) {
        Exact e = { 12345, 67 };
        EXPECT(!exact_add(&e, no[i]) && e.lo == 12345 && e.hi == 67, "%a", (double)no[i]);
        EXPECT(exact_add(&e, yes[i]), "%a", (double)yes[i]);
    }
    for (int i = 0; i < 5; i++) {
        Exact e = { 12345, 67 };
        EXPECT(exact_add(&e, nothing[i]) && e.lo == 12345 && e.hi == 67, "%a",
               (double)nothing[i]);
    }
    for (int i = 0; i < 100; i++) {             /* across the carry, down and up again */
        Exact e = { (uint64_t)i, 0 };
        EXPECT(exact_add(&e, -0x1p-55f) && exact_add(&e, 0x1p-55f) && e.lo == (uint64_t)i &&
               e.hi == 0, "there and back from %d", i);
    }
}

/* ---- tiles and pictures ---- */

static void tiles(void)
{
    Rng rng = rng_seed(63);

    for (int turn = 0; turn < 300; turn++) {
        uint32_t w = 1 + rng_below(&rng, 90), h = 1 + rng_below(&rng, 90), crop[4];
        unsigned char *seen;
        uint64_t pixels = 0;
        Film f;
        crop[0] = rng_below(&rng, w);
        crop[1] = rng_below(&rng, h);
        crop[2] = crop[0] + 1 + rng_below(&rng, w - crop[0]);
        crop[3] = crop[1] + 1 + rng_below(&rng, h - crop[1]);
        REQUIRE(film_init(&f, w, h, crop, 1), "memory");
        seen = MEM_ARRAY(unsigned char, (size_t)w * h);
        REQUIRE(seen, "memory");
        for (uint32_t k = 0; k < film_ntiles(&f); k++) {
            uint32_t x0, y0, x1, y1;
            film_tile(&f, k, &x0, &y0, &x1, &y1);
            for (uint32_t y = y0; y < y1; y++)
                for (uint32_t x = x0; x < x1; x++, pixels++)
                    EXPECT(x >= crop[0] && x < crop[2] && y >= crop[1] && y < crop[3] &&
                           !seen[(size_t)y * w + x]++, "pixel %lu,%lu", (unsigned long)x,
                           (unsigned long)y);
        }
        EXPECT(pixels == (uint64_t)f.w * f.h, "tiles miss a pixel");
        mem_free(seen);
        film_clear(&f);
    }
}

/* ---- noise ---- */

/* The formula as it is defined: over pixels, the mean of the variance of their means; its root over
 * the mean of all. Samples are what a film keeps of a luminance: doubles from floats. */
static double noise_of(const float *lum, size_t pixels, size_t n)
{
    double variance = 0, all = 0;

    for (size_t p = 0; p < pixels; p++) {
        double mean = 0, squares = 0;
        for (size_t i = 0; i < n; i++)
            mean += lum[p * n + i];
        mean /= (double)n;
        for (size_t i = 0; i < n; i++)
            squares += (lum[p * n + i] - mean) * (lum[p * n + i] - mean);
        variance += squares / (double)(n - 1) / (double)n;
        all += mean;
    }
    return sqrt(variance / (double)pixels) / (all / (double)pixels);
}

static void noise(void)
{
    enum { W = 23, H = 18, MOST = 40 };
    static float lum[W * H * MOST];
    const uint32_t crop[4] = { 5, 6, 5 + W, 6 + H };
    Rng rng = rng_seed(64);

    for (size_t n = 1; n <= MOST; n += n < 4 ? 1 : 9) {
        double spread = n % 2 ? 1 : 0.1, want;
        Film f;
        REQUIRE(film_init(&f, 40, 40, crop, 1), "memory");
        for (uint32_t p = 0; p < W * H; p++)
            for (uint32_t i = 0; i < n; i++) {
                float g = (float)(p % 7 + spread * rng_unit(&rng));
                Rgb c = rgb_all(g);
                lum[p * n + i] = rgb_lum(c);
                film_add(&f, 5 + p % W, 6 + p / W, i, &c);
            }
        EXPECT(film_samples(&f) == (uint64_t)W * H * n, "count of samples");
        if (n < 2)
            EXPECT(film_error_independent(&f) == INFINITY, "one sample tells nothing of noise");
        else {
            /* The variance, spread^2 / 12, is what is left of squares of 15 in the mean; those of
             * the samples differ from the pixel's by the roundings of a luminance in float. */
            double bound = 0.5 * 15 * 2 * 4 * 6e-8 / (spread * spread / 12);
            want = noise_of(lum, W * H, n);
            EXPECT(fabs(film_error_independent(&f) - want) <= want * bound, "%g and not %g",
                   film_error_independent(&f), want);
        }
        film_clear(&f);
    }
}

static void no_noise(void)
{
    const uint32_t crop[4] = { 0, 0, 4, 4 };
    Film f;

    for (int bright = 0; bright < 2; bright++) {
        Rgb c = rgb_all((float)bright);
        REQUIRE(film_init(&f, 4, 4, crop, 1), "memory");
        for (uint32_t p = 0; p < 160; p++)
            film_add(&f, p % 4, p / 4 % 4, p / 16, &c);
        EXPECT(film_error(&f) < 1e-3, "error of what is constant: %g", film_error(&f));
        film_clear(&f);
    }
}

const TestCase test_film_sums[] = {
    { "sums", sums, false }, { "values", values, false }, { "limits", limits, false },
    { "tiles", tiles, false }, { "noise", noise, false }, { "no_noise", no_noise, false },
    { NULL, NULL, false }
};
