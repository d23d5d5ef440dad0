/* splats.h -- light that lands on any pixel at any time: from methods that follow it from lamps, or
 * that move paths about the picture. Beside a film's samples, which belong to a pixel each.
 *
 * Where       A splat at a place x of the picture's plane adds w(x - c) of its light to each pixel
 *             whose centre c is near enough, w the pixel filter of integral 1: what the mean of the
 *             pixel's own samples would be, if these were drawn from w.
 * How much    Splats are the mean of so many shots, each of which may give many splats or none; so
 *             the expectation of a shot's splats is the picture.
 * Order       Sums are exact, as those of samples are: whose splat comes first is all the same.
 *             Locks, each of some tiles, let several threads splat at once. */
#ifndef IMAGE_SPLATS_H
#define IMAGE_SPLATS_H

#include "image/film.h"
#include "image/filter.h"

struct Splats {
    Exact   *sums;                      /* owned: [layer][pixel][3] */
    uint64_t shots;
    float   *gain;                      /* owned: of each pixel, or NULL: 1 */
    struct SplatLock *lock;             /* owned */
};

/* Gives the film room for splats in all its layers. False: reported. */
bool film_accepts_splats(Film *f);

/* Adds c to the layers whose bits are set, around a place in pixels from the top left of the whole
 * picture; what falls outside the window is nothing. Any number of threads at once. What is not
 * finite or too large is refused and counted. */
void film_splat(Film *f, const Filter *filter, V2 place, uint32_t layers, Rgb c);

/* There will be a splat around that place: fetches the sums of its pixel, which are hardly ever at
 * hand. */
void film_awaits_splat(const Film *f, V2 place);

/* So many shots more. By one thread at a time, while none splats. */
void film_shots(Film *f, uint64_t n);

/* From now on the mean of each pixel's splats is multiplied by its gain, an array that is the
 * film's then: for filters of noise. */
void film_multiply_splats(Film *f, float *gain);

/* ---- for film.c and filmstate.c; n: numbers of `sums` ---- */

void splats_save(const Splats *s, size_t n, Saving *to);
void splats_load(Splats *s, size_t n, Loading *from);
void splats_join(Splats *s, const Splats *other, size_t n);

void splats_free(Splats *s);                            /* s may be NULL */
/* Of sums 3 sum .. 3 sum + 2, which are those of the pixel. */
Rgb  splats_mean(const Splats *s, size_t sum, size_t pixel);
uint64_t splats_refused(const Splats *s, uint32_t *x, uint32_t *y);

#endif
