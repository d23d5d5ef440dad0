/* exr.c -- OpenEXR: writes scan lines of floats, packed or not; the format `exr`.
 *
 *     magic, version  attributes 0  offset of each block  blocks: first line, bytes, data
 *
 * Source      [EXR]  the file layout as the OpenEXR project describes it.
 * How         All integers are little-endian. Channels stand in the order of their names, and a
 *             line of a block has the line of each channel after the other. ZIP takes 16 lines a
 *             block: bytes of even places before those of odd ones, each byte as its difference
 *             from the one before, and that through deflate; a block that would not be smaller is
 *             stored as it is.
 * Memory      Packed blocks are kept until all are there, for their offsets stand before them.
 * Departs     No alpha: what is rendered has none. */
#include "image/exr.h"

#include "base/bits.h"
#include "base/file.h"
#include "base/mem.h"
#include "image/deflate.h"

#include <stdio.h>
#include <string.h>

typedef struct { char name[EXR_NAME]; const float *first; } Channel;    /* of the first pixel */
typedef struct { unsigned char *bytes; size_t n; } Block;       /* owned */

typedef struct {
    uint32_t w, h, lines;                       /* lines of a block */
    bool     packed;
    Channel  channel[3 * EXR_LAYERS];           /* in order */
    int      channels;
} Exr;

/* ---- what blocks hold ---- */

void exr_arrange(const unsigned char *from, unsigned char *to, size_t n)
{
    size_t half = (n + 1) / 2;

    for (size_t i = 0; i < n; i++)
        to[i % 2 ? half + i / 2 : i / 2] = from[i];
    for (size_t i = n; i-- > 1; )
        to[i] = (unsigned char)(to[i] - to[i - 1] + 128);
}

static void put_u32(unsigned char *p, uint32_t v)
{
    for (int i = 0; i < 4; i++)
        p[i] = (unsigned char)(v >> (8 * i));
}

static size_t raw_bytes(const Exr *e, uint32_t lines)
{
    return (size_t)e->w * lines * (size_t)e->channels * 4;
}

/* Lines y0 .. y1-1. */
static void fill_block(const Exr *e, uint32_t y0, uint32_t y1, unsigned char *to)
{
    enum { STRIDE = sizeof(Rgb) / sizeof(float) };

    for (uint32_t y = y0; y < y1; y++)
        for (int k = 0; k < e->channels; k++) {
            const float *at = e->channel[k].first + (size_t)y * e->w * STRIDE;
            for (uint32_t x = 0; x < e->w; x++, at += STRIDE, to += 4)
                put_u32(to, bits_of_float(*at));
        }
}

/* Packs block k; raw and other: room for its bytes. False: out of memory, reported. */
static bool pack_block(const Exr *e, uint32_t k, unsigned char *raw, unsigned char *other, Block *b)
{
    uint32_t y0 = k * e->lines, y1 = e->h - y0 > e->lines ? y0 + e->lines : e->h;
    size_t n = raw_bytes(e, y1 - y0);

    fill_block(e, y0, y1, raw);
    exr_arrange(raw, other, n);
    if (!zlib_compress(other, n, &b->bytes, &b->n))
        return false;
    if (b->n < n)
        return true;
    mem_free(b->bytes);
    b->bytes = mem_array(n, 1);
    b->n = n;
    if (b->bytes)
        memcpy(b->bytes, raw, n);
    return b->bytes != NULL;
}

static uint32_t blocks_of(const Exr *e) { return (e->h - 1) / e->lines + 1; }

static void free_blocks(Block *b, uint32_t n)
{
    for (uint32_t k = 0; b && k < n; k++)
        mem_free(b[k].bytes);
    mem_free(b);
}

/* NULL: out of memory, reported. */
static Block *pack(const Exr *e)
{
    uint32_t n = blocks_of(e), k = 0;
    Block *b = MEM_ARRAY(Block, n);
    unsigned char *room = b ? mem_array(raw_bytes(e, e->lines), 2) : NULL;

    while (room && k < n && pack_block(e, k, room, room + raw_bytes(e, e->lines), &b[k]))
        k++;
    mem_free(room);
    if (room && k == n)
        return b;
    free_blocks(b, n);
    return NULL;
}

/* ---- the file ---- */

static void out_u32(Out *o, uint32_t v)
{
    unsigned char b[4];
    put_u32(b, v);
    out_write(o, b, 4);
}

static size_t put_attribute(Out *o, const char *name, const char *type, const void *bytes, size_t n)
{
    out_write(o, name, strlen(name) + 1);
    out_write(o, type, strlen(type) + 1);
    out_u32(o, (uint32_t)n);
    if (bytes)
        out_write(o, bytes, n);
    return strlen(name) + strlen(type) + 2 + 4 + n;
}

static size_t put_channels(Out *o, const Exr *e)
{
    static const unsigned char kind[16] = { EXR_FLOAT, [8] = 1, [12] = 1 };     /* each pixel */
    size_t n = 1, head;

    for (int k = 0; k < e->channels; k++)
        n += strlen(e->channel[k].name) + 1 + sizeof kind;
    head = put_attribute(o, "channels", "chlist", NULL, n);
    for (int k = 0; k < e->channels; k++) {
        out_write(o, e->channel[k].name, strlen(e->channel[k].name) + 1);
        out_write(o, kind, sizeof kind);
    }
    out_write(o, "", 1);
    return head;
}

