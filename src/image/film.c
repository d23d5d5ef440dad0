/* film.c -- exact sums of samples. See film.h.
 *
 * Noise       What is the variance V(n) of a pixel's mean of n samples that are not independent? Of
 *             a block of 2^k samples in two halves with means a, b, the mean is (a + b)/2, and Q(k)
 *             = (a - b)^2/4 has, as var(a) = var(b) = V(2^(k-1)), the expectation
 *                 E[Q(k)] = V(2^(k-1)) - V(2^k),
 *             however the halves depend on each other. V falls to nothing in the end, so V(2^k) is
 *             the sum of all E[Q] to come. With V ~ n^-a each of those is r = 2^-a of the one
 *             before: V(2^k) = E[Q(k)] r / (1 - r). For independent samples r = 1/2 and V = E[Q],
 *             half the squared difference of two halves over two, as [Cline07 (4.15)] has it; along
 *             edges, in strata, 0.354 and 0.547 Q, [Cline07 4.5.2]. r comes from the picture: Q(k)
 *             of all pixels over Q(k-2) is r^2. It is kept between these two: where the first few
 *             samples do better than along edges, what is left does not. The mean of the first half
 *             is kept when it ends: Q(k) = (mean of all - that)^2.
 * Few pixels  Q has one degree of freedom a pixel. The plain variance of the samples has more, but
 *             is too high: it is given the weight of 4 pixels.
 * Counts      Between powers of two V falls as 1/n. */
#include "image/film.h"

#include "base/bits.h"
#include "base/mem.h"
#include "image/splats.h"

#include <string.h>

enum { FRACTION_BITS = 60, MOST_EXPONENT = 60 };
static const double DECAY_OF_EDGES = 0.35355339;        /* 2^-1.5 */
enum { PLAIN_WEIGHT = 4 };              /* pixels that the plain variance counts as */

bool exact_add(Exact *e, float v)
{
    uint32_t bits = bits_of_float(v);
    uint64_t m, lo, hi, old = e->lo;
    int shift;

    if ((bits & 0x7FFFFFFFu) == 0)
        return true;
    /* v = m 2^(exponent - 150); in units of 2^-60 it is m 2^shift */
    shift = (int)(bits >> 23 & 255) - 150 + FRACTION_BITS;
    m = (bits & 0x7FFFFFu) | 0x800000u;
    if (shift > MOST_EXPONENT - 24 + FRACTION_BITS)
        return false;                           /* too large, infinite or not a number */
    if (shift < -24)
        return true;                            /* below half a unit (denormals too) */
    if (shift < 0) {
        lo = (m + ((uint64_t)1 << (-shift - 1))) >> -shift;
        hi = 0;
    } else if (shift < 64) {
        lo = m << shift;
        hi = shift ? m >> (64 - shift) : 0;
    } else {
        lo = 0;
        hi = m << (shift - 64);
    }
    if (bits >> 31) {                           /* subtract */
        e->lo -= lo;
        e->hi -= hi + (e->lo > old);
    } else {
        e->lo += lo;
        e->hi += hi + (e->lo < old);
    }
    return true;
}

void exact_join(Exact *e, const Exact *other)
{
    e->lo += other->lo;
    e->hi += other->hi + (e->lo < other->lo);
}

/* The magnitude first, so that small negative sums keep their digits. */
double exact_value(const Exact *e)
{
    bool negative = e->hi >> 63;
    uint64_t lo = e->lo, hi = e->hi;
    double v;

    if (negative) {
        lo = ~lo + 1;
        hi = ~hi + (lo == 0);
    }
    v = (double)hi * 16.0 + (double)lo * 0x1p-60;
    return negative ? -v : v;
}

