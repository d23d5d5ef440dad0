/* test_physics_furnace.c -- closed rooms whose light is known in closed form.
 *
 * Furnace: every wall shines with Le and reflects rho. Each bounce adds Le rho^n, whatever the
 * shape, so L = Le / (1 - rho), and Le (1 - rho^(k+1)) / (1 - rho) up to k bounces. Shapes are not
 * only spheres: there the density of a cosine lobe equals that of a point by area, and a wrong
 * weight of the two ways to find a light goes unseen. Explicit paths alone are tested where their
 * variance is finite: not next to an edge that shines.
 *
 * Zones of a sphere: with shares f of the area, emitted radiance Li and albedo rho_i, the radiance
 * that arrives is the same everywhere, sum f Li / (1 - sum f rho_i), and zone i sends out
 * Li + rho_i times that. A light of power P in a sphere of area A and albedo rho adds the indirect
 * irradiance rho P / (A (1 - rho)) everywhere. */
#include "geometry/generate.h"
#include "test/physics.h"
#include "test/ray_help.h"

#include <stdio.h>

static const double LE[3] = { 1, 2, 4 }, RHO[3] = { 0.1, 0.5, 0.9 };
#define LE_TEXT  "L=1/2/4"
#define RHO_TEXT "reflectance=0.1/0.5/0.9"

/* A room of two lights, a third of the triangles and the others, seen from within. */
static void furnace_of(Lab *l, Mesh *m)
{
    uint32_t material, third = m->ntris / 3;
    Mesh a, b;

    lab_init(l);
    material = lab_material(l, "diffuse", RHO_TEXT);
    mesh_part(&a, m, 0, third);
    mesh_part(&b, m, third, m->ntris);
    lab_shine(l, lab_mesh(l, &a, material, true), LE_TEXT);
    lab_shine(l, lab_mesh(l, &b, material, true), LE_TEXT);
    mesh_clear(m);
    lab_build(l);
}

static void furnace_sphere(Lab *l, V3 centre, float radius)
{
    lab_init(l);
    lab_shine(l, lab_sphere(l, centre, radius, lab_material(l, "diffuse", RHO_TEXT), true),
              LE_TEXT);
    lab_build(l);
}

static void furnace_cube(Lab *l)
{
    Mesh m = { 0 };
    REQUIRE(mesh_cube(&m), "cube");
    furnace_of(l, &m);
}

/* Radiance of all bounces up to k and each by itself: the tally says which. */
static void expect_bounces(const Meter *m, int k, double delta_all, double delta_each,
                           const char *what)
{
    double truth[3] = { LE[0], LE[1], LE[2] }, sum[3] = { 0, 0, 0 };
    char name[200];

    for (int n = 0; n <= k; n++) {
        if (n <= 8) {
            snprintf(name, sizeof name, "%s, bounce %d", what, n);
            stat_expect_rgb(meter_length(m, n + 1), truth, delta_each, name);
        }
        for (int c = 0; c < 3; c++) {
            sum[c] += truth[c];
            truth[c] *= RHO[c];
        }
    }
    stat_expect_rgb(meter_radiance(m), sum, delta_all, what);
    if (k + 2 < TALLY_LENGTHS)
        stat_expect(&meter_length(m, k + 2)[2], 0, 0, "longer than the depth allows");
}

typedef struct { const char *options; int depth; uint64_t n; double delta_all, delta_each; } Way;

static void run_ways(Lab *l, V3 eye, const Way *w, int count, const char *shape)
{
    Gauge g = { ray_anywhere, NULL, 0, 11, 0 };
    char name[200];

    g.of = &eye;
    for (int i = 0; i < count; i++) {
        Meter m;
        snprintf(name, sizeof name, "%s,maxdepth=%d", w[i].options, w[i].depth);
        lab_open(l, name);
        g.n = w[i].n;
        lab_measure(l, &g, &m);
        snprintf(name, sizeof name, "%s: %s to %d", shape, w[i].options, w[i].depth);
        expect_bounces(&m, w[i].depth, w[i].delta_all, w[i].delta_each, name);
    }
}

/* Roulette is off here, so the implicit way has no variance but by a rare path that ends early. */
static const Way ways[] = {
    { "strategy=implicit,roulette=100", 8, 1 << 13, 0.0005, 0.001 },
    { "strategy=mis,heuristic=power,lightsampler=power,roulette=100", 8, 1 << 17, 0.003, 0.01 },
    { "strategy=mis,heuristic=balance,lightsampler=uniform,roulette=100", 8, 1 << 17, 0.003, 0.01 },
    { "strategy=mis,roulette=100", 0, 1 << 10, 0.01, 0.01 },
    { "strategy=mis,roulette=100", 1, 1 << 14, 0.02, 0.03 },
    { "strategy=mis,roulette=100", 2, 1 << 14, 0.02, 0.03 },
};
enum { WAYS = sizeof ways / sizeof *ways };

