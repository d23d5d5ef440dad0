/* test_image.c -- images in memory: the sRGB curve, display bytes, tone maps, and every format
 * against bytes made by hand and against files of other programs. */
#include "base/mem.h"
#include "image/deflate.h"
#include "image/format.h"
#include "image/image.h"
#include "test/image_help.h"

#include <float.h>
#include <stdlib.h>

/* ---- curves and display bytes ---- */

static void srgb_curve(void)
{
    /* IEC 61966-2-1 worked out to 40 digits. */
    static const double known[][3] = {          /* x, decode(x), encode(x) */
        { 0.03125, 0.00241873065015479876, 0.19394684976967976966 },
        { 0.0625, 0.00515566839903260025, 0.27730417691097279721 },
        { 0.25, 0.05087608817155679056, 0.53709873048319424775 },
        { 0.5, 0.21404114048223244240, 0.73535698305244949462 },
        { 0.75, 0.52252155396839181772, 0.88082502109029975368 },
        { 0.984375, 0.96482275285539016671, 0.99309994794155214955 }
    };
    float last = -1.0f;

    for (size_t i = 0; i < sizeof known / sizeof known[0]; i++) {
        float x = (float)known[i][0];
        EXPECT(srgb_decode(x) == (float)known[i][1], "decode(%g) = %.9g", x, srgb_decode(x));
        EXPECT(srgb_encode(x) == (float)known[i][2], "encode(%g) = %.9g", x, srgb_encode(x));
    }
    EXPECT(srgb_encode(-1.0f) == 0.0f && srgb_encode(1.5f) == 1.0f && srgb_encode(NAN) == 0.0f &&
           srgb_encode(INFINITY) == 1.0f, "encode does not clamp");
    EXPECT(srgb_decode(-1.0f) == 0.0f && srgb_decode(1.5f) == 1.0f && srgb_decode(NAN) == 0.0f &&
           srgb_decode(1.0f) == 1.0f && srgb_decode(0.0f) == 0.0f, "decode does not clamp");
    for (int i = 0; i <= 65535; i++) {
        float x = (float)i / 65535.0f, y = srgb_decode(x);
        /* x dy / (y dx) is nowhere below 1, so the rounding of y (0.51 ulp) comes back no larger,
         * relative to x, and encode adds its own. At the joint of the two branches the standard's
         * constants miss each other by 3e-8. */
        EXPECT(fabs((double)srgb_encode(y) - x) <= 2.04 * 0x1p-24 * x +
               (fabsf(x - 0.04045f) < 1e-6f ? 3e-8 : 0), "at %d", i);
        EXPECT(y > last, "decode does not grow at %d", i);
        last = y;
    }
}

static int rounded(float linear) { return (int)floor((double)srgb_encode(linear) * 255.0 + 0.5); }

static void display_bytes(void)
{
    Rng r = rng_seed(1);
    unsigned char b[3];
    Rgb odd[3] = {
        { -1.0f, NAN, INFINITY }, { -0.0f, -INFINITY, FLT_MAX }, { 1e-30f, 0.5f, 2.0f }
    };
    static const unsigned char expected[9] = { 0, 0, 255, 0, 0, 255, 0, 188, 255 };
    Display half = { .exposure = -1.0f };

    for (int i = 0; i < 256; i++) {
        colour_bytes(rgb_all(srgb_decode((float)i / 255.0f)), NULL, b);
        EXPECT(b[0] == i && b[1] == i && b[2] == i, "byte %d comes back as %d", i, b[0]);
    }
    for (int i = 0; i < 20000; i++) {
        float x = rng_unit(&r), e = srgb_encode(x) * 255.0f;
        colour_bytes(rgb_all(x), NULL, b);
        /* Just at a threshold the rounding of the curve may decide otherwise. */
        EXPECT(b[0] == rounded(x) || fabsf(e - floorf(e) - 0.5f) < 1e-4f, "%.9g: %d", x, b[0]);
    }
    for (int i = 0; i < 3; i++) {
        colour_bytes(odd[i], NULL, b);
        EXPECT(!memcmp(b, expected + 3 * i, 3), "%d: %d %d %d", i, b[0], b[1], b[2]);
    }
    colour_bytes((Rgb){ 1.0f, 0.5f, 2.0f }, &half, b);
    EXPECT(b[0] == rounded(0.5f) && b[1] == rounded(0.25f) && b[2] == 255, "an exposure of -1");
}

/* ---- the list ---- */

