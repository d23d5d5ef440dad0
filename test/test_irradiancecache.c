/* test_irradiancecache.c -- pictures by the caches of irradiance and of radiance: closed rooms in
 * closed form, a matt room and rooms of other things against path tracing, what each option
 * does. */
#include "geometry/generate.h"
#include "test/pictures.h"

#include <stdio.h>
#include <string.h>

enum { SIDE = 96 };

/* ---- pictures ---- */

static Image picture_of(Lab *l, const char *method, uint32_t spp, uint64_t seed)
{
    RenderSettings s;
    RenderReport report;
    Image im;
    Film film;

    picture_settings(l, &s, method, SIDE, SIDE, spp);
    s.seed = seed;
    REQUIRE(image_init(&im, SIDE, SIDE), "memory");
    picture_render(l, &s, &film, &report);
    film_picture(&film, 0, &im);
    film_clear(&film);
    return im;
}

static double mean_of(const Image *im)
{
    double sum = 0;
    for (size_t i = 0; i < (size_t)im->w * im->h; i++)
        sum += rgb_lum(im->pixels[i]);
    return sum / ((double)im->w * im->h);
}

/* Of a against two truths with noise of their own, which adds nothing to the product of the
 * differences: its root, by luminance. */
static double difference(const Image *a, const Image *b, const Image *c)
{
    double squares = 0;
    for (size_t i = 0; i < (size_t)a->w * a->h; i++) {
        double v = (double)rgb_lum(a->pixels[i]);
        squares += (v - (double)rgb_lum(b->pixels[i])) * (v - (double)rgb_lum(c->pixels[i]));
    }
    return sqrt(d_max(squares, 0) / ((double)a->w * a->h));
}

/* ---- a room: two blocks, coloured walls, a lamp below the ceiling ---- */

/* The floor and the blocks are of the model. */
static void room(Lab *l, const char *model, const char *options)
{
    uint32_t grey, red, green, things;
    Mesh box;

    lab_init(l);
    grey = lab_material(l, "diffuse", "reflectance=0.7");
    things = lab_material(l, model, options);
    red = lab_material(l, "diffuse", "reflectance=0.7/0.2/0.2");
    green = lab_material(l, "diffuse", "reflectance=0.2/0.7/0.2");
    lab_quad(l, v3(-1, -1, 0), v3(2, 0, 0), v3(0, 2, 0), things);
    lab_quad(l, v3(-1, -1, 2), v3(0, 2, 0), v3(2, 0, 0), grey);
    lab_quad(l, v3(-1, 1, 0), v3(2, 0, 0), v3(0, 0, 2), grey);
    lab_quad(l, v3(-1, -1, 0), v3(0, 2, 0), v3(0, 0, 2), red);
    lab_quad(l, v3(1, -1, 0), v3(0, 0, 2), v3(0, 2, 0), green);
    REQUIRE(mesh_box(&box, v3(-0.7f, 0, 0.001f), v3(-0.1f, 0.6f, 1.1f)), "memory");
    lab_mesh(l, &box, things, false);
    REQUIRE(mesh_box(&box, v3(0.2f, -0.6f, 0.001f), v3(0.7f, -0.1f, 0.5f)), "memory");
    lab_mesh(l, &box, things, false);
    lab_shine(l, lab_quad(l, v3(-0.4f, -0.4f, 1.95f), v3(0, 0.8f, 0), v3(0.8f, 0, 0), grey),
              "L=8");
    lab_camera(l, v3(0, -3.4f, 1), v3(0, 0, 1), 40, "");
    lab_build(l);
}

/* The light that was scattered more than once: a picture less that of direct light by the same
 * numbers, so that the noise of that is not in it. options: "rays=9," */
static Image indirect(Lab *l, const char *method, const char *options, int maxdepth, uint32_t spp,
                      uint64_t seed, double *whole)
{
    char text[200];
    Image im, direct;

    snprintf(text, sizeof text, "%s:%smaxdepth=%d", method, options, maxdepth);
    im = picture_of(l, text, spp, seed);
    *whole = mean_of(&im);
    snprintf(text, sizeof text, "%s:%smaxdepth=1", method, options);
    direct = picture_of(l, text, spp, seed);
    for (size_t i = 0; i < (size_t)im.w * im.h; i++)
        im.pixels[i] = rgb_sub(im.pixels[i], direct.pixels[i]);
    image_clear(&direct);
    return im;
}

