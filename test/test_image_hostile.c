/* test_image_hostile.c -- broken image files, no memory, and a file system that fails: one message
 * each, no leak, no more memory than the file can justify, no half-written file. */
#include "test/image_help.h"

#include <dirent.h>
#include <errno.h>
#include <stdlib.h>
#include <unistd.h>

enum { SEED_MAX = 512, MOST_PIXELS = 1 << 16 };

/* ---- counting messages ---- */

static int messages_fd = -1, saved_fd = -1;

/* From here on standard error goes to a file of the case's folder, through a large buffer. */
static void catch_messages(void)
{
    static char buffer[1 << 16];
    FILE *f = fopen(in_folder("messages"), "w+");

    REQUIRE(f, "cannot make a file");
    messages_fd = fileno(f);
    fflush(stderr);
    saved_fd = dup(2);
    REQUIRE(saved_fd >= 0 && dup2(messages_fd, 2) == 2, "dup");
    REQUIRE(!setvbuf(stderr, buffer, _IOFBF, sizeof buffer), "setvbuf");
}

/* The lines since catch_messages must be `expected` in number and begin like those of `name`. */
static void check_messages(unsigned long expected, const char *name)
{
    FileBytes f;
    unsigned long lines = 0;
    char begin[300];
    int n = snprintf(begin, sizeof begin, "rushlight: %.200s:", name);

    fflush(stderr);
    dup2(saved_fd, 2);
    close(saved_fd);
    REQUIRE(file_read(in_folder("messages"), (uint64_t)1 << 30, &f), "file_read");
    for (const char *line = f.bytes, *end; (end = strchr(line, '\n')) != NULL; line = end + 1) {
        EXPECT(!strncmp(line, begin, (size_t)n), "message %.*s", (int)(end - line), line);
        lines++;
    }
    EXPECT(lines == expected, "%lu messages for %lu failures", lines, expected);
    file_clear(&f);
}

/* ---- one hostile file ---- */

typedef struct { unsigned long runs, failures; size_t most_refused, most_read; } Tally;

/* Can a reader justify this memory? A file that is refused: what its bytes could have held in the
 * formats without packing (12 bytes from one); nothing in the packed formats, which are checked
 * first. A file that is read: its pixels, and a row of four bytes a pixel. */
static bool justified(const Image *im, bool packed, bool ok, size_t n, size_t peak)
{
    const size_t heads = 128;                   /* of two blocks */
    if (!ok)
        return peak <= (packed ? 0 : 16 * n + heads);
    return peak <= (size_t)im->w * im->h * sizeof(Rgb) + 4 * (size_t)(im->w + im->h) + heads &&
           (packed || peak <= 16 * n + heads);
}

static bool is_empty(const Image *im) { return im->w == 0 && im->h == 0 && !im->pixels; }

static void try_bytes(const ImageFormat *f, const unsigned char *bytes, size_t n, Tally *tally)
{
    static volatile float sink;
    bool packed = !strcmp(f->info.name, "hdr") || !strcmp(f->info.name, "tga"), ok;
    long blocks = mem_blocks();
    size_t held = mem_bytes(), peak;
    float sum = 0.0f;
    Image im;
    unsigned char *exact = malloc(n ? n : 1);   /* so that one byte too far is seen */

    REQUIRE(exact, "memory");
    memcpy(exact, bytes, n);
    err_reset();
    mem_fail_at(0, false);
    ok = f->read(&im, "broken", exact, n, MOST_PIXELS, 0);
    peak = mem_peak() - held;
    EXPECT(ok == (err_status() == STATUS_OK), "%s: %d but status %d", f->info.name, ok,
           err_status());
    EXPECT(ok || is_empty(&im), "%s: refused, but not empty", f->info.name);
    EXPECT(justified(&im, packed, ok, n, peak), "%s: %lu bytes for %u x %u from a file of %lu",
           f->info.name, (unsigned long)peak, (unsigned)im.w, (unsigned)im.h, (unsigned long)n);
    if (ok) {
        EXPECT(im.w > 0 && im.h > 0 && (uint64_t)im.w * im.h <= MOST_PIXELS, "size");
        for (size_t i = 0; i < (size_t)im.w * im.h; i++)
            sum += im.pixels[i].r + im.pixels[i].g + im.pixels[i].b;
        sink = sum;
    }
    (void)sink;
    image_clear(&im);
    EXPECT(mem_blocks() == blocks, "%s: leaks", f->info.name);
    free(exact);
    tally->runs++;
    tally->failures += !ok;
    if (peak > *(ok ? &tally->most_read : &tally->most_refused))
        *(ok ? &tally->most_read : &tally->most_refused) = peak;
}

