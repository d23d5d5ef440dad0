/* lamps.c -- where on a light: what fixed lights in place of a sky look like, and what sampling
 * lamps by solid angle gains.
 *
 * Banding   [Cline07 4.4.2]: a sky as a fixed set of median-cut lights has no noise but hard edges,
 *           one for each light. sigma/mu; how much of it is the same for other seeds (the root of
 *           the mean of (a - r)(b - s), as in biased.c); and the correlation of the errors of
 *           pixels that are next to each other: 0 for noise, towards 1 for bands. banding.png: the
 *           reference, then each set; below it what is off, four times, grey for nothing.
 * Lamps     A small piece of floor under one lamp, a triangle or a ball, near or far, of points by
 *           area or of directions by solid angle. sigma/mu by pairs of seeds [Cline07 (4.14)], and
 *           the same at equal time. A whole ball is always taken by its cone: by area it is one
 *           with the least of caps cut off. */
#include "bench/bench.h"
#include "bench/report.h"

#include <stdio.h>
#include <string.h>

/* ---- banding ---- */

enum { W = 240, H = 160 };

static const char floor_text[] =
    "Scale -1 1 1\n"
    "LookAt 0 -6.4 2.6  0 0 0.62  0 0 1\n"
    "Camera \"perspective\" \"float fov\" 36\n"
    "Sampler \"zerotwo\"\n"
    "Integrator \"direct\" \"string strategy\" \"light\"\n"
    "WorldBegin\n"
    "LightSource \"infinite\" \"string filename\" \"probe.hdr\" \"float scale\" 0.6 %s\n"
    "Material \"diffuse\" \"rgb reflectance\" [ 0.5 0.5 0.5 ]\n"
    "Shape \"bilinearmesh\" \"point3 P\" [ -12 -12 0  12 -12 0  -12 12 0  12 12 0 ]\n"
    "Include \"parts/still.pbrt\"\n";

static bool floor_picture(const char *light, uint32_t spp, uint64_t seed, Image *im)
{
    char text[sizeof floor_text + 200];
    RenderReport unused;
    RenderRequest q;

    snprintf(text, sizeof text, floor_text, light);
    memset(&q, 0, sizeof q);
    q.w = W;
    q.h = H;
    q.spp = spp;
    q.seed = seed;
    q.threads = processors();
    return bench_text_picture("scenes/floor", text, &q, im, &unused);
}

static double off(const Image *a, const Image *r, size_t i)
{
    return (double)rgb_lum(a->pixels[i]) - (double)rgb_lum(r->pixels[i]);
}

typedef struct { double sigma, same, next; } Structure;

static Structure structure(const Image *a, const Image *b, const Image *r, const Image *s)
{
    double squares = 0, same = 0, next = 0, mu = 0;
    size_t n = (size_t)W * H;
    Structure of;

    for (size_t i = 0; i < n; i++) {
        double d = off(a, r, i);
        squares += d * d;
        same += d * off(b, s, i);
        next += (i + 1) % W ? d * off(a, r, i + 1) : 0;
        mu += (double)rgb_lum(r->pixels[i]);
    }
    of.sigma = sqrt(squares * (double)n) / mu;
    of.same = sqrt((same > 0 ? same : 0) * (double)n) / mu;
    of.next = squares > 0 ? next / squares : 0;
    return of;
}

/* Into column k of the figure: the picture, and below it what is off. */
static void paste(Image *all, int k, const Image *im, const Image *ref)
{
    for (uint32_t y = 0; y < H; y++)
        for (uint32_t x = 0; x < W; x++) {
            Rgb c = *image_at(im, x, y), d = rgb_sub(c, *image_at(ref, x, y));
            *image_at(all, (uint32_t)k * (W + 4) + x, y) = c;
            *image_at(all, (uint32_t)k * (W + 4) + x, H + 4 + y) =
                rgb_add(rgb_all(0.2f), rgb_scale(d, 4));
        }
}

static void banding(void)
{
    static const struct { const char *name, *light; } sets[] = {
        { "16 lights, fixed", "\"string sampling\" \"mediancut\" \"integer lights\" 16 "
                              "\"bool jitter\" false" },
        { "64 lights, fixed", "\"string sampling\" \"mediancut\" \"integer lights\" 64 "
                              "\"bool jitter\" false" },
        { "64 lights, jittered", "\"string sampling\" \"mediancut\" \"integer lights\" 64" },
        { "1024 lights, fixed", "\"string sampling\" \"mediancut\" \"integer lights\" 1024 "
                                "\"bool jitter\" false" },
        { "inverted sums", "\"string sampling\" \"cdf\"" },
        { "alias method", "\"string sampling\" \"alias\"" },
    };
    enum { SETS = sizeof sets / sizeof sets[0], SPP = 64 };
    static const Display display = { 0 };
    Image ref[2] = { { 0 }, { 0 } }, all = { 0 };

    if (!floor_picture("", 4096, 100, &ref[0]) || !floor_picture("", 4096, 101, &ref[1]) ||
        !image_init(&all, (SETS + 1) * (W + 4), 2 * H + 4))
        return;
    paste(&all, 0, &ref[0], &ref[1]);
    printf("# a sky by median cut [Cline07 4.4.2], %d samples a pixel\n", SPP);
    for (int k = 0; k < SETS; k++) {
        Image a = { 0 }, b = { 0 };
        Structure s;
        if (!floor_picture(sets[k].light, SPP, 1, &a) || !floor_picture(sets[k].light, SPP, 2, &b))
            return;
        s = structure(&a, &b, &ref[0], &ref[1]);
        printf("banding\t%-20s\tsigma/mu %.4f\tthe same for other seeds %.4f\t"
               "correlation of neighbours %.3f\n", sets[k].name, s.sigma, s.same, s.next);
        fflush(stdout);
        paste(&all, k + 1, &a, &ref[0]);
        image_clear(&a);
        image_clear(&b);
    }
    if (image_write(&all, "banding.png", &display)) {
        printf("# the pictures, and what is off: banding.png\n");
        report_picture("banding.png");
    }
    image_clear(&all);
    image_clear(&ref[0]);
    image_clear(&ref[1]);
}

