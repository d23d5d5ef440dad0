/* test_irradiance.c -- what irradiance caches are made of: gradients against closed forms, the tree
 * of balls against all balls, records between which one interpolates. */
#include "base/mem.h"
#include "base/random.h"
#include "integrators/irradiance.h"
#include "test/test.h"

/* ---- light with closed forms ---- */

/* A ball of radiance 1: E = pi R^2 n.d / |d|^3 where all of it is above the horizon. */
static const V3 BALL = { 0.6f, -0.4f, 1.5f };
#define BALL_RADIUS 0.5f

static double ball_E(V3 p, V3 n)
{
    V3 d = v_sub(BALL, p);
    double r = v_len(d);
    return PI * BALL_RADIUS * BALL_RADIUS * v_dot(n, d) / (r * r * r);
}

static float ball_L(V3 p, V3 w, float *inv)
{
    V3 d = v_sub(BALL, p);
    float b = v_dot(d, w), c = v_len2(d) - BALL_RADIUS * BALL_RADIUS;

    *inv = 0.0f;
    if (b < 0 || b * b < c)
        return 0.0f;
    *inv = 1.0f / (b - sqrtf(b * b - c));
    return 1.0f;
}

/* A wall of radiance 1 in the plane x = 0, up to this height over the plane z = 0, endless along y:
 * at the distance x from it E = pi/2 (1 - x / sqrt(x^2 + height^2)) on that plane. */
#define WALL 1.2f

static double wall_E(double x) { return PI / 2 * (1 - x / sqrt(x * x + (double)WALL * WALL)); }

static float wall_L(V3 p, V3 w, float *inv)
{
    float t = -p.x / w.x;

    *inv = w.x < 0 && p.z + t * w.z <= WALL ? 1.0f / t : 0.0f;
    return *inv > 0 ? 1.0f : 0.0f;
}

/* A disc of radiance 1 at the height h, over the axis: E = pi R^2 / (R^2 + h^2). */
static float disc_L(V3 p, V3 w, float *inv)
{
    float t = (1.0f - p.z) / w.z;
    V3 at = v_mad(w, t, p);

    *inv = at.x * at.x + at.y * at.y < 0.49f ? 1.0f / t : 0.0f;
    return *inv > 0 ? 1.0f : 0.0f;
}

static float even_L(V3 p, V3 w, float *inv)
{
    (void)p, (void)w;
    *inv = 0.25f;
    return 1.0f;
}

typedef float Field(V3 p, V3 w, float *inv);

/* The channels have 1, 2 and 0 times the light. */
static Irradiance gather(Field *L, V3 p, V3 n, int rays, uint64_t seed)
{
    Frame f = frame_about(n);
    Irradiance out;
    Hemisphere h;
    Rng rng = rng_seed(seed);

    hemisphere_start(&h, rays);
    for (int k = 0; k < h.sectors; k++)
        for (int j = 0; j < h.rings; j++) {
            float x = rng_unit(&rng), y = rng_unit(&rng), inv, light;
            light = L(p, frame_out(&f, hemisphere_direction(&h, j, k, (V2){ x, y })), &inv);
            hemisphere_take(&h, j, k, rgb(light, 2 * light, 0), inv);
        }
    hemisphere_end(&h, &f, &out);
    return out;
}

static void expect_near(double value, double truth, double within, const char *what)
{
    EXPECT(fabs(value - truth) <= within, "%s: %g, not %g", what, value, truth);
}

