/* png_help.h -- PNG files of every kind, put together by the letter for tests of their reader. */
#ifndef TEST_PNG_HELP_H
#define TEST_PNG_HELP_H

#include "image/deflate.h"
#include "image/png.h"
#include "test/image_help.h"

enum { PNG_ROOM = 1 << 16 };
typedef struct { unsigned char bytes[PNG_ROOM]; size_t n; } PngFile;

static inline void png_u32(unsigned char *p, size_t v)
{
    for (int i = 0; i < 4; i++)
        p[i] = (unsigned char)(v >> (24 - 8 * i));
}

static inline void png_chunk(PngFile *f, const char *type, const void *data, size_t n)
{
    unsigned char *c = f->bytes + f->n;

    REQUIRE(f->n + n + 12 <= PNG_ROOM, "no room for %s", type);
    png_u32(c, n);
    memcpy(c + 4, type, 4);
    if (n)
        memcpy(c + 8, data, n);
    png_u32(c + 8 + n, checksum_crc32(0, c + 4, n + 4));
    f->n += n + 12;
}

static inline void png_begin(PngFile *f, uint32_t w, uint32_t h, int depth, int type,
                             int interlaced)
{
    unsigned char head[13] = { 0 };

    f->n = PNG_SIGNATURE;
    memcpy(f->bytes, png_signature, PNG_SIGNATURE);
    png_u32(head, w);
    png_u32(head + 4, h);
    head[8] = (unsigned char)depth;
    head[9] = (unsigned char)type;
    head[12] = (unsigned char)interlaced;
    png_chunk(f, "IHDR", head, 13);
}

/* The n bytes packed, in one chunk or in pieces of `piece` bytes. */
static inline void png_data(PngFile *f, const unsigned char *raw, size_t n, size_t piece)
{
    unsigned char *packed;
    size_t packed_n;

    REQUIRE(zlib_compress(raw, n, &packed, &packed_n), "zlib_compress");
    for (size_t at = 0; at < packed_n; at += piece)
        png_chunk(f, "IDAT", packed + at, packed_n - at < piece ? packed_n - at : piece);
    mem_free(packed);
    png_chunk(f, "IEND", NULL, 0);
}

/* Puts sample number k of a row. */
static inline void png_sample(unsigned char *row, size_t k, int depth, unsigned v)
{
    if (depth == 16) {
        row[2 * k] = (unsigned char)(v >> 8);
        row[2 * k + 1] = (unsigned char)v;
    } else {
        size_t bit = k * (size_t)depth;
        row[bit / 8] |= (unsigned char)(v << (8 - depth - (int)(bit % 8)));
    }
}

/* Filters a row of n bytes under the row above (NULL: none) into out[n + 1]. step: of a pixel. */
static inline void png_filter(int filter, const unsigned char *row, const unsigned char *above,
                              size_t n, size_t step, unsigned char *out)
{
    out[0] = (unsigned char)filter;
    for (size_t i = 0; i < n; i++) {
        int left = i < step ? 0 : row[i - step], up = above ? above[i] : 0;
        int corner = above && i >= step ? above[i - step] : 0, p = left + up - corner;
        int guess[5] = { 0, left, up, (left + up) / 2, corner };
        if (abs(p - left) <= abs(p - up) && abs(p - left) <= abs(p - corner))
            guess[4] = left;
        else if (abs(p - up) <= abs(p - corner))
            guess[4] = up;
        out[i + 1] = (unsigned char)(row[i] - guess[filter]);
    }
}

#endif
