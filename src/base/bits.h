/* bits.h -- floating-point numbers as the bits that stand for them in IEEE 754, and back. */
#ifndef BASE_BITS_H
#define BASE_BITS_H

#include "base/platform.h"

#include <stdint.h>
#include <string.h>

INLINE uint64_t bits_of(double v)
{
    uint64_t b;
    memcpy(&b, &v, sizeof b);
    return b;
}

INLINE double double_of(uint64_t b)
{
    double v;
    memcpy(&v, &b, sizeof v);
    return v;
}

INLINE uint32_t bits_of_float(float v)
{
    uint32_t b;
    memcpy(&b, &v, sizeof b);
    return b;
}

INLINE float float_of(uint32_t b)
{
    float v;
    memcpy(&v, &b, sizeof v);
    return v;
}

#endif
