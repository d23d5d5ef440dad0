/* hdr.c -- Radiance pictures: three mantissas of 8 bits with one common exponent.
 *
 *     #?RADIANCE\n  KEY=VALUE lines  \n  an empty line  \n  -Y H +X W\n  then H scan lines
 *
 * A pixel is r g b e and means (r, g, b) * 2^(e - 136), black if e = 0. A scan line is packed in
 * one of two ways [Ward94]:
 *     old  pixels, where 1 1 1 n repeats the pixel before n times, and a second such count after
 *          it n * 256 times, and so on; a line without such counts is just flat
 *     new  2 2 and the width in two bytes, then the four components one after the other, each as
 *          runs (128 + n, value: n times) and copies (n, n values); lines of 8 to 32767 pixels only
 *
 * Source      [Ward94]  G. Ward, the Radiance file formats (picture files).
 * The resolution line names the slow axis first and may run either way along both: all eight are
 * read. Pixels are divided by the product of the EXPOSURE and COLORCORR lines, as the format asks.
 * Other lines (GAMMA, PRIMARIES, VIEW, comments) are passed over.
 * Departs     Mantissas are read as m, not m + 1/2, and rounded to nearest when written, as most
 *             programs do today: black and powers of two stay exact.
 * Invariant   A pixel written and read back differs by at most half a step of its exponent, 1/256
 *             of its largest component. Below 2^-128 is black; above 255 * 2^119, and infinity, is
 *             that number; negative and not a number is 0.
 * Memory      The scan lines are checked from first to last before memory is taken, so a broken
 *             file costs none. A whole one may hold far more pixels than bytes (12 bytes can be a
 *             line of 65,000 pixels); then max_pixels is the bound. */
#include "image/format.h"

#include "base/bits.h"
#include "base/file.h"
#include "base/mem.h"
#include "base/text.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

enum { NEW_MIN = 8, NEW_MAX = 32767, RUN_MIN = 4, RUN_MAX = 127, COPY_MAX = 128 };
#define RGBE_MOST (255 * 0x1p119)

typedef struct {
    const char *path;
    const unsigned char *at, *end;      /* borrowed: the scan lines not yet read */
    double   gain[3];                   /* 1 / (EXPOSURE * COLORCORR) */
    uint32_t w, h;                      /* of the image */
    uint32_t lines, length;             /* scan lines in the file, pixels of each */
    uint32_t line;                      /* the present one */
    int64_t  start, line_step, pixel_step;      /* where scan line and pixel stand in the image */
} Hdr;

/* ---- numbers ---- */

static double two_to(int k)             /* for exponents of normal doubles */
{
    return double_of((uint64_t)(k + 1023) << 52);
}

/* e with 2^(e-1) <= x < 2^e, for positive normal doubles. */
static int exponent_of(double x) { return (int)(bits_of(x) >> 52) - 1022; }

static Rgb colour_of(const unsigned char *p, const double *gain)
{
    double step = two_to(p[3] - 136);

    if (p[3] == 0)
        return rgb(0, 0, 0);
    return rgb((float)(p[0] * step * gain[0]), (float)(p[1] * step * gain[1]),
               (float)(p[2] * step * gain[2]));
}

static double usable(float x) { return x > 0.0f ? (x < RGBE_MOST ? x : RGBE_MOST) : 0.0; }

static void rgbe_of(Rgb c, unsigned char *p)
{
    double v[3] = { usable(c.r), usable(c.g), usable(c.b) }, most = v[0], steps;
    int e;

    for (int i = 1; i < 3; i++)
        most = v[i] > most ? v[i] : most;
    memset(p, 0, 4);
    if (most < 0x1p-128)
        return;
    e = exponent_of(most);
    if (floor(most * two_to(8 - e) + 0.5) > 255)        /* rounds up to the next power of two */
        e++;
    steps = two_to(8 - e);
    for (int i = 0; i < 3; i++)
        p[i] = (unsigned char)floor(v[i] * steps + 0.5);
    p[3] = (unsigned char)(e + 128);
}

/* ---- reading the header ---- */

static bool detect_hdr(const unsigned char *b, size_t n)
{
    return n >= 2 && b[0] == '#' && b[1] == '?';
}

static bool take_key(Text *line, const char *key)
{
    size_t n = strlen(key);

    if ((size_t)(line->end - line->at) < n || memcmp(line->at, key, n))
        return false;
    line->at += n;
    return true;
}

/* Divides gain by the numbers on the line: one for all, or one for each of the channels. */
static bool take_gain(Text *line, double *gain, int numbers)
{
    float x = 1.0f;

    for (int i = 0; i < 3; i++) {
        if ((i < numbers && !text_float(line, &x)) || !(x > 0.0f) || !is_finite(x))
            return err_at(text_place(line), "a number above 0 was expected");
        gain[i] /= x;
        if (!(gain[i] > 0.0) || !is_finite((float)gain[i]))
            return err_at(text_place(line), "the exposures multiply to nothing a float can hold");
    }
    return true;
}

