/* maths.c -- transcendental functions from + - * / and sqrt. See maths.h.
 *
 * Each function has three steps: an argument reduction that is exact or nearly so, a polynomial on
 * a short interval about 0, and putting the result together. The polynomials are minimax fits
 * (Remez exchange at 60 digits; the leading Taylor terms are kept, so that small arguments lose
 * nothing), rounded to double; the bound beside each is its relative error. There are two sets:
 * `brief` ones, whose error vanishes in the rounding to float, and `full` ones for results in
 * double. Those of `brief` are summed in pairs and not by Horner's rule, for a processor that can
 * do several things at once.
 *
 * Of IEEE arithmetic this asks rounding to nearest and double operations that round to double (see
 * platform.h); nothing depends on the byte order. */
#include "base/maths.h"

#include "base/bits.h"

#define PI_2      0x1.921fb54442d18p+0
#define PI_4      0x1.921fb54442d18p-1
#define TWO_OVER_PI 0x1.45f306dc9c883p-1
#define LN2       0x1.62e42fefa39efp-1
#define LOG2E     0x1.71547652b82fep+0
#define TAN_PI_8  0x1.a827999fcef32p-2
#define FLOAT_END 0x1.ffffffp127        /* from here on a double rounds to an infinite float */

static double with_sign_of(double size, double sign)
{
    return double_of(bits_of(size) | (bits_of(sign) & (uint64_t)1 << 63));
}

static bool finite_d(double x) { return x - x == 0.0; }

/* For n (modulo 2^32) in -1022 .. 1023. */
static double power_of_2(uint32_t n) { return double_of((uint64_t)(n + 1023) << 52); }

/* The nearest integer to x, |x| < 2^31, also modulo 2^32: above 2^52 there is no room for a
 * fraction, and the last bits of the pattern count in ones. Much quicker than a conversion. */
static double nearest(double x, uint32_t *n)
{
    double shifted = x + 0x1.8p52;
    *n = (uint32_t)bits_of(shifted);
    return shifted - 0x1.8p52;
}

/* A float from a double of any size: C99 leaves a conversion out of range undefined. */
static float to_float(double y) { return y < FLOAT_END ? (float)y : INFINITY; }

/* ---- sine and cosine ---- */

static double sin_full(double r)                        /* 2^-57.9 */
{
    double z = r * r;
    return r + r * z * (-0x1.5555555555548p-3 + z * (0x1.111111110f7cdp-7 +
                   z * (-0x1.a01a019bfd849p-13 + z * (0x1.71de356773c5bp-19 +
                   z * (-0x1.ae5e5a4449b3dp-26 + z * 0x1.5d8fba9b1f3dap-33)))));
}

static double cos_full(double r)                        /* 2^-62.1 */
{
    double z = r * r;
    return (1.0 - 0.5 * z) + z * z * (0x1.5555555555553p-5 + z * (-0x1.6c16c16c16132p-10 +
                   z * (0x1.a01a019e24bc8p-16 + z * (-0x1.27e4f903dba05p-22 +
                   z * (0x1.1eea8935afc8fp-29 + z * -0x1.8ff9c5239853bp-37)))));
}

/* 2/pi in binary after the point, 32 bits a word, with two words of zeros in front. */
static const uint32_t TWO_OVER_PI_BITS[] = {
    0x00000000, 0x00000000, 0xA2F9836E, 0x4E441529, 0xFC2757D1, 0xF534DDC0, 0xDB629599,
    0x3C439041, 0xFE5163AB, 0xDEBBC561, 0xB7246E3A, 0x424DD2E0, 0x06492EEA, 0x09D1921C,
    0xFE1DEB1C, 0xB129A73E, 0xE88235F5, 0x2EBB4484, 0xE99C7026, 0xB45F7E41, 0x3991D639,
    0x835339F4, 0x9C845F8B, 0xBDF9283B, 0x1FF897FF, 0xDE05980F, 0xEF2F118B, 0x5A0A6D1F,
    0x6D367ECF, 0x27CB09B7, 0x4F463F66, 0x9E5FEA2D, 0x7527BAC7, 0xEBE5F17B, 0x3D0739F7,
    0x8A5292EA, 0x6BFB5FB1, 0x1F8D5D08, 0x56033046
};

enum { WORDS = 6 };             /* of the product m * 2/pi that are kept */

