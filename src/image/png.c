/* png.c -- portable network graphics: writes 8 bits a channel, sRGB. Reading is in pngread.c.
 *
 * Source      [PNG]  ISO/IEC 15948:2003 (W3C PNG, second edition).
 * How         Every row is sent as differences from a prediction by its left, upper and upper left
 *             neighbours. The prediction of a row is the one of five that leaves the least sum of
 *             absolute differences, the rule that [PNG 12.8] recommends. */
#include "image/deflate.h"
#include "image/format.h"
#include "image/png.h"

#include "base/file.h"
#include "base/mem.h"

enum { CHANNELS = 3, CHUNK_MAX = 1 << 20 };

/* Filters the n bytes of a row under the row `above` into out; returns the sum of the differences
 * as signed bytes. */
static uint64_t filter_row(int filter, const unsigned char *row, const unsigned char *above,
                           size_t n, unsigned char *out)
{
    uint64_t sum = 0;

    for (size_t i = 0; i < n; i++) {
        int left = i < CHANNELS ? 0 : row[i - CHANNELS];
        int corner = i < CHANNELS ? 0 : above[i - CHANNELS];
        out[i] = (unsigned char)(row[i] - png_prediction(filter, left, above[i], corner));
        sum += out[i] < 128 ? out[i] : 256u - out[i];
    }
    return sum;
}

/* Writes the number of the best filter and the filtered row. trial: room for n bytes. */
static void put_row(const unsigned char *row, const unsigned char *above, size_t n,
                    unsigned char *trial, unsigned char *out)
{
    uint64_t least = filter_row(0, row, above, n, out + 1);

    out[0] = 0;
    for (int filter = 1; filter < PNG_FILTERS; filter++) {
        uint64_t sum = filter_row(filter, row, above, n, trial);
        if (sum < least) {
            least = sum;
            out[0] = (unsigned char)filter;
            memcpy(out + 1, trial, n);
        }
    }
}

/* All rows, filtered, into out[h * (3 w + 1)]. rows: room for three of them, zeroed. */
static void put_rows(const Quantiser *q, unsigned char *rows, unsigned char *out)
{
    const Image *im = q->tone.im;
    size_t n = (size_t)im->w * CHANNELS;
    unsigned char *row = rows, *above = rows + n, *trial = rows + 2 * n, *swap;

    for (uint32_t y = 0; y < im->h; y++, out += n + 1) {
        quantiser_row(q, y, row);
        put_row(row, above, n, trial, out);
        swap = above;
        above = row;
        row = swap;
    }
}

/* The zlib stream of the filtered rows, owned by the caller. False: out of memory, reported. */
static bool pack(const Image *im, const Display *display, unsigned char **packed, size_t *n)
{
    size_t row = (size_t)im->w * CHANNELS;
    unsigned char *rows = mem_array(row, 3), *all = rows ? mem_array(im->h, row + 1) : NULL;
    Quantiser q;
    bool ok = all && quantiser_init(&q, display, im);

    *packed = NULL;
    if (ok) {
        put_rows(&q, rows, all);
        quantiser_clear(&q);
    }
    mem_free(rows);
    if (ok)
        zlib_compress(all, im->h * (row + 1), packed, n);
    mem_free(all);
    return *packed != NULL;
}

static void put_chunk(Out *o, const char *type, const unsigned char *data, size_t n)
{
    uint32_t crc = checksum_crc32(0, (const unsigned char *)type, 4);

    out_u32be(o, (uint32_t)n);
    out_write(o, type, 4);
    out_write(o, data, n);
    out_u32be(o, checksum_crc32(crc, data, n));
}

static void put_u32be(unsigned char *p, uint32_t v)
{
    for (int i = 0; i < 4; i++)
        p[i] = (unsigned char)(v >> (24 - 8 * i));
}

static void put_file(Out *o, const Image *im, const unsigned char *packed, size_t n)
{
    static const unsigned char intent[1] = { 0 };       /* sRGB, perceptual [PNG 11.3.3.5] */
    static const unsigned char gamma[4] = { 0, 0, 0xB1, 0x8F };         /* 45455 = 1e5 / 2.2 */
    unsigned char header[13] = { 0, 0, 0, 0, 0, 0, 0, 0, 8, 2, 0, 0, 0 };  /* 8 bits, RGB */

    put_u32be(header, im->w);
    put_u32be(header + 4, im->h);
    out_write(o, png_signature, PNG_SIGNATURE);
    put_chunk(o, "IHDR", header, sizeof header);
    put_chunk(o, "sRGB", intent, sizeof intent);
    put_chunk(o, "gAMA", gamma, sizeof gamma);
    for (size_t at = 0; at < n; at += CHUNK_MAX)
        put_chunk(o, "IDAT", packed + at, n - at < CHUNK_MAX ? n - at : CHUNK_MAX);
    put_chunk(o, "IEND", header, 0);
}

static bool write_png(const Image *im, const char *path, const Display *display)
{
    unsigned char *packed;
    size_t n;
    Out *o = pack(im, display, &packed, &n) ? out_open(path) : NULL;

    if (o)
        put_file(o, im, packed, n);
    mem_free(packed);
    return o && out_close(o);
}

const ImageFormat image_format_png = {
    .info = { "png", "PNG", "portable network graphics: writes 8 bits a channel, sRGB", NULL },
    .extensions = "png", .linear = false, .detect = png_detect, .read = png_read, .write = write_png
};
