/* test_image_compare.c -- figures of image difference against numbers worked out by hand. */
#include "image/compare.h"
#include "test/image_help.h"

static bool near(double a, double b) { return fabs(a - b) <= 1e-12 * fabs(b); }

static bool compare(const Image *a, const Image *r, ImageDifference *d)
{
    return image_compare(a, "a.pfm", r, "r.pfm", d);
}

/* Two pixels; all values are exact floats.
 *     a: (1, 0.5, 0.25) (2, 0, 1)       r: (0.5, 1, 0.25) (1, 0, 3)
 *     differences (0.5, 0.5, 0) and (1, 0, 2)
 *     distances 0.443 and 0.527; |r| 0.765 and 0.641; |a| 0.621 and 0.712 */
static void figures(void)
{
    Image a = new_image(2, 1), r = new_image(2, 1);
    ImageDifference d;
    const double sigma2 = (0.443 * 0.443 + 0.527 * 0.527) / 2;

    a.pixels[0] = rgb(1, 0.5f, 0.25f);
    a.pixels[1] = rgb(2, 0, 1);
    r.pixels[0] = rgb(0.5f, 1, 0.25f);
    r.pixels[1] = rgb(1, 0, 3);
    REQUIRE(compare(&a, &r, &d), "compare");
    EXPECT(d.pixels == 2 && d.not_finite_a == 0 && d.not_finite_r == 0, "counts");
    EXPECT(near(d.sigma, sqrt(sigma2)), "sigma %.17g", d.sigma);
    EXPECT(near(d.mean_r, 0.703) && near(d.mean_a, 0.6665), "means %.17g %.17g", d.mean_a,
           d.mean_r);
    EXPECT(near(d.sigma_over_mu, sqrt(sigma2) / 0.703), "sigma/mu %.17g", d.sigma_over_mu);
    EXPECT(near(d.ratio, 0.6665 / 0.703), "ratio %.17g", d.ratio);
    EXPECT(near(d.rmse, sqrt(5.5 / 6)), "rmse %.17g", d.rmse);
    EXPECT(near(d.relmse, (0.25 / 0.26 + 0.25 / 1.01 + 1 / 1.01 + 4 / 9.01) / 6), "relmse %.17g",
           d.relmse);
    EXPECT(d.max == 2 && d.max_at.x == 1 && d.max_at.y == 0 && d.max_channel == 2, "max %g", d.max);
    /* z: the differences of |.| are -0.144 and 0.071, their mean -0.0365, the standard deviation
     * 0.215 / sqrt(2), and that of the mean 0.1075. */
    EXPECT(d.tiles == 1 && near(d.z_max, -0.0365 / 0.1075) && d.z_mean == d.z_max, "z %.17g",
           d.z_max);

    /* The reference is the denominator: exchanged, the same sigma over another mean. */
    REQUIRE(compare(&r, &a, &d), "compare");
    EXPECT(near(d.sigma, sqrt(sigma2)) && near(d.sigma_over_mu, sqrt(sigma2) / 0.6665),
           "exchanged: %.17g", d.sigma_over_mu);
    image_clear(&a);
    image_clear(&r);
}

