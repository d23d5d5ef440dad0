/* test_panorama.c -- pictures of directions: every mapping is a bijection of its picture and the
 * directions that it shows, with the jacobian that it says, and shows up, left and right where the
 * head of panorama.h puts them. The sky's numbers against those of its paper. */
#include "base/random.h"
#include "sampling/warp.h"
#include "scene/panorama.h"
#include "test/physics.h"

#include <stdio.h>

static const Mapping mappings[] = {
    { MAPPING_LATLONG, 0, 0 }, { MAPPING_OCTAHEDRAL, 0, 0 }, { MAPPING_ANGULAR, 0, 0 },
    { MAPPING_MIRRORBALL, 0, 0 }, { MAPPING_WINDOW, 0.7f, 1.9f }
};
static const char *const names[] = { "latlong", "octahedral", "angular", "mirrorball", "window" };
enum { MAPPINGS = 5 };

static V3 anywhere(Rng *rng)
{
    V2 u = { rng_unit(rng), 0 };
    u.y = rng_unit(rng);
    return warp_sphere(u);
}

/* ---- there and back ---- */

/* How far a place may be off: float coordinates in a map that stretches by 1 / sqrt(jacobian). */
static void round_trip(void)
{
    for (int k = 0; k < MAPPINGS; k++) {
        const Mapping *m = &mappings[k];
        Rng rng = rng_seed(71);
        double far_place = 0, far_direction = 0;
        int shown = 0;
        for (int i = 0; i < 200000; i++) {
            V2 p = { rng_unit(&rng), 0 }, q;
            float j, back;
            V3 d, e;
            p.y = rng_unit(&rng);
            d = mapping_direction(m, p, &j);
            EXPECT(fabsf(v_len2(d) - 1) <= ROUNDINGS(16), "%s: |d|^2 = %.9g", names[k],
                   (double)v_len2(d));
            if (j > 0.5f) {                     /* away from poles, rims and grazing windows */
                q = mapping_place(m, d, &back);
                far_place = d_max(far_place, hypot((double)q.x - p.x, (double)q.y - p.y));
                EXPECT(fabsf(back / j - 1) <= 1e-4f, "%s: jacobian %.9g there, %.9g back",
                       names[k], (double)j, (double)back);
                shown++;
            }
            d = anywhere(&rng);
            q = mapping_place(m, d, &j);
            e = mapping_direction(m, q, &back);
            if (j > 0)                          /* each direction is somewhere */
                far_direction = d_max(far_direction, (double)v_len(v_sub(e, d)));
            else
                EXPECT(m->kind == MAPPING_WINDOW, "%s shows not all directions", names[k]);
        }
        EXPECT(shown > 100000, "%s: %d places", names[k], shown);
        EXPECT(far_place <= 2e-6, "%s: place to place is off by %g", names[k], far_place);
        /* next to the rim of a ball a step of a place is a big step of the direction */
        EXPECT(far_direction <= (m->kind == MAPPING_MIRRORBALL ? 2e-3 : 2e-5),
               "%s: direction to direction is off by %g", names[k], far_direction);
    }
}

static double product(V3 d) { return d.x * d.y + 0.3 * d.z * d.z * d.z + d.x + 0.5 * d.y * d.y; }

/* The area of a small square's picture, and integrals of known functions: over all directions the
 * mean of y^2 is 1/3, of the odd ones 0. */
static void jacobians(void)
{
    enum { N = 700 };
    for (int k = 0; k < MAPPINGS; k++) {
        const Mapping *m = &mappings[k];
        double one = 0, f = 0, all = mapping_solid_angle(m);
        Rng rng = rng_seed(72);
        float j;
        for (int y = 0; y < N; y++)
            for (int x = 0; x < N; x++) {
                V2 p = { ((float)x + 0.5f) / N, ((float)y + 0.5f) / N };
                V3 d = mapping_direction(m, p, &j);
                one += (double)j / N / N;
                f += product(d) * (double)j / N / N;
            }
        EXPECT(fabs(one / all - 1) < 1e-3, "%s: solid angle %.9g, it is %.9g", names[k], one, all);
        if (m->kind != MAPPING_WINDOW)
            EXPECT(fabs(f / (all / 6) - 1) < 3e-3, "%s: integral %.9g, it is %.9g", names[k], f,
                   all / 6);
        for (int i = 0; i < 20000; i++) {
            const float h = 1e-3f;
            V2 p = { h + (1 - 2 * h) * rng_unit(&rng), 0 };
            V3 a, b, c, d;
            float ja, jb, jc, jd, area;
            p.y = h + (1 - 2 * h) * rng_unit(&rng);
            a = mapping_direction(m, (V2){ p.x - h, p.y }, &ja);
            b = mapping_direction(m, (V2){ p.x + h, p.y }, &jb);
            c = mapping_direction(m, (V2){ p.x, p.y - h }, &jc);
            d = mapping_direction(m, (V2){ p.x, p.y + h }, &jd);
            mapping_direction(m, p, &j);
            if (!(f_min(f_min(ja, jb), f_min(jc, jd)) > 1) || v_dot(a, b) < 0.9998f ||
                v_dot(c, d) < 0.9998f || (m->kind == MAPPING_OCTAHEDRAL &&
                (fabsf(p.x - 0.5f) < 2 * h || fabsf(p.y - 0.5f) < 2 * h ||
                 fabsf(fabsf(p.x - 0.5f) + fabsf(p.y - 0.5f) - 0.5f) < 2 * h)))
                continue;                       /* seams, folds and rims */
            area = v_len(v_cross(v_sub(b, a), v_sub(d, c))) / (4 * h * h);
            EXPECT(fabsf(area / j - 1) < 0.02f, "%s at %.4f %.4f: area %.6g, jacobian %.6g",
                   names[k], (double)p.x, (double)p.y, (double)area, (double)j);
        }
    }
}

