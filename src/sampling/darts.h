/* darts.h -- sets of points on the unit torus with a distance between all of them. */
#ifndef SAMPLING_DARTS_H
#define SAMPLING_DARTS_H

#include "base/random.h"

/* Coordinates in units of 2^-32: differences are those on the torus by themselves. */
typedef struct { uint32_t x, y; } TorusPoint;

typedef enum { DARTS_THROWN, DARTS_BEST } DartMethod;

/* n points by the method, then `relax` steps of Lloyd's relaxation. False: memory, reported. */
bool darts_make(TorusPoint *p, uint32_t n, DartMethod method, int relax, Rng *rng);

/* The least distance between two of n points, in units of the side of the square; of one point,
 * from it to itself around the torus. By trying all. */
double darts_distance(const TorusPoint *p, uint32_t n);

#endif
