/* test_physics_specular.c -- mirrors and glass.
 *
 * Mirror image: a perfect mirror of reflectance r shows the light once more, behind it; a floor
 * gets E of the light plus r times E of its image, where the mirror is large enough to hold that.
 *
 * Invisible glass: a body that absorbs nothing, in a sky of the same radiance L from everywhere,
 * cannot be seen: what refraction concentrates on entering, (n2/n1)^2, it spreads on leaving, and
 * Fresnel's reflectance and transmittance add up to 1. Reflection and transmission are chosen by
 * their shares, so not only the mean but every single sample is L, however often light is reflected
 * within. Excepted is a point so near to an edge, half a float step or 3e-8 of the size, that it
 * is rounded into the plane of the next face: its ray may slip out there. */
#include "geometry/generate.h"
#include "sampling/warp.h"
#include "test/physics.h"

#include <string.h>

/* ---- mirror image ---- */

/* Irradiance at `at` of a horizontal rectangle of radiance 1 above it, by the view factors of the
 * four rectangles with a corner above the point. */
static double corner_factor(double x, double y, double h)
{
    double a = x / h, b = y / h, p = sqrt(1 + a * a), q = sqrt(1 + b * b);
    return (a / p * md_atan2(b, p) + b / q * md_atan2(a, q)) / (2 * PI);
}

static double rectangle_irradiance(double x0, double x1, double y0, double y1, double h)
{
    return PI * (corner_factor(x1, y1, h) - corner_factor(x0, y1, h) - corner_factor(x1, y0, h) +
                 corner_factor(x0, y0, h));
}

static void mirror_image(void)
{
    static const struct { const char *options; double direct, image; } ways[] = {
        { "strategy=implicit,maxdepth=2,roulette=9", 0.02, 0.05 },
        { "strategy=explicit,maxdepth=2,roulette=9", 0.04, 0.05 },
        { "strategy=mis,maxdepth=2,roulette=9", 0.015, 0.05 },
        { "strategy=mis,heuristic=balance,maxdepth=2,roulette=9", 0.015, 0.05 },
    };
    V3 at = { 0.1f, 0.2f, 0 };
    Ray r = ray_towards(v3(-0.9f, -0.7f, 0.3f), at);
    Gauge g = { ray_fixed, NULL, 400000, 41, 0 };
    /* the light spans x -2 .. 0.9, y -2 .. 3 at z = 0.8; the mirror at x = 1 turns x to 2 - x */
    double direct = rectangle_irradiance(-2.1, 0.8, -2.2, 2.8, 0.8) / PI;
    double image = rectangle_irradiance(1, 3.9, -2.2, 2.8, 0.8) / PI;
    double truth[2][3];
    uint32_t black;
    Lab l;

    lab_init(&l);
    black = lab_material(&l, "diffuse", "reflectance=0");
    lab_quad(&l, v3(-4, -5, 0), v3(5, 0, 0), v3(0, 10, 0),
             lab_material(&l, "diffuse", "reflectance=1"));
    lab_quad(&l, v3(1, -40, -1), v3(0, 0, 40), v3(0, 80, 0),
             lab_material(&l, "mirror", "reflectance=0.9/0.5/0.25"));
    lab_shine(&l, lab_quad(&l, v3(-2, -2, 0.8f), v3(0, 5, 0), v3(2.9f, 0, 0), black), "L=1/2/4");
    lab_build(&l);
    g.of = &r;
    for (int c = 0; c < 3; c++) {
        truth[0][c] = direct * (1 << c);
        truth[1][c] = image * (1 << c) * (c == 0 ? 0.9 : c == 1 ? 0.5 : 0.25);
    }
    for (size_t i = 0; i < sizeof ways / sizeof *ways; i++) {
        Meter m;
        lab_open(&l, ways[i].options);
        lab_measure(&l, &g, &m);
        stat_expect_rgb(meter_length(&m, 2), truth[0], ways[i].direct, ways[i].options);
        stat_expect_rgb(meter_length(&m, 3), truth[1], ways[i].image, ways[i].options);
    }
    lab_clear(&l);
}

