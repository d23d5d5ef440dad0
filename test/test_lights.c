/* test_lights.c -- lights draw what they say.
 *
 * Directions: from eight points about each light, near and far, in front of it and beside it, how
 * often `sample` draws from each part of a cap that just holds the light, against the mean there of
 * pdf_w of what a ray meets. The cap is cut into parts of equal solid angle. The means come from
 * rays at random in each part, since a light's edge is no matter for quadrature, so the counts
 * have the variance of both; their sum is judged by the chi-squared distribution.
 * Consistency: the density of a drawn direction is that of the surface which the ray meets there.
 * Power: radiance times pi times area, and the like. */
#include "base/random.h"
#include "geometry/generate.h"
#include "sampling/warp.h"
#include "scene/scene.h"
#include "test/chi2.h"
#include "test/physics.h"

#include <stdio.h>
#include <string.h>

/* ---- a light from a point, in a cap ---- */

typedef struct {
    const Scene *scene;
    const Light *light;
    V3    from;
    Frame axis;
    float height;               /* of the cap: 1 - cos of its half angle */
    float size;                 /* radius of the scene */
    V3    pole;                 /* of a sky's picture */
} View;

static V2 unit2(Rng *rng)
{
    float x = rng_unit(rng);
    return (V2){ x, rng_unit(rng) };
}

/* The surface of the light that a ray from the point meets. */
static bool meets(const View *v, V3 wi, Surface *s)
{
    Ray r = { .o = v->from, .d = wi, .tmax = INFINITY };
    Hit h;

    if (!accel_nearest(v->scene->accel, &r, &h))
        return false;
    accel_surface(v->scene->accel, &r, &h, s);
    return scene_light_of(v->scene, s) == v->light &&
           !rgb_black(v->light->kind->radiance(v->light, wi, s));
}

static float density(const View *v, V3 wi)
{
    Surface s;
    if (v->light->kind->infinite)
        return v->light->kind->pdf_w(v->light, v->from, wi, NULL);
    return meets(v, wi, &s) ? v->light->kind->pdf_w(v->light, v->from, wi, &s) : 0;
}

/* Parts of the cap: rows of equal height, columns of equal angle, so all of equal solid angle. */
enum { ROWS = 16, COLUMNS = 32, PARTS = ROWS * COLUMNS };

static int part_of(const View *v, V3 wi)
{
    V3 w = frame_in(&v->axis, wi);
    float down = w.z > 0 ? (w.x * w.x + w.y * w.y) / (1 + w.z) : 1 - w.z;
    float phi = m_atan2(w.y, w.x) * (0.5f * INV_PI);
    int row = (int)(down / v->height * ROWS), column = (int)((phi < 0 ? phi + 1 : phi) * COLUMNS);

    return (row < ROWS ? row : ROWS - 1) * COLUMNS + (column < COLUMNS ? column : COLUMNS - 1);
}

static V3 direction_in(const View *v, int part, V2 u)
{
    double down = (part / COLUMNS + (double)u.x) / ROWS * v->height, sine = sqrt(down * (2 - down));
    double phi = 2 * PI * (part % COLUMNS + (double)u.y) / COLUMNS;
    V3 w = v3((float)(sine * md_cos(phi)), (float)(sine * md_sin(phi)), (float)(1 - down));
    return v_unit(frame_out(&v->axis, w));
}

