/* test_preview.c -- pictures in terminals: means of what is covered, colours, and what a terminal
 * shows of a render while it goes on, is resized, interrupted, refused. */
#include "base/mem.h"
#include "base/random.h"
#include "cli/preview.h"
#include "image/halfblocks.h"
#include "image/tonemap.h"
#include "test/terminal.h"

#include <signal.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

#define TRUE_COLOUR "TERM=xterm-256color COLORTERM=truecolor"
#define COLOURS_256 "TERM=xterm-256color"

/* ---- the picture made small ---- */

static void noise(Image *im, uint32_t w, uint32_t h)
{
    Rng r = rng_seed(w * 1000 + h);

    REQUIRE(image_init(im, w, h), "no memory");
    for (size_t i = 0; i < (size_t)w * h; i++)
        im->pixels[i] = rgb(rng_unit(&r), rng_unit(&r) * 3, rng_unit(&r) * 0.2f);
}

/* The mean over a box of a function that is constant on pixels: both sides cut into as many parts
 * as the other has, so that each part lies in one pixel of either. */
static double mean_by_parts(const Image *im, const Display *d, uint32_t W, uint32_t H, uint32_t X,
                            uint32_t Y, int channel)
{
    double sum = 0;
    Tone t;

    REQUIRE(tone_init(&t, d, im), "no memory");
    for (uint32_t v = 0; v < im->h; v++)
        for (uint32_t u = 0; u < im->w; u++) {
            uint32_t x = (X * im->w + u) / W, y = (Y * im->h + v) / H;
            Rgb c = tone_pixel(&t, (size_t)y * im->w + x);
            float k = channel == 0 ? c.r : channel == 1 ? c.g : c.b;
            sum += k < 0 ? 0 : k > 1 ? 1 : k;
        }
    tone_clear(&t);
    return sum / ((double)im->w * im->h);
}

static void means(void)
{
    static const uint32_t SIZES[][4] = {
        { 12, 8, 6, 4 }, { 13, 7, 5, 3 }, { 5, 3, 13, 7 }, { 7, 7, 7, 7 }, { 1, 9, 3, 2 }
    };
    Display d = { 0 };

    d.exposure = 0.5f;
    for (size_t i = 0; i < sizeof SIZES / sizeof *SIZES; i++) {
        Image im, small;
        d.tonemap = i % 2 ? kind_find(tonemaps, "reinhard") : NULL;
        noise(&im, SIZES[i][0], SIZES[i][1]);
        REQUIRE(image_init(&small, SIZES[i][2], SIZES[i][3]) && halfblocks_shrink(&im, &d, &small),
                "no memory");
        for (uint32_t y = 0; y < small.h; y++)
            for (uint32_t x = 0; x < small.w; x++) {
                Rgb c = *image_at(&small, x, y);
                double e = d_max(fabs(c.r - mean_by_parts(&im, &d, small.w, small.h, x, y, 0)),
                                 fabs(c.g - mean_by_parts(&im, &d, small.w, small.h, x, y, 1)));
                EXPECT(e < 1e-6, "case %d, pixel %d,%d: off by %g", (int)i, (int)x, (int)y, e);
            }
        image_clear(&im);
        image_clear(&small);
    }
}

/* Fits, touches one side, keeps the shape to within half a pixel. */
static void fits(void)
{
    static const uint32_t SHAPES[][2] = { { 1280, 720 }, { 16, 16 }, { 1, 5000 }, { 65535, 1 } };

    for (size_t i = 0; i < sizeof SHAPES / sizeof *SHAPES; i++)
        for (int columns = 1; columns < 200; columns += 33)
            for (int rows = 1; rows < 60; rows += 19) {
                uint32_t w, h, W = SHAPES[i][0], H = SHAPES[i][1];
                double ideal;
                halfblocks_fit(W, H, columns, rows, &w, &h);
                EXPECT(w >= 1 && h >= 1 && w <= (uint32_t)columns && h <= 2 * (uint32_t)rows &&
                       (w == (uint32_t)columns || h == 2 * (uint32_t)rows),
                       "%lu x %lu in %d x %d", (unsigned long)w, (unsigned long)h, columns, rows);
                ideal = w == (uint32_t)columns ? (double)h - (double)w * H / W
                                               : (double)w - (double)h * W / H;
                EXPECT(fabs(ideal) <= 0.5 + 1e-9 || w == 1 || h == 1, "shape off by %g", ideal);
            }
}

