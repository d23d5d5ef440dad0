/* test_cli_render.c -- what the options of `render` do to the picture: forms and places of options,
 * windows, extra pictures that add up, budgets, limits, names of pictures. */
#include "cli/args.h"
#include "image/image.h"
#include "integrators/integrator.h"
#include "test/cli_help.h"
#include "test/image_help.h"

#include <math.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/stat.h>

static Image read_image(const char *name)
{
    Image im;
    REQUIRE(image_read(&im, cli_path(name), IMAGE_PIXELS_DEFAULT), "%s cannot be read", name);
    return im;
}

static bool is_there(const char *name)
{
    size_t n;
    return cli_read(name, &n) != NULL;
}

/* ---- forms and places of options ---- */

static void forms(void)
{
    static const char *const SAME[] = {
        "render tiny.pbrt --spp=3 --seed=7 --size=9x5 --quiet -o b.pfm",
        "--spp 3 --seed 7 --size 9x5 --quiet -o b.pfm tiny.pbrt",
        "render --spp 3 --seed=7 tiny.pbrt --quiet --size 9x5 -o b.pfm",
        "--quiet -o b.pfm --spp 1 --seed 1 --size 9x5 --spp 3 --seed 7 tiny.pbrt",
        "-o b.pfm --spp 3 --seed 7 --size 9x5 --quiet -- tiny.pbrt",
        "render --spp 3 --seed 7 --size 9x5 --quiet -o b.pfm -- -odd.pbrt",
        "tiny.pbrt --spp 3 --seed 7 --size 9x5 --quiet -o b.pfm --threads 1 --accel brute",
        "tiny.pbrt --spp 3 --seed 7 --size 9x5 --quiet -o b.pfm --threads 256",
        "tiny.pbrt --spp 3 --seed 7 --size 9x5 --quiet -o b.pfm --integrator path:maxdepth=4",
        "tiny.pbrt --spp 3 --seed 7 --size 9x5 --quiet -o b.pfm --sampler zerotwo --filter box:",
    };
    Cli c;

    cli_scene();
    cli_write_text("-odd.pbrt", cli_scene_text);
    c = CLI_WORKS("tiny.pbrt --spp 3 --seed 7 --size 9x5 --quiet -o a.pfm");
    EXPECT(!c.out[0] && !c.err[0], "quiet says: %s%s", c.out, c.err);
    for (size_t i = 0; i < sizeof SAME / sizeof *SAME; i++) {
        c = CLI_WORKS("%s", SAME[i]);
        EXPECT(!c.out[0] && !c.err[0], "quiet says: %s%s", c.out, c.err);
        EXPECT(cli_same_file("a.pfm", "b.pfm"), "'%s' is another picture", SAME[i]);
    }
}

/* Each of these must matter. */
static void each_option_matters(void)
{
    static const char *const OTHER[] = {
        "--seed 8", "--spp 2", "--size 10x5", "--crop 1,1,4,4", "--sampler random",
        "--filter triangle", "--filter box:xradius=2", "--integrator ao",
        "--integrator path:maxdepth=1",
    };
    cli_scene();
    CLI_WORKS("tiny.pbrt --spp 3 --seed 7 --size 9x5 --quiet -o a.pfm -o a.ppm");
    for (size_t i = 0; i < sizeof OTHER / sizeof *OTHER; i++) {
        CLI_WORKS("tiny.pbrt --spp 3 --seed 7 --size 9x5 --quiet -o b.pfm %s", OTHER[i]);
        EXPECT(!cli_same_file("a.pfm", "b.pfm"), "%s changes nothing", OTHER[i]);
    }
    CLI_WORKS("tiny.pbrt --spp 3 --seed 7 --size 9x5 --quiet --exposure 1 -o b.pfm -o b.ppm");
    EXPECT(cli_same_file("a.pfm", "b.pfm") && !cli_same_file("a.ppm", "b.ppm"), "--exposure");
    CLI_WORKS("tiny.pbrt --spp 3 --seed 7 --size 9x5 --quiet --tonemap reinhard -o b.pfm -o c.ppm");
    EXPECT(cli_same_file("a.pfm", "b.pfm") && !cli_same_file("a.ppm", "c.ppm"), "--tonemap");
}

