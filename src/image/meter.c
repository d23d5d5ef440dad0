/* meter.c -- exposure by the picture itself: the list of ways to find it.
 *
 * Source      [Reinhard02] (1), (2) for the logarithmic average.
 * Departs     Black pixels say nothing: [Reinhard02] adds a small number to every luminance, which
 *             then decides how bright a picture with a black background becomes. */
#include "image/tonemap.h"

#include "base/bits.h"

#include <float.h>

/* A luminance that counts. */
static bool counts(float lum) { return lum > 0.0f && lum <= FLT_MAX; }

static double gain_average(const Opts *o, const Image *im)
{
    double sum = 0;
    uint64_t n = 0;

    for (size_t i = 0; i < (size_t)im->w * im->h; i++) {
        float lum = rgb_lum(im->pixels[i]);
        if (!counts(lum))
            continue;
        sum += md_log(lum);
        n++;
    }
    return n ? opt_float(o, "key") / md_exp(sum / (double)n) : 1.0;
}

/* The luminance of which number `rank` in order: positive floats have the order of their bits, so
 * those are found byte by byte, from the highest, by counting. */
static float luminance_of_rank(const Image *im, uint64_t rank)
{
    uint32_t known = 0, mask = 0;

    for (int shift = 24; shift >= 0; shift -= 8) {
        uint64_t count[256] = { 0 };
        uint32_t byte = 0;
        for (size_t i = 0; i < (size_t)im->w * im->h; i++) {
            float lum = rgb_lum(im->pixels[i]);
            uint32_t bits = bits_of_float(lum);
            if (counts(lum) && (bits & mask) == known)
                count[bits >> shift & 255]++;
        }
        while (byte < 255 && rank >= count[byte])
            rank -= count[byte++];
        known |= byte << shift;
        mask |= (uint32_t)255 << shift;
    }
    return float_of(known);
}

static double gain_percentile(const Opts *o, const Image *im)
{
    uint64_t n = 0;

    for (size_t i = 0; i < (size_t)im->w * im->h; i++)
        n += counts(rgb_lum(im->pixels[i]));
    if (!n)
        return 1.0;
    return opt_float(o, "value") /
           luminance_of_rank(im, (uint64_t)((double)(n - 1) * opt_float(o, "percent") / 100.0));
}

float display_gain(const Display *display, const Image *im)
{
    double gain = md_pow(2.0, display->exposure);
    Opts o = display->meter_opts;

    if (display->meter) {
        if (!o.defs)
            opts_default(&o, display->meter->info.options);
        gain *= display->meter->gain(&o, im);
    }
    return (float)d_min(gain, FLT_MAX);
}

static const OptDef average_options[] = {
    { .key = "key", .type = OPT_FLOAT, .num = 0.18, .lo = 1e-3, .hi = 10,
      .help = "what the average becomes" },
    { .key = NULL }
};
static const OptDef percentile_options[] = {
    { .key = "percent", .type = OPT_FLOAT, .num = 99, .lo = 0, .hi = 100,
      .help = "of pixels that are darker" },
    { .key = "value", .type = OPT_FLOAT, .num = 0.9, .lo = 1e-3, .hi = 1e3,
      .help = "what that luminance becomes" },
    { .key = NULL }
};

static const LightMeter average = {
    { "average", "Reinhard02 (2)", "logarithmic average of luminances", average_options },
    gain_average
};
static const LightMeter percentile = {
    { "percentile", "", "a luminance that few pixels exceed", percentile_options }, gain_percentile
};
const LightMeter *const meters[] = { &average, &percentile, NULL };