static void cube(void)
{
    Lab l;
    furnace_cube(&l);
    run_ways(&l, v3(0.1f, 0.05f, 0.2f), ways, WAYS, "cube");
    lab_clear(&l);
}

static void room(void)
{
    Mesh m = { 0 };
    Lab l;
    REQUIRE(mesh_room(&m), "room");
    furnace_of(&l, &m);
    run_ways(&l, v3(0.5f, 0.6f, 0.4f), ways, WAYS, "L-shaped room");
    lab_clear(&l);
}

static void blob(void)
{
    Mesh m = { 0 };
    Lab l;
    REQUIRE(mesh_blob(&m, 7), "blob");
    furnace_of(&l, &m);
    run_ways(&l, v3(0, 0, 0.1f), ways, WAYS, "blob");
    lab_clear(&l);
}

/* In a sphere every way is without variance: cos cos / d^2 is the same for all pairs of points. */
static const Way sphere_ways[] = {
    { "strategy=implicit,roulette=100", 8, 1 << 14, 1e-5, 1e-5 },
    { "strategy=explicit,roulette=100", 8, 1 << 14, 1e-4, 1e-4 },
    { "strategy=mis,roulette=100", 8, 1 << 14, 1e-4, 1e-4 },
    { "strategy=mis,heuristic=balance,lightsampler=uniform,roulette=100", 8, 1 << 14, 1e-4, 1e-4 },
};
enum { SPHERE_WAYS = sizeof sphere_ways / sizeof *sphere_ways };

static void sphere(void)
{
    Lab l;
    furnace_sphere(&l, v3(0, 0, 0), 1);
    run_ways(&l, v3(0.2f, 0.1f, 0.3f), sphere_ways, SPHERE_WAYS, "sphere");
    lab_clear(&l);
}

/* Far from the origin, where the points of a sphere are rounded to coarse steps, what is asked for
 * loses a little light. In a sphere of radius 1 the squared distance q of two points is uniform in
 * (0, 4), for pairs by area and for directions by cosine alike, and asking's value is
 * 4 cos cos / q = 1 of the truth.
 *
 * Rounding. Let x be the part along the normal of how far the one point is rounded against the
 * other. The cosines become (q/2 + x) / sqrt q and (q/2 - x) / sqrt q, the value
 *   r = max(0, 1 - 4 x^2 / q^2),  and  integral dq/4 (r - 1) = -|x|.
 * With steps h_k of the coordinates x has variance sum h_k^2 / 18, so E|x| <= X = sqrt(that). The
 * heuristics see the densities in the ratio r: they give r^2 / (1 + r^2) or r / (1 + r) for r, and
 * lose 0.320 X or 0.406 X of the half that is theirs.
 *
 * Leaving. A ray starts beside its point, D inwards, so one of cosine c arrives at c' with
 * c'^2 = c^2 + 2 D. The density of asking is reckoned from the point: the ratio is r = 1 - y^2,
 * y = (c' - c) / (c' + c), where q/4 = c^2 = D/2 (1/y - 2 + y); the weight of meeting the light
 * loses, by integral over y,
 *   power:   D/4 integral (1 - y^2)(2 - y^2) / (2 - 2 y^2 + y^4) dy = 0.180 D
 *   balance: D/4 integral (1 - y^2) / (2 - y^2) dy                  = 0.0942 D
 * D is |n| . e, on average half the sum of the coordinates of e: 6 roundings of radius and centre,
 * 2 of the point.
 *
 * So no strategy gains; each loses a share of at most B, whatever the bounce, as only its last edge
 * is connected: X = 8.3e-6 asking, 0.320 X + 0.180 D = 2.9e-5 or 0.406 X + 0.0942 D = 1.7e-5 both
 * ways, nothing meeting. */
typedef struct { double rounding, leaving; } Loss;      /* in units of X and of D */
static const Loss losses[SPHERE_WAYS] = { { 0, 0 }, { 1, 0 }, { 0.320, 0.180 }, { 0.406, 0.0942 } };

