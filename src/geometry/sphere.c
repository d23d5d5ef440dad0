/* sphere.c -- a ray against a sphere or a part of one.
 *
 * Source      [PBRT4 6.2.2] for the parameters of partial spheres; the quadratic by [Haines19].
 * Error       All in double: the discriminant r^2 |d|^2 - |l x d|^2 keeps its digits where
 *             b^2 - 4ac would not, for small spheres far away. */
#include "geometry/geometry.h"

bool sphere_init(Sphere *s, const Transform *t, float radius, float zmin, float zmax,
                 float phimax_degrees)
{
    double scale;
    float lo = f_min(zmin, zmax), hi = f_max(zmin, zmax);

    if (!xf_is_similarity(t, &scale))
        return false;
    s->centre = xf_point(t, v3(0, 0, 0));
    s->frame.s = v_unit(xf_vector(t, v3(1, 0, 0)));
    s->frame.t = v_unit(xf_vector(t, v3(0, 1, 0)));
    s->frame.n = v_unit(xf_vector(t, v3(0, 0, 1)));
    s->radius = (float)(fabs((double)radius) * scale);
    s->zmin = (float)(f_max(lo, -fabsf(radius)) * scale);
    s->zmax = (float)(f_min(hi, fabsf(radius)) * scale);
    s->phimax = (float)(phimax_degrees * (PI / 180));
    s->whole = s->zmin <= -s->radius && s->zmax >= s->radius && phimax_degrees >= 360.0f;
    if (s->whole)
        s->phimax = 2.0f * PI_F;
    return true;
}

Box sphere_box(const Sphere *s)
{
    /* Four roundings outwards: the test below works in double, so only the sum here errs. */
    V3 r = v_mad(v_abs(s->centre), ROUNDINGS(4), v_all(s->radius * (1.0f + ROUNDINGS(4))));
    return (Box){ v_sub(s->centre, r), v_add(s->centre, r) };
}

static bool kept(const Sphere *s, const Ray *r, double t)
{
    V3 p = v3((float)(r->o.x + t * r->d.x - s->centre.x),
              (float)(r->o.y + t * r->d.y - s->centre.y),
              (float)(r->o.z + t * r->d.z - s->centre.z));
    V3 q = frame_in(&s->frame, p);

    return q.z >= s->zmin && q.z <= s->zmax && m_azimuth(q.y, q.x) <= s->phimax;
}

float sphere_cross(const Sphere *s, const Ray *r)
{
    double dx = r->d.x, dy = r->d.y, dz = r->d.z;
    double lx = (double)s->centre.x - r->o.x, ly = (double)s->centre.y - r->o.y;
    double lz = (double)s->centre.z - r->o.z, r2 = (double)s->radius * s->radius;
    double px = ly * dz - lz * dy, py = lz * dx - lx * dz, pz = lx * dy - ly * dx;
    double dd = dx * dx + dy * dy + dz * dz, disc = r2 * dd - (px * px + py * py + pz * pz);
    double inv, b, half, c, near, far;
    float t;

    if (!(disc >= 0))                                   /* before any division: most rays miss */
        return 0.0f;
    inv = 1.0 / dd;
    b = (lx * dx + ly * dy + lz * dz) * inv;
    half = sqrt(disc) * inv;
    c = (lx * lx + ly * ly + lz * lz - r2) * inv;       /* near * far, without cancellation */
    if (b >= 0) {
        far = b + half;
        near = far != 0 ? c / far : 0;
    } else {
        near = b - half;
        far = c / near;
    }
    t = (float)near;
    if (!(t > 0.0f) || (!s->whole && !kept(s, r, near))) {
        t = (float)far;
        if (!(t > 0.0f) || (!s->whole && !kept(s, r, far)))
            return 0.0f;
    }
    return t;
}