/* p <- p + a * m * 2^shift mod 2^192, high words first; shift is 0 or 32. */
static void add_product(uint32_t p[WORDS], const uint32_t a[WORDS], uint32_t m, int shift)
{
    uint64_t carry = 0;
    for (int k = WORDS - 1 - shift / 32; k >= 0; k--) {
        carry += (uint64_t)a[k + shift / 32] * m + p[k];
        p[k] = (uint32_t)carry;
        carry >>= 32;
    }
}

/* The reduction of [Payne83]: |x| = m * 2^e, and in x * 2/pi those bits of 2/pi that make multiples
 * of 4 can be left out, as can those too far behind. The 192 bits in between, times m, leave 2 bits
 * of quadrant and a fraction whose error, 2^-137, is far below the least that a double comes
 * to a multiple of pi/2 (about 2^-61). */
static uint32_t reduce_huge(double x, double *r)
{
    uint64_t bits = bits_of(x), m = (bits & (((uint64_t)1 << 52) - 1)) | (uint64_t)1 << 52;
    int e = (int)(bits >> 52 & 0x7FF) - 1075, first = e + 62, shift = first % 32;
    const uint32_t *table = TWO_OVER_PI_BITS + first / 32;
    uint32_t a[WORDS], p[WORDS] = { 0 }, flip, quadrant;
    double f = 0.0, unit = 0x1p-190;

    for (int k = 0; k < WORDS; k++)
        a[k] = (uint32_t)(((uint64_t)table[k] << 32 | table[k + 1]) >> (32 - shift));
    add_product(p, a, (uint32_t)m, 0);
    add_product(p, a, (uint32_t)(m >> 32), 32);
    quadrant = p[0] >> 30;
    flip = p[0] >> 29 & 1 ? 0xFFFFFFFF : 0;             /* above 1/2: minus what is missing to 1 */
    p[0] = ((p[0] ^ flip) & 0x3FFFFFFF);
    for (int k = WORDS - 1; k >= 0; k--, unit *= 0x1p32)
        f += (k ? p[k] ^ flip : p[k]) * unit;
    if (flip) {
        quadrant++;
        f = -f;
    }
    *r = x < 0.0 ? -f * PI_2 : f * PI_2;
    return (x < 0.0 ? 4 - quadrant : quadrant) & 3;
}

/* x = quadrant * pi/2 + r with |r| <= pi/4, of a finite x. Below 2^20 by [Cody80]: pi/2 in three
 * parts, of which the first two have 33 bits, so that n times each is exact. */
static uint32_t reduce(double x, double *r)
{
    uint32_t quadrant;
    double n;

    if (UNLIKELY(fabs(x) >= 0x1p20))
        return reduce_huge(x, r);
    n = nearest(x * TWO_OVER_PI, &quadrant);
    *r = ((x - n * 0x1.921fb544p+0) - n * 0x1.0b4611a6p-34) - n * 0x1.3198a2e037073p-69;
    return quadrant & 3;
}

/* The pair for quadrant * pi/2 + r, given that for r. Without branches, because the quadrants of
 * sampled angles cannot be foretold: exchange and signs are done on the bits. */
static void turn(uint32_t quadrant, float s, float c, float *out_s, float *out_c)
{
    uint32_t a = bits_of_float(s), b = bits_of_float(c), exchange = (a ^ b) & (0 - (quadrant & 1));

    a ^= exchange ^ (quadrant & 2) << 30;
    b ^= exchange ^ ((quadrant + 1) & 2) << 30;
    *out_s = float_of(a);
    *out_c = float_of(b);
}

static inline void sincos_turn(float u, float *s, float *c)
{
    uint32_t quadrant;
    double quarters = 4.0 * u, r;

    r = (quarters - nearest(quarters, &quadrant)) * PI_2;
    turn(quadrant, (float)sin_brief(r), (float)cos_brief(r), s, c);
}

void m_sincos_turn(float u, float *s, float *c) { sincos_turn(u, s, c); }

void m_sincos_turns(const float *u, float *s, float *c, int n)
{
    for (int i = 0; i < n; i++)
        sincos_turn(u[i], &s[i], &c[i]);
}

void m_sincos(float x, float *s, float *c)
{
    double r;
    uint32_t quadrant;

    if (UNLIKELY(!is_finite(x))) {
        *s = *c = NAN;
        return;
    }
    quadrant = reduce(x, &r);
    turn(quadrant, (float)sin_brief(r), (float)cos_brief(r), s, c);
}

