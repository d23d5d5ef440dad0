/* halves.h -- lights that face somewhere, in two halves: where the trees over them divide. */
#ifndef LIGHTSAMPLING_HALVES_H
#define LIGHTSAMPLING_HALVES_H

#include "base/vec.h"

INLINE void order_swap(uint32_t *a, uint32_t *b)
{
    uint32_t x = *a;
    *a = *b;
    *b = x;
}

/* Puts order[first .. end), numbers of lights, into two runs, by the middle of their longest side
 * in six dimensions: three of the place, and three of the normal in units of a distance. Where that
 * parts nothing, half of them. Returns where the second run begins. */
INLINE uint32_t halves_divide(uint32_t *order, uint32_t first, uint32_t end,
                              float (*key)(const void *of, uint32_t light, int k), const void *of)
{
    float lo[6], hi[6], middle;
    uint32_t at = first;
    int axis = 0;

    for (int k = 0; k < 6; k++) {
        lo[k] = INFINITY;
        hi[k] = -INFINITY;
        for (uint32_t i = first; i < end; i++) {
            float x = key(of, order[i], k);
            lo[k] = f_min(lo[k], x);
            hi[k] = f_max(hi[k], x);
        }
        if (hi[k] - lo[k] > hi[axis] - lo[axis])
            axis = k;
    }
    middle = 0.5f * lo[axis] + 0.5f * hi[axis];
    for (uint32_t i = first; i < end; i++)
        if (key(of, order[i], axis) < middle)
            order_swap(&order[i], &order[at++]);
    return at == first || at == end ? first + (end - first) / 2 : at;
}

#endif
