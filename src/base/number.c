/* number.c -- decimal to binary and back, correctly rounded. See number.h.
 *
 * A decimal is w * 10^e with an integer w; a binary value m * 2^e. Both conversions come down to
 * one question, the integer part of (integer) * 2^a * 10^b and whether anything is left over, which
 * ratio_floor answers exactly with whole numbers of bounded size. In front of it stands arithmetic
 * in double wherever a bound of its error proves the rounding [Clinger90, Gay90]:
 *   - an integer up to 2^53 and a power of ten up to 10^22 are doubles, so one operation on them
 *     is correctly rounded;
 *   - a double with a relative error of a few 2^-53 rounds to the right float unless it lies within
 *     that error of the middle between two floats.
 * Printing takes 6, 7, 8, 9 (double: 15, 16, 17) correctly rounded digits until they read back.
 *
 * Memory is bounded whatever the length of the text: a middle between two doubles has at most 768
 * significant digits, so of the digits behind the 800th only "are they all zero" can matter. */
#include "base/number.h"

#include "base/big.h"
#include "base/bits.h"
#include "base/error.h"
#include "base/platform.h"

#include <math.h>
#include <string.h>

/* ---- formats ---- */

/* A value is m * 2^e with m < 2^bits, e >= emin. Patterns are those of IEEE 754, sign apart. */
typedef struct {
    int      bits, emin;
    uint64_t infinity;
    int      sure, enough;      /* any decimal of `sure` digits survives; `enough` tell all apart */
} Format;

static const Format FLOAT  = { 24, -149, (uint64_t)0xFF << 23, 6, 9 };
static const Format DOUBLE = { 53, -1074, (uint64_t)0x7FF << 52, 15, 17 };

/* The powers of ten that are doubles. */
static const double TEN[23] = {
    1e0, 1e1, 1e2, 1e3, 1e4, 1e5, 1e6, 1e7, 1e8, 1e9, 1e10, 1e11, 1e12, 1e13, 1e14, 1e15, 1e16,
    1e17, 1e18, 1e19, 1e20, 1e21, 1e22
};

/* The pattern of q * 2^e plus, with `more`, something below 2^e: nearest, ties to even. q has more
 * bits than the format, or e <= emin, so that what is dropped is there to see. */
static uint64_t assemble(uint64_t q, int e, bool more, const Format *f)
{
    int drop = bit_length(q) - f->bits;
    uint64_t m, rest, half, pattern;

    if (drop < f->emin - e)
        drop = f->emin - e;
    if (drop > 63)
        return 0;
    m = q >> drop;
    rest = q - (m << drop);
    half = (uint64_t)1 << drop >> 1;
    m += rest > half || (rest == half && (more || (m & 1)));
    /* The leading 1 of m adds 1 to the exponent field, as does a carry out of m. */
    pattern = ((uint64_t)(e + drop - f->emin) << (f->bits - 1)) + m;
    return pattern < f->infinity ? pattern : f->infinity;
}

/* ---- reading ---- */

enum {
    HEAD = 18,                  /* digits that surely fit into int64_t, whatever they are */
    DIGITS = 800,               /* more than can matter one by one */
    LOWEST = -323,              /* 10^(LOWEST - 1) is below half of the least double */
    HIGHEST = 310               /* 10^(HIGHEST - 1) is above the largest double */
};

/* A number in the text: about w * 10^e10. */
typedef struct {
    uint64_t    w;              /* its first HEAD significant digits */
    int64_t     e10;
    bool        negative, cut;  /* cut: digits that are not 0 follow those of w */
    const char *digits, *end;   /* borrowed: where they stand, with the point among them */
} Decimal;

static unsigned digit_at(const char *p) { return (unsigned)(unsigned char)*p - '0'; }

/* Takes the leading digits of a long number again, without the zeros in front. */
static void take_head(Decimal *d)
{
    int taken = 0;

    while (d->digits < d->end && (*d->digits == '0' || *d->digits == '.'))
        d->digits++;
    d->w = 0;
    for (const char *p = d->digits; p < d->end; p++) {
        if (*p == '.')
            continue;
        if (taken < HEAD) {
            d->w = d->w * 10 + digit_at(p);
            taken++;
        } else {
            d->cut |= *p != '0';
            d->e10++;
        }
    }
}

