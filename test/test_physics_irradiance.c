/* test_physics_irradiance.c -- light that arrives without a bounce, against closed forms.
 *
 * A white receiver in the plane z = 0 is looked at in one point: its radiance is E / pi.
 *   polygon   E = L/2 |sum beta_i n.gamma_i|, beta_i the angle between successive corners,
 *             gamma_i the unit normal of their plane, clipped at the horizon [Lambert1760]
 *   sphere    E = pi L (R/d)^2 cos, above the horizon
 *   disc      E = pi L / 2 (1 - (h^2 + a^2 - R^2) / sqrt((h^2 + a^2 + R^2)^2 - 4 R^2 a^2)),
 *             parallel, at height h and a off its axis
 *   sky       L = cos^k: E = 2 pi / (k + 2); of cells, the sum of L dphi (sin^2 b - sin^2 a) / 2
 * Each strategy that can find the light must agree: asking for it, meeting it, both. */
#include "base/random.h"
#include "test/physics.h"

#include <stdio.h>
#include <string.h>

static const double LE[3] = { 1, 2, 4 };
#define LE_TEXT "L=1/2/4"
static const V3 AT = { 0.05f, 0.02f, 0 };       /* the point that is looked at */

/* ---- the receiver and the ways ---- */

static uint32_t begin(Lab *l)           /* gives a black material for the lights */
{
    uint32_t white, black;
    lab_init(l);
    white = lab_material(l, "diffuse", "reflectance=1");
    black = lab_material(l, "diffuse", "reflectance=0");
    lab_quad(l, v3(-4, -5, 0), v3(10, 0, 0), v3(0, 10, 0), white);
    return black;
}

/* Deltas of the three ways; 0: cannot, or not with finite variance. */
typedef struct { double implicit, explicit, mis; uint64_t n; } Power;

static void expect_way(Lab *l, const char *options, const Gauge *g, const double E[3], double delta,
                       const char *what)
{
    double L[3] = { E[0] / PI, E[1] / PI, E[2] / PI };
    char text[200];
    Meter m;

    snprintf(text, sizeof text, "%s,maxdepth=1,roulette=9", options);
    lab_open(l, text);
    lab_measure(l, g, &m);
    snprintf(text, sizeof text, "%s, %s", what, options);
    stat_expect_rgb(meter_radiance(&m), L, delta, text);
}

/* Builds the scene and asks all ways for the irradiance E at the point `at`. */
static void expect_irradiance(Lab *l, V3 at, const double E[3], Power p, const char *what)
{
    Ray r = ray_towards(v3(-0.9f, -0.7f, 0.11f), at);
    Gauge g = { ray_fixed, NULL, 0, 31, 0 };

    g.of = &r;
    g.n = p.n;
    lab_build(l);
    if (p.implicit > 0)
        expect_way(l, "strategy=implicit", &g, E, p.implicit, what);
    if (p.explicit > 0) {
        expect_way(l, "strategy=explicit", &g, E, p.explicit, what);
        expect_way(l, "strategy=explicit,lightsampler=uniform", &g, E, p.explicit, what);
    }
    if (p.mis > 0) {
        expect_way(l, "strategy=mis,heuristic=power", &g, E, p.mis, what);
        expect_way(l, "strategy=mis,heuristic=balance", &g, E, p.mis, what);
    }
    lab_clear(l);
}

static void grey(double E, double rgb[3])
{
    for (int c = 0; c < 3; c++)
        rgb[c] = LE[c] * E;
}

/* ---- polygons ---- */

typedef struct { double x, y, z; } D3;

