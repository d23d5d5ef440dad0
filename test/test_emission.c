/* test_emission.c -- the particles that lights send: their directions by chi-squared against their
 * own density, the densities as emit_pdf says them, their power against the light's, and what they
 * bring to a receiver against both ways of looking at the light from there.
 *
 * Three estimates of the mean irradiance of a disc, each by its own code:
 *   emission  power of the particles that meet the disc, over its area
 *   asking    `sample` towards the light from a point of the disc, times the cosine
 *   chance    pi times what `radiance` says of the directions of a cosine law (not for deltas)
 * Nothing is in the way, so no ray is blocked but by the light itself. */
#include "base/random.h"
#include "geometry/generate.h"
#include "sampling/warp.h"
#include "scene/scene.h"
#include "test/chi2.h"
#include "test/physics.h"

#include <stdio.h>
#include <string.h>

static V2 unit2(Rng *rng)
{
    float x = rng_unit(rng);
    return (V2){ x, rng_unit(rng) };
}

/* ---- the lights ---- */

/* A picture of one dark half, a gradient, and one bright spot. */
static Rgb motley(uint32_t x, uint32_t y, uint32_t w, uint32_t h)
{
    float u = ((float)x + 0.5f) / (float)w, v = ((float)y + 0.5f) / (float)h;
    if (u > 0.58f && u < 0.66f && v > 0.3f && v < 0.42f)
        return rgb(30, 20, 10);
    return u > 0.5f && v > 0.5f ? rgb(0, 0, 0) : rgb(0.3f + u, 0.2f + v, 1.3f - u * v);
}

/* Given to the scene under a name, as if it had been read from a file. */
static void give_picture(Lab *l, const char *name, uint32_t w, uint32_t h)
{
    Scene *s = l->scene;
    SceneImage *im = MEM_NEW(SceneImage);

    REQUIRE(im && image_init(&im->image, w, h), "memory");
    im->path = arena_string(&s->arena, name, strlen(name));
    for (uint32_t y = 0; y < h; y++)
        for (uint32_t x = 0; x < w; x++)
            *image_at(&im->image, x, y) = motley(x, y, w, h);
    REQUIRE(MEM_PUSH(s->images, s->nimages, s->cap_images, im), "memory");
}

/* A square of two triangles that knows its (u, v), facing +z. */
static uint32_t square(Lab *l, V3 centre, float size)
{
    Mesh m = { 0 };
    REQUIRE(mesh_grid(&m, 1, 1), "memory");
    mesh_move(&m, size, v_mad(v3(-0.5f, -0.5f, 0), size, centre));
    return lab_mesh(l, &m, 0, false);
}

typedef struct {
    const char *name, *kind, *options;  /* kind "" : an area light of the shape below */
    enum { NO_SHAPE, SQUARE, SPHERE, INSIDE, ZONE, RING, BALL } shape;
    double delta;                       /* of the comparison of irradiances */
    int halvings;                       /* of the parts of chi2.h: pictures and edges */
} Case;