/* Without --quiet: two lines that tell the scene and the picture. */
static void notes(void)
{
    Cli c;

    cli_scene();
    c = CLI_WORKS("tiny.pbrt -o a.pfm");
    EXPECT(!c.out[0] && cli_lines(c.err) == 2, "it prints: %s%s", c.out, c.err);
    EXPECT(strstr(c.err, "rushlight: tiny.pbrt: 7 primitives, 2 lights, built in ") == c.err,
           "first: %s", c.err);
    EXPECT(strstr(c.err, "\nrushlight: a.pfm: 2.0 samples a pixel in "), "second: %s", c.err);
}

/* ---- windows ---- */

/* A window holds the very pixels that the whole picture has there. */
static void crop(void)
{
    Image all, part;

    cli_scene();
    CLI_WORKS("tiny.pbrt --quiet --size 40x30 -o all.pfm");
    CLI_WORKS("tiny.pbrt --quiet --size 40x30 --crop 7,5,31,22 -o part.pfm");
    all = read_image("all.pfm");
    part = read_image("part.pfm");
    REQUIRE(part.w == 24 && part.h == 17, "%lu x %lu", (unsigned long)part.w,
            (unsigned long)part.h);
    for (uint32_t y = 0; y < part.h; y++)
        EXPECT(same_pixels(image_at(&part, 0, y), image_at(&all, 7, y + 5), part.w),
               "row %lu is another", (unsigned long)y);
    image_clear(&all);
    image_clear(&part);
    CLI_WORKS("tiny.pbrt --quiet --crop 15,11,16,12 -o part.pfm");
    CLI_WORKS("tiny.pbrt --quiet --size 1x1 -o one.pfm");
    CLI_WORKS("tiny.pbrt --quiet --size 65535x1 --spp 1 -o wide.pfm -o wide.png");
    CLI_WORKS("tiny.pbrt --quiet --size 1x65535 --spp 1 -o high.pfm -o high.hdr");
    CLI_WORKS("tiny.pbrt --quiet --max-pixels 32 --size 5000x5000 --crop 4992,4996,5000,5000 "
              "-o part.pfm --spp 1");
}

/* ---- extra pictures ---- */

enum { DEPTH = 12 };

/* Sums n pictures a0.pfm ... and compares with all.pfm. Every term is positive; a sample's value is
 * made of at most 2 DEPTH terms that are rounded once each in the picture and once in a part, and
 * the parts and the whole are rounded once more. */
static void expect_sum(int n, const char *what)
{
    Image all = read_image("all.pfm"), part;
    double sum[3][64 * 64] = { { 0 } };
    bool any = false;

    for (int k = 0; k < n; k++) {
        char name[20];
        snprintf(name, sizeof name, "a%d.pfm", k);
        part = read_image(name);
        REQUIRE(part.w == all.w && part.h == all.h && all.w * all.h <= 64 * 64, "%s: size", name);
        for (size_t i = 0; i < (size_t)all.w * all.h; i++) {
            sum[0][i] += part.pixels[i].r;
            sum[1][i] += part.pixels[i].g;
            sum[2][i] += part.pixels[i].b;
        }
        image_clear(&part);
    }
    for (size_t i = 0; i < (size_t)all.w * all.h; i++) {
        const float *p = &all.pixels[i].r;
        for (int c = 0; c < 3; c++) {
            EXPECT(fabs(sum[c][i] - p[c]) <= (4 * DEPTH + 2) * 0x1p-24 * p[c],
                   "%s: pixel %lu: the parts give %.9g, the picture is %.9g", what,
                   (unsigned long)i, sum[c][i], (double)p[c]);
            any = any || p[c] > 0;
        }
    }
    EXPECT(any, "the picture is black");
    image_clear(&all);
}

