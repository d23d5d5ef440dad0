/* waiting.h -- what waits on the stack of a query: the bits of the distance at which the ray enters
 * it, then its number. Distances are not negative, so their bits are in their order, and comparing
 * takes no branch, which would be taken at random. */
#ifndef ACCEL_WAITING_H
#define ACCEL_WAITING_H

#include "base/bits.h"

typedef uint64_t Waiting;

INLINE Waiting waiting(float near, uint32_t number)
{
    return (Waiting)bits_of_float(near) << 32 | number;
}

INLINE float waiting_near(Waiting w) { return float_of((uint32_t)(w >> 32)); }

#endif
