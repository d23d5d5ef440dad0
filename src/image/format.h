/* format.h -- what the file formats share: the size check that stands before any memory is taken,
 * and the step between linear floats and the bytes of display formats. */
#ifndef IMAGE_FORMAT_H
#define IMAGE_FORMAT_H

#include "image/image.h"

/* False, reported at `at`: no pixels, a side of 2^31 or more, or more than max_pixels in all. */
bool image_size_fits(Place at, int64_t w, int64_t h, uint64_t max_pixels);

/* A sample in [0,1] made linear; by sRGB where it is left to the file. */
float sample_decode(float x, Encoding encoding);
/* table[v] = sample_decode(v / most) for v = 0 .. most. */
void sample_table(float *table, unsigned most, Encoding encoding);

/* Turns linear colours into display bytes. Byte b stands for from[b] <= x < from[b + 1], where
 * from[b] is what the sRGB curve maps to b - 1/2: the same as rounding the curve, but decided by
 * comparisons only, and a byte that was read back comes out the same. */
typedef struct {
    const ToneMap *tonemap;     /* borrowed; NULL: none, the thresholds clamp */
    float gain;                 /* 2^exposure */
    float from[256];            /* from[0] is not used: nothing is below black */
} Quantiser;

/* display NULL: as it is, clamped. */
void quantiser_init(Quantiser *q, const Display *display);
/* n colours to 3 n bytes. What is not a number counts as 0, infinity as the largest float. */
void quantiser_row(const Quantiser *q, const Rgb *row, size_t n, unsigned char *bytes);

#endif
