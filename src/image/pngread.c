/* pngread.c -- reads portable network graphics: all colour types, depths and forms of the format.
 *
 *     signature, then chunks: length, four letters, data, CRC-32
 *     IHDR  width, height, depth, colour type (1 palette, 2 colour, 4 alpha), 0, 0, interlaced
 *     PLTE  the palette       tRNS  its alpha, or the colour that is transparent
 *     gAMA, sRGB, iCCP        what the samples mean
 *     IDAT  one zlib stream: rows, each after the number of its filter        IEND
 *
 * Source      [PNG]  W3C, second edition; section numbers stand at the lines.
 * Judgement   The samples are sRGB, as nearly all files mean it; so are those of a file with a
 *             colour profile, and of one whose gAMA is about 1 / 2.2. Another gAMA without sRGB
 *             beside it is taken at its word [PNG 11.3.3.2]: linear = sample^(1 / gAMA). 1 is how a
 *             file says that it is linear.
 * Refuses     what is not whole: a wrong checksum of any chunk or of the stream, a missing IEND,
 *             pixels without a colour, critical chunks that it does not know.
 * Memory      16 bytes a pixel, besides 50 KB and two rows. The packed bytes must be as many as the
 *             rows need at least; and unless rows and pixels each fit in 16 bytes for each of the
 *             file, the whole stream is checked before memory is taken for them. */
#include "image/format.h"
#include "image/deflate.h"
#include "image/inflate.h"
#include "image/png.h"

#include "base/mem.h"

enum { GREY = 0, COLOUR = 2, MAPPED = 3, ALPHA = 4, CHUNK = 12 };

typedef struct {
    const char *path;
    const unsigned char *bytes, *end;           /* borrowed: the file */
    uint32_t w, h;
    unsigned depth, type, channels;             /* depth: bits of a sample */
    bool     interlaced;
    const unsigned char *palette, *key;         /* borrowed: PLTE and tRNS, or NULL */
    unsigned colours, keys;                     /* entries of the palette, bytes of tRNS */
    bool     srgb, ended;
    uint32_t gamma;                             /* of gAMA, 0: none */
    const unsigned char *idat;                  /* borrowed: the first IDAT chunk */
    const unsigned char *next;                  /* the chunk that the stream goes on in */
    uint64_t packed;                            /* bytes of all of them */
    Encoding encoding;
    float    linear[256];                       /* of samples of up to 8 bits */
} Png;

static uint32_t u32be(const unsigned char *p)
{
    return (uint32_t)p[0] << 24 | (uint32_t)p[1] << 16 | (uint32_t)p[2] << 8 | p[3];
}

static bool wrong(const Png *p, const char *what)
{
    return err_at((Place){ p->path, 0, 0 }, "%s", what);
}

/* ---- chunks ---- */

static bool is(const unsigned char *chunk, const char *type) { return !memcmp(chunk + 4, type, 4); }

/* A whole chunk stands there, with letters for a name and the right sum. */
static bool check_chunk(const Png *p, const unsigned char *c)
{
    size_t left = (size_t)(p->end - c);

    if (left < CHUNK)
        return wrong(p, "the file ends before its last chunk, IEND");
    for (int i = 4; i < 8; i++)
        if ((c[i] | 32) < 'a' || (c[i] | 32) > 'z')
            return wrong(p, "a chunk was expected, four letters after its length");
    if (u32be(c) > left - CHUNK)
        return err_at((Place){ p->path, 0, 0 }, "the file ends within the chunk %.4s",
                      (const char *)c + 4);
    if (checksum_crc32(0, c + 4, u32be(c) + 4) != u32be(c + 8 + u32be(c)))
        return err_at((Place){ p->path, 0, 0 }, "the chunk %.4s has a wrong checksum",
                      (const char *)c + 4);
    return true;
}

