/* exrread.c -- reads a layer of an OpenEXR file.
 *
 * Source      [EXR]; see exr.c for the layout.
 * Reads       Files of one part in scan lines, not packed or by RLE, ZIPS or ZIP, in any order of
 *             lines; channels of halves, floats and whole numbers. The picture is the data window,
 *             wherever that lies. Alpha is left out.
 * Refused     Tiles, several parts, deep pixels, channels of fewer pixels than the picture has, and
 *             the other ways of packing: with a line that says which.
 * Memory      Before any is taken, every block is found, and what it holds is seen to be no more
 *             than its bytes can unpack to. Then the picture, and one block twice. */
#include "image/exr.h"

#include "base/bits.h"
#include "base/mem.h"
#include "image/format.h"
#include "image/inflate.h"

#include <stdio.h>
#include <string.h>

typedef struct {
    const char *path;
    const unsigned char *bytes; /* borrowed: of the file, n */
    size_t   n, at;             /* at: what was read of the header */
    const unsigned char *list;  /* its channels */
    size_t   list_n;
    int      how;               /* packed */
    int32_t  window[4];         /* x0 y0 x1 y1, with the last ones */
    uint32_t w, h, lines;       /* lines of a block */
    uint64_t line;              /* bytes of a line of all channels */
    struct { uint64_t offset; int kind; } pick[3];      /* in a line of one pixel a channel */
} ExrIn;

static uint32_t u32_at(const unsigned char *p)
{
    return p[0] | (uint32_t)p[1] << 8 | (uint32_t)p[2] << 16 | (uint32_t)p[3] << 24;
}

static bool broken(const ExrIn *f, const char *what)
{
    return err_at((Place){ f->path, 0, 0 }, "%s", what);
}

/* ---- the header ---- */

/* A text that ends with 0, of at most 255 letters. NULL: there is none. */
static const char *take_name(ExrIn *f)
{
    const char *name = (const char *)f->bytes + f->at;
    size_t room = f->n - f->at < 256 ? f->n - f->at : 256;
    const char *end = memchr(name, 0, room);

    if (!end)
        return NULL;
    f->at += (size_t)(end - name) + 1;
    return name;
}

static bool take_known(ExrIn *f, const char *name, const unsigned char *v, size_t n)
{
    if (!strcmp(name, "channels")) {
        f->list = v;
        f->list_n = n;
    } else if (!strcmp(name, "compression") && n == 1)
        f->how = v[0];
    else if (!strcmp(name, "dataWindow") && n == 16) {
        for (int k = 0; k < 4; k++)
            f->window[k] = (int32_t)u32_at(v + 4 * k);
    } else if (!strcmp(name, "compression") || !strcmp(name, "dataWindow"))
        return broken(f, "the header has an attribute of a wrong size");
    return true;
}

static bool read_attributes(ExrIn *f)
{
    f->how = -1;
    f->window[2] = f->window[3] = -1;
    for (f->at = 8;;) {
        const char *name = take_name(f);
        size_t size;
        if (!name)
            return broken(f, "the header is cut off, the name of an attribute was expected");
        if (!name[0])
            return true;
        if (!take_name(f) || f->n - f->at < 4)
            return broken(f, "the header is cut off within an attribute");
        size = u32_at(f->bytes + f->at);
        f->at += 4;
        if (size > f->n - f->at)
            return broken(f, "the header is cut off within the value of an attribute");
        if (!take_known(f, name, f->bytes + f->at, size))
            return false;
        f->at += size;
    }
}

static bool read_version(ExrIn *f)
{
    static const struct { uint32_t bit; const char *what; } kinds[] = {
        { 0x200, "holds tiles" }, { 0x800, "holds deep pixels" }, { 0x1000, "has several parts" }
    };
    uint32_t v;

    if (f->n < 8 || u32_at(f->bytes) != EXR_MAGIC)
        return broken(f, "is no EXR file");
    v = u32_at(f->bytes + 4);
    if ((v & 0xFF) != EXR_VERSION)
        return err_at((Place){ f->path, 0, 0 }, "the version of the format is %lu, %d was expected",
                      (unsigned long)(v & 0xFF), EXR_VERSION);
    for (int k = 0; k < 3; k++)
        if (v & kinds[k].bit)
            return err_at((Place){ f->path, 0, 0 }, "the file %s, one part of scan lines was "
                          "expected", kinds[k].what);
    return true;
}

