/* plot.c -- see plot.h. Numbers are written without the locale. Ticks stand at 1, 2, 5 times powers
 * of ten where an axis has less than two decades, else at the powers themselves; the finer ones,
 * 2 to 9 times, have no label. Colours are those that people with any kind of sight tell apart
 * (Okabe and Ito); curves that come after all of them have dashes too, and every one has a mark. */
#include "render/plot.h"

#include "base/file.h"
#include "base/maths.h"
#include "base/number.h"

#include <stdio.h>
#include <string.h>

enum { PANEL_W = 520, PANEL_H = 400, LEFT = 78, RIGHT = 18, TOP = 44, BOTTOM = 58, ROW = 22,
       COLOURS = 7, MARKS = 4 };

static const char *const colours[COLOURS] = { "#0072b2", "#d55e00", "#009e73", "#cc79a7",
                                              "#56b4e9", "#e69f00", "#000000" };

/* ---- text ---- */

static void number(Out *o, double v)
{
    char text[NUMBER_MAX];
    number_print_fixed(text, v, 2);
    out_text(o, text);
}

/* " name='v'" */
static void attribute(Out *o, const char *name, double v)
{
    out_text(o, " ");
    out_text(o, name);
    out_text(o, "=\"");
    number(o, v);
    out_text(o, "\"");
}

/* Length of the UTF-8 sequence at s that XML allows, or 0. */
static int utf8_length(const unsigned char *s)
{
    int n = s[0] < 0x80 ? 1 : s[0] >= 0xC2 && s[0] < 0xE0 ? 2 : s[0] >= 0xE0 && s[0] < 0xF0 ? 3
            : s[0] >= 0xF0 && s[0] < 0xF5 ? 4 : 0;

    for (int i = 1; i < n; i++)
        if ((s[i] & 0xC0) != 0x80)
            return 0;
    if ((n == 1 && s[0] < 32) || s[0] == 127 || (s[0] == 0xE0 && s[1] < 0xA0) ||
        (s[0] == 0xED && s[1] > 0x9F) || (s[0] == 0xEF && s[1] == 0xBF && s[2] > 0xBD) ||
        (s[0] == 0xF0 && s[1] < 0x90) || (s[0] == 0xF4 && s[1] > 0x8F))
        return 0;
    return n;
}

/* What would be markup, or no text at all, is written so that it is none. */
static void escaped(Out *o, const char *s)
{
    while (*s) {
        int n = utf8_length((const unsigned char *)s);
        if (*s == '<')
            out_text(o, "&lt;");
        else if (*s == '>')
            out_text(o, "&gt;");
        else if (*s == '&')
            out_text(o, "&amp;");
        else if (n)
            out_write(o, s, (size_t)n);
        else
            out_text(o, "?");
        s += n ? n : 1;
    }
}

static void text_at(Out *o, double x, double y, const char *more, const char *s)
{
    out_text(o, "<text");
    attribute(o, "x", x);
    attribute(o, "y", y);
    out_text(o, more);
    out_text(o, ">");
    escaped(o, s);
    out_text(o, "</text>\n");
}

static void line_at(Out *o, double x0, double y0, double x1, double y1, const char *more)
{
    out_text(o, "<line");
    attribute(o, "x1", x0);
    attribute(o, "y1", y0);
    attribute(o, "x2", x1);
    attribute(o, "y2", y1);
    out_text(o, more);
    out_text(o, "/>\n");
}

/* ---- axes ---- */

typedef struct { double lo, hi; } Range;        /* of log10 */
typedef struct { Range x, y; double left; } Frame;

static double log10_of(double v) { return md_log(v) / md_log(10); }
static bool drawable(double v) { return v > 0 && v < INFINITY; }

static void widen(Range *r, double v)
{
    r->lo = d_min(r->lo, log10_of(v));
    r->hi = d_max(r->hi, log10_of(v));
}