/* Takes [eE] [+-] digits at p if digits are there, and adds them to *e10. */
static const char *scan_exponent(const char *p, const char *end, int64_t *e10)
{
    const char *q = p + 1;
    bool negative = q < end && *q == '-';
    int64_t e = 0;

    q += q < end && (*q == '-' || *q == '+');
    if (q >= end || digit_at(q) > 9)
        return p;
    for (; q < end && digit_at(q) <= 9; q++)
        if (e < (int64_t)1 << 55)       /* more than any text has digits to make up for it */
            e = e * 10 + (int64_t)digit_at(q);
    *e10 += negative ? -e : e;
    return q;
}

static size_t scan(const char *s, const char *end, Decimal *d)
{
    const char *p = s;
    uint64_t w = 0;
    ptrdiff_t count;

    d->negative = p < end && *p == '-';
    p += p < end && (*p == '-' || *p == '+');
    d->digits = p;
    for (; p < end && digit_at(p) <= 9; p++)
        w = w * 10 + digit_at(p);
    count = p - d->digits;
    d->e10 = 0;
    if (p < end && *p == '.') {
        const char *point = p++;
        for (; p < end && digit_at(p) <= 9; p++)
            w = w * 10 + digit_at(p);
        d->e10 = point + 1 - p;
        count += p - point - 1;
    }
    if (!count)
        return 0;
    d->w = w;
    d->cut = false;
    d->end = p;
    if (UNLIKELY(count > HEAD))
        take_head(d);
    if (p < end && (*p == 'e' || *p == 'E'))
        p = scan_exponent(p, end, &d->e10);
    return (size_t)(p - s);
}

/* What matters of a long number, as an integer; *e10 is its power of ten. True: there is more. */
static bool take_digits(const Decimal *d, Big *a, int *e10)
{
    uint32_t group = 0, unit = 1;
    int taken = 0;
    bool more = false;

    a->n = 0;
    for (const char *p = d->digits; p < d->end; p++) {
        if (*p == '.')
            continue;
        if (taken == DIGITS) {
            more |= *p != '0';
            continue;
        }
        group = group * 10 + digit_at(p);
        unit *= 10;
        taken++;
        if (unit == 1000000000 || taken == DIGITS) {
            big_muladd(a, unit, group);
            group = 0;
            unit = 1;
        }
    }
    big_muladd(a, unit, group);
    *e10 = (int)d->e10 + HEAD - taken;
    return more;
}

/* The pattern nearest to d, without its sign. */
static uint64_t decimal_bits(const Decimal *d, const Format *f)
{
    Big num, den;
    bool left = false, more;
    int e10, scale, point = 1;
    uint64_t q;

    for (uint64_t w = d->w; w >= 10; w /= 10)
        point++;
    if (!d->w || d->e10 + point < LOWEST)
        return 0;
    if (d->e10 + point > HIGHEST)
        return f->infinity;
    e10 = (int)d->e10;
    big_set(&num, d->w);
    big_set(&den, 1);
    if (d->cut)
        left = take_digits(d, &num, &e10);
    big_times_power_of_5(e10 > 0 ? &num : &den, e10 > 0 ? e10 : -e10);
    scale = 60 - (big_bits(&num) - big_bits(&den));     /* the quotient has 60 or 61 bits */
    q = ratio_floor(&num, &den, scale, &more);
    return assemble(q, e10 - scale, more || left, f);
}

static uint64_t decimal_double(const Decimal *d)
{
    if (d->w <= (uint64_t)1 << 53 && d->e10 >= -22 && d->e10 <= 22 && !d->cut) {
        double w = (double)(int64_t)d->w;
        return bits_of(d->e10 < 0 ? w / TEN[-d->e10] : w * TEN[d->e10]);
    }
    return decimal_bits(d, &DOUBLE);
}

/* What the fast path for floats cannot decide: within 8 units of a double from a middle. The cut
 * digits, the conversion of w and the operation err by less than 3. */
static bool near_middle(double x)
{
    return (bits_of(x) & 0x1FFFFFFF) - (0x10000000 - 8) <= 16;
}

/* The fast path keeps far from the ends of float: w < 10^18. */
static float decimal_float(const Decimal *d)
{
    if (d->e10 >= -20 && d->e10 <= 20) {
        double w = (double)(int64_t)d->w;
        double x = d->e10 < 0 ? w / TEN[-d->e10] : w * TEN[d->e10];
        if (LIKELY(!near_middle(x)))
            return (float)x;
    }
    return float_of((uint32_t)decimal_bits(d, &FLOAT));
}

