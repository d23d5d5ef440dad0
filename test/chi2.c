/* chi2.c -- Pearson's test of samplers. See chi2.h. */
#include "test/chi2.h"

#include "base/maths.h"
#include "base/mem.h"
#include "base/statistics.h"
#include "test/test.h"

#include <stdlib.h>

/* ---- the distribution: regularised incomplete gamma function ---- */

/* Q(a, x) = Gamma(a, x) / Gamma(a): a series for P = 1 - Q below the mean, and above it Legendre's
 * continued fraction by Lentz's method. */
static double gamma_tail(double a, double x)
{
    double front, sum, term, b, c, d;

    if (!(x > 0.0))
        return 1.0;
    front = md_exp(a * md_log(x) - x - log_gamma(a));
    if (x < a + 1.0) {
        sum = term = 1.0 / a;
        for (int k = 1; k < 100000 && term > sum * 1e-16; k++)
            sum += term *= x / (a + k);
        return 1.0 - front * sum;
    }
    b = x + 1.0 - a;
    c = 1e300;
    d = 1.0 / b;
    sum = d;
    for (int k = 1; k < 100000; k++) {
        double an = -k * (k - a);
        b += 2.0;
        d = an * d + b;
        d = 1.0 / (fabs(d) < 1e-300 ? 1e-300 : d);
        c = b + an / c;
        c = fabs(c) < 1e-300 ? 1e-300 : c;
        sum *= c * d;
        if (fabs(c * d - 1.0) < 1e-15)
            break;
    }
    return front * sum;
}

double chi2_tail(double x, double dof) { return gamma_tail(0.5 * dof, 0.5 * x); }

/* ---- counts against expectations ---- */

typedef struct { double expected, observed; } Bin;

static int by_expected(const void *a, const void *b)
{
    double x = ((const Bin *)a)->expected, y = ((const Bin *)b)->expected;
    return (x > y) - (x < y);
}

/* Sorts, pools and tests. */
static double bins_p(Bin *bin, size_t n)
{
    Bin pool = { 0.0, 0.0 };
    size_t cells = 0;
    double sum = 0.0;

    qsort(bin, n, sizeof *bin, by_expected);
    for (size_t i = 0; i < n; i++) {
        pool.expected += bin[i].expected;
        pool.observed += bin[i].observed;
        if (pool.expected >= 10.0) {                    /* what is left over joins the last pool */
            bin[cells++] = pool;
            pool = (Bin){ 0.0, 0.0 };
        }
    }
    if (!cells)
        return 1.0;
    bin[cells - 1].expected += pool.expected;
    bin[cells - 1].observed += pool.observed;
    for (size_t i = 0; i < cells; i++) {
        double d = bin[i].observed - bin[i].expected;
        sum += d * d / bin[i].expected;
    }
    return cells < 2 ? 1.0 : chi2_tail(sum, (double)(cells - 1));
}

double chi2_counts(const double *expected, const uint64_t *observed, size_t n)
{
    Bin *bin = MEM_ARRAY(Bin, n);
    double p = bin ? 1.0 : 0.0;
    for (size_t i = 0; bin && i < n; i++) {
        bin[i] = (Bin){ expected[i], (double)observed[i] };
        if (expected[i] == 0.0 && observed[i] > 0)
            p = 0.0;
    }
    if (p > 0.0)
        p = bins_p(bin, n);
    mem_free(bin);
    return p;
}

/* ---- quadrature over bins ---- */

typedef struct {
    double (*f)(const void *of, V3 w);
    const void *of;
    bool square;
} Integrand;

/* The integral over a cell of the parameter square [x0, x0+dx) x [y0, y0+dy) by Gauss's rule of n
 * points a side. Directions: theta = pi x, phi = 2 pi y - pi. */
