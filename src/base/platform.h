/* platform.h -- the one place for compiler extensions. Each has a plain C99 twin, and defining
 * RUSHLIGHT_PLAIN chooses the twins (make V=plain; the tests run that build too).
 * It also refuses what would break the promise that results do not depend on the build. */
#ifndef BASE_PLATFORM_H
#define BASE_PLATFORM_H

#include <stdint.h>

#ifdef __FAST_MATH__
#error "rushlight must not be compiled with -ffast-math: results would depend on the build"
#endif

#if defined(__GNUC__) && !defined(RUSHLIGHT_PLAIN)
#define PRINTF_LIKE(f, a) __attribute__((format(printf, f, a)))
#define LIKELY(c)   __builtin_expect(!!(c), 1)
#define UNLIKELY(c) __builtin_expect(!!(c), 0)
#define PREFETCH(p) __builtin_prefetch(p)
#define NOINLINE    __attribute__((noinline))
#define INLINE      static inline __attribute__((always_inline, unused))
#define SWAP_BYTES(x) __builtin_bswap64(x)
#define LOWEST_BIT(x) __builtin_ctz((unsigned)(x))
#define COUNT_BITS(x) __builtin_popcount((unsigned)(x))
#else
#define PRINTF_LIKE(f, a)
#define LIKELY(c)   (c)
#define UNLIKELY(c) (c)
#define PREFETCH(p) ((void)(p))
#define NOINLINE
#define INLINE      static inline
#define SWAP_BYTES(x)                                                                  \
    (((x) & 0xFFu) << 56 | ((x) & 0xFF00u) << 40 | ((x) & 0xFF0000u) << 24 |           \
     ((x) & 0xFF000000u) << 8 | ((x) >> 8 & 0xFF000000u) | ((x) >> 24 & 0xFF0000u) |   \
     ((x) >> 40 & 0xFF00u) | (x) >> 56)
#define LOWEST_BIT(x) lowest_bit((unsigned)(x))
#define COUNT_BITS(x) count_bits((unsigned)(x))
static inline int lowest_bit(unsigned x)        /* x != 0 */
{
    int k = 0;
    while (!(x >> k & 1))
        k++;
    return k;
}
static inline int count_bits(unsigned x)
{
    int n = 0;
    for (; x; x &= x - 1)
        n++;
    return n;
}
#endif

/* The product of polynomials modulo 2, a bit a coefficient: a multiplication without carries. */
#if defined(__PCLMUL__) && defined(__x86_64__) && !defined(RUSHLIGHT_PLAIN)
#include <wmmintrin.h>
INLINE uint64_t carryless_product(uint32_t a, uint32_t b)
{
    __m128i p = _mm_clmulepi64_si128(_mm_cvtsi32_si128((int)a), _mm_cvtsi32_si128((int)b), 0);
    return (uint64_t)_mm_cvtsi128_si64(p);
}
#else
/* With every fourth bit only, a common product has sums of at most eight, whose carries do not
 * reach the next of these bits: four by four such products. */
INLINE uint64_t carryless_product(uint32_t a, uint32_t b)
{
    const uint64_t every_fourth = 0x1111111111111111u;
    uint64_t product = 0, x[4], y[4];

    for (int k = 0; k < 4; k++) {
        x[k] = a & every_fourth << k;
        y[k] = b & every_fourth << k;
    }
    for (int k = 0; k < 4; k++)
        product |= (x[0] * y[k] ^ x[1] * y[(k + 3) & 3] ^ x[2] * y[(k + 2) & 3] ^
                    x[3] * y[(k + 1) & 3]) & every_fourth << k;
    return product;
}
#endif

/* tcc 0.9.27 stores 16 bytes where it returns a struct of three floats by value, and so overwrites
 * whatever stands behind it: it gets a fourth. */
#ifdef __TINYC__
#define FOURTH_FLOAT , unused
#else
#define FOURTH_FLOAT
#endif

#endif
