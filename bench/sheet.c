/* sheet.c -- pictures side by side: bench sheet COLUMNS WIDTH HEIGHT OUT IN... writes a contact
 * sheet, each picture in a cell of its own, made smaller by the mean of the pixels that fall on one
 * of the sheet. What is smaller than its cell keeps its size. */
#include "base/mem.h"
#include "bench/bench.h"

#include <stdlib.h>

enum { RIM = 4 };

/* The mean of the pixels of `im` that cover pixel (x, y) of a picture of w by h. */
static Rgb mean_at(const Image *im, uint32_t x, uint32_t y, uint32_t w, uint32_t h)
{
    uint32_t x0 = (uint32_t)((uint64_t)x * im->w / w);
    uint32_t x1 = (uint32_t)((x + (uint64_t)1) * im->w / w);
    uint32_t y0 = (uint32_t)((uint64_t)y * im->h / h);
    uint32_t y1 = (uint32_t)((y + (uint64_t)1) * im->h / h);
    Rgb sum = { 0, 0, 0 };

    for (uint32_t v = y0; v < y1; v++)
        for (uint32_t u = x0; u < x1; u++)
            sum = rgb_add(sum, *image_at(im, u, v));
    return rgb_scale(sum, 1.0f / ((float)(x1 - x0) * (float)(y1 - y0)));
}

void sheet_paste(Image *all, const Image *im, uint32_t left, uint32_t top, uint32_t w, uint32_t h)
{
    double s = d_min(1, d_min((double)w / im->w, (double)h / im->h));
    uint32_t tw = (uint32_t)d_max(1, s * im->w + 0.5), th = (uint32_t)d_max(1, s * im->h + 0.5);

    left += (w - tw) / 2;
    top += (h - th) / 2;
    for (uint32_t y = 0; y < th; y++)
        for (uint32_t x = 0; x < tw; x++)
            *image_at(all, left + x, top + y) = mean_at(im, x, y, tw, th);
}

bool sheet_of(const Image *im, uint32_t n, uint32_t columns, uint32_t w, uint32_t h,
              const char *file)
{
    static const Display display = { 0 };
    Image all;
    bool ok = image_init(&all, columns * (w + RIM) + RIM,
                         (n + columns - 1) / columns * (h + RIM) + RIM);

    for (uint32_t k = 0; ok && k < n; k++)
        sheet_paste(&all, &im[k], RIM + k % columns * (w + RIM), RIM + k / columns * (h + RIM),
                    w, h);
    ok = ok && image_write(&all, file, &display);
    image_clear(&all);
    return ok;
}

int sheet(int argc, char **argv)
{
    uint32_t n = (uint32_t)(argc - 4);
    bool ok = true;
    Image *im;

    if (argc < 5 || atoi(argv[0]) < 1 || atoi(argv[1]) < 1 || atoi(argv[2]) < 1) {
        err_usage("expected COLUMNS WIDTH HEIGHT OUT IN...");
        return STATUS_USAGE;
    }
    im = MEM_ARRAY(Image, n);
    for (uint32_t k = 0; im && ok && k < n; k++)
        ok = image_read(&im[k], argv[4 + k], IMAGE_PIXELS_DEFAULT);
    ok = im && ok && sheet_of(im, n, (uint32_t)atoi(argv[0]), (uint32_t)atoi(argv[1]),
                              (uint32_t)atoi(argv[2]), argv[3]);
    for (uint32_t k = 0; im && k < n; k++)
        image_clear(&im[k]);
    mem_free(im);
    return ok ? STATUS_OK : STATUS_INPUT;
}
