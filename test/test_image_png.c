/* test_image_png.c -- the PNG writer and deflate, read back by a decoder that shares nothing with
 * them: bit by bit, code by code, CRC by polynomial division. */
#include "image/format.h"
#include "test/image_help.h"

/* The compressor's own parts are tested too, so its source stands here, under other names. */
#define zlib_compress      tested_zlib_compress
#define checksum_crc32     tested_crc32
#define checksum_adler32   tested_adler32
#include "image/deflate.c"

#include <stdlib.h>

/* ---- a naive inflate [RFC1951] ---- */

typedef struct {
    const unsigned char *in;
    size_t bit, bits;                   /* next bit, number of them */
    unsigned char *out;
    size_t n, room;
    int blocks[4];                      /* how many of each type were met */
    int longest, farthest, deepest;     /* match, distance, code */
} Inflate;

static unsigned get(Inflate *f, int count)
{
    unsigned v = 0;
    for (int k = 0; k < count; k++, f->bit++) {
        REQUIRE(f->bit < f->bits, "the stream ends early");
        v |= (unsigned)(f->in[f->bit / 8] >> f->bit % 8 & 1) << k;
    }
    return v;
}

/* Canonical code: reads bits until they are the code of a symbol. */
static int get_symbol(Inflate *f, const int *length, int n)
{
    unsigned code = 0, first = 0;

    for (int len = 1; len <= 15; len++) {
        int count = 0, s;
        code = code << 1 | get(f, 1);
        for (s = 0; s < n; s++)
            count += length[s] == len;
        if (code - first < (unsigned)count) {
            for (s = 0; ; s++)
                if (length[s] == len && code-- == first)
                    return s;
        }
        first = (first + (unsigned)count) << 1;
    }
    REQUIRE(false, "no such code");
    return -1;
}

/* Every code the writer makes must be complete: the shares of its symbols add up to one. */
static void check_complete(Inflate *f, const int *length, int n)
{
    unsigned sum = 0;
    for (int s = 0; s < n; s++)
        if (length[s]) {
            sum += 1u << (15 - length[s]);
            f->deepest = length[s] > f->deepest ? length[s] : f->deepest;
        }
    REQUIRE(sum == 1u << 15, "the code is not complete: %u of 32768", sum);
}

static void get_lengths(Inflate *f, int *length, int *literals, int *distances)
{
    static const int order[19] = {
        16, 17, 18, 0, 8, 7, 9, 6, 10, 5, 11, 4, 12, 3, 13, 2, 14, 1, 15
    };
    int head[19] = { 0 }, n, total, k = 0;

    *literals = (int)get(f, 5) + 257;
    *distances = (int)get(f, 5) + 1;
    n = (int)get(f, 4) + 4;
    REQUIRE(*literals <= 286 && *distances <= 30, "%d + %d codes", *literals, *distances);
    total = *literals + *distances;
    for (int i = 0; i < n; i++)
        head[order[i]] = (int)get(f, 3);
    check_complete(f, head, 19);
    while (k < total) {
        int s = get_symbol(f, head, 19), run = 1, value = s;
        if (s == 16) {
            REQUIRE(k > 0, "nothing to repeat");
            run = 3 + (int)get(f, 2);
            value = length[k - 1];
        } else if (s >= 17) {
            run = s == 17 ? 3 + (int)get(f, 3) : 11 + (int)get(f, 7);
            value = 0;
        }
        REQUIRE(k + run <= total, "too many lengths");
        while (run--)
            length[k++] = value;
    }
    check_complete(f, length, *literals);
    check_complete(f, length + *literals, *distances);
}

