/* test_principled.c -- materials that are made of several models: `disney` is the mixture that it
 * says it is, and as good a model as its parts; mixtures of materials that let rays pass. */
#include "base/random.h"
#include "sampling/warp.h"
#include "test/chi2.h"
#include "test/scene_help.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static void build(SceneFile *f)
{
    Opts o;
    opts_default(&o, accels[0]->info.options);
    REQUIRE(scene_build(f->scene, accels[0], &o, 1), "build");
}

/* A scene of one material, the last one, and a ball of it. */
static SceneFile ball_of(const char *materials, unsigned warnings)
{
    char text[3000];
    SceneFile f;

    snprintf(text, sizeof text, "WorldBegin\n%s\nShape \"sphere\" \"float radius\" 1\n", materials);
    f = scene_of(text, warnings);
    build(&f);
    return f;
}

static const Bsdf *bsdf_at(const SceneFile *f, V2 uv, BsdfRoom *room)
{
    Surface s = surface_at(v_all(0.0f), v_all(0.0f), v3(0, 0, 1), uv);
    const Shape *ball = scene_shape(f, 0);
    return material_bsdf(&f->scene->materials[ball->material], &s, room);
}

static V2 unit2(Rng *rng)
{
    float x = rng_unit(rng);
    return (V2){ x, rng_unit(rng) };
}

static bool alike(Rgb a, Rgb b, double part)
{
    double most = (double)rgb_max(a) > rgb_max(b) ? (double)rgb_max(a) : (double)rgb_max(b);
    return fabs((double)a.r - b.r) <= part * most && fabs((double)a.g - b.g) <= part * most &&
           fabs((double)a.b - b.b) <= part * most;
}

/* Both give the same f, density and albedo. */
static void expect_same(const char *what, const char *one, const char *other, unsigned warnings)
{
    SceneFile f = ball_of(one, warnings), g = ball_of(other, 0);
    BsdfRoom room[2];
    Rng rng = rng_seed(61);

    for (int i = 0; i < 3000; i++) {
        V2 uv = unit2(&rng);
        const Bsdf *a = bsdf_at(&f, uv, &room[0]), *b = bsdf_at(&g, uv, &room[1]);
        V3 wo = warp_sphere(unit2(&rng)), wi = warp_sphere(unit2(&rng));
        Rgb fa = a->kind->eval(a, wo, wi, false), fb = b->kind->eval(b, wo, wi, false);
        float pa = a->kind->pdf_w(a, wo, wi), pb = b->kind->pdf_w(b, wo, wi);
        EXPECT(alike(fa, fb, 1e-4) && fabsf(pa - pb) <= 1e-4f * f_max(pa, pb), "%s: f %g %g %g, "
               "not %g %g %g; density %g, not %g", what, fa.r, fa.g, fa.b, fb.r, fb.g, fb.b, pa,
               pb);
        EXPECT(alike(a->kind->albedo(a, wo), b->kind->albedo(b, wo), 1e-4), "%s: albedo", what);
    }
    scenefile_clear(&f);
    scenefile_clear(&g);
}

#define NAMED(name, type) "MakeNamedMaterial \"" name "\" \"string type\" \"" type "\" "
#define ALPHA(x) "\"float roughness\" " x " \"bool remaproughness\" false\n"