static void formats(void)
{
    Image im;
    const unsigned char png[8] = { 137, 80, 78, 71, 13, 10, 26, 10 };

    for (const ImageFormat *const *f = image_formats; *f; f++) {
        EXPECT((*f)->read || (*f)->write, "%s does nothing", (*f)->info.name);
        EXPECT(!(*f)->detect((const unsigned char *)"", 0), "%s detects nothing", (*f)->info.name);
        EXPECT(format_named((*f)->info.name) == *f, "two are called %s", (*f)->info.name);
    }
    EXPECT(image_format_for_writing("a/b.png") == format_named("png"), "png");
    EXPECT(image_format_for_writing("A.PFM") == format_named("pfm"), "case counts");
    EXPECT(image_format_for_writing("x.rgbe") == format_named("hdr"), "second extension");
    EXPECT(err_status() == STATUS_OK, "status %d", err_status());
    for (int i = 0; i < 5; i++) {
        static const char *const bad[5] = { "x.tga", "x.xyz", "png", "a.png/b", "x." };
        err_reset();
        EXPECT(!image_format_for_writing(bad[i]) && err_status() == STATUS_USAGE, "%s", bad[i]);
    }
    err_reset();
    REQUIRE(file_write(in_folder("x.png"), png, sizeof png), "file_write");
    EXPECT(!image_read(&im, in_folder("x.png"), 100) && err_status() == STATUS_INPUT, "png");
    err_reset();
    REQUIRE(file_write(in_folder("y.pfm"), "hello", 5), "file_write");
    EXPECT(!image_read(&im, in_folder("y.pfm"), 100) && err_status() == STATUS_INPUT, "no image");
    err_reset();
    EXPECT(!image_read(&im, in_folder("none.pfm"), 100) && err_status() == STATUS_INPUT, "none");
    EXPECT(!im.pixels && !im.w && !im.h && mem_blocks() == 0, "%ld blocks", mem_blocks());
}

static void sizes(void)
{
    const int64_t most = INT32_MAX;
    const struct { int64_t w, h; uint64_t most; bool fits; } cases[] = {
        { 1, 1, 1, true }, { 3, 4, 12, true }, { 3, 4, 11, false }, { 0, 1, 9, false },
        { 1, 0, 9, false }, { -1, -1, 9, false }, { 1, 1, 0, false },
        { most, most, UINT64_MAX, true }, { most + 1, 1, UINT64_MAX, false },
        { 1, most + 1, UINT64_MAX, false }, { INT64_MAX, INT64_MAX, UINT64_MAX, false }
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        err_reset();
        EXPECT(image_size_fits((Place){ "x", 0, 0 }, cases[i].w, cases[i].h, cases[i].most) ==
               cases[i].fits, "case %d", (int)i);
        EXPECT((err_status() == STATUS_OK) == cases[i].fits, "case %d: status", (int)i);
    }
}

/* ---- PFM ---- */

static void pfm_bytes(void)
{
    /* Two columns, two rows, from bottom to top: 1 2 / 3 -0.5. */
    static const unsigned char big[] = {
        'P', 'f', '\n', '2', ' ', '2', '\n', '1', '\n', 0x3F, 0x80, 0, 0, 0x40, 0, 0, 0,
        0x40, 0x40, 0, 0, 0xBF, 0, 0, 0
    };
    static const unsigned char little[] = {     /* one pixel, scale 2, CRLF before the floats */
        'P', 'F', '\r', '\n', '1', ' ', '1', '\r', '\n', '-', '2', '.', '0', '\r', '\n',
        0, 0, 0x80, 0x3F, 0, 0, 0, 0x40, 0, 0, 0, 0xBF
    };
    static const unsigned char begins_lf[] = {  /* the first byte of the floats is a line feed */
        'P', 'f', ' ', '1', ' ', '1', ' ', '-', '1', '\r', '\n', 0, 0x80, 0x3F
    };
    Image im;

    REQUIRE(read_memory(&im, "pfm", big, sizeof big), "big-endian");
    EXPECT(im.w == 2 && im.h == 2, "size");
    EXPECT(im.pixels[2].r == 1 && im.pixels[3].g == 2 && im.pixels[0].b == 3 &&
           im.pixels[1].r == -0.5f, "pixels");
    image_clear(&im);
    REQUIRE(read_memory(&im, "pfm", little, sizeof little), "little-endian");
    EXPECT(im.pixels[0].r == 2 && im.pixels[0].g == 4 && im.pixels[0].b == -1, "pixels");
    image_clear(&im);
    REQUIRE(read_memory(&im, "pfm", begins_lf, sizeof begins_lf), "line feed");
    EXPECT(float_bits(im.pixels[0].r) == 0x3F80000A, "%08x", (unsigned)float_bits(im.pixels[0].r));
    image_clear(&im);
}

