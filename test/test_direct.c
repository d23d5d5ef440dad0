/* test_direct.c -- every strategy for direct light gives the light that path tracing gives.
 *
 * Pictures    four small scenes: lamps and a glossy ball; a sphere light; a picture of the sky;
 *             many lights, delta ones among them. Every strategy against path:maxdepth=1, by tiles.
 * Closed      a lamp over a floor, a lamp behind a lamp, a sky: irradiance as theory has it.
 * Resampling  variance falls as tentative samples grow.
 * Bad input   no light, black ones, ones without extent: black pictures, never NaN. */
#include "geometry/generate.h"
#include "integrators/lighting.h"
#include "test/pictures.h"

#include <stdio.h>
#include <string.h>

enum { SIDE = 32 };

typedef struct { const char *method; uint32_t spp; double delta; } Way;

static void expect_agreement(Lab *l, const char *truth, uint32_t spp, const Way *way)
{
    Series first, other;

    messages_quiet(true);
    series_render(l, &first, truth, SIDE, spp, 200);
    for (uint64_t i = 0; way[i].method; i++) {
        series_render(l, &other, way[i].method, SIDE, way[i].spp, 201 + i);
        series_expect_same(&other, &first, way[i].delta, way[i].method);
        series_clear(&other);
    }
    series_clear(&first);
}

/* Two lamps of different size, one behind the other for a part of the floor, and a glossy ball. */
static void add_lamps(Lab *l)
{
    uint32_t black = lab_material(l, "diffuse", "reflectance=0");

    lab_quad(l, v3(-3, -3, 0), v3(6, 0, 0), v3(0, 6, 0),
             lab_material(l, "phong", "reflectance=0.4/0.3/0.2,specular=0.4,exponent=20"));
    lab_sphere(l, v3(0, 0.3f, 0.6f), 0.6f, lab_material(l, "conductor", "roughness=0.3"), false);
    lab_shine(l, lab_quad(l, v3(-2, -1.5f, 2.2f), v3(0, 3, 0), v3(3, 0, 0.5f), black),
              "L=1/1/1.5");
    lab_shine(l, lab_quad(l, v3(-1, -0.5f, 1.6f), v3(0, 0.7f, 0), v3(0.8f, 0, 0), black),
              "L=3/4/4");
    lab_camera(l, v3(0, -4, 2), v3(0, 0, 0.4f), 45, "");
}

static void lamps(void)
{
    static const Way ways[] = {
        { "direct:strategy=uniform,bsdfsamples=8", 8, 0.06 },
        { "direct:strategy=brdf,bsdfsamples=2", 16, 0.05 },
        { "direct:strategy=light,lightsamples=2,lightsampler=contribution", 8, 0.03 },
        { "direct:strategy=light,lights=all", 8, 0.03 },
        { "direct:strategy=light,lights=shirley,tolerance=0.6", 8, 0.03 },
        { "direct:strategy=light,occlusion=directions", 8, 0.03 },
        { "direct:strategy=mis,lightsamples=3,bsdfsamples=1", 8, 0.03 },
        { "direct:strategy=mis,heuristic=balance,lightsamples=1,bsdfsamples=2", 8, 0.03 },
        { "direct:strategy=mis,lights=all", 8, 0.03 },
        { "direct:strategy=mis,occlusion=directions", 8, 0.02 },
        { "direct:strategy=ris,tentative=12,samples=3", 8, 0.03 },
        { "direct:strategy=ris,tentative=5,samples=7,heuristic=balance,lightshare=0.8", 8, 0.03 },
        { "direct:strategy=ris,tentative=8,samples=2,occlusion=directions", 8, 0.03 },
        { "path:strategy=ris,maxdepth=1", 24, 0.03 },
        { NULL, 0, 0 }
    };
    Lab l;

    lab_init(&l);
    add_lamps(&l);
    lab_build(&l);
    expect_agreement(&l, "path:maxdepth=1", 32, ways);
    lab_clear(&l);
}

