/* test_image_pngread.c -- reading PNG: every colour type, depth and order of pixels with values
 * that are known because the file was made here, what the samples mean, files of other programs,
 * and broken ones whose checksums are right. */
#include "image/format.h"
#include "image/inflate.h"
#include "test/png_help.h"

/* ---- inflate ---- */

typedef struct { const unsigned char *at, *end; size_t most; Rng r; } Pieces;

static bool next_piece(void *ctx, const unsigned char **at, const unsigned char **end)
{
    Pieces *p = ctx;
    size_t left = (size_t)(p->end - p->at), n = rng_below(&p->r, (uint32_t)p->most + 1);

    if (!left)
        return false;
    n = n < left ? n : left;
    *at = p->at;
    *end = p->at += n;
    return true;
}

/* Whether packed[0..n) gives bytes[0..size), taken in small pieces on both sides. */
static bool unpacks(const unsigned char *packed, size_t n, const unsigned char *bytes, size_t size,
                    size_t piece)
{
    static Inflate f;
    static unsigned char out[1 << 17];
    Pieces p = { packed, packed + n, piece, rng_seed(piece) };
    size_t made = 0;

    REQUIRE(size <= sizeof out, "room");
    inflate_init(&f, next_piece, &p);
    while (made < size) {
        size_t want = 1 + rng_below(&p.r, (uint32_t)piece), got;
        want = want < size - made ? want : size - made;
        got = inflate_take(&f, out + made, want);
        made += got;
        if (got < want)
            break;
    }
    return inflate_finish(&f) && f.made == size && made == size && !memcmp(out, bytes, size);
}

static void inflate_pieces(void)
{
    static unsigned char bytes[1 << 17];
    Rng r = rng_seed(31);

    for (int kind = 0; kind < 5; kind++) {
        unsigned char *packed;
        size_t n, size = kind == 4 ? 0 : kind == 3 ? 700 : sizeof bytes;
        for (size_t i = 0; i < size; i++)
            bytes[i] = (unsigned char)(kind == 0 ? rng_bits(&r) : kind == 1 ? i / 5000
                       : i > 33000 && rng_below(&r, 20) ? bytes[i - 32768] : rng_below(&r, 30));
        REQUIRE(zlib_compress(bytes, size, &packed, &n), "zlib_compress");
        for (size_t piece = 1; piece < 100000; piece = 9 * piece + 1)
            EXPECT(unpacks(packed, n, bytes, size, piece), "kind %d in pieces of %d", kind,
                   (int)piece);
        EXPECT(!unpacks(packed, n - 1, bytes, size, 100), "cut");
        packed[n - 1] ^= 1;
        EXPECT(!unpacks(packed, n, bytes, size, 100), "wrong sum");
        mem_free(packed);
    }
}

/* Streams by hand: a stored block, the fixed code with a copy that overlaps itself, and faults. */
static void inflate_by_hand(void)
{
    static const struct { const char *packed; size_t n; const char *bytes; } fine[] = {
        { "x\1\1\5\0\372\377hello\6\54\2\25", 16, "hello" },
        { "x\234KLD\7\0@\335\6\323", 11, "aaaaaaaaaaaaaaaaaa" }
    };
    static const struct { const char *packed; size_t n; } broken[] = {
        { "", 0 }, { "x", 1 }, { "x\2", 2 }, { "y\1", 2 }, { "x\273", 2 },
        { "x\1\7", 3 },                         /* a block of type 3 */
        { "x\1\1\5\0\372\376hello\6\54\2\25", 16 },     /* its length twice, once wrong */
        { "x\234\113\4\302", 5 },               /* a copy from before the first byte */
        { "x\234\5\340\377\377\377\377\377\377\377\377\377\377\377\377", 16 },
        { "x\234\375\377\377\377\377\377\377\377\377\377\377\377\377", 15 }
    };
    for (size_t i = 0; i < sizeof fine / sizeof *fine; i++)
        EXPECT(unpacks((const unsigned char *)fine[i].packed, fine[i].n,
                       (const unsigned char *)fine[i].bytes, strlen(fine[i].bytes), 100),
               "stream %d", (int)i);
    for (size_t i = 0; i < sizeof broken / sizeof *broken; i++)
        EXPECT(!unpacks((const unsigned char *)broken[i].packed, broken[i].n,
                        (const unsigned char *)"aaaa", 4, 100), "broken stream %d", (int)i);
}

