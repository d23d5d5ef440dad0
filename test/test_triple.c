/* test_triple.c -- direct:strategy=triple: maps of visibility are a guide and never the light.
 *
 * Toy         an integral over the square whose map is wrong: the estimate is right for any zones,
 *             n, a and size, and where all is said to be occluded. Errata 6.0 to 6.2.
 * Pictures    a sky without shadows, a room with a hole, thin bars: every unbiased variant gives
 *             what other strategies give, by tiles; with other lights, mirrors and media beside.
 * Biased      how far off the others are: little, and to the dark side.
 * Pays        less noise than two stage sampling with as many samples, made beforehand or learned.
 * Bytes       the same for 1, 2 and 5 threads, for windows, a pixel, one sample, by policies. */
#include "base/random.h"
#include "lightsampling/visibility.h"
#include "test/pictures.h"

#include <stdio.h>
#include <string.h>

enum { SIDE = 32 };

typedef struct { const char *method; uint32_t spp; double delta; } Way;

static void expect_agreement(Lab *l, const char *truth, uint32_t spp, const Way *way)
{
    Series first, other;

    messages_quiet(true);
    series_render(l, &first, truth, SIDE, spp, 300);
    for (uint64_t i = 0; way[i].method; i++) {
        series_render(l, &other, way[i].method, SIDE, way[i].spp, 301 + i);
        series_expect_same(&other, &first, way[i].delta, way[i].method);
        series_clear(&other);
    }
    series_clear(&first);
}

/* ---- the toy ---- */

/* Integral 0.36496: over x < 0.6, and over y > 0.9 of the rest. */
static double toy_light(V2 u)
{
    return u.x < 0.6f || u.y > 0.9f ? 6.0 * (double)u.x * (double)u.x * (double)u.y : 0.0;
}

/* Zones by a picture that has little to do with it. */
static void toy_map(int size, bool nothing, VisibilityMap *m)
{
    static const uint32_t crop[4] = { 0, 0, 1, 1 };
    bool visible[VISIBILITY_MOST * VISIBILITY_MOST];
    Visibility v;
    Film f;

    for (int i = 0; i < size * size; i++)
        visible[i] = !nothing && i % size < size / 3;
    REQUIRE(film_init(&f, 1, 1, crop, 1) && visibility_init(&v, &f, size, 8, false, false),
            "memory");
    for (uint32_t k = 0; k < visibility_maps(&v); k++)
        visibility_make(&v, k, visible);
    visibility_at(&v, 0, 0, m);
    visibility_clear(&v);
    film_clear(&f);
}

static void toy_measure(const VisibilityMap *m, int n, float a, Rng *r, const char *what)
{
    Thinning t = thinning_of(n, (float)m->open / (float)(m->size * m->size), a);
    Stat s = { 0, 0, 0, 0, 0 };
    int runs = (test_is_long() ? 16 : 1) * (60000 / n);

    for (int k = 0; k < runs; k++) {
        double sum = 0;
        for (int i = 0; i < t.points; i++) {
            V2 u = { rng_unit(r), rng_unit(r) };
            float weight;
            if (thinning_keeps(&t, visibility_zone(m, u), rng_unit(r), &weight))
                sum += (double)weight * toy_light(u);
        }
        stat_add(&s, sum);
    }
    stat_expect(&s, 0.36496, 0.2, what);
}

static void toy(void)
{
    static const int sizes[] = { 1, 2, 5, 16, 64 };
    static const float as[] = { 0.25f, 0.5f, 1 };
    Rng r = rng_seed(3);

    for (int i = 0; i < 5; i++)
        for (int nothing = 0; nothing < 2; nothing++) {
            VisibilityMap m;
            toy_map(sizes[i], nothing, &m);
            EXPECT(!nothing || m.open == 0, "nothing is open");
            for (int k = 0; k < 3; k++) {
                char what[80];
                snprintf(what, sizeof what, "size %d, a %g, %d open", sizes[i], (double)as[k],
                         m.open);
                toy_measure(&m, i % 2 ? 16 : 5, as[k], &r, what);
            }
        }
}

/* ---- scenes ---- */

