/* statistics.c -- see statistics.h.
 *
 * Sources  [Abramowitz64]  6.1.40 (log gamma), 26.5.8 (continued fraction of the beta function),
 *          26.7.1 (Student's t by it). The fraction is summed by the method of [Lentz76]. */
#include "base/statistics.h"

#include "base/maths.h"

#include <math.h>
#include <stdlib.h>

static int by_size(const void *a, const void *b)
{
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

void sort_numbers(double *v, size_t n) { qsort(v, n, sizeof *v, by_size); }

double median(double *v, int n)
{
    sort_numbers(v, (size_t)n);
    return n % 2 ? v[n / 2] : 0.5 * (v[n / 2 - 1] + v[n / 2]);
}

double log_gamma(double x)
{
    static const double series[] = { 1.0 / 12, -1.0 / 360, 1.0 / 1260, -1.0 / 1680, 1.0 / 1188,
                                     -691.0 / 360360, 1.0 / 156 };
    double product = 1, sum = 0, z;

    for (; x < 10; x++)                         /* there the series is good to the last bits */
        product *= x;
    z = 1 / (x * x);
    for (int k = 6; k >= 0; k--)
        sum = sum * z + series[k];
    return (x - 0.5) * md_log(x) - x + 0.5 * md_log(2 * PI) + sum / x - md_log(product);
}

/* Coefficient number m of the continued fraction 1 / (1 + d1 / (1 + d2 / (1 + ... */
static double beta_step(double a, double b, double x, int m)
{
    double k = m / 2;
    if (m % 2)
        return -(a + k) * (a + b + k) * x / ((a + 2 * k) * (a + 2 * k + 1));
    return k * (b - k) * x / ((a + 2 * k - 1) * (a + 2 * k));
}

/* I_x(a, b) where the fraction converges fast: x <= (a + 1) / (a + b + 2). */
static double beta_part(double a, double b, double x, double y)
{
    enum { STEPS = 10000 };                     /* it takes O(sqrt(max(a, b))) */
    const double tiny = 1e-300;                 /* stands for a 0 that would be divided by */
    double c = 1, d = 1, f, log_front;

    if (!(x > 0))
        return 0;
    d = 1 - (a + b) * x / (a + 1);
    d = 1 / (fabs(d) < tiny ? tiny : d);
    f = d;
    for (int m = 2; m < STEPS; m++) {
        double step = beta_step(a, b, x, m);
        d = 1 + step * d;
        c = 1 + step / c;
        d = 1 / (fabs(d) < tiny ? tiny : d);
        c = fabs(c) < tiny ? tiny : c;
        f *= c * d;
        if (fabs(c * d - 1) < 1e-15)
            break;
    }
    log_front = a * md_log(x) + b * md_log(y) + log_gamma(a + b) - log_gamma(a) - log_gamma(b);
    return md_exp(log_front) * f / a;
}

double beta_incomplete(double a, double b, double x, double y)
{
    return x <= (a + 1) / (a + b + 2) ? beta_part(a, b, x, y) : 1 - beta_part(b, a, y, x);
}

double student_p(double t, double dof)
{
    double all = dof + t * t;
    return all < INFINITY ? beta_incomplete(0.5 * dof, 0.5, dof / all, t * t / all) : 0;
}

double student_t(double p, double dof)
{
    double lo = 0, hi = 1;

    while (student_p(hi, dof) > p && hi < 1e150)
        hi *= 2;
    for (int i = 0; i < 100; i++) {
        double middle = 0.5 * (lo + hi);
        if (student_p(middle, dof) > p)
            lo = middle;
        else
            hi = middle;
    }
    return hi;
}

/* log(1 - p) and 1 - exp(-q) lose their digits near 0; there two terms of their series do. */
double family_p(double p, double n)
{
    double q = n * (p < 1e-6 ? p + 0.5 * p * p : -md_log(1 - p));
    return q < 1e-6 ? q - 0.5 * q * q : 1 - md_exp(-q);
}

/* ---- a line through points ---- */

/* Sums over rows of the equations: `one` is what at_0 is multiplied by. */
typedef struct { double one2, one_x, x2, one_y, xy; } Normal;

/* Row i with errors independent of those before it, and of one size: a row less what the one before
 * foretells of it. */
static void whiten(const double *x, const double *y, const double *tie, int i, double row[3])
{
    double rho = tie && i ? tie[i] : 0, s = 1 / sqrt(1 - rho * rho);

    row[0] = (1 - rho) * s;
    row[1] = (x[i] - (rho > 0 ? rho * x[i - 1] : 0)) * s;
    row[2] = (y[i] - (rho > 0 ? rho * y[i - 1] : 0)) * s;
}

LineFit line_fit(const double *x, const double *y, const double *tie, int n, double confidence)
{
    LineFit f = { n, 0, 0, INFINITY, -INFINITY, INFINITY };
    Normal s = { 0, 0, 0, 0, 0 };
    double row[3], det, rest = 0, reach;

    for (int i = 0; i < n; i++) {
        whiten(x, y, tie, i, row);
        s.one2 += row[0] * row[0];
        s.one_x += row[0] * row[1];
        s.x2 += row[1] * row[1];
        s.one_y += row[0] * row[2];
        s.xy += row[1] * row[2];
    }
    det = s.one2 * s.x2 - s.one_x * s.one_x;
    if (n < 2 || !(det > 1e-12 * s.one2 * s.x2)) {
        f.n = n < 1 ? n : 1;
        return f;
    }
    f.slope = (s.one2 * s.xy - s.one_x * s.one_y) / det;
    f.at_0 = (s.one_y - f.slope * s.one_x) / s.one2;
    if (n == 2)
        return f;
    for (int i = 0; i < n; i++) {
        double off;
        whiten(x, y, tie, i, row);
        off = row[2] - f.slope * row[1] - f.at_0 * row[0];
        rest += off * off;
    }
    f.error = sqrt(rest / (n - 2) * s.one2 / det);
    reach = f.error * student_t(1 - confidence, n - 2);
    f.lo = f.slope - reach;
    f.hi = f.slope + reach;
    return f;
}
