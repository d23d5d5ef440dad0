/* format.h -- what the file formats share: the size check that stands before any memory is taken,
 * and the step between linear floats and the bytes of display formats. */
#ifndef IMAGE_FORMAT_H
#define IMAGE_FORMAT_H

#include "image/tonemap.h"

/* False, reported at `at`: no pixels, a side of 2^31 or more, or more than max_pixels in all. */
bool image_size_fits(Place at, int64_t w, int64_t h, uint64_t max_pixels);

/* A sample in [0,1] made linear; by sRGB where it is left to the file. */
float sample_decode(float x, Encoding encoding);
/* table[v] = sample_decode(v / most) for v = 0 .. most. */
void sample_table(float *table, unsigned most, Encoding encoding);

/* Turns linear colours into display bytes. Byte b stands for from[b] <= x < from[b + 1], where
 * from[b] is what the sRGB curve maps to b - 1/2: the same as rounding the curve, but decided by
 * comparisons only, and a byte that was read back comes out the same. Dithered, the curve's value
 * is rounded up at some places and down at others, as many as make the mean right. */
typedef struct {
    Tone  tone;
    bool  dither;
    float from[256];            /* from[0] is not used: nothing is below black */
} Quantiser;

/* display NULL: as it is, clamped. False: out of memory, reported, nothing held. */
bool quantiser_init(Quantiser *q, const Display *display, const Image *im);
void quantiser_clear(Quantiser *q);
/* Row y of the picture to 3 w bytes. */
void quantiser_row(const Quantiser *q, uint32_t y, unsigned char *bytes);

#endif