static void get_match(Inflate *f, int s, const int *length, int n)
{
    static const int base[29] = { 3, 4, 5, 6, 7, 8, 9, 10, 11, 13, 15, 17, 19, 23, 27, 31, 35, 43,
        51, 59, 67, 83, 99, 115, 131, 163, 195, 227, 258 };
    static const int extra[29] = { 0, 0, 0, 0, 0, 0, 0, 0, 1, 1, 1, 1, 2, 2, 2, 2, 3, 3, 3, 3, 4, 4,
        4, 4, 5, 5, 5, 5, 0 };
    static const int far_base[32] = { 1, 2, 3, 4, 5, 7, 9, 13, 17, 25, 33, 49, 65, 97, 129, 193,
        257, 385, 513, 769, 1025, 1537, 2049, 3073, 4097, 6145, 8193, 12289, 16385, 24577 };
    int run, back;

    REQUIRE(s <= 285, "length code %d", s);
    run = base[s - 257] + (int)get(f, extra[s - 257]);
    REQUIRE(run < 258 || s == 285, "258 in the wrong code");
    s = get_symbol(f, length, n);
    REQUIRE(s <= 29, "distance code %d", s);
    back = far_base[s] + (int)get(f, s < 4 ? 0 : s / 2 - 1);
    REQUIRE((size_t)back <= f->n && f->n + (size_t)run <= f->room, "a match out of bounds");
    f->longest = run > f->longest ? run : f->longest;
    f->farthest = back > f->farthest ? back : f->farthest;
    for (; run; run--, f->n++)
        f->out[f->n] = f->out[f->n - (size_t)back];
}

static void get_block(Inflate *f, unsigned type)
{
    int length[320], literals = 288, distances = 30;

    for (int s = 0; s < 288; s++)
        length[s] = s < 144 ? 8 : s < 256 ? 9 : s < 280 ? 7 : 8;
    for (int s = 0; s < 30; s++)
        length[288 + s] = 5;
    if (type == 2)
        get_lengths(f, length, &literals, &distances);
    for (;;) {
        int s = get_symbol(f, length, literals);
        if (s == 256)
            return;
        REQUIRE(f->n < f->room, "too many bytes");
        if (s < 256)
            f->out[f->n++] = (unsigned char)s;
        else
            get_match(f, s, length + literals, distances);
    }
}

static void get_stored(Inflate *f)
{
    unsigned n;

    f->bit = (f->bit + 7) / 8 * 8;
    n = get(f, 16);
    REQUIRE(get(f, 16) == (n ^ 0xFFFF), "the length of a stored block is wrong");
    REQUIRE(f->n + n <= f->room, "too many bytes");
    while (n--)
        f->out[f->n++] = (unsigned char)get(f, 8);
}

/* The whole zlib stream must give exactly `room` bytes and end with their checksum. */
static void inflate_all(Inflate *f, const unsigned char *in, size_t n, size_t room)
{
    uint32_t a = 1, b = 0, sum = 0;
    unsigned last, type;

    *f = (Inflate){ .in = in, .bits = n * 8, .room = room };
    f->out = mem_array(room, 1);
    REQUIRE(f->out && n >= 6, "%lu bytes", (unsigned long)n);
    REQUIRE(in[0] == 0x78 && (in[0] * 256 + in[1]) % 31 == 0 && !(in[1] & 32), "zlib header");
    f->bit = 16;
    do {
        last = get(f, 1);
        type = get(f, 2);
        REQUIRE(type < 3, "block type 3");
        f->blocks[type]++;
        if (type)
            get_block(f, type);
        else
            get_stored(f);
    } while (!last);
    f->bit = (f->bit + 7) / 8 * 8;
    for (int k = 0; k < 4; k++)
        sum = sum << 8 | get(f, 8);
    EXPECT(f->bit == f->bits, "bytes after the stream");
    EXPECT(f->n == room, "%lu of %lu bytes", (unsigned long)f->n, (unsigned long)room);
    for (size_t i = 0; i < f->n; i++) {
        a = (a + f->out[i]) % 65521;
        b = (b + a) % 65521;
    }
    EXPECT(sum == (b << 16 | a), "adler");
}

/* ---- deflate ---- */

static Inflate totals;                  /* what the streams of the case have shown */

static void note_seen(const Inflate *f)
{
    for (int k = 0; k < 3; k++)
        totals.blocks[k] += f->blocks[k];
    totals.longest = f->longest > totals.longest ? f->longest : totals.longest;
    totals.farthest = f->farthest > totals.farthest ? f->farthest : totals.farthest;
    totals.deepest = f->deepest > totals.deepest ? f->deepest : totals.deepest;
}

