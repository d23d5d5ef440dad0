/* simd.h -- four and eight floats at once. Each lane does what the scalar operation would, so the
 * processor's vectors and the plain twins below give the same bits; the tests run both (make
 * V=plain). */
#ifndef BASE_SIMD_H
#define BASE_SIMD_H

#include "base/platform.h"

#include <math.h>

#if defined(__GNUC__) && defined(__SSE__) && !defined(RUSHLIGHT_PLAIN)

typedef float F4 __attribute__((vector_size(16)));

INLINE F4 f4(float a, float b, float c, float d) { return (F4){ a, b, c, d }; }
INLINE F4 f4_add(F4 a, F4 b) { return a + b; }
INLINE F4 f4_sub(F4 a, F4 b) { return a - b; }
INLINE F4 f4_mul(F4 a, F4 b) { return a * b; }
/* a > b ? a : b and a < b ? a : b in each lane: b where either is not a number */
INLINE F4 f4_max(F4 a, F4 b) { return __builtin_ia32_maxps(a, b); }
INLINE F4 f4_min(F4 a, F4 b) { return __builtin_ia32_minps(a, b); }
INLINE float f4_lane(F4 a, int k) { return a[k]; }

/* Four floats at an address that is a multiple of 16. */
INLINE F4 f4_load(const float *p) { return *(const F4 *)p; }

typedef int F4Bits __attribute__((vector_size(16)));
INLINE F4 f4_abs(F4 a) { return (F4)((F4Bits)a & 0x7FFFFFFF); }
/* s < 0 ? a : b in each lane */
INLINE F4 f4_if_negative(F4 s, F4 a, F4 b)
{
    F4Bits m = s < f4(0, 0, 0, 0);
    return (F4)(((F4Bits)a & m) | ((F4Bits)b & ~m));
}

/* Bit k: the sign of a[k], that of -0 too. */
INLINE int f4_signs(F4 a) { return __builtin_ia32_movmskps(a); }

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

#define F4_EACH(r, of) do { for (int k = 0; k < 4; k++) (r).v[k] = (of); } while (0)

INLINE F4 f4_add(F4 a, F4 b) { F4_EACH(a, a.v[k] + b.v[k]); return a; }
INLINE F4 f4_sub(F4 a, F4 b) { F4_EACH(a, a.v[k] - b.v[k]); return a; }
INLINE F4 f4_mul(F4 a, F4 b) { F4_EACH(a, a.v[k] * b.v[k]); return a; }
INLINE F4 f4_max(F4 a, F4 b) { F4_EACH(a, a.v[k] > b.v[k] ? a.v[k] : b.v[k]); return a; }
INLINE F4 f4_min(F4 a, F4 b) { F4_EACH(a, a.v[k] < b.v[k] ? a.v[k] : b.v[k]); return a; }
INLINE F4 f4_abs(F4 a) { F4_EACH(a, fabsf(a.v[k])); return a; }
INLINE F4 f4_if_negative(F4 s, F4 a, F4 b)
{
    F4_EACH(a, s.v[k] < 0.0f ? a.v[k] : b.v[k]);
    return a;
}
INLINE float f4_lane(F4 a, int k) { return a.v[k]; }
INLINE int f4_signs(F4 a)
{
    int bits = 0;
    for (int k = 0; k < 4; k++)
        bits |= (signbit(a.v[k]) != 0) << k;
    return bits;
}
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

INLINE F4 f4_all(float a) { return f4(a, a, a, a); }

/* The largest and the least of lanes 0, 1, 2. */
INLINE float f4_max_three(F4 a)
{
    float x = f4_lane(a, 0), y = f4_lane(a, 1), z = f4_lane(a, 2), m = y > z ? y : z;
    return x > m ? x : m;
}
INLINE float f4_min_three(F4 a)
{
    float x = f4_lane(a, 0), y = f4_lane(a, 1), z = f4_lane(a, 2), m = y < z ? y : z;
    return x < m ? x : m;
}

/* ---- eight ---- */

#if defined(__AVX2__) && defined(__GNUC__) && !defined(RUSHLIGHT_PLAIN)
#include <immintrin.h>

