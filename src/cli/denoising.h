/* denoising.h -- --denoise and --fireflies of the commands that write pictures: which filter for
 * the picture, or for which parts of it, and what it is guided by. */
#ifndef CLI_DENOISING_H
#define CLI_DENOISING_H

#include "image/denoise.h"

/* The picture, and the parts that add up to it. */
enum { PART_PICTURE, PART_EMISSION, PART_DIRECT, PART_INDIRECT, PARTS };

/* What filters may want to know besides: pictures that can be had by these names. */
enum { GUIDE_ALBEDO = PARTS, GUIDE_NORMAL, GUIDE_DEPTH, GUIDE_VARIANCE,
       LAYERS = GUIDE_VARIANCE + PARTS };               /* a variance of each part */
/* "albedo", "variance", "variance.direct". */
const char *denoising_layer(int layer);

typedef struct {
    const Denoiser *kind[PARTS];        /* NULL: that part stays as it is */
    Opts  opts[PARTS];
    float fireflies;                    /* 0: they stay */
    int   threads;
} Denoising;

#define DENOISING_ARGS \
    { "--denoise", "[PART=]NAME[:KEY=VALUE,...]", \
      "filters noise; biased; see list denoisers; PART: emission, direct, indirect" }, \
    { "--fireflies", "X", "pixels above X times their brightest neighbour become that; biased" }

/* "NAME[:KEY=VALUE,...]" for the picture, "direct=NAME[...]" for a part. False: usage error
 * reported. */
bool denoising_set(Denoising *d, const char *value, Arena *arena);
bool denoising_set_fireflies(Denoising *d, const char *value);
bool denoising_any(const Denoising *d);
/* Whether that layer is of use for it. */
bool denoising_wants(const Denoising *d, int layer);
/* Filters im[PART_PICTURE]; layers without pixels are not there. All may be changed. False:
 * reported. */
bool denoising_run(const Denoising *d, Image im[LAYERS]);

#endif