/* The parts by hand; alpha is the square of roughness, the tint of glass the root of the colour. */
static void parts(void)
{
    static const char metal[] = NAMED("m", "conductor") "\"rgb reflectance\" [.64 .36 .25] "
        ALPHA(".36"), matt[] = NAMED("c", "coateddiffuse") "\"rgb reflectance\" [.64 .36 .25] "
        "\"float eta\" 1.4 " ALPHA(".36"), glass[] = NAMED("g", "dielectric")
        "\"rgb transmittance\" [.8 .6 .5] \"float eta\" 1.4 " ALPHA(".36");
    char text[2000];

    expect_same("metal", "Material \"disney\" \"rgb color\" [.64 .36 .25] \"float metallic\" 1 "
                "\"float roughness\" .6", "Material \"conductor\" \"rgb reflectance\" "
                "[.64 .36 .25] " ALPHA(".36"), 0);
    snprintf(text, sizeof text, "%s%s%s" NAMED("b", "mix") "\"string materials\" [\"c\" \"g\"] "
             "\"float amount\" .25\nMaterial \"mix\" \"string materials\" [\"b\" \"m\"] "
             "\"float amount\" .3\n", metal, matt, glass);
    expect_same("all three", "Material \"disney\" \"rgb color\" [.64 .36 .25] \"float metallic\" "
                ".3 \"float spectrans\" .25 \"float roughness\" .6 \"float eta\" 1.4", text, 0);
    snprintf(text, sizeof text, "%s%sTexture \"k\" \"float\" \"checkerboard\" \"float tex1\" .2 "
             "\"float tex2\" .9\nMaterial \"mix\" \"string materials\" [\"c\" \"m\"] "
             "\"texture amount\" \"k\"\n", metal, matt);
    expect_same("a texture of metal", "Texture \"k\" \"float\" \"checkerboard\" \"float tex1\" .2 "
                "\"float tex2\" .9\nMaterial \"disney\" \"rgb color\" [.64 .36 .25] "
                "\"texture metallic\" \"k\" \"float roughness\" .6 \"float eta\" 1.4", text, 0);
    expect_same("a coat", "Material \"disney\" \"rgb color\" [.64 .36 .25] \"float metallic\" 1 "
                "\"float roughness\" .6 \"float clearcoat\" .8 \"float clearcoatgloss\" 0 "
                "\"float sheen\" 0", NAMED("m", "conductor") "\"rgb reflectance\" [.64 .36 .25] "
                ALPHA(".36") NAMED("k", "coatedconductor") "\"rgb reflectance\" [.64 .36 .25] "
                "\"float interface.roughness\" .1 \"float conductor.roughness\" .36 "
                "\"bool remaproughness\" false\nMaterial \"mix\" \"string materials\" "
                "[\"m\" \"k\"] \"float amount\" .2\n", 0);
    expect_same("what there is no model of", "Material \"disney\" \"float sheen\" 1 "
                "\"float flatness\" .5 \"bool thin\" \"true\"", "Material \"disney\"", 1);
}

/* ---- as good a model as any ---- */

typedef struct { const Bsdf *b; V3 wo; } View;

static bool draw(const void *of, Rng *rng, V3 *w)
{
    const View *v = of;
    float lobe = rng_unit(rng);
    BsdfSample s;

    if (!v->b->kind->sample(v->b, v->wo, lobe, unit2(rng), false, &s))
        return false;
    *w = s.wi;
    return true;
}
static double density(const void *of, V3 w)
{
    const View *v = of;
    return (double)v->b->kind->pdf_w(v->b, v->wo, w);
}
static double energy(const void *of, V3 w)
{
    const View *v = of;
    return (double)rgb_lum(v->b->kind->eval(v->b, v->wo, w, true)) * fabsf(w.z);
}