/* inf, infinity or nan with a sign, in any case. */
static size_t scan_special(const char *s, const char *end, double *v)
{
    static const char *const NAMES[] = { "infinity", "inf", "nan" };
    const char *p = s;
    bool negative = p < end && *p == '-';

    p += p < end && (*p == '-' || *p == '+');
    for (int k = 0; k < 3; k++) {
        const char *name = NAMES[k];
        size_t n = 0;
        while (name[n] && p + n < end && (p[n] == name[n] || p[n] == name[n] - 'a' + 'A'))
            n++;
        if (!name[n]) {
            *v = k == 2 ? NAN : negative ? -INFINITY : INFINITY;
            return (size_t)(p - s) + n;
        }
    }
    return 0;
}

size_t number_float(const char *s, const char *end, float *v)
{
    Decimal d;
    size_t n = scan(s, end, &d);

    if (UNLIKELY(!n)) {
        double x;
        n = scan_special(s, end, &x);
        if (n)
            *v = (float)x;
        return n;
    }
    *v = d.negative ? -decimal_float(&d) : decimal_float(&d);
    return n;
}

size_t number_double(const char *s, const char *end, double *v)
{
    Decimal d;
    size_t n = scan(s, end, &d);

    if (UNLIKELY(!n))
        return scan_special(s, end, v);
    *v = double_of(decimal_double(&d));
    if (d.negative)
        *v = -*v;
    return n;
}

size_t number_int(const char *s, const char *end, int64_t *v, bool *clipped)
{
    const char *p = s, *digits;
    bool negative = p < end && *p == '-', over = false;
    uint64_t w = 0, limit = (uint64_t)INT64_MAX + negative;

    p += p < end && (*p == '-' || *p == '+');
    digits = p;
    for (; p < end && digit_at(p) <= 9; p++) {
        if (w > (limit - digit_at(p)) / 10)
            over = true;
        else
            w = w * 10 + digit_at(p);
    }
    if (p == digits)
        return 0;
    if (over)
        w = limit;
    *v = !negative ? (int64_t)w : w ? -(int64_t)(w - 1) - 1 : 0;        /* INT64_MIN too */
    if (clipped)
        *clipped = over;
    return (size_t)(p - s);
}

/* ---- printing ---- */

/* |v| > 0 as m * 2^e. */
static uint64_t parts_of(uint64_t pattern, const Format *f, int *e)
{
    uint64_t field = pattern >> (f->bits - 1), leading = (uint64_t)1 << (f->bits - 1);

    *e = f->emin + (field ? (int)field - 1 : 0);
    return (pattern & (leading - 1)) | (field ? leading : 0);
}

/* v * 10^k, below 10^18, to the nearest integer, ties to even. */
static uint64_t scaled(double v, int k)
{
    Big num, den;
    uint64_t twice;
    bool more;
    int e;

    if (k >= -22 && k <= 22) {
        double x = k < 0 ? v / TEN[-k] : v * TEN[k], whole = floor(x);
        /* Below 2^52 the middles are doubles, so x lies on the right side of them, or on one. */
        if (x < 0x1p52 && x - whole != 0.5)
            return (uint64_t)whole + (x - whole > 0.5);
    }
    if (v == 0.0)
        return 0;
    big_set(&num, parts_of(bits_of(v), &DOUBLE, &e));
    big_set(&den, 1);
    big_times_power_of_5(k > 0 ? &num : &den, k > 0 ? k : -k);
    twice = ratio_floor(&num, &den, e + k + 1, &more);
    return (twice >> 1) + ((twice & 1) && (more || (twice & 2)));
}

/* The n first digits of v > 0, correctly rounded, as an integer to be multiplied by 10^*e10. */
static uint64_t leading_digits(double v, int n, int *e10)
{
    uint64_t limit = 1, w;
    int e, top;

    for (int i = 0; i < n; i++)
        limit *= 10;
    e = bit_length(parts_of(bits_of(v), &DOUBLE, &top)) - 1 + top;
    top = (int)floor(e * 0.30102999566398119521);       /* of log10 v: this or one more */
    while ((w = scaled(v, n - 1 - top)) >= limit)
        top++;
    *e10 = top + 1 - n;
    return w;
}

