/* triangle.c -- the rare parts of the triangle test, and blocks of triangles. See triangle.h. */
#include "geometry/triangle.h"

#include "base/d3.h"

#include <string.h>

/* ---- triangles that reach from behind the origin to before it ----
 *
 * Such a one may be met where it is not: a surface that the ray has just left, at a grazing angle,
 * is seen as a strip thinner than its rounding. A bound of the error of t would have to grow with
 * the angle until it hid true hits of needles, and rays would slip out there. So the plane decides,
 * in which the point that is met must lie: before the origin or behind it. Where the plane holds
 * the ray, or as good as holds it, that says nothing either; then the triangle must be somewhere
 * else than the origin. */

/* t of the ray's way to the triangle's plane, in double from the numbers as they were given. Its
 * sign is certain where the origin is farther from the plane than 2^-48 of the triangle's size;
 * ray_origin moves it farther. */
static double plane_t(const Probe *r, V3 a, V3 b, V3 c)
{
    D3 n = d3_normal(a, b, c);
    return d3_dot(n, d3_to(r->ray->o, a)) / d3_dot(n, d3_of(r->ray->d));
}

/* Where the line x = 0 crosses the edge from (x0, z0) to (x1, z1), if it does: *least becomes the
 * least z so far. */
static void cross_edge(float x0, float z0, float x1, float z1, float *least)
{
    float z;

    if ((x0 < 0.0f && x1 < 0.0f) || (x0 > 0.0f && x1 > 0.0f))
        return;
    z = x0 != x1 ? (x0 * z1 - x1 * z0) / (x0 - x1) : f_min(z0, z1);
    *least = f_min(z, *least);
}

static float extent(float a, float b, float c)
{
    return f_max(a, f_max(b, c)) - f_min(a, f_min(b, c));
}

/* Whether all that the ray could meet of the triangle lies before the origin, and 2^-10 of its
 * depth away: much more than a point's error could put an origin beside its own surface. Seen
 * edge-on a triangle is a line; the ray meets it between two of its edges. */
static bool clearly_ahead(const TriangleView *v, bool forward)
{
    V3 a = v->a, b = v->b, c = v->c;
    float most = f_max(fabsf(a.z), f_max(fabsf(b.z), fabsf(c.z))), least = INFINITY;

    if (extent(a.y, b.y, c.y) > extent(a.x, b.x, c.x)) {
        a.x = a.y;
        b.x = b.y;
        c.x = c.y;
    }
    if (!forward) {
        a.z = -a.z;
        b.z = -b.z;
        c.z = -c.z;
    }
    cross_edge(a.x, a.z, b.x, b.z, &least);
    cross_edge(b.x, b.z, c.x, c.z, &least);
    cross_edge(c.x, c.z, a.x, a.z, &least);
    return least > 0x1p-10f * most;
}

NOINLINE bool triangle_astride(V3 pa, V3 pb, V3 pc, const TriangleView *v, const Probe *r,
                               float *t)
{
    double plane = plane_t(r, pa, pb, pc);

    if (!(plane > 0))
        return clearly_ahead(v, v_pick(&r->ray->d, r->kz) > 0.0f);
    *t = (float)plane;
    return true;
}

/* ---- one ---- */

NOINLINE bool triangle_accept_prim(const Geometry *g, uint32_t prim, const Probe *r,
                                   const TriangleView *v, Hit *h)
{
    const Tri *tri = &g->tri[prim];
    return triangle_accept(g->p[tri->v[0]], g->p[tri->v[1]], g->p[tri->v[2]], v, prim, r, h);
}

/* ---- eight at once ---- */

void triangle_block_init(TriangleBlock *b, const Geometry *g, const uint32_t *prims, int n)
{
    memset(b, 0, sizeof *b);
    for (int k = 0; k < n; k++) {
        V3 c[3];
        geometry_corners(g, prims[k], c);
        for (int i = 0; i < 3; i++)
            for (int axis = 0; axis < 3; axis++)
                b->p[i][axis][k] = v_axis(c[i], axis);
        b->prim[k] = prims[k];
    }
}
