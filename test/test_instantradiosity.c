/* test_instantradiosity.c -- virtual point lights against path tracing, and what they are.
 *
 * Tails       Near a virtual light what it brings has no bound, so the spread of a pixel that looks
 *             into a corner is not to be trusted. Scenes without a clamp here have no corners:
 *             between a floor and what hangs over it, all of them are of the order of their mean.
 *             Corners are for clamp with compensate, whose variance is finite.
 * Tied        Tiles of one picture have the same lights: only whole runs are independent. */
#include "geometry/generate.h"
#include "integrators/virtualcuts.h"
#include "test/lamp_help.h"

#include <stdio.h>
#include <string.h>

/* ---- scenes ---- */

static void add_lamp(Lab *l, const char *lamp)
{
    uint32_t black = lab_material(l, "diffuse", "reflectance=0");
    uint32_t grey = lab_material(l, "diffuse", "reflectance=0.5");

    if (!strcmp(lamp, "quad"))
        lab_shine(l, lab_quad(l, v3(-1, -1, 4), v3(0, 2, 0), v3(2, 0, 0), grey), "L=4/5/6");
    else if (!strcmp(lamp, "sides"))
        lab_shine(l, lab_quad(l, v3(-1, -1, 4), v3(0, 2, 0), v3(2, 0, 1), black),
                  "L=4/5/6,twosided=true,exponent=3");
    else if (!strcmp(lamp, "ball"))
        lab_shine(l, lab_sphere(l, v3(-2, -1, 4), 0.5f, black, false), "L=8/6/4");
    else if (!strcmp(lamp, "point"))
        lab_light(l, "point", "from=1/-2/5,I=9", NULL);
    else if (!strcmp(lamp, "infinite"))
        lab_light(l, "infinite", "L=0.5/0.7/1", NULL);
    else if (!strcmp(lamp, "picture"))
        lab_sky(l, 16, 8, lamp_sky, NULL);
    else
        REQUIRE(false, "no lamp %s", lamp);
}

/* A floor, and over it a matt plate that hangs free, seen from above; a glossy one beside it; and a
 * ball whose shading normals are far from its flat sides. */
static void add_plates(Lab *l)
{
    Mesh ball;

    REQUIRE(mesh_icosphere(&ball, 1), "memory");
    ball.n = MEM_ARRAY(V3, ball.nverts);
    REQUIRE(ball.n, "memory");
    memcpy(ball.n, ball.p, ball.nverts * sizeof *ball.p);
    mesh_move(&ball, 0.6f, v3(0.2f, -2.2f, 1.2f));
    lab_mesh(l, &ball, lab_material(l, "diffuse", "reflectance=0.8"), false);
    lab_quad(l, v3(-3, -3, 0), v3(6, 0, 0), v3(0, 6, 0),
             lab_material(l, "diffuse", "reflectance=0.7/0.6/0.5"));
    lab_quad(l, v3(-2, -1, 1.2f), v3(1.8f, 0, 0.3f), v3(0, 2, 0),
             lab_material(l, "diffuse", "reflectance=0.3/0.5/0.7"));
    lab_quad(l, v3(0.6f, -1, 1.4f), v3(1.8f, 0, 0), v3(0, 2, 0.2f),
             lab_material(l, "phong", "reflectance=0.3,specular=0.4,exponent=6"));
    lab_camera(l, v3(0.5f, -7, 3), v3(0, 0, 0.6f), 45, "");
}

static void compare_as(Lab *l, const char *path, const char *options, uint32_t spp, uint32_t more,
                       double delta, const char *what)
{
    char text[200];
    Series a, b;

    snprintf(text, sizeof text, "instantradiosity:%s", options);
    series_render(l, &a, path, 32, spp, 1);
    series_render(l, &b, text, 32, more, 2);
    b.tied = true;
    series_expect_same(&b, &a, delta, what);
    series_clear(&a);
    series_clear(&b);
}