/* ---- channels ---- */

typedef struct { const char *name; size_t length; int kind; } ChannelIn;

/* The channel at *at of the list, which moves on. False: the list ends, or is broken (*at > n). */
static bool next_channel(const ExrIn *f, size_t *at, ChannelIn *c)
{
    const unsigned char *p = f->list + *at;
    const unsigned char *end = *at < f->list_n ? memchr(p, 0, f->list_n - *at) : NULL;

    if (end && end == p)
        return false;
    if (!end || f->list_n - (size_t)(end - f->list) < 17 || u32_at(end + 1) > EXR_FLOAT) {
        *at = f->list_n + 1;
        return false;
    }
    c->name = (const char *)p;
    c->length = (size_t)(end - p);
    c->kind = (int)u32_at(end + 1);
    *at = (size_t)(end - f->list) + 17;
    return true;
}

static unsigned bytes_of(int kind) { return kind == EXR_HALF ? 2 : 4; }

static bool check_channels(ExrIn *f)
{
    ChannelIn c;
    size_t at = 0;

    while (f->list && next_channel(f, &at, &c)) {
        const unsigned char *after = (const unsigned char *)c.name + c.length + 1;
        if (u32_at(after + 8) != 1 || u32_at(after + 12) != 1)
            return broken(f, "has channels of fewer pixels, one for each pixel was expected");
        f->line += (uint64_t)bytes_of(c.kind) * f->w;
    }
    if (!f->list || at > f->list_n || !f->line)
        return broken(f, "the list of channels is missing or broken");
    return true;
}

/* Whether the channel is `letter` of the layer; 0: any one of it. */
static bool is_of(const ChannelIn *c, const char *layer, char letter)
{
    size_t n = strlen(layer), rest = n ? n + 1 : 0;

    if (c->length <= rest || memcmp(c->name, layer, n) || (n && c->name[n] != '.'))
        return false;
    if (letter)
        return c->length == rest + 1 && c->name[rest] == letter;
    return !memchr(c->name + rest, '.', c->length - rest);
}

/* Picks the first such channel for component k. Returns how many there are. */
static int pick_channel(ExrIn *f, const char *layer, char letter, int k)
{
    uint64_t offset = 0;
    size_t at = 0;
    int found = 0;
    ChannelIn c;

    for (; next_channel(f, &at, &c); offset += bytes_of(c.kind))
        if (is_of(&c, layer, letter) && !found++) {
            f->pick[k].offset = offset;
            f->pick[k].kind = c.kind;
        }
    return found;
}

/* Colours, vectors, or one channel, which stands for all three. */
static bool pick_layer(ExrIn *f, const char *layer)
{
    static const char *const three[] = { "RGB", "XYZ" }, one[] = "YZV";

    for (int s = 0; s < 2; s++) {
        int k = 0;
        while (k < 3 && pick_channel(f, layer, three[s][k], k))
            k++;
        if (k == 3)
            return true;
    }
    for (int s = 0; s < 4; s++)
        if (s < 3 ? pick_channel(f, layer, one[s], 0) : pick_channel(f, layer, 0, 0) == 1) {
            f->pick[1] = f->pick[2] = f->pick[0];
            return true;
        }
    return false;
}

/* The names of all channels, as far as there is room. */
static const char *channel_names(const ExrIn *f, char *out, size_t room)
{
    size_t at = 0, used = 0;
    ChannelIn c;

    out[0] = 0;
    while (next_channel(f, &at, &c) && used + c.length + 2 < room)
        used += (size_t)snprintf(out + used, room - used, "%s%s", used ? " " : "", c.name);
    return out;
}

/* ---- blocks ---- */

static bool check_packing(ExrIn *f)
{
    static const uint32_t lines[] = { 1, 1, 1, EXR_ZIP_LINES };
    static const char *const others[] = { "PIZ", "PXR24", "B44", "B44A", "DWAA", "DWAB" };

    if (f->how >= 0 && f->how <= EXR_ZIP) {
        f->lines = lines[f->how];
        return true;
    }
    return err_at((Place){ f->path, 0, 0 }, "is packed by %s, ZIP, ZIPS, RLE or nothing was "
                  "expected (another program can convert it)",
                  f->how > EXR_ZIP && f->how <= EXR_ZIP + 6 ? others[f->how - EXR_ZIP - 1]
                                                           : "a way that is not known");
}