/* Random finite floats, high byte first. */
static void pfm_big_endian(void)
{
    unsigned char file[12 + 12 * 50] = "PF 25 2 1\n";
    Rng r = rng_seed(19);
    uint32_t bits[150];
    Image im;

    for (int i = 0; i < 150; i++) {
        bits[i] = (uint32_t)rng_bits(&r) & 0xBFFFFFFF;
        for (int k = 0; k < 4; k++)
            file[10 + 4 * i + k] = (unsigned char)(bits[i] >> (24 - 8 * k));
    }
    REQUIRE(read_memory(&im, "pfm", file, 10 + 600), "read");
    for (int i = 0; i < 50; i++) {
        Rgb c = *image_at(&im, (uint32_t)i % 25, 1 - (uint32_t)i / 25);
        EXPECT(float_bits(c.r) == bits[3 * i] && float_bits(c.g) == bits[3 * i + 1] &&
               float_bits(c.b) == bits[3 * i + 2], "pixel %d", i);
    }
    image_clear(&im);
}

static void pfm_round_trip(void)
{
    static const uint32_t special[] = {
        0x00000000, 0x80000000, 0x00000001, 0x807FFFFF, 0x7F7FFFFF, 0x7F800000, 0xFF800000,
        0x7FC00000
    };
    Image im = new_image(37, 23), back;
    Rng r = rng_seed(2);

    for (size_t i = 0; i < 37 * 23; i++) {
        uint32_t v[3];
        for (int c = 0; c < 3; c++) {
            v[c] = (uint32_t)rng_bits(&r);
            if ((v[c] & 0x7F800000) == 0x7F800000)      /* a random payload is not promised */
                v[c] = special[v[c] % 8];
        }
        im.pixels[i] = rgb(float_of_bits(v[0]), float_of_bits(v[1]), float_of_bits(v[2]));
    }
    for (int i = 0; i < 8; i++)
        im.pixels[i].g = float_of_bits(special[i]);
    REQUIRE(image_write(&im, in_folder("a.pfm"), NULL), "write");
    REQUIRE(image_read(&back, in_folder("a.pfm"), 37 * 23), "read");
    EXPECT(back.w == 37 && back.h == 23, "size");
    EXPECT(same_pixels(im.pixels, back.pixels, 37 * 23), "bits differ");
    image_clear(&back);
    EXPECT(!image_read(&back, in_folder("a.pfm"), 37 * 23 - 1), "max_pixels is not kept");
    image_clear(&im);
}

/* ---- PPM ---- */

static void expect_bytes(const Image *im, const char *what, const int *expected)
{
    for (size_t i = 0; i < (size_t)im->w * im->h; i++) {
        Rgb c = im->pixels[i];
        const int *e = expected + 3 * i;
        EXPECT(c.r == srgb_decode((float)e[0] / 255.0f) && c.g == srgb_decode((float)e[1] / 255.0f)
               && c.b == srgb_decode((float)e[2] / 255.0f), "%s: pixel %lu is %g %g %g", what,
               (unsigned long)i, c.r, c.g, c.b);
    }
}

static void ppm_bytes(void)
{
    static const struct { const char *bytes; size_t n; } files[] = {
#define FILE_OF(s) { s, sizeof s - 1 }
        FILE_OF("P3 2 1 255 1 2 3 253 254 255"),
        FILE_OF("P3\n# c\n2 #x\r\n1\n255\n1 2 3\n253 254\n255\n"),
        FILE_OF("P6\n2 1\n255\n\1\2\3\375\376\377"),
        FILE_OF("P6#\n#\n2#\n1 # 9\n255\n\1\2\3\375\376\377trailing"),
        FILE_OF("P6\n2 1\n255# c\n\1\2\3\375\376\377"),
        FILE_OF("P6 2 1 65535 \1\1\2\2\3\3\375\375\376\376\377\377")    /* v * 257 / 65535 */
    };
    static const int colour[] = { 1, 2, 3, 253, 254, 255 }, grey[] = { 7, 7, 7, 9, 9, 9 };
    Image im;

    for (size_t i = 0; i < sizeof files / sizeof files[0]; i++) {
        REQUIRE(read_memory(&im, "ppm", files[i].bytes, files[i].n), "file %d", (int)i);
        EXPECT(im.w == 2 && im.h == 1, "size");
        expect_bytes(&im, files[i].bytes, colour);
        image_clear(&im);
    }
    REQUIRE(read_memory(&im, "ppm", "P5 1 2 255 \7\11", 13), "P5");
    EXPECT(im.w == 1 && im.h == 2, "size");
    expect_bytes(&im, "P5", grey);
    image_clear(&im);
    REQUIRE(read_memory(&im, "ppm", "P2 1 2 255 7 9", 14), "P2");
    expect_bytes(&im, "P2", grey);
    image_clear(&im);
    REQUIRE(read_memory(&im, "ppm", "P5 1 1 1 \1", 10), "maximum 1");
    EXPECT(im.pixels[0].r == 1.0f, "1 of 1 is %g", im.pixels[0].r);
    image_clear(&im);
    REQUIRE(read_memory(&im, "ppm", "P5 1 1 1023 \1\377", 14), "10 bits");
    EXPECT(im.pixels[0].r == srgb_decode(511.0f / 1023.0f), "%g", im.pixels[0].r);
    image_clear(&im);
    EXPECT(!read_memory(&im, "ppm", "P5 1 1 9 \12", 10), "10 of 9");
    EXPECT(!read_memory(&im, "ppm", "P3 1 1 255 1 2 256", 18), "256 of 255");
    EXPECT(!read_memory(&im, "ppm", "P2 1 1 255 -1", 13), "negative");
    EXPECT(!read_memory(&im, "ppm", "P5 1 1 65536 \0\0", 15), "17 bits");
    EXPECT(!read_memory(&im, "ppm", "P5 0 1 255 \0\0", 13), "no pixels");
    EXPECT(!read_memory(&im, "ppm", "P5 65535 65535 255 \0\0", 21), "lies");
}

