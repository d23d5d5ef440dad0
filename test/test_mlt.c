/* test_mlt.c -- chains of explicit paths, and energy that flows along them, against path tracing:
 * scenes with every kind of lamp, camera and surface, and every rule of flow. Errors are those of
 * independent runs, so chains may be as correlated as they like. */
#include "integrators/proposals.h"
#include "test/lamp_help.h"

#include <stdio.h>
#include <string.h>

/* ---- scenes ---- */

/* A ball of glass over a floor: its caustic, also as a mirror shows it. */
static void add_ball(Lab *l)
{
    lamp_glass(l);
    lab_quad(l, v3(-3, 3, 0), v3(6, 0, 0), v3(0, 0, 3), lab_material(l, "mirror", ""));
}

/* Both kinds of events at one vertex: a polished coat over a matt base, on a pane. */
static void add_coats(Lab *l)
{
    lab_quad(l, v3(-3, -3, 0), v3(6, 0, 0), v3(0, 6, 0),
             lab_material(l, "coateddiffuse", "reflectance=0.6,roughness=0"));
    lab_quad(l, v3(-2, 1, 0), v3(2.5f, 0, 0), v3(0, 0, 2),
             lab_material(l, "thindielectric", ""));
    lab_sphere(l, v3(1, 0, 1), 0.8f, lab_material(l, "conductor", "roughness=0.3"), false);
    lab_shine(l, lab_quad(l, v3(-1, -1, 4), v3(0, 2, 0), v3(2, 0, 0),
                          lab_material(l, "diffuse", "reflectance=0")), "L=4/5/6");
}

/* In air that takes light away, and water that takes more of it. */
static void add_tank(Lab *l)
{
    Medium air = { "", { 0.05f, 0.02f, 0.01f }, { 0, 0, 0 }, 0 },
           water = { "", { 0.5f, 0.3f, 0.2f }, { 0, 0, 0 }, 0 };
    uint32_t around = 0, within = 0, ball;
    Shape *s;

    REQUIRE(scene_add_medium(l->scene, &air, &around) &&
            scene_add_medium(l->scene, &water, &within), "memory");
    l->scene->around = around;
    add_ball(l);
    ball = lab_sphere(l, v3(1.7f, -0.5f, 0.5f), 0.5f, lab_material(l, "dielectric", "eta=1.33"),
                      false);
    s = &l->scene->geometries[0].shapes[ball];
    s->separates = true;
    s->inside = within;
    s->outside = around;
}

/* A ball of glass and a pane over a floor, and a wall: no lamp of its own. */
static void add_panes(Lab *l)
{
    uint32_t glass = lab_material(l, "dielectric", "");

    lab_quad(l, v3(-3, -3, 0), v3(6, 0, 0), v3(0, 6, 0), lab_material(l, "diffuse", ""));
    lab_quad(l, v3(-3, 3, 0), v3(6, 0, 0), v3(0, 0, 3),
             lab_material(l, "phong", "reflectance=0.3,specular=0.5,exponent=12"));
    lab_sphere(l, v3(0.3f, 0, 1.2f), 1, glass, false);
    lab_quad(l, v3(1, -1, 1.5f), v3(2, 0, 0.3f), v3(0, 2, 0),
             lab_material(l, "thindielectric", ""));
}

/* A point in a ball of glass, between a floor and a wall: all light comes through the glass. */
static void add_lantern(Lab *l)
{
    uint32_t matt = lab_material(l, "diffuse", "reflectance=0.4/0.5/0.6");

    lab_quad(l, v3(-3, -3, 0), v3(6, 0, 0), v3(0, 6, 0), matt);
    lab_quad(l, v3(-3, 2, 0), v3(6, 0, 0), v3(0, 0, 3), matt);
    lab_sphere(l, v3(0.6f, 0, 1), 0.5f, lab_material(l, "dielectric", ""), false);
    lab_light(l, "point", "from=0.5/0.1/1.1,I=9", NULL);
}

typedef struct {
    const char *name, *lamps[2];
    void (*add)(Lab *l);
    const char *camera, *options, *filter;
    V3 eye, at;
    float fov;
    const char *truth;          /* what misses none of the light; NULL: path */
} Scenery;

