/* copyimage.c -- a picture copied by Metropolis sampling: figures 7.22 and 7.23 of [Cline07], with
 * the corrections of errata 7.5.
 *
 * A point walks over the picture and leaves a mark at every step. It is let go to a brighter place
 * always, to a darker one with the probability of their ratio, so in the long run it is everywhere
 * as often as that place is bright: its marks, of the colour of the place at luminance 1, add up to
 * the picture, up to a factor. All that it ever asks of the picture is how bright two places are.
 *
 * Writes copyimage.png: a column each for 1, 8 and 256 steps a pixel, and the picture itself. Rows,
 * and lines of the table: proposals anywhere, as in the figure; half of them near by, which are
 * more often accepted but lead to more of the same; and, to compare, points drawn independently.
 * Of n marks a pixel each of them would be off by 1/sqrt(n) where the picture is as bright as in
 * the mean; the error falls as that in all three. */
#include "bench/bench.h"
#include "base/mem.h"
#include "sampling/table.h"

#include <stdio.h>

enum { SIDE = 160, GAP = 4, COUNTS = 3, WAYS = 3, NEAR = 4 };

typedef enum { ANYWHERE, NEARBY, INDEPENDENT } Way;

typedef struct { uint32_t x, y; float lum; } Point;

static Point point_at(const Image *f, uint32_t x, uint32_t y)
{
    return (Point){ x, y, rgb_lum(*image_at(f, x, y)) };
}

static Point anywhere(const Image *f, Rng *r)
{
    uint32_t x = rng_below(r, f->w);
    return point_at(f, x, rng_below(r, f->h));
}

/* T(x>y) = T(y>x): the same square around both, on a picture without borders. */
static Point mutated(const Image *f, Way way, Point p, Rng *r)
{
    uint32_t dx, dy;

    if (way == ANYWHERE || rng_unit(r) < 0.5f)
        return anywhere(f, r);
    dx = rng_below(r, 2 * NEAR + 1);
    dy = rng_below(r, 2 * NEAR + 1);
    return point_at(f, (p.x + dx + f->w - NEAR) % f->w, (p.y + dy + f->h - NEAR) % f->h);
}

static void mark(const Image *f, Point p, Image *histogram)
{
    Rgb *h = image_at(histogram, p.x, p.y);
    *h = rgb_add(*h, rgb_scale(*image_at(f, p.x, p.y), 1.0f / p.lum));
}

static void copy_image(const Image *f, Image *histogram, Way way, uint64_t mutations, Rng *r)
{
    Point x, y;

    do
        x = anywhere(f, r);
    while (!(x.lum > 0.0f));
    for (uint64_t i = 0; i < mutations; i++) {
        y = mutated(f, way, x, r);
        if (rng_unit(r) * x.lum < y.lum)                /* with a = min(1, F(y) / F(x)), (7.13) */
            x = y;
        mark(f, x, histogram);
    }
}

static bool draw_image(const Image *f, Image *histogram, uint64_t draws, Rng *r)
{
    uint32_t n = f->w * f->h, k;
    float *lum = MEM_ARRAY(float, n);
    AliasTable table;
    bool ok = false;

    for (uint32_t i = 0; lum && i < n; i++)
        lum[i] = rgb_lum(f->pixels[i]);
    if (lum && alias_init(&table, lum, n)) {
        ok = true;
        for (uint64_t i = 0; i < draws; i++)
            if (alias_sample(&table, rng_unit(r), &k, NULL, NULL))
                mark(f, point_at(f, k % f->w, k / f->w), histogram);
        alias_clear(&table);
    }
    mem_free(lum);
    return ok;
}

static double mean_of(const Image *f)
{
    double sum = 0;

    for (size_t i = 0; i < (size_t)f->w * f->h; i++)
        sum += rgb_lum(f->pixels[i]);
    return sum / ((double)f->w * f->h);
}

/* The scale s = f_ave / h_ave, (7.12); then how far off the copy is, as a share of the mean. */
static double finish(const Image *f, Image *copy, uint64_t spp)
{
    double mean = mean_of(f), squares = 0;
    size_t n = (size_t)f->w * f->h;

    for (size_t i = 0; i < n; i++) {
        Rgb *c = &copy->pixels[i];
        double d;
        *c = rgb_scale(*c, (float)(mean / (double)spp));
        d = (double)rgb_lum(*c) - (double)rgb_lum(f->pixels[i]);
        squares += d * d;
    }
    return sqrt(squares / (double)n) / mean;
}

static void paste(Image *sheet, const Image *im, uint32_t column, uint32_t row)
{
    for (uint32_t y = 0; y < im->h; y++)
        for (uint32_t x = 0; x < im->w; x++)
            *image_at(sheet, column * (im->w + GAP) + x, row * (im->h + GAP) + y) =
                *image_at(im, x, y);
}

/* One line of the table, one row of the sheet. */
static void line(const Image *f, Way way, const char *name, Image *sheet)
{
    static const uint64_t spp[COUNTS] = { 1, 8, 256 };
    size_t n = (size_t)f->w * f->h;
    double error[COUNTS];

    for (uint32_t k = 0; k < COUNTS; k++) {
        Rng r = rng_seed(k);
        Image copy;
        if (!image_init(&copy, f->w, f->h))
            return;
        if (way != INDEPENDENT)
            copy_image(f, &copy, way, spp[k] * n, &r);
        else if (!draw_image(f, &copy, spp[k] * n, &r))
            return;
        error[k] = finish(f, &copy, spp[k]);
        paste(sheet, &copy, k, (uint32_t)way);
        image_clear(&copy);
    }
    paste(sheet, f, COUNTS, (uint32_t)way);
    printf("  %-24s%10.4f%10.4f%10.4f%12.2f%s\n", name, error[0], error[1], error[2],
           error[2] * 16, error[1] / error[2] > 4.5 && error[1] / error[2] < 7 ? "" : "  WRONG");
}

/* As a display would show it, or the lamp rules the walk: it is a hundred times the mean. */
static void limit(Image *f)
{
    for (size_t i = 0; i < (size_t)f->w * f->h; i++) {
        Rgb *c = &f->pixels[i];
        *c = rgb(clamp01(c->r), clamp01(c->g), clamp01(c->b));
    }
}

void bench_copyimage(void)
{
    static const char *const names[WAYS] = { "proposals anywhere", "half of them near by",
                                             "independent" };
    static const Display display = { 0 };
    RenderReport report;
    Image f, sheet;

    if (!bench_render("scenes/cornell.pbrt", "path", NULL, SIDE, 64, processors(), 0, &f, &report))
        return;
    limit(&f);
    printf("copyimage: rms error as a share of the mean, by steps a pixel; times sqrt of these\n"
           "  %-24s%10d%10d%10d%12s\n", "", 1, 8, 256, "sqrt(256)");
    if (image_init(&sheet, (COUNTS + 1) * (f.w + GAP) - GAP, WAYS * (f.h + GAP) - GAP)) {
        for (int w = 0; w < WAYS; w++)
            line(&f, (Way)w, names[w], &sheet);
        image_write(&sheet, "copyimage.png", &display);
        image_clear(&sheet);
    }
    image_clear(&f);
}