/* A lamp that is a ball, and a two-sided disc: each is met twice or from behind by some rays. */
static void balls(void)
{
    static const Way ways[] = {
        { "direct:strategy=brdf,bsdfsamples=2", 16, 0.05 },
        { "direct:strategy=light,occlusion=directions", 8, 0.03 },
        { "direct:strategy=mis,lightsampler=contribution", 8, 0.03 },
        { "direct:strategy=mis,occlusion=directions,lightsampler=uniform", 8, 0.03 },
        { "direct:strategy=ris,tentative=8,samples=2", 8, 0.03 },
        { "direct:strategy=ris,tentative=8,samples=2,occlusion=directions", 8, 0.03 },
        { NULL, 0, 0 }
    };
    uint32_t black;
    Mesh m = { 0 };
    Lab l;

    lab_init(&l);
    black = lab_material(&l, "diffuse", "reflectance=0");
    lab_quad(&l, v3(-3, -3, 0), v3(6, 0, 0), v3(0, 6, 0),
             lab_material(&l, "coateddiffuse", "reflectance=0.2/0.5/0.7,roughness=0.2"));
    lab_sphere(&l, v3(-0.7f, 0, 0.4f), 0.4f, lab_material(&l, "diffuse", "reflectance=0.7"), false);
    lab_shine(&l, lab_sphere(&l, v3(0.8f, 0.2f, 1), 0.4f, black, false), "L=2/3/2");
    lab_shine(&l, lab_disk(&l, v3(0, 0.6f, 1.4f), v3(0.5f, 0.3f, -1), 0.5f, 0.1f, black),
              "L=2/1/1,twosided=true");
    REQUIRE(mesh_cube(&m), "cube");
    mesh_move(&m, 0.5f, v3(-1.2f, 0.8f, 1));
    lab_shine(&l, lab_mesh(&l, &m, black, false), "L=1/1/2");
    lab_camera(&l, v3(0, -4, 2), v3(0, 0, 0.4f), 45, "");
    lab_build(&l);
    expect_agreement(&l, "path:maxdepth=1", 32, ways);
    lab_clear(&l);
}

static Rgb cloudy(V3 w)
{
    float c = f_max(0, 0.58f * w.x - 0.58f * w.y + 0.58f * w.z), bright = f_sqr(f_sqr(c));
    return rgb_scale(rgb(0.5f, 0.7f, 1), w.z > 0 ? 0.5f + 3 * bright : 0.05f);
}

static void sky(void)
{
    static const Way ways[] = {
        { "direct:strategy=uniform,bsdfsamples=4", 8, 0.03 },
        { "direct:strategy=brdf", 16, 0.03 },
        { "direct:strategy=mis,lightsampler=contribution", 8, 0.03 },
        { "direct:strategy=mis,occlusion=directions", 8, 0.03 },
        { "direct:strategy=ris,tentative=8,samples=2", 8, 0.03 },
        { "path:strategy=ris,maxdepth=1", 24, 0.03 },
        { NULL, 0, 0 }
    };
    Transform turn = xf_rotate(30, 0, 0, 1);
    uint32_t black;
    Lab l;

    lab_init(&l);
    black = lab_material(&l, "diffuse", "reflectance=0");
    lab_quad(&l, v3(-3, -3, 0), v3(6, 0, 0), v3(0, 6, 0),
             lab_material(&l, "diffuse", "reflectance=0.5/0.4/0.3"));
    lab_sphere(&l, v3(-0.5f, 0, 0.6f), 0.6f, lab_material(&l, "conductor", "roughness=0.2"), false);
    lab_shine(&l, lab_disk(&l, v3(0.9f, 0, 1.2f), v3(-0.3f, -0.2f, -1), 0.5f, 0.2f, black),
              "L=3/2/1");
    lab_light(&l, "infinite", "L=0.1/0.1/0.2", NULL);           /* a second one behind it */
    lab_sky(&l, 32, 16, cloudy, &turn);
    lab_camera(&l, v3(0, -4, 2), v3(0, 0, 0.5f), 45, "");
    lab_build(&l);
    expect_agreement(&l, "path:maxdepth=1", 32, ways);
    lab_clear(&l);
}