/* ---- truth ---- */

static void lamps(void)
{
    static const char *const names[] = { "quad", "sides", "ball", "point", "infinite", "picture" };

    for (size_t i = 0; i < sizeof names / sizeof *names; i++) {
        Lab l;
        lab_init(&l);
        add_lamp(&l, names[i]);
        add_plates(&l);
        lab_build(&l);
        compare_as(&l, "path:maxdepth=4,roulette=2", "lights=512,maxdepth=4,roulette=2", 8, 1, 0.12,
                   names[i]);
        lab_clear(&l);
    }
}

/* No path has more edges than it may. */
static void expect_no_longer(Lab *l, const char *method, int edges)
{
    RenderSettings s;
    RenderReport report;
    char aov[40];
    Image im;
    Film f;

    snprintf(aov, sizeof aov, "length:%d=a.pfm", edges + 1);
    picture_settings(l, &s, method, 32, 32, 1);
    REQUIRE(aov_parse(&s.aovs[0], aov), "%s", aov);
    s.naovs = 1;
    picture_render(l, &s, &f, &report);
    REQUIRE(image_init(&im, 32, 32), "memory");
    film_picture(&f, 1, &im);
    for (int i = 0; i < 32 * 32; i++)
        EXPECT(rgb_black(im.pixels[i]), "%s: a path of %d edges", method, edges + 1);
    image_clear(&im);
    film_clear(&f);
}

/* Eye paths by mirrors count as parts of paths: none is too long or too short. A wall of mirror
 * lights the floor too. */
static void mirror(void)
{
    for (int depth = 1; depth <= 3; depth++) {
        char path[80], ours[80];
        Lab l;
        lab_init(&l);
        add_lamp(&l, "quad");
        add_plates(&l);
        lab_sphere(&l, v3(0, -2.5f, 2.5f), 0.6f, lab_material(&l, "mirror", ""), false);
        lab_quad(&l, v3(-3, 3, 0), v3(6, 0, 0), v3(0, 0, 4), lab_material(&l, "mirror", ""));
        lab_build(&l);
        snprintf(path, sizeof path, "path:maxdepth=%d", depth);
        snprintf(ours, sizeof ours, "lights=256,maxdepth=%d,compensate=true", depth);
        compare_as(&l, path, ours, 16, 2, 0.2, path);
        snprintf(path, sizeof path, "instantradiosity:lights=9,maxdepth=%d", depth);
        expect_no_longer(&l, path, depth + 1);
        lab_clear(&l);
    }
}

/* A closed room with a ball of glass in a corner and a glossy one: what the bound takes away comes
 * back, and so does the caustic. */
static void corners(void)
{
    uint32_t white;
    Mesh room;
    Lab l;

    lab_init(&l);
    white = lab_material(&l, "diffuse", "reflectance=0.7/0.6/0.5");
    REQUIRE(mesh_box(&room, v3(-2, -2, 0), v3(2, 2, 3)), "memory");
    lab_mesh(&l, &room, white, true);
    lab_sphere(&l, v3(-1.2f, 1.2f, 0.7f), 0.6f, lab_material(&l, "dielectric", ""), false);
    lab_sphere(&l, v3(1.1f, 1.0f, 0.6f), 0.6f,
               lab_material(&l, "phong", "reflectance=0.3,specular=0.5,exponent=8"), false);
    lab_shine(&l, lab_disk(&l, v3(0, 0, 2.95f), v3(0, 0, -1), 1.2f, 0, white), "L=4");
    lab_camera(&l, v3(0, -1.8f, 1.5f), v3(0, 1, 1.1f), 75, "");
    lab_build(&l);
    compare_as(&l, "path:maxdepth=5,roulette=3",
               "lights=64,clamp=6,compensate=true,maxdepth=5,roulette=3", 16, 6, 0.3, "a room");
    lab_clear(&l);
}

