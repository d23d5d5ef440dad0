/* test_number.c -- number.h against the grammar, against exact decimal arithmetic on strings (a
 * naive twin that shares nothing with number.c) and against the C library in the C locale. */
#include "base/number.h"

#include "base/maths.h"
#include "base/mem.h"
#include "base/random.h"
#include "test/test.h"

#include <locale.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static uint64_t bits_d(double v) { uint64_t b; memcpy(&b, &v, sizeof b); return b; }
static uint32_t bits_f(float v) { uint32_t b; memcpy(&b, &v, sizeof b); return b; }
static double of_bits_d(uint64_t b) { double v; memcpy(&v, &b, sizeof v); return v; }
static float of_bits_f(uint32_t b) { float v; memcpy(&v, &b, sizeof v); return v; }

static bool same_d(double a, double b) { return bits_d(a) == bits_d(b) || (a != a && b != b); }
static bool same_f(float a, float b) { return bits_f(a) == bits_f(b) || (a != a && b != b); }

static float as_float(double v)         /* C99 leaves a conversion out of range undefined */
{
    return v >= 0x1.ffffffp127 ? INFINITY : v <= -0x1.ffffffp127 ? -INFINITY : (float)v;
}

/* Both parsers on a copy that ends at the last byte of a heap block, so that a checked build sees a
 * byte read too far. */
static void parse(const char *text, size_t n, size_t *took_f, float *f, size_t *took_d, double *d)
{
    char *copy = malloc(n ? n : 1);
    REQUIRE(copy, "no memory");
    memcpy(copy, text, n);
    *took_f = number_float(copy, copy + n, f);
    *took_d = number_double(copy, copy + n, d);
    free(copy);
}

static void expect_parse(const char *text, size_t took, double want)
{
    size_t nf, nd, n = strlen(text);
    float f = 77.0f, want_f;
    double d = 77.0;

    parse(text, n, &nf, &f, &nd, &d);
    if (!took)
        want = 77.0;                            /* untouched */
    want_f = as_float(want);
    EXPECT(nf == took && nd == took, "\"%.40s\": takes %d and %d bytes, %d expected", text,
           (int)nf, (int)nd, (int)took);
    EXPECT(same_d(d, want), "\"%.40s\": double %a, expected %a", text, d, want);
    EXPECT(same_f(f, want_f), "\"%.40s\": float %a, expected %a", text, (double)f, (double)want_f);
}