static void parts_by_length(void)
{
    char line[1000] = "tiny.pbrt --quiet --spp 8 -o all.pfm --integrator path:maxdepth=12";

    cli_scene();
    for (int k = 0; k < 16; k++)
        sprintf(line + strlen(line), " --aov length:%d=a%d.pfm", k + 1, k);
    CLI_WORKS("%s", line);
    expect_sum(16, "lengths");
    CLI_WORKS("tiny.pbrt --quiet --spp 8 -o all.pfm --integrator path:maxdepth=0 "
              "--aov length:1=a0.pfm --aov length:2=a1.pfm");
    expect_sum(1, "what is seen at once");
}

static void parts_by_strategy(void)
{
    static const char *const WAYS[] = { "mis", "implicit", "explicit" };
    char line[1000];

    cli_scene();
    for (int w = 0; w < 3; w++) {
        snprintf(line, sizeof line, "tiny.pbrt --quiet --spp 8 -o all.pfm --integrator "
                 "path:maxdepth=%d,strategy=%s", DEPTH, WAYS[w]);
        for (int k = 0; k < STRATEGIES; k++)
            sprintf(line + strlen(line), " --aov strategy:%s=a%d.pfm", strategy_names[k], k);
        CLI_WORKS("%s", line);
        expect_sum(STRATEGIES, WAYS[w]);
    }
}

/* A floor of one colour, seen from straight above at distance 5. */
static void first_hits(void)
{
    static const char FLOOR[] =
        "LookAt 0 0 5  0 0 0  0 1 0\nCamera \"perspective\" \"float fov\" 20\n"
        "Film \"rgb\" \"integer xresolution\" 8 \"integer yresolution\" 8\nWorldBegin\n"
        "LightSource \"infinite\"\nMaterial \"diffuse\" \"rgb reflectance\" [ 0.25 0.5 0.75 ]\n"
        "Shape \"trianglemesh\" \"point3 P\" [ -9 -9 0  9 -9 0  9 9 0  -9 9 0 ]\n"
        "  \"integer indices\" [ 0 1 2 0 2 3 ]\n";
    Image n, d, a;

    cli_write_text("floor.pbrt", FLOOR);
    CLI_WORKS("floor.pbrt --quiet --spp 4 -o x.pfm --aov normal=n.pfm --aov depth=d.pfm "
              "--aov albedo=a.pfm --aov normal=n.ppm --aov depth=d.png");
    n = read_image("n.pfm");
    d = read_image("d.pfm");
    a = read_image("a.pfm");
    for (size_t i = 0; i < 64; i++) {
        EXPECT(n.pixels[i].r == 0 && n.pixels[i].g == 0 && n.pixels[i].b == 1, "normal");
        EXPECT(d.pixels[i].r >= 4.9999f && d.pixels[i].r <= 5.16f, "depth %g",
               (double)d.pixels[i].r);                      /* 5 / cos of the corner */
        EXPECT(a.pixels[i].r == 0.25f && a.pixels[i].g == 0.5f && a.pixels[i].b == 0.75f, "albedo");
    }
    image_clear(&n);
    image_clear(&d);
    image_clear(&a);
    n = read_image("n.ppm");                                /* (1 + n) / 2: (0.5, 0.5, 1) */
    EXPECT(fabsf(n.pixels[0].r - 0.5f) < 0.005f && n.pixels[0].b == 1, "as a colour: %g %g",
           (double)n.pixels[0].r, (double)n.pixels[0].b);
    image_clear(&n);
}

/* ---- budgets ---- */

/* The count of samples a pixel in the note of the end. */
static double samples_of(const char *err)
{
    const char *at = strstr(err, " samples a pixel in ");
    double v = 0;

    REQUIRE(at, "no summary: %s", err);
    while (at > err && at[-1] != ' ')
        at--;
    REQUIRE(sscanf(at, "%lf", &v) == 1, "no number: %s", err);
    return v;
}

static double error_of(const char *err)
{
    const char *at = strstr(err, "estimated sigma/mu ");
    double v = 0;
    REQUIRE(at && sscanf(at + 19, "%lf", &v) == 1, "no error: %s", err);
    return v;
}