static bool read_header(Png *p, const unsigned char *c, uint64_t max_pixels)
{
    static const uint8_t depths[7] = { 31, 0, 24, 15, 24, 0, 24 };  /* bit k: 2^k [PNG 11.2.2] */
    static const uint8_t channels[7] = { 1, 0, 3, 1, 2, 0, 4 };
    unsigned k = 0;

    if (!is(c, "IHDR") || u32be(c) != 13)
        return wrong(p, "the first chunk was expected to be IHDR with 13 bytes");
    p->w = u32be(c + 8);
    p->h = u32be(c + 12);
    p->depth = c[16];
    p->type = c[17];
    while (k < 5 && 1u << k != p->depth)
        k++;
    if (k == 5 || p->type > 6 || !(depths[p->type] >> k & 1))
        return err_at((Place){ p->path, 0, 0 }, "there is no colour type %u with %u bits a sample",
                      p->type, p->depth);
    if (c[18] || c[19] || c[20] > 1)
        return wrong(p, "an unknown way of packing or interlacing");
    p->channels = channels[p->type];
    p->interlaced = c[20] == 1;
    return image_size_fits((Place){ p->path, 0, 0 }, p->w, p->h, max_pixels);
}

static bool read_transparency(Png *p, const unsigned char *c)
{
    unsigned n = u32be(c) > 256 ? 257 : u32be(c);

    if (p->type & ALPHA)                                /* there is an alpha of its own */
        return true;
    if (p->type == MAPPED ? n > p->colours : n != 2 * p->channels)
        return wrong(p, "tRNS has another length than the colours need");
    p->key = c + 8;
    p->keys = n;
    return true;
}

static bool read_data(Png *p, const unsigned char *c, bool follows)
{
    if (p->type == MAPPED && !p->palette)
        return wrong(p, "the pixels are indices, but there is no palette");
    if (p->idat && !follows)
        return wrong(p, "the chunks IDAT do not stand together");
    if (!p->idat)
        p->idat = c;
    p->packed += u32be(c);
    return true;
}

static bool read_palette(Png *p, const unsigned char *c)
{
    uint32_t n = u32be(c);

    if (p->palette || p->idat || n == 0 || n > 768 || n % 3)
        return wrong(p, "one palette of 1 to 256 colours was expected, before the pixels");
    p->palette = c + 8;
    p->colours = n / 3;
    return true;
}

/* One chunk after IHDR; before: the one in front of it. */
static bool read_chunk(Png *p, const unsigned char *c, const unsigned char *before)
{
    if (is(c, "PLTE"))
        return read_palette(p, c);
    if (is(c, "IDAT"))
        return read_data(p, c, is(before, "IDAT"));
    if (is(c, "tRNS") && !p->idat)
        return read_transparency(p, c);
    if (is(c, "IEND")) {
        p->ended = true;
        return p->idat || wrong(p, "there are no pixels");
    }
    if (is(c, "sRGB") || is(c, "iCCP"))
        p->srgb = true;
    else if (is(c, "gAMA") && u32be(c) == 4)
        p->gamma = u32be(c + 8);
    else if (!(c[4] & 32))                              /* a capital: critical [PNG 5.4] */
        return err_at((Place){ p->path, 0, 0 }, "there is an unknown critical chunk, %.4s",
                      (const char *)c + 4);
    return true;
}

static bool read_chunks(Png *p, uint64_t max_pixels)
{
    const unsigned char *c = p->bytes + PNG_SIGNATURE, *before = c;

    if (!check_chunk(p, c) || !read_header(p, c, max_pixels))
        return false;
    while (!p->ended) {
        before = c;
        c += CHUNK + u32be(c);
        if (!check_chunk(p, c) || !read_chunk(p, c, before))
            return false;
    }
    return true;
}

/* gAMA is written in 1e-5; 45455 stands for sRGB in files of all kinds of programs. */
static Encoding encoding_of(const Png *p, Encoding asked)
{
    if (asked != ENCODING_BY_FILE || p->srgb || p->gamma == 0 ||
        (p->gamma > 45000 && p->gamma < 46000))
        return asked;
    return (Encoding)(1e5 / p->gamma);
}

/* The next piece of the zlib stream, for inflate.c. */
static bool next_piece(void *ctx, const unsigned char **at, const unsigned char **end)
{
    Png *p = ctx;

    if (!is(p->next, "IDAT"))
        return false;
    *at = p->next + 8;
    *end = *at + u32be(p->next);
    p->next = *end + 4;
    return true;
}

/* ---- rows ---- */

typedef struct { uint32_t x0, y0, dx, dy; } Pass;       /* pixels x0 + i dx, y0 + j dy */

