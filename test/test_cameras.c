/* test_cameras.c -- rays of the perspective camera.
 *
 * The ray through the pixel to which a point projects must meet the point. The projection is worked
 * out here in double from the definition: camera looks along +z, x to the right, y up, the shorter
 * side of the screen spans [-1, 1] times tan(fov/2) at distance 1, rows run downwards. With a lens,
 * all rays of a pixel meet in the plane of focus, and start evenly spread over the lens. */
#include "base/random.h"
#include "test/chi2.h"
#include "test/pictures.h"

#include <stdio.h>
#include <string.h>

typedef struct {
    V3 eye, at, up;
    double fov;
    uint32_t w, h;
    double aspect;
    const char *options;
} Shot;

static const Shot shots[] = {
    { { 0, 0, 0 }, { 0, 0, 1 }, { 0, 1, 0 }, 90, 100, 100, 1, "" },
    { { 1, -2, 3 }, { 4, 1, 2 }, { 0, 0, 1 }, 40, 160, 90, 160.0 / 90, "" },
    { { 1, -2, 3 }, { -3, 0, 4 }, { 0, 0, 1 }, 70, 90, 160, 90.0 / 160, "" },
    { { 0, 5, 0 }, { 0, 0, 0 }, { 1, 0, 1 }, 120, 64, 64, 2, "frameaspectratio=2" },
    { { 1000, 200, -300 }, { 990, 205, -300 }, { 0, 0, 1 }, 20, 640, 480, 4.0 / 3, "" },
};
enum { SHOTS = sizeof shots / sizeof *shots };

static const Camera *camera_of(Lab *l, const Shot *s, const char *more)
{
    const CameraKind *k = kind_find(cameras, "perspective");
    Transform view;
    char text[200];
    Making m;
    Opts o;

    memset(&m, 0, sizeof m);
    m.scene = l->scene;
    REQUIRE(xf_look_at(&view, s->eye, s->at, s->up), "view");
    m.to_world = xf_inverse(&view);
    opts_default(&o, k->info.options);
    snprintf(text, sizeof text, "%s%s%s", s->options, s->options[0] && more[0] ? "," : "", more);
    REQUIRE(opts_parse(&o, "perspective", text, &l->arena), "%s", text);
    opt_set_number(&o, "fov", s->fov);
    l->scene->camera = k->make(&m, &o);
    REQUIRE(l->scene->camera, "camera");
    l->scene->camera->kind = k;
    k->film(l->scene->camera, s->w, s->h);
    return l->scene->camera;
}