static void budget_of_time(void)
{
    Cli c;

    cli_scene();
    c = CLI_WORKS("tiny.pbrt -o a.pfm --time 0.2");
    EXPECT(samples_of(c.err) > 2, "no more than the scene asks for: %s", c.err);
    c = CLI_WORKS("tiny.pbrt -o a.pfm --time 1e9 --spp 3");
    EXPECT(samples_of(c.err) == 3, "the count ends it first: %s", c.err);
    c = CLI_WORKS("tiny.pbrt -o a.pfm --time 0.001 --spp 4000000000");
    EXPECT(is_there("a.pfm"), "no picture");
}

/* Where all pixels stop together, the estimate that ends it is the one that is told; it is rounded
 * to four digits there. Else it is foretold by other samples: of 192 pixels, roughly. */
static void budget_of_error(void)
{
    double last = 0;

    cli_scene();
    for (double e = 0.5; e > 0.02; e *= 0.5) {
        Cli c = CLI_WORKS("tiny.pbrt -o a.pfm --error %g", e);
        EXPECT(error_of(c.err) <= 1.7 * e, "sigma/mu %g: %s", e, c.err);
        c = CLI_WORKS("tiny.pbrt -o a.pfm --error %g --adaptive none", e);
        EXPECT(error_of(c.err) <= e + 0.00005, "sigma/mu %g: %s", e, c.err);
        EXPECT(samples_of(c.err) >= last, "fewer samples: %s", c.err);
        last = samples_of(c.err);
    }
    EXPECT(last > 8, "%g samples", last);
    EXPECT(samples_of(CLI_WORKS("tiny.pbrt -o a.pfm --error 1e-9 --spp 5").err) == 5, "--spp");
}

/* ---- limits ---- */

static void limits(void)
{
    static const char big[(2 << 20) + 1];
    typedef union { size_t bytes; double d; void *p; long double l; } Header;   /* of a block */
    char says[80];

    cli_scene();
    CLI_WORKS("tiny.pbrt --quiet -o a.pfm --max-memory 8 --max-pixels 192 --max-file 1");
    CLI_FAILS(STATUS_INPUT, "sky.pfm: the image has 8 x 4 pixels, at most 31 in all were expected "
              "(--max-pixels)", "tiny.pbrt --quiet --size 3x3 -o b.pfm --max-pixels 31");
    snprintf(says, sizeof says, "rushlight: out of memory: %lu bytes were asked for\n",
             48000000 + (unsigned long)sizeof(Header) + MEM_BEYOND);
    EXPECT_CLI(cli("tiny.pbrt --quiet --size 1000x1000 -o b.pfm --max-memory 8"), STATUS_OUTPUT,
               says);
    cli_write("big.pbrt", big, sizeof big);
    CLI_FAILS(STATUS_INPUT, "big.pbrt: has 2097153 bytes, the limit is 1048576 (--max-file)",
              "big.pbrt --quiet --max-file 1");
    cli_write_text("own.pbrt", "Include \"own.pbrt\"\n");
    CLI_FAILS(STATUS_INPUT, "own.pbrt:1:9: a file includes itself: own.pbrt includes own.pbrt",
              "own.pbrt --quiet");
    EXPECT(!is_there("b.pfm") && !is_there("big.png") && !is_there("own.png"), "a picture");
}

/* Includes nested k deep pass where the limit is k, and fail where it is less. */
static void include_depth(void)
{
    cli_scene();
    cli_write_text("i0.pbrt", cli_scene_text);
    for (int k = 1; k <= 5; k++) {
        char name[20], text[60];
        snprintf(name, sizeof name, "i%d.pbrt", k);
        snprintf(text, sizeof text, "Include \"i%d.pbrt\"\n", k - 1);
        cli_write_text(name, text);
    }
    CLI_WORKS("i5.pbrt --quiet --max-include 5 -o a.pfm");
    CLI_WORKS("tiny.pbrt --quiet -o b.pfm");
    EXPECT(cli_same_file("a.pfm", "b.pfm"), "another picture");
    EXPECT(cli("i5.pbrt --quiet --max-include 4 -o c.pfm").status == STATUS_INPUT, "one too many");
}