static bool take_format(Text *line)
{
    Word w = text_word(line);
    char name[40];

    if (word_is(w, "32-bit_rle_rgbe"))
        return true;
    return err_at(text_place_of(line, w.s), "the format is '%s', 32-bit_rle_rgbe was expected",
                  word_copy(name, sizeof name, w));
}

static bool read_header(Text *t, double *gain)
{
    Text line;

    if (!detect_hdr((const unsigned char *)t->at, (size_t)(t->end - t->at)))
        return err_at((Place){ t->file, 1, 1 }, "'#?RADIANCE' was expected");
    text_line(t, &line);
    while (text_line(t, &line)) {
        if (text_done(&line))
            return true;
        if (take_key(&line, "EXPOSURE=") ? !take_gain(&line, gain, 1)
            : take_key(&line, "COLORCORR=") ? !take_gain(&line, gain, 3)
            : take_key(&line, "FORMAT=") && !take_format(&line))
            return false;
    }
    return err_at(text_place(t), "the header has no end, an empty line was expected");
}

typedef struct { char letter; bool forward; int64_t n; } Axis;

/* "-Y 480": Y runs forward, that is down from the top, if the sign is -; X if it is +. */
static bool take_axis(Text *line, Axis *a)
{
    Word w = text_word(line);

    if (w.n != 2 || (w.s[0] != '+' && w.s[0] != '-') || (w.s[1] != 'X' && w.s[1] != 'Y') ||
        !text_int(line, &a->n))
        return false;
    a->letter = w.s[1];
    a->forward = (w.s[1] == 'Y') == (w.s[0] == '-');
    return true;
}

static bool read_resolution(Text *t, Hdr *f, uint64_t max_pixels)
{
    Text line = *t;
    Axis slow = { 'Y', true, 0 }, fast = { 'X', true, 0 };
    bool ok = text_line(t, &line) && take_axis(&line, &slow) && take_axis(&line, &fast) &&
              slow.letter != fast.letter;

    text_blanks(&line);
    if (!ok || !text_done(&line))
        return err_at((Place){ t->file, line.line, 1 },
                      "the size was expected, like '-Y 480 +X 640'");
    if (!image_size_fits((Place){ t->file, line.line, 1 }, fast.n, slow.n, max_pixels))
        return false;
    f->lines = (uint32_t)slow.n;
    f->length = (uint32_t)fast.n;
    f->w = slow.letter == 'Y' ? f->length : f->lines;
    f->h = slow.letter == 'Y' ? f->lines : f->length;
    f->line_step = slow.letter == 'Y' ? f->w : 1;
    f->pixel_step = slow.letter == 'Y' ? 1 : f->w;
    f->start = (slow.forward ? 0 : (slow.n - 1) * f->line_step) +
               (fast.forward ? 0 : (fast.n - 1) * f->pixel_step);
    f->line_step *= slow.forward ? 1 : -1;
    f->pixel_step *= fast.forward ? 1 : -1;
    return true;
}

/* ---- reading scan lines: into row[4 * length], or only checking if row is NULL ---- */

static bool broken(const Hdr *f, const char *what)
{
    return err_at((Place){ f->path, 0, 0 }, "scan line %lu of %lu %s", (unsigned long)f->line + 1,
                  (unsigned long)f->lines, what);
}

/* Also takes flat lines. */
static bool read_old(Hdr *f, unsigned char *row)
{
    uint32_t x = 0, shift = 0;

    while (x < f->length) {
        const unsigned char *p = f->at;
        if (f->end - p < 4)
            return broken(f, "is cut off, more pixels were expected");
        f->at += 4;
        if (p[0] == 1 && p[1] == 1 && p[2] == 1) {
            uint64_t run = (uint64_t)p[3] << shift;
            if (x == 0)
                return broken(f, "begins with a repetition, a pixel was expected");
            if (run > f->length - x || shift > 24)
                return broken(f, "is overrun by a repetition");
            for (uint64_t k = 0; row && k < run; k++)
                memcpy(row + 4 * (x + k), row + 4 * ((size_t)x - 1), 4);
            x += (uint32_t)run;
            shift += 8;
        } else {
            if (row)
                memcpy(row + 4 * (size_t)x, p, 4);
            x++;
            shift = 0;
        }
    }
    return true;
}

static bool read_component(Hdr *f, unsigned char *row)
{
    for (uint32_t x = 0; x < f->length; ) {
        uint32_t n, bytes;
        bool run;
        if (f->end - f->at < 2)
            return broken(f, "is cut off, a run was expected");
        run = *f->at > 128;
        n = run ? *f->at & 127u : *f->at;
        bytes = run ? 1 : n;
        f->at++;
        if (n == 0 || n > f->length - x)
            return broken(f, n ? "is overrun by a run" : "has a run of no pixels");
        if ((size_t)(f->end - f->at) < bytes)
            return broken(f, "is cut off in a run");
        for (uint32_t k = 0; row && k < n; k++)
            row[4 * (size_t)(x + k)] = f->at[run ? 0 : k];
        f->at += bytes;
        x += n;
    }
    return true;
}

