/* test_scenefile_lights.c -- lights as scene files of version 3 and 4 write them: which parameters
 * mean what, and what old names imply. */
#include "image/image.h"
#include "test/scene_help.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

static const Light *light_of(const SceneFile *f, size_t k) { return f->scene->lights[k]; }

static Rgb power_of(const SceneFile *f, size_t k)
{
    return light_of(f, k)->kind->power(light_of(f, k));
}

/* Red to the right, green downwards. */
static void picture(const char *name, uint32_t w, uint32_t h)
{
    static const Display none = { 0 };
    Image im;

    REQUIRE(image_init(&im, w, h), "memory");
    for (uint32_t y = 0; y < h; y++)
        for (uint32_t x = 0; x < w; x++)
            *image_at(&im, x, y) = rgb((float)x, (float)y, 1);
    REQUIRE(image_write(&im, scene_write(name, ""), &none), "%s", name);
    image_clear(&im);
}

static SceneFile lights_of(const char *text, unsigned warnings, size_t n)
{
    const AccelKind *k = kind_find(accels, ACCEL_DEFAULT);
    SceneFile f = scene_of(text, warnings);
    Opts o;

    opts_default(&o, k->info.options);
    REQUIRE(scene_build(f.scene, k, &o, 1), "the scene was not built");
    REQUIRE(f.scene->nlights == n, "%d lights", (int)f.scene->nlights);
    return f;
}

/* Towards the light, from 1 away in direction d. */
static Rgb shone(const SceneFile *f, size_t k, V3 d)
{
    LightSample s;
    if (!light_of(f, k)->kind->sample(light_of(f, k), v_unit(d), (V2){ 0, 0 }, &s))
        return rgb_all(0);
    return s.L;
}

static bool is(Rgb c, float r, float g, float b)
{
    return fabsf(c.r - r) <= 1e-4f * (1 + r) && fabsf(c.g - g) <= 1e-4f * (1 + g) &&
           fabsf(c.b - b) <= 1e-4f * (1 + b);
}

/* mapname is version 3: 45 degrees, and latlong whatever its shape; filename is version 4. */
static void projections(void)
{
    SceneFile f;
    Rgb a, b, c;

    picture("wide.pfm", 8, 4);
    f = lights_of("WorldBegin LightSource \"projection\" \"string mapname\" \"wide.pfm\"\n"
                  "LightSource \"projection\" \"string filename\" \"wide.pfm\" \"float fov\" 45\n"
                  "LightSource \"projection\" \"string filename\" \"wide.pfm\" \"rgb I\" [2 2 2]\n"
                  "LightSource \"projection\" \"string filename\" \"wide.pfm\" \"float fov\" 90 "
                  "\"float scale\" 2\n"
                  "LightSource \"projection\" \"float power\" 12 \"float fov\" 20", 0, 5);
    a = power_of(&f, 0);
    b = power_of(&f, 1);
    EXPECT(is(a, b.r, b.g, b.b), "45 degrees");
    b = power_of(&f, 2);
    c = power_of(&f, 3);
    EXPECT(is(b, c.r, c.g, c.b) && c.b > 4 * a.b, "90 degrees");
    /* tan 45 = 1 above and below, 2 to the sides; x to the right of the picture, y down */
    EXPECT(is(shone(&f, 2, v3(0.1f, 0.1f, 1)), 8, 4, 2) &&
           is(shone(&f, 2, v3(-1.9f, -0.9f, 1)), 0, 0, 2) &&
           is(shone(&f, 2, v3(1.9f, -0.9f, 1)), 14, 0, 2) &&
           is(shone(&f, 2, v3(-1.9f, 0.9f, 1)), 0, 6, 2), "where the picture is");
    EXPECT(rgb_black(shone(&f, 2, v3(2.1f, 0, 1))) && rgb_black(shone(&f, 2, v3(0, 1.1f, 1))) &&
           rgb_black(shone(&f, 2, v3(0, 0, -1))), "beside the beam");
    a = power_of(&f, 4);
    EXPECT(fabsf(rgb_lum(a) - 12) < 1e-3f, "%g W", (double)rgb_lum(a));
    EXPECT(is(shone(&f, 4, v3(0.1f, 0.1f, 1)), shone(&f, 4, v3(0, 0, 1)).r, a.g / a.r *
              shone(&f, 4, v3(0, 0, 1)).r, shone(&f, 4, v3(0, 0, 1)).b), "white");
    scenefile_clear(&f);
}

