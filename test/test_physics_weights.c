/* test_physics_weights.c -- the weights of multiple importance sampling, path by path.
 *
 * One vertex on a floor, several lights, one of which a single path ends on. The same path is made
 * by `path` with and without the other way, and the quotient of what they add is its weight. It
 * must be p^k / (p^k + q^k), [Veach97 9.2], k = 2 or 1, with p and q, the densities per solid
 * angle of both ways, from first principles in double: the cosine over pi, or the mixture with a
 * cosine power; the share of the light in the power of all times d^2 / (cos A), or one over the
 * solid angle of a sphere's cone, or of the whole sphere of directions. */
#include "sampling/warp.h"
#include "test/enumerate.h"
#include "test/physics.h"

#include <stdio.h>
#include <string.h>

typedef enum { QUAD, BALL, DISC, SKY, LIGHTS } Which;
static const char *const names[LIGHTS] = { "quad", "ball", "disc", "sky" };

/* The world: a floor, and lights that do not hide each other from its point. Powers by luminance,
 * for L = 1: pi A, and for the sky 4 pi^2 R^2. */
static const V3 POINT = { 0.1f, 0.2f, 0 };
static const V3 QUAD_AT = { -1, -1, 1 }, BALL_AT = { 1.2f, 1, 1 }, DISC_AT = { -1, 1.5f, 1 };
#define QUAD_SIDE 1.2f
#define BALL_RADIUS 0.5f
#define DISC_RADIUS 0.6f

/* Glossy: half of the light in a lobe of cos^EXPONENT. */
#define EXPONENT 8
#define GLOSSY "reflectance=0.4,specular=0.4,exponent=8"

static void world(Lab *l, bool glossy)
{
    uint32_t floor_of, black, shape;

    lab_init(l);
    floor_of = lab_material(l, glossy ? "phong" : "diffuse", glossy ? GLOSSY : "reflectance=0.8");
    black = lab_material(l, "diffuse", "reflectance=0");
    lab_quad(l, v3(-3, -3, 0), v3(6, 0, 0), v3(0, 6, 0), floor_of);
    shape = lab_quad(l, QUAD_AT, v3(0, QUAD_SIDE, 0), v3(QUAD_SIDE, 0, 0), black);
    lab_shine(l, shape, "L=1");
    shape = lab_sphere(l, BALL_AT, BALL_RADIUS, black, false);
    lab_shine(l, shape, "L=1");
    shape = lab_disk(l, DISC_AT, v3(0, 0, -1), DISC_RADIUS, 0, black);
    lab_shine(l, shape, "L=1");
    lab_light(l, "infinite", "L=0.05", NULL);
    lab_build(l);
}

static double share(const Lab *l, Which w, bool uniform)
{
    double r = (double)l->scene->radius, all = 0, power[LIGHTS];

    if (uniform)
        return 0.25;
    power[QUAD] = PI * QUAD_SIDE * QUAD_SIDE;
    power[BALL] = 4 * PI * PI * BALL_RADIUS * BALL_RADIUS;
    power[DISC] = PI * PI * DISC_RADIUS * DISC_RADIUS;
    power[SKY] = 0.05 * 4 * PI * PI * r * r;
    for (int k = 0; k < LIGHTS; k++)
        all += power[k];
    return power[w] / all;
}

/* Density of a direction from POINT by asking light w for a point, given where it meets the
 * light. */
static double light_density(Which w, V3 p)
{
    double x = (double)p.x - POINT.x, y = (double)p.y - POINT.y, z = p.z;
    double d2 = x * x + y * y + z * z;
    double bx = (double)BALL_AT.x - POINT.x, by = (double)BALL_AT.y - POINT.y, bz = BALL_AT.z;
    double sin2 = (double)BALL_RADIUS * BALL_RADIUS / (bx * bx + by * by + bz * bz);

    switch (w) {
    case QUAD: return d2 * sqrt(d2) / (z * QUAD_SIDE * QUAD_SIDE);
    case DISC: return d2 * sqrt(d2) / (z * PI * DISC_RADIUS * DISC_RADIUS);
    case BALL: return 1 / (2 * PI * (1 - sqrt(1 - sin2)));
    default:   return 1 / (4 * PI);
    }
}

