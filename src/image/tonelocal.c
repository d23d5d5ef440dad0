/* tonelocal.c -- the tone map `local`: dodging and burning, by hand of the picture itself.
 *
 * Source      [Reinhard02] section 3.2, (5) to (9).
 * Idea        x / (1 + x) with another x below the line: the mean luminance V of what is around the
 *             pixel, as far as that is of one kind. A dark spot among bright things gets darker by
 *             it, a bright one among dark things brighter: details keep their contrast.
 * How         Means are Gaussian, each 1.6 times as wide as the one before. A pixel takes the last
 *             of those that differ from the next, measured by their size, by less than a threshold:
 *             beyond is an edge. Beyond the border there is nothing to average.
 * Invariant   In a picture of one colour V is its luminance: the same as `reinhard`. */
#include "image/tonemap.h"

#include "base/mem.h"

#include <string.h>

enum { SCALES = 8, RADIUS_MOST = 47 };                   /* 3.04 STEP^SCALES CENTRE, rounded up */
static const double STEP = 1.6;
static const double CENTRE = 0.35355339059327379;       /* 1 / (2 sqrt 2): of the narrow mean */
static const float MOST = 1e30f;                        /* sums of such luminances are finite */

typedef struct {
    uint32_t w, h;
    float *lum, *narrow, *wide, *rows;                  /* owned, of each pixel */
    unsigned char *done;                                /* owned: an edge was met */
    float *chosen;                                      /* borrowed */
} Means;

/* Weights at 0 .. radius of exp(-(x / width)^2). Returns the radius, beyond which it is 1e-4. */
static int weights_of(double width, float *weight)
{
    int radius = (int)ceil(3.04 * width);

    for (int k = 0; k <= radius; k++)
        weight[k] = (float)md_exp(-(k / width) * (k / width));
    return radius;
}

/* Of n numbers, `step` apart, the mean around number i. */
static float mean_at(const float *from, int n, size_t step, int i, const float *weight, int radius)
{
    int lo = i < radius ? -i : -radius, hi = n - 1 - i < radius ? n - 1 - i : radius;
    float sum = 0.0f, total = 0.0f;

    for (int k = lo; k <= hi; k++) {
        float w = weight[k < 0 ? -k : k];
        sum += w * from[(size_t)(i + k) * step];
        total += w;
    }
    return sum / total;
}

static void blur(const Means *m, double width, float *to)
{
    float weight[RADIUS_MOST + 1];
    int radius = weights_of(width, weight), w = (int)m->w, h = (int)m->h;

    for (int y = 0; y < h; y++)
        for (int x = 0; x < w; x++)
            m->rows[(size_t)y * m->w + (size_t)x] =
                mean_at(m->lum + (size_t)y * m->w, w, 1, x, weight, radius);
    for (int y = 0; y < h; y++)
        for (int x = 0; x < w; x++)
            to[(size_t)y * m->w + (size_t)x] =
                mean_at(m->rows + x, h, m->w, y, weight, radius);
}

/* Goes from one scale to the next. edge: 2^phi a / s^2, of (7). */
static void choose(Means *m, float edge, float threshold)
{
    for (size_t i = 0; i < (size_t)m->w * m->h; i++) {
        float v = (m->narrow[i] - m->wide[i]) / (edge + m->narrow[i]);
        if (fabsf(v) >= threshold)
            m->done[i] = 1;
        if (!m->done[i])
            m->chosen[i] = m->narrow[i];
    }
}

static void run_scales(Means *m, const Opts *o)
{
    double s = 1.0, sharp = md_pow(2.0, opt_float(o, "sharpness")) * opt_float(o, "key");
    float *swap;

    blur(m, CENTRE * s, m->narrow);
    memcpy(m->chosen, m->narrow, (size_t)m->w * m->h * sizeof *m->chosen);
    for (int k = 0; k < SCALES; k++, s *= STEP) {
        blur(m, CENTRE * s * STEP, m->wide);
        choose(m, (float)(sharp / (s * s)), opt_float(o, "threshold"));
        swap = m->narrow;
        m->narrow = m->wide;
        m->wide = swap;
    }
}

static bool prepare_local(Tone *t, const Opts *o)
{
    size_t n = (size_t)t->im->w * t->im->h;
    Means m = { t->im->w, t->im->h, NULL, NULL, NULL, NULL, NULL, NULL };
    bool ok;

    m.lum = MEM_ARRAY(float, n);
    m.narrow = MEM_ARRAY(float, n);
    m.wide = MEM_ARRAY(float, n);
    m.rows = MEM_ARRAY(float, n);
    m.done = mem_array(n, 1);
    t->local = m.chosen = MEM_ARRAY(float, n);
    ok = m.lum && m.narrow && m.wide && m.rows && m.done && m.chosen;
    for (size_t i = 0; ok && i < n; i++)
        m.lum[i] = f_min(rgb_lum(tone_exposed(t, i)), MOST);
    if (ok)
        run_scales(&m, o);
    mem_free(m.lum);
    mem_free(m.narrow);
    mem_free(m.wide);
    mem_free(m.rows);
    mem_free(m.done);
    if (!ok)
        tone_clear(t);
    return ok;
}

static Rgb map_local(const Tone *t, Rgb c, size_t pixel)
{
    float k = 1.0f / (1.0f + t->local[pixel]);          /* (9) */
    return rgb(clamp01(c.r * k), clamp01(c.g * k), clamp01(c.b * k));
}

static const OptDef options[] = {
    { .key = "key", .type = OPT_FLOAT, .num = 0.18, .lo = 1e-3, .hi = 10,
      .help = "luminance of what is neither dark nor bright" },
    { .key = "sharpness", .type = OPT_FLOAT, .num = 8, .lo = 0, .hi = 30, .help = "phi" },
    { .key = "threshold", .type = OPT_FLOAT, .num = 0.05, .lo = 1e-4, .hi = 1,
      .help = "of what is an edge" },
    { .key = NULL }
};

const ToneMap tonemap_local = {
    { "local", "Reinhard02 (9)", "x / (1 + mean around), keeps hue and details", options },
    prepare_local, map_local
};
