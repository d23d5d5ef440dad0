/* test_physics_exact.c -- expectations without noise, by the enumerating sampler.
 *
 * Roulette    leaves every expectation as it is: the mean over its outcomes, all else fixed, is
 *             what the path gives without it, in any scene; and in a furnace the known sum.
 * Lights      the mean over which light is asked is the sum of all.
 * Splits      a dielectric gives F of what is above and (1 - F) / eta^2 of what is below; a
 *             mixture of lobes uses the shares that its density states.
 * MIS         the weight of one path, from the densities of both ways by first principles.
 * Where all numbers are powers of two the results are exact to 1e-12; else to the roundings of the
 * few products and to 2^-24, the grain of canonical numbers, for each choice. */
#include "geometry/generate.h"
#include "lightsampling/lightsampler.h"
#include "sampling/warp.h"
#include "test/enumerate.h"
#include "test/physics.h"

#include <stdio.h>
#include <string.h>

#define GRAINS ROUNDINGS(64)

static Enumeration enumeration(DecisionKind kind, EnumerateRule rule, uint32_t n, uint64_t seed)
{
    Enumeration e;
    memset(&e, 0, sizeof e);
    e.rule[kind] = rule;
    e.n[kind] = n;
    e.seed = seed;
    return e;
}

static void expect_equal(const double *is, const double *truth, double relative, const char *what)
{
    for (int c = 0; c < 3; c++)
        EXPECT(fabs(is[c] - truth[c]) <= relative * fabs(truth[c]), "%s, channel %d: %.15g, it is "
               "%.15g, off by %.2g", what, c, is[c], truth[c], is[c] / truth[c] - 1);
}

/* ---- the radiance of a path as a function of its decisions ---- */

typedef struct { Lab *lab; Ray ray; int length; } Seen;        /* length 0: of all paths */

static void radiance(void *of, Sampler *s, double *values)
{
    Seen *x = of;
    Tally tally;
    Tracer t;
    Rgb L;

    memset(&t, 0, sizeof t);
    memset(&tally, 0, sizeof tally);
    t.scene = x->lab->scene;
    t.sampler = *s;
    t.tally = &tally;
    L = x->lab->integrator->kind->radiance(x->lab->integrator, &x->ray, &t);
    if (x->length)
        L = tally.length[x->length];
    values[0] = (double)L.r;
    values[1] = (double)L.g;
    values[2] = (double)L.b;
}

static void radiance_mean(Lab *l, Ray ray, int length, Enumeration *e, double *mean)
{
    Seen x;

    x.lab = l;
    x.ray = ray;
    x.length = length;
    enumerate_mean(e, radiance, &x, mean);
}

/* ---- roulette ---- */

static void furnace(Lab *l, const char *reflectance)
{
    uint32_t shape;
    lab_init(l);
    shape = lab_sphere(l, v_all(0), 1, lab_material(l, "diffuse", reflectance), true);
    lab_shine(l, shape, "L=1/2/4");
    lab_build(l);
}

static void roulette_furnace(void)
{
    static const struct {
        const char *reflectance, *options;
        double rho[3];
        int depth, cells;
    } f[] = {
        { "reflectance=0.5/0.25/0.125", "strategy=implicit,maxdepth=8,roulette=1",
          { 0.5, 0.25, 0.125 }, 8, 2 },
        { "reflectance=0.8/0.5/0.3", "strategy=implicit,maxdepth=3,roulette=1",
          { 0.8, 0.5, 0.3 }, 3, 0 },
        { "reflectance=0.3/0.9/0.6", "strategy=implicit,maxdepth=5,roulette=3",
          { 0.3, 0.9, 0.6 }, 5, 0 },
    };
    for (int i = 0; i < 3; i++) {
        Enumeration e = enumeration(DECIDE_ROULETTE, f[i].cells ? CELLS : STEPS,
                                    f[i].cells ? (uint32_t)f[i].cells : 1, 61);
        double mean[ENUMERATE_VALUES], truth[3] = { 0, 0, 0 };
        Lab l;
        furnace(&l, f[i].reflectance);
        lab_open(&l, f[i].options);
        radiance_mean(&l, ray_towards(v_all(0), v3(1, 2, 3)), 0, &e, mean);
        for (int n = f[i].depth; n >= 0; n--)
            for (int c = 0; c < 3; c++)
                truth[c] = (1 << c) + f[i].rho[c] * truth[c];
        expect_equal(mean, truth, f[i].cells ? 1e-12 : GRAINS, f[i].options);
        EXPECT(e.runs > 10, "roulette was played %.0f times", (double)e.runs);
        lab_clear(&l);
    }
}

/* A room with two lamps, a ball of glass and a glossy one; many paths, each with and without
 * roulette. */