static void known(void)
{
    V3 p = v3(0.9f, 0.3f, 0), up = v3(0, 0, 1), tilted = v_unit(v3(0.2f, -0.3f, 1));
    Irradiance e = gather(even_L, p, tilted, 300, 1);

    for (int k = 0; k < 3; k++) {
        expect_near(v_len(e.move[k]), 0, 1e-5, "even light: move");
        expect_near(v_len(e.turn[k]), 0, 1e-4, "even light: turn");
    }
    expect_near(e.E.r, PI, 1e-5, "even light");
    expect_near(e.inv_distance, 0.25, 1e-6, "mean distance");
    e = gather(disc_L, v3(0, 0, 0), up, 40000, 2);
    expect_near(e.E.r, PI * 0.49 / 1.49, 0.005, "disc");
    expect_near(e.E.g, 2 * e.E.r, 1e-5, "channels");
    expect_near(e.E.b, 0, 0, "channels");
    e = gather(wall_L, p, up, 40000, 3);
    expect_near(e.E.r, wall_E(p.x), 0.005, "wall");
    e = gather(ball_L, p, tilted, 40000, 4);
    expect_near(e.E.r, ball_E(p, tilted), 0.005, "ball");
}

/* Against differences of the closed forms. */
static void gradients(void)
{
    V3 p = v3(0.9f, 0.3f, 0), up = v3(0, 0, 1), n = v_unit(v3(0.2f, -0.3f, 1));
    const V3 axis[3] = { { 1, 0, 0 }, { 0, 1, 0 }, { 0, 0, 1 } };
    const float h = 0.01f;
    Irradiance e = gather(ball_L, p, n, 60000, 5);
    double E = ball_E(p, n), slope;

    for (int k = 0; k < 3; k++) {
        V3 d = v_sub(axis[k], v_scale(n, v_dot(axis[k], n)));   /* along the surface */
        V3 turned = v_unit(v_mad(d, h, n)), back = v_unit(v_mad(d, -h, n));
        slope = (ball_E(v_mad(d, h, p), n) - ball_E(v_mad(d, -h, p), n)) / (2 * h);
        expect_near(v_dot(d, e.move[0]), slope, 0.05 * E, "ball: move");
        expect_near(v_dot(d, e.move[1]), 2 * slope, 0.1 * E, "ball: move, green");
        slope = ball_E(p, turned) - ball_E(p, back);
        expect_near(v_dot(v_sub(v_cross(n, turned), v_cross(n, back)), e.turn[0]), slope,
                    0.02 * h * E, "ball: turn");
    }
    e = gather(wall_L, p, up, 60000, 6);
    slope = (wall_E(p.x + h) - wall_E(p.x - h)) / (2 * h);
    expect_near(e.move[0].x, slope, 0.03 * fabs(slope), "wall: away from it");
    expect_near(e.move[0].y, 0, 0.03 * fabs(slope), "wall: along it");
}

/* ---- trees of balls ---- */

static float uniform(Rng *rng, float lo, float hi)
{
    return lo + (hi - lo) * rng_unit(rng);
}

static V3 anywhere(Rng *rng, float size)
{
    float x = uniform(rng, -size, size), y = uniform(rng, -size, size);
    return v3(x, y, uniform(rng, -size, size));
}

enum { BALLS = 500, QUESTIONS = 2000 };

/* Also balls and questions outside of the box. */
static void tree(void)
{
    Box box = { { -1, -1, -1 }, { 1, 1, 1 } };
    Rng rng = rng_seed(3);
    V3 p[BALLS];
    float r[BALLS];
    BallTree t;
    size_t seen = 0, standing = 0;

    REQUIRE(balltree_init(&t, box), "memory");
    for (uint32_t i = 0; i < BALLS; i++) {
        p[i] = anywhere(&rng, 1.2f);
        r[i] = m_exp(uniform(&rng, -7, 0.5f));
        REQUIRE(balltree_add(&t, p[i], r[i], i), "memory");
    }
    for (size_t i = 0; i < t.nballs; i++)
        standing += t.balls[i].n;
    EXPECT(standing <= 8 * BALLS, "%lu balls in cells", (unsigned long)standing);
    for (int q = 0; q < QUESTIONS; q++) {
        int count[BALLS] = { 0 };
        V3 x = q < BALLS ? p[q] : anywhere(&rng, 1.3f);
        BallWalk walk = balltree_ask(&t, x);
        uint32_t id;
        while (balltree_next(&walk, &id)) {
            count[id]++;
            seen++;
        }
        for (int i = 0; i < BALLS; i++)
            EXPECT(count[i] == (v_len(v_sub(x, p[i])) <= r[i]) ||
                   fabsf(v_len(v_sub(x, p[i])) / r[i] - 1) < 1e-6f, "ball %d is met %d times", i,
                   count[i]);
    }
    EXPECT(seen < (size_t)QUESTIONS * BALLS / 4, "%lu balls looked at", (unsigned long)seen);
    balltree_clear(&t);
    EXPECT(mem_blocks() == 0, "blocks are left");
}