/* Small lamps in a row, a spot, a sun and a point light, over a floor seen from both sides. */
static void add_many(Lab *l)
{
    uint32_t black = lab_material(l, "diffuse", "reflectance=0");
    Transform up = xf_translate(0, 0, 1.5);

    lab_quad(l, v3(-3, 3, 0), v3(6, 0, 0), v3(0, -6, 0),         /* its front is below */
             lab_material(l, "diffuse", "reflectance=0.5/0.4/0.3"));
    lab_quad(l, v3(-1.5f, 1, 0.1f), v3(3, 0, 0), v3(0, 0, 1),
             lab_material(l, "diffusetransmission", "reflectance=0.3,transmittance=0.5"));
    lab_sphere(l, v3(-0.4f, -0.5f, 0.5f), 0.5f, lab_material(l, "conductor", "roughness=0.25"),
               false);
    for (int i = 0; i < 6; i++)
        lab_shine(l, lab_quad(l, v3((float)i - 2.6f, 0.5f + 0.3f * (float)(i % 3), 1),
                              v3(0, 0.2f, 0), v3(0.2f, 0, 0), black), "L=8/6/4");
    lab_light(l, "point", "I=0.3/0.3/0.5", &up);
    lab_light(l, "spot", "I=4/3/3,coneangle=25,from=1.5/-1/2,to=0.5/0/0", NULL);
    lab_light(l, "distant", "L=0.2,from=-1/-1/2,to=0/0/0", NULL);
    lab_camera(l, v3(0, -4, 2), v3(0, 0, 0.4f), 45, "");
}

static void many(void)
{
    static const Way ways[] = {
        { "direct:strategy=light,lightsampler=uniform,lightsamples=2", 16, 0.05 },
        { "direct:strategy=light,lightsampler=contribution", 8, 0.05 },
        { "direct:strategy=light,lights=all", 4, 0.04 },
        { "direct:strategy=light,lights=shirley", 4, 0.04 },
        { "direct:strategy=light,lights=shirley,tolerance=0.9", 8, 0.02 },
        { "direct:strategy=mis,lightsampler=contribution", 8, 0.03 },
        { "direct:strategy=mis,lights=all", 4, 0.04 },
        { "direct:strategy=ris,tentative=16,samples=2,lightsampler=contribution", 8, 0.03 },
        { "path:strategy=mis,maxdepth=1,lightsampler=contribution", 8, 0.03 },
        { "path:strategy=ris,maxdepth=1,lightsampler=contribution", 8, 0.03 },
        { NULL, 0, 0 }
    };
    Lab l;

    lab_init(&l);
    add_many(&l);
    lab_build(&l);
    expect_agreement(&l, "path:maxdepth=1", 64, ways);
    lab_clear(&l);
}

