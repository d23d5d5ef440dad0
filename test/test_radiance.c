/* test_radiance.c -- what the radiance cache is made of: harmonics by quadrature, records of light
 * whose harmonics have closed forms, what is told of a direction in another frame. */
#include "base/random.h"
#include "integrators/radiance.h"
#include "test/test.h"

static void expect_near(double value, double truth, double within, const char *what)
{
    EXPECT(fabs(value - truth) <= within, "%s: %g, not %g", what, value, truth);
}

/* ---- harmonics ---- */

/* Norm 1, products 0, by the middles of fine rings and of sectors that are exact for such waves. */
static void orthonormal(void)
{
    enum { RINGS = 1000, SECTORS = 24 };
    static double product[HARMONICS_MOST][HARMONICS_MOST];
    Harmonics h;

    harmonics_init(&h, HARMONIC_BANDS);
    REQUIRE(h.n == HARMONICS_MOST, "%d functions", h.n);
    for (int j = 0; j < RINGS; j++)
        for (int k = 0; k < SECTORS; k++) {
            double z = (j + 0.5) / RINGS, sine = sqrt(1 - z * z);
            float Y[HARMONICS_MOST], s, c;
            m_sincos_turn(((float)k + 0.5f) / SECTORS, &s, &c);
            harmonics_at(&h, v3((float)sine * c, (float)sine * s, (float)z), Y);
            for (int a = 0; a < h.n; a++)
                for (int b = 0; b <= a; b++)
                    product[a][b] += 2 * PI / (RINGS * SECTORS) * (double)Y[a] * (double)Y[b];
        }
    for (int a = 0; a < h.n; a++)
        for (int b = 0; b <= a; b++)
            EXPECT(fabs(product[a][b] - (a == b)) < 1e-3, "the product of %d and %d is %g", a, b,
                   product[a][b]);
}

/* Fewer bands are some of the functions of more; and below the horizon is as above. */
static void bands(void)
{
    V3 w = v_unit(v3(0.3f, -0.5f, 0.4f));
    float all[HARMONICS_MOST], few[HARMONICS_MOST], below[HARMONICS_MOST];
    Harmonics h;

    harmonics_init(&h, HARMONIC_BANDS);
    harmonics_at(&h, w, all);
    harmonics_at(&h, v3(w.x, w.y, -w.z), below);
    for (int i = 0; i < h.n; i++)
        expect_near(below[i], all[i], 1e-5, "below the horizon");
    for (int n = 1; n < HARMONIC_BANDS; n++) {
        int found = 0;
        harmonics_init(&h, n);
        harmonics_at(&h, w, few);
        for (int i = 0; i < h.n; i++)
            for (int k = found; k < HARMONICS_MOST; k++)
                if (few[i] == all[k]) {
                    found = k + 1;
                    break;
                }
        EXPECT(h.n == n * (n + 1) / 2 && found >= h.n, "%d bands", n);
    }
}

/* ---- a ball of radiance 1, all of it above the horizon ----
 *
 * It fills a cone about its middle w. By Funk and Hecke the integral of a harmonic of band l over
 * that is its value at w times 2 pi (P(l-1) - P(l+1)) / (2 l + 1), of the cone's cosine. */

static const V3 BALL = { 0.6f, -0.4f, 1.5f };
#define BALL_RADIUS 0.5f

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

static double legendre(int l, double x)
{
    double before = 1, p = x;

    if (l <= 0)
        return 1;
    for (int k = 2; k <= l; k++) {
        double next = ((2 * k - 1) * x * p - (k - 1) * before) / k;
        before = p;
        p = next;
    }
    return p;
}

/* The band of function number i: they come by m, and of each by l. */
static int band_of(int i, int bands_all)
{
    for (int m = 0; m < bands_all; m++)
        for (int l = m; l < bands_all; l += 2) {
            i -= m ? 2 : 1;
            if (i < 0)
                return l;
        }
    return -1;
}