static const Scenery sceneries[] = {
    { "a quad", { "quad", NULL }, lamp_things, "perspective", "", "",
      { 0.5f, -7, 3 }, { 0, 0, 1 }, 45, NULL },
    { "a ball of glass", { NULL, NULL }, add_ball, "perspective", "", "",
      { 1.2f, -4.5f, 2.5f }, { 0.6f, 0, 0.6f }, 45, NULL },
    { "points, a lens", { "point", "ball" }, lamp_things, "perspective",
      "lensradius=0.3,focaldistance=6", "", { 0.5f, -7, 3 }, { 0, 0, 1 }, 45, NULL },
    { "the sky, a wide filter", { "infinite", "distant" }, lamp_things, "perspective", "",
      "@@gaussian", { 0.5f, -7, 3 }, { 0, 0, 1 }, 45, NULL },
    { "a picture, all around", { "picture", NULL }, lamp_things, "environment", "", "",
      { 0.2f, -2.5f, 1.5f }, { 0, 0, 1 }, 60, NULL },
    { "a spot, parallel rays", { "spot", "quad" }, lamp_things, "orthographic", "", "",
      { 0.2f, -2.5f, 1.5f }, { 0, 0, 1 }, 60, NULL },
    { "coats", { "infinite", NULL }, add_coats, "perspective", "", "@@mitchell",
      { 0.5f, -7, 3 }, { 0, 0, 1 }, 45, NULL },
    { "a ball of glass, a lens", { "infinite", NULL }, add_ball, "orthographic",
      "lensradius=0.05,focaldistance=4", "", { 1.2f, -4.5f, 2.5f }, { 0.6f, 0, 0.6f }, 60, NULL },
    { "media", { NULL, NULL }, add_tank, "perspective", "", "",
      { 1.2f, -4.5f, 2.5f }, { 0.6f, 0, 0.6f }, 45, NULL },
    /* what comes through the glass is found from the lamps alone */
    { "a point behind glass", { "point", "infinite" }, add_panes, "perspective",
      "lensradius=0.1,focaldistance=5", "", { 1.2f, -4.5f, 2.5f }, { 0.6f, 0, 0.6f }, 45, "bdpt" },
    { "the sun behind glass", { "distant", NULL }, add_panes, "orthographic", "", "@@mitchell",
      { 1.2f, -4.5f, 2.5f }, { 0.6f, 0, 0.6f }, 60, "bdpt" },
    { "a point in a ball", { "infinite", NULL }, add_lantern, "perspective", "", "@@mitchell",
      { 1.2f, -4.5f, 2.5f }, { 0.6f, 0, 0.6f }, 45, "bdpt" },
};
enum { SCENERIES = sizeof sceneries / sizeof *sceneries };

static void open_scenery(Lab *l, const Scenery *s)
{
    lab_init(l);
    for (int i = 0; i < 2; i++)
        if (s->lamps[i])
            lamp_add(l, s->lamps[i]);
    s->add(l);
    lab_camera_of(l, s->camera, s->eye, s->at, s->fov, s->options);
    lab_build(l);
}

/* ---- the same picture ---- */

static void render_path(Lab *l, const Scenery *s, uint32_t side, uint32_t spp, Series *path)
{
    char method[160];

    snprintf(method, sizeof method, "%s:maxdepth=4,roulette=2%s", s->truth ? s->truth : "path",
             s->filter);
    series_render(l, path, method, side, spp, 1);
}

static void expect_same(Lab *l, const Scenery *s, const char *way, uint32_t side, uint32_t spp,
                        const Series *path, double delta)
{
    char method[160], what[200];
    Series chains;

    snprintf(method, sizeof method, "%s,maxdepth=4,roulette=2%s", way, s->filter);
    snprintf(what, sizeof what, "%s, %s", s->name, way);
    series_render(l, &chains, method, side, spp, 2);
    series_expect_same(&chains, path, delta, what);
    series_clear(&chains);
}

static void compare(const Scenery *s, const char *way, uint32_t spp, uint32_t path_spp,
                    double delta)
{
    Series path;
    Lab l;

    open_scenery(&l, s);
    render_path(&l, s, 32, path_spp, &path);
    expect_same(&l, s, way, 32, spp, &path, delta);
    series_clear(&path);
    lab_clear(&l);
}

