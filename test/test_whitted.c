/* test_whitted.c -- trees of mirror images, whose every sample is exact: point lamps on a matt
 * plane, lamps with a surface as points, sums of Fresnel's terms, what ends a tree and how large it
 * gets, and the ambient light against radiosity in closed rooms. */
#include "base/maths.h"
#include "integrators/ambient.h"
#include "integrators/vertex.h"
#include "scene/medium.h"
#include "test/pictures.h"
#include "test/scene_help.h"

#include <stdio.h>
#include <string.h>

/* One sample, and the rays that it took. */
static Rgb see(const Lab *l, Ray r, uint64_t seed, uint64_t *rays)
{
    const SamplerKind *kind = kind_find(samplers, "random");
    uint32_t spp = 1;
    Tracer t;
    Opts none;
    Rgb L;

    memset(&t, 0, sizeof t);
    t.scene = l->scene;
    opts_default(&none, kind->info.options);
    REQUIRE(sampler_init(&t.sampler, kind, &none, seed, &spp), "sampler");
    L = l->integrator->kind->radiance(l->integrator, &r, &t);
    EXPECT(rgb_finite(L), "not finite");
    if (rays)
        *rays = t.rays;
    return L;
}

static bool close_to(double a, double b, double tolerance)
{
    return fabs(a - b) <= tolerance * fabs(b) + 1e-9;
}

/* ---- lamps ---- */

static uint32_t floor_of(Lab *l, const char *options)
{
    return lab_quad(l, v3(-50, -50, 0), v3(100, 0, 0), v3(0, 100, 0),
                    lab_material(l, "diffuse", options));
}

/* I cos / d^2 rho / pi, to rounding, in each sample; nothing in the shadow of a ball, be it of
 * glass; the lamp itself cannot be seen. */
static void test_point_lamp(void)
{
    Lab l;

    lab_init(&l);
    floor_of(&l, "reflectance=0.5/0.25/0.8");
    lab_sphere(&l, v3(3, 0, 1.5f), 0.2f, lab_material(&l, "dielectric", ""), false);
    lab_light(&l, "point", "from=0/0/3,I=1/2/4", NULL);
    lab_light(&l, "point", "from=0/4/2,I=4", NULL);
    lab_build(&l);
    lab_open(&l, "whitted:ambient=none");
    for (int i = 0; i < 40; i++) {
        float x = -2.0f + 0.1f * (float)i;
        V3 at = { x, 0.3f, 0 };
        Ray r = ray_towards(v3(x + 2, -3, 2), at);
        double d2 = x * x + 0.09 + 9, e2 = x * x + 3.7 * 3.7 + 4;
        double a = 3 / (d2 * sqrt(d2)) / PI, b = 4 * 2 / (e2 * sqrt(e2)) / PI;
        Rgb first = see(&l, r, 1, NULL), other = see(&l, r, 2, NULL);
        EXPECT(close_to(first.r, 0.5 * (a + b), 1e-5) && close_to(first.g, 0.25 * (2 * a + b), 1e-5)
               && close_to(first.b, 0.8 * (4 * a + b), 1e-5), "at %g: %.9g, it is %.9g", x, first.r,
               0.5 * (a + b));
        EXPECT(!memcmp(&first, &other, sizeof first), "noise at %g", x);
    }
    /* the ball's shadow of the first lamp is about x = 6, 0: the second one is left */
    EXPECT(close_to(see(&l, ray_towards(v3(6, -1, 5), v3(6, 0, 0)), 1, NULL).r,
                    0.5 * 4 * 2 / (56 * sqrt(56)) / PI, 1e-5), "in the shadow of glass");
    lab_clear(&l);
}

/* Flat lamps shine forwards by the cosine, spheres all round; seen from afar they are right. What
 * stands at the centre's side of the lamp's own surface does not matter. */