/* All coefficients at p, in the frame f. */
static void ball_truth(const Harmonics *h, const Frame *f, V3 p, double *out)
{
    V3 d = v_sub(BALL, p);
    double r = v_len(d), c = sqrt(1 - (double)BALL_RADIUS * (double)BALL_RADIUS / (r * r));
    float Y[HARMONICS_MOST];

    harmonics_at(h, frame_in(f, v_unit(d)), Y);
    for (int i = 0; i < h->n; i++) {
        int l = band_of(i, h->bands);
        double before = l ? legendre(l - 1, c) : 1, cone = before - (l ? legendre(l + 1, c) : c);
        out[i] = (double)Y[i] * 2 * PI * cone / (2 * l + 1);
    }
}

typedef float Field(V3 p, V3 w, float *inv);

/* Channels have 1, 2 and 0 times the light. */
static Reach gather(const Harmonics *h, Field *L, V3 p, V3 n, int rays, uint64_t seed, Radiance *of)
{
    Frame f = frame_about(n);
    Rng rng = rng_seed(seed);
    Dome d;

    dome_start(&d, h, rays);
    for (int k = 0; k < d.sectors; k++)
        for (int j = 0; j < d.rings; j++) {
            float x = rng_unit(&rng), y = rng_unit(&rng), inv, light;
            V3 w = dome_direction(&d, j, k, (V2){ x, y });
            light = L(p, frame_out(&f, w), &inv);
            dome_take(&d, j, k, w, rgb(light, 2 * light, 0), inv);
        }
    return dome_end(&d, p, n, 0.01f, 10, of);
}

static void known(void)
{
    V3 p = v3(0.9f, 0.3f, 0), n = v_unit(v3(0.2f, -0.3f, 1));
    Frame f = frame_about(n);
    double truth[HARMONICS_MOST];
    Radiance of[HARMONICS_MOST];
    Harmonics h;

    harmonics_init(&h, HARMONIC_BANDS);
    gather(&h, ball_L, p, n, 60000, 1, of);
    ball_truth(&h, &f, p, truth);
    for (int i = 0; i < h.n; i++) {
        expect_near(of[i].value.r, truth[i], 0.003, "a ball's coefficient");
        expect_near(of[i].value.g, 2 * truth[i], 0.006, "green");
        expect_near(of[i].value.b, 0, 0, "blue");
    }
}

/* Against differences of the closed form. The outlines of what is seen are known as well as cells
 * are wide: 1 / 140 of the hemisphere. */
static void gradients(void)
{
    V3 p = v3(0.9f, 0.3f, 0), n = v_unit(v3(0.2f, -0.3f, 1));
    Frame f = frame_about(n);
    const V3 along[2] = { f.s, f.t };
    const float step = 0.01f;
    double before[HARMONICS_MOST], after[HARMONICS_MOST], worst = 0, most = 0;
    Radiance of[HARMONICS_MOST];
    Harmonics h;

    harmonics_init(&h, 6);
    gather(&h, ball_L, p, n, 60000, 2, of);
    for (int k = 0; k < 2; k++) {
        ball_truth(&h, &f, v_mad(along[k], -step, p), before);
        ball_truth(&h, &f, v_mad(along[k], step, p), after);
        for (int i = 0; i < h.n; i++) {
            double slope = (after[i] - before[i]) / (2 * (double)step);
            worst = d_max(worst, fabs((double)of[i].along[k].r - slope));
            most = d_max(most, fabs(slope));
        }
    }
    EXPECT(worst < 0.1 * most, "slopes up to %g, off by %g", most, worst);
}

/* ---- directions ---- */

/* Polynomials of few degrees that are even along the normal: no more than harmonics can say. */
static V3 turned_to;            /* the normal that `smooth` belongs to */
static float smooth(V3 p, V3 w, float *inv)
{
    Frame f = frame_about(turned_to);
    V3 d = frame_in(&f, w);

    (void)p;
    *inv = 0.5f;
    return 2 + d.x - 0.5f * d.y + 0.7f * d.x * d.y + 0.4f * d.z * d.z * d.x - d.y * d.y;
}

