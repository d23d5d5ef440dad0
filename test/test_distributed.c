/* test_distributed.c -- sampled lights, lens, time and gloss: against `path` where there is direct
 * light only, and against a naive twin for all else, whatever is split and however lights are
 * chosen. And the pattern that branches share. */
#include "integrators/vertex.h"
#include "test/pictures.h"

#include <stdio.h>
#include <string.h>

/* ---- a scene with everything in it ---- */

static Rgb some_sky(V3 w)
{
    return w.x > 0.5f ? rgb(3, 2, 1) : w.z < -0.9f ? rgb(0, 0, 0) : rgb(0.2f, 0.3f, 0.6f);
}

/* A floor of that material between a mirror, glass, plastic and metal, under lamps and a sky. */
static void add_all(Lab *l, const char *kind, const char *options)
{
    uint32_t black = lab_material(l, "diffuse", "reflectance=0");

    lab_quad(l, v3(-9, -9, 0), v3(18, 0, 0), v3(0, 18, 0), lab_material(l, kind, options));
    lab_quad(l, v3(-3, 3, 0), v3(6, 0, 0), v3(0, 0, 4), lab_material(l, "mirror", ""));
    lab_sphere(l, v3(-1.5f, 0, 1), 1, lab_material(l, "dielectric", ""), false);
    lab_sphere(l, v3(1.5f, 0, 1), 1, lab_material(l, "coateddiffuse", "reflectance=0.6/0.3/0.1"),
               false);
    lab_sphere(l, v3(0, 1.5f, 0.7f), 0.7f, lab_material(l, "conductor", "roughness=0.1"), false);
    lab_shine(l, lab_quad(l, v3(-1, -2, 4), v3(0, 3, 0), v3(3, 0, 0), black), "L=2/3/4");
    lab_shine(l, lab_sphere(l, v3(-3, -2, 2), 0.8f, black, false), "L=3/2/1");
    lab_sky(l, 32, 16, some_sky, NULL);
}

/* Places that the ray of a sample looks at: the floor at first hand, the mirror, each of the balls,
 * where glass and metal show the others. */
static const V3 views[] = { { 0, -1.5f, 0 }, { 1.2f, 3, 1 }, { -1.5f, 0, 1.2f }, { 1.5f, 0, 1 },
                            { 0, 1.5f, 0.9f } };
enum { VIEWS = sizeof views / sizeof *views };
static const V3 eye = { 0.3f, -6, 2.5f };

/* ---- direct light ---- */

/* With one event `path` and this one are the same sum, however it is sampled. */
static void test_direct_light(void)
{
    static const char *const floors[][2] = {
        { "diffuse", "reflectance=0.8" }, { "phong", "reflectance=0.3,specular=0.5,exponent=30" },
        { "conductor", "roughness=0.2" },
    };
    static const char *const ways[] = {
        "distributed:maxdepth=1", "distributed:maxdepth=1,lightsampler=uniform,lightsamples=4",
        "distributed:maxdepth=1,lightsampler=all,bsdfsamples=3",
        "distributed:maxdepth=1,lightsampler=all,lightsamples=2,bsdfsamples=2",
    };
    Ray r = ray_towards(eye, views[0]);
    Gauge g = { ray_fixed, NULL, 90000, 5, 0 };

    g.of = &r;
    for (size_t f = 0; f < sizeof floors / sizeof *floors; f++) {
        Meter path, m;
        Lab l;
        lab_init(&l);
        add_all(&l, floors[f][0], floors[f][1]);
        lab_light(&l, "point", "from=2/-3/2,I=5", NULL);
        lab_build(&l);
        lab_open(&l, "path:maxdepth=1");
        lab_measure(&l, &g, &path);
        for (size_t i = 0; i < sizeof ways / sizeof *ways; i++) {
            lab_open(&l, ways[i]);
            lab_measure(&l, &g, &m);
            for (int c = 0; c < 3; c++)
                stat_expect_same(&meter_radiance(&m)[c], &meter_radiance(&path)[c], 0.06, ways[i]);
        }
        lab_clear(&l);
    }
}

/* ---- the naive twin ---- */

/* Light by chance alone: a walk that adds what shines where it comes by, and ends where a matt part
 * of a model has turned it. */
