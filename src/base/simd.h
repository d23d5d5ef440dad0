/* simd.h -- four and eight floats at once. Each lane does what the scalar operation would, so the
 * processor's vectors and the plain twins below give the same bits; the tests run both (make
 * V=plain). */
#ifndef BASE_SIMD_H
#define BASE_SIMD_H

#include "base/platform.h"

#include <math.h>
#include <string.h>

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
/* The same at any address; and three floats, the last of them twice. */
typedef float F4Any __attribute__((vector_size(16), aligned(4)));
INLINE F4 f4_load_any(const float *p) { return *(const F4Any *)p; }
INLINE void f4_store_any(float *p, F4 a) { *(F4Any *)p = a; }
INLINE F4 f4_load_three(const float *p) { return (F4){ p[0], p[1], p[2], p[2] }; }

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
/* Bit k: a[k] < b[k]; a[k] <= b[k]. */
INLINE int f4_less(F4 a, F4 b) { return __builtin_ia32_movmskps((F4)(a < b)); }
INLINE int f4_at_most(F4 a, F4 b) { return __builtin_ia32_movmskps((F4)(a <= b)); }

/* Four points of three coordinates become three rows of four. */
INLINE void f4_transpose(F4 a, F4 b, F4 c, F4 d, F4 row[3])
{
    F4 ab = __builtin_shufflevector(a, b, 0, 4, 1, 5);
    F4 cd = __builtin_shufflevector(c, d, 0, 4, 1, 5);

    row[0] = __builtin_shufflevector(ab, cd, 0, 1, 4, 5);
    row[1] = __builtin_shufflevector(ab, cd, 2, 3, 6, 7);
    ab = __builtin_shufflevector(a, b, 2, 6, 3, 7);
    cd = __builtin_shufflevector(c, d, 2, 6, 3, 7);
    row[2] = __builtin_shufflevector(ab, cd, 0, 1, 4, 5);
}

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
INLINE int f4_less(F4 a, F4 b)
{
    int bits = 0;
    for (int k = 0; k < 4; k++)
        bits |= (a.v[k] < b.v[k]) << k;
    return bits;
}
INLINE int f4_at_most(F4 a, F4 b)
{
    int bits = 0;
    for (int k = 0; k < 4; k++)
        bits |= (a.v[k] <= b.v[k]) << k;
    return bits;
}
INLINE F4 f4_load(const float *p) { return f4(p[0], p[1], p[2], p[3]); }
INLINE F4 f4_load_any(const float *p) { return f4_load(p); }
INLINE F4 f4_load_three(const float *p) { return f4(p[0], p[1], p[2], p[2]); }
INLINE void f4_store_any(float *p, F4 a) { for (int k = 0; k < 4; k++) p[k] = a.v[k]; }
INLINE void f4_transpose(F4 a, F4 b, F4 c, F4 d, F4 row[3])
{
    for (int k = 0; k < 3; k++)
        row[k] = f4(a.v[k], b.v[k], c.v[k], d.v[k]);
}

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

/* Lanes in the order of three axes, the fourth stays; no branch, since axes come at random. */
#if defined(__AVX__) && defined(__GNUC__) && !defined(RUSHLIGHT_PLAIN)
typedef F4Turn F4Axes;
INLINE F4Axes f4_axes(int x, int y, int z) { return (F4Axes){ x, y, z, 3 }; }
INLINE F4 f4_pick(F4 a, F4Axes axes) { return __builtin_ia32_vpermilvarps(a, axes); }
#else
typedef struct { int k[3]; } F4Axes;
INLINE F4Axes f4_axes(int x, int y, int z) { F4Axes r = { { x, y, z } }; return r; }
INLINE F4 f4_pick(F4 a, F4Axes axes)
{
    return f4(f4_lane(a, axes.k[0]), f4_lane(a, axes.k[1]), f4_lane(a, axes.k[2]), f4_lane(a, 3));
}
#endif

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
INLINE F8 f8_join(F4 a, F4 b) { return _mm256_set_m128(b, a); }
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
/* -a in the lanes where s is -0, a where it is 0. */
INLINE F8 f8_flip(F8 a, F8 s) { return _mm256_xor_ps(a, s); }
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
INLINE F8 f8_join(F4 a, F4 b) { F8 r; F8_EACH(r, f4_lane(k < 4 ? a : b, k & 3)); return r; }
INLINE void f8_store(float *p, F8 a) { for (int k = 0; k < 8; k++) p[k] = a.v[k]; }
INLINE F8 f8_load_u16(const uint16_t *p) { F8 r; F8_EACH(r, (float)p[k]); return r; }
INLINE F8 f8_load_u8(const unsigned char *p) { F8 r; F8_EACH(r, (float)p[k]); return r; }
INLINE F8 f8_add(F8 a, F8 b) { F8_EACH(a, a.v[k] + b.v[k]); return a; }
INLINE F8 f8_sub(F8 a, F8 b) { F8_EACH(a, a.v[k] - b.v[k]); return a; }
INLINE F8 f8_mul(F8 a, F8 b) { F8_EACH(a, a.v[k] * b.v[k]); return a; }
INLINE F8 f8_abs(F8 a) { F8_EACH(a, fabsf(a.v[k])); return a; }
INLINE F8 f8_flip(F8 a, F8 s) { F8_EACH(a, signbit(s.v[k]) ? -a.v[k] : a.v[k]); return a; }
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