/* Mirrors are followed; what is seen in them is direct light too. Media scatter and absorb. */
static void mirrors_and_fog(void)
{
    static const Way once[] = {
        { "direct:strategy=mis,maxdepth=1", 24, 0.03 },
        { "direct:strategy=ris,maxdepth=1,tentative=4,samples=1", 32, 0.03 },
        { NULL, 0, 0 }
    };
    static const Way twice[] = {
        { "direct:strategy=light,maxdepth=4", 16, 0.03 },
        { "direct:strategy=ris,maxdepth=4,tentative=4,samples=2", 16, 0.03 },
        { NULL, 0, 0 }
    };
    uint32_t black, shape;
    Medium fog = { "fog", { 0.05f, 0.1f, 0.1f }, { 0.2f, 0.2f, 0.15f }, 0.4f };
    Lab l;

    lab_init(&l);
    add_lamps(&l);
    REQUIRE(scene_add_medium(l.scene, &fog, &shape), "memory");
    l.scene->around = shape;
    lab_sphere(&l, v3(1, -0.8f, 0.4f), 0.4f, lab_material(&l, "mirror", "reflectance=0.8"), false);
    lab_build(&l);
    expect_agreement(&l, "path:maxdepth=1", 64, once);
    lab_clear(&l);
    lab_init(&l);                               /* lamp, mirror, black room: nothing but once */
    black = lab_material(&l, "diffuse", "reflectance=0");
    lab_quad(&l, v3(-3, -3, 0), v3(6, 0, 0), v3(0, 6, 0),
             lab_material(&l, "mirror", "reflectance=0.8"));
    lab_shine(&l, lab_sphere(&l, v3(0.5f, 0, 1.5f), 0.3f, black, false), "L=4/3/3");
    lab_quad(&l, v3(-2, 1, 0), v3(4, 0, 0), v3(0, 0, 2),
             lab_material(&l, "diffuse", "reflectance=0.8"));
    lab_camera(&l, v3(0, -4, 2), v3(0, 0, 0.4f), 45, "");
    lab_build(&l);
    expect_agreement(&l, "direct:strategy=mis,lightsamples=4,maxdepth=4", 32, twice);
    lab_clear(&l);
}

/* ---- ward: how biased? ---- */

static double mean_of(Lab *l, const char *method)
{
    RenderSettings s;
    RenderReport report;
    double sum = 0;
    Image im;
    Film film;

    REQUIRE(image_init(&im, SIDE, SIDE), "memory");
    picture_settings(l, &s, method, SIDE, SIDE, 64);
    picture_render(l, &s, &film, &report);
    film_picture(&film, 0, &im);
    for (size_t i = 0; i < (size_t)SIDE * SIDE; i++)
        sum += (double)rgb_lum(im.pixels[i]);
    film_clear(&film);
    image_clear(&im);
    return sum / (SIDE * SIDE);
}

/* The guess is off by at most `tolerance` of what there would be without shadows; with a tolerance
 * of 0 nothing is guessed. */
static void ward(void)
{
    double truth, none, some, all;
    Lab l;

    messages_quiet(true);
    lab_init(&l);
    add_many(&l);
    lab_build(&l);
    truth = mean_of(&l, "direct:strategy=light,lights=all");
    none = mean_of(&l, "direct:strategy=light,lights=ward,tolerance=0");
    some = mean_of(&l, "direct:strategy=light,lights=ward,tolerance=0.1");
    all = mean_of(&l, "direct:strategy=light,lights=ward,tolerance=0.9");
    EXPECT(fabs(none / truth - 1) < 1e-4, "tolerance 0: off by %.2g", none / truth - 1);
    EXPECT(fabs(some / truth - 1) < 0.02, "tolerance 0.1: off by %.2g", some / truth - 1);
    EXPECT(fabs(all / truth - 1) < 0.5 && fabs(all / truth - 1) > 1e-3,
           "tolerance 0.9: off by %.2g, a bias was expected", all / truth - 1);
    lab_clear(&l);
}

/* ---- a lamp behind a lamp, by theory ---- */

/* Irradiance of a disc of radius R at height h, on its axis: pi L R^2 / (h^2 + R^2). A small disc
 * before a large one takes the large one's share of its own solid angle away. */