float m_sin(float x)
{
    float s, c;
    m_sincos(x, &s, &c);
    return s;
}

float m_cos(float x)
{
    float s, c;
    m_sincos(x, &s, &c);
    return c;
}

float m_tan(float x)
{
    double r;

    if (!is_finite(x))
        return NAN;
    if (reduce(x, &r) & 1)
        return (float)(-cos_brief(r) / sin_brief(r));
    return (float)(sin_brief(r) / cos_brief(r));
}

double md_sin(double x)
{
    double r, y;
    uint32_t quadrant;

    if (!finite_d(x))
        return NAN;
    if (fabs(x) < 0x1p-27)                              /* x^2 / 6 is below half an ulp */
        return x;
    quadrant = reduce(x, &r);
    y = quadrant & 1 ? cos_full(r) : sin_full(r);
    return quadrant & 2 ? -y : y;
}

double md_cos(double x)
{
    double r, y;
    uint32_t quadrant;

    if (!finite_d(x))
        return NAN;
    quadrant = reduce(x, &r);
    y = quadrant & 1 ? sin_full(r) : cos_full(r);
    return (quadrant + 1) & 2 ? -y : y;
}

/* ---- arc tangent and its kin ---- */

/* The angle whose tangent is y/x, in [0, pi/2], for y, x >= 0, not nan; 0 if both are. The smaller
 * one goes above, and tan(a - pi/4) = (y - x) / (y + x) serves above pi/8. No branch but for the
 * ends, because directions cannot be foretold. */
static double angle(double y, double x)
{
    double above = y < x ? y : x, below = y < x ? x : y;
    double t, z, w, even, odd, a;
    bool far;

    if (below == 0.0)
        return 0.0;
    if (UNLIKELY(below > 0x1p1022)) {                   /* a sum must not overflow */
        above = below < INFINITY ? above * 0.5 : above == INFINITY;
        below = below < INFINITY ? below * 0.5 : 1.0;
    }
    far = above > TAN_PI_8 * below;
    t = (above - (far ? below : 0.0)) / (below + (far ? above : 0.0));
    z = t * t;                                          /* 2^-59.5 */
    w = z * z;
    even = -0x1.555555555553dp-2 + w * (-0x1.24924922b1207p-3 + w * (-0x1.745cf90b18e73p-4 +
           w * (-0x1.10ebdd9bedd8ep-4 + w * (-0x1.9cdc25af57346p-5 + w * -0x1.259d3ed12877bp-6))));
    odd = 0x1.99999999958ebp-3 + w * (0x1.c71c70e7a23a5p-4 + w * (0x1.3b111c6462db9p-4 +
          w * (0x1.df11674da0655p-5 + w * 0x1.37ed3c6ac1250p-5)));
    a = (far ? PI_4 : 0.0) + (t + t * z * (even + z * odd));
    return y > x ? PI_2 - a : a;
}

double md_atan2(double y, double x)
{
    double a;

    if (y != y || x != x)
        return NAN;
    a = angle(fabs(y), fabs(x));
    if (bits_of(x) >> 63)
        a = PI - a;
    return with_sign_of(a, y);
}

float m_atan2(float y, float x) { return (float)md_atan2(y, x); }
float m_atan(float x) { return (float)md_atan2(x, 1.0); }

float m_asin(float x)
{
    double size = fabs((double)x);

    if (x != x)
        return NAN;
    if (size > 1.0)
        size = 1.0;
    return (float)with_sign_of(angle(size, sqrt((1.0 - size) * (1.0 + size))), x);
}

float m_acos(float x)
{
    double size = fabs((double)x), a;

    if (x != x)
        return NAN;
    if (size > 1.0)
        size = 1.0;
    a = angle(sqrt((1.0 - size) * (1.0 + size)), size);
    return (float)(x < 0.0f ? PI - a : a);
}

/* ---- exponential ---- */

/* e^x for |x| < 700. */
static double exp_brief(double x)                       /* 2^-32 */
{
    uint32_t n;
    double r = x - nearest(x * LOG2E, &n) * LN2, r2 = r * r;
    double low = 0x1.0000000b92186p-1 + r * 0x1.5555557430b46p-3;
    double mid = 0x1.5554e9027337ap-5 + r * 0x1.1110ab6d0386cp-7;
    double high = 0x1.6d432850007abp-10 + r * 0x1.a17e0b73eb57ep-13;

    return ((1.0 + r) + r2 * (low + r2 * (mid + r2 * high))) * power_of_2(n);
}

