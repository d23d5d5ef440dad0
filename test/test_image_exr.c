/* test_image_exr.c -- OpenEXR: what is written comes back to the last bit, layer by layer; files
 * put together by the letter in every form that is read; broken ones. */
#include "image/deflate.h"
#include "image/exr.h"
#include "image/inflate.h"
#include "test/image_help.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>

/* ---- files by the letter ---- */

enum { ROOM = 1 << 16, MOST = 8 };

typedef struct {
    unsigned char bytes[ROOM];
    size_t n;
} Made;

/* What a file shall be. Values are made by value_of. */
typedef struct {
    const char *names[MOST];    /* in order; ends at NULL */
    int kinds[MOST];
    int how, w, h, x0, y0;
    bool from_below;            /* blocks stand in the order of falling lines */
} Wish;

static void put(Made *f, const void *bytes, size_t n)
{
    REQUIRE(f->n + n <= ROOM, "no room");
    memcpy(f->bytes + f->n, bytes, n);
    f->n += n;
}

static void set_u32(unsigned char *p, uint32_t v)
{
    for (int i = 0; i < 4; i++)
        p[i] = (unsigned char)(v >> (8 * i));
}

static void put_u32(Made *f, uint32_t v)
{
    unsigned char b[4];
    set_u32(b, v);
    put(f, b, 4);
}

static void put_attribute(Made *f, const char *name, const char *type, const void *v, size_t n)
{
    put(f, name, strlen(name) + 1);
    put(f, type, strlen(type) + 1);
    put_u32(f, (uint32_t)n);
    put(f, v, n);
}

/* Bits of a sample, so that each is another and all are finite. */
static uint32_t value_of(int kind, int channel, int x, int y)
{
    uint32_t v = (uint32_t)(channel * 1000 + y * 37 + x * 3 + 1);
    return kind == EXR_HALF ? v * 7919 % 0x7C00 : kind == EXR_UINT ? v * 65537
                                                               : float_bits((float)v * 0.37f);
}

/* What a reader should make of it. */
static float expected(int kind, uint32_t bits)
{
    if (kind == EXR_UINT)
        return (float)bits;
    if (kind == EXR_FLOAT)
        return float_of_bits(bits);
    return (bits >> 10 & 31) == 0 ? (float)ldexp((double)(bits & 1023), -24)
                                  : (float)ldexp(1024.0 + (bits & 1023), (int)(bits >> 10) - 25);
}

/* Runs of 2 to 128 bytes, and what stands between them one by one. */
static size_t pack_runs(const unsigned char *in, size_t n, unsigned char *out)
{
    size_t used = 0;

    for (size_t at = 0; at < n;) {
        size_t run = 1;
        while (at + run < n && run < 128 && in[at + run] == in[at])
            run++;
        out[used++] = (unsigned char)(run > 1 ? run - 1 : 255);
        out[used++] = in[at];
        at += run;
    }
    return used;
}

static size_t pack(int how, const unsigned char *raw, size_t n, unsigned char *out)
{
    static unsigned char mixed[ROOM];
    unsigned char *z;
    size_t packed;

    memcpy(out, raw, n);
    if (how == EXR_NONE)
        return n;
    exr_arrange(raw, mixed, n);
    if (how == EXR_RLE) {
        packed = pack_runs(mixed, n, out);
    } else {
        REQUIRE(zlib_compress(mixed, n, &z, &packed), "zlib_compress");
        memcpy(out, z, packed < n ? packed : n);
        mem_free(z);
    }
    if (packed >= n)
        memcpy(out, raw, n);
    return packed < n ? packed : n;
}

static size_t raw_block(const Wish *w, int y0, int y1, unsigned char *raw)
{
    size_t n = 0;

    for (int y = y0; y < y1; y++)
        for (int c = 0; w->names[c]; c++)
            for (int x = 0; x < w->w; x++) {
                uint32_t v = value_of(w->kinds[c], c, x, y);
                set_u32(raw + n, v);
                n += w->kinds[c] == EXR_HALF ? 2 : 4;
            }
    return n;
}

