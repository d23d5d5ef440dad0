/* harmonics.h -- spherical harmonics for the hemisphere: smooth functions of direction as a few
 * numbers.
 *
 * Source      [Abramowitz64 8.5.3] for the recurrence, in its normalised form.
 * Basis       The real harmonics of the bands l = 0 .. bands-1 that are even in z: those with l + m
 *             even. A function on the hemisphere is taken to go on below the horizon as its mirror
 *             image, so it has no step there that would ring; that leaves n (n + 1) / 2 of the n^2
 *             harmonics; and these are orthogonal on the hemisphere by themselves. Times sqrt 2,
 *             they are orthonormal. [Gautron04] make a basis by moving the sphere's: it needs n^2
 *             for the same bands, and is the same only about its own normal. */
#ifndef INTEGRATORS_HARMONICS_H
#define INTEGRATORS_HARMONICS_H

#include "base/vec.h"

enum { HARMONIC_BANDS = 10, HARMONICS_MOST = HARMONIC_BANDS * (HARMONIC_BANDS + 1) / 2 };

typedef struct {
    int   bands, n;             /* n: functions */
    float first[HARMONIC_BANDS];                /* l = m, without sine^m */
    float up[HARMONIC_BANDS][HARMONIC_BANDS], back[HARMONIC_BANDS][HARMONIC_BANDS];     /* [m][l] */
} Harmonics;

void harmonics_init(Harmonics *h, int bands);                   /* 1 .. HARMONIC_BANDS */
/* All of them for a unit vector; z below 0 counts as above. */
void harmonics_at(const Harmonics *h, V3 w, float *out);

#endif
