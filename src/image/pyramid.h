/* pyramid.h -- looking up a picture between its pixels, and in smaller copies of itself. */
#ifndef IMAGE_PYRAMID_H
#define IMAGE_PYRAMID_H

#include "image/image.h"

typedef enum { WRAP_REPEAT, WRAP_CLAMP, WRAP_BLACK } Wrap;      /* what is beyond the edges */

/* Each level is the one before at half its size, rounded up; the last one is a single pixel. */
typedef struct {
    const Image *base;          /* borrowed: level 0 */
    Image *level;               /* owned: 1 and on */
    int n;                      /* of these */
} Pyramid;

bool pyramid_init(Pyramid *p, const Image *base);       /* false: memory, reported, *p empty */
void pyramid_clear(Pyramid *p);

/* What is asked: u to the right and v upwards, the whole picture being [0,1]^2; alpha instead of
 * the colour, if the picture has it. */
typedef struct { float u, v; Wrap wrap; bool alpha; } ImagePlace;

Rgb image_nearest(const Image *im, const ImagePlace *l);
Rgb image_bilinear(const Image *im, const ImagePlace *l);
/* Between the two levels around `level`, bilinear in each. */
Rgb pyramid_trilinear(const Pyramid *p, const ImagePlace *l, float level);

#endif
