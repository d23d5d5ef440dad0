/* statistics.h -- what a few measurements allow to say: their median, Student's t, several tests at
 * once, and a line through points with the interval that its slope is in. */
#ifndef BASE_STATISTICS_H
#define BASE_STATISTICS_H

#include <stdbool.h>
#include <stddef.h>

void   sort_numbers(double *v, size_t n);       /* the least first */
double median(double *v, int n);                /* of n >= 1; sorts v */

/* log of the gamma function, x > 0; error below 1e-14 of max(1, |result|). */
double log_gamma(double x);

/* The regularised incomplete beta function I_x(a, b), for a, b > 0 and y = 1 - x, which the caller
 * gives since only he may know it without rounding. Relative error below 1e-12 (of the smaller of
 * I and 1 - I it is the smaller one that is summed). */
double beta_incomplete(double a, double b, double x, double y);

/* Student's t with `dof` >= 1 degrees of freedom: the chance of |T| >= |t|. */
double student_p(double t, double dof);
/* The t for which that chance is p, 0 < p <= 1. */
double student_t(double p, double dof);

/* The chance that of n independent tests of true claims one or more gives p or less: 1 - (1 - p)^n,
 * without cancellation [Sidak67]. */
double family_p(double p, double n);

/* y = at_0 + slope x by least squares. */
typedef struct {
    int    n;                   /* points; the rest is set from 2 on */
    double slope, at_0;
    double error;               /* standard error of the slope; infinite with 2 points */
    double lo, hi;              /* the interval of confidence; infinite with 2 points */
} LineFit;

/* Fits n points. tie[i]: the correlation, in [0, 1), of what y[i] is off with what y[i - 1] is off,
 * where those of others are tied only through such neighbours (a Markov chain); tie[0] is not read.
 * NULL: all independent. Then, and for normal errors of one size, the interval is exact: Student's
 * t with n - 2 degrees of freedom. Two equal x and no third: no slope (n = 1). */
LineFit line_fit(const double *x, const double *y, const double *tie, int n, double confidence);

#endif
