/* image_help.h -- what the suites about images share. */
#ifndef TEST_IMAGE_HELP_H
#define TEST_IMAGE_HELP_H

#include "base/file.h"
#include "base/mem.h"
#include "base/random.h"
#include "image/format.h"
#include "test/test.h"

#include <stdio.h>
#include <string.h>

static inline const ImageFormat *format_named(const char *name)
{
    const ImageFormat *const *f = image_formats;
    while (*f && strcmp((*f)->info.name, name))
        f++;
    REQUIRE(*f, "no format %s", name);
    return *f;
}

static inline const ToneMap *tonemap_named(const char *name)
{
    const ToneMap *const *t = tonemaps;
    while (*t && strcmp((*t)->info.name, name))
        t++;
    REQUIRE(*t, "no tone map %s", name);
    return *t;
}

/* Whether n pixels have the same bits: by component, since a pixel may be wider than those. */
static inline bool same_pixels(const Rgb *a, const Rgb *b, size_t n)
{
    for (size_t i = 0; i < n; i++)
        if (memcmp(&a[i].r, &b[i].r, sizeof(float)) || memcmp(&a[i].g, &b[i].g, sizeof(float)) ||
            memcmp(&a[i].b, &b[i].b, sizeof(float)))
            return false;
    return true;
}

/* A path in the folder of the case. Static buffer. */
static inline const char *in_folder(const char *name)
{
    static char path[400];
    snprintf(path, sizeof path, "%s/%s", test_folder(), name);
    return path;
}

static inline Image new_image(uint32_t w, uint32_t h)
{
    Image im;
    REQUIRE(image_init(&im, w, h), "image_init %u x %u", (unsigned)w, (unsigned)h);
    return im;
}

/* Positive colours whose size varies over 2^lo .. 2^(lo + range). */
static inline void fill_random(Image *im, Rng *r, int lo, uint32_t range)
{
    size_t n = (size_t)im->w * im->h;
    for (size_t i = 0; i < n; i++) {
        double scale = 1.0;
        int e = lo + (int)rng_below(r, range);
        for (; e > 0; e--)
            scale *= 2.0;
        for (; e < 0; e++)
            scale *= 0.5;
        im->pixels[i].r = (float)(scale * rng_unit(r));     /* in this order everywhere */
        im->pixels[i].g = (float)(scale * rng_unit(r));
        im->pixels[i].b = (float)(scale * rng_unit(r));
    }
}

/* The bytes of a display format; 3 w h of them into b. */
static inline void picture_bytes(const Image *im, const Display *display, unsigned char *b)
{
    Quantiser q;

    REQUIRE(quantiser_init(&q, display, im), "quantiser_init");
    for (uint32_t y = 0; y < im->h; y++)
        quantiser_row(&q, y, b + (size_t)y * im->w * 3);
    quantiser_clear(&q);
}

static inline void colour_bytes(Rgb c, const Display *display, unsigned char b[3])
{
    Image im = { 1, 1, &c, NULL };
    picture_bytes(&im, display, b);
}

static inline uint32_t float_bits(float x)
{
    uint32_t u;
    memcpy(&u, &x, sizeof u);
    return u;
}

static inline float float_of_bits(uint32_t u)
{
    float x;
    memcpy(&x, &u, sizeof x);
    return x;
}

/* Reads bytes by the format called `name`, as a file called "memory". */
static inline bool read_memory(Image *im, const char *name, const void *bytes, size_t n)
{
    return format_named(name)->read(im, "memory", bytes, n, IMAGE_PIXELS_DEFAULT, ENCODING_BY_FILE);
}

#endif
