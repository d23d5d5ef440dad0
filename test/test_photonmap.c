/* test_photonmap.c -- photons that are kept, what is estimated from them against densities for
 * which the estimate's mean is known, and the pictures that come of it. */
#include "base/mem.h"
#include "base/random.h"
#include "geometry/generate.h"
#include "integrators/photonstore.h"
#include "sampling/warp.h"
#include "test/lamp_help.h"
#include "test/pictures.h"

#include <stdio.h>
#include <string.h>

/* ---- one photon ---- */

static double angle_of(V3 a, V3 b) { return 114.59 * m_asin(0.5f * v_len(v_sub(a, b))); }

static void packing(void)
{
    static const Rgb colours[] = { { 1, 1, 1 }, { 0.7f, 0.01f, 3e5f }, { 1e-20f, 2e-20f, 0 },
                                   { 255.9f, 0.3f, 1 }, { 0.99999f, 0.5f, 0.1f } };
    Rng r = rng_seed(4);

    EXPECT(sizeof(Photon) == 20, "%u bytes", (unsigned)sizeof(Photon));
    for (size_t c = 0; c < sizeof colours / sizeof *colours; c++) {
        const float *truth = &colours[c].r;
        float most = rgb_max(colours[c]);
        double sum[3] = { 0, 0, 0 };
        for (int i = 0; i < 40000; i++) {
            V3 n = warp_sphere((V2){ rng_unit(&r), rng_unit(&r) });
            V3 wi = warp_sphere((V2){ rng_unit(&r), rng_unit(&r) });
            Photon p = photon_of(v3(rng_unit(&r), 1, 2), colours[c], wi, n);
            Rgb f = photon_flux(&p);
            sum[0] += f.r / 40000;
            sum[1] += f.g / 40000;
            sum[2] += f.b / 40000;
            EXPECT(fabsf(f.r - truth[0]) <= most / 127, "%g of %g", (double)f.r, (double)truth[0]);
            EXPECT(angle_of(photon_wi(&p), wi) < 0.25 && angle_of(photon_normal(&p), n) < 4.0,
                   "%g and %g degrees", angle_of(photon_wi(&p), wi),
                   angle_of(photon_normal(&p), n));
        }
        for (int k = 0; k < 3; k++)     /* 5.6 standard errors: steps of at most most / 127 */
            EXPECT(fabs(sum[k] - truth[k]) <= 5.6 * most / 127 / 2 / 200, "colour %u: %g for %g",
                   (unsigned)c, sum[k], (double)truth[k]);
    }
}

/* ---- stores ---- */

static void fill(Lab *l, PhotonStore *s, uint64_t seed)
{
    const SamplerKind *kind = kind_find(samplers, "random");
    uint32_t spp = 1;
    Tracer t;
    Opts none;

    memset(&t, 0, sizeof t);
    t.scene = l->scene;
    opts_default(&none, kind->info.options);
    REQUIRE(sampler_init(&t.sampler, kind, &none, seed, &spp), "sampler");
    for (int stage = 0; stage < PHOTONSTORE_STAGES; stage++)
        for (uint64_t n = photonstore_units(s, stage); n-- > 0;)
            photonstore_run(s, stage, n, &t);
    sampler_clear(&t.sampler);
}

/* In watts. */
static double flux_of(const PhotonStore *s)
{
    double sum = 0;

    for (uint32_t i = 0; i < s->n; i++)
        sum += photon_flux(&s->photons[i]).g;
    return sum / (double)s->paths;
}

/* All that lamps send out comes upon the black ball around them; lamps beyond shine on the stage,
 * of which a ball fills a part of area that is the same from everywhere. */