static const Case cases[] = {
    { "point", "point", "I=1/2/4,from=0.4/0.2/1.5", NO_SHAPE, 0.08, 0 },
    { "spot", "spot", "I=1/2/4,from=0.4/0.2/1.5,to=0/0/0,coneangle=40,conedeltaangle=30", NO_SHAPE,
      0.03, 2 },
    { "wide spot", "spot", "I=1,from=0/0.3/1,to=0/-1/0,coneangle=150,conedeltaangle=1", NO_SHAPE,
      0.065, 3 },
    { "goniometric", "goniometric", "I=1/2/4,filename=map,mapping=latlong", NO_SHAPE, 0.06, 3 },
    { "goniometric square", "goniometric", "power=50,filename=square", NO_SHAPE, 0.08, 3 },
    { "projection", "projection", "I=1/2/4,filename=map,fov=50", NO_SHAPE, 0.11, 4 },
    { "white projection", "projection", "I=1/2/4,fov=100", NO_SHAPE, 0.04, 4 },
    { "distant", "distant", "L=1/2/4,from=1/2/5,to=0/0/0", NO_SHAPE, 0.03, 0 },
    { "square", "", "L=1/2/4,twosided", SQUARE, 0.055, 0 },
    { "focused square", "", "L=1/2/4,twosided,exponent=7.5", SQUARE, 0.075, 0 },
    { "square with a picture", "", "L=1/2/4,twosided,filename=map", SQUARE, 0.14, 0 },
    { "sphere", "", "L=1/2/4", SPHERE, 0.055, 0 },
    { "focused sphere with a picture", "", "L=1,exponent=2,filename=map", SPHERE, 0.08, 0 },
    { "inside of a sphere", "", "L=1/2/4", INSIDE, 0.08, 0 },
    { "inside with a picture", "", "L=1/2/4,filename=map,exponent=1", INSIDE, 0.16, 0 },
    { "zone", "", "L=1/2/4,twosided", ZONE, 0.065, 0 },
    { "ring with a picture", "", "L=1/2/4,filename=map,twosided", RING, 0.13, 0 },
    { "mesh ball", "", "L=1/2/4,power=20", BALL, 0.07, 0 },
    { "constant sky", "infinite", "L=1/2/4", NO_SHAPE, 0.055, 0 },
    { "latlong sky", "infinite", "L=1/2/4,filename=map", NO_SHAPE, 0.06, 3 },
    { "octahedral sky", "infinite", "L=1/2/4,filename=square", NO_SHAPE, 0.07, 3 },
    { "angular sky", "infinite", "filename=square,mapping=angular", NO_SHAPE, 0.075, 3 },
    { "mirror ball sky", "infinite", "filename=square,mapping=mirrorball", NO_SHAPE, 0.08, 3 },
    { "sky with sun", "sky", "sunsize=20,sundirection=0.5/-0.2/0.8", NO_SHAPE, 0.09, 4 },
    { "sky without sun", "sky", "sunscale=0,scale=1/0.5/2", NO_SHAPE, 0.04, 2 },
    { "sun without sky", "sky", "skyscale=0,albedo=0,sunsize=30", NO_SHAPE, 0.09, 4 }
};
enum { CASES = sizeof cases / sizeof *cases };

static const V3 RECEIVER = { 0.1f, -0.1f, -1.2f };      /* a disc of radius 1.5 that faces +z */
#define RECEIVER_RADIUS 1.5f

static uint32_t area_light(Lab *l, const Case *c)
{
    uint32_t shape = 0;
    Mesh m = { 0 };

    switch (c->shape) {
    case NO_SHAPE: break;
    case SQUARE: shape = square(l, v3(0, 0.2f, 0.1f), 1.2f); break;
    case SPHERE: shape = lab_sphere(l, v3(0.3f, 0, 0.2f), 0.7f, 0, false); break;
    case INSIDE: shape = lab_sphere(l, v3(0.3f, 0, -0.2f), 3, 0, true); break;
    case ZONE:   shape = lab_zone(l, v3(0, 0, 0.2f), 0.8f, -0.1f, 0.5f, 0, false); break;
    case RING:   shape = lab_disk(l, v3(0, 0, 0.4f), v3(0.2f, 0.1f, 1), 0.8f, 0.3f, 0); break;
    case BALL:
        REQUIRE(mesh_icosphere(&m, 2), "memory");
        mesh_move(&m, 0.6f, v3(0, 0, 0.4f));
        shape = lab_mesh(l, &m, 0, false);
        break;
    }
    return lab_shine(l, shape, c->options);
}

static const Light *begin(Lab *l, const Case *c)
{
    Transform turned = xf_rotate(120, 1, 0.2, -0.3);
    Transform risen = xf_rotate(-100, 0.2, 1, 0.1);     /* the rims of light probes are above */
    uint32_t index;

    lab_init(l);
    give_picture(l, "map", 32, 16);
    give_picture(l, "square", 24, 24);
    lab_disk(l, RECEIVER, v3(0, 0, 1), RECEIVER_RADIUS, 0, 0);
    if (!c->kind[0])
        index = area_light(l, c);
    else if (!strstr(c->options, "filename") && !strstr(c->options, "fov"))
        index = lab_light(l, c->kind, c->options, NULL);
    else
        index = lab_light(l, c->kind, c->options, strcmp(c->kind, "infinite") ? &turned : &risen);
    lab_build(l);
    return l->scene->lights[index];
}

static Surface surface_of(const Emission *e)
{
    return surface_at(e->p, e->err, e->n, (V2){ 0, 0 });
}

/* ---- directions ---- */

typedef struct { const Light *light; bool frame; } Sent;

/* Directions about the normal of the place, or in the world. */
static bool draw(const void *of, Rng *rng, V3 *w)
{
    const Sent *s = of;
    V2 u = unit2(rng);
    Emission e;

    if (!s->light->kind->emit(s->light, u, unit2(rng), &e))
        return false;
    *w = e.d;
    if (s->frame) {
        Frame f = frame_about(e.n);
        *w = frame_in(&f, e.d);
    }
    return true;
}

