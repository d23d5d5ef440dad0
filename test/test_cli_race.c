/* test_cli_race.c -- the command `race`: its table, CSV, plot and pictures, files of races, and
 * what it says of wrong ones. No figure of speed is judged. */
#include "test/cli_help.h"

#include "image/image.h"

#include <signal.h>
#include <stdlib.h>
#include <string.h>

static const char *file_text(const char *name)
{
    size_t n;
    const char *text = cli_read(name, &n);
    REQUIRE(text && strlen(text) == n, "%s", name);
    return text;
}

/* ---- well formed ---- */

static bool name_char(char c)
{
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '-';
}

static const char *attributes(const char *p)
{
    for (;;) {
        p += strspn(p, " \n");
        if (!name_char(*p))
            return p;
        while (name_char(*p))
            p++;
        REQUIRE(p[0] == '=' && p[1] == '"', "an attribute: %.30s", p);
        p += 2 + strcspn(p + 2, "\"<&");
        REQUIRE(*p == '"', "an attribute's end: %.30s", p);
        p++;
    }
}

/* Elements nest, attributes are quoted, text has no bare < or & and no control character. */
static void expect_xml(const char *text)
{
    const char *open[16], *p = text + strcspn(text, "\n");
    int depth = 0;

    EXPECT(!strncmp(text, "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n", 39), "head");
    while (*(p += strspn(p, "\n"))) {
        if (*p != '<') {
            REQUIRE(depth > 0 && (unsigned char)*p >= 32, "text outside: %.30s", p);
            if (*p == '&')
                REQUIRE(!strncmp(p, "&lt;", 4) || !strncmp(p, "&gt;", 4) || !strncmp(p, "&amp;", 5),
                        "a bare &: %.30s", p);
            p++;
        } else if (p[1] == '/') {
            size_t n = strcspn(p + 2, ">");
            REQUIRE(depth > 0 && !strncmp(open[depth - 1], p + 2, n) &&
                    !name_char(open[depth - 1][n]), "ends what is not open: %.30s", p);
            depth--;
            p += n + 3;
        } else {
            REQUIRE(name_char(p[1]) && depth < 16, "a tag: %.30s", p);
            open[depth++] = p + 1;
            for (p++; name_char(*p); p++)
                ;
            p = attributes(p);
            REQUIRE(*p == '>' || !strncmp(p, "/>", 2), "a tag's end: %.30s", p);
            depth -= *p == '/';
            p += *p == '/' ? 2 : 1;
        }
    }
    EXPECT(depth == 0, "%d elements are open", depth);
}

static int count(const char *text, const char *word)
{
    int n = 0;
    for (; (text = strstr(text, word)) != NULL; text++)
        n++;
    return n;
}

/* ---- what comes out ---- */

#define TINY "race tiny.pbrt --quiet --threads 2 --seed 3 "

/* The rows after the head are as long as it, and there are so many. */
static void expect_aligned(const char *out, const char *head, int rows)
{
    const char *p = strstr(out, head);
    size_t n;
    int i = 0;

    REQUIRE(p, "no '%s' in:\n%s", head, out);
    n = strcspn(p, "\n");
    for (p += n + 1; strcspn(p, "\n") == n; i++)
        p += n + 1;
    EXPECT(i == rows, "%d rows after '%s' in:\n%s", i, head, out);
}