static void power(void)
{
    static const char *const names[] = { "quad", "disk", "ball", "point", "spot", "distant",
                                         "infinite", "picture" };

    for (int k = 0; k < 8; k++) {
        Stat got = { 0, 0, 0, 0, 0 };
        LightSampler *by;
        double truth;
        uint32_t black;
        Stage stage;
        Lab l;
        lab_init(&l);
        black = lab_material(&l, "diffuse", "reflectance=0");
        lab_sphere(&l, v3(0, 0, 0), 5, black, false);
        switch (k) {
        case 0: lab_shine(&l, lab_quad(&l, v3(-1, -1, 2), v3(0, 2, 0), v3(2, 0, 0), black),
                          "L=4/5/6"); break;
        case 1: lab_shine(&l, lab_disk(&l, v3(1, 0, 2), v3(0.6f, 0, -0.8f), 0.5f, 0.1f, black),
                          "L=4/5/6,twosided=true"); break;
        case 2: lab_shine(&l, lab_sphere(&l, v3(-2, -1, 1), 0.5f, black, false), "L=8/6/4"); break;
        case 3: lab_light(&l, "point", "from=1/-2/3,I=9", NULL); break;
        case 4: lab_light(&l, "spot", "from=2/-2/3,to=0/0/0,I=40,coneangle=35,conedeltaangle=15",
                          NULL); break;
        case 5: lab_light(&l, "distant", "from=1/-1/2,to=0/0/0,L=2", NULL); break;
        case 6: lab_light(&l, "infinite", "L=0.5/0.7/1", NULL); break;
        default: lab_sky(&l, 16, 8, lamp_sky, NULL); break;
        }
        lab_camera(&l, v3(0, -4, 0), v3(0, 0, 0), 45, "");
        lab_build(&l);
        by = lightsampler_open("power", l.scene);
        REQUIRE(by, "memory");
        truth = l.scene->lights[0]->kind->power(l.scene->lights[0]).g;
        stage = stage_of(l.scene);
        if (k >= 5)
            truth *= 25.0 / ((double)stage.radius * stage.radius);
        for (uint64_t seed = 0; seed < 16; seed++) {
            PhotonStore s;
            photonstore_init(&s, by, PHOTONS_ALL, 4000, 3, 1);
            fill(&l, &s, seed);
            EXPECT(s.n > 3500 && s.n < 4500, "%s: %u photons for 4000", names[k], s.n);
            EXPECT(photonstore_bytes(&s) <= 24.0 * s.n, "%u bytes for %u",
                   (unsigned)photonstore_bytes(&s), s.n);
            stat_add_block(&got, flux_of(&s), s.n, 0);
            photonstore_clear(&s);
        }
        stat_expect(&got, truth, k < 5 ? 0.01 : 0.05, names[k]);
        lightsampler_close(by);
        lab_clear(&l);
    }
}

/* Which photons are kept: behind glass and a mirror, by mirrors' light alone, and none of it. */
static void kept(void)
{
    static const char *const names[] = { "all", "indirect", "rough", "caustic" };
    double flux[4], direct, indirect;
    LightSampler *by;
    PhotonStore s;
    Lab l;

    lab_init(&l);
    lab_quad(&l, v3(-3, -3, 0), v3(6, 0, 0), v3(0, 6, 0), lab_material(&l, "diffuse", ""));
    lab_quad(&l, v3(-3, 3, 0), v3(6, 0, 0), v3(0, 0, 3), lab_material(&l, "mirror", ""));
    lab_quad(&l, v3(3, -3, 0), v3(0, 6, 0), v3(0, 0, 3), lab_material(&l, "diffuse", ""));
    lab_sphere(&l, v3(0, 0, 1.2f), 1, lab_material(&l, "dielectric", ""), false);
    lab_light(&l, "point", "from=1/-2/3,I=9", NULL);
    lab_camera(&l, v3(0, -4, 1), v3(0, 0, 0), 45, "");
    lab_build(&l);
    by = lightsampler_open("power", l.scene);
    REQUIRE(by, "memory");
    for (int k = 0; k < 4; k++) {
        photonstore_init(&s, by, (PhotonLight)k, 20000, 9, 4);
        fill(&l, &s, 1);
        flux[k] = flux_of(&s);
        EXPECT(s.n > 18000 && s.n < 22000, "%s: %u photons for 20000", names[k], s.n);
        photonstore_clear(&s);
    }
    indirect = flux[PHOTONS_ROUGH] + flux[PHOTONS_CAUSTIC];
    EXPECT(flux[PHOTONS_ROUGH] > 0 && flux[PHOTONS_CAUSTIC] > 0 &&
           fabs(flux[PHOTONS_INDIRECT] / indirect - 1) < 0.03, "indirect: %g, not %g",
           flux[PHOTONS_INDIRECT], indirect);
    photonstore_init(&s, by, PHOTONS_ALL, 20000, 0, 4);
    fill(&l, &s, 1);
    direct = flux_of(&s);
    EXPECT(fabs(flux[PHOTONS_ALL] / (direct + indirect) - 1) < 0.03, "all: %g, not %g + %g",
           flux[PHOTONS_ALL], direct, indirect);
    photonstore_clear(&s);
    lightsampler_close(by);
    lab_clear(&l);
}

