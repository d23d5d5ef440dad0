/* denoise.c -- the list of noise filters, and what they share.
 *
 * Variance    If nobody knows it: a pixel less the mean of its four neighbours has, of independent
 *             noise, 5/4 of its variance where the picture is smooth; averaged over 5 x 5. */
#include "image/denoise.h"

#include "base/mem.h"
#include "base/work.h"

#include <string.h>

#define DENOISERS(X) X(gaussian) X(bilateral) X(guided) X(nlmeans)
#define DECLARE(name) extern const Denoiser denoiser_##name;
#define ENTRY(name) &denoiser_##name,
DENOISERS(DECLARE)
const Denoiser *const denoisers[] = { DENOISERS(ENTRY) NULL };

/* ---- rows on threads ---- */

typedef struct { void (*row)(void *ctx, uint32_t y); void *ctx; } Rows;

static void run_row(void *ctx, uint64_t unit, int worker)
{
    const Rows *r = ctx;

    (void)worker;
    r->row(r->ctx, (uint32_t)unit);
}

void rows_run(const Noisy *in, void (*row)(void *ctx, uint32_t y), void *ctx)
{
    Rows r = { row, ctx };
    Work w = { in->colour->h, run_row, NULL, &r };

    work_run(&w, in->threads);
}

/* ---- variance ---- */

static Rgb roughness2(const Image *im, uint32_t x, uint32_t y)
{
    uint32_t l = x ? x - 1 : x + 1 < im->w ? x + 1 : x, r = x + 1 < im->w ? x + 1 : l;
    uint32_t u = y ? y - 1 : y + 1 < im->h ? y + 1 : y, d = y + 1 < im->h ? y + 1 : u;
    Rgb sum = rgb_add(rgb_add(*image_at(im, l, y), *image_at(im, r, y)),
                      rgb_add(*image_at(im, x, u), *image_at(im, x, d)));
    Rgb c = rgb_sub(*image_at(im, x, y), rgb_scale(sum, 0.25f));
    return rgb_scale(rgb_mul(c, c), 0.8f);
}

static Rgb roughness_around(const Image *im, uint32_t x, uint32_t y)
{
    Rgb sum = rgb_all(0.0f);
    int n = 0;

    for (int dy = -2; dy <= 2; dy++)
        for (int dx = -2; dx <= 2; dx++) {
            int64_t u = (int64_t)x + dx, v = (int64_t)y + dy;
            if (u < 0 || v < 0 || u >= im->w || v >= im->h)
                continue;
            sum = rgb_add(sum, roughness2(im, (uint32_t)u, (uint32_t)v));
            n++;
        }
    return rgb_scale(sum, 1.0f / (float)n);
}

bool noisy_variance(const Noisy *in, Image *v)
{
    const Image *im = in->colour;

    if (!image_init(v, im->w, im->h))
        return false;
    for (uint32_t y = 0; y < im->h; y++)
        for (uint32_t x = 0; x < im->w; x++)
            *image_at(v, x, y) = in->variance ? *image_at(in->variance, x, y)
                                              : roughness_around(im, x, y);
    return true;
}

/* ---- guides ---- */

static float *put_vector(float *to, const Image *im, size_t i)
{
    if (!im)
        return to;
    *to++ = im->pixels[i].r;
    *to++ = im->pixels[i].g;
    *to++ = im->pixels[i].b;
    return to;
}

bool guides_init(Guides *g, const Noisy *in)
{
    size_t n = (size_t)in->colour->w * in->colour->h;

    g->n = (in->albedo ? 3 : 0) + (in->normal ? 3 : 0) + (in->depth ? 1 : 0);
    g->v = MEM_ARRAY(float, n * (size_t)g->n);
    if (!g->v)
        return false;
    for (size_t i = 0; i < n; i++) {
        float *to = put_vector(g->v + i * (size_t)g->n, in->albedo, i);
        to = put_vector(to, in->normal, i);
        if (in->depth)          /* what is met nowhere is by itself */
            *to = in->depth->pixels[i].r > 0.0f ? m_log(in->depth->pixels[i].r) : -100.0f;
    }
    return true;
}

void guides_clear(Guides *g)
{
    mem_free(g->v);
    g->v = NULL;
}

/* ---- fireflies ---- */

static float brightest_neighbour(const float *lum, uint32_t w, uint32_t h, uint32_t x, uint32_t y)
{
    float most = 0.0f;

    for (uint32_t v = y ? y - 1 : 0; v <= y + 1 && v < h; v++)
        for (uint32_t u = x ? x - 1 : 0; u <= x + 1 && u < w; u++)
            if (u != x || v != y)
                most = f_max(most, lum[(size_t)v * w + u]);
    return most;
}

bool fireflies_clamp(Image *im, Image *variance, float factor)
{
    size_t n = (size_t)im->w * im->h;
    float *lum = MEM_ARRAY(float, n);

    for (size_t i = 0; lum && i < n; i++)
        lum[i] = rgb_lum(im->pixels[i]);
    for (uint32_t y = 0; lum && y < im->h; y++)
        for (uint32_t x = 0; x < im->w; x++) {
            size_t i = (size_t)y * im->w + x;
            float most = factor * brightest_neighbour(lum, im->w, im->h, x, y);
            if (!(lum[i] > most))
                continue;
            im->pixels[i] = rgb_scale(im->pixels[i], most / lum[i]);
            if (variance)
                variance->pixels[i] = rgb_scale(variance->pixels[i], f_sqr(most / lum[i]));
        }
    mem_free(lum);
    return lum != NULL;
}
