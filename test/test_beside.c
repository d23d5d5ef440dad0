/* test_beside.c -- lights that are asked beside as many directions by the surface: pictures of the
 * sky are sampled by what rises above an even level (panorama.c).
 *
 * Level       Together with the surface's mean density, 1 / 2 pi, the density is proportional to
 *             the light above the level, and below it the surface alone finds enough: cell by cell,
 *             for every mapping; and by hand for a picture of three values.
 * Draws       Chi-squared against the density that it says.
 * Who asks    Only who has at least as many directions by the surface, and no one else: pictures
 *             are the same, bit by bit, whatever the option says.
 * Truth       test_truth.c has these ways in its grid. Here a sky of which most is below the level,
 *             under which each that asks so gives the picture of `light`, which does not.
 * Noise       What it is for: variance on a matt floor under a sky with a small sun. */
#include "scene/panorama.h"
#include "test/chi2.h"
#include "test/pictures.h"

#include <stdio.h>
#include <string.h>

/* ---- the level ---- */

static const Mapping mappings[] = {
    { MAPPING_LATLONG, 0, 0 }, { MAPPING_OCTAHEDRAL, 0, 0 }, { MAPPING_ANGULAR, 0, 0 },
    { MAPPING_MIRRORBALL, 0, 0 }
};

/* A small sun in a wide glow, a bright quarter, a gentle rest. */
static Rgb sunny(V3 w)
{
    float c = f_max(0, v_dot(w, v_unit(v3(0.3f, -0.4f, 0.8f)))), glow = f_sqr(f_sqr(c));
    float L = (w.x > 0 && w.y > 0 ? 1.6f : 0.6f) + 0.5f * w.z + 3 * glow;
    glow = f_sqr(f_sqr(f_sqr(glow)));
    return rgb_scale(rgb(1, 0.8f, 0.7f), L + 200 * f_sqr(f_sqr(glow)));
}

static void draw_picture(Image *im, uint32_t w, uint32_t h, const Mapping *m, Rgb (*f)(V3 w))
{
    REQUIRE(image_init(im, w, h), "memory");
    for (uint32_t y = 0; y < h; y++)
        for (uint32_t x = 0; x < w; x++) {
            float jacobian;
            V2 p = { ((float)x + 0.5f) / (float)w, ((float)y + 0.5f) / (float)h };
            *image_at(im, x, y) = f(mapping_direction(m, p, &jacobian));
        }
}

static void bright_of(Panorama *p, const Image *im, Mapping m)
{
    REQUIRE(panorama_init(p, im, m) && panorama_set_bright(p, 0, 0, NULL), "memory");
}

static void expect_level(const Panorama *p, const char *what)
{
    const double surface = 0.5 / PI;
    double per_light = 0;
    int above = 0, below = 0;

    for (int pass = 0; pass < 2; pass++)        /* the factor first, by the brightest of all */
        for (uint32_t y = 0; y < p->image->h; y++)
            for (uint32_t x = 0; x < p->image->w; x++) {
                V2 at = { ((float)x + 0.5f) / (float)p->image->w,
                          ((float)y + 0.5f) / (float)p->image->h };
                float jacobian;
                V3 d = mapping_direction(&p->mapping, at, &jacobian);
                double L = (double)rgb_lum(*image_at(p->image, x, y));
                double pdf = (double)panorama_bright_pdf_w(p, d);
                if (!(jacobian > 0) || !(L > 0))
                    continue;
                if (!pass) {
                    if (L > 100)
                        per_light = (pdf + surface) / L;
                } else if (pdf > 0) {
                    above++;
                    EXPECT(fabs((pdf + surface) / (per_light * L) - 1) < 0.02, "%s: density %g "
                           "+ %g for light %g, the brightest has %g for each", what, pdf, surface,
                           L, per_light);
                } else {
                    below++;
                    EXPECT(per_light * L < 1.02 * surface, "%s: light %g is left to the surface, "
                           "whose density is %g, wanted %g", what, L, surface, per_light * L);
                }
            }
    EXPECT(above > 20 && below > 20, "%s: %d cells above, %d below", what, above, below);
}

static void level(void)
{
    static const char *const names[] = { "latlong", "octahedral", "angular", "mirrorball" };

    for (int k = 0; k < 4; k++) {
        Panorama p;
        Image im = { 0 };
        draw_picture(&im, 192, k ? 192 : 96, &mappings[k], sunny);
        bright_of(&p, &im, mappings[k]);
        expect_level(&p, names[k]);
        panorama_clear(&p);
        image_clear(&im);
    }
}