static void test_lamps_as_points(void)
{
    V3 at = { 1, 2, 0 };
    Ray r = ray_towards(v3(0, -3, 2), at);
    double d2 = 1 + 4 + 16, c = 4 / sqrt(d2), square = 0.6 * 0.4 * 3 * c * c / d2 / PI;
    double ball = PI * 0.09 * 2 * c / d2 / PI;
    uint32_t black;
    Lab l;

    for (int which = 0; which < 4; which++) {
        double truth = which == 0 || which == 3 ? square : which == 1 ? ball : 0;
        Rgb L;
        lab_init(&l);
        floor_of(&l, "reflectance=1");
        black = lab_material(&l, "diffuse", "reflectance=0");
        if (which == 1)
            lab_shine(&l, lab_sphere(&l, v3(0, 0, 4), 0.3f, black, false), "L=2");
        else                                    /* the second looks up */
            lab_shine(&l, lab_quad(&l, v3(-0.3f, -0.2f, 4),
                                   which == 2 ? v3(0.6f, 0, 0) : v3(0, 0.4f, 0),
                                   which == 2 ? v3(0, 0.4f, 0) : v3(0.6f, 0, 0), black),
                      "L=3");
        if (which == 3)                         /* hides an edge of the lamp, not its middle */
            lab_quad(&l, v3(0.15f, -1, 3.99f), v3(1, 0, 0), v3(0, 2, 0), black);
        lab_build(&l);
        lab_open(&l, "whitted:ambient=none");
        L = see(&l, r, 1, NULL);
        EXPECT(close_to(L.g, truth, which == 1 ? 0.01 : 2e-4), "lamp %d: %.9g, it is %.9g", which,
               L.g, truth);
        lab_clear(&l);
    }
}

/* Lamps that are seen, directly and in a mirror; a lamp that shines with the power of its cosine;
 * the background. */
static void test_seen(void)
{
    Ray up = ray_towards(v3(0, 0, 1), v3(0.01f, 0.01f, 4)), down = ray_towards(v3(0, 0, 1),
                                                                              v3(0.01f, 0, 0));
    Rgb L;
    Lab l;

    lab_init(&l);
    lab_quad(&l, v3(-50, -50, 0), v3(100, 0, 0), v3(0, 100, 0),
             lab_material(&l, "mirror", "reflectance=0.5/0.25/0.125"));
    lab_shine(&l, lab_quad(&l, v3(-1, -1, 4), v3(0, 2, 0), v3(2, 0, 0),
                           lab_material(&l, "diffuse", "")), "L=1/2/4");
    lab_light(&l, "infinite", "L=7", NULL);
    lab_build(&l);
    lab_open(&l, "whitted:ambient=none");
    L = see(&l, up, 1, NULL);
    EXPECT(L.r == 1 && L.g == 2 && L.b == 4, "%g %g %g", L.r, L.g, L.b);
    L = see(&l, down, 1, NULL);
    EXPECT(L.r == 0.5f && L.g == 0.5f && L.b == 0.5f, "%g %g %g", L.r, L.g, L.b);
    L = see(&l, ray_towards(v3(0, 0, 5), v3(1, 0, 9)), 1, NULL);
    EXPECT(L.r == 7, "background %g", L.r);
    L = see(&l, ray_towards(v3(5, 0, 5), v3(5.1f, 0, 0)), 1, NULL);
    EXPECT(L.r == 3.5f, "background in the mirror %g", L.r);
    lab_open(&l, "whitted:maxdepth=0");
    L = see(&l, down, 1, NULL);
    EXPECT(rgb_black(L), "maxdepth=0");
    lab_clear(&l);
}

/* ---- trees ---- */

static Rgb two_halves(V3 w) { return w.z > 0 ? rgb(1, 0, 0) : rgb(0, 1, 0); }

/* A slab of glass under a red sky, over a green one: of each the series
 *   reflected F + (1-F)^2 F sum F^2k, transmitted (1-F)^2 sum F^2k,
 * as many terms as maxdepth has room for: 1, 3, 5 .. and 2, 4, 6 .. events. */
