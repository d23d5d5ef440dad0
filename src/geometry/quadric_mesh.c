/* quadric_mesh.c -- shapes of revolution as triangles.
 *
 * Source      The parametrisations of [PBRT3 3.2-3.6]: a curve P(v) in space is turned about the z
 *             axis by the angle u phimax.
 * Normals     dP/du x dP/dv, of the true surface; where the curve meets the axis dP/du vanishes,
 *             and its direction a little further along the curve is taken.
 * Error       128 steps a turn: chords lie within 1 - cos(pi/128) = 3.0e-4 radii of the circle.
 *             An outline of the user's has as many steps as they ask for, and 8 a span if smooth.
 * Invariants  A full turn ends in the very points it began with, so there is no crack at the seam.
 *             Triangles that the axis would make flat are not made. */
#include "geometry/quadric_mesh.h"

#include "base/d3.h"

enum { STEPS_AROUND = 128 };

typedef struct { D3 p, dv; double v; } Profile;         /* a point of the curve, its tangent */

static uint32_t steps_around(double phimax, uint32_t a_turn)
{
    return (uint32_t)ceil(a_turn * phimax / 360);
}

static uint32_t steps_along(const Quadric *q)
{
    switch (q->kind) {
    case QUADRIC_SPHERE:      return STEPS_AROUND / 2;
    case QUADRIC_DISK:        return 1;
    case QUADRIC_CYLINDER:    return 1;
    case QUADRIC_CONE:        return 8;                 /* normals change fast near the tip */
    case QUADRIC_PARABOLOID:  return STEPS_AROUND / 4;
    case QUADRIC_HYPERBOLOID: return STEPS_AROUND / 2;
    case QUADRIC_TORUS:       return STEPS_AROUND / 2;
    }
    return 1;
}

uint32_t quadric_triangles(const Quadric *q) {
    return 2 * steps_around(q->phimax, STEPS_AROUND) * steps_along(q);
}

/* Equal steps of the polar angle; at a pole the radius is 0 exactly. */
static Profile sphere_at(const Quadric *q, double w)
{
    double r = q->radius, lo = q->zmin > -r ? q->zmin : -r, hi = q->zmax < r ? q->zmax : r;
    double a = md_atan2(sqrt((r - lo) * (r + lo)), -lo);
    double b = md_atan2(sqrt((r - hi) * (r + hi)), -hi);
    double t = a + w * (b - a);                         /* angle from the lower pole */
    double z = w == 0 ? lo : w == 1 ? hi : -r * md_cos(t);
    double x = sqrt((r - z) * (r + z));
    return (Profile){ { x, 0, z }, { -z, 0, x }, w };
}

/* The radius goes down in equal steps. Near z = 0 dP/dv has no bound; its direction has. */
static Profile paraboloid_at(const Quadric *q, double w)
{
    double lo = q->radius * sqrt(q->zmin / q->zmax), x = lo + w * (q->radius - lo);
    double z = w == 0 ? q->zmin : q->zmax * (x / q->radius) * (x / q->radius);
    return (Profile){ { x, 0, z }, { q->radius, 0, 2 * q->zmax * (x / q->radius) },
                      (z - q->zmin) / (q->zmax - q->zmin) };
}

/* From the inner equator down; the last point is the first, exactly. */
static Profile torus_at(const Quadric *q, double w)
{
    double a = w == 1 ? 0 : 2 * PI * w, s = md_sin(a), c = md_cos(a);
    return (Profile){ { q->radius - q->inner * c, 0, -q->inner * s }, { s, 0, -c }, w };
}

static Profile profile_at(const Quadric *q, double w)
{
    double r = q->radius, x;

    switch (q->kind) {
    case QUADRIC_SPHERE:
        return sphere_at(q, w);
    case QUADRIC_DISK:
        x = (1 - w) * r + w * q->inner;
        return (Profile){ { x, 0, q->height }, { -1, 0, 0 }, w };
    case QUADRIC_CYLINDER:
        return (Profile){ { r, 0, q->zmin + w * (q->zmax - q->zmin) }, { 0, 0, 1 }, w };
    case QUADRIC_CONE:
        return (Profile){ { (1 - w) * r, 0, w * q->height }, { -r, 0, q->height }, w };
    case QUADRIC_PARABOLOID:
        return paraboloid_at(q, w);
    case QUADRIC_TORUS:
        return torus_at(q, w);
    case QUADRIC_HYPERBOLOID:
        break;
    }
    return (Profile){ { q->p1.x + w * ((double)q->p2.x - q->p1.x),
                        q->p1.y + w * ((double)q->p2.y - q->p1.y),
                        q->p1.z + w * ((double)q->p2.z - q->p1.z) },
                      { (double)q->p2.x - q->p1.x, (double)q->p2.y - q->p1.y,
                        (double)q->p2.z - q->p1.z }, w };
}

/* dP/du x dP/dv at angle 0, of any length. last: the curve ends here, it does not begin. */
static D3 normal_at(const Profile *c, bool last)
{
    double x = c->p.x, y = c->p.y;
    if (x == 0 && y == 0) {
        x = last ? -c->dv.x : c->dv.x;
        y = last ? -c->dv.y : c->dv.y;
    }
    return (D3){ x * c->dv.z, y * c->dv.z, -y * c->dv.y - x * c->dv.x };
}

