/* octahedral.h -- the unit square onto the unit sphere, area onto area, and back.
 *
 * Source      [Clarberg08], [PBRT4 3.8.3].
 * Idea        A diamond in the square becomes the upper hemisphere and the four corners, turned
 *             out, the lower one, as an octahedron folds; within each of the four parts of a
 *             hemisphere a triangle goes to a part of the disc along squares about the corner, and
 *             from there to the sphere by Lambert's projection. So the density is 1 / (4 pi)
 *             everywhere, and neighbours in the square are neighbours on the sphere. */
#ifndef SAMPLING_OCTAHEDRAL_H
#define SAMPLING_OCTAHEDRAL_H

#include "base/maths.h"
#include "base/platform.h"
#include "base/vec.h"

INLINE float sign_like(float x, float sign) { return sign < 0.0f ? -x : x; }

INLINE V3 octahedral_sphere(V2 p)
{
    float u = 2.0f * p.x - 1.0f, v = 2.0f * p.y - 1.0f, a = fabsf(u), b = fabsf(v);
    float inside = 1.0f - (a + b);              /* of the diamond: the upper hemisphere */
    float r = 1.0f - fabsf(inside), wide = r * sqrtf(2.0f - r * r), s, c;

    m_sincos((r > 0.0f ? (b - a) / r + 1.0f : 1.0f) * (PI_F / 4), &s, &c);
    return v3(sign_like(c, u) * wide, sign_like(s, v) * wide, sign_like(1.0f - r * r, inside));
}

/* d is unit. */
INLINE V2 octahedral_square(V3 d)
{
    float r = sqrtf(f_max(0.0f, 1.0f - fabsf(d.z)));
    float v = m_atan2(fabsf(d.y), fabsf(d.x)) * (2.0f * INV_PI) * r, u = r - v;

    if (d.z < 0.0f) {
        float swap = u;
        u = 1.0f - v;
        v = 1.0f - swap;
    }
    return (V2){ 0.5f * (sign_like(u, d.x) + 1.0f), 0.5f * (sign_like(v, d.y) + 1.0f) };
}

/* The place in the square of one a little beside it: an edge is one with itself, turned round. */
INLINE V2 octahedral_wrap(V2 p)
{
    if (p.x < 0.0f || p.x > 1.0f)
        p = (V2){ p.x < 0.0f ? -p.x : 2.0f - p.x, 1.0f - p.y };
    if (p.y < 0.0f || p.y > 1.0f)
        p = (V2){ 1.0f - p.x, p.y < 0.0f ? -p.y : 2.0f - p.y };
    return p;
}

#endif