static Rgb cloudy(V3 w)
{
    float c = f_max(0, 0.58f * w.x - 0.48f * w.y + 0.66f * w.z), bright = f_sqr(f_sqr(c));
    return rgb_scale(rgb(0.5f, 0.7f, 1), w.z > 0 ? 0.5f + 3 * bright : 0.05f);
}

static void add_floor(Lab *l)
{
    lab_quad(l, v3(-3, -3, 0), v3(6, 0, 0), v3(0, 6, 0),
             lab_material(l, "phong", "reflectance=0.4/0.3/0.2,specular=0.4,exponent=20"));
    lab_camera(l, v3(0, -4, 1.4f), v3(0, 0, 0.3f), 45, "");
}

static void open_sky(void)
{
    static const Way ways[] = {
        { "direct:strategy=triple,samples=4", 2, 0.02 },
        { "direct:strategy=triple,samples=4,lazy=true", 2, 0.02 },
        { NULL, 0, 0 }
    };
    Transform turn = xf_rotate(30, 0, 0, 1);
    Lab l;

    lab_init(&l);
    add_floor(&l);
    lab_sky(&l, 32, 16, cloudy, &turn);
    lab_build(&l);
    expect_agreement(&l, "path:maxdepth=1", 32, ways);
    lab_clear(&l);
}

/* Under a roof with a hole, before a ball and a wall. */
static void add_room(Lab *l, float hole)
{
    uint32_t grey = lab_material(l, "diffuse", "reflectance=0.6");

    add_floor(l);
    lab_sphere(l, v3(0.6f, 0.3f, 0.5f), 0.5f, lab_material(l, "conductor", "roughness=0.3"), false);
    lab_quad(l, v3(-3, 2, 0), v3(6, 0, 0), v3(0, 0, 2), grey);
    lab_quad(l, v3(-3, -6, 0), v3(0, 0, 2), v3(0, 8, 0), grey);
    lab_quad(l, v3(3, -6, 0), v3(0, 8, 0), v3(0, 0, 2), grey);
    lab_quad(l, v3(-3, -6, 0), v3(6, 0, 0), v3(0, 0, 2), grey);
    lab_quad(l, v3(-3, -6, 2), v3(0, 8, 0), v3(3 - hole, 0, 0), grey);
    lab_quad(l, v3(hole, -6, 2), v3(0, 8, 0), v3(3 - hole, 0, 0), grey);
    lab_quad(l, v3(-hole, -6, 2), v3(0, 6 - hole, 0), v3(2 * hole, 0, 0), grey);
    lab_quad(l, v3(-hole, hole, 2), v3(0, 2 - hole, 0), v3(2 * hole, 0, 0), grey);
    lab_sky(l, 32, 16, cloudy, NULL);
}

static void room(void)
{
    static const Way ways[] = {
        { "direct:strategy=triple,samples=8", 2, 0.06 },
        { "direct:strategy=triple,samples=8,lazy=true", 2, 0.06 },
        { "direct:strategy=triple,samples=8,space=world", 2, 0.07 },
        { "direct:strategy=triple,samples=3,a=0.1,size=7,spacing=3", 3, 0.09 },
        { NULL, 0, 0 }
    };
    Lab l;

    lab_init(&l);
    add_room(&l, 0.7f);
    lab_build(&l);
    expect_agreement(&l, "direct:strategy=light,maxdepth=1", 48, ways);
    lab_clear(&l);
}

/* The same with more of everything, for a long run. Numbers of the sampler that are spread over a
 * pixel's samples, and maps that learn from the pixels around, must not find each other. */
static void room_long(void)
{
    static const Way ways[] = {
        { "direct:strategy=twostage,samples=8", 4, 0.06 },
        { "direct:strategy=triple,samples=8,lazy=true,space=world", 4, 0.06 },
        { "direct:strategy=triple,samples=5,size=1", 4, 0.08 },
        { "direct:strategy=triple,samples=5,size=64,spacing=30", 4, 0.1 },
        { "direct:strategy=triple,samples=5,a=1,spacing=1,size=4", 4, 0.08 },
        { "direct:strategy=triple,samples=1,lazy=true,a=0.01", 24, 0.16 },
        { "direct:strategy=triple,samples=6,lazy=true@halton", 8, 0.05 },
        { "direct:strategy=triple,samples=6,lazy=true@random", 8, 0.06 },
        { NULL, 0, 0 }
    };
    Lab l;

    lab_init(&l);
    add_room(&l, 0.5f);
    lab_build(&l);
    expect_agreement(&l, "path:maxdepth=1", 192, ways);
    lab_clear(&l);
}