/* Density of a direction by the floor, seen from `eye`. */
static double floor_density(bool glossy, V3 eye, V3 wi)
{
    double ex = (double)eye.x - POINT.x, ey = (double)eye.y - POINT.y, ez = eye.z;
    double c = (ez * wi.z - ex * wi.x - ey * wi.y) / sqrt(ex * ex + ey * ey + ez * ez);
    double diffuse = (double)wi.z / PI;

    if (!glossy)
        return diffuse;
    c = c > 0 ? md_pow(c, EXPONENT) : 0;
    return 0.5 * diffuse + 0.5 * (EXPONENT + 1) / (2 * PI) * c;
}

/* ---- one path ---- */

/* Hands out the same numbers for a seed, but for the choice of light, which is `choose`. */
typedef struct { Enumeration e; float choose; } Fixed;

static float one(Sampler *s, Decision d)
{
    const Fixed *f = s->state;
    return d == DECISION(DECIDE_LIGHT, 0) ? f->choose : enumerate_fixed(&f->e, d).x;
}
static V2 two(Sampler *s, Decision d) { return enumerate_fixed(&((const Fixed *)s->state)->e, d); }
static const SamplerKind fixed_kind = { .info = { "fixed", "", "", NULL }, .one = one, .two = two };

static double contribution(Lab *l, const char *options, Fixed *f, Ray r, Strategy how)
{
    Tally tally;
    Tracer t;

    memset(&t, 0, sizeof t);
    memset(&tally, 0, sizeof tally);
    t.scene = l->scene;
    t.sampler.kind = &fixed_kind;
    t.sampler.state = f;
    t.tally = &tally;
    lab_open(l, options);
    l->integrator->kind->radiance(l->integrator, &r, &t);
    return (double)tally.strategy[how].g;
}

static double heuristic(double p, double q, bool power)
{
    return power ? p * p / (p * p + q * q) : p / (p + q);
}

/* What is asked: `path`; or `direct` with `others` samples of the other way for one of this one, of
 * one light or of all, and with directions in place of points, where the sky lies behind every
 * lamp. */
typedef enum { BY_PATH, BY_DIRECT, BY_ALL, BY_DIRECTIONS, METHODS } Method;
typedef struct {
    bool glossy, uniform, power;
    Method method;
    int others;
    int count[STRATEGIES][LIGHTS];
} Setup;

/* The method with both ways, or with `how` alone. */
static void method_text(char text[200], const Setup *s, Strategy how, bool both)
{
    static const char *const by_path[2] = { "implicit", "explicit" };
    static const char *const by_direct[2] = { "brdf", "light" };
    static const char *const more[METHODS] = { "", "", ",lights=all", ",occlusion=directions" };
    bool by_light = how == STRATEGY_EXPLICIT;
    char tail[100];

    snprintf(tail, sizeof tail, ",heuristic=%s,lightsampler=%s,maxdepth=1",
             s->power ? "power" : "balance", s->uniform ? "uniform" : "power");
    if (s->method == BY_PATH)
        snprintf(text, 200, "strategy=%s,roulette=9%s", both ? "mis" : by_path[how], tail);
    else
        snprintf(text, 200, "direct:strategy=%s,lightsamples=%d,bsdfsamples=%d%s%s",
                 both ? "mis" : by_direct[how], by_light ? 1 : s->others, by_light ? s->others : 1,
                 both || s->method != BY_ALL || by_light ? more[s->method] : "", tail);
}

/* Density of asking for the direction that meets w there. */
static double asked_density(const Lab *l, const Setup *s, Which w, V3 p)
{
    double d = light_density(w, p);

    if (s->method != BY_ALL)
        d *= share(l, w, s->uniform);
    if (s->method == BY_DIRECTIONS && w != SKY)
        d += share(l, SKY, s->uniform) * light_density(SKY, p);
    return d;
}

static void expect_weight(Lab *l, Setup *s, Fixed *f, Ray r, Strategy how, Which w, V3 wi, V3 p)
{
    char text[200];
    double alone, both, asked, met, truth;

    method_text(text, s, how, false);
    alone = contribution(l, text, f, r, how);
    method_text(text, s, how, true);
    both = contribution(l, text, f, r, how);
    asked = asked_density(l, s, w, p);
    met = floor_density(s->glossy, r.o, wi);
    truth = how == STRATEGY_EXPLICIT ? heuristic(asked, s->others * met, s->power)
                                     : heuristic(met, s->others * asked, s->power);
    if (!(alone > 0))
        return;
    s->count[how][w]++;
    EXPECT(fabs(both / alone - truth) <= 1e-5 * truth, "way %d to the %s, %s: weight %.9g, it is "
           "%.9g", (int)how, names[w], text, both / alone, truth);
}

