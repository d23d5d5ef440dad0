/* film.h -- where samples add up.
 *
 * Sums are exact: a pixel holds a fixed-point number of 128 bits, so adding is associative, and a
 * picture does not depend on the order of samples, units, threads or shards. A unit in the last
 * place is 2^-60; a value may be as large as 2^60, so a float of usual size is added to 24 bits and
 * one of 1e-12 still to 20. What is not finite or larger than that is refused and counted. */
#ifndef IMAGE_FILM_H
#define IMAGE_FILM_H

#include "image/image.h"

/* value = (hi 2^64 + lo) 2^-60, two's complement */
typedef struct { uint64_t lo, hi; } Exact;

bool   exact_add(Exact *e, float v);    /* false: v is not finite or too large; *e unchanged */
void   exact_join(Exact *e, const Exact *other);
double exact_value(const Exact *e);

typedef struct Splats Splats;

enum { FILM_TILE = 16 };                /* side of a tile, pixels */
enum { FILM_MARKS = 4 };                /* blocks of samples that are remembered */

/* Statistics of a tile's samples, by luminance. Added to by one thread at a time. */
typedef struct {
    double   sum, squares;
    uint64_t samples, refused;
    uint32_t bad_x, bad_y, bad_index;   /* the first one refused: pixel and sample */
} TileStats;

/* The window [x0, x1) x [y0, y1) of a picture of full_w x full_h. Layer 0 is the picture; others
 * are whatever the caller calls them. */
typedef struct {
    uint32_t full_w, full_h, x0, y0, x1, y1, w, h;
    uint32_t tiles_x, tiles_y;
    int      layers;
    Exact   *sums;                      /* owned: [layer][pixel][3] */
    uint32_t *counts;                   /* owned: samples of each pixel */
    float   *marks;                     /* owned: [pixel][FILM_MARKS]; entry k % FILM_MARKS is the
                                         * luminance of the mean of the pixel's first 2^k samples */
    TileStats *tiles;                   /* owned */
    Splats  *splats;                    /* owned: see splats.h; NULL: it takes none. With them: */
    uint32_t passes;                    /* over the whole picture, whose blocks `marks` are of */
} Film;

/* False: reported, nothing held. layers >= 1. */
bool film_init(Film *f, uint32_t full_w, uint32_t full_h, const uint32_t crop[4], int layers);
void film_clear(Film *f);

/* Pixels of tile k, in picture coordinates: half open. */
void film_tile(const Film *f, uint32_t k, uint32_t *x0, uint32_t *y0, uint32_t *x1, uint32_t *y1);
INLINE uint32_t film_ntiles(const Film *f) { return f->tiles_x * f->tiles_y; }
INLINE size_t film_pixel(const Film *f, uint32_t x, uint32_t y)
{
    return (size_t)(y - f->y0) * f->w + (x - f->x0);
}

/* Whether it would take that: finite and not too large. */
bool film_takes(Rgb c);
/* One camera sample of pixel (x, y): values[layer]. A sample with any bad value counts as black in
 * the layer that has it, and is recorded. index: the sample's number, for messages. */
void film_add(Film *f, uint32_t x, uint32_t y, uint32_t index, const Rgb *values);

void film_picture(const Film *f, int layer, Image *im);         /* im has the window's size */
uint64_t film_samples(const Film *f);
uint64_t film_refused(const Film *f, uint32_t *x, uint32_t *y, uint32_t *index);
/* Takes back all samples of pixel (x, y), whose luminances add up to sum, their squares to squares:
 * for those who render a pixel again. */
void film_drop(Film *f, uint32_t x, uint32_t y, double sum, double squares);
/* Samples of each pixel, as a grey picture of the window's size. */
void film_counts(const Film *f, Image *im);

/* Variance of the mean of each pixel of a layer, whose samples' squares are in layer `squares`; of
 * a film with splats, from two halves of its passes, grey, of the picture. */
void film_variance(const Film *f, int layer, int squares, Image *im);

/* A film with splats has had one whole pass more: a mean of passes is what its picture is then. */
void film_pass(Film *f);

/* Estimated sigma/mu of the picture's noise, [Cline07 (4.13)]. Infinity before every pixel has two
 * samples. The first is for every sampler and any counts: from how far the means of whole blocks of
 * 2^k samples (with splats: of passes) lie apart, and how fast that falls with k (see film.c). The
 * second is for independent samples, of which it is the sharper estimate; of stratified ones it is
 * too high, and of splats it knows nothing. */
double film_error(const Film *f);
double film_error_independent(const Film *f);

/* How variance falls from block to block twice as long: the share r that is left, and the variance
 * of a block's mean as a multiple of Q. last, before: sums over the same pixels of Q for blocks of
 * 2^k and of 2^(k-2) samples; 0, 0: nobody knows. */
double film_decay(double last, double before);
INLINE double film_left(double r) { return r / (1 - r); }

#endif