static D3 d3_sub(V3 a, V3 b)
{
    return (D3){ (double)a.x - b.x, (double)a.y - b.y, (double)a.z - b.z };
}
static double d3_dot(D3 a, D3 b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
static D3 d3_cross(D3 a, D3 b)
{
    return (D3){ a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x };
}

/* The part above the horizon z = 0 of a polygon seen from the origin; room for n + 1 corners. */
static int clip(const D3 *in, int n, D3 *out)
{
    int count = 0;
    for (int i = 0; i < n; i++) {
        D3 a = in[i], b = in[(i + 1) % n];
        if (a.z >= 0)
            out[count++] = a;
        if ((a.z >= 0) != (b.z >= 0)) {
            double t = a.z / (a.z - b.z);
            out[count++] = (D3){ a.x + t * (b.x - a.x), a.y + t * (b.y - a.y), 0 };
        }
    }
    return count;
}

/* Irradiance at `at`, normal +z, of a polygon of radiance 1 that faces it. */
static double polygon_irradiance(V3 at, const V3 *corner, int n)
{
    D3 v[8], w[9];
    double sum = 0;

    for (int i = 0; i < n; i++)
        v[i] = d3_sub(corner[i], at);
    n = clip(v, n, w);
    for (int i = 0; i < n; i++) {
        D3 a = w[i], b = w[(i + 1) % n], g = d3_cross(a, b);
        double size = sqrt(d3_dot(g, g));
        if (size > 0)
            sum += md_atan2(size, d3_dot(a, b)) * g.z / size;
    }
    return 0.5 * fabs(sum);
}

typedef struct { const char *name; V3 corner, a, b; Power power; } Quad;        /* front a x b */

/* The power of `far`, from its geometry. Asking: the value goes as g = cos cos / d^2, whose
 * relative deviation over the quadrangle is, to first order,
 *   cv = sqrt(((grad ln g . a)^2 + (grad ln g . b)^2) / 12) = 0.00207;
 * 8.7 cv / sqrt(2e5) = 4.03e-5, and 7 % more because the deviation is itself measured, from 3125
 * blocks: 5.6 / sqrt(2 * 3125) is 7 %. So 4.4e-5.
 * Both ways, balanced: a direction of the BSDF meets the light with chance q = E / pi = 6.44e-6.
 * Such a hit weighs q against asking's 1, which adds E / pi: the mean once more. So k hits in n
 * samples give a variance of cv^2 + k / n. Expected are q n = 1.29, or 20.6 under --long; Poisson's
 * distribution gives more than 11, or 50, with p < 2e-8, and 8.7 sqrt((cv^2 + k / n) / n) is then
 * 1.51e-4, or 2.2e-5 where a quarter is allowed. So 1.6e-4. By the power heuristic such hits weigh
 * q^2, as good as nothing. With n = 20000 the numbers would be 1.6e-4 and 1e-3. */
static const Quad quads[] = {
    { "overhead", { -0.5f, -0.4f, 1 }, { 0, 1, 0 }, { 1, 0, 0 }, { 0.04, 0.01, 0.02, 200000 } },
    { "wall that touches", { 0.5f, -0.6f, 0 }, { 0, 0, 1 }, { 0, 1.2f, 0 },
      { 0.04, 0.03, 0.02, 200000 } },
    { "tilted", { 0.3f, -0.5f, 0.4f }, { -0.2f, 0.3f, 0.5f }, { 0.5f, 0.9f, 0.2f },
      { 0.06, 0.02, 0.03, 200000 } },
    { "through the horizon", { 0.7f, -0.5f, -0.5f }, { 0, 0, 1 }, { 0, 1, 0.3f },
      { 0.06, 0.03, 0.03, 200000 } },
    { "huge", { -100, -100, 1 }, { 0, 200, 0 }, { 200, 0, 0 }, { 0.001, 0, 0.003, 200000 } },
    { "large", { -10, -10, 1 }, { 0, 20, 0 }, { 20, 0, 0 }, { 0.003, 0.15, 0.015, 200000 } },
    { "tiny", { 0.3f, 0.1f, 0.8f }, { 1e-4f, 0, 0 }, { 0, -1e-4f, 0 }, { 0, 1e-5, 1e-5, 20000 } },
    { "far", { 400, 300, 800 }, { 4, 0, -2 }, { 0, -5, 0 }, { 0, 4.4e-5, 1.6e-4, 200000 } },
};

static void quad_corners(const Quad *q, V3 v[4])
{
    v[0] = q->corner;
    v[1] = v_add(q->corner, q->a);
    v[2] = v_add(v[1], q->b);
    v[3] = v_add(q->corner, q->b);
}

static void polygons(void)
{
    for (size_t i = 0; i < sizeof quads / sizeof *quads; i++) {
        const Quad *q = &quads[i];
        uint32_t black;
        double E[3];
        V3 v[4];
        Lab l;

        black = begin(&l);
        lab_shine(&l, lab_quad(&l, q->corner, q->a, q->b, black), LE_TEXT);
        quad_corners(q, v);
        grey(polygon_irradiance(AT, v, 4), E);
        expect_irradiance(&l, AT, E, q->power, q->name);
    }
}

/* A light shines from its front, or from both sides. */
static void sides(void)
{
    static const Quad q = { "", { -0.5f, -0.4f, 1 }, { 1, 0, 0 }, { 0, 1, 0 }, { 0, 0, 0, 0 } };
    static const Power away = { 1, 1, 1, 1000 }, both = { 0.04, 0.01, 0.02, 200000 };
    const double none[3] = { 0, 0, 0 };
    uint32_t black;
    double E[3];
    V3 v[4];
    Lab l;

    black = begin(&l);
    lab_shine(&l, lab_quad(&l, q.corner, q.a, q.b, black), LE_TEXT);
    expect_irradiance(&l, AT, none, away, "light that faces away");
    black = begin(&l);
    lab_shine(&l, lab_quad(&l, q.corner, q.a, q.b, black), "L=1/2/4,twosided");
    quad_corners(&q, v);
    grey(polygon_irradiance(AT, v, 4), E);
    expect_irradiance(&l, AT, E, both, "two-sided light seen from its back");
}

/* A black screen at half the height hides what lies below twice its edge. */
static void shadow(void)
{
    static const V3 seen[4] = { { 0.25f, -0.4f, 1 }, { 0.25f, 0.6f, 1 }, { 0.5f, 0.6f, 1 },
                                { 0.5f, -0.4f, 1 } };
    static const Power power = { 0.08, 0.04, 0.05, 200000 }, dark = { 0, 1, 1, 1000 };
    const double none[3] = { 0, 0, 0 };
    uint32_t black = 0;
    double E[3];
    Lab l;

    for (int i = 0; i < 2; i++) {
        black = begin(&l);
        lab_quad(&l, v3(-3, -3, 0.5f), v3(3.15f, 0, 0), v3(0, 6, 0), black);
        if (i == 0) {                           /* the edge at x = 0.15 hides x < 0.25 at z = 1 */
            lab_shine(&l, lab_quad(&l, v3(-0.5f, -0.4f, 1), v3(0, 1, 0), v3(1, 0, 0), black),
                      LE_TEXT);
            grey(polygon_irradiance(AT, seen, 4), E);
            expect_irradiance(&l, AT, E, power, "light half hidden");
        } else {
            lab_light(&l, "point", "from=0.2/0/1", NULL);
            lab_light(&l, "distant", "from=-0.2/0/1,to=0/0/0", NULL);
            expect_irradiance(&l, AT, none, dark, "delta lights hidden");
        }
    }
}

enum { ROWS = 25, COLUMNS = 40, MANY = ROWS * COLUMNS };

/* Small triangles of different radiance on a dome, each a light of its own; none hides another. */
static void many(void)
{
    static const Power power = { 0.12, 0.02, 0.03, 200000 };
    double E[3] = { 0, 0, 0 };
    Rng rng = rng_seed(5);
    uint32_t black;
    Lab l;

    black = begin(&l);
    for (int i = 0; i < MANY; i++) {
        Mesh m = { 0 };
        float z = 0.05f + 0.9f * (float)(i / COLUMNS) / ROWS;
        float phi = 2 * PI_F * (float)(i % COLUMNS) / COLUMNS;
        float r = sqrtf(1 - z * z), L = 1 + rng_unit(&rng);
        V3 d = v3(r * m_cos(phi), r * m_sin(phi), z), v[3];
        Frame f = frame_about(v_neg(d));
        char text[40];

        m.p = MEM_ARRAY(V3, 3);
        m.tri = MEM_ARRAY(Tri, 1);
        REQUIRE(m.p && m.tri, "memory");
        m.nverts = 3;
        m.ntris = 1;
        m.tri[0] = (Tri){ { 0, 1, 2 } };
        for (int k = 0; k < 3; k++)
            m.p[k] = v[k] = v_mad(frame_out(&f, v3(m_cos(2.1f * k), m_sin(2.1f * k), 0)), 0.03f,
                                  v_mad(d, 2 + 0.5f * (float)i / MANY, AT));
        snprintf(text, sizeof text, "L=%.9g/1/0.5", (double)L);
        lab_shine(&l, lab_mesh(&l, &m, black, false), text);
        E[0] += L * polygon_irradiance(AT, v, 3);
        E[1] += polygon_irradiance(AT, v, 3);
        E[2] += 0.5 * polygon_irradiance(AT, v, 3);
    }
    expect_irradiance(&l, AT, E, power, "a thousand lights");
}

/* ---- spheres and discs ---- */

/* Sphere at c, radius R, by the cone it fills: a sum over its disc of directions. */
static double sphere_irradiance(V3 at, V3 c, double R)
{
    enum { N = 1500 };
    D3 d = d3_sub(c, at);
    double d2 = d3_dot(d, d), sin2 = R * R / d2, height = sin2 / (1 + sqrt(1 - sin2));
    double up = d.z / sqrt(d2), side = sqrt(1 - up * up), sum = 0;

    for (int i = 0; i < N; i++) {               /* equal solid angles */
        double down = height * (i + 0.5) / N, s = sqrt(down * (2 - down));
        for (int k = 0; k < N; k++) {
            double z = (1 - down) * up + s * md_cos(2 * PI * (k + 0.5) / N) * side;
            sum += z > 0 ? z : 0;
        }
    }
    return sum / N / N * 2 * PI * height;
}

/* The power of `far sphere`, as that of `far` above: directions uniform on a disc of radius
 * R/d = 1.414e-3 across, at 45 degrees, give cv = 1.414e-3 / 2, so 8.7 cv / sqrt(2e5) = 1.38e-5,
 * and 7 %. q = (R/d)^2 cos = 1.41e-6, q n = 0.28 (4.5): more than 7 (20) hits have p < 2e-8, which
 * is 1.15e-4 (1.3e-5 where a quarter is allowed). */
static void spheres(void)
{
    static const struct { const char *name; V3 c; float R; Power power; } s[] = {
        { "sphere", { 0.5f, 0.3f, 1.2f }, 0.4f, { 0.07, 0.005, 0.01, 200000 } },
        { "near sphere", { 0.3f, -0.2f, 1 }, 0.95f, { 0.012, 0.01, 0.01, 200000 } },
        { "tiny sphere", { 0.5f, 0.3f, 1.2f }, 1e-4f, { 0, 1e-5, 1e-5, 20000 } },
        { "far sphere", { 3000, 4000, 5000 }, 10, { 0, 1.5e-5, 1.2e-4, 200000 } },
        { "sphere through the horizon", { 1.2f, 0, 0.2f }, 0.7f, { 0.07, 0.025, 0.03, 200000 } },
    };
    for (size_t i = 0; i < sizeof s / sizeof *s; i++) {
        D3 d = d3_sub(s[i].c, AT);
        double d2 = d3_dot(d, d), exact = PI * s[i].R * s[i].R * d.z / (d2 * sqrt(d2)), E[3];
        bool above = d.z > s[i].R;
        uint32_t black;
        Lab l;

        black = begin(&l);
        lab_shine(&l, lab_sphere(&l, s[i].c, s[i].R, black, false), LE_TEXT);
        if (above)                              /* the sum itself against the closed form */
            EXPECT(fabs(sphere_irradiance(AT, s[i].c, s[i].R) / exact - 1) < 1e-5, "cone sum");
        grey(above ? exact : sphere_irradiance(AT, s[i].c, s[i].R), E);
        expect_irradiance(&l, AT, E, s[i].power, s[i].name);
    }
}

/* The upper half of a sphere around the point: E = pi L. And its lower half of 60 degrees. */
static void dome(void)
{
    static const Power power = { 1e-4, 0.015, 0.02, 200000 };
    static const float zmin[2] = { 0, 1.5f };
    for (int i = 0; i < 2; i++) {
        Power p = power;
        uint32_t black;
        double E[3];
        Lab l;

        black = begin(&l);
        lab_shine(&l, lab_zone(&l, AT, 3, zmin[i], 3, black, true), LE_TEXT);
        grey(PI * (1 - zmin[i] * zmin[i] / 9.0), E);
        p.implicit = i ? 0.02 : 1e-4;
        expect_irradiance(&l, AT, E, p, i ? "cap" : "dome");
    }
}

static double disc_irradiance(double h, double a, double R)
{
    double s = h * h + a * a, q = s + R * R;
    return 0.5 * PI * (1 - (s - R * R) / sqrt(q * q - 4 * R * R * a * a));
}

static void discs(void)
{
    static const struct { const char *name; V3 c; float R, inner; Power power; } d[] = {
        { "disc on the axis", { 0.05f, 0.02f, 1 }, 0.5f, 0, { 0.04, 0.005, 0.02, 200000 } },
        { "disc off the axis", { 0.65f, 0.82f, 0.7f }, 0.6f, 0, { 0.06, 0.02, 0.03, 200000 } },
        { "ring", { 0.05f, 0.02f, 0.5f }, 0.5f, 0.3f, { 0.04, 0.01, 0.02, 200000 } },
        { "ring off the axis", { 0.35f, 0.42f, 0.6f }, 0.6f, 0.45f, { 0.06, 0.02, 0.03, 200000 } },
    };
    for (size_t i = 0; i < sizeof d / sizeof *d; i++) {
        D3 to = d3_sub(d[i].c, AT);
        double a = sqrt(to.x * to.x + to.y * to.y), E[3];
        uint32_t black;
        Lab l;

        black = begin(&l);
        lab_shine(&l, lab_disk(&l, d[i].c, v3(0, 0, -1), d[i].R, d[i].inner, black), LE_TEXT);
        grey(disc_irradiance(to.z, a, d[i].R) -
             (d[i].inner > 0 ? disc_irradiance(to.z, a, d[i].inner) : 0), E);
        expect_irradiance(&l, AT, E, d[i].power, d[i].name);
    }
}

/* ---- lights without extent ---- */

static void deltas(void)
{
    static const Power power = { 0, 1e-6, 1e-6, 1000 };
    double d2 = 0.25 * 0.25 + 0.28 * 0.28 + 1.2 * 1.2, d = sqrt(d2), E[3];
    Transform t = xf_translate(0.25, 0.28, 0.2);
    Lab l;

    begin(&l);
    lab_light(&l, "point", "I=1/2/4,from=0.3/0.3/1.2", NULL);
    grey(1.2 / (d2 * d), E);
    expect_irradiance(&l, AT, E, power, "point");

    begin(&l);                          /* the same by a transform and by power */
    lab_light(&l, "point", "I=1/2/4,from=0.05/0.02/1,power=100", &t);
    for (int c = 0; c < 3; c++)
        E[c] *= 100 / (4 * PI * (0.299 * 1 + 0.587 * 2 + 0.114 * 4));
    expect_irradiance(&l, AT, E, power, "point of 100 W");

    begin(&l);
    lab_light(&l, "distant", "L=1/2/4,from=0.3/-0.4/1.2,to=0/0/0", NULL);
    grey(1.2 / sqrt(0.09 + 0.16 + 1.44), E);
    expect_irradiance(&l, AT, E, power, "distant");
}

/* Full within 20 degrees of the axis, none beyond 60, between them 3x^2 - 2x^3 of the cosine. */
static void spot(void)
{
    static const double angle[] = { 0, 15, 19.9, 21, 40, 50, 61, 80 };
    static const Power power = { 0, 1e-6, 1e-6, 1000 }, dark = { 0, 1, 1, 1000 };
    double inner = md_cos(20 * PI / 180), outer = md_cos(60 * PI / 180);

    for (size_t i = 0; i < sizeof angle / sizeof *angle; i++) {
        double c = md_cos(angle[i] * PI / 180), x = (c - outer) / (inner - outer), E[3];
        V3 at = v3((float)(1.5 * md_sin(angle[i] * PI / 180) / c), 0, 0);
        char name[40];
        Lab l;

        begin(&l);
        lab_light(&l, "spot", "I=1/2/4,from=0/0/1.5,to=0/0/0.5,coneangle=60,conedeltaangle=40",
                  NULL);
        x = x < 0 ? 0 : x > 1 ? 1 : x;
        c = md_cos(md_atan2(at.x, 1.5));        /* of the point as a float */
        grey(x * x * (3 - 2 * x) * c * c * c / (1.5 * 1.5), E);
        snprintf(name, sizeof name, "spot at %g degrees", angle[i]);
        expect_irradiance(&l, at, E, E[0] > 0 ? power : dark, name);
    }
}

/* ---- skies ---- */

static Rgb sky_even(V3 w) { (void)w; return rgb(1, 2, 4); }
static Rgb sky_cos2(V3 w) { float c = f_max(0, w.z); return rgb(c * c, 2 * c * c, 4 * c * c); }
static Rgb sky_cos9(V3 w)
{
    float c = f_max(0, w.z), c3 = c * c * c;
    return rgb_scale(rgb(1, 2, 4), c3 * c3 * c3);
}
/* One bright cell of 64 x 32, at 45 degrees, on a dim sky. */
static Rgb sky_sun(V3 w)
{
    bool sun = w.x > 0.6f && w.y > 0 && w.y < 0.08f && w.z > 0.64f && w.z < 0.72f;
    return rgb_scale(rgb(1, 2, 4), sun ? 1e4f : 0.1f);
}

/* Irradiance of the cells as they are, by direction, on a receiver that faces +z. */
static double cells_irradiance(uint32_t w, uint32_t h, Rgb (*f)(V3 w))
{
    double sum = 0;
    for (uint32_t y = 0; 2 * y < h; y++)
        for (uint32_t x = 0; x < w; x++) {
            double a = md_sin(PI * y / h), b = md_sin(PI * (y + 1) / h);
            double theta = PI * (y + 0.5) / h, phi = 2 * PI * (x + 0.5) / w, st = md_sin(theta);
            V3 d = v3((float)(st * md_cos(phi)), (float)(st * md_sin(phi)), (float)md_cos(theta));
            sum += (double)f(d).r * 2 * PI / w * 0.5 * (b * b - a * a);
        }
    return sum;
}

static void skies(void)
{
    static const struct { const char *name; Rgb (*f)(V3); double k; Power power; } s[] = {
        { "even sky of cells", sky_even, 0, { 1e-5, 0.03, 0.01, 200000 } },
        { "sky cos^2", sky_cos2, 2, { 0.02, 0.02, 0.02, 200000 } },
        { "sky cos^9", sky_cos9, 9, { 0.03, 0.02, 0.02, 200000 } },
        { "sky with a sun", sky_sun, -1, { 0, 0.02, 0.02, 200000 } },
    };
    static const Power constant = { 1e-5, 0.03, 0.01, 200000 };
    double E[3];
    Lab l;

    begin(&l);
    lab_light(&l, "infinite", LE_TEXT, NULL);
    grey(PI, E);
    expect_irradiance(&l, AT, E, constant, "constant sky");
    for (size_t i = 0; i < sizeof s / sizeof *s; i++) {
        Transform t = xf_rotate(77, 0, 0, 1);
        double sum = cells_irradiance(64, 32, s[i].f);
        if (s[i].k >= 0)
            EXPECT(fabs(sum / (2 * PI / (s[i].k + 2)) - 1) < 0.01, "%s: the cells give %g",
                   s[i].name, sum);
        begin(&l);
        lab_sky(&l, 64, 32, s[i].f, &t);
        grey(sum, E);
        expect_irradiance(&l, AT, E, s[i].power, s[i].name);
    }
}

/* A sky that is bright around x, turned so that this is overhead; turned back it would be below. */
static Rgb sky_aside(V3 w)
{
    float c = f_max(0, w.x);
    return rgb_scale(rgb(1, 2, 4), c * c);
}

static void turned_sky(void)
{
    static const Power power = { 0.02, 0.02, 0.02, 200000 };
    Transform t = xf_rotate(-90, 0, 1, 0);      /* x to z */
    double E[3];
    Lab l;

    begin(&l);
    lab_sky(&l, 128, 64, sky_aside, &t);
    grey(PI / 2, E);
    expect_irradiance(&l, AT, E, power, "turned sky");
}

const TestCase test_physics_irradiance[] = {
    { "polygons", polygons, false },
    { "sides", sides, false },
    { "shadow", shadow, false },
    { "many", many, false },
    { "spheres", spheres, false },
    { "dome", dome, false },
    { "discs", discs, false },
    { "deltas", deltas, false },
    { "spot", spot, false },
    { "skies", skies, false },
    { "turned_sky", turned_sky, false },
    { NULL, NULL, false }
};
