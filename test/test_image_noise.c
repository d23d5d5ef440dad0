/* test_image_noise.c -- what two noisy images tell: their noise without a reference, and whether
 * any tile differs, with a rate of false alarms for all tiles together. */
#include "base/maths.h"
#include "base/statistics.h"
#include "image/compare.h"
#include "test/image_help.h"

#include <stdlib.h>

static bool family(const Image *a, const Image *r, double alpha, FamilyTest *f)
{
    return image_family_test(a, "a.pfm", r, "r.pfm", alpha, f);
}

/* Sum of 12 uniform numbers: mean 6, variance 1. */
static float noise(Rng *rng)
{
    float sum = -6.0f;
    for (int i = 0; i < 12; i++)
        sum += rng_unit(rng);
    return sum;
}

/* ---- two renders ---- */

typedef enum { GREY, CHANNELS, SPIKES } Kind;

static void fill(Image *im, Kind kind, Rng *rng)
{
    for (size_t i = 0; i < (size_t)im->w * im->h; i++) {
        float v[3];
        v[0] = noise(rng);
        for (int c = 1; c < 3; c++)
            v[c] = kind == GREY ? v[0] : noise(rng);
        for (int c = 0; c < 3 && kind == SPIKES; c++)
            v[c] = rng_unit(rng) < 0.05f ? 1.0f : 0.0f;
        im->pixels[i] = rgb(4 + v[0], 4 + v[1], 4 + v[2]);
    }
}

/* Eq. 4.15 against the error that is known because the expectation is: the ratios of variances that
 * erratum 4.3 gives. For spikes by hand, with w2 = 0.447 the sum of the squared weights, p = 0.05:
 * E|d|^2 = w2 p (1 - p) + (1 - w2) (2 p (1 - p))^2, and of two images half of
 * w2 2 p (1 - p) + (1 - w2) (2 p (1 - p))^2: 0.0237 / 0.0262 = 0.905. */
static void two_renders(void)
{
    static const double expected[] = { 1.0, 1.0, 0.905 }, bound[] = { 0.01, 0.01, 0.025 };
    enum { SIDE = 400 };
    Image a = new_image(SIDE, SIDE), b = new_image(SIDE, SIDE), r = new_image(SIDE, SIDE);
    Rng rng = rng_seed(3);
    ImageDifference d;
    ImageNoise e;

    for (int k = GREY; k <= SPIKES; k++) {
        double ratio;
        fill(&a, (Kind)k, &rng);
        fill(&b, (Kind)k, &rng);
        for (size_t i = 0; i < (size_t)SIDE * SIDE; i++)
            r.pixels[i] = rgb_all(k == SPIKES ? 4.05f : 4.0f);
        REQUIRE(image_noise(&a, "a", &b, "b", &e) && image_compare(&a, "a", &r, "r", &d),
                "compare");
        ratio = e.sigma * e.sigma / (d.sigma * d.sigma);
        EXPECT(fabs(ratio - expected[k]) < bound[k], "kind %d: %g", k, ratio);
        EXPECT(fabs(e.sigma_over_mu - e.sigma / (0.5 * (e.mean_a + e.mean_b))) < 1e-12 &&
               fabs(e.mean_a - d.mean_a) < 1e-9, "kind %d: means", k);
        EXPECT(k == SPIKES || fabs(e.relmse / d.relmse - 1) < 0.12, "kind %d: relmse %g %g", k,
               e.relmse, d.relmse);
    }
    image_clear(&a);
    image_clear(&b);
    image_clear(&r);
}

static void two_odd_renders(void)
{
    Image a = new_image(2, 1), b = new_image(2, 1), small = new_image(1, 2);
    ImageNoise e;

    a.pixels[0] = rgb(1, 0, 0.5f);              /* |a - b| = 0.299 + 0.587 */
    b.pixels[0] = rgb(2, 1, 0.5f);
    a.pixels[1] = rgb_all(NAN);
    REQUIRE(image_noise(&a, "a", &b, "b", &e), "compare");
    EXPECT(e.pixels == 1 && fabs(e.sigma - 0.886 / sqrt(2.0)) < 1e-12, "by hand: %g", e.sigma);
    EXPECT(fabs(e.relmse - (0.5 / 2.26 + 0.5 / 0.26) / 3) < 1e-12, "relmse %g", e.relmse);
    a.pixels[0].r = INFINITY;
    REQUIRE(image_noise(&a, "a", &b, "b", &e), "compare");
    EXPECT(e.pixels == 0 && e.sigma == INFINITY && e.sigma_over_mu == INFINITY, "nothing left");
    EXPECT(!image_noise(&a, "a", &small, "b", &e) && err_status() == STATUS_INPUT, "sizes differ");
    image_clear(&a);
    image_clear(&b);
    image_clear(&small);
}