static void put_header(Made *f, const Wish *w)
{
    unsigned char list[400] = { 0 }, window[16], how = (unsigned char)w->how;
    size_t n = 0;

    for (int c = 0; w->names[c]; c++) {
        strcpy((char *)list + n, w->names[c]);
        n += strlen(w->names[c]) + 1;
        set_u32(list + n, (uint32_t)w->kinds[c]);
        set_u32(list + n + 8, 1);
        set_u32(list + n + 12, 1);
        n += 16;
    }
    set_u32(window, (uint32_t)w->x0);
    set_u32(window + 4, (uint32_t)w->y0);
    set_u32(window + 8, (uint32_t)(w->x0 + w->w - 1));
    set_u32(window + 12, (uint32_t)(w->y0 + w->h - 1));
    f->n = 0;
    put_u32(f, EXR_MAGIC);
    put_u32(f, EXR_VERSION);
    put_attribute(f, "channels", "chlist", list, n + 1);
    put_attribute(f, "comment", "string", "of no concern", 13);
    put_attribute(f, "compression", "compression", &how, 1);
    put_attribute(f, "dataWindow", "box2i", window, 16);
    put_attribute(f, "lineOrder", "lineOrder", w->from_below ? "\1" : "\0", 1);
    put(f, "", 1);
}

static void make(Made *f, const Wish *w)
{
    static unsigned char raw[ROOM], packed[ROOM];
    int lines = w->how == EXR_ZIP ? 16 : 1, blocks = (w->h - 1) / lines + 1;
    size_t table;

    put_header(f, w);
    table = f->n;
    for (int k = 0; k < 2 * blocks; k++)
        put_u32(f, 0);
    for (int i = 0; i < blocks; i++) {
        int k = w->from_below ? blocks - 1 - i : i, y0 = k * lines;
        size_t n = raw_block(w, y0, y0 + lines < w->h ? y0 + lines : w->h, raw);
        set_u32(f->bytes + table + 8 * (size_t)k, (uint32_t)f->n);
        n = pack(w->how, raw, n, packed);
        put_u32(f, (uint32_t)(w->y0 + y0));
        put_u32(f, (uint32_t)n);
        put(f, packed, n);
    }
}

/* Component k of what is read must be channel number channel[k]. */
static void expect_channels(const Wish *w, const Made *f, const char *layer, const int channel[3])
{
    Image im;

    REQUIRE(exr_read(&im, "memory", f->bytes, f->n, 1 << 20, layer), "layer '%s'", layer);
    EXPECT(exr_has(f->bytes, f->n, layer), "has not '%s'", layer);
    REQUIRE(im.w == (uint32_t)w->w && im.h == (uint32_t)w->h, "%u x %u", im.w, im.h);
    for (int y = 0; y < w->h; y++)
        for (int x = 0; x < w->w; x++)
            for (int k = 0; k < 3; k++) {
                int c = channel[k];
                float got = (&image_at(&im, (uint32_t)x, (uint32_t)y)->r)[k];
                float want = expected(w->kinds[c], value_of(w->kinds[c], c, x, y));
                EXPECT(got == want, "%s at %d,%d: %.9g, not %.9g", w->names[c], x, y, (double)got,
                       (double)want);
            }
    image_clear(&im);
}