static void test_slab(void)
{
    Ray r = ray_towards(v3(-0.3f, 0.2f, 2), v3(0, 0, 1));
    double c = 1 / sqrt(1 + 0.09 + 0.04), s = sqrt(1 - c * c) / 1.5, t = sqrt(1 - s * s);
    double p = (c - 1.5 * t) / (c + 1.5 * t), q = (1.5 * c - t) / (1.5 * c + t);
    double F = 0.5 * (p * p + q * q);
    uint32_t glass;
    Lab l;

    lab_init(&l);
    glass = lab_material(&l, "dielectric", "eta=1.5");
    lab_quad(&l, v3(-500, -500, 1), v3(1000, 0, 0), v3(0, 1000, 0), glass);
    lab_quad(&l, v3(-500, -500, 0), v3(0, 1000, 0), v3(1000, 0, 0), glass);
    lab_sky(&l, 16, 8, two_halves, NULL);
    lab_build(&l);
    for (int depth = 1; depth <= 7; depth++) {
        double R = F, T = 0, part = (1 - F) * (1 - F);
        char text[80];
        Rgb L;
        for (int events = 2; events <= depth; events++, part *= F)
            if (events % 2)
                R += part;
            else
                T += part;
        snprintf(text, sizeof text, "whitted:ambient=none,cutoff=0.000001,maxdepth=%d", depth);
        lab_open(&l, text);
        L = see(&l, r, 1, NULL);
        EXPECT(close_to(L.r, R, 2e-5) && close_to(L.g, T, 2e-5),
               "maxdepth=%d: %.9g and %.9g, they are %.9g and %.9g", depth, L.r, L.g, R, T);
    }
    lab_clear(&l);
}

/* Between two mirrors of 0.5 the products are 0.5, 0.25, 0.125, 0.0625: with a cutoff of 0.1 the
 * fourth is not followed, as in [Shirley91 fig. 5.10]. Four rays with that of the eye. */
static void test_cutoff(void)
{
    static const struct { double cutoff; int depth; uint64_t rays; } runs[] = {
        { 0.1, 100, 4 }, { 0.125, 100, 4 }, { 0.126, 100, 3 }, { 0.01, 100, 7 }, { 1, 100, 1 },
        { 0.000001, 5, 6 }, { 0.000001, 100, 20 }, { 0.1, 0, 1 },
    };
    uint32_t mirror;
    Lab l;

    lab_init(&l);
    mirror = lab_material(&l, "mirror", "reflectance=0.5/0.4/0.5");
    lab_quad(&l, v3(-500, -500, 1), v3(1000, 0, 0), v3(0, 1000, 0), mirror);
    lab_quad(&l, v3(-500, -500, 0), v3(0, 1000, 0), v3(1000, 0, 0), mirror);
    lab_light(&l, "infinite", "", NULL);
    lab_build(&l);
    for (size_t i = 0; i < sizeof runs / sizeof *runs; i++) {
        char text[80];
        uint64_t rays;
        snprintf(text, sizeof text, "whitted:cutoff=%.7f,maxdepth=%d", runs[i].cutoff,
                 runs[i].depth);
        lab_open(&l, text);
        EXPECT(rgb_black(see(&l, ray_towards(v3(0, 0, 0.5f), v3(0.1f, 0, 0)), 1, &rays)), "light");
        EXPECT(rays == runs[i].rays, "%s: %lu rays, not %lu", text, (unsigned long)rays,
               (unsigned long)runs[i].rays);
    }
    lab_clear(&l);
}

/* Ten balls of glass within each other: the tree would have 2^100 leaves. It has at most
 * maxdepth / cutoff rays and that of the eye. Seen in an even sky, what the cutoff left out is
 * missing: less, the smaller it is. */
static void test_tree_stays_small(void)
{
    static const double cutoffs[] = { 0.1, 0.01, 0.001, 0.0001 };
    uint64_t rays, most = 0;
    Rgb L = { 0, 0, 0 };
    Lab l;

    lab_init(&l);
    for (int i = 0; i < 10; i++)
        lab_sphere(&l, v3(0.01f * (float)i, 0, 0), 1.0f - 0.09f * (float)i,
                   lab_material(&l, "dielectric", i % 2 ? "eta=0.6666667" : "eta=1.5"), false);
    lab_light(&l, "infinite", "", NULL);
    lab_build(&l);
    for (int k = 0; k < 4; k++) {
        char text[80];
        double last = L.g;
        snprintf(text, sizeof text, "whitted:ambient=none,cutoff=%g,maxdepth=100", cutoffs[k]);
        lab_open(&l, text);
        L = see(&l, ray_towards(v3(-3, 0.2f, 0.1f), v3(0, 0.5f, 0.1f)), 1, &rays);
        EXPECT((double)rays <= 1 + 100 / cutoffs[k] && rays > most, "cutoff %g: %lu rays",
               cutoffs[k], (unsigned long)rays);
        EXPECT(L.g > last && L.g <= 1.00001f, "cutoff %g: %.9g", cutoffs[k], L.g);
        most = rays;
    }
    EXPECT(L.g > 0.95f, "%g", L.g);
    lab_clear(&l);
}

