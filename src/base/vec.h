/* vec.h -- points, vectors, colours, boxes and frames, by value, so that formulas nest. */
#ifndef BASE_VEC_H
#define BASE_VEC_H

#include "base/maths.h"
#include "base/platform.h"

#include <stddef.h>

typedef struct { float x, y; } V2;
typedef struct { float x, y, z FOURTH_FLOAT; } V3;
typedef struct { float r, g, b FOURTH_FLOAT; } Rgb;     /* linear, Rec. 709 primaries */

INLINE V3 v3(float x, float y, float z) { return (V3){ x, y, z }; }
INLINE V3 v_all(float s) { return (V3){ s, s, s }; }
INLINE V3 v_add(V3 a, V3 b) { return (V3){ a.x + b.x, a.y + b.y, a.z + b.z }; }
INLINE V3 v_sub(V3 a, V3 b) { return (V3){ a.x - b.x, a.y - b.y, a.z - b.z }; }
INLINE V3 v_mul(V3 a, V3 b) { return (V3){ a.x * b.x, a.y * b.y, a.z * b.z }; }
INLINE V3 v_scale(V3 a, float s) { return (V3){ a.x * s, a.y * s, a.z * s }; }
INLINE V3 v_neg(V3 a) { return (V3){ -a.x, -a.y, -a.z }; }
INLINE V3 v_mad(V3 a, float s, V3 b) { return (V3){ a.x * s + b.x, a.y * s + b.y, a.z * s + b.z }; }
INLINE float v_dot(V3 a, V3 b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
INLINE float v_absdot(V3 a, V3 b) { return fabsf(v_dot(a, b)); }
INLINE float v_len2(V3 a) { return v_dot(a, a); }
INLINE float v_len(V3 a) { return sqrtf(v_dot(a, a)); }
INLINE V3 v_abs(V3 a) { return (V3){ fabsf(a.x), fabsf(a.y), fabsf(a.z) }; }
INLINE V3 v_min(V3 a, V3 b) { return (V3){ f_min(a.x, b.x), f_min(a.y, b.y), f_min(a.z, b.z) }; }
INLINE V3 v_max(V3 a, V3 b) { return (V3){ f_max(a.x, b.x), f_max(a.y, b.y), f_max(a.z, b.z) }; }
INLINE float v_max3(V3 a) { return f_max(a.x, f_max(a.y, a.z)); }
INLINE float v_axis(V3 a, int k) { return k == 0 ? a.x : k == 1 ? a.y : a.z; }

/* A V3 is three floats in a row, so one can be picked by number without a branch. */
typedef char v3_is_three_floats[offsetof(V3, z) == 2 * sizeof(float) ? 1 : -1];
INLINE float v_pick(const V3 *a, int k) { return (&a->x)[k]; }

INLINE bool v_finite(V3 a) { return is_finite(a.x) && is_finite(a.y) && is_finite(a.z); }

/* In double: products of nearly parallel vectors keep their digits. */
INLINE V3 v_cross(V3 a, V3 b)
{
    return (V3){ (float)((double)a.y * b.z - (double)a.z * b.y),
                 (float)((double)a.z * b.x - (double)a.x * b.z),
                 (float)((double)a.x * b.y - (double)a.y * b.x) };
}

/* Unit vector along a; the zero vector and what under- or overflows is handled by scaling first. */
INLINE V3 v_unit(V3 a)
{
    float l2 = v_len2(a), m;
    if (LIKELY(l2 > 1e-30f && l2 < 1e30f))
        return v_scale(a, 1.0f / sqrtf(l2));
    m = v_max3(v_abs(a));
    if (!(m > 0.0f) || !is_finite(m))
        return (V3){ 0.0f, 0.0f, 0.0f };
    a = v3(a.x / m, a.y / m, a.z / m);
    return v_scale(a, 1.0f / sqrtf(v_len2(a)));
}

INLINE V3 v_lerp(V3 a, V3 b, float t) { return v_mad(v_sub(b, a), t, a); }

/* ---- colour ---- */

INLINE Rgb rgb(float r, float g, float b) { return (Rgb){ r, g, b }; }
INLINE Rgb rgb_all(float s) { return (Rgb){ s, s, s }; }
INLINE Rgb rgb_add(Rgb a, Rgb b) { return (Rgb){ a.r + b.r, a.g + b.g, a.b + b.b }; }
INLINE Rgb rgb_sub(Rgb a, Rgb b) { return (Rgb){ a.r - b.r, a.g - b.g, a.b - b.b }; }
INLINE Rgb rgb_mul(Rgb a, Rgb b) { return (Rgb){ a.r * b.r, a.g * b.g, a.b * b.b }; }
INLINE Rgb rgb_scale(Rgb a, float s) { return (Rgb){ a.r * s, a.g * s, a.b * s }; }
INLINE bool rgb_black(Rgb a) { return a.r == 0.0f && a.g == 0.0f && a.b == 0.0f; }
INLINE bool rgb_finite(Rgb a) { return is_finite(a.r) && is_finite(a.g) && is_finite(a.b); }
INLINE float rgb_min(Rgb a) { return f_min(a.r, f_min(a.g, a.b)); }
INLINE float rgb_max(Rgb a) { return f_max(a.r, f_max(a.g, a.b)); }
/* [Cline07 4.6.1] */
INLINE float rgb_lum(Rgb a) { return 0.299f * a.r + 0.587f * a.g + 0.114f * a.b; }

/* ---- boxes ---- */

typedef struct { V3 lo, hi; } Box;                      /* empty: lo > hi */

INLINE Box box_empty(void)
{
    return (Box){ { INFINITY, INFINITY, INFINITY }, { -INFINITY, -INFINITY, -INFINITY } };
}
INLINE Box box_point(Box b, V3 p) { return (Box){ v_min(b.lo, p), v_max(b.hi, p) }; }
INLINE Box box_join(Box a, Box b) { return (Box){ v_min(a.lo, b.lo), v_max(a.hi, b.hi) }; }
INLINE bool box_is_empty(Box b)
{
    return !(b.lo.x <= b.hi.x && b.lo.y <= b.hi.y && b.lo.z <= b.hi.z);
}
INLINE V3 box_centre(Box b)             /* halved first: the sum of two large floats overflows */
{
    return v_add(v_scale(b.lo, 0.5f), v_scale(b.hi, 0.5f));
}
INLINE bool box_holds(Box outer, Box b)
{
    return outer.lo.x <= b.lo.x && outer.lo.y <= b.lo.y && outer.lo.z <= b.lo.z &&
           outer.hi.x >= b.hi.x && outer.hi.y >= b.hi.y && outer.hi.z >= b.hi.z;
}
INLINE float box_area(Box b)            /* of all six sides */
{
    V3 d = v_sub(b.hi, b.lo);
    return 2.0f * (d.x * d.y + d.y * d.z + d.z * d.x);
}

/* ---- frames ---- */

typedef struct { V3 s, t, n; } Frame;                   /* orthonormal, right-handed */

/* Frame about the unit vector n, continuous but at n = (0,0,-1): [Duff17]. */
INLINE Frame frame_about(V3 n)
{
    float sign = n.z >= 0.0f ? 1.0f : -1.0f, a = -1.0f / (sign + n.z), b = n.x * n.y * a;
    return (Frame){ { 1.0f + sign * n.x * n.x * a, sign * b, -sign * n.x },
                    { b, sign + n.y * n.y * a, -n.y }, n };
}
/* Frame about the unit vector n with s along u, as far as that is possible; else any. */
INLINE Frame frame_along(V3 n, V3 u)
{
    V3 s = v_sub(u, v_scale(n, v_dot(n, u)));
    float len2 = v_dot(s, s);

    if (!(len2 > 1e-12f * v_dot(u, u)) || !is_finite(len2))     /* u runs along n to 6 digits */
        return frame_about(n);
    s = v_scale(s, 1.0f / sqrtf(len2));
    return (Frame){ s, v_cross(n, s), n };
}
INLINE V3 frame_out(const Frame *f, V3 v)               /* local to world */
{
    return (V3){ v.x * f->s.x + v.y * f->t.x + v.z * f->n.x,
                 v.x * f->s.y + v.y * f->t.y + v.z * f->n.y,
                 v.x * f->s.z + v.y * f->t.z + v.z * f->n.z };
}
INLINE V3 frame_in(const Frame *f, V3 v)
{
    return (V3){ v_dot(v, f->s), v_dot(v, f->t), v_dot(v, f->n) };
}

#endif