/* With a margin, and never less than a third of a decade. */
static void settle(Range *r)
{
    double margin;
    if (!(r->lo <= r->hi))
        *r = (Range){ 0, 1 };
    margin = d_max(0.05 * (r->hi - r->lo), 0.5 * (0.35 - (r->hi - r->lo)));
    r->lo -= margin;
    r->hi += margin;
}

static Frame frame_of(const PlotPanel *p, double left)
{
    Frame f = { { INFINITY, -INFINITY }, { INFINITY, -INFINITY }, 0 };

    f.left = left;
    for (int k = 0; k < p->ncurves; k++)
        for (int i = 0; i < p->curves[k].n; i++)
            if (drawable(p->curves[k].x[i]) && drawable(p->curves[k].y[i])) {
                widen(&f.x, p->curves[k].x[i]);
                widen(&f.y, p->curves[k].y[i]);
            }
    settle(&f.x);
    settle(&f.y);
    return f;
}

static double place_x(const Frame *f, double log_x)
{
    return f->left + LEFT + (PANEL_W - LEFT - RIGHT) * (log_x - f->x.lo) / (f->x.hi - f->x.lo);
}

static double place_y(const Frame *f, double log_y)
{
    return PANEL_H - BOTTOM - (PANEL_H - TOP - BOTTOM) * (log_y - f->y.lo) / (f->y.hi - f->y.lo);
}

/* Which of 1 .. 9 times a power of ten have labels: as many as there is room for. */
static bool has_label(const Range *r, int digit, int power)
{
    double decades = r->hi - r->lo;
    int every = decades > 16 ? (int)(decades / 8) : decades > 8 ? 2 : 1;

    if (digit == 1)
        return power % every == 0;
    return decades < 2.2 && (digit == 2 || digit == 5);
}

static void tick(Out *o, const Frame *f, bool across, double v, const char *label)
{
    const char *line = label ? " stroke=\"#dddddd\"" : " stroke=\"#f2f2f2\"";
    double at = across ? place_x(f, v) : place_y(f, v);
    double left = f->left + LEFT, right = f->left + PANEL_W - RIGHT;

    if (across)
        line_at(o, at, TOP, at, PANEL_H - BOTTOM, line);
    else
        line_at(o, left, at, right, at, line);
    if (label && across)
        text_at(o, at, PANEL_H - BOTTOM + 18, " text-anchor=\"middle\"", label);
    else if (label)
        text_at(o, left - 8, at + 4, " text-anchor=\"end\"", label);
}

static void ticks(Out *o, const Frame *f, bool across)
{
    const Range *r = across ? &f->x : &f->y;

    for (int labels = 0; labels < 2; labels++)          /* lines with labels go above the others */
        for (int power = (int)floor(r->lo); power <= (int)ceil(r->hi); power++)
            for (int digit = 1; digit < 10; digit++) {
                double v = power + log10_of(digit);
                char text[NUMBER_MAX];
                if (v < r->lo || v > r->hi || has_label(r, digit, power) != (labels == 1) ||
                    (digit > 1 && r->hi - r->lo > 6))
                    continue;
                snprintf(text, sizeof text, "%de%d", digit, power);
                if (power >= -4 && power <= 6) {
                    double plain = digit;
                    number_double(text, text + strlen(text), &plain);
                    number_print_double(text, plain);
                }
                tick(o, f, across, v, labels ? text : NULL);
            }
}

