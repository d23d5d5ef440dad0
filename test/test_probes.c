/* test_probes.c -- probes taken and used: a mirror ball under a sky of known directions is
 * photographed as panorama.h says, and the photograph, lit by, is that sky again; so is an angular
 * map made of it, and the panorama that a spherical camera writes from under each. */
#include "image/image.h"
#include "sampling/warp.h"
#include "scene/scene.h"
#include "test/cli_help.h"
#include "test/scene_help.h"

#include <math.h>
#include <stdio.h>

enum { SIDE = 192 };

/* A sky whose colour tells the direction. */
static Rgb truth(V3 d)
{
    return rgb(1.5f + 1.2f * d.x, 1.5f + 1.2f * d.y, 1.5f + 1.2f * d.z);
}

/* In latitude and longitude, by the formula and not by panorama.c. */
static void write_sky(void)
{
    Image im;

    REQUIRE(image_init(&im, 256, 128), "memory");
    for (uint32_t y = 0; y < im.h; y++)
        for (uint32_t x = 0; x < im.w; x++) {
            double phi = 2 * PI * (x + 0.5) / im.w, theta = PI * (y + 0.5) / im.h;
            *image_at(&im, x, y) = truth(v3((float)(sin(theta) * cos(phi)),
                                            (float)(sin(theta) * sin(phi)), (float)cos(theta)));
        }
    REQUIRE(image_write(&im, cli_path("sky.pfm"), NULL), "sky.pfm");
    image_clear(&im);
}

/* The camera is far away at -x, its right is +y and its upright z. Rays that pass the ball see the
 * sky behind it: the picture is the square about the ball. */
static void photograph(void)
{
    cli_write_text("ball.pbrt",
                   "LookAt -50 0 0  0 0 0  0 0 1\nCamera \"orthographic\"\n"
                   "Film \"image\" \"integer xresolution\" 192 \"integer yresolution\" 192\n"
                   "Integrator \"path\" \"integer maxdepth\" 3\nWorldBegin\n"
                   "LightSource \"infinite\" \"string filename\" \"sky.pfm\" "
                   "\"string mapping\" \"latlong\"\n"
                   "Material \"mirror\" \"rgb reflectance\" [1 1 1]\nShape \"sphere\"\n");
    CLI_WORKS("ball.pbrt --quiet --filter box --spp 4 -o ball.pfm");
}

/* At each radius r of an angular map is what a ball has at sin(r pi / 2). */
static void write_angular(void)
{
    Image ball, im;

    REQUIRE(image_read(&ball, cli_path("ball.pfm"), IMAGE_PIXELS_DEFAULT), "ball.pfm");
    REQUIRE(image_init(&im, SIDE, SIDE), "memory");
    for (uint32_t y = 0; y < SIDE; y++)
        for (uint32_t x = 0; x < SIDE; x++) {
            double u = (2 * x + 1.0) / SIDE - 1, v = (2 * y + 1.0) / SIDE - 1, r = hypot(u, v);
            double k = r > 0 && r < 1 ? sin(r * PI / 2) / r : 1;
            *image_at(&im, x, y) = *image_at(&ball, (uint32_t)((1 + k * u) / 2 * SIDE),
                                             (uint32_t)((1 + k * v) / 2 * SIDE));
        }
    REQUIRE(image_write(&im, cli_path("angular.pfm"), NULL), "angular.pfm");
    image_clear(&ball);
    image_clear(&im);
}

/* The sky again, by direction; up to 145 degrees from the camera, where a pixel of the ball is a
 * step of 2 / 192 over cos(72.5) in the half angle: 4 degrees, or 0.09 in colour. */
static void check(const char *name, const char *mapping)
{
    char text[300];
    SceneFile f;
    double worst = 0;

    snprintf(text, sizeof text, "WorldBegin LightSource \"infinite\" \"string filename\" \"%s\" "
             "\"string mapping\" \"%s\"", cli_path(name), mapping);
    f = scene_of(text, 0);
    for (int i = 0; i < 64; i++) {
        V2 u = { ((float)(i % 8) + 0.5f) / 8, ((float)(i / 8) + 0.5f) / 8 };
        V3 d = warp_sphere(u);
        const Light *l = f.scene->lights[0];
        Rgb is, want = truth(d);
        if (i == 0) {
            Opts o;
            opts_default(&o, accels[0]->info.options);
            REQUIRE(scene_build(f.scene, accels[0], &o, 1), "build");
        }
        if (-d.x < -0.82f)
            continue;
        is = rgb_sub(l->kind->radiance(l, d, NULL), want);
        worst = d_max(worst, d_max(fabs(is.r), d_max(fabs(is.g), fabs(is.b))));
    }
    EXPECT(worst < 0.09, "%s: colours of directions are off by %g", name, worst);
    scenefile_clear(&f);
}

/* What a spherical camera sees, which is a panorama in latitude and longitude. */
static void panorama(const char *name, const char *mapping, const char *out)
{
    char text[500];

    snprintf(text, sizeof text, "Transform [1 0 0 0  0 0 1 0  0 1 0 0  0 0 0 1]\n"
             "Camera \"spherical\" \"string mapping\" \"equirectangular\"\n"
             "Film \"image\" \"integer xresolution\" 256 \"integer yresolution\" 128\n"
             "WorldBegin\nLightSource \"infinite\" \"string filename\" \"%s\" "
             "\"string mapping\" \"%s\"\n", name, mapping);
    cli_write_text("around.pbrt", text);
    CLI_WORKS("around.pbrt --quiet --filter box --spp 4 -o %s", out);
}

static void round_trip(void)
{
    write_sky();
    photograph();
    write_angular();
    check("sky.pfm", "latlong");
    check("ball.pfm", "mirrorball");
    check("angular.pfm", "angular");
    panorama("ball.pfm", "mirrorball", "a.pfm");
    check("a.pfm", "latlong");
    panorama("angular.pfm", "angular", "b.pfm");
    check("b.pfm", "latlong");
}

const TestCase test_probes[] = {
    { "round_trip", round_trip, false },
    { NULL, NULL, false }
};