static void grammar(void)
{
    const struct { const char *text; int took; double v; } CASES[] = {
        { "", 0, 0 }, { "+", 0, 0 }, { "-", 0, 0 }, { ".", 0, 0 }, { "-.", 0, 0 },
        { "+.e1", 0, 0 },
        { "e5", 0, 0 }, { "E", 0, 0 }, { "--1", 0, 0 }, { "+-1", 0, 0 }, { " 1", 0, 0 },
        { "\t", 0, 0 }, { "x", 0, 0 }, { "in", 0, 0 }, { "na", 0, 0 }, { "-i", 0, 0 },
        { "\xb1", 0, 0 }, { "/", 0, 0 }, { ":", 0, 0 }, { "+\xff", 0, 0 },
        { "0", 1, 0.0 }, { "-0", 2, -0.0 }, { "+0", 2, 0.0 }, { "-0.0e5", 6, -0.0 },
        { "5.", 2, 5 }, { "-.5", 3, -0.5 }, { "+.5", 3, 0.5 }, { "00012", 5, 12 },
        { "1e", 1, 1 }, { "1e+", 1, 1 }, { "1e-", 1, 1 }, { "1e+x", 1, 1 }, { "1.e", 2, 1 },
        { "1e5x", 3, 1e5 }, { "1E+5", 4, 1e5 }, { "1e-05", 5, 1e-5 }, { "1e5.5", 3, 1e5 },
        { "1.2.3", 3, 1.2 }, { "1,5", 1, 1 }, { "0x10", 1, 0 }, { "1f", 1, 1 }, { "12 34", 2, 12 },
        { "7/8/9", 1, 7 }, { "5.e1", 4, 50 }, { ".5e1", 4, 5 }, { "1_0", 1, 1 }, { "3d0", 1, 3 },
        { "inf", 3, INFINITY }, { "-inf", 4, -INFINITY }, { "+Inf", 4, INFINITY },
        { "INFINITY", 8, INFINITY }, { "-Infinity", 9, -INFINITY }, { "infinit", 3, INFINITY },
        { "infx", 3, INFINITY }, { "nan", 3, NAN }, { "-NaN", 4, NAN }, { "nanq", 3, NAN },
        { "1e400", 5, INFINITY }, { "-1e400", 6, -INFINITY }, { "1e-400", 6, 0.0 },
        { "-1e-400", 7, -0.0 }, { "1e99999999999999999999", 22, INFINITY },
        { "1e-99999999999999999999", 23, 0.0 }, { "0e99999999999999999999", 22, 0.0 },
        { "-0.000e-9999999999", 18, -0.0 }, { "1e9223372036854775808", 21, INFINITY },
        { "123456789012345678901234567890123", 33, 123456789012345678901234567890123.0 },
        { "0.000000000000000000000000000000001", 35, 1e-33 },
        { "100000000000000000000000000000000e-32", 37, 1.0 },
        { "9007199254740993", 16, 9007199254740992.0 },
        { "9007199254740993.00000000000000000000000001", 43, 9007199254740994.0 },
        { "2.2250738585072012e-308", 23, 0x1p-1022 },
        { "2.2250738585072011e-308", 23, 0x0.fffffffffffffp-1022 },
        { "4.9e-324", 8, 0x1p-1074 }, { "2.4703282292062327e-324", 23, 0.0 },
        { "2.4703282292062328e-324", 23, 0x1p-1074 },
        { "1.7976931348623157e308", 22, 0x1.fffffffffffffp1023 },
        { "1.7976931348623158e308", 22, 0x1.fffffffffffffp1023 },
        { "1.7976931348623159e308", 22, INFINITY },
    };
    for (size_t k = 0; k < sizeof CASES / sizeof CASES[0]; k++)
        expect_parse(CASES[k].text, (size_t)CASES[k].took, CASES[k].v);
}

/* What is taken depends on the bytes before `end` alone. */
static void ends(void)
{
    const char *text = "-123.456e-12,";
    static const double BEFORE[] = { 0, 0, -1, -12, -123, -123, -123.4, -123.45, -123.456,
                                     -123.456, -123.456, -123.456e-1, -123.456e-12, -123.456e-12 };
    static const int TAKES[] = { 0, 0, 2, 3, 4, 5, 6, 7, 8, 8, 8, 11, 12, 12 };

    for (size_t n = 0; n <= 13; n++) {
        size_t nf, nd;
        float f = 0.0f;
        double d = 0.0;
        parse(text, n, &nf, &f, &nd, &d);
        EXPECT((int)nf == TAKES[n] && nd == nf, "%d bytes: takes %d", (int)n, (int)nd);
        EXPECT(d == BEFORE[n] && f == (float)BEFORE[n], "%d bytes: %a", (int)n, d);
    }
}

static void integers(void)
{
    static const struct { const char *text; int took; int64_t v; bool clipped; } CASES[] = {
        { "", 0, 0, false }, { "-", 0, 0, false }, { "+", 0, 0, false }, { "a", 0, 0, false },
        { "- 1", 0, 0, false }, { "--1", 0, 0, false },
        { "0", 1, 0, false }, { "-0", 2, 0, false }, { "+7x", 2, 7, false },
        { "12.5", 2, 12, false }, { "000000000000000000000000009", 27, 9, false },
        { "9223372036854775807", 19, INT64_MAX, false },
        { "9223372036854775808", 19, INT64_MAX, true },
        { "-9223372036854775808", 20, INT64_MIN, false },
        { "-9223372036854775807", 20, -INT64_MAX, false },
        { "-9223372036854775809", 20, INT64_MIN, true },
        { "9223372036854775810", 19, INT64_MAX, true },
        { "18446744073709551616", 20, INT64_MAX, true },
        { "-18446744073709551617", 21, INT64_MIN, true },
        { "100000000000000000000000000000000", 33, INT64_MAX, true },
    };
    for (size_t k = 0; k < sizeof CASES / sizeof CASES[0]; k++) {
        const char *s = CASES[k].text;
        int64_t v = 77, again = 77;
        bool clipped = !CASES[k].clipped, taken = CASES[k].took > 0;
        size_t n = number_int(s, s + strlen(s), &v, &clipped);
        size_t m = number_int(s, s + strlen(s), &again, NULL);
        EXPECT((int)n == CASES[k].took && m == n, "\"%s\": takes %d", s, (int)n);
        EXPECT(v == (taken ? CASES[k].v : 77) && again == v, "\"%s\": another value", s);
        EXPECT(!taken || clipped == CASES[k].clipped, "\"%s\": clipped is %d", s, clipped);
    }
}