/* ---- seeds: small whole files that show every trait ---- */

typedef struct { const char *format, *name; unsigned char bytes[SEED_MAX]; size_t n; } Seed;

static void add(Seed *s, const void *bytes, size_t n)
{
    REQUIRE(s->n + n <= SEED_MAX, "%s: the seed is too large", s->name);
    memcpy(s->bytes + s->n, bytes, n);
    s->n += n;
}

static void add_text(Seed *s, const char *text) { add(s, text, strlen(text)); }

static void add_noise(Seed *s, size_t n)
{
    Rng r = rng_seed(13);
    for (; n; n--) {
        unsigned char b = (unsigned char)rng_bits(&r);
        add(s, &b, 1);
    }
}

static void add_tga(Seed *s, int kind, int bits, int map_bits, int w, int h)
{
    unsigned char head[18] = { 2, map_bits != 0, (unsigned char)kind, 1, 0, 4, 0,
        (unsigned char)map_bits, 0, 0, 0, 0, (unsigned char)w, 0, (unsigned char)h, 0,
        (unsigned char)bits, 0x20 };
    add(s, head, sizeof head);
    add_text(s, "id");
    add_noise(s, map_bits ? (size_t)(4 * ((map_bits + 7) / 8)) : 0);
}

enum { SEEDS = 10 };

static void make_seed(int k, Seed *s)
{
    static const char *const formats[SEEDS] = {
        "pfm", "pfm", "ppm", "ppm", "ppm", "hdr", "hdr", "hdr", "tga", "tga"
    };
    *s = (Seed){ .format = formats[k], .name = formats[k] };
    switch (k) {
    case 0:
        add_text(s, "PF\n4 3\n-1.5e0\n");
        add_noise(s, 4 * 3 * 12);
        break;
    case 1:
        add_text(s, "Pf 3\r\n2 1 ");
        add_noise(s, 3 * 2 * 4);
        break;
    case 2:
        add_text(s, "P6\n# a comment\n5 4\n255\n");
        add_noise(s, 5 * 4 * 3);
        break;
    case 3:
        add_text(s, "P3 # c\n3 2\n99\n1 2 3  4 5 6\n7 8 9 10 11 12\n# d\n13 14 15\t99 0 18\n");
        break;
    case 4:
        add_text(s, "P5 4 3 16383\n");
        for (int i = 0; i < 12; i++)
            add(s, "\77\377", 2);
        break;
    case 5:                                     /* new code: runs and copies in three lines */
        add_text(s, "#?RADIANCE\n# c\nFORMAT=32-bit_rle_rgbe\nEXPOSURE=1.5\n\n-Y 3 +X 10\n");
        for (int y = 0; y < 3; y++)
            add(s, "\2\2\0\12" "\212\200" "\5abcde\205f" "\2gh\204i\204j"
                "\203\177\201\200\6\200\201\202\203\204\205", 32);
        break;
    case 6:                                     /* old code: repetitions, and one of two bytes */
        add_text(s, "#?RGBE\nCOLORCORR=1 .5 2\n\n+X 2 -Y 300\n");
        for (int x = 0; x < 2; x++)
            add(s, "\200\1\2\200\1\1\1\3\3\220\0\201\201\0\0\0\1\1\1\46\1\1\1\1", 24);
        break;
    case 7:                                     /* flat */
        add_text(s, "#?RADIANCE\nGAMMA=1\n\n+Y 3 -X 5\n");
        add_noise(s, 3 * 5 * 4);
        break;
    case 8:                                     /* mapped, packed */
        add_tga(s, 9, 8, 24, 7, 3);
        add(s, "\206\1\2\1\2\3\200\4\204\3\4\1\2\3\1\4", 16);
        break;
    default:                                    /* colours, packed, a packet over two rows */
        add_tga(s, 10, 32, 0, 6, 4);
        add(s, "\210abcd\1efghijkl\214mnop", 19);
        break;
    }
}