/* e.n is on the side of d: so of two-sided lights both halves of the density are one here. */
static double density(const void *of, V3 w)
{
    const Sent *s = of;
    Surface at = surface_at(v_all(0), v_all(0), v3(0, 0, 1), (V2){ 0, 0 });
    float pdf_a, pdf, back = 0;

    if (s->frame && w.z <= 0)
        return 0;
    s->light->kind->emit_pdf(s->light, &at, w, &pdf_a, &pdf);
    if (s->frame)
        s->light->kind->emit_pdf(s->light, &at, v_neg(w), &pdf_a, &back);
    return (double)pdf + back;
}

static void directions(void)
{
    for (int i = 0; i < CASES; i++) {
        const Case *c = &cases[i];
        Chi2 chi;
        Sent sent;
        Lab l;
        sent.light = begin(&l, c);
        sent.frame = c->shape != NO_SHAPE;
        if (sent.light->kind->delta != DELTA_DIRECTION) {
            memset(&chi, 0, sizeof chi);
            chi.draw = draw;
            chi.pdf = density;
            chi.of = &sent;
            chi.draws = test_is_long() ? 1000000 : 60000;
            chi.rows = 24;
            chi.cols = 48;
            chi.halvings = c->halvings;
            chi2_expect(&chi, c->name);
        }
        lab_clear(&l);
    }
}

/* ---- densities, power ---- */

/* A direction may round into the next cell of a picture, or beyond the rim of the sun. */
static void densities(void)
{
    for (int i = 0; i < CASES; i++) {
        enum { N = 20000 };
        int off = 0, sent = 0;
        Rng rng = rng_seed(61);
        const Light *light;
        Emission e;
        Lab l;
        light = begin(&l, &cases[i]);
        for (int k = 0; k < N; k++) {
            float pdf_a, pdf_w;
            V2 u = unit2(&rng);
            Surface at;
            if (!light->kind->emit(light, u, unit2(&rng), &e))
                continue;
            sent++;
            EXPECT(fabsf(v_len2(e.d) - 1) < ROUNDINGS(16) && e.pdf_a > 0 && e.pdf_w > 0 &&
                   is_finite(e.pdf_w) && v_finite(e.p) && e.cosine > 0, "%s: |d|^2 %.9g, pdf %g %g",
                   cases[i].name, (double)v_len2(e.d), (double)e.pdf_a, (double)e.pdf_w);
            EXPECT(cases[i].shape != NO_SHAPE ? fabsf(v_dot(e.n, e.d) - e.cosine) < 1e-6f
                                              : v_len2(e.n) == 0 && e.cosine == 1,
                   "%s: cosine %g", cases[i].name, (double)e.cosine);
            at = surface_of(&e);
            light->kind->emit_pdf(light, &at, e.d, &pdf_a, &pdf_w);
            EXPECT(pdf_a == e.pdf_a, "%s: pdf_a %g and %g", cases[i].name, (double)pdf_a,
                   (double)e.pdf_a);
            off += !(fabsf(pdf_w / e.pdf_w - 1) < 1e-3f);
            if (light->kind->infinite)          /* as looking at it says */
                EXPECT(light->kind->pdf_w(light, e.p, v_neg(e.d), NULL) == pdf_w, "%s",
                       cases[i].name);
        }
        EXPECT(sent > N / 2, "%s: only %d of %d particles", cases[i].name, sent, N);
        EXPECT(off <= N / 2000, "%s: %d of %d densities differ", cases[i].name, off, sent);
        lab_clear(&l);
    }
}

/* The mean of the particles' power is the light's, to 2 in 1000 where that is an integral over
 * cells which a rim cuts, or by points (a picture on a shape). */
static void powers(void)
{
    for (int i = 0; i < CASES; i++) {
        enum { N = 100000 };
        Rng rng = rng_seed(62);
        const Light *light;
        Stat sum[3];
        Rgb power;
        double truth[3];
        Emission e;
        Lab l;
        light = begin(&l, &cases[i]);
        memset(sum, 0, sizeof sum);
        for (int k = 0; k < N; k++) {
            V2 u = unit2(&rng);
            Rgb w = rgb_all(0);
            if (light->kind->emit(light, u, unit2(&rng), &e))
                w = rgb_scale(e.L, e.cosine / (e.pdf_a * e.pdf_w));
            stat_add(&sum[0], (double)w.r);
            stat_add(&sum[1], (double)w.g);
            stat_add(&sum[2], (double)w.b);
        }
        power = light->kind->power(light);
        truth[0] = power.r;
        truth[1] = power.g;
        truth[2] = power.b;
        for (int c = 0; c < 3; c++)
            EXPECT(fabs(sum[c].mean / truth[c] - 1) <= 2e-3 + 5.6 * stat_error(&sum[c]) / truth[c],
                   "%s, channel %d: particles carry %.6g, power is %.6g", cases[i].name, c,
                   sum[c].mean, truth[c]);
        lab_clear(&l);
    }
}

