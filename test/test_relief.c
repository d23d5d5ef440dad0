/* test_relief.c -- normals that surfaces have by pictures and not by their shape: bump maps and
 * normal maps, against the normals that follow from their definitions. */
#include "test/scene_help.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/* The frame normal of the world's first material at the middle of what a ray down from z = 9 meets
 * at (x, y). */
static V3 normal_at(SceneFile *f, float x, float y)
{
    Ray r = { .o = { x, y, 9 }, .d = { 0, 0, -1 }, .tmax = INFINITY };
    Surface s;
    Opts o;
    Hit h;

    opts_default(&o, accels[0]->info.options);
    REQUIRE(scene_build(f->scene, accels[0], &o, 1), "build");
    REQUIRE(accel_nearest(f->scene->accel, &r, &h), "nothing is there");
    accel_surface(f->scene->accel, &r, &h, &s);
    EXPECT(s.shape->plain == false, "(u, v) are left out");
    return material_frame(&f->scene->materials[s.shape->material], &s).n;
}

/* A square of side 4 about the origin; corners in the order 00, 10, 11, 01 of (u, v). */
#define SQUARE(uv) "Shape \"trianglemesh\" \"point3 P\" [-2 -2 0  2 -2 0  2 2 0  -2 2 0] " \
    "\"integer indices\" [0 1 2 0 2 3] \"point2 uv\" [" uv "]\n"
#define PLAIN "0 0 1 0 1 1 0 1"
#define TURNED "0 1 0 0 1 0 1 1"        /* u runs along y, v along -x */
#define FLIPPED "0 1 1 1 1 0 0 0"       /* v runs along -y */

static void expect_normal(const char *what, const char *material, const char *shape, V3 want)
{
    char text[1500];
    SceneFile f;
    V3 n;

    snprintf(text, sizeof text, "WorldBegin\n%s\n%s", material, shape);
    f = scene_of(text, 0);
    n = normal_at(&f, 0.3f, 0.9f);
    want = v_unit(want);
    EXPECT(v_near(n, want, 2e-5f), "%s: %g %g %g, not %g %g %g", what, (double)n.x, (double)n.y,
           (double)n.z, (double)want.x, (double)want.y, (double)want.z);
    scenefile_clear(&f);
}

/* Of one colour: x, y, z are 2 c / 255 - 1. */
static void normal_maps(void)
{
    static const char map[] = "Material \"diffuse\" \"string normalmap\" \"n.ppm\"\n";
    float x = 2 * 150 / 255.0f - 1, y = 2 * 90 / 255.0f - 1, z = 2 * 220 / 255.0f - 1;

    scene_write("n.ppm", "P3 1 1 255 150 90 220\n");
    expect_normal("plain", map, SQUARE(PLAIN), v3(x, y, z));
    expect_normal("turned", map, SQUARE(TURNED), v3(-y, x, z));
    expect_normal("flipped", map, SQUARE(FLIPPED), v3(x, y, z));
    expect_normal("reversed", map, "ReverseOrientation\n" SQUARE(PLAIN), v3(x, -y, -z));
    expect_normal("shading normals", map,
                  "Shape \"trianglemesh\" \"point3 P\" [-2 -2 0  2 -2 0  2 2 0  -2 2 0] "
                  "\"integer indices\" [0 1 2 0 2 3] \"point2 uv\" [" PLAIN "] "
                  "\"normal N\" [.6 0 .8 .6 0 .8 .6 0 .8 .6 0 .8]\n",
                  v_add(v_scale(v3(0.8f, 0, -0.6f), x), v_add(v_scale(v3(0, 1, 0), y),
                                                              v_scale(v3(0.6f, 0, 0.8f), z))));
    expect_normal("in a mixture", "MakeNamedMaterial \"a\" \"string type\" \"diffuse\" "
                  "\"string normalmap\" \"n.ppm\"\nMakeNamedMaterial \"b\" \"string type\" "
                  "\"conductor\"\nMaterial \"mix\" \"string materials\" [\"b\" \"a\"]\n",
                  SQUARE(PLAIN), v3(x, y, z));
    scene_write("n.ppm", "P3 1 1 255 255 128 100\n");           /* looks into the surface */
    expect_normal("below", map, SQUARE(PLAIN), v3(0, 0, 1));
}

/* A ramp of 0.3 over u, which is 4 long; and both at once: the ramp stands on the other normal. */
static void bumps(void)
{
    static const char ramp[] =
        "Texture \"ramp\" \"float\" \"bilerp\" \"float v00\" 0 \"float v01\" 0 "
        "\"float v10\" 0.3 \"float v11\" 0.3\n";
    char text[600];
    V3 n;

    snprintf(text, sizeof text, "%sMaterial \"diffuse\" \"texture displacement\" \"ramp\"\n", ramp);
    expect_normal("ramp", text, SQUARE(PLAIN), v3(-0.3f / 4, 0, 1));
    expect_normal("ramp, turned", text, SQUARE(TURNED), v3(0, -0.3f / 4, 1));
    expect_normal("ramp, reversed", text, "ReverseOrientation\n" SQUARE(PLAIN),
                  v3(-0.3f / 4, 0, -1));
    scene_write("n.ppm", "P3 1 1 255 128 168 255\n");
    snprintf(text, sizeof text, "%sMaterial \"diffuse\" \"texture displacement\" \"ramp\" "
             "\"string normalmap\" \"n.ppm\"\n", ramp);
    n = v_unit(v3(1 / 255.0f, 81 / 255.0f, 1));
    expect_normal("both", text, SQUARE(PLAIN),
                  v_mad(v_cross(n, v3(0, 4, 0)), 0.3f, v_scale(n, 16)));
}

const TestCase test_relief[] = {
    { "normal_maps", normal_maps, false },
    { "bumps", bumps, false },
    { NULL, NULL, false }
};