/* ---- by area, by solid angle ---- */

static const char lamp_text[] =
    "LookAt 0 -1 0.2  0 0 0  0 0 1\n"
    "Camera \"perspective\" \"float fov\" 5\n"
    "Sampler \"random\"\n"
    "Integrator \"direct\" \"string strategy\" \"light\" \"integer maxdepth\" 1\n"
    "WorldBegin\n"
    "Material \"diffuse\"\n"
    "Shape \"bilinearmesh\" \"point3 P\" [ -9 -9 0  9 -9 0  -9 9 0  9 9 0 ]\n"
    "Material \"diffuse\" \"rgb reflectance\" [ 0 0 0 ]\n"
    "AttributeBegin\n"
    "AreaLightSource \"diffuse\" \"rgb L\" [ 1 1 1 ] \"bool twosided\" true %s\n"
    "%s\n"
    "AttributeEnd\n";

typedef struct { const char *name, *lamp[2]; } Lamp;

static bool lamp_noise(const char *option, const char *shape, double *sigma, double *seconds)
{
    enum { SIDE = 32, SPP = 64, PAIRS = 3 };
    double squares = 0, sum = 0;
    char text[sizeof lamp_text + 300];

    snprintf(text, sizeof text, lamp_text, option, shape);
    *seconds = 1e30;
    for (uint64_t k = 0; k < PAIRS; k++) {
        Image im[2] = { { 0 }, { 0 } };
        for (uint64_t j = 0; j < 2; j++) {
            RenderRequest q;
            RenderReport r;
            memset(&q, 0, sizeof q);
            q.w = q.h = SIDE;
            q.spp = SPP;
            q.threads = 1;
            q.seed = 2 * k + j;
            if (!bench_text_picture("lamp", text, &q, &im[j], &r))
                return false;
            *seconds = r.cpu_seconds < *seconds ? r.cpu_seconds : *seconds;
        }
        for (size_t i = 0; i < (size_t)SIDE * SIDE; i++) {
            double x = (double)rgb_lum(im[0].pixels[i]), y = (double)rgb_lum(im[1].pixels[i]);
            squares += 0.5 * (x - y) * (x - y);
            sum += 0.5 * (x + y);
        }
        image_clear(&im[0]);
        image_clear(&im[1]);
    }
    *sigma = sqrt(squares * PAIRS * SIDE * SIDE) / sum;
    return true;
}

static void solid_angles(void)
{
    static const char by_area[] = "\"string sampling\" \"area\"";
    static const char by_angle[] = "\"string sampling\" \"solidangle\"";
    static const Lamp lamps[] = {
#define TRIANGLE(p) "Shape \"trianglemesh\" \"point3 P\" [ " p " ] \"integer indices\" [ 0 1 2 ]"
#define BALL(at, more) "Translate " at " Shape \"sphere\" \"float radius\" 0.5 " more
#define CAPPED "\"float zmin\" -0.4999 \"float zmax\" 0.4999"
        { "triangle, 0.15 away", { TRIANGLE("-0.5 -0.4 0.15 0.5 -0.4 0.15 0 0.6 0.15"), NULL } },
        { "triangle, 0.5 away", { TRIANGLE("-0.5 -0.4 0.5 0.5 -0.4 0.5 0 0.6 0.5"), NULL } },
        { "triangle, 5 away", { TRIANGLE("-0.5 -0.4 5 0.5 -0.4 5 0 0.6 5"), NULL } },
        { "triangle on edge, 0.3 away", { TRIANGLE("-0.5 0.3 0.05 0.5 0.3 0.05 0 0.3 1"), NULL } },
        { "ball, 0.1 away", { BALL("0 0.2 0.6", CAPPED), BALL("0 0.2 0.6", "") } },
        { "ball, 0.5 away", { BALL("0 0.2 1", CAPPED), BALL("0 0.2 1", "") } },
        { "ball, 5 away", { BALL("0 0.2 5.5", CAPPED), BALL("0 0.2 5.5", "") } },
    };

    printf("# lamps of size 1 over a floor: points by area, directions by solid angle\n");
    for (size_t k = 0; k < sizeof lamps / sizeof lamps[0]; k++) {
        const char *angle = lamps[k].lamp[1] ? lamps[k].lamp[1] : lamps[k].lamp[0];
        double s[2], t[2];
        if (!lamp_noise(by_area, lamps[k].lamp[0], &s[0], &t[0]) ||
            !lamp_noise(by_angle, angle, &s[1], &t[1]))
            return;
        printf("lamps\t%-28s\tsigma/mu by area %.4f, by solid angle %.4f: variance / %.2f\t"
               "CPU s %.3f, %.3f: at equal time / %.2f\n", lamps[k].name, s[0], s[1],
               s[0] * s[0] / (s[1] * s[1]), t[0], t[1],
               s[0] * s[0] * t[0] / (s[1] * s[1] * t[1]));
        fflush(stdout);
    }
}

void bench_lamps(void)
{
    banding();
    solid_angles();
}