/* Pools of parts with at least ten draws expected; refused draws are one more. */
static void expect_directions(const View *v, const char *what)
{
    const int each = test_is_long() ? 2000 : 200, n = each * PARTS;
    static uint32_t count[PARTS];
    double refused = n, sum = 0, all = 0, all_variance = 0, e = 0, o = 0, variance = 0;
    int dof = 0;
    Rng rng = rng_seed(53);
    LightSample s;

    memset(count, 0, sizeof count);
    for (int i = 0; i < n; i++)
        if (v->light->kind->sample(v->light, v->from, unit2(&rng), &s)) {
            count[part_of(v, s.wi)]++;
            refused--;
        }
    for (int k = 0; k < PARTS; k++) {
        double share = 2 * PI * v->height / PARTS * n;
        Stat mean = { 0, 0, 0, 0, 0 };
        for (int i = 0; i < each; i++)
            stat_add(&mean, (double)density(v, direction_in(v, k, unit2(&rng))));
        e += share * mean.mean;
        o += count[k];
        variance += share * mean.mean + share * share * stat_error(&mean) * stat_error(&mean);
        all += share * mean.mean;
        all_variance += share * share * stat_error(&mean) * stat_error(&mean);
        if (e >= 10) {
            sum += (o - e) * (o - e) / variance;
            dof++;
            e = o = variance = 0;
        }
    }
    EXPECT(dof >= 16, "%s: only %d parts of the cap are lit", what, dof);
    EXPECT(chi2_tail(sum, dof) >= CHI2_P_MIN, "%s: chi^2 = %.1f in %d parts", what, sum, dof);
    /* the density integrates to what is not refused */
    EXPECT(fabs(n - refused - all) <=
               5.6 * sqrt(all_variance + refused * (n - refused) / n) + 1e-5 * n,
           "%s: of %d draws %.0f are given, the density says %.1f", what, n, n - refused, all);
}

/* The cap: about the mean direction, a little wider than what a few thousand draws reach. */
static bool find_cap(View *v)
{
    enum { N = 4096 };
    static V3 w[N];
    V3 sum = v_all(0);
    Rng rng = rng_seed(51);
    LightSample s;
    int n = 0;

    for (int i = 0; i < N; i++)
        if (v->light->kind->sample(v->light, v->from, unit2(&rng), &s)) {
            w[n++] = s.wi;
            sum = v_add(sum, s.wi);
        }
    if (!n)
        return false;
    v->height = 0;
    sum = v_unit(sum);
    if (v_len2(sum) == 0)
        sum = v3(0, 0, 1);
    v->axis = frame_about(sum);
    for (int i = 0; i < n; i++) { /* 1 - cos of unit vectors: half the distance squared */
        float down = 0.5f * v_len2(v_sub(w[i], sum));
        v->height = f_max(v->height, down);
    }
    v->height *= 1.2f;
    if (v->light->kind->infinite || v->height > 1.5f)
        v->height = 2;
    return true;
}

/* How far the density of the surface may be off that of the sample: d^2 / (cos A), where the place
 * of the hit is off by some roundings of the coordinates over the cosine, and the normal of a round
 * light by that over its size. */
static float tolerance(const View *v, const LightSample *s, const Surface *hit)
{
    float c, size;
    if (v->light->kind->infinite) /* 1 / sine of the angle to the pole of the picture */
        return 1e-5f + ROUNDINGS(8) / sqrtf(f_max(1e-6f, 1 - f_sqr(v_dot(v->pole, s->wi))));
    c = v_absdot(hit->ng, s->wi);
    size = v_max3(v_max(v_abs(v->from), v_abs(s->p))) + s->dist;
    return 1e-5f + ROUNDINGS(16) * size / (c * c * f_min(v->size, s->dist));
}