/* Bars between which the sky is seen: whatever maps say of it is wrong a pixel further on. Lamps, a
 * second sky and a mirror are there too, bumps, and a surface that light passes through. */
static void add_bars(Lab *l)
{
    uint32_t grey = lab_material(l, "diffuse", "reflectance=0.5"), black;

    black = lab_material(l, "diffuse", "reflectance=0");
    add_floor(l);
    for (int i = -6; i <= 6; i++)
        lab_quad(l, v3(0.25f * (float)i, -2, 0.7f), v3(0, 4, 0), v3(0.15f, 0, 0), grey);
    lab_quad(l, v3(-1.5f, 1, 0), v3(2, 0, 0), v3(0, 0, 1),
             lab_material(l, "diffusetransmission", "reflectance=0.3,transmittance=0.5"));
    lab_sphere(l, v3(0.8f, -0.6f, 0.4f), 0.4f, lab_material(l, "mirror", "reflectance=0.8"), false);
    lab_shine(l, lab_quad(l, v3(-1, -1, 1.2f), v3(0, 0.3f, 0), v3(0.3f, 0, 0), black), "L=6/5/4");
    lab_light(l, "infinite", "L=0.1/0.1/0.2", NULL);
    lab_light(l, "distant", "L=0.2,from=-1/-1/2,to=0/0/0", NULL);
    lab_sky(l, 32, 16, cloudy, NULL);
}

static void bars(void)
{
    static const Way ways[] = {
        { "direct:strategy=triple,samples=4,spacing=16,size=8,maxdepth=3", 3, 0.03 },
        { "direct:strategy=triple,samples=4,lazy=true,maxdepth=3", 3, 0.03 },
        { NULL, 0, 0 }
    };
    Lab l;

    lab_init(&l);
    add_bars(&l);
    lab_build(&l);
    expect_agreement(&l, "direct:strategy=mis,maxdepth=3", 48, ways);
    lab_clear(&l);
}

/* Fog without an end takes all the light of the sky, for maps too; lamps are left. */
static void fog(void)
{
    static const Way ways[] = {
        { "direct:strategy=triple,samples=4,maxdepth=1", 8, 0.06 },
        { "direct:strategy=triple,samples=4,maxdepth=1,lazy=true,space=world", 8, 0.06 },
        { NULL, 0, 0 }
    };
    Medium thin = { "fog", { 0.02f, 0.05f, 0.05f }, { 0.1f, 0.1f, 0.07f }, 0.4f };
    uint32_t medium;
    Lab l;

    lab_init(&l);
    add_room(&l, 0.8f);
    lab_shine(&l, lab_quad(&l, v3(-1, -1, 1.8f), v3(0, 1, 0), v3(1, 0, 0),
                           lab_material(&l, "diffuse", "reflectance=0")), "L=6/5/4");
    REQUIRE(scene_add_medium(l.scene, &thin, &medium), "memory");
    l.scene->around = medium;
    lab_build(&l);
    expect_agreement(&l, "direct:strategy=light,maxdepth=1", 96, ways);
    lab_clear(&l);
}

/* ---- one picture: its mean, and its noise ---- */

typedef struct { double mean, noise; } Looks;