/* All bytes through the writer and back, from a picture that was made of bytes. */
static void ppm_round_trip(void)
{
    Image im = new_image(64, 41), back;
    Rng r = rng_seed(3);

    for (size_t i = 0; i < 64 * 41; i++)
        im.pixels[i] = rgb(srgb_decode((float)(i & 255) / 255.0f),
                           srgb_decode((float)rng_below(&r, 256) / 255.0f),
                           srgb_decode((float)rng_below(&r, 256) / 255.0f));
    REQUIRE(image_write(&im, in_folder("a.ppm"), NULL), "write");
    REQUIRE(image_read(&back, in_folder("a.ppm"), 64 * 41), "read");
    EXPECT(back.w == 64 && back.h == 41, "size");
    EXPECT(same_pixels(im.pixels, back.pixels, 64 * 41), "bytes differ");
    image_clear(&im);
    image_clear(&back);
}

/* ---- Radiance ---- */

/* Half a step of the exponent that the largest component needs. */
static double half_step(Rgb c)
{
    int e;
    double f = frexp(rgb_max(c), &e);
    return ldexp(0.5, (f >= 255.5 / 256.0 ? e + 1 : e) - 8);
}

static void hdr_round_trip(void)
{
    static const uint32_t widths[] = { 1, 2, 7, 8, 9, 127, 128, 129, 130, 1000, 32767, 32768 };
    Rng r = rng_seed(4);

    for (size_t k = 0; k < sizeof widths / sizeof widths[0]; k++)
        for (int style = 0; style < 3; style++) {
            uint32_t w = widths[k], h = w > 1000 ? 2 : 5;
            Image im = new_image(w, h), back;
            fill_random(&im, &r, style ? -120 : -2, style ? 240 : 4);
            for (size_t i = 0; style == 2 && i < (size_t)w * h; i++)    /* runs of all lengths */
                if (i && rng_below(&r, 200))
                    im.pixels[i] = im.pixels[i - 1];
            REQUIRE(image_write(&im, in_folder("a.hdr"), NULL), "write");
            REQUIRE(image_read(&back, in_folder("a.hdr"), IMAGE_PIXELS_DEFAULT), "read");
            EXPECT(back.w == w && back.h == h, "size");
            for (size_t i = 0; i < (size_t)w * h; i++) {
                Rgb a = im.pixels[i], b = back.pixels[i];
                double bound = half_step(a);
                EXPECT(fabs((double)a.r - b.r) <= bound && fabs((double)a.g - b.g) <= bound &&
                       fabs((double)a.b - b.b) <= bound, "width %u: %.9g %.9g %.9g came back as "
                       "%.9g %.9g %.9g", (unsigned)w, a.r, a.g, a.b, b.r, b.g, b.b);
            }
            image_clear(&im);
            image_clear(&back);
        }
}

