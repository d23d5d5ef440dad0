/* test_motion.c -- maps that change with time: what they are at their ends and half way, that the
 * inverse is one, that bounds hold at every time and are no larger than need be; and pictures of
 * what moves against what is known of them. */
#include "base/motion.h"
#include "base/random.h"
#include "render/render.h"
#include "sampling/warp.h"
#include "test/mesh_help.h"
#include "test/scene_help.h"

#include <stdio.h>
#include <string.h>

/* ---- maps ---- */

static float between(Rng *rng, float lo, float hi) { return lo + (hi - lo) * rng_unit(rng); }

static V3 direction(Rng *rng)
{
    V2 u;
    u.x = rng_unit(rng);
    u.y = rng_unit(rng);
    return v_unit(warp_sphere(u));
}

static Motion motion_of(Transform start, Transform end)
{
    Motion m;
    REQUIRE(motion_init(&m, &start, &end), "something is between");
    return m;
}

static Affine there_at(const Motion *m, float t)
{
    Affine there, back;
    motion_at(m, t, &there, &back);
    return there;
}

static double most_apart(const Affine *a, const Affine *b)
{
    double most = 0;
    for (int k = 0; k < 12; k++)
        most = d_max(most, fabs((double)a->m[k / 4][k % 4] - b->m[k / 4][k % 4]));
    return most;
}

static Transform then(Transform a, Transform b) { return xf_then(&a, &b); }

/* Half a turn by 100 degrees is one by 50 about the same axis; by 180, too, one way or the other;
 * beyond, the shorter way is backwards. Half way from 1 to 3 is 2. */
static void halves(void)
{
    static const struct { double whole, half; } turn[] = {
        { 100, 50 }, { 1e-5, 5e-6 }, { 179, 89.5 }, { 180, 90 }, { 200, -80 }, { 359, -0.5 },
        { -90, -45 }
    };
    static const double axis[4][3] = { { 1, 2, 3 }, { 1, 0, 0 }, { 0, -1, 0 }, { -3, 1, 0.5 } };
    Motion m;
    Affine is, want, other;
    Transform half;

    for (size_t i = 0; i < 4 * sizeof turn / sizeof *turn; i++) {
        const double *a = axis[i % 4];
        Transform base = then(xf_rotate(33, 2, -1, 1), xf_scale(2, 1, 0.5));
        m = motion_of(base, then(xf_rotate(turn[i / 4].whole, a[0], a[1], a[2]), base));
        half = then(xf_rotate(turn[i / 4].half, a[0], a[1], a[2]), base);
        want = xf_affine(&half);
        half = then(xf_rotate(-turn[i / 4].half, a[0], a[1], a[2]), base);
        other = xf_affine(&half);
        is = there_at(&m, 0.5f);
        EXPECT(most_apart(&is, &want) < 1e-6 ||
                   (turn[i / 4].whole == 180 && most_apart(&is, &other) < 1e-6),
               "half a turn by %g: %g off", turn[i / 4].whole, most_apart(&is, &want));
    }
    m = motion_of(then(xf_translate(1, 2, 3), xf_scale(1, -1, 1)),
                  then(xf_translate(3, 0, 3), xf_scale(3, -3, 3)));
    half = then(xf_translate(2, 1, 3), xf_scale(2, -2, 2));
    want = xf_affine(&half);
    is = there_at(&m, 0.5f);
    EXPECT(most_apart(&is, &want) < 1e-6, "half way from 1 to 3, mirrored");
}

static Transform random_map(Rng *rng)
{
    V3 a = direction(rng), b = direction(rng);
    Transform t = xf_scale(md_exp(between(rng, -3, 3)), md_exp(between(rng, -3, 3)),
                           md_exp(between(rng, -3, 3)));

    t = then(xf_rotate(360 * rng_unit(rng), a.x, a.y, a.z), t);
    t = then(t, xf_rotate(360 * rng_unit(rng), b.x, b.y, b.z));
    return then(xf_translate(between(rng, -9, 9), between(rng, -9, 9), 1), t);
}