/* What absorbs takes its part of lights, whichever way they go. */
static void haze(void)
{
    Medium m = { "haze", { 0.05f, 0.1f, 0.15f }, { 0, 0, 0 }, 0 };
    uint32_t index;
    Lab l;

    lab_init(&l);
    REQUIRE(scene_add_medium(l.scene, &m, &index), "memory");
    l.scene->around = index;
    add_lamp(&l, "quad");
    add_lamp(&l, "point");
    add_plates(&l);
    lab_build(&l);
    compare_as(&l, "path:maxdepth=3", "lights=512,maxdepth=3", 8, 1, 0.12, "haze");
    lab_clear(&l);
}

/* ---- the lights themselves ---- */

static void make_lights(Lab *l, VirtualLights *v, uint32_t paths, uint32_t sets, int maxdepth)
{
    Tracer t;
    Opts none;
    uint32_t spp = 1;

    memset(&t, 0, sizeof t);
    t.scene = l->scene;
    opts_default(&none, samplers[0]->info.options);
    REQUIRE(sampler_init(&t.sampler, samplers[0], &none, 7, &spp), "sampler");
    REQUIRE(virtuallights_init(v, l->scene, paths, sets, maxdepth, 3), "lights");
    for (int phase = 0; phase < VIRTUAL_PHASES; phase++)
        for (uint64_t n = virtuallights_units(v, phase), i = n; i-- > 0;)      /* any order */
            REQUIRE(virtuallights_run(v, phase, i, &t), "lights");
    sampler_clear(&t.sampler);
}

/* Watts, by 64 x 128 directions that fill equal solid angles. */
static double power_of(const VirtualLights *v, const VirtualLight *l)
{
    double sum = 0;

    for (int i = 0; i < 64; i++)
        for (int k = 0; k < 128; k++) {
            float z = (float)(2 * i + 1) / 64 - 1, r = sqrtf(1 - z * z), sn, cs;
            m_sincos_turn(((float)k + 0.5f) / 128, &sn, &cs);
            sum += (double)rgb_lum(virtuallight_intensity(v, l, v3(r * cs, r * sn, z)));
        }
    return sum * 4 * PI / (64 * 128);
}

/* On lamps they shine with the lamps' power, each set of them. */
static void power(void)
{
    uint32_t black;
    double all = 0;
    VirtualLights v;
    Lab l;

    lab_init(&l);
    black = lab_material(&l, "diffuse", "reflectance=0");
    lab_shine(&l, lab_quad(&l, v3(-1, -1, 4), v3(0, 2, 0), v3(2, 0, 0), black), "L=4/5/6");
    lab_shine(&l, lab_sphere(&l, v3(3, 0, 4), 0.5f, black, false), "L=2,exponent=2");
    lab_shine(&l, lab_disk(&l, v3(-3, 0, 2), v3(1, 0, 1), 0.7f, 0.3f, black), "L=3,twosided=true");
    lab_camera(&l, v3(0, -7, 3), v3(0, 0, 1), 45, "");
    lab_build(&l);
    for (size_t i = 0; i < l.scene->nlights; i++)
        all += (double)rgb_lum(l.scene->lights[i]->kind->power(l.scene->lights[i]));
    make_lights(&l, &v, 200, 3, 4);
    for (uint32_t set = 0; set < 3; set++) {
        const VirtualLight *light = v.light + v.set[set].first;
        size_t n = 0;
        double sum = 0;
        while (n < v.set[set].n && light[n].depth == 0)
            n++;
        EXPECT(n == 200, "%lu lights on lamps", (unsigned long)n);
        for (size_t i = 0; i < n; i++)
            sum += power_of(&v, &light[i]);
        EXPECT(fabs(sum / all - 1) < 0.01, "%g W, lamps have %g", sum, all);
    }
    virtuallights_clear(&v);
    lab_clear(&l);
}