typedef __m256 F8;

INLINE F8 f8_all(float a) { return _mm256_set1_ps(a); }
INLINE F8 f8_load(const float *p) { return _mm256_loadu_ps(p); }
INLINE void f8_store(float *p, F8 a) { _mm256_storeu_ps(p, a); }
/* Eight whole numbers as floats. */
INLINE F8 f8_load_u16(const uint16_t *p)
{
    __m128i whole = _mm_loadu_si128((const __m128i *)(const void *)p);
    return _mm256_cvtepi32_ps(_mm256_cvtepu16_epi32(whole));
}
INLINE F8 f8_load_u8(const unsigned char *p)
{
    __m128i whole = _mm_loadl_epi64((const __m128i *)(const void *)p);
    return _mm256_cvtepi32_ps(_mm256_cvtepu8_epi32(whole));
}
INLINE F8 f8_add(F8 a, F8 b) { return _mm256_add_ps(a, b); }
INLINE F8 f8_sub(F8 a, F8 b) { return _mm256_sub_ps(a, b); }
INLINE F8 f8_mul(F8 a, F8 b) { return _mm256_mul_ps(a, b); }
INLINE F8 f8_abs(F8 a) { return _mm256_andnot_ps(_mm256_set1_ps(-0.0f), a); }
/* a > b ? a : b and a < b ? a : b in each lane: b where either is not a number */
INLINE F8 f8_max(F8 a, F8 b) { return _mm256_max_ps(a, b); }
INLINE F8 f8_min(F8 a, F8 b) { return _mm256_min_ps(a, b); }
/* Bit k: a[k] < b[k]; a[k] <= b[k]. */
INLINE int f8_less(F8 a, F8 b) { return _mm256_movemask_ps(_mm256_cmp_ps(a, b, _CMP_LT_OQ)); }
INLINE int f8_at_most(F8 a, F8 b) { return _mm256_movemask_ps(_mm256_cmp_ps(a, b, _CMP_LE_OQ)); }

#else

typedef struct { float v[8]; } F8;

#define F8_EACH(r, of) do { for (int k = 0; k < 8; k++) (r).v[k] = (of); } while (0)

INLINE F8 f8_all(float a) { F8 r; F8_EACH(r, a); return r; }
INLINE F8 f8_load(const float *p) { F8 r; F8_EACH(r, p[k]); return r; }
INLINE void f8_store(float *p, F8 a) { for (int k = 0; k < 8; k++) p[k] = a.v[k]; }
INLINE F8 f8_load_u16(const uint16_t *p) { F8 r; F8_EACH(r, (float)p[k]); return r; }
INLINE F8 f8_load_u8(const unsigned char *p) { F8 r; F8_EACH(r, (float)p[k]); return r; }
INLINE F8 f8_add(F8 a, F8 b) { F8_EACH(a, a.v[k] + b.v[k]); return a; }
INLINE F8 f8_sub(F8 a, F8 b) { F8_EACH(a, a.v[k] - b.v[k]); return a; }
INLINE F8 f8_mul(F8 a, F8 b) { F8_EACH(a, a.v[k] * b.v[k]); return a; }
INLINE F8 f8_abs(F8 a) { F8_EACH(a, fabsf(a.v[k])); return a; }
INLINE F8 f8_max(F8 a, F8 b) { F8_EACH(a, a.v[k] > b.v[k] ? a.v[k] : b.v[k]); return a; }
INLINE F8 f8_min(F8 a, F8 b) { F8_EACH(a, a.v[k] < b.v[k] ? a.v[k] : b.v[k]); return a; }
INLINE int f8_less(F8 a, F8 b)
{
    int bits = 0;
    for (int k = 0; k < 8; k++)
        bits |= (a.v[k] < b.v[k]) << k;
    return bits;
}
INLINE int f8_at_most(F8 a, F8 b)
{
    int bits = 0;
    for (int k = 0; k < 8; k++)
        bits |= (a.v[k] <= b.v[k]) << k;
    return bits;
}

#endif

#endif