/* ---- where things are ---- */

static void places(void)
{
    static const struct { MappingKind kind; V3 d; float x, y; } known[] = {
        { MAPPING_LATLONG, { -1, 0, 0 }, 0.5f, 0.5f },
        { MAPPING_LATLONG, { 0, 1, 0 }, 0.25f, 0.5f },
        { MAPPING_LATLONG, { 0.8f, 0, 0.6f }, 0, 0.295167f },
        { MAPPING_OCTAHEDRAL, { 0, 0, 1 }, 0.5f, 0.5f },
        { MAPPING_OCTAHEDRAL, { 1, 0, 0 }, 1, 0.5f }, { MAPPING_OCTAHEDRAL, { 0, 1, 0 }, 0.5f, 1 },
        { MAPPING_OCTAHEDRAL, { -0.8f, 0, 0.6f }, 0.183772f, 0.5f },
        { MAPPING_OCTAHEDRAL, { 0.70710678f, 0.70710678f, 0 }, 0.75f, 0.75f },
        { MAPPING_OCTAHEDRAL, { 0.565685f, 0.565685f, -0.6f }, 0.841886f, 0.841886f },
        { MAPPING_ANGULAR, { -1, 0, 0 }, 0.5f, 0.5f },
        { MAPPING_ANGULAR, { 0, 1, 0 }, 0.75f, 0.5f },
        { MAPPING_ANGULAR, { 0, 0, 1 }, 0.5f, 0.25f },
        { MAPPING_ANGULAR, { 0.70710678f, -0.70710678f, 0 }, 0.125f, 0.5f },
        { MAPPING_MIRRORBALL, { -1, 0, 0 }, 0.5f, 0.5f },
        { MAPPING_MIRRORBALL, { 0, 1, 0 }, 0.853553f, 0.5f },
        { MAPPING_MIRRORBALL, { 0, 0, 1 }, 0.5f, 0.146447f },
        { MAPPING_MIRRORBALL, { 0.6f, 0, -0.8f }, 0.5f, 0.947214f },
        { MAPPING_WINDOW, { 0, 0, 1 }, 0.5f, 0.5f },
        { MAPPING_WINDOW, { 0.28f, 0, 0.96f }, 0.708333f, 0.5f },
        { MAPPING_WINDOW, { 0, -0.8f, 0.6f }, 0.5f, 0.149123f }
    };
    for (size_t i = 0; i < sizeof known / sizeof *known; i++) {
        float j;
        V2 p = mapping_place(&mappings[known[i].kind], known[i].d, &j);
        EXPECT(fabsf(p.x - known[i].x) < 2e-6f && fabsf(p.y - known[i].y) < 2e-6f,
               "%s: (%g %g %g) is at %.6f %.6f, expected %.6f %.6f", names[known[i].kind],
               (double)known[i].d.x, (double)known[i].d.y, (double)known[i].d.z, (double)p.x,
               (double)p.y, (double)known[i].x, (double)known[i].y);
    }
}

/* ---- the sky ---- */

static Rgb seen(const Lab *l, V3 d)
{
    const Light *light = l->scene->lights[0];
    return light->kind->radiance(light, v_unit(d), NULL);
}

static double luminance(Rgb c) { return 0.2126 * c.r + 0.7152 * c.g + 0.0722 * c.b; }

/* The zenith by the paper's appendix, worked out by hand for T = 2 and the sun 45 degrees high;
 * the distribution's ratio between two directions by its formula; the sun's irradiance; the
 * ground by quadrature. */