/* Within a closed matt ball all flux arrives, and the k-th vertices shine with albedo^k of it; what
 * they leave is in the order of depth. */
static void flux(void)
{
    VirtualLights v;
    double watts[4] = { 0, 0, 0, 0 };
    Lab l;

    lab_init(&l);
    lab_sphere(&l, v3(0, 0, 0), 3, lab_material(&l, "diffuse", "reflectance=0.6"), true);
    lab_light(&l, "point", "from=0.5/0/1,I=1", NULL);
    lab_camera(&l, v3(0, -2, 0), v3(0, 0, 0), 45, "");
    lab_build(&l);
    make_lights(&l, &v, 500, 1, 4);
    EXPECT(v.n == 1500 && v.nvertices == 0, "%lu lights", (unsigned long)v.n);
    for (size_t i = 0; i < v.n; i++) {
        EXPECT(i == 0 || v.light[i].depth >= v.light[i - 1].depth, "out of order");
        watts[v.light[i].depth] += power_of(&v, &v.light[i]);
    }
    for (int k = 1; k < 4; k++)
        EXPECT(fabs(watts[k] / (4 * PI * pow(0.6, k)) - 1) < 0.01, "vertex %d: %g W", k, watts[k]);
    virtuallights_clear(&v);
    lab_clear(&l);
}

/* ---- clusters ---- */

enum { POINTS = 300 };

static V3 any_direction(Rng *r)
{
    float z = 2 * rng_unit(r) - 1, rho = sqrtf(1 - z * z), sn, cs;
    m_sincos_turn(rng_unit(r), &sn, &cs);
    return v3(rho * cs, rho * sn, z);
}

/* Lights in a cloud that is flat or not, about one normal, more or less. */
static void random_lights(Rng *r, OrientedLight *l, int kind)
{
    V3 about = any_direction(r);
    float wide = kind % 3 == 0 ? 0.0f : kind % 3 == 1 ? 0.3f : 2.0f;

    for (int i = 0; i < POINTS; i++) {
        l[i].p = v3(rng_unit(r), rng_unit(r), kind & 1 ? 0.4f : rng_unit(r));
        l[i].n = v_unit(v_mad(any_direction(r), wide, about));
        l[i].power = 0.01f + rng_unit(r);
        l[i].two_sided = kind == 5 && i % 7 == 0;
    }
}

static double exactly(const OrientedLight *l, const LitMatt *at)
{
    V3 d = v_sub(l->p, at->p);
    double d2 = (double)v_len2(d), len = sqrt(d2), out = -(double)v_dot(l->n, d) / len;
    double in = (double)v_dot(at->n, d) / len;

    if (l->two_sided)
        out = fabs(out);
    return in > 0 && out > 0 ? in * out / d2 : 0;
}

/* Gives the number of lights below. */
static uint32_t expect_bounds(const Cluster *c, const OrientedLight *l, const LitMatt *at,
                              double *most, double *power)
{
    double one, other, sum[2] = { 0, 0 };
    uint32_t n = 1;

    if (!c->second) {
        *most = exactly(&l[c->light], at);
        *power = (double)c->power;
    } else {
        n = expect_bounds(c + 1, l, at, &one, &sum[0]) +
            expect_bounds(c + c->second, l, at, &other, &sum[1]);
        *most = one > other ? one : other;
        *power = sum[0] + sum[1];
        EXPECT(c->light == c[1].light || c->light == c[c->second].light, "stands for no child");
    }
    EXPECT(fabs((double)c->power / *power - 1) < 1e-4, "power %g", (double)c->power);
    EXPECT(*most <= (double)cluster_bound(c, at), "%g is above the bound %g", *most,
           (double)cluster_bound(c, at));
    return n;
}

static Cluster tree_of[2 * POINTS];
static OrientedLight cloud[POINTS];