/* A clear coat: the mirror image of the sky, and the base lit by a lamp; the ambient light is
 * reflected by the base alone. */
static void test_coat(void)
{
    Ray r = ray_towards(v3(0, 0, 2), v3(0, 0, 0));
    double F = 0.04;                            /* from above, eta = 1.5 */
    Vertex v;
    Rgb L, base;
    Lab l;

    lab_init(&l);
    lab_quad(&l, v3(-50, -50, 0), v3(100, 0, 0), v3(0, 100, 0),
             lab_material(&l, "coateddiffuse", "reflectance=0.6"));
    lab_light(&l, "infinite", "L=1/0/0", NULL);
    lab_build(&l);
    memset(&v, 0, sizeof v);
    v.s.shape = &l.scene->geometries[0].shapes[0];
    v.s.ng = v.s.ns = v3(0, 0, 1);
    vertex_make(&v, l.scene, v3(0, 0, -1));
    base = v.b->kind->albedo(v.b, v.wo);        /* with the coat's F */
    lab_open(&l, "whitted:ambient=constant,L0=0/2/3");
    L = see(&l, r, 1, NULL);
    EXPECT(close_to(L.r, F, 1e-5), "coat %.9g", L.r);
    EXPECT(close_to(L.g, 2 * (base.g - F), 1e-4) && close_to(L.b, 3 * (base.g - F), 1e-4),
           "base %.9g, it is %.9g", L.g, 2 * (base.g - F));
    lab_clear(&l);
}

/* ---- ambient light ---- */

/* In a ball of even reflectance rho the light that was reflected once or more is the same
 * everywhere, Phi rho/(1 - rho) / A: there the estimate is the truth, and so is every sample. */
static void test_ambient_in_a_ball(void)
{
    Lab l;

    lab_init(&l);
    lab_sphere(&l, v3(0, 0, 0), 2, lab_material(&l, "diffuse", "reflectance=0.5/0.2/0.9"), false);
    lab_light(&l, "point", "from=0.5/0.2/0.7,I=3", NULL);
    lab_build(&l);
    lab_open(&l, "whitted");
    for (int k = 0; k < 8; k++) {
        static const double rho[3] = { 0.5, 0.2, 0.9 };
        V3 at = v_scale(v_unit(v3((float)(k % 2) - 0.4f, (float)(k / 2 % 2) - 0.6f,
                                  (float)(k / 4) - 0.5f)), 2);
        V3 to = v_sub(v3(0.5f, 0.2f, 0.7f), at);
        double d2 = v_len2(to), direct = 3 * -v_dot(to, at) / 2 / (d2 * sqrt(d2)) / PI;
        double phi = 4 * PI * 3, area = 16 * PI;
        Rgb L = see(&l, ray_towards(v3(0, 0, 0), at), 1, NULL);
        double got[3] = { L.r, L.g, L.b };
        for (int c = 0; c < 3; c++) {
            double truth = rho[c] * (direct + phi * rho[c] / (1 - rho[c]) / (PI * area));
            EXPECT(close_to(got[c], truth, 1e-4), "%d: %.9g, it is %.9g", k, got[c], truth);
        }
    }
    lab_clear(&l);
}

/* And `path` says so too. */
static void test_ambient_is_the_path(void)
{
    Ray r = ray_towards(v3(0, 0, 0), v3(1, 2, 0.3f));
    Gauge g = { ray_fixed, NULL, 60000, 3, 0 };
    double truth[3];
    Meter m;
    Rgb L;
    Lab l;

    g.of = &r;
    lab_init(&l);
    lab_sphere(&l, v3(0, 0, 0), 2, lab_material(&l, "diffuse", "reflectance=0.5"), false);
    lab_light(&l, "point", "from=0.5/0.2/0.7,I=3", NULL);
    lab_build(&l);
    lab_open(&l, "whitted");
    L = see(&l, r, 1, NULL);
    truth[0] = truth[1] = truth[2] = L.g;
    lab_open(&l, "path:maxdepth=60,roulette=8");
    lab_measure(&l, &g, &m);
    stat_expect_rgb(meter_radiance(&m), truth, 0.03, "path in a ball");
    lab_clear(&l);
}