/* Packs, unpacks, compares; returns the packed size. */
static size_t check_bytes(const unsigned char *bytes, size_t n, const char *what)
{
    unsigned char *packed;
    size_t packed_n;
    Inflate f;

    REQUIRE(zlib_compress(bytes, n, &packed, &packed_n), "%s", what);
    EXPECT(packed_n <= n + n / 3000 + 16, "%s: %lu bytes became %lu", what, (unsigned long)n,
           (unsigned long)packed_n);
    inflate_all(&f, packed, packed_n, n);
    EXPECT(!memcmp(f.out, bytes, n), "%s: bytes differ", what);
    note_seen(&f);
    mem_free(f.out);
    mem_free(packed);
    return packed_n;
}

static void deflate_bytes(void)
{
    static const size_t sizes[] = { 0, 1, 2, 3, 4, 5, 257, 258, 259, 260, 516, 1000, 16383, 16384,
                                    16385, 32767, 32768, 32769, 40000, 70000, 200000 };
    unsigned char *b = mem_array(300000, 1);
    Rng r = rng_seed(6);

    REQUIRE(b, "memory");
    for (size_t k = 0; k < sizeof sizes / sizeof sizes[0]; k++)
        for (int kind = 0; kind < 6; kind++) {
            size_t n = sizes[k];
            for (size_t i = 0; i < n; i++) {
                uint32_t v = (uint32_t)rng_bits(&r);
                switch (kind) {
                case 0: b[i] = (unsigned char)v; break;                         /* noise */
                case 1: b[i] = 42; break;                                       /* one byte */
                case 2: b[i] = (unsigned char)(i % 7); break;                   /* a period */
                case 3: b[i] = v & 7 ? (unsigned char)(v >> 8 & 3) : 9; break;  /* few letters */
                case 4: b[i] = i >= 32768 ? b[i - 32768] : (unsigned char)v; break;
                default: b[i] = i >= 32769 ? b[i - 32769] : (unsigned char)v; break;
                }
            }
            check_bytes(b, n, "bytes");
        }
    EXPECT(totals.blocks[0] > 10 && totals.blocks[1] > 10 && totals.blocks[2] > 10,
           "blocks: %d stored, %d fixed, %d own", totals.blocks[0], totals.blocks[1],
           totals.blocks[2]);
    EXPECT(totals.longest == 258 && totals.farthest == 32768, "longest %d, farthest %d",
           totals.longest, totals.farthest);
    mem_free(b);
}

/* What repeats must shrink, as the format allows: a run of one byte takes two bits for a match of
 * 258 bytes, and a copy of 32768 bytes of noise 128 matches of at most 48 bits. */
static void deflate_shrinks(void)
{
    unsigned char *b = mem_array(1 << 20, 1);
    Rng r = rng_seed(7);
    size_t n;

    REQUIRE(b, "memory");
    n = check_bytes(b, 1 << 20, "zeros");
    EXPECT(n <= (1 << 20) / 258 / 4 + 100, "zeros take %lu", (unsigned long)n);
    for (size_t i = 0; i < 65536; i++)
        b[i] = i < 32768 ? (unsigned char)rng_bits(&r) : b[i - 32768];
    n = check_bytes(b, 65536, "a copy");
    EXPECT(n <= 32768 + 128 * 6 + 400, "a copy takes %lu", (unsigned long)n);   /* + block heads */
    mem_free(b);
}

/* A block that is stored may be longer than what one length of 16 bits can say. */
static void stored_blocks(void)
{
    static const size_t sizes[] = { 0, 1, 65534, 65535, 65536, 131070, 131071, 200000 };
    Rng r = rng_seed(18);

    for (size_t k = 0; k < sizeof sizes / sizeof sizes[0]; k++) {
        size_t n = sizes[k];
        Deflate *d = MEM_NEW(Deflate);
        unsigned char *bytes = mem_array(n, 1);
        Inflate f;
        REQUIRE(d && bytes && mem_grow(&d->out, &d->out_cap, n + 100, 1), "memory");
        for (size_t i = 0; i < n; i++)
            bytes[i] = (unsigned char)rng_bits(&r);
        d->in = bytes;
        d->n = n;
        put_bits(d, 0x9C78, 16);
        put_stored(d, n, true);
        for (int i = 3; i >= 0; i--)
            put_bits(d, checksum_adler32(1, bytes, n) >> 8 * i & 255, 8);
        inflate_all(&f, d->out, d->out_n, n);
        EXPECT(!memcmp(f.out, bytes, n), "%lu bytes differ", (unsigned long)n);
        EXPECT(f.blocks[0] == (n ? (int)((n + 65534) / 65535) : 1), "%d blocks", f.blocks[0]);
        mem_free(f.out);
        mem_free(bytes);
        mem_free(d->out);
        mem_free(d);
    }
}

