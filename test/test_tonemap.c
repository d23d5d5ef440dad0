/* test_tonemap.c -- curves against their formulas, exposure by the picture, dithering: what a
 * display is given. */
#include "image/tonemap.h"
#include "test/image_help.h"

#include <float.h>
#include <math.h>

static Display display_of(const char *text)
{
    static Arena arena;         /* of the case's process */
    Display d = { 0 };

    d.tonemap = kind_from_text(tonemaps, "tone mapper", text, &d.tonemap_opts, &arena);
    REQUIRE(d.tonemap, "%s", text);
    return d;
}

/* The curve at one colour of a picture that has no other. */
static Rgb mapped(const char *text, Rgb c)
{
    Display d = display_of(text);
    Image im = { 1, 1, &c, NULL };
    Tone t;

    REQUIRE(tone_init(&t, &d, &im), "tone_init");
    c = tone_pixel(&t, 0);
    tone_clear(&t);
    return c;
}

static void expect(const char *text, Rgb in, double r, double g, double b)
{
    Rgb c = mapped(text, in);

    EXPECT(fabs(c.r - r) <= 2e-7 && fabs(c.g - g) <= 2e-7 && fabs(c.b - b) <= 2e-7,
           "%s of %g %g %g is %.9g %.9g %.9g, not %.9g %.9g %.9g", text, (double)in.r,
           (double)in.g, (double)in.b, (double)c.r, (double)c.g, (double)c.b, r, g, b);
}

/* Figures by hand. */
static void formulas(void)
{
    expect("linear", rgb(0.25f, 1.0f, 7.0f), 0.25, 1, 1);
    expect("exponential", rgb(1.0f, 1e-6f, FLT_MAX), 0.63212055882855767840, 9.999995e-7, 1);
    expect("reinhard", rgb_all(3), 0.75, 0.75, 0.75);
    expect("reinhard", rgb(10, 0, 0), 1, 0, 0);                 /* 10 / 3.99 is cut */
    expect("reinhard:white=3", rgb_all(3), 1, 1, 1);
    expect("reinhard:white=2", rgb_all(1), 0.625, 0.625, 0.625);        /* (1 + 1/4) / 2 */
    expect("scurve:contrast=2,middle=0.5", rgb(0.5f, 0.25f, 1), 0.5, 0.2, 0.8);
    expect("scurve:contrast=1,middle=1", rgb(3, 1, 0), 0.75, 0.5, 0);
    expect("logarithmic:scale=1,white=7", rgb_all(1), 1 / 3.0, 1 / 3.0, 1 / 3.0);
    expect("logarithmic", rgb_all(123), 1, 1, 1);               /* the picture's own largest */
    expect("logarithmic:scale=1e-3,white=1e9", rgb_all(1e-3f), 7.2382416e-8, 7.2382416e-8,
           7.2382416e-8);                                       /* 1e-6 / log(1 + 1e6) */
    expect("filmic:white=4", rgb_all(2), 1, 1, 1);
    /* At x = 2: (2 (.3 + .05) + .004) / (2 (.3 + .5) + .06) - 1/15; at 11.2 the same sum */
    expect("filmic", rgb_all(1), (0.704 / 1.66 - 1 / 15.0) / (19.38 / 24.476 - 1 / 15.0),
           (0.704 / 1.66 - 1 / 15.0) / (19.38 / 24.476 - 1 / 15.0),
           (0.704 / 1.66 - 1 / 15.0) / (19.38 / 24.476 - 1 / 15.0));
    expect("local", rgb(3, 3, 3), 0.75, 0.75, 0.75);
    for (int i = 1; i < 256; i++) {             /* the display's curve becomes x^(1/gamma) */
        Display d = display_of("gamma:gamma=1.8");
        unsigned char b[3];
        colour_bytes(rgb_all((float)pow(i / 255.0, 1.8)), &d, b);
        EXPECT(b[0] == i, "gamma: %d comes out as %d", i, b[0]);
    }
}

