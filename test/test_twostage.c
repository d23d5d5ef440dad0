/* test_twostage.c -- two stage importance sampling brings the light that other strategies bring.
 *
 * Skies       one bright pixel, a black half, a constant, 1 x 1, turned, folded; with things that
 *             hide some of each.
 * Surfaces    matt, glossy, rough glass, paper that light shines through, mixtures with a mirror.
 * Others      lamps and point lights beside the sky; two skies; none; fog.
 * Densities   the density of directions for six models, three normals and three maps. */
#include "base/mem.h"
#include "integrators/twostage.h"
#include "sampling/warp.h"
#include "test/chi2.h"
#include "test/partition_help.h"
#include "test/twostage_help.h"

#include <stdio.h>
#include <string.h>

enum { SIDE = 32 };

/* ---- skies ---- */

static Rgb constant(V3 w) { (void)w; return rgb(0.5f, 0.6f, 0.8f); }
static Rgb half_black(V3 w) { return rgb_all(w.x > 0.0f ? 1.0f + 0.5f * w.z : 0.0f); }
static Rgb one_bright(V3 w)
{
    return rgb_all(v_dot(w, v_unit(v3(0.6f, -0.6f, 0.7f))) > 0.995f ? 100.0f : 0.1f);
}

typedef struct { const char *name; uint32_t w, h; Rgb (*f)(V3 w); const char *options; } Sky;
static const Sky skies[] = {
    { "cloudy", 64, 32, sky_cloudy, "" },
    { "1 x 1", 1, 1, constant, "mapping=latlong" },
    { "half black", 40, 20, half_black, "" },
    { "one bright", 48, 24, one_bright, "" },
    { "octahedral", 32, 32, sky_cloudy, "mapping=octahedral" },
};
enum { NSKIES = sizeof skies / sizeof *skies };

static void all_skies(void)
{
    static const Way ways[] = {
        { "direct:strategy=twostage,samples=4", 2, 0.06 },
        { "direct:strategy=twostage,samples=3,splits=40,peaks=sampled", 2, 0.06 },
        { "path:strategy=twostage,maxdepth=1", 4, 0.06 },
        { NULL, 0, 0 }
    };
    Transform a = xf_rotate(50, 1, 2, 0.5), b = xf_rotate(30, 0, 0, 1);

    for (int k = 0; k < NSKIES; k++) {
        Lab l;
        lab_init(&l);
        add_things(&l, k % 2 == 0);
        lab_sky_as(&l, skies[k].w, skies[k].h, skies[k].f, k == 0 ? &a : &b, skies[k].options);
        lab_camera(&l, v3(0, -4, 2), v3(0, 0, 0.5f), 45, "");
        lab_build(&l);
        ways_agree(&l, SIDE, "direct:strategy=mis,lightsamples=4,bsdfsamples=4", 4, ways,
                         skies[k].name);
        lab_clear(&l);
    }
}

/* Of a size at which several pixels make a cell; with hidden and free parts. */
static void large(void)
{
    static const Way ways[] = {
        { "direct:strategy=twostage,samples=16", 4, 0.06 },
        { "path:strategy=twostage,maxdepth=1", 8, 0.06 },
        { NULL, 0, 0 }
    };
    static const struct { uint32_t w, h; Rgb (*f)(V3 w); } sky[] = {
        { 4096, 2048, one_bright }, { 4500, 2250, sky_cloudy }
    };

    for (int k = 0; k < 2; k++) {
        Lab l;
        lab_init(&l);
        add_things(&l, k == 0);
        lab_sky(&l, sky[k].w, sky[k].h, sky[k].f, NULL);
        lab_camera(&l, v3(0, -4, 2), v3(0, 0, 0.5f), 45, "");
        lab_build(&l);
        ways_agree(&l, SIDE, "direct:strategy=mis,lightsamples=8,bsdfsamples=8", 8, ways,
                         "large");
        lab_clear(&l);
    }
}

/* ---- surfaces, other lights ---- */