/* The least sum of freq * length over all lengths from 1 to limit that make a prefix code. */
static uint64_t brute_cost(const uint32_t *freq, int n, int limit, unsigned room)
{
    uint64_t least = UINT64_MAX;

    if (n == 0)
        return 0;
    for (int length = 1; length <= limit; length++) {
        unsigned share = 1u << (limit - length);
        if (share <= room) {
            uint64_t rest = brute_cost(freq + 1, n - 1, limit, room - share);
            if (rest != UINT64_MAX && rest + (uint64_t)freq[0] * (unsigned)length < least)
                least = rest + (uint64_t)freq[0] * (unsigned)length;
        }
    }
    return least;
}

static void code_lengths(void)
{
    Rng r = rng_seed(8);
    uint32_t freq[LITERALS] = { 0 };
    uint8_t length[LITERALS];

    for (int round = 0; round < 3000; round++) {
        int n = 2 + (int)rng_below(&r, 6), limit = 3 + (int)rng_below(&r, 3);
        uint64_t cost = 0;
        unsigned share = 0;
        for (int s = 0; s < n; s++)
            freq[s] = 1 + (uint32_t)(rng_bits(&r) >> (44 + rng_below(&r, 20)));
        limited_lengths(freq, n, limit, length);
        for (int s = 0; s < n; s++) {
            REQUIRE(length[s] >= 1 && length[s] <= limit, "length %d", length[s]);
            cost += (uint64_t)freq[s] * length[s];
            share += 1u << (limit - length[s]);
        }
        EXPECT(share == 1u << limit, "%d symbols: %u of %u", n, share, 1u << limit);
        EXPECT(cost == brute_cost(freq, n, limit, 1u << limit), "not the best code");
    }
    /* Fibonacci numbers would make a Huffman code as deep as there are symbols. */
    freq[0] = freq[1] = 1;
    for (int s = 2; s < 40; s++)
        freq[s] = freq[s - 1] + freq[s - 2];
    for (int limit = 6; limit <= 15; limit++) {
        unsigned share = 0;
        limited_lengths(freq, 40, limit, length);
        for (int s = 0; s < 40; s++) {
            EXPECT(length[s] >= 1 && length[s] <= limit, "limit %d: %d", limit, length[s]);
            share += 1u << (limit - length[s]);
        }
        EXPECT(share == 1u << limit, "limit %d: %u", limit, share);
    }
}

static void checksums(void)
{
    unsigned char *ones = mem_array(6000, 1);

    REQUIRE(ones, "memory");
    EXPECT(checksum_crc32(0, (const unsigned char *)"123456789", 9) == 0xCBF43926, "crc");
    EXPECT(checksum_crc32(checksum_crc32(0, (const unsigned char *)"1234", 4),
                          (const unsigned char *)"56789", 5) == 0xCBF43926, "crc in two parts");
    EXPECT(checksum_adler32(1, (const unsigned char *)"Wikipedia", 9) == 0x11E60398, "adler");
    memset(ones, 255, 6000);
    /* a = 1 + 6000 * 255, b = 6000 + 255 * 6000 * 6001 / 2, both mod 65521. */
    EXPECT(checksum_adler32(1, ones, 6000) ==
           ((6000 + 255u * (uint64_t)6000 * 6001 / 2) % 65521 << 16 | 1530001 % 65521), "adler");
    mem_free(ones);
}

/* ---- PNG ---- */

static uint32_t be32(const unsigned char *p)
{
    return (uint32_t)p[0] << 24 | (uint32_t)p[1] << 16 | (uint32_t)p[2] << 8 | p[3];
}

/* CRC-32 as the remainder of a division of polynomials, bit by bit. */
static uint32_t crc_by_division(const unsigned char *p, size_t n)
{
    uint32_t r = 0xFFFFFFFF;
    for (size_t i = 0; i < n; i++)
        for (int k = 0; k < 8; k++) {
            uint32_t bit = (r ^ (uint32_t)(p[i] >> k)) & 1;
            r = r >> 1 ^ (bit ? 0xEDB88320 : 0);
        }
    return ~r;
}

