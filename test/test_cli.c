/* test_cli.c -- the command line: what every command answers to right and wrong words, with its
 * exact messages and exit status. Pictures are the business of test_cli_render.c. */
#include "base/version.h"
#include "cli/args.h"
#include "lightsampling/lightsampler.h"
#include "render/render.h"
#include "image/denoise.h"
#include "test/cli_help.h"

#include <string.h>
#include <sys/stat.h>

/* ---- help and version ---- */

static void version(void)
{
    const char *want = "rushlight " RUSHLIGHT_VERSION "\n";
    Cli c = CLI_WORKS("--version");

    EXPECT(!strcmp(c.out, want) && !c.err[0], "--version: %s%s", c.out, c.err);
    for (int i = 0; commands[i]; i++) {
        c = CLI_WORKS("%s --version", commands[i]->name);
        EXPECT(!strcmp(c.out, want) && !c.err[0], "%s: %s%s", commands[i]->name, c.out, c.err);
    }
    c = CLI_WORKS("nosuch.pbrt --spp 3 --version");
    EXPECT(!strcmp(c.out, want) && !c.err[0], "after a file: %s%s", c.out, c.err);
}

/* Without a word, and by every word for it, the same page; it has each command once. */
static void overview(void)
{
    static const char *const WORDS[] = { "help", "--help", "-h", "help --help" };
    Cli first = CLI_WORKS("%s", "");

    for (int i = 0; i < 3; i++) {
        Cli c = CLI_WORKS("%s", WORDS[i]);
        EXPECT(!strcmp(c.out, first.out) && !c.err[0], "%s: another page", WORDS[i]);
    }
    EXPECT(!first.err[0], "it says: %s", first.err);
    for (int i = 0; commands[i]; i++) {
        char line[200];
        const char *at;
        snprintf(line, sizeof line, "\n  %-10s %-26s %s\n", commands[i]->name, commands[i]->usage,
                 commands[i]->summary);
        at = strstr(first.out, line);
        EXPECT(at && !strstr(at + 1, line), "not one line for %s", commands[i]->name);
    }
}

/* The names at the left of a page of help, and nothing else, are the options of the table. */
static void expect_options(const Command *c, const char *page)
{
    const ArgDef *a = c->args;

    for (const char *p = page; (p = strstr(p, "\n  -")) != NULL; a += a->name != NULL) {
        p += 3;
        EXPECT(a->name && strcspn(p, " \n") == strlen(a->name) &&
               !memcmp(p, a->name, strlen(a->name)), "help %s: '%.20s' instead of %s", c->name, p,
               a->name ? a->name : "the end");
    }
    EXPECT(!a->name, "help %s lacks %s", c->name, a->name);
}

static void help_of_each(void)
{
    static const char *const FORMS[] = { "%s --help", "%s -h", "--help %s", "-h %s",
                                         "%s a b --help", "%s --nonsense --help" };
    for (int i = 0; commands[i]; i++) {
        Cli page = CLI_WORKS("help %s", commands[i]->name);
        char head[160], line[100];
        snprintf(head, sizeof head, "rushlight %s %s\n  %s\n", commands[i]->name,
                 commands[i]->usage, commands[i]->summary);
        EXPECT(!strncmp(page.out, head, strlen(head)), "help %s begins: %.100s", commands[i]->name,
               page.out);
        expect_options(commands[i], page.out);
        for (size_t k = 0; k < sizeof FORMS / sizeof *FORMS; k++) {
            Cli c;
            snprintf(line, sizeof line, "%.*s%s%s", (int)strcspn(FORMS[k], "%"), FORMS[k],
                     commands[i]->name, strchr(FORMS[k], '%') + 2);
            if (!strcmp(commands[i]->name, "help"))
                continue;                       /* "help --help" is the overview's */
            c = CLI_WORKS("%s", line);
            EXPECT(!strcmp(c.out, page.out) && !c.err[0], "'%s' is another page", line);
        }
    }
}

/* ---- words that are wrong: status 2 and one line ---- */

/* {read} and {written} in a message stand for the image formats that can be. */
typedef struct { const char *line, *err; } Wrong;

