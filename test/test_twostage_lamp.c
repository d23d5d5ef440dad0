/* test_twostage_lamp.c -- two stage importance sampling of lamps with pictures, and by colour.
 *
 * Places      points of rectangles are points of their surface, whatever the order of corners.
 * Densities   draws agree with their densities: six models, three places of the lamp, three
 *             pictures, by luminance and by colour.
 * Light       that of other strategies: pictures with one bright pixel, a black half, a constant
 *             of 1 x 1, large ones; lamps of two sides, focused, with holes, that touch a surface;
 *             with things in between, in fog, several at once, beside a sky with its sun. */
#include "base/mem.h"
#include "integrators/twostage.h"
#include "test/chi2.h"
#include "test/twostage_help.h"

#include <stdio.h>
#include <string.h>

enum { SIDE = 16 };

/* ---- pictures ---- */

static Rgb film(float x, float y)
{
    float c = f_max(0, 1.0f - 9.0f * (f_sqr(x - 0.7f) + f_sqr(y - 0.3f)));
    return rgb(0.2f + 3 * c, 0.2f + 2 * c * x, 0.1f + 0.6f * y);
}
static Rgb half(float x, float y) { return rgb_all(x > 0.5f ? 1.0f + y : 0.0f); }
static Rgb spot(float x, float y)
{
    return rgb_all(fabsf(x - 0.3f) < 0.06f && fabsf(y - 0.6f) < 0.06f ? 50.0f : 0.05f);
}
static Rgb white(float x, float y) { (void)x; (void)y; return rgb(1, 0.8f, 0.6f); }
typedef struct { const char *name; uint32_t w, h; Rgb (*f)(float x, float y); } Picture;
static const Picture pictures[] = {
    { "film", 40, 30, film }, { "black half", 64, 64, half }, { "one bright", 8, 8, spot },
    { "1 x 1", 1, 1, white }, { "large", 2048, 1024, film }
};
enum { NPICTURES = sizeof pictures / sizeof *pictures };

static uint32_t lamp(Lab *l, const Picture *p, bool uv, V3 corner, V3 a, V3 b, const char *options,
                     uint32_t material)
{
    char text[160];
    uint32_t shape = uv ? lab_screen(l, corner, a, b, material)
                        : lab_quad(l, corner, a, b, material);

    snprintf(text, sizeof text, "filename=%s,%s", lab_picture(l, p->w, p->h, p->f), options);
    return lab_shine(l, shape, text);
}

/* ---- places ---- */

/* Triangles whose corners start anywhere, one or both of them turned over. */
static void expect_places(int a, int b, bool turned)
{
    static const int near[3] = { 0, 1, 2 }, far[3] = { 0, 2, 3 };
    V3 corner = { 0.3f, -0.2f, 0.1f }, s = { 1.2f, 0.3f, 0 }, t = { -0.3f, 1.1f, 0.6f };
    Mesh m = { 0 };
    LightRectangle r;
    const Light *l;
    Rng rng;
    Lab lab;

    lab_init(&lab);
    m.p = MEM_ARRAY(V3, 4);
    m.tri = MEM_ARRAY(Tri, 2);
    REQUIRE(m.p && m.tri, "memory");
    m.nverts = 4;
    m.ntris = 2;
    m.p[0] = corner;
    m.p[1] = v_add(corner, s);
    m.p[2] = v_add(m.p[1], t);
    m.p[3] = v_add(corner, t);
    for (int k = 0; k < 3; k++) {
        m.tri[0].v[k] = (uint32_t)near[(a + k) % 3];
        m.tri[1].v[k] = (uint32_t)far[turned ? (b + 3 - k) % 3 : (b + k) % 3];
    }
    {
        char text[80];
        uint32_t shape = lab_mesh(&lab, &m, lab_material(&lab, "diffuse", ""), false);
        snprintf(text, sizeof text, "filename=%s", lab_picture(&lab, 40, 30, film));
        lab_shine(&lab, shape, text);
    }
    lab_build(&lab);
    l = lab.scene->lights[0];
    REQUIRE(l->kind->places && l->kind->places->rectangle(l, &r), "a rectangle: %d %d", a, b);
    EXPECT(r.both == turned, "sides");
    rng = rng_seed(5 + (uint64_t)(16 * (3 * a + b)));
    for (int i = 0; i < 200; i++) {
        V2 q = { rng_unit(&rng), 0 };
        V3 from = { 0.2f, 0.1f, 2.0f }, p;
        LightSample ls;
        Hit h;
        Ray ray;
        q.y = rng_unit(&rng);
        p = v_mad(r.side[0], q.x, v_mad(r.side[1], q.y, r.corner));
        if (!l->kind->places->seen(l, q, from, &ls))
            continue;
        EXPECT(v_len(v_sub(ls.p, p)) < 1e-5f, "place (%g, %g)", (double)q.x, (double)q.y);
        ray = ray_towards(from, ls.p);
        if (scene_nearest(lab.scene, &ray, &h)) {
            Surface surface;
            float pdf_w;
            accel_surface(lab.scene->accel, &ray, &h, &surface);
            pdf_w = l->kind->pdf_w(l, from, ray.d, &surface);
            EXPECT(fabsf(ls.pdf_w / pdf_w - 1) < 1e-3f, "density %g, where it is met %g",
                   (double)ls.pdf_w, (double)pdf_w);
            EXPECT(fabsf(rgb_lum(rgb_sub(ls.L, l->kind->radiance(l, ray.d, &surface)))) < 1e-3f,
                   "radiance");
        }
    }
    lab_clear(&lab);
}

