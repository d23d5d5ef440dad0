/* nlmeans.c -- the noise filter `nlmeans`: the mean of pixels around which the same is seen.
 *
 * Source      [Buades05]; the distance that knows the noise, and guides, after [Rousselle12 (4)]
 *             and [Rousselle13 5].
 * Idea        Two pixels are as far apart as the patches around them differ. Of two patches that
 *             show the same the squared difference is the sum of their variances in the mean: that
 *             is taken off, and what is left is measured by it:
 *                 d^2 = [(a - b)^2 - (va + min(va, vb))] / (k^2 (va + vb)).
 *             So no number has to be tried out for each picture. Weights are exp(-d^2), or less if
 *             guides differ, and fall to nothing towards the end of where it looks: else one bright
 *             pixel would show as a square.
 * How         By offset, not by pixel: of a row of the picture, of one offset, the squared
 *             differences of all pixels of the rows that patches reach are summed along columns,
 *             then along the row: a sum for each pixel at 4 f additions. */
#include "image/denoise.h"

#include "base/mem.h"
#include "base/work.h"

#include <string.h>

enum { STRIP = 16 };            /* rows of a unit */

typedef struct {
    const Image *from;          /* borrowed */
    Image *to, variance;        /* variance: owned */
    Guides guides;              /* owned */
    int    radius, patch;
    float  k2, guide;
    struct Scratch *scratch;    /* owned: one a worker */
} NlMeans;

/* Of a strip: differences of pixels, their sums along columns, weights and colours added up. */
typedef struct Scratch { float *d, *columns, *total; Rgb *sum; } Scratch;       /* owned */

static float channel_distance(float a, float b, float va, float vb, float k2)
{
    return ((a - b) * (a - b) - (va + f_min(va, vb))) / (1e-10f + k2 * (va + vb));
}

static float pixel_distance(const NlMeans *f, size_t i, size_t j)
{
    Rgb a = f->from->pixels[i], b = f->from->pixels[j];
    Rgb va = f->variance.pixels[i], vb = f->variance.pixels[j];

    return (channel_distance(a.r, b.r, va.r, vb.r, f->k2) +
            channel_distance(a.g, b.g, va.g, vb.g, f->k2) +
            channel_distance(a.b, b.b, va.b, vb.b, f->k2)) * (1.0f / 3.0f);
}

static int clamped(int v, int n) { return v < 0 ? 0 : v >= n ? n - 1 : v; }

/* Rows y0 - patch .. y1 + patch of differences to the pixels at the offset; beyond the border the
 * last pixel goes on. */
static void fill_differences(const NlMeans *f, const Scratch *s, int y0, int y1, int dx, int dy)
{
    int w = (int)f->from->w, h = (int)f->from->h;
    float *to = s->d;

    for (int y = y0 - f->patch; y < y1 + f->patch; y++) {
        size_t a = (size_t)clamped(y, h) * f->from->w;
        size_t b = (size_t)clamped(clamped(y, h) + dy, h) * f->from->w;
        for (int x = 0; x < w; x++)
            *to++ = pixel_distance(f, a + (size_t)x, b + (size_t)clamped(x + dx, w));
    }
}

static void sum_columns(const NlMeans *f, const Scratch *s, int row)
{
    size_t w = f->from->w;

    for (size_t x = 0; x < w; x++) {
        float sum = 0.0f;
        for (int k = 0; k <= 2 * f->patch; k++)
            sum += s->d[(size_t)(row + k) * w + x];
        s->columns[x] = sum;
    }
}

/* Adds the pixels at the offset to those of row y. */
static void add_offset(const NlMeans *f, const Scratch *s, int row, int y, int dx, int dy)
{
    int w = (int)f->from->w, side = 2 * f->patch + 1;
    float scale = 1.0f / (float)(side * side), reach = 1.0f / f_sqr((float)f->radius + 1.0f);
    float window = (1.0f - (float)(dx * dx) * reach) * (1.0f - (float)(dy * dy) * reach);

    for (int x = dx < 0 ? -dx : 0; x < w && x + dx < w; x++) {
        size_t i = (size_t)y * f->from->w + (size_t)x;
        size_t j = (size_t)(y + dy) * f->from->w + (size_t)(x + dx);
        size_t at = (size_t)row * f->from->w + (size_t)x;
        float d2 = 0.0f, weight;
        for (int k = -f->patch; k <= f->patch; k++)
            d2 += s->columns[clamped(x + k, w)];
        d2 = f_max(d2 * scale, 0.0f);
        if (f->guides.n && d2 < 16.0f)
            d2 = f_max(d2, f->guide * guides_distance2(&f->guides, i, j));
        if (!(d2 < 16.0f))
            continue;
        weight = window * m_exp(-d2);
        s->sum[at] = rgb_add(s->sum[at], rgb_scale(f->from->pixels[j], weight));
        s->total[at] += weight;
    }
}