static void expect_consistent(const View *v, const char *what)
{
    int n = 20000, drawn = 0, off = 0, missed = 0;
    Rng rng = rng_seed(52);
    LightSample s;
    Surface hit;

    memset(&hit, 0, sizeof hit);
    for (int i = 0; i < n; i++) {
        float p;
        if (!v->light->kind->sample(v->light, v->from, unit2(&rng), &s))
            continue;
        drawn++;
        EXPECT(s.pdf_w > 0 && is_finite(s.pdf_w) && fabsf(v_len2(s.wi) - 1) < ROUNDINGS(16) &&
               !rgb_black(s.L), "%s: pdf %g, |wi|^2 %g", what, (double)s.pdf_w,
               (double)v_len2(s.wi));
        if (!v->light->kind->infinite && !meets(v, s.wi, &hit)) {
            missed++;
            continue;
        }
        p = v->light->kind->pdf_w(v->light, v->from, s.wi, &hit);
        off += !(fabsf(p / s.pdf_w - 1) <= tolerance(v, &s, &hit));
    }
    /* rays to the rim that miss by rounding; directions that round into the next cell of a
     * picture */
    EXPECT(missed <= 2 + n / 2000, "%s: %d of %d rays miss it", what, missed, drawn);
    EXPECT(off <= n / 5000, "%s: %d of %d densities differ", what, off, drawn);
}

static bool expect_view(View v, const char *what)
{
    if (!find_cap(&v))
        return false;
    expect_directions(&v, what);
    expect_consistent(&v, what);
    return true;
}

/* From eight points: two far away, four around, two close to `near`. */
static void expect_light(Lab *l, uint32_t light, V3 centre, float size, V3 near, const char *what)
{
    static const V3 around[6] = { { 30, -40, 20 },        { -100, 5, 70 },
                                  { 1.5f, 0.4f, 1.7f },   { -0.9f, -1.2f, 2.1f },
                                  { 1.1f, -1.6f, -0.8f }, { 0.3f, 2.4f, 0.1f } };
    int seen = 0;
    char name[80];

    lab_build(l);
    for (int k = 0; k < 8; k++) {
        View v;
        memset(&v, 0, sizeof v);
        v.scene = l->scene;
        v.light = l->scene->lights[light];
        v.from = k == 6 ? near : v_lerp(near, centre, -0.07f);
        if (k < 6)
            v.from = v_mad(around[k], size, centre);
        v.size = l->scene->radius;
        snprintf(name, sizeof name, "%s from point %d", what, k);
        seen += expect_view(v, name);
    }
    EXPECT(seen >= 5, "%s is seen from %d points only", what, seen);
    lab_clear(l);
}

/* ---- the lights ---- */

static uint32_t begin(Lab *l)
{
    lab_init(l);
    return 0;                   /* the neutral material */
}

static void mesh_lights(void)
{
    Mesh m = { 0 };
    uint32_t light;
    Lab l;

    begin(&l);
    light = lab_shine(&l, lab_quad(&l, v3(-0.5f, -1, 0.2f), v3(1, 0, 0.3f), v3(0, 2, 0), 0), "L=2");
    expect_light(&l, light, v3(0, 0, 0.35f), 1, v3(0.1f, 0.2f, 0.6f), "quad");

    begin(&l);
    REQUIRE(mesh_cube(&m), "cube");
    mesh_move(&m, 2, v3(1, 2, 3));
    light = lab_shine(&l, lab_mesh(&l, &m, 0, false), "L=2");
    expect_light(&l, light, v3(1, 2, 3), 2, v3(1.3f, 2.2f, 4.4f), "cube");

    begin(&l);
    REQUIRE(mesh_icosphere(&m, 2), "icosphere");
    light = lab_shine(&l, lab_mesh(&l, &m, 0, true), "L=2");
    expect_light(&l, light, v_all(0), 0.006f, v3(0.3f, 0.5f, 0.6f), "inside of a mesh");
}