static void sky(void)
{
    enum { N = 400 };
    const double T = 2, A = 0.1787 * T - 1.463, B = -0.3554 * T + 0.4275, C = -0.0227 * T + 5.3251;
    const double D = 0.1206 * T - 2.5771, E = -0.067 * T + 0.3703, s45 = sqrt(0.5);
    double chi = (4.0 / 9 - T / 120) * PI / 2, Y = (4.0453 * T - 4.971) * tan(chi) - 0.2155 * T +
                 2.4192, f, up = 0, X, Z, sum, at;
    Rgb z, sun, ground;
    Lab l;

    lab_init(&l);
    lab_light(&l, "sky", "turbidity=2,sundirection=0/-1/1,albedo=0.5,sunsize=2", NULL);
    lab_build(&l);
    z = seen(&l, v3(0, 0, 1));
    EXPECT(fabs(luminance(z) / Y - 1) < 1e-3, "zenith %.6g kcd/m^2, the paper has %.6g",
           luminance(z), Y);
    X = 0.4124 * z.r + 0.3576 * z.g + 0.1805 * z.b;
    Z = 0.0193 * z.r + 0.1192 * z.g + 0.9505 * z.b;
    sum = X + luminance(z) + Z;
    EXPECT(fabs(X / sum - 0.240952) < 2e-4 && fabs(luminance(z) / sum - 0.243722) < 2e-4,
           "zenith: x %.6f y %.6f", X / sum, luminance(z) / sum);
    /* towards (0, 1, 1): at 45 degrees from the zenith, 90 from the sun */
    f = (1 + A * exp(B / s45)) * (1 + C * exp(D * PI / 2)) /
        ((1 + A * exp(B)) * (1 + C * exp(D * PI / 4) + E * 0.5));
    at = luminance(seen(&l, v3(0, 1, 1)));
    EXPECT(fabs(at / (Y * f) - 1) < 1e-3, "opposite: %.6g, the paper has %.6g", at, Y * f);
    sun = rgb_sub(seen(&l, v3(0, -1, 1)), seen(&l, v3(0, -1, 1.05f)));
    at = luminance(sun) * PI * md_sin(PI / 180) * md_sin(PI / 180);
    EXPECT(fabs(at - 93) < 2, "sun: %.6g klx, by its spectrum about 93", at);
    EXPECT(luminance(seen(&l, v3(0.017f, -0.70710678f, 0.70710678f))) > 1e4 &&
           luminance(seen(&l, v3(0.018f, -0.70710678f, 0.70710678f))) < 1e3, "the disc's edge");
    for (int i = 0; i < N * N; i++) {           /* z d omega = d(z^2 / 2) dphi */
        float c = sqrtf(((float)(i / N) + 0.5f) / N), r = sqrtf(1 - c * c);
        float phi = 2 * PI_F * ((float)(i % N) + 0.5f) / N;
        Rgb L = seen(&l, v3(r * m_cos(phi), r * m_sin(phi), c));
        up += PI / N / N * d_min((double)L.g, 1e3);     /* without the sun */
    }
    ground = seen(&l, v3(0.3f, 0.1f, -0.2f));
    at = sun.g * PI * md_sin(PI / 180) * md_sin(PI / 180) * s45;
    EXPECT(fabs(ground.g * PI / 0.5 / (up + at) - 1) < 0.01, "ground %.6g, lit by %.6g + %.6g",
           (double)ground.g, up, at);
    EXPECT(up + at > 65 && up + at < 95, "%.6g klx on the ground", up + at);
    lab_clear(&l);
}

/* Nowhere negative or infinite, for any weather and hour. */
static void weathers(void)
{
    for (int t = 2; t <= 10; t += 2)
        for (int k = 0; k < 5; k++) {
            static const char *const sun[] = { "0/0/1", "1/0/1", "0/3/1", "5/5/0.5", "1/0/0.001" };
            char text[80];
            Rng rng = rng_seed(73);
            Lab l;
            snprintf(text, sizeof text, "turbidity=%d,sundirection=%s", t, sun[k]);
            lab_init(&l);
            lab_light(&l, "sky", text, NULL);
            lab_build(&l);
            for (int i = 0; i < 2000; i++) {
                V3 d = anywhere(&rng);
                Rgb L;
                d.z *= i % 3 ? 1 : 1e-4f;
                L = seen(&l, d);
                EXPECT(rgb_finite(L) && L.r >= 0 && L.g >= 0 && L.b >= 0 && rgb_lum(L) > 0,
                       "%s: %g %g %g", text, (double)L.r, (double)L.g, (double)L.b);
            }
            lab_clear(&l);
        }
}

const TestCase test_panorama[] = {
    { "round_trip", round_trip, false },
    { "jacobians", jacobians, false },
    { "places", places, false },
    { "sky", sky, false },
    { "weathers", weathers, false },
    { NULL, NULL, false }
};