static Motion random_motion(Rng *rng, int i)
{
    Transform a = random_map(rng), b = random_map(rng);
    if (i % 3 == 0)
        b = then(xf_translate(between(rng, -9, 9), 0.5, between(rng, -9, 9)), a);
    if (i % 5 == 0) {
        a = then(a, xf_scale(1, 1, -1));
        b = then(b, xf_scale(1, 1, -1));
    }
    return motion_of(a, b);
}

/* At its ends it is what was asked for; the inverse undoes it at all times, and it stays a map that
 * turns nothing inside out. */
static void ends(void)
{
    Rng rng = rng_seed(5);

    for (int i = 0; i < 300; i++) {
        Transform a = random_map(&rng), b = random_map(&rng);
        Motion m = motion_of(a, b);
        Affine first = there_at(&m, 0), last = there_at(&m, 1), wa = xf_affine(&a);
        Affine wb = xf_affine(&b);
        EXPECT(most_apart(&first, &wa) < 4e-6 && most_apart(&last, &wb) < 4e-6,
               "motion %d: the ends are %g and %g off", i, most_apart(&first, &wa),
               most_apart(&last, &wb));
        m = random_motion(&rng, i);
        for (int k = 0; k <= 8; k++) {
            V3 p = v_scale(direction(&rng), 3), q;
            Affine there, back;
            motion_at(&m, (float)k / 8, &there, &back);
            q = affine_point(&back, affine_point(&there, p));
            EXPECT(v_near(p, q, 2e-3f), "motion %d: there and back is %g %g %g from %g %g %g", i,
                   (double)q.x, (double)q.y, (double)q.z, (double)p.x, (double)p.y, (double)p.z);
        }
    }
}

static void refused(void)
{
    Transform a = xf_identity(), b = xf_scale(-1, 1, 1);
    Motion m;
    EXPECT(!motion_init(&m, &a, &b) && !motion_init(&m, &b, &a), "turned inside out");
}

/* Points of the box are in the bounds at every time; and the bounds are not larger than what many
 * points at many times span by more than a hundredth of the way round. */
static void bounds(void)
{
    Rng rng = rng_seed(6);
    Box box = { { -1, -2, 0.5f }, { 2, -1, 1 } };
    double widest = 0;

    for (int i = 0; i < 400; i++) {
        Motion m = random_motion(&rng, i);
        Box b = motion_box(&m, box), seen = box_empty();
        double size = v_max3(v_sub(b.hi, b.lo)), way;
        for (int k = 0; k < 4000; k++) {
            Affine there = there_at(&m, k < 8 ? 0.0f : k < 16 ? 1.0f : rng_unit(&rng));
            V3 p = v3(k & 1 ? box.hi.x : box.lo.x, k & 2 ? box.hi.y : box.lo.y,
                      k & 4 ? box.hi.z : box.lo.z);
            p = affine_point(&there, p);
            seen = box_point(seen, p);
        }
        EXPECT(box_holds(b, seen), "motion %d leaves its bounds", i);
        way = d_max(v_max3(v_sub(b.hi, seen.hi)), v_max3(v_sub(seen.lo, b.lo)));
        widest = d_max(widest, way / size);
    }
    printf("bounds are up to %g of their size too large\n", widest);
    EXPECT(widest < 0.01, "bounds are %g of their size too large", widest);
}

/* ---- pictures ---- */

static Film film_of(const char *text, const char *integrator, uint32_t spp, uint64_t seed)
{
    SceneFile f = scene_of(text, 0);
    RenderSettings s;
    RenderRequest q;
    RenderReport report;
    Film film = { .w = 0 };

    memset(&q, 0, sizeof q);
    q.integrator = integrator;
    q.sampler = "random";
    q.spp = spp;
    q.seed = seed;
    q.seed_given = true;
    q.threads = 1;
    q.max_pixels = 1 << 20;
    REQUIRE(settings_resolve(&s, &q, &f) && scene_build(f.scene, s.accel, &s.accel_opts, 1) &&
                render(f.scene, &s, &film, &report), "render");
    scenefile_clear(&f);
    return film;
}

static double mean_of(const Film *f, uint32_t x, uint32_t y)
{
    size_t k = film_pixel(f, x, y);
    return exact_value(&f->sums[3 * k]) / f->counts[k];
}