/* ---- estimates ---- */

enum { POINTS = 2000, ASKED = 9 };

/* A store of photons even over the unit square, straight from above, of flux 1 + 2 x^2. */
static void make_even(PhotonStore *s, uint32_t n, uint64_t seed)
{
    Rng r = rng_seed(seed);

    memset(s, 0, sizeof *s);
    s->photons = MEM_ARRAY(Photon, n);
    REQUIRE(s->photons && pointtree_init(&s->tree, s->photons, n, sizeof(Photon)), "memory");
    s->paths = s->n = n;
    for (uint32_t i = 0; i < n; i++) {
        V3 p = v3(rng_unit(&r), rng_unit(&r), 0);
        s->photons[i] = photon_of(p, rgb_all(1 + 2 * p.x * p.x), v3(0, 0, 1), v3(0, 0, 1));
    }
    pointtree_build(&s->tree);
}

static void meet_floor(Lab *l, Vertex *v, V3 at)
{
    Ray r = { .o = { at.x, at.y, 1 }, .d = { 0, 0, -1 }, .tmax = INFINITY };
    Tracer t;

    memset(&t, 0, sizeof t);
    t.scene = l->scene;
    REQUIRE(vertex_meet(v, &r, &t), "nothing there");
}

/* The mean of estimates at ASKED points, less what there is without blur, f taken out; n: of all
 * photons. */
static double excess(Lab *l, const PhotonStore *s, const PhotonLook *look)
{
    double sum = 0;

    for (int i = 0; i < ASKED; i++) {
        V3 at = v3(0.25f + 0.25f * (float)(i % 3), 0.25f + 0.25f * (float)(i / 3), 0);
        Vertex v;
        meet_floor(l, &v, at);
        sum += (double)PI_F / 0.5 * photonstore_radiance(s, look, &v, NULL).g - 1 - 2 * f_sqr(at.x);
    }
    return sum / ASKED;
}

/* mean of d^2 / r^2 under the kernels, over the disc */
static const double spread_of_kernel[] = { 0.5, 0.3, 1.0 / 3.0 };
static const char *const kernel_names[] = { "constant", "cone", "epanechnikov" };

/* Over even photons, (k - 1) / (pi r^2) has the mean N and (k - 1) / (pi r^2) r^2 the mean
 * (k - 1) / pi; inside, photons are even over the disc. So with flux 1 + 2 x^2 the mean estimate is
 * too large by 2 mean(x^2) = r^2 times the above: by (k - 1) / (pi N) with neighbours, by R^2 with
 * a radius. Without the factor (k - 1) / k the excess were about 1 / k of the whole more. */
static void estimates(void)
{
    static const uint32_t ks[] = { 2, 5, 20, 60, 1000 };
    Lab l;

    lab_init(&l);
    lab_quad(&l, v3(0, 0, 0), v3(1, 0, 0), v3(0, 1, 0), lab_material(&l, "diffuse", ""));
    lab_light(&l, "point", "from=0/0/3", NULL);
    lab_build(&l);
    for (int c = 0; c < 15; c++) {
        PhotonLook look = { (Kernel)(c % 3), ks[c / 3], 1 };
        double spread = spread_of_kernel[c % 3], truth;
        Stat got = { 0, 0, 0, 0, 0 };
        char what[80];
        int stores = look.k < 5 ? 1500 : 300;
        if (look.k == 1000)     /* so many are not within */
            look.radius2 = 0.01f;
        truth = look.k == 1000 ? spread * 0.01 : spread * (look.k - 1) / (PI_F * POINTS);
        for (int i = 0; i < stores; i++) {
            PhotonStore s;
            make_even(&s, POINTS, (uint64_t)i);
            stat_add_block(&got, 1 + excess(&l, &s, &look), ASKED, 0);
            photonstore_clear(&s);
        }
        snprintf(what, sizeof what, "%s, %u neighbours", kernel_names[c % 3], look.k);
        stat_expect(&got, 1 + truth, look.k < 5 ? 0.4 : look.k < 20 ? 0.2 : 0.1, what);
    }
    lab_clear(&l);
}