/* The same by solid angle: near, far, on both sides, lamps of several triangles, a flipped one. */
static void solid_lights(void)
{
    Mesh m = { 0 };
    uint32_t light;
    Lab l;

    begin(&l);
    light = lab_shine(&l, lab_quad(&l, v3(-0.5f, -1, 0.2f), v3(1, 0, 0.3f), v3(0, 2, 0), 0),
                      "L=2,sampling=solidangle");
    expect_light(&l, light, v3(0, 0, 0.35f), 1, v3(0.1f, 0.2f, 0.6f), "quad by angle");

    begin(&l);
    light = lab_shine(&l, lab_quad(&l, v3(-0.5f, -1, 0.2f), v3(1, 0, 0.3f), v3(0, 2, 0), 0),
                      "L=2,sampling=solidangle,twosided");
    expect_light(&l, light, v3(0, 0, 0.35f), 1, v3(0.1f, 0.2f, 0.4f), "two-sided quad by angle");

    begin(&l);
    REQUIRE(mesh_cube(&m), "cube");
    mesh_move(&m, 2, v3(1, 2, 3));
    light = lab_shine(&l, lab_mesh(&l, &m, 0, false), "L=2,sampling=solidangle");
    expect_light(&l, light, v3(1, 2, 3), 2, v3(1.3f, 2.2f, 4.4f), "cube by angle");

    begin(&l);
    REQUIRE(mesh_cube(&m), "cube");
    light = lab_shine(&l, lab_mesh(&l, &m, 0, true), "L=2,sampling=solidangle");
    expect_light(&l, light, v3(0, 0, 0), 0.004f, v3(0.2f, 0.1f, 0.1f), "inside of a cube");
}

static void sphere_lights(void)
{
    uint32_t light;
    Lab l;

    begin(&l);
    light = lab_shine(&l, lab_sphere(&l, v3(1, -1, 2), 0.5f, 0, false), "L=2");
    expect_light(&l, light, v3(1, -1, 2), 1, v3(1.3f, -0.6f, 2.1f), "sphere");

    begin(&l);
    light = lab_shine(&l, lab_sphere(&l, v3(1, -1, 2), 0.5f, 0, true), "L=2");
    expect_light(&l, light, v3(1, -1, 2), 0.004f, v3(1.1f, -0.7f, 2.2f), "inside of a sphere");

    begin(&l);
    light = lab_shine(&l, lab_zone(&l, v3(0, 0, 0), 1, 0.3f, 0.9f, 0, true), "L=2");
    expect_light(&l, light, v3(0, 0, 0), 0.005f, v3(0.1f, 0.2f, 0.1f), "zone from within");

    begin(&l);
    light = lab_shine(&l, lab_zone(&l, v3(0, 0, 0), 1, -0.2f, 1, 0, false), "L=2");
    expect_light(&l, light, v3(0, 0, 0), 1, v3(0.2f, 0.3f, 1.3f), "zone from outside");
}

static void disc_lights(void)
{
    uint32_t light;
    Lab l;

    begin(&l);
    light = lab_shine(&l, lab_disk(&l, v3(0, 1, 0), v3(1, 2, 2), 0.7f, 0, 0), "L=2");
    expect_light(&l, light, v3(0, 1, 0), 1, v3(0.2f, 1.2f, 0.1f), "disc");

    begin(&l);
    light = lab_shine(&l, lab_disk(&l, v3(0, 1, 0), v3(1, 2, 2), 0.7f, 0.5f, 0), "L=2,twosided");
    expect_light(&l, light, v3(0, 1, 0), 1, v3(0.2f, 1.3f, 0.3f), "ring");
}

static Rgb spotted(V3 w)        /* one bright cell, one black quarter */
{
    if (w.x > 0 && w.y > 0)
        return w.z > 0 ? rgb(0, 0, 0) : rgb(1, 1, 1);
    return w.x < -0.68f && fabsf(w.y) < 0.1f && w.z > 0.66f ? rgb(90, 60, 30)
                                                            : rgb(0.2f, 0.1f, 0.3f);
}

