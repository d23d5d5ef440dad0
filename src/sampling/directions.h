/* directions.h -- direction numbers of Sobol's sequence. */
#ifndef SAMPLING_DIRECTIONS_H
#define SAMPLING_DIRECTIONS_H

#include <stdint.h>

enum { DIRECTION_BITS = 32 };

/* Of each dimension the numbers that the bits of an index, from the lowest, select for the sum
 * modulo 2; the first digit is the highest bit. n is at most 48. */
void directions_find(uint32_t (*v)[DIRECTION_BITS], int n);

/* The least t for which the first 2^m points of two dimensions are a (t,m,2)-net: each box of area
 * 2^(t - m) has 2^t of them. m <= 16. */
int directions_t(const uint32_t a[DIRECTION_BITS], const uint32_t b[DIRECTION_BITS], int m);

#endif