/* e^(x + more) with a small second part. The power of two goes on in two steps: 2^n need not be
 * a double where the result is, and only the last step may round. */
static double exp_full(double x, double more)           /* 2^-59.3 * r^2 */
{
    double n, r, y;
    uint32_t unused;
    int half;

    if (x > 710.0)
        return INFINITY;
    if (x < -746.0)
        return 0.0;
    n = nearest(x * LOG2E, &unused);
    half = (int)n / 2;
    r = (x - n * 0x1.62e42fefa3p-1) + (more - n * 0x1.3de6af278ece6p-42);
    y = 1.0 + (r + r * r * (0.5 + r * (0x1.5555555555557p-3 + r * (0x1.5555555555558p-5 +
                   r * (0x1.11111111100dbp-7 + r * (0x1.6c16c16c151fep-10 +
                   r * (0x1.a01a01abe825fp-13 + r * (0x1.a01a01acfa4ffp-16 +
                   r * (0x1.71de0231273f0p-19 + r * (0x1.27e4ccce8dacfp-22 +
                   r * (0x1.af4dea4a1c08bp-26 + r * 0x1.1f8b4bf89fbbap-29)))))))))));
    return y * power_of_2((uint32_t)half) * power_of_2((uint32_t)((int)n - half));
}

/* e^x as a float for any x but nan. */
static float exp_to_float(double x)
{
    if (x > 89.0)
        return INFINITY;
    return x < -104.0 ? 0.0f : to_float(exp_brief(x));
}

float m_exp(float x) { return x != x ? NAN : exp_to_float(x); }
double md_exp(double x) { return x != x ? NAN : exp_full(x, 0.0); }

/* ---- logarithm ---- */

/* x = 2^e * m with m in [sqrt(1/2), sqrt(2)), for finite x > 0. Returns m - 1, which is exact. */
static double split(double x, int *e)
{
    uint64_t bits, above;

    *e = 0;
    if (UNLIKELY(x < 0x1p-1022)) {
        x *= 0x1p54;
        *e = -54;
    }
    bits = bits_of(x);
    above = bits - 0x3FE6A09E667F3BCD;                  /* sqrt(1/2) */
    *e += (int)(above >> 52) - (above >> 63 ? 4096 : 0);
    return double_of((above & (((uint64_t)1 << 52) - 1)) + 0x3FE6A09E667F3BCD) - 1.0;
}

/* ln(1 + f) = 2 artanh(s), s = f / (2 + f), for 1 + f as split gives it. */
static double log_brief(double f)                       /* 2^-44.9 */
{
    double s = f / (2.0 + f), z = s * s, z2 = z * z;
    return 2.0 * s * (1.0 + z * ((0x1.555555561e470p-2 + z * 0x1.999996a940859p-3) +
                                 z2 * ((0x1.249411f21ac75p-3 + z * 0x1.c62b136aff1bfp-4) +
                                       z2 * 0x1.91159fd237524p-4)));
}

static double log_full(double f)                        /* 2^-66.7 * s^2 */
{
    double s = f / (2.0 + f), z = s * s;
    return 2.0 * s + 2.0 * s * z * (0x1.5555555555555p-2 + z * (0x1.9999999999dffp-3 +
                   z * (0x1.249249242b415p-3 + z * (0x1.c71c7258fda54p-4 +
                   z * (0x1.745cde359dcc9p-4 + z * (0x1.3b20ab9045807p-4 +
                   z * (0x1.0f5cc8eb7040bp-4 + z * 0x1.0f63131352f63p-4)))))));
}

/* What a logarithm gives where x is not a finite number above 0. */
static double log_edge(double x) { return x == 0.0 ? -INFINITY : x > 0.0 ? INFINITY : NAN; }

static bool in_log_domain(double x) { return x > 0.0 && x < INFINITY; }

float m_log(float x)
{
    int e;
    double f;

    if (UNLIKELY(!in_log_domain(x)))
        return (float)log_edge(x);
    f = split(x, &e);
    return (float)(e * LN2 + log_brief(f));
}

