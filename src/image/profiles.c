/* profiles.c -- the pixel filters: their list, and what each is along one axis. See filter.h. */
#include "image/filter.h"
#include "sampling/warp.h"

#define RADII_TO(most) \
    { .key = "xradius", .type = OPT_FLOAT, .num = 0, .lo = 0, .hi = most, .also = "xwidth", \
      .help = "half width in pixels; 0: the usual one" }, \
    { .key = "yradius", .type = OPT_FLOAT, .num = 0, .lo = 0, .hi = most, .also = "ywidth", \
      .help = "half height in pixels; 0: the usual one" }
#define RADII RADII_TO(100)
static const OptDef radii[] = { RADII, { .key = NULL } };

/* ---- the family that has all conditions, errata 001.1: a(x) + a(1 - x) = 1 over 1 pixel ---- */

static double box(const Filter *f, double x, double r)
{
    (void)f;
    (void)x;
    (void)r;
    return 1;
}
static float box_inverse(float u) { return 2.0f * u - 1.0f; }

static const FilterKind filter_box = {
    .info = { "box", "Shirley91 5.1", "all of the pixel alike", radii },
    .fails = "", .radius = 0.5, .profile = box, .inverse = box_inverse
};

static double triangle(const Filter *f, double x, double r)
{
    (void)f;
    return 1 - x / r;
}

static const FilterKind filter_triangle = {
    .info = { "triangle", "Shirley91 5.1, (5.9)", "a tent over two pixels: smoother edges", radii },
    .fails = "", .radius = 1, .profile = triangle, .inverse = warp_tent
};

/* (1 - x) (1 - A x (x - 1/2)), which is negative nowhere for A from -16 to 2. */
static double cubic(const Filter *f, double x, double r)
{
    x /= r;
    return (1 - x) * (1 - f->a * x * (x - 0.5));
}
static void cubic_init(Filter *f, const Opts *o) { f->a = opt_float(o, "a"); }

static const OptDef cubic_options[] = {
    RADII,
    { .key = "a", .type = OPT_FLOAT, .num = 2, .lo = -16, .hi = 2,
      .help = "2: smooth at its ends; 0: the tent" },
    { .key = NULL }
};
static const FilterKind filter_cubic = {
    .info = { "cubic", "Shirley91 5.1", "cubics over two pixels: the tent and its kin",
              cubic_options },
    .fails = "", .radius = 1, .profile = cubic, .init = cubic_init
};

/* Three cosines, of 1, 2 and 3 periods over the width: over a width of four pixels or more whole
 * ones each adds up to 0 on any grid, hence condition 5; the least value is 6e-5. */
static double blackmanharris(const Filter *f, double x, double r)
{
    double c = md_cos(PI * (x / r)), c2 = 2 * c * c - 1, c3 = c * (2 * c2 - 1);
    (void)f;
    return 0.35875 + 0.48829 * c + 0.14128 * c2 + 0.01168 * c3;
}

static const FilterKind filter_blackmanharris = {
    .info = { "blackmanharris", "Harris78", "three cosines over four pixels: like a Gaussian",
              radii },
    .fails = "", .radius = 2, .profile = blackmanharris
};

/* ---- others ---- */

/* Less its value at the end, so that it ends at 0. [PBRT4 8.8] */
static double gaussian(const Filter *f, double x, double r)
{
    return md_exp(-x * x * f->a) - md_exp(-r * r * f->a);
}
static void gaussian_init(Filter *f, const Opts *o)
{
    double sigma = opt_float(o, "sigma");
    f->a = opt_given(o, "alpha") ? (double)opt_float(o, "alpha") : 0.5 / (sigma * sigma);
    f->reach = sqrt(36 / f->a);         /* e^-36 there, below the roundings of 1 */
}

static const OptDef gaussian_options[] = {
    RADII,
    { .key = "sigma", .type = OPT_FLOAT, .num = 0.5, .lo = 0.05, .hi = 100,
      .help = "standard deviation, pixels" },
    { .key = "alpha", .type = OPT_FLOAT, .num = 2, .lo = 1e-4, .hi = 200,
      .help = "1 / (2 sigma^2), if given" },
    { .key = NULL }
};
static const FilterKind filter_gaussian = {
    .info = { "gaussian", "PBRT4 8.8.3", "a Gaussian, cut off", gaussian_options },
    .fails = "5 (thin things twinkle a little as they move)", .radius = 1.5, .profile = gaussian,
    .init = gaussian_init
};

/* Piecewise cubic over four pixels; its two parameters stand on the line B + 2 C = 1 where it is
 * best. B = 1, C = 0 is the cubic spline, which has no negative place. [Mitchell88 (8)] */
static double mitchell(const Filter *f, double x, double r)
{
    double b = f->a, c = f->b;
    x = 2 * x / r;
    if (x < 1)
        return ((12 - 9 * b - 6 * c) * x + (-18 + 12 * b + 6 * c)) * (x * x) + (6 - 2 * b);
    return (((-b - 6 * c) * x + (6 * b + 30 * c)) * x + (-12 * b - 48 * c)) * x + (8 * b + 24 * c);
}
static void mitchell_init(Filter *f, const Opts *o)
{
    f->a = opt_float(o, "B");
    f->b = opt_float(o, "C");
}

static const OptDef mitchell_options[] = {
    RADII,
    { .key = "B", .type = OPT_FLOAT, .num = 1.0 / 3, .lo = -10, .hi = 10,
      .help = "blur; with B=1,C=0, the cubic spline, all conditions are met" },
    { .key = "C", .type = OPT_FLOAT, .num = 1.0 / 3, .lo = -10, .hi = 10,
      .help = "sharpness, and ringing" },
    { .key = NULL }
};
static const FilterKind filter_mitchell = {
    .info = { "mitchell", "Mitchell88", "sharp, with some ringing; needs more samples",
              mitchell_options },
    .fails = "4 (negative places)", .radius = 2, .profile = mitchell, .init = mitchell_init
};

static double sinc(double x) { return x < 1e-5 ? 1 : md_sin(PI * x) / (PI * x); }

/* The ideal one, cut off by the middle lobe of another. [PBRT4 8.8.5] */
static double windowed_sinc(const Filter *f, double x, double r)
{
    (void)r;
    return sinc(x) * sinc(x / f->a);
}
static void sinc_init(Filter *f, const Opts *o) { f->a = opt_float(o, "tau"); }

static const OptDef sinc_options[] = {
    RADII_TO(16),               /* with up to 32 changes of sign: see filter.h */
    { .key = "tau", .type = OPT_FLOAT, .num = 3, .lo = 1, .hi = 100,
      .help = "lobes within the window" },
    { .key = NULL }
};
static const FilterKind filter_sinc = {
    .info = { "sinc", "PBRT4 8.8.5", "a windowed sinc: sharpest, rings; needs many more samples",
              sinc_options },
    .fails = "4 (negative places), 5", .radius = 4, .profile = windowed_sinc, .init = sinc_init
};

const FilterKind *const filters[] = {
    &filter_box, &filter_triangle, &filter_cubic, &filter_blackmanharris, &filter_gaussian,
    &filter_mitchell, &filter_sinc, NULL
};