/* ---- pictures ---- */

typedef struct {
    int w, h, depth, type, interlaced, channels;
    unsigned v[16][16][4];              /* samples by row and column */
    unsigned char palette[768], alpha[256];
    int colours, alphas;
    bool keyed;                         /* the colour of pixel (0, 0) is transparent */
} Made;

static int channels_of(int type) { return type == 2 ? 3 : type == 4 ? 2 : type == 6 ? 4 : 1; }

static void fill_made(Made *m, Rng *r)
{
    m->channels = channels_of(m->type);
    m->colours = 1 << (m->depth < 8 ? m->depth : 8);
    if (m->depth == 8)
        m->colours -= (int)rng_below(r, 200);
    m->alphas = (int)rng_below(r, (uint32_t)m->colours + 1);
    m->keyed = m->type < 3 && rng_below(r, 2);
    for (int i = 0; i < 768; i++)
        m->palette[i] = (unsigned char)rng_bits(r);
    for (int i = 0; i < 256; i++)
        m->alpha[i] = (unsigned char)rng_bits(r);
    for (int y = 0; y < m->h; y++)
        for (int x = 0; x < m->w; x++)
            for (int k = 0; k < m->channels; k++) {
                unsigned most = m->type == 3 ? (unsigned)m->colours : 1u << m->depth;
                m->v[y][x][k] = x && rng_below(r, 3) ? m->v[y][x - 1][k] : rng_below(r, most);
            }
}

/* The rows of one pass behind what raw holds; returns the new length. Tables as [PNG 8.2] has them:
 * which pass each pixel of a square of 8 x 8 belongs to. */
static size_t add_pass(const Made *m, int pass, unsigned char *raw, size_t n, Rng *r)
{
    static const char order[8][9] = { "16462646", "77777777", "56565656", "77777777", "36463646",
                                      "77777777", "56565656", "77777777" };
    unsigned char rows[2][128] = { { 0 } }, *row = rows[0], *above = NULL;
    size_t step = (size_t)(m->channels * m->depth + 7) / 8;

    for (int y = 0; y < m->h; y++) {
        size_t k = 0, bytes;
        memset(row, 0, sizeof rows[0]);
        for (int x = 0; x < m->w; x++)
            if (!m->interlaced || order[y % 8][x % 8] == '0' + pass)
                for (int c = 0; c < m->channels; c++)
                    png_sample(row, k++, m->depth, m->v[y][x][c]);
        if (!k)
            continue;
        bytes = (k * (size_t)m->depth + 7) / 8;
        png_filter((int)rng_below(r, 5), row, above, bytes, step, raw + n);
        n += bytes + 1;
        above = row;
        row = row == rows[0] ? rows[1] : rows[0];
    }
    return n;
}

static void make_png(const Made *m, PngFile *f, Rng *r)
{
    unsigned char raw[4096], key[6];
    size_t n = 0;

    png_begin(f, (uint32_t)m->w, (uint32_t)m->h, m->depth, m->type, m->interlaced);
    png_chunk(f, "tEXt", "nothing", 7);
    if (m->type == 3)
        png_chunk(f, "PLTE", m->palette, 3 * (size_t)m->colours);
    if (m->type == 3 && m->alphas)
        png_chunk(f, "tRNS", m->alpha, (size_t)m->alphas);
    for (int c = 0; c < m->channels && m->keyed; c++) {
        key[2 * c] = (unsigned char)(m->v[0][0][c] >> 8);
        key[2 * c + 1] = (unsigned char)m->v[0][0][c];
    }
    if (m->keyed)
        png_chunk(f, "tRNS", key, 2 * (size_t)m->channels);
    for (int pass = 1; pass <= (m->interlaced ? 7 : 1); pass++)
        n = add_pass(m, pass, raw, n, r);
    png_data(f, raw, n, 1 + rng_below(r, 60));
}