/* ---- exact decimals, as strings ---- */

enum { ROOM = 1200 };
/* 0.d[0]d[1]... * 10^point; doubling and halving are done digit by digit. */
typedef struct { int n, point; char d[ROOM]; } Exact;

static void exact_double(Exact *x)
{
    int carry = 0;
    for (int i = x->n - 1; i >= 0; i--) {
        int v = x->d[i] * 2 + carry;
        x->d[i] = (char)(v % 10);
        carry = v / 10;
    }
    if (carry) {
        memmove(x->d + 1, x->d, (size_t)x->n);
        x->d[0] = 1;
        x->n++;
        x->point++;
    }
    while (x->n > 1 && !x->d[x->n - 1])
        x->n--;
}

static void exact_halve(Exact *x)
{
    int rest = 0;
    for (int i = 0; i < x->n; i++) {
        int v = rest * 10 + x->d[i];
        x->d[i] = (char)(v / 2);
        rest = v % 2;
    }
    if (rest)
        x->d[x->n++] = 5;
    if (!x->d[0]) {
        memmove(x->d, x->d + 1, (size_t)x->n - 1);
        x->n--;
        x->point--;
    }
}

static void exact_set(Exact *x, uint64_t m, int e)                      /* m * 2^e */
{
    char digits[24];
    x->n = x->point = snprintf(digits, sizeof digits, "%llu", (unsigned long long)m);
    for (int i = 0; i < x->n; i++)
        x->d[i] = (char)(digits[i] - '0');
    for (; e > 0; e--)
        exact_double(x);
    for (; e < 0; e++)
        exact_halve(x);
}

/* The number's text, in one of the ways to write it, and a bit above it or below it if side is 1 or
 * -1. The bit is so far behind that only a count of all digits sees it. */
static void exact_text(const Exact *x, int side, bool plain, char *out)
{
    char digits[ROOM + 1600];
    int n = x->n;

    for (int i = 0; i < n; i++)
        digits[i] = (char)('0' + x->d[i]);
    if (side) {
        if (side < 0)
            digits[n - 1]--;                            /* the last digit is not 0 */
        memset(digits + n, side < 0 ? '9' : '0', 1500);
        n += 1500;
        digits[n++] = '3';
    }
    digits[n] = 0;
    if (!plain)
        sprintf(out, "0.%se%d", digits, x->point);
    else if (x->point <= 0)
        sprintf(out, ".%0*d%s", 1 - x->point, 0, digits);       /* one 0 too many, cut below */
    else if (x->point >= n)
        sprintf(out, "%s%0*d", digits, x->point - n + 1, 0);
    else
        sprintf(out, "%.*s.%s", x->point, digits, digits + x->point);
    if (plain && x->point <= 0)                         /* .0000ddd with exactly -point zeros */
        memmove(out + 1, out + 2, strlen(out + 1));
    if (plain && x->point >= n)
        out[strlen(out) - 1] = 0;
}

static void expect_middle(const Exact *x, bool is_float, uint64_t low, bool plain)
{
    static char text[2 * ROOM + 4000];
    for (int side = -1; side <= 1; side++) {
        uint64_t want = side < 0 ? low : side > 0 ? low + 1 : low + (low & 1), got;
        size_t n, length;
        float f;
        double d;
        exact_text(x, side, plain, text);
        length = strlen(text);
        if (is_float) {
            n = number_float(text, text + length, &f);
            got = bits_f(f);
        } else {
            n = number_double(text, text + length, &d);
            got = bits_d(d);
        }
        EXPECT(n == length, "takes %d of %d bytes of %.60s...", (int)n, (int)length, text);
        EXPECT(got == want, "%s %.60s...: pattern %llx, expected %llx (side %d)",
               is_float ? "float" : "double", text, (unsigned long long)got,
               (unsigned long long)want, side);
    }
}

