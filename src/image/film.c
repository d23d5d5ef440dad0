/* film.c -- exact sums of samples. See film.h. */
#include "image/film.h"

#include "base/mem.h"

#include <string.h>

enum { FRACTION_BITS = 60, MOST_EXPONENT = 60 };

bool exact_add(Exact *e, float v)
{
    uint32_t bits;
    uint64_t m, lo, hi, old = e->lo;
    int shift;

    memcpy(&bits, &v, 4);
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
    f->tiles = MEM_ARRAY(TileStats, film_ntiles(f));
    if (f->sums && f->counts && f->tiles)
        return true;
    film_clear(f);
    return false;
}

void film_clear(Film *f)
{
    mem_free(f->sums);
    mem_free(f->counts);
    mem_free(f->tiles);
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
    uint32_t bits;
    memcpy(&bits, &v, 4);
    return (int)(bits >> 23 & 255) - 150 <= MOST_EXPONENT - 24;
}

static bool good(Rgb c) { return fits(c.r) && fits(c.g) && fits(c.b); }

static void add_layer(Exact *sum, Rgb c)
{
    exact_add(&sum[0], c.r);
    exact_add(&sum[1], c.g);
    exact_add(&sum[2], c.b);
}

void film_add(Film *f, uint32_t x, uint32_t y, uint32_t index, const Rgb *values)
{
    size_t pixel = film_pixel(f, x, y), n = (size_t)f->w * f->h;
    TileStats *t = &f->tiles[(y - f->y0) / FILM_TILE * f->tiles_x + (x - f->x0) / FILM_TILE];
    bool all_good = true;
    double lum;

    for (int k = 0; k < f->layers; k++) {
        if (LIKELY(good(values[k])))
            add_layer(f->sums + ((size_t)k * n + pixel) * 3, values[k]);
        else
            all_good = false;
    }
    f->counts[pixel]++;
    t->samples++;
    if (UNLIKELY(!all_good)) {
        if (!t->refused++) {
            t->bad_x = x;
            t->bad_y = y;
            t->bad_index = index;
        }
        if (!good(values[0]))
            return;
    }
    lum = rgb_lum(values[0]);
    t->sum += lum;
    t->squares += lum * lum;
}

void film_picture(const Film *f, int layer, Image *im)
{
    size_t n = (size_t)f->w * f->h;
    const Exact *s = f->sums + (size_t)layer * n * 3;

    for (size_t i = 0; i < n; i++, s += 3) {
        double count = f->counts[i] ? f->counts[i] : 1;
        im->pixels[i] = rgb((float)(exact_value(&s[0]) / count),
                            (float)(exact_value(&s[1]) / count),
                            (float)(exact_value(&s[2]) / count));
    }
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
    return n;
}

/* Mean over pixels of (variance within the pixel / samples of the pixel), by luminance:
 * sum of squares less n times the squared mean is (n - 1) times the variance. */
double film_error(const Film *f)
{
    double within = 0, mean = 0, pixels = (double)f->w * f->h;
    uint64_t samples = film_samples(f);
    double n = (double)samples / pixels;

    if (n < 2)
        return INFINITY;
    for (uint32_t k = 0; k < film_ntiles(f); k++)
        within += f->tiles[k].squares;
    for (size_t i = 0; i < (size_t)f->w * f->h; i++) {
        const Exact *s = f->sums + i * 3;
        double c = f->counts[i] ? f->counts[i] : 1;
        double m = (0.299 * exact_value(&s[0]) + 0.587 * exact_value(&s[1]) +
                    0.114 * exact_value(&s[2])) / c;
        within -= m * m * f->counts[i];
        mean += m;
    }
    mean /= pixels;
    if (!(mean > 0) || !(within > 0))
        return 0;
    return sqrt(within / ((n - 1) * pixels) / n) / mean;
}
