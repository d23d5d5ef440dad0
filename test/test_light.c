/* test_light.c -- light that comes from the lamps: light tracing against path tracing, for every
 * kind of lamp, camera and surface. */
#include "geometry/generate.h"
#include "test/lamp_help.h"

#include <stdio.h>
#include <string.h>

/* filter: what follows the method, or "". */
static void compare(Lab *l, const char *filter, uint32_t spp, double delta, const char *what)
{
    char method[2][80];
    Series path, light;

    snprintf(method[0], sizeof *method, "path:maxdepth=4,roulette=2%s", filter);
    snprintf(method[1], sizeof *method, "light:maxdepth=4,roulette=2%s", filter);
    series_render(l, &path, method[0], 32, spp, 1);
    series_render(l, &light, method[1], 32, 2 * spp, 2);
    series_expect_same(&light, &path, delta, what);
    series_clear(&path);
    series_clear(&light);
}

static void lamps(void)
{
    for (size_t i = 0; i < LAMPS; i++) {
        Lab l;
        lamp_scene(&l, lamp_names[i], "");
        compare(&l, "", 8, 0.06, lamp_names[i]);
        lab_clear(&l);
    }
}

/* Lens, parallel rays, all around; filters wider than a pixel. */
static void lenses(void)
{
    static const char *const names[][3] = {
        { "perspective", "lensradius=0.3,focaldistance=6", "" },
        { "perspective", "", "@@gaussian" },
        { "perspective", "lensradius=0.1,focaldistance=3", "@random@mitchell" },
        { "orthographic", "", "" },
        { "spherical", "", "" },
        { "environment", "", "" },
    };

    for (size_t i = 0; i < sizeof names / sizeof *names; i++) {
        Lab l;
        lab_init(&l);
        lamp_add(&l, "quad");
        lamp_add(&l, "point");
        lamp_things(&l);
        lab_camera_of(&l, names[i][0], v3(0.2f, -2.5f, 1.5f), v3(0, 0, 1), 60, names[i][1]);
        lab_build(&l);
        compare(&l, names[i][2], 24, 0.06, names[i][0]);
        lab_clear(&l);
    }
}

/* ---- what light does on its way ---- */

/* Through a ball of glass, whose caustic `path` finds by chance, for the lamp is large. */
static void caustic(void)
{
    Lab l;

    lab_init(&l);
    lamp_glass(&l);
    /* beside the ball, so that it is not seen */
    lab_camera(&l, v3(2.2f, -2.5f, 2), v3(1.6f, 0, 0), 24, "");
    lab_build(&l);
    compare(&l, "", 128, 0.06, "a ball of glass");
    lab_clear(&l);
}

/* A matt block within a tank of water, and a camera within it too: radiance is larger in there by
 * the square of the index, flux is not. Both ways through the surface are seen. */
static void tank(void)
{
    for (int inside = 0; inside < 2; inside++) {
        Mesh water;
        Lab l;
        lab_init(&l);
        lab_quad(&l, v3(-3, -3, 0.05f), v3(6, 0, 0), v3(0, 6, 0), lab_material(&l, "diffuse", ""));
        REQUIRE(mesh_box(&water, v3(-4, -4, -1), v3(4, 4, 1)), "memory");
        lab_mesh(&l, &water, lab_material(&l, "dielectric", "eta=1.33,roughness=0.4"), false);
        lamp_add(&l, "infinite");
        lab_camera(&l, inside ? v3(0, -2, 0.6f) : v3(0, -3, 3.5f), v3(0, 0, 0), 50, "");
        lab_build(&l);
        compare(&l, "", 32, inside ? 0.12 : 0.35, inside ? "within a tank" : "into a tank");
        lab_clear(&l);
    }
}

static const Texture *unseen(Lab *l)
{
    Texture *t = arena_take(&l->scene->arena, 1, sizeof *t);

    REQUIRE(t, "memory");
    t->kind = TEXTURE_CONSTANT;
    return t;
}

/* In fog that has a border, a lamp within it and one outside. */
static void fog(void)
{
    Medium m = { "", { 0.1f, 0.2f, 0.3f }, { 0.4f, 0.3f, 0.3f }, 0.4f };
    uint32_t index, border;
    Shape *s;
    Lab l;

    lab_init(&l);
    lamp_things(&l);
    lamp_add(&l, "point");
    lab_light(&l, "spot", "from=-5/-5/3,to=0/0/0,I=60,coneangle=20", NULL);
    REQUIRE(scene_add_medium(l.scene, &m, &index), "memory");
    border = lab_sphere(&l, v3(0, 0, 1), 3.9f, lab_material(&l, "diffuse", ""), false);
    l.scene->materials[l.scene->geometries[0].shapes[border].material].opacity = unseen(&l);
    s = &l.scene->geometries[0].shapes[border];
    s->separates = true;
    s->inside = index;
    s->outside = NO_MEDIUM;
    lab_camera(&l, v3(0.5f, -7, 3), v3(0, 0, 1), 45, "");
    lab_build(&l);
    compare(&l, "", 24, 0.15, "fog");
    lab_clear(&l);
}

/* ---- photons ---- */

/* Those that a wide lens catches. */
static void photons(void)
{
    Series path, counted;
    Lab l;

    lab_init(&l);
    lamp_add(&l, "quad");
    lamp_things(&l);
    lab_camera(&l, v3(0.5f, -7, 3), v3(0, 0, 1), 45, "lensradius=2,focaldistance=7");
    lab_build(&l);
    series_render(&l, &path, "path:maxdepth=4", 32, 8, 1);
    series_render(&l, &counted, "photons:maxdepth=4", 32, 96, 2);
    series_expect_same(&counted, &path, 0.2, "a wide lens");
    series_clear(&path);
    series_clear(&counted);
    lab_clear(&l);
}

