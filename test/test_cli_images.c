/* test_cli_images.c -- the commands info, compare and convert: what they print and write. */
#include "cli/args.h"
#include "image/image.h"
#include "test/cli_help.h"

#include <math.h>
#include <string.h>

static Image read_image(const char *name)
{
    Image im;
    REQUIRE(image_read(&im, cli_path(name), IMAGE_PIXELS_DEFAULT), "%s cannot be read", name);
    return im;
}

/* w x h pixels of one colour. */
static void write_plain(const char *name, uint32_t w, uint32_t h, Rgb c)
{
    Image im;
    REQUIRE(image_init(&im, w, h), "image_init");
    for (size_t i = 0; i < (size_t)w * h; i++)
        im.pixels[i] = c;
    REQUIRE(image_write(&im, cli_path(name), NULL), "%s", name);
    image_clear(&im);
}

/* ---- info ---- */

static void info_image(void)
{
    Cli c;

    cli_scene();
    c = CLI_WORKS("info sky.pfm");
    EXPECT(!strcmp(c.out, "image          8x4\nmean           0.625 0.5625 0.5\n"
                          "least          0.25 0.125 0.5\nmost           1 1 0.5\n"
                          "not finite     0 pixels\n"), "sky: %s", c.out);
    EXPECT(!c.err[0], "it says: %s", c.err);
    write_plain("a.pfm", 1, 1, rgb(1, INFINITY, 1));
    c = CLI_WORKS("info a.pfm");
    EXPECT(!strcmp(c.out, "image          1x1\nmean           0 0 0\nnot finite     1 pixels\n"),
           "not finite: %s", c.out);
}

static void expect_begins(const char *name, const char *want)
{
    Cli c = CLI_WORKS("info %s", name);
    EXPECT(!strncmp(c.out, want, strlen(want)), "%s begins: %snot: %s", name, c.out, want);
    EXPECT(!c.err[0], "it says: %s", c.err);
}

