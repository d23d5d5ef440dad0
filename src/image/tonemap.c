/* tonemap.c -- curves from light without a bound to [0,1], pixel by pixel, and their list.
 *
 * Source      [GIRT 4.1.2.5] names the logarithmic, the exponential and the S-shaped one;
 *             [Reinhard02] (3), (4); [Naka66] for the S, which is how receptors of the eye answer;
 *             [Hable10] for the film's.
 * Invariant   Each maps finite colours that are not negative to [0,1] and grows with each
 *             component that it treats alone; black stays black.
 * Hue         `logarithmic`, `reinhard` and `local` change the luminance and keep the ratios of the
 *             components; a saturated colour may still exceed 1 and is cut there. The others treat
 *             each component alone, so that bright colours pale, as they do on film. */
#include "image/tonemap.h"

#include "base/mem.h"

#include <float.h>
#include <string.h>

/* ---- for all ---- */

/* Curves are promised finite numbers that are not negative. */
static float usable(float x) { return x > 0.0f ? f_min(x, FLT_MAX) : 0.0f; }

Rgb tone_exposed(const Tone *t, size_t pixel)
{
    Rgb c = rgb_scale(t->im->pixels[pixel], t->gain);
    return rgb(usable(c.r), usable(c.g), usable(c.b));
}

Rgb tone_pixel(const Tone *t, size_t pixel)
{
    Rgb c = tone_exposed(t, pixel);
    return t->kind ? t->kind->map(t, c, pixel) : c;
}

bool tone_init(Tone *t, const Display *display, const Image *im)
{
    Opts o;

    memset(t, 0, sizeof *t);
    t->im = im;
    t->gain = display ? display_gain(display, im) : 1.0f;
    t->kind = display ? display->tonemap : NULL;
    if (!t->kind || !t->kind->prepare)
        return true;
    o = display->tonemap_opts;
    if (!o.defs)
        opts_default(&o, t->kind->info.options);
    return t->kind->prepare(t, &o);
}

void tone_clear(Tone *t)
{
    mem_free(t->local);
    memset(t, 0, sizeof *t);
}

static Rgb cut(Rgb c) { return rgb(clamp01(c.r), clamp01(c.g), clamp01(c.b)); }

/* In double: sums with 1 must not overflow. */
static double luminance(Rgb c) { return 0.299 * c.r + 0.587 * c.g + 0.114 * c.b; }

static Rgb scaled(Rgb c, double k)
{
    return cut(rgb((float)(c.r * k), (float)(c.g * k), (float)(c.b * k)));
}

/* The option, or if it is 0 the largest luminance of the picture. */
static double white_of(const Tone *t, const Opts *o)
{
    double white = opt_float(o, "white");

    for (size_t i = 0; opt_float(o, "white") == 0.0f && i < (size_t)t->im->w * t->im->h; i++)
        white = d_max(white, luminance(tone_exposed(t, i)));
    return white;
}

/* ---- linear and gamma ---- */

static Rgb map_linear(const Tone *t, Rgb c, size_t pixel)
{
    (void)t;
    (void)pixel;
    return cut(c);
}

static bool prepare_gamma(Tone *t, const Opts *o)
{
    t->a[0] = 1.0 / opt_float(o, "gamma");
    return true;
}

/* What the sRGB curve, which comes after it, makes x^(1/gamma) of. */
static Rgb map_gamma(const Tone *t, Rgb c, size_t pixel)
{
    float e = (float)t->a[0];

    (void)pixel;
    c = cut(c);
    return rgb(srgb_decode(m_pow(c.r, e)), srgb_decode(m_pow(c.g, e)), srgb_decode(m_pow(c.b, e)));
}

/* ---- logarithmic, exponential, S-shaped ---- */

static bool prepare_logarithmic(Tone *t, const Opts *o)
{
    t->a[0] = opt_float(o, "scale");
    t->a[1] = md_log(1.0 + t->a[0] * white_of(t, o));
    return true;
}

/* log(1 + s L) / log(1 + s white). For small s L the logarithm is s L: the ratio keeps its digits
 * by the first terms of the series. */
static Rgb map_logarithmic(const Tone *t, Rgb c, size_t pixel)
{
    double L = luminance(c), x = t->a[0] * L;
    double l = x < 1e-5 ? x * (1.0 - x / 2.0) : md_log(1.0 + x);

    (void)pixel;
    return L > 0.0 ? scaled(c, l / (t->a[1] * L)) : cut(c);
}

/* The answer of a film whose grains each catch light once: 1 - e^-x of them have been hit. The
 * difference loses its digits where x is small; there three terms of its series are as good as
 * double (the next is x^4 / 24). */
static float exposed(double x)
{
    return (float)(x < 1e-4 ? x * (1.0 - x / 2.0 * (1.0 - x / 3.0)) : 1.0 - md_exp(-x));
}

static Rgb map_exponential(const Tone *t, Rgb c, size_t pixel)
{
    (void)t;
    (void)pixel;
    return rgb(exposed(c.r), exposed(c.g), exposed(c.b));
}