/* What pixel (x, y) must be: with straight samples, as told to be linear. */
static void expected(const Made *m, int x, int y, float *c)
{
    const unsigned *v = m->v[y][x];
    float most = (float)((1u << m->depth) - 1);

    for (int k = 0; k < 3; k++)
        c[k] = m->type == 3 ? (float)m->palette[3 * v[0] + (unsigned)k] / 255.0f
                            : (float)v[m->type & 2 ? k : 0] / most;
    c[3] = 1.0f;
    if (m->type == 3)
        c[3] = (int)v[0] < m->alphas ? (float)m->alpha[v[0]] / 255.0f : 1.0f;
    else if (m->type & 4)
        c[3] = (float)v[m->channels - 1] / most;
    else if (m->keyed && !memcmp(v, m->v[0][0], (size_t)m->channels * sizeof *v))
        c[3] = 0.0f;
}

static void check_made(const Made *m, const PngFile *f)
{
    bool opaque = true;
    Image im;

    REQUIRE(format_named("png")->read(&im, "memory", f->bytes, f->n, 256, ENCODING_LINEAR),
            "type %d, depth %d, %d x %d", m->type, m->depth, m->w, m->h);
    EXPECT((int)im.w == m->w && (int)im.h == m->h, "size");
    for (int y = 0; y < m->h; y++)
        for (int x = 0; x < m->w; x++) {
            size_t i = (size_t)(y * m->w + x);
            Rgb p = im.pixels[i];
            float c[4], a = im.alpha ? im.alpha[i] : 1.0f;
            expected(m, x, y, c);
            opaque = opaque && c[3] == 1.0f;
            EXPECT(p.r == c[0] && p.g == c[1] && p.b == c[2] && a == c[3],
                   "type %d, depth %d, %s, pixel %d, %d", m->type, m->depth,
                   m->interlaced ? "interlaced" : "plain", x, y);
        }
    EXPECT(opaque == !im.alpha, "an alpha of ones is dropped, another one is not");
    image_clear(&im);
}

static const struct { int type, depth; } kinds[] = {
    { 0, 1 }, { 0, 2 }, { 0, 4 }, { 0, 8 }, { 0, 16 }, { 2, 8 }, { 2, 16 }, { 3, 1 }, { 3, 2 },
    { 3, 4 }, { 3, 8 }, { 4, 8 }, { 4, 16 }, { 6, 8 }, { 6, 16 }
};
enum { KINDS = sizeof kinds / sizeof *kinds };

static void all_kinds(void)
{
    Rng r = rng_seed(32);

    for (int k = 0; k < KINDS; k++)
        for (int round = 0; round < 40; round++) {
            static PngFile f;
            static Made m;
            m.w = 1 + (int)rng_below(&r, 15);
            m.h = 1 + (int)rng_below(&r, 15);
            m.type = kinds[k].type;
            m.depth = kinds[k].depth;
            m.interlaced = round & 1;
            fill_made(&m, &r);
            make_png(&m, &f, &r);
            check_made(&m, &f);
        }
}

/* What was written comes back: the display bytes are the same again. */
static void round_trip(void)
{
    Rng r = rng_seed(33);
    Image im = new_image(67, 41), back;
    Quantiser q, p;

    fill_random(&im, &r, -5, 6);
    REQUIRE(image_write(&im, in_folder("a.png"), NULL), "write");
    REQUIRE(image_read(&back, in_folder("a.png"), 67 * 41), "read");
    EXPECT(!back.alpha, "alpha");
    REQUIRE(quantiser_init(&q, NULL, &im) && quantiser_init(&p, NULL, &back), "quantiser_init");
    for (uint32_t y = 0; y < im.h; y++) {
        unsigned char a[67 * 3], b[67 * 3];
        quantiser_row(&q, y, a);
        quantiser_row(&p, y, b);
        EXPECT(!memcmp(a, b, sizeof a), "row %u", (unsigned)y);
    }
    image_clear(&im);
    image_clear(&back);
}

/* ---- what samples mean ---- */