static void goniometric(void)
{
    SceneFile f;

    picture("square.pfm", 4, 4);
    f = lights_of("WorldBegin LightSource \"goniometric\" \"string mapname\" \"square.pfm\"\n"
                  "LightSource \"goniometric\" \"string filename\" \"square.pfm\"\n"
                  "LightSource \"goniometric\" \"rgb I\" [3 4 5] \"float power\" 9\n"
                  "AttributeBegin Translate 0 0 5 Rotate 90 1 0 0\nLightSource \"goniometric\" "
                  "\"string filename\" \"square.pfm\" \"string mapping\" \"latlong\"\n"
                  "AttributeEnd", 0, 4);
    /* latlong: the pole is y, x the first meridian, then z */
    EXPECT(is(shone(&f, 0, v3(1, 3, 0.1f)), 0, 0, 1) &&
           is(shone(&f, 0, v3(1, -3, 0.1f)), 0, 3, 1) &&
           is(shone(&f, 0, v3(0.1f, 0.1f, -1)), 3, 1, 1), "latlong");
    /* octahedral: y in the middle, x to the right, z down */
    EXPECT(is(shone(&f, 1, v3(1, 9, 1)), 2, 2, 1) && is(shone(&f, 1, v3(9, 1, 1)), 3, 2, 1) &&
           is(shone(&f, 1, v3(-1, -9, 1)), 0, 3, 1), "octahedral");
    EXPECT(fabsf(rgb_lum(power_of(&f, 2)) - 9) < 1e-3f &&
           is(power_of(&f, 2), 0.75f * power_of(&f, 2).g, power_of(&f, 2).g,
              1.25f * power_of(&f, 2).g), "power without a picture");
    {                           /* y of the light is z of the world */
        LightSample s;
        EXPECT(light_of(&f, 3)->kind->sample(light_of(&f, 3), v3(0.1f, 0, 7), (V2){ 0, 0 }, &s) &&
               is(rgb_scale(s.L, s.dist * s.dist), 0, 0, 1), "turned and moved");
    }
    scenefile_clear(&f);
}

static Rgb sky_at(const SceneFile *f, size_t k, V3 d)
{
    return light_of(f, k)->kind->radiance(light_of(f, k), v_unit(d), NULL);
}

static void skies(void)
{
    double sum = 0;
    SceneFile f;

    picture("square.pfm", 4, 4);
    picture("wide.pfm", 8, 4);
    f = lights_of("WorldBegin LightSource \"infinite\" \"string mapname\" \"square.pfm\"\n"
                  "LightSource \"infinite\" \"string filename\" \"square.pfm\" \"float scale\" 2\n"
                  "LightSource \"infinite\" \"string filename\" \"square.pfm\" \"string mapping\" "
                  "\"angular\"\n"
                  "LightSource \"infinite\" \"string filename\" \"square.pfm\" \"string mapping\" "
                  "\"mirrorball\"\n"
                  "LightSource \"infinite\" \"float illuminance\" 7\n"
                  "LightSource \"infinite\" \"string filename\" \"wide.pfm\" \"float illuminance\" "
                  "7\nLightSource \"infinite\" \"integer nsamples\" 4 \"float portal\" [1 2]",
                  1, 7);
    EXPECT(is(sky_at(&f, 0, v3(1, 0.1f, 3)), 0, 0, 1) &&
           is(sky_at(&f, 0, v3(1, -0.1f, -3)), 3, 3, 1), "mapname is latlong");
    EXPECT(is(sky_at(&f, 1, v3(1, 1, 9)), 4, 4, 2) && is(sky_at(&f, 1, v3(9, -1, 1)), 6, 2, 2),
           "a square is octahedral");
    /* centre -x, right +y, top +z; at 80 degrees the mirror ball is farther out */
    EXPECT(is(sky_at(&f, 2, v3(-9, 1, 1)), 2, 1, 1) && is(sky_at(&f, 2, v3(-0.17f, -0.98f, -0.1f)),
              1, 2, 1), "angular");
    EXPECT(is(sky_at(&f, 3, v3(-9, 1, 1)), 2, 1, 1) && is(sky_at(&f, 3, v3(-0.17f, -0.98f, -0.1f)),
              0, 2, 1), "mirror ball");
    EXPECT(fabsf(rgb_lum(sky_at(&f, 4, v3(1, 2, 3))) * PI_F - 7) < 1e-3f,
           "illuminance of a constant sky");
    for (int i = 0; i < 400 * 200; i++) {
        float c = sqrtf(((float)(i % 200) + 0.5f) / 200), s = sqrtf(1 - c * c);
        float phi = 2 * PI_F * ((float)(i / 200) + 0.5f) / 400;
        sum += PI / 80000 * (double)rgb_lum(sky_at(&f, 5, v3(s * m_cos(phi), s * m_sin(phi), c)));
    }
    EXPECT(fabs(sum - 7) < 0.01, "illuminance of a picture: %g", sum);
    scenefile_clear(&f);
}