/* Every byte changed to every value, every length, every byte left out, eight bytes put in
 * everywhere. */
static void mutate_all(const Seed *s, Tally *tally)
{
    static const unsigned char extra[8] = { 0, 1, 127, 128, 255, ' ', '9', '\n' };
    const ImageFormat *f = format_named(s->format);
    unsigned char b[SEED_MAX + 1];

    for (size_t i = 0; i < s->n; i++) {
        memcpy(b, s->bytes, s->n);
        for (int v = 1; v < 256; v++) {
            b[i] = (unsigned char)(s->bytes[i] + v);
            try_bytes(f, b, s->n, tally);
        }
        try_bytes(f, s->bytes, i, tally);
        memcpy(b, s->bytes, i);
        memcpy(b + i, s->bytes + i + 1, s->n - i - 1);
        try_bytes(f, b, s->n - 1, tally);
    }
    for (size_t i = 0; i <= s->n; i++)
        for (int k = 0; k < 8; k++) {
            memcpy(b, s->bytes, i);
            b[i] = extra[k];
            memcpy(b + i + 1, s->bytes + i, s->n - i);
            try_bytes(f, b, s->n + 1, tally);
        }
}

static void mutations(int first, int last)
{
    Tally tally = { 0, 0, 0, 0 };

    catch_messages();
    for (int k = first; k <= last; k++) {
        Seed s;
        Tally whole = { 0, 0, 0, 0 };
        make_seed(k, &s);
        try_bytes(format_named(s.format), s.bytes, s.n, &whole);
        EXPECT(whole.failures == 0, "seed %d is refused", k);
        tally.failures += whole.failures;
        mutate_all(&s, &tally);
    }
    EXPECT(tally.failures > 0 && tally.failures < tally.runs, "%lu of %lu refused", tally.failures,
           tally.runs);
    check_messages(tally.failures, "broken");
}

static void mutate_pfm(void) { mutations(0, 1); }
static void mutate_ppm(void) { mutations(2, 4); }
static void mutate_hdr(void) { mutations(5, 7); }
static void mutate_tga(void) { mutations(8, 9); }

/* Several changes at once: bytes, pieces moved and doubled, numbers made large. */
static size_t mangle(unsigned char *b, size_t n, Rng *r)
{
    for (uint32_t k = 1 + rng_below(r, 6); k && n; k--) {
        uint32_t at = rng_below(r, (uint32_t)n), from = rng_below(r, (uint32_t)n);
        uint32_t size = 1 + rng_below(r, 8);
        if (size > n - at)
            size = (uint32_t)n - at;
        if (size > n - from)
            size = (uint32_t)n - from;
        switch (rng_below(r, 6)) {
        case 0: b[at] ^= (unsigned char)(1u << rng_below(r, 8)); break;
        case 1: b[at] = (unsigned char)rng_bits(r); break;
        case 2: memmove(b + at, b + from, size); break;
        case 3: memset(b + at, rng_below(r, 2) ? 255 : 0, size); break;
        case 4: b[at] = (unsigned char)('0' + rng_below(r, 10)); break;
        default: n = at + (n - at) / (1 + rng_below(r, 2)); break;
        }
    }
    return n;
}

static void mangled(void)
{
    Rng r = rng_seed(14);
    Tally tally = { 0, 0, 0, 0 };
    unsigned rounds = test_is_long() ? 6000000 : 60000;

    catch_messages();
    for (unsigned i = 0; i < rounds; i++) {
        unsigned char b[SEED_MAX];
        Seed s;
        make_seed((int)(i % SEEDS), &s);
        memcpy(b, s.bytes, s.n);
        try_bytes(format_named(s.format), b, mangle(b, s.n, &r), &tally);
    }
    check_messages(tally.failures, "broken");
}

