/* test_statistics.c -- Student's t against closed forms, and lines through points whose slope is
 * known: whether the interval holds it as often as it says. */
#include "base/maths.h"
#include "base/random.h"
#include "base/statistics.h"
#include "test/test.h"

static bool near(double a, double b, double tolerance)
{
    return fabs(a - b) <= tolerance * fabs(b);
}

static void gamma_function(void)
{
    double factorial = 1;

    EXPECT(near(log_gamma(0.5), 0.5 * md_log(PI), 1e-14), "1/2: %.17g", log_gamma(0.5));
    for (int n = 1; n <= 100; n++) {            /* gamma(n + 1) = n! */
        factorial *= n;
        EXPECT(fabs(log_gamma(n + 1) - md_log(factorial)) < 1e-14 * (1 + md_log(factorial)),
               "%d: %.17g", n, log_gamma(n + 1));
    }
}

static void beta_function(void)
{
    for (int i = 0; i <= 64; i++) {
        double x = i / 64.0, y = 1 - x, two = x * x * (3 - 2 * x);
        EXPECT(fabs(beta_incomplete(2, 2, x, y) - two) < 1e-13, "I(2, 2) at %g", x);
        EXPECT(near(beta_incomplete(5, 1, x, y), x * x * x * x * x, 1e-12), "I(5, 1) at %g", x);
        EXPECT(fabs(beta_incomplete(0.5, 0.5, x, y) -
                    2 / PI * md_atan2(sqrt(x), sqrt(y))) < 1e-13, "I(1/2, 1/2) at %g", x);
        EXPECT(fabs(beta_incomplete(31.5, 0.5, x, y) + beta_incomplete(0.5, 31.5, y, x) - 1) <
               1e-13, "both sides at %g", x);
    }
}

/* The chance of |T| < t by the finite sums of [Abramowitz64] 26.7.3 and 26.7.4. */
static double within(double t, int dof)
{
    double angle = md_atan2(t, sqrt(dof)), c = md_cos(angle), s = md_sin(angle), sum = 0, term;

    if (dof % 2) {
        term = c;
        for (int k = 3; k <= dof; k += 2) {
            sum += term;
            term *= c * c * (k - 1) / k;
        }
        return 2 / PI * (angle + s * sum);
    }
    term = 1;
    for (int k = 2; k <= dof; k += 2) {
        sum += term;
        term *= c * c * (k - 1) / k;
    }
    return s * sum;
}

static void students_t(void)
{
    static const struct { double p, dof, t; } printed[] = {     /* tables of Student's t */
        { 0.05, 1, 12.706204736 }, { 0.05, 10, 2.2281388520 }, { 0.01, 5, 4.0321429836 },
        { 0.05, 63, 1.9983405425 }, { 0.001, 30, 3.6459586350 }
    };

    for (int dof = 1; dof <= 130; dof += dof < 20 ? 1 : 17)
        for (double t = 0; t < 6; t += 0.37)
            EXPECT(fabs(student_p(t, dof) - (1 - within(t, dof))) < 1e-13, "t %g of %d: %.17g", t,
                   dof, student_p(t, dof));
    for (double t = 1; t < 1e100; t *= 7)       /* far out: 1 - t / sqrt(2 + t^2), not cancelled */
        EXPECT(near(student_p(-t, 2), 2 / (sqrt(2 + t * t) * (sqrt(2 + t * t) + t)), 1e-11),
               "t %g of 2: %g", t, student_p(t, 2));
    EXPECT(student_p(0, 7) == 1 && student_p(INFINITY, 7) == 0 && student_p(1e200, 7) == 0, "ends");
    for (int i = 0; i < 5; i++)
        EXPECT(near(student_t(printed[i].p, printed[i].dof), printed[i].t, 1e-10),
               "%g of %g: %.12g", printed[i].p, printed[i].dof,
               student_t(printed[i].p, printed[i].dof));
}

static void families(void)
{
    EXPECT(family_p(0, 5) == 0 && family_p(1, 5) == 1 && family_p(0.3, 1) < 0.3 + 1e-15, "ends");
    EXPECT(near(family_p(0.25, 2), 1 - 0.75 * 0.75, 1e-14), "two");
    EXPECT(near(family_p(1e-20, 1e6), 1e-14, 1e-12), "small ones");
    for (double p = 9.9e-7; p < 1.2e-6; p *= 1.01)      /* where the forms change hands */
        EXPECT(near(family_p(p, 3), p * (3 + p * (-3 + p)), 1e-9), "at %g", p);
}

/* ---- lines ---- */

/* Sum of 12 uniform numbers: mean 6, variance 1. */
static double normal(Rng *r)
{
    double sum = -6;
    for (int i = 0; i < 12; i++)
        sum += rng_unit(r);
    return sum;
}

