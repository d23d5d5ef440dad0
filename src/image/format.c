/* format.c -- sizes and display bytes. See format.h. */
#include "image/format.h"

#include <float.h>

bool image_size_fits(Place at, int64_t w, int64_t h, uint64_t max_pixels)
{
    if (w < 1 || h < 1)
        return err_at(at, "the image has no pixels, 1 x 1 or more were expected");
    if (w > INT32_MAX || h > INT32_MAX || (uint64_t)w * (uint64_t)h > max_pixels)
        return err_at(at, "the image has %.0f x %.0f pixels, at most %.0f in all were expected "
                      "(--max-pixels)", (double)w, (double)h, (double)max_pixels);
    return true;
}

float sample_decode(float x, Encoding encoding)
{
    if (encoding <= 0.0f)
        return srgb_decode(x);
    return encoding == 1.0f ? x : m_pow(x, encoding);
}

void sample_table(float *table, unsigned most, Encoding encoding)
{
    for (unsigned v = 0; v <= most; v++)
        table[v] = sample_decode((float)v / (float)most, encoding);
}

void quantiser_init(Quantiser *q, const Display *display)
{
    q->tonemap = display ? display->tonemap : NULL;
    q->gain = display ? m_pow(2.0f, display->exposure) : 1.0f;
    for (int b = 0; b < 256; b++)
        q->from[b] = srgb_decode(((float)b - 0.5f) / 255.0f);
}

/* The largest b with from[b] <= x, by halving. */
static unsigned char byte_of(const float from[256], float x)
{
    unsigned b = 0;
    for (unsigned step = 128; step; step /= 2)
        if (x >= from[b + step])
            b += step;
    return (unsigned char)b;
}

/* Tone maps are promised finite numbers that are not negative. */
static float usable(float x) { return x > 0.0f ? f_min(x, FLT_MAX) : 0.0f; }

void quantiser_row(const Quantiser *q, const Rgb *row, size_t n, unsigned char *bytes)
{
    for (size_t i = 0; i < n; i++) {
        Rgb c = rgb(usable(row[i].r * q->gain), usable(row[i].g * q->gain),
                    usable(row[i].b * q->gain));
        if (q->tonemap)
            c = q->tonemap->map(c);
        bytes[3 * i] = byte_of(q->from, c.r);
        bytes[3 * i + 1] = byte_of(q->from, c.g);
        bytes[3 * i + 2] = byte_of(q->from, c.b);
    }
}