static double share_lost(Loss loss, V3 centre)
{
    const float c[3] = { fabsf(centre.x), fabsf(centre.y), fabsf(centre.z) };
    double squares = 0, D = 0;

    for (int k = 0; k < 3; k++) {
        double h = (double)float_after(c[k]) - c[k];
        squares += h * h;
        D += 0.5 * (1.0 + c[k]) * (ROUNDINGS(6) + ROUNDINGS(2));
    }
    return loss.rounding * sqrt(squares / 18) + loss.leaving * D;
}

/* How far the mean of n values within [0, 1] of the truth may be off if their expectation loses B:
 * few of them lose much, so a measured deviation says little. None loses more than 1, hence the
 * variance is at most B (rounding along d has mean 0 and adds 1e-9), and by Bernstein's inequality
 * a mean is off by another t with p <= exp(-n t^2 / (2 B + 2 t / 3)) = 1e-8, to each side. */
static double most_off(double B, double n)
{
    double a = 18.42 / (3 * n);         /* ln 1e8 = 18.42 */
    return B > 0 ? B + a + sqrt(a * a + 6 * a * B) : 0;
}

static void sphere_far(void)
{
    V3 centre = { 300, -200, 100 }, eye = { 300.25f, -200, 100.25f };
    Gauge g = { ray_anywhere, NULL, 1 << 17, 15, 0 };
    char text[200];
    Lab l;

    g.of = &eye;
    furnace_sphere(&l, centre, 1);
    for (int i = 0; i < SPHERE_WAYS; i++) {
        Meter m;
        snprintf(text, sizeof text, "%s,maxdepth=8", sphere_ways[i].options);
        lab_open(&l, text);
        lab_measure(&l, &g, &m);
        for (int n = 0; n <= 8; n++)
            for (int c = 0; c < 3; c++) {
                const Stat *s = &meter_length(&m, n + 1)[c];
                double B = n ? share_lost(losses[i], centre) : 0, truth = LE[c], off;
                double most = most_off(B, (double)(test_is_long() ? 16 * g.n : g.n));
                for (int k = 0; k < n; k++)
                    truth *= RHO[c];
                off = s->mean / truth - 1;
                EXPECT(fabs(off) <= most + ROUNDINGS(64),
                       "%s, bounce %d, channel %d: %.9g, it is %.9g: off by %.3g, at most %.3g",
                       text, n, c, s->mean, truth, off, most);
            }
    }
    lab_clear(&l);
}

/* One bounce from the middle of a wall, with power to find a bias of 0.05 %. */
static void one_bounce(const char *options, uint64_t n, const double delta[3])
{
    Ray r = ray_towards(v3(0.1f, 0.05f, 0), v3(0.5f, 0.1f, 0.2f));
    Gauge g = { ray_fixed, NULL, n, 12, 0 };
    Meter m;
    Lab l;

    g.of = &r;
    furnace_cube(&l);
    lab_open(&l, options);
    lab_measure(&l, &g, &m);
    for (int c = 0; c < 3; c++)
        stat_expect(&meter_radiance(&m)[c], LE[c] * (1 + RHO[c]), delta[c], options);
    lab_clear(&l);
}

static void cube_power(void)
{
    static const double delta[3] = { 0.0002, 0.0008, 0.001 };
    one_bounce("strategy=mis,heuristic=power,maxdepth=1,roulette=100", 2000000, delta);
}

static void cube_balance(void)
{
    static const double delta[3] = { 0.0002, 0.0008, 0.001 };
    one_bounce("strategy=mis,heuristic=balance,lightsampler=uniform,maxdepth=1,roulette=100",
               2000000, delta);
}

static void cube_explicit(void)
{
    static const double delta[3] = { 0.0008, 0.003, 0.005 };
    one_bounce("strategy=explicit,maxdepth=1,roulette=100", 3000000, delta);
}

/* All bounces, ended by roulette from the first one on. */
static void roulette(void)
{
    static const struct { const char *options; uint64_t n; double delta[3]; } runs[] = {
        { "strategy=implicit,maxdepth=10000,roulette=1", 600000, { 0.0005, 0.005, 0.012 } },
        { "strategy=mis,maxdepth=10000,roulette=1", 250000, { 0.001, 0.008, 0.018 } },
        { "strategy=mis,maxdepth=10000,roulette=4", 250000, { 0.001, 0.005, 0.018 } },
    };
    V3 eye = { 0.1f, 0.05f, 0.2f };
    Gauge g = { ray_anywhere, NULL, 0, 13, 0 };
    Meter m;
    Lab l;

    g.of = &eye;
    furnace_cube(&l);
    for (int i = 0; i < 3; i++) {
        g.n = runs[i].n;
        lab_open(&l, runs[i].options);
        lab_measure(&l, &g, &m);
        for (int c = 0; c < 3; c++)
            stat_expect(&meter_radiance(&m)[c], LE[c] / (1 - RHO[c]), runs[i].delta[c],
                        runs[i].options);
    }
    lab_clear(&l);
}

