/* bilateral.c -- the noise filter `bilateral`: the mean of what is around and alike.
 *
 * Source      [Tomasi98]; by what guides say beside it, if there are any.
 * Idea        Weights are Gaussian in the distance of pixels, in that of their colours and in that
 *             of their guides. Colours are compared by the logarithm of luminance, in stops, above
 *             what the noise hides: variance is added to what is compared.
 * Departs     [Tomasi98] has a fixed scale of colours; light has none, hence the logarithms. */
#include "image/denoise.h"

#include "base/mem.h"

typedef struct {
    const Image *from;          /* borrowed */
    Image  *to;
    Guides  guides;             /* owned */
    float  *level;              /* owned: logarithm of each pixel's luminance */
    int     radius;
    float   space, range, guide;        /* 1 / (2 sigma^2) of each */
} Bilateral;

static float weight_of(const Bilateral *b, size_t i, size_t j, int dx, int dy)
{
    float e = b->space * (float)(dx * dx + dy * dy) + b->range * f_sqr(b->level[i] - b->level[j]);

    if (b->guides.n)
        e += b->guide * guides_distance2(&b->guides, i, j);
    return e < 16.0f ? m_exp(-e) : 0.0f;
}

static Rgb mean_at(const Bilateral *b, int x, int y)
{
    int w = (int)b->from->w, h = (int)b->from->h, r = b->radius;
    size_t i = (size_t)y * b->from->w + (size_t)x;
    Rgb sum = rgb_all(0.0f);
    float total = 0.0f;

    for (int v = y < r ? 0 : y - r; v <= y + r && v < h; v++)
        for (int u = x < r ? 0 : x - r; u <= x + r && u < w; u++) {
            size_t j = (size_t)v * b->from->w + (size_t)u;
            float k = weight_of(b, i, j, u - x, v - y);
            if (k == 0.0f)
                continue;
            sum = rgb_add(sum, rgb_scale(b->from->pixels[j], k));
            total += k;
        }
    return rgb_scale(sum, 1.0f / total);
}

static void filter_row(void *ctx, uint32_t y)
{
    const Bilateral *b = ctx;

    for (uint32_t x = 0; x < b->from->w; x++)
        *image_at(b->to, x, y) = mean_at(b, (int)x, (int)y);
}

/* In stops; noise lifts what is dark. */
static bool find_levels(Bilateral *b, const Noisy *in)
{
    size_t n = (size_t)in->colour->w * in->colour->h;
    Image v;

    b->level = MEM_ARRAY(float, n);
    if (!b->level || !noisy_variance(in, &v))
        return false;
    for (size_t i = 0; i < n; i++) {
        float lum = rgb_lum(in->colour->pixels[i]);
        b->level[i] = 0.5f * m_log2(lum * lum + rgb_lum(v.pixels[i]) + 1e-12f);
    }
    image_clear(&v);
    return true;
}

static bool run_bilateral(const Noisy *in, const Opts *o, Image *out)
{
    float sigma = opt_float(o, "sigma");
    Bilateral b = { .from = in->colour, .to = out, .radius = (int)ceilf(2.5f * sigma) };
    bool ok;

    b.space = 0.5f / f_sqr(sigma);
    b.range = 0.5f / f_sqr(opt_float(o, "range"));
    b.guide = 0.5f / f_sqr(opt_float(o, "guide"));
    ok = find_levels(&b, in) && guides_init(&b.guides, in);
    if (ok)
        rows_run(in, filter_row, &b);
    guides_clear(&b.guides);
    mem_free(b.level);
    return ok;
}

static const OptDef options[] = {
    { .key = "sigma", .type = OPT_FLOAT, .num = 3, .lo = 0.1, .hi = 40, .help = "pixels" },
    { .key = "range", .type = OPT_FLOAT, .num = 1.5, .lo = 0.01, .hi = 100,
      .help = "stops that are alike" },
    { .key = "guide", .type = OPT_FLOAT, .num = 0.1, .lo = 1e-3, .hi = 100,
      .help = "distance of guides that are alike" },
    { .key = NULL }
};

const Denoiser denoiser_bilateral = {
    { "bilateral", "Tomasi98", "mean of what is around and alike; biased", options }, run_bilateral
};