static V3 turned(D3 p, double s, double c)
{
    return v3((float)(p.x * c - p.y * s), (float)(p.x * s + p.y * c), (float)p.z);
}

static void add_row(Mesh *m, const Profile *c, bool last, double phimax, uint32_t nu)
{
    D3 n = d3_unit(normal_at(c, last));
    bool full = phimax >= 360;

    for (uint32_t i = 0; i <= nu; i++) {
        double u = (double)i / nu, a = u * phimax * (PI / 180);
        double s = full && i == nu ? 0 : md_sin(a), co = full && i == nu ? 1 : md_cos(a);
        m->p[m->nverts] = turned(c->p, s, co);
        m->n[m->nverts] = turned(n, s, co);
        m->uv[m->nverts++] = (V2){ (float)u, (float)c->v };
    }
}

static bool on_axis(const Mesh *m, uint32_t row, uint32_t nu)
{
    V3 p = m->p[row * (nu + 1)];
    return p.x == 0.0f && p.y == 0.0f;
}

/* Between the last two rows. */
static void join_rows(Mesh *m, uint32_t nu)
{
    uint32_t j = m->nverts / (nu + 1) - 2;

    for (uint32_t i = 0; i < nu; i++) {
        uint32_t a = j * (nu + 1) + i, d = a + nu + 1;
        if (!on_axis(m, j, nu))
            m->tri[m->ntris++] = (Tri){ { a, a + 1, d + 1 } };
        if (!on_axis(m, j + 1, nu))
            m->tri[m->ntris++] = (Tri){ { a, d + 1, d } };
    }
}

static bool room(Mesh *m, size_t rows, size_t strips, uint32_t nu)
{
    return mesh_alloc(m, rows * (nu + (size_t)1), 2 * strips * nu, true, true);
}

bool quadric_mesh(Mesh *m, const Quadric *q)
{
    uint32_t nu = steps_around(q->phimax, STEPS_AROUND), nv = steps_along(q);

    if (!room(m, nv + (size_t)1, nv, nu))
        return false;
    for (uint32_t j = 0; j <= nv; j++) {
        Profile c = profile_at(q, (double)j / nv);
        add_row(m, &c, j == nv, q->phimax, nu);
        if (j > 0)
            join_rows(m, nu);
    }
    return true;
}

/* ---- outlines ---- */

enum { STEPS_OF_SPAN = 8 };

uint64_t outline_triangles(const Outline *o)
{
    return 2 * (uint64_t)(o->n - 1) * (o->smooth ? STEPS_OF_SPAN : 1) *
           steps_around(o->phimax, o->around);
}

static bool is_corner(const Outline *o, uint32_t i, uint32_t next)
{
    return o->p[i].x == o->p[next].x && o->p[i].y == o->p[next].y;
}

/* Tangent at point i: half the way between its neighbours; at an end of the curve, the chord. */
static V2 tangent(const Outline *o, uint32_t i)
{
    bool first = i == 0 || is_corner(o, i - 1, i), last = i + 1 == o->n || is_corner(o, i, i + 1);
    uint32_t a = first ? i : i - 1, b = last ? i : i + 1;
    return (V2){ (o->p[b].x - o->p[a].x) * (first || last ? 1.0f : 0.5f),
                 (o->p[b].y - o->p[a].y) * (first || last ? 1.0f : 0.5f) };
}

/* The point of the span after point i, by Hermite's polynomials; at its ends exactly the given. */
static Profile span_at(const Outline *o, uint32_t i, double t)
{
    V2 p = o->p[i], q = o->p[i + 1], a = tangent(o, i), b = tangent(o, i + 1);
    double v = (i + t) / (o->n - 1), dx = (double)q.x - p.x, dz = (double)q.y - p.y;
    double s = t * t * (3 - 2 * t), ds = 6 * t * (1 - t);
    double f = t * (1 - t) * (1 - t), df = (1 - t) * (1 - 3 * t);
    double g = -t * t * (1 - t), dg = t * (3 * t - 2);
    D3 at, dv;

    if (!o->smooth)
        return (Profile){ { p.x + t * dx, 0, p.y + t * dz }, { dx, 0, dz }, v };
    at = (D3){ p.x + s * dx + f * a.x + g * b.x, 0, p.y + s * dz + f * a.y + g * b.y };
    dv = (D3){ ds * dx + df * a.x + dg * b.x, 0, ds * dz + df * a.y + dg * b.y };
    if (t == 0 || t == 1)
        at = (D3){ t == 0 ? p.x : q.x, 0, t == 0 ? p.y : q.y };
    at.x = d_max(at.x, 0);                              /* a curve may swing across the axis */
    return (Profile){ at, dv, v };
}

bool outline_mesh(Mesh *m, const Outline *o)
{
    uint32_t nu = steps_around(o->phimax, o->around), steps = o->smooth ? STEPS_OF_SPAN : 1;
    size_t strips = (o->n - (size_t)1) * steps;

    if (!room(m, strips + o->n, strips, nu))
        return false;
    for (uint32_t i = 0; i + 1 < o->n; i++) {
        if (is_corner(o, i, i + 1))
            continue;
        for (uint32_t j = 0; j <= steps; j++) {
            Profile c = span_at(o, i, (double)j / steps);
            add_row(m, &c, j == steps, o->phimax, nu);
            if (j > 0)
                join_rows(m, nu);
        }
    }
    return true;
}
