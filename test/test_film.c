/* test_film.c -- the film: exact sums, and samples that are no numbers. */
#include "base/random.h"
#include "image/film.h"
#include "test/test.h"

/* What is not finite is left out, counted, and the first place remembered. */
static void refused(void)
{
    const uint32_t window[4] = { 3, 4, 30, 20 };
    Rgb good[2] = { { 1, 2, 3 }, { 4, 5, 6 } }, bad[2] = { { 1, 2, 3 }, { 4, 5, 6 } };
    uint32_t x = 0, y = 0, index = 0;
    Image im;
    Film f;

    REQUIRE(film_init(&f, 40, 40, window, 2) && image_init(&im, 27, 16), "memory");
    bad[1].g = NAN;
    film_add(&f, 20, 10, 0, good);
    film_add(&f, 20, 10, 1, bad);
    bad[1].g = -INFINITY;
    film_add(&f, 20, 10, 2, bad);
    EXPECT(film_refused(&f, &x, &y, &index) == 2 && x == 20 && y == 10 && index == 1,
           "refused: first at %lu,%lu sample %lu", (unsigned long)x, (unsigned long)y,
           (unsigned long)index);
    film_picture(&f, 0, &im);
    EXPECT(image_at(&im, 17, 6)->g == 2, "the good layer is %g", (double)image_at(&im, 17, 6)->g);
    film_picture(&f, 1, &im);
    EXPECT(image_at(&im, 17, 6)->r == 4.0f / 3, "the bad one counts as black: %g",
           (double)image_at(&im, 17, 6)->r);
    image_clear(&im);
    film_clear(&f);
}

/* Sums do not depend on order, also with signs and sizes mixed, and are right to 2^-60 a term. */
static void exact_sums(void)
{
    enum { N = 1000 };
    Rng rng = rng_seed(71);
    static float v[N];
    Exact a = { 0, 0 }, b = { 0, 0 }, half[2] = { { 0, 0 }, { 0, 0 } };
    double sum = 0, size = 0;

    for (int i = 0; i < N; i++) {
        float mantissa = 2 * rng_unit(&rng) - 1;
        int e = (int)rng_below(&rng, 40) - 30;
        v[i] = mantissa * (float)md_pow(2, e);
        sum += (double)v[i];            /* 2^-30 .. 2^10 in double: exact to 2^-42 or so */
        size += fabs((double)v[i]);
    }
    for (int i = 0; i < N; i++) {
        EXPECT(exact_add(&a, v[i]) && exact_add(&b, v[(i * 7 + 3) % N]), "refused %g",
               (double)v[i]);
        exact_add(&half[i % 2], v[i]);
    }
    exact_join(&half[0], &half[1]);
    EXPECT(a.lo == b.lo && a.hi == b.hi, "order matters");
    EXPECT(a.lo == half[0].lo && a.hi == half[0].hi, "joining differs from adding");
    EXPECT(fabs(exact_value(&a) - sum) <= N * (0x1p-60 + size * 0x1p-53), "%.17g, in double %.17g",
           exact_value(&a), sum);
    EXPECT(!exact_add(&a, INFINITY) && !exact_add(&a, NAN) && !exact_add(&a, -0x1p61f) &&
           exact_add(&a, -0x1p-70f), "limits of what is added");
    EXPECT(a.lo == b.lo && a.hi == b.hi, "what was refused changed the sum");
}

const TestCase test_film[] = {
    { "refused", refused, false },
    { "exact_sums", exact_sums, false },
    { NULL, NULL, false }
};