/* Share of the time at which a disc about (at, 0) with at from -w to w covers (x, y). */
static double covered(double x, double y, double radius, double w)
{
    double half = radius * radius - y * y, lo, hi;
    if (half <= 0)
        return 0;
    half = sqrt(half);
    lo = d_max(x - half, -w);
    hi = d_min(x + half, w);
    return hi > lo ? (hi - lo) / (2 * w) : 0;
}

/* The mean of that over a pixel, by the middle rule. */
static double profile(double x0, double y0, double side, double radius, double w)
{
    enum { N = 40 };
    double sum = 0;
    for (int i = 0; i < N * N; i++)
        sum += covered(x0 + (i % N + 0.5) / N * side, y0 + (i / N + 0.5) / N * side, radius, w);
    return sum / (N * N);
}

/* A dark disc slides before a bright sky: the picture is the disc blurred by a box, within four
 * standard errors of a share of n in each pixel, and in the sum of squares over all. */
static void expect_blur(const char *text, double w, const char *what)
{
    enum { SIDE = 20, SPP = 400 };
    Film f = film_of(text, "path:maxdepth=1", SPP, 0);
    double chi2 = 0, n = 0;

    for (uint32_t y = 0; y < SIDE; y++)
        for (uint32_t x = 0; x < SIDE; x++) {
            double p = 1 - profile(-2 + 0.2 * x, 1.8 - 0.2 * y, 0.2, 0.7, w);
            double is = mean_of(&f, x, y), sigma = sqrt(p * (1 - p) / SPP);
            EXPECT(fabs(is - p) <= 5 * sigma + 2e-3, "%s, pixel %d %d is %g, not %g", what, (int)x,
                   (int)y, is, p);
            if (p > 0.05 && p < 0.95) {
                chi2 += (is - p) * (is - p) / (sigma * sigma);
                n++;
            }
        }
    printf("%s: chi2 / n %g of %g\n", what, chi2 / n, n);
    EXPECT(n > 100 && fabs(chi2 / n - 1) < 5 * sqrt(2 / n), "%s: chi2 / n is %g", what, chi2 / n);
    film_clear(&f);
}

#define FILM20 "Film \"rgb\" \"integer xresolution\" 20 \"integer yresolution\" 20\n" \
    "PixelFilter \"box\"\n"
#define ORTHO "Camera \"orthographic\" \"float screenwindow\" [-2 2 -2 2]\n"
#define SKY "LightSource \"infinite\" \"rgb L\" [1 1 1]\n" \
    "Material \"diffuse\" \"rgb reflectance\" [0 0 0]\n"
#define DISC "Shape \"disk\" \"float radius\" 0.7 \"float height\" 3\n"

/* By a shape that slides; by one that slides and is turned within its plane, which a disc does not
 * show; by an object; by the camera; and by a shutter that is open in the middle third only. */
static void blur(void)
{
    messages_nowhere();
    expect_blur(FILM20 ORTHO "WorldBegin " SKY "ActiveTransform StartTime Translate -1 0 0 "
                "ActiveTransform EndTime Translate 1 0 0 " DISC, 1, "shape");
    expect_blur(FILM20 ORTHO "WorldBegin " SKY "ActiveTransform StartTime Translate -1 0 0 "
                "ActiveTransform EndTime Translate 1 0 0 Rotate 150 0 0 1 " DISC, 1, "turned");
    expect_blur(FILM20 ORTHO "WorldBegin " SKY "ObjectBegin \"o\" " DISC "ObjectEnd "
                "ActiveTransform EndTime Translate 2 0 0 ActiveTransform All Translate -1 0 0 "
                "ObjectInstance \"o\"", 1, "object");
    expect_blur(FILM20 "ActiveTransform StartTime Translate -1 0 0 ActiveTransform EndTime "
                "Translate 1 0 0 ActiveTransform All " ORTHO "WorldBegin " SKY DISC, 1, "camera");
    expect_blur(FILM20 "TransformTimes 0 3 " ORTHO " \"float shutteropen\" 1 "
                "\"float shutterclose\" 2 WorldBegin " SKY "ActiveTransform StartTime "
                "Translate -3 0 0 ActiveTransform EndTime Translate 3 0 0 " DISC, 1, "shutter");
}