static double gauss(const Integrand *g, double x0, double dx, double y0, double dy, int n)
{
    static const double at[4][3] = { { 0 }, { 0 }, { 0.21132486540518712, 0.78867513459481288 },
                                     { 0.11270166537925831, 0.5, 0.88729833462074169 } };
    static const double share[4][3] = { { 0 }, { 0 }, { 0.5, 0.5 },
                                        { 5.0 / 18, 8.0 / 18, 5.0 / 18 } };
    double sum = 0.0, cos_phi[3], sin_phi[3];

    for (int j = 0; j < n && !g->square; j++) {
        double phi = PI * (2.0 * (y0 + at[n][j] * dy) - 1.0);
        cos_phi[j] = md_cos(phi);
        sin_phi[j] = md_sin(phi);
    }
    for (int i = 0; i < n; i++) {
        double x = x0 + at[n][i] * dx, row = 0.0, s = md_sin(PI * x), c = md_cos(PI * x);
        for (int j = 0; j < n; j++) {
            V3 w = g->square ? v3((float)x, (float)(y0 + at[n][j] * dy), 0.0f)
                             : v3((float)(s * cos_phi[j]), (float)(s * sin_phi[j]), (float)c);
            row += share[n][j] * g->f(g->of, w);
        }
        sum += share[n][i] * row * (g->square ? 1.0 : 2.0 * PI * PI * s);
    }
    return sum * dx * dy;
}

/* Halves a cell both ways until rules of 2 and of 3 points agree to 1e-4 (the latter is then right
 * to about 1e-6, unless a narrow peak makes them agree by chance) or the difference is 2e-9 of the
 * whole; at least `least`, at most 10 times. */
static double integrate(const Integrand *g, double x0, double dx, double y0, double dy, int depth,
                        int least)
{
    double fine = 0.0, coarse;
    if (depth >= least) {
        coarse = gauss(g, x0, dx, y0, dy, 2);
        fine = gauss(g, x0, dx, y0, dy, 3);
        if (fabs(fine - coarse) <= 1e-4 * fabs(fine) || fabs(fine - coarse) <= 2e-9 || depth == 10)
            return fine;
    }
    dx *= 0.5;
    dy *= 0.5;
    fine = 0.0;
    for (int k = 0; k < 4; k++)
        fine += integrate(g, x0 + (k & 1) * dx, dx, y0 + (k >> 1) * dy, dy, depth + 1, least);
    return fine;
}

/* Of rows that the circle z = jump crosses, each side by itself. */
static double integrate_bin(const Integrand *g, float jump, double x, double dx, double y,
                            double dy, int least)
{
    double cut = g->square ? 0.0 : (double)m_acos(jump) / PI - x;
    if (!(cut > 0.0 && cut < dx))
        return integrate(g, x, dx, y, dy, 0, least);
    return integrate(g, x, cut, y, dy, 0, least) +
           integrate(g, x + cut, dx - cut, y, dy, 0, least);
}

double chi2_integral(double (*f)(const void *of, V3 w), const void *of, bool square, float jump,
                     int rows, int cols)
{
    Integrand g = { f, of, square };
    double sum = 0.0;
    for (int i = 0; i < rows; i++)
        for (int j = 0; j < cols; j++)
            sum += integrate_bin(&g, jump, (double)i / rows, 1.0 / rows, (double)j / cols,
                                 1.0 / cols, 0);
    return sum;
}

/* ---- the test of a sampler ---- */

typedef struct {
    Chi2 c;
    size_t n;                   /* bins */
    double *expected;           /* of one draw; owned */
    uint64_t *observed;         /* owned */
    double *edge;               /* cosines of the rows' edges, falling; owned */
    Bin *bin;                   /* owned */
} Test;

static int clamp_int(int k, int n) { return k < 0 ? 0 : k < n ? k : n - 1; }

static size_t bin_of(const Test *t, V3 w)
{
    int row, col;
    if (t->c.square) {
        row = clamp_int((int)floor((double)w.x * t->c.rows), t->c.rows);
        col = clamp_int((int)floor((double)w.y * t->c.cols), t->c.cols);
    } else {                    /* by z, not by angle: which side of the horizon must not round */
        int lo = 0, n = t->c.rows;
        while (n > 1) {
            int half = n / 2;
            lo = w.z <= t->edge[lo + half] ? lo + half : lo;
            n -= half;
        }
        row = lo;
        col = clamp_int((int)floor((m_atan2(w.y, w.x) / (2.0 * PI) + 0.5) * t->c.cols), t->c.cols);
    }
    return (size_t)row * (size_t)t->c.cols + (size_t)col;
}