static void outputs(void)
{
    static const char *const labels[] = { "path@random", "path:strategy=implicit",
                                          "path:maxdepth=0" };
    const char *svg;
    const Csv *csv;
    Cli c;

    cli_scene();
    c = CLI_WORKS(TINY "--with path@random --with path:strategy=implicit --with path:maxdepth=0 "
                  "--spp 8 --reference auto --reference-spp 64 --csv a.csv --plot a.svg -o a.pfm");
    EXPECT(!strncmp(c.out, "tiny.pbrt, 16 x 12 pixels, seed 3, 2 threads\n", 45), "%s", c.out);
    EXPECT(!c.err[0], "it says: %s", c.err);
    expect_aligned(c.out, "method                       spp    seconds      CPU s", 12);
    expect_aligned(c.out, "method                  sampler           slope       95 % interval", 3);
    csv = csv_of(file_text("a.csv"));
    REQUIRE(csv->n == 12, "%d rows", csv->n);
    for (int i = 0; i < 12; i++) {
        EXPECT(!strcmp(csv_text(csv, i, "method"), labels[i / 4]), "row %d", i);
        EXPECT(!strcmp(csv_text(csv, i, "sampler"), i < 4 ? "random" : "zerotwo"), "row %d", i);
        EXPECT(csv_num(csv, i, "spp") == 1 << i % 4, "row %d", i);
        EXPECT(csv_num(csv, i, "sigma_over_mu") > 0 && csv_num(csv, i, "relmse") > 0 &&
               csv_num(csv, i, "reference_sigma_over_mu") > 0, "row %d", i);
        EXPECT(csv_num(csv, i, "slope_lo") < csv_num(csv, i, "slope") &&
               csv_num(csv, i, "slope") < csv_num(csv, i, "slope_hi"), "row %d", i);
    }
    /* what shines and is seen is less than all light */
    EXPECT(csv_num(csv, 11, "mean_ratio") < 0.97 && csv_num(csv, 3, "mean_ratio") > 0.97,
           "means %s %s", csv_text(csv, 11, "mean_ratio"), csv_text(csv, 3, "mean_ratio"));
    svg = file_text("a.svg");
    expect_xml(svg);
    EXPECT(count(svg, "<polyline ") == 6 && count(svg, "<circle ") == 9 &&
           count(svg, ">samples a pixel<") == 1 && count(svg, ">seconds<") == 1 &&
           count(svg, "slope -1/2") == 2 && count(svg, ">path:maxdepth=0<") == 1, "svg: %s", svg);
    CLI_WORKS("tiny.pbrt --quiet --seed 3 --spp 8 --sampler random -o b.pfm --integrator path");
    EXPECT(cli_same_file("a-1-path_random.pfm", "b.pfm"), "not the picture of render");
    CLI_WORKS("tiny.pbrt --quiet --seed 3 --spp 8 -o c.pfm --integrator path:maxdepth=0");
    EXPECT(cli_same_file("a-3-path_maxdepth_0.pfm", "c.pfm"), "not the picture of render");
}

/* Independent samples converge with slope -1/2, told by two renders; no clock has part in it. */
static void random_slope(void)
{
    const Csv *csv;
    Cli c;

    cli_scene();
    c = CLI_WORKS("race tiny.pbrt --quiet --seed 3 --with path@random --spp 256 --size 48x36 "
                  "--csv a.csv");
    EXPECT(strstr(c.out, "error of one of two renders") && !strstr(c.out, "relMSE"), "%s", c.out);
    csv = csv_of(file_text("a.csv"));
    REQUIRE(csv->n == 9, "%d rows", csv->n);
    EXPECT(csv_num(csv, 0, "slope_lo") < -0.5 && csv_num(csv, 0, "slope_hi") > -0.5 &&
           csv_num(csv, 0, "slope_hi") - csv_num(csv, 0, "slope_lo") < 0.3, "slope %s: %s, %s",
           csv_text(csv, 0, "slope"), csv_text(csv, 0, "slope_lo"), csv_text(csv, 0, "slope_hi"));
    EXPECT(!*csv_text(csv, 0, "relmse") && csv_num(csv, 8, "mean_ratio") == 1, "without one");
}

