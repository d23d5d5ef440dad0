/* test_maths.c -- maths.h against the C library's long double functions, against values computed
 * with 700 digits, and against itself on every other machine: one hash of many results. */
#include "base/maths.h"

#include "base/random.h"
#include "test/test.h"

#include <float.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

typedef long double Wide;

/* By functions of our own, because tcc converts a second argument to long double wrongly. */
static Wide wide_pow(double x, double y) { Wide a = x, b = y; return powl(a, b); }
static Wide wide_atan2(double y, double x) { Wide a = y, b = x; return atan2l(a, b); }

static uint64_t bits_d(double v) { uint64_t b; memcpy(&b, &v, sizeof b); return b; }
static uint32_t bits_f(float v) { uint32_t b; memcpy(&b, &v, sizeof b); return b; }
static float of_bits_f(uint32_t b) { float v; memcpy(&v, &b, sizeof v); return v; }
static double unit_d(Rng *r) { return (double)(rng_bits(r) >> 11) * 0x1p-53; }

/* |got - want| in ulp of the format at want: `bits` of precision, exponents from emin up, largest
 * values below 2^emax. Infinity counts as 2^emax, as rounding has it; nan wants nan. */
static double error_in(Wide got, Wide want, int bits, int emin, int emax)
{
    int e;
    Wide top = ldexpl(1.0L, emax);

    if (got != got || want != want)
        return (got != got) == (want != want) ? 0.0 : 1e9;
    got = got > top ? top : got < -top ? -top : got;
    want = want > top ? top : want < -top ? -top : want;
    frexpl(want, &e);
    if (want == 0.0L || e < emin)
        e = emin;
    if (e > emax)
        e = emax;
    return (double)ldexpl(fabsl(got - want), bits - e);
}

static double error_f(float got, Wide want) { return error_in(got, want, 24, -125, 128); }
static double error_d(double got, Wide want) { return error_in(got, want, 53, -1021, 1024); }

/* The promises of maths.h. */
#define BOUND_F 0.51
#define BOUND_D 4.0

/* ---- float functions of one argument ---- */

static Wide clamped_asin(Wide x) { return asinl(x > 1.0L ? 1.0L : x < -1.0L ? -1.0L : x); }
static Wide clamped_acos(Wide x) { return acosl(x > 1.0L ? 1.0L : x < -1.0L ? -1.0L : x); }

static const struct { const char *name; float (*ours)(float); Wide (*theirs)(Wide); } ONES[] = {
    { "sin", m_sin, sinl }, { "cos", m_cos, cosl }, { "tan", m_tan, tanl },
    { "asin", m_asin, clamped_asin }, { "acos", m_acos, clamped_acos }, { "atan", m_atan, atanl },
    { "exp", m_exp, expl }, { "log", m_log, logl }, { "log2", m_log2, log2l },
};
enum { N_ONES = sizeof ONES / sizeof ONES[0] };

/* Floats of all signs, exponents and kinds, `step` patterns apart. */
static void sweep(int k, uint32_t step)
{
    uint32_t b = 0;
    double worst = 0.0;
    float at = 0.0f;

    do {
        float x = of_bits_f(b);
        double e = error_f(ONES[k].ours(x), ONES[k].theirs(x));
        if (e > worst) {
            worst = e;
            at = x;
        }
        b += step;
    } while (b >= step);
    printf("%s: worst error %.5f ulp, at %a\n", ONES[k].name, worst, (double)at);
    EXPECT(worst <= BOUND_F, "%s(%a): error %.4f ulp", ONES[k].name, (double)at, worst);
}

static void floats(void)
{
    for (int k = 0; k < N_ONES; k++)
        sweep(k, 15013);
}

static void floats_dense(void)
{
    for (int k = 0; k < N_ONES; k++)
        sweep(k, 61);
}