static void hdr_special(void)
{
    static const Rgb in[7] = {
        { 1, 0, 0 }, { 0.5f, 2, 0.25f }, { INFINITY, 1, NAN }, { -1, -0.0f, 3 },
        { 0x1p-129f, 0, 0 }, { FLT_MAX, 0x1p119f, 0x1p118f }, { 0x1p-128f, 0, 0 }
    };
    const float most = 255 * 0x1p119f;
    const Rgb out[7] = {
        { 1, 0, 0 }, { 0.5f, 2, 0.25f }, { most, 0, 0 }, { 0, 0, 3 }, { 0, 0, 0 },
        { most, 0x1p119f, 0x1p119f }, { 0x1p-128f, 0, 0 }       /* halves of a step go up */
    };
    Image im = new_image(7, 1), back, column = new_image(1, 2);
    FileBytes f;

    column.pixels[0] = rgb_all(1);              /* black is four zeros, whatever was before */
    REQUIRE(image_write(&column, in_folder("b.hdr"), NULL), "write");
    REQUIRE(file_read(in_folder("b.hdr"), 1000, &f), "file_read");
    EXPECT(f.size > 8 && !memcmp(f.bytes + f.size - 8, "\200\200\200\201\0\0\0\0", 8), "black");
    file_clear(&f);
    image_clear(&column);
    memcpy(im.pixels, in, sizeof in);
    REQUIRE(image_write(&im, in_folder("a.hdr"), NULL), "write");
    REQUIRE(image_read(&back, in_folder("a.hdr"), 7), "read");
    for (int i = 0; i < 7; i++)
        EXPECT(back.pixels[i].r == out[i].r && back.pixels[i].g == out[i].g &&
               back.pixels[i].b == out[i].b, "%d: %g %g %g", i, back.pixels[i].r,
               back.pixels[i].g, back.pixels[i].b);
    REQUIRE(file_read(in_folder("a.hdr"), 1000, &f), "file_read");
    EXPECT(!memcmp(f.bytes, "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 1 +X 7\n\200\0\0\201", 49),
           "header and first pixel");
    file_clear(&f);
    image_clear(&im);
    image_clear(&back);
}

/* Pixel k of the file has red mantissa k + 128, so exposes where it went. */
static void hdr_orientations(void)
{
    static const char *const sizes[8] = {
        "-Y 2 +X 3", "-Y 2 -X 3", "+Y 2 +X 3", "+Y 2 -X 3",
        "+X 3 -Y 2", "-X 3 -Y 2", "+X 3 +Y 2", "-X 3 +Y 2"
    };
    static const int at[8][6] = {               /* k at each place of the image, row by row */
        { 0, 1, 2, 3, 4, 5 }, { 2, 1, 0, 5, 4, 3 }, { 3, 4, 5, 0, 1, 2 }, { 5, 4, 3, 2, 1, 0 },
        { 0, 2, 4, 1, 3, 5 }, { 4, 2, 0, 5, 3, 1 }, { 1, 3, 5, 0, 2, 4 }, { 5, 3, 1, 4, 2, 0 }
    };
    for (int s = 0; s < 8; s++) {
        unsigned char file[200];
        size_t n = (size_t)snprintf((char *)file, sizeof file, "#?RGBE\nVIEW= -vp 0 0 0\n\n%s\n",
                                    sizes[s]);
        Image im;
        for (int k = 0; k < 6; k++, n += 4)
            memcpy(file + n, (unsigned char[4]){ (unsigned char)(128 + k), 0, 0, 136 }, 4);
        REQUIRE(read_memory(&im, "hdr", file, n), "%s", sizes[s]);
        EXPECT(im.w == 3 && im.h == 2, "%s: %u x %u", sizes[s], (unsigned)im.w, (unsigned)im.h);
        for (int k = 0; k < 6; k++)
            EXPECT(im.pixels[k].r == (float)(128 + at[s][k]), "%s: %g at %d", sizes[s],
                   im.pixels[k].r, k);
        image_clear(&im);
    }
}

static bool read_hdr_text(Image *im, const char *header, const char *data, size_t n)
{
    unsigned char file[600];
    size_t k = strlen(header);
    memcpy(file, header, k);
    memcpy(file + k, data, n);
    return read_memory(im, "hdr", file, k + n);
}

static void hdr_lines(void)
{
    Image im;

    /* Old code: a pixel, 3 more of it, another one, 2 + 1 * 256 more of it. */
    REQUIRE(read_hdr_text(&im, "#?RADIANCE\n\n-Y 1 +X 263\n",
                          "\200\0\0\210\1\1\1\3\220\0\0\210\1\1\1\2\1\1\1\1", 20), "old code");
    EXPECT(im.pixels[0].r == 128 && im.pixels[3].r == 128 && im.pixels[4].r == 144 &&
           im.pixels[262].r == 144, "old code");
    image_clear(&im);
    EXPECT(!read_hdr_text(&im, "#?RADIANCE\n\n-Y 1 +X 262\n",
                          "\200\0\0\210\1\1\1\3\220\0\0\210\1\1\1\2\1\1\1\1", 20), "overrun");
    EXPECT(!read_hdr_text(&im, "#?RADIANCE\n\n-Y 1 +X 9\n", "\1\1\1\11\1\1\1\11", 8),
           "repetition of nothing");
    /* New code: a run, a copy, a run; then a flat line of pixels that begin with 2 2 200. */
    REQUIRE(read_hdr_text(&im, "#?RADIANCE\nEXPOSURE=2\nEXPOSURE= 2.0 \nCOLORCORR=1 2 4\n\n"
                          "-Y 2 +X 8\n", "\2\2\0\10\203\200\2\201\202\203\203\210\200\210\200"
                          "\210\210\2\2\310\210\2\2\310\210\2\2\310\210\2\2\310\210\2\2\310\210"
                          "\2\2\310\210\2\2\310\210\2\2\310\210", 49), "new code");
    EXPECT(im.pixels[2].r == 32 && im.pixels[3].r == 32.25f && im.pixels[4].r == 32.5f &&
           im.pixels[7].r == 32.75f && im.pixels[0].g == 16 && im.pixels[0].b == 8, "new code");
    EXPECT(im.pixels[15].r == 0.5f && im.pixels[8].g == 0.25f && im.pixels[9].b == 12.5f,
           "flat line");
    image_clear(&im);
    EXPECT(!read_hdr_text(&im, "#?RADIANCE\nEXPOSURE=0\n\n-Y 1 +X 1\n", "\1\2\3\4", 4), "gain 0");
    EXPECT(!read_hdr_text(&im, "#?RADIANCE\nFORMAT=32-bit_rle_xyze\n\n-Y 1 +X 1\n", "\1\2\3\4",
                          4), "xyze");
    EXPECT(!read_hdr_text(&im, "#?RADIANCE\n\n-Y 1 +X 8\n", "\2\2\0\11\210\0\210\0\210\0\210\0",
                          12), "wrong width");
    EXPECT(!read_hdr_text(&im, "#?RADIANCE\n\n-Y 65535 +X 65535\n", "\1\2\3\4", 4), "lies");
    EXPECT(mem_blocks() == 0, "%ld blocks", mem_blocks());
}

