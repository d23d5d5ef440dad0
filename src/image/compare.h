/* compare.h -- how far an image is from a reference: figures, a statistical test, a picture. */
#ifndef IMAGE_COMPARE_H
#define IMAGE_COMPARE_H

#include "image/image.h"

/* Where a largest value was met, counting from 0 at the top left. */
typedef struct { uint32_t x, y; } PixelPlace;

/* a is the image under test, r the reference. Pixels that are not finite in either image are
 * counted and left out of everything else. |c| is 0.299 r + 0.587 g + 0.114 b, and |c - d| the same
 * sum of the absolute differences [Cline07 (4.11)]. A ratio 0/0 counts as 0, x/0 as infinity; if no
 * pixel is left, the figures of error are infinite. */
typedef struct {
    uint64_t pixels;                    /* compared */
    uint64_t not_finite_a, not_finite_r;
    double   sigma;                     /* sqrt of the mean of |a - r|^2     [Cline07 (4.12)] */
    double   sigma_over_mu;             /* sigma over the mean |r|           [Cline07 (4.13)] */
    double   rmse;                      /* sqrt of the mean of (a - r)^2 over the channels */
    double   relmse;                    /* mean of (a - r)^2 / (r^2 + 0.01) over the channels */
    double   mean_a, mean_r;            /* of |a|, |r| */
    double   ratio;                     /* mean_a / mean_r */
    double   max;                       /* largest |a - r| of a channel */
    PixelPlace max_at;
    int      max_channel;               /* 0 red, 1 green, 2 blue */

    /* The z-test. The image is cut into tiles of 8 x 8 pixels (those of the last column and row
     * take the rest, up to 15). z of a tile is the mean of |a| - |r| over its pixels, in units of
     * that mean's standard error, estimated from the scatter of the same differences: Student's t
     * with (pixels - 1) degrees of freedom.
     *
     * What it says: if a and r are renders of one scene whose pixels are independent and unbiased,
     * every z has mean 0 and a spread of about 1.02, whatever the noise; the largest of T tiles is
     * then near sqrt(2 ln T), and z_mean within 5 / sqrt(T) of 0. A shift of a whole tile by less
     * than its noise shows up in z_max; one of the whole image, sqrt(T) times smaller, in z_mean.
     *
     * What it cannot say: errors that cancel within a tile are not seen. Pixels that share samples
     * (wide reconstruction filters, denoising, photons, Markov chains) vary together; the scatter
     * within a tile then says too little of the error of its mean, and z is too large. A rare
     * bright path makes the noise far from normal: z then stays small where it should not. The
     * true difference of the two expectations may vary over a tile, which also hides a shift. */
    double   z_max;                     /* signed z of the tile with the largest |z| */
    PixelPlace z_max_at;                /* its top left pixel */
    double   z_mean;                    /* mean of the signed z over the tiles */
    uint64_t tiles;                     /* with two or more pixels compared */
} ImageDifference;

/* False, reported: the sizes differ. The names are for that message. */
bool image_compare(const Image *a, const char *name_a, const Image *r, const char *name_r,
                   ImageDifference *d);

/* The same tiles as one question: does any of them differ? Each z is turned into the chance p of
 * such a z or a larger one, either way, by Student's t with its own degrees of freedom (tiles of
 * the last column and row have more). The least p of T tiles becomes the chance that T tiles which
 * do not differ would give so small a one, 1 - (1 - p)^T [Sidak67]; tiles whose claim falls at
 * alpha are counted by Holm's steps, each with that formula for the tiles that are left [Holm79].
 *
 * What it says: if nothing differs, and the noise is as below, the test finds that something does
 * in no more than the fraction alpha of all pairs of images; this holds however many tiles there
 * are, and for any set of them that differ, of the others. If the images share the noise of no
 * pixel, tiles are independent, and the rate is alpha itself for normal noise.
 *
 * What it cannot say: all that the z-test cannot, see above. Moreover Student's t is exact for
 * normal noise only, and p of one in T tiles asks for its far tail. Two renders with equally many
 * samples have a symmetric difference, and rare bright pixels then make the test find less than it
 * may: 0.3 to 1 times alpha for exponential noise. Against a reference with little noise of its
 * own the difference is skewed like the method's noise, and the test finds differences that are
 * none: of 256 tiles at alpha 0.01 in 26 % of pairs for exponential noise, in 2 % for the mean of
 * 16 such samples, at the stated rate from 64 on. So compare like with like, or pictures of many
 * samples. That no tile differs does not prove the images equal: a shift of all pixels of one tile
 * by s standard deviations moves its z by 8 s, and is found if 8 s is above about 6. */
typedef struct {
    uint64_t tiles;                     /* with two or more pixels compared */
    uint64_t differ;                    /* of these, at alpha */
    double   p;                         /* of the whole family; 1 without any tile */
    double   z;                         /* of the tile with the least p, and where it begins */
    PixelPlace at;
} FamilyTest;

/* False, reported: the sizes differ, or memory ran out. 0 < alpha < 1. */
bool image_family_test(const Image *a, const char *name_a, const Image *r, const char *name_r,
                       double alpha, FamilyTest *f);

/* Noise without a reference: a and b are renders of one picture, with equal budgets and independent
 * samples. Then E|a - b|^2 is the sum of the two variances, and half of it that of either
 * [Cline07 (4.14), (4.15)]; the mean of both pictures has half of that again. Exact for grey noise.
 * The distance of colours adds |d| of channels, and of a product |d_r| |d_g| the expectation need
 * not double with the variance: for noise of independent channels the estimate of sigma^2 is 1.00
 * of the true one if it is normal, 0.91 if it is 5 % of bright spots. What both images have in
 * common, a bias for one, is not seen. Pixels that are not finite are left out. */
typedef struct {
    uint64_t pixels;                    /* compared; 0: the errors are infinite */
    double   sigma;                     /* of either image */
    double   sigma_over_mu;             /* over the mean of both */
    double   relmse;                    /* of either, over (m^2 + 0.01), m the mean of both: far too
                                         * small if the noise is as large as the picture */
    double   mean_a, mean_b;            /* of |a|, |b| */
} ImageNoise;

/* False, reported: the sizes differ. */
bool image_noise(const Image *a, const char *name_a, const Image *b, const char *name_b,
                 ImageNoise *e);

typedef enum {
    DIFFERENCE_SIGNED,          /* |a| - |r|: red where a is brighter, blue where it is darker */
    DIFFERENCE_ABSOLUTE         /* |a - r| of each channel */
} DifferenceStyle;

/* A picture of the difference times `scale`, linear, black where the images agree, pure green
 * where a pixel is not finite. *out is made here. False: reported (sizes, memory). */
bool image_difference(const Image *a, const char *name_a, const Image *r, const char *name_r,
                      DifferenceStyle style, double scale, Image *out);

#endif