/* The density is the same from everywhere, so one view of each is enough. */
static void skies(void)
{
    Transform turned = xf_rotate(50, 1, 2, 3);
    View v;
    Lab l;

    for (int k = 0; k < 4; k++) {
        uint32_t light;
        begin(&l);
        light = k == 0   ? lab_light(&l, "infinite", "L=2", NULL)
                : k == 3 ? lab_sky(&l, 1, 1, spotted, NULL)
                         : lab_sky(&l, 16, 8, spotted, k == 2 ? &turned : NULL);
        lab_build(&l);
        memset(&v, 0, sizeof v);
        v.scene = l.scene;
        v.light = l.scene->lights[light];
        v.from = v3(1, 2, 3);
        v.pole = k == 2 ? xf_vector(&turned, v3(0, 0, 1)) : v3(0, 0, 1);
        expect_view(v, k == 0 ? "constant sky" : k == 3 ? "sky of one cell"
                       : k == 2 ? "turned sky" : "sky of cells");
        lab_clear(&l);
    }
}

static Rgb dappled(V3 w) { return rgb_add(spotted(w), rgb_all(0.05f)); }   /* nowhere black */

/* Other ways of sampling a picture have densities of their own. */
static void ways_of_skies(void)
{
    static const char *const ways[] = {
        "sampling=alias", "sampling=mediancut,lights=16", "sampling=mediancut,lights=4096",
        "sampling=mediancut,lights=1"
    };
    for (int k = 0; k < 4; k++) {
        View v;
        Lab l;
        begin(&l);
        memset(&v, 0, sizeof v);
        lab_sky_as(&l, 16, 8, k ? dappled : spotted, NULL, ways[k]);
        lab_build(&l);
        v.scene = l.scene;
        v.light = l.scene->lights[0];
        v.from = v3(1, 2, 3);
        v.pole = v3(0, 0, 1);
        expect_view(v, ways[k]);
        lab_clear(&l);
    }
}

/* Fixed lights: of each draw, L / pdf is a light's share over its chance; their mean is all light
 * that there is, and there are no more directions than lights. */
static void fixed_lights(void)
{
    enum { N = 4096, LIGHTS = 32 };
    V3 seen[LIGHTS];
    double sum = 0, all;
    int directions = 0;
    const Light *light;
    Lab l;

    begin(&l);
    lab_sky_as(&l, 64, 32, spotted, NULL, "sampling=mediancut,lights=32,jitter=false");
    lab_build(&l);
    light = l.scene->lights[0];
    all = (double)rgb_lum(light->kind->power(light)) / (PI * l.scene->radius * l.scene->radius);
    for (int i = 0; i < N; i++) {
        LightSample s;
        int k = 0;
        REQUIRE(light->kind->sample(light, v_all(0), (V2){ (i + 0.5f) / N, 0.3f }, &s), "a draw");
        sum += (double)(rgb_lum(s.L) / s.pdf_w) / N;
        while (k < directions && v_len2(v_sub(seen[k], s.wi)) > 1e-6f)
            k++;
        REQUIRE(k < LIGHTS, "more than %d lights", LIGHTS);
        seen[k] = s.wi;
        directions += k == directions;
    }
    EXPECT(fabs(sum / all - 1) < 1e-2, "light %g, it is %g", sum, all);
    EXPECT(directions >= LIGHTS / 2, "%d directions", directions);
    lab_clear(&l);
}

/* ---- power ---- */

static bool near_to(float x, double truth) { return fabs((double)x / truth - 1) <= 1e-5; }

static void expect_power(Lab *l, uint32_t light, double lum_one, double power, const char *what)
{
    Rgb p;

    lab_build(l);
    p = l->scene->lights[light]->kind->power(l->scene->lights[light]);
    EXPECT(near_to(p.r, power) && near_to(p.g, 2 * power) && near_to(p.b, 4 * power),
           "%s: power %g %g %g, it is %g, its double and its fourfold", what, (double)p.r,
           (double)p.g, (double)p.b, power);
    if (lum_one > 0)
        EXPECT(near_to(rgb_lum(p), lum_one), "%s: %g W asked for, %g found", what, lum_one,
               (double)rgb_lum(p));
    lab_clear(l);
}

static Rgb half_bright(V3 w) { return w.z > 0 ? rgb(1, 2, 4) : rgb(0, 0, 0); }