/* [PNG 8.2]; pass 0 is all of a picture that is not interlaced. */
static Pass pass_of(unsigned k)
{
    static const Pass passes[8] = {
        { 0, 0, 1, 1 }, { 0, 0, 8, 8 }, { 4, 0, 8, 8 }, { 0, 4, 4, 8 }, { 2, 0, 4, 4 },
        { 0, 2, 2, 4 }, { 1, 0, 2, 2 }, { 0, 1, 1, 2 }
    };
    return passes[k];
}
static unsigned first_pass(const Png *p) { return p->interlaced ? 1 : 0; }
static unsigned last_pass(const Png *p) { return p->interlaced ? 7 : 0; }

/* How many of 0 .. n-1 are from + k step. */
static uint32_t count_of(uint32_t n, uint32_t from, uint32_t step)
{
    return n > from ? (n - from - 1) / step + 1 : 0;
}

static uint64_t row_bytes(const Png *p, uint32_t w)
{
    return ((uint64_t)w * p->channels * p->depth + 7) / 8;
}

static uint64_t unpacked_bytes(const Png *p)
{
    uint64_t sum = 0;

    for (unsigned k = first_pass(p); k <= last_pass(p); k++) {
        Pass a = pass_of(k);
        uint32_t w = count_of(p->w, a.x0, a.dx);
        if (w)
            sum += count_of(p->h, a.y0, a.dy) * (1 + row_bytes(p, w));
    }
    return sum;
}

/* Differences become bytes again. step: bytes from a pixel to the next one. */
static void unfilter(int filter, unsigned char *row, const unsigned char *above, size_t n,
                     size_t step)
{
    for (size_t i = 0; i < n && i < step; i++)
        row[i] = (unsigned char)(row[i] + png_prediction(filter, 0, above[i], 0));
    for (size_t i = step; i < n; i++)
        row[i] = (unsigned char)(row[i] +
                                 png_prediction(filter, row[i - step], above[i], above[i - step]));
}

/* Sample k of a row. */
static unsigned sample(const Png *p, const unsigned char *row, size_t k)
{
    size_t bit = k * p->depth;

    if (p->depth == 8)
        return row[k];
    if (p->depth == 16)
        return (unsigned)row[2 * k] << 8 | row[2 * k + 1];
    return row[bit / 8] >> (8 - p->depth - bit % 8) & ((1u << p->depth) - 1);
}

static float linear(const Png *p, unsigned v)
{
    return p->depth == 16 ? sample_decode((float)v / 65535.0f, p->encoding) : p->linear[v];
}

/* True if the three samples are those of the transparent colour [PNG 11.3.2.1]. */
static bool is_key(const Png *p, const unsigned *v)
{
    for (unsigned k = 0; k < p->channels; k++)
        if (v[k] != ((unsigned)p->key[2 * k] << 8 | p->key[2 * k + 1]))
            return false;
    return true;
}

static void put_pixel(const Png *p, const Image *im, size_t to, const unsigned *v)
{
    unsigned most = (1u << p->depth) - 1, colours = p->channels - (p->type & ALPHA ? 1 : 0);
    float alpha = 1.0f;
    Rgb c;

    if (p->type == MAPPED) {
        const unsigned char *e = p->palette + 3 * v[0];
        c = rgb(p->linear[e[0]], p->linear[e[1]], p->linear[e[2]]);
        alpha = v[0] < p->keys ? (float)p->key[v[0]] / 255.0f : 1.0f;
    } else {
        c = rgb_all(linear(p, v[0]));
        if (colours == 3) {
            c.g = linear(p, v[1]);
            c.b = linear(p, v[2]);
        }
        if (p->type & ALPHA)
            alpha = (float)v[colours] / (float)most;
        else if (p->key)
            alpha = is_key(p, v) ? 0.0f : 1.0f;
    }
    im->pixels[to] = c;
    if (im->alpha)
        im->alpha[to] = alpha;
}

/* The w pixels of a row into the image, or only checked if im is NULL. */
static bool read_row(const Png *p, const Image *im, const unsigned char *row, uint32_t w, Pass a,
                     uint32_t y)
{
    unsigned v[4];

    for (uint32_t i = 0; i < w && (im || p->type == MAPPED); i++) {
        for (unsigned k = 0; k < p->channels; k++)
            v[k] = sample(p, row, (size_t)i * p->channels + k);
        if (p->type == MAPPED && v[0] >= p->colours)
            return err_at((Place){ p->path, 0, 0 }, "a pixel has the colour %u, the palette holds "
                          "%u from 0 on", v[0], p->colours);
        if (im)
            put_pixel(p, im, (size_t)y * p->w + a.x0 + (size_t)i * a.dx, v);
    }
    return true;
}