/* Cells of equal solid angle, of which 1/8 are 9, 1/4 are 3, the others 1/2. The level is
 * 2 (9/8 + 3/4) / (1 + 2 (1/8 + 1/4)) = 15/7; what rises above it is 48/7 and 6/7, 15/14 in the
 * mean: densities 6.4 and 0.8 times the even one. All alike, and all black: no level is above. */
static void by_hand(void)
{
    static const struct { float value[8], density[8]; } cases[] = {
        { { 3, 0.5f, 9, 0.5f, 3, 0.5f, 0.5f, 0.5f }, { 0.8f, 0, 6.4f, 0, 0.8f, 0, 0, 0 } },
        { { 2, 2, 2, 2, 2, 2, 2, 2 }, { 1, 1, 1, 1, 1, 1, 1, 1 } },
        { { 0, 0, 0, 0, 0, 0, 0, 0 }, { 0, 0, 0, 0, 0, 0, 0, 0 } },
        { { 0, 0, 0, 0, 0, 7, 0, 0 }, { 0, 0, 0, 0, 0, 8, 0, 0 } },
    };

    for (size_t k = 0; k < sizeof cases / sizeof cases[0]; k++) {
        Panorama p;
        Image im = { 0 };
        REQUIRE(image_init(&im, 4, 2), "memory");
        for (uint32_t i = 0; i < 8; i++)
            *image_at(&im, i % 4, i / 4) = rgb_all(cases[k].value[i]);
        bright_of(&p, &im, mappings[1]);
        for (uint32_t i = 0; i < 8; i++) {
            float jacobian, pdf;
            V2 at = { ((float)(i % 4) + 0.4f) / 4, ((float)(i / 4) + 0.4f) / 2 };
            pdf = panorama_bright_pdf_w(&p, mapping_direction(&mappings[1], at, &jacobian));
            EXPECT(fabsf(pdf * 4 * PI_F - cases[k].density[i]) < 1e-5f, "picture %d, cell %d: "
                   "density %g of the even one, expected %g", (int)k, (int)i,
                   (double)(pdf * 4 * PI_F), (double)cases[k].density[i]);
        }
        panorama_clear(&p);
        image_clear(&im);
    }
}

/* ---- draws ---- */

static bool draw(const void *of, Rng *rng, V3 *w)
{
    V2 u = { rng_unit(rng), 0 };
    LightSample s;

    u.y = rng_unit(rng);
    if (!light_sample(of, true, v3(1, 2, 3), u, &s))
        return false;
    *w = s.wi;
    return true;
}

static double density(const void *of, V3 w)
{
    return (double)light_pdf_w(of, true, v3(1, 2, 3), w, NULL);
}

static void expect_draws(const Lab *l, uint64_t seed, int halvings, float jump, const char *what)
{
    chi2_expect(&(Chi2){ draw, density, l->scene->lights[0], .draws = 200000, .seed = seed,
                         .halvings = halvings, .jump = jump }, what);
}

static void draws(void)
{
    static const char *const ways[] = { "sampling=cdf", "sampling=alias", "sampling=mediancut",
                                        "sampling=cdf,mapping=octahedral" };
    for (int k = 0; k < 4; k++) {
        Transform turned = xf_rotate(90, 0, 0, 1);
        Lab l;
        lab_init(&l);
        lab_sky_as(&l, 32, 16, sunny, k == 1 ? NULL : &turned, ways[k]);
        lab_build(&l);
        expect_draws(&l, 61, k == 3 ? 3 : 1, 0, ways[k]);
        lab_clear(&l);
    }
    for (int sun = 0; sun < 2; sun++) {
        Lab l;
        lab_init(&l);
        lab_light(&l, "sky", sun ? "sundirection=0/0/1,sunsize=50" : "sunscale=0", NULL);
        lab_build(&l);
        expect_draws(&l, 62, 1, sun ? 0.906307787f : 0 /* cos 25 degrees */,
                     sun ? "sky with sun" : "sky without sun");
        lab_clear(&l);
    }
}

/* ---- in pictures ---- */

static void begin(Lab *l, const char *floor, const char *options, bool picture)
{
    lab_init(l);
    lab_quad(l, v3(-3, -3, 0), v3(6, 0, 0), v3(0, 6, 0), lab_material(l, floor, options));
    lab_sphere(l, v3(-0.4f, 0, 0.5f), 0.5f, lab_material(l, "conductor", "roughness=0.3"), false);
    if (picture)
        lab_sky_as(l, 64, 32, sunny, NULL, "");
    else
        lab_light(l, "sky", "scale=0.03,sunsize=8,sundirection=0.5/-0.4/0.6", NULL);
    lab_camera(l, v3(0, -4, 2), v3(0, 0, 0.4f), 45, "");
    lab_build(l);
}