/* ---- eight whole numbers, and eight keys ---- */

/* A key is a float that is not negative, above a whole number of 32 bits: its bits are in the order
 * of the floats. */
#if defined(__AVX512F__) && defined(__AVX512VL__) && defined(__GNUC__) && !defined(RUSHLIGHT_PLAIN)

typedef __m256i I8;
typedef __m512i Keys8;

INLINE I8 i8_all(uint32_t a) { return _mm256_set1_epi32((int)a); }
INLINE I8 i8_load(const uint32_t *p) { return _mm256_loadu_si256((const void *)p); }
INLINE I8 i8_load_u8(const unsigned char *p)
{
    return _mm256_cvtepu8_epi32(_mm_loadl_epi64((const void *)p));
}
INLINE void i8_store(uint32_t *p, I8 a) { _mm256_storeu_si256((void *)p, a); }
INLINE I8 i8_add(I8 a, I8 b) { return _mm256_add_epi32(a, b); }
INLINE I8 i8_sub(I8 a, I8 b) { return _mm256_sub_epi32(a, b); }
INLINE I8 i8_left(I8 a, int n) { return _mm256_slli_epi32(a, n); }
/* a < 0 ? b : c, a with a sign */
INLINE I8 i8_if_top(I8 a, I8 b, I8 c)
{
    return _mm256_mask_mov_epi32(c, _mm256_cmplt_epi32_mask(a, _mm256_setzero_si256()), b);
}

INLINE Keys8 keys8(F8 high, I8 low)
{
    __m512i a = _mm512_slli_epi64(_mm512_cvtepu32_epi64(_mm256_castps_si256(high)), 32);
    return _mm512_or_si512(a, _mm512_cvtepu32_epi64(low));
}
/* The least of those in bits, which are not 0. */
INLINE uint64_t keys8_least(Keys8 a, int bits)
{
    return _mm512_mask_reduce_min_epu64((__mmask8)bits, a);
}
/* Those in bits but the one key. */
INLINE int keys8_others(Keys8 a, int bits, uint64_t key)
{
    return _mm512_mask_cmpneq_epu64_mask((__mmask8)bits, a, _mm512_set1_epi64((long long)key));
}
/* Stores those in bits, in their order. Eight places at p may be written. */
INLINE void keys8_store(uint64_t *p, Keys8 a, int bits)
{
    _mm512_storeu_si512(p, _mm512_maskz_compress_epi64((__mmask8)bits, a));
}

#else

typedef struct { uint32_t v[8]; } I8;
typedef struct { uint64_t v[8]; } Keys8;

#define I8_EACH(r, of) do { for (int k = 0; k < 8; k++) (r).v[k] = (of); } while (0)

INLINE I8 i8_all(uint32_t a) { I8 r; I8_EACH(r, a); return r; }
INLINE I8 i8_load(const uint32_t *p) { I8 r; I8_EACH(r, p[k]); return r; }
INLINE I8 i8_load_u8(const unsigned char *p) { I8 r; I8_EACH(r, p[k]); return r; }
INLINE void i8_store(uint32_t *p, I8 a) { for (int k = 0; k < 8; k++) p[k] = a.v[k]; }
INLINE I8 i8_add(I8 a, I8 b) { I8_EACH(a, a.v[k] + b.v[k]); return a; }
INLINE I8 i8_sub(I8 a, I8 b) { I8_EACH(a, a.v[k] - b.v[k]); return a; }
INLINE I8 i8_left(I8 a, int n) { I8_EACH(a, a.v[k] << n); return a; }
INLINE I8 i8_if_top(I8 a, I8 b, I8 c) { I8_EACH(a, a.v[k] >> 31 ? b.v[k] : c.v[k]); return a; }

INLINE Keys8 keys8(F8 high, I8 low)
{
    float lane[8];
    Keys8 r;

    f8_store(lane, high);
    for (int k = 0; k < 8; k++) {
        uint32_t bits;
        memcpy(&bits, &lane[k], 4);
        r.v[k] = (uint64_t)bits << 32 | low.v[k];
    }
    return r;
}
INLINE uint64_t keys8_least(Keys8 a, int bits)
{
    uint64_t least = UINT64_MAX;
    for (; bits; bits &= bits - 1)
        least = a.v[LOWEST_BIT(bits)] < least ? a.v[LOWEST_BIT(bits)] : least;
    return least;
}
INLINE int keys8_others(Keys8 a, int bits, uint64_t key)
{
    for (int k = 0; k < 8; k++)
        bits &= ~((a.v[k] == key) << k);
    return bits;
}
INLINE void keys8_store(uint64_t *p, Keys8 a, int bits)
{
    for (; bits; bits &= bits - 1)
        *p++ = a.v[LOWEST_BIT(bits)];
}

#endif

#endif
