/* halfblocks.c -- the code of `halfblocks.h`.
 *
 * Idea        The mean is taken of what the display would show, not of the light: a lamp a thousand
 *             times too bright for the display is one white pixel of it, not a white block. It is
 *             taken of linear values, as the eye takes it of a picture seen from afar. */
#include "image/halfblocks.h"

#include "image/tonemap.h"

#include <stdio.h>
#include <string.h>

void halfblocks_fit(uint32_t w, uint32_t h, int columns, int rows, uint32_t *across, uint32_t *down)
{
    double scale = d_min((double)columns / w, 2.0 * rows / h);

    *across = (uint32_t)d_max(1, floor(w * scale + 0.5));
    *down = (uint32_t)d_max(1, floor(h * scale + 0.5));
}

/* How much of [i, i + 1) lies in [lo, hi). */
static float overlap(uint32_t i, double lo, double hi)
{
    return (float)(d_min(hi, i + 1.0) - d_max(lo, i));
}

static Rgb shown(const Tone *t, uint32_t x, uint32_t y)
{
    Rgb c = tone_pixel(t, (size_t)y * t->im->w + x);
    return rgb(clamp01(c.r), clamp01(c.g), clamp01(c.b));
}

/* The mean over [box[0], box[2]) x [box[1], box[3]) of the picture's plane. */
static Rgb mean_of(const Tone *t, const double box[4])
{
    uint32_t x0 = (uint32_t)box[0], y0 = (uint32_t)box[1];
    uint32_t x1 = (uint32_t)d_min(ceil(box[2]), t->im->w);
    uint32_t y1 = (uint32_t)d_min(ceil(box[3]), t->im->h);
    Rgb sum = rgb_all(0.0f);
    float area = 0.0f;

    for (uint32_t y = y0; y < y1; y++)
        for (uint32_t x = x0; x < x1; x++) {
            float a = overlap(x, box[0], box[2]) * overlap(y, box[1], box[3]);
            sum = rgb_add(sum, rgb_scale(shown(t, x, y), a));
            area += a;
        }
    return rgb_scale(sum, 1.0f / area);
}

bool halfblocks_shrink(const Image *im, const Display *display, Image *small)
{
    double sx = (double)im->w / small->w, sy = (double)im->h / small->h;
    Tone t;

    if (!tone_init(&t, display, im))
        return false;
    for (uint32_t y = 0; y < small->h; y++)
        for (uint32_t x = 0; x < small->w; x++) {
            double box[4] = { x * sx, y * sy, (x + 1) * sx, (y + 1) * sy };
            *image_at(small, x, y) = mean_of(&t, box);
        }
    tone_clear(&t);
    return true;
}

/* ---- colours ---- */

static void bytes_of(Rgb c, unsigned char b[3])
{
    b[0] = (unsigned char)(srgb_encode(c.r) * 255.0f + 0.5f);
    b[1] = (unsigned char)(srgb_encode(c.g) * 255.0f + 0.5f);
    b[2] = (unsigned char)(srgb_encode(c.b) * 255.0f + 0.5f);
}

static int squared_distance(const unsigned char a[3], const unsigned char b[3])
{
    int d = 0;
    for (int k = 0; k < 3; k++)
        d += (a[k] - b[k]) * (a[k] - b[k]);
    return d;
}

/* Levels of the cube are 0, 95, 135, 175, 215, 255; greys are 8, 18, ... 238. */
int colour_of_256(const unsigned char c[3])
{
    unsigned char cube[3], grey[3];
    int index = 0, mean = (c[0] + c[1] + c[2]) / 3;
    int g = mean < 8 ? 0 : mean > 238 ? 23 : (mean - 8 + 5) / 10;

    for (int k = 0; k < 3; k++) {
        int level = c[k] < 48 ? 0 : c[k] < 115 ? 1 : (c[k] - 35) / 40;
        cube[k] = (unsigned char)(level ? 55 + 40 * level : 0);
        index = 6 * index + level;
        grey[k] = (unsigned char)(8 + 10 * g);
    }
    return squared_distance(c, grey) < squared_distance(c, cube) ? 232 + g : 16 + index;
}

/* ---- text ---- */

/* ground: of the cell, else its ink. */
static char *put_colour(char *at, Rgb c, bool ground, bool true_colour)
{
    unsigned char b[3];

    bytes_of(c, b);
    return at + (true_colour
                     ? sprintf(at, "\033[%d8;2;%d;%d;%dm", ground ? 4 : 3, b[0], b[1], b[2])
                     : sprintf(at, "\033[%d8;5;%dm", ground ? 4 : 3, colour_of_256(b)));
}

static char *put_cell(char *at, const Image *small, uint32_t x, uint32_t y, bool true_colour)
{
    at = put_colour(at, *image_at(small, x, y), false, true_colour);
    if (y + 1 < small->h)
        at = put_colour(at, *image_at(small, x, y + 1), true, true_colour);
    else
        at += sprintf(at, "\033[49m");
    return at + sprintf(at, "\xe2\x96\x80");                /* U+2580, the upper half block */
}

/* A line is wiped behind the picture only: at the last column that would take its last cell. */
size_t halfblocks_text(const Image *small, int columns, int rows, bool true_colour, char *text)
{
    char *at = text;

    for (uint32_t y = 0; y < small->h; y += 2) {
        at += sprintf(at, "\033[%lu;1H", (unsigned long)y / 2 + 1);
        for (uint32_t x = 0; x < small->w; x++)
            at = put_cell(at, small, x, y, true_colour);
        at += sprintf(at, "\033[0m%s", small->w < (uint32_t)columns ? "\033[K" : "");
    }
    if (small->h / 2 + small->h % 2 < (uint32_t)rows)
        at += sprintf(at, "\033[%lu;1H\033[J", (unsigned long)(small->h / 2 + small->h % 2 + 1));
    at += sprintf(at, "\033[%d;1H", rows);
    return (size_t)(at - text);
}
