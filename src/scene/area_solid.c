/* area_solid.c -- lamps of few triangles, sampled uniformly by the solid angle that they fill.
 *
 * Source      [Arvo95]: a spherical triangle cut in proportion to two numbers. Its area by
 *             [vanOosterom83]: tan(omega / 2) = det(a, b, c) / (1 + a.b + b.c + c.a).
 * Choice      A triangle in proportion to its solid angle, so the density of the lamp is one over
 *             the sum of all, wherever it is met: nobody need know which triangle a ray has hit.
 * Where       Not from afar, where the sum is below a ten-thousandth: there the cosine and distance
 *             differ little over the lamp and area does as well; and not from so near that the sum
 *             nears a half of all directions, where edges run through the poles of the map. All in
 *             double, since the angles of a small triangle add up to little more than pi. */
#include "scene/area.h"

#include "base/d3.h"

static const double LEAST = 1e-4, MOST = 6.0;
static const double TRIANGLE_LEAST = 1e-10;     /* of one: edge on, it is never met */

/* The corners of triangle i as seen from a point, and the directions to them. */
static void look(const Area *l, uint32_t i, V3 from, D3 to[3], D3 w[3])
{
    V3 c[3];

    geometry_face(geometry_of(l), lamp_triangle(shape_of(l), i), c);
    for (int k = 0; k < 3; k++) {
        to[k] = d3_to(from, c[k]);
        w[k] = d3_unit(to[k]);
    }
}

/* Negative where the corners run counter-clockwise: then we look at the front. */
static double signed_angle(const D3 w[3])
{
    double det = d3_dot(w[0], d3_cross(w[1], w[2]));
    double all = 1.0 + d3_dot(w[0], w[1]) + d3_dot(w[1], w[2]) + d3_dot(w[2], w[0]);

    return 2.0 * md_atan2(det, all);
}

double area_solid_angles(const Area *l, V3 from, double sum[SOLID_MOST])
{
    bool flip = shape_of(l)->flip;
    double all = 0.0;

    for (uint32_t i = 0; i < l->solid; i++) {
        D3 to[3], w[3];
        double angle;
        look(l, i, from, to, w);
        angle = signed_angle(w);
        if (l->two_sided)
            angle = fabs(angle);
        else if (!flip)
            angle = -angle;
        if (angle > TRIANGLE_LEAST)
            all += angle;
        sum[i] = all;
    }
    return all >= LEAST && all <= MOST ? all : 0.0;
}

/* The part of c that is perpendicular to a, unit. */
static D3 across(D3 c, D3 a) { return d3_unit(d3_mad(a, -d3_dot(c, a), c)); }

static double root(double x) { return x > 0.0 ? sqrt(x) : 0.0; }

/* A point of the spherical triangle w, of that area. [Arvo95] */
static D3 direction_in(const D3 w[3], double area, double u, double v)
{
    D3 nb = across(w[1], w[0]), nc = across(w[2], w[0]), c, x;
    double cos_a = d3_dot(nb, nc), sin_a, s, t, p, q, z, cos_part, sin_part;

    x = d3_cross(nb, nc);
    sin_a = sqrt(d3_dot(x, x));
    cos_part = md_cos(u * area);                /* of the part of the area that is cut off */
    sin_part = md_sin(u * area);
    s = sin_part * cos_a - cos_part * sin_a;    /* sine and cosine of that less the angle at a */
    t = cos_part * cos_a + sin_part * sin_a;
    p = t - cos_a;
    q = s + sin_a * d3_dot(w[0], w[1]);
    z = (q * s + p * t) * sin_a;
    z = z != 0.0 ? ((q * t - p * s) * cos_a - q) / z : 1.0;
    z = z < -1.0 ? -1.0 : z > 1.0 ? 1.0 : z;
    c = d3_mad(across(w[2], w[0]), root(1.0 - z * z), d3_mad(w[0], z - 1.0, w[0]));
    z = 1.0 - v * (1.0 - d3_dot(c, w[1]));
    return d3_mad(across(c, w[1]), root(1.0 - z * z), d3_mad(w[1], z - 1.0, w[1]));
}

/* Where the direction meets the triangle: weights of its second and third corner. */
static bool weights_of(const D3 to[3], D3 d, float *b1, float *b2)
{
    double w0 = d3_dot(d, d3_cross(to[1], to[2])), w1 = d3_dot(d, d3_cross(to[2], to[0]));
    double w2 = d3_dot(d, d3_cross(to[0], to[1])), all = w0 + w1 + w2, x, y;

    if (all == 0.0)
        return false;
    x = w1 / all;
    y = w2 / all;
    x = x < 0.0 ? 0.0 : x > 1.0 ? 1.0 : x;
    y = y < 0.0 ? 0.0 : y > 1.0 - x ? 1.0 - x : y;
    *b1 = (float)x;
    *b2 = (float)y;
    return true;
}

bool area_solid_sample(const Area *l, V3 from, V2 u, const double sum[SOLID_MOST],
                       uint32_t *triangle, float *b1, float *b2)
{
    double x = u.x * sum[l->solid - 1], before = 0.0;
    D3 to[3], w[3];
    uint32_t i = 0;

    while (i + 1 < l->solid && sum[i] <= x)
        before = sum[i++];
    if (!(sum[i] > before))             /* the last, by rounding, which has no share */
        return false;
    look(l, i, from, to, w);
    *triangle = i;
    return weights_of(to, direction_in(w, sum[i] - before, (x - before) / (sum[i] - before), u.y),
                      b1, b2);
}