/* The bias by itself: k = 200 of N. From N to 4 N it falls by 4. */
static void slope(void)
{
    PhotonLook look = { KERNEL_CONSTANT, 200, 1 };
    Stat got[2] = { { 0, 0, 0, 0, 0 }, { 0, 0, 0, 0, 0 } };
    Lab l;

    lab_init(&l);
    lab_quad(&l, v3(0, 0, 0), v3(1, 0, 0), v3(0, 1, 0), lab_material(&l, "diffuse", ""));
    lab_light(&l, "point", "from=0/0/3", NULL);
    lab_build(&l);
    for (int k = 0; k < 2; k++)
        for (int i = 0; i < 400; i++) {
            PhotonStore s;
            make_even(&s, k ? 4 * 1500 : 1500, (uint64_t)(7000 * k + i));
            stat_add_block(&got[k], excess(&l, &s, &look), ASKED, 0);
            photonstore_clear(&s);
        }
    for (int k = 0; k < 2; k++) {
        double truth = 0.5 * 199 / (PI_F * 1500 * (k ? 4 : 1));
        EXPECT(fabs(got[k].mean - truth) <= 5.6 * stat_error(&got[k]), "%d: %g, not %g +- %g", k,
               got[k].mean, truth, stat_error(&got[k]));
    }
    EXPECT(got[0].mean > 6 * stat_error(&got[0]), "lost in noise");
    EXPECT(got[0].mean / got[1].mean > 2.5 && got[0].mean / got[1].mean < 6.5,
           "4 times the photons: the bias falls from %g to %g", got[0].mean, got[1].mean);
    lab_clear(&l);
}

/* ---- closed rooms ---- */

/* Within a sphere, whose area within a chord of r is pi r^2, no estimate is biased: the light is
 * L (1 + rho + ... ), whatever photons bring of it, in both views; bright and dark rooms. */
static void furnace(void)
{
    static const char *const views[] = {
        "view=direct,photons=20000", "view=gather,photons=20000,gather=4",
        "view=direct,photons=20000,kernel=constant,neighbours=10",
        "view=direct,photons=500,radius=1e20", "view=gather,photons=2000,neighbours=1024,gather=2",
        "view=direct,photons=20000,neighbours=1024,radius=0.2"
    };

    for (int k = 0; k < 6; k++) {
        RenderSettings s;
        RenderReport report;
        Stat got = { 0, 0, 0, 0, 0 };
        char text[160];
        Lab l;
        lab_init(&l);
        lab_shine(&l, lab_sphere(&l, v3(0, 0, 0), 1, lab_material(&l, "diffuse", "reflectance=0.6"),
                                 true), "L=1");
        lab_camera_of(&l, "spherical", v3(0.2f, 0.1f, 0), v3(1, 0, 0), 90, "");
        lab_build(&l);
        snprintf(text, sizeof text, "photonmap:%s,maxdepth=30", views[k]);
        picture_settings(&l, &s, text, 16, 8, 1);
        for (s.seed = 0; s.seed < 12; s.seed++) {
            Image im;
            Film film;
            double mean = 0;
            picture_render(&l, &s, &film, &report);
            REQUIRE(image_init(&im, 16, 8), "memory");
            film_picture(&film, 0, &im);
            for (int i = 0; i < 128; i++)
                mean += rgb_lum(im.pixels[i]) / 128;
            stat_add_block(&got, mean, 1, 0);
            image_clear(&im);
            film_clear(&film);
        }
        stat_expect(&got, 2.5, k == 3 ? 0.06 : 0.03, views[k]);
        lab_clear(&l);
    }
}