/* The grey 100 of a file with these chunks, read with this encoding. */
static float grey_of(uint32_t gamma, const char *other, Encoding encoding)
{
    static PngFile f;
    unsigned char g[4];
    Image im;
    float v;

    png_begin(&f, 1, 1, 8, 0, 0);
    png_u32(g, gamma);
    if (gamma)
        png_chunk(&f, "gAMA", g, 4);
    if (other)
        png_chunk(&f, other, "", 1);
    png_data(&f, (const unsigned char *)"\0\144", 2, 99);
    REQUIRE(format_named("png")->read(&im, "memory", f.bytes, f.n, 1, encoding), "read");
    v = im.pixels[0].r;
    image_clear(&im);
    return v;
}

static void encodings(void)
{
    const float x = 100.0f / 255.0f, curve = srgb_decode(x);

    EXPECT(grey_of(0, NULL, ENCODING_BY_FILE) == curve, "sRGB unless the file says otherwise");
    EXPECT(grey_of(45455, NULL, ENCODING_BY_FILE) == curve, "1 / 2.2 stands for sRGB");
    EXPECT(grey_of(100000, NULL, ENCODING_BY_FILE) == x, "1 is linear");
    EXPECT(grey_of(100000, "sRGB", ENCODING_BY_FILE) == curve, "sRGB comes before gAMA");
    EXPECT(grey_of(100000, "iCCP", ENCODING_BY_FILE) == curve, "so does a profile");
    EXPECT(grey_of(50000, NULL, ENCODING_BY_FILE) == m_pow(x, 2.0f), "1/2: squared");
    EXPECT(grey_of(100000, NULL, ENCODING_SRGB) == curve, "told to be sRGB");
    EXPECT(grey_of(45455, "sRGB", ENCODING_LINEAR) == x, "told to be linear");
    EXPECT(grey_of(45455, "sRGB", 1.8f) == m_pow(x, 1.8f), "told another exponent");
}

static void other_formats(void)
{
    static const unsigned char tga[22] = { 0, 0, 2, 0, 0, 0, 0, 0, 0, 0, 0, 0, 1, 0, 1, 0, 32, 8,
                                           30, 20, 10, 51 };
    Image im;

    REQUIRE(format_named("tga")->read(&im, "memory", tga, 22, 1, 2.0f), "tga");
    EXPECT(im.pixels[0].r == m_pow(10.0f / 255.0f, 2.0f) && im.alpha && im.alpha[0] == 0.2f,
           "tga: encoding and alpha");
    image_clear(&im);
    REQUIRE(format_named("ppm")->read(&im, "memory", (const unsigned char *)"P5 1 1 4\n\2", 10, 1,
                                      ENCODING_LINEAR), "ppm");
    EXPECT(im.pixels[0].r == 0.5f && !im.alpha, "ppm");
    image_clear(&im);
}

/* ---- files of other programs ---- */

/* CRC-32 of the samples that libpng gives, expanded to 16 bits of red, green, blue and alpha. */
static uint32_t crc_of_samples(const Image *im)
{
    uint32_t crc = 0;

    for (size_t i = 0; i < (size_t)im->w * im->h; i++) {
        float v[4] = { im->pixels[i].r, im->pixels[i].g, im->pixels[i].b,
                       im->alpha ? im->alpha[i] : 1.0f };
        unsigned char b[8];
        for (int k = 0; k < 4; k++) {
            unsigned s = (unsigned)(v[k] * 65535.0f + 0.5f);
            b[2 * k] = (unsigned char)(s >> 8);
            b[2 * k + 1] = (unsigned char)s;
        }
        crc = checksum_crc32(crc, b, 8);
    }
    return crc;
}

