/* chi2.h -- does a sampler draw from the density that it states? Pearson's test of counts in bins
 * against the integral of the density over each bin, for directions and for points of the unit
 * square; and the same for numbered things.
 *
 * Bins are cells of equal theta and phi, or of equal x and y. Their expected counts come from
 * adaptive quadrature in double, refined further where counts and integral disagree (only that can
 * clear the sampler: more digits never hide a difference). Bins that expect fewer than 10 are
 * pooled in order of size. The counts are looked at twice, in all bins and in blocks of 4 x 4: many
 * bins find local faults, few find faint broad ones. A sampler passes if p >= 2e-8 both times, no
 * draw fell where the density is 0, and the density integrates to 1, or to what draws were given
 * out if it refuses some. RELIABILITY: 1e6 draws find an rms error of the density of 3.3 % in
 * 64 x 128 bins and of 1.7 % in 16 x 32. */
#ifndef TEST_CHI2_H
#define TEST_CHI2_H

#include "base/random.h"
#include "base/vec.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#define CHI2_P_MIN 2e-8         /* 1e-4 for a family of 5000 tests */

typedef struct {
    /* Draws a unit direction, or a point (x, y, any) of [0,1)^2. False: refused. */
    bool (*draw)(const void *of, Rng *rng, V3 *w);
    /* Density: per solid angle, or per unit square. */
    double (*pdf)(const void *of, V3 w);
    const void *of;
    bool square;                /* points, not directions */
    uint64_t draws, seed;       /* draws 0: 1e6 */
    int rows, cols;             /* 0: 64 and 128; multiples of 4 */
    int halvings;               /* of every bin, both ways, to begin with; 2 or 3 for densities with
                                 * jumps, of which the points of a large cell may see nothing */
    float jump;                 /* z of a circle on which a density of directions jumps: bins that
                                 * it crosses are integrated in two parts; 0: none is known */
} Chi2;

typedef struct {
    double p_fine, p_coarse;    /* chance of counts at least as far off */
    double integral;            /* of the density */
    uint64_t refused, astray;   /* draws; astray: where the density is 0 or not finite */
    bool ok;                    /* false also if memory ran out */
} Chi2Result;

Chi2Result chi2_run(const Chi2 *c);

/* Runs it and records a failure of the running case, called `what`, if it is not ok. */
void chi2_expect(const Chi2 *c, const char *what);

/* p of counts of n numbered things against what was expected of each. Draws of things whose
 * expectation is 0 make p 0. */
double chi2_counts(const double *expected, const uint64_t *observed, size_t n);

/* Integral over the sphere (per solid angle) or the square, by the same quadrature. jump: as in
 * Chi2. */
double chi2_integral(double (*f)(const void *of, V3 w), const void *of, bool square, float jump,
                     int rows, int cols);

/* Upper tail of the chi-squared distribution. */
double chi2_tail(double x, double dof);

#endif