/* A stack of 256 KiB, as threads have on some systems, under includes and textures as deep as they
 * may be. Sanitizers need more. */
static void little_stack(void)
{
    const struct rlimit most = { 256 << 10, 256 << 10 };
    setrlimit(RLIMIT_STACK, &most);
}

static void small_stack(void)
{
    static char text[40000];
    Cli c;

    cli_scene();
    cli_write_text("i0.pbrt", cli_scene_text);
    for (int k = 1; k <= 64; k++) {
        char name[20];
        snprintf(name, sizeof name, "i%d.pbrt", k);
        snprintf(text, sizeof text, "Include \"i%d.pbrt\"\n", k - 1);
        cli_write_text(name, text);
    }
    strcpy(text, "Include \"i63.pbrt\"\n");
    for (int k = 1; k < 250; k++)
        sprintf(text + strlen(text), "Texture \"t%d\" \"spectrum\" \"scale\" \"%s tex\" %s%d%s "
                "\"float scale\" 0.99\n", k, k > 1 ? "texture" : "float", k > 1 ? "\"t" : "",
                k > 1 ? k - 1 : 1, k > 1 ? "\"" : "");
    strcat(text, "Material \"diffuse\" \"texture reflectance\" \"t120\"\nShape \"sphere\"\n");
    cli_write_text("deep.pbrt", text);
    c = cli_start(little_stack, "deep.pbrt --quiet --threads 1 -o a.pfm");
    cli_wait(&c);
    EXPECT_CLI(c, 0, "");
}

/* ---- warnings ---- */

/* The warning and the error are the same but for the word, and --strict leaves no picture. */
#define FOG "MakeNamedMedium \"fog\" \"string type\" \"homogeneous\" "     \
            "\"rgb sigma_s\" [ 1 1 1 ]\nWorldBegin\nShape \"sphere\"\n"              \
            "LightSource \"infinite\"\n"
#define LEAVES(method) method " leaves out the light that media scatter, here the medium 'fog'; "  \
                       "path and direct show it"
static void strict(void)
{
    static const struct { const char *text, *place, *says; } CASES[] = {
        { "WorldBegin\nLightSource \"infinite\"\nMaterial \"mattt\"\nShape \"sphere\"\n",
          "w.pbrt:3:1: ",
          "unknown material 'mattt', did you mean 'matte'?; the neutral one is used" },
        { "WorldBegin\nShape \"sphere\"\nLightSource \"point\" \"rgb I\" [ 0 0 0 ]\n", "",
          "the lights have no power: the picture is black" },
        { "Integrator \"paths\"\nWorldBegin\nShape \"sphere\"\nLightSource \"infinite\"\n",
          "w.pbrt:1:22: ", "integrator \"paths\" is not known; \"path\" is used" },
        { "Integrator \"whitted\"\n" FOG, "", LEAVES("whitted") },
        { "Integrator \"distributed\"\n" FOG, "", LEAVES("distributed") },
    };
    for (size_t i = 0; i < sizeof CASES / sizeof *CASES; i++) {
        char want[400], text[500];
        snprintf(text, sizeof text, "Camera \"perspective\" %s", CASES[i].text);
        cli_write_text("w.pbrt", text);
        snprintf(want, sizeof want, "rushlight: %swarning: %s\n", CASES[i].place, CASES[i].says);
        EXPECT_CLI(cli("w.pbrt --quiet --size 4x4 --spp 1 -o w.pfm"), 0, want);
        EXPECT(is_there("w.pfm"), "no picture");
        snprintf(want, sizeof want, "rushlight: %s%s\n", CASES[i].place, CASES[i].says);
        EXPECT_CLI(cli("w.pbrt --strict --size 4x4 --spp 1 -o s.pfm --quiet"), STATUS_INPUT, want);
        EXPECT(!is_there("s.pfm"), "strict: a picture");
    }
    cli_scene();
    CLI_WORKS("tiny.pbrt --quiet --strict -o s.pfm");
}