/* Draws, then integrates every bin, again and deeper where the count is surprising. */
static void count_and_integrate(Test *t, Chi2Result *r)
{
    const Chi2 *c = &t->c;
    Integrand g = { c->pdf, c->of, c->square };
    Rng rng = rng_seed(c->seed);
    double n = (double)c->draws;

    for (uint64_t k = 0; k < c->draws; k++) {
        V3 w;
        double pdf;
        if (!c->draw(c->of, &rng, &w)) {
            r->refused++;
            continue;
        }
        pdf = c->pdf(c->of, w);
        if (!(pdf > 0.0) || pdf > 1e300)
            r->astray++;
        t->observed[bin_of(t, w)]++;
    }
    for (size_t k = 0; k < t->n; k++) {
        double dx = 1.0 / c->rows, x = dx * (double)(k / (size_t)c->cols);
        double dy = 1.0 / c->cols, y = dy * (double)(k % (size_t)c->cols), off;
        double e = integrate_bin(&g, c->jump, x, dx, y, dy, c->halvings);
        off = fabs((double)t->observed[k] - n * e);
        if (off > 4.0 * sqrt(n * e + 1.0))
            e = integrate_bin(&g, c->jump, x, dx, y, dy, c->halvings + (e > 0.0 ? 3 : 5));
        t->expected[k] = e;
        r->integral += e;
    }
}

/* p in blocks of s x s bins. Refused draws are a bin of their own; if there are none, the
 * expectations are scaled to what was drawn, as the integral's error is not the sampler's. */
static double view_p(Test *t, const Chi2Result *r, int s)
{
    size_t cols = (size_t)(t->c.cols / s), n = (size_t)(t->c.rows / s) * cols;
    double draws = (double)t->c.draws, scale = r->refused ? draws : draws / r->integral;

    for (size_t k = 0; k < n; k++)
        t->bin[k] = (Bin){ 0.0, 0.0 };
    for (size_t k = 0; k < t->n; k++) {
        size_t row = k / (size_t)t->c.cols / (size_t)s, col = k % (size_t)t->c.cols / (size_t)s;
        t->bin[row * cols + col].expected += scale * t->expected[k];
        t->bin[row * cols + col].observed += (double)t->observed[k];
    }
    if (r->refused) {
        double e = draws * (1.0 - r->integral);
        t->bin[n++] = (Bin){ e > 0.0 ? e : 0.0, (double)r->refused };
    }
    return bins_p(t->bin, n);
}

Chi2Result chi2_run(const Chi2 *c)
{
    Test t = { *c, 0, NULL, NULL, NULL, NULL };
    Chi2Result r = { 0.0, 0.0, 0.0, 0, 0, false };

    t.c.draws = c->draws ? c->draws : 1000000;
    t.c.rows = c->rows ? c->rows : 64;
    t.c.cols = c->cols ? c->cols : 128;
    t.n = (size_t)t.c.rows * (size_t)t.c.cols;
    t.expected = MEM_ARRAY(double, t.n);
    t.observed = MEM_ARRAY(uint64_t, t.n);
    t.edge = MEM_ARRAY(double, (size_t)t.c.rows + 1);
    t.bin = MEM_ARRAY(Bin, t.n + 1);
    if (t.expected && t.observed && t.edge && t.bin) {
        for (int i = 0; i <= t.c.rows; i++)
            t.edge[i] = 2 * i == t.c.rows ? 0.0 : md_cos(PI * i / t.c.rows);
        count_and_integrate(&t, &r);
        r.p_fine = view_p(&t, &r, 1);
        r.p_coarse = view_p(&t, &r, 4);
        r.ok = r.p_fine >= CHI2_P_MIN && r.p_coarse >= CHI2_P_MIN && r.astray == 0 &&
               r.integral <= 1.0 + 1e-4 && (r.refused || r.integral >= 1.0 - 1e-4);
    }
    mem_free(t.expected);
    mem_free(t.observed);
    mem_free(t.edge);
    mem_free(t.bin);
    return r;
}

void chi2_expect(const Chi2 *c, const char *what)
{
    Chi2Result r = chi2_run(c);
    EXPECT(r.ok, "%s: p %.2g, in blocks %.2g; the density integrates to %.6f; %lu refused, %lu "
           "astray", what, r.p_fine, r.p_coarse, r.integral, (unsigned long)r.refused,
           (unsigned long)r.astray);
}
