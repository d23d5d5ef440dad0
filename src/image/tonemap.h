/* tonemap.h -- from light without a bound to what a display can show: exposure, by hand or by the
 * picture itself, then a curve, by which each member of `tonemaps` is known. */
#ifndef IMAGE_TONEMAP_H
#define IMAGE_TONEMAP_H

#include "image/image.h"

/* A curve made ready for one picture. */
typedef struct {
    const ToneMap *kind;        /* NULL: none */
    const Image *im;            /* borrowed */
    float  gain;                /* of all exposure */
    double a[3];                /* what the kind wants to know */
    float *local;               /* owned: a number for each pixel, of kinds that look around */
} Tone;

/* False: out of memory, reported, nothing held. display NULL: as it is. */
bool tone_init(Tone *t, const Display *display, const Image *im);
void tone_clear(Tone *t);
/* A pixel times the gain. What is not a number counts as 0, infinity as the largest float. */
Rgb  tone_exposed(const Tone *t, size_t pixel);
/* The same through the curve: in [0,1], or, if there is none, without a bound. */
Rgb  tone_pixel(const Tone *t, size_t pixel);

struct ToneMap {
    KindInfo info;
    /* Fills a and local for the exposed picture. False: reported. NULL: needs nothing. */
    bool (*prepare)(Tone *t, const Opts *o);
    Rgb  (*map)(const Tone *t, Rgb exposed, size_t pixel);      /* to [0,1] */
};
extern const ToneMap tonemap_local;                     /* in a file of its own */

/* ---- exposure by the picture ---- */

struct LightMeter {
    KindInfo info;
    double (*gain)(const Opts *o, const Image *im);     /* 1 where nothing can be said */
};
/* What display's meter and stops make of a picture. */
float display_gain(const Display *display, const Image *im);

#endif