bool film_init(Film *f, uint32_t full_w, uint32_t full_h, const uint32_t crop[4], int layers)
{
    size_t n;

    memset(f, 0, sizeof *f);
    f->full_w = full_w;
    f->full_h = full_h;
    f->x0 = crop[0];
    f->y0 = crop[1];
    f->x1 = crop[2];
    f->y1 = crop[3];
    f->w = f->x1 - f->x0;
    f->h = f->y1 - f->y0;
    f->tiles_x = (f->w + FILM_TILE - 1) / FILM_TILE;
    f->tiles_y = (f->h + FILM_TILE - 1) / FILM_TILE;
    f->layers = layers;
    n = (size_t)f->w * f->h;
    if (n > SIZE_MAX / sizeof(Exact) / 3 / (size_t)layers)
        return err_memory(SIZE_MAX);
    f->sums = MEM_ARRAY(Exact, n * 3 * (size_t)layers);
    f->counts = MEM_ARRAY(uint32_t, n);
    f->marks = MEM_ARRAY(float, n * FILM_MARKS);
    f->tiles = MEM_ARRAY(TileStats, film_ntiles(f));
    if (f->sums && f->counts && f->marks && f->tiles)
        return true;
    film_clear(f);
    return false;
}

void film_clear(Film *f)
{
    mem_free(f->sums);
    mem_free(f->counts);
    mem_free(f->marks);
    mem_free(f->tiles);
    splats_free(f->splats);
    memset(f, 0, sizeof *f);
}

void film_tile(const Film *f, uint32_t k, uint32_t *x0, uint32_t *y0, uint32_t *x1, uint32_t *y1)
{
    *x0 = f->x0 + k % f->tiles_x * FILM_TILE;
    *y0 = f->y0 + k / f->tiles_x * FILM_TILE;
    *x1 = f->x1 - *x0 > FILM_TILE ? *x0 + FILM_TILE : f->x1;
    *y1 = f->y1 - *y0 > FILM_TILE ? *y0 + FILM_TILE : f->y1;
}

/* Whether exact_add would take it: by the exponent alone. */
static bool fits(float v)
{
    return (int)(bits_of_float(v) >> 23 & 255) - 150 <= MOST_EXPONENT - 24;
}

bool film_takes(Rgb c) { return fits(c.r) && fits(c.g) && fits(c.b); }

static void add_layer(Exact *sum, Rgb c)
{
    exact_add(&sum[0], c.r);
    exact_add(&sum[1], c.g);
    exact_add(&sum[2], c.b);
}

static double mean_luminance(const Film *f, size_t pixel)
{
    const Exact *s = f->sums + pixel * 3;
    double c = f->counts[pixel] ? f->counts[pixel] : 1;
    return (0.299 * exact_value(&s[0]) + 0.587 * exact_value(&s[1]) +
            0.114 * exact_value(&s[2])) / c;
}

INLINE bool power_of_two(uint32_t n) { return (n & (n - 1)) == 0; }

/* Floor of the binary logarithm, n > 0. */
static int log2_of(uint32_t n)
{
    int k = 0;
    while (n >>= 1)
        k++;
    return k;
}

static TileStats *tile_of(const Film *f, uint32_t x, uint32_t y)
{
    return &f->tiles[(y - f->y0) / FILM_TILE * f->tiles_x + (x - f->x0) / FILM_TILE];
}

void film_add(Film *f, uint32_t x, uint32_t y, uint32_t index, const Rgb *values)
{
    size_t pixel = film_pixel(f, x, y), n = (size_t)f->w * f->h;
    TileStats *t = tile_of(f, x, y);
    bool all_good = true;
    double lum;

    for (int k = 0; k < f->layers; k++) {
        if (LIKELY(film_takes(values[k])))
            add_layer(f->sums + ((size_t)k * n + pixel) * 3, values[k]);
        else
            all_good = false;
    }
    f->counts[pixel]++;
    t->samples++;
    if (UNLIKELY(power_of_two(f->counts[pixel]) && !f->splats))
        f->marks[pixel * FILM_MARKS + (size_t)(log2_of(f->counts[pixel]) % FILM_MARKS)] =
            (float)mean_luminance(f, pixel);
    if (UNLIKELY(!all_good)) {
        if (!t->refused++) {
            t->bad_x = x;
            t->bad_y = y;
            t->bad_index = index;
        }
        if (!film_takes(values[0]))
            return;
    }
    lum = rgb_lum(values[0]);
    t->sum += lum;
    t->squares += lum * lum;
}