float m_log2(float x)
{
    int e;
    double f;

    if (UNLIKELY(!in_log_domain(x)))
        return (float)log_edge(x);
    f = split(x, &e);
    return (float)(e + log_brief(f) * LOG2E);
}

double md_log(double x)
{
    int e;
    double f;

    if (!in_log_domain(x))
        return log_edge(x);
    f = split(x, &e);
    return e * 0x1.62e42fefa3p-1 + (e * 0x1.3de6af278ece6p-42 + log_full(f));
}

/* ---- power ---- */

/* x^y where x or y is 0, infinite or nan, or x < 0. */
static double pow_edge(double x, double y)
{
    if (y == 0.0 || x == 1.0)
        return 1.0;
    if (!(x >= 0.0) || y != y)
        return NAN;
    if (x == 0.0 || x == INFINITY)
        return (x > 0.0) == (y > 0.0) ? INFINITY : 0.0;
    return (x > 1.0) == (y > 0.0) ? INFINITY : 0.0;
}

float m_pow(float x, float y)
{
    int e;
    double f;

    if (UNLIKELY(!in_log_domain(x) || !is_finite(y)))
        return (float)pow_edge(x, y);
    f = split(x, &e);
    return exp_to_float(y * (e * LN2 + log_brief(f)));
}

/* The unevaluated sum of two doubles, |lo| <= ulp(hi): some 106 bits [Dekker71]. */
typedef struct { double hi, lo; } Twin;

static Twin twin_sum(double a, double b)                /* exact for |a| >= |b| or a = 0 */
{
    double s = a + b;
    return (Twin){ s, b - (s - a) };
}

static double top_half(double x) { return double_of(bits_of(x) & ~(((uint64_t)1 << 27) - 1)); }

/* a * b with an error of 2^-106. */
static Twin twin_product(double a, double b)
{
    double p = a * b, ah = top_half(a), al = a - ah, bh = top_half(b), bl = b - bh;
    return (Twin){ p, ((ah * bh - p) + ah * bl + al * bh) + al * bl };
}

static Twin twin_times(Twin a, Twin b)
{
    Twin p = twin_product(a.hi, b.hi);
    return twin_sum(p.hi, p.lo + (a.hi * b.lo + a.lo * b.hi));
}

/* ln(1 + f) to about 2^-63: as log_full, with the terms up to s^3 carried in two doubles. */
static Twin log_twin(double f)
{
    static const Twin THIRD = { 0x1.5555555555555p-2, 0x1.5555555555555p-56 };
    Twin below = twin_sum(2.0, f), s, z, w, back;
    double tail;

    s.hi = f / below.hi;
    back = twin_product(s.hi, below.hi);
    s.lo = (((f - back.hi) - back.lo) - s.hi * below.lo) / below.hi;
    z = twin_times(s, s);
    tail = 0x1.999999999999fp-3 + z.hi * (0x1.249249248e48fp-3 +
           z.hi * (0x1.c71c71d80788fp-4 + z.hi * (0x1.745d09de8df3ap-4 +
           z.hi * (0x1.3b18bd81ed288p-4 + z.hi * (0x1.101823fe2dae4p-4 +
           z.hi * 0x1.087ea9c07696ep-4)))));
    w = twin_times(z, THIRD);
    w = twin_sum(w.hi, w.lo + z.hi * z.hi * tail);
    s.hi *= 2.0;
    s.lo *= 2.0;
    w = twin_times(s, w);
    z = twin_sum(s.hi, w.hi);
    return twin_sum(z.hi, z.lo + (s.lo + w.lo));
}

/* The error of the exponent is the relative error of the power, so the logarithm needs more digits
 * than a double has. */
double md_pow(double x, double y)
{
    Twin l, p;
    double big;
    int e;

    if (!in_log_domain(x) || !finite_d(y))
        return pow_edge(x, y);
    l = log_twin(split(x, &e));
    big = e * 0x1.62e42fefa3p-1;
    p = twin_sum(big, l.hi);
    p = twin_sum(p.hi, p.lo + (e * 0x1.3de6af278ece6p-42 + l.lo));
    if (fabs(y * p.hi) > 800.0)
        return y * p.hi > 0.0 ? INFINITY : 0.0;
    p = twin_times(p, (Twin){ y, 0.0 });
    return exp_full(p.hi, p.lo);
}