#define SHORT "chains=32,bootstrap=4096"

static void mlt(void)
{
    compare(&sceneries[0], "mlt:" SHORT ",direct=no,newpath=0.3", 3, 8, 0.1);
    compare(&sceneries[1], "mlt:" SHORT, 5, 24, 0.2);
    compare(&sceneries[3], "mlt:" SHORT ",direct=no,newpath=0.3,square=9", 3, 8, 0.1);
    compare(&sceneries[8], "mlt:" SHORT ",inner=1,lamps=no", 5, 24, 0.2);
    compare(&sceneries[9], "mlt:" SHORT ",newpath=0.2", 4, 8, 0.2);
    compare(&sceneries[10], "mlt:" SHORT ",direct=no,newpath=0.2", 4, 8, 0.2);
    compare(&sceneries[11], "mlt:" SHORT ",direct=no,newpath=0.2", 4, 8, 0.1);
}

static void erpt(void)
{
    compare(&sceneries[0], "erpt:direct=no,length=30,mutations=2,lamps=yes", 5, 8, 0.15);
    compare(&sceneries[1], "erpt:length=30,mutations=2,square=9", 6, 24, 0.2);
    compare(&sceneries[9], "erpt:length=30,mutations=2", 6, 8, 0.2);
    compare(&sceneries[10], "erpt:direct=no,length=30,mutations=2", 3, 8, 0.2);
    compare(&sceneries[11], "erpt:direct=no,length=10,mutations=2", 4, 8, 0.1);
    compare(&sceneries[2], "erpt:direct=no,flow=detailed,length=4,lamps=yes", 3, 8, 0.15);
    compare(&sceneries[5], "erpt:direct=no,flow=iterated,length=4,lamps=yes", 3, 8, 0.15);
}

/* Every way in every scenery, in pictures so small that 256 samples a pixel are enough for the
 * bound. By detailed and iterated flow each path that a sample finds is moved about, so their trees
 * are small. */
static void all(void)
{
    static const struct { const char *way; uint32_t spp; } ways[] = {
        { "mlt:" SHORT ",direct=no,newpath=0.3", 2 },
        { "mlt:" SHORT ",newpath=0.1,lens=2,caustic=0.5,inner=0.5", 2 },
        { "mlt:" SHORT ",square=9,most=0.5", 2 },
        { "erpt:direct=no,inner=1,lamps=yes", 2 },
        { "erpt:direct=no,choice=exclusive,length=30,lamps=yes", 2 },
        { "erpt:lamps=yes,length=30,mutations=3,square=9", 1 },
        { "erpt:flow=iterated,length=8,lamps=yes", 1 },
        { "erpt:direct=no,flow=detailed,length=8,lamps=yes", 2 },
        { "mlt:" SHORT ",direct=no,newpath=0.3,lamps=no", 2 },
        { "erpt:length=30,mutations=3,lamps=no", 1 },
        { "erpt:direct=no,flow=detailed,length=4,lamps=no", 1 },
        { "erpt:flow=iterated,length=4,lamps=no", 1 },
    };

    for (int k = 0; k < SCENERIES; k++) {
        Series path;
        Lab l;
        open_scenery(&l, &sceneries[k]);
        render_path(&l, &sceneries[k], 16, 16, &path);
        for (size_t i = 0; i < sizeof ways / sizeof *ways; i++)
            if (!sceneries[k].truth || !strstr(ways[i].way, "lamps=no"))
                expect_same(&l, &sceneries[k], ways[i].way, 16, ways[i].spp, &path, 0.6);
        series_clear(&path);
        lab_clear(&l);
    }
}

/* ---- what there is to see without light, and by filters ---- */