/* ---- pictures ---- */

static void add_room(Lab *l)
{
    uint32_t grey = lab_material(l, "diffuse", "reflectance=0.7/0.6/0.5");

    lab_quad(l, v3(-3, -3, 0), v3(6, 0, 0), v3(0, 6, 0), grey);
    lab_quad(l, v3(-3, 3, 0), v3(6, 0, 0), v3(0, 0, 4), lab_material(l, "diffuse",
                                                                    "reflectance=0.3/0.5/0.7"));
    lab_quad(l, v3(-3, -3, 0), v3(0, 6, 0), v3(0, 0, 4), grey);
    lab_sphere(l, v3(1.2f, 0, 1), 0.9f, lab_material(l, "phong",
               "reflectance=0.3,specular=0.5,exponent=12"), false);
    lab_shine(l, lab_quad(l, v3(-1, -1, 3.9f), v3(0, 2, 0), v3(2, 0, 0),
                          lab_material(l, "diffuse", "reflectance=0")), "L=4/5/6");
    lab_camera(l, v3(0.5f, -7, 3), v3(0, 0, 1.4f), 45, "");
    lab_build(l);
}

typedef struct { double rel, off; } Apart;      /* root of mean squares over the mean; the mean's */

/* Tiles of the means of both. */
static Apart apart(const Series *a, const Series *b)
{
    double squares = 0, sum[2] = { 0, 0 };

    for (uint32_t i = 0; i < a->tiles; i++) {
        double m[2] = { 0, 0 };
        for (int r = 0; r < RUNS; r++) {
            m[0] += a->tile[i * RUNS + (uint32_t)r] / RUNS;
            m[1] += b->tile[i * RUNS + (uint32_t)r] / RUNS;
        }
        squares += (m[0] - m[1]) * (m[0] - m[1]) / a->tiles;
        sum[0] += m[0] / a->tiles;
        sum[1] += m[1] / a->tiles;
    }
    return (Apart){ sqrt(squares) / sum[1], sum[0] / sum[1] - 1 };
}

/* Both views are near `path`, the gather nearer, and nearer with more photons. */
static void views(void)
{
    static const char *const methods[] = {
        "photonmap:view=direct,photons=2000,neighbours=50,radius=9,maxdepth=5",
        "photonmap:view=direct,photons=32000,neighbours=50,radius=9,maxdepth=5",
        "photonmap:view=gather,photons=20000,neighbours=50,gather=8,maxdepth=5",
    };
    Apart by[3];
    Series path, map;
    Lab l;

    lab_init(&l);
    add_room(&l);
    series_render(&l, &path, "path:maxdepth=5,roulette=9", 32, 16, 1);
    for (int k = 0; k < 3; k++) {
        series_render(&l, &map, methods[k], 32, 2, 100 + (uint64_t)k);
        by[k] = apart(&map, &path);
        series_clear(&map);
    }
    EXPECT(by[0].rel < 0.12 && by[1].rel < 0.03 && by[2].rel < 0.02 && fabs(by[2].off) < 0.01,
           "apart %g, %g, %g; gather's mean by %g", by[0].rel, by[1].rel, by[2].rel, by[2].off);
    EXPECT(by[1].rel < 0.5 * by[0].rel, "16 times the photons: from %g to %g", by[0].rel,
           by[1].rel);
    series_clear(&path);
    lab_clear(&l);
}

/* The caustic of a ball of glass, by its own map and by chance, and what the glass shows; also with
 * records of irradiance for the rest. */