static void every_form(void)
{
    static Made f;
    Wish w = { .names = { "B", "G", "R", "depth.Z", "id.number", "n.X", "n.Y", "n.Z" },
               .kinds = { EXR_HALF, EXR_FLOAT, EXR_HALF, EXR_FLOAT, EXR_UINT, EXR_HALF, EXR_HALF,
                          EXR_HALF } };
    /* The list needs its end. */
    Wish last = w;

    last.names[7] = NULL;
    for (w.how = EXR_NONE; w.how <= EXR_ZIP; w.how++)
        for (int s = 0; s < 6; s++) {
            static const int sizes[6][2] = { { 1, 1 }, { 7, 1 }, { 1, 33 }, { 13, 16 }, { 5, 17 },
                                             { 20, 50 } };
            last.how = w.how;
            last.w = sizes[s][0];
            last.h = sizes[s][1];
            last.x0 = s == 3 ? -5 : 0;
            last.y0 = s == 3 ? -100 : 3 * s;
            last.from_below = s % 2;
            make(&f, &last);
            expect_channels(&last, &f, "", (int[3]){ 2, 1, 0 });
            expect_channels(&last, &f, "depth", (int[3]){ 3, 3, 3 });
            expect_channels(&last, &f, "id", (int[3]){ 4, 4, 4 });
        }
    EXPECT(!exr_has(f.bytes, f.n, "dept") && !exr_has(f.bytes, f.n, "depth.Z"), "not a layer");
    EXPECT(exr_has(f.bytes, f.n, "n"), "Y of two channels is a grey");
}

/* All 65536 of them; what is no number stays none. */
static void halves(void)
{
    Wish w = { .names = { "Y" }, .kinds = { EXR_HALF }, .w = 256, .h = 256 };
    static unsigned char bytes[8 * ROOM];
    Made head;
    size_t n;
    Image im;

    put_header(&head, &w);
    memcpy(bytes, head.bytes, head.n);
    n = head.n + 8 * 256;
    for (uint32_t y = 0; y < 256; y++) {
        memset(bytes + head.n + 8 * y, 0, 8);
        set_u32(bytes + head.n + 8 * y, (uint32_t)n);
        set_u32(bytes + n, y);
        set_u32(bytes + n + 4, 512);
        for (uint32_t x = 0; x < 256; x++) {
            bytes[n + 8 + 2 * x] = (unsigned char)x;
            bytes[n + 9 + 2 * x] = (unsigned char)y;
        }
        n += 8 + 512;
    }
    REQUIRE(exr_read(&im, "memory", bytes, n, 1 << 20, ""), "exr_read");
    for (uint32_t h = 0; h < 65536; h++) {
        float got = im.pixels[h].g, size = expected(EXR_HALF, h & 0x7FFF);
        if ((h & 0x7C00) == 0x7C00)
            EXPECT(h & 0x3FF ? got != got : got == (h & 0x8000 ? -INFINITY : INFINITY), "%x", h);
        else
            EXPECT(got == (h & 0x8000 ? -size : size) && !signbit(got) == !(h & 0x8000),
                   "%x is %.9g, not %.9g", h, (double)got, (double)size);
    }
    image_clear(&im);
}

/* ---- what we write ---- */

static void expect_back(const char *path, const char *layer, const Image *im)
{
    FileBytes f;
    Image back;

    REQUIRE(file_read(path, (uint64_t)1 << 30, &f), "file_read");
    REQUIRE(exr_read(&back, path, (unsigned char *)f.bytes, f.size, 1 << 20, layer), "'%s'", layer);
    REQUIRE(back.w == im->w && back.h == im->h, "%s: size", layer);
    EXPECT(same_pixels(back.pixels, im->pixels, (size_t)im->w * im->h), "'%s' of %u x %u", layer,
           im->w, im->h);
    image_clear(&back);
    file_clear(&f);
}

static void there_and_back(void)
{
    static const uint32_t sizes[][2] = { { 1, 1 }, { 3, 40 }, { 64, 16 }, { 65, 33 }, { 300, 1 } };
    Rng r = rng_seed(2);

    for (size_t s = 0; s < sizeof sizes / sizeof *sizes; s++)
        for (int packed = 0; packed < 2; packed++) {
            Image a = new_image(sizes[s][0], sizes[s][1]), b = new_image(a.w, a.h);
            Image grey = new_image(a.w, a.h);
            const ExrLayer layers[3] = { { "", "RGB", &a }, { "normal", "XYZ", &b },
                                         { "length.2", "Y", &grey } };
            char path[400];
            snprintf(path, sizeof path, "%s", in_folder("a.exr"));
            fill_random(&a, &r, -40, 80);
            fill_random(&b, &r, -3, 6);
            a.pixels[0] = rgb(-0.0f, INFINITY, -FLT_MIN / 8);
            for (uint32_t i = 0; i < a.w * a.h; i++)
                grey.pixels[i] = rgb_all((float)i);
            REQUIRE(exr_write(path, layers, 3, packed), "exr_write");
            expect_back(path, "", &a);
            expect_back(path, "normal", &b);
            expect_back(path, "length.2", &grey);
            image_clear(&a);
            image_clear(&b);
            image_clear(&grey);
        }
}

