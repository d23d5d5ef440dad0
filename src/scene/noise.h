/* noise.h -- numbers that vary smoothly and without a period through space. */
#ifndef SCENE_NOISE_H
#define SCENE_NOISE_H

#include "base/vec.h"

/* In [-1,1], 0 where all coordinates are whole, about 0 in the mean. Continuous, and so are its
 * first two derivatives. 0 beyond 2^30, where a float has no digits left for it. */
float noise(V3 p);

/* The octaves of noise that a sum is made of: each is twice as fine (1.99 times, so that their
 * zeros do not meet) and `roughness` times as high. What is finer than `width` is left out. */
typedef struct { int octaves; float roughness, width; } Octaves;
float noise_sum(V3 p, Octaves o);               /* fractional Brownian motion */
float noise_turbulence(V3 p, Octaves o);        /* of absolute values: has creases */

/* In [0,1) by the cell of a grid, `which` of several numbers. */
float noise_cell(int64_t x, int64_t y, unsigned which);

#endif