/* Looking into mirrors: each multiplies by its reflectance. Two of them at right angles. */
static void mirror_seen(void)
{
    Ray r = ray_towards(v3(0.5f, 0.2f, 0.6f), v3(1, 0.25f, 0.3f));
    Gauge g = { ray_fixed, NULL, 256, 42, 0 };
    double truth[3] = { 0.5 * 0.4, 2 * 0.25 * 0.6, 4 * 0.125 * 0.8 };
    Meter m;
    Lab l;

    lab_init(&l);
    lab_quad(&l, v3(1, -5, 0), v3(0, 0, 5), v3(0, 10, 0),
             lab_material(&l, "mirror", "reflectance=0.5/0.25/0.125"));
    lab_quad(&l, v3(-5, -5, 0), v3(6, 0, 0), v3(0, 10, 0),
             lab_material(&l, "mirror", "reflectance=0.4/0.6/0.8"));
    lab_light(&l, "infinite", "L=1/2/4", NULL);
    lab_build(&l);
    g.of = &r;
    lab_open(&l, "roulette=9");
    lab_measure(&l, &g, &m);
    stat_expect_rgb(meter_radiance(&m), truth, 1e-6, "two mirrors");
    stat_expect_rgb(meter_length(&m, 3), truth, 1e-6, "two mirrors, paths of 3");
    lab_clear(&l);
}

/* ---- invisible glass ---- */

typedef enum { SPHERE, CUBE, NESTED, TORUS, FACETS, BLOB, BODIES } Body;
static const char *const body_names[BODIES] = { "sphere", "cube", "nested spheres", "torus",
                                                "icosahedron", "blob" };

static void add_body(Lab *l, Body body)
{
    uint32_t glass = lab_material(l, "dielectric", "eta=1.5");
    Mesh m = { 0 };
    bool ok = true;

    switch (body) {
    case SPHERE: lab_sphere(l, v3(0, 0, 0), 1, glass, false); return;
    case NESTED:                                /* glass around water around a bubble of air */
        lab_sphere(l, v3(0, 0, 0), 1, glass, false);
        lab_sphere(l, v3(0.2f, 0, 0), 0.7f, lab_material(l, "dielectric", "eta=0.8866667"), false);
        lab_sphere(l, v3(0.2f, 0.3f, 0), 0.3f, lab_material(l, "dielectric", "eta=0.7518797"),
                   false);
        return;
    case CUBE:   ok = mesh_cube(&m); break;
    case TORUS:  ok = mesh_torus(&m, 24, 12, 1, 0.4f); break;
    case FACETS: ok = mesh_icosphere(&m, 1); break;
    default:     ok = mesh_blob(&m, 7); break;
    }
    REQUIRE(ok, "mesh");
    lab_mesh(l, &m, glass, false);
}

/* Towards a place within the ball of radius 1. */
static Ray ray_at_body(Rng *rng)
{
    V2 u = { rng_unit(rng), rng_unit(rng) }, v = { rng_unit(rng), rng_unit(rng) };
    return ray_towards(v_scale(warp_sphere(u), 3), v_scale(warp_sphere(v), rng_unit(rng)));
}

static Rgb even_sky(V3 w)
{
    (void)w;
    return rgb(1, 2, 4);
}

static bool nearly(float a, float b) { return fabsf(a / b - 1.0f) <= ROUNDINGS(64); }