/* The ranges in which programs live, every float of them that the step meets. */
static void floats_near(void)
{
    static const struct { float lo, hi; } RANGES[] = { { 0.5f, 2.0f }, { 2.0f, 128.0f } };
    for (int k = 0; k < N_ONES; k++)
        for (int q = 0; q < 2; q++)
            for (uint32_t b = bits_f(RANGES[q].lo); b < bits_f(RANGES[q].hi); b += 509) {
                float x = of_bits_f(b);
                for (int sign = 0; sign < 2; sign++, x = -x)
                    EXPECT(error_f(ONES[k].ours(x), ONES[k].theirs(x)) <= BOUND_F,
                           "%s(%a) = %a", ONES[k].name, (double)x, (double)ONES[k].ours(x));
            }
}

/* ---- known values ---- */

/* Far arguments, among them the floats and the double that come nearest to a multiple of pi/2. */
static void far(void)
{
    static const struct { float x; double sin, cos; } F[] = {
        { 0x1.fffffep+127f, -0x1.0b33665089575p-1, 0x1.b4bf2c79bdfcep-1 },
        { -0x1.93e594p+99f, 0x1.95135fcc7c53cp-1, -0x1.3924432ee4d87p-1 },
        { 0x1p+120f, 0x1.82e34655e6fcbp-2, -0x1.da0cd0b66d8cep-1 },
        { 0x1p+20f, 0x1.526ccb2fc8656p-2, 0x1.e33ada92fe2aep-1 },
        { 0x1.000018p+20f, 0x1.edfd304b953b9p-1, -0x1.0d3669fe6c521p-2 },
        { 0x1.0f0cf0p+73f, -0x1.77d988f563719p-1, 0x1.5baded759a40dp-1 },
        { 0x1.f37c8ap+95f, 1.0, -0x1.bbdd52a58eafbp-30 },
        { 0x1.f37c8ap+96f, -0x1.bbdd52a58eafbp-29, -1.0 },
        { 0x1.47d0fep+34f, 1.0, -0x1.149dafd6b8987p-29 },
        { 0x1.32ede2p+85f, 1.0, -0x1.bc77be4e3b960p-28 },
    };
    static const struct { double x, sin, cos; } D[] = {
        { 0x1.0f0cf064dd592p+73, -0x1.b453ab76bf397p-1, 0x1.0be2cef01c8f4p-1 },
        { 0x1.6ac5b262ca1ffp+849, 1.0, -0x1.14ae72e6ba22fp-61 },
        { 0x1p+1023, 0x1.205248cbdb760p-1, -0x1.a719f26c232bfp-1 },
        { 0x1.fffffffffffffp+1023, 0x1.452fc98b34e97p-8, -0x1.fffe62ecfab75p-1 },
        { 0x1.00001p+20, 0x1.f20cc1ff62d21p-1, 0x1.dacfb27d45b34p-3 },
        { 0x1.4p+62, 0x1.f6e294c63176fp-1, -0x1.80b853ab9298cp-3 },
    };
    for (size_t k = 0; k < sizeof F / sizeof F[0]; k++) {
        float x = F[k].x;
        EXPECT(error_f(m_sin(x), F[k].sin) <= BOUND_F, "sin %a = %a", (double)x, (double)m_sin(x));
        EXPECT(error_f(m_cos(x), F[k].cos) <= BOUND_F, "cos %a = %a", (double)x, (double)m_cos(x));
        EXPECT(m_sin(-x) == -m_sin(x) && m_cos(-x) == m_cos(x), "%a: symmetry", (double)x);
    }
    for (size_t k = 0; k < sizeof D / sizeof D[0]; k++) {
        double x = D[k].x;
        EXPECT(error_d(md_sin(x), D[k].sin) <= BOUND_D, "sin %a = %a", x, md_sin(x));
        EXPECT(error_d(md_cos(x), D[k].cos) <= BOUND_D, "cos %a = %a", x, md_cos(x));
        EXPECT(md_sin(-x) == -md_sin(x) && md_cos(-x) == md_cos(x), "%a: symmetry", x);
    }
}

