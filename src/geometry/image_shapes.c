/* image_shapes.c -- geometry images made by rule. See image_shapes.h. */
#include "geometry/image_shapes.h"

#include "base/maths.h"

/* A surface over the grid; what its points are made of. */
typedef struct {
    uint32_t side;
    bool   triangular;
    double a, b;                /* radii */
} Rule;
typedef V3 RulePoint(const Rule *r, uint32_t x, uint32_t y);

static bool fill(Tessellation *t, ImageForm f, TessellationBorder border, Rule rule,
                 RulePoint *point)
{
    size_t i = 0;

    rule.side = f.side;
    rule.triangular = f.triangular;
    if (!tessellation_init(t, f.triangular, f.side + 1, f.side + 1, NULL))
        return false;
    t->border = border;
    t->smooth = true;
    for (uint32_t y = 0; y <= f.side; y++)
        for (uint32_t x = 0; x <= (f.triangular ? y : f.side); x++) {
            V3 p = point(&rule, x, y);
            if (f.place)
                p = xf_point(f.place, p);
            t->values[i++] = p.x;
            t->values[i++] = p.y;
            t->values[i++] = p.z;
        }
    if (tessellation_finish(t, f.bits))
        return true;
    tessellation_clear(t);
    return false;
}

/* ---- spheres ---- */

static V3 onto_sphere(double x, double y, double z, double radius)
{
    double scale = radius / sqrt(x * x + y * y + z * z);
    return v3((float)(x * scale), (float)(y * scale), (float)(z * scale));
}

/* A point of the square -1 .. 1 on the octahedron |x| + |y| + |z| = 1, all times the side so that
 * points of the border that meet are made of the same whole numbers. */
static V3 octahedron(const Rule *r, uint32_t i, uint32_t j)
{
    double n = r->side, u = 2.0 * i - n, v = 2.0 * j - n, w = n - fabs(u) - fabs(v);
    double x = u, y = v;

    if (w < 0) {                        /* the corners beyond the equator are folded under it */
        x = (n - fabs(v)) * (u < 0 ? -1 : 1);
        y = (n - fabs(u)) * (v < 0 ? -1 : 1);
    }
    return onto_sphere(x, y, w, r->a);
}

/* Weights of the corners of the triangle, times the side, to a point of a tetrahedron: the middle
 * of each side is a corner of its base, the three corners are its apex. */
static V3 tetrahedron(const Rule *r, uint32_t x, uint32_t y)
{
    double n = r->side, w[3] = { n - y, (double)y - x, x };
    double base[3], apex = 0;           /* base[k]: the middle of the side across from corner k */

    for (int k = 0; k < 3; k++)
        base[k] = n - 2 * w[k];
    for (int k = 0; k < 3; k++)
        if (base[k] < 0) {              /* the part at corner k */
            apex = -base[k];
            base[(k + 1) % 3] = 2 * w[(k + 2) % 3];
            base[(k + 2) % 3] = 2 * w[(k + 1) % 3];
            base[k] = 0;
            break;
        }
    return onto_sphere(apex + base[0] - base[1] - base[2], apex - base[0] + base[1] - base[2],
                       apex - base[0] - base[1] + base[2], r->a);
}

bool image_sphere(Tessellation *t, ImageForm f, float radius)
{
    Rule rule = { .a = radius };
    return fill(t, f, BORDER_FOLDS, rule, f.triangular ? tetrahedron : octahedron);
}

/* ---- others ---- */

static V3 torus(const Rule *r, uint32_t x, uint32_t y)
{
    double u = 2 * PI * (x % r->side) / r->side, v = 2 * PI * (y % r->side) / r->side;
    double ring = r->a + r->b * md_cos(v);
    return v3((float)(ring * md_cos(u)), (float)(ring * md_sin(u)), (float)(r->b * md_sin(v)));
}

bool image_torus(Tessellation *t, ImageForm f, float major, float minor)
{
    Rule rule = { .a = major, .b = minor };
    return fill(t, f, BORDER_WRAPS, rule, torus);
}

static V3 patch(const Rule *r, uint32_t x, uint32_t y)
{
    double u = (double)x / r->side, v = (double)y / r->side;
    double a = 2 * PI * (2 * u + v), b = 2 * PI * (3 * v - u), c = 2 * PI * (9 * u + 7 * v);
    double lean = 0.05 * md_cos(a);
    return v3((float)(u + lean), (float)(v + 0.04 * md_cos(b)),
              (float)(0.08 * md_sin(a) + 0.06 * md_sin(b) + 0.01 * md_sin(c)));
}

bool image_patch(Tessellation *t, ImageForm f)
{
    Rule rule = { .a = 0 };
    return fill(t, f, BORDER_OPEN, rule, patch);
}