static bool prepare_scurve(Tone *t, const Opts *o)
{
    t->a[0] = opt_float(o, "contrast");
    t->a[1] = opt_float(o, "middle");
    return true;
}

/* x^n / (x^n + m^n) = 1 / (1 + (m / x)^n) [Naka66]: half at m, an S on logarithmic axes. */
static float s_shaped(const Tone *t, float x)
{
    return x > 0.0f ? (float)(1.0 / (1.0 + md_pow(t->a[1] / x, t->a[0]))) : 0.0f;
}

static Rgb map_scurve(const Tone *t, Rgb c, size_t pixel)
{
    (void)pixel;
    return rgb(s_shaped(t, c.r), s_shaped(t, c.g), s_shaped(t, c.b));
}

/* ---- Reinhard's, and the film's ---- */

static bool prepare_reinhard(Tone *t, const Opts *o)
{
    double white = opt_float(o, "white");
    t->a[0] = white > 0.0 ? 1.0 / (white * white) : 0.0;
    return true;
}

/* [Reinhard02 (4)], without `white` (3). */
static Rgb map_reinhard(const Tone *t, Rgb c, size_t pixel)
{
    double L = luminance(c);

    (void)pixel;
    return scaled(c, (1.0 + L * t->a[0]) / (1.0 + L));
}

/* [Hable10]'s curve, without the shift that makes 0 of 0. */
static double film(double x)
{
    static const double A = 0.15, B = 0.50, C = 0.10, D = 0.20, E = 0.02, F = 0.30;
    return (x * (A * x + C * B) + D * E) / (x * (A * x + B) + D * F) - E / F;
}

static bool prepare_filmic(Tone *t, const Opts *o)
{
    t->a[0] = 1.0 / film(opt_float(o, "white"));
    return true;
}

/* Twice as bright first, as [Hable10] has it; the curve is flat to the left of that. */
static float of_film(const Tone *t, float x) { return clamp01((float)(film(2.0 * x) * t->a[0])); }

static Rgb map_filmic(const Tone *t, Rgb c, size_t pixel)
{
    (void)pixel;
    return rgb(of_film(t, c.r), of_film(t, c.g), of_film(t, c.b));
}

/* ---- the list ---- */

static const OptDef gamma_options[] = {
    { .key = "gamma", .type = OPT_FLOAT, .num = 2.2, .lo = 0.1, .hi = 10,
      .help = "a display with the curve x^gamma" },
    { .key = NULL }
};
static const OptDef logarithmic_options[] = {
    { .key = "white", .type = OPT_FLOAT, .num = 0, .lo = 0, .hi = 1e9,
      .help = "luminance that becomes 1; 0: the largest of the picture" },
    { .key = "scale", .type = OPT_FLOAT, .num = 10, .lo = 1e-3, .hi = 1e9,
      .help = "more of it lifts what is dark" },
    { .key = NULL }
};
static const OptDef scurve_options[] = {
    { .key = "contrast", .type = OPT_FLOAT, .num = 1.3, .lo = 0.1, .hi = 10 },
    { .key = "middle", .type = OPT_FLOAT, .num = 0.5, .lo = 1e-3, .hi = 1e3,
      .help = "what becomes one half" },
    { .key = NULL }
};
static const OptDef reinhard_options[] = {
    { .key = "white", .type = OPT_FLOAT, .num = 0, .lo = 0, .hi = 1e9,
      .help = "luminance that becomes 1; 0: none does" },
    { .key = NULL }
};
static const OptDef filmic_options[] = {
    { .key = "white", .type = OPT_FLOAT, .num = 11.2, .lo = 0.1, .hi = 1e4,
      .help = "twice what becomes 1" },
    { .key = NULL }
};

static const ToneMap linear = {
    { "linear", "", "cuts each channel at 1", NULL }, NULL, map_linear
};
static const ToneMap gamma_curve = {
    { "gamma", "", "x^(1/gamma) on the display, in place of the sRGB curve", gamma_options },
    prepare_gamma, map_gamma
};
static const ToneMap logarithmic = {
    { "logarithmic", "GIRT 4.1.2.5", "log(1 + s x) on luminance, keeps the hue",
      logarithmic_options }, prepare_logarithmic, map_logarithmic
};
static const ToneMap exponential = {
    { "exponential", "GIRT 4.1.2.5", "1 - exp(-x) of each channel, like film", NULL }, NULL,
    map_exponential
};
static const ToneMap scurve = {
    { "scurve", "Naka66", "x^n / (x^n + m^n) of each channel, like the eye", scurve_options },
    prepare_scurve, map_scurve
};
static const ToneMap reinhard = {
    { "reinhard", "Reinhard02 (4)", "x / (1 + x) on luminance, keeps the hue", reinhard_options },
    prepare_reinhard, map_reinhard
};
static const ToneMap filmic = {
    { "filmic", "Hable10", "a film's curve with toe and shoulder, of each channel",
      filmic_options }, prepare_filmic, map_filmic
};

const ToneMap *const tonemaps[] = {
    &linear, &gamma_curve, &logarithmic, &exponential, &scurve, &reinhard, &tonemap_local, &filmic,
    NULL
};