/* ---- TGA ---- */

typedef struct { unsigned char bytes[4000]; size_t n; } Tga;

static void put(Tga *t, unsigned v, int bytes)
{
    for (; bytes; bytes--, v >>= 8)
        t->bytes[t->n++] = (unsigned char)v;
}

/* A colour of 5 bits a channel, in the form asked for. */
static void put_colour(Tga *t, const int *c, int bits)
{
    if (bits <= 16)
        put(t, (unsigned)(c[0] << 10 | c[1] << 5 | c[2]), 2);
    else {
        put(t, (unsigned)c[2] * 255 / 31, 1);
        put(t, (unsigned)c[1] * 255 / 31, 1);
        put(t, (unsigned)c[0] * 255 / 31, 1);
        put(t, 77, bits / 8 - 3);
    }
}

enum { TW = 5, TH = 4, COLOURS = 7, FIRST = 3 };
static const int palette[COLOURS][3] = {        /* what all depths agree on */
    { 0, 0, 0 }, { 31, 31, 31 }, { 31, 0, 0 }, { 0, 31, 0 }, { 0, 0, 31 }, { 31, 31, 0 },
    { 0, 31, 31 }
};

/* kind 1, 2, 3 or with 8 added. index[]: the palette entry of each pixel in the file's order. */
static void make_tga(Tga *t, int kind, int bits, int map_bits, int descriptor, const int *index)
{
    int base = kind & 7, k = 0;

    t->n = 0;
    put(t, 3, 1);
    put(t, map_bits != 0, 1);
    put(t, (unsigned)kind, 1);
    put(t, FIRST, 2);
    put(t, map_bits ? COLOURS : 0, 2);
    put(t, (unsigned)map_bits, 1);
    put(t, 0, 4);
    put(t, TW, 2);
    put(t, TH, 2);
    put(t, (unsigned)bits, 1);
    put(t, (unsigned)descriptor, 1);
    put(t, 0x616263, 3);
    for (int i = 0; map_bits && i < COLOURS; i++)
        put_colour(t, palette[i], map_bits);
    while (k < TW * TH) {
        int n = 1;
        bool run = false;
        if (kind & 8) {
            while (k + n < TW * TH && index[k + n] == index[k])
                n++;
            run = n > 1;
            put(t, (unsigned)(run ? 127 + n : 0), 1);
        }
        if (base == 1)
            put(t, (unsigned)(FIRST + index[k]), (bits + 7) / 8);
        else if (base == 3)
            put(t, palette[index[k]][0] * 255u / 31 | 0x5500, bits / 8);
        else
            put_colour(t, palette[index[k]], bits);
        k += run ? n : 1;
    }
}

static void check_tga(const Tga *t, const char *what, int kind, int descriptor, const int *index)
{
    Image im;

    REQUIRE(read_memory(&im, "tga", t->bytes, t->n), "%s: kind %d", what, kind);
    EXPECT(im.w == TW && im.h == TH, "size");
    for (int k = 0; k < TW * TH; k++) {
        int x = descriptor & 16 ? TW - 1 - k % TW : k % TW;
        int y = descriptor & 32 ? k / TW : TH - 1 - k / TW;
        const int *e = palette[index[k]];
        Rgb c = *image_at(&im, (uint32_t)x, (uint32_t)y);
        bool grey = (kind & 7) == 3;
        EXPECT(c.r == (float)(e[0] / 31) && c.g == (float)(e[grey ? 0 : 1] / 31) &&
               c.b == (float)(e[grey ? 0 : 2] / 31), "%s: kind %d, descriptor %d, pixel %d", what,
               kind, descriptor, k);
    }
    image_clear(&im);
}