static void powers(void)
{
    const char *L = "L=1/2/4";
    double c0 = md_cos(20 * PI / 180), c1 = md_cos(60 * PI / 180), sum = 0;
    double lum = 0.299 + 1.174 + 0.456;
    uint32_t light;
    Lab l;

    begin(&l);
    light = lab_shine(&l, lab_quad(&l, v_all(0), v3(2, 0, 0), v3(1, 3, 0), 0), L);
    expect_power(&l, light, 0, 6 * PI, "quad");
    begin(&l);
    light = lab_shine(&l, lab_quad(&l, v_all(0), v3(2, 0, 0), v3(1, 3, 0), 0), "L=1/2/4,twosided");
    expect_power(&l, light, 0, 12 * PI, "two-sided quad");
    begin(&l);
    light = lab_shine(&l, lab_quad(&l, v_all(0), v3(2, 0, 0), v3(1, 3, 0), 0), "L=1/2/4,power=60");
    expect_power(&l, light, 60, 60 / lum, "quad of 60 W");
    begin(&l);
    light = lab_shine(&l, lab_sphere(&l, v3(1, 1, 1), 3, 0, false), L);
    expect_power(&l, light, 0, 36 * PI * PI, "sphere");
    begin(&l);
    light = lab_shine(&l, lab_zone(&l, v3(1, 1, 1), 3, -1, 2, 0, false), L);
    expect_power(&l, light, 0, 18 * PI * PI, "zone");
    begin(&l);
    light = lab_shine(&l, lab_disk(&l, v_all(0), v3(1, 1, 1), 3, 1, 0), L);
    expect_power(&l, light, 0, 8 * PI * PI, "ring");

    begin(&l);
    expect_power(&l, lab_light(&l, "point", "I=1/2/4", NULL), 0, 4 * PI, "point");
    begin(&l);
    expect_power(&l, lab_light(&l, "point", "I=1/2/4,power=25", NULL), 25, 25 / lum,
                 "point of 25 W");
    for (int i = 0; i < 10000; i++) {           /* solid angle by cosine, Simpson not needed */
        double c = c1 + (c0 - c1) * (i + 0.5) / 10000, x = (c - c1) / (c0 - c1);
        sum += x * x * (3 - 2 * x) * (c0 - c1) / 10000;
    }
    sum = 2 * PI * (sum + 1 - c0);
    begin(&l);
    light = lab_light(&l, "spot", "I=1/2/4,coneangle=60,conedeltaangle=40", NULL);
    expect_power(&l, light, 0, sum, "spot");
    begin(&l);
    light = lab_light(&l, "spot", "I=1/2/4,coneangle=60,conedeltaangle=40,power=7", NULL);
    expect_power(&l, light, 7, 7 / lum, "spot of 7 W");

    begin(&l);                                  /* the scene's ball: of the box of the sphere */
    lab_sphere(&l, v3(5, 6, 7), 2, 0, false);
    expect_power(&l, lab_light(&l, "distant", L, NULL), 0, PI * 12, "distant");
    begin(&l);
    lab_sphere(&l, v3(5, 6, 7), 2, 0, false);
    expect_power(&l, lab_light(&l, "infinite", L, NULL), 0, 4 * PI * PI * 12, "sky");
    begin(&l);
    lab_sphere(&l, v3(5, 6, 7), 2, 0, false);
    expect_power(&l, lab_sky(&l, 8, 4, half_bright, NULL), 0, 2 * PI * PI * 12, "half a sky");
}

const TestCase test_lights[] = {
    { "mesh", mesh_lights, false },
    { "solid_angle", solid_lights, false },
    { "sphere", sphere_lights, false },
    { "disc", disc_lights, false },
    { "sky", skies, false },
    { "sky_ways", ways_of_skies, false },
    { "fixed", fixed_lights, false },
    { "power", powers, false },
    { NULL, NULL, false }
};
