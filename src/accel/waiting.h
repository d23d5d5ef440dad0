/* waiting.h -- what waits on the stack of a query: the bits of the distance at which the ray enters
 * it, then its number. Distances are not negative, so their bits are in their order, and comparing
 * takes no branch, which would be taken at random. */
#ifndef ACCEL_WAITING_H
#define ACCEL_WAITING_H

#include "base/platform.h"

#include <string.h>

typedef uint64_t Waiting;

INLINE Waiting waiting(float near, uint32_t number)
{
    uint32_t bits;
    memcpy(&bits, &near, 4);
    return (Waiting)bits << 32 | number;
}

INLINE float waiting_near(Waiting w)
{
    uint32_t bits = (uint32_t)(w >> 32);
    float near;
    memcpy(&near, &bits, 4);
    return near;
}

#endif