static Rgb walk(const Scene *s, Ray r, int maxdepth, Tracer *t)
{
    Rgb sum = rgb_all(0), left = rgb_all(1);

    for (int depth = 0;; depth++) {
        BsdfSample bs;
        Vertex v;
        if (!vertex_meet(&v, &r, t)) {
            for (size_t i = 0; i < s->ninfinite; i++)
                sum = rgb_add(sum, rgb_mul(left, s->infinite[i]->kind->radiance(s->infinite[i], r.d,
                                                                                NULL)));
            return sum;
        }
        if (scene_light_of(s, &v.s)) {
            const Light *l = scene_light_of(s, &v.s);
            sum = rgb_add(sum, rgb_mul(left, l->kind->radiance(l, r.d, &v.s)));
        }
        if (maxdepth < 0 || depth >= maxdepth || !vertex_sample(&v, t, depth, &bs))
            return sum;
        left = rgb_mul(left, bs.weight);
        r = vertex_ray(&v, bs.wi);
        if (bs.flags & BSDF_MATT)
            maxdepth = -1;                      /* one look more */
    }
}

static void measure_twin(const Lab *l, Ray r, uint32_t n, Stat s[3])
{
    const SamplerKind *kind = kind_find(samplers, "random");
    uint32_t spp = n;
    Tracer t;
    Opts none;

    memset(&t, 0, sizeof t);
    memset(s, 0, 3 * sizeof *s);
    t.scene = l->scene;
    opts_default(&none, kind->info.options);
    REQUIRE(sampler_init(&t.sampler, kind, &none, 77, &spp), "sampler");
    for (uint32_t i = 0; i < n; i++) {
        Rgb L;
        sampler_start(&t.sampler, i);
        L = walk(l->scene, r, 6, &t);
        stat_add(&s[0], L.r);
        stat_add(&s[1], L.g);
        stat_add(&s[2], L.b);
    }
}

static void test_twin(void)
{
    static const char *const ways[] = {
        "distributed:maxdepth=6", "distributed:maxdepth=6,roulette=1,lightsampler=all",
        "distributed:maxdepth=6,lightsamples=3,bsdfsamples=4",
        "distributed:maxdepth=6,lightsampler=all,lightsamples=2,bsdfsamples=2,roulette=2",
    };
    uint32_t n = test_is_long() ? 1600000 : 200000;
    char what[200];
    Lab l;

    lab_init(&l);
    add_all(&l, "phong", "reflectance=0.4/0.3/0.2,specular=0.5,exponent=60");
    lab_build(&l);
    for (int k = 0; k < VIEWS; k++) {
        Ray r = ray_towards(eye, views[k]);
        Gauge g = { ray_fixed, NULL, 46000, 6, 0 };
        Stat twin[3];
        g.of = &r;
        measure_twin(&l, r, n, twin);
        for (size_t i = 0; i < sizeof ways / sizeof *ways; i++) {
            Meter m;
            lab_open(&l, ways[i]);
            lab_measure(&l, &g, &m);
            snprintf(what, sizeof what, "view %d, %s", k, ways[i]);
            for (int c = 0; c < 3; c++)
                stat_expect_same(&meter_radiance(&m)[c], &twin[c], 0.1, what);
        }
    }
    lab_clear(&l);
}

/* The same by the default sampler, whose branches share a pattern. */
static void test_patterns_are_unbiased(void)
{
    Lab l;

    lab_init(&l);
    add_all(&l, "phong", "reflectance=0.4/0.3/0.2,specular=0.5,exponent=60");
    lab_build(&l);
    for (int k = 0; k < VIEWS; k++) {
        Ray r = ray_towards(eye, views[k]);
        Gauge plain = { ray_fixed, NULL, 60000, 6, 0 }, g = { ray_fixed, NULL, 32000, 6, 16 };
        Meter a, b;
        plain.of = g.of = &r;
        lab_open(&l, "distributed:maxdepth=6");
        lab_measure(&l, &plain, &a);
        lab_open(&l, "distributed:maxdepth=6,lightsamples=4,bsdfsamples=2");
        lab_measure(&l, &g, &b);
        for (int c = 0; c < 3; c++)
            stat_expect_same(&meter_radiance(&b)[c], &meter_radiance(&a)[c], 0.1, "patterns");
    }
    lab_clear(&l);
}

