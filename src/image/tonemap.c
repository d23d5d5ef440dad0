/* tonemap.c -- from light without a bound to what a display can show, pixel by pixel.
 *
 * Source      [Reinhard02]  Reinhard, Stark, Shirley, Ferwerda, "Photographic tone reproduction for
 *             digital images", SIGGRAPH 2002, (3).
 * Invariant   Each maps finite colours that are not negative to [0,1] and grows with each
 *             component that it treats alone; black stays black. */
#include "image/image.h"

static Rgb map_clamp(Rgb c) { return rgb(clamp01(c.r), clamp01(c.g), clamp01(c.b)); }

/* The answer of a film whose grains each catch light once: 1 - e^-x of them have been hit. The
 * difference loses its digits where x is small; there three terms of its series are as good as
 * double (the next is x^4 / 24). */
static float exposed(double x)
{
    return (float)(x < 1e-4 ? x * (1.0 - x / 2.0 * (1.0 - x / 3.0)) : 1.0 - md_exp(-x));
}
static Rgb map_exponential(Rgb c) { return rgb(exposed(c.r), exposed(c.g), exposed(c.b)); }

/* Divides by 1 + luminance, which keeps the hue; a saturated colour may still exceed 1 and is cut
 * there. In double: 1 + luminance must not overflow. */
static Rgb map_reinhard(Rgb c)
{
    double k = 1.0 / (1.0 + 0.299 * c.r + 0.587 * c.g + 0.114 * c.b);   /* [Reinhard02 (3)] */
    return map_clamp(rgb((float)(c.r * k), (float)(c.g * k), (float)(c.b * k)));
}

static const ToneMap tonemap_clamp = {
    { "clamp", "", "cuts each channel at 1", NULL }, map_clamp
};
static const ToneMap tonemap_exponential = {
    { "exponential", "", "1 - exp(-x) of each channel, like film", NULL }, map_exponential
};
static const ToneMap tonemap_reinhard = {
    { "reinhard", "Reinhard02 (3)", "x / (1 + x) on luminance, keeps the hue", NULL }, map_reinhard
};

const ToneMap *const tonemaps[] = {
    &tonemap_clamp, &tonemap_exponential, &tonemap_reinhard, NULL
};