/* ---- what arrives ---- */

static V3 receiver_point(V2 u)
{
    V2 q = warp_disk_concentric(u);
    return v3(RECEIVER.x + RECEIVER_RADIUS * q.x, RECEIVER.y + RECEIVER_RADIUS * q.y, RECEIVER.z);
}

static Surface receiver(V2 u)
{
    V3 p = receiver_point(u);
    Surface s = surface_at(p, v_scale(v_abs(p), ROUNDINGS(6)), v3(0, 0, 1), (V2){ 0, 0 });
    return s;
}

static void emitted(const Lab *l, const Light *light, Rng *rng, Stat *s)
{
    V2 u = unit2(rng);
    Surface at;
    Emission e;
    Ray r;
    Hit h;
    double c = 0;

    if (light->kind->emit(light, u, unit2(rng), &e)) {
        r = emission_ray(&e, 0);
        if (accel_nearest(l->scene->accel, &r, &h)) {
            accel_surface(l->scene->accel, &r, &h, &at);
            if (at.shape->light == NO_LIGHT && e.d.z < 0)
                c = (double)rgb_lum(e.L) * e.cosine / ((double)e.pdf_a * e.pdf_w);
        }
    }
    stat_add(s, c / (PI * RECEIVER_RADIUS * RECEIVER_RADIUS));
}

static void asked(const Lab *l, const Light *light, Rng *rng, Stat *s)
{
    Surface at = receiver(unit2(rng));
    LightSample ls;
    double c = 0;
    Ray r;

    if (light->kind->sample(light, at.p, unit2(rng), &ls) && ls.wi.z > 0) {
        r = shadow_ray(&at, &ls);
        if (!accel_blocked(l->scene->accel, &r))
            c = (double)rgb_lum(ls.L) * ls.wi.z / ls.pdf_w;
    }
    stat_add(s, c);
}

static void by_chance(const Lab *l, const Light *light, Rng *rng, Stat *s)
{
    Surface at = receiver(unit2(rng)), met;
    Rgb L = rgb_all(0);
    V3 d = warp_cosine(unit2(rng));
    Ray r = { .o = ray_origin(at.p, at.err, at.ng, d), .d = d, .tmax = INFINITY };
    Hit h;

    if (accel_nearest(l->scene->accel, &r, &h)) {
        accel_surface(l->scene->accel, &r, &h, &met);
        if (scene_light_of(l->scene, &met) == light)
            L = light->kind->radiance(light, d, &met);
    } else if (light->kind->infinite)
        L = light->kind->radiance(light, d, NULL);
    stat_add(s, PI * (double)rgb_lum(L));
}

static void arrives(void)
{
    for (int i = 0; i < CASES; i++) {
        const Case *c = &cases[i];
        int n = test_is_long() ? 4000000 : 250000;
        Stat sum[3];
        Rng rng = rng_seed(63);
        const Light *light;
        char what[120];
        Lab l;
        light = begin(&l, c);
        memset(sum, 0, sizeof sum);
        for (int k = 0; k < n; k++) {
            emitted(&l, light, &rng, &sum[0]);
            asked(&l, light, &rng, &sum[1]);
            if (light->kind->delta == DELTA_NONE)
                by_chance(&l, light, &rng, &sum[2]);
        }
        snprintf(what, sizeof what, "%s, emission and asking", c->name);
        stat_expect_same(&sum[0], &sum[1], c->delta, what);
        snprintf(what, sizeof what, "%s, chance and asking", c->name);
        if (light->kind->delta == DELTA_NONE)
            stat_expect_same(&sum[2], &sum[1], c->delta, what);
        lab_clear(&l);
    }
}

const TestCase test_emission[] = {
    { "directions", directions, false },
    { "densities", densities, false },
    { "powers", powers, false },
    { "arrives", arrives, false },
    { NULL, NULL, false }
};
