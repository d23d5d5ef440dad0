/* test_simd.c -- vectors against the plain operations, lane by lane and bit by bit: what lets every
 * build give the same pictures. */
#include "base/random.h"
#include "base/simd.h"
#include "test/test.h"

#include <string.h>

enum { ODD_ONES = 12 };

/* One number in four is of the odd ones, so that pairs of them meet. */
static void fill(Rng *r, float *v, int n)
{
    const float odd_ones[ODD_ONES] = { 0.0f, -0.0f, 1.0f, -1.0f, INFINITY, -INFINITY, NAN,
                                       1e-45f, -1e-45f, 3.4e38f, -3.4e38f, 1.5f };

    for (int k = 0; k < n; k++)
        v[k] = rng_below(r, 4) ? 2.0f * rng_unit(r) - 1.0f : odd_ones[rng_below(r, ODD_ONES)];
}

/* The same bits; what is no number may be any. */
static bool same(float a, float b)
{
    return (a != a && b != b) || !memcmp(&a, &b, sizeof a);
}

static float plus(float a, float b) { return a + b; }
static float minus(float a, float b) { return a - b; }
static float times(float a, float b) { return a * b; }
static float most(float a, float b) { return a > b ? a : b; }
static float least(float a, float b) { return a < b ? a : b; }

typedef float (*Plain)(float a, float b);
typedef struct {
    const char *name;
    Plain plain;
    F4 (*four)(F4 a, F4 b);
    F8 (*eight)(F8 a, F8 b);
} Op;

/* Not inlined: their addresses are taken. */
static F4 add4(F4 a, F4 b) { return f4_add(a, b); }
static F4 sub4(F4 a, F4 b) { return f4_sub(a, b); }
static F4 mul4(F4 a, F4 b) { return f4_mul(a, b); }
static F4 max4(F4 a, F4 b) { return f4_max(a, b); }
static F4 min4(F4 a, F4 b) { return f4_min(a, b); }
static F8 add8(F8 a, F8 b) { return f8_add(a, b); }
static F8 sub8(F8 a, F8 b) { return f8_sub(a, b); }
static F8 mul8(F8 a, F8 b) { return f8_mul(a, b); }
static F8 max8(F8 a, F8 b) { return f8_max(a, b); }
static F8 min8(F8 a, F8 b) { return f8_min(a, b); }

static const Op ops[] = {
    { "add", plus, add4, add8 }, { "sub", minus, sub4, sub8 }, { "mul", times, mul4, mul8 },
    { "max", most, max4, max8 }, { "min", least, min4, min8 }
};

static void two_operands(void)
{
    Rng r = rng_seed(1);

    for (size_t o = 0; o < sizeof ops / sizeof ops[0]; o++)
        for (int i = 0; i < 20000; i++) {
            float a[8], b[8], out[8];
            F4 four;
            bool ok = true;

            fill(&r, a, 8);
            fill(&r, b, 8);
            four = ops[o].four(f4(a[0], a[1], a[2], a[3]), f4(b[0], b[1], b[2], b[3]));
            f8_store(out, ops[o].eight(f8_load(a), f8_load(b)));
            for (int k = 0; k < 8; k++) {
                float want = ops[o].plain(a[k], b[k]);
                ok = ok && same(out[k], want) && (k >= 4 || same(f4_lane(four, k), want));
            }
            EXPECT(ok, "%s of numbers %d", ops[o].name, i);
            if (!ok)
                return;
        }
}

static void other_operations(void)
{
    Rng r = rng_seed(2);

    for (int i = 0; i < 20000; i++) {
        float a[8], b[8], c[8], out[8];
        int less = 0, at_most = 0, signs = 0;
        F4 x, chosen, size;
        bool ok = true;

        fill(&r, a, 8);
        fill(&r, b, 8);
        fill(&r, c, 8);
        x = f4(a[0], a[1], a[2], a[3]);
        chosen = f4_if_negative(x, f4(b[0], b[1], b[2], b[3]), f4(c[0], c[1], c[2], c[3]));
        size = f4_abs(x);
        f8_store(out, f8_abs(f8_load(a)));
        for (int k = 0; k < 8; k++) {
            ok = ok && same(out[k], fabsf(a[k]));
            less |= (a[k] < b[k]) << k;
            at_most |= (a[k] <= b[k]) << k;
        }
        for (int k = 0; k < 4; k++) {
            uint32_t word;
            memcpy(&word, &a[k], 4);
            signs |= (int)(word >> 31) << k;
            ok = ok && same(f4_lane(size, k), fabsf(a[k])) &&
                 same(f4_lane(chosen, k), a[k] < 0.0f ? b[k] : c[k]);
        }
        ok = ok && f4_less(x, f4_load_any(b)) == (less & 15) &&
             f4_at_most(x, f4_load_any(b)) == (at_most & 15);
        ok = ok && f4_signs(x) == signs && f8_less(f8_load(a), f8_load(b)) == less &&
             f8_at_most(f8_load(a), f8_load(b)) == at_most &&
             same(f4_max_three(x), most(a[0], most(a[1], a[2]))) &&
             same(f4_min_three(x), least(a[0], least(a[1], a[2])));
        EXPECT(ok, "numbers %d", i);
        if (!ok)
            return;
    }
}