static void room(Lab *l)
{
    uint32_t grey;
    Mesh m = { 0 };

    lab_init(l);
    grey = lab_material(l, "diffuse", "reflectance=0.7/0.6/0.4");
    REQUIRE(mesh_cube(&m), "cube");
    mesh_move(&m, 2, v_all(0));
    lab_mesh(l, &m, grey, true);
    lab_sphere(l, v3(-0.4f, 0.3f, -0.5f), 0.4f, lab_material(l, "dielectric", "eta=1.5"), false);
    lab_sphere(l, v3(0.5f, 0.1f, -0.6f), 0.3f, lab_material(l, "phong", "exponent=20"), false);
    lab_shine(l, lab_quad(l, v3(-0.8f, -0.8f, 0.95f), v3(0, 1.6f, 0), v3(1.6f, 0, 0), grey),
              "L=1/2/4");
    lab_light(l, "point", "I=0.5,from=0.2/-0.6/0.1", NULL);
    lab_build(l);
}

static void roulette_room(void)
{
    static const char *const options[] = { "maxdepth=4", "maxdepth=4,strategy=explicit",
                                           "maxdepth=4,heuristic=balance" };
    int lit = 0;
    Lab l;

    room(&l);
    for (int i = 0; i < 3; i++)
        for (uint64_t seed = 0; seed < 30; seed++) {
            Enumeration played = enumeration(DECIDE_ROULETTE, STEPS, 1, seed), none = played;
            double with[ENUMERATE_VALUES], without[ENUMERATE_VALUES];
            V2 u = enumerate_fixed(&played, DECISION(DECIDE_PIXEL, 0));
            Ray r = { .o = { 0, -0.9f, 0.3f }, .d = warp_sphere(u), .tmax = INFINITY };
            char text[100];

            snprintf(text, sizeof text, "%s,roulette=%d", options[i], i < 2 ? 1 : 2);
            lab_open(&l, text);
            radiance_mean(&l, r, 0, &played, with);
            snprintf(text, sizeof text, "%s,roulette=100", options[i]);
            lab_open(&l, text);
            radiance_mean(&l, r, 0, &none, without);
            expect_equal(with, without, GRAINS, options[i]);
            lit += without[0] > 0;
        }
    EXPECT(lit > 45, "only %d paths carry light", lit);
    lab_clear(&l);
}

/* ---- which light ---- */

static void begin_floor(Lab *l)
{
    lab_init(l);
    lab_quad(l, v3(-5, -5, 0), v3(10, 0, 0), v3(0, 10, 0),
             lab_material(l, "diffuse", "reflectance=1"));
}

static Ray floor_ray(void) { return ray_towards(v3(-1, -1, 1), v3(0.1f, 0.2f, 0)); }

static void light_choice(void)
{
    static const double I[4] = { 1, 2, 5, 8 };
    static const V3 at[4] = { { 0, 0, 1 }, { 1, 0.5f, 0.7f }, { -1, 2, 2 }, { 0.3f, -1, 0.5f } };
    static const char *const options[] = {
        "strategy=explicit,maxdepth=1,roulette=9,lightsampler=power",
        "strategy=mis,maxdepth=1,roulette=9,lightsampler=power",
        "strategy=explicit,maxdepth=1,roulette=9,lightsampler=uniform",
        "strategy=mis,maxdepth=1,roulette=9,lightsampler=uniform",
    };
    double truth[3] = { 0, 0, 0 };
    Lab l;

    begin_floor(&l);
    for (int k = 0; k < 4; k++) {
        double x = at[k].x - 0.1, y = at[k].y - 0.2, z = at[k].z, d2 = x * x + y * y + z * z;
        char text[100];
        snprintf(text, sizeof text, "I=%g/%g/%g,from=%g/%g/%g", I[k], 2 * I[k], 0.5 * I[k],
                 (double)at[k].x, (double)at[k].y, (double)at[k].z);
        lab_light(&l, "point", text, NULL);
        truth[0] += I[k] * z / (d2 * sqrt(d2)) / PI;
        truth[1] += 2 * I[k] * z / (d2 * sqrt(d2)) / PI;
        truth[2] += 0.5 * I[k] * z / (d2 * sqrt(d2)) / PI;
    }
    lab_build(&l);
    for (int i = 0; i < 4; i++)
        for (int cells = 0; cells < 2; cells++) { /* powers add up to 16, uniform shares are 1/4 */
            Enumeration e = enumeration(DECIDE_LIGHT, cells ? CELLS : STEPS, cells ? 16 : 4, 62);
            double mean[ENUMERATE_VALUES];
            lab_open(&l, options[i]);
            radiance_mean(&l, floor_ray(), 0, &e, mean);
            expect_equal(mean, truth, GRAINS, options[i]);
        }
    lab_clear(&l);
}