static void expand(char *out, const char *err)
{
    const char *brace = strchr(err, '{');
    bool write = brace && !strncmp(brace, "{written}", 9), first = true;

    if (!brace || (!write && strncmp(brace, "{read}", 6))) {
        sprintf(out, "rushlight: %s\n", err);
        return;
    }
    out += sprintf(out, "rushlight: %.*s", (int)(brace - err), err);
    for (const ImageFormat *const *f = image_formats; *f; f++)
        if (write ? (*f)->write != NULL : (*f)->read != NULL) {
            out += sprintf(out, "%s%s", first ? "" : " ", (*f)->info.name);
            first = false;
        }
    sprintf(out, "%s\n", strchr(brace, '}') + 1);
}

static void expect_wrong(const Wrong *w, int n, int status)
{
    for (int i = 0; i < n; i++) {
        Cli c = cli("%s", w[i].line);
        char want[1000];
        expand(want, w[i].err);
        EXPECT(c.status == status, "'%s': status %d, not %d", w[i].line, c.status, status);
        EXPECT(!strcmp(c.err, want), "'%s' says: %snot: %s", w[i].line, c.err, want);
        EXPECT(!c.out[0], "'%s' prints: %s", w[i].line, c.out);
    }
}
#define EXPECT_WRONG(table, status) expect_wrong(table, (int)(sizeof table / sizeof *table), status)

static void unknown_words(void)
{
    static const Wrong CASES[] = {
        { "rendr", "unknown command 'rendr', did you mean 'render'?; see rushlight help" },
        { "lst integrators", "unknown command 'lst', did you mean 'list'?; see rushlight help" },
        { "frobnicate", "unknown command 'frobnicate', and there is no file of that name; see "
          "rushlight help" },
        { "''", "unknown command '', and there is no file of that name; see rushlight help" },
        { "help convrt", "unknown command 'convrt', did you mean 'convert'?; see rushlight help" },
        { "--help inof", "unknown command 'inof', did you mean 'info'?; see rushlight help" },
        { "help info render", "help takes one command" },
        { "tiny.pbrt --sp 3",
          "render: unknown option '--sp', did you mean '--spp'?; see rushlight help render" },
        { "render --sizw=3x3 tiny.pbrt",
          "render: unknown option '--sizw', did you mean '--size'?; see rushlight help render" },
        { "--frobnicate tiny.pbrt",
          "render: unknown option '--frobnicate'; see rushlight help render" },
        { "tiny.pbrt -ox.png",
          "render: unknown option '-ox.png'; see rushlight help render" },
        { "compare a b --mx 3",
          "compare: unknown option '--mx', did you mean '--max'?; see rushlight help compare" },
        { "info --quiet", "info: unknown option '--quiet'; see rushlight help info" },
        { "--versoin",
          "render: unknown option '--versoin', did you mean '--version'?; see rushlight help "
          "render" },
        { "list --hlep", "list: unknown option '--hlep', did you mean '--help'?; see rushlight "
          "help list" },
        { "list light lights", "list takes one kind" },
    };
    EXPECT_WRONG(CASES, STATUS_USAGE);
}

/* The lists of names in these messages are those of the program. */
static void expect_unknown_kind(const char *line, const void *list, const char *what,
                                const char *word, const char *near)
{
    char err[600];
    const KindInfo *info;
    Wrong w;

    snprintf(err, sizeof err, "unknown %s '%s'%s%s%s (have:", what, word,
             near ? ", did you mean '" : "", near ? near : "", near ? "'?" : "");
    for (size_t k = 0; (info = kind_info(list, k)) != NULL; k++)
        strcat(strcat(err, " "), info->name);
    strcat(err, ")");
    w.line = line;
    w.err = err;
    expect_wrong(&w, 1, STATUS_USAGE);
}