/* A lamp behind a mirror's corner: only mirrors and one matt surface, where all of path's paths but
 * the ones over two matt surfaces are found; and there is one. */
static void test_mirrors_and_one_floor(void)
{
    Ray r = ray_towards(v3(-2, -1, 1), v3(1, 0.5f, 0.3f));      /* in the mirror: the floor */
    Gauge g = { ray_fixed, NULL, 60000, 8, 0 };
    Meter a, b;
    Lab l;

    g.of = &r;
    lab_init(&l);
    lab_quad(&l, v3(-9, -9, 0), v3(9.9f, 0, 0), v3(0, 18, 0), lab_material(&l, "diffuse", ""));
    lab_quad(&l, v3(1, -9, -5), v3(0, 0, 9), v3(0, 18, 0),
             lab_material(&l, "mirror", "reflectance=0.8/0.6/0.4"));
    lab_shine(&l, lab_quad(&l, v3(-4, -2, 1.5f), v3(0, 4, 0), v3(3, 0, 0),
                           lab_material(&l, "diffuse", "reflectance=0")), "L=2");
    lab_build(&l);
    lab_open(&l, "path:maxdepth=2");
    lab_measure(&l, &g, &a);
    lab_open(&l, "distributed");
    lab_measure(&l, &g, &b);
    EXPECT(meter_length(&b, 3)->mean > 0.01, "the lamp does not light the floor");
    for (int c = 0; c < 3; c++)
        stat_expect_same(&meter_radiance(&b)[c], &meter_radiance(&a)[c], 0.05, "mirror");
    lab_clear(&l);
}

/* ---- ambient light ---- */

/* Seen by the matt part alone, in the mean; a mirror shows the floor with it. */
static void test_ambient(void)
{
    double truth[3] = { 0.5, 0.25, 1 }, mirrored[3] = { 0.25, 0.125, 0.5 };
    Ray r = ray_towards(v3(0, -2, 2), v3(0, 0, 0)), up = ray_towards(v3(-2, -1, 1),
                                                                    v3(1, 0.5f, 0.3f));
    Gauge g = { ray_fixed, NULL, 2000, 9, 0 };
    Meter m;
    Lab l;

    lab_init(&l);
    lab_quad(&l, v3(-9, -9, 0), v3(10, 0, 0), v3(0, 18, 0),
             lab_material(&l, "diffuse", "reflectance=0.5/0.25/1"));
    lab_quad(&l, v3(1, -9, 0), v3(0, 0, 9), v3(0, 18, 0),
             lab_material(&l, "mirror", "reflectance=0.5"));
    lab_build(&l);
    for (int k = 0; k < 2; k++) {
        lab_open(&l, k ? "distributed:ambient=constant,L0=1,bsdfsamples=4"
                       : "distributed:ambient=constant,L0=1");
        g.of = &r;
        lab_measure(&l, &g, &m);
        stat_expect_rgb(meter_radiance(&m), truth, 0.01, "matt");
        g.of = &up;
        lab_measure(&l, &g, &m);
        stat_expect_rgb(meter_radiance(&m), mirrored, 0.01, "in the mirror");
    }
    lab_clear(&l);
}

/* ---- lens, time, media: the driver's part, and that of rays ---- */

/* A blurred picture of direct light, by both. */
static void test_blur(void)
{
    Series a, b;
    uint32_t black;
    Lab l;

    lab_init(&l);
    lab_camera(&l, v3(0, -6, 3), v3(0, 0, 0.5f), 40, "lensradius=0.4,focaldistance=4");
    black = lab_material(&l, "diffuse", "reflectance=0");
    lab_quad(&l, v3(-9, -9, 0), v3(18, 0, 0), v3(0, 18, 0), lab_material(&l, "diffuse", ""));
    lab_sphere(&l, v3(0, 0, 1), 1, lab_material(&l, "diffuse", "reflectance=0.8/0.3/0.2"), false);
    lab_shine(&l, lab_quad(&l, v3(-2, -2, 4), v3(0, 2, 0), v3(2, 0, 0), black), "L=5");
    lab_build(&l);
    series_render(&l, &a, "path:maxdepth=1", 32, 8, 1);
    series_render(&l, &b, "distributed:maxdepth=1,lightsamples=2", 32, 4, 2);
    series_expect_same(&b, &a, 0.02, "lens");
    series_clear(&a);
    series_clear(&b);
    lab_clear(&l);
}

