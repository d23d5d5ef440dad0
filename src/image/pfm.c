/* pfm.c -- portable float maps: three floats a pixel (PF) or one (Pf), in either byte order.
 *
 *     PF\n  W H\n  SCALE\n  then W * H * (3 or 1) floats, rows from bottom to top
 *
 * Source      [PFM]  P. Debevec's description of the format, as the programs in use agree on it.
 * A negative SCALE means little-endian, a positive one big-endian; samples are multiplied by its
 * size, as pbrt does. One byte of white space stands before the floats ("\r\n" is taken as one
 * where the file is long enough for it).
 * Invariant   A file holds every float exactly: numbers, both zeros and infinities come back with
 *             the same bits. What is not a number is kept too (its payload is not promised),
 *             because this is the format in which faults of a render are looked for; `compare`
 *             counts such pixels.
 * Memory      12 bytes a pixel, 3 times the file at most (Pf), taken once its length is checked. */
#include "image/format.h"

#include "base/bits.h"
#include "base/file.h"
#include "base/text.h"

#include <stdio.h>
#include <string.h>

typedef struct {
    int64_t w, h;
    int     channels;
    float   scale;                  /* size of SCALE */
    bool    little;
    const unsigned char *data;      /* borrowed: the bottom row */
} Pfm;

static bool detect_pfm(const unsigned char *b, size_t n)
{
    return n >= 3 && b[0] == 'P' && (b[1] == 'F' || b[1] == 'f') && b[2] <= ' ';
}

static bool read_header(Text *t, Pfm *f, uint64_t max_pixels)
{
    float scale;
    Word magic = text_word(t);

    f->channels = word_is(magic, "PF") ? 3 : 1;
    if (f->channels == 1 && !word_is(magic, "Pf"))
        return err_at((Place){ t->file, 1, 1 }, "'PF' or 'Pf' was expected");
    text_space(t);
    if (!text_int(t, &f->w))
        return err_at(text_place(t), "the width was expected");
    text_space(t);
    if (!text_int(t, &f->h))
        return err_at(text_place(t), "the height was expected");
    if (!image_size_fits((Place){ t->file, 0, 0 }, f->w, f->h, max_pixels))
        return false;
    text_space(t);
    if (!text_float(t, &scale) || scale == 0.0f || !is_finite(scale))
        return err_at(text_place(t), "the scale was expected, a number that is not 0");
    f->little = scale < 0.0f;
    f->scale = fabsf(scale);
    return true;
}

/* Finds the floats behind the header and checks that all of them are there. */
static bool find_data(const Text *t, Pfm *f)
{
    uint64_t need = (uint64_t)f->w * (uint64_t)f->h * (uint64_t)f->channels * 4;
    uint64_t left = (uint64_t)(t->end - t->at);
    uint64_t skip = left >= need + 2 && t->at[0] == '\r' && t->at[1] == '\n' ? 2 : 1;

    if (left < need + skip)
        return err_at((Place){ t->file, 0, 0 }, "the file ends after %.0f bytes of pixels, "
                      "%.0f were expected", left ? (double)(left - 1) : 0.0, (double)need);
    f->data = (const unsigned char *)t->at + skip;
    return true;
}

static float sample(const unsigned char *p, bool little)
{
    uint32_t bits = little
        ? p[0] | (uint32_t)p[1] << 8 | (uint32_t)p[2] << 16 | (uint32_t)p[3] << 24
        : p[3] | (uint32_t)p[2] << 8 | (uint32_t)p[1] << 16 | (uint32_t)p[0] << 24;
    return float_of(bits);
}

static Rgb pixel(const Pfm *f, const unsigned char *p)
{
    Rgb c;
    c.r = sample(p, f->little);
    c.g = f->channels == 3 ? sample(p + 4, f->little) : c.r;
    c.b = f->channels == 3 ? sample(p + 8, f->little) : c.r;
    return f->scale == 1.0f ? c : rgb_scale(c, f->scale);
}

static bool read_pfm(Image *im, const char *path, const unsigned char *bytes, size_t n,
                 uint64_t max_pixels, Encoding encoding)
{
    Text t;
    Pfm f;

    (void)encoding;
    memset(im, 0, sizeof *im);
    text_init(&t, path, (const char *)bytes, n);
    if (!read_header(&t, &f, max_pixels) || !find_data(&t, &f) ||
        !image_init(im, (uint32_t)f.w, (uint32_t)f.h))
        return false;
    for (uint32_t y = im->h; y-- > 0; )
        for (uint32_t x = 0; x < im->w; x++, f.data += 4 * f.channels)
            *image_at(im, x, y) = pixel(&f, f.data);
    return true;
}

static void put_float(Out *o, float x)
{
    uint32_t bits = bits_of_float(x);

    out_write(o, (unsigned char[4]){ (unsigned char)bits, (unsigned char)(bits >> 8),
                                     (unsigned char)(bits >> 16), (unsigned char)(bits >> 24) }, 4);
}

static bool write_pfm(const Image *im, const char *path, const Display *display)
{
    char header[64];
    Out *o = out_open(path);

    (void)display;
    if (!o)
        return false;
    snprintf(header, sizeof header, "PF\n%lu %lu\n-1.0\n", (unsigned long)im->w,
             (unsigned long)im->h);
    out_text(o, header);
    for (uint32_t y = im->h; y-- > 0; )
        for (uint32_t x = 0; x < im->w; x++) {
            const Rgb *c = image_at(im, x, y);
            put_float(o, c->r);
            put_float(o, c->g);
            put_float(o, c->b);
        }
    return out_close(o);
}

const ImageFormat image_format_pfm = {
    .info = { "pfm", "PFM", "portable float map: exact linear floats", NULL },
    .extensions = "pfm", .linear = true, .detect = detect_pfm, .read = read_pfm,
    .write = write_pfm
};
