/* png.h -- what the reader and the writer of PNG share. */
#ifndef IMAGE_PNG_H
#define IMAGE_PNG_H

#include "image/image.h"

#include <stdlib.h>
#include <string.h>

enum { PNG_FILTERS = 5, PNG_SIGNATURE = 8 };

static const unsigned char png_signature[PNG_SIGNATURE] = { 137, 'P', 'N', 'G', 13, 10, 26, 10 };

static inline bool png_detect(const unsigned char *b, size_t n)
{
    return n >= PNG_SIGNATURE && !memcmp(b, png_signature, PNG_SIGNATURE);
}

/* The neighbour nearest to left + up - corner; of equals the left one, then the upper. */
static inline int png_paeth(int left, int up, int corner)
{
    int to_left = abs(up - corner), to_up = abs(left - corner);
    int to_corner = abs(left + up - 2 * corner);

    if (to_left <= to_up && to_left <= to_corner)
        return left;
    return to_up <= to_corner ? up : corner;
}

static inline int png_prediction(int filter, int left, int up, int corner)      /* [PNG 9.2] */
{
    switch (filter) {
    case 1:  return left;
    case 2:  return up;
    case 3:  return (left + up) / 2;
    case 4:  return png_paeth(left, up, corner);
    default: return 0;
    }
}

bool png_read(Image *im, const char *path, const unsigned char *bytes, size_t n,
              uint64_t max_pixels, Encoding encoding);

#endif
