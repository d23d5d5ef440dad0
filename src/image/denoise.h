/* denoise.h -- filters that take noise from a rendered picture. All of them are biased: they mix
 * pixels, so what they make is smoother than the truth, and no longer a mean of samples. */
#ifndef IMAGE_DENOISE_H
#define IMAGE_DENOISE_H

#include "image/image.h"

/* A picture and what is known of it; all borrowed, of one size. variance: of each pixel; the guides
 * albedo, normal and depth: of what is seen there. Those that are not known are NULL. */
typedef struct {
    const Image *colour, *variance, *albedo, *normal, *depth;
    int threads;
} Noisy;

typedef struct {
    KindInfo info;
    /* out has the size of the picture. False: out of memory, reported. */
    bool (*run)(const Noisy *in, const Opts *o, Image *out);
} Denoiser;
extern const Denoiser *const denoisers[];               /* ends with NULL */

/* ---- for the filters ---- */

/* The variance if it is known, else as the picture's own roughness tells. False: reported. */
bool noisy_variance(const Noisy *in, Image *v);

/* Guides as vectors of n <= GUIDES_MOST numbers a pixel, among which distances are alike: albedo,
 * normal, and the logarithm of depth. n is 0 where there are none. */
enum { GUIDES_MOST = 7 };
typedef struct { int n; float *v; } Guides;             /* owned: [pixel][n] */
bool guides_init(Guides *g, const Noisy *in);           /* false: reported */
void guides_clear(Guides *g);
INLINE float guides_distance2(const Guides *g, size_t a, size_t b)
{
    const float *p = g->v + a * (size_t)g->n, *q = g->v + b * (size_t)g->n;
    float sum = 0.0f;

    for (int k = 0; k < g->n; k++)
        sum += (p[k] - q[k]) * (p[k] - q[k]);
    return sum;
}

/* Calls row(ctx, y) for all rows, on several threads. */
void rows_run(const Noisy *in, void (*row)(void *ctx, uint32_t y), void *ctx);

/* Brings each pixel that is more than `factor` times as bright as the brightest of its neighbours
 * down to that, and its variance with it (NULL: is not known). Biased, too. False: reported. */
bool fireflies_clamp(Image *im, Image *variance, float factor);

#endif