/* A file of a race, with options that change it, saves in time, and labels that are markup. */
static void race_file(void)
{
    static const char text[] =
        "Scene \"tiny.pbrt\" Spp [ 1 3 ] Seed 3 Threads 1\n"
        "Method \"<&>\\\"\xC3\xA4\xFF\" Integrator \"path\" \"integer maxdepth\" 2\n"
        "Method \"a, b\" Integrator \"path\" Sampler \"random\"\n"
        "Output \"a.pfm\" \"a.png\" Autosave 0.001 Csv \"a.csv\" Plot \"a.svg\"\n";
    const Csv *csv;
    Cli c;

    cli_scene();
    cli_write_text("x.race", text);
    CLI_WORKS("race x.race --quiet");
    csv = csv_of(file_text("a.csv"));
    REQUIRE(csv->n == 4, "%d rows", csv->n);
    EXPECT(csv_num(csv, 1, "spp") == 3 && !strcmp(csv_text(csv, 2, "method"), "a, b") &&
           !strcmp(csv_text(csv, 0, "method"), "<&>\"\xC3\xA4\xFF") &&
           !strcmp(csv_text(csv, 0, "reference"), "pair"), "rows");
    expect_xml(file_text("a.svg"));
    EXPECT(strstr(file_text("a.svg"), ">&lt;&amp;&gt;\"\xC3\xA4?<"), "label: %s",
           file_text("a.svg"));
    CLI_WORKS("tiny.pbrt --quiet --seed 3 --spp 3 -o b.pfm --integrator path:maxdepth=2");
    EXPECT(cli_same_file("a-1-_______.pfm", "b.pfm"), "not the picture of render");
    c = CLI_WORKS("race x.race --quiet --spp 1,2 --size 8x9 --with path:strategy=explicit "
                  "--reference auto --reference-with path@random --csv b.csv");
    csv = csv_of(file_text("b.csv"));
    REQUIRE(csv->n == 6, "%d rows", csv->n);
    EXPECT(csv_num(csv, 5, "spp") == 2 && csv_num(csv, 5, "width") == 8 &&
           !strcmp(csv_text(csv, 5, "reference"), "auto"), "%s", c.out);
}

/* By time, with pictures on the way: an early moment comes in any render. */
static void by_time(void)
{
    const Csv *csv;

    cli_scene();
    CLI_WORKS(TINY "--with path --time 0.02,0.2 --autosave 0.002,0.004 -o a.pfm --csv a.csv");
    csv = csv_of(file_text("a.csv"));
    REQUIRE(csv->n >= 1 && csv->n <= 2, "%d rows", csv->n);
    EXPECT(csv_num(csv, csv->n - 1, "seconds") >= 0.2, "it ended too soon");
    EXPECT(strstr(cli_folder(), "a-1-path-0.002s.pfm a-1-path-0.004s.pfm a-1-path.pfm "),
           "files: %s", cli_folder());
}

static void nap(void)
{
    volatile double x = 1;
    for (long i = 0; i < 20000000; i++)
        x = x * 1.0000001;
}

/* What was reached is told and written. */
static void interrupted(void)
{
    Cli c;

    cli_scene();
    c = cli_start(NULL, "race tiny.pbrt --with path --with ao --spp 1,2,4,4000000000 --threads 2 "
                  "--size 70x50 --reference auto --reference-spp 2 --csv a.csv --plot a.svg "
                  "-o a.pfm");
    cli_await(&c, "method 1 of 2");
    nap();
    kill(c.pid, SIGINT);
    cli_wait(&c);
    EXPECT(c.status == STATUS_INTERRUPTED, "status %d: %s", c.status, c.err);
    EXPECT(csv_of(file_text("a.csv"))->n >= 1 && strstr(c.out, "\npath  "), "out: %s", c.out);
    expect_xml(file_text("a.svg"));
    EXPECT(strstr(cli_folder(), "a-1-path.pfm ") && !strstr(cli_folder(), "a-2-ao"), "files: %s",
           cli_folder());
    EXPECT(!strstr(c.err, "method 2"), "it went on: %s", c.err);
}

/* ---- wrong ones ---- */