/* ---- records ---- */

static IrradianceRecord plain(V3 p, V3 n, float radius, float E)
{
    IrradianceRecord r = { { p, n, radius, 0.001f }, { .E = { E, E, E } } };
    return r;
}

/* The store against a look at all its records. */
static void store(void)
{
    Box box = { { -1, -1, -1 }, { 1, 1, 1 } };
    Rng rng = rng_seed(4);
    IrradianceStore s;
    int found = 0;

    REQUIRE(irradiance_init(&s, box, 0.4f), "memory");
    for (int i = 0; i < 400; i++) {
        V3 p = anywhere(&rng, 1), n = v_unit(v_mad(anywhere(&rng, 1), 0.2f, v3(0, 0, 1)));
        IrradianceRecord r = plain(p, n, uniform(&rng, 0.1f, 2), uniform(&rng, 1, 2));
        r.of.move[1] = anywhere(&rng, 0.3f);
        r.of.turn[2] = anywhere(&rng, 0.3f);
        REQUIRE(irradiance_insert(&s, &r), "memory");
    }
    for (int q = 0; q < 1000; q++) {
        V3 p = anywhere(&rng, 1), n = v_unit(v_mad(anywhere(&rng, 1), 0.2f, v3(0, 0, 1)));
        float a = q % 2 ? 0.4f : 0.2f;
        IrradianceSum sum = { 0, { 0, 0, 0 } };
        Rgb E, all;
        bool known = irradiance_at(&s, p, n, a, true, &E);
        for (size_t i = 0; i < s.n; i++)
            irradiance_add(&sum, &s.reaches.at[i], &s.of[i], p, n, a, true);
        found += known;
        if (irradiance_mean(&sum, &all) != known)
            EXPECT(false, "the tree and all records differ in whether there is one");
        else if (known)
            EXPECT(rgb_max(rgb_sub(E, all)) < 1e-5f && rgb_min(rgb_sub(E, all)) > -1e-5f,
                   "the tree and all records differ");
    }
    EXPECT(found > 300 && found < 1000, "%d of 1000 places are known", found);
    irradiance_clear(&s);
}

/* Weights and what is passed over, number by number. errata 7.15 */
static void weights(void)
{
    V3 up = v3(0, 0, 1), tilted = v3(0.6f, 0, 0.8f);
    IrradianceRecord r = plain(v3(0, 0, 0), up, 2, 1), s = plain(v3(1, 0, 0), up, 2, 4);
    IrradianceSum sum = { 0, { 0, 0, 0 } };
    Rgb E;

    expect_near(reach_error(&r.at, v3(0.3f, 0.4f, 0), up), 0.25, 1e-6, "by place");
    expect_near(reach_error(&r.at, v3(0, 0, 0), tilted), sqrt(0.2), 1e-6, "by normal");
    EXPECT(!is_finite(reach_error(&r.at, v3(0, 0, -0.5f), up)), "a place below it is not passed");
    EXPECT(is_finite(reach_error(&r.at, v3(0, 0, 0.5f), up)), "a place above it is passed over");
    irradiance_add(&sum, &r.at, &r.of, v3(0.25f, 0, 0), up, 1, true);     /* e = 1/8: 8 - 1 */
    irradiance_add(&sum, &s.at, &s.of, v3(0.25f, 0, 0), up, 1, true);     /* e = 3/8: 8/3 - 1 */
    irradiance_add(&sum, &s.at, &s.of, v3(-1.01f, 0, 0), up, 1, true);    /* e > 1: none */
    EXPECT(irradiance_mean(&sum, &E), "no mean");
    expect_near(E.r, (7 * 1 + 5.0 / 3 * 4) / (7 + 5.0 / 3), 1e-5, "mean");
}