/* A medium that only absorbs takes the same as from `path`. */
static void test_medium(void)
{
    Medium fog = { "", { 0.1f, 0.2f, 0.4f }, { 0, 0, 0 }, 0 };
    Ray r = ray_towards(v3(1, -2, 2), v3(1, 0, 0));
    Gauge g = { ray_fixed, NULL, 60000, 10, 0 };
    uint32_t index;
    Meter a, b;
    Lab l;

    g.of = &r;
    lab_init(&l);
    lab_quad(&l, v3(-9, -9, 0), v3(18, 0, 0), v3(0, 18, 0), lab_material(&l, "diffuse", ""));
    lab_shine(&l, lab_quad(&l, v3(-1, -1, 3), v3(0, 2, 0), v3(2, 0, 0),
                           lab_material(&l, "diffuse", "reflectance=0")), "L=5");
    REQUIRE(scene_add_medium(l.scene, &fog, &index), "memory");
    l.scene->around = index;
    lab_build(&l);
    lab_open(&l, "path:maxdepth=1");
    lab_measure(&l, &g, &a);
    lab_open(&l, "distributed:maxdepth=1");
    lab_measure(&l, &g, &b);
    for (int c = 0; c < 3; c++)
        stat_expect_same(&meter_radiance(&b)[c], &meter_radiance(&a)[c], 0.03, "fog");
    lab_clear(&l);
}

/* ---- the pattern ---- */

/* Parts of 16 samples, 4 of each: one in each of 64 cells; those of one sample in 4 quarters; the
 * cells that go with a sample differ from pixel to pixel. */
static void test_parts(void)
{
    const SamplerKind *kind = kind_find(samplers, "zerotwo");
    int alike = 0;
    uint32_t spp = 16;
    Sampler s;
    Opts none;

    opts_default(&none, kind->info.options);
    REQUIRE(sampler_init(&s, kind, &none, 1, &spp), "sampler");
    for (uint32_t pixel = 0; pixel < 50; pixel++) {
        int cell[64] = { 0 };
        sampler_pixel(&s, pixel, 3);
        for (uint32_t i = 0; i < 16; i++) {
            int quarter[4] = { 0 }, full = 0;
            V2 whole;
            sampler_start(&s, i);
            whole = sample_2d(&s, DECISION(DECIDE_PIXEL, 0));
            for (uint32_t k = 0; k < 4; k++) {
                Sampler part = sampler_part(&s, 4, k);
                V2 u = sample_2d(&part, DECISION(DECIDE_LIGHT_POINT, 0));
                cell[(int)(u.x * 8) + 8 * (int)(u.y * 8)]++;
                quarter[(int)(u.x * 2) + 2 * (int)(u.y * 2)]++;
                alike += (int)(u.x * 4) == (int)(whole.x * 4);
            }
            for (int q = 0; q < 4; q++)
                full += quarter[q] == 1;
            EXPECT(full == 4, "pixel %u, sample %u: %d quarters of 4", (unsigned)pixel,
                   (unsigned)i, full);
        }
        for (int c = 0; c < 64; c++)
            EXPECT(cell[c] == 1, "pixel %u: %d samples in a cell", (unsigned)pixel, cell[c]);
    }
    /* a quarter of 3200, and 5 standard errors of what is no more even than chance */
    EXPECT(alike > 800 - 5 * 25 && alike < 800 + 5 * 25, "%d of 3200 follow the pixel", alike);
}

const TestCase test_distributed[] = {
    { "direct_light", test_direct_light, false },
    { "twin", test_twin, false },
    { "patterns_are_unbiased", test_patterns_are_unbiased, false },
    { "mirrors_and_one_floor", test_mirrors_and_one_floor, false },
    { "ambient", test_ambient, false },
    { "blur", test_blur, false },
    { "medium", test_medium, false },
    { "parts", test_parts, false },
    { NULL, NULL, false }
};