/* Nothing is found: a warning, and a black picture. */
static void darkness(void)
{
    static const char *const methods[] = { "mlt:" SHORT ",direct=no", "erpt:direct=no" };

    for (int i = 0; i < 2; i++) {
        unsigned before = warnings_count();
        RenderSettings s;
        RenderReport report;
        Film f;
        Image im;
        Lab l;
        lab_init(&l);
        lamp_things(&l);
        lab_light(&l, "point", "from=0/0/-1,I=9", NULL);        /* below the floor */
        lab_camera(&l, v3(0, 0, 5), v3(0, 0.1f, 0), 20, "");
        lab_build(&l);
        picture_settings(&l, &s, methods[i], 16, 16, 2);
        picture_render(&l, &s, &f, &report);
        REQUIRE(image_init(&im, 16, 16), "memory");
        film_picture(&f, 0, &im);
        for (int k = 0; k < 256; k++)
            EXPECT(rgb_black(im.pixels[k]), "pixel %d shines", k);
        EXPECT(i > 0 || warnings_count() == before + 1, "mlt says nothing of it");
        image_clear(&im);
        film_clear(&f);
        lab_clear(&l);
    }
}

/* Counts of a window and what they make of a picture: expected over counted, where there are
 * any. */
static void filter_of_proposals(void)
{
    static const uint32_t window[4] = { 2, 1, 7, 5 };
    static const int counts[4][5] = { { 1, 2, 3, 4, 5 }, { 9, 0, 1, 1, 2 }, { 5, 5, 5, 5, 5 },
                                      { 2, 7, 1, 8, 3 } };
    /* of the 3 x 3 square around the pixel (x, y), as far as it is in the window */
    static const struct { int x, y; double mean, median; } at[] = {
        { 0, 0, 3, 2 }, { 1, 1, 31.0 / 9, 3 }, { 4, 3, 21.0 / 4, 5 }, { 2, 2, 33.0 / 9, 5 }
    };

    for (int median = 0; median < 2; median++) {
        Proposals p = { .median = false };
        Film f;
        Image im;
        REQUIRE(film_init(&f, 10, 10, window, 1) && film_accepts_splats(&f) &&
                proposals_init(&p, &f, median, 3) && image_init(&im, 5, 4), "memory");
        for (int y = 0; y < 4; y++)
            for (int x = 0; x < 5; x++) {
                V2 place = { (float)x + 2.3f, (float)y + 1.9f };
                for (int k = 0; k < counts[y][x]; k++)
                    proposals_add(&p, place);
                film_splat(&f, &p.box, place, 1, rgb(1, 2, 4));
            }
        REQUIRE(proposals_even_out(&p, &f), "memory");
        film_picture(&f, 0, &im);
        for (size_t i = 0; i < sizeof at / sizeof *at; i++) {
            Rgb c = im.pixels[at[i].y * 5 + at[i].x];
            int n = counts[at[i].y][at[i].x];
            double want = n ? (median ? at[i].median : at[i].mean) / n : 1;
            EXPECT(fabs(c.r / want - 1) < 1e-6 && fabs(c.b / want - 4) < 1e-5,
                   "pixel %d,%d: %g, not %g", at[i].x, at[i].y, (double)c.r, want);
        }
        image_clear(&im);
        film_clear(&f);
        proposals_clear(&p);
    }
}

/* Both filters, together: little light is lost, and the rules say what is done when. */
static void both_filters(void)
{
    Series plain, filtered;
    double mean[2] = { 0, 0 };
    Lab l;

    open_scenery(&l, &sceneries[0]);
    series_render(&l, &plain, "erpt:maxdepth=3,mutations=8", 32, 2, 3);
    series_render(&l, &filtered, "erpt:maxdepth=3,mutations=8,even=box,repeats=20", 32,
                  2, 3);
    for (uint32_t k = 0; k < plain.tiles * RUNS; k++) {
        mean[0] += plain.tile[k];
        mean[1] += filtered.tile[k];
    }
    EXPECT(mean[1] != mean[0] && fabs(mean[1] / mean[0] - 1) < 0.1, "filters leave %g of %g",
           mean[1], mean[0]);
    series_clear(&plain);
    series_clear(&filtered);
    lab_clear(&l);
}

const TestCase test_mlt[] = {
    { "mlt", mlt, false },
    { "erpt", erpt, false },
    { "all", all, true },
    { "darkness", darkness, false },
    { "filter_of_proposals", filter_of_proposals, false },
    { "both_filters", both_filters, false },
    { NULL, NULL, false }
};
