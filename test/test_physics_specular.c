/* test_physics_specular.c -- mirrors and glass.
 *
 * Mirror image: a perfect mirror of reflectance r shows the light once more, behind it; a floor
 * gets E of the light plus r times E of its image, where the mirror is large enough to hold that.
 *
 * Invisible glass: a body that absorbs nothing, in a sky of the same radiance L from everywhere,
 * cannot be seen: what refraction concentrates on entering, (n2/n1)^2, it spreads on leaving, and
 * Fresnel's reflectance and transmittance add up to 1. Reflection and transmission are chosen by
 * their shares, so not only the mean but every single sample is L, however often light is reflected
 * within. Excepted are rays that meet a face nearer to its edge than rounding can tell; see
 * meets_edge(). Bodies without edges have no exception. */
#include "geometry/generate.h"
#include "sampling/warp.h"
#include "test/physics.h"

#include <string.h>

/* ---- mirror image ---- */

/* Irradiance at `at` of a horizontal rectangle of radiance 1 above it, by the view factors of the
 * four rectangles with a corner above the point. */
static double corner_factor(double x, double y, double h)
{
    double a = x / h, b = y / h, p = sqrt(1 + a * a), q = sqrt(1 + b * b);
    return (a / p * md_atan2(b, p) + b / q * md_atan2(a, q)) / (2 * PI);
}

static double rectangle_irradiance(double x0, double x1, double y0, double y1, double h)
{
    return PI * (corner_factor(x1, y1, h) - corner_factor(x0, y1, h) - corner_factor(x1, y0, h) +
                 corner_factor(x0, y0, h));
}

static void mirror_image(void)
{
    static const struct { const char *options; double direct, image; } ways[] = {
        { "strategy=implicit,maxdepth=2,roulette=9", 0.02, 0.05 },
        { "strategy=explicit,maxdepth=2,roulette=9", 0.04, 0.05 },
        { "strategy=mis,maxdepth=2,roulette=9", 0.015, 0.05 },
        { "strategy=mis,heuristic=balance,maxdepth=2,roulette=9", 0.015, 0.05 },
        { "strategy=mis,maxdepth=2,roulette=9,glints=2", 0.015, 0.04 },
        { "strategy=implicit,maxdepth=2,roulette=9,glints=5", 0.02, 0.025 },
    };
    V3 at = { 0.1f, 0.2f, 0 };
    Ray r = ray_towards(v3(-0.9f, -0.7f, 0.3f), at);
    Gauge g = { ray_fixed, NULL, 400000, 41, 0 };
    /* the light spans x -2 .. 0.9, y -2 .. 3 at z = 0.8; the mirror at x = 1 turns x to 2 - x */
    double direct = rectangle_irradiance(-2.1, 0.8, -2.2, 2.8, 0.8) / PI;
    double image = rectangle_irradiance(1, 3.9, -2.2, 2.8, 0.8) / PI;
    double truth[2][3];
    uint32_t black;
    Lab l;

    lab_init(&l);
    black = lab_material(&l, "diffuse", "reflectance=0");
    lab_quad(&l, v3(-4, -5, 0), v3(5, 0, 0), v3(0, 10, 0),
             lab_material(&l, "diffuse", "reflectance=1"));
    lab_quad(&l, v3(1, -40, -1), v3(0, 0, 40), v3(0, 80, 0),
             lab_material(&l, "mirror", "reflectance=0.9/0.5/0.25"));
    lab_shine(&l, lab_quad(&l, v3(-2, -2, 0.8f), v3(0, 5, 0), v3(2.9f, 0, 0), black), "L=1/2/4");
    lab_build(&l);
    g.of = &r;
    for (int c = 0; c < 3; c++) {
        truth[0][c] = direct * (1 << c);
        truth[1][c] = image * (1 << c) * (c == 0 ? 0.9 : c == 1 ? 0.5 : 0.25);
    }
    for (size_t i = 0; i < sizeof ways / sizeof *ways; i++) {
        Meter m;
        lab_open(&l, ways[i].options);
        lab_measure(&l, &g, &m);
        stat_expect_rgb(meter_length(&m, 2), truth[0], ways[i].direct, ways[i].options);
        stat_expect_rgb(meter_length(&m, 3), truth[1], ways[i].image, ways[i].options);
    }
    lab_clear(&l);
}