static void take(Lab *l, const char *method, Film *film)
{
    RenderSettings s;
    RenderReport report;

    picture_settings(l, &s, method, 16, 16, 2);
    picture_render(l, &s, film, &report);
}

static void who_asks(void)
{
    static const struct { const char *method; bool asks; } ways[] = {
        { "direct:strategy=mis", true }, { "direct:strategy=mis,bsdfsamples=3", true },
        { "direct:strategy=mis,lightsamples=2", false },
        { "direct:strategy=mis,lights=all", true },
        { "direct:strategy=mis,occlusion=directions", true },
        { "direct:strategy=light", false }, { "direct:strategy=brdf", false },
        { "direct:strategy=ris,tentative=8,samples=2", true },
        { "direct:strategy=ris,tentative=8,samples=2,lightshare=0.75", false },
        { "direct:strategy=ris,tentative=8,samples=2,lightshare=1", false },
        { "direct:strategy=twostage,samples=4", false },
        { "path:maxdepth=2", true }, { "path:strategy=explicit", false },
        { "path:strategy=implicit", false }, { "path:strategy=ris", true },
    };
    Lab l;

    begin(&l, "diffuse", "reflectance=0.5", true);
    for (size_t k = 0; k < sizeof ways / sizeof ways[0]; k++) {
        char all[120];
        Film a, b;
        snprintf(all, sizeof all, "%s,sky=all", ways[k].method);
        take(&l, ways[k].method, &a);
        take(&l, all, &b);
        EXPECT(films_equal(&a, &b) != ways[k].asks, "%s: sky=all makes %s difference",
               ways[k].method, ways[k].asks ? "no" : "a");
        film_clear(&a);
        film_clear(&b);
    }
    lab_clear(&l);
}

static void expect_truth(bool picture)
{
    static const char *const ways[] = {
        "direct:strategy=mis", "direct:strategy=mis,bsdfsamples=2,heuristic=balance",
        "direct:strategy=mis,occlusion=directions", "direct:strategy=mis,lights=all",
        "direct:strategy=ris,tentative=8,samples=2", "path:maxdepth=1",
        "path:strategy=ris,maxdepth=1"
    };
    Series right, s;
    Lab l;

    begin(&l, "phong", "reflectance=0.3,specular=0.3,exponent=15", picture);
    series_render(&l, &right, "direct:strategy=light,lightsamples=8@random", 32, 8, 900);
    for (size_t k = 0; k < sizeof ways / sizeof ways[0]; k++) {
        series_render(&l, &s, ways[k], 32, 4, 910 + (uint64_t)k);
        series_expect_same(&s, &right, 0.03, ways[k]);
        series_clear(&s);
    }
    series_clear(&right);
    lab_clear(&l);
}

static void truth(void)
{
    expect_truth(true);
    expect_truth(false);
}

static void noise(void)
{
    static const char *const ways[] = { "direct:strategy=mis", "path:maxdepth=1" };

    for (int k = 0; k < 4; k++) {
        double error[2] = { 0, 0 };
        Lab l;
        begin(&l, "diffuse", "reflectance=0.5", k < 2);
        for (int all = 0; all < 2; all++) {
            char method[80];
            Series s;
            snprintf(method, sizeof method, "%s,sky=%s@random", ways[k % 2],
                     all ? "all" : "bright");
            series_render(&l, &s, method, 32, 4, 930);
            for (uint32_t i = 0; i < s.tiles; i++) {
                Stat st = { 0, 0, 0, 0, 0 };
                for (int run = 0; run < RUNS; run++)
                    stat_add(&st, s.tile[i * RUNS + (uint32_t)run]);
                error[all] += st.squares / (st.n - 1);
            }
            series_clear(&s);
        }
        EXPECT(error[0] < 0.6 * error[1], "%s: variance %g, asked for all light %g", ways[k % 2],
               error[0], error[1]);
        lab_clear(&l);
    }
}

const TestCase test_beside[] = {
    { "level", level, false },
    { "by_hand", by_hand, false },
    { "draws", draws, false },
    { "who_asks", who_asks, false },
    { "truth", truth, false },
    { "noise", noise, false },
    { NULL, NULL, false }
};
