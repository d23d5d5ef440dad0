/* directions.c -- direction numbers of Sobol's sequence, found and not copied.
 *
 * Source      [Sobol67]; that 2-D projections decide, and how their quality t is told from the
 *             matrices: [JoeKuo08], [Niederreiter92 4.4].
 * Idea        Dimension j has the j-th primitive polynomial modulo 2 of degree s, in order of
 *             degree, x^s + a_1 x^(s-1) + ... + 1, and odd numbers m_1 .. m_s, m_k < 2^k, from
 *             which the others follow:
 *                 m_k = 2 a_1 m_(k-1) ^ 4 a_2 m_(k-2) ^ ... ^ 2^s m_(k-s) ^ m_(k-s)
 *             Any choice is a sequence that is even in each dimension. For each dimension in turn,
 *             some choices are tried, and that one is kept whose projections with the dimensions
 *             before it have the least t: those it makes a 2-D decision with count most.
 * Primitive   x is of order 2^s - 1 modulo the polynomial: found by multiplying until 1 comes. */
#include "sampling/directions.h"

#include "base/random.h"

#include <string.h>

/* ---- primitive polynomials: bit k is the coefficient of x^k ---- */

static bool is_primitive(uint32_t p, int s)
{
    uint32_t x = 1, order = 0;

    do {
        x <<= 1;
        if (x >> s & 1)
            x ^= p;
        order++;
    } while (x > 1);
    return x == 1 && order == (1u << s) - 1;
}

static uint32_t next_primitive(uint32_t p, int *degree)
{
    do {
        p += 2;
        if (p >> (*degree + 1))
            ++*degree;
    } while (!is_primitive(p, *degree));
    return p;
}

static void extend(uint32_t v[DIRECTION_BITS], uint32_t p, int s)
{
    for (int k = s; k < DIRECTION_BITS; k++) {
        v[k] = v[k - s] ^ v[k - s] >> s;
        for (int i = 1; i < s; i++)
            if (p >> (s - i) & 1)
                v[k] ^= v[k - i];
    }
}

/* ---- quality of two dimensions ---- */

/* Row r of a dimension's matrix: which of the m lowest bits of the index make digit r. */
static uint32_t row(const uint32_t v[DIRECTION_BITS], int r, int m)
{
    uint32_t bits = 0;
    for (int c = 0; c < m; c++)
        bits |= (v[c] >> (31 - r) & 1) << c;
    return bits;
}

/* Adds a row to a basis, in which by[k] has its highest bit at k. False: it depends on them. */
static bool independent(uint32_t *by, uint32_t x)
{
    for (int k = 15; x; k--)
        if (x >> k & 1) {
            if (!by[k]) {
                by[k] = x;
                return true;
            }
            x ^= by[k];
        }
    return false;
}

int directions_t(const uint32_t a[DIRECTION_BITS], const uint32_t b[DIRECTION_BITS], int m)
{
    uint32_t first[16] = { 0 }, rows[16];
    int even = m;               /* any so many first digits of the two, together, are even */

    for (int r = 0; r < m; r++)
        rows[r] = row(b, r, m);
    for (int from_a = 0; from_a < even; from_a++) {
        uint32_t by[16];
        int from_b = 0;
        memcpy(by, first, sizeof by);
        while (from_a + from_b < even && independent(by, rows[from_b]))
            from_b++;
        even = from_a + from_b < even ? from_a + from_b : even;
        independent(first, row(a, from_a, m));
    }
    return m - even;
}

/* ---- the search ---- */

static double badness(uint32_t (*v)[DIRECTION_BITS], int j)
{
    enum { NEAR = 10 };
    static const int lengths[3] = { 4, 6, 9 };
    double sum = 0;

    for (int i = j > NEAR ? j - NEAR : 0; i < j; i++)
        for (int k = 0; k < 3; k++)
            sum += (double)(1 << directions_t(v[i], v[j], lengths[k])) *
                   (j % 2 && i == j - 1 ? 16 : 1);
    return sum;
}

void directions_find(uint32_t (*v)[DIRECTION_BITS], int n)
{
    enum { TRIES = 32 };
    Rng rng = rng_seed(1967);
    uint32_t p = 1;
    int degree = 0;

    for (int k = 0; k < DIRECTION_BITS && n > 0; k++)
        v[0][k] = 1u << (31 - k);
    for (int j = 1; j < n; j++) {
        uint32_t best[DIRECTION_BITS] = { 0 };
        double least = 0;
        p = next_primitive(p, &degree);
        for (int t = 0; t < (degree == 1 ? 1 : TRIES); t++) {
            double b;
            for (int k = 0; k < degree; k++)
                v[j][k] = (2 * rng_below(&rng, 1u << k) + 1) << (31 - k);
            extend(v[j], p, degree);
            b = badness(v, j);
            if (t == 0 || b < least) {
                least = b;
                memcpy(best, v[j], sizeof best);
            }
        }
        memcpy(v[j], best, sizeof best);
    }
}