static bool read_line(Hdr *f, unsigned char *row)
{
    const unsigned char *p = f->at;
    bool packed = f->length >= NEW_MIN && f->length <= NEW_MAX && f->end - p >= 4 &&
                  p[0] == 2 && p[1] == 2 && p[2] < 128;

    if (!packed)
        return read_old(f, row);
    if (((uint32_t)p[2] << 8 | p[3]) != f->length)
        return broken(f, "has another width than the picture");
    f->at += 4;
    for (int c = 0; c < 4; c++)
        if (!read_component(f, row ? row + c : NULL))
            return false;
    return true;
}

static bool check_lines(Hdr *f)
{
    const unsigned char *begin = f->at;

    for (f->line = 0; f->line < f->lines; f->line++)
        if (!read_line(f, NULL))
            return false;
    f->at = begin;
    return true;
}

/* The lines have been checked, so that reading them again cannot fail. */
static void read_lines(Hdr *f, Image *im, unsigned char *row)
{
    for (f->line = 0; f->line < f->lines; f->line++) {
        Rgb *to = im->pixels + f->start + f->line * f->line_step;
        read_line(f, row);
        for (uint32_t x = 0; x < f->length; x++)
            to[x * f->pixel_step] = colour_of(row + 4 * (size_t)x, f->gain);
    }
}

static bool read_hdr(Image *im, const char *path, const unsigned char *bytes, size_t n,
                     uint64_t max_pixels, Encoding encoding)
{
    Text t;
    Hdr f = { .path = path, .gain = { 1.0, 1.0, 1.0 } };
    unsigned char *row;

    (void)encoding;
    memset(im, 0, sizeof *im);
    text_init(&t, path, (const char *)bytes, n);
    if (!read_header(&t, f.gain) || !read_resolution(&t, &f, max_pixels))
        return false;
    f.at = (const unsigned char *)t.at;
    f.end = bytes + n;
    if (!check_lines(&f) || !image_init(im, f.w, f.h))
        return false;
    row = mem_array(f.length, 4);
    if (row)
        read_lines(&f, im, row);
    else
        image_clear(im);
    mem_free(row);
    return row != NULL;
}

/* ---- writing ---- */

/* One component (every fourth byte) of a line of n pixels, as runs of RUN_MIN or more and copies
 * of what stands between them. */
static void put_component(Out *o, const unsigned char *p, uint32_t n)
{
    unsigned char buffer[1 + COPY_MAX];
    uint32_t x = 0;

    while (x < n) {
        uint32_t from = x, run = 0;
        for (; x < n; x += run) {                       /* find the next run worth sending */
            for (run = 1; x + run < n && run < RUN_MAX && p[4 * (size_t)(x + run)] ==
                 p[4 * (size_t)x]; run++)
                ;
            if (run >= RUN_MIN)
                break;
        }
        while (from < x) {
            uint32_t k = x - from < COPY_MAX ? x - from : COPY_MAX;
            buffer[0] = (unsigned char)k;
            for (uint32_t i = 0; i < k; i++)
                buffer[1 + i] = p[4 * (size_t)(from + i)];
            out_write(o, buffer, k + 1);
            from += k;
        }
        if (x < n) {
            out_write(o, (unsigned char[2]){ (unsigned char)(128 + run), p[4 * (size_t)x] }, 2);
            x += run;
        }
    }
}

static void put_line(Out *o, const unsigned char *row, uint32_t n)
{
    if (n < NEW_MIN || n > NEW_MAX) {
        out_write(o, row, 4 * (size_t)n);               /* flat: no pixel of ours is 1 1 1 n */
        return;
    }
    out_write(o, (unsigned char[4]){ 2, 2, (unsigned char)(n >> 8), (unsigned char)n }, 4);
    for (int c = 0; c < 4; c++)
        put_component(o, row + c, n);
}

static bool write_hdr(const Image *im, const char *path, const Display *display)
{
    char header[100];
    unsigned char *row = mem_array(im->w, 4);
    Out *o = row ? out_open(path) : NULL;

    (void)display;
    if (o) {
        snprintf(header, sizeof header, "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y %lu +X %lu\n",
                 (unsigned long)im->h, (unsigned long)im->w);
        out_text(o, header);
        for (uint32_t y = 0; y < im->h; y++) {
            for (uint32_t x = 0; x < im->w; x++)
                rgbe_of(*image_at(im, x, y), row + 4 * (size_t)x);
            put_line(o, row, im->w);
        }
    }
    mem_free(row);
    return o && out_close(o);
}

const ImageFormat image_format_hdr = {
    .info = { "hdr", "Ward94", "Radiance picture: 8 bits a channel and a common exponent", NULL },
    .extensions = "hdr pic rgbe", .linear = true, .detect = detect_hdr, .read = read_hdr,
    .write = write_hdr
};
