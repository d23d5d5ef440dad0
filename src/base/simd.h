/* simd.h -- four floats at once. Each lane does what the scalar operation would, so the processor's
 * vectors and the plain twin below give the same bits; the tests run both (make V=plain). */
#ifndef BASE_SIMD_H
#define BASE_SIMD_H

#include "base/platform.h"

#if defined(__GNUC__) && defined(__SSE__) && !defined(RUSHLIGHT_PLAIN)

typedef float F4 __attribute__((vector_size(16)));

INLINE F4 f4(float a, float b, float c, float d) { return (F4){ a, b, c, d }; }
INLINE F4 f4_sub(F4 a, F4 b) { return a - b; }
INLINE F4 f4_mul(F4 a, F4 b) { return a * b; }
/* a > b ? a : b in each lane: b where either is not a number */
INLINE F4 f4_max(F4 a, F4 b) { return __builtin_ia32_maxps(a, b); }
INLINE float f4_lane(F4 a, int k) { return a[k]; }

/* Four floats at an address that is a multiple of 16. */
INLINE F4 f4_load(const float *p) { return *(const F4 *)p; }

/* What f4_turn does: exchange the two halves, or leave them. */
typedef int F4Turn __attribute__((vector_size(16)));
INLINE F4Turn f4_turn_if(int turn)      /* 0 or 1; no branch, since it would be taken at random */
{
    return (F4Turn){ 0, 1, 2, 3 } ^ (turn << 1);
}
INLINE F4 f4_turn(F4 a, F4Turn turn)
{
#ifdef __AVX__
    return __builtin_ia32_vpermilvarps(a, turn);
#else
    F4Turn same = turn == (F4Turn){ 0, 1, 2, 3 };
    F4Turn turned = (F4Turn)__builtin_shufflevector(a, a, 2, 3, 0, 1);
    return (F4)(((F4Turn)a & same) | (turned & ~same));
#endif
}

/* Bit k: a[k] + a[k + 2] <= 0, for k = 0, 1. */
INLINE int f4_halves_cancel(F4 a)
{
    F4 sum = a + __builtin_shufflevector(a, a, 2, 3, 0, 1);
    return __builtin_ia32_movmskps((F4)(sum <= f4(0, 0, 0, 0))) & 3;
}

#else

typedef struct { float v[4]; } F4;

INLINE F4 f4(float a, float b, float c, float d)
{
    F4 r;
    r.v[0] = a;
    r.v[1] = b;
    r.v[2] = c;
    r.v[3] = d;
    return r;
}
INLINE F4 f4_sub(F4 a, F4 b)
{
    for (int k = 0; k < 4; k++)
        a.v[k] = a.v[k] - b.v[k];
    return a;
}
INLINE F4 f4_mul(F4 a, F4 b)
{
    for (int k = 0; k < 4; k++)
        a.v[k] = a.v[k] * b.v[k];
    return a;
}
INLINE F4 f4_max(F4 a, F4 b)
{
    for (int k = 0; k < 4; k++)
        a.v[k] = a.v[k] > b.v[k] ? a.v[k] : b.v[k];
    return a;
}
INLINE float f4_lane(F4 a, int k) { return a.v[k]; }
INLINE F4 f4_load(const float *p) { return f4(p[0], p[1], p[2], p[3]); }

typedef int F4Turn;
INLINE F4Turn f4_turn_if(int turn) { return turn; }
INLINE F4 f4_turn(F4 a, F4Turn turn)
{
    return turn ? f4(a.v[2], a.v[3], a.v[0], a.v[1]) : a;
}
INLINE int f4_halves_cancel(F4 a)
{
    return (a.v[0] + a.v[2] <= 0.0f ? 1 : 0) | (a.v[1] + a.v[3] <= 0.0f ? 2 : 0);
}

#endif
#endif