/* The same by value, by pair, and of both signs. */
static void sincos(void)
{
    for (uint32_t b = 0; b < 0x7F800000; b += 30011) {
        float x = of_bits_f(b), s, c;
        for (int sign = 0; sign < 2; sign++, x = -x) {
            m_sincos(x, &s, &c);
            EXPECT(bits_f(s) == bits_f(m_sin(x)) && bits_f(c) == bits_f(m_cos(x)), "%a", (double)x);
        }
    }
}

/* Of u turns, reduced in whole numbers to an eighth of a turn. */
static void expect_turn(uint32_t k, float s, float c)
{
    static const Wide TWO_PI = 6.283185307179586476925286766559005768L;
    uint32_t quadrant = (k + (1u << 21)) >> 22;                         /* of 2^24 a turn */
    Wide r = ((Wide)k - (Wide)quadrant * 0x1p22L) * 0x1p-24L * TWO_PI, ws = sinl(r), wc = cosl(r);
    Wide ts = quadrant % 2 ? wc : ws, tc = quadrant % 2 ? -ws : wc;

    if (quadrant & 2) {
        ts = -ts;
        tc = -tc;
    }
    EXPECT(error_f(s, ts) <= BOUND_F && error_f(c, tc) <= BOUND_F, "turn of %u / 2^24: %a %a",
           (unsigned)k, (double)s, (double)c);
}

static void sincos_turn(void)
{
    static const float WHOLE[9][2] = { { 0, 1 }, { 0x1.6a09e6p-1f, 0x1.6a09e6p-1f }, { 1, 0 },
        { 0x1.6a09e6p-1f, -0x1.6a09e6p-1f }, { 0, -1 }, { -0x1.6a09e6p-1f, -0x1.6a09e6p-1f },
        { -1, 0 }, { -0x1.6a09e6p-1f, 0x1.6a09e6p-1f }, { 0, 1 } };
    float s, c;

    for (int k = 0; k <= 8; k++) {
        m_sincos_turn((float)k * 0.125f, &s, &c);
        EXPECT(s == WHOLE[k][0] && c == WHOLE[k][1], "%d/8: %a %a", k, (double)s, (double)c);
    }
    for (uint32_t k = 0; k <= 1u << 24; k += test_is_long() ? 3 : 37) {
        m_sincos_turn((float)k * 0x1p-24f, &s, &c);
        expect_turn(k, s, c);
    }
    m_sincos_turn(0x1p-149f, &s, &c);
    EXPECT(s == 0x1.8p-147f && c == 1.0f, "least denormal: %a %a", (double)s, (double)c);
    m_sincos_turn(-0.25f, &s, &c);
    EXPECT(s == -1.0f && c == 0.0f, "-1/4: %a %a", (double)s, (double)c);
    m_sincos_turn(ONE_MINUS_ULP, &s, &c);
    EXPECT(s < 0.0f && s > -1e-6f && c == 1.0f, "1 - ulp: %a %a", (double)s, (double)c);
}

/* Many at once are the same bits, wherever a vector may end. */
static void sincos_turns(void)
{
    enum { N = 100 };
    float u[N], s[N], c[N];

    for (int i = 0; i < N; i++)
        u[i] = (float)(i * 7919 - 300000) * 0x1.3p-17f;
    for (int n = 1; n <= N; n += n < 40 ? 1 : 20) {
        int wrong = 0;
        m_sincos_turns(u, s, c, n);
        for (int i = 0; i < n; i++) {
            float one_s, one_c;
            m_sincos_turn(u[i], &one_s, &one_c);
            wrong += memcmp(&s[i], &one_s, sizeof one_s) || memcmp(&c[i], &one_c, sizeof one_c);
        }
        EXPECT(!wrong, "%d of %d differ", wrong, n);
    }
}

/* ---- two arguments ---- */