/* The beginning of a seed and then noise, to every reader, also those of the other formats. */
static void noise_files(void)
{
    Rng r = rng_seed(15);
    Tally tally = { 0, 0, 0, 0 };

    catch_messages();
    for (unsigned i = 0; i < 30000; i++) {
        Seed s;
        make_seed((int)(i % SEEDS), &s);
        for (uint32_t k = rng_below(&r, (uint32_t)s.n); k < s.n; k++)
            s.bytes[k] = (unsigned char)(rng_below(&r, 3) ? rng_below(&r, 3) : rng_below(&r, 256));
        for (const ImageFormat *const *f = image_formats; *f; f++)
            if ((*f)->read)
                try_bytes(*f, s.bytes, s.n, &tally);
    }
    check_messages(tally.failures, "broken");
}

/* Each seed is recognised by its own format and by no other. */
static void recognised(void)
{
    for (int k = 0; k < SEEDS; k++) {
        Seed s;
        make_seed(k, &s);
        for (const ImageFormat *const *f = image_formats; *f; f++)
            EXPECT((*f)->detect(s.bytes, s.n) == !strcmp((*f)->info.name, s.format),
                   "seed %d and %s", k, (*f)->info.name);
    }
}

/* ---- files that are wrong in one thing, and headers that lie ---- */

typedef struct { const char *format, *bytes; size_t n; } Wrong;
#define WRONG(format, s) { format, s, sizeof s - 1 }

/* All must be refused, without taking memory. */
static void refuse_all(const Wrong *w, unsigned long n)
{
    catch_messages();
    for (size_t i = 0; i < n; i++) {
        Image im;
        bool ok;
        err_reset();
        mem_fail_at(0, false);
        ok = format_named(w[i].format)->read(&im, "wrong", (const unsigned char *)w[i].bytes,
                                             w[i].n, UINT64_MAX, 0);
        EXPECT(!ok && err_status() == STATUS_INPUT && is_empty(&im), "file %d is read", (int)i);
        EXPECT(mem_peak() == 0, "file %d takes %lu bytes", (int)i, (unsigned long)mem_peak());
    }
    check_messages(n, "wrong");
}