static void filter_rows(const NlMeans *f, const Scratch *s, int y0, int y1)
{
    int h = (int)f->from->h, w = (int)f->from->w;

    for (int dy = -f->radius; dy <= f->radius; dy++)
        for (int dx = -f->radius; dx <= f->radius; dx++) {
            if (dx <= -w || dx >= w)
                continue;
            fill_differences(f, s, y0, y1, dx, dy);
            for (int y = y0; y < y1; y++)
                if (y + dy >= 0 && y + dy < h) {
                    sum_columns(f, s, y - y0);
                    add_offset(f, s, y - y0, y, dx, dy);
                }
        }
    for (int y = y0; y < y1; y++)
        for (int x = 0; x < w; x++) {
            size_t at = (size_t)(y - y0) * f->from->w + (size_t)x;
            *image_at(f->to, (uint32_t)x, (uint32_t)y) = rgb_scale(s->sum[at], 1 / s->total[at]);
        }
}

/* ---- strips on threads ---- */

static void run_strip(void *ctx, uint64_t unit, int worker)
{
    const NlMeans *f = ctx;
    Scratch *s = &f->scratch[worker];
    int y0 = (int)unit * STRIP, h = (int)f->from->h;
    size_t n = (size_t)f->from->w * STRIP;

    memset(s->total, 0, n * sizeof *s->total);
    memset(s->sum, 0, n * sizeof *s->sum);
    filter_rows(f, s, y0, h - y0 > STRIP ? y0 + STRIP : h);
}

static bool scratch_init(NlMeans *f, int threads)
{
    size_t w = f->from->w, rows = STRIP + 2 * (size_t)f->patch;

    f->scratch = MEM_ARRAY(Scratch, (size_t)threads);
    for (int i = 0; f->scratch && i < threads; i++) {
        Scratch *s = &f->scratch[i];
        s->d = MEM_ARRAY(float, w * rows);
        s->columns = MEM_ARRAY(float, w);
        s->total = MEM_ARRAY(float, w * STRIP);
        s->sum = MEM_ARRAY(Rgb, w * STRIP);
        if (!s->d || !s->columns || !s->total || !s->sum)
            return false;
    }
    return f->scratch != NULL;
}

static void scratch_clear(NlMeans *f, int threads)
{
    for (int i = 0; f->scratch && i < threads; i++) {
        mem_free(f->scratch[i].d);
        mem_free(f->scratch[i].columns);
        mem_free(f->scratch[i].total);
        mem_free(f->scratch[i].sum);
    }
    mem_free(f->scratch);
}

static bool run_nlmeans(const Noisy *in, const Opts *o, Image *out)
{
    NlMeans f = { .from = in->colour, .to = out, .radius = (int)opt_int(o, "radius"),
                  .patch = (int)opt_int(o, "patch"), .k2 = f_sqr(opt_float(o, "k")) };
    Work w = { (in->colour->h + STRIP - 1) / STRIP, run_strip, NULL, &f };
    bool ok;

    f.guide = 0.5f / f_sqr(opt_float(o, "guide"));
    ok = guides_init(&f.guides, in) && noisy_variance(in, &f.variance) &&
         scratch_init(&f, in->threads);
    if (ok)
        work_run(&w, in->threads);
    scratch_clear(&f, in->threads);
    image_clear(&f.variance);
    guides_clear(&f.guides);
    return ok;
}

static const OptDef options[] = {
    { .key = "radius", .type = OPT_INT, .num = 8, .lo = 1, .hi = 50,
      .help = "of where it looks, pixels" },
    { .key = "patch", .type = OPT_INT, .num = 3, .lo = 0, .hi = 10,
      .help = "radius of patches, pixels" },
    { .key = "k", .type = OPT_FLOAT, .num = 0.45, .lo = 0.01, .hi = 100,
      .help = "more of it: smoother" },
    { .key = "guide", .type = OPT_FLOAT, .num = 0.1, .lo = 1e-3, .hi = 100,
      .help = "distance of guides that are alike" },
    { .key = NULL }
};

const Denoiser denoiser_nlmeans = {
    { "nlmeans", "Rousselle12", "mean of pixels with like surroundings; biased", options },
    run_nlmeans
};