/* The middle above the value with that pattern. */
static void middle_float(uint32_t pattern, bool plain)
{
    static Exact x;
    uint32_t field = pattern >> 23, m = (pattern & 0x7FFFFF) | (field ? 0x800000u : 0);
    exact_set(&x, 2 * (uint64_t)m + 1, -150 + (field ? (int)field - 1 : 0));
    expect_middle(&x, true, pattern, plain);
}

static void middle_double(uint64_t pattern, bool plain)
{
    static Exact x;
    uint64_t field = pattern >> 52, m = pattern & (((uint64_t)1 << 52) - 1);
    exact_set(&x, 2 * (m | (field ? (uint64_t)1 << 52 : 0)) + 1,
              -1075 + (field ? (int)field - 1 : 0));
    expect_middle(&x, false, pattern, plain);
}

/* Halfway cases: even neighbour at the middle, the right one just beside it, of all exponents. The
 * last patterns are those below infinity. */
static void middles(void)
{
    Rng r = rng_seed(5);
    static const uint32_t EDGES_F[] = { 0, 1, 2, 0x7FFFFE, 0x7FFFFF, 0x800000, 0xFFFFFF, 0x1000000,
                                        0x7F7FFFFE, 0x7F7FFFFF };
    static const uint64_t EDGES_D[] = { 0, 1, 0xFFFFFFFFFFFFE, 0xFFFFFFFFFFFFF, 0x10000000000000,
                                        0x7FEFFFFFFFFFFFFE, 0x7FEFFFFFFFFFFFFF };
    for (int k = 0; k < 10; k++)
        for (int plain = 0; plain < 2; plain++)
            middle_float(EDGES_F[k], plain);
    for (int k = 0; k < 7; k++)
        for (int plain = 0; plain < 2; plain++)
            middle_double(EDGES_D[k], plain);
    for (uint32_t field = 0; field < 255; field++)
        middle_float(field << 23 | (uint32_t)(rng_bits(&r) >> 41), field & 1);
    for (uint64_t field = 0; field < 2047; field += 7)
        middle_double(field << 52 | rng_bits(&r) >> 12, field & 1);
}

/* ---- against the C library ---- */

static void expect_library(const char *text)
{
    size_t n = strlen(text), nf, nd;
    char *end_f, *end_d;
    float f, want_f = strtof(text, &end_f);
    double d, want_d = strtod(text, &end_d);

    nf = number_float(text, text + n, &f);
    nd = number_double(text, text + n, &d);
    EXPECT(text + nf == end_f && text + nd == end_d, "%s: takes %d and %d", text, (int)nf, (int)nd);
    EXPECT(same_f(f, want_f), "%s: float %a, strtof %a", text, (double)f, (double)want_f);
    EXPECT(same_d(d, want_d), "%s: double %a, strtod %a", text, d, want_d);
}

static void library(void)
{
    Rng r = rng_seed(6);
    char text[1000];

    for (int i = 0; i < 300000; i++) {
        int n = 1 + (int)rng_below(&r, i % 256 ? 24 : 900);
        int point = (int)rng_below(&r, (uint32_t)n + 1);
        char *p = text;
        if (rng_below(&r, 4) == 0)
            *p++ = '-';
        for (int k = 0; k < n; k++) {
            if (k == point)
                *p++ = '.';
            *p++ = (char)(rng_below(&r, 3) ? '0' + rng_below(&r, 10) : '0');
        }
        *p = 0;
        if (rng_below(&r, 3))
            sprintf(p, "e%d", (int)rng_below(&r, i % 2 ? 80 : 700) - (i % 2 ? 50 : 350));
        expect_library(text);
    }
}

/* Digits of a printed number without sign, point, exponent and the zeros around them. */
static int significant(const char *text, char *out)
{
    int n = 0;
    for (; *text && *text != 'e'; text++)
        if (*text >= '0' && *text <= '9' && (n || *text != '0'))
            out[n++] = *text;
    while (n && out[n - 1] == '0')
        n--;
    out[n] = 0;
    return n;
}

/* v > 0, v finite. The library's correctly rounded digits say how many are needed; where it finds
 * that n are, ours are those n, or fewer above a power of two, which then must read back. */