static void odd_images(void)
{
    Image a = new_image(3, 2), r = new_image(3, 2), small = new_image(2, 3);
    ImageDifference d;

    REQUIRE(compare(&a, &r, &d), "compare");
    EXPECT(d.sigma == 0 && d.sigma_over_mu == 0 && d.ratio == 0 && d.z_max == 0, "two black ones");
    a.pixels[4] = rgb(1, 0, 0);
    REQUIRE(compare(&a, &r, &d), "compare");
    EXPECT(d.sigma_over_mu == INFINITY && d.ratio == INFINITY && d.max == 1, "black reference");
    a.pixels[0].g = NAN;
    a.pixels[1].b = INFINITY;
    r.pixels[1].r = -INFINITY;
    r.pixels[5].r = NAN;
    REQUIRE(compare(&a, &r, &d), "compare");
    EXPECT(d.pixels == 3 && d.not_finite_a == 2 && d.not_finite_r == 2 && d.max == 1, "counts");
    EXPECT(near(d.rmse, 1.0 / 3) && near(d.mean_a, 0.299 / 3), "figures leave them out");
    for (int i = 0; i < 6; i++)
        a.pixels[i] = rgb_all(NAN);
    REQUIRE(compare(&a, &r, &d), "compare");
    EXPECT(d.pixels == 0 && d.sigma_over_mu == INFINITY && d.rmse == INFINITY && d.tiles == 0 &&
           d.z_mean == 0 && d.z_max == 0, "nothing left");
    EXPECT(err_status() == STATUS_OK, "status");
    EXPECT(!compare(&a, &small, &d) && err_status() == STATUS_INPUT, "sizes differ");
    image_clear(&a);
    image_clear(&r);
    image_clear(&small);
}

/* A tile whose pixels differ by 0 and 1 in turns: mean 1/2, variance 1/4 * 64/63, z = sqrt(63). */
static void z_by_hand(void)
{
    Image a = new_image(8, 8), r = new_image(8, 8);
    ImageDifference d;

    for (int i = 0; i < 64; i++) {
        r.pixels[i] = rgb_all(4.0f);
        a.pixels[i] = rgb_all(4.0f + (float)(i % 2));
    }
    REQUIRE(compare(&a, &r, &d), "compare");
    EXPECT(fabs(d.z_max - sqrt(63.0)) < 1e-9, "z %.17g", d.z_max);
    for (int i = 0; i < 64; i++)                /* no noise: the floats' own rounding is the unit */
        a.pixels[i] = rgb_all(5.0f);
    REQUIRE(compare(&a, &r, &d), "compare");
    EXPECT(fabs(d.z_max / (0x1p24 / 9.0) - 1.0) < 1e-6, "z %.17g", d.z_max);
    image_clear(&a);
    image_clear(&r);
}

/* 21 x 17 pixels are 2 x 2 tiles, of 8 or 13 columns and 8 or 9 rows. */
static void z_tiles(void)
{
    static const uint32_t at[4][4] = {          /* a pixel, and where its tile begins */
        { 7, 7, 0, 0 }, { 20, 0, 8, 0 }, { 0, 16, 0, 8 }, { 8, 8, 8, 8 }
    };
    Image a = new_image(21, 17), r = new_image(21, 17);
    ImageDifference d;

    for (int k = 0; k < 4; k++) {
        float sign = k % 2 ? -1.0f : 1.0f;
        image_at(&a, at[k][0], at[k][1])->g = sign;
        REQUIRE(compare(&a, &r, &d), "compare");
        image_at(&a, at[k][0], at[k][1])->g = 0;
        EXPECT(d.tiles == 4 && d.z_max_at.x == at[k][2] && d.z_max_at.y == at[k][3], "tile %u %u",
               (unsigned)d.z_max_at.x, (unsigned)d.z_max_at.y);
        /* One of n pixels differs: mean 1/n, variance 1/n, so z is 1. */
        EXPECT(fabs(d.z_max - (double)sign) < 1e-6, "z %.17g", d.z_max);
        EXPECT(fabs(d.z_mean - (double)sign / 4) < 1e-6, "mean z %.17g", d.z_mean);
    }
    image_clear(&a);
    image_clear(&r);
}

/* Sum of 12 uniform numbers: mean 6, variance 1. */
static float noise(Rng *rng)
{
    float sum = -6.0f;
    for (int i = 0; i < 12; i++)
        sum += rng_unit(rng);
    return sum;
}

/* T = 4096 tiles. Without a shift z_mean has a standard deviation of 1.016 / 64, and P(|t_63| > 7)
 * is below 3e-9 a tile. A shift of s standard deviations of the difference moves every z by 8 s. */
