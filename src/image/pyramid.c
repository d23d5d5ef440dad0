/* pyramid.c -- pictures between their pixels, and in smaller copies of themselves. See pyramid.h.
 *
 * Source      [Williams83] mip maps; the sides need not be powers of two here.
 * Invariant   A pixel of a level is the exact mean of the part of the level before that it covers,
 *             so all levels have the mean of the picture. */
#include "image/pyramid.h"

#include "base/mem.h"

#include <string.h>

/* ---- looking up ---- */

/* n is the side: the place of i in it, or -1 for none. */
static int64_t wrapped(int64_t i, int64_t n, Wrap wrap)
{
    if (i >= 0 && i < n)
        return i;
    if (wrap == WRAP_BLACK)
        return -1;
    if (wrap == WRAP_CLAMP)
        return i < 0 ? 0 : n - 1;
    i %= n;
    return i < 0 ? i + n : i;
}

static Rgb pixel(const Image *im, int64_t x, int64_t y, const ImagePlace *l)
{
    size_t i;

    x = wrapped(x, im->w, l->wrap);
    y = wrapped(y, im->h, l->wrap);
    if (x < 0 || y < 0)
        return rgb_all(0.0f);
    i = (size_t)y * im->w + (size_t)x;
    return l->alpha && im->alpha ? rgb_all(im->alpha[i]) : im->pixels[i];
}

/* Whether a place in pixels can be told from its neighbours: not so beyond the digits of a float,
 * and not if it is no number. */
static bool has_place(float x, float y) { return fabsf(x) < 1e9f && fabsf(y) < 1e9f; }

Rgb image_nearest(const Image *im, const ImagePlace *l)
{
    float x = floorf(l->u * (float)im->w), y = floorf((1.0f - l->v) * (float)im->h);

    if (!has_place(x, y))
        return pixel(im, 0, 0, l);
    return pixel(im, (int64_t)x, (int64_t)y, l);
}

/* Between pixel centres; v runs upwards, rows run downwards. */
Rgb image_bilinear(const Image *im, const ImagePlace *l)
{
    float x = l->u * (float)im->w - 0.5f, y = (1.0f - l->v) * (float)im->h - 0.5f;
    float fx = floorf(x), fy = floorf(y), a = x - fx, b = y - fy;
    int64_t i, j;
    Rgb top, bottom;

    if (!has_place(fx, fy))
        return pixel(im, 0, 0, l);
    i = (int64_t)fx;
    j = (int64_t)fy;
    top = rgb_add(rgb_scale(pixel(im, i, j, l), 1.0f - a), rgb_scale(pixel(im, i + 1, j, l), a));
    bottom = rgb_add(rgb_scale(pixel(im, i, j + 1, l), 1.0f - a),
                     rgb_scale(pixel(im, i + 1, j + 1, l), a));
    return rgb_add(rgb_scale(top, 1.0f - b), rgb_scale(bottom, b));
}

Rgb pyramid_trilinear(const Pyramid *p, const ImagePlace *l, float level)
{
    int k;
    Rgb fine, coarse;

    if (!(level > 0.0f))
        return image_bilinear(p->base, l);
    if (level >= (float)p->n)
        return image_bilinear(p->n ? &p->level[p->n - 1] : p->base, l);
    k = (int)level;
    fine = image_bilinear(k ? &p->level[k - 1] : p->base, l);
    coarse = image_bilinear(&p->level[k], l);
    return rgb_add(fine, rgb_scale(rgb_sub(coarse, fine), level - (float)k));
}

/* ---- making the levels ---- */

/* The pixels from[0..n) of a side of w that pixel i of a side of half, rounded up, covers, with
 * the part of it that each makes up. At most four: 2 and a part on either side. */
typedef struct { uint32_t from, n; double part[4]; } Cover;

static Cover cover_of(uint32_t w, uint32_t half, uint32_t i)
{
    uint64_t lo = (uint64_t)i * w, hi = lo + w;         /* in 1 / half of a pixel */
    Cover c = { (uint32_t)(lo / half), 0, { 0 } };

    for (uint64_t x = c.from; x * half < hi; x++) {
        uint64_t a = x * half > lo ? x * half : lo, b = (x + 1) * half < hi ? (x + 1) * half : hi;
        c.part[c.n++] = (double)(b - a) / w;
    }
    return c;
}

static void average(const Image *from, Image *to, uint32_t x, uint32_t y)
{
    Cover across = cover_of(from->w, to->w, x), down = cover_of(from->h, to->h, y);
    double sum[4] = { 0, 0, 0, 0 };
    size_t at = (size_t)y * to->w + x;

    for (uint32_t j = 0; j < down.n; j++)
        for (uint32_t i = 0; i < across.n; i++) {
            size_t k = (size_t)(down.from + j) * from->w + across.from + i;
            double part = down.part[j] * across.part[i];
            sum[0] += part * from->pixels[k].r;
            sum[1] += part * from->pixels[k].g;
            sum[2] += part * from->pixels[k].b;
            sum[3] += from->alpha ? part * from->alpha[k] : 0;
        }
    to->pixels[at] = rgb((float)sum[0], (float)sum[1], (float)sum[2]);
    if (to->alpha)
        to->alpha[at] = (float)sum[3];
}

static bool halve(const Image *from, Image *to)
{
    uint32_t w = from->w - from->w / 2, h = from->h - from->h / 2;

    if (!(from->alpha ? image_init_alpha : image_init)(to, w, h))
        return false;
    for (uint32_t y = 0; y < h; y++)
        for (uint32_t x = 0; x < w; x++)
            average(from, to, x, y);
    return true;
}

bool pyramid_init(Pyramid *p, const Image *base)
{
    int n = 0;

    for (uint32_t side = base->w > base->h ? base->w : base->h; side > 1; side -= side / 2)
        n++;
    *p = (Pyramid){ base, MEM_ARRAY(Image, (size_t)n), 0 };
    if (!p->level)
        return false;
    for (; p->n < n; p->n++)
        if (!halve(p->n ? &p->level[p->n - 1] : base, &p->level[p->n])) {
            pyramid_clear(p);
            return false;
        }
    return true;
}

void pyramid_clear(Pyramid *p)
{
    for (int i = 0; i < p->n; i++)
        image_clear(&p->level[i]);
    mem_free(p->level);
    memset(p, 0, sizeof *p);
}