static void expect_shortest(double v, bool is_float)
{
    char ours[NUMBER_MAX], theirs[40], a[40], b[40];
    int n = 1, length;
    double back;

    for (;; n++) {
        snprintf(theirs, sizeof theirs, "%.*e", n - 1, v);
        if (is_float ? strtof(theirs, NULL) == (float)v : strtod(theirs, NULL) == v)
            break;
    }
    length = (int)(is_float ? number_print_float(ours, (float)v) : number_print_double(ours, v));
    EXPECT(length == (int)strlen(ours) && length < NUMBER_MAX, "%s: length %d", ours, length);
    back = is_float ? strtof(ours, NULL) : strtod(ours, NULL);
    EXPECT(back == v, "%a is printed as %s", v, ours);
    if (significant(ours, a) < significant(theirs, b))
        EXPECT(!(bits_d(v) << 12), "%a: %s has fewer digits than %s", v, ours, theirs);
    else
        EXPECT(!strcmp(a, b), "%a: %s, expected the digits of %s", v, ours, theirs);
}

/* Can a decimal of n digits read back as v? All that are near enough are tried. */
static bool can_do_with(double v, int n, bool is_float)
{
    char text[40];
    int e10;
    unsigned long long w;

    snprintf(text, sizeof text, "%.17e", v);
    e10 = atoi(strchr(text, 'e') + 1) - n + 1;
    memmove(text + 1, text + 2, 17);
    text[n] = 0;
    w = strtoull(text, NULL, 10);                       /* the first n digits of v, cut */
    for (int k = -1; k <= 2; k++) {
        snprintf(text, sizeof text, "%llue%d", w + (unsigned long long)k, e10);
        if (is_float ? strtof(text, NULL) == (float)v : strtod(text, NULL) == v)
            return true;
    }
    return false;
}

static void powers_of_2(void)
{
    char text[NUMBER_MAX], digits[40];
    for (int is_float = 0; is_float < 2; is_float++) {
        double v = is_float ? 0x1p-149 : 0x1p-1074;
        for (; v <= (is_float ? 0x1p127 : 0x1p1023); v *= 2.0) {
            int n;
            if (is_float)
                number_print_float(text, (float)v);
            else
                number_print_double(text, v);
            n = significant(text, digits);
            expect_shortest(v, is_float);
            EXPECT(n == 1 || !can_do_with(v, n - 1, is_float), "%a: %s is not shortest", v, text);
        }
    }
}

static void shortest(void)
{
    Rng r = rng_seed(7);
    for (int i = 0; i < 40000; i++) {
        uint64_t b = rng_bits(&r) >> 1;
        double v = of_bits_d(b);
        float f = of_bits_f((uint32_t)(b >> 32));
        if (v > 0.0 && v < INFINITY && i % 4 == 0)
            expect_shortest(v, false);
        if (f > 0.0f && f < INFINITY)
            expect_shortest(f, true);
        expect_shortest(rng_unit(&r) + 0x1p-30, false);
        expect_shortest((double)of_bits_f(1 + (uint32_t)(b & 0xFFFFF)), true);  /* denormals */
    }
}