/* The lamp's picture is over (u, v), its first row at v = 1. */
static void areas(void)
{
    static const V3 place[4] = { { 0.5f, 3.5f, 0 }, { 3.5f, 3.5f, 0 }, { 0.5f, 0.5f, 0 },
                                 { 3.5f, 0.5f, 0 } };
    SceneFile f;

    picture("square.pfm", 4, 4);
    f = lights_of("WorldBegin AreaLightSource \"diffuse\" \"string filename\" \"square.pfm\" "
                  "\"float exponent\" 2\nShape \"trianglemesh\" \"point3 P\" "
                  "[0 0 0 4 0 0 4 4 0 0 4 0] \"integer indices\" [0 1 2 0 2 3] \"point2 uv\" "
                  "[0 0 1 0 1 1 0 1]", 0, 1);
    for (int k = 0; k < 4; k++) {
        V3 eye = v_add(place[k], v3(3, 0, 4));
        Ray r = { .o = eye, .d = v3(-0.6f, 0, -0.8f), .tmax = INFINITY };
        Surface s;
        Rgb L;
        Hit h;
        REQUIRE(accel_nearest(f.scene->accel, &r, &h), "missed");
        accel_surface(f.scene->accel, &r, &h, &s);
        L = light_of(&f, 0)->kind->radiance(light_of(&f, 0), r.d, &s);
        EXPECT(is(L, k % 2 ? 3 * 0.64f : 0, k / 2 ? 3 * 0.64f : 0, 0.64f), "place %d: %g %g %g", k,
               (double)L.r, (double)L.g, (double)L.b);
    }
    /* mean (1.5, 1.5, 1), area 16, integral of cos^3 pi / 2 */
    EXPECT(is(power_of(&f, 0), 12 * PI_F, 12 * PI_F, 8 * PI_F), "power %g",
           (double)power_of(&f, 0).r);
    scenefile_clear(&f);
}

/* Of a lamp behind a mask only what is left of it shines, and a power that is asked for is that of
 * what is left: of 64 squares every second, on half of the picture's width. */
static void masks(void)
{
    static const char text[] = "WorldBegin\nTexture \"holes\" \"float\" \"checkerboard\" "
        "\"float uscale\" 8 \"float vscale\" 8 \"float tex1\" 1 \"float tex2\" 0.5\n"
        "AreaLightSource \"diffuse\" \"rgb L\" [1 2 3] %s\n"
        "Shape \"trianglemesh\" \"point3 P\" [0 0 0 4 0 0 4 4 0 0 4 0] \"integer indices\" "
        "[0 1 2 0 2 3] \"point2 uv\" [0 0 .5 0 .5 1 0 1] \"texture alpha\" \"holes\"";
    char with[700];
    SceneFile f;

    snprintf(with, sizeof with, text, "");
    f = lights_of(with, 0, 1);
    EXPECT(is(power_of(&f, 0), 12 * PI_F, 24 * PI_F, 36 * PI_F), "power %g, not %g",
           (double)power_of(&f, 0).r, 12 * PI);
    scenefile_clear(&f);
    snprintf(with, sizeof with, text, "\"float power\" 20");
    f = lights_of(with, 0, 1);
    EXPECT(fabsf(rgb_lum(power_of(&f, 0)) - 20) < 1e-3f, "power %g, not 20",
           (double)rgb_lum(power_of(&f, 0)));
    scenefile_clear(&f);
}

const TestCase test_scenefile_lights[] = {
    { "projections", projections, false },
    { "goniometric", goniometric, false },
    { "skies", skies, false },
    { "areas", areas, false },
    { "masks", masks, false },
    { NULL, NULL, false }
};