/* The filter of a row must be the first of those that leave the least sum of differences, taken as
 * signed bytes. above: the row above, NULL for the first one. */
static void check_choice(int chosen, const unsigned char *row, const unsigned char *above, size_t n)
{
    unsigned long sums[5] = { 0, 0, 0, 0, 0 };
    int best = 0;

    for (size_t i = 0; i < n; i++) {
        int a = i < 3 ? 0 : row[i - 3], b = above ? above[i] : 0;
        int c = i < 3 || !above ? 0 : above[i - 3];
        int da = abs(b - c), db = abs(a - c), dc = abs(a + b - 2 * c);
        int guess[5] = { 0, a, b, (a + b) / 2, 0 };
        guess[4] = da <= db && da <= dc ? a : db <= dc ? b : c;
        for (int k = 0; k < 5; k++) {
            int left = (row[i] - guess[k]) & 255;
            sums[k] += (unsigned long)(left < 128 ? left : 256 - left);
        }
    }
    for (int k = 1; k < 5; k++)
        if (sums[k] < sums[best])
            best = k;
    EXPECT(chosen == best, "filter %d with %lu, not %d with %lu", chosen, sums[chosen], best,
           sums[best]);
}

typedef struct { uint32_t w, h; unsigned char *rgb, *data; size_t n; int filters[5]; } Png;

/* Checks the chunks and gathers the data. */
static void read_chunks(Png *p, const unsigned char *b, size_t n)
{
    size_t at = 8;
    bool ended = false;

    REQUIRE(n > 8 && !memcmp(b, "\x89PNG\r\n\x1a\n", 8), "signature");
    p->data = mem_array(n, 1);
    REQUIRE(p->data, "memory");
    while (!ended) {
        size_t size;
        REQUIRE(n - at >= 12, "cut chunk");
        size = be32(b + at);
        REQUIRE(size <= n - at - 12, "chunk of %lu bytes", (unsigned long)size);
        EXPECT(be32(b + at + 8 + size) == crc_by_division(b + at + 4, size + 4), "crc of a chunk");
        if (at == 8) {
            REQUIRE(size == 13 && !memcmp(b + 12, "IHDR", 4), "IHDR");
            p->w = be32(b + 16);
            p->h = be32(b + 20);
            EXPECT(!memcmp(b + 24, "\10\2\0\0\0", 5), "8 bits RGB");
        } else if (!memcmp(b + at + 4, "IDAT", 4)) {
            memcpy(p->data + p->n, b + at + 8, size);
            p->n += size;
        } else if (!memcmp(b + at + 4, "sRGB", 4))
            EXPECT(size == 1 && b[at + 8] == 0 && p->n == 0, "sRGB");
        ended = !memcmp(b + at + 4, "IEND", 4);
        at += size + 12;
    }
    EXPECT(at == n, "bytes after the end");
}

static void unfilter(Png *p, const unsigned char *in)
{
    size_t n = (size_t)p->w * 3;

    for (uint32_t y = 0; y < p->h; y++, in += n + 1) {
        unsigned char *row = p->rgb + y * n;
        REQUIRE(in[0] < 5, "filter %d", in[0]);
        p->filters[in[0]]++;
        for (size_t i = 0; i < n; i++) {
            int a = i < 3 ? 0 : row[i - 3], b = y ? *(row + i - n) : 0;
            int c = i < 3 || !y ? 0 : *(row + i - n - 3), q = a + b - c;
            int da = abs(q - a), db = abs(q - b), dc = abs(q - c);
            int guess[5] = { 0, a, b, (a + b) / 2, 0 };
            guess[4] = da <= db && da <= dc ? a : db <= dc ? b : c;
            row[i] = (unsigned char)(in[1 + i] + guess[in[0]]);
        }
        check_choice(in[0], row, y ? row - n : NULL, n);
    }
}