/* Lights with extent, each point on them fixed: the mean of a choice is the sum of the lights
 * alone. All of the shapes are always there, since they hide each other. */
static void add_lights(Lab *l, int only)
{
    uint32_t black = lab_material(l, "diffuse", "reflectance=0");
    uint32_t quad = lab_quad(l, v3(-1, -1, 2), v3(0, 1, 0), v3(1, 0, 0), black);
    uint32_t ball = lab_sphere(l, v3(1.5f, 1, 1), 0.5f, black, false);
    uint32_t disc = lab_disk(l, v3(-1, 1.5f, 1), v3(0.5f, -0.5f, -1), 0.4f, 0, black);

    if (only < 0 || only == 0)
        lab_shine(l, quad, "L=1/2/3");
    if (only < 0 || only == 1)
        lab_shine(l, ball, "L=3/2/1");
    if (only < 0 || only == 2)
        lab_shine(l, disc, "L=9/1/3");
    if (only < 0 || only == 3)
        lab_light(l, "infinite", "L=0.2/0.3/0.4", NULL);
}

static void light_choice_areas(void)
{
    for (uint64_t seed = 0; seed < 20; seed++)
        for (int uniform = 0; uniform < 2; uniform++) {
            const char *options =
                uniform ? "strategy=explicit,maxdepth=1,roulette=9,lightsampler=uniform"
                        : "strategy=explicit,maxdepth=1,roulette=9";
            double sum[3] = { 0, 0, 0 }, mean[ENUMERATE_VALUES];
            for (int k = -1; k < 4; k++) {
                Enumeration e = enumeration(DECIDE_LIGHT, STEPS, 8, seed);
                Lab l;
                begin_floor(&l);
                add_lights(&l, k);
                lab_build(&l);
                lab_open(&l, options);
                if (k < 0)
                    radiance_mean(&l, floor_ray(), 2, &e, mean);
                else {
                    double alone[ENUMERATE_VALUES];
                    radiance_mean(&l, floor_ray(), 2, &e, alone);
                    for (int c = 0; c < 3; c++)
                        sum[c] += alone[c];
                }
                lab_clear(&l);
            }
            expect_equal(mean, sum, GRAINS, options);
        }
}

/* ---- reflect or transmit ---- */

static Rgb two_halves(V3 w) { return w.z > 0 ? rgb(1, 2, 4) : rgb(8, 3, 1); }

/* Fresnel's reflectance from the two amplitudes; c1 on the side of index n1. */
static double fresnel(double n1, double n2, double c1)
{
    double s2 = n1 / n2 * sqrt(1 - c1 * c1), c2, rs, rp;
    if (s2 >= 1)
        return 1;
    c2 = sqrt(1 - s2 * s2);
    rs = (n1 * c1 - n2 * c2) / (n1 * c1 + n2 * c2);
    rp = (n2 * c1 - n1 * c2) / (n2 * c1 + n1 * c2);
    return 0.5 * (rs * rs + rp * rp);
}

/* A single surface of glass between two halves of a sky, seen from both sides. */
static void glass_split(void)
{
    static const double angle[] = { 1, 20, 40, 45, 60, 80, 89 };
    Lab l;

    lab_init(&l);
    lab_quad(&l, v3(-5, -5, 0), v3(10, 0, 0), v3(0, 10, 0),
             lab_material(&l, "dielectric",
                          "eta=1.5,reflectance=1/0.5/0.25,transmittance=0.5/1/0.75"));
    lab_sky(&l, 4, 2, two_halves, NULL);
    lab_build(&l);
    lab_open(&l, "strategy=implicit,maxdepth=1,roulette=9");
    for (int below = 0; below < 2; below++)
        for (size_t i = 0; i < sizeof angle / sizeof *angle; i++) {
            Enumeration e = enumeration(DECIDE_LOBE, STEPS, 1, 63);
            double c = md_cos(angle[i] * PI / 180), s = md_sin(angle[i] * PI / 180);
            double eta = below ? 1 / 1.5 : 1.5, F, truth[3], mean[ENUMERATE_VALUES];
            V3 eye = v3((float)(2 * s), 0.1f, (float)(below ? -2 * c : 2 * c));
            Ray r = ray_towards(eye, v3(0, 0.1f, 0));
            const double up[3] = { 1, 2, 4 }, down[3] = { 8, 3, 1 };
            const double R[3] = { 1, 0.5, 0.25 }, T[3] = { 0.5, 1, 0.75 };
            char text[60];

            c = fabs((double)r.d.z);
            F = fresnel(1, eta, c);
            for (int k = 0; k < 3; k++)
                truth[k] = F * R[k] * (below ? down[k] : up[k]) +
                           (1 - F) * T[k] / (eta * eta) * (below ? up[k] : down[k]);
            radiance_mean(&l, r, 0, &e, mean);
            snprintf(text, sizeof text, "%g degrees %s", angle[i], below ? "inside" : "outside");
            /* near the critical angle and at grazing F is steep in the rounded direction */
            expect_equal(mean, truth, 20 * GRAINS, text);
        }
    lab_clear(&l);
}