static void wrong_headers(void)
{
    static const Wrong wrong[] = {
        WRONG("pfm", ""), WRONG("pfm", "P6 1 1 -1 abcd"), WRONG("pfm", "PFF 1 1 -1 abcdabcdabcd"),
        WRONG("pfm", "Pf x 1 -1 abcd"), WRONG("pfm", "Pf 1 x -1 abcd"), WRONG("pfm", "Pf 1 1"),
        WRONG("pfm", "Pf 0 1 -1 abcd"), WRONG("pfm", "Pf 1 -1 -1 abcd"),
        WRONG("pfm", "Pf 1 1 0 abcd"), WRONG("pfm", "Pf 1 1 nan abcd"),
        WRONG("pfm", "Pf 1 1 inf abcd"), WRONG("pfm", "Pf 1 1 -1x abcd"),
        WRONG("pfm", "Pf 1 1 -1 abc"), WRONG("pfm", "Pf 1 1 -1"),
        WRONG("pfm", "PF 1 1 1 abcdabcdabc"),
        WRONG("ppm", ""), WRONG("ppm", "P1 1 1 1"), WRONG("ppm", "P4 1 1 a"),
        WRONG("ppm", "P6x 1 1 255 abc"), WRONG("ppm", "P6 x 1 255 abc"),
        WRONG("ppm", "P6 1 x 255 abc"), WRONG("ppm", "P6 1 0 255 abc"),
        WRONG("ppm", "P6 1 1 0 abc"), WRONG("ppm", "P6 1 1 65536 abcdef"),
        WRONG("ppm", "P6 1 1 x abc"), WRONG("ppm", "P6 1 1 255 ab"),
        WRONG("ppm", "P6 1 1 256 abcde"), WRONG("ppm", "P6 1 1 2.5 abc"),
        WRONG("ppm", "P6 1 1 255"), WRONG("ppm", "P6 # 1 1 255 abc"),
        WRONG("hdr", ""), WRONG("hdr", "?#\n\n-Y 1 +X 1\nabcd"),
        WRONG("hdr", "#?RGBE\n-Y 1 +X 1\nabcd"),
        WRONG("hdr", "#?\n\nY 1 +X 1\nabcd"), WRONG("hdr", "#?\n\n-Y 1 +Y 1\nabcd"),
        WRONG("hdr", "#?\n\n-Y 1 *X 1\nabcd"), WRONG("hdr", "#?\n\n-Y 1 +Z 1\nabcd"),
        WRONG("hdr", "#?\n\n-Y 1 +X 1 1\nabcd"), WRONG("hdr", "#?\n\n-Y 1\nabcd"),
        WRONG("hdr", "#?\n\n-Y1 +X1\nabcd"), WRONG("hdr", "#?\n\n-Y 0 +X 1\nabcd"),
        WRONG("hdr", "#?\n\n-Y 1 +X -1\nabcd"), WRONG("hdr", "#?\n\n"),
        WRONG("hdr", "#?\n\n-Y 1 +X 1\nabc"), WRONG("hdr", "#?\nEXPOSURE=\n\n-Y 1 +X 1\nabcd"),
        WRONG("hdr", "#?\nEXPOSURE=-1\n\n-Y 1 +X 1\nabcd"),
        WRONG("hdr", "#?\nEXPOSURE=inf\n\n-Y 1 +X 1\nabcd"),
        WRONG("hdr", "#?\nEXPOSURE=nan\n\n-Y 1 +X 1\nabcd"),
        WRONG("hdr", "#?\nEXPOSURE=1e-38\nEXPOSURE=1e-38\n\n-Y 1 +X 1\nabcd"),
        WRONG("hdr", "#?\nCOLORCORR=1 1\n\n-Y 1 +X 1\nabcd"),
        WRONG("hdr", "#?\nCOLORCORR=1 1 0\n\n-Y 1 +X 1\nabcd"),
        WRONG("hdr", "#?\nFORMAT=\n\n-Y 1 +X 1\nabcd"),
        WRONG("hdr", "#?\n\n-Y 1 +X 4\nabcd\1\1\1\1\1\1\1\0\1\1\1\0\1\1\1\0\1\1\1\1"),
        WRONG("hdr", "#?\n\n-Y 1 +X 8\n\2\2\0\10\0\0\0\0\0\0\0\0"),
        WRONG("hdr", "#?\n\n-Y 1 +X 8\n\2\2\0\10\211a\210b\210c\210d"),
        WRONG("hdr", "#?\n\n-Y 1 +X 8\n\2\2\0\10\210a\210b\210c\10abcdefg"),
        WRONG("hdr", "#?\n\n-Y 1 +X 8\n\2\2\0\10\210a\210b\210c\210"),
        /* length of the name, map, kind, its first, number, bits, origin, 1 x 1, bits, flags */
        WRONG("tga", ""), WRONG("tga", "\0\0\2\0\0\0\0\0\0\0\0\0\1\0\1\0\30"),
        WRONG("tga", "\0\2\2\0\0\0\0\0\0\0\0\0\1\0\1\0\30\0abc"),
        WRONG("tga", "\0\0\0\0\0\0\0\0\0\0\0\0\1\0\1\0\30\0abc"),
        WRONG("tga", "\0\0\4\0\0\0\0\0\0\0\0\0\1\0\1\0\30\0abc"),
        WRONG("tga", "\0\0\42\0\0\0\0\0\0\0\0\0\1\0\1\0\30\0abc"),
        WRONG("tga", "\0\0\2\0\0\0\0\0\0\0\0\0\0\0\1\0\30\0abc"),
        WRONG("tga", "\0\0\2\0\0\0\0\0\0\0\0\0\1\0\1\0\10\0abc"),
        WRONG("tga", "\0\0\2\0\0\0\0\0\0\0\0\0\1\0\1\0\31\0abcd"),
        WRONG("tga", "\0\0\3\0\0\0\0\0\0\0\0\0\1\0\1\0\30\0abc"),
        WRONG("tga", "\0\0\2\0\0\0\0\0\0\0\0\0\1\0\1\0\30\200abc"),
        WRONG("tga", "\0\0\2\0\0\0\0\0\0\0\0\0\1\0\1\0\30\0ab"),
        WRONG("tga", "\1\0\2\0\0\0\0\0\0\0\0\0\1\0\1\0\30\0abc"),
        WRONG("tga", "\0\0\12\0\0\0\0\0\0\0\0\0\1\0\1\0\30\0\201abc"),
        WRONG("tga", "\0\0\12\0\0\0\0\0\0\0\0\0\1\0\1\0\30\0\1abcabc"),
        WRONG("tga", "\0\0\12\0\0\0\0\0\0\0\0\0\1\0\1\0\30\0\200ab"),
        WRONG("tga", "\0\0\1\0\0\1\0\30\0\0\0\0\1\0\1\0\10\0abc\0"),
        WRONG("tga", "\0\1\1\0\0\1\0\10\0\0\0\0\1\0\1\0\10\0a\0"),
        WRONG("tga", "\0\1\1\0\0\1\0\30\0\0\0\0\1\0\1\0\30\0abc\0\0\0"),
        WRONG("tga", "\0\1\1\0\0\1\0\30\0\0\0\0\1\0\1\0\10\0abc\1"),
        WRONG("tga", "\0\1\1\5\0\1\0\30\0\0\0\0\1\0\1\0\10\0abc\4"),
        WRONG("tga", "\0\1\1\0\0\2\0\30\0\0\0\0\1\0\1\0\10\0abc\0")
    };
    refuse_all(wrong, sizeof wrong / sizeof wrong[0]);
}