static void unknown_kinds(void)
{
    cli_scene();
    expect_unknown_kind("tiny.pbrt --quiet --integrator pth", integrators, "integrator", "pth",
                        "path");
    expect_unknown_kind("tiny.pbrt --quiet --accel=brvte:a=1", accels, "accelerator", "brvte",
                        "brute");
    expect_unknown_kind("tiny.pbrt --quiet --sampler randm", samplers, "sampler", "randm",
                        "random");
    expect_unknown_kind("tiny.pbrt --quiet --filter frobnicate", filters, "filter", "frobnicate",
                        NULL);
    expect_unknown_kind("tiny.pbrt --tonemap ''", tonemaps, "tone mapper", "", NULL);
    expect_unknown_kind("convert --tonemap reinhart a b", tonemaps, "tone mapper", "reinhart",
                        "reinhard");
    EXPECT(!strcmp(cli_folder(), "roof.ply sky.pfm tiny.pbrt wood.ppm "), "left: %s", cli_folder());
}

static void missing_words(void)
{
    static const Wrong CASES[] = {
        { "render", "render takes a scene (.pbrt, .obj or .ply); see rushlight help render" },
        { "--quiet", "render takes a scene (.pbrt, .obj or .ply); see rushlight help render" },
        { "tiny.pbrt --spp", "render: --spp takes N" },
        { "tiny.pbrt -o", "render: -o takes FILE" },
        { "tiny.pbrt --integrator", "render: --integrator takes NAME[:KEY=VALUE,...]" },
        { "tiny.pbrt --quiet=1", "render: --quiet takes no value" },
        { "tiny.pbrt --strict=", "render: --strict takes no value" },
        { "tiny.pbrt other.pbrt", "render takes one scene, got 'tiny.pbrt' and 'other.pbrt'" },
        { "render tiny.pbrt -- --spp", "render takes one scene, got 'tiny.pbrt' and '--spp'" },
        { "compare", "compare takes two images, an image and its reference" },
        { "compare a", "compare takes two images, an image and its reference" },
        { "compare a b c", "compare takes two images, an image and its reference" },
        { "convert a", "convert takes two names, the image to read and the one to write" },
        { "convert a b c", "convert takes two names, the image to read and the one to write" },
        { "info", "info takes a file" },
        { "info a b", "info takes one file, got 'a' and 'b'" },
    };
    EXPECT_WRONG(CASES, STATUS_USAGE);
}

#define WHOLE(name, value, lo, hi) { "tiny.pbrt " name " " value, name " '" value \
    "' is not right, expected a whole number from " lo " to " hi }
#define NUMBER(name, value, lo, hi) { "tiny.pbrt " name "=" value, name " '" value \
    "' is not right, expected a number from " lo " to " hi }
#define SIZE(value) { "tiny.pbrt --size " value, "--size '" value \
    "' is not right, expected WxH in pixels, as 640x480" }
#define CROP(value) { "tiny.pbrt --crop " value, "--crop '" value \
    "' is not right, expected X0,Y0,X1,Y1 in pixels with X0 < X1 and Y0 < Y1" }

static void wrong_values(void)
{
    static const Wrong CASES[] = {
        WHOLE("--spp", "0", "1", "4294967295"), WHOLE("--spp", "4294967296", "1", "4294967295"),
        WHOLE("--spp", "1.5", "1", "4294967295"), WHOLE("--spp", "3x", "1", "4294967295"),
        WHOLE("--spp", "99999999999999999999999", "1", "4294967295"),
        WHOLE("--threads", "0", "1", "256"), WHOLE("--threads", "257", "1", "256"),
        WHOLE("--seed", "-1", "0", "9223372036854775807"),
        WHOLE("--max-pixels", "0", "1", "1099511627776"),
        WHOLE("--max-memory", "0", "1", "1073741824"),
        WHOLE("--max-include", "10001", "1", "10000"),
        WHOLE("--max-file", "-5", "1", "1073741824"),
        NUMBER("--time", "0", "0.001", "1000000000"), NUMBER("--time", "", "0.001", "1000000000"),
        NUMBER("--time", "nan", "0.001", "1000000000"),
        NUMBER("--time", "1s", "0.001", "1000000000"),
        NUMBER("--error", "-1", "1e-9", "1000000000"),
        NUMBER("--error", "inf", "1e-9", "1000000000"),
        NUMBER("--exposure", "100.5", "-100", "100"), NUMBER("--exposure", "1,5", "-100", "100"),
        SIZE("3"), SIZE("3x"), SIZE("x3"), SIZE("0x3"), SIZE("3x0"), SIZE("3X4"), SIZE("3x4x5"),
        SIZE("-3x4"), SIZE("4294967297x1"), SIZE("3x4."),
        CROP("0,0,0,1"), CROP("0,1,1,1"), CROP("2,0,1,1"), CROP("0,0,1"), CROP("0,0,1,1,1"),
        CROP("-1,0,1,1"), CROP("a"),
        { "compare a b --max -1", "--max '-1' is not right, expected a number from 0 to 1e300" },
        { "compare a b --scale x", "--scale 'x' is not right, expected a number from 0 to 1e30" },
        { "tiny.pbrt -o x.foo", "x.foo: no image is written with the extension 'foo', one of these "
                                "was expected: {written}" },
        { "tiny.pbrt -o tga/x", "tga/x: no image is written with the extension '', one of these "
                                "was expected: {written}" },
        { "compare a b --diff d.tga", "d.tga: no image is written with the extension 'tga', one of "
                                      "these was expected: {written}" },
        { "convert a b", "b: no image is written with the extension '', one of these was expected: "
                         "{written}" },
    };
    EXPECT_WRONG(CASES, STATUS_USAGE);
}