/* Whole numbers as floats. */
static void whole(void)
{
    Rng r = rng_seed(4);

    for (int i = 0; i < 10000; i++) {
        uint16_t wide[8];
        unsigned char small[8];
        float a[8], b[8];
        bool ok = true;

        for (int k = 0; k < 8; k++) {
            wide[k] = (uint16_t)(i ? rng_bits(&r) : 0xFFFF);
            small[k] = (unsigned char)(i ? rng_bits(&r) : 0xFF);
        }
        f8_store(a, f8_load_u16(wide));
        f8_store(b, f8_load_u8(small));
        for (int k = 0; k < 8; k++)
            ok = ok && a[k] == (float)wide[k] && b[k] == (float)small[k];
        EXPECT(ok, "numbers %d", i);
    }
}

/* Rows of points; whole numbers in lanes. */
static void rows(void)
{
    Rng r = rng_seed(5);

    for (int i = 0; i < 1000; i++) {
        float p[4][4], out[3][4], joined[8];
        uint32_t a[8], b[8], c[8], sum[8], less[8], left[8], chosen[8];
        unsigned char small[8];
        F4 row[3];
        I8 x, y;
        bool ok = true;

        for (int k = 0; k < 4; k++)
            fill(&r, p[k], 4);
        for (int k = 0; k < 8; k++) {
            a[k] = rng_bits(&r);
            b[k] = rng_bits(&r);
            small[k] = (unsigned char)rng_bits(&r);
        }
        f4_transpose(f4_load_any(p[0]), f4_load_any(p[1]), f4_load_any(p[2]), f4_load_any(p[3]),
                     row);
        for (int k = 0; k < 3; k++) {
            f4_store_any(out[k], row[k]);
            for (int l = 0; l < 4; l++)
                ok = ok && same(out[k][l], p[l][k]);
        }
        for (int k = 0; k < 6; k++) {
            int axes[3] = { k % 3, (k + 1 + k / 3) % 3, (k + 2 - k / 3) % 3 };
            f4_store_any(out[0], f4_pick(f4_load_any(p[0]), f4_axes(axes[0], axes[1], axes[2])));
            for (int l = 0; l < 4; l++)
                ok = ok && same(out[0][l], p[0][l < 3 ? axes[l] : 3]);
        }
        f8_store(joined, f8_join(f4_load_any(p[0]), f4_load_any(p[1])));
        for (int k = 0; k < 8; k++)
            ok = ok && same(joined[k], p[k / 4][k % 4]);
        x = i8_load(a);
        y = i8_load(b);
        i8_store(sum, i8_add(x, y));
        i8_store(less, i8_sub(x, y));
        i8_store(left, i8_left(x, 27));
        i8_store(chosen, i8_if_top(x, y, i8_all(7)));
        i8_store(c, i8_load_u8(small));
        for (int k = 0; k < 8; k++)
            ok = ok && sum[k] == a[k] + b[k] && less[k] == a[k] - b[k] && left[k] == a[k] << 27 &&
                 chosen[k] == (a[k] >> 31 ? b[k] : 7) && c[k] == small[k];
        EXPECT(ok, "numbers %d", i);
    }
}

/* Keys: the least of any choice of eight, and the others in their order. */
static void keys(void)
{
    Rng r = rng_seed(6);

    for (int i = 0; i < 5000; i++) {
        float near[8];
        uint32_t low[8];
        uint64_t key[8], out[16], least = UINT64_MAX;
        int chosen = i < 256 ? i : (int)(rng_bits(&r) & 255), n = 0, others;
        Keys8 all;
        bool ok = true;

        for (int k = 0; k < 8; k++) {
            uint32_t word;
            near[k] = rng_below(&r, 4) ? rng_unit(&r) * 9 : rng_below(&r, 2) ? INFINITY : 0.0f;
            low[k] = rng_bits(&r);
            memcpy(&word, &near[k], 4);
            key[k] = (uint64_t)word << 32 | low[k];
            least = chosen >> k & 1 && key[k] < least ? key[k] : least;
        }
        all = keys8(f8_load(near), i8_load(low));
        ok = keys8_least(all, chosen) == least;
        others = keys8_others(all, chosen, least);
        keys8_store(out, all, others);
        for (int k = 0; k < 8; k++)
            if (chosen >> k & 1 && key[k] != least)
                ok = ok && others >> k & 1 && out[n++] == key[k];
        EXPECT(ok && COUNT_BITS(others) == n, "numbers %d", i);
    }
}

static void bits(void)
{
    for (int k = 0; k < 32; k++) {
        EXPECT(COUNT_BITS(1u << k) == 1 && COUNT_BITS(0xFFFFFFFFu << k) == 32 - k, "%d", k);
        EXPECT(LOWEST_BIT(1u << k) == k, "bit %d alone", k);
        EXPECT(LOWEST_BIT(0xFFFFFFFFu << k) == k, "bit %d and all above", k);
    }
}

/* Polynomials modulo 2 multiplied as on paper. */
static void carryless(void)
{
    Rng r = rng_seed(3);

    for (int i = 0; i < 20000; i++) {
        uint32_t a = (uint32_t)rng_bits(&r), b = (uint32_t)rng_bits(&r);
        uint64_t want = 0;

        a = i % 5 ? a : 0xFFFFFFFFu;            /* the most carries */
        b = i % 3 ? b : 0xFFFFFFFFu;
        for (int k = 0; k < 32; k++)
            want ^= b >> k & 1 ? (uint64_t)a << k : 0;
        EXPECT(carryless_product(a, b) == want, "%lx times %lx", (unsigned long)a,
               (unsigned long)b);
    }
}

const TestCase test_simd[] = {
    { "two_operands", two_operands, false },
    { "other_operations", other_operations, false },
    { "whole", whole, false }, { "rows", rows, false }, { "keys", keys, false },
    { "bits", bits, false }, { "carryless", carryless, false },
    { NULL, NULL, false }
};
