/* disk.c -- a ray against a disc, a ring or a sector of one. Source: [PBRT4 6.4]. In double. */
#include "geometry/geometry.h"

bool disk_init(Disk *d, const Transform *t, float height, float radius, float inner,
               float phimax_degrees)
{
    double scale;

    if (!xf_is_similarity(t, &scale))
        return false;
    d->centre = xf_point(t, v3(0, 0, height));
    d->frame.s = v_unit(xf_vector(t, v3(1, 0, 0)));
    d->frame.t = v_unit(xf_vector(t, v3(0, 1, 0)));
    d->frame.n = v_unit(xf_normal(t, v3(0, 0, 1)));
    d->radius = (float)(radius * scale);
    d->inner = (float)(inner * scale);
    d->phimax = (float)(f_min(phimax_degrees, 360.0f) * (PI / 180));
    return true;
}

/* Extent of a circle of radius r with normal n along each axis: r sqrt(1 - n_i^2). */
Box disk_box(const Disk *d)
{
    V3 n = d->frame.n;
    float r = d->radius * (1.0f + ROUNDINGS(8));
    V3 e = v3(r * sqrtf(f_max(0.0f, 1.0f - n.x * n.x) + ROUNDINGS(8)),
              r * sqrtf(f_max(0.0f, 1.0f - n.y * n.y) + ROUNDINGS(8)),
              r * sqrtf(f_max(0.0f, 1.0f - n.z * n.z) + ROUNDINGS(8)));
    e = v_mad(v_abs(d->centre), ROUNDINGS(4), e);
    return (Box){ v_sub(d->centre, e), v_add(d->centre, e) };
}

static double dot3(V3 a, double x, double y, double z) { return a.x * x + a.y * y + a.z * z; }

float disk_cross(const Disk *d, const Ray *r)
{
    double ox = (double)r->o.x - d->centre.x, oy = (double)r->o.y - d->centre.y;
    double oz = (double)r->o.z - d->centre.z;
    double down = dot3(d->frame.n, r->d.x, r->d.y, r->d.z), t, x, y, rr;
    float tf;

    if (down == 0)
        return 0.0f;
    t = -dot3(d->frame.n, ox, oy, oz) / down;
    tf = (float)t;
    if (!(tf > 0.0f) || !is_finite(tf))
        return 0.0f;
    ox += t * r->d.x;
    oy += t * r->d.y;
    oz += t * r->d.z;
    x = dot3(d->frame.s, ox, oy, oz);
    y = dot3(d->frame.t, ox, oy, oz);
    rr = x * x + y * y;
    if (rr > (double)d->radius * d->radius || rr < (double)d->inner * d->inner)
        return 0.0f;
    if (d->phimax < 2.0f * PI_F && m_azimuth((float)y, (float)x) > d->phimax)
        return 0.0f;
    return tf;
}