/* Areas and mean reflectances of the walls of a scene. */
static Walls walls_of(const char *text)
{
    const AccelKind *kind = kind_find(accels, ACCEL_DEFAULT);
    SceneFile f = scene_of(text, 0);
    Opts o;
    Walls w;

    opts_default(&o, kind->info.options);
    REQUIRE(scene_build(f.scene, kind, &o, 1), "build");
    w = ambient_walls(f.scene);
    scenefile_clear(&f);
    return w;
}

/* Of all shapes, in instances too, but without mirrors and clear glass. */
static void test_walls(void)
{
    static const char text[] =
        "WorldBegin\n"
        "Material \"diffuse\" \"float reflectance\" 0.25\n"
        "Shape \"sphere\" \"float radius\" 2\n"
        "Material \"mirror\"\nShape \"sphere\" \"float radius\" 9\n"
        "Material \"dielectric\"\nShape \"sphere\" \"float radius\" 8\n"
        "Material \"diffuse\" \"rgb reflectance\" [0.5 0.75 1]\n"
        "Shape \"disk\" \"float radius\" 3 \"float innerradius\" 1\n"
        "ObjectBegin \"o\"\nShape \"trianglemesh\" \"point3 P\" [0 0 0 1 0 0 0 1 0] "
        "\"integer indices\" [0 1 2]\nObjectEnd\n"
        "Scale 2 2 2\nObjectInstance \"o\"\nTranslate 5 0 0\nObjectInstance \"o\"\n";
    double ball = 16 * PI, rest = 8 * PI + 2 * 0.5 * 4, area = ball + rest;
    Walls w = walls_of(text);

    EXPECT(close_to(w.area, area, 1e-5), "area %.9g, it is %.9g", w.area, area);
    for (int c = 0; c < 3; c++) {
        double R = (0.25 * ball + (0.5 + 0.25 * c) * rest) / area;
        EXPECT(close_to(w.reflectance[c], R, 1e-5), "reflectance %.9g, it is %.9g",
               w.reflectance[c], R);
    }
}

/* What textures vary is looked at in many places; what a mask takes away is no area. */
static void test_textured_walls(void)
{
    static const char *const shapes[] = {
        ("Shape \"bilinearmesh\" \"point3 P\" [0 0 0 10 0 0 0 10 0 10 10 0] "
         "\"point2 uv\" [0 0 1 0 0 1 1 1]\n"),
        "Shape \"disk\" \"float radius\" 3\n", "Shape \"sphere\" \"float radius\" 3\n" };
    static const double areas[] = { 100, 9 * PI, 36 * PI };
    char text[1000];

    for (int i = 0; i < 3; i++)
        for (int masked = 0; masked < 2; masked++) {
            Walls w;
            snprintf(text, sizeof text,
                     "WorldBegin\nTexture \"t\" \"%s\" \"checkerboard\" \"float uscale\" 4 "
                     "\"float vscale\" 4 \"%s tex1\" %s \"%s tex2\" %s\n"
                     "Material \"diffuse\" %s\n%.*s %s\n", masked ? "float" : "spectrum",
                     masked ? "float" : "rgb", masked ? "1" : "[0.6 0.6 0.6]",
                     masked ? "float" : "rgb", masked ? "0" : "[0.2 0.2 0.2]",
                     masked ? "" : "\"texture reflectance\" \"t\"",
                     (int)strlen(shapes[i]) - 1, shapes[i],
                     masked ? "\"texture alpha\" \"t\"" : "");
            w = walls_of(text);
            EXPECT(close_to(w.area, areas[i] * (masked ? 0.5 : 1), masked ? 0.15 : 1e-5),
                   "shape %d: area %g of %g", i, w.area, areas[i]);
            EXPECT(close_to(w.reflectance[1], masked ? 0.5 : 0.4, masked ? 1e-5 : 0.08),
                   "shape %d: reflectance %g", i, w.reflectance[1]);
        }
}

static Rgb ambient_of(const Scene *s, const char *text, bool sky)
{
    const IntegratorKind *k = kind_find(integrators, "whitted");
    Arena arena = { 0 };
    Opts o;
    Rgb L;

    opts_default(&o, k->info.options);
    REQUIRE(opts_parse(&o, "whitted", text, &arena), "%s", text);
    L = ambient_light(s, &o, sky);
    arena_clear(&arena);
    return L;
}