/* The pattern of the default sampler has the same mean. */
static void pattern(void)
{
    V3 eye = { 0.1f, 0.05f, 0.2f };
    Gauge g = { ray_anywhere, NULL, 1 << 17, 14, 1024 };
    Meter m;
    Lab l;

    g.of = &eye;
    furnace_cube(&l);
    lab_open(&l, "maxdepth=4,roulette=100");
    lab_measure(&l, &g, &m);
    expect_bounces(&m, 4, 0.004, 0.012, "cube, patterns of 1024");
    lab_clear(&l);
}

/* ---- zones of a sphere ---- */

enum { ZONES = 3 };
static const float ZONE_Z[ZONES + 1] = { -2, -1, 1.2f, 2 };     /* radius 2 */
static const double ZONE_L[ZONES][3] = { { 0, 0.5, 1 }, { 1, 0.5, 0 }, { 3, 1, 2 } };
static const double ZONE_RHO[ZONES][3] = { { 0.8, 0.5, 0.2 }, { 0.3, 0.6, 0.9 }, { 0.5, 0, 0.7 } };

static double zone_arriving(int c, bool shining)
{
    double emitted = 0, kept = 0;
    for (int i = 0; i < ZONES; i++) {
        double f = ((double)ZONE_Z[i + 1] - ZONE_Z[i]) / 4;
        emitted += f * (shining ? ZONE_L[i][c] : 0);
        kept += f * ZONE_RHO[i][c];
    }
    return emitted / (1 - kept);
}

static void zones_of(Lab *l)
{
    char text[80];

    lab_init(l);
    for (int i = 0; i < ZONES; i++) {
        const double *rho = ZONE_RHO[i], *L = ZONE_L[i];
        uint32_t m, shape;
        snprintf(text, sizeof text, "reflectance=%g/%g/%g", rho[0], rho[1], rho[2]);
        m = lab_material(l, "diffuse", text);
        shape = lab_zone(l, v3(1, -1, 0.5f), 2, ZONE_Z[i], ZONE_Z[i + 1], m, true);
        snprintf(text, sizeof text, "L=%g/%g/%g", L[0], L[1], L[2]);
        lab_shine(l, shape, text);
    }
    lab_build(l);
}

static void zones(void)
{
    static const char *const options[] = {
        "strategy=implicit", "strategy=explicit", "strategy=explicit,lightsampler=uniform",
        "strategy=mis", "strategy=mis,heuristic=balance,lightsampler=uniform"
    };
    V3 centre = { 1, -1, 0.5f }, eye = { 1.5f, -0.5f, 0.2f };
    char name[200];
    Lab l;

    zones_of(&l);
    for (int i = 0; i < 5; i++) {
        snprintf(name, sizeof name, "%s,maxdepth=10000", options[i]);
        lab_open(&l, name);
        for (int z = 0; z < ZONES; z++) {
            float middle = 0.5f * (ZONE_Z[z] + ZONE_Z[z + 1]), r = sqrtf(4 - middle * middle);
            V3 at = v_add(centre, v3(0.6f * r, -0.8f * r, middle));
            Ray ray = ray_towards(eye, at);
            Gauge g = { ray_fixed, NULL, 100000, 21, 0 };
            double truth[3];
            Meter m;
            g.of = &ray;
            lab_measure(&l, &g, &m);
            for (int c = 0; c < 3; c++)
                truth[c] = ZONE_L[z][c] + ZONE_RHO[z][c] * zone_arriving(c, true);
            snprintf(name, sizeof name, "zone %d, %s", z, options[i]);
            stat_expect_rgb(meter_radiance(&m), truth, 0.04, name);
        }
    }
    lab_clear(&l);
}

