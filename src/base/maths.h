/* maths.h -- the functions of libm that the program uses, made of + - * / and sqrt alone, so that
 * a result does not depend on the machine's libm. Float results are computed in double and
 * rounded once: error below 0.51 ulp of a float, for every argument, however large.
 *
 * Special cases are those of C99 annex F where the domain is not left: m_log(0) = -inf,
 * m_log(x < 0) = nan, m_exp(-inf) = 0, m_pow(x, 0) = 1, m_atan2 with its signs of zero. m_asin and
 * m_acos clamp to [-1, 1] first, because their callers pass products of unit vectors. */
#ifndef BASE_MATHS_H
#define BASE_MATHS_H

#include <math.h>               /* sqrt, sqrtf, fabs, floor, ceil, INFINITY: exact everywhere */
#include <stdbool.h>
#include <stdint.h>
#include <string.h>

#define PI      3.14159265358979323846
#define PI_F    3.14159274f
#define INV_PI  0.318309886f
#define ONE_MINUS_ULP 0x1.fffffep-1f            /* the largest float below 1 */

float m_sin(float x);
float m_cos(float x);
void  m_sincos(float x, float *s, float *c);
/* Of 2 pi u for |u| < 2^20, canonical numbers above all: the reduction is exact. */
void  m_sincos_turn(float u, float *s, float *c);
void  m_sincos_turns(const float *u, float *s, float *c, int n);        /* the same of n */
float m_tan(float x);
float m_asin(float x);
float m_acos(float x);
float m_atan(float x);
float m_atan2(float y, float x);                /* in [-pi, pi]; -pi is that of (-0, x < 0) */
float m_exp(float x);
float m_log(float x);
float m_log2(float x);
float m_pow(float x, float y);                  /* x >= 0 */

/* In double, for accumulators: error below 4 ulp of a double, 9e-16 relative. md_pow: x >= 0. */
double md_sin(double x);
double md_cos(double x);
double md_exp(double x);
double md_log(double x);
double md_atan2(double y, double x);
double md_pow(double x, double y);

/* The angle from the x axis to (x, y), counter-clockwise: in [0, 2 pi]. */
static inline float m_azimuth(float y, float x)
{
    float phi = m_atan2(y, x);
    return phi < 0.0f ? phi + 2.0f * PI_F : phi;
}

static inline bool is_finite(float x) { return x - x == 0.0f; }

static inline float f_min(float a, float b) { return a < b ? a : b; }
static inline float f_max(float a, float b) { return a > b ? a : b; }
static inline double d_min(double a, double b) { return a < b ? a : b; }
static inline double d_max(double a, double b) { return a > b ? a : b; }
static inline float clamp01(float x) { return f_min(f_max(x, 0.0f), 1.0f); }
static inline float f_sqr(float a) { return a * a; }

/* Exchanges the two, or leaves them: on the bits, without a branch, for conditions that cannot be
 * foretold. */
static inline void f_exchange_if(bool exchange, float *a, float *b)
{
    uint32_t x, y, turn;

    memcpy(&x, a, sizeof x);
    memcpy(&y, b, sizeof y);
    turn = (x ^ y) & (0 - (uint32_t)exchange);
    x ^= turn;
    y ^= turn;
    memcpy(a, &x, sizeof x);
    memcpy(b, &y, sizeof y);
}

/* ---- sine and cosine on [-pi/4, pi/4], what all others are reduced to ---- */

/* The form r * (1 + ...) keeps the sign of zero. */
static inline double sin_brief(double r)                /* error 2^-37.5 */
{
    double z = r * r, z2 = z * z;
    return r * (1.0 + z * ((-0x1.5555554c70e6dp-3 + z * 0x1.11110869b65b5p-7) +
                           z2 * (-0x1.a00f7e9e77905p-13 + z * 0x1.6cd1d190e6608p-19)));
}
static inline double cos_brief(double r)                /* 2^-41.3 */
{
    double z = r * r, z2 = z * z;
    return (1.0 - 0.5 * z) + z2 * ((0x1.55555552c1ffep-5 + z * -0x1.6c16bbae1553bp-10) +
                                   z2 * (0x1.a012cee1980e4p-16 + z * -0x1.2474de4884747p-22));
}
/* m_sincos_turn for |u| <= 1/8. */
static inline void m_sincos_eighth(float u, float *s, float *c)
{
    double r = 4.0 * u * (PI / 2);
    *s = (float)sin_brief(r);
    *c = (float)cos_brief(r);
}

/* n roundings in a row err by at most this, relative [Higham02 3.4]: n u / (1 - n u), u = 2^-24. */
#define ROUNDINGS(n) ((n) * 5.9604645e-8f / (1.0f - (n) * 5.9604645e-8f))

#endif