/* The formula; the sky's part of it; no infinity where nothing is absorbed, nor without walls. */
static void test_ambient_formula(void)
{
    double phi = PI * 6 * 5 + 4 * PI, R = (6 * 0.0 + 100 * 0.6) / 106, want;
    Rgb L;
    Lab l;

    lab_init(&l);
    lab_quad(&l, v3(-5, -5, 0), v3(10, 0, 0), v3(0, 10, 0),
             lab_material(&l, "diffuse", "reflectance=0.6"));
    lab_shine(&l, lab_quad(&l, v3(0, 0, 4), v3(2, 0, 0), v3(0, 3, 0),
                           lab_material(&l, "diffuse", "reflectance=0")), "L=5");
    lab_light(&l, "point", "from=0/0/3,I=1", NULL);
    lab_light(&l, "infinite", "L=0.25/0.5/1", NULL);
    lab_build(&l);
    want = phi * R / (1 - R) / (PI * 106);
    L = ambient_of(l.scene, "ambient=estimate", false);
    EXPECT(close_to(L.g, want, 1e-5), "%.9g, it is %.9g", L.g, want);
    L = ambient_of(l.scene, "ambient=estimate", true);
    EXPECT(close_to(L.r, want + 0.25, 1e-5) && close_to(L.b, want + 1, 1e-5), "sky: %.9g", L.r);
    EXPECT(rgb_black(ambient_of(l.scene, "ambient=none", true)), "none");
    EXPECT(ambient_of(l.scene, "ambient=constant,L0=1/2/3", true).b == 3, "constant");
    lab_clear(&l);

    lab_init(&l);
    floor_of(&l, "reflectance=1");
    lab_light(&l, "point", "", NULL);
    lab_build(&l);
    L = ambient_of(l.scene, "ambient=estimate", true);
    EXPECT(L.r > 0 && close_to(L.r, 4 * PI * 49 / (PI * 1e4), 1e-5), "white: %.9g", L.r);
    lab_clear(&l);

    lab_init(&l);
    lab_light(&l, "point", "", NULL);
    lab_build(&l);
    EXPECT(rgb_black(ambient_of(l.scene, "ambient=estimate", true)), "no walls");
    lab_clear(&l);
}

static Rgb sky_of_two(V3 w)
{
    (void)w;
    return rgb_all(2);
}

/* Inside of a ball from which a cap is cut off, a part o of its area, any point sees the cap as a
 * part o of all directions, so that a sky L gives all points the same light: it sums up to
 * L o / (1 - R (1 - o)). Of that the part L o comes straight from the sky. In a closed ball there
 * is none. */
static void test_ambient_in_a_bowl(void)
{
    static const double open[] = { 0.5, 0.2, 0.02, 0 };

    for (int k = 0; k < 4; k++) {
        double R = 0.7, o = open[k], want = 2 * o / (1 - R * (1 - o)), got;
        Lab l;
        lab_init(&l);
        lab_zone(&l, v3(0, 0, 0), 1, -1, (float)(1 - 2 * o),
                 lab_material(&l, "diffuse", "reflectance=0.7"), false);
        lab_sky(&l, 16, 8, sky_of_two, NULL);
        lab_camera(&l, v3(0.1f, 0.2f, -0.3f), v3(0.5f, 0.3f, -0.9f), 45, "");
        lab_build(&l);
        got = (double)ambient_of(l.scene, "ambient=estimate", true).g;
        EXPECT(fabs(got - want) <= 0.05 * want, "%g open: %.4g, it is %.4g", o, got, want);
        got = (double)ambient_of(l.scene, "ambient=estimate", false).g;
        EXPECT(fabs(got - want + 2 * o) <= 0.05 * want, "%g open, without the sky: %.4g, it is "
               "%.4g", o, got, want - 2 * o);
        lab_clear(&l);
    }
}

/* ---- the driver, and scenes with little in them ---- */