/* Whatever the frame of the place that asks, a direction has the light that it has. */
static void directions(void)
{
    Rng rng = rng_seed(5);

    for (int k = 0; k < 8; k++) {
        float x = rng_unit(&rng), y = rng_unit(&rng), z = rng_unit(&rng), inv;
        V3 n = v_unit(v3(2 * x - 1, 2 * y - 1, 2 * z - 1)), p = v3(x, y, z);
        V3 asking = v_unit(v_mad(v3(y, -x, 0.3f), 0.1f, n));
        Box around = { { -1, -1, -1 }, { 1, 1, 1 } };
        Radiance of[HARMONICS_MOST];
        RadianceStore s;
        Reach at;
        Rgb L;
        turned_to = n;
        REQUIRE(radiance_init(&s, around, 0.5f, 4), "memory");
        at = gather(&s.basis, smooth, p, n, 20000, (uint64_t)k, of);
        expect_near(at.radius, 2, 1e-3, "radius");
        REQUIRE(radiance_insert(&s, &at, of), "memory");
        for (int i = 0; i < 20; i++) {
            V3 wi = v3(rng_unit(&rng) - 0.5f, rng_unit(&rng) - 0.5f, rng_unit(&rng) - 0.5f);
            wi = v_unit(wi);
            wi = v_dot(wi, n) < 0 ? v_neg(wi) : wi;
            REQUIRE(radiance_at(&s, p, asking, wi, 0.5f, true, &L), "nothing known");
            expect_near(L.r, smooth(p, wi, &inv), 0.03, "light along a direction");
        }
        EXPECT(!radiance_at(&s, p, v_neg(n), n, 0.5f, true, &L) &&
               !radiance_known(&s, p, v_neg(n), 0.5f), "known on the other side");
        radiance_clear(&s);
    }
}

/* Two records of even light, number by number; and one of light that changes. */
static void between(void)
{
    Box around = { { -1, -1, -1 }, { 1, 1, 1 } };
    V3 up = v3(0, 0, 1), at = v3(0.25f, 0, 0);
    Radiance of = { { 1, 1, 1 }, { { 0, 0, 0 }, { 0, 0, 0 } } };
    Reach r = { v3(0, 0, 0), up, 2, 2 }, q = { v3(1, 0, 0), up, 2, 2 };
    double Y = sqrt(0.5 / PI);
    RadianceStore s;
    Rgb L;

    REQUIRE(radiance_init(&s, around, 1, 1) && radiance_insert(&s, &r, &of), "memory");
    of.value = rgb(4, -4, 0);
    of.along[0] = rgb(0, 0, 2);
    REQUIRE(radiance_insert(&s, &q, &of), "memory");
    REQUIRE(radiance_at(&s, at, up, up, 1, false, &L), "nothing known");
    expect_near(L.r, Y * (7 * 1 + 5.0 / 3 * 4) / (7 + 5.0 / 3), 1e-5, "mean");     /* 8-1, 8/3-1 */
    expect_near(L.g, Y * (7 * 1 - 5.0 / 3 * 4) / (7 + 5.0 / 3), 1e-5, "with less");
    REQUIRE(radiance_at(&s, v3(1.2f, 0, 0), up, up, 1, true, &L), "nothing known");
    {   /* the record's x may point either way */
        Frame f = frame_about(up);
        double w = 1 / 0.6 - 1, v = 1 / 0.1 - 1, there = 2 * 0.2 * (double)v_dot(f.s, v3(1, 0, 0));
        expect_near(L.b, Y * (w * 1 + v * there) / (w + v), 1e-4, "by its slope");
        expect_near(L.g, d_max(0, Y * (w * 1 - v * 4) / (w + v)), 1e-4, "no less than none");
    }
    radiance_clear(&s);
}

const TestCase test_radiance[] = {
    { "orthonormal", orthonormal, false },
    { "bands", bands, false },
    { "known", known, false },
    { "gradients", gradients, false },
    { "directions", directions, false },
    { "between", between, false },
    { NULL, NULL, false }
};
