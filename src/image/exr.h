/* exr.h -- OpenEXR pictures: any number of layers in one file, each of one or three channels. */
#ifndef IMAGE_EXR_H
#define IMAGE_EXR_H

#include "image/image.h"

enum { EXR_LAYERS = 64, EXR_NAME = 64 };
enum { EXR_MAGIC = 20000630, EXR_VERSION = 2 };
enum { EXR_NONE, EXR_RLE, EXR_ZIPS, EXR_ZIP };          /* ways of packing, as files say them */
enum { EXR_UINT, EXR_HALF, EXR_FLOAT };                 /* kinds of channels, likewise */
enum { EXR_ZIP_LINES = 16 };                            /* in a block of kind ZIP */

/* name: "" for the picture, else what stands before the dot in the names of the channels. channels:
 * one letter each, three ("RGB", "XYZ"), or one, which holds the red of im. All borrowed. */
typedef struct { const char *name, *channels; const Image *im; } ExrLayer;

/* n > 0 layers of one size, in floats: every bit of them comes back. Whole or not at all. False:
 * reported. */
bool exr_write(const char *path, const ExrLayer *layers, int n, bool packed);

/* Is it an EXR file that has this layer? */
bool exr_has(const unsigned char *bytes, size_t n, const char *layer);
/* Reads a layer, "" the picture. One channel becomes grey. False: reported, *im empty. */
bool exr_read(Image *im, const char *path, const unsigned char *bytes, size_t n,
              uint64_t max_pixels, const char *layer);

/* What ZIP and RLE do to a block's n bytes before they are packed; `to` is other room for them. */
void exr_arrange(const unsigned char *from, unsigned char *to, size_t n);

#endif