static void exact_lines(void)
{
    const double x[] = { 0, 1, 2, 4 }, y[] = { 5, 3, 1, -3 }, tie[] = { 0, 0.5, 0.25, 0.9 };
    const double same[] = { 3, 3, 3 }, by_hand[] = { 1, 2, 6 };
    LineFit f = line_fit(x, y, NULL, 4, 0.95);

    EXPECT(near(f.slope, -2, 1e-14) && near(f.at_0, 5, 1e-14) && f.error < 1e-14, "a line");
    f = line_fit(x, y, tie, 4, 0.95);
    EXPECT(near(f.slope, -2, 1e-13) && near(f.at_0, 5, 1e-13) && f.error < 1e-13, "tied");
    f = line_fit(x, y, NULL, 2, 0.95);
    EXPECT(near(f.slope, -2, 1e-14) && f.lo == -INFINITY && f.hi == INFINITY, "two points");
    EXPECT(line_fit(x, y, NULL, 1, 0.95).n == 1 && line_fit(x, y, NULL, 0, 0.95).n == 0, "fewer");
    EXPECT(line_fit(same, y, NULL, 3, 0.95).n == 1, "upright");
    /* 0 1 2 against 1 2 6: slope 5/2, off by 1/2, -1, 1/2, so 3/2 over (1 * 2): 0.75. */
    f = line_fit(x, by_hand, NULL, 3, 0.95);
    EXPECT(near(f.slope, 2.5, 1e-14) && near(f.error, sqrt(0.75), 1e-14) &&
           near(f.hi, 2.5 + 12.706204736 * sqrt(0.75), 1e-9), "by hand: %g %g", f.slope, f.error);
}

/* How often the interval at 90 % holds the slope, of errors tied by rho (a chain). */
static double coverage(double rho, const double *tie, int rounds)
{
    enum { N = 8 };
    Rng r = rng_seed(5);
    double x[N], y[N], held = 0;

    for (int k = 0; k < rounds; k++) {
        double off = normal(&r);
        for (int i = 0; i < N; i++) {
            x[i] = 0.7 * i;
            y[i] = 1 - 0.5 * x[i] + 0.1 * off;
            off = rho * off + sqrt(1 - rho * rho) * normal(&r);
        }
        LineFit f = line_fit(x, y, tie, N, 0.9);
        held += f.lo < -0.5 && f.hi > -0.5;
    }
    return held / rounds;
}

/* 4000 rounds: a standard error of 0.0047. Errors that are tied, taken for independent ones, give
 * an interval that is too narrow. */
static void intervals(void)
{
    const double half[] = { 0, 0.5, 0.5, 0.5, 0.5, 0.5, 0.5, 0.5 };
    double plain = coverage(0, NULL, 4000), tied = coverage(0.5, half, 4000);
    double mistaken = coverage(0.5, NULL, 4000);

    EXPECT(fabs(plain - 0.9) < 0.019, "independent: %g", plain);
    EXPECT(fabs(tied - 0.9) < 0.019, "tied: %g", tied);
    EXPECT(mistaken < 0.8, "tied, not told: %g", mistaken);
}

/* What race measures: the error of a running mean over P pixels at 1, 2, 4, ... 256 samples. The
 * same samples are in all of them: errors at n < m are correlated by sqrt(n / m), so their squares
 * by n / m, which is a chain. */
static void running_means(void)
{
    enum { PIXELS = 100, LEVELS = 9, ROUNDS = 300 };
    double x[LEVELS], y[LEVELS], tie[LEVELS], held = 0, mean = 0;
    Rng r = rng_seed(8);

    for (int k = 0; k < ROUNDS; k++) {
        double sum[PIXELS] = { 0 };
        for (int level = 0, n = 0; level < LEVELS; level++) {
            double square = 0;
            for (; n < 1 << level; n++)
                for (int p = 0; p < PIXELS; p++)
                    sum[p] += rng_unit(&r) - 0.5;
            for (int p = 0; p < PIXELS; p++)
                square += sum[p] / n * (sum[p] / n);
            x[level] = md_log(n);
            y[level] = 0.5 * md_log(square / PIXELS);
            tie[level] = 0.5;
        }
        LineFit f = line_fit(x, y, tie, LEVELS, 0.9);
        held += f.lo < -0.5 && f.hi > -0.5;
        mean += f.slope / ROUNDS;
    }
    EXPECT(fabs(mean + 0.5) < 0.01, "mean slope %g", mean);
    EXPECT(fabs(held / ROUNDS - 0.9) < 0.06, "held %g", held / ROUNDS);
}

const TestCase test_statistics[] = {
    { "gamma_function", gamma_function, false },
    { "beta_function", beta_function, false },
    { "students_t", students_t, false },
    { "families", families, false },
    { "exact_lines", exact_lines, false },
    { "intervals", intervals, false },
    { "running_means", running_means, false },
    { NULL, NULL, false }
};
