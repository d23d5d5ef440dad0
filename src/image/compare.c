/* compare.c -- image differences. See compare.h.
 *
 * Source      [Cline07]  4.6: colour difference (4.11), image difference (4.12), (4.13). The mean
 *             in (4.13) is that of the reference: the metric is not symmetric. 4.6.3: noise from
 *             two renders (4.14), (4.15).
 * All sums run in double, row by row, so a result does not depend on the machine. */
#include "image/compare.h"

#include "base/mem.h"
#include "base/statistics.h"

#include <math.h>
#include <string.h>

enum { TILE = 8 };
#define FLOAT_ULP 0x1p-24       /* relative rounding error of a float */

static double weighted(double r, double g, double b) { return 0.299 * r + 0.587 * g + 0.114 * b; }

static double luminance(Rgb c) { return weighted(c.r, c.g, c.b); }

static double ratio_of(double a, double b) { return b != 0.0 ? a / b : a != 0.0 ? INFINITY : 0.0; }

static bool same_size(const Image *a, const char *name_a, const Image *r, const char *name_r)
{
    if (a->w == r->w && a->h == r->h)
        return true;
    return err_at((Place){ name_a, 0, 0 }, "has %lu x %lu pixels, %lu x %lu as in %s were expected",
                  (unsigned long)a->w, (unsigned long)a->h, (unsigned long)r->w,
                  (unsigned long)r->h, name_r);
}

/* ---- figures over the pixels ---- */

typedef struct { double sigma2, square, relative, a, r; } Sums;

static void add_pixel(ImageDifference *d, Sums *s, Rgb a, Rgb r, uint32_t x, uint32_t y)
{
    const double va[3] = { a.r, a.g, a.b }, vr[3] = { r.r, r.g, r.b };
    double e[3], distance;

    for (int c = 0; c < 3; c++) {
        e[c] = fabs(va[c] - vr[c]);
        s->square += e[c] * e[c];
        s->relative += e[c] * e[c] / (vr[c] * vr[c] + 0.01);
        if (e[c] > d->max) {
            d->max = e[c];
            d->max_at = (PixelPlace){ x, y };
            d->max_channel = c;
        }
    }
    distance = weighted(e[0], e[1], e[2]);              /* [Cline07 (4.11)] */
    s->sigma2 += distance * distance;
    s->a += luminance(a);
    s->r += luminance(r);
    d->pixels++;
}

static void compare_pixels(ImageDifference *d, const Image *a, const Image *r)
{
    Sums s = { 0, 0, 0, 0, 0 };
    double n;

    for (uint32_t y = 0; y < a->h; y++)
        for (uint32_t x = 0; x < a->w; x++) {
            Rgb ca = *image_at(a, x, y), cr = *image_at(r, x, y);
            d->not_finite_a += !rgb_finite(ca);
            d->not_finite_r += !rgb_finite(cr);
            if (rgb_finite(ca) && rgb_finite(cr))
                add_pixel(d, &s, ca, cr, x, y);
        }
    if (d->pixels == 0) {
        d->sigma = d->sigma_over_mu = d->rmse = d->relmse = d->max = INFINITY;
        return;
    }
    n = (double)d->pixels;
    d->sigma = sqrt(s.sigma2 / n);                      /* [Cline07 (4.12)] */
    d->rmse = sqrt(s.square / (3 * n));
    d->relmse = s.relative / (3 * n);
    d->mean_a = s.a / n;
    d->mean_r = s.r / n;
    d->ratio = ratio_of(d->mean_a, d->mean_r);
    d->sigma_over_mu = ratio_of(d->sigma, fabs(d->mean_r));     /* [Cline07 (4.13)] */
}

/* ---- the z-test ---- */

typedef struct { uint32_t across, down; } Tiling;
typedef struct { PixelPlace at; double n, z; } Tile;    /* n: pixels compared */

static Tiling tiling_of(const Image *a)
{
    return (Tiling){ a->w < TILE ? 1 : a->w / TILE, a->h < TILE ? 1 : a->h / TILE };
}

/* Where tile k of a side with `n` pixels begins; the last one takes the rest. */
static uint32_t tile_begin(uint32_t k, uint32_t tiles, uint32_t n)
{
    return k < tiles ? k * TILE : n;
}

/* Tile k, row by row. False: fewer than two of its pixels are finite. The standard error is never
 * taken below the rounding of the floats themselves, so that a shift without any noise gives a
 * large number and not infinity. */
static bool tile_test(const Image *a, const Image *r, Tiling all, uint64_t k, Tile *t)
{
    uint32_t i = (uint32_t)(k % all.across), j = (uint32_t)(k / all.across);
    uint32_t x1 = tile_begin(i + 1, all.across, a->w), y1 = tile_begin(j + 1, all.down, a->h);
    double n = 0, mean = 0, scatter = 0, level = 0, error, least;

    t->at = (PixelPlace){ tile_begin(i, all.across, a->w), tile_begin(j, all.down, a->h) };
    for (uint32_t y = t->at.y; y < y1; y++)
        for (uint32_t x = t->at.x; x < x1; x++) {
            Rgb ca = *image_at(a, x, y), cr = *image_at(r, x, y);
            double v, step;
            if (!rgb_finite(ca) || !rgb_finite(cr))
                continue;
            v = luminance(ca) - luminance(cr);
            n++;                                        /* [Welford62] */
            step = v - mean;
            mean += step / n;
            scatter += step * (v - mean);
            level += fabs(luminance(ca)) + fabs(luminance(cr));
        }
    t->n = n;
    if (n < 2)
        return false;
    error = sqrt(scatter / (n - 1) / n);
    least = FLOAT_ULP * level / n;
    t->z = ratio_of(mean, error > least ? error : least);
    return true;
}