static bool reads_back(uint64_t w, int e10, double v, const Format *f)
{
    Decimal d = { w, e10, false, false, NULL, NULL };
    return f == &FLOAT ? (double)decimal_float(&d) == v : decimal_double(&d) == bits_of(v);
}

/* The shortest digits that read back as v > 0. A decimal of `sure` digits or fewer that does is the
 * nearest one of `sure` digits (if v is normal), so the search need not begin below. The nearest
 * one of n digits does if any does, but above a power of two: there the gap above is twice the
 * one below, and the next decimal up may do where the nearest, below, does not. */
static uint64_t shortest_digits(double v, const Format *f, int *e10)
{
    bool normal = v >= (f == &FLOAT ? 0x1p-126 : 0x1p-1022);

    for (int n = normal ? f->sure : 1;; n++) {
        uint64_t w = leading_digits(v, n, e10);
        if (n == f->enough || reads_back(w, *e10, v, f))
            return w;
        if (!(bits_of(v) << 12) && reads_back(w + 1, *e10, v, f))
            return w + 1;
    }
}

static char *put_zeros(char *p, int n)
{
    while (n-- > 0)
        *p++ = '0';
    return p;
}

/* w in decimal, with at least `least` digits. Returns the end. */
static char *put_integer(char *p, uint64_t w, int least)
{
    char digits[20];
    int n = 0;

    for (; w || n < least; w /= 10)
        digits[n++] = (char)('0' + w % 10);
    while (n)
        *p++ = digits[--n];
    return p;
}

/* w * 10^e10, w > 0: plain from 1e-5 up to below 1e16, else with an exponent. */
static char *put_decimal(char *p, uint64_t w, int e10)
{
    char digits[20];
    int n, point;               /* the value is 0.DIGITS * 10^point */

    for (; w % 10 == 0; w /= 10)
        e10++;
    n = (int)(put_integer(digits, w, 1) - digits);
    point = n + e10;
    if (point > 16 || point < -4) {
        *p++ = digits[0];
        if (n > 1)
            *p++ = '.';
        memcpy(p, digits + 1, (size_t)n - 1);
        p += n - 1;
        *p++ = 'e';
        if (point < 1)
            *p++ = '-';
        return put_integer(p, (uint64_t)(point < 1 ? 1 - point : point - 1), 1);
    }
    if (point <= 0) {
        *p++ = '0';
        *p++ = '.';
        p = put_zeros(p, -point);
        memcpy(p, digits, (size_t)n);
        return p + n;
    }
    for (int i = 0; i < n; i++) {
        if (i == point)
            *p++ = '.';
        *p++ = digits[i];
    }
    return put_zeros(p, point - n);
}

static size_t print(char *out, double v, const Format *f)
{
    char *p = out;
    int e10;

    if (v != v) {
        memcpy(out, "nan", 4);
        return 3;
    }
    if (bits_of(v) >> 63)
        *p++ = '-';
    v = fabs(v);
    if (v == 0.0)
        *p++ = '0';
    else if (v > 0x1.fffffffffffffp1023) {
        memcpy(p, "inf", 3);
        p += 3;
    } else {
        uint64_t w = shortest_digits(v, f, &e10);
        p = put_decimal(p, w, e10);
    }
    *p = 0;
    return (size_t)(p - out);
}

size_t number_print_float(char out[NUMBER_MAX], float v) { return print(out, v, &FLOAT); }
size_t number_print_double(char out[NUMBER_MAX], double v) { return print(out, v, &DOUBLE); }

/* The parts before and behind the point are doubles, so both are taken apart exactly. */
size_t number_print_fixed(char out[NUMBER_MAX], double v, int digits)
{
    double size = fabs(v), whole = floor(size);
    uint64_t before, behind = 0, limit = 1;
    char *p = out;

    if (!(size < 1e15))
        return print(out, v, &DOUBLE);
    ASSERT(digits >= 0 && digits <= 17);
    for (int i = 0; i < digits; i++)
        limit *= 10;
    if (digits) {
        before = (uint64_t)whole;
        behind = scaled(size - whole, digits);
        if (behind == limit) {
            behind = 0;
            before++;
        }
    } else
        before = scaled(size, 0);
    if (bits_of(v) >> 63)
        *p++ = '-';
    p = put_integer(p, before, 1);
    if (digits) {
        *p++ = '.';
        p = put_integer(p, behind, digits);
    }
    *p = 0;
    return (size_t)(p - out);
}