/* Noise: root of the mean squared difference of two pictures, over root two and their mean. */
static Looks looks_of(Lab *l, const char *method, uint32_t spp)
{
    Looks r = { 0, 0 };
    RenderSettings s;
    RenderReport report;
    Image im[2];
    Film film;

    picture_settings(l, &s, method, SIDE, SIDE, spp);
    for (int k = 0; k < 2; k++) {
        s.seed = 50 + (uint64_t)k;
        REQUIRE(image_init(&im[k], SIDE, SIDE), "memory");
        picture_render(l, &s, &film, &report);
        film_picture(&film, 0, &im[k]);
        film_clear(&film);
    }
    for (size_t i = 0; i < (size_t)SIDE * SIDE; i++) {
        double a = rgb_lum(im[0].pixels[i]), b = rgb_lum(im[1].pixels[i]);
        r.mean += 0.5 * (a + b) / (SIDE * SIDE);
        r.noise += 0.5 * (a - b) * (a - b) / (SIDE * SIDE);
    }
    r.noise = sqrt(r.noise) / r.mean;
    image_clear(&im[0]);
    image_clear(&im[1]);
    return r;
}

/* What is believed and not looked at is wrong, but not by much; dimming brings no light. It takes
 * about a thousandth here, which is less than the noise of these means, a quarter of a percent. */
static void biased(void)
{
    Looks truth, preimage, world, dim;
    Lab l;

    messages_quiet(true);
    lab_init(&l);
    add_room(&l, 0.7f);
    lab_build(&l);
    truth = looks_of(&l, "direct:strategy=triple,samples=32", 16);
    preimage = looks_of(&l, "direct:strategy=triple,samples=32,biased=true", 8);
    world = looks_of(&l, "direct:strategy=triple,samples=32,biased=true,space=world", 8);
    dim = looks_of(&l, "direct:strategy=triple,samples=32,lazy=true,dim=true,spacing=32", 8);
    EXPECT(fabs(preimage.mean / truth.mean - 1) < 0.2, "preimage: %g", preimage.mean / truth.mean);
    EXPECT(fabs(world.mean / truth.mean - 1) < 0.1, "world: %g", world.mean / truth.mean);
    EXPECT(dim.mean < 1.01 * truth.mean && dim.mean > 0.8 * truth.mean,
           "dim: %g", dim.mean / truth.mean);
    lab_clear(&l);
}

static void pays(void)
{
    double two, made, lazy, world, believed;
    Lab l;

    messages_quiet(true);
    lab_init(&l);
    add_room(&l, 0.4f);
    lab_build(&l);
    two = looks_of(&l, "direct:strategy=twostage,samples=16", 8).noise;
    made = looks_of(&l, "direct:strategy=triple,samples=16", 8).noise;
    lazy = looks_of(&l, "direct:strategy=triple,samples=16,lazy=true", 8).noise;
    world = looks_of(&l, "direct:strategy=triple,samples=16,space=world", 8).noise;
    believed = looks_of(&l, "direct:strategy=triple,samples=16,biased=true", 8).noise;
    EXPECT(made < 0.85 * two && lazy < 0.87 * two && world < 1.15 * two && believed < made,
           "noise: two stage %.4f, made %.4f, lazy %.4f, world %.4f, believed %.4f", two, made,
           lazy, world, believed);
    lab_clear(&l);
}

/* ---- bytes ---- */

/* Also with maps of a bright texel or two, as the hole is small, and pixels at all edges. */
static void same_bytes(Lab *l, const char *method, const char *policy, uint32_t w, uint32_t h,
                       const uint32_t crop[4], uint32_t spp)
{
    static const int threads[] = { 1, 2, 5 };
    RenderReport report;
    RenderSettings s;
    Film film[3];

    picture_settings(l, &s, method, w, h, spp);
    memcpy(s.crop, crop, sizeof s.crop);
    if (policy) {
        s.adaptive = kind_from_text(adaptives, "policy", policy, &s.adaptive_opts, &l->arena);
        REQUIRE(s.adaptive, "%s", policy);
    }
    for (int k = 0; k < 3; k++) {
        s.threads = threads[k];
        picture_render(l, &s, &film[k], &report);
        EXPECT(films_equal(&film[0], &film[k]), "%s, %s, %u x %u, %u samples: %d threads differ",
               method, policy ? policy : "all alike", w, h, spp, threads[k]);
        EXPECT(film_refused(&film[k], NULL, NULL, NULL) == 0, "%s: bad samples", method);
    }
    for (int k = 0; k < 3; k++)
        film_clear(&film[k]);
}