static void random_point(Rng *r, LitMatt *at)
{
    at->p = v3(3 * rng_unit(r) - 1, 3 * rng_unit(r) - 1, 3 * rng_unit(r) - 1);
    at->n = any_direction(r);
    at->most = INFINITY;
}

static void cluster_bounds(void)
{
    Rng r = rng_seed(3);
    uint32_t order[POINTS];
    double most, power;
    LitMatt at;

    for (int kind = 0; kind < 12; kind++) {
        random_lights(&r, cloud, kind % 6);
        clusters_build(tree_of, order, cloud, POINTS, 1, (uint64_t)kind);
        for (int i = 0; i < 200; i++) {
            random_point(&r, &at);
            EXPECT(expect_bounds(tree_of, cloud, &at, &most, &power) == POINTS, "lights are lost");
        }
    }
}

/* Unhindered: what light number k brings. */
static Rgb ask_cloud(void *ctx, uint32_t root, uint32_t light)
{
    (void)root;
    return rgb_all(cloud[light].power * (float)exactly(&cloud[light], ctx));
}

/* A cut is off by no more than all its bounds together; each of these is small enough; and by less
 * than the tolerance in the mean, far less than its clusters. */
static void cuts(void)
{
    static CutCluster cut[CLUSTERS_MOST];
    Rng r = rng_seed(5);
    uint32_t order[POINTS];
    const Cluster *root = tree_of;
    double squares = 0, sizes = 0;
    int lit = 0;

    random_lights(&r, cloud, 1);
    clusters_build(tree_of, order, cloud, POINTS, 1, 9);
    for (int i = 0; i < 2000; i++) {
        CutAsk q = { .f = 1, .tolerance = 0.02f, .most = 1000, .ask = ask_cloud };
        double truth = 0, sum = 0, error = 0;
        size_t n;
        random_point(&r, &q.at);
        q.ctx = &q.at;
        n = clusters_cut(&root, 1, &q, cut);
        for (int k = 0; k < POINTS; k++)
            truth += (double)cloud[k].power * exactly(&cloud[k], &q.at);
        for (size_t k = 0; k < n; k++) {
            sum += (double)(cut[k].unit.g * cut[k].node->power);
            error += (double)cut[k].error;
        }
        for (size_t k = 0; k < n; k++)
            EXPECT((double)cut[k].error <= 0.0201 * sum, "a cluster is off by %g of %g",
                   (double)cut[k].error, sum);
        EXPECT(fabs(sum - truth) <= error + 1e-4 * truth, "%g, not %g: off by more than %g", sum,
               truth, error);
        if (truth > 1e-6) {
            squares += (sum / truth - 1) * (sum / truth - 1);
            sizes += (double)n;
            lit++;
        }
    }
    EXPECT(lit > 200 && sqrt(squares / lit) < 0.02, "off by %g", sqrt(squares / lit));
    EXPECT(sizes / lit < 0.8 * POINTS, "%g clusters of %d lights", sizes / lit, POINTS);
}

/* The picture by cuts, with mirrors, glossy things and shadows, is that by each light. */
static void cut_picture(void)
{
    Image im[2];
    double squares = 0, sum = 0;
    Lab l;

    lab_init(&l);
    add_lamp(&l, "sides");
    add_lamp(&l, "quad");
    add_plates(&l);
    lab_sphere(&l, v3(0, -2.5f, 2.5f), 0.6f, lab_material(&l, "mirror", ""), false);
    lab_build(&l);
    for (int k = 0; k < 2; k++) {
        static const char *const how[] = { "cut=0", "cut=0.02" };
        RenderSettings s;
        RenderReport report;
        char text[100];
        Film f;
        snprintf(text, sizeof text, "instantradiosity:lights=600,clamp=50,%s", how[k]);
        picture_settings(&l, &s, text, 32, 32, 1);
        picture_render(&l, &s, &f, &report);
        REQUIRE(image_init(&im[k], 32, 32), "memory");
        film_picture(&f, 0, &im[k]);
        film_clear(&f);
    }
    for (int i = 0; i < 32 * 32; i++) {
        double a = (double)rgb_lum(im[0].pixels[i]), b = (double)rgb_lum(im[1].pixels[i]);
        squares += a > 0 ? (b / a - 1) * (b / a - 1) : 0;
        sum += a > 0;
    }
    EXPECT(sqrt(squares / sum) < 0.02, "cuts are off by %g", sqrt(squares / sum));
    image_clear(&im[0]);
    image_clear(&im[1]);
    lab_clear(&l);
}

