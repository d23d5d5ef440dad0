/* gaussian.c -- the noise filter `gaussian`: the mean of what is around, whatever that is.
 *
 * Source      [GIRT 4.1.2.5], there for indirect light, which is smooth by itself.
 * How         Along rows, then along columns, of what there is within three standard deviations;
 *             beyond the border there is nothing to average. */
#include "image/denoise.h"

enum { RADIUS_MOST = 300 };

typedef struct {
    const Image *from;          /* borrowed */
    Image *to;
    float  weight[RADIUS_MOST + 1];
    int    radius;
    bool   down;                /* along columns */
} Blur;

static Rgb mean_at(const Blur *b, uint32_t x, uint32_t y)
{
    int at = (int)(b->down ? y : x), n = (int)(b->down ? b->from->h : b->from->w);
    int lo = at < b->radius ? -at : -b->radius;
    int hi = n - 1 - at < b->radius ? n - 1 - at : b->radius;
    Rgb sum = rgb_all(0.0f);
    float total = 0.0f;

    for (int k = lo; k <= hi; k++) {
        float w = b->weight[k < 0 ? -k : k];
        uint32_t place = (uint32_t)(at + k);
        sum = rgb_add(sum, rgb_scale(b->down ? *image_at(b->from, x, place)
                                             : *image_at(b->from, place, y), w));
        total += w;
    }
    return rgb_scale(sum, 1.0f / total);
}

static void blur_row(void *ctx, uint32_t y)
{
    const Blur *b = ctx;

    for (uint32_t x = 0; x < b->from->w; x++)
        *image_at(b->to, x, y) = mean_at(b, x, y);
}

static bool run_gaussian(const Noisy *in, const Opts *o, Image *out)
{
    float sigma = opt_float(o, "sigma");
    Blur b = { .from = in->colour, .radius = (int)ceilf(3.0f * sigma) };
    Image rows;

    if (!image_init(&rows, out->w, out->h))
        return false;
    for (int k = 0; k <= b.radius; k++)
        b.weight[k] = m_exp(-0.5f * f_sqr((float)k / sigma));
    b.to = &rows;
    rows_run(in, blur_row, &b);
    b.from = &rows;
    b.to = out;
    b.down = true;
    rows_run(in, blur_row, &b);
    image_clear(&rows);
    return true;
}

static const OptDef options[] = {
    { .key = "sigma", .type = OPT_FLOAT, .num = 2, .lo = 0.1, .hi = 100, .help = "pixels" },
    { .key = NULL }
};

const Denoiser denoiser_gaussian = {
    { "gaussian", "GIRT 4.1.2.5", "mean of what is around, edges or not; biased", options },
    run_gaussian
};