static void data_png(void)
{
    static const struct { const char *name; uint32_t w, h; unsigned long crc; } known[] = {
        { "png/basi0g01.png", 32, 32, 1528237258 },
        { "png/basi0g08.png", 32, 32, 2811970424 },
        { "png/basi0g16.png", 32, 32, 89686505 },
        { "png/basi3p02.png", 32, 32, 1669504077 },
        { "png/basi4a08.png", 32, 32, 3273968578 },
        { "png/basn0g02.png", 32, 32, 2055212725 },
        { "png/basn0g16.png", 32, 32, 89686505 },
        { "png/basn2c08.png", 32, 32, 3081450955 },
        { "png/basn3p04.png", 32, 32, 2124724531 },
        { "png/basn6a08.png", 32, 32, 2973292814 },
        { "png/bgai4a16.png", 32, 32, 3845379373 },
        { "png/bgbn4a08.png", 32, 32, 3273968578 },
        { "png/oi1n0g16.png", 32, 32, 89686505 },
        { "png/oi4n0g16.png", 32, 32, 89686505 },
        { "png/s01n3p01.png", 1, 1, 3147431818 },
        { "png/s03i3p01.png", 3, 3, 531031025 },
        { "png/s04n3p01.png", 4, 4, 3743638504 },
        { "png/s06i3p02.png", 6, 6, 481140008 },
        { "png/s07n3p02.png", 7, 7, 3987382228 },
        { "png/s09i3p02.png", 9, 9, 967794091 },
        { "png/s32n3p04.png", 32, 32, 1853420045 },
        { "png/s34i3p04.png", 34, 34, 3957573263 },
        { "png/s35n3p04.png", 35, 35, 355228088 },
        { "png/s37i3p04.png", 37, 37, 2011381619 },
        { "png/s38n3p04.png", 38, 38, 1282837860 },
        { "png/s40i3p04.png", 40, 40, 2113597778 },
        { "png/tbbn2c16.png", 32, 32, 3690889999 },
        { "png/tbbn3p08.png", 32, 32, 2771463751 },
        { "png/tbwn3p08.png", 32, 32, 2771463751 },
        { "png/tp0n0g08.png", 32, 32, 1653252178 },
        { "png/tp1n3p08.png", 32, 32, 2771463751 },
        { "png/z06n2c08.png", 32, 32, 1912178247 },
        { "scenes/killeroos/textures/lines.png", 1024, 1024, 3828412905 },
        { "scenes/simple-room/textures/buildingblock.png", 512, 512, 1392046566 },
        { "obj/forms/cube_texture.png", 256, 256, 3429872319 },
        { "meshes/spot_texture.png", 1024, 1024, 2318579924 }
    };
    for (size_t i = 0; i < sizeof known / sizeof *known; i++) {
        Image im;
        REQUIRE(image_read_as(&im, test_data(known[i].name), IMAGE_PIXELS_DEFAULT,
                              ENCODING_LINEAR), "%s", known[i].name);
        EXPECT(im.w == known[i].w && im.h == known[i].h, "%s: %u x %u", known[i].name,
               (unsigned)im.w, (unsigned)im.h);
        EXPECT(crc_of_samples(&im) == known[i].crc, "%s: crc %lu", known[i].name,
               (unsigned long)crc_of_samples(&im));
        image_clear(&im);
    }
}

/* ---- hostile files whose checksums are right ---- */

/* Makes the sums of all chunks right again, as far as there are chunks. */
static void mend(unsigned char *b, size_t n)
{
    size_t at = PNG_SIGNATURE;

    while (n - at >= 12) {
        size_t size = (size_t)b[at] << 24 | (size_t)b[at + 1] << 16 | (size_t)b[at + 2] << 8 |
                      b[at + 3];
        if (size > n - at - 12)
            return;
        png_u32(b + at + 8 + size, checksum_crc32(0, b + at + 4, size + 4));
        at += size + 12;
    }
}

/* Reads it from a block of exactly its size, so that a byte too far is seen; no leak, no more
 * memory than is promised. */
