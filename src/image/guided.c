/* guided.c -- the noise filter `guided`: in every window light is a linear function of the guides.
 *
 * Source      [He13]: (5), (6) in their form for guides of several numbers, (19).
 * Idea        Around pixel k, in a window of (2 r + 1)^2 pixels, the picture is fitted by
 *             q = a . I + b, I the guides: least squares, with eps |a|^2 against what noise alone
 *             would fit. Each pixel has the mean of what all windows that it is in say of it, so
 *             that windows leave no edges. What guides tell apart stays apart; the noise, of which
 *             they know nothing, goes.
 * Itself      What is left, as edges of shadows, of which guides know nothing either, is filtered
 *             once more, guided by itself, each channel alone: (5) with the mean variance of the
 *             noise in the window taken off the variance that is there. Where that is all noise
 *             nothing stays; where it is more, there is something to keep. Without guides that is
 *             all. */
#include "image/denoise.h"

#include "base/mem.h"

#include <string.h>

enum { MOST = GUIDES_MOST };

/* Fit around a pixel: of each channel the factors of the guides, then b. */
typedef struct { float c[3][MOST + 1]; } Fit;

typedef struct {
    const Image *from;          /* borrowed */
    Image *to, variance;        /* variance: owned */
    Guides guides;              /* owned */
    Fit   *fits;                /* owned: of each pixel */
    bool   by_guides;           /* else by itself */
    int    radius;
    double eps;
} Guided;

typedef struct { int x0, y0, x1, y1; double n; } Window;       /* half open */

static Window window_at(const Guided *g, int x, int y)
{
    int w = (int)g->from->w, h = (int)g->from->h, r = g->radius;
    Window k = { x < r ? 0 : x - r, y < r ? 0 : y - r, w - x > r ? x + r + 1 : w,
                 h - y > r ? y + r + 1 : h, 0 };
    k.n = (double)(k.x1 - k.x0) * (k.y1 - k.y0);
    return k;
}

/* Sums over a window, of guides taken from those of the pixel in its middle. */
typedef struct { double g[MOST], gg[MOST][MOST], p[3], gp[MOST][3]; } Sums;

static void add_pixel(Sums *s, const float *guide, const float *middle, int n, Rgb c)
{
    double p[3] = { c.r, c.g, c.b }, d[MOST];

    for (int i = 0; i < n; i++)
        d[i] = (double)guide[i] - middle[i];
    for (int k = 0; k < 3; k++)
        s->p[k] += p[k];
    for (int i = 0; i < n; i++) {
        s->g[i] += d[i];
        for (int j = 0; j <= i; j++)
            s->gg[i][j] += d[i] * d[j];
        for (int k = 0; k < 3; k++)
            s->gp[i][k] += d[i] * p[k];
    }
}

/* Solves A x = y for three y at once, A symmetric and positive definite, by L L^T = A [Higham02
 * 10.1]. A's lower half becomes L; y becomes x. */
static void solve(double a[MOST][MOST], double y[MOST][3], int n)
{
    for (int i = 0; i < n; i++) {
        for (int j = 0; j <= i; j++) {
            for (int k = 0; k < j; k++)
                a[i][j] -= a[i][k] * a[j][k];
            a[i][j] = i == j ? sqrt(a[i][i]) : a[i][j] / a[j][j];
        }
        for (int c = 0; c < 3; c++) {
            for (int k = 0; k < i; k++)
                y[i][c] -= a[i][k] * y[k][c];
            y[i][c] /= a[i][i];
        }
    }
    for (int i = n; i-- > 0; )
        for (int c = 0; c < 3; c++) {
            for (int k = i + 1; k < n; k++)
                y[i][c] -= a[k][i] * y[k][c];
            y[i][c] /= a[i][i];
        }
}

/* Means and covariances of the sums, and what fits them. */
static void fit_sums(Sums *s, const Window *w, const float *middle, int n, double eps, Fit *fit)
{
    for (int i = 0; i < n; i++)
        s->g[i] /= w->n;
    for (int c = 0; c < 3; c++)
        s->p[c] /= w->n;
    for (int i = 0; i < n; i++) {
        for (int j = 0; j <= i; j++)
            s->gg[i][j] = s->gg[i][j] / w->n - s->g[i] * s->g[j] + (i == j ? eps : 0);
        for (int c = 0; c < 3; c++)
            s->gp[i][c] = s->gp[i][c] / w->n - s->g[i] * s->p[c];
    }
    solve(s->gg, s->gp, n);
    for (int c = 0; c < 3; c++) {
        double b = s->p[c];
        for (int i = 0; i < n; i++) {
            b -= s->gp[i][c] * (s->g[i] + middle[i]);
            fit->c[c][i] = (float)s->gp[i][c];
        }
        fit->c[c][n] = (float)b;
    }
}

static void fit_guides(const Guided *g, int x, int y)
{
    Window w = window_at(g, x, y);
    size_t at = (size_t)y * g->from->w + (size_t)x, n = (size_t)g->guides.n;
    const float *middle = g->guides.v + at * n;
    Sums s;

    memset(&s, 0, sizeof s);
    for (int v = w.y0; v < w.y1; v++)
        for (int u = w.x0; u < w.x1; u++) {
            size_t i = (size_t)v * g->from->w + (size_t)u;
            add_pixel(&s, g->guides.v + i * n, middle, g->guides.n, g->from->pixels[i]);
        }
    fit_sums(&s, &w, middle, g->guides.n, g->eps, &g->fits[at]);
}

