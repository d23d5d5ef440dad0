/* lamp_help.c -- see lamp_help.h. */
#include "test/lamp_help.h"

#include "base/mem.h"
#include "geometry/generate.h"

#include <string.h>

const char *const lamp_names[LAMPS] = {
    "quad", "ball", "point", "spot", "distant", "infinite", "picture"
};

Rgb lamp_sky(V3 w)
{
    return w.x > 0.5f ? rgb(3, 2, 1) : w.z < -0.5f ? rgb_all(0) : rgb(0.2f, 0.3f, 0.6f);
}

void lamp_add(Lab *l, const char *lamp)
{
    uint32_t black = lab_material(l, "diffuse", "reflectance=0");

    if (!strcmp(lamp, "quad"))
        lab_shine(l, lab_quad(l, v3(-1, -1, 4), v3(0, 2, 0), v3(2, 0, 0), black), "L=4/5/6");
    else if (!strcmp(lamp, "ball"))
        lab_shine(l, lab_sphere(l, v3(-2, -1, 3), 0.5f, black, false), "L=8/6/4");
    else if (!strcmp(lamp, "point"))
        lab_light(l, "point", "from=1/-2/3,I=9", NULL);
    else if (!strcmp(lamp, "spot"))
        lab_light(l, "spot", "from=2/-2/4,to=0/0/0,I=40,coneangle=35,conedeltaangle=15", NULL);
    else if (!strcmp(lamp, "distant"))
        lab_light(l, "distant", "from=1/-1/2,to=0/0/0,L=2", NULL);
    else if (!strcmp(lamp, "infinite"))
        lab_light(l, "infinite", "L=0.5/0.7/1", NULL);
    else if (!strcmp(lamp, "picture"))
        lab_sky(l, 16, 8, lamp_sky, NULL);
    else
        REQUIRE(false, "no lamp %s", lamp);
}

void lamp_things(Lab *l)
{
    Mesh ball;

    lab_quad(l, v3(-3, -3, 0), v3(6, 0, 0), v3(0, 6, 0), lab_material(l, "diffuse",
                                                                     "reflectance=0.7/0.6/0.5"));
    lab_quad(l, v3(-3, 3, 0), v3(6, 0, 0), v3(0, 0, 3), lab_material(l, "diffuse",
                                                                    "reflectance=0.3/0.5/0.7"));
    lab_sphere(l, v3(1.2f, 0, 1), 0.9f, lab_material(l, "phong",
               "reflectance=0.3,specular=0.5,exponent=12"), false);
    REQUIRE(mesh_icosphere(&ball, 1), "memory");
    ball.n = MEM_ARRAY(V3, ball.nverts);
    REQUIRE(ball.n, "memory");
    memcpy(ball.n, ball.p, ball.nverts * sizeof *ball.p);
    mesh_move(&ball, 0.9f, v3(-1.2f, 0, 1));
    lab_mesh(l, &ball, lab_material(l, "diffuse", "reflectance=0.8"), false);
}

void lamp_scene(Lab *l, const char *lamp, const char *lens)
{
    lab_init(l);
    lamp_add(l, lamp);
    lamp_things(l);
    lab_camera(l, v3(0.5f, -7, 3), v3(0, 0, 1), 45, lens);
    lab_build(l);
}

void lamp_glass(Lab *l)
{
    lab_quad(l, v3(-3, -3, 0), v3(6, 0, 0), v3(0, 6, 0), lab_material(l, "diffuse", ""));
    lab_sphere(l, v3(0, 0, 1.2f), 1, lab_material(l, "dielectric", ""), false);
    lab_shine(l, lab_disk(l, v3(-3, 0, 4.5f), v3(0.67f, 0, -0.74f), 2, 0,
                          lab_material(l, "diffuse", "reflectance=0")), "L=3/2/1");
}