/* Black stays black, more is more, nothing leaves [0,1], whatever the picture holds. */
static void curves(void)
{
    enum { N = 306 };
    Image im = new_image(N, 1);
    float x = 1e-12f;

    for (int i = 1; i < N - 2; i++, x *= 1.5f)
        im.pixels[i] = rgb_all(f_min(x, FLT_MAX));
    im.pixels[N - 2] = rgb(NAN, -1, INFINITY);
    im.pixels[N - 1] = rgb(FLT_MAX, 0, FLT_MAX);
    for (const ToneMap *const *k = tonemaps; *k; k++) {
        bool grows = *k != &tonemap_local;
        Display d = display_of((*k)->info.name);
        float last = 0.0f;
        Tone t;
        REQUIRE(tone_init(&t, &d, &im), "tone_init");
        EXPECT(rgb_black(tone_pixel(&t, 0)), "%s: black does not stay black", (*k)->info.name);
        for (size_t i = 1; i < N; i++) {
            Rgb c = tone_pixel(&t, i);
            EXPECT(rgb_finite(c) && rgb_min(c) >= 0 && rgb_max(c) <= 1, "%s of %g: %g %g %g",
                   (*k)->info.name, (double)im.pixels[i].r, (double)c.r, (double)c.g, (double)c.b);
            if (i < N - 2 && grows)
                EXPECT(c.r >= last && c.r == c.g && c.g == c.b, "%s(%g) = %g", (*k)->info.name,
                       (double)im.pixels[i].r, (double)c.r);
            last = c.r;
        }
        EXPECT(!grows || tone_pixel(&t, N - 3).r > 0.999f, "%s ends at %g", (*k)->info.name,
               (double)tone_pixel(&t, N - 3).r);
        tone_clear(&t);
    }
    image_clear(&im);
}

/* The mean around a pixel, by the whole picture at once. */
static double naive_mean(const Image *im, int x, int y, double width)
{
    double sum = 0, total = 0;

    for (int v = 0; v < (int)im->h; v++)
        for (int u = 0; u < (int)im->w; u++) {
            double w = exp(-((u - x) * (u - x) + (v - y) * (v - y)) / (width * width));
            sum += w * im->pixels[v * (int)im->w + u].g;
            total += w;
        }
    return sum / total;
}

/* [Reinhard02 (5) to (9)] written down as it stands there. *sure: no difference was so near the
 * threshold that rounding could decide. */
static double naive_local(const Image *im, int x, int y, bool *sure)
{
    double s = 1, chosen = naive_mean(im, x, y, 1 / (2 * sqrt(2.0)));

    *sure = true;
    for (int k = 0; k < 8; k++, s *= 1.6) {
        double v1 = naive_mean(im, x, y, s / (2 * sqrt(2.0)));
        double v2 = naive_mean(im, x, y, 1.6 * s / (2 * sqrt(2.0)));
        double v = fabs((v1 - v2) / (256 * 0.18 / (s * s) + v1));
        *sure = *sure && fabs(v - 0.05) > 0.001;
        if (v >= 0.05)
            break;
        chosen = v1;
    }
    return im->pixels[y * (int)im->w + x].g / (1 + chosen);
}

static void dodging(void)
{
    Image im = new_image(40, 33);
    Display d = display_of("local");
    int told = 0;
    Rng r = rng_seed(6);
    Tone t;

    for (uint32_t y = 0; y < im.h; y++)         /* steps, a ramp, a few spots */
        for (uint32_t x = 0; x < im.w; x++)
            *image_at(&im, x, y) = rgb_all((x < 20 ? 0.05f : 2.0f) + 0.05f * (float)y +
                                           (rng_below(&r, 40) ? 0 : 5.0f));
    REQUIRE(tone_init(&t, &d, &im), "tone_init");
    for (int y = 0; y < 33; y++)
        for (int x = 0; x < 40; x++) {
            bool sure;
            double want = naive_local(&im, x, y, &sure);
            float got = tone_pixel(&t, (size_t)(y * 40 + x)).g;
            told += sure;
            EXPECT(!sure || fabs(got - fmin(want, 1)) < 1e-3, "%d,%d: %g, not %g", x, y,
                   (double)got, want);
        }
    EXPECT(told > 1000, "%d pixels are told for sure", told);
    tone_clear(&t);
    image_clear(&im);
}

