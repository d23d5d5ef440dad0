/* filter.c -- drawing from pixel filters. See filter.h. */
#include "image/filter.h"

/* ---- integrals ---- */

/* Of the profile from x0 to x1, by Gauss's rule of four points: exact for cubics and all up to the
 * seventh degree, and in cells of r / 128 as good as exact for the others. */
static double integral(const Filter *f, double r, double x0, double x1)
{
    static const double at[2] = { 0.33998104358485626, 0.86113631159405257 };
    static const double weight[2] = { 0.65214515486254614, 0.34785484513745386 };
    double half = 0.5 * (x1 - x0), middle = 0.5 * (x1 + x0), sum = 0;

    for (int i = 0; i < 2; i++)
        sum += weight[i] * (f->kind->profile(f, middle - half * at[i], r) +
                            f->kind->profile(f, middle + half * at[i], r));
    return sum * half;
}

/* Where the profile is 0 between x0 and x1, at which its signs differ. */
static double zero_between(const Filter *f, double r, double x0, double x1)
{
    bool positive = f->kind->profile(f, x0, r) > 0;

    for (int i = 0; i < 60; i++) {
        double x = 0.5 * (x0 + x1);
        if ((f->kind->profile(f, x, r) > 0) == positive)
            x0 = x;
        else
            x1 = x;
    }
    return 0.5 * (x0 + x1);
}

static void add_cell(const Filter *f, FilterAxis *a, double end)
{
    double mass = integral(f, a->radius, a->at[a->n], end);

    ASSERT(a->n + 1 < FILTER_NODES);
    a->sign[a->n] = mass < 0 ? -1.0f : 1.0f;
    a->at[a->n + 1] = end;
    a->sum[a->n + 1] = a->sum[a->n] + fabs(mass);
    a->area += 2 * mass;
    a->n++;
}

/* Equal cells, divided where the sign changes, of which eight places in each are asked. */
static void axis_init(const Filter *f, FilterAxis *a, double radius)
{
    enum { ASKED = 8 };
    double step = radius / (FILTER_CELLS * ASKED), inset = 1e-9 * radius;

    a->radius = radius;
    a->at[0] = a->sum[0] = a->area = 0;
    a->n = 0;
    for (int i = 0; i < FILTER_CELLS * ASKED; i++) {
        double x0 = step * i + inset, x1 = step * (i + 1) - inset;      /* a 0 on a node is none */
        if (f->kind->profile(f, x0, radius) * f->kind->profile(f, x1, radius) < 0)
            add_cell(f, a, zero_between(f, radius, x0, x1));
        if ((i + 1) % ASKED == 0)
            add_cell(f, a, radius * ((i + 1) / ASKED) / FILTER_CELLS);
    }
    ASSERT(a->area > 0);
}

void filter_init(Filter *f, const FilterKind *kind, const Opts *o)
{
    double r[2] = { opt_float(o, "xradius"), opt_float(o, "yradius") }, z = 1;
    bool negative = false;

    f->kind = kind;
    f->reach = INFINITY;
    if (kind->init)
        kind->init(f, o);
    for (int k = 0; k < 2; k++) {
        FilterAxis *a = &f->axis[k];
        axis_init(f, a, d_min(r[k] > 0 ? r[k] : kind->radius, f->reach));
        for (size_t i = 0; i < a->n; i++)
            negative = negative || a->sign[i] < 0.0f;
        z *= 2 * a->sum[a->n] / a->area;
    }
    f->weight = negative ? (float)z : 1.0f;
}

/* ---- sampling ---- */

/* The place in cell k up to which there is `mass`, by Newton's method, kept within bounds that
 * close in. */
static double place_in(const Filter *f, const FilterAxis *a, size_t k, double mass)
{
    double lo = a->at[k], hi = a->at[k + 1], start = lo, whole = a->sum[k + 1] - a->sum[k];
    double x = lo + (hi - lo) * (whole > 0 ? mass / whole : 0);

    for (int i = 0; i < 40; i++) {
        double over = a->sign[k] * integral(f, a->radius, start, x) - mass;
        double slope = a->sign[k] * f->kind->profile(f, x, a->radius), next;
        if (over > 0)
            hi = x;
        else
            lo = x;
        next = slope > 0 ? x - over / slope : lo;
        if (!(next > lo && next < hi))
            next = 0.5 * (lo + hi);
        if (fabs(next - x) <= 1e-9 * a->radius)
            return next;
        x = next;
    }
    return x;
}

/* Rising in u, from one end of the filter to the other, so that strata stay strata. */
static float axis_sample(const Filter *f, const FilterAxis *a, float u, float *sign)
{
    double t = 2.0 * u - 1.0, mass = fabs(t) * a->sum[a->n], x;
    size_t lo = 0, hi = a->n;

    while (hi - lo > 1) {
        size_t middle = (lo + hi) / 2;
        if (a->sum[middle] <= mass)
            lo = middle;
        else
            hi = middle;
    }
    *sign *= a->sign[lo];
    x = place_in(f, a, lo, mass - a->sum[lo]);
    return (float)(t < 0 ? -x : x);
}

V2 filter_sample(const Filter *f, V2 u, float *weight)
{
    *weight = f->weight;
    if (f->kind->inverse)
        return (V2){ f->kind->inverse(u.x) * (float)f->axis[0].radius,
                     f->kind->inverse(u.y) * (float)f->axis[1].radius };
    return (V2){ axis_sample(f, &f->axis[0], u.x, weight),
                 axis_sample(f, &f->axis[1], u.y, weight) };
}

double filter_eval(const Filter *f, double x, double y)
{
    const FilterAxis *a = f->axis;

    if (fabs(x) > a[0].radius || fabs(y) > a[1].radius)
        return 0;
    return f->kind->profile(f, fabs(x), a[0].radius) / a[0].area *
           (f->kind->profile(f, fabs(y), a[1].radius) / a[1].area);
}