typedef struct { double x, y, z; } D3;
static D3 d3(V3 v) { return (D3){ v.x, v.y, v.z }; }
static D3 d3_sub(D3 a, D3 b) { return (D3){ a.x - b.x, a.y - b.y, a.z - b.z }; }
static double d3_dot(D3 a, D3 b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
static D3 d3_cross(D3 a, D3 b)
{
    return (D3){ a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x };
}
static D3 d3_unit(D3 a)
{
    double l = sqrt(d3_dot(a, a));
    return (D3){ a.x / l, a.y / l, a.z / l };
}

/* The camera's axes: left-handed, so x = up x forward is to the right. */
static void axes(const Shot *s, D3 *x, D3 *y, D3 *z)
{
    *z = d3_unit(d3_sub(d3(s->at), d3(s->eye)));
    *x = d3_unit(d3_cross(d3(s->up), *z));
    *y = d3_cross(*z, *x);
}

/* World point at distance z along the axis that pixel (px, py) shows. */
static D3 shown(const Shot *s, double px, double py, double distance)
{
    double t = md_sin(s->fov * PI / 360) / md_cos(s->fov * PI / 360);
    double wide = s->aspect > 1 ? s->aspect : 1, tall = s->aspect > 1 ? 1 : 1 / s->aspect;
    double u = (2 * px / s->w - 1) * wide * t * distance;
    double v = (1 - 2 * py / s->h) * tall * t * distance;
    D3 x, y, z, e = d3(s->eye);

    axes(s, &x, &y, &z);
    return (D3){ e.x + u * x.x + v * y.x + distance * z.x, e.y + u * x.y + v * y.y + distance * z.y,
                 e.z + u * x.z + v * y.z + distance * z.z };
}

/* Distance of a point from the line of a ray, whose points are at least before it. */
static double off_ray(const Ray *r, D3 p)
{
    D3 to = d3_sub(p, d3(r->o)), d = d3(r->d), c = d3_cross(to, d);
    return d3_dot(to, d) > 0 ? sqrt(d3_dot(c, c)) : INFINITY;
}

/* Corners, centre and a few places between. */
static void pixels(void)
{
    static const double at[][2] = { { 0, 0 },     { 1, 0 },      { 0, 1 },    { 1, 1 },
                                    { 0.5, 0.5 }, { 0.25, 0.8 }, { 0.9, 0.3 } };
    for (int k = 0; k < SHOTS; k++) {
        const Shot *s = &shots[k];
        const Camera *c;
        Lab l;

        lab_init(&l);
        c = camera_of(&l, s, "");
        for (size_t i = 0; i < sizeof at / sizeof *at; i++) {
            V2 pixel = { (float)(at[i][0] * s->w), (float)(at[i][1] * s->h) };
            Ray r = c->kind->ray(c, pixel, (V2){ 0.3f, 0.7f }, 0.0f);
            D3 p = shown(s, (double)pixel.x, (double)pixel.y, 4);
            double size = 1e-6 * (fabs((double)s->eye.x) + 10);

            EXPECT(off_ray(&r, p) < size, "shot %d: the ray of pixel %g %g passes by %.3g", k,
                   (double)pixel.x, (double)pixel.y, off_ray(&r, p));
            EXPECT(fabsf(v_len2(r.d) - 1) < ROUNDINGS(16) && r.tmax == INFINITY, "ray of length %g",
                   (double)v_len2(r.d));
        }
        lab_clear(&l);
    }
}

/* Known by heart: 90 degrees from the origin along z, the four corners. */
static void corners(void)
{
    static const double x[4] = { -1, 1, -1, 1 }, y[4] = { 1, 1, -1, -1 };
    const Camera *c;
    Lab l;

    lab_init(&l);
    c = camera_of(&l, &shots[0], "");
    for (int k = 0; k < 4; k++) {
        Ray r = c->kind->ray(c, (V2){ k % 2 ? 100 : 0, k / 2 ? 100 : 0 }, (V2){ 0, 0 }, 0.0f);
        EXPECT(fabs(r.d.x * sqrt(3.0) - x[k]) < 1e-6 && fabs(r.d.y * sqrt(3.0) - y[k]) < 1e-6 &&
                   fabs(r.d.z * sqrt(3.0) - 1) < 1e-6 && v_len2(r.o) == 0,
               "corner %d: along %g %g %g", k, (double)r.d.x, (double)r.d.y, (double)r.d.z);
    }
    lab_clear(&l);
}

/* "screenwindow" replaces the span of the screen. */
static void window(void)
{
    static const double numbers[4] = { -0.5, 1.5, -2, 1 };
    const CameraKind *k = kind_find(cameras, "perspective");
    Param p = { "screenwindow", "float", PARAM_FLOAT, { NULL, 0, 0 }, 4, numbers, NULL, false };
    Params ps = { &p, 1 };
    Camera *c;
    Making m;
    Opts o;
    Lab l;

    lab_init(&l);
    memset(&m, 0, sizeof m);
    m.scene = l.scene;
    m.to_world = xf_identity();
    opts_default(&o, k->info.options);
    REQUIRE(opts_params(&o, "perspective", &ps), "params");
    c = k->make(&m, &o);
    REQUIRE(c, "camera");
    k->film(c, 200, 100);
    for (int i = 0; i < 4; i++) {
        Ray r = k->ray(c, (V2){ i % 2 ? 200 : 0, i / 2 ? 100 : 0 }, (V2){ 0, 0 }, 0.0f);
        double x = numbers[i % 2], y = numbers[i / 2 ? 2 : 3];
        EXPECT(fabs((double)(r.d.x / r.d.z) - x) < 1e-6 && fabs((double)(r.d.y / r.d.z) - y) < 1e-6,
               "corner %d: %g %g, it is %g %g", i, (double)(r.d.x / r.d.z), (double)(r.d.y / r.d.z),
               x, y);
    }
    lab_clear(&l);
}

/* Rays of one pixel meet in the plane of focus; they start on the lens, evenly spread: squared
 * radius and angle are uniform. */
static void lens(void)
{
    enum { N = 20000, BINS = 32 };
    const double radius = 0.25, focus = 3;
    uint64_t by_radius[BINS] = { 0 }, by_angle[BINS] = { 0 };
    double expected[BINS];

    for (int k = 0; k < SHOTS; k++) {
        const Shot *s = &shots[k];
        const Camera *c;
        Rng rng = rng_seed(81);
        V2 pixel = { 0.3f * (float)s->w, 0.85f * (float)s->h };
        D3 x, y, z, p = shown(s, (double)pixel.x, (double)pixel.y, focus);
        double worst = 0, off_lens = 0, size = 2e-6 * (fabs((double)s->eye.x) + 10);
        Lab l;

        lab_init(&l);
        c = camera_of(&l, s, "lensradius=0.25,focaldistance=3");
        axes(s, &x, &y, &z);
        for (int i = 0; i < N; i++) {
            V2 u = { rng_unit(&rng), rng_unit(&rng) };
            Ray r = c->kind->ray(c, pixel, u, 0.0f);
            D3 o = d3_sub(d3(r.o), d3(s->eye));
            double a = d3_dot(o, x), b = d3_dot(o, y), r2 = (a * a + b * b) / (radius * radius);
            double d = off_ray(&r, p), phi = md_atan2(b, a) / (2 * PI) + 0.5;
            worst = d > worst ? d : worst;
            d = fabs(d3_dot(o, z));
            off_lens = d > off_lens ? d : off_lens;
            if (k == 0) {
                by_radius[r2 < 1 ? (int)(r2 * BINS) : BINS - 1]++;
                by_angle[phi < 1 ? (int)(phi * BINS) : 0]++;
            }
            EXPECT(r2 <= 1 + size, "shot %d: a ray starts outside the lens", k);
        }
        EXPECT(worst < size && off_lens < size,
               "shot %d: rays miss the focus by %.3g, the lens by %.3g", k, worst, off_lens);
        lab_clear(&l);
    }
    for (int i = 0; i < BINS; i++)
        expected[i] = (double)N / BINS;
    EXPECT(chi2_counts(expected, by_radius, BINS) >= CHI2_P_MIN &&
           chi2_counts(expected, by_angle, BINS) >= CHI2_P_MIN, "the lens is not evenly covered");
}

/* A transform that mirrors turns the picture round. */
static void mirrored(void)
{
    const CameraKind *k = kind_find(cameras, "perspective");
    Camera *c;
    Making m;
    Opts o;
    Ray r;
    Lab l;

    lab_init(&l);
    memset(&m, 0, sizeof m);
    m.scene = l.scene;
    m.to_world = xf_scale(-1, 1, 1);
    opts_default(&o, k->info.options);
    c = k->make(&m, &o);
    REQUIRE(c, "camera");
    k->film(c, 10, 10);
    r = k->ray(c, (V2){ 10, 5 }, (V2){ 0, 0 }, 0.0f);
    EXPECT(r.d.x < 0 && r.d.z > 0, "the right of a mirrored picture looks along %g %g %g",
           (double)r.d.x, (double)r.d.y, (double)r.d.z);
    lab_clear(&l);
}

const TestCase test_cameras[] = {
    { "corners", corners, false },
    { "pixels", pixels, false },
    { "window", window, false },
    { "lens", lens, false },
    { "mirrored", mirrored, false },
    { NULL, NULL, false }
};