/* ---- names of pictures ---- */

static void default_names(void)
{
    static const struct { const char *film, *want; } CASES[] = {
        { "", "scene.png" },
        { "\"string filename\" \"a.pfm\"", "a.pfm" },
        { "\"string filename\" \"b.hdr\"", "b.hdr" },
        { "\"string filename\" \"c.jpeg\"", "c.png" },
        { "\"string filename\" \"d\"", "d.png" },
        { "\"string filename\" \"e.f.tga\"", "e.f.png" },
        { "\"string filename\" \"sub/g.ppm\"", "sub/g.ppm" },
    };
    char text[400];

    REQUIRE(mkdir(cli_path("sub"), 0777) == 0, "mkdir");
    for (size_t i = 0; i < sizeof CASES / sizeof *CASES; i++) {
        Cli c;
        snprintf(text, sizeof text, "Film \"rgb\" \"integer xresolution\" 4 \"integer "
                 "yresolution\" 4 %s\nSampler \"random\" \"integer pixelsamples\" 1\n"
                 "Camera \"perspective\"\nWorldBegin\nLightSource \"infinite\"\n", CASES[i].film);
        cli_write_text("sub/scene.pbrt", text);
        c = CLI_WORKS("sub/scene.pbrt --quiet");
        EXPECT(!c.err[0] && is_there(CASES[i].want), "%s: no %s", CASES[i].film, CASES[i].want);
        remove(cli_path(CASES[i].want));
    }
    CLI_WORKS("sub/scene.pbrt --quiet -o x.hdr");
    EXPECT(is_there("x.hdr") && !is_there("sub/g.ppm"), "-o");
    EXPECT(!strcmp(cli_folder(), "sub x.hdr "), "left: %s", cli_folder());
}

/* A bare mesh brings its camera and sky. */
static void bare_mesh(void)
{
    Image im;
    float most = 0;

    cli_scene();
    CLI_WORKS("roof.ply --quiet --size 12x12 --spp 2");
    CLI_WORKS("roof.ply --quiet --size 12x12 --spp 2 -o a.pfm");
    EXPECT(is_there("roof.png"), "no roof.png");
    im = read_image("a.pfm");
    for (size_t i = 0; i < 144; i++)
        most = fmaxf(most, im.pixels[i].g);
    EXPECT(most > 0.1f, "black");
    image_clear(&im);
}

/* Several pictures of one render hold the same light. */
static void several_outputs(void)
{
    char line[300] = "tiny.pbrt --quiet";

    cli_scene();
    for (const ImageFormat *const *f = image_formats; *f; f++)
        if ((*f)->write)
            sprintf(line + strlen(line), " -o a.%s", (*f)->info.name);
    CLI_WORKS("%s", line);
    for (const ImageFormat *const *f = image_formats; *f; f++)
        if ((*f)->write) {
            char a[20], b[20];
            snprintf(a, sizeof a, "a.%s", (*f)->info.name);
            snprintf(b, sizeof b, "b.%s", (*f)->info.name);
            CLI_WORKS("convert a.pfm %s", b);
            EXPECT(cli_same_file(a, b), "%s is not what a.pfm converts to", a);
        }
}

const TestCase test_cli_render[] = {
    { "forms", forms, false },
    { "each_option_matters", each_option_matters, false },
    { "notes", notes, false },
    { "crop", crop, false },
    { "parts_by_length", parts_by_length, false },
    { "parts_by_strategy", parts_by_strategy, false },
    { "first_hits", first_hits, false },
    { "budget_of_time", budget_of_time, false },
    { "budget_of_error", budget_of_error, false },
    { "limits", limits, false },
    { "include_depth", include_depth, false },
    { "small_stack", small_stack, false },
    { "strict", strict, false },
    { "default_names", default_names, false },
    { "bare_mesh", bare_mesh, false },
    { "several_outputs", several_outputs, false },
    { NULL, NULL, false }
};