/* Values that can be judged only once the scene is read. */
static void wrong_settings(void)
{
    static const Wrong CASES[] = {
        { "tiny.pbrt --quiet --crop 0,0,17,12", "--crop ends at 17,12, the picture is 16x12" },
        { "tiny.pbrt --quiet --size 8x8 --crop 7,7,8,9",
          "--crop ends at 8,9, the picture is 8x8" },
        { "tiny.pbrt --quiet --max-pixels 191",
          "a picture of 16x12 pixels is above the limit of 191 (--max-pixels)" },
        { "tiny.pbrt --quiet --size 100000x100000",
          "a picture of 100000x100000 pixels is above the limit of 268435456 (--max-pixels)" },
        { "tiny.pbrt --quiet --integrator path:maxdept=3",
          "path has no option 'maxdept', did you mean 'maxdepth'?" },
        { "tiny.pbrt --quiet --integrator path:maxdepth=-3",
          "path: 'maxdepth=-3' is not right, expected maxdepth=(a whole number from 0 to 100000)" },
        { "tiny.pbrt --quiet --integrator path:strategy=both", "path: 'strategy=both' is not "
          "right, expected strategy=(one of implicit explicit mis ris twostage)" },
        { "tiny.pbrt --quiet --filter=box:xradius=x",
          "box: 'xradius=x' is not right, expected xradius=(a number from 0 to 100)" },
        { "tiny.pbrt --quiet --aov normal",
          "--aov takes NAME=FILE; see list aovs" },
        { "tiny.pbrt --quiet --aov=normal:3=x.pfm", "--aov normal takes nothing after ':'" },
        { "tiny.pbrt --quiet --aov length:0=x.pfm", "--aov length:N takes N from 1 to 16 edges" },
        { "tiny.pbrt --quiet --aov length:17=x.pfm", "--aov length:N takes N from 1 to 16 edges" },
        { "tiny.pbrt --quiet --aov length=x.pfm", "--aov length:N takes N from 1 to 16 edges" },
        { "tiny.pbrt --quiet --aov variance:picture=x.pfm",
          "--aov variance:NAME takes emission, direct or indirect" },
        { "tiny.pbrt --quiet --integrator light --aov variance:direct=x.pfm",
          "--aov variance:NAME wants samples that are a pixel's own, light has others" },
        { "tiny.pbrt --quiet --integrator light --aov edges=x.pfm",
          "--aov edges wants samples that are a pixel's own, light has others" },
        { "tiny.pbrt --quiet --aov strategy:both=x.pfm",
          "--aov strategy:NAME takes implicit, explicit, lens, merge or connect" },
        { "tiny.pbrt --quiet --aov depth=x.foo", "x.foo: no image is written with the extension "
          "'foo', one of these was expected: {written}" },
    };
    char many[600] = "tiny.pbrt";
    Wrong w = { many, "at most 8 -o are possible" };

    cli_scene();
    EXPECT_WRONG(CASES, STATUS_USAGE);
    for (int i = 0; i < 9; i++)
        strcat(many, " -o x.pfm");
    expect_wrong(&w, 1, STATUS_USAGE);
    strcpy(many, "tiny.pbrt");
    for (int i = 0; i < 17; i++)
        strcat(many, " --aov depth=x.pfm");
    w.err = "at most 16 --aov are possible";
    expect_wrong(&w, 1, STATUS_USAGE);
    EXPECT(!strcmp(cli_folder(), "roof.ply sky.pfm tiny.pbrt wood.ppm "), "left: %s", cli_folder());
}

