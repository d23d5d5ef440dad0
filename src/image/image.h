/* image.h -- pixels in memory and on disk. Linear RGB float, row 0 at the top. */
#ifndef IMAGE_IMAGE_H
#define IMAGE_IMAGE_H

#include "base/kind.h"
#include "base/vec.h"

#include <stddef.h>
#include <stdint.h>

/* w * h pixels, row-major from the top left. Both arrays are owned. alpha, of as many numbers in
 * [0,1] (0 lets all light through), is NULL where all is opaque; colours are not multiplied by it.
 * {0} is the empty image. */
typedef struct { uint32_t w, h; Rgb *pixels; float *alpha; } Image;

#define IMAGE_PIXELS_DEFAULT ((uint64_t)1 << 28)        /* most pixels of an image (--max-pixels) */

bool image_init(Image *im, uint32_t w, uint32_t h);     /* black; false: reported, *im empty */
bool image_init_alpha(Image *im, uint32_t w, uint32_t h);       /* with alpha, 0 everywhere */
void image_drop_alpha(Image *im, float value);  /* if there is one and it is `value` everywhere */
void image_clear(Image *im);
static inline Rgb *image_at(const Image *im, uint32_t x, uint32_t y)
{
    return im->pixels + (size_t)y * im->w + x;
}

/* How display formats (png, ppm) get their bytes: v = tonemap(2^exposure * meter * linear), then
 * the sRGB curve, rounded, or up and down by a pattern of places whose mean is right. NULL: no
 * curve but the cut at 1; no meter. Formats that hold floats store the linear values. Options
 * without a table are the defaults. */
typedef struct ToneMap ToneMap;
typedef struct LightMeter LightMeter;
typedef struct {
    const ToneMap *tonemap;  Opts tonemap_opts;
    const LightMeter *meter; Opts meter_opts;           /* exposure by the picture itself */
    float exposure;                                     /* stops */
    bool  dither;
    bool  uncompressed;                                 /* of formats that may be either (exr) */
} Display;
extern const ToneMap *const tonemaps[];                 /* ends with NULL; see tonemap.h */
extern const LightMeter *const meters[];                /* ends with NULL */

/* How the samples of display formats, in [0,1], become linear when they are read: by the sRGB curve
 * if below 0, by what the file says (sRGB if it says nothing) if 0, else x^encoding, where 1 is
 * linear. Formats that hold floats are linear in any case, and so is alpha. */
typedef float Encoding;
#define ENCODING_SRGB    (-1.0f)
#define ENCODING_BY_FILE 0.0f
#define ENCODING_LINEAR  1.0f

/* One file format, in a file of its own; image.c has the list. */
typedef struct {
    KindInfo info;
    const char *extensions;                             /* "hdr pic": first is the usual one */
    bool linear;                                        /* holds floats, not display bytes */
    /* True if a file that begins with these bytes is of this format. */
    bool (*detect)(const unsigned char *bytes, size_t n);
    /* Reads all of bytes[0..n), file named `path` in messages, of at most max_pixels pixels.
     * False: reported once with its place, *im empty. NULL if the format cannot be read. */
    bool (*read)(Image *im, const char *path, const unsigned char *bytes, size_t n,
                 uint64_t max_pixels, Encoding encoding);
    /* Writes whole or not at all. False: reported. NULL if the format cannot be written. */
    bool (*write)(const Image *im, const char *path, const Display *display);
} ImageFormat;
extern const ImageFormat *const image_formats[];        /* ends with NULL */

/* Whether files with the extension of path can be read. */
bool image_can_read(const char *path);
/* One that can be written, by the extension of path. NULL: none is; nothing reported. */
const ImageFormat *image_format_of(const char *path);
/* Their usual extensions, with blanks between. */
enum { IMAGE_EXTENSIONS = 200 };
const char *image_extensions(char out[IMAGE_EXTENSIONS]);
/* The same with a report: a usage error that lists them. */
const ImageFormat *image_format_for_writing(const char *path);
/* Format by the bytes, not by the name. */
bool image_read(Image *im, const char *path, uint64_t max_pixels);     /* ENCODING_BY_FILE */
bool image_read_as(Image *im, const char *path, uint64_t max_pixels, Encoding encoding);
/* A layer of an EXR file, "" the picture; other formats have no layers. */
bool image_read_layer(Image *im, const char *path, uint64_t max_pixels, const char *layer);
bool image_write(const Image *im, const char *path, const Display *display);

float srgb_encode(float linear);        /* both clamp to [0,1] */
float srgb_decode(float encoded);

#endif