/* A light of radiant intensity I in a sphere: what arrives after at least one bounce. */
static void lamp_in_sphere(void)
{
    static const double rho[3] = { 0.1, 0.5, 0.8 };
    Ray r = ray_towards(v3(0.2f, 0.1f, -0.3f), v3(0.6f, -0.8f, 0));
    Gauge g = { ray_fixed, NULL, 300000, 22, 0 };
    double truth[3];
    Stat indirect[3];
    Meter m;
    Lab l;

    lab_init(&l);
    lab_sphere(&l, v3(0, 0, 0), 1, lab_material(&l, "diffuse", "reflectance=0.1/0.5/0.8"), true);
    lab_light(&l, "point", "I=1/2/3,from=0.3/0.4/-0.2", NULL);
    lab_build(&l);
    g.of = &r;
    for (int i = 0; i < 2; i++) {
        lab_open(&l, i ? "strategy=explicit,maxdepth=10000" : "strategy=mis,maxdepth=10000");
        lab_measure(&l, &g, &m);
        for (int c = 0; c < 3; c++) {       /* sphere of area 4 pi, power 4 pi I */
            double E = rho[c] * (c + 1) / (1 - rho[c]);
            truth[c] = rho[c] * E / PI;
            indirect[c] = meter_radiance(&m)[c];        /* direct light has no variance */
            indirect[c].mean -= meter_length(&m, 2)[c].mean;
        }
        EXPECT(stat_error(&meter_length(&m, 2)[0]) < 1e-12, "direct light of a point varies");
        stat_expect_rgb(indirect, truth, 0.03, i ? "lamp, explicit" : "lamp, mis");
    }
    lab_clear(&l);
}

/* A ball in a uniform sky sends out no more than the sky, whatever it is made of, and those that
 * lose nothing exactly that. The ball is closed, so what is refracted comes out again. */
static void white_balls(void)
{
    static const struct { const char *kind, *options; double keeps; } rows[] = {
        { "diffuse", "reflectance=1", 1 },
        { "orennayar", "reflectance=1,sigma=20", 0 },
        { "diffusetransmission", "reflectance=0.5,transmittance=0.5", 1 },
        { "phong", "reflectance=0.5,specular=0.5,exponent=20", 0 },
        { "mirror", "reflectance=1", 1 },
        { "dielectric", "eta=1.5", 1 },
        { "dielectric", "eta=1.5,roughness=0.3", 0 },
        { "thindielectric", "", 1 },
        { "conductor", "reflectance=1,uroughness=0.5,vroughness=0.1", 0 },
        { "coateddiffuse", "reflectance=1,roughness=0.3", 0 },
        { "ashikhminshirley", "reflectance=1,specular=0.2,nu=5,nv=500", 0 },
        { "ward", "reflectance=0.2,specular=0.8,uroughness=0.3,vroughness=0.1", 0 },
        { "blinn", "reflectance=0.2,specular=0.8,exponent=10", 0 },
        { "lafortune", "reflectance=0.8", 0 },
    };
    for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
        V3 eye = v3(0, 0, 1.02f);               /* close by: many rays meet the ball */
        Gauge g = { ray_anywhere, &eye, 4096, 71 + i, 0 };
        const Stat *L;
        Meter m;
        Lab l;

        lab_init(&l);
        lab_sphere(&l, v_all(0), 1.0f, lab_material(&l, rows[i].kind, rows[i].options), false);
        lab_light(&l, "infinite", "L=1", NULL);
        lab_build(&l);
        lab_open(&l, "maxdepth=200,roulette=100000");
        lab_measure(&l, &g, &m);
        L = meter_radiance(&m);
        EXPECT(L->mean <= 1.0 + 5.6 * stat_error(L) + 1e-4, "%s:%s sends out %.5f +- %.5f",
               rows[i].kind, rows[i].options, L->mean, stat_error(L));
        EXPECT(rows[i].keeps == 0.0 || L->mean >= 1.0 - 5.6 * stat_error(L) - 1e-4,
               "%s:%s sends out only %.5f +- %.5f", rows[i].kind, rows[i].options, L->mean,
               stat_error(L));
        EXPECT(L->mean > 0.6, "%s:%s sends out %.5f", rows[i].kind, rows[i].options, L->mean);
        lab_clear(&l);
    }
}

const TestCase test_physics_furnace[] = {
    { "white_balls", white_balls, false },
    { "bounces_cube", cube, false },
    { "bounces_room", room, false },
    { "bounces_blob", blob, false },
    { "bounces_sphere", sphere, false },
    { "bounces_sphere_far", sphere_far, false },
    { "cube_power", cube_power, false },
    { "cube_balance", cube_balance, false },
    { "cube_explicit", cube_explicit, false },
    { "roulette", roulette, false },
    { "pattern", pattern, false },
    { "zones", zones, false },
    { "lamp_in_sphere", lamp_in_sphere, false },
    { NULL, NULL, false }
};
