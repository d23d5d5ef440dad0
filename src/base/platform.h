/* platform.h -- the one place for compiler extensions. Each has a plain C99 twin, and defining
 * RUSHLIGHT_PLAIN chooses the twins (make V=plain; the tests run that build too).
 * It also refuses what would break the promise that results do not depend on the build. */
#ifndef BASE_PLATFORM_H
#define BASE_PLATFORM_H

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
static inline int lowest_bit(unsigned x)        /* x != 0 */
{
    int k = 0;
    while (!(x >> k & 1))
        k++;
    return k;
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