static void eclipse(void)
{
    static const char *const methods[] = {
        "direct:strategy=light,lightsamples=4", "direct:strategy=light,occlusion=directions",
        "direct:strategy=mis,lightsampler=contribution", "direct:strategy=mis,occlusion=directions",
        "direct:strategy=ris,tentative=8,samples=2", "direct:strategy=brdf",
        "direct:strategy=ris,tentative=8,samples=1,occlusion=directions",
        "direct:strategy=light,lights=shirley,tolerance=0.4", "path:strategy=ris,maxdepth=1"
    };
    double near = PI * 0.09 / (1 + 0.09), far = PI * 1 / (4 + 1), truth;
    Ray r = ray_towards(v3(-0.9f, -0.7f, 0.11f), v3(0.05f, 0.02f, 0));
    Gauge g = { ray_fixed, NULL, 60000, 41, 0 };
    uint32_t black;
    Lab l;

    truth = (3 * near + 2 * (far - near)) / PI;
    g.of = &r;
    lab_init(&l);
    black = lab_material(&l, "diffuse", "reflectance=0");
    lab_quad(&l, v3(-4, -5, 0), v3(10, 0, 0), v3(0, 10, 0),
             lab_material(&l, "diffuse", "reflectance=1"));
    lab_shine(&l, lab_disk(&l, v3(0.05f, 0.02f, 1), v3(0, 0, -1), 0.3f, 0, black), "L=3");
    lab_shine(&l, lab_disk(&l, v3(0.05f, 0.02f, 2), v3(0, 0, -1), 1, 0, black), "L=2");
    lab_build(&l);
    for (size_t i = 0; i < sizeof methods / sizeof methods[0]; i++) {
        Meter m;
        lab_open(&l, methods[i]);
        lab_measure(&l, &g, &m);
        stat_expect(meter_radiance(&m), truth, 0.08, methods[i]);
    }
    lab_clear(&l);
}

/* ---- nothing to see ---- */

static void expect_black(Lab *l, const char *what)
{
    static const char *const methods[] = {
        "direct:strategy=uniform", "direct:strategy=brdf", "direct:strategy=light",
        "direct:strategy=mis", "direct:strategy=ris", "direct:strategy=ris,tentative=1,samples=1",
        "direct:strategy=light,lights=all", "direct:strategy=light,lights=ward",
        "direct:strategy=light,lights=shirley", "direct:strategy=mis,occlusion=directions",
        "direct:strategy=mis,lightsampler=contribution", "path:strategy=ris",
        "path:lightsampler=contribution", "direct:strategy=light,lightsampler=uniform",
        "direct:strategy=cut,points=100", "direct:strategy=cut,jitter=false,points=1,indirect=yes",
        "direct:strategy=cut,brdf=all,points=9", "direct:strategy=sir,points=100",
        "direct:strategy=cut,brdf=single,points=50,indirect=only"
    };
    Ray r = ray_towards(v3(-0.9f, -0.7f, 0.5f), v3(0.05f, 0.02f, 0));
    Gauge g = { ray_fixed, NULL, 64, 41, 0 };

    messages_quiet(true);
    g.of = &r;
    for (size_t i = 0; i < sizeof methods / sizeof methods[0]; i++) {
        Meter m;
        lab_open(l, methods[i]);
        lab_measure(l, &g, &m);         /* which asks that all is finite */
        EXPECT(meter_radiance(&m)[0].total == 0, "%s, %s: not black", what, methods[i]);
    }
    lab_clear(l);
}

static Rgb night(V3 w)
{
    (void)w;
    return rgb_all(0);
}

static void begin_dark(Lab *l)
{
    lab_init(l);
    lab_quad(l, v3(-4, -5, 0), v3(10, 0, 0), v3(0, 10, 0),
             lab_material(l, "diffuse", "reflectance=1"));
}

