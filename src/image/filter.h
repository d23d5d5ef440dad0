/* filter.h -- pixel filters, by sampling: the place of a camera sample is drawn from the filter
 * around the pixel's centre, so a sample belongs to one pixel and pixels stay independent.
 *
 * Source      [Shirley91 5.1, 5.4.1]. All are separable, w(x, y) = a(x) a(y), and symmetric.
 * Negative    Where a is negative in places, samples are drawn from |w|, and one that falls on a
 *             negative place counts -Z, others +Z, Z the integral of |w| by that of w. The mean of
 *             value times weight is then the filtered picture, and sums stay exact. (Means divided
 *             by the sum of signs would be smoother where the picture is, but biased, and the sum
 *             may be 0.)
 * Conditions  A filter should have 1. unit area, 2. symmetry, 3. bounded support, 4. no negative
 *             place, and 5. weights on the grid of pixels that add up to the same wherever the grid
 *             lies. All here have 1 to 3. Those with an `a` from the family of errata 001.1 and
 *             some others have 4 and 5 as well; the rest say in `fails` what they lack. */
#ifndef IMAGE_FILTER_H
#define IMAGE_FILTER_H

#include "base/kind.h"
#include "base/vec.h"

typedef struct Filter Filter;

typedef struct {
    KindInfo info;
    const char *fails;          /* the conditions that it has not at its usual radius; "": none */
    double radius;              /* usual half width, pixels */
    /* a at distance x from the middle, in [0, r], up to a factor. Smooth between 128ths of r. */
    double (*profile)(const Filter *f, double x, double r);
    /* Where its integral reaches the part u, in [-1, 1] of the half width; NULL: by table. */
    float (*inverse)(float u);
    void (*init)(Filter *f, const Opts *o);     /* the kind's own numbers; NULL: none */
} FilterKind;

/* One axis: half a table of the integral of |a|. Cells end where a changes its sign. */
enum { FILTER_CELLS = 128, FILTER_NODES = FILTER_CELLS + 49 };
typedef struct {
    double radius;
    double at[FILTER_NODES], sum[FILTER_NODES]; /* of nodes; sum[n] is half the integral of |a| */
    float  sign[FILTER_NODES];                  /* of a in the cell that begins there */
    size_t n;                                   /* cells */
    double area;                                /* of a over both halves */
} FilterAxis;

struct Filter {
    const FilterKind *kind;
    double a, b;                /* the kind's own */
    double reach;               /* beyond is nothing, however large the radius */
    FilterAxis axis[2];
    float  weight;              /* Z; exactly 1 if nothing is negative */
};

void filter_init(Filter *f, const FilterKind *kind, const Opts *o);

/* Offset from the pixel's centre, in pixels; *weight: what a sample there counts. */
V2 filter_sample(const Filter *f, V2 u, float *weight);

/* w there, of integral 1. |w| / Z is the density of filter_sample. */
double filter_eval(const Filter *f, double x, double y);

extern const FilterKind *const filters[];               /* ends with NULL */
#define FILTER_DEFAULT "box"

#endif