/* The nearest of all 240, of a grid of colours. */
static void nearest_of_256(void)
{
    for (int r = 0; r < 256; r += 5)
        for (int g = 0; g < 256; g += 15)
            for (int b = 0; b < 256; b += 17) {
                unsigned char c[3] = { (unsigned char)r, (unsigned char)g, (unsigned char)b };
                int best = 1 << 20, got = -1, mine = colour_of_256(c);
                for (int n = 16; n < 256; n++) {
                    int level[3], d = 0;
                    for (int k = 0; k < 3; k++) {
                        level[k] = (n - 16) / (k == 0 ? 36 : k == 1 ? 6 : 1) % 6;
                        level[k] = n >= 232 ? 8 + 10 * (n - 232)
                                 : level[k] ? 55 + 40 * level[k] : 0;
                        d += (level[k] - c[k]) * (level[k] - c[k]);
                    }
                    if (d < best)
                        best = d;
                    if (n == mine)
                        got = d;
                }
                EXPECT(got == best, "%d %d %d: %d is at %d, the nearest at %d", r, g, b, mine, got,
                       best);
            }
}

/* ---- what a terminal shows ---- */

static Film film;
static Display display;

static void make_film(void)
{
    static const uint32_t WHOLE[4] = { 0, 0, 40, 30 };
    Rng r = rng_seed(4);

    REQUIRE(film_init(&film, 40, 30, WHOLE, 1), "no memory");
    for (uint32_t y = 0; y < 30; y++)
        for (uint32_t x = 0; x < 40; x++) {
            Rgb c = rgb((float)x / 40, rng_unit(&r) * 2, (float)y / 20);
            film_add(&film, x, y, 0, &c);
        }
    display.tonemap = kind_find(tonemaps, "exponential");
    display.exposure = 1;
}

static void show_and_exit(void)
{
    Preview p;
    RenderSettings s;
    RenderReport r;

    terminal_take();
    memset(&s, 0, sizeof s);
    memset(&r, 0, sizeof r);
    if (!preview_start(&p, &display, &s) || !s.watch->look(p.watch.ctx, &film, &r))
        _exit(1);
    warn_at((Place){ "some.pbrt", 1, 2 }, "said meanwhile");
    preview_end(&p);
    _exit(0);
}

/* One look at the film, in a process of its own. */
static pid_t show_once(void)
{
    pid_t pid = fork();

    REQUIRE(pid >= 0, "fork");
    if (pid == 0)
        show_and_exit();
    return pid;
}

static int32_t shown_as(const Image *small, uint32_t x, uint32_t y, bool true_colour)
{
    Rgb c = *image_at(small, x, y);
    unsigned char b[3] = { (unsigned char)floor(255 * srgb_encode(c.r) + 0.5),
                           (unsigned char)floor(255 * srgb_encode(c.g) + 0.5),
                           (unsigned char)floor(255 * srgb_encode(c.b) + 0.5) };
    int n = colour_of_256(b);

    if (true_colour)
        return b[0] << 16 | b[1] << 8 | b[2];
    if (n >= 232)
        return 0x010101 * (8 + 10 * (n - 232));
    for (int k = 0; k < 3; k++) {
        int level = (n - 16) / (k == 0 ? 36 : k == 1 ? 6 : 1) % 6;
        b[k] = (unsigned char)(level ? 55 + 40 * level : 0);
    }
    return b[0] << 16 | b[1] << 8 | b[2];
}

static void expect_shown(const Terminal *t, bool true_colour)
{
    Image im, small;
    uint32_t w, h;

    halfblocks_fit(film.w, film.h, t->columns, t->rows > 1 ? t->rows - 1 : 1, &w, &h);
    REQUIRE(image_init(&im, film.w, film.h) && image_init(&small, w, h), "no memory");
    film_picture(&film, 0, &im);
    REQUIRE(halfblocks_shrink(&im, &display, &small), "no memory");
    for (uint32_t y = 0; y < (uint32_t)t->rows; y++)
        for (uint32_t x = 0; x < (uint32_t)t->columns; x++) {
            const TermCell *c = &t->page[1].cell[y][x];
            bool in = x < w && 2 * y < h;
            int32_t ink = in ? shown_as(&small, x, 2 * y, true_colour) : -1;
            int32_t ground = in && 2 * y + 1 < h ? shown_as(&small, x, 2 * y + 1, true_colour) : -1;
            EXPECT(c->block == in && (!in || (c->ink == ink && c->ground == ground)),
                   "%d x %d, cell %lu,%lu: %06lx %06lx for %06lx %06lx", t->columns, t->rows,
                   (unsigned long)x, (unsigned long)y, (unsigned long)c->ink,
                   (unsigned long)c->ground, (unsigned long)ink, (unsigned long)ground);
        }
    image_clear(&im);
    image_clear(&small);
}