/* Where a ray from POINT meets which light; false: the floor's underside or a back. */
static bool light_met(const Lab *l, V3 wi, Which *w, V3 *p)
{
    Ray r = { .o = { POINT.x, POINT.y, 1e-7f }, .d = wi, .tmax = INFINITY };
    const Light *light;
    Surface s;
    Hit h;

    *w = SKY;
    *p = v_all(0);
    if (!accel_nearest(l->scene->accel, &r, &h))
        return true;
    accel_surface(l->scene->accel, &r, &h, &s);
    light = scene_light_of(l->scene, &s);
    if (!light)
        return false;
    *w = (Which)light->index;
    *p = s.p;
    return true;
}

/* The direction that the floor's sampling yields: that of its own model, whose density is not
 * asked. */
static bool floor_direction(const Lab *l, const Fixed *f, V3 eye, V3 *wi)
{
    V3 wo = v_unit(v_sub(eye, POINT));
    Frame frame = frame_about(v3(0, 0, 1));
    BsdfSample bs;
    BsdfRoom room;
    const Surface somewhere = { .uv = { 0, 0 } };
    const Bsdf *b;

    b = material_bsdf(&l->scene->materials[1], &somewhere, &room);
    if (!b->kind->sample(b, frame_in(&frame, wo),
                        enumerate_fixed(&f->e, DECISION(DECIDE_LOBE, 0)).x,
                        enumerate_fixed(&f->e, DECISION(DECIDE_DIRECTION, 0)), false, &bs))
        return false;
    *wi = frame_out(&frame, bs.wi);
    return true;
}

static void one_seed(Lab *l, Setup *s, uint64_t seed)
{
    V3 eye = { -1.1f, -0.5f, 0.9f }, wi, p;
    Ray r = ray_towards(eye, POINT);
    float below = 0;
    LightSample ls;
    Fixed f;
    Which w;

    memset(&f, 0, sizeof f);
    f.e.seed = seed;
    f.choose = 0.5f;
    if (floor_direction(l, &f, eye, &wi) && light_met(l, wi, &w, &p))
        expect_weight(l, s, &f, r, STRATEGY_IMPLICIT, w, wi, p);
    if (s->method == BY_ALL)                    /* there no light can be told from the others */
        return;
    for (int k = 0; k < LIGHTS; k++) {          /* u in the middle of each light's share */
        const Light *light = l->scene->lights[k];
        V2 u = enumerate_fixed(&f.e, DECISION(DECIDE_LIGHT_POINT, 0));
        float part = (float)share(l, (Which)k, s->uniform);
        f.choose = below + 0.5f * part;
        below += part;
        if (!light->kind->sample(light, POINT, u, &ls) || ls.wi.z <= 0.01f)
            continue;
        w = (Which)k;
        p = ls.p;
        if (s->method != BY_DIRECTIONS || light_met(l, ls.wi, &w, &p))
            expect_weight(l, s, &f, r, STRATEGY_EXPLICIT, w, ls.wi, p);
    }
}

static void weights(bool glossy, Method method, int others)
{
    Lab l;

    world(&l, glossy);
    for (int k = 0; k < 4; k++) {
        Setup s;
        memset(&s, 0, sizeof s);
        s.glossy = glossy;
        s.uniform = k & 1;
        s.power = k & 2;
        s.method = method;
        s.others = others;
        for (uint64_t seed = 0; seed < (method == BY_PATH ? 1000 : 600); seed++)
            one_seed(&l, &s, seed);
        for (int how = 0; how < (method == BY_ALL ? STRATEGY_EXPLICIT : STRATEGY_LENS); how++)
            for (int w = 0; w < LIGHTS; w++)
                EXPECT(s.count[how][w] >= 5, "%s: only %d paths by way %d", names[w],
                       s.count[how][w], how);
    }
    lab_clear(&l);
}

static void matt(void) { weights(false, BY_PATH, 1); }
static void glossy_floor(void) { weights(true, BY_PATH, 1); }
static void direct_one(void) { weights(true, BY_DIRECT, 1); }
static void direct_many(void) { weights(true, BY_DIRECT, 5); }
static void direct_all(void) { weights(true, BY_ALL, 2); }
static void direct_directions(void) { weights(true, BY_DIRECTIONS, 3); }

const TestCase test_physics_weights[] = {
    { "matt", matt, false },
    { "glossy", glossy_floor, false },
    { "direct_one", direct_one, false },
    { "direct_many", direct_many, false },
    { "direct_all", direct_all, false },
    { "direct_directions", direct_directions, false },
    { NULL, NULL, false }
};