static Rgb value_of(const Film *f, int layer, size_t pixel)
{
    size_t at = (size_t)layer * f->w * f->h + pixel;
    const Exact *s = f->sums + at * 3;
    double count = f->counts[pixel] ? f->counts[pixel] : 1;
    Rgb c = { (float)(exact_value(&s[0]) / count), (float)(exact_value(&s[1]) / count),
              (float)(exact_value(&s[2]) / count) };

    return f->splats ? rgb_add(c, splats_mean(f->splats, at, pixel)) : c;
}

void film_picture(const Film *f, int layer, Image *im)
{
    size_t n = (size_t)f->w * f->h;

    for (size_t i = 0; i < n; i++)
        im->pixels[i] = value_of(f, layer, i);
}

void film_pass(Film *f)
{
    int k;

    if (!power_of_two(++f->passes))
        return;
    k = log2_of(f->passes);
    for (size_t i = 0; i < (size_t)f->w * f->h; i++)
        f->marks[i * FILM_MARKS + (size_t)(k % FILM_MARKS)] = rgb_lum(value_of(f, 0, i));
}

uint64_t film_samples(const Film *f)
{
    uint64_t n = 0;
    for (uint32_t k = 0; k < film_ntiles(f); k++)
        n += f->tiles[k].samples;
    return n;
}

uint64_t film_refused(const Film *f, uint32_t *x, uint32_t *y, uint32_t *index)
{
    uint64_t n = 0;
    for (uint32_t k = 0; k < film_ntiles(f); k++) {
        const TileStats *t = &f->tiles[k];
        if (t->refused && !n) {
            *x = t->bad_x;
            *y = t->bad_y;
            *index = t->bad_index;
        }
        n += t->refused;
    }
    if (f->splats) {
        uint32_t sx, sy;
        uint64_t more = splats_refused(f->splats, &sx, &sy);
        if (more && !n) {
            *x = sx;
            *y = sy;
            *index = 0;
        }
        n += more;
    }
    return n;
}

void film_drop(Film *f, uint32_t x, uint32_t y, double sum, double squares)
{
    size_t pixel = film_pixel(f, x, y), n = (size_t)f->w * f->h;
    TileStats *t = tile_of(f, x, y);

    for (int k = 0; k < f->layers; k++)
        memset(f->sums + ((size_t)k * n + pixel) * 3, 0, 3 * sizeof *f->sums);
    t->samples -= f->counts[pixel];
    t->sum -= sum;
    t->squares -= squares;
    f->counts[pixel] = 0;
}

void film_counts(const Film *f, Image *im)
{
    for (size_t i = 0; i < (size_t)f->w * f->h; i++)
        im->pixels[i] = rgb_all((float)f->counts[i]);
}

/* ---- noise ---- */

/* Q of the pixel's block of 2^k samples. */
static double block_q(const Film *f, size_t pixel, int k)
{
    const float *m = f->marks + pixel * FILM_MARKS;
    double d = (double)m[k % FILM_MARKS] - (double)m[(k - 1) % FILM_MARKS];
    return d * d;
}

/* Of a component. Of one sample nobody knows: its own square, as large as it may be. */
static float variance_of(const Exact *sum, const Exact *squares, uint32_t n)
{
    double mean, v;

    if (n < 2)
        return (float)exact_value(squares);
    mean = exact_value(sum) / n;
    v = (exact_value(squares) / n - mean * mean) / (n - 1);
    return v > 0 ? (float)v : 0.0f;
}

static float variance_of_passes(const Film *f, size_t pixel)
{
    int k = f->passes ? log2_of(f->passes) : 0;
    double q = k ? block_q(f, pixel, k) : f_sqr(rgb_lum(value_of(f, 0, pixel)));

    return (float)(q * (k ? (double)((uint32_t)1 << k) / f->passes : 1));
}