static void forms(void)
{
    const struct { double v; const char *text; } D[] = {
        { 0.0, "0" }, { -0.0, "-0" }, { 1, "1" }, { -1.5, "-1.5" }, { 100, "100" }, { 0.1, "0.1" },
        { 1e15, "1000000000000000" }, { 1e16, "1e16" },
        { 12345678901234567.0, "1.2345678901234568e16" },
        { 1e-5, "0.00001" }, { 1.25e-5, "0.0000125" }, { 9.5e-6, "9.5e-6" }, { 1e23, "1e23" },
        { 0x1p-1074, "5e-324" }, { 0x1.fffffffffffffp1023, "1.7976931348623157e308" },
        { 0x1p-44, "5.684341886080802e-14" }, { 9007199254740993.0, "9007199254740992" },
        { INFINITY, "inf" }, { -INFINITY, "-inf" }, { NAN, "nan" }, { 0.3, "0.3" },
        { 2.0 / 3.0, "0.6666666666666666" }, { -1234.5e-300, "-1.2345e-297" },
    };
    const struct { float v; const char *text; } F[] = {
        { 0.1f, "0.1" }, { 16777216.0f, "16777216" }, { 0x1p-149f, "1e-45" },
        { 0x1.fffffep127f, "3.4028235e38" }, { 1e10f, "10000000000" },
        { 0.333333343f, "0.33333334" },
        { -0.0f, "-0" }, { 3.14159274f, "3.1415927" }, { NAN, "nan" }, { -INFINITY, "-inf" },
        { 0x1p-126f, "1.1754944e-38" }, { 5e-6f, "5e-6" },
    };
    char out[NUMBER_MAX];
    for (size_t k = 0; k < sizeof D / sizeof D[0]; k++) {
        size_t n = number_print_double(out, D[k].v);
        EXPECT(!strcmp(out, D[k].text) && n == strlen(out), "%a: %s", D[k].v, out);
    }
    for (size_t k = 0; k < sizeof F / sizeof F[0]; k++) {
        size_t n = number_print_float(out, F[k].v);
        EXPECT(!strcmp(out, F[k].text) && n == strlen(out), "%a: %s", (double)F[k].v, out);
    }
}

static void fixed(void)
{
    Rng r = rng_seed(8);
    char ours[NUMBER_MAX], theirs[400];
    static const double EDGES[] = { 0.0, -0.0, 0.5, 1.5, 2.5, 0.125, 0.375, -0.001, 9.9999, 0.05,
                                    999999999999999.0, -999999999999999.875, 0x1p-1074, 1e-300,
                                    0.99999999999999989, 123456789012345.67 };
    for (int i = 0; i < 200000; i++) {
        int digits = (int)rng_below(&r, 18), kind = (int)rng_below(&r, 4);
        double v = rng_unit(&r) - 0.5;
        if (i < 16 * 18) {
            v = EDGES[i / 18];
            digits = i % 18;
        } else if (kind == 0)
            v = (double)(int64_t)rng_bits(&r) * 0x1p-14;
        else if (kind == 1)                             /* a tie in one digit or another */
            v = ((double)rng_below(&r, 20000) - 10000.0) / 64.0;
        else if (kind == 2)
            v *= 1000.0;
        if (!(fabs(v) < 1e15))
            continue;
        snprintf(theirs, sizeof theirs, "%.*f", digits, v);
        EXPECT(number_print_fixed(ours, v, digits) == strlen(theirs) && !strcmp(ours, theirs),
               "%a with %d digits: %s, expected %s", v, digits, ours, theirs);
    }
    number_print_fixed(ours, 1e15, 3);
    EXPECT(!strcmp(ours, "1000000000000000"), "1e15: %s", ours);
    number_print_fixed(ours, -INFINITY, 3);
    EXPECT(!strcmp(ours, "-inf"), "-inf: %s", ours);
    number_print_fixed(ours, NAN, 0);
    EXPECT(!strcmp(ours, "nan"), "nan: %s", ours);
}

/* ---- there and back ---- */

static void back_f(uint32_t b)
{
    char text[NUMBER_MAX];
    float v = of_bits_f(b), back = 0.0f;
    size_t n = number_print_float(text, v);
    EXPECT(number_float(text, text + n, &back) == n && same_f(back, v), "%08x is printed as %s",
           (unsigned)b, text);
}

static void back_d(uint64_t b)
{
    char text[NUMBER_MAX];
    double v = of_bits_d(b), back = 0.0;
    size_t n = number_print_double(text, v);
    EXPECT(number_double(text, text + n, &back) == n && same_d(back, v), "%016llx is printed as %s",
           (unsigned long long)b, text);
}

static void there_and_back(void)
{
    Rng r = rng_seed(9);
    for (int i = 0; i < (test_is_long() ? 10000000 : 1000000); i++)
        back_f((uint32_t)(rng_bits(&r) >> 32));
}

static void there_and_back_double(void)
{
    Rng r = rng_seed(10);
    for (int i = 0; i < (test_is_long() ? 10000000 : 1000000); i++)
        back_d(rng_bits(&r));
}

/* ---- long texts ---- */