/* ---- the family ---- */

/* a and r: the same picture with noise of its own in each. spread: of each noise. */
static void fill_pair(Image *a, Image *r, float spread, Rng *rng)
{
    for (size_t i = 0; i < (size_t)a->w * a->h; i++) {
        float base = 3.0f + (float)(i % a->w) * 0.01f;
        a->pixels[i] = rgb_all(base + spread * noise(rng));
        r->pixels[i] = rgb_all(base + spread * noise(rng));
    }
}

/* 600 pairs of 64 tiles at alpha 0.1: 60 false alarms, with a standard deviation of 7.3. Without a
 * correction for the number of tiles nearly every pair would have one. */
static void false_alarms(void)
{
    enum { PAIRS = 600 };
    Image a = new_image(65, 67), r = new_image(65, 67);         /* tiles with a rest, too */
    Rng rng = rng_seed(21);
    FamilyTest f;
    int alarms = 0, plain = 0;

    for (int k = 0; k < PAIRS; k++) {
        fill_pair(&a, &r, 0.5f, &rng);
        REQUIRE(family(&a, &r, 0.1, &f) && f.tiles == 64, "test");
        EXPECT((f.differ > 0) == (f.p <= 0.1), "pair %d: p %g, %d tiles", k, f.p, (int)f.differ);
        alarms += f.differ > 0;
        plain += student_p(f.z, 63) < 0.1;
    }
    EXPECT(abs(alarms - PAIRS / 10) < 5 * 7.3, "%d of %d", alarms, PAIRS);
    EXPECT(plain > PAIRS * 9 / 10, "not corrected: %d", plain);
    image_clear(&a);
    image_clear(&r);
}

/* A shift of one tile by 1.2 standard deviations of the difference moves its z to 9.6; three such
 * tiles are all found, and no other. */
static void shifted_tiles(void)
{
    enum { SIDE = 256 };
    static const uint32_t at[3][2] = { { 16, 40 }, { 248, 0 }, { 128, 248 } };
    Image a = new_image(SIDE, SIDE), r = new_image(SIDE, SIDE);
    Rng rng = rng_seed(22);
    FamilyTest f;
    float shift = 1.2f * 0.5f * 1.414f;

    fill_pair(&a, &r, 0.5f, &rng);
    REQUIRE(family(&a, &r, 0.01, &f), "test");
    EXPECT(f.tiles == 1024 && f.differ == 0 && f.p > 0.01 && f.p < 1, "no shift: p %g", f.p);
    for (uint64_t n = 0; n < 3; n++) {
        for (uint32_t k = 0; k < 64; k++) {
            Rgb *p = image_at(&a, at[n][0] + k % 8, at[n][1] + k / 8);
            *p = rgb_sub(*p, rgb_all(shift));
        }
        REQUIRE(family(&a, &r, 0.01, &f), "test");
        EXPECT(f.differ == n + 1 && f.p < 1e-5 && f.z < -6, "%d shifted: %d found, p %g",
               (int)n + 1, (int)f.differ, f.p);
        EXPECT(n || (f.at.x == at[0][0] && f.at.y == at[0][1]), "at %u %u", (unsigned)f.at.x,
               (unsigned)f.at.y);
    }
    image_clear(&a);
    image_clear(&r);
}

static void odd_families(void)
{
    Image a = new_image(8, 8), r = new_image(8, 8), small = new_image(2, 3);
    FamilyTest f;

    REQUIRE(family(&a, &r, 0.01, &f), "test");
    EXPECT(f.tiles == 1 && f.differ == 0 && f.p == 1, "two black ones: p %g", f.p);
    a.pixels[0] = rgb_all(1);                   /* z = 1 of 63 degrees of freedom, and one tile */
    REQUIRE(family(&a, &r, 0.01, &f), "test");
    EXPECT(fabs(f.p - student_p(1, 63)) < 1e-9 && fabs(f.z - 1) < 1e-6, "one tile: p %g", f.p);
    for (int i = 0; i < 64; i++)
        a.pixels[i] = rgb_all(INFINITY);
    REQUIRE(family(&a, &r, 0.01, &f), "test");
    EXPECT(f.tiles == 0 && f.differ == 0 && f.p == 1, "nothing left");
    EXPECT(!family(&a, &small, 0.01, &f) && err_status() == STATUS_INPUT, "sizes differ");
    image_clear(&a);
    image_clear(&r);
    image_clear(&small);
}

const TestCase test_image_noise[] = {
    { "two_renders", two_renders, false },
    { "two_odd_renders", two_odd_renders, false },
    { "false_alarms", false_alarms, false },
    { "shifted_tiles", shifted_tiles, false },
    { "odd_families", odd_families, false },
    { NULL, NULL, false }
};