static void axes(Out *o, const Frame *f, const PlotPanel *p)
{
    double left = f->left + LEFT, middle = 0.5 * (TOP + PANEL_H - BOTTOM);
    char turn[140], x[NUMBER_MAX], y[NUMBER_MAX];

    ticks(o, f, true);
    ticks(o, f, false);
    out_text(o, "<rect fill=\"none\" stroke=\"#444444\"");
    attribute(o, "x", left);
    attribute(o, "y", TOP);
    attribute(o, "width", PANEL_W - LEFT - RIGHT);
    attribute(o, "height", PANEL_H - TOP - BOTTOM);
    out_text(o, "/>\n");
    text_at(o, left + 0.5 * (PANEL_W - LEFT - RIGHT), PANEL_H - BOTTOM + 40,
            " text-anchor=\"middle\"", p->x_label);
    number_print_fixed(x, f->left + 20, 2);
    number_print_fixed(y, middle, 2);
    snprintf(turn, sizeof turn, " text-anchor=\"middle\" transform=\"rotate(-90 %s %s)\"", x, y);
    text_at(o, f->left + 20, middle, turn, p->y_label);
}

/* ---- curves ---- */

static void mark(Out *o, double x, double y, int k)
{
    static const double shapes[MARKS - 1][4][2] = {
        { { -4, -4 }, { 4, -4 }, { 4, 4 }, { -4, 4 } },
        { { 0, -5 }, { 5, 4 }, { -5, 4 }, { 0, -5 } },
        { { 0, -5.5 }, { 5.5, 0 }, { 0, 5.5 }, { -5.5, 0 } }
    };
    int shape = k % MARKS;

    out_text(o, shape ? "<polygon points=\"" : "<circle r=\"4\"");
    for (int i = 0; shape && i < 4; i++) {
        out_text(o, i ? " " : "");
        number(o, x + shapes[shape - 1][i][0]);
        out_text(o, ",");
        number(o, y + shapes[shape - 1][i][1]);
    }
    if (shape)
        out_text(o, "\"");
    else {
        attribute(o, "cx", x);
        attribute(o, "cy", y);
    }
    out_text(o, " fill=\"");
    out_text(o, colours[k % COLOURS]);
    out_text(o, "\"/>\n");
}

static void stroke(Out *o, int k)
{
    out_text(o, " fill=\"none\" stroke-width=\"2\" stroke=\"");
    out_text(o, colours[k % COLOURS]);
    out_text(o, k < COLOURS ? "\"/>\n" : "\" stroke-dasharray=\"6 3\"/>\n");
}

static void curve(Out *o, const Frame *f, const PlotCurve *c, int k)
{
    bool any = false;

    for (int marks = 0; marks < 2; marks++) {
        for (int i = 0; i < c->n; i++) {
            double x, y;
            if (!drawable(c->x[i]) || !drawable(c->y[i]))
                continue;
            x = place_x(f, log10_of(c->x[i]));
            y = place_y(f, log10_of(c->y[i]));
            if (marks) {
                mark(o, x, y, k);
                continue;
            }
            out_text(o, any ? " " : "<polyline points=\"");
            number(o, x);
            out_text(o, ",");
            number(o, y);
            any = true;
        }
        if (!marks && any) {
            out_text(o, "\"");
            stroke(o, k);
        }
    }
}

/* A dashed line of the slope, through the middle of what is drawn, from frame to frame. */
static void guide(Out *o, const Frame *f, const PlotPanel *p)
{
    double mx = 0.5 * (f->x.lo + f->x.hi), my = 0.5 * (f->y.lo + f->y.hi);
    double reach_x = mx - f->x.lo, reach_y = (f->y.hi - my) / fabs(p->guide);
    double d = d_min(reach_x, reach_y);

    line_at(o, place_x(f, mx - d), place_y(f, my - d * p->guide), place_x(f, mx + d),
            place_y(f, my + d * p->guide), " stroke=\"#888888\" stroke-dasharray=\"2 4\"");
    text_at(o, place_x(f, mx + 0.93 * d), place_y(f, my + 0.93 * d * p->guide) + 18,
            " text-anchor=\"end\" fill=\"#888888\"", p->guide_label);
}