static void power(void)
{
    Rng r = rng_seed(11);
    double worst = 0.0;

    for (int i = 0; i < (test_is_long() ? 20000000 : 500000); i++) {
        float x = of_bits_f((uint32_t)(rng_bits(&r) >> 33) % 0x7F800000), y;
        double e;
        if (i % 4)
            x = i % 4 == 1 ? rng_unit(&r) : rng_unit(&r) + 0.5f;        /* bases of a renderer */
        y = i % 8 < 4 ? (rng_unit(&r) - 0.5f) * 20.0f : (rng_unit(&r) - 0.5f) * 2000.0f;
        if (i % 16 == 9)
            y = of_bits_f((uint32_t)(rng_bits(&r) >> 32));
        e = error_f(m_pow(x, y), wide_pow(x, y));
        EXPECT(e <= BOUND_F, "pow(%a, %a) = %a: %.4f ulp", (double)x, (double)y,
               (double)m_pow(x, y), e);
        if (e > worst)
            worst = e;
        EXPECT(m_pow(x, 1.0f) == x && m_pow(x, 0.0f) == 1.0f, "pow(%a, 1 or 0)", (double)x);
    }
    printf("pow: worst error %.5f ulp\n", worst);
    for (int k = -149; k < 128; k++) {
        EXPECT(m_pow(2.0f, (float)k) == (float)ldexp(1.0, k), "2^%d", k);
        EXPECT(m_log2((float)ldexp(1.0, k)) == (float)k, "log2 of 2^%d", k);
    }
}

static void arc_tangent(void)
{
    Rng r = rng_seed(12);
    double worst = 0.0;

    for (int i = 0; i < (test_is_long() ? 20000000 : 500000); i++) {
        float y = of_bits_f((uint32_t)(rng_bits(&r) >> 32));
        float x = of_bits_f((uint32_t)(rng_bits(&r) >> 32));
        double e;
        if (i % 4) {
            y = rng_unit(&r) - 0.5f;
            x = rng_unit(&r) - 0.5f;
        }
        e = error_f(m_atan2(y, x), wide_atan2(y, x));
        EXPECT(e <= BOUND_F, "atan2(%a, %a) = %a: %.4f ulp", (double)y, (double)x,
               (double)m_atan2(y, x), e);
        if (e > worst)
            worst = e;
    }
    printf("atan2: worst error %.5f ulp\n", worst);
}

/* ---- special values ---- */

static void expect_f(float got, float want, const char *what)
{
    EXPECT(bits_f(got) == bits_f(want) || (got != got && want != want), "%s gives %a, expected %a",
           what, (double)got, (double)want);
}

static void expect_d(double got, double want, const char *what)
{
    EXPECT(bits_d(got) == bits_d(want) || (got != got && want != want), "%s gives %a, expected %a",
           what, got, want);
}

#define IS(call, want)   expect_f(call, want, #call)
#define IS_D(call, want) expect_d(call, want, #call)
#define NEAR_D(call, want) EXPECT(error_d(call, want) <= BOUND_D, "%s gives %a", #call, call)

static void special_floats(void)
{
    const float inf = INFINITY, pi = PI_F, half_pi = 0x1.921fb6p+0f, least = 0x1p-149f;

    IS(m_sin(0.0f), 0.0f);          IS(m_sin(-0.0f), -0.0f);        IS(m_sin(inf), NAN);
    IS(m_sin(-inf), NAN);           IS(m_sin(NAN), NAN);            IS(m_sin(-least), -least);
    IS(m_cos(0.0f), 1.0f);          IS(m_cos(-0.0f), 1.0f);         IS(m_cos(-inf), NAN);
    IS(m_tan(-0.0f), -0.0f);        IS(m_tan(inf), NAN);            IS(m_tan(least), least);
    IS(m_asin(-0.0f), -0.0f);       IS(m_asin(1.0f), half_pi);      IS(m_asin(-1.0f), -half_pi);
    IS(m_asin(1.5f), half_pi);      IS(m_asin(-inf), -half_pi);     IS(m_asin(NAN), NAN);
    IS(m_acos(1.0f), 0.0f);         IS(m_acos(-1.0f), pi);          IS(m_acos(0.0f), half_pi);
    IS(m_acos(1.0000001f), 0.0f);   IS(m_acos(-7.0f), pi);          IS(m_acos(NAN), NAN);
    IS(m_atan(-0.0f), -0.0f);       IS(m_atan(inf), half_pi);       IS(m_atan(-inf), -half_pi);
    IS(m_atan(NAN), NAN);           IS(m_atan(least), least);
    IS(m_exp(0.0f), 1.0f);          IS(m_exp(-0.0f), 1.0f);         IS(m_exp(inf), inf);
    IS(m_exp(-inf), 0.0f);          IS(m_exp(NAN), NAN);            IS(m_exp(-200.0f), 0.0f);
    IS(m_exp(88.8f), inf);          IS(m_exp(-103.0f), least);      IS(m_exp(1e30f), inf);
    IS(m_log(0.0f), -inf);          IS(m_log(-0.0f), -inf);         IS(m_log(-1.0f), NAN);
    IS(m_log(1.0f), 0.0f);          IS(m_log(inf), inf);            IS(m_log(-inf), NAN);
    IS(m_log(NAN), NAN);            IS(m_log2(0.0f), -inf);         IS(m_log2(1.0f), 0.0f);
    IS(m_log2(-least), NAN);        IS(m_log2(inf), inf);           IS(m_log2(least), -149.0f);
}

