/* test_mlt.c -- chains of explicit paths, and energy that flows along them, against path tracing:
 * scenes with every kind of lamp, camera and surface, and every rule of flow. Errors are those of
 * independent runs, so chains may be as correlated as they like. */
#include "test/lamp_help.h"

#include <stdio.h>
#include <string.h>

/* ---- scenes ---- */

/* A ball of glass over a floor: its caustic, also as a mirror shows it. */
static void add_ball(Lab *l)
{
    lab_quad(l, v3(-3, -3, 0), v3(6, 0, 0), v3(0, 6, 0), lab_material(l, "diffuse", ""));
    lab_quad(l, v3(-3, 3, 0), v3(6, 0, 0), v3(0, 0, 3), lab_material(l, "mirror", ""));
    lab_sphere(l, v3(0, 0, 1.2f), 1, lab_material(l, "dielectric", ""), false);
    lab_shine(l, lab_disk(l, v3(-3, 0, 4.5f), v3(0.67f, 0, -0.74f), 2, 0,
                          lab_material(l, "diffuse", "reflectance=0")), "L=3/2/1");
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

typedef struct {
    const char *name, *lamps[2];
    void (*add)(Lab *l);
    const char *camera, *options, *filter;
    V3 eye, at;
    float fov;
} Scenery;

static const Scenery settings[] = {
    { "a quad", { "quad", NULL }, lamp_things, "perspective", "", "",
      { 0.5f, -7, 3 }, { 0, 0, 1 }, 45 },
    { "a ball of glass", { NULL, NULL }, add_ball, "perspective", "", "",
      { 1.2f, -4.5f, 2.5f }, { 0.6f, 0, 0.6f }, 45 },
    { "points, a lens", { "point", "ball" }, lamp_things, "perspective",
      "lensradius=0.3,focaldistance=6", "", { 0.5f, -7, 3 }, { 0, 0, 1 }, 45 },
    { "the sky, a wide filter", { "infinite", "distant" }, lamp_things, "perspective", "",
      "@@gaussian", { 0.5f, -7, 3 }, { 0, 0, 1 }, 45 },
    { "a picture, all around", { "picture", NULL }, lamp_things, "environment", "", "",
      { 0.2f, -2.5f, 1.5f }, { 0, 0, 1 }, 60 },
    { "a spot, parallel rays", { "spot", "quad" }, lamp_things, "orthographic", "", "",
      { 0.2f, -2.5f, 1.5f }, { 0, 0, 1 }, 60 },
    { "coats", { "infinite", NULL }, add_coats, "perspective", "", "@@mitchell",
      { 0.5f, -7, 3 }, { 0, 0, 1 }, 45 },
    { "a ball of glass, a lens", { "infinite", NULL }, add_ball, "orthographic",
      "lensradius=0.05,focaldistance=4", "", { 1.2f, -4.5f, 2.5f }, { 0.6f, 0, 0.6f }, 60 },
};
enum { SETTINGS = sizeof settings / sizeof *settings };

static void open_setting(Lab *l, const Scenery *s)
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

static void compare(const Scenery *s, const char *way, uint32_t spp, uint32_t path_spp,
                    double delta)
{
    char method[2][160], what[200];
    Series path, chains;
    Lab l;

    open_setting(&l, s);
    snprintf(method[0], sizeof *method, "path:maxdepth=4,roulette=2%s", s->filter);
    snprintf(method[1], sizeof *method, "%s,maxdepth=4,roulette=2%s", way, s->filter);
    snprintf(what, sizeof what, "%s, %s", s->name, way);
    series_render(&l, &path, method[0], 32, path_spp, 1);
    series_render(&l, &chains, method[1], 32, spp, 2);
    series_expect_same(&chains, &path, delta, what);
    series_clear(&path);
    series_clear(&chains);
    lab_clear(&l);
}

#define SHORT "chains=32,bootstrap=4096"

static void mlt(void)
{
    compare(&settings[0], "mlt:" SHORT ",direct=no,newpath=0.3", 12, 8, 0.1);
    compare(&settings[1], "mlt:" SHORT ",newpath=0.3", 24, 32, 0.2);
    compare(&settings[3], "mlt:" SHORT ",direct=no,newpath=0.3,square=9", 12, 8, 0.1);
}

static void erpt(void)
{
    compare(&settings[0], "erpt:direct=no,length=30,mutations=2", 6, 8, 0.15);
    compare(&settings[1], "erpt:length=30,mutations=2", 8, 24, 0.2);
    compare(&settings[2], "erpt:direct=no,flow=detailed,length=4", 3, 8, 0.15);
    compare(&settings[5], "erpt:direct=no,flow=iterated,length=4", 3, 8, 0.15);
}

/* Every way in every setting. */
static void all(void)
{
    static const struct { const char *way; uint32_t spp; } ways[] = {
        { "mlt:" SHORT ",direct=no,newpath=0.3", 24 },
        { "mlt:" SHORT ",direct=yes,newpath=0.1,lens=2,caustic=0.5", 16 },
        { "mlt:" SHORT ",direct=yes,newpath=0.3,square=9,most=0.5", 16 },
        { "erpt:direct=no", 8 }, { "erpt:direct=yes,length=30,mutations=3,square=0", 8 },
        { "erpt:direct=no,choice=exclusive,length=30", 8 },
        { "erpt:direct=no,flow=detailed,length=8", 4 },
        { "erpt:direct=yes,flow=iterated,length=16", 2 },
    };

    for (size_t i = 0; i < sizeof ways / sizeof *ways; i++)
        for (int k = 0; k < SETTINGS; k++)
            compare(&settings[k], ways[i].way, ways[i].spp, 32, 0.3);
}

const TestCase test_mlt[] = {
    { "mlt", mlt, false },
    { "erpt", erpt, false },
    { "all", all, true },
    { NULL, NULL, false }
};