static bool survives(const unsigned char *bytes, size_t n, bool expect_refused)
{
    unsigned char *exact = malloc(n ? n : 1);
    size_t before = mem_bytes(), most = 32 * n + 60000;
    long blocks = mem_blocks();
    Image im;
    bool ok;

    REQUIRE(exact, "memory");
    memcpy(exact, bytes, n);
    err_reset();
    mem_fail_at(0, false);
    ok = format_named("png")->read(&im, "hostile", exact, n, 1 << 20, 0);
    EXPECT(ok == (err_status() == STATUS_OK), "status");
    EXPECT(ok || (!im.pixels && !im.alpha), "refused, but not empty");
    if (ok)
        most += (size_t)im.w * im.h * 20;
    EXPECT(mem_peak() - before <= most, "%lu bytes for a file of %lu",
           (unsigned long)(mem_peak() - before), (unsigned long)n);
    EXPECT(!ok || !expect_refused, "is read");
    image_clear(&im);
    EXPECT(mem_blocks() == blocks, "leaks");
    free(exact);
    return ok;
}

static void seed_png(PngFile *f, int k, Rng *r)
{
    static Made m;

    m.w = 9;
    m.h = 7;
    m.type = kinds[k % KINDS].type;
    m.depth = kinds[k % KINDS].depth;
    m.interlaced = k / KINDS % 2;
    fill_made(&m, r);
    make_png(&m, f, r);
}

static void mutated(void)
{
    static PngFile f;
    Rng r = rng_seed(34);
    unsigned rounds = test_is_long() ? 2000000 : 20000;
    unsigned long read = 0, refused = 0;

    for (unsigned i = 0; i < rounds; i++) {
        seed_png(&f, (int)i, &r);
        for (uint32_t k = 1 + rng_below(&r, 3); k; k--) {
            uint32_t at = 8 + rng_below(&r, (uint32_t)f.n - 8);
            f.bytes[at] = (unsigned char)(rng_below(&r, 2) ? f.bytes[at] ^ 1u << rng_below(&r, 8)
                                                           : rng_bits(&r));
        }
        if (rng_below(&r, 8) == 0)
            f.n = 8 + rng_below(&r, (uint32_t)f.n - 8);
        mend(f.bytes, f.n);
        if (survives(f.bytes, f.n, false))
            read++;
        else
            refused++;
    }
    EXPECT(read > rounds / 100 && refused > rounds / 3, "%lu read, %lu refused", read, refused);
}

static void cut_everywhere(void)
{
    static PngFile f;
    Rng r = rng_seed(35);

    for (int k = 0; k < KINDS; k++) {
        seed_png(&f, k, &r);
        for (size_t n = 0; n < f.n; n++)
            survives(f.bytes, n, true);
        EXPECT(survives(f.bytes, f.n, false), "the whole");
        for (size_t i = 8; i < f.n; i++) {              /* every bit counts */
            f.bytes[i] ^= 16;
            survives(f.bytes, f.n, true);
            f.bytes[i] ^= 16;
        }
    }
}

/* Files that are wrong in one thing: chunks by their letters, in this order. */
static void wrong_chunks(void)
{
    static const struct { int type, depth; const char *chunks; bool fine; } forms[] = {
        { 0, 8, "DE", true }, { 0, 8, "tDE", true }, { 0, 8, "PDE", true }, { 0, 8, "D", false },
        { 0, 8, "E", false }, { 0, 8, "DtDE", false }, { 0, 8, "HDE", false },
        { 3, 8, "DE", false }, { 3, 8, "PDE", true }, { 3, 8, "DPE", false },
        { 3, 8, "PPDE", false }, { 3, 8, "TPDE", false }, { 3, 8, "PTDE", true },
        { 2, 8, "TDE", false }, { 0, 8, "XDE", false }, { 1, 8, "DE", false },
        { 2, 4, "DE", false }, { 3, 16, "PDE", false }, { 0, 3, "DE", false },
        { 5, 8, "DE", false }, { 7, 8, "DE", false }, { 255, 255, "DE", false }
    };
    static const unsigned char raw[4] = { 0, 0, 0, 0 };

    for (size_t i = 0; i < sizeof forms / sizeof *forms; i++) {
        static PngFile f;
        size_t n;
        unsigned char *packed;
        REQUIRE(zlib_compress(raw, forms[i].type == 2 ? 4 : 2, &packed, &n), "zlib_compress");
        png_begin(&f, 1, 1, forms[i].depth, forms[i].type, 0);
        for (const char *c = forms[i].chunks; *c; c++)
            switch (*c) {
            case 'H': png_chunk(&f, "IHDR", f.bytes + 16, 13); break;
            case 'P': png_chunk(&f, "PLTE", "abc", 3); break;
            case 'T': png_chunk(&f, "tRNS", "a", 1); break;
            case 't': png_chunk(&f, "tEXt", "a", 1); break;
            case 'X': png_chunk(&f, "XxXx", "a", 1); break;
            case 'D': png_chunk(&f, "IDAT", packed, n); break;
            default:  png_chunk(&f, "IEND", NULL, 0); break;
            }
        EXPECT(survives(f.bytes, f.n, !forms[i].fine) == forms[i].fine, "form %d", (int)i);
        mem_free(packed);
    }
}