static void sampled(void)
{
    static const char *const rows[] = {
        "Material \"disney\" \"rgb color\" [1 1 1] \"float metallic\" .3 \"float roughness\" .6",
        ("Material \"disney\" \"rgb color\" [1 1 1] \"float metallic\" .5 \"float clearcoat\" 1 "
         "\"float clearcoatgloss\" 0 \"float anisotropic\" .8"),
        "Material \"disney\" \"rgb color\" [1 1 1] \"float spectrans\" .7 \"float roughness\" .7"
    };
    for (int i = 0; i < 3; i++) {
        SceneFile f = ball_of(rows[i], 0);
        BsdfRoom room;
        const Bsdf *b = bsdf_at(&f, (V2){ 0.3f, 0.4f }, &room);
        for (int k = 0; k < 3; k++) {
            float t = 0.3f + 0.5f * (float)k, jump = i == 2 ? -m_cos(t) / 1.5f : 0.0f;
            View v = { b, { m_sin(t), 0, m_cos(t) } };
            double all;
            chi2_expect(&(Chi2){ draw, density, &v, .draws = 100000, .seed = 5,
                                 .halvings = i == 2 ? 2 : 0, .jump = jump }, rows[i]);
            all = chi2_integral(energy, &v, false, jump, 48, 96);
            EXPECT(all > 0.6 && all <= 1 + 1e-3, "%s: albedo %g", rows[i], all);
        }
        for (int k = 0; k < 20000; k++) {
            Rng rng = rng_seed((uint64_t)k);
            V3 wo = warp_sphere(unit2(&rng)), wi = warp_sphere(unit2(&rng));
            Rgb there = b->kind->eval(b, wo, wi, false), back = b->kind->eval(b, wi, wo, true);
            EXPECT(alike(there, back, 1e-4), "%s: f %g, its adjoint %g", rows[i],
                   (double)there.g, (double)back.g);
        }
        scenefile_clear(&f);
    }
}

/* ---- mixtures of what lets rays pass ---- */

/* Leaf of opacity .25 and plate of .75, a share of .4 and .6: .55 is stopped; of that the leaf has
 * .1, the plate .45. Two opaque ones stay as they were. */
static void opacity(void)
{
    static const char mixed[] = NAMED("leaf", "uber") "\"rgb opacity\" [.25 .25 .25] "
        "\"rgb Kd\" [.2 .8 .2] \"rgb Ks\" [0 0 0]\n" NAMED("plate", "uber")
        "\"rgb opacity\" [.75 .75 .75] \"rgb Kd\" [.9 .1 .5] \"rgb Ks\" [0 0 0]\n"
        "Material \"mix\" \"string namedmaterial1\" \"leaf\" \"string namedmaterial2\" \"plate\" "
        "\"rgb amount\" [.4 .4 .4]\n";
    static const char same[] = NAMED("leaf", "uber") "\"rgb Kd\" [.2 .8 .2] \"rgb Ks\" [0 0 0]\n"
        NAMED("plate", "uber") "\"rgb Kd\" [.9 .1 .5] \"rgb Ks\" [0 0 0]\n"
        "Material \"mix\" \"string namedmaterial1\" \"leaf\" \"string namedmaterial2\" \"plate\" "
        "\"float amount\" 0.1818182\n";
    SceneFile f = ball_of(mixed, 0);
    const Material *m = &f.scene->materials[scene_shape(&f, 0)->material];
    Surface s = surface_at(v_all(0.0f), v_all(0.0f), v3(0, 0, 1), (V2){ 0, 0 });
    int stopped = 0;

    REQUIRE(m->opacity, "a mixture that is not let through");
    EXPECT(fabsf(texture_alpha(m->opacity, &s) - 0.55f) < 1e-5f, "opacity %g",
           (double)texture_alpha(m->opacity, &s));
    for (int i = 0; i < 10000; i++) {           /* rays that the near side stops */
        Ray r = { .o = { 0.3f * m_sin((float)i), 0.2f, 9 }, .d = { 0, 0, -1 }, .tmax = INFINITY };
        Hit h;
        stopped += scene_nearest(f.scene, &r, &h) && h.t < 9;
    }
    EXPECT(abs(stopped - 5500) < 250, "%d of 10000 rays are stopped", stopped);   /* 5 sigma */
    scenefile_clear(&f);
    expect_same("opacities", mixed, same, 0);
}

const TestCase test_principled[] = {
    { "parts", parts, false },
    { "sampled", sampled, false },
    { "opacity", opacity, false },
    { NULL, NULL, false }
};