static bool broken(const Png *p, const Inflate *f)
{
    return err_at((Place){ p->path, 0, 0 }, "the packed pixels are wrong: the zlib stream %s",
                  f->fault ? f->fault : "holds fewer rows than the picture");
}

/* rows: room for two of the widest ones, each with one byte in front. */
static bool read_pass(const Png *p, const Image *im, Inflate *f, Pass a, unsigned char *rows)
{
    uint32_t w = count_of(p->w, a.x0, a.dx);
    size_t n = (size_t)row_bytes(p, w), step = (p->channels * p->depth + 7) / 8;
    unsigned char *row = rows, *above = rows + n + 1, *swap;

    memset(above, 0, n + 1);
    for (uint32_t y = a.y0; w && y < p->h; y += a.dy) {
        if (inflate_take(f, row, n + 1) <= n)
            return broken(p, f);
        if (row[0] >= PNG_FILTERS)
            return wrong(p, "a row has an unknown filter, 0 to 4 was expected");
        unfilter(row[0], row + 1, above + 1, n, step);
        if (!read_row(p, im, row + 1, w, a, y))
            return false;
        swap = above;
        above = row;
        row = swap;
        if (p->h - y <= a.dy)                           /* so that y cannot overflow */
            break;
    }
    return true;
}

static bool read_stream(Png *p, const Image *im, Inflate *f, unsigned char *rows)
{
    p->next = p->idat;
    inflate_init(f, next_piece, p);
    for (unsigned k = first_pass(p); k <= last_pass(p); k++)
        if (!read_pass(p, im, f, pass_of(k), rows))
            return false;
    return inflate_finish(f) || broken(p, f);
}

/* Unpacks as many bytes as the rows have, and keeps none: for rows long beside the file. */
static bool stream_is_whole(Png *p, Inflate *f)
{
    unsigned char some[1024];

    p->next = p->idat;
    inflate_init(f, next_piece, p);
    for (uint64_t left = unpacked_bytes(p); left;) {
        size_t n = left < sizeof some ? (size_t)left : sizeof some;
        if (inflate_take(f, some, n) < n)
            return broken(p, f);
        left -= n;
    }
    return inflate_finish(f) || broken(p, f);
}

static bool read_pixels(Png *p, Image *im, Inflate *f, unsigned char *rows)
{
    bool alpha = p->type & ALPHA || p->key;
    uint64_t pixels = (uint64_t)p->w * p->h;
    size_t room = (size_t)(p->end - p->bytes);

    if (pixels > room && !read_stream(p, NULL, f, rows))
        return false;
    if (!(alpha ? image_init_alpha : image_init)(im, p->w, p->h))
        return false;
    if (!read_stream(p, im, f, rows)) {
        image_clear(im);
        return false;
    }
    image_drop_alpha(im, 1.0f);
    return true;
}

bool png_read(Image *im, const char *path, const unsigned char *bytes, size_t n,
              uint64_t max_pixels, Encoding encoding)
{
    Png p = { .path = path, .bytes = bytes, .end = bytes + n };
    unsigned char *rows = NULL;
    Inflate *f;
    bool ok;

    memset(im, 0, sizeof *im);
    if (!png_detect(bytes, n))
        return wrong(&p, "the eight bytes that begin a PNG file were expected");
    if (!read_chunks(&p, max_pixels))
        return false;
    if (unpacked_bytes(&p) / INFLATE_RATIO > p.packed)
        return err_at((Place){ path, 0, 0 }, "%.0f packed bytes cannot hold %.0f x %.0f pixels",
                      (double)p.packed, (double)p.w, (double)p.h);
    if (row_bytes(&p, p.w) > SIZE_MAX / 2 - 1)
        return err_memory(SIZE_MAX);
    p.encoding = encoding_of(&p, encoding);
    sample_table(p.linear, p.type == MAPPED || p.depth > 8 ? 255 : (1u << p.depth) - 1,
                 p.encoding);
    f = MEM_NEW(Inflate);
    ok = f && (row_bytes(&p, p.w) <= 8 * n || stream_is_whole(&p, f));
    if (ok)
        rows = mem_array((size_t)row_bytes(&p, p.w) + 1, 2);
    ok = rows && read_pixels(&p, im, f, rows);
    mem_free(f);
    mem_free(rows);
    return ok;
}