/* Looking into mirrors: each multiplies by its reflectance. Two of them at right angles. */
static void mirror_seen(void)
{
    Ray r = ray_towards(v3(0.5f, 0.2f, 0.6f), v3(1, 0.25f, 0.3f));
    Gauge g = { ray_fixed, NULL, 256, 42, 0 };
    double truth[3] = { 0.5 * 0.4, 2 * 0.25 * 0.6, 4 * 0.125 * 0.8 };
    Meter m;
    Lab l;

    lab_init(&l);
    lab_quad(&l, v3(1, -5, 0), v3(0, 0, 5), v3(0, 10, 0),
             lab_material(&l, "mirror", "reflectance=0.5/0.25/0.125"));
    lab_quad(&l, v3(-5, -5, 0), v3(6, 0, 0), v3(0, 10, 0),
             lab_material(&l, "mirror", "reflectance=0.4/0.6/0.8"));
    lab_light(&l, "infinite", "L=1/2/4", NULL);
    lab_build(&l);
    g.of = &r;
    lab_open(&l, "roulette=9");
    lab_measure(&l, &g, &m);
    stat_expect_rgb(meter_radiance(&m), truth, 1e-6, "two mirrors");
    stat_expect_rgb(meter_length(&m, 3), truth, 1e-6, "two mirrors, paths of 3");
    lab_clear(&l);
}

/* ---- invisible glass ---- */

typedef enum { SPHERE, CUBE, NESTED, TORUS, FACETS, BLOB, BODIES } Body;
static const char *const body_names[BODIES] = { "sphere", "cube", "nested spheres", "torus",
                                                "icosahedron", "blob" };

static void add_body(Lab *l, Body body)
{
    uint32_t glass = lab_material(l, "dielectric", "eta=1.5");
    Mesh m = { 0 };
    bool ok = true;

    switch (body) {
    case SPHERE: lab_sphere(l, v3(0, 0, 0), 1, glass, false); return;
    case NESTED:                                /* glass around water around a bubble of air */
        lab_sphere(l, v3(0, 0, 0), 1, glass, false);
        lab_sphere(l, v3(0.2f, 0, 0), 0.7f, lab_material(l, "dielectric", "eta=0.8866667"), false);
        lab_sphere(l, v3(0.2f, 0.3f, 0), 0.3f, lab_material(l, "dielectric", "eta=0.7518797"),
                   false);
        return;
    case CUBE:   ok = mesh_cube(&m); break;
    case TORUS:  ok = mesh_torus(&m, 24, 12, 1, 0.4f); break;
    case FACETS: ok = mesh_icosphere(&m, 1); break;
    default:     ok = mesh_blob(&m, 7); break;
    }
    REQUIRE(ok, "mesh");
    lab_mesh(l, &m, glass, false);
}

/* Towards a place within the ball of radius 1. */
static Ray ray_at_body(Rng *rng)
{
    V2 u = { rng_unit(rng), rng_unit(rng) }, v = { rng_unit(rng), rng_unit(rng) };
    return ray_towards(v_scale(warp_sphere(u), 3), v_scale(warp_sphere(v), rng_unit(rng)));
}

static Rgb even_sky(V3 w)
{
    (void)w;
    return rgb(1, 2, 4);
}

static bool nearly(float a, float b) { return fabsf(a / b - 1.0f) <= ROUNDINGS(64); }