static void darkness(void)
{
    Mesh m = { 0 };
    Lab l;

    begin_dark(&l);
    lab_build(&l);
    expect_black(&l, "no light");
    begin_dark(&l);
    lab_sky(&l, 8, 4, night, NULL);
    lab_build(&l);
    expect_black(&l, "a black sky");
    begin_dark(&l);
    lab_light(&l, "point", "I=0", NULL);
    lab_light(&l, "infinite", "L=0", NULL);
    lab_shine(&l, lab_quad(&l, v3(-1, -1, 2), v3(0, 2, 0), v3(2, 0, 0), 0), "L=0");
    lab_build(&l);
    expect_black(&l, "lights of power 0");
    begin_dark(&l);
    lab_shine(&l, lab_quad(&l, v3(-1, -1, 2), v3(0, 2, 0), v3(0, 1, 0), 0), "L=1");
    lab_shine(&l, lab_mesh(&l, &m, 0, false), "L=1");
    lab_build(&l);
    expect_black(&l, "lights of area 0");
}

/* ---- resampling by itself ---- */

/* The sharing out of tentative samples. */
static void shares(void)
{
    static const struct { int m; float share; int light; } s[] = {
        { 8, 0.5f, 4 }, { 1, 0.5f, 1 }, { 1, 0, 0 }, { 2, 0.01f, 1 }, { 2, 0.99f, 1 },
        { 8, 1, 8 }, { 8, 0, 0 }, { 64, 0.25f, 16 }
    };
    for (size_t i = 0; i < sizeof s / sizeof s[0]; i++) {
        Resampling r = resampling_of(s[i].m, 1, s[i].share);
        EXPECT(r.by_light == s[i].light && r.by_light + r.by_scattering == s[i].m,
               "%d by %g: %d and %d", s[i].m, (double)s[i].share, r.by_light, r.by_scattering);
    }
}

/* The more tentative samples, the less noise; and what is kept in eight is nearly what a plain
 * estimate has with as many rays, where nothing is hidden and the product is what varies. */
static double variance_of(Lab *l, const char *method)
{
    Ray r = ray_towards(v3(-0.9f, -0.7f, 0.8f), v3(0.05f, 0.02f, 0));
    Gauge g = { ray_fixed, NULL, 8192, 43, 0 };
    const Stat *s;
    Meter m;

    g.of = &r;
    lab_open(l, method);
    lab_measure(l, &g, &m);
    s = meter_radiance(&m);
    return s->squares / (s->n - 1) / (s->mean * s->mean);
}

static void resampling_pays(void)
{
    double one, four, sixteen, many;
    uint32_t black;
    Lab l;

    lab_init(&l);
    black = lab_material(&l, "diffuse", "reflectance=0");
    lab_quad(&l, v3(-4, -5, 0), v3(10, 0, 0), v3(0, 10, 0),
             lab_material(&l, "phong", "reflectance=0.2,specular=0.7,exponent=40"));
    lab_shine(&l, lab_quad(&l, v3(-3, -3, 2), v3(0, 6, 0), v3(6, 0, 0), black), "L=1");
    lab_build(&l);
    one = variance_of(&l, "direct:strategy=ris,lightshare=1,tentative=1,samples=1");
    four = variance_of(&l, "direct:strategy=ris,lightshare=1,tentative=4,samples=1");
    sixteen = variance_of(&l, "direct:strategy=ris,lightshare=1,tentative=16,samples=1");
    many = variance_of(&l, "direct:strategy=ris,lightshare=1,tentative=16,samples=8");
    EXPECT(four < 0.35 * one && sixteen < 0.35 * four,
           "relative variances %.3g, %.3g, %.3g: each should be a quarter", one, four, sixteen);
    EXPECT(many < 1.1 * sixteen, "keeping more: %.3g, against %.3g", many, sixteen);
    lab_clear(&l);
}

const TestCase test_direct[] = {
    { "lamps", lamps, false },
    { "balls", balls, false },
    { "sky", sky, false },
    { "many", many, false },
    { "mirrors_and_fog", mirrors_and_fog, false },
    { "ward", ward, false },
    { "eclipse", eclipse, false },
    { "darkness", darkness, false },
    { "shares", shares, false },
    { "resampling_pays", resampling_pays, false },
    { NULL, NULL, false }
};
