/* test_physics_agree.c -- pictures by different strategies are the same but for noise.
 *
 * What no closed form covers: rooms with boxes and mirrors, glossy floors under lights of different
 * size, a picture of the sky with a lamp. Means of tiles of 8 x 8 pixels over 16 runs are
 * compared by Welch's test (Jung, Hanika, Dachsbacher 2020): a bias of a few percent in one
 * corner shows in the distribution of p long before it shows in any one pixel. */
#include "geometry/generate.h"
#include "test/pictures.h"

#include <stdio.h>

enum { SIDE = 64 };

typedef struct { const char *options; uint32_t spp; double delta; } Way;

/* Renders each way; all must agree with the first. */
static void expect_agreement(Lab *l, const Way *way, int n)
{
    Series first, other;

    lab_build(l);
    series_render(l, &first, way[0].options, SIDE, way[0].spp, 100);
    for (int i = 1; i < n; i++) {
        series_render(l, &other, way[i].options, SIDE, way[i].spp, 100 + (uint64_t)i);
        series_expect_same(&other, &first, way[i].delta, way[i].options);
        series_clear(&other);
    }
    series_clear(&first);
    lab_clear(l);
}

static void add_box(Lab *l, V3 centre, float side, uint32_t material)
{
    Mesh m = { 0 };
    REQUIRE(mesh_cube(&m), "cube");
    mesh_move(&m, side, centre);
    lab_mesh(l, &m, material, false);
}

/* A room of side 2, open towards the camera, with a broad lamp below the ceiling. */
static void room(void)
{
    static const Way ways[] = {
        { "strategy=mis,maxdepth=5", 8, 0.01 },
        { "strategy=explicit,maxdepth=5", 8, 0.01 },
        { "strategy=implicit,maxdepth=5", 32, 0.01 },
        { "strategy=mis,heuristic=balance,lightsampler=uniform,maxdepth=5,roulette=100", 8, 0.01 },
    };
    uint32_t white, red, green;
    Lab l;

    lab_init(&l);
    white = lab_material(&l, "diffuse", "reflectance=0.7");
    red = lab_material(&l, "diffuse", "reflectance=0.6/0.1/0.1");
    green = lab_material(&l, "diffuse", "reflectance=0.1/0.5/0.1");
    lab_quad(&l, v3(-1, -1, 0), v3(2, 0, 0), v3(0, 2, 0), white);
    lab_quad(&l, v3(-1, -1, 2), v3(0, 2, 0), v3(2, 0, 0), white);
    lab_quad(&l, v3(-1, 1, 0), v3(2, 0, 0), v3(0, 0, 2), white);
    lab_quad(&l, v3(-1, -1, 0), v3(0, 2, 0), v3(0, 0, 2), red);
    lab_quad(&l, v3(1, -1, 0), v3(0, 0, 2), v3(0, 2, 0), green);
    add_box(&l, v3(-0.4f, 0.3f, 0.3f), 0.6f, white);
    lab_sphere(&l, v3(0.45f, -0.1f, 0.35f), 0.35f, lab_material(&l, "mirror", "reflectance=0.8"),
               false);
    lab_shine(&l, lab_quad(&l, v3(-0.7f, -0.7f, 1.9f), v3(0, 1.4f, 0), v3(1.4f, 0, 0), white),
              "L=5/4/3");
    lab_camera(&l, v3(0, -3.5f, 1), v3(0, 0, 1), 42, "");
    expect_agreement(&l, ways, 4);
}

/* A glossy floor and a rough metal ball between a wide lamp and one a tenth of its size. */
static void glossy(void)
{
    static const Way ways[] = {
        { "strategy=mis,maxdepth=3", 32, 0.01 },
        { "strategy=explicit,maxdepth=3", 32, 0.01 },
        { "strategy=implicit,maxdepth=3", 64, 0.01 },
        { "strategy=mis,heuristic=balance,lightsampler=uniform,maxdepth=3", 32, 0.01 },
    };
    uint32_t black, metal;
    Lab l;

    lab_init(&l);
    black = lab_material(&l, "diffuse", "reflectance=0");
    metal = lab_material(&l, "conductor", "roughness=0.15");
    lab_quad(&l, v3(-3, -3, 0), v3(6, 0, 0), v3(0, 6, 0),
             lab_material(&l, "phong", "reflectance=0.3/0.2/0.1,specular=0.6,exponent=30"));
    lab_sphere(&l, v3(0, 0, 0.7f), 0.7f, metal, false);
    lab_shine(&l, lab_quad(&l, v3(-2, -1.5f, 2.2f), v3(0, 3, 0), v3(3, 0, 1), black), "L=1/1/1.5");
    lab_shine(&l, lab_sphere(&l, v3(1.6f, -0.6f, 0.9f), 0.35f, black, false), "L=6/4/2");
    lab_camera(&l, v3(0, -4, 2), v3(0, 0, 0.5f), 45, "");
    expect_agreement(&l, ways, 4);
}

/* A sky that is twice as bright around (0.5, -0.5, 0.7) as elsewhere above, and dark below. */
static Rgb cloudy(V3 w)
{
    float c = f_max(0, 0.58f * w.x - 0.58f * w.y + 0.58f * w.z), bright = c * c * c * c;
    return rgb_scale(rgb(0.5f, 0.7f, 1), w.z > 0 ? 0.5f + 3 * bright : 0.05f);
}

static void sky(void)
{
    static const Way ways[] = {
        { "strategy=mis,maxdepth=3", 8, 0.01 },
        { "strategy=explicit,maxdepth=3", 16, 0.01 },
        { "strategy=implicit,maxdepth=3", 32, 0.01 },
        { "strategy=mis,heuristic=balance,lightsampler=uniform,maxdepth=3", 8, 0.01 },
    };
    Transform turn = xf_rotate(30, 0, 0, 1);
    uint32_t matt, coated, black;
    Mesh m = { 0 };
    Lab l;

    lab_init(&l);
    matt = lab_material(&l, "diffuse", "reflectance=0.5/0.4/0.3");
    coated = lab_material(&l, "coateddiffuse", "reflectance=0.2/0.5/0.7,roughness=0.1");
    black = lab_material(&l, "diffuse", "reflectance=0");
    lab_quad(&l, v3(-3, -3, 0), v3(6, 0, 0), v3(0, 6, 0), matt);
    REQUIRE(mesh_blob(&m, 3), "blob");
    mesh_move(&m, 0.6f, v3(-0.6f, 0.2f, 0.7f));
    lab_mesh(&l, &m, coated, false);
    lab_shine(&l, lab_disk(&l, v3(0.9f, 0, 1.2f), v3(-0.3f, -0.2f, -1), 0.5f, 0.2f, black),
              "L=3/2/1");
    lab_sky(&l, 32, 16, cloudy, &turn);
    lab_camera(&l, v3(0, -4, 2), v3(0, 0, 0.5f), 45, "");
    expect_agreement(&l, ways, 4);
}

const TestCase test_physics_agree[] = {
    { "room", room, false },
    { "glossy", glossy, false },
    { "sky", sky, false },
    { NULL, NULL, false }
};