static void caustic(void)
{
    static const char *const methods[] = {
        "photonmap:view=direct,photons=5000,caustics=5000,neighbours=30,maxdepth=4",
        "photonmap:view=gather,photons=5000,caustics=5000,neighbours=30,gather=4,maxdepth=4",
        "photonmap:view=direct,photons=8000,neighbours=30,caustics=0,maxdepth=4,radius=0.3",
        "photonmap:view=gather,photons=5000,caustics=0,gather=24,maxdepth=4",
        "irradiancecache:photons=5000,caustics=5000,neighbours=30,rays=100,maxdepth=4",
        "irradiancecache:photons=0,caustics=5000,neighbours=30,rays=100,maxdepth=4",
    };
    Series path, map;
    Lab l;

    lab_init(&l);
    lamp_glass(&l);
    lab_camera(&l, v3(2.2f, -2.5f, 2), v3(1.2f, 0, 0), 40, "");
    lab_build(&l);
    series_render(&l, &path, "path:maxdepth=4", 24, 48, 1);
    for (int k = 0; k < 6; k++) {
        Apart by;
        series_render(&l, &map, methods[k], 24, 2, 30 + (uint64_t)k);
        by = apart(&map, &path);
        EXPECT(by.rel < 0.05 && fabs(by.off) < (k == 2 ? 0.04 : 0.02), "%s: apart %g, %g",
               methods[k], by.rel, by.off);
        series_clear(&map);
    }
    series_clear(&path);
    lab_clear(&l);
}

/* ---- what there may be too little of ---- */

static void same_as(Lab *l, const char *method, const char *other, double most)
{
    Series a, b;
    Apart by;

    series_render(l, &a, method, 16, 4, 1);
    series_render(l, &b, other, 16, 4, 2);
    by = apart(&a, &b);
    EXPECT(by.rel <= most, "%s: apart %g from %s", method, by.rel, other);
    series_clear(&a);
    series_clear(&b);
}

static void little(void)
{
    RenderSettings s;
    RenderReport report;
    Film film;
    Lab l;

    /* light once scattered, and not at all, is nobody's but direct light's */
    lab_init(&l);
    add_room(&l);
    same_as(&l, "photonmap:photons=0", "direct", 0.02);
    same_as(&l, "photonmap:photons=0,view=direct", "direct", 0.02);
    same_as(&l, "photonmap:maxdepth=1", "direct", 0.02);
    same_as(&l, "photonmap:maxdepth=0", "direct:maxdepth=0", 0.03);
    same_as(&l, "photonmap:photons=5000,gather=4,maxdepth=2", "path:maxdepth=2", 0.03);
    same_as(&l, "photonmap:view=direct,photons=1,caustics=1", "direct", 0.5);
    same_as(&l, "photonmap:view=direct,photons=20000,radius=1e-30", "direct", 0.02);
    lab_clear(&l);

    for (int lamps = 0; lamps < 2; lamps++) {   /* none; one that shines on nothing */
        lab_init(&l);
        lab_quad(&l, v3(-3, -3, 0), v3(6, 0, 0), v3(0, 6, 0), lab_material(&l, "diffuse", ""));
        if (lamps)
            lab_light(&l, "spot", "from=0/0/-1,to=0/0/-5,I=9", NULL);
        lab_camera(&l, v3(0.5f, -7, 3), v3(0, 0, 1.4f), 45, "");
        lab_build(&l);
        picture_settings(&l, &s, "photonmap:photons=100", 8, 8, 1);
        picture_render(&l, &s, &film, &report);
        film_clear(&film);
        lab_clear(&l);
    }
}

static void threads(void)
{
    static const char *const methods[] = { "photonmap:photons=30000,caustics=9000,gather=4",
                                           "photonmap:view=direct,strategy=triple,photons=9000" };

    for (int k = 0; k < 2; k++) {
        RenderSettings s;
        RenderReport report;
        Film one, three;
        Lab l;
        lab_init(&l);
        lab_sphere(&l, v3(-1, -1, 1), 0.8f, lab_material(&l, "dielectric", ""), false);
        add_room(&l);
        picture_settings(&l, &s, methods[k], 40, 24, 1);
        picture_render(&l, &s, &one, &report);
        s.threads = 3;
        picture_render(&l, &s, &three, &report);
        EXPECT(films_equal(&one, &three), "threads change the picture");
        film_clear(&one);
        film_clear(&three);
        lab_clear(&l);
    }
}

const TestCase test_photonmap[] = {
    { "packing", packing, false },
    { "power", power, false },
    { "kept", kept, false },
    { "estimates", estimates, false },
    { "slope", slope, false },
    { "furnace", furnace, false },
    { "views", views, false },
    { "caustic", caustic, false },
    { "little", little, false },
    { "threads", threads, false },
    { NULL, NULL, false }
};