/* ---- the picture ---- */

static void render_room(Lab *l, const char *method, int threads, Film *f)
{
    RenderSettings s;
    RenderReport report;

    picture_settings(l, &s, method, 40, 24, 1);
    s.threads = threads;
    picture_render(l, &s, f, &report);
}

/* A bound only takes away, the more the lower it is; interleaved sets give each pixel the light
 * that its own set gives; threads change nothing. */
static void bounds(void)
{
    static const char *const clamp[] = { "0", "1e6", "4", "0.5" };
    Image im[4];
    Film one, three;
    double sum[4];
    Lab l;

    lab_init(&l);
    add_lamp(&l, "quad");
    add_plates(&l);
    lab_quad(&l, v3(-3, 3, 0), v3(6, 0, 0), v3(0, 0, 3), lab_material(&l, "diffuse", ""));
    lab_build(&l);
    for (int k = 0; k < 4; k++) {
        char text[100];
        snprintf(text, sizeof text, "instantradiosity:lights=20,clamp=%s", clamp[k]);
        render_room(&l, text, 1, &one);
        REQUIRE(image_init(&im[k], 40, 24), "memory");
        film_picture(&one, 0, &im[k]);
        film_clear(&one);
        sum[k] = 0;
        for (int i = 0; i < 40 * 24; i++) {
            sum[k] += (double)im[k].pixels[i].g;
            EXPECT(!k || im[k].pixels[i].g <= im[k - 1].pixels[i].g, "pixel %d is brighter", i);
        }
        EXPECT(k < 2 || sum[k] < 0.999 * sum[k - 1], "clamp=%s takes nothing away", clamp[k]);
    }
    for (int k = 0; k < 4; k++)
        image_clear(&im[k]);
    render_room(&l, "instantradiosity:lights=20,interleave=3,clamp=9,compensate=true", 1, &one);
    render_room(&l, "instantradiosity:lights=20,interleave=3,clamp=9,compensate=true", 3, &three);
    EXPECT(films_equal(&one, &three), "threads change the picture");
    film_clear(&one);
    film_clear(&three);
    lab_clear(&l);
}

static void refuses(void)
{
    VirtualLights v;
    Image im;
    Film f;
    Lab l;

    messages_quiet(true);
    lab_init(&l);
    add_plates(&l);
    lab_build(&l);
    EXPECT(!virtuallights_init(&v, l.scene, 500000, 4, 5, 3), "two million paths");
    render_room(&l, "instantradiosity:lights=10", 1, &f);       /* no light at all */
    REQUIRE(image_init(&im, 40, 24), "memory");
    film_picture(&f, 0, &im);
    for (int i = 0; i < 40 * 24; i++)
        EXPECT(rgb_black(im.pixels[i]), "light from nowhere");
    image_clear(&im);
    film_clear(&f);
    lab_clear(&l);
}

const TestCase test_instantradiosity[] = {
    { "lamps", lamps, false },
    { "mirror", mirror, false },
    { "corners", corners, false },
    { "haze", haze, false },
    { "power", power, false },
    { "flux", flux, false },
    { "cluster_bounds", cluster_bounds, false },
    { "cuts", cuts, false },
    { "cut_picture", cut_picture, false },
    { "bounds", bounds, false },
    { "refuses", refuses, false },
    { NULL, NULL, false }
};