void film_variance(const Film *f, int layer, int squares, Image *im)
{
    size_t n = (size_t)f->w * f->h;

    for (size_t i = 0; i < n; i++) {
        const Exact *a = f->sums + ((size_t)layer * n + i) * 3;
        const Exact *b = f->sums + ((size_t)squares * n + i) * 3;
        im->pixels[i] = f->splats ? rgb_all(variance_of_passes(f, i))
                                  : rgb(variance_of(&a[0], &b[0], f->counts[i]),
                                        variance_of(&a[1], &b[1], f->counts[i]),
                                        variance_of(&a[2], &b[2], f->counts[i]));
    }
}

/* Variance of the pixels' means, summed, from the spread of the samples within pixels: of each tile
 * the pooled variance of a sample, [squares - n mean^2] / [n - 1], over the samples of each pixel.
 * Adds the means up in *mean. False: a pixel has less than two samples. */
static bool plain_variance(const Film *f, double *variance, double *mean)
{
    *variance = *mean = 0;
    for (uint32_t k = 0; k < film_ntiles(f); k++) {
        uint32_t x0, y0, x1, y1;
        double within = f->tiles[k].squares, degrees = 0, shares = 0;
        film_tile(f, k, &x0, &y0, &x1, &y1);
        for (uint32_t y = y0; y < y1; y++)
            for (uint32_t x = x0; x < x1; x++) {
                size_t i = film_pixel(f, x, y);
                double c = f->counts[i], m = mean_luminance(f, i);
                if (c < 2)
                    return false;
                within -= m * m * c;
                degrees += c - 1;
                shares += 1 / c;
                *mean += m;
            }
        *variance += within > 0 ? within / degrees * shares : 0;
    }
    return true;
}

double film_decay(double last, double before)
{
    double r = before > 0 ? sqrt(last / before) : 0.5;
    return r < DECAY_OF_EDGES ? DECAY_OF_EDGES : r > 0.5 ? 0.5 : r;
}

/* The variance of the pixels' means, summed, from the means of blocks; every pixel has two samples,
 * or there were two passes. */
static double block_variance(const Film *f)
{
    double sum = 0, last = 0, before = 0;

    for (size_t i = 0; i < (size_t)f->w * f->h; i++) {
        uint32_t n = f->splats ? f->passes : f->counts[i];
        int k = log2_of(n);
        double q = block_q(f, i, k);
        sum += q * (double)((uint32_t)1 << k) / n;
        if (k >= 3) {
            last += q;
            before += block_q(f, i, k - 2);
        }
    }
    return sum * film_left(film_decay(last, before));
}

double film_error_independent(const Film *f)
{
    double variance, mean, pixels = (double)f->w * f->h;

    if (!plain_variance(f, &variance, &mean))
        return INFINITY;
    return mean > 0 && variance > 0 ? sqrt(variance * pixels) / mean : 0;
}

/* Of a film with splats, which nobody can tell apart. */
static double error_of_passes(const Film *f)
{
    double mean = 0, variance, pixels = (double)f->w * f->h;

    if (f->passes < 2)
        return INFINITY;
    for (size_t i = 0; i < (size_t)f->w * f->h; i++)
        mean += rgb_lum(value_of(f, 0, i));
    variance = block_variance(f);
    return mean > 0 && variance > 0 ? sqrt(variance * pixels) / mean : 0;
}

double film_error(const Film *f)
{
    double plain, mean, blocks, pixels = (double)f->w * f->h;

    if (f->splats)
        return error_of_passes(f);
    if (!plain_variance(f, &plain, &mean))
        return INFINITY;
    blocks = block_variance(f);
    plain = (blocks * pixels + plain * PLAIN_WEIGHT) / (pixels + PLAIN_WEIGHT);
    return mean > 0 && plain > 0 ? sqrt(plain * pixels) / mean : 0;
}