static uint32_t blocks_of(const ExrIn *f) { return (f->h - 1) / f->lines + 1; }
static uint64_t raw_bytes(const ExrIn *f, uint32_t k)
{
    uint32_t y = k * f->lines;
    return f->line * (f->h - y < f->lines ? f->h - y : f->lines);
}

/* Finds the packed bytes of block k. NULL: they are not where the table says. */
static const unsigned char *block_at(const ExrIn *f, uint32_t k, size_t *n)
{
    const unsigned char *entry = f->bytes + f->at + 8 * (size_t)k, *p;
    uint64_t offset = u32_at(entry) | (uint64_t)u32_at(entry + 4) << 32;

    if (offset > f->n || f->n - offset < 8)
        return NULL;
    p = f->bytes + offset;
    *n = u32_at(p + 4);
    if (u32_at(p) != (uint32_t)f->window[1] + k * f->lines || *n > f->n - offset - 8)
        return NULL;
    return p + 8;
}

/* Whether all blocks are there, and can be as large as they must. */
static bool check_blocks(const ExrIn *f)
{
    uint64_t all = 0;

    if ((f->n - f->at) / 8 < blocks_of(f))
        return broken(f, "the table of blocks is cut off");
    for (uint32_t k = 0; k < blocks_of(f); k++) {
        size_t n;
        uint64_t raw = raw_bytes(f, k);
        if (!block_at(f, k, &n))
            return broken(f, "a block of lines is not where the table of blocks says");
        all += n;
        if (n > raw || (f->how == EXR_NONE && n < raw) || raw / INFLATE_RATIO > n || all > f->n)
            return broken(f, "a block of lines has another size than its pixels need");
    }
    return true;
}

/* Undoes exr_arrange. */
static void restore(unsigned char *from, unsigned char *to, size_t n)
{
    size_t half = (n + 1) / 2;

    for (size_t i = 1; i < n; i++)
        from[i] = (unsigned char)(from[i] + from[i - 1] - 128);
    for (size_t i = 0; i < n; i++)
        to[i] = from[i % 2 ? half + i / 2 : i / 2];
}

typedef struct { const unsigned char *at, *end; } Piece;

/* The one piece that there is, for inflate.h. */
static bool give_piece(void *ctx, const unsigned char **at, const unsigned char **end)
{
    Piece *p = ctx;

    *at = p->at;
    *end = p->end;
    p->at = p->end;
    return *at < *end;
}

static bool unpack_zip(Inflate *z, const unsigned char *p, size_t n, unsigned char *to, size_t raw)
{
    Piece piece = { p, p + n };

    inflate_init(z, give_piece, &piece);
    return inflate_take(z, to, raw) == raw && inflate_finish(z);
}

/* Runs: a byte c below 128 and one that is repeated c + 1 times; or 256 - c bytes as they are. */
static bool unpack_rle(const unsigned char *p, size_t n, unsigned char *to, size_t raw)
{
    const unsigned char *end = p + n;

    while (p < end) {
        bool copies = *p >= 128;
        size_t run = copies ? 256u - *p : *p + 1u, takes = copies ? run : 1;
        p++;
        if (run > raw || takes > (size_t)(end - p))
            return false;
        if (copies)
            memcpy(to, p, run);
        else
            memset(to, *p, run);
        to += run;
        raw -= run;
        p += takes;
    }
    return raw == 0;
}

/* The bytes of block k: where they are in the file, or in room[raw .. 2 raw). NULL: broken. */
static const unsigned char *unpack(const ExrIn *f, uint32_t k, Inflate *z, unsigned char *room)
{
    size_t n = 0, raw = (size_t)raw_bytes(f, k);
    const unsigned char *p = block_at(f, k, &n);

    if (n == raw)
        return p;
    if (f->how == EXR_RLE ? !unpack_rle(p, n, room, raw) : !unpack_zip(z, p, n, room, raw))
        return NULL;
    restore(room, room + raw, raw);
    return room + raw;
}

/* ---- pixels ---- */