/* ---- rays that are lost at an edge ----
 *
 * A path that is not L must have met a face, by its own u and v, within
 *   reach = |err| + 8 roundings of t
 * of an edge. For there are two ways to lose it, where faces make a right angle or more:
 * - the point, a sum of the corners, errs by err (7 roundings a coordinate). So near to an edge it
 *   may come out on the plane of the next face, and ray_origin's step along its own face's normal
 *   does not take it off that if the faces are at right angles. A ray that goes out through that
 *   plane starts on it: t is 0, no hit, and it leaves the body unrefracted;
 * - the ray cuts off the edge: it enters by one face and leaves by the other after a way shorter
 *   than the two t can tell, each being off by 4 roundings (its own, and 3 of the box that bounds
 *   it). Of equal t the lower index wins, and where that is the far face it is met from inside
 *   without having been entered. The way is not shorter than the distance to the edge. */
static double edge_distance(const Lab *l, const Hit *h)
{
    const double weight[3] = { 1.0 - (double)h->u - (double)h->v, h->u, h->v };
    double least = INFINITY, area2;
    V3 c[3];

    geometry_corners(&l->scene->geometries[0], h->prim, c);
    area2 = v_len(v_cross(v_sub(c[1], c[0]), v_sub(c[2], c[0])));
    for (int k = 0; k < 3; k++) {
        double d = weight[k] * area2 / v_len(v_sub(c[(k + 2) % 3], c[(k + 1) % 3]));
        least = d < least ? d : least;
    }
    return least;
}

/* Walks the path of the sample once more: whether it meets a face within reach of an edge. */
static bool meets_edge(const Lab *l, Tracer *t, Ray r)
{
    for (int depth = 0; depth < 100000; depth++) {
        BsdfSample bs;
        Surface s;
        Frame f;
        BsdfRoom room;
        const Bsdf *b;
        Hit h;
        V3 wi;
        if (!tracer_nearest(t, &r, &h))
            return false;
        accel_surface(l->scene->accel, &r, &h, &s);
        if (s.shape->kind == SHAPE_MESH &&
            edge_distance(l, &h) <= v_len(s.err) + ROUNDINGS(8) * h.t)
            return true;
        b = material_bsdf(&l->scene->materials[s.shape->material], &s, &room);
        f = frame_about(s.ns);
        if (!b->kind->sample(b, frame_in(&f, v_neg(r.d)),
                            sample_1d(&t->sampler, DECISION(DECIDE_LOBE, depth)), (V2){ 0, 0 },
                            false, &bs))
            return false;
        wi = frame_out(&f, bs.wi);
        r = (Ray){ .o = ray_origin(s.p, s.err, s.ng, wi), .d = wi, .tmax = INFINITY };
    }
    return false;
}

/* How many of n rays may be lost so. Lines that meet a convex body pass a silhouette edge closer
 * than d with chance d sum of L (pi - angle) / S: an edge of length L is in the silhouette with
 * chance (pi - angle) / pi, is seen pi L / 4 long, and the body's shadow is S / 4. That is pi d for
 * the cube, of right angles, and no more for these rays, which are denser in the middle; flatter
 * edges lose none the first way, and fewer the second. d = 2^-23 + 2^-24: the test of a triangle
 * takes corners relative to the origin, here numbers below 4 in steps of 2^-22, which moves the ray
 * by half of one at most; and a weight below 2^-24 is lost against 1. The same again for the few
 * reflections within, at distances below 1, in steps of a quarter. In all pi 3 2^-23 = 1.1e-6.
 * Poisson's distribution of mean m is above k with p < m^(k+1) / (k+1)!, which shall be 2e-8: that
 * gives 4 of 40000 and 11 of 1e6. */
static uint32_t most_lost(uint32_t n)
{
    double m = n * PI * 3 * 0x1p-23, p = m;
    uint32_t k = 0;

    while (p > 2e-8)
        p *= m / (++k + 1);
    return k;
}