/* The bytes by hand: a picture of one pixel, not packed. */
static void by_the_letter(void)
{
    static const unsigned char begin[] = {
        0x76, 0x2F, 0x31, 0x01, 2, 4, 0, 0, 'c', 'h', 'a', 'n', 'n', 'e', 'l', 's', 0,
        'c', 'h', 'l', 'i', 's', 't', 0, 55, 0, 0, 0, 'B', 0, 2, 0, 0, 0, 0, 0, 0, 0, 1, 0, 0, 0,
        1, 0, 0, 0, 'G', 0 };
    static const unsigned char end[] = { 0, 0, 0, 0, 12, 0, 0, 0, 0, 0, 0x80, 0x40, 0, 0, 0, 0x40,
                                         0, 0, 0x80, 0x3F };
    const char *path = in_folder("one.exr");
    Display plain = { .uncompressed = true };
    unsigned char mixed[5];
    Image im = new_image(1, 1);
    FileBytes f;

    im.pixels[0] = rgb(1, 2, 4);
    REQUIRE(image_write(&im, path, &plain), "image_write");
    REQUIRE(file_read(path, 1 << 20, &f), "file_read");
    EXPECT(f.size > 200 && !memcmp(f.bytes, begin, sizeof begin), "the beginning");
    EXPECT(!memcmp(f.bytes + f.size - sizeof end, end, sizeof end), "the end");
    exr_arrange((const unsigned char *)"\1\2\3\4\5", mixed, 5);   /* 1 3 5 2 4, and differences */
    EXPECT(!memcmp(mixed, "\1\202\202\175\202", 5), "arranged");
    EXPECT((unsigned char)f.bytes[f.size - 28] == ((f.size - 20) & 255), "the offset");
    file_clear(&f);
    image_clear(&im);
}

/* Smooth pictures must become smaller, and noise no larger than it is. */
static void packing(void)
{
    Image im = new_image(64, 64);
    const char *path = in_folder("a.exr");
    Rng r = rng_seed(3);
    FileBytes f;

    for (uint32_t i = 0; i < 64 * 64; i++)
        im.pixels[i] = rgb_all(1.0f + (float)(i / 64) * 0.01f);
    REQUIRE(image_write(&im, path, NULL) && file_read(path, 1 << 20, &f), "write");
    EXPECT(f.size < 64 * 64 * 12 / 10, "smooth: %lu bytes", (unsigned long)f.size);
    file_clear(&f);
    for (uint32_t i = 0; i < 64 * 64; i++) {
        im.pixels[i].r = float_of_bits(rng_bits(&r) & 0x7F7FFFFF);
        im.pixels[i].g = float_of_bits(rng_bits(&r) & 0x7F7FFFFF);
        im.pixels[i].b = float_of_bits(rng_bits(&r) & 0x7F7FFFFF);
    }
    REQUIRE(image_write(&im, path, NULL) && file_read(path, 1 << 20, &f), "write");
    EXPECT(f.size < 64 * 64 * 12 + 500, "noise: %lu bytes", (unsigned long)f.size);
    file_clear(&f);
    expect_back(path, "", &im);
    image_clear(&im);
}

/* ---- broken files ---- */

typedef struct { unsigned long runs, read; } Tally;

