/* tga.c -- Truevision Targa: reads colours, greys and colour maps, flat or run-length packed.
 *
 *      0  length of the name behind the header        8  x, y of the origin: not used
 *      1  1 if there is a colour map                 12  width, height
 *      2  1 mapped, 2 colour, 3 grey; + 8: packed    16  bits a pixel
 *      3  first index of the map, number of          17  0x10: right to left; 0x20: top to bottom
 *      7  its entries, bits of an entry                  0x0F: bits of alpha in a colour
 *                                                        0xC0: interleaved, never seen
 *
 * Numbers are little-endian. A colour is b g r, b g r a, or 5 bits each, blue lowest, in two bytes;
 * a grey is one byte, with 16 bits another one for alpha. A packet of a packed file is a byte n
 * and then, if n > 127, one pixel that stands for n - 127 of them, else n + 1 pixels. It may go on
 * in the next row.
 *
 * Source      [TGA]  Truevision TGA file format specification 2.0. Its footer is not needed.
 * Alpha is there if byte 17 says so: 8 bits of it beside 24 of colour or 8 of grey, one beside 15.
 * A plane that is 0 everywhere was not meant and is dropped. The samples are taken as sRGB.
 * Memory      12 bytes a pixel, 16 with alpha, taken after the pixels were checked from first to
 *             last. A packed file may hold 128 pixels in two bytes: max_pixels is the bound. */
#include "image/format.h"

#include <string.h>

enum { HEADER = 18, MAPPED = 1, COLOUR = 2, GREY = 3, PACKED = 8 };

typedef struct {
    const char *path;
    int      kind;                      /* MAPPED, COLOUR or GREY */
    bool     packed;
    unsigned bits, bytes;               /* of a pixel */
    uint32_t w, h;
    unsigned map_first, map_n, map_bits;
    const unsigned char *map;           /* borrowed: its entries */
    const unsigned char *data, *end;    /* borrowed: the pixels; they end before `end` */
    bool     from_right, from_top;
    unsigned alpha_bits;                /* 0, 1 or 8 */
    float    linear[256];
} Tga;

static unsigned u16le(const unsigned char *p) { return p[0] | (unsigned)p[1] << 8; }

static bool colour_bits(unsigned bits)
{
    return bits == 15 || bits == 16 || bits == 24 || bits == 32;
}

/* The format has no mark at its front, so all that the header may say is checked. */
static bool detect_tga(const unsigned char *b, size_t n)
{
    unsigned kind;

    if (n < HEADER || b[1] > 1)
        return false;
    kind = b[2] & ~(unsigned)PACKED;
    return (kind == MAPPED || kind == COLOUR || kind == GREY) &&
           (b[16] == 8 || colour_bits(b[16]));
}

static bool wrong(const Tga *f, const char *what)
{
    return err_at((Place){ f->path, 0, 0 }, "%s", what);
}

static bool check_kind(const Tga *f, bool has_map)
{
    if (f->kind == COLOUR && !colour_bits(f->bits))
        return wrong(f, "a colour has another size than 15, 16, 24 or 32 bits");
    if (f->kind == GREY && f->bits != 8 && f->bits != 16)
        return wrong(f, "a grey has another size than 8 or 16 bits");
    if (f->kind != MAPPED)
        return true;
    if (!has_map)
        return wrong(f, "the pixels are indices, but there is no colour map");
    if (f->bits != 8 && f->bits != 15 && f->bits != 16)
        return wrong(f, "an index has another size than 8, 15 or 16 bits");
    return colour_bits(f->map_bits) ||
           wrong(f, "an entry of the colour map has another size than 15, 16, 24 or 32 bits");
}

/* Bits of alpha in a colour of the file: what byte 17 says, if it is possible. */
static unsigned alpha_of(const Tga *f, unsigned said)
{
    unsigned bits = f->kind == MAPPED ? f->map_bits : f->bits;
    unsigned most = bits == 32 || (f->kind == GREY && bits == 16) ? 8 : bits == 16 ? 1 : 0;
    return said && said <= 8 && most ? most : 0;
}

static bool read_header(Tga *f, const unsigned char *b, size_t n, uint64_t max_pixels)
{
    bool has_map;
    size_t map_bytes;

    if (!detect_tga(b, n))
        return wrong(f, "is no TGA file of type 1, 2, 3, 9, 10 or 11");
    has_map = b[1] == 1;
    f->kind = b[2] & ~PACKED;
    f->packed = (b[2] & PACKED) != 0;
    f->map_first = u16le(b + 3);
    f->map_n = u16le(b + 5);
    f->map_bits = b[7];
    f->w = u16le(b + 12);
    f->h = u16le(b + 14);
    f->bits = b[16];
    f->bytes = (f->bits + 7) / 8;
    f->from_right = (b[17] & 0x10) != 0;
    f->from_top = (b[17] & 0x20) != 0;
    f->alpha_bits = alpha_of(f, b[17] & 15);
    if (!check_kind(f, has_map) ||
        !image_size_fits((Place){ f->path, 0, 0 }, f->w, f->h, max_pixels))
        return false;
    if (b[17] & 0xC0)
        return wrong(f, "the rows are interleaved, which is not supported");
    map_bytes = has_map ? (size_t)f->map_n * ((f->map_bits + 7) / 8) : 0;
    if (n - HEADER < b[0] + map_bytes)
        return wrong(f, "the file ends before its pixels begin");
    f->map = b + HEADER + b[0];
    f->data = f->map + map_bytes;
    f->end = b + n;
    return true;
}