static void lying_headers(void)
{
    static const Wrong lies[] = {
        WRONG("pfm", "PF 65535 65535 -1 xx"), WRONG("pfm", "PF 2147483648 2 -1 xx"),
        WRONG("pfm", "PF 99999999999999999999 1 -1 x"), WRONG("ppm", "P6 65535 65535 255 xx"),
        WRONG("ppm", "P3 65535 65535 255 1 2 3"), WRONG("ppm", "P5 4294967296 4294967296 255 x"),
        WRONG("hdr", "#?RGBE\n\n-Y 65535 +X 65535\n\1\2\3\4\1\1\1\377\1\1\1\377\1\1\1\377"),
        WRONG("hdr", "#?RGBE\n\n-Y 2147483647 +X 1\n\1\2\3\4"),
        WRONG("hdr", "#?RGBE\n\n-Y 65535 +X 32767\n\2\2\177\377\377\1\377\1"),
        WRONG("tga", "\0\0\2\0\0\0\0\0\0\0\0\0\377\377\377\377\30\0xx"),
        WRONG("tga", "\0\0\12\0\0\0\0\0\0\0\0\0\377\377\377\377\40\0\377abcd\377abcd"),
        WRONG("tga", "\377\1\1\0\0\377\377\30\0\0\0\0\1\0\1\0\10\0xx")
    };
    refuse_all(lies, sizeof lies / sizeof lies[0]);
}

/* ---- broken files of other programs ---- */

/* Reads each file of a folder of test data; all are refused but those whose name is in `fine`. */
static void broken_folder(const char *name, const char *fine, int expected)
{
    char folder[300], path[600];
    int files = 0;
    struct dirent *e;
    DIR *dir;

    snprintf(folder, sizeof folder, "%s", test_data(name));
    dir = opendir(folder);
    REQUIRE(dir, "%s", folder);
    while ((e = readdir(dir)) != NULL) {
        Image im;
        bool ok;
        FileBytes f;
        if (e->d_name[0] == '.')
            continue;
        files++;
        snprintf(path, sizeof path, "%s/%s", folder, e->d_name);
        REQUIRE(file_read(path, 1 << 20, &f), "file_read");
        err_reset();
        catch_messages();
        mem_fail_at(0, false);
        ok = image_read(&im, path, IMAGE_PIXELS_DEFAULT);
        check_messages(!ok, path);
        EXPECT(ok == (err_status() == STATUS_OK), "%s", path);
        EXPECT(ok == (strstr(fine, e->d_name) != NULL), "%s: %s", path, ok ? "read" : "refused");
        EXPECT(mem_peak() <= 17 * f.size + (1 << 20), "%s: %lu bytes", path,
               (unsigned long)mem_peak());
        image_clear(&im);
        file_clear(&f);
    }
    closedir(dir);
    EXPECT(files >= expected, "%d files", files);
}

