/* sheet.c -- pictures side by side: bench sheet COLUMNS WIDTH HEIGHT OUT IN... writes a contact
 * sheet, each picture in a cell of its own, made smaller by the mean of the pixels that fall on one
 * of the sheet. What is smaller than its cell keeps its size. */
#include "bench/bench.h"

#include "image/image.h"

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

int sheet(int argc, char **argv)
{
    static const Display display = { 0 };
    uint32_t columns, w, h, n = (uint32_t)(argc - 4);
    Image all, im;
    bool ok;

    if (argc < 5 || atoi(argv[0]) < 1 || atoi(argv[1]) < 1 || atoi(argv[2]) < 1) {
        err_usage("expected COLUMNS WIDTH HEIGHT OUT IN...");
        return STATUS_USAGE;
    }
    columns = (uint32_t)atoi(argv[0]);
    w = (uint32_t)atoi(argv[1]);
    h = (uint32_t)atoi(argv[2]);
    ok = image_init(&all, columns * (w + RIM) + RIM, (n + columns - 1) / columns * (h + RIM) + RIM);
    for (uint32_t k = 0; ok && k < n; k++) {
        ok = image_read(&im, argv[4 + k], IMAGE_PIXELS_DEFAULT);
        if (ok)
            sheet_paste(&all, &im, RIM + k % columns * (w + RIM), RIM + k / columns * (h + RIM), w,
                        h);
        image_clear(&im);
    }
    ok = ok && image_write(&all, argv[3], &display);
    image_clear(&all);
    return ok ? STATUS_OK : STATUS_INPUT;
}