static void places(void)
{
    for (int a = 0; a < 3; a++)
        for (int b = 0; b < 3; b++)
            for (int turned = 0; turned < 2; turned++)
                expect_places(a, b, turned);
}

/* What is no rectangle, or has no picture, is not taken for one. */
static void others(void)
{
    LightRectangle r;
    uint32_t black, i;
    Lab l;

    lab_init(&l);
    black = lab_material(&l, "diffuse", "reflectance=0");
    lab_shine(&l, lab_quad(&l, v3(0, 0, 0), v3(1, 0, 0), v3(0, 1, 0), black), "L=1");
    lab_shine(&l, lab_disk(&l, v3(3, 0, 0), v3(0, 0, 1), 1, 0, black), "L=1");
    i = lamp(&l, &pictures[0], true, v3(0, 0, 2), v3(1, 0, 0), v3(0, 1, 0), "L=1", black);
    lab_build(&l);
    for (uint32_t k = 0; k < 3; k++)
        EXPECT(l.scene->lights[k]->kind->places->rectangle(l.scene->lights[k], &r) == (k == i),
               "light %u", (unsigned)k);
    lab_clear(&l);
}

/* ---- densities ---- */

static PartitionSample drawn(const void *of, Rng *rng)
{
    PartitionSample s;
    V2 u;

    u.x = rng_unit(rng);
    u.y = rng_unit(rng);
    product_draw(of, u, &s);
    return s;
}
static bool draw_place(const void *of, Rng *rng, V3 *w)
{
    PartitionSample s = drawn(of, rng);
    *w = v3(s.place.x, s.place.y, 0);
    return true;
}
static double density_of_place(const void *of, V3 w)
{
    V2 q = { f_min(w.x, ONE_MINUS_ULP), f_min(w.y, ONE_MINUS_ULP) };
    return (double)product_pdf(of, q);
}
static bool draw_direction(const void *of, Rng *rng, V3 *w)
{
    *w = drawn(of, rng).wi;
    return true;
}
static double density_of_direction(const void *of, V3 w)
{
    const Product *p = of;
    float jacobian;
    return (double)product_pdf(p, skymap_place(&p->of->map[0], w, &jacobian));
}

static const char *const models[][2] = {
    { "diffuse", "reflectance=0.5/0.3/0.1" }, { "orennayar", "sigma=40" },
    { "phong", "reflectance=0.1,specular=0.8,exponent=200" },
    { "ashikhminshirley", "reflectance=0.1/0.1/0.5,specular=0.8,nu=1,nv=800" },
    { "dielectric", "eta=1.5,roughness=0.2,remaproughness=false" },
    { "blinn", "reflectance=0,specular=1/0.3/0,exponent=500" }
};

static Rgb sky(V3 w) { return rgb(1.0f + w.x, 0.5f, w.z > 0 ? 1.0f - w.x : 0.1f); }