/* Light scattered more than once, by records and by path: how far off are the mean and pixels, of
 * the mean of all light? Each of the methods with options, as text for `indirect`, is a picture. */
typedef struct { const char *method, *options; uint32_t spp; } Way;
static void compare(Lab *l, const Way *ways, int n, int maxdepth, uint32_t spp, double *bias,
                    double *sigma)
{
    double whole, own;
    Image b = indirect(l, "path", "", maxdepth, spp, 1, &whole);
    Image c = indirect(l, "path", "", maxdepth, spp, 2, &own);

    for (int i = 0; i < n; i++) {
        Image a = indirect(l, ways[i].method, ways[i].options, maxdepth, ways[i].spp, 3, &own);
        bias[i] = (mean_of(&a) - 0.5 * (mean_of(&b) + mean_of(&c))) / whole;
        sigma[i] = difference(&a, &b, &c) / whole;
        image_clear(&a);
    }
    image_clear(&b);
    image_clear(&c);
}

/* Within 3 % sigma/mu of the truth, at default accuracy. */
static void matt_room(void)
{
    static const Way way = { "irradiancecache", "", 16 };
    double bias, sigma;
    Lab l;

    room(&l, "diffuse", "reflectance=0.7");
    compare(&l, &way, 1, 9, 32, &bias, &sigma);
    EXPECT(sigma < 0.03, "sigma/mu is %g", sigma);
    EXPECT(fabs(bias) < 0.005, "the mean is off by %g", bias);
    lab_clear(&l);
}

/* A glossy floor and glossy blocks: the mean is path's, and what is looked up has less noise than
 * what is followed. With steep lobes, which are followed but for their skirts, no more. */
static void glossy_room(void)
{
    static const char *const lobes[] = { "reflectance=0.2,specular=0.6,exponent=8",
                                         "reflectance=0,specular=0.8,exponent=40" };
    static const Way ways[] = { { "radiancecache", "", 2 }, { "irradiancecache", "", 2 } };

    for (int i = 0; i < 2; i++) {
        double bias[2], sigma[2];
        Lab l;
        room(&l, "phong", lobes[i]);
        compare(&l, ways, 2, 6, 16, bias, sigma);
        EXPECT(sigma[0] < 0.04 && sigma[0] < (i ? 1.1 : 0.9) * sigma[1],
               "%s: sigma/mu is %g, without lookup %g", lobes[i], sigma[0], sigma[1]);
        EXPECT(fabs(bias[0]) < 0.005, "%s: the mean is off by %g", lobes[i], bias[0]);
        lab_clear(&l);
    }
}

/* Fewer records, further apart: worse. With so many rays that noise is not
 * what differs. */
static void accuracy(void)
{
    static const Way ways[] = {
        { "irradiancecache", "rays=1000,minspacing=2,accuracy=0.15,", 16 },
        { "irradiancecache", "rays=1000,minspacing=2,accuracy=0.5,", 16 }
    };
    double bias[2], sigma[2];
    Lab l;

    room(&l, "diffuse", "reflectance=0.7");
    compare(&l, ways, 2, 2, 32, bias, sigma);
    EXPECT(sigma[0] < 0.7 * sigma[1], "accuracy 0.1 and 0.5 are off by %g and %g", sigma[0],
           sigma[1]);
    lab_clear(&l);
}

/* Each tile by itself makes records of its own: steps between tiles are larger than the mean step
 * from pixel to pixel. After the overture they are not. */