static void panel(Out *o, const PlotPanel *p, double left)
{
    Frame f = frame_of(p, left);

    axes(o, &f, p);
    if (p->guide != 0)
        guide(o, &f, p);
    for (int k = 0; k < p->ncurves; k++)
        curve(o, &f, &p->curves[k], k);
}

static void legend(Out *o, const PlotPanel *p)
{
    for (int k = 0; k < p->ncurves; k++) {
        double y = PANEL_H + ROW * (k + 0.5);
        out_text(o, "<line");
        attribute(o, "x1", LEFT);
        attribute(o, "y1", y);
        attribute(o, "x2", LEFT + 32);
        attribute(o, "y2", y);
        stroke(o, k);
        mark(o, LEFT + 16, y, k);
        out_text(o, "<text");
        attribute(o, "x", LEFT + 42);
        attribute(o, "y", y + 4);
        out_text(o, ">");
        escaped(o, p->curves[k].label);
        if (p->curves[k].note) {
            out_text(o, "<tspan dx=\"14\" fill=\"#666666\">");
            escaped(o, p->curves[k].note);
            out_text(o, "</tspan>");
        }
        out_text(o, "</text>\n");
    }
}

/* The beginning of a file, on white. */
static Out *svg_open(const char *path, double w, double h)
{
    Out *o = out_open(path);

    if (!o)
        return NULL;
    out_text(o, "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n"
                "<svg xmlns=\"http://www.w3.org/2000/svg\"");
    attribute(o, "width", w);
    attribute(o, "height", h);
    out_text(o, " font-family=\"Helvetica, Arial, sans-serif\" font-size=\"13\">\n"
                "<rect width=\"100%\" height=\"100%\" fill=\"#ffffff\"/>\n");
    return o;
}

static bool svg_close(Out *o)
{
    out_text(o, "</svg>\n");
    return out_close(o);
}

bool plot_write(const char *path, const char *title, const PlotPanel *panels, int npanels)
{
    double w = npanels * PANEL_W, h = PANEL_H + ROW * (panels[0].ncurves + 1);
    Out *o = svg_open(path, w, h);

    if (!o)
        return false;
    text_at(o, LEFT, 26, " font-size=\"15\" font-weight=\"bold\"", title);
    for (int i = 0; i < npanels; i++)
        panel(o, &panels[i], i * PANEL_W);
    legend(o, &panels[0]);
    return svg_close(o);
}

/* ---- sets of points ---- */

enum { SQUARE = 200, GAP = 30 };

static void square(Out *o, const PlotPoints *p, double left, double top)
{
    text_at(o, left, top - 8, " font-size=\"11\"", p->title);
    for (int i = 0; i <= p->columns; i++) {
        double x = left + (double)i * SQUARE / p->columns;
        line_at(o, x, top, x, top + SQUARE, i % p->columns ? " stroke=\"#dddddd\""
                                                           : " stroke=\"#444444\"");
    }
    for (int i = 0; i <= p->rows; i++) {
        double y = top + (double)i * SQUARE / p->rows;
        line_at(o, left, y, left + SQUARE, y, i % p->rows ? " stroke=\"#dddddd\""
                                                          : " stroke=\"#444444\"");
    }
    for (int i = 0; i < p->n; i++) {
        out_text(o, "<circle r=\"2.5\"");
        attribute(o, "cx", left + SQUARE * (double)p->xy[2 * i]);
        attribute(o, "cy", top + SQUARE * (1 - (double)p->xy[2 * i + 1]));
        out_text(o, "/>\n");
    }
}

bool plot_write_points(const char *path, const PlotPoints *sets, int nsets, int across)
{
    int pitch = SQUARE + GAP, down = (nsets + across - 1) / across;
    Out *o = svg_open(path, GAP + across * pitch, GAP + down * (pitch + 10));

    if (!o)
        return false;
    for (int k = 0; k < nsets; k++)
        square(o, &sets[k], GAP + k % across * pitch, GAP + k / across * (pitch + 10));
    return svg_close(o);
}