static void expect_unseen(Lab *l, const char *name)
{
    const SamplerKind *kind = kind_find(samplers, "random");
    uint32_t n = test_is_long() ? 1000000 : 40000, spp = 1, seen = 0, lost = 0;
    Rng rng = rng_seed(43);
    Tracer t;
    Opts none;
    Ray first = { .o = { 0, 0, 0 }, .d = { 0, 0, 1 }, .tmax = 0 };
    Rgb is = { 0, 0, 0 };

    memset(&t, 0, sizeof t);
    t.scene = l->scene;
    opts_default(&none, kind->info.options);
    REQUIRE(sampler_init(&t.sampler, kind, &none, 44, &spp), "sampler");
    for (uint32_t k = 0; k < n; k++) {
        Ray r = ray_at_body(&rng);
        Rgb L;
        sampler_pixel(&t.sampler, k, 0);
        sampler_start(&t.sampler, 0);
        L = l->integrator->kind->radiance(l->integrator, &r, &t);
        if (nearly(L.r, 1) && nearly(L.g, 2) && nearly(L.b, 4))
            continue;
        if (meets_edge(l, &t, r)) {
            lost++;
            continue;
        }
        if (!seen++) {
            first = r;
            is = L;
        }
    }
    EXPECT(lost <= most_lost(n), "%s: %lu of %lu rays are lost at edges, at most %lu may be", name,
           (unsigned long)lost, (unsigned long)n, (unsigned long)most_lost(n));
    EXPECT(seen == 0,
           "%s: %lu of %lu rays see it, the first from %.9g %.9g %.9g along %.9g %.9g %.9g: "
           "%.9g %.9g %.9g",
           name, (unsigned long)seen, (unsigned long)n, (double)first.o.x, (double)first.o.y,
           (double)first.o.z, (double)first.d.x, (double)first.d.y, (double)first.d.z, (double)is.r,
           (double)is.g, (double)is.b);
    EXPECT(t.rays > n + n / 2, "%s: only %.0f rays", name, (double)t.rays);
}

static void invisible(const char *options, bool cells)
{
    for (int body = 0; body < BODIES; body++) {
        Lab l;
        lab_init(&l);
        add_body(&l, (Body)body);
        if (cells)
            lab_sky(&l, 16, 8, even_sky, NULL);
        else
            lab_light(&l, "infinite", "L=1/2/4", NULL);
        lab_build(&l);
        lab_open(&l, options);
        expect_unseen(&l, body_names[body]);
        lab_clear(&l);
    }
}

/* Without roulette: it may end a path whose product is rounded to below 1. */
static void glass(void) { invisible("maxdepth=100000,roulette=100000", false); }
static void glass_implicit(void)
{
    invisible("maxdepth=100000,roulette=100000,strategy=implicit", true);
}

/* ---- a glossy lobe ---- */

/* Seen from straight above, a lobe of Phong's reflects ks of an even sky, and matt adds kd. */
static void phong_from_above(void)
{
    static const double truth[3] = { 0.3 + 0.5, 2 * (0.2 + 0.7), 4 * (0.1 + 0.25) };
    static const char *const ways[] = { "strategy=implicit,maxdepth=1",
                                        "strategy=explicit,maxdepth=1", "strategy=mis,maxdepth=1" };
    static const double delta[3] = { 0.003, 0.055, 0.01 };
    Ray r = { .o = { 0.1f, 0.2f, 1 }, .d = { 0, 0, -1 }, .tmax = INFINITY };
    Gauge g = { ray_fixed, NULL, 200000, 45, 0 };
    Lab l;

    lab_init(&l);
    lab_quad(&l, v3(-1, -1, 0), v3(2, 0, 0), v3(0, 2, 0),
             lab_material(&l, "phong", "reflectance=0.3/0.2/0.1,specular=0.5/0.7/0.25,exponent=8"));
    lab_light(&l, "infinite", "L=1/2/4", NULL);
    lab_build(&l);
    g.of = &r;
    for (int i = 0; i < 3; i++) {
        Meter m;
        lab_open(&l, ways[i]);
        lab_measure(&l, &g, &m);
        stat_expect_rgb(meter_radiance(&m), truth, delta[i], ways[i]);
    }
    lab_clear(&l);
}