/* ---- inputs that are wrong: status 3 ---- */

#define KNOWN_IMAGES "is no image of a known kind, one of these was expected: {read}"

static void wrong_inputs(void)
{
    static const Wrong CASES[] = {
        { "nosuch.pbrt", "nosuch.pbrt: cannot be opened: No such file or directory" },
        { "nosuch/x.ply", "nosuch/x.ply: cannot be opened: No such file or directory" },
        { "render nosuch.obj", "nosuch.obj: cannot be opened: No such file or directory" },
        { "info nosuch.hdr", "nosuch.hdr: cannot be opened: No such file or directory" },
        { "convert nosuch.hdr x.png", "nosuch.hdr: cannot be opened: No such file or directory" },
        { "compare nosuch.hdr x.png", "nosuch.hdr: cannot be opened: No such file or directory" },
        { ".", ".: a scene was expected: .pbrt, .obj or .ply" },
        { "render ''", "'': a scene was expected: .pbrt, .obj or .ply" },
        { "folder.pbrt", "folder.pbrt: is a folder, a file was expected" },
        { "info folder.ply", "folder.ply: is a folder, a file was expected" },
        { "info .", ".: is a folder, a file was expected" },
        { "convert . x.png", ".: is a folder, a file was expected" },
        { "tiny.pbrt/x.pbrt", "tiny.pbrt/x.pbrt: cannot be opened: Not a directory" },
        { "wood.ppm", "wood.ppm: a scene was expected: .pbrt, .obj or .ply" },
        { "render tiny", "tiny: a scene was expected: .pbrt, .obj or .ply" },
        { "a\nb\x1B[2J\x7F.pbrt", "a?b?[2J?.pbrt: cannot be opened: No such file or directory" },
        { "info empty.txt", "empty.txt: " KNOWN_IMAGES },
        { "compare tiny.pbrt wood.ppm", "tiny.pbrt: " KNOWN_IMAGES },
        { "compare wood.ppm tiny.pbrt", "tiny.pbrt: " KNOWN_IMAGES },
        { "empty.ply", "empty.ply:1:1: not a PLY file, 'ply' alone on line 1 was expected" },
        { "empty.pbrt --strict", "there is no shape and no light; the picture shows a sky" },
        { "wrong.pbrt", "wrong.pbrt:2:7: expected the kind of shape in quotes" },
        { "compare wood.ppm sky.pfm",
          "wood.ppm: has 2 x 2 pixels, 8 x 4 as in sky.pfm were expected" },
    };
    cli_scene();
    cli_write_text("empty.txt", "");
    cli_write_text("empty.ply", "");
    cli_write_text("empty.pbrt", "");
    cli_write_text("wrong.pbrt", "WorldBegin\nShape sphere\n");
    REQUIRE(mkdir(cli_path("folder.pbrt"), 0777) == 0 && mkdir(cli_path("folder.ply"), 0777) == 0,
            "mkdir");
    EXPECT_WRONG(CASES, STATUS_INPUT);
}

/* ---- list ---- */

static const struct { const char *name; const void *list; } SETS[] = {
    { "integrators", integrators }, { "accelerators", accels }, { "samplers", samplers },
    { "materials", bsdfs },         { "lights", lights },       { "lightsamplers", lightsamplers },
    { "media", medium_kinds },
    { "shapes", shape_readers },    { "cameras", cameras },     { "filters", filters },
    { "adaptives", adaptives },     { "aovs", aovs },
    { "formats", image_formats },   { "tonemaps", tonemaps },       { "meters", meters },
    { "denoisers", denoisers },
};
enum { SETS_N = sizeof SETS / sizeof *SETS };