static void z_statistics(void)
{
    enum { SIDE = 512 };
    Image a = new_image(SIDE, SIDE), r = new_image(SIDE, SIDE);
    Rng rng = rng_seed(12);
    ImageDifference d;
    const double unit = 1.016 / 64, both = sqrt(1.0 + 0.25);

    for (int i = 0; i < SIDE * SIDE; i++) {
        float base = (float)(i % SIDE) * 0.01f;         /* a picture that both share */
        a.pixels[i] = rgb_all(base + 0.5f * noise(&rng));
        r.pixels[i] = rgb_all(base + noise(&rng));
    }
    REQUIRE(compare(&a, &r, &d), "compare");
    EXPECT(d.tiles == 4096 && fabs(d.z_max) < 7.0 && fabs(d.z_max) > 2.5, "z_max %g", d.z_max);
    EXPECT(fabs(d.z_mean) < 5 * unit, "z_mean %g", d.z_mean);
    /* sigma^2 is E (|r| + |g| + |b| weighted)^2 = E of the squared grey difference = 1.25. */
    EXPECT(fabs(d.sigma * d.sigma / 1.25 - 1.0) < 5 * sqrt(2.0 / (SIDE * SIDE)), "sigma %g",
           d.sigma);
    for (int i = 0; i < SIDE * SIDE; i++)
        a.pixels[i] = rgb_add(a.pixels[i], rgb_all(0.025f));
    REQUIRE(compare(&a, &r, &d), "compare");
    /* E z = 8 s (1 + 3 / (4 * 63)), for the mean of 1/s is above 1/sigma. */
    EXPECT(fabs(d.z_mean - 8 * 0.025 / both * (1 + 0.75 / 63)) < 6 * unit, "z_mean %g", d.z_mean);
    EXPECT(d.z_mean > 6 * unit, "a shift of 2 %% of the noise is not seen: %g", d.z_mean);
    image_clear(&a);
    image_clear(&r);
}

static void pictures(void)
{
    Image a = new_image(2, 2), r = new_image(2, 2), out;

    a.pixels[1] = rgb_all(1.5f);
    r.pixels[1] = rgb_all(1.0f);
    a.pixels[2] = rgb(0, 1, 2);
    r.pixels[2] = rgb(1, 1, 4);
    a.pixels[3].b = NAN;
    REQUIRE(image_difference(&a, "a", &r, "r", DIFFERENCE_SIGNED, 2.0, &out), "signed");
    EXPECT(rgb_black(out.pixels[0]), "equal pixels are black");
    EXPECT(out.pixels[1].r == 1.0f && out.pixels[1].g == 0.0f && out.pixels[1].b == 0.0f, "red");
    EXPECT(out.pixels[2].r == 0.0f && out.pixels[2].g == 0.0f &&
           fabsf(out.pixels[2].b - 2 * (0.299f + 0.228f)) < 1e-6f, "blue %g", out.pixels[2].b);
    EXPECT(out.pixels[3].g == 1.0f && out.pixels[3].r == 0.0f, "not finite");
    image_clear(&out);
    REQUIRE(image_difference(&a, "a", &r, "r", DIFFERENCE_ABSOLUTE, 2.0, &out), "absolute");
    EXPECT(out.pixels[2].r == 2.0f && out.pixels[2].g == 0.0f && out.pixels[2].b == 4.0f, "abs");
    image_clear(&out);
    image_clear(&r);
    r = new_image(1, 4);
    EXPECT(!image_difference(&a, "a", &r, "r", DIFFERENCE_ABSOLUTE, 2.0, &out) && !out.pixels &&
           err_status() == STATUS_INPUT, "sizes differ");
    image_clear(&a);
    image_clear(&r);
}

const TestCase test_image_compare[] = {
    { "figures", figures, false },
    { "odd_images", odd_images, false },
    { "z_by_hand", z_by_hand, false },
    { "z_tiles", z_tiles, false },
    { "z_statistics", z_statistics, false },
    { "pictures", pictures, false },
    { NULL, NULL, false }
};