static void compare_tiles(ImageDifference *d, const Image *a, const Image *r)
{
    Tiling all = tiling_of(a);
    double sum = 0;
    Tile t;

    for (uint64_t k = 0; k < (uint64_t)all.across * all.down; k++) {
        if (!tile_test(a, r, all, k, &t))
            continue;
        d->tiles++;
        sum += t.z;
        if (fabs(t.z) > fabs(d->z_max)) {
            d->z_max = t.z;
            d->z_max_at = t.at;
        }
    }
    d->z_mean = d->tiles ? sum / (double)d->tiles : 0.0;
}

/* How many of the n claims "this tile does not differ" fall, p[] in order: the least falls if it
 * would be rare among n, the next if rare among n - 1, until one stands [Holm79]. */
static uint64_t holm_steps(const double *p, uint64_t n, double alpha)
{
    uint64_t k = 0;
    while (k < n && family_p(p[k], (double)(n - k)) <= alpha)
        k++;
    return k;
}

bool image_family_test(const Image *a, const char *name_a, const Image *r, const char *name_r,
                       double alpha, FamilyTest *f)
{
    Tiling all = tiling_of(a);
    uint64_t most = (uint64_t)all.across * all.down;
    double *p;
    Tile t;

    *f = (FamilyTest){ 0 };
    f->p = 1;
    if (!same_size(a, name_a, r, name_r))
        return false;
    p = MEM_ARRAY(double, (size_t)most);
    if (!p)
        return false;
    for (uint64_t k = 0; k < most; k++) {
        if (!tile_test(a, r, all, k, &t))
            continue;
        p[f->tiles] = student_p(t.z, t.n - 1);
        if (f->tiles == 0 || p[f->tiles] < f->p) {
            f->p = p[f->tiles];
            f->at = t.at;
            f->z = t.z;
        }
        f->tiles++;
    }
    f->p = f->tiles ? family_p(f->p, (double)f->tiles) : 1;
    sort_numbers(p, (size_t)f->tiles);
    f->differ = holm_steps(p, f->tiles, alpha);
    mem_free(p);
    return true;
}

bool image_compare(const Image *a, const char *name_a, const Image *r, const char *name_r,
                   ImageDifference *d)
{
    *d = (ImageDifference){ 0 };
    if (!same_size(a, name_a, r, name_r))
        return false;
    compare_pixels(d, a, r);
    compare_tiles(d, a, r);
    return true;
}

/* ---- two renders and no reference ---- */

bool image_noise(const Image *a, const char *name_a, const Image *b, const char *name_b,
                 ImageNoise *e)
{
    size_t n = (size_t)a->w * a->h;
    double sigma2 = 0, relative = 0;

    *e = (ImageNoise){ 0, INFINITY, INFINITY, INFINITY, 0, 0 };
    if (!same_size(a, name_a, b, name_b))
        return false;
    for (size_t i = 0; i < n; i++) {
        Rgb ca = a->pixels[i], cb = b->pixels[i];
        const double va[3] = { ca.r, ca.g, ca.b }, vb[3] = { cb.r, cb.g, cb.b };
        double d[3], distance;
        if (!rgb_finite(ca) || !rgb_finite(cb))
            continue;
        for (int c = 0; c < 3; c++) {
            double m = 0.5 * (va[c] + vb[c]);
            d[c] = fabs(va[c] - vb[c]);
            relative += 0.5 * d[c] * d[c] / (m * m + 0.01);
        }
        distance = weighted(d[0], d[1], d[2]);
        sigma2 += 0.5 * distance * distance;            /* [Cline07 (4.14)] */
        e->mean_a += luminance(ca);
        e->mean_b += luminance(cb);
        e->pixels++;
    }
    if (!e->pixels)
        return true;
    e->mean_a /= (double)e->pixels;
    e->mean_b /= (double)e->pixels;
    e->sigma = sqrt(sigma2 / (double)e->pixels);        /* [Cline07 (4.15)] */
    e->sigma_over_mu = ratio_of(e->sigma, fabs(0.5 * (e->mean_a + e->mean_b)));
    e->relmse = relative / (3 * (double)e->pixels);
    return true;
}

/* ---- the picture ---- */

static Rgb difference_of(Rgb a, Rgb r, DifferenceStyle style, double scale)
{
    double v;

    if (!rgb_finite(a) || !rgb_finite(r))
        return rgb(0, 1, 0);
    if (style == DIFFERENCE_ABSOLUTE)
        return rgb((float)(scale * fabs((double)a.r - r.r)),
                   (float)(scale * fabs((double)a.g - r.g)),
                   (float)(scale * fabs((double)a.b - r.b)));
    v = scale * (luminance(a) - luminance(r));
    return v > 0 ? rgb((float)v, 0, 0) : rgb(0, 0, (float)-v);
}

bool image_difference(const Image *a, const char *name_a, const Image *r, const char *name_r,
                      DifferenceStyle style, double scale, Image *out)
{
    size_t n = (size_t)a->w * a->h;

    memset(out, 0, sizeof *out);
    if (!same_size(a, name_a, r, name_r) || !image_init(out, a->w, a->h))
        return false;
    for (size_t i = 0; i < n; i++)
        out->pixels[i] = difference_of(a->pixels[i], r->pixels[i], style, scale);
    return true;
}