static void data_malformed(void)
{
    broken_folder("malformed/hdr", "", 3);
    broken_folder("malformed/pfm", "", 1);
    broken_folder("malformed/tga", "", 6);
    broken_folder("malformed/png", "", 7);
}

/* ---- memory and files that fail ---- */

static Image small_image(void)
{
    Image im = new_image(20, 9);
    Rng r = rng_seed(16);
    fill_random(&im, &r, -1, 2);
    return im;
}

/* Reading with the k-th allocation failing, for all k. */
static void no_memory_reading(void)
{
    for (int s = 0; s < SEEDS; s++) {
        Seed seed;
        bool ok = false;
        make_seed(s, &seed);
        for (unsigned long k = 1; !ok; k++) {
            Image im;
            err_reset();
            mem_fail_at(k, true);
            ok = read_memory(&im, seed.format, seed.bytes, seed.n);
            EXPECT(ok == (mem_calls() < k), "seed %d survives %lu of %lu", s, k, mem_calls());
            EXPECT(ok || (err_status() == STATUS_OUTPUT && is_empty(&im)), "seed %d", s);
            image_clear(&im);
            REQUIRE(k < 10, "too many allocations");
        }
        mem_fail_at(0, false);
        EXPECT(mem_blocks() == 0, "seed %d leaks", s);
    }
}

static int files_in_folder(void)
{
    DIR *dir = opendir(test_folder());
    int n = 0;
    REQUIRE(dir, "opendir");
    while (readdir(dir))
        n++;
    closedir(dir);
    return n - 2;
}

/* The old file must stand there, alone and untouched. */
static void expect_old_file(const char *path)
{
    FileBytes f;
    EXPECT(files_in_folder() == 1, "%s: %d files", path, files_in_folder());
    REQUIRE(file_read(path, 100, &f), "%s is gone", path);
    EXPECT(f.size == 3 && !memcmp(f.bytes, "old", 3), "%s was changed", path);
    file_clear(&f);
}

static void failing_writes(void)
{
    Image im = small_image();
    long blocks = mem_blocks();

    for (const ImageFormat *const *f = image_formats; *f; f++) {
        char path[400];
        if (!(*f)->write)
            continue;
        snprintf(path, sizeof path, "%s/x.%s", test_folder(), (*f)->info.name);
        for (int memory = 0; memory < 2; memory++) {
            bool ok = false;
            for (unsigned long k = 1; !ok; k++) {
                REQUIRE(file_write(path, "old", 3), "file_write");
                err_reset();
                if (memory)
                    mem_fail_at(k, true);
                else
                    file_fail_at(k, true, ENOSPC);
                ok = image_write(&im, path, NULL);
                EXPECT(ok == ((memory ? mem_calls() : file_calls()) < k), "%s: %lu", path, k);
                mem_fail_at(0, false);
                file_fail_at(0, false, 0);
                EXPECT(ok || err_status() == STATUS_OUTPUT, "%s: status %d", path, err_status());
                if (!ok)
                    expect_old_file(path);
                REQUIRE(k < 50, "too many operations");
            }
            EXPECT(mem_blocks() == blocks, "%s leaks", path);
        }
        unlink(path);
    }
    image_clear(&im);
}

const TestCase test_image_hostile[] = {
    { "mutate_pfm", mutate_pfm, false },
    { "mutate_ppm", mutate_ppm, false },
    { "mutate_hdr", mutate_hdr, false },
    { "mutate_tga", mutate_tga, false },
    { "mangled", mangled, false },
    { "noise_files", noise_files, false },
    { "recognised", recognised, false },
    { "wrong_headers", wrong_headers, false },
    { "lying_headers", lying_headers, false },
    { "data_malformed", data_malformed, false },
    { "no_memory_reading", no_memory_reading, false },
    { "failing_writes", failing_writes, false },
    { NULL, NULL, false }
};
