/* ppm.c -- portable pixmaps and greymaps of 8 or 16 bits a sample.
 *
 *     P6\n  W H\n  MAX\n  then W * H * 3 samples of one byte, or of two, high first, if MAX > 255
 *
 * P5 has one sample a pixel; P3 and P2 are the same with decimal numbers. A '#' before a number
 * starts a comment up to the end of the line.
 *
 * Source      [Netpbm]  ppm(5), pgm(5). Departs: the samples are taken as sRGB, as everybody does.
 * Memory      12 bytes a pixel, 12 times the file at most (P5), taken after the length is checked:
 *             a decimal sample needs two bytes, but for the last one. */
#include "image/format.h"

#include "base/file.h"
#include "base/mem.h"
#include "base/number.h"
#include "base/text.h"

#include <stdio.h>
#include <string.h>

typedef struct {
    int64_t w, h, most;
    int     channels;               /* 1 or 3 */
    bool    plain;                  /* decimal numbers */
    Encoding encoding;
    float   linear[256];            /* of samples, if most < 256 */
} Ppm;

static bool detect_ppm(const unsigned char *b, size_t n)
{
    return n >= 3 && b[0] == 'P' && (b[1] == '2' || b[1] == '3' || b[1] == '5' || b[1] == '6') &&
           (b[2] <= ' ' || b[2] == '#');
}

/* The next number, over white space and comments. Not reported. */
static bool next_number(Text *t, int64_t *v)
{
    Text comment;
    size_t n;
    int next;

    text_space(t);
    while (text_peek(t) == '#') {
        text_line(t, &comment);
        text_space(t);
    }
    n = number_int(t->at, t->end, v, NULL);
    t->at += n;
    next = text_peek(t);
    return n && (next <= ' ' || next == '#');
}

static bool read_header(Text *t, Ppm *f, uint64_t max_pixels)
{
    char kind;

    if (!detect_ppm((const unsigned char *)t->at, (size_t)(t->end - t->at)))
        return err_at((Place){ t->file, 1, 1 }, "'P2', 'P3', 'P5' or 'P6' was expected");
    kind = t->at[1];
    t->at += 2;
    f->plain = kind <= '3';
    f->channels = kind == '3' || kind == '6' ? 3 : 1;
    if (!next_number(t, &f->w))
        return err_at(text_place(t), "the width was expected");
    if (!next_number(t, &f->h))
        return err_at(text_place(t), "the height was expected");
    if (!image_size_fits((Place){ t->file, 0, 0 }, f->w, f->h, max_pixels))
        return false;
    if (!next_number(t, &f->most) || f->most < 1 || f->most > 65535)
        return err_at(text_place(t), "the largest sample was expected, 1 to 65535");
    if (f->most < 256)
        sample_table(f->linear, (unsigned)f->most, f->encoding);
    return true;
}

/* Steps over the one white byte, or the comment, behind the header; are there bytes enough for all
 * samples? */
static bool find_data(Text *t, const Ppm *f)
{
    Text comment;
    uint64_t samples = (uint64_t)f->w * (uint64_t)f->h * (uint64_t)f->channels;
    uint64_t need = f->plain ? 2 * samples - 1 : f->most < 256 ? samples : 2 * samples, left;

    if (text_peek(t) == '#')
        text_line(t, &comment);
    else if (!text_done(t))
        t->at++;
    left = (uint64_t)(t->end - t->at);
    if (left < need)
        return err_at((Place){ t->file, 0, 0 }, "the file ends after %.0f bytes of pixels, "
                      "%.0f were expected", (double)left, (double)need);
    return true;
}

static bool next_sample(Text *t, const Ppm *f, float *x)
{
    int64_t v;

    if (f->plain) {
        if (!next_number(t, &v))
            return err_at(text_place(t), "a sample was expected");
    } else {
        v = (unsigned char)*t->at++;
        if (f->most > 255)
            v = v << 8 | (unsigned char)*t->at++;
    }
    if (v < 0 || v > f->most)
        return err_at(f->plain ? text_place(t) : (Place){ t->file, 0, 0 },
                      "a sample is %.0f, 0 to %.0f was expected", (double)v, (double)f->most);
    *x = f->most < 256 ? f->linear[v] : sample_decode((float)v / (float)f->most, f->encoding);
    return true;
}

static bool read_pixels(Text *t, const Ppm *f, Image *im)
{
    size_t n = (size_t)im->w * im->h;

    for (size_t i = 0; i < n; i++) {
        Rgb *c = &im->pixels[i];
        if (!next_sample(t, f, &c->r))
            return false;
        c->g = c->b = c->r;
        if (f->channels == 3 && (!next_sample(t, f, &c->g) || !next_sample(t, f, &c->b)))
            return false;
    }
    return true;
}

static bool read_ppm(Image *im, const char *path, const unsigned char *bytes, size_t n,
                 uint64_t max_pixels, Encoding encoding)
{
    Text t;
    Ppm f;

    f.encoding = encoding;
    memset(im, 0, sizeof *im);
    text_init(&t, path, (const char *)bytes, n);
    if (!read_header(&t, &f, max_pixels) || !find_data(&t, &f) ||
        !image_init(im, (uint32_t)f.w, (uint32_t)f.h))
        return false;
    if (read_pixels(&t, &f, im))
        return true;
    image_clear(im);
    return false;
}

static void put_picture(Out *o, const Quantiser *q, unsigned char *row)
{
    const Image *im = q->tone.im;
    char header[64];

    snprintf(header, sizeof header, "P6\n%lu %lu\n255\n", (unsigned long)im->w,
             (unsigned long)im->h);
    out_text(o, header);
    for (uint32_t y = 0; y < im->h; y++) {
        quantiser_row(q, y, row);
        out_write(o, row, (size_t)im->w * 3);
    }
}

static bool write_ppm(const Image *im, const char *path, const Display *display)
{
    Quantiser q;
    unsigned char *row = MEM_ARRAY(unsigned char, (size_t)im->w * 3);
    Out *o;

    if (!row || !quantiser_init(&q, display, im)) {
        mem_free(row);
        return false;
    }
    o = out_open(path);
    if (o)
        put_picture(o, &q, row);
    quantiser_clear(&q);
    mem_free(row);
    return o && out_close(o);
}

const ImageFormat image_format_ppm = {
    .info = { "ppm", "Netpbm", "portable pixmap: 8 bits a channel, sRGB", NULL },
    .extensions = "ppm pgm pnm", .linear = false, .detect = detect_ppm, .read = read_ppm,
    .write = write_ppm
};
