/* d3.h -- vectors in double, for what is built once: differences and products of floats keep their
 * digits there. */
#ifndef BASE_D3_H
#define BASE_D3_H

#include "base/vec.h"

typedef struct { double x, y, z; } D3;

INLINE D3 d3_of(V3 a) { return (D3){ a.x, a.y, a.z }; }
INLINE D3 d3_to(V3 from, V3 p)
{
    return (D3){ (double)p.x - from.x, (double)p.y - from.y, (double)p.z - from.z };
}
INLINE V3 d3_rounded(D3 a) { return v3((float)a.x, (float)a.y, (float)a.z); }

INLINE double d3_dot(D3 a, D3 b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
INLINE D3 d3_scale(D3 a, double s) { return (D3){ a.x * s, a.y * s, a.z * s }; }
INLINE D3 d3_mad(D3 a, double s, D3 b)
{
    return (D3){ b.x + s * a.x, b.y + s * a.y, b.z + s * a.z };
}
INLINE D3 d3_cross(D3 a, D3 b)
{
    return (D3){ a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x };
}
INLINE D3 d3_unit(D3 a)                                 /* of 0: 0 */
{
    double l = sqrt(d3_dot(a, a));
    return l > 0.0 ? (D3){ a.x / l, a.y / l, a.z / l } : (D3){ 0, 0, 0 };
}

/* (b - a) x (c - a): along the normal of the triangle, and as long as twice its area. */
INLINE D3 d3_normal(V3 a, V3 b, V3 c) { return d3_cross(d3_to(a, b), d3_to(a, c)); }

#endif