static void surfaces(void)
{
    static const Way ways[] = {
        { "direct:strategy=twostage,samples=4,maxdepth=3", 4, 0.08 },
        { "direct:strategy=twostage,samples=8,peaks=sampled,maxdepth=3", 4, 0.08 },
        { NULL, 0, 0 }
    };
    static const Way paths[] = {
        { "path:strategy=twostage,maxdepth=3", 12, 0.08 }, { NULL, 0, 0 }
    };
    uint32_t glass, paper, mixed, coat;
    Lab l;

    lab_init(&l);
    glass = lab_material(&l, "dielectric", "eta=1.5,roughness=0.3,remaproughness=false");
    paper = lab_material(&l, "diffusetransmission", "reflectance=0.3,transmittance=0.5/0.4/0.3");
    mixed = lab_material(&l, "thindielectric", "eta=1.5");
    coat = lab_material(&l, "coateddiffuse", "reflectance=0.5/0.1/0.1,roughness=0");
    lab_quad(&l, v3(-3, -3, 0), v3(6, 0, 0), v3(0, 6, 0), coat);
    lab_sphere(&l, v3(-0.7f, 0, 0.6f), 0.6f, glass, false);
    lab_quad(&l, v3(0, -0.5f, 0), v3(1.4f, 0.5f, 0), v3(0, 0.2f, 1.2f), paper);
    lab_quad(&l, v3(0.2f, -1.2f, 0), v3(1, 0.2f, 0), v3(0, 0, 0.8f), mixed);
    lab_sky(&l, 64, 32, sky_cloudy, NULL);
    lab_camera(&l, v3(0, -4, 2), v3(0, 0, 0.5f), 45, "");
    lab_build(&l);
    ways_agree(&l, SIDE, "direct:strategy=mis,lightsamples=4,bsdfsamples=4,maxdepth=3", 8, ways,
                     "surfaces");
    ways_agree(&l, SIDE, "path:maxdepth=3", 16, paths, "surfaces");
    lab_clear(&l);
}

static void add_lamps(Lab *l)
{
    Transform up = xf_translate(0.5, -1, 1.5);
    uint32_t black = lab_material(l, "diffuse", "reflectance=0");

    lab_shine(l, lab_disk(l, v3(0.9f, 0, 1.6f), v3(-0.3f, -0.2f, -1), 0.4f, 0, black), "L=3/2/1");
    lab_light(l, "point", "I=0.3/0.3/0.5", &up);
}

static void others(void)
{
    static const Way ways[] = {
        { "direct:strategy=twostage,samples=4", 3, 0.12 },
        { "direct:strategy=twostage,samples=2,lightsamples=2,lightsampler=power", 3, 0.12 },
        { "direct:strategy=twostage,samples=2,lightsampler=uniform,occlusion=directions", 3, 0.12 },
        { "path:strategy=twostage,maxdepth=1", 8, 0.12 },
        { "path:strategy=twostage,maxdepth=1,lightsampler=uniform,heuristic=balance", 8, 0.15 },
        { NULL, 0, 0 }
    };
    Medium fog = { "fog", { 0.05f, 0.1f, 0.1f }, { 0.2f, 0.2f, 0.15f }, 0.6f };

    for (int k = 0; k < 4; k++) {
        static const char *const name[] = { "lamps", "two skies", "no sky", "fog" };
        uint32_t index;
        Lab l;
        lab_init(&l);
        add_things(&l, true);
        add_lamps(&l);
        if (k != 2)
            lab_sky(&l, 32, 16, sky_cloudy, NULL);
        if (k == 1)
            lab_light(&l, "infinite", "L=0.4/0.3/0.2", NULL);
        if (k == 3) {
            REQUIRE(scene_add_medium(l.scene, &fog, &index), "memory");
            l.scene->around = index;
        }
        lab_camera(&l, v3(0, -4, 2), v3(0, 0, 0.5f), 45, "");
        lab_build(&l);
        ways_agree(&l, SIDE, "path:maxdepth=1", 16, k == 3 ? ways + 3 : ways, name[k]);
        lab_clear(&l);
    }
}

/* ---- nothing to see, nothing to hear of ---- */

static Rgb night(V3 w) { (void)w; return rgb_all(0); }

static void darkness(void)
{
    static const char *const methods[] = { "direct:strategy=twostage", "path:strategy=twostage",
                                           "direct:strategy=twostage,peaks=sampled" };
    Ray r = ray_towards(v3(-0.9f, -0.7f, 0.5f), v3(0.05f, 0.02f, 0));
    Gauge g = { ray_fixed, NULL, 64, 41, 0 };

    g.of = &r;
    for (int k = 0; k < 6; k++) {
        Lab l;
        lab_init(&l);
        lab_quad(&l, v3(-4, -5, 0), v3(10, 0, 0), v3(0, 10, 0),
                 lab_material(&l, "diffuse", k < 3 ? "reflectance=1" : "reflectance=0"));
        if (k % 3)
            lab_sky(&l, 8, 4, k % 3 == 1 ? night : k < 3 ? half_black : constant, NULL);
        if (k % 3 == 0 && k)
            lab_light(&l, "infinite", "L=1", NULL);
        lab_build(&l);
        for (int i = 0; i < 3; i++) {
            Meter m;
            lab_open(&l, methods[i]);
            lab_measure(&l, &g, &m);            /* which asks that all is finite */
            EXPECT((meter_radiance(&m)[0].total > 0) == (k == 2), "%d: %s", k, methods[i]);
        }
        lab_clear(&l);
    }
}

