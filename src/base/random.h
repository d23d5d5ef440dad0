/* random.h -- counter-based random numbers: a number is a pure function of a key and a counter, so
 * that work may run in any order on any number of threads and still draw the same numbers.
 *
 * Source  [Steele14] the finalizer of SplitMix64 (Stafford's mix 13), a bijection of 64 bits. */
#ifndef BASE_RANDOM_H
#define BASE_RANDOM_H

#include "base/maths.h"
#include "base/platform.h"

#include <stdint.h>

INLINE uint64_t mix64(uint64_t x)
{
    x = (x ^ (x >> 30)) * 0xBF58476D1CE4E5B9u;
    x = (x ^ (x >> 27)) * 0x94D049BB133111EBu;
    return x ^ (x >> 31);
}

/* A key out of a key and a word: order matters, and 0 is no fixed point. */
INLINE uint64_t key_with(uint64_t key, uint64_t word)
{
    return mix64(key ^ mix64(word + 0x9E3779B97F4A7C15u));
}

/* Draw number `counter` of the stream `key`. */
INLINE uint64_t draw64(uint64_t key, uint64_t counter)
{
    return mix64(key + counter * 0x9E3779B97F4A7C15u);
}

/* In [0,1): multiples of 2^-24, so never 1 and exact in float. */
INLINE float unit_of(uint32_t bits) { return (float)(bits >> 8) * 0x1p-24f; }

/* A sequential generator for places where order is fixed anyway (tests, generated meshes). */
typedef struct { uint64_t key, counter; } Rng;
INLINE Rng rng_seed(uint64_t seed) { return (Rng){ mix64(seed + 0x9E3779B97F4A7C15u), 0 }; }
INLINE uint64_t rng_bits(Rng *r) { return draw64(r->key, ++r->counter); }
INLINE float rng_unit(Rng *r) { return unit_of((uint32_t)(rng_bits(r) >> 32)); }
INLINE uint32_t rng_below(Rng *r, uint32_t n)           /* 0 .. n-1; bias below n * 2^-32 */
{
    return (uint32_t)(((rng_bits(r) >> 32) * n) >> 32);
}

#endif