/* Lamps above: one that shines down, one that shines up at a ceiling. */
static const char DOWN[] = "[9 9 9] Translate 0 3 0 Rotate 90 1 0 0 Shape \"disk\" "
    "\"float radius\" 0.4 ";
static const char UP[] = "[90 90 90] Translate 0 2 0 Rotate -90 1 0 0 Shape \"disk\" "
    "\"float radius\" 0.4 AttributeEnd AttributeBegin Translate 0 3 0 Rotate 90 1 0 0 "
    "Shape \"disk\" \"float radius\" 3 ";

/* A card and a ball above a floor, below a lamp. */
static Film scene_film(const char *lamp, const char *place, const char *integrator, uint32_t spp,
                       uint64_t seed)
{
    static const char *const scene =
        "Film \"rgb\" \"integer xresolution\" 8 \"integer yresolution\" 8 PixelFilter \"box\"\n"
        "LookAt 0 3 -4 0 0 0 0 1 0 Camera \"perspective\" \"float fov\" 40\nWorldBegin\n"
        "AttributeBegin AreaLightSource \"diffuse\" \"rgb L\" %s AttributeEnd\n"
        "AttributeBegin Rotate -90 1 0 0 Shape \"disk\" \"float radius\" 3 AttributeEnd\n"
        "%s Scale 0.5 0.5 0.5 Shape \"trianglemesh\" \"point3 P\" [-1 0 -1 1 0 -1 1 0 1 -1 0 1] "
        "\"integer indices\" [0 1 2 0 2 3] Shape \"sphere\" \"float radius\" 0.6";
    char text[2000];
    snprintf(text, sizeof text, scene, lamp, place);
    return film_of(text, integrator, spp, seed);
}

/* Shadows move with what throws them, and reflected light meets it where it is: each time stands
 * for itself. So the mean of pictures of the scene as it is at 64 times is the picture of what
 * moves, to the noise of both and to the 1/128 by which 64 times may miss when an edge passes. */
static void expect_mean_of_stills(const char *lamp, const char *integrator)
{
    enum { TIMES = 64, SPP = 32 };
    double still[64] = { 0 }, mean = 0, squares = 0, noise;
    Film f = scene_film(lamp, "ActiveTransform StartTime Translate -1.2 0.4 0 ActiveTransform "
                        "EndTime Translate 1.2 1 0 Rotate 80 0 1 0 ActiveTransform All",
                        integrator, 2048, TIMES);

    noise = f_sqr((float)film_error(&f));
    for (int t = 0; t < TIMES; t++) {
        char place[80];
        double at = (t + 0.5) / TIMES;
        Film one;
        snprintf(place, sizeof place, "Translate %.9f %.9f 0 Rotate %.9f 0 1 0", -1.2 + 2.4 * at,
                 0.4 + 0.6 * at, 80 * at);
        one = scene_film(lamp, place, integrator, SPP, (uint64_t)t);
        noise += film_error(&one) * film_error(&one) / TIMES / TIMES;
        for (uint32_t k = 0; k < 64; k++)
            still[k] += mean_of(&one, k % 8, k / 8) / TIMES;
        film_clear(&one);
    }
    for (uint32_t k = 0; k < 64; k++) {
        double d = mean_of(&f, k % 8, k / 8) - still[k];
        mean += still[k] / 64;
        squares += d * d / 64;
    }
    printf("%s: rms %g of the mean, noise %g\n", integrator, sqrt(squares) / mean, sqrt(noise));
    EXPECT(sqrt(squares) < (1.5 * sqrt(noise) + 1.0 / 128) * mean,
           "%s: the picture differs by %g of its mean, of which noise is %g", integrator,
           sqrt(squares) / mean, sqrt(noise));
    film_clear(&f);
}

static void together(void)
{
    expect_mean_of_stills(DOWN, "path:maxdepth=3");
    expect_mean_of_stills(DOWN, "ao:distance=1");
    expect_mean_of_stills(UP, "sppm:maxdepth=3,radius=0.2,photons=200");
}

const TestCase test_motion[] = {
    { "halves", halves, false }, { "ends", ends, false }, { "refused", refused, false },
    { "bounds", bounds, false }, { "blur", blur, false }, { "together", together, false },
    { NULL, NULL, false }
};
