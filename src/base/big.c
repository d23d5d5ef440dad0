/* big.c -- whole numbers of bounded size, by the schoolbook. See big.h.
 *
 * Source  [Knuth2 4.3.1] for the division, which here yields quotients of 30 bits only, so that one
 *         estimate from the leading limbs and a step or two of correction do. */
#include "base/big.h"

#include "base/error.h"

int bit_length(uint64_t x)
{
    int n = 0;
    for (int step = 32; step; step /= 2)
        if (x >> step) {
            x >>= step;
            n += step;
        }
    return n + (x != 0);
}

void big_set(Big *a, uint64_t x)
{
    a->n = 0;
    for (; x; x >>= 32)
        a->d[a->n++] = (uint32_t)x;
}

void big_muladd(Big *a, uint32_t m, uint32_t add)
{
    uint64_t carry = add;
    for (int i = 0; i < a->n; i++) {
        carry += (uint64_t)a->d[i] * m;
        a->d[i] = (uint32_t)carry;
        carry >>= 32;
    }
    if (carry) {
        ASSERT(a->n < BIG_LIMBS);
        a->d[a->n++] = (uint32_t)carry;
    }
}

void big_times_power_of_5(Big *a, int k)
{
    for (; k >= 13; k -= 13)
        big_muladd(a, 1220703125u, 0);                  /* 5^13, the largest below 2^32 */
    for (; k > 0; k--)
        big_muladd(a, 5, 0);
}

int big_bits(const Big *a)
{
    return a->n ? 32 * (a->n - 1) + bit_length(a->d[a->n - 1]) : 0;
}

static void big_shift(Big *a, int k)                    /* a <- a * 2^k */
{
    int limbs = k / 32, n = a->n;

    if (!n || !k)
        return;
    ASSERT(n + limbs < BIG_LIMBS);
    a->d[n] = 0;
    for (int i = n; i >= 0; i--) {                      /* from above: in place */
        uint64_t two = (uint64_t)a->d[i] << 32 | (i ? a->d[i - 1] : 0);
        a->d[i + limbs] = (uint32_t)(two >> (32 - k % 32));
    }
    for (int i = 0; i < limbs; i++)
        a->d[i] = 0;
    a->n = n + limbs + (a->d[n + limbs] != 0);
}

/* a <- a - q * b, where b->n + 1 limbs of a hold all of it and the result is not negative. */
static void big_take(Big *a, const Big *b, uint32_t q)
{
    uint64_t borrow = 0;
    for (int i = 0; i < b->n; i++) {
        uint64_t p = (uint64_t)q * b->d[i] + borrow;
        borrow = (p >> 32) + (a->d[i] < (uint32_t)p);
        a->d[i] -= (uint32_t)p;
    }
    a->d[b->n] -= (uint32_t)borrow;
}

static bool big_reaches(const Big *a, const Big *b)     /* a >= b, limbs as in big_take */
{
    int i = b->n - 1;
    if (a->d[b->n])
        return true;
    while (i > 0 && a->d[i] == b->d[i])
        i--;
    return a->d[i] >= b->d[i];
}

/* a / b below 2^31, leaving the remainder in a. b's top limb has its high bit set, so the estimate
 * from the leading limbs is low by a factor of at most 1 - 2^-31: there are 2 steps at most. */
static uint32_t big_divide(Big *a, const Big *b)
{
    uint32_t q;

    for (int i = a->n; i <= b->n; i++)
        a->d[i] = 0;
    q = (uint32_t)(((uint64_t)a->d[b->n] << 32 | a->d[b->n - 1]) / ((uint64_t)b->d[b->n - 1] + 1));
    big_take(a, b, q);
    for (; big_reaches(a, b); q++)
        big_take(a, b, 1);
    a->n = b->n;
    while (a->n && !a->d[a->n - 1])
        a->n--;
    return q;
}

uint64_t ratio_floor(Big *num, Big *den, int e, bool *more)
{
    uint64_t high;
    int align;

    big_shift(e > 0 ? num : den, e > 0 ? e : -e);
    align = 31 - (big_bits(den) + 30 + 31) % 32;        /* to whole limbs, for big_divide */
    big_shift(num, align);
    big_shift(den, align + 30);
    high = big_divide(num, den);
    big_shift(num, 30);
    high = (high << 30) + big_divide(num, den);
    *more = num->n != 0;
    return high;
}