static void wrong_lines(void)
{
    cli_scene();
    CLI_FAILS(STATUS_USAGE, "race takes a scene (.pbrt, .obj or .ply) or a file of a race; see "
              "rushlight help race", "race");
    CLI_FAILS(STATUS_USAGE, "race takes methods, as --with path --with "
              "path:strategy=implicit@random", "race tiny.pbrt");
    CLI_FAILS(STATUS_USAGE, "path has no option 'strateg', did you mean 'strategy'?",
              TINY "--with path:strateg=mis");
    CLI_FAILS(STATUS_USAGE, "race: unknown option '--wiht', did you mean '--with'?; see rushlight "
              "help race", TINY "--wiht path");
    CLI_FAILS(STATUS_USAGE, "--spp '4,2' is not right, expected whole numbers that rise, with "
              "commas between (at most 48)", TINY "--with path --spp 4,2");
    CLI_FAILS(STATUS_USAGE, "--time '1,' is not right, expected seconds that rise, with commas "
              "between (at most 48)", TINY "--with path --time 1,");
    CLI_FAILS(STATUS_USAGE, "--reference 'auto' is one too many, expected auto, pair, one file or "
              "two", TINY "--with path --reference a.pfm --reference auto");
    CLI_FAILS(STATUS_USAGE, "automatic saves want a picture to write: -o FILE",
              TINY "--with path --autosave 1");
    CLI_FAILS(STATUS_INPUT, "r.pfm: cannot be opened: No such file or directory",
              TINY "--with path --spp 2 --reference r.pfm");
    CLI_FAILS(STATUS_INPUT, "sky.pfm: has 8 x 4 pixels, 16 x 12 as are rendered were expected",
              TINY "--with path --spp 2 --reference sky.pfm");
    CLI_FAILS(STATUS_OUTPUT, "no/a.csv: cannot be written: No such file or directory",
              TINY "--with path --spp 2 --csv no/a.csv");
    CLI_FAILS(STATUS_OUTPUT, "no/a-1-path.pfm: cannot be written: No such file or directory",
              TINY "--with path --spp 2 -o no/a.pfm");
    cli_write_text("x.race", "Scene \"none.pbrt\" Method \"m\" Integrator \"path\"");
    CLI_FAILS(STATUS_INPUT, "none.pbrt: cannot be opened: No such file or directory",
              "race x.race");
    cli_write_text("y.race", "Scene \"tiny.pbrt\"\nMethd \"m\"\n");
    CLI_FAILS(STATUS_INPUT, "y.race:2:1: unknown directive 'Methd', did you mean 'Method'?",
              "race y.race");
}

/* The same picture whatever the seed: two renders say nothing. A black one: no error relative to it
 * either, and no figure that is not a number. */
static void nothing_to_tell(void)
{
    static const char black[] =
        "Camera \"perspective\" Film \"rgb\" \"integer xresolution\" 8 \"integer yresolution\" 8\n"
        "WorldBegin Shape \"sphere\"\n";
    const Csv *csv;
    Cli c;

    cli_write_text("black.pbrt", black);
    c = CLI_WORKS("race black.pbrt --quiet --with path --spp 4 --csv a.csv --plot a.svg");
    EXPECT(strstr(c.err, "path: two renders with different seeds are the same picture") &&
           !strstr(c.out, "nan"), "out: %s err: %s", c.out, c.err);
    csv = csv_of(file_text("a.csv"));
    REQUIRE(csv->n == 3 && !*csv_text(csv, 0, "slope"), "%d rows", csv->n);
    expect_xml(file_text("a.svg"));
    c = cli("race black.pbrt --quiet --with path --spp 4 --reference auto");
    EXPECT(c.status == STATUS_INPUT && strstr(c.err, "the reference is black"), "%d: %s", c.status,
           c.err);
}

const TestCase test_cli_race[] = {
    { "outputs", outputs, false },
    { "random_slope", random_slope, false },
    { "race_file", race_file, false },
    { "by_time", by_time, false },
    { "interrupted", interrupted, false },
    { "wrong_lines", wrong_lines, false },
    { "nothing_to_tell", nothing_to_tell, false },
    { NULL, NULL, false }
};