static void try_bytes(const unsigned char *bytes, size_t n, Tally *t)
{
    long blocks = mem_blocks();
    size_t held = mem_bytes(), most = (sizeof(Rgb) / 2 + 2) * n * INFLATE_RATIO, peak;
    unsigned char *exact = malloc(n ? n : 1);   /* so that one byte too far is seen */
    Image im;
    bool ok;

    REQUIRE(exact, "memory");
    memcpy(exact, bytes, n);
    err_reset();
    mem_fail_at(0, false);
    exr_has(exact, n, "depth");
    ok = exr_read(&im, "broken", exact, n, 1 << 16, "");
    peak = mem_peak() - held;
    EXPECT(ok == (err_status() == STATUS_OK) && ok == (im.pixels != NULL), "status %d",
           err_status());
    EXPECT(peak <= most + sizeof(Inflate) + 200, "%lu bytes from a file of %lu",
           (unsigned long)peak, (unsigned long)n);
    image_clear(&im);
    EXPECT(mem_blocks() == blocks, "leaks");
    free(exact);
    t->runs++;
    t->read += ok;
}

static void mutate(int how, const unsigned char *values, int nvalues, Tally *t)
{
    static Made f;
    Wish w = { .names = { "B", "G", "R" }, .kinds = { EXR_HALF, EXR_FLOAT, EXR_HALF }, .w = 4,
               .h = how == EXR_ZIP ? 18 : 3 };

    w.how = how;
    make(&f, &w);
    try_bytes(f.bytes, f.n, t);
    EXPECT(t->read == 1, "%d: the whole file", how);
    for (size_t n = 0; n < f.n; n++)
        try_bytes(f.bytes, n, t);
    for (size_t i = 0; i < f.n; i++) {
        unsigned char old = f.bytes[i];
        for (int k = 0; k < nvalues; k++) {
            f.bytes[i] = (unsigned char)(values ? values[k] : old ^ (k + 1));
            try_bytes(f.bytes, f.n, t);
        }
        f.bytes[i] = old;
    }
}

/* Standard error is closed: each broken file has its line. */
static void quiet(void) { REQUIRE(freopen("/dev/null", "w", stderr), "stderr"); }

static void every_byte(int nvalues, const unsigned char *values)
{
    quiet();
    for (int how = EXR_NONE; how <= EXR_ZIP; how++) {
        Tally t = { 0, 0 };
        mutate(how, values, nvalues, &t);
        EXPECT(t.read > 10 && t.read < t.runs / 2, "kind %d: %lu of %lu were read", how, t.read,
               t.runs);
    }
}

static void broken_bytes(void)
{
    static const unsigned char values[] = { 0, 1, 2, 3, 4, 0x7F, 0x80, 0xFE, 0xFF };
    every_byte(sizeof values, values);
}
static void every_broken_byte(void) { every_byte(255, NULL); }

/* Several bytes at once. */
static void broken_at_random(void)
{
    static Made f;
    Wish w = { .names = { "B", "G", "R", "depth.Z" },
               .kinds = { EXR_HALF, EXR_FLOAT, EXR_UINT, EXR_FLOAT }, .w = 9, .h = 20 };
    Rng r = rng_seed(8);
    Tally t = { 0, 0 };

    quiet();
    for (long k = 0; k < (test_is_long() ? 3000000 : 20000); k++) {
        if (k % 64 == 0) {
            w.how = (int)rng_below(&r, 4);
            make(&f, &w);
        }
        for (uint32_t i = rng_below(&r, 3) + 1; i; i--)
            f.bytes[rng_below(&r, (uint32_t)f.n)] = (unsigned char)rng_bits(&r);
        try_bytes(f.bytes, f.n, &t);
    }
}

const TestCase test_image_exr[] = {
    { "every_form", every_form, false },
    { "halves", halves, false },
    { "there_and_back", there_and_back, false },
    { "by_the_letter", by_the_letter, false },
    { "packing", packing, false },
    { "broken_bytes", broken_bytes, false },
    { "every_broken_byte", every_broken_byte, true },
    { "broken_at_random", broken_at_random, false },
    { "broken_at_random_long", broken_at_random, true },
    { NULL, NULL, false }
};