static void lazy(void)
{
    double step[2];
    Lab l;

    lab_init(&l);
    lab_quad(&l, v3(-1, -1, 0), v3(2, 0, 0), v3(0, 2, 0), lab_material(&l, "diffuse", ""));
    lab_quad(&l, v3(-1, 1, 0), v3(2, 0, 0), v3(0, 0, 2), lab_material(&l, "diffuse", ""));
    lab_shine(&l, lab_quad(&l, v3(-1, -3, 4), v3(0, 2, 0), v3(2, 0, 0),
                           lab_material(&l, "diffuse", "reflectance=0")), "L=8");
    lab_camera(&l, v3(0, -0.5f, 1.5f), v3(0, 0, 0), 40, "");
    lab_build(&l);
    for (int overture = 0; overture < 2; overture++) {
        double at = 0, within = 0;
        char method[100];
        Image im, plain = picture_of(&l, "irradiancecache:maxdepth=1@sobol", 32, 1);
        snprintf(method, sizeof method, "irradiancecache:maxdepth=2,rays=50,overture=%s@sobol",
                 overture ? "true" : "false");
        im = picture_of(&l, method, 32, 1);
        for (uint32_t y = 0; y < SIDE; y++)
            for (uint32_t x = 1; x < SIDE; x++) {
                double d = (double)rgb_lum(*image_at(&im, x, y)) -
                           (double)rgb_lum(*image_at(&plain, x, y)) -
                           (double)rgb_lum(*image_at(&im, x - 1, y)) +
                           (double)rgb_lum(*image_at(&plain, x - 1, y));
                if (x % FILM_TILE == 0)
                    at += d * d / (SIDE / FILM_TILE);
                else
                    within += d * d / (SIDE - 1 - SIDE / FILM_TILE);
            }
        step[overture] = sqrt(at / within);
        image_clear(&im);
        image_clear(&plain);
    }
    EXPECT(step[0] > 2.5, "tiles without an overture differ by %g of the usual steps", step[0]);
    EXPECT(step[1] < 1.8, "tiles after the overture differ by %g of the usual steps", step[1]);
    lab_clear(&l);
}

static void same_bytes(void)
{
    static const char *const methods[] = { "irradiancecache:rays=30", "radiancecache:rays=30",
                                           "irradiancecache:rays=30,overture=false" };
    Lab l;

    room(&l, "phong", "reflectance=0.4,specular=0.4,exponent=5");
    for (int i = 0; i < 3; i++) {
        RenderSettings s;
        RenderReport report;
        Film one, three;
        picture_settings(&l, &s, methods[i], 70, 50, 3);
        picture_render(&l, &s, &one, &report);
        s.threads = 3;
        picture_render(&l, &s, &three, &report);
        EXPECT(films_equal(&one, &three), "%s: other bytes with 3 threads", methods[i]);
        film_clear(&one);
        film_clear(&three);
    }
    lab_clear(&l);
}

/* ---- closed forms ---- */

/* A ball that shines with Le and reflects rho, seen from within: Le / (1 - rho). All but Le is by
 * records from 2 events on. */
static void furnace(void)
{
    static const char *const methods[] = {
        "irradiancecache:maxdepth=200,rays=200", "radiancecache:maxdepth=200,rays=200",
        "irradiancecache:maxdepth=200,rays=200,overture=false",
        "irradiancecache:maxdepth=200,rays=200,gradients=false,accuracy=1"
    };
    static const double truth[3] = { 1 / 0.9, 2 / 0.5, 4 / 0.2 };
    Lab l;

    lab_init(&l);
    lab_shine(&l, lab_sphere(&l, v3(0, 0, 0), 2, lab_material(&l, "diffuse",
                             "reflectance=0.1/0.5/0.8"), true), "L=1/2/4");
    lab_camera(&l, v3(0.5f, -1, 0.2f), v3(0, 0, 0), 90, "");
    lab_build(&l);
    for (int i = 0; i < 4; i++) {
        Image im = picture_of(&l, methods[i], 4, 3);
        for (int c = 0; c < 3; c++) {
            double sum = 0;
            for (int k = 0; k < SIDE * SIDE; k++)
                sum += c == 0 ? im.pixels[k].r : c == 1 ? im.pixels[k].g : im.pixels[k].b;
            sum /= SIDE * SIDE;
            EXPECT(fabs(sum / truth[c] - 1) < 0.02, "%s: %g, not %g", methods[i], sum, truth[c]);
        }
        image_clear(&im);
    }
    lab_clear(&l);
}

/* ---- other things ---- */

static void add_lamp(Lab *l)
{
    lab_shine(l, lab_quad(l, v3(-1, -1.5f, 3), v3(0, 2, 0), v3(2, 0, 0),
                          lab_material(l, "diffuse", "reflectance=0")), "L=6/5/4");
}

/* A ball of each of many materials over a floor and before a wall, beside a mirror: the mean is
 * that by path, and pixels are but for the noise of 16 samples that lobes and glass have. */