static void expect_unseen(Lab *l, const char *name)
{
    const SamplerKind *kind = kind_find(samplers, "random");
    uint32_t n = test_is_long() ? 1000000 : 40000, spp = 1, seen = 0;
    Rng rng = rng_seed(43);
    Tracer t;
    Opts none;
    Ray first = { .o = { 0, 0, 0 }, .d = { 0, 0, 1 }, .tmax = 0 };
    Rgb is = { 0, 0, 0 };

    memset(&t, 0, sizeof t);
    t.scene = l->scene;
    opts_default(&none, kind->info.options);
    REQUIRE(sampler_init(&t.sampler, kind, &none, 44, &spp), "sampler");
    for (uint32_t k = 0; k < n; k++) {
        Ray r = ray_at_body(&rng);
        Rgb L;
        sampler_pixel(&t.sampler, k, 0);
        sampler_start(&t.sampler, 0);
        L = l->integrator->kind->radiance(l->integrator, &r, &t);
        if (nearly(L.r, 1) && nearly(L.g, 2) && nearly(L.b, 4))
            continue;
        if (!seen++) {
            first = r;
            is = L;
        }
    }
    EXPECT(seen <= 1e-6 * n,
           "%s: %lu of %lu rays see it, the first from %.9g %.9g %.9g along %.9g %.9g %.9g: "
           "%.9g %.9g %.9g",
           name, (unsigned long)seen, (unsigned long)n, (double)first.o.x, (double)first.o.y,
           (double)first.o.z, (double)first.d.x, (double)first.d.y, (double)first.d.z, (double)is.r,
           (double)is.g, (double)is.b);
    EXPECT(t.rays > n + n / 2, "%s: only %.0f rays", name, (double)t.rays);
}

static void invisible(const char *options, bool cells)
{
    for (int body = 0; body < BODIES; body++) {
        Lab l;
        lab_init(&l);
        add_body(&l, (Body)body);
        if (cells)
            lab_sky(&l, 16, 8, even_sky, NULL);
        else
            lab_light(&l, "infinite", "L=1/2/4", NULL);
        lab_build(&l);
        lab_open(&l, options);
        expect_unseen(&l, body_names[body]);
        lab_clear(&l);
    }
}

static void glass(void) { invisible("maxdepth=100000", false); }
static void glass_implicit(void)
{
    invisible("maxdepth=100000,strategy=implicit,roulette=50", true);
}

/* ---- a glossy lobe ---- */

/* Seen from straight above, a lobe of Phong's reflects ks of an even sky, and matt adds kd. */
static void phong_from_above(void)
{
    static const double truth[3] = { 0.3 + 0.5, 2 * (0.2 + 0.7), 4 * (0.1 + 0.25) };
    static const char *const ways[] = { "strategy=implicit,maxdepth=1",
                                        "strategy=explicit,maxdepth=1", "strategy=mis,maxdepth=1" };
    static const double delta[3] = { 0.003, 0.055, 0.01 };
    Ray r = { .o = { 0.1f, 0.2f, 1 }, .d = { 0, 0, -1 }, .tmax = INFINITY };
    Gauge g = { ray_fixed, NULL, 200000, 45, 0 };
    Lab l;

    lab_init(&l);
    lab_quad(&l, v3(-1, -1, 0), v3(2, 0, 0), v3(0, 2, 0),
             lab_material(&l, "phong", "reflectance=0.3/0.2/0.1,specular=0.5/0.7/0.25,exponent=8"));
    lab_light(&l, "infinite", "L=1/2/4", NULL);
    lab_build(&l);
    g.of = &r;
    for (int i = 0; i < 3; i++) {
        Meter m;
        lab_open(&l, ways[i]);
        lab_measure(&l, &g, &m);
        stat_expect_rgb(meter_radiance(&m), truth, delta[i], ways[i]);
    }
    lab_clear(&l);
}

const TestCase test_physics_specular[] = {
    { "mirror_image", mirror_image, false },
    { "mirror_seen", mirror_seen, false },
    { "phong_from_above", phong_from_above, false },
    { "glass", glass, false },
    { "glass_implicit", glass_implicit, false },
    { NULL, NULL, false }
};