static void bytes(void)
{
    static const char *const methods[] = {
        "direct:strategy=triple,samples=2", "direct:strategy=triple,samples=2,lazy=true,spacing=5",
        "direct:strategy=triple,samples=2,space=world,size=3",
        "direct:strategy=triple,samples=1,biased=true,spacing=40,size=64",
        "direct:strategy=triple,samples=3,dim=true,a=1,size=1,lazy=true,spacing=1"
    };
    static const uint32_t all[4] = { 0, 0, 41, 35 }, window[4] = { 5, 3, 38, 22 },
                          corner[4] = { 39, 34, 41, 35 }, pixel[4] = { 0, 0, 1, 1 };
    Lab l;

    messages_quiet(true);
    lab_init(&l);
    add_room(&l, 0.15f);
    lab_build(&l);
    for (int i = 0; i < 5; i++) {
        same_bytes(&l, methods[i], NULL, 41, 35, all, 5);
        same_bytes(&l, methods[i], NULL, 41, 35, window, 1);
        same_bytes(&l, methods[i], NULL, 41, 35, corner, 3);
        same_bytes(&l, methods[i], NULL, 1, 1, pixel, 4);
    }
    for (int i = 0; i < 2; i++) {
        same_bytes(&l, methods[i], "neighbours:min=4", 41, 35, window, 8);
        same_bytes(&l, methods[i], "variable:pilot=60,rerender=true", 41, 35, window, 6);
    }
    lab_clear(&l);
}

/* A window has the maps of the whole, if nothing is learned. */
static void windows(void)
{
    const char *method = "direct:strategy=triple,samples=2,biased=true,size=5";
    static const uint32_t window[4] = { 13, 7, 38, 30 };
    RenderReport report;
    RenderSettings s;
    Film whole, part;
    Lab l;

    messages_quiet(true);
    lab_init(&l);
    add_room(&l, 0.5f);
    lab_build(&l);
    picture_settings(&l, &s, method, 41, 35, 2);
    picture_render(&l, &s, &whole, &report);
    memcpy(s.crop, window, sizeof s.crop);
    picture_render(&l, &s, &part, &report);
    for (uint32_t y = part.y0; y < part.y1; y++)
        for (uint32_t x = part.x0; x < part.x1; x++)
            EXPECT(!memcmp(&whole.sums[3 * film_pixel(&whole, x, y)],
                           &part.sums[3 * film_pixel(&part, x, y)], 3 * sizeof *part.sums),
                   "pixel %u, %u is another in the window", x, y);
    film_clear(&whole);
    film_clear(&part);
    lab_clear(&l);
}

/* ---- bad input ---- */

static void refused(void)
{
    RenderReport report;
    RenderSettings s;
    Film film;
    Lab l;

    messages_quiet(true);
    lab_init(&l);                               /* no light beyond: as mis */
    add_floor(&l);
    lab_shine(&l, lab_quad(&l, v3(-1, -1, 1), v3(0, 2, 0), v3(2, 0, 0), 0), "L=1");
    lab_build(&l);
    EXPECT(looks_of(&l, "direct:strategy=triple", 1).mean > 0, "a lamp is forgotten");
    picture_settings(&l, &s, "direct:strategy=triple,biased=true,lazy=true", 8, 8, 1);
    EXPECT(!render(l.scene, &s, &film, &report), "biased and lazy");
    lab_clear(&l);
    lab_init(&l);                               /* no memory for the maps */
    add_room(&l, 0.5f);
    lab_build(&l);
    picture_settings(&l, &s, "direct:strategy=triple,size=64,spacing=1", 300, 300, 1);
    mem_limit(4000000);
    EXPECT(!render(l.scene, &s, &film, &report), "more memory than there is");
    mem_limit(0);
    EXPECT(!film.sums, "a film is left");
    lab_clear(&l);
}

const TestCase test_triple[] = {
    { "toy", toy, false }, { "open_sky", open_sky, false }, { "room", room, false },
    { "room_long", room_long, true }, { "bars", bars, false }, { "fog", fog, true },
    { "biased", biased, false }, { "pays", pays, false },
    { "bytes", bytes, false }, { "windows", windows, false }, { "refused", refused, false },
    { NULL, NULL, false }
};