/* A glossy floor under a smooth sky: nearly every sample brings the same. */
static void pays(void)
{
    Ray r = ray_towards(v3(-0.9f, -0.7f, 0.5f), v3(0.05f, 0.02f, 0));
    static const char *const methods[] = { "direct:strategy=twostage,samples=64",
                                           "direct:strategy=mis,lightsamples=32,bsdfsamples=32" };
    Gauge g = { ray_fixed, NULL, 1024, 17, 0 };
    double cv[2];
    Lab l;

    g.of = &r;
    lab_init(&l);
    lab_quad(&l, v3(-4, -5, 0), v3(10, 0, 0), v3(0, 10, 0),
             lab_material(&l, "phong", "reflectance=0.2,specular=0.7,exponent=100"));
    lab_sky(&l, 128, 64, sky_cloudy, NULL);
    lab_build(&l);
    for (int i = 0; i < 2; i++) {
        Meter m;
        lab_open(&l, methods[i]);
        lab_measure(&l, &g, &m);
        cv[i] = stat_error(&meter_radiance(&m)[1]) / meter_radiance(&m)[1].mean;
    }
    EXPECT(cv[0] < 0.65 * cv[1], "two stage: error %.8f, both ways weighed: %.8f", cv[0], cv[1]);
    lab_clear(&l);
}

/* ---- densities: six models, three normals, three maps ---- */

static const char *const models[][2] = {
    { "diffuse", "reflectance=0.5" }, { "orennayar", "sigma=40" },
    { "phong", "reflectance=0.1,specular=0.8,exponent=200" },
    { "ashikhminshirley", "reflectance=0.1,specular=0.8,nu=1,nv=800" },
    { "dielectric", "eta=1.5,roughness=0.2,remaproughness=false" },
    { "blinn", "reflectance=0,specular=1,exponent=500" }
};

static void density_of(int model, int normal, int sky)
{
    static const V3 normals[] = { { 0, 0, 1 }, { 0.48f, -0.64f, 0.6f }, { 1, 0, 0 } };
    static const int maps[] = { 0, 2, 3 };
    static TwoStage two;
    static Partition p;
    V3 n = normals[normal];
    Ray r = ray_towards(v_add(v_scale(n, 2), v_scale(frame_about(n).t, 1.5f)), v_all(0));
    Frame f = frame_about(n);
    const Sky *s = &skies[maps[sky]];
    Chi2 c = { partition_draw, partition_density, &p, false, test_is_long() ? 1000000 : 100000, 3,
               64, 128, 2, 0 };
    Tracer t;
    Vertex v;
    Turn u;
    char what[120];
    Opts o;
    Lab l;

    lab_init(&l);
    lab_quad(&l, v_scale(v_add(f.s, f.t), -1), v_scale(f.s, 2), v_scale(f.t, 2),
             lab_material(&l, models[model][0], models[model][1]));
    lab_sky(&l, 128, 64, s->f, NULL);
    lab_build(&l);
    lab_method(&l, "direct:strategy=twostage", &o);
    REQUIRE(twostage_init(&two, l.scene, &o, false), "map");
    memset(&t, 0, sizeof t);
    t.scene = l.scene;
    REQUIRE(vertex_meet(&v, &r, &t), "the surface is met");
    u = turn_on(&v, r.d, NO_MEDIUM, 0);
    snprintf(what, sizeof what, "%s, normal %d, %s", models[model][0], normal, s->name);
    REQUIRE(twostage_partition(&two, &u, 32, &t, &p), "%s", what);
    chi2_expect(&c, what);
    twostage_clear(&two);
    lab_clear(&l);
}

static void densities(void)
{
    for (int k = 0; k < 3; k++)
        density_of(k * 2 + 1, k, k);
}

static void all_densities(void)
{
    for (int m = 0; m < 6; m++)
        for (int n = 0; n < 3; n++)
            for (int s = 0; s < 3; s++)
                density_of(m, n, s);
}

const TestCase test_twostage[] = {
    { "skies", all_skies, false }, { "large", large, true }, { "surfaces", surfaces, false },
    { "others", others, false }, { "darkness", darkness, false }, { "pays", pays, false },
    { "densities", densities, false }, { "all_densities", all_densities, true },
    { NULL, NULL, false }
};