/* ---- glints ---- */

static void add_instance(Lab *l, uint32_t material, V3 centre, float radius)
{
    ShapeTraits traits = { material, NO_LIGHT, false };
    Transform here = xf_translate(centre.x, centre.y, centre.z), stay = xf_identity();
    Sphere ball;
    uint32_t in, shape;

    REQUIRE(sphere_init(&ball, &stay, radius, -radius, radius, 360), "sphere");
    REQUIRE(scene_add_geometry(l->scene, &in) &&
            geometry_add_sphere(&l->scene->geometries[in], &ball, traits, &shape) &&
            geometry_add_instance(&l->scene->geometries[0], in, &here, &shape), "memory");
}

/* Caustics of glass and of a mirror on a floor that has a coat, so that it glints itself: what
 * candidates find beside a path is what the path finds alone. Explicitly it brings no other light
 * by chance, so that here they are compared by themselves. */
static void glints(void)
{
    static const char *const ways[] = { "maxdepth=5,roulette=3,strategy=explicit,glints=7",
                                        "maxdepth=5,roulette=3,strategy=explicit,glints=3" };
    Ray r = ray_towards(v3(-1.5f, -0.6f, 0.8f), v3(0.1f, -0.1f, 0));
    Gauge g = { ray_fixed, NULL, 60000, 45, 0 };

    for (int instanced = 0; instanced < 2; instanced++) {
        Meter alone, m;
        uint32_t glass;
        Lab l;
        lab_init(&l);
        glass = lab_material(&l, "dielectric", "eta=1.5");
        lab_quad(&l, v3(-2, -2, 0), v3(4, 0, 0), v3(0, 4, 0),
                 lab_material(&l, "coateddiffuse", "reflectance=0.7/0.5/0.3,roughness=0"));
        lab_quad(&l, v3(1, -1, 0), v3(0, 0, 2), v3(0, 2, 0),
                 lab_material(&l, "mirror", "reflectance=0.9/0.6/0.8"));
        if (instanced)
            add_instance(&l, glass, v3(-0.3f, 0.3f, 0.5f), 0.4f);
        else
            lab_sphere(&l, v3(-0.3f, 0.3f, 0.5f), 0.4f, glass, false);
        lab_shine(&l, lab_sphere(&l, v3(-0.3f, 0.45f, 1.4f), 0.5f, 0, false), "L=4/3/2");
        lab_build(&l);
        g.of = &r;
        g.n = 160000;
        lab_open(&l, "maxdepth=5,roulette=3,strategy=explicit");
        lab_measure(&l, &g, &alone);
        g.n = 60000;
        for (int i = 0; i < 2; i++) {
            lab_open(&l, ways[i]);
            lab_measure(&l, &g, &m);
            for (int c = 0; c < 3; c++) {
                stat_expect_same(&meter_radiance(&alone)[c], &meter_radiance(&m)[c], 0.1, ways[i]);
                stat_expect_same(&meter_strategy(&alone, STRATEGY_IMPLICIT)[c],
                                 &meter_strategy(&m, STRATEGY_IMPLICIT)[c], 0.2, ways[i]);
            }
        }
        lab_clear(&l);
    }
}

const TestCase test_physics_specular[] = {
    { "mirror_image", mirror_image, false },
    { "mirror_seen", mirror_seen, false },
    { "glints", glints, false },
    { "phong_from_above", phong_from_above, false },
    { "glass", glass, false },
    { "glass_implicit", glass_implicit, false },
    { NULL, NULL, false }
};