/* at: where the lamp is; 3: there is a sky, by colour. */
static void density_of(int model, int at, int picture, bool colour)
{
    static const V3 corner[] = { { -0.5f, -0.5f, 1.5f }, { 0.6f, -2, -0.5f }, { -3, 1, 0.01f } };
    static const V3 a[] = { { 0, 1.2f, 0 }, { 0, 4, 0 }, { 6, 0, 0 } };
    static const V3 b[] = { { 1, 0, 0.2f }, { 0, 0, 2 }, { 0, 0.1f, 1 } };
    static const Picture square[] = {           /* cells are bins */
        { "film", 64, 64, film }, { "black half", 64, 64, half }, { "one bright", 32, 32, spot }
    };
    static TwoStage two;
    static Product p;
    bool is_sky = at == 3;
    Ray r = ray_towards(v3(-1.5f, 0.2f, 2), v_all(0));
    Chi2 c = { is_sky ? draw_direction : draw_place, is_sky ? density_of_direction
               : density_of_place, &p, !is_sky, test_is_long() ? 1000000 : 100000, 3,
               64, 64, is_sky ? 2 : 1, 0 };
    V3 peak[TWOSTAGE_PEAKS_MOST];
    char what[120];
    Tracer t;
    Vertex v;
    Turn u;
    Opts o;
    Lab l;
    int n;

    lab_init(&l);
    lab_quad(&l, v3(-2, -2, 0), v3(4, 0, 0), v3(0, 4, 0),
             lab_material(&l, models[model][0], models[model][1]));
    if (is_sky)
        lab_sky(&l, 128, 64, sky, NULL);
    else
        lamp(&l, &square[picture], true, corner[at], a[at], b[at], "twosided=true",
             lab_material(&l, "diffuse", "reflectance=0"));
    lab_build(&l);
    lab_method(&l, colour ? "direct:strategy=twostage,f=colour" : "direct:strategy=twostage", &o);
    REQUIRE(twostage_init(&two, l.scene, &o, false) && two.nasked == 1, "map");
    memset(&t, 0, sizeof t);
    t.scene = l.scene;
    REQUIRE(vertex_meet(&v, &r, &t), "the surface is met");
    u = turn_on(&v, r.d, NO_MEDIUM, 0);
    snprintf(what, sizeof what, "%s, lamp %d, picture %d%s", models[model][0], at, picture,
             colour ? ", colour" : "");
    n = twostage_peaks(&two, &u, 32, &t, peak);
    REQUIRE(product_make(&p, &two.asked[0], &u, peak, n, false, 32), "%s", what);
    c.cols = is_sky ? 128 : 64;
    chi2_expect(&c, what);
    twostage_clear(&two);
    lab_clear(&l);
}

static void densities(void)
{
    density_of(0, 0, 0, true);
    density_of(3, 2, 1, false);
    density_of(5, 3, 0, true);
}

static void all_densities(void)
{
    for (int m = 0; m < 6; m++) {
        for (int at = 0; at < 3; at++)
            for (int k = 0; k < 3; k++) {
                density_of(m, at, k, false);
                density_of(m, at, k, true);
            }
        density_of(m, 3, 0, true);
    }
}

/* ---- light ---- */

static uint32_t black(Lab *l) { return lab_material(l, "diffuse", "reflectance=0"); }

static const Way usual[] = {
    { "direct:strategy=twostage,samples=4", 2, 0.17 },
    { "direct:strategy=twostage,samples=4,f=colour,peaks=sampled", 2, 0.17 },
    { "path:strategy=twostage,maxdepth=1", 6, 0.17 },
    { NULL, 0, 0 }
};

/* Not in the picture. */
static void overhead(Lab *l, const Picture *p, bool uv, const char *options, uint32_t material)
{
    lamp(l, p, uv, v3(-1.2f, -1, 2.6f), v3(0, 2, 0), v3(2.4f, 0, 0.2f), options, material);
}

static void show_pictures(int first, int end)
{
    for (int k = first; k < end; k++) {
        Lab l;
        lab_init(&l);
        add_things(&l, k % 2 == 0);
        overhead(&l, &pictures[k], k != 1, "L=2", black(&l));
        add_eye(&l);
        ways_agree(&l, SIDE, "path:maxdepth=1", k == 2 ? 64 : 16, usual, pictures[k].name);
        lab_clear(&l);
    }
}

static void some_pictures(void) { show_pictures(0, NPICTURES - 1); }
static void large_picture(void) { show_pictures(NPICTURES - 1, NPICTURES); }

/* Half of the rays pass. */
static uint32_t thin(Lab *l)
{
    Texture *t = arena_take(&l->scene->arena, 1, sizeof *t);
    uint32_t m = black(l);

    REQUIRE(t, "memory");
    t->kind = TEXTURE_CONSTANT;
    t->value = rgb_all(0.5f);
    l->scene->materials[m].opacity = t;
    return m;
}

static const Way ways_of_lamps[] = {
    { "direct:strategy=twostage,samples=6", 2, 0.25 },
    { "direct:strategy=triple,samples=6", 2, 0.25 },
    { "path:strategy=twostage,maxdepth=1", 12, 0.25 },
    { NULL, 0, 0 }
};