static void screen_is_picture(void)
{
    static const int SIZES[][2] = { { 80, 24 }, { 200, 60 }, { 30, 40 }, { 7, 3 }, { 2, 1 } };
    static Terminal t;

    make_film();
    for (size_t i = 0; i < 2 * (sizeof SIZES / sizeof *SIZES); i++) {
        bool true_colour = i % 2;
        int status;
        pid_t pid;
        terminal_open(&t, SIZES[i / 2][0], SIZES[i / 2][1],
                      true_colour ? TRUE_COLOUR : COLOURS_256);
        pid = show_once();
        terminal_read(&t, 0);
        waitpid(pid, &status, 0);
        EXPECT(status == 0 && t.frames == 1u + (t.rows == 1), "status %d, %u frames", status,
               t.frames);
        expect_shown(&t, true_colour);
        EXPECT(terminal_is_restored(&t), "the terminal is not as it was");
        if (t.columns >= 80)
            EXPECT(!strcmp(terminal_line(&t, 0),
                           "rushlight: some.pbrt:1:2: warning: said meanwhile"),
                   "the message: %s", terminal_line(&t, 0));
        terminal_close(&t);
    }
    film_clear(&film);
}

/* ---- whole renders ---- */

static void ends_well(Terminal *t, Cli *c, int status)
{
    terminal_read(t, 0);
    cli_wait(c);
    EXPECT(c->status == status, "status %d, not %d: %s", c->status, status, terminal_line(t, 0));
    EXPECT(terminal_is_restored(t), "the terminal is not as it was");
    terminal_close(t);
}

/* After a new size the pictures have it: the first whole one may still have been on its way. */
static void resize(void)
{
    static Terminal t;
    Cli c;

    cli_scene();
    terminal_open(&t, 80, 24, TRUE_COLOUR);
    c = cli_start(terminal_take, "tiny.pbrt --size 40x30 --time 60 --preview -o a.pfm");
    terminal_read(&t, 3);
    EXPECT(t.other && !t.cursor && !t.wraps, "the screen is not its own");
    terminal_resize(&t, 33, 12);
    terminal_read(&t, 3);
    EXPECT(t.whole_x == 29 && t.whole_y == 11, "made smaller: %d x %d", t.whole_x, t.whole_y);
    terminal_resize(&t, 120, 50);
    terminal_read(&t, 2);
    kill(c.pid, SIGINT);
    ends_well(&t, &c, 130);
    EXPECT(t.most_x == 120 && t.most_y == 45, "the last picture fills %d x %d", t.most_x, t.most_y);
}

static void ends(void)
{
    static Terminal t;
    Cli c;

    cli_scene();
    terminal_open(&t, 100, 30, COLOURS_256);
    c = cli_start(terminal_take, "tiny.pbrt --size 20x15 --time 0.3 --preview -o a.pfm --quiet");
    ends_well(&t, &c, 0);
    EXPECT(t.frames > 0, "no picture");
    terminal_open(&t, 100, 30, COLOURS_256);
    c = cli_start(terminal_take, "tiny.pbrt --spp 2000000000 --preview -o a.pfm --quiet");
    terminal_read(&t, 1);
    kill(c.pid, SIGTERM);
    kill(c.pid, SIGINT);                /* the second ends it at once, wherever it is */
    ends_well(&t, &c, 130);
}

/* Elsewhere it says so, and renders. */
static void no_terminal(void)
{
    static Terminal t;
    Cli c;

    cli_scene();
    EXPECT_CLI(cli("tiny.pbrt --preview --quiet -o a.pfm"), 0, "rushlight: warning: "
               "--preview wants a terminal on standard error: there is no preview\n");
    EXPECT_CLI(cli("tiny.pbrt --preview --quiet --strict -o b.pfm"), 3, "rushlight: "
               "--preview wants a terminal on standard error: there is no preview\n");
    terminal_open(&t, 100, 30, "TERM=dumb");
    c = cli_start(terminal_take, "tiny.pbrt --preview --quiet -o a.pfm");
    ends_well(&t, &c, 0);
    EXPECT(t.frames == 0 && strstr(terminal_line(&t, 0), "wants a terminal"), "a dumb one");
}

const TestCase test_preview[] = {
    { "means", means, false },
    { "fits", fits, false },
    { "nearest_of_256", nearest_of_256, false },
    { "screen_is_picture", screen_is_picture, false },
    { "resize", resize, false },
    { "ends", ends, false },
    { "no_terminal", no_terminal, false },
    { NULL, NULL, false }
};