static void tga_kinds(void)
{
    static const struct { int kind, bits, map_bits; } forms[] = {
        { 2, 15, 0 }, { 2, 16, 0 }, { 2, 24, 0 }, { 2, 32, 0 }, { 3, 8, 0 }, { 3, 16, 0 },
        { 1, 8, 15 }, { 1, 8, 16 }, { 1, 8, 24 }, { 1, 8, 32 }, { 1, 16, 24 }, { 2, 24, 24 }
    };
    Rng r = rng_seed(5);
    int index[TW * TH];
    Tga t;

    for (size_t i = 0; i < sizeof forms / sizeof forms[0]; i++)
        for (int descriptor = 0; descriptor < 64; descriptor += 16)
            for (int packed = 0; packed <= 8; packed += 8) {
                for (int k = 0; k < TW * TH; k++)
                    index[k] = k && rng_below(&r, 2) ? index[k - 1] : (int)rng_below(&r, COLOURS);
                make_tga(&t, forms[i].kind + packed, forms[i].bits, forms[i].map_bits, descriptor,
                         index);
                check_tga(&t, "tga", forms[i].kind + packed, descriptor, index);
            }
}

static void tga_values(void)
{
    Tga t = { { 0 }, 0 };
    Image im;

    /* One row of all the 32 levels of 5 bits, then they should be round(v * 255 / 31). */
    put(&t, 0x00020000, 4);
    put(&t, 0, 4);
    put(&t, 0, 4);
    put(&t, 32, 2);
    put(&t, 1, 2);
    put(&t, 0x000F, 2);
    for (unsigned v = 0; v < 32; v++)
        put(&t, v << 10 | v << 5 | v, 2);
    REQUIRE(read_memory(&im, "tga", t.bytes, t.n), "15 bits");
    for (int v = 0; v < 32; v++) {
        int nearest = (int)floor(v * 255.0 / 31.0 + 0.5);
        EXPECT(im.pixels[v].r == srgb_decode((float)nearest / 255.0f) &&
               im.pixels[v].r == im.pixels[v].g && im.pixels[v].g == im.pixels[v].b, "%d", v);
    }
    image_clear(&im);
    t.bytes[17] = 0x40;
    EXPECT(!read_memory(&im, "tga", t.bytes, t.n), "interleaved");
    t.bytes[17] = 0;
    EXPECT(!read_memory(&im, "tga", t.bytes, t.n - 1), "cut");
    t.bytes[2] = 1;
    EXPECT(!read_memory(&im, "tga", t.bytes, t.n), "indices without a map");
    EXPECT(mem_blocks() == 0, "%ld blocks", mem_blocks());
}

/* ---- the same bytes everywhere ---- */

/* The files that one picture gives, with every tone map. The sums are those of a build by gcc on
 * x86-64: that the contents are right is shown elsewhere; here, that no compiler, no byte order
 * and no size of a pointer changes a bit of them. The upper half of the picture is noise, the
 * lower one tiles and slopes, which pack. */
static void same_bytes(void)
{
    static const struct { const char *file, *tonemap; uint32_t crc; } known[] = {
        { "a.pfm", "linear", 1154755708 }, { "a.hdr", "linear", 3721525856 },
        { "a.ppm", "linear", 1777485388 }, { "a.ppm", "exponential", 1892444985 },
        { "a.ppm", "reinhard", 1517235383 }, { "a.png", "reinhard", 3591293375 }
    };
    Image im = new_image(301, 67);
    Rng r = rng_seed(17);

    fill_random(&im, &r, -9, 14);
    for (uint32_t y = 33; y < im.h; y++)
        for (uint32_t x = 0; x < im.w; x++)
            *image_at(&im, x, y) = rgb((float)(x / 9 * y / 7 % 5), (float)x / 64.0f,
                                       (float)((x ^ y) & 24) / 16.0f);
    for (size_t i = 0; i < sizeof known / sizeof known[0]; i++) {
        FileBytes f;
        Display d = { .tonemap = tonemap_named(known[i].tonemap), .exposure = 0.75f };
        uint32_t crc;
        REQUIRE(image_write(&im, in_folder(known[i].file), &d), "write");
        REQUIRE(file_read(in_folder(known[i].file), 1 << 20, &f), "file_read");
        crc = checksum_crc32(0, (const unsigned char *)f.bytes, f.size);
        EXPECT(crc == known[i].crc, "%s, %s: %lu", known[i].file, known[i].tonemap,
               (unsigned long)crc);
        file_clear(&f);
    }
    image_clear(&im);
}