static void special_pairs(void)
{
    const float inf = INFINITY, pi = PI_F, half_pi = 0x1.921fb6p+0f, least = 0x1p-149f;
    const float most = 0x1.fffffep127f;

    IS(m_atan2(0.0f, 1.0f), 0.0f);      IS(m_atan2(-0.0f, 1.0f), -0.0f);
    IS(m_atan2(0.0f, -1.0f), pi);       IS(m_atan2(-0.0f, -1.0f), -pi);
    IS(m_atan2(0.0f, 0.0f), 0.0f);      IS(m_atan2(-0.0f, 0.0f), -0.0f);
    IS(m_atan2(0.0f, -0.0f), pi);       IS(m_atan2(-0.0f, -0.0f), -pi);
    IS(m_atan2(1.0f, 0.0f), half_pi);   IS(m_atan2(-1.0f, -0.0f), -half_pi);
    IS(m_atan2(inf, 1.0f), half_pi);    IS(m_atan2(-1.0f, inf), -0.0f);
    IS(m_atan2(1.0f, -inf), pi);        IS(m_atan2(inf, inf), 0x1.921fb6p-1f);
    IS(m_atan2(inf, -inf), 0x1.2d97c8p+1f);     IS(m_atan2(-inf, inf), -0x1.921fb6p-1f);
    IS(m_atan2(NAN, 1.0f), NAN);        IS(m_atan2(1.0f, NAN), NAN);

    IS(m_pow(0.0f, 0.0f), 1.0f);        IS(m_pow(NAN, 0.0f), 1.0f);     IS(m_pow(1.0f, NAN), 1.0f);
    IS(m_pow(1.0f, inf), 1.0f);         IS(m_pow(inf, 0.0f), 1.0f);     IS(m_pow(0.0f, 2.0f), 0.0f);
    IS(m_pow(-0.0f, 2.0f), 0.0f);       IS(m_pow(0.0f, -2.0f), inf);    IS(m_pow(inf, 2.0f), inf);
    IS(m_pow(inf, -2.0f), 0.0f);        IS(m_pow(0.5f, inf), 0.0f);     IS(m_pow(0.5f, -inf), inf);
    IS(m_pow(2.0f, inf), inf);          IS(m_pow(2.0f, -inf), 0.0f);    IS(m_pow(-1.0f, 2.0f), NAN);
    IS(m_pow(NAN, 1.0f), NAN);          IS(m_pow(2.0f, NAN), NAN);      IS(m_pow(3.0f, 3e38f), inf);
    IS(m_pow(2.0f, -149.0f), least);    IS(m_pow(2.0f, -151.0f), 0.0f);
    IS(m_pow(2.0f, 128.0f), inf);       IS(m_pow(most, 1.0f), most);
    IS(m_pow(0.3f, 3e38f), 0.0f);       IS(m_pow(0.0f, inf), 0.0f);     IS(m_pow(0.0f, -inf), inf);
}