static void materials(void)
{
    static const char *const things[][2] = {
        { "orennayar", "reflectance=0.6,sigma=30" },
        { "phong", "reflectance=0.4,specular=0.4,exponent=20" },
        { "diffusetransmission", "reflectance=0.3,transmittance=0.5" },
        { "coateddiffuse", "reflectance=0.6" },
        { "dielectric", "" },
        { "conductor", "roughness=0.3" },
    };

    for (size_t i = 0; i < sizeof things / sizeof *things; i++) {
        const Way way = { "irradiancecache", "rays=300,minspacing=3,", 16 };
        double bias, sigma;
        Lab l;
        lab_init(&l);
        lab_quad(&l, v3(-2, -2, 0), v3(4, 0, 0), v3(0, 4, 0),
                 lab_material(&l, "diffuse", "reflectance=0.7/0.5/0.4"));
        lab_quad(&l, v3(-2, 1.5f, 0), v3(4, 0, 0), v3(0, 0, 3),
                 lab_material(&l, "diffuse", "reflectance=0.4/0.5/0.7"));
        lab_quad(&l, v3(1.2f, -1, 0), v3(0, 0, 2), v3(0.3f, 2, 0),
                 lab_material(&l, "conductor", "roughness=0"));
        lab_sphere(&l, v3(-0.2f, 0, 0.8f), 0.7f, lab_material(&l, things[i][0], things[i][1]),
                   false);
        add_lamp(&l);
        lab_camera(&l, v3(0, -4, 1.5f), v3(0, 0, 0.9f), 45, "");
        lab_build(&l);
        compare(&l, &way, 1, 6, 16, &bias, &sigma);
        EXPECT(fabs(bias) < 0.01, "%s: the mean is off by %g", things[i][0], bias);
        EXPECT(sigma < (i == 0 || i == 2 || i == 3 ? 0.06 : 0.13), "%s: pixels are off by %g",
               things[i][0], sigma);
        lab_clear(&l);
    }
}

/* Nothing that shines, nothing to see, no depth to speak of, one ray: no crash, and the right
 * picture where there is one. */
static void extremes(void)
{
    static const char *const methods[] = { "irradiancecache:rays=1", "irradiancecache:maxdepth=0",
                                           "irradiancecache:maxdepth=1",
                                           "irradiancecache:rays=1,overture=false",
                                           "irradiancecache:minspacing=1e6,maxspacing=0.01",
                                           "radiancecache:rays=1,bands=10",
                                           "radiancecache:sharpest=0",
                                           "irradiancecache:photons=9,caustics=9,neighbours=9" };
    Image im, truth;
    Lab l;

    for (int shapes = 0; shapes < 2; shapes++) {
        lab_init(&l);
        if (shapes)
            lab_quad(&l, v3(-1, -1, 0), v3(2, 0, 0), v3(0, 2, 0), lab_material(&l, "diffuse", ""));
        lab_camera(&l, v3(0, -2, 1), v3(0, 0, 0), 60, "");
        lab_build(&l);
        for (size_t i = 0; i < sizeof methods / sizeof *methods; i++) {
            im = picture_of(&l, methods[i], 1, 0);
            EXPECT(mean_of(&im) == 0, "%s: light from nowhere", methods[i]);
            image_clear(&im);
        }
        lab_clear(&l);
    }
    room(&l, "diffuse", "reflectance=0.7");
    im = picture_of(&l, "irradiancecache:maxdepth=1", 4, 1);
    truth = picture_of(&l, "path:maxdepth=1", 4, 1);
    EXPECT(fabs(mean_of(&im) / mean_of(&truth) - 1) < 1e-5, "direct light alone");
    image_clear(&im);
    image_clear(&truth);
    im = picture_of(&l, "irradiancecache:rays=1", 1, 0);
    EXPECT(mean_of(&im) > 0, "one ray");
    image_clear(&im);
    lab_clear(&l);
}

const TestCase test_irradiancecache[] = {
    { "matt_room", matt_room, false },
    { "glossy_room", glossy_room, false },
    { "accuracy", accuracy, false },
    { "lazy", lazy, false },
    { "same_bytes", same_bytes, false },
    { "furnace", furnace, false },
    { "materials", materials, false },
    { "extremes", extremes, false },
    { NULL, NULL, false }
};