/* ---- files of other programs ---- */

/* CRC-32 of the floats, little-endian, row by row from the top, by another decoder. */
static uint32_t crc_of_floats(const Image *im)
{
    uint32_t crc = 0;
    for (size_t i = 0; i < (size_t)im->w * im->h; i++) {
        const Rgb c = im->pixels[i];
        const float v[3] = { c.r, c.g, c.b };
        unsigned char b[12];
        for (int k = 0; k < 12; k++)
            b[k] = (unsigned char)(float_bits(v[k / 4]) >> 8 * (k % 4));
        crc = checksum_crc32(crc, b, 12);
    }
    return crc;
}

static uint32_t crc_of_display(const Image *im)
{
    size_t n = (size_t)im->w * im->h * 3;
    unsigned char *bytes = MEM_ARRAY(unsigned char, n);
    uint32_t crc;

    REQUIRE(bytes, "memory");
    picture_bytes(im, NULL, bytes);
    crc = checksum_crc32(0, bytes, n);
    mem_free(bytes);
    return crc;
}

typedef struct { const char *name; uint32_t w, h, crc; } Known;

static void check_known(const Known *known, uint32_t (*crc)(const Image *))
{
    for (; known->name; known++) {
        Image im;
        REQUIRE(image_read(&im, test_data(known->name), IMAGE_PIXELS_DEFAULT), "%s", known->name);
        EXPECT(im.w == known->w && im.h == known->h, "%s: %u x %u", known->name, (unsigned)im.w,
               (unsigned)im.h);
        EXPECT(crc(&im) == known->crc, "%s: crc %lu", known->name, (unsigned long)crc(&im));
        image_clear(&im);
    }
}

static void data_hdr(void)
{
    static const Known known[] = {
        { "hdr/campus_probe.hdr", 640, 640, 1888195840 },
        { "hdr/car-stack-eighth_flat.hdr", 129, 97, 398716388 },
        { "hdr/ennis_256.hdr", 256, 128, 976391251 },
        { "hdr/grace_probe.hdr", 1000, 1000, 1103174786 },
        { "hdr/image1.hdr", 128, 85, 3444088319 },
        { "hdr/memorial.hdr", 512, 768, 1920013323 },
        { "hdr/old-rle.hdr", 551, 276, 873030200 },
        { "hdr/rgbr4x4.hdr", 4, 4, 3473021589 },
        { "hdr/roof_garden_1k.hdr", 1024, 512, 239018639 },
        { "hdr/uffizi_latlong.hdr", 1200, 600, 2230894771 },
        { "hdr/wells_256.hdr", 256, 128, 1702894493 },
        { NULL, 0, 0, 0 }
    };
    check_known(known, crc_of_floats);
}

static void data_pfm(void)
{
    static const Known known[] = {
        { "pfm/hopper.pfm", 128, 128, 4085018870 },
        { "scenes/cornell-box/reference.pfm", 256, 256, 3815029301 },
        { "scenes/veach-mis/reference.pfm", 320, 180, 597385894 },
        { "scenes/veach-bidir/reference.pfm", 256, 256, 3434744423 },
        { "scenes/veach-ajar/reference.pfm", 320, 180, 526316804 },
        { NULL, 0, 0, 0 }
    };
    check_known(known, crc_of_floats);
}

static void data_tga(void)
{
    static const Known known[] = {
        { "scenes/veach-ajar/textures/Good Textures_005844.tga", 426, 640, 2159083948 },
        { "scenes/veach-ajar/textures/cherry-wood-texture.tga", 640, 512, 3890329840 },
        { "scenes/veach-ajar/textures/landscape-with-a-lake.tga", 640, 427, 3793239159 },
        { NULL, 0, 0, 0 }
    };
    check_known(known, crc_of_display);
}

const TestCase test_image[] = {
    { "srgb_curve", srgb_curve, false },
    { "display_bytes", display_bytes, false },
    { "formats", formats, false },
    { "sizes", sizes, false },
    { "pfm_bytes", pfm_bytes, false },
    { "pfm_big_endian", pfm_big_endian, false },
    { "pfm_round_trip", pfm_round_trip, false },
    { "ppm_bytes", ppm_bytes, false },
    { "ppm_round_trip", ppm_round_trip, false },
    { "hdr_round_trip", hdr_round_trip, false },
    { "hdr_special", hdr_special, false },
    { "hdr_orientations", hdr_orientations, false },
    { "hdr_lines", hdr_lines, false },
    { "tga_kinds", tga_kinds, false },
    { "tga_values", tga_values, false },
    { "same_bytes", same_bytes, false },
    { "data_hdr", data_hdr, false },
    { "data_pfm", data_pfm, false },
    { "data_tga", data_tga, false },
    { NULL, NULL, false }
};