/* Writes im, reads it back, compares with the display bytes; adds to the filters seen. */
static size_t check_png(const Image *im, const Display *display, int *filters)
{
    FileBytes file;
    Inflate f;
    Png p = { 0, 0, NULL, NULL, 0, { 0 } };
    Quantiser q;
    size_t n = (size_t)im->w * 3, size;
    unsigned char *row = mem_array(n, 1);

    REQUIRE(row && image_write(im, in_folder("a.png"), display), "write");
    REQUIRE(file_read(in_folder("a.png"), 1 << 28, &file), "file_read");
    read_chunks(&p, (const unsigned char *)file.bytes, file.size);
    REQUIRE(p.w == im->w && p.h == im->h, "size");
    inflate_all(&f, p.data, p.n, p.h * (n + 1));
    p.rgb = mem_array(n, p.h);
    REQUIRE(p.rgb, "memory");
    unfilter(&p, f.out);
    REQUIRE(quantiser_init(&q, display, im), "quantiser_init");
    for (uint32_t y = 0; y < im->h; y++) {
        quantiser_row(&q, y, row);
        EXPECT(!memcmp(row, p.rgb + y * n, n), "row %u differs", (unsigned)y);
    }
    quantiser_clear(&q);
    for (int k = 0; k < 5; k++)
        filters[k] += p.filters[k];
    size = file.size;
    file_clear(&file);
    mem_free(row);
    mem_free(p.rgb);
    mem_free(p.data);
    mem_free(f.out);
    return size;
}

static Rgb pattern(int kind, uint32_t x, uint32_t y, Rng *r)
{
    float fx = (float)x / 64.0f, fy = (float)y / 64.0f;
    switch (kind) {
    case 0:  return rgb(rng_unit(r), rng_unit(r), rng_unit(r));
    case 1:  return rgb(0.2f, 0.4f, 0.9f);
    case 2:  return rgb(fx, fy, 0.5f * (fx + fy));
    case 3:  return rgb_all((x / 4 + y / 4) % 2 ? 1.0f : 0.0f);
    case 4:  return rgb(fx * fx + 0.05f * rng_unit(r), fy, fx * fy);
    default: return rgb_scale(rgb(fx, 1.0f - fx, fy), 0.3f + 0.7f * rng_unit(r) * fy);
    }
}

static void png_pictures(void)
{
    static const uint32_t sizes[][2] = {
        { 1, 1 }, { 2, 1 }, { 1, 2 }, { 3, 5 }, { 64, 64 }, { 131, 77 }, { 65535, 1 }, { 1, 65535 }
    };
    int filters[5] = { 0 };
    Rng r = rng_seed(9);

    for (size_t k = 0; k < sizeof sizes / sizeof sizes[0]; k++)
        for (int kind = 0; kind < 6; kind++) {
            Image im = new_image(sizes[k][0], sizes[k][1]);
            for (uint32_t y = 0; y < im.h; y++)
                for (uint32_t x = 0; x < im.w; x++)
                    *image_at(&im, x, y) = pattern(kind, x, y, &r);
            check_png(&im, NULL, filters);
            image_clear(&im);
        }
    for (int k = 0; k < 5; k++)
        EXPECT(filters[k] > 0, "filter %d is never chosen", k);
}

static void png_display(void)
{
    int filters[5] = { 0 };
    Rng r = rng_seed(10);
    Image im = new_image(40, 30);

    fill_random(&im, &r, -8, 16);
    for (const ToneMap *const *t = tonemaps; *t; t++)
        for (float stops = -2.5f; stops < 3.0f; stops += 2.5f)
            check_png(&im, &(Display){ .tonemap = *t, .exposure = stops }, filters);
    image_clear(&im);
}

/* Noise does not shrink: more than one data chunk. */
static void png_chunks(void)
{
    int filters[5] = { 0 };
    Rng r = rng_seed(11);
    Image im = new_image(700, 600);

    fill_random(&im, &r, 0, 1);
    EXPECT(check_png(&im, NULL, filters) > 1 << 20, "smaller than a chunk");
    image_clear(&im);
}

const TestCase test_image_png[] = {
    { "checksums", checksums, false },
    { "code_lengths", code_lengths, false },
    { "stored_blocks", stored_blocks, false },
    { "deflate_bytes", deflate_bytes, false },
    { "deflate_shrinks", deflate_shrinks, false },
    { "png_pictures", png_pictures, false },
    { "png_display", png_display, false },
    { "png_chunks", png_chunks, false },
    { NULL, NULL, false }
};