/* The channel k of a pixel. */
static double channel(Rgb c, int k) { return k == 0 ? c.r : k == 1 ? c.g : c.b; }

/* [He13 (5)] with I = p. */
static void fit_itself(const Guided *g, int x, int y)
{
    Window w = window_at(g, x, y);
    Fit *fit = &g->fits[(size_t)y * g->from->w + (size_t)x];

    for (int k = 0; k < 3; k++) {
        double sum = 0, squares = 0, noise = 0, mean, a;
        for (int v = w.y0; v < w.y1; v++)
            for (int u = w.x0; u < w.x1; u++) {
                double c = channel(*image_at(g->from, (uint32_t)u, (uint32_t)v), k);
                sum += c;
                squares += c * c;
                noise += channel(*image_at(&g->variance, (uint32_t)u, (uint32_t)v), k);
            }
        mean = sum / w.n;
        a = d_max(squares / w.n - mean * mean, 0);
        a = a > 0 ? d_max(a - noise / w.n, 0) / a : 0;
        fit->c[k][0] = (float)a;
        fit->c[k][1] = (float)(mean - a * mean);
    }
}

static void fit_row(void *ctx, uint32_t y)
{
    const Guided *g = ctx;

    for (uint32_t x = 0; x < g->from->w; x++)
        if (g->by_guides)
            fit_guides(g, (int)x, (int)y);
        else
            fit_itself(g, (int)x, (int)y);
}

/* [He13 (6)]: the mean of the fits of all windows that hold the pixel, at its guides. */
static Rgb mean_at(const Guided *g, int x, int y)
{
    Window w = window_at(g, x, y);
    size_t at = (size_t)y * g->from->w + (size_t)x;
    int n = g->by_guides ? g->guides.n : 1;
    float guide[3][MOST + 1], sum[3] = { 0, 0, 0 };

    for (int k = 0; k < 3; k++) {
        guide[k][0] = (float)channel(g->from->pixels[at], k);
        if (g->by_guides)
            memcpy(guide[k], g->guides.v + at * (size_t)n, (size_t)n * sizeof(float));
        guide[k][n] = 1.0f;
    }
    for (int v = w.y0; v < w.y1; v++)
        for (int u = w.x0; u < w.x1; u++) {
            const Fit *f = &g->fits[(size_t)v * g->from->w + (size_t)u];
            for (int k = 0; k < 3; k++)
                for (int i = 0; i <= n; i++)
                    sum[k] += f->c[k][i] * guide[k][i];
        }
    return rgb(sum[0] / (float)w.n, sum[1] / (float)w.n, sum[2] / (float)w.n);
}

static void mean_row(void *ctx, uint32_t y)
{
    const Guided *g = ctx;

    for (uint32_t x = 0; x < g->from->w; x++)
        *image_at(g->to, x, y) = mean_at(g, (int)x, (int)y);
}

static void fit_all(Guided *g, const Noisy *in, const Image *from, Image *to, bool by_guides)
{
    g->from = from;
    g->to = to;
    g->by_guides = by_guides;
    rows_run(in, fit_row, g);
    rows_run(in, mean_row, g);
}

/* First by guides, then what they leave by itself; rest: room for that. Light is not negative. */
static void fit_twice(Guided *g, const Noisy *in, Image *rest, Image *out)
{
    size_t n = (size_t)out->w * out->h;

    fit_all(g, in, in->colour, rest, true);
    for (size_t i = 0; i < n; i++)
        rest->pixels[i] = rgb_sub(in->colour->pixels[i], rest->pixels[i]);
    fit_all(g, in, rest, out, false);
    for (size_t i = 0; i < n; i++) {
        Rgb fit = rgb_sub(in->colour->pixels[i], rest->pixels[i]);
        Rgb c = rgb_add(fit, out->pixels[i]);
        out->pixels[i] = rgb(f_max(c.r, 0.0f), f_max(c.g, 0.0f), f_max(c.b, 0.0f));
    }
}

static bool run_guided(const Noisy *in, const Opts *o, Image *out)
{
    Guided g = { .radius = (int)opt_int(o, "radius"), .eps = opt_float(o, "eps") };
    Image rest = { 0 };
    bool ok;

    g.fits = MEM_ARRAY(Fit, (size_t)out->w * out->h);
    ok = g.fits && guides_init(&g.guides, in) && noisy_variance(in, &g.variance) &&
         image_init(&rest, out->w, out->h);
    if (ok && g.guides.n)
        fit_twice(&g, in, &rest, out);
    else if (ok)
        fit_all(&g, in, in->colour, out, false);
    image_clear(&rest);
    image_clear(&g.variance);
    guides_clear(&g.guides);
    mem_free(g.fits);
    return ok;
}

static const OptDef options[] = {
    { .key = "radius", .type = OPT_INT, .num = 3, .lo = 1, .hi = 50, .help = "of windows, pixels" },
    { .key = "eps", .type = OPT_FLOAT, .num = 0.001, .lo = 1e-6, .hi = 100,
      .help = "differences of guides, squared, that say nothing" },
    { .key = NULL }
};

const Denoiser denoiser_guided = {
    { "guided", "He13", "linear in guides, window by window; biased", options }, run_guided
};