/* A kilobyte that claims ten thousand million pixels, or as many as its packed bytes could hold but
 * do not, is refused before memory is taken for them. */
static void lying_sizes(void)
{
    static PngFile f;
    static unsigned char raw[1000];
    const uint32_t sizes[3][2] = { { 100000, 100000 }, { 2147483647, 1 }, { 2000, 30 } };
    unsigned char *packed;
    size_t n;

    REQUIRE(zlib_compress(raw, 2, &packed, &n), "zlib_compress");
    for (int k = 0; k < 3; k++) {
        Image im;
        png_begin(&f, sizes[k][0], sizes[k][1], 1, 0, 0);
        png_chunk(&f, "tEXt", raw, 900);
        png_chunk(&f, "IDAT", packed, n);
        png_chunk(&f, "IEND", NULL, 0);
        err_reset();
        mem_fail_at(0, false);
        EXPECT(!format_named("png")->read(&im, "lie", f.bytes, f.n, UINT64_MAX, 0), "read");
        EXPECT(mem_peak() <= (k < 2 ? 0 : sizeof(Inflate) + 1000) + (size_t)mem_bytes(),
               "%d: %lu bytes", k, (unsigned long)mem_peak());
    }
    mem_free(packed);
}

static void no_memory(void)
{
    static PngFile f;
    Rng r = rng_seed(36);

    seed_png(&f, 14, &r);
    for (unsigned long k = 1; k < 10; k++) {
        Image im;
        bool ok;
        err_reset();
        mem_fail_at(k, true);
        ok = format_named("png")->read(&im, "memory", f.bytes, f.n, 1000, 0);
        EXPECT(ok == (mem_calls() < k), "%lu", k);
        image_clear(&im);
        mem_fail_at(0, false);
        EXPECT(mem_blocks() == 0, "leaks");
    }
}

/* Kinds that are known but not read are named, with what to do about it. */
static void foreign(void)
{
    static const struct { const char *bytes; size_t n; } files[] = {
        { "\377\330\377\340\0\20JFIF\0", 11 }, { "\166\57\61\1\2\0\0\0", 8 }, { "GIF89a", 6 },
        { "II*\0\10\0\0\0", 8 }, { "RIFF\0\0\0\0WEBP", 12 }, { "\377\330", 2 }, { "", 0 }
    };
    for (size_t i = 0; i < sizeof files / sizeof *files; i++) {
        Image im;
        REQUIRE(file_write(in_folder("x.jpg"), files[i].bytes, files[i].n), "write");
        err_reset();
        EXPECT(!image_read(&im, in_folder("x.jpg"), 100) && err_status() == STATUS_INPUT, "%d",
               (int)i);
    }
}

const TestCase test_image_pngread[] = {
    { "inflate_pieces", inflate_pieces, false },
    { "inflate_by_hand", inflate_by_hand, false },
    { "all_kinds", all_kinds, false },
    { "round_trip", round_trip, false },
    { "encodings", encodings, false },
    { "other_formats", other_formats, false },
    { "data_png", data_png, false },
    { "mutated", mutated, false },
    { "cut_everywhere", cut_everywhere, false },
    { "wrong_chunks", wrong_chunks, false },
    { "lying_sizes", lying_sizes, false },
    { "no_memory", no_memory, false },
    { "foreign", foreign, false },
    { NULL, NULL, false }
};
