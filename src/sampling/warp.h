/* warp.h -- canonical numbers, in [0,1), made into points and directions, each with its density.
 *
 * Source  [Shirley97] the concentric map of the square to the disc; [Heitz19] the map to the
 *         triangle; [Shirley91 (5.9)] the tent. All keep area and bend strata little.
 *
 * Directions come out of the disc by two projections: Malley's, straight up, gives a cosine
 * density; Lambert's equal area one gives a uniform density on any cap, so the sphere, the
 * hemisphere and a cone are one map with three heights.
 *
 * A canonical number is a multiple of 2^-24 and stands for the cell that begins there. The disc
 * takes the middle of the cell (exact in float), so that its rim is never met and the cosine of a
 * direction is never 0. Other floats below 1 are legal too. */
#ifndef SAMPLING_WARP_H
#define SAMPLING_WARP_H

#include "base/maths.h"
#include "base/platform.h"
#include "base/vec.h"

/* Directions as places of a square: the octahedron |x| + |y| + |z| = 1 seen from above, with its
 * lower half folded outwards over the edges of the upper. Of a point of that half: x and y on the
 * octahedron to those in the square, and back. */
INLINE void octahedron_fold(float *x, float *y)
{
    float a = *x, b = *y;

    *x = copysignf(1.0f - fabsf(b), a);
    *y = copysignf(1.0f - fabsf(a), b);
}

/* The unit disc, with density 1 / pi; *r is the distance from the centre, without the error of
 * squaring. */
INLINE V2 warp_disk_radius(V2 u, float *r)
{
    float a = (2.0f * u.x - 1.0f) + 0x1p-24f, b = (2.0f * u.y - 1.0f) + 0x1p-24f;
    float p = fabsf(a), q = fabsf(b), x, y;

    *r = f_max(p, q);
    m_sincos_eighth(0.125f * (f_min(p, q) / f_max(*r, 0x1p-60f)), &y, &x);
    f_exchange_if(q >= p, &x, &y);
    return (V2){ copysignf(*r * x, a), copysignf(*r * y, b) };
}

INLINE V2 warp_disk_concentric(V2 u)
{
    float r;
    return warp_disk_radius(u, &r);
}

/* The hemisphere about +z, in proportion to the cosine; z > 0. */
INLINE V3 warp_cosine(V2 u)
{
    float r;
    V2 d = warp_disk_radius(u, &r);
    return (V3){ d.x, d.y, sqrtf((1.0f - r) * (1.0f + r)) };
}
INLINE float warp_cosine_pdf(float z) { return z > 0.0f ? z * INV_PI : 0.0f; }

/* The cap of height h = 1 - cos(greatest angle) about +z, uniformly; 0 < h <= 2. The height, not
 * the cosine, because that of a small far light is lost in the rounding of 1. */
INLINE V3 warp_cone(V2 u, float h)
{
    float r, down, scale;
    V2 d = warp_disk_radius(u, &r);
    down = h * r * r;
    scale = sqrtf(h * (2.0f - down));                           /* sin^2 = down (2 - down) */
    return (V3){ d.x * scale, d.y * scale, 1.0f - down };
}
INLINE float warp_cone_pdf(float h) { return 0.5f * INV_PI / h; }

/* Height of the cone whose half angle, at most a right one, has this squared sine. */
INLINE float warp_cone_height(float sin2) { return sin2 / (1.0f + sqrtf(1.0f - sin2)); }

INLINE V3 warp_hemisphere(V2 u) { return warp_cone(u, 1.0f); }
INLINE float warp_hemisphere_pdf(void) { return 0.5f * INV_PI; }

INLINE V3 warp_sphere(V2 u) { return warp_cone(u, 2.0f); }
INLINE float warp_sphere_pdf(void) { return 0.25f * INV_PI; }

/* Barycentric coordinates, uniform over a triangle: none is negative and they add up to 1. The
 * density on a triangle is one over its area. */
INLINE V3 warp_triangle(V2 u)
{
    float most = f_max(u.x, u.y), x = 0.5f * f_min(u.x, u.y), y = most - x;
    f_exchange_if(u.x >= u.y, &x, &y);
    return (V3){ x, y, 1.0f - most };
}

/* Inverse of the cumulative tent on [-1, 1], whose density is 1 - |x|. [Shirley91 (5.9)] */
INLINE float warp_tent(float u)
{
    return u < 0.5f ? sqrtf(2.0f * u) - 1.0f : 1.0f - sqrtf(2.0f * (1.0f - u));
}

#endif