/* Within a sphere that shines alike everywhere, the ball about a pinhole sees that everywhere. */
static void photons_on_a_ball(void)
{
    static const char *const kinds[] = { "environment", "perspective", "spherical" };

    for (int k = 0; k < 3; k++) {
        RenderSettings s;
        RenderReport report;
        Stat mean[2] = { { 0, 0, 0, 0, 0 }, { 0, 0, 0, 0, 0 } };
        Lab l;
        lab_init(&l);
        lab_shine(&l, lab_sphere(&l, v3(0, 0, 0), 10,
                                 lab_material(&l, "diffuse", "reflectance=0"), true), "L=1");
        lab_camera_of(&l, kinds[k], v3(0, 0, 0), v3(1, 0, 0), 90, "");
        lab_build(&l);
        picture_settings(&l, &s, "photons:ball=2", 8, 8, 4000);
        for (s.seed = 0; s.seed < 16; s.seed++) {
            Image im;
            Film film;
            double half[2] = { 0, 0 };
            picture_render(&l, &s, &film, &report);
            REQUIRE(image_init(&im, 8, 8), "memory");
            film_picture(&film, 0, &im);
            for (int i = 0; i < 64; i++)
                half[i / 32] += rgb_lum(im.pixels[i]) / 32;
            for (int h = 0; h < 2; h++)
                stat_add_block(&mean[h], half[h], 1, 0);
            image_clear(&im);
            film_clear(&film);
        }
        for (int h = 0; h < 2; h++)
            stat_expect(&mean[h], 1, 0.2, kinds[k]);
        lab_clear(&l);
    }
}

/* ---- the picture as a whole ---- */

/* Bytes do not depend on threads; parts by length and strategy add up to the picture. */
static void parts(void)
{
    static const char *const names[] = { "strategy:implicit=a.pfm", "strategy:lens=b.pfm",
                                        "length:1=c.pfm", "length:2=d.pfm", "length:3=e.pfm",
                                        "length:4=f.pfm", "length:5=g.pfm" };
    enum { AOVS = sizeof names / sizeof *names };
    Image part[1 + AOVS];
    RenderSettings s;
    RenderReport report;
    Film one, three;
    Lab l;

    lab_init(&l);
    lamp_add(&l, "quad");
    lamp_things(&l);
    lab_camera(&l, v3(0.5f, -7, 4), v3(0, 0, 2), 60, "");
    lab_build(&l);
    picture_settings(&l, &s, "light:maxdepth=4@zerotwo@gaussian", 40, 24, 3);
    for (int k = 0; k < AOVS; k++)
        REQUIRE(aov_parse(&s.aovs[k], names[k]), "%s", names[k]);
    s.naovs = AOVS;
    picture_render(&l, &s, &one, &report);
    EXPECT(report.spp == 3 && one.splats->shots == 40 * 24 * 3, "%g samples a pixel", report.spp);
    s.threads = 3;
    picture_render(&l, &s, &three, &report);
    EXPECT(films_equal(&one, &three), "threads change the picture");
    for (int k = 0; k <= AOVS; k++) {
        REQUIRE(image_init(&part[k], 40, 24), "memory");
        film_picture(&one, k, &part[k]);
    }
    for (int i = 0; i < 40 * 24; i++) {
        float all = part[0].pixels[i].g, strategies = 0, lengths = 0;
        for (int k = 1; k <= 2; k++)
            strategies += part[k].pixels[i].g;
        for (int k = 3; k <= AOVS; k++)
            lengths += part[k].pixels[i].g;
        EXPECT(fabsf(all - strategies) <= 1e-5f * all && fabsf(all - lengths) <= 1e-5f * all,
               "pixel %d: %g, by strategy %g, by length %g", i, all, strategies, lengths);
    }
    for (int k = 0; k <= AOVS; k++)
        image_clear(&part[k]);
    film_clear(&one);
    film_clear(&three);
    lab_clear(&l);
}

/* An error that was asked for is reached, as far as the estimate from passes can tell. */
static void error(void)
{
    RenderSettings s;
    RenderReport report;
    Image im, ref;
    double squares = 0, mean = 0;
    Film film;
    Lab l;

    lab_init(&l);
    lamp_add(&l, "quad");
    lamp_things(&l);
    lab_camera(&l, v3(0.5f, -7, 3), v3(0, 0, 1), 45, "");
    lab_build(&l);
    picture_settings(&l, &s, "light", 32, 32, 0);
    s.error = 0.1;
    picture_render(&l, &s, &film, &report);
    REQUIRE(image_init(&im, 32, 32) && image_init(&ref, 32, 32), "memory");
    film_picture(&film, 0, &im);
    film_clear(&film);
    picture_settings(&l, &s, "path", 32, 32, 512);
    picture_render(&l, &s, &film, &report);
    film_picture(&film, 0, &ref);
    film_clear(&film);
    for (int i = 0; i < 32 * 32; i++) {
        double d = (double)rgb_lum(im.pixels[i]) - rgb_lum(ref.pixels[i]);
        squares += d * d;
        mean += rgb_lum(ref.pixels[i]);
    }
    squares = sqrt(squares * 32 * 32) / mean;
    EXPECT(squares < 0.13 && squares > 0.04, "asked for 0.1, got %g", squares);
    image_clear(&im);
    image_clear(&ref);
    lab_clear(&l);
}

const TestCase test_light[] = {
    { "lamps", lamps, false },
    { "lenses", lenses, false },
    { "caustic", caustic, false },
    { "tank", tank, false },
    { "fog", fog, false },
    { "photons", photons, false },
    { "photons_on_a_ball", photons_on_a_ball, false },
    { "parts", parts, false },
    { "error", error, false },
    { NULL, NULL, false }
};