/* ---- lobes of a mixture ---- */

typedef struct { Bsdf b; V3 wo; V2 u; } Lobes;

/* Chances of the two branches, told apart by where the sample goes; weights of delta events. */
static void lobe_event(void *of, Sampler *s, double *values)
{
    const Lobes *x = of;
    BsdfSample first, bs;
    float lobe = sample_1d(s, DECISION(DECIDE_LOBE, 0));
    bool ok = x->b.kind->sample(&x->b, x->wo, lobe, x->u, false, &bs);

    x->b.kind->sample(&x->b, x->wo, 0, x->u, false, &first);
    values[0] = ok && !memcmp(&bs.wi, &first.wi, sizeof bs.wi);
    values[1] = ok && (bs.flags & BSDF_SPECULAR) ? (double)bs.weight.g : 0;
}

static void set_lobes(Lab *l, Lobes *x, const char *kind, const char *options, uint64_t seed)
{
    uint32_t m = lab_material(l, kind, options);
    const Surface somewhere = { .uv = { 0, 0 } };
    BsdfRoom room;
    Rng rng = rng_seed(seed);
    V2 u;

    x->b = *material_bsdf(&l->scene->materials[m], &somewhere, &room);
    u.x = rng_unit(&rng);
    u.y = rng_unit(&rng);
    x->wo = warp_hemisphere(u);
    x->u.x = 0.4f + 0.2f * rng_unit(&rng);      /* mild, so that no branch goes below the surface */
    x->u.y = 0.4f + 0.2f * rng_unit(&rng);
}

/* Phong: chance of the lobe, and the density as the mixture with just that chance. */
static void phong_lobes(void)
{
    double ls = 0.299 * 0.2 + 0.587 * 0.5 + 0.114 * 0.1;
    double ld = 0.299 * 0.5 + 0.587 * 0.2 + 0.114 * 0.4;
    double share = ls / (ls + ld);
    Lab l;

    lab_init(&l);
    for (uint64_t seed = 0; seed < 20; seed++) {
        Enumeration e = enumeration(DECIDE_LOBE, STEPS, 1, 0);
        double chance[ENUMERATE_VALUES], cosine, alpha, pdf;
        BsdfSample s;
        Lobes x;

        set_lobes(&l, &x, "phong", "reflectance=0.5/0.2/0.4,specular=0.2/0.5/0.1,exponent=12",
                  seed);
        enumerate_mean(&e, lobe_event, &x, chance);
        REQUIRE(x.b.kind->sample(&x.b, x.wo, 0, x.u, false, &s), "absorbed");
        EXPECT(fabs(chance[0] - share) <= 2e-7, "chance of the lobe %.9g, it is %.9g", chance[0],
               share);
        alpha = -(double)x.wo.x * s.wi.x - (double)x.wo.y * s.wi.y + (double)x.wo.z * s.wi.z;
        cosine = (double)s.wi.z;
        pdf = (1 - share) * cosine / PI + share * 13 / (2 * PI) * md_pow(alpha > 0 ? alpha : 0, 12);
        EXPECT(fabs((double)s.pdf_w / pdf - 1) <= 1e-5, "density %.9g, it is %.9g", (double)s.pdf_w,
               pdf);
    }
    lab_clear(&l);
}

/* A smooth coat reflects Fresnel's share, whatever chance it is given. */
static void coat_lobes(void)
{
    Lab l;

    lab_init(&l);
    for (uint64_t seed = 0; seed < 20; seed++) {
        Enumeration e = enumeration(DECIDE_LOBE, STEPS, 1, 0);
        double mean[ENUMERATE_VALUES], F;
        Lobes x;

        set_lobes(&l, &x, "coateddiffuse", "reflectance=0.6,eta=1.4", seed);
        enumerate_mean(&e, lobe_event, &x, mean);
        F = fresnel(1, 1.4, (double)x.wo.z);
        EXPECT(fabs(mean[1] - F) <= 20 * GRAINS, "the coat reflects %.9g, it is %.9g", mean[1], F);
    }
    lab_clear(&l);
}

const TestCase test_physics_exact[] = {
    { "roulette_furnace", roulette_furnace, false },
    { "roulette_room", roulette_room, false },
    { "light_choice", light_choice, false },
    { "light_choice_areas", light_choice_areas, false },
    { "glass_split", glass_split, false },
    { "phong_lobes", phong_lobes, false },
    { "coat_lobes", coat_lobes, false },
    { NULL, NULL, false }
};