static void special_doubles(void)
{
    const double inf = INFINITY, pi = PI, half_pi = PI / 2.0, huge = 0x1.fffffffffffffp1023;

    IS_D(md_sin(-0.0), -0.0);       IS_D(md_sin(inf), NAN);         IS_D(md_sin(NAN), NAN);
    IS_D(md_cos(0.0), 1.0);         IS_D(md_cos(-inf), NAN);        IS_D(md_sin(1e-310), 1e-310);
    IS_D(md_exp(0.0), 1.0);         IS_D(md_exp(-inf), 0.0);        IS_D(md_exp(inf), inf);
    IS_D(md_exp(NAN), NAN);         IS_D(md_exp(709.8), inf);       IS_D(md_exp(-745.2), 0.0);
    IS_D(md_exp(-745.0), 0x1p-1074);        IS_D(md_log(1.0), 0.0); IS_D(md_log(0.0), -inf);
    IS_D(md_log(-1.0), NAN);        IS_D(md_log(inf), inf);         IS_D(md_log(NAN), NAN);
    IS_D(md_atan2(-0.0, -0.0), -pi);        IS_D(md_atan2(0.0, 1.0), 0.0);
    IS_D(md_atan2(huge, huge), pi / 4.0);   IS_D(md_atan2(inf, huge), half_pi);
    IS_D(md_atan2(huge, inf), 0.0);         IS_D(md_atan2(-huge, 1.0), -half_pi);
    IS_D(md_atan2(0x1p-1074, 0x1p-1074), pi / 4.0);         IS_D(md_atan2(NAN, 0.0), NAN);
    IS_D(md_pow(0.0, 0.0), 1.0);    IS_D(md_pow(0.0, -1.0), inf);   IS_D(md_pow(-2.0, 2.0), NAN);
    IS_D(md_pow(1.0, inf), 1.0);    IS_D(md_pow(2.0, 1024.0), inf); IS_D(md_pow(2.0, -1076.0), 0.0);
    IS_D(md_pow(2.0, -1074.0), 0x1p-1074);
    IS_D(md_pow(0.5, huge), 0.0);

    NEAR_D(md_pow(10.0, 22.0), 1e22);
    NEAR_D(md_pow(1.5, 1000.0), 0x1.f2dd011353699p+584);
    NEAR_D(md_pow(1.0 + 0x1p-52, 0x1.5ep61), 0x1.d945df4f8ea07p+1009);
    NEAR_D(md_pow(0x1p-1074, 0.5), 0x1p-537);
    NEAR_D(md_log(0x1p-1074), -0x1.74385446d71c3p+9);
}

/* ---- doubles ---- */

static void expect_double(const char *name, double x, double got, Wide want, double *worst)
{
    double e = error_d(got, want);
    EXPECT(e <= BOUND_D, "%s(%a) = %a: %.2f ulp", name, x, got, e);
    if (e > *worst)
        *worst = e;
}

static void doubles(void)
{
    Rng r = rng_seed(13);
    double w[6] = { 0 };

#if LDBL_MANT_DIG < 64
    test_skip("long double is no wider than double here");
#endif
    for (int i = 0; i < (test_is_long() ? 10000000 : 200000); i++) {
        double u = unit_d(&r) - 0.5, v = unit_d(&r) - 0.5;
        double angle = u * ldexp(1.0, (int)rng_below(&r, i % 8 ? 30 : 1000));
        double x = i % 2 ? 1.0 + u * 0.5 : ldexp(1.0 + u, (int)rng_below(&r, 2000) - 1000);
        double y = (i % 3 ? 2.0 : 2000.0) * v;
        expect_double("sin", angle, md_sin(angle), sinl(angle), &w[0]);
        expect_double("cos", angle, md_cos(angle), cosl(angle), &w[1]);
        expect_double("exp", u * 1500.0, md_exp(u * 1500.0), expl(u * 1500.0), &w[2]);
        expect_double("exp", u, md_exp(u), expl(u), &w[2]);
        expect_double("log", x, md_log(x), logl(x), &w[3]);
        expect_double("atan2", u, md_atan2(u, v), wide_atan2(u, v), &w[4]);
        expect_double("pow", x, md_pow(x, y), wide_pow(x, y), &w[5]);
    }
    printf("doubles: worst errors sin %.2f cos %.2f exp %.2f log %.2f atan2 %.2f pow %.2f ulp\n",
           w[0], w[1], w[2], w[3], w[4], w[5]);
}