static float five_bits(const Tga *f, unsigned v) { return f->linear[((v & 31) * 255 + 15) / 31]; }

static Rgb colour_of(const Tga *f, const unsigned char *p, unsigned bits)
{
    unsigned v;

    if (bits == 8)
        return rgb_all(f->linear[p[0]]);
    if (bits > 16)
        return rgb(f->linear[p[2]], f->linear[p[1]], f->linear[p[0]]);
    v = u16le(p);
    return rgb(five_bits(f, v >> 10), five_bits(f, v >> 5), five_bits(f, v));
}

static float alpha_at(const Tga *f, const unsigned char *p)
{
    if (f->alpha_bits == 1)
        return p[1] & 128 ? 1.0f : 0.0f;
    return (float)p[f->kind == GREY ? 1 : 3] / 255.0f;
}

/* The pixel at p into place `to` of the image, if there is one. */
static bool read_pixel(const Tga *f, const unsigned char *p, const Image *im, size_t to)
{
    unsigned k;

    if (f->kind == MAPPED) {
        k = f->bits == 8 ? p[0] : u16le(p);
        if (k < f->map_first || k - f->map_first >= f->map_n)
            return err_at((Place){ f->path, 0, 0 }, "a pixel has the colour %u, the map holds %u "
                          "from %u on", k, f->map_n, f->map_first);
        p = f->map + (size_t)(k - f->map_first) * ((f->map_bits + 7) / 8);
    }
    if (im)
        im->pixels[to] = colour_of(f, p, f->kind == MAPPED ? f->map_bits
                                         : f->kind == GREY ? 8 : f->bits);
    if (im && im->alpha)
        im->alpha[to] = alpha_at(f, p);
    return true;
}

/* Where the k-th pixel of the file belongs. */
static size_t place_of(const Tga *f, uint64_t k)
{
    uint32_t x = (uint32_t)(k % f->w), y = (uint32_t)(k / f->w);
    return (size_t)(f->from_top ? y : f->h - 1 - y) * f->w + (f->from_right ? f->w - 1 - x : x);
}

/* Reads all pixels into *im, or only checks them if im is NULL. A flat file is one packet. */
static bool read_pixels(const Tga *f, const Image *im)
{
    const unsigned char *p = f->data;
    uint64_t total = (uint64_t)f->w * f->h, k = 0;

    while (k < total) {
        uint64_t count = total - k, distinct = count;
        if (f->packed && p < f->end) {
            count = (*p & 127u) + 1;
            distinct = *p & 128 ? 1 : count;
            p++;
        }
        if (count > total - k)
            return wrong(f, "a run of pixels goes past the last row");
        if ((uint64_t)(f->end - p) < distinct * f->bytes)
            return err_at((Place){ f->path, 0, 0 }, "the file ends after %.0f of %.0f pixels",
                          (double)(k + (f->packed ? 0 : (uint64_t)(f->end - p) / f->bytes)),
                          (double)total);
        for (uint64_t i = 0; i < count && (im || f->kind == MAPPED); i++)
            if (!read_pixel(f, p + (distinct == 1 ? 0 : i * f->bytes), im, place_of(f, k + i)))
                return false;
        p += distinct * f->bytes;
        k += count;
    }
    return true;
}

static bool read_tga(Image *im, const char *path, const unsigned char *bytes, size_t n,
                     uint64_t max_pixels, Encoding encoding)
{
    Tga f = { .path = path };

    memset(im, 0, sizeof *im);
    if (!read_header(&f, bytes, n, max_pixels) || !read_pixels(&f, NULL) ||
        !(f.alpha_bits ? image_init_alpha : image_init)(im, f.w, f.h))
        return false;
    sample_table(f.linear, 255, encoding);
    read_pixels(&f, im);                /* was checked: cannot fail */
    image_drop_alpha(im, 0.0f);
    image_drop_alpha(im, 1.0f);
    return true;
}

const ImageFormat image_format_tga = {
    .info = { "tga", "TGA", "Truevision Targa: read only, sRGB", NULL },
    .extensions = "tga", .linear = false, .detect = detect_tga, .read = read_tga, .write = NULL
};