/* Of two sides, focused, with a mask, standing on the floor. */
static void every_lamp(void)
{
    static const char *const options[] = { "twosided=true,L=2", "exponent=8,L=6", "L=4",
                                           "twosided=true,exponent=2,L=2" };

    for (int k = 0; k < 4; k++) {
        Lab l;
        lab_init(&l);
        add_things(&l, k == 1);
        if (k == 3)
            lamp(&l, &pictures[0], true, v3(-1, -0.8f, 0), v3(0.8f, 0.8f, 0), v3(0, 0.2f, 1.6f),
                 options[k], black(&l));
        else
            overhead(&l, &pictures[0], true, options[k], k == 2 ? thin(&l) : black(&l));
        add_eye(&l);
        ways_agree(&l, SIDE, "path:maxdepth=1", 48, ways_of_lamps, options[k]);
        lab_clear(&l);
    }
}

/* Six screens, of which four have maps, with a plain lamp, a point light, and a sky; in fog; behind
 * glass and in mirrors. */
static void in_company(int first, int end)
{
    static const Way deep[] = {
        { "path:strategy=twostage,maxdepth=4", 16, 0.25 },
        { "path:strategy=twostage,maxdepth=4,f=colour,splits=4", 16, 0.25 },
        { NULL, 0, 0 }
    };
    static const Way foggy[] = {
        { "direct:strategy=twostage,samples=1", 24, 0.35 },
        { "path:strategy=twostage,maxdepth=1", 16, 0.35 },
        { NULL, 0, 0 }
    };
    Medium fog = { "fog", { 0.05f, 0.1f, 0.1f }, { 0.2f, 0.2f, 0.15f }, 0.6f };
    Transform up = xf_translate(0.5, -1, 1.5);

    for (int k = first; k < end; k++) {
        uint32_t index;
        Lab l;
        lab_init(&l);
        add_things(&l, true);
        if (k != 1)
            lab_sky(&l, 32, 16, sky_cloudy, NULL);
        for (int i = 0; i < (k == 0 ? 6 : 2); i++)
            lamp(&l, &pictures[i % 2 * 3], true, v3(-1.5f + 0.5f * (float)i, -1, 2.6f),
                 v3(0, 2, 0), v3(0.4f, 0, 0.1f), "L=2", black(&l));
        lab_shine(&l, lab_disk(&l, v3(0.9f, 0, 1.6f), v3(-0.3f, -0.2f, -1), 0.4f, 0, black(&l)),
                  "L=3/2/1");
        lab_light(&l, "point", "I=0.3/0.3/0.5", &up);
        if (k == 1) {
            REQUIRE(scene_add_medium(l.scene, &fog, &index), "memory");
            l.scene->around = index;
        }
        if (k == 2) {
            lab_sphere(&l, v3(0, -0.8f, 0.4f), 0.4f, lab_material(&l, "dielectric", "eta=1.5"),
                       false);
            lab_quad(&l, v3(1.5f, -1, 0), v3(0, 2, 0), v3(0.2f, 0, 1.5f),
                     lab_material(&l, "mirror", ""));
        }
        add_eye(&l);
        ways_agree(&l, SIDE, k == 2 ? "path:maxdepth=4" : "path:maxdepth=1", 32,
                         k == 2 ? deep : k == 1 ? foggy : ways_of_lamps,
                         k == 0 ? "company" : k == 1 ? "fog" : "glass");
        lab_clear(&l);
    }
}

static void company(void) { in_company(0, 1); }
static void fog_and_glass(void) { in_company(1, 3); }

/* A glossy floor under a screen with a small bright spot: far less noise than by area. */
static void pays(void)
{
    double area, two;
    Lab l;

    lab_init(&l);
    lab_quad(&l, v3(-4, -5, 0), v3(10, 0, 0), v3(0, 10, 0),
             lab_material(&l, "phong", "reflectance=0.2,specular=0.7,exponent=100"));
    lamp(&l, &pictures[2], true, v3(-1, -1, 1.5f), v3(0, 2, 0), v3(2, 0, 0), "", black(&l));
    lab_build(&l);
    two = noise_of(&l, "direct:strategy=twostage,samples=16", 1);
    area = noise_of(&l, "direct:strategy=mis,lightsamples=8,bsdfsamples=8", 1);
    EXPECT(two < 0.2 * area, "two stage: error %.8f, by area and surface: %.8f", two, area);
    lab_clear(&l);
}

const TestCase test_twostage_lamp[] = {
    { "places", places, false }, { "others", others, false },
    { "densities", densities, false }, { "all_densities", all_densities, true },
    { "pictures", some_pictures, false }, { "large", large_picture, true },
    { "lamps", every_lamp, false },
    { "company", company, false }, { "fog_and_glass", fog_and_glass, true },
    { "pays", pays, false },
    { NULL, NULL, false }
};