/* ---- exposure by the picture ---- */

static float gain_of(const char *text, const Image *im)
{
    static Arena arena;
    Display d = { .exposure = 1 };

    d.meter = kind_from_text(meters, "meter", text, &d.meter_opts, &arena);
    REQUIRE(d.meter, "%s", text);
    return display_gain(&d, im);
}

static void metering(void)
{
    Image im = new_image(100, 3);
    Rng r = rng_seed(4);

    EXPECT(gain_of("average", &im) == 2 && gain_of("percentile", &im) == 2, "of black: the stops");
    for (uint32_t i = 0; i < 100; i++)          /* 1/8 and 32: 2 on the average of logarithms */
        im.pixels[i] = rgb_all(i % 2 ? 0.125f : 32);
    im.pixels[101] = rgb(NAN, 1, 1);
    im.pixels[102] = rgb(INFINITY, 1, 1);
    EXPECT(fabsf(gain_of("average", &im) - 0.18f) < 1e-6f, "%g", (double)gain_of("average", &im));
    EXPECT(fabsf(gain_of("average:key=1", &im) - 1) < 1e-6f, "key");
    for (uint32_t i = 0; i < 300; i++)          /* 1 .. 200 in any order, and black */
        im.pixels[i] = rgb_all(i < 200 ? (float)(1 + i) : 0);
    for (uint32_t i = 200; i-- > 1; ) {
        uint32_t k = rng_below(&r, i + 1);
        Rgb c = im.pixels[i];
        im.pixels[i] = im.pixels[k];
        im.pixels[k] = c;
    }
    for (int p = 0; p <= 100; p += 10) {
        char text[60];
        float want = (float)(2.0 / (1 + 199 * p / 100));
        sprintf(text, "percentile:percent=%d,value=1", p);
        EXPECT(fabsf(gain_of(text, &im) - want) < 1e-5f * want, "%d %%: %g, not %g", p,
               (double)gain_of(text, &im), (double)want);
    }
    image_clear(&im);
}

/* ---- dithering ---- */

/* The mean of many bytes is the curve's value, which one byte cannot be; none is further from it
 * than one step; what is a byte's own value stays that. */
static void dithering(void)
{
    static unsigned char b[3 * 64 * 64];
    Image im = new_image(64, 64);
    Display d = { .dither = true };
    Rng r = rng_seed(5);

    for (int k = 0; k < 200; k++) {
        float x = rng_unit(&r), e = srgb_encode(x) * 255.0f;
        double sum = 0;
        for (uint32_t i = 0; i < 64 * 64; i++)
            im.pixels[i] = rgb_all(x);
        picture_bytes(&im, &d, b);
        for (uint32_t i = 0; i < 3 * 64 * 64; i++) {
            sum += b[i];
            EXPECT(fabsf((float)b[i] - e) < 1.0f, "%d for %g", b[i], (double)e);
        }
        EXPECT(fabs(sum / (3 * 64 * 64) - e) < 0.004, "the mean of %g is %g", (double)e,
               sum / (3 * 64 * 64));
    }
    for (int v = 0; v < 256; v += 255) {
        im.pixels[0] = im.pixels[63] = rgb_all((float)v);
        picture_bytes(&im, &d, b);
        EXPECT(b[0] == v && b[3 * 63] == v, "black or white becomes %d", b[0]);
    }
    image_clear(&im);
}

const TestCase test_tonemap[] = {
    { "formulas", formulas, false },
    { "curves", curves, false },
    { "dodging", dodging, false },
    { "metering", metering, false },
    { "dithering", dithering, false },
    { NULL, NULL, false }
};