/* The line of `page` that begins with this text; the case ends if there is none. */
static const char *line_of(const char *page, const char *indent, const char *name, int width)
{
    char begin[100];
    const char *at;
    snprintf(begin, sizeof begin, "\n%s%-*s ", indent, width, name);
    at = strstr(page, begin);
    REQUIRE(at, "there is no line of '%s%s'", indent, name);
    return at + 1;
}

static void expect_word(const char *line, const char *text)
{
    const char *end = line + strcspn(line, "\n"), *at = text ? strstr(line, text) : line;
    EXPECT(at && at < end, "'%s' is not in '%.*s'", text, (int)(end - line), line);
}

static void expect_entry(const char *page, const KindInfo *info)
{
    const char *line = line_of(page, "  ", info->name, 14);
    int options = 0, lines = 0;

    expect_word(line, info->summary);
    expect_word(line, info->source);
    for (const OptDef *d = info->options; d && d->key; d++, options++) {
        const char *option = line_of(line, "    ", d->key, 18);
        expect_word(option, d->help);
        expect_word(option, d->also);
        expect_word(option, d->type == OPT_CHOICE ? d->choices : NULL);
    }
    /* what an option is called has blanks behind it, what a method is like has not */
    for (line = strchr(line, '\n') + 1; !strncmp(line, "    ", 4); line = strchr(line, '\n') + 1)
        lines += line[4 + strcspn(line + 4, " ;\n")] == ' ' &&
                 strncmp(line, "    meets Shirley", 17) && strncmp(line, "    fails of", 12);
    EXPECT(lines == options, "%s: %d options, %d lines", info->name, options, lines);
}

/* Each set alone, by its plural and its singular, and all of them after each other. */
static void lists(void)
{
    static char all[100000];

    for (int s = 0; s < SETS_N; s++) {
        Cli c = CLI_WORKS("list %s", SETS[s].name);
        Cli one = CLI_WORKS("list %.*s", (int)strlen(SETS[s].name) - 1, SETS[s].name);
        const KindInfo *info;
        size_t n = strlen(SETS[s].name), k = 0, found = 0;

        EXPECT(!strcmp(c.out, one.out) && !c.err[0], "list %s: another page", SETS[s].name);
        EXPECT(!strncmp(c.out, SETS[s].name, n) && c.out[n] == '\n', "it begins: %.30s", c.out);
        for (; (info = kind_info(SETS[s].list, k)) != NULL; k++)
            expect_entry(c.out, info);
        for (const char *p = c.out; (p = strstr(p, "\n  ")) != NULL; p++)
            found += p[3] != ' ';
        EXPECT(found == k && k > 0, "%s: %lu kinds, %lu lines", SETS[s].name, (unsigned long)k,
               (unsigned long)found);
        REQUIRE(strlen(all) + strlen(c.out) < sizeof all, "too long");
        strcat(all, c.out);
    }
    EXPECT(!strcmp(CLI_WORKS("list").out, all), "list is not all the lists");
}

static void list_of_nothing(void)
{
    char err[400] = "unknown kind 'ligths', did you mean 'lights'? (have:";
    Wrong w = { "list ligths", err };
    for (int s = 0; s < SETS_N; s++)
        strcat(strcat(err, " "), SETS[s].name);
    strcat(err, ")");
    expect_wrong(&w, 1, STATUS_USAGE);
}

const TestCase test_cli[] = {
    { "version", version, false },
    { "overview", overview, false },
    { "help_of_each", help_of_each, false },
    { "unknown_words", unknown_words, false },
    { "unknown_kinds", unknown_kinds, false },
    { "missing_words", missing_words, false },
    { "wrong_values", wrong_values, false },
    { "wrong_settings", wrong_settings, false },
    { "wrong_inputs", wrong_inputs, false },
    { "lists", lists, false },
    { "list_of_nothing", list_of_nothing, false },
    { NULL, NULL, false }
};
