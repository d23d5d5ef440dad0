/* twostage_help.h -- what the suites of two stage importance sampling share: pictures by several
 * ways that must agree, and the things in them. */
#ifndef TEST_TWOSTAGE_HELP_H
#define TEST_TWOSTAGE_HELP_H

#include "test/pictures.h"

#include <stdio.h>

typedef struct { const char *method; uint32_t spp; double delta; } Way;

/* Each way, up to one of no method, gives the pictures that `truth` gives. */
INLINE void ways_agree(Lab *l, uint32_t side, const char *truth, uint32_t spp, const Way *way,
                       const char *where)
{
    Series first, other;

    messages_quiet(true);
    series_render(l, &first, truth, side, spp, 300);
    for (uint64_t i = 0; way[i].method; i++) {
        char what[200];
        snprintf(what, sizeof what, "%s: %s", where, way[i].method);
        series_render(l, &other, way[i].method, side, way[i].spp, 301 + i);
        series_expect_same(&other, &first, way[i].delta, what);
        series_clear(&other);
    }
    series_clear(&first);
}

/* A glossy floor and a bright ball; `covered`: and another, and a wall that hides some light. */
INLINE void add_things(Lab *l, bool covered)
{
    lab_quad(l, v3(-3, -3, 0), v3(6, 0, 0), v3(0, 6, 0),
             lab_material(l, "phong", "reflectance=0.4/0.3/0.2,specular=0.4,exponent=30"));
    lab_sphere(l, v3(-0.7f, 0.2f, 0.6f), 0.6f, lab_material(l, "conductor", "roughness=0.3"),
               false);
    if (!covered)
        return;
    lab_sphere(l, v3(0.8f, -0.3f, 0.5f), 0.5f, lab_material(l, "orennayar", "sigma=30"), false);
    lab_quad(l, v3(-2, 1, 0), v3(4, 0, 0), v3(0, 0, 1.5f),
             lab_material(l, "diffuse", "reflectance=0.6"));
}

INLINE void add_eye(Lab *l)
{
    lab_camera(l, v3(0, -4, 2), v3(0, 0, 0.5f), 45, "");
    lab_build(l);
}

/* sigma/mu of a channel of what comes from one place of the floor. */
INLINE double noise_of(Lab *l, const char *method, int channel)
{
    Ray r = ray_towards(v3(-0.9f, -0.7f, 0.5f), v3(0.05f, 0.02f, 0));
    Gauge g = { ray_fixed, NULL, 1024, 17, 0 };
    Meter m;

    g.of = &r;
    lab_open(l, method);
    lab_measure(l, &g, &m);
    return stat_error(&meter_radiance(&m)[channel]) / meter_radiance(&m)[channel].mean;
}

INLINE Rgb sky_cloudy(V3 w)
{
    float c = f_max(0, 0.58f * w.x - 0.58f * w.y + 0.58f * w.z), bright = f_sqr(f_sqr(c));
    return rgb_scale(rgb(0.5f, 0.7f, 1), w.z > 0 ? 0.5f + 3 * bright : 0.05f);
}

#endif