/* All before the table of offsets; returns its length. */
static size_t put_header(Out *o, const Exr *e)
{
    enum { LONG_NAMES = 0x400 };        /* of more than 31 letters */
    unsigned char window[16] = { 0 }, one[4], how = e->packed ? EXR_ZIP : EXR_NONE;
    size_t n = 8;

    out_u32(o, EXR_MAGIC);
    out_u32(o, EXR_VERSION | LONG_NAMES);
    put_u32(window + 8, e->w - 1);
    put_u32(window + 12, e->h - 1);
    put_u32(one, bits_of_float(1.0f));
    n += put_channels(o, e);
    n += put_attribute(o, "compression", "compression", &how, 1);
    n += put_attribute(o, "dataWindow", "box2i", window, 16);
    n += put_attribute(o, "displayWindow", "box2i", window, 16);
    n += put_attribute(o, "lineOrder", "lineOrder", "", 1);
    n += put_attribute(o, "pixelAspectRatio", "float", one, 4);
    n += put_attribute(o, "screenWindowCenter", "v2f", (unsigned char[8]){ 0 }, 8);
    n += put_attribute(o, "screenWindowWidth", "float", one, 4);
    out_write(o, "", 1);
    return n + 1;
}

/* blocks NULL: as they are, from raw, which has room for one. */
static void put_file(Out *o, const Exr *e, const Block *blocks, unsigned char *raw)
{
    uint32_t n = blocks_of(e);
    uint64_t at = put_header(o, e) + 8 * (uint64_t)n;

    for (uint32_t k = 0; k < n; k++) {
        out_u32(o, (uint32_t)at);
        out_u32(o, (uint32_t)(at >> 32));
        at += 8 + (blocks ? blocks[k].n : raw_bytes(e, 1));
    }
    for (uint32_t k = 0; k < n; k++) {
        size_t bytes = blocks ? blocks[k].n : raw_bytes(e, 1);
        out_u32(o, k * e->lines);
        out_u32(o, (uint32_t)bytes);
        if (raw)
            fill_block(e, k, k + 1, raw);
        out_write(o, blocks ? blocks[k].bytes : raw, bytes);
    }
}

/* Puts a channel in its place by name. */
static void add_channel(Exr *e, const char *layer, char letter, const float *first)
{
    Channel c;
    int k = e->channels++;

    snprintf(c.name, sizeof c.name, "%.*s%s%c", EXR_NAME - 3, layer, layer[0] ? "." : "", letter);
    c.first = first;
    for (; k > 0 && strcmp(e->channel[k - 1].name, c.name) > 0; k--)
        e->channel[k] = e->channel[k - 1];
    e->channel[k] = c;
}

static void set_up(Exr *e, const ExrLayer *layers, int n, bool packed)
{
    memset(e, 0, sizeof *e);
    e->w = layers[0].im->w;
    e->h = layers[0].im->h;
    e->packed = packed;
    e->lines = packed ? EXR_ZIP_LINES : 1;
    for (int k = 0; k < n; k++)
        for (int c = 0; layers[k].channels[c]; c++)
            add_channel(e, layers[k].name, layers[k].channels[c], &layers[k].im->pixels[0].r + c);
}

bool exr_write(const char *path, const ExrLayer *layers, int n, bool packed)
{
    Exr e;
    Block *blocks = NULL;
    unsigned char *raw = NULL;
    Out *o;

    ASSERT(n > 0 && n <= EXR_LAYERS);
    set_up(&e, layers, n, packed);
    if ((uint64_t)e.w * (uint64_t)e.channels * 4 * e.lines > INT32_MAX)
        return err_output(path, "%d channels of %lu pixels a line are too many for an EXR file",
                          e.channels, (unsigned long)e.w);
    if (packed)
        blocks = pack(&e);
    else
        raw = mem_array(raw_bytes(&e, 1), 1);
    o = blocks || raw ? out_open(path) : NULL;
    if (o)
        put_file(o, &e, blocks, raw);
    free_blocks(blocks, blocks ? blocks_of(&e) : 0);
    mem_free(raw);
    return o && out_close(o);
}

/* ---- the format ---- */

static bool write_exr(const Image *im, const char *path, const Display *display)
{
    ExrLayer picture = { "", "RGB", im };
    return exr_write(path, &picture, 1, !display || !display->uncompressed);
}

static bool detect_exr(const unsigned char *b, size_t n)
{
    return n >= 4 && !memcmp(b, "\x76\x2F\x31\x01", 4);
}

static bool read_exr(Image *im, const char *path, const unsigned char *bytes, size_t n,
                     uint64_t max_pixels, Encoding encoding)
{
    (void)encoding;
    return exr_read(im, path, bytes, n, max_pixels, "");
}

const ImageFormat image_format_exr = {
    .info = { "exr", "EXR", "OpenEXR scan lines: linear floats in layers, packed or not", NULL },
    .extensions = "exr", .linear = true, .detect = detect_exr, .read = read_exr,
    .write = write_exr
};