/* The half with these bits: sign, 5 of the exponent, 10 of the fraction. */
static float float_of_half(uint32_t h)
{
    uint32_t sign = (h & 0x8000u) << 16, e = h >> 10 & 31, m = h & 0x3FFu;

    if (e == 31)                                        /* infinite or no number */
        return float_of(sign | 0x7F800000u | m << 13);
    if (e == 0)                                         /* m 2^-24 */
        return (sign ? -1.0f : 1.0f) * (float)m * 0x1p-24f;
    return float_of(sign | (e + 112) << 23 | m << 13);
}

static float sample(const unsigned char *p, int kind)
{
    if (kind == EXR_HALF)
        return float_of_half(p[0] | (uint32_t)p[1] << 8);
    return kind == EXR_FLOAT ? float_of(u32_at(p)) : (float)u32_at(p);
}

static void place_lines(const ExrIn *f, uint32_t k, const unsigned char *p, Image *im)
{
    uint32_t y0 = k * f->lines, y1 = f->h - y0 > f->lines ? y0 + f->lines : f->h;

    for (uint32_t y = y0; y < y1; y++, p += f->line)
        for (int c = 0; c < 3; c++) {
            const unsigned char *from = p + f->pick[c].offset * f->w;
            size_t step = bytes_of(f->pick[c].kind);
            for (uint32_t x = 0; x < f->w; x++, from += step) {
                Rgb *to = image_at(im, x, y);
                *(c == 0 ? &to->r : c == 1 ? &to->g : &to->b) = sample(from, f->pick[c].kind);
            }
        }
}

static bool read_blocks(const ExrIn *f, Image *im)
{
    size_t most = (size_t)raw_bytes(f, 0);
    unsigned char *room = f->how == EXR_NONE ? NULL : mem_array(most, 2);
    Inflate *z = room ? MEM_NEW(Inflate) : NULL;
    bool ok = f->how == EXR_NONE || z;

    for (uint32_t k = 0; ok && k < blocks_of(f); k++) {
        const unsigned char *p = unpack(f, k, z, room);
        ok = p || err_at((Place){ f->path, 0, 0 }, "the block at line %lu cannot be unpacked",
                         (unsigned long)(k * f->lines));
        if (ok)
            place_lines(f, k, p, im);
    }
    mem_free(room);
    mem_free(z);
    return ok;
}

static bool read_header(ExrIn *f, uint64_t max_pixels)
{
    if (!read_version(f) || !read_attributes(f))
        return false;
    if (!image_size_fits((Place){ f->path, 0, 0 }, (int64_t)f->window[2] - f->window[0] + 1,
                         (int64_t)f->window[3] - f->window[1] + 1, max_pixels))
        return false;
    f->w = (uint32_t)((int64_t)f->window[2] - f->window[0] + 1);
    f->h = (uint32_t)((int64_t)f->window[3] - f->window[1] + 1);
    return check_channels(f) && check_packing(f);
}

bool exr_has(const unsigned char *bytes, size_t n, const char *layer)
{
    ExrIn f = { .bytes = bytes, .n = n, .at = 8 };

    if (n < 8 || u32_at(bytes) != EXR_MAGIC)
        return false;
    for (const char *name; (name = take_name(&f)) != NULL && name[0];) {
        size_t size;
        if (!take_name(&f) || n - f.at < 4 || (size = u32_at(bytes + f.at)) > n - f.at - 4)
            return false;
        if (!strcmp(name, "channels")) {
            f.list = bytes + f.at + 4;
            f.list_n = size;
            return pick_layer(&f, layer);
        }
        f.at += 4 + size;
    }
    return false;
}

bool exr_read(Image *im, const char *path, const unsigned char *bytes, size_t n,
              uint64_t max_pixels, const char *layer)
{
    ExrIn f = { .path = path, .bytes = bytes, .n = n };
    char names[300];

    memset(im, 0, sizeof *im);
    if (!read_header(&f, max_pixels))
        return false;
    if (!pick_layer(&f, layer))
        return err_at((Place){ path, 0, 0 }, "it has no %s%s%s; its channels: %s",
                      layer[0] ? "layer '" : "colours", layer, layer[0] ? "'" : "",
                      channel_names(&f, names, sizeof names));
    if (!check_blocks(&f) || !image_init(im, f.w, f.h))
        return false;
    if (read_blocks(&f, im))
        return true;
    image_clear(im);
    return false;
}