/* Lights of no power, none at all, no lens: black pictures, or those of the ambient light. */
static void test_little(void)
{
    static const struct { const char *method, *light; float want; } runs[] = {
        { "whitted", NULL, 0 }, { "distributed", NULL, 0 },
        { "whitted", "I=0", 0 }, { "distributed:lightsampler=all", "I=0", 0 },
        { "distributed:lightsampler=uniform,lightsamples=3", "I=0", 0 },
        { "whitted:ambient=constant,L0=2", NULL, 1 },
        { "distributed:ambient=constant,L0=2", NULL, 1 },
        { "distributed:ambient=estimate", NULL, 0 },
    };

    for (size_t i = 0; i < sizeof runs / sizeof *runs; i++) {
        RenderSettings s;
        RenderReport report;
        Film film;
        Image im;
        Lab l;
        lab_init(&l);
        lab_camera(&l, v3(0, -3, 3), v3(0, 0, 0), 40, "");
        floor_of(&l, "reflectance=0.5");
        if (runs[i].light)
            lab_light(&l, "point", runs[i].light, NULL);
        lab_build(&l);
        picture_settings(&l, &s, runs[i].method, 8, 8, 1);
        picture_render(&l, &s, &film, &report);
        REQUIRE(image_init(&im, 8, 8), "memory");
        film_picture(&film, 0, &im);
        for (uint32_t p = 0; p < 64; p++)
            EXPECT(fabsf(image_at(&im, p % 8, p / 8)->g - runs[i].want) < 1e-5f, "%s: %g",
                   runs[i].method, image_at(&im, p % 8, p / 8)->g);
        image_clear(&im);
        film_clear(&film);
        lab_clear(&l);
    }
}

/* Media take light on the way to the surface and from there to the lamp. */
static void test_media(void)
{
    Medium fog = { "", { 0.1f, 0.2f, 0.3f }, { 0.1f, 0, 0 }, 0 };
    Ray r = ray_towards(v3(1, 0, 2), v3(1, 0, 0));
    uint32_t index;
    Lab l;

    for (int k = 0; k < 2; k++) {
        double d2 = 10, direct = 3 / (d2 * sqrt(d2)) / PI;
        double way = 2 + sqrt(10);
        Rgb L;
        lab_init(&l);
        floor_of(&l, "reflectance=1");
        REQUIRE(scene_add_medium(l.scene, &fog, &index), "memory");
        l.scene->around = index;
        if (k == 0)
            lab_light(&l, "point", "from=0/0/3,I=1", NULL);
        else {
            lab_shine(&l, lab_quad(&l, v3(-0.005f, -0.005f, 3), v3(0, 0.01f, 0), v3(0.01f, 0, 0),
                                   lab_material(&l, "diffuse", "reflectance=0")), "L=10000");
            direct *= 3 / sqrt(10);             /* the lamp's cosine */
        }
        lab_build(&l);
        lab_open(&l, "whitted:ambient=none");
        L = see(&l, r, 1, NULL);
        EXPECT(close_to(L.r, direct * md_exp(-0.2 * way), 1e-3) &&
               close_to(L.b, direct * md_exp(-0.3 * way), 1e-3), "lamp %d: %.9g, it is %.9g", k,
               L.r, direct * md_exp(-0.2 * way));
        lab_clear(&l);
    }
}

/* Scene files of others ask for it by that name. */
static void test_scene_file(void)
{
    SceneFile f = scene_of("Integrator \"whitted\" \"integer maxdepth\" 5\nWorldBegin\n", 0);
    RenderRequest q;
    RenderSettings s;

    memset(&q, 0, sizeof q);
    q.threads = 1;
    q.max_pixels = IMAGE_PIXELS_DEFAULT;
    REQUIRE(settings_resolve(&s, &q, &f), "settings");
    EXPECT(!strcmp(s.integrator->info.name, "whitted") &&
           opt_int(&s.integrator_opts, "maxdepth") == 5, "%s", s.integrator->info.name);
    scenefile_clear(&f);
}

const TestCase test_whitted[] = {
    { "point_lamp", test_point_lamp, false },
    { "lamps_as_points", test_lamps_as_points, false },
    { "seen", test_seen, false },
    { "slab", test_slab, false },
    { "cutoff", test_cutoff, false },
    { "tree_stays_small", test_tree_stays_small, false },
    { "coat", test_coat, false },
    { "ambient_in_a_ball", test_ambient_in_a_ball, false },
    { "ambient_is_the_path", test_ambient_is_the_path, false },
    { "walls", test_walls, false },
    { "textured_walls", test_textured_walls, false },
    { "ambient_formula", test_ambient_formula, false },
    { "ambient_in_a_bowl", test_ambient_in_a_bowl, false },
    { "little", test_little, false },
    { "media", test_media, false },
    { "scene_file", test_scene_file, false },
    { NULL, NULL, false }
};
