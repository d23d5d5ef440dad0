/* format.c -- sizes and display bytes. See format.h. */
#include "image/format.h"

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

bool quantiser_init(Quantiser *q, const Display *display, const Image *im)
{
    q->dither = display && display->dither;
    for (int b = 0; b < 256; b++)
        q->from[b] = srgb_decode(((float)b - 0.5f) / 255.0f);
    return tone_init(&q->tone, display, im);
}

void quantiser_clear(Quantiser *q) { tone_clear(&q->tone); }

/* The largest b with from[b] <= x, by halving. */
static unsigned char byte_of(const float from[256], float x)
{
    unsigned b = 0;
    for (unsigned step = 128; step; step /= 2)
        if (x >= from[b + step])
            b += step;
    return (unsigned char)b;
}

/* In [0,1), evenly spread over the pixels of any neighbourhood: [Roberts18]'s sequence of two
 * dimensions, whose steps are here along x and along y, in units of 2^-32. */
static float threshold_at(uint32_t x, uint32_t y)
{
    return (float)((x * 3242174889u + y * 2447445414u) >> 8) * 0x1p-24f;
}

static unsigned char dithered(float x, float threshold)
{
    return (unsigned char)f_min(255.0f, floorf(srgb_encode(x) * 255.0f + threshold));
}

void quantiser_row(const Quantiser *q, uint32_t y, unsigned char *bytes)
{
    for (uint32_t x = 0; x < q->tone.im->w; x++, bytes += 3) {
        Rgb c = tone_pixel(&q->tone, (size_t)y * q->tone.im->w + x);
        float t = threshold_at(x, y);
        bytes[0] = q->dither ? dithered(c.r, t) : byte_of(q->from, c.r);
        bytes[1] = q->dither ? dithered(c.g, t) : byte_of(q->from, c.g);
        bytes[2] = q->dither ? dithered(c.b, t) : byte_of(q->from, c.b);
    }
}