/* Radii: by distance, gradient and bounds; and neighbours differ by no more than their distance. */
static void radii(void)
{
    Box box = { { -1, -1, -1 }, { 1, 1, 1 } };
    Irradiance of = { .E = { 1, 1, 1 }, .inv_distance = 2 };
    V3 up = v3(0, 0, 1), zero = v3(0, 0, 0);
    IrradianceRecord r;
    IrradianceStore s;

    expect_near(irradiance_record(zero, up, &of, 0.1f, 10).at.radius, 0.5, 1e-6, "distance");
    expect_near(irradiance_record(zero, up, &of, 0.1f, 0.3f).at.radius, 0.3, 1e-6, "most");
    for (int k = 0; k < 3; k++)
        of.move[k] = v3(5, 0, 0);
    expect_near(irradiance_record(zero, up, &of, 0.1f, 10).at.radius, 0.2, 1e-6, "gradient");
    r = irradiance_record(zero, up, &of, 0.4f, 10);
    expect_near(r.at.radius, 0.4, 1e-6, "least");
    expect_near(r.of.move[1].x, 2.5, 1e-5, "a gradient beyond its reach");
    REQUIRE(irradiance_init(&s, box, 0.5f), "memory");
    r = plain(zero, up, 1, 1);
    REQUIRE(irradiance_insert(&s, &r), "memory");
    r = plain(v3(0.1f, 0, 0), up, 0.2f, 1);     /* shrinks the first */
    REQUIRE(irradiance_insert(&s, &r), "memory");
    r = plain(v3(-0.1f, 0, 0), up, 3, 1);       /* is shrunk by it */
    REQUIRE(irradiance_insert(&s, &r), "memory");
    expect_near(s.reaches.at[0].radius, 0.3, 1e-6, "a neighbour that was there");
    expect_near(s.reaches.at[1].radius, 0.2, 1e-6, "the small one");
    expect_near(s.reaches.at[2].radius, 0.4, 1e-6, "one that comes later");
    irradiance_clear(&s);
}

/* Two records a part of the way to the ball apart: with gradients the places between are known to
 * the second order. */
static void between(void)
{
    V3 up = v3(0, 0, 1);
    double worst[2] = { 0, 0 };

    for (int with = 0; with < 2; with++) {
        Box box = { { -2, -2, -2 }, { 2, 2, 2 } };
        IrradianceStore s;
        REQUIRE(irradiance_init(&s, box, 0.6f), "memory");
        for (int i = -3; i <= 3; i++) {
            V3 p = v3(0.3f * (float)i, -0.2f, 0);
            Irradiance of = gather(ball_L, p, up, 20000, 9);
            IrradianceRecord r = irradiance_record(p, up, &of, 0.6f, 0.6f);
            REQUIRE(irradiance_insert(&s, &r), "memory");
        }
        for (float x = -0.8f; x <= 0.8f; x += 0.05f) {
            V3 p = v3(x, 0, 0);
            Rgb E;
            REQUIRE(irradiance_at(&s, p, up, 0.6f, with != 0, &E), "nothing known at %g",
                    (double)x);
            worst[with] = d_max(worst[with], fabs(E.r / ball_E(p, up) - 1));
        }
        irradiance_clear(&s);
    }
    EXPECT(worst[1] < 0.04 && worst[1] < 0.4 * worst[0], "errors %g without, %g with gradients",
           worst[0], worst[1]);
}

const TestCase test_irradiance[] = {
    { "known", known, false },
    { "gradients", gradients, false },
    { "tree", tree, false },
    { "store", store, false },
    { "weights", weights, false },
    { "radii", radii, false },
    { "between", between, false },
    { NULL, NULL, false }
};