/* ---- the same bits everywhere ---- */

static uint64_t hash(uint64_t h, uint64_t bits) { return (h ^ bits) * 0x100000001B3u + (h >> 47); }

/* What all machines and compilers must give; a nan has no bits that count. One draw a statement:
 * the order of arguments is the compiler's. */
static void same_bits(void)
{
    Rng r = rng_seed(14);
    uint64_t h = 0;

    for (int i = 0; i < 200000; i++) {
        float x = of_bits_f((uint32_t)(rng_bits(&r) >> 33) % 0x7F800000), u = rng_unit(&r), s, c;
        double v = unit_d(&r), d = ldexp(1.0 + v, (int)rng_below(&r, 2000) - 1000);
        m_sincos_turn(u, &s, &c);
        h = hash(h, bits_f(s) ^ (uint64_t)bits_f(c) << 32);
        for (int k = 0; k < N_ONES; k++)
            h = hash(h, bits_f(ONES[k].ours(x)));
        h = hash(h, bits_f(m_pow(x, u * 8.0f - 4.0f)));
        h = hash(h, bits_f(m_atan2(u - 0.5f, x)));
        h = hash(h, bits_d(md_sin(d)) ^ bits_d(md_cos(v)) ^ bits_d(md_exp(v * 100.0)));
        h = hash(h, bits_d(md_log(d)) ^ bits_d(md_atan2(v, -v * v)) ^ bits_d(md_pow(d, v)));
    }
    EXPECT(h == 0xe05a0bc4dc6aa2e0u, "hash %016llx", (unsigned long long)h);
}

static void helpers(void)
{
    EXPECT(is_finite(0x1.fffffep127f) && is_finite(-0.0f), "finite");
    EXPECT(!is_finite(INFINITY) && !is_finite(-INFINITY) && !is_finite(NAN), "not finite");
    EXPECT(clamp01(-1.0f) == 0.0f && clamp01(2.0f) == 1.0f && clamp01(0.25f) == 0.25f, "clamp01");
    EXPECT(f_min(1.0f, 2.0f) == 1.0f && f_max(1.0f, 2.0f) == 2.0f && f_sqr(-3.0f) == 9.0f, "min");
    EXPECT(ONE_MINUS_ULP < 1.0f && of_bits_f(bits_f(ONE_MINUS_ULP) + 1) == 1.0f, "ONE_MINUS_ULP");
    EXPECT((float)PI == PI_F && error_f(INV_PI, 1.0L / PI) <= 0.5001, "pi");
    EXPECT(ROUNDINGS(1) > 0x1p-24f && ROUNDINGS(3) > 3 * 0x1p-24f && ROUNDINGS(3) < 0.18e-6f,
           "ROUNDINGS");
}

const TestCase test_maths[] = {
    { "helpers", helpers, false },
    { "floats", floats, false },
    { "floats_near", floats_near, false },
    { "floats_dense", floats_dense, true },
    { "far", far, false },
    { "sincos", sincos, false },
    { "sincos_turn", sincos_turn, false },
    { "sincos_turns", sincos_turns, false },
    { "power", power, false },
    { "arc_tangent", arc_tangent, false },
    { "special_floats", special_floats, false },
    { "special_pairs", special_pairs, false },
    { "special_doubles", special_doubles, false },
    { "doubles", doubles, false },
    { "same_bits", same_bits, false },
    { NULL, NULL, false }
};