static void expect_long(const char *text, size_t n, double want)
{
    float f = -1.0f;
    double d = -1.0;
    EXPECT(number_float(text, text + n, &f) == n, "%.20s...: a part of it was taken", text);
    EXPECT(number_double(text, text + n, &d) == n, "%.20s...: a part of it was taken", text);
    EXPECT(same_d(d, want) && same_f(f, as_float(want)), "%.20s...: %a", text, d);
}

/* Megabytes of digits, with work in proportion (a quadratic method would need hours here) and no
 * memory from the heap. */
static void endless(void)
{
    enum { N = 8 << 20 };
    char *text = malloc(N + 64);
    int64_t v;
    bool clipped;

    REQUIRE(text, "no memory");
    mem_fail_at(0, false);
    memset(text, '9', N);
    expect_long(text, N, INFINITY);
    EXPECT(number_int(text, text + N, &v, &clipped) == N && v == INT64_MAX && clipped, "integer");
    sprintf(text + N, "e-%d", N);
    expect_long(text, strlen(text), 1.0);               /* 0.999..., to the nearest */
    memset(text, '0', N);
    memcpy(text, "0.", 2);
    expect_long(text, N, 0.0);
    sprintf(text + N, "125e%d", N);                     /* 0.000...125 */
    expect_long(text, strlen(text), 12.5);
    memcpy(text, "1.", 2);
    expect_long(text, N, 1.0);
    memset(text + N, '0', 10);
    text[0] = '3';
    text[1] = '0';
    sprintf(text + N, "e-%d", N - 1);
    expect_long(text, strlen(text), 3.0);
    memset(text + N, '7', 60);                          /* an exponent of 60 digits */
    memcpy(text + N, "e-", 2);
    expect_long(text, N + 60, 0.0);
    memset(text, '7', N);
    memcpy(text, "1e", 2);
    expect_long(text, N, INFINITY);
    EXPECT(mem_calls() == 0, "%lu calls of the allocator", mem_calls());
    free(text);
}

/* ---- locale ---- */

static bool decimal_comma(void)
{
    static const char *const NAMES[] = { "de_DE.UTF-8", "de_DE.utf8", "de_DE", "fr_FR.UTF-8",
                                         "fr_FR.utf8", "ru_RU.UTF-8", "pl_PL.UTF-8" };
    char cmd[700];

    for (int round = 0; round < 2; round++) {
        for (size_t k = 0; k < sizeof NAMES / sizeof NAMES[0]; k++)
            if (setlocale(LC_ALL, NAMES[k]) && !strcmp(localeconv()->decimal_point, ","))
                return true;
        /* None is installed: build one, where the system has the sources. */
        snprintf(cmd, sizeof cmd, "localedef -i de_DE -f UTF-8 '%s/de_DE.UTF-8' >/dev/null 2>&1",
                 test_folder());
        if (round || system(cmd) || setenv("LOCPATH", test_folder(), 1))
            break;
    }
    return false;
}

static void locale(void)
{
    char text[NUMBER_MAX];

    if (!decimal_comma())
        test_skip("no locale with a decimal comma here");
    snprintf(text, sizeof text, "%.1f", 0.5);
    REQUIRE(!strcmp(text, "0,5"), "printf does not follow the locale: %s", text);
    expect_parse("0.5", 3, 0.5);
    expect_parse("0,5", 1, 0.0);
    expect_parse("1234.25e1", 9, 12342.5);
    expect_parse("0.1000000000000000055511151231257827021181583404541015625", 57, 0.1);
    number_print_double(text, 0.1);
    EXPECT(!strcmp(text, "0.1"), "%s", text);
    number_print_float(text, 1234.5f);
    EXPECT(!strcmp(text, "1234.5"), "%s", text);
    number_print_fixed(text, 1234.5, 2);
    EXPECT(!strcmp(text, "1234.50"), "%s", text);
}

const TestCase test_number[] = {
    { "grammar", grammar, false },
    { "ends", ends, false },
    { "integers", integers, false },
    { "middles", middles, false },
    { "library", library, false },
    { "forms", forms, false },
    { "shortest", shortest, false },
    { "powers_of_2", powers_of_2, false },
    { "fixed", fixed, false },
    { "there_and_back", there_and_back, false },
    { "there_and_back_double", there_and_back_double, false },
    { "endless", endless, false },
    { "locale", locale, false },
    { NULL, NULL, false }
};