static void info_scenes(void)
{
    cli_scene();
    expect_begins("tiny.pbrt", "world          6 triangles, 9 vertices\n"
                               "shapes         2 meshes, 1 spheres, 0 disks, 0 tessellations, 0 ");
    expect_begins("roof.ply", "world          4 triangles, 5 vertices\n"
                              "shapes         1 meshes, 0 spheres, 0 disks, 0 tessellations, 0 ");
    cli_write_text("room.obj", "mtllib room.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl red\n"
                               "f 1 2 3\nv 0 0 1\nf 1 2 4\n");
    cli_write_text("room.mtl", "newmtl red\nKd 1 0 0\n");
    expect_begins("room.obj", "world          2 triangles, ");
    cli_write_text("ROOM.OBJ", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    expect_begins("ROOM.OBJ", "world          1 triangles, 3 vertices\n");
    cli_write_text("object.pbrt", "WorldBegin\nObjectBegin \"a\"\nShape \"sphere\"\n"
                                  "Shape \"disk\"\nObjectEnd\nObjectInstance \"a\"\n"
                                  "ObjectInstance \"a\"\n");
    expect_begins("object.pbrt", "world          0 triangles, 0 vertices\n"
                                 "object 1       0 triangles, 0 vertices\n"
                                 "shapes         0 meshes, 1 spheres, 1 disks, 0 tessellations, "
                                 "2 instances\n");
    cli_write_text("field.pbrt", "WorldBegin Shape \"heightfield\" \"integer nu\" 3 \"integer nv\" "
                                 "2\n\"float Pz\" [ 0 1 2 3 4 5 ]\n");
    expect_begins("field.pbrt", "world          4 triangles, 6 vertices\n"
                                "shapes         0 meshes, 0 spheres, 0 disks, 1 tessellations, ");
}

/* ---- compare ---- */

/* The number behind a name in a table. */
static double figure(const char *table, const char *name)
{
    char begin[40];
    const char *at;
    double v = NAN;

    snprintf(begin, sizeof begin, "%-14s ", name);
    at = !strncmp(table, begin, strlen(begin)) ? table : strstr(table, begin);
    if (!at || sscanf(at + strlen(begin), "%lf", &v) != 1)
        test_fail(__FILE__, __LINE__, "no figure %s in: %s", name, table);
    return v;
}

/* 144 additions in double */
static bool near(double a, double b) { return fabs(a - b) <= 200 * 1.2e-16 * b; }

static void compare_figures(void)
{
    Cli c;

    write_plain("one.pfm", 16, 9, rgb_all(1));
    write_plain("more.pfm", 16, 9, rgb_all(1.5f));
    c = CLI_WORKS("compare one.pfm one.pfm");
    EXPECT(!c.err[0] && figure(c.out, "sigma/mu") == 0 && figure(c.out, "rmse") == 0 &&
           figure(c.out, "max") == 0 && figure(c.out, "mean-ratio") == 1, "the same: %s", c.out);
    c = CLI_WORKS("compare more.pfm one.pfm");
    EXPECT(near(figure(c.out, "sigma/mu"), 0.5) && near(figure(c.out, "rmse"), 0.5) &&
           figure(c.out, "max") == 0.5 && near(figure(c.out, "mean-ratio"), 1.5), "more: %s",
           c.out);
    c = CLI_WORKS("compare one.pfm more.pfm");
    EXPECT(near(figure(c.out, "sigma/mu"), 1.0 / 3), "less: %s", c.out);
    EXPECT(cli_lines(c.out) == 15, "%d lines", cli_lines(c.out));
}

static void compare_limit(void)
{
    Cli c;

    write_plain("one.pfm", 16, 9, rgb_all(1));
    write_plain("more.pfm", 16, 9, rgb_all(1.5f));
    write_plain("bad.pfm", 16, 9, rgb_all(NAN));
    CLI_WORKS("compare one.pfm one.pfm --max 0");
    CLI_WORKS("compare more.pfm one.pfm --max 0.5000001");
    c = cli("compare more.pfm one.pfm --max 0.4999999");
    EXPECT_CLI(c, STATUS_DIFFERENT, "");
    EXPECT(near(figure(c.out, "sigma/mu"), 0.5), "no table: %s", c.out);
    c = cli("compare --max=1e300 bad.pfm one.pfm");          /* nothing left to compare */
    EXPECT_CLI(c, STATUS_DIFFERENT, "");
    c = cli("compare --max-pixels 143 one.pfm one.pfm");
    EXPECT_CLI(c, STATUS_INPUT, "rushlight: one.pfm: the image has 16 x 9 pixels, at most 143 in "
               "all were expected (--max-pixels)\n");
    CLI_WORKS("compare --max-pixels 144 one.pfm one.pfm");
}

static void compare_family(void)
{
    Cli c;

    write_plain("one.pfm", 16, 9, rgb_all(1));
    write_plain("more.pfm", 16, 9, rgb_all(1.5f));
    write_plain("bad.pfm", 16, 9, rgb_all(NAN));
    c = CLI_WORKS("compare one.pfm one.pfm --family 0.01");
    EXPECT(figure(c.out, "tiles-differ") == 0 && figure(c.out, "family-p") == 1, "%s", c.out);
    c = CLI_WORKS("compare more.pfm one.pfm");                   /* told, but no limit was given */
    EXPECT(figure(c.out, "tiles-differ") == 2 && figure(c.out, "family-p") < 1e-9, "%s", c.out);
    EXPECT_CLI(cli("compare more.pfm one.pfm --family 0.01"), STATUS_DIFFERENT, "");
    EXPECT_CLI(cli("compare bad.pfm one.pfm --family 0.01"), STATUS_DIFFERENT, "");
    CLI_FAILS(STATUS_USAGE, "--family '2' is not right, expected a number from 1e-12 to 0.5",
              "compare one.pfm one.pfm --family 2");
}

static void compare_picture(void)
{
    Image d;
    Cli c;

    write_plain("one.pfm", 16, 9, rgb_all(1));
    write_plain("more.pfm", 16, 9, rgb_all(1.5f));
    CLI_WORKS("compare more.pfm one.pfm --diff d.pfm");
    d = read_image("d.pfm");
    EXPECT(d.w == 16 && d.h == 9 && d.pixels[5].r == 0.5f && d.pixels[5].g == 0 &&
           d.pixels[5].b == 0, "more is red");
    image_clear(&d);
    c = cli("compare one.pfm more.pfm --scale 4 --diff d.pfm --max 0.1");
    EXPECT_CLI(c, STATUS_DIFFERENT, "");
    d = read_image("d.pfm");
    EXPECT(d.pixels[7].r == 0 && d.pixels[7].g == 0 && d.pixels[7].b == 2, "less is blue, 4 times");
    image_clear(&d);
    c = cli("compare one.pfm more.pfm --max 0.1 --diff one.pfm/d.pfm");
    EXPECT_CLI(c, STATUS_OUTPUT, "rushlight: one.pfm/d.pfm: cannot be written: Not a directory\n");
    EXPECT(!strcmp(cli_folder(), "d.pfm more.pfm one.pfm "), "left: %s", cli_folder());
}

/* ---- convert ---- */

/* Rounding of a format: its greatest error where the largest channel of a pixel is `most`. 255
 * steps of the sRGB curve, whose slope ends at 2.275; 8 bits under a common exponent, cut or
 * rounded. */
static float rounding(const ImageFormat *f, float most)
{
    if (!strcmp(f->info.name, "pfm"))
        return 0;
    return f->linear ? most / 127.0f : 0.5f / 255 * 2.2751f;
}

static void expect_near(const Image *a, const Image *b, const ImageFormat *f)
{
    REQUIRE(a->w == b->w && a->h == b->h, "%s: the size is another", f->info.name);
    for (size_t i = 0; i < (size_t)a->w * a->h; i++) {
        Rgb x = a->pixels[i], y = b->pixels[i];
        float most = fmaxf(fabsf(x.r - y.r), fmaxf(fabsf(x.g - y.g), fabsf(x.b - y.b)));
        EXPECT(most <= rounding(f, fmaxf(x.r, fmaxf(x.g, x.b))), "%s: pixel %lu is off by %g",
               f->info.name, (unsigned long)i, (double)most);
    }
}

/* From every format that can be read to every one that can be written. What has been rounded once
 * is not changed by its own format again. */
static void convert_all(void)
{
    Image sky, im;

    cli_scene();
    sky = read_image("sky.pfm");
    for (const ImageFormat *const *f = image_formats; *f; f++) {
        const char *name = (*f)->info.name;
        if (!(*f)->write)
            continue;
        CLI_WORKS("convert sky.pfm a.%s", name);
        if (!(*f)->read)
            continue;
        CLI_WORKS("convert a.%s back.pfm", name);
        im = read_image("back.pfm");
        expect_near(&sky, &im, *f);
        image_clear(&im);
        for (const ImageFormat *const *to = image_formats; *to; to++)
            if ((*to)->write)
                CLI_WORKS("convert a.%s b.%s", name, (*to)->info.name);
        {
            char a[20], b[20];
            snprintf(a, sizeof a, "a.%s", name);
            snprintf(b, sizeof b, "b.%s", name);
            EXPECT(cli_same_file(a, b), "%s: converted again it changes", name);
        }
    }
    image_clear(&sky);
}

/* Exposure is a factor of what is written; formats for display are exposed before their curve. */
/* One pixel, half let through: it says so, once, and writes the colour. */
static void convert_alpha(void)
{
    static const unsigned char tga[18 + 4] = { 0, 0, 2, 0, 0, 0, 0, 0, 0, 0, 0, 0, 1, 0, 1, 0, 32,
                                               8, 30, 20, 10, 128 };
    Cli c;

    cli_write("half.tga", tga, sizeof tga);
    c = cli("convert half.tga half.png");
    EXPECT(c.status == 0 && strstr(c.err, "half.tga: warning: it has opacities") &&
           cli_lines(c.err) == 1, "status %d: %s", c.status, c.err);
}

static void convert_exposed(void)
{
    Image sky, im;

    cli_scene();
    CLI_WORKS("convert --exposure 1 sky.pfm twice.pfm");
    sky = read_image("sky.pfm");
    im = read_image("twice.pfm");
    for (size_t i = 0; i < 32; i++)
        EXPECT(im.pixels[i].r == 2 * sky.pixels[i].r && im.pixels[i].b == 2 * sky.pixels[i].b,
               "pixel %lu is not twice", (unsigned long)i);
    image_clear(&im);
    image_clear(&sky);
    CLI_WORKS("convert sky.pfm a.ppm --exposure=-2");
    CLI_WORKS("convert --exposure -2 sky.pfm b.pfm");
    CLI_WORKS("convert b.pfm b.ppm");
    EXPECT(cli_same_file("a.ppm", "b.ppm"), "exposing and converting do not commute");
    CLI_WORKS("convert sky.pfm c.ppm");
    EXPECT(!cli_same_file("a.ppm", "c.ppm"), "no exposure");
    for (size_t k = 0; kind_info(tonemaps, k); k++) {
        CLI_WORKS("convert sky.pfm d.ppm --tonemap %s", kind_info(tonemaps, k)->name);
        EXPECT(cli_same_file("c.ppm", "d.ppm") == (k == 0), "%s", kind_info(tonemaps, k)->name);
    }
    CLI_WORKS("convert sky.pfm sky.pfm --exposure 1");       /* over itself */
    EXPECT(cli_same_file("sky.pfm", "twice.pfm"), "over itself");
}

static void convert_limit(void)
{
    cli_scene();
    CLI_FAILS(STATUS_INPUT, "sky.pfm: the image has 8 x 4 pixels, at most 31 in all were expected "
              "(--max-pixels)", "convert sky.pfm a.hdr --max-pixels=31");
    CLI_FAILS(STATUS_OUTPUT, "nosuch/a.hdr: cannot be written: No such file or directory",
              "convert sky.pfm nosuch/a.hdr");
    EXPECT(!strcmp(cli_folder(), "roof.ply sky.pfm tiny.pbrt wood.ppm "), "left: %s", cli_folder());
}

const TestCase test_cli_images[] = {
    { "info_image", info_image, false },
    { "info_scenes", info_scenes, false },
    { "compare_figures", compare_figures, false },
    { "compare_limit", compare_limit, false },
    { "compare_family", compare_family, false },
    { "compare_picture", compare_picture, false },
    { "convert_all", convert_all, false },
    { "convert_alpha", convert_alpha, false },
    { "convert_exposed", convert_exposed, false },
    { "convert_limit", convert_limit, false },
    { NULL, NULL, false }
};
