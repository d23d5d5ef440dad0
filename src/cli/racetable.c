/* racetable.c -- see racetable.h. The table has a row for each checkpoint, then one for each
 * method: its slope, and how long it takes to the error that the first method ends with. */
#include "cli/racetable.h"

#include "base/file.h"
#include "base/number.h"
#include "render/plot.h"

#include <stdio.h>
#include <string.h>

enum { NAME_LEAST = 6, NAME_MOST = 36, TEXT = 160 };

static double ratio(const Race *race, const RacePoint *p)
{
    return race->mean != 0 ? p->mean / race->mean : INFINITY;
}

/* ---- for people ---- */

/* What continues a letter of UTF-8 takes no column of its own. */
static int columns(const char *s)
{
    int n = 0;
    for (; *s; s++)
        n += ((unsigned char)*s & 0xC0) != 0x80;
    return n;
}

static int name_width(const Race *race)
{
    int width = NAME_LEAST;
    for (int i = 0; i < race->n; i++) {
        int n = columns(race->result[i].label);
        width = n > width ? n < NAME_MOST ? n : NAME_MOST : width;
    }
    return width;
}

/* A name that is too long gets a line of its own. Control characters must not reach a terminal. */
static void print_name(const char *name, int width)
{
    int n = columns(name);

    for (; *name; name++)
        putchar((unsigned char)*name < 32 || *name == 127 ? '?' : *name);
    if (n > width)
        printf("\n%*s", width, "");
    else
        printf("%*s", width - n, "");
}

/* Digits after the point that leave three to the least of the figures. */
static int digits_of(const Race *race, bool relmse)
{
    double least = INFINITY;
    int digits = 2;

    for (int i = 0; i < race->n; i++)
        for (int k = 0; k < race->result[i].n; k++) {
            const RacePoint *p = &race->result[i].point[k];
            double v = relmse ? p->relmse : p->sigma_over_mu;
            if (v > 0 && v < INFINITY)
                least = d_min(least, v);
        }
    for (; least < 1 && digits < 9; least *= 10)
        digits++;
    return digits;
}

static void print_figure(int width, int digits, double v)
{
    char text[NUMBER_MAX];

    if (v - v != 0)
        printf("%*s", width, "-");
    else {
        number_print_fixed(text, v, digits);
        printf("%*s", width, text);
    }
}

static void print_head(const RaceOrder *o, const Race *race)
{
    printf("%s, %lu x %lu pixels, seed %.0f, %d thread%s\n", o->scene, (unsigned long)race->w,
           (unsigned long)race->h, (double)race->seed, race->threads, race->threads > 1 ? "s" : "");
    if (race->reference == REFERENCE_PAIR)
        printf("error of one of two renders, from their difference; mean: of the first method's "
               "last\n");
    else if (race->noise_known)
        printf("error against %s; its own noise, sigma/mu %.3g, is taken off; mean: of its mean\n",
               o->reference_file[0] ? "the mean of two references" : "a rendered reference",
               race->noise_over_mu);
    else
        printf("error against %s, whose own noise is not known and adds to it; mean: of its mean\n",
               o->reference_file[0]);
}

static bool print_checkpoints(const Race *race, int width)
{
    int error = digits_of(race, false), relmse = digits_of(race, true);
    bool doubtful = false, relative = race->reference != REFERENCE_PAIR;

    printf("\n%-*s%10s%11s%11s%13s%*s%9s\n", width, "method", "spp", "seconds", "CPU s",
           "sigma/mu", relative ? 14 : 0, relative ? "relMSE" : "", "mean");
    for (int i = 0; i < race->n; i++) {
        const RaceResult *r = &race->result[i];
        for (int k = 0; k < r->n; k++) {
            const RacePoint *p = &r->point[k];
            print_name(k ? "" : r->label, width);
            print_figure(10, p->spp == floor(p->spp) ? 0 : 1, p->spp);
            print_figure(11, 3, p->seconds);
            print_figure(11, 3, p->cpu_seconds);
            print_figure(12, error, p->sigma_over_mu);
            printf("%c", p->doubtful ? '*' : ' ');
            if (relative)
                print_figure(14, relmse, p->relmse);
            print_figure(9, 4, ratio(race, p));
            printf("\n");
            doubtful = doubtful || p->doubtful;
        }
    }
    return doubtful;
}

static void print_reach(const Race *race, const RaceResult *r)
{
    const char *sign = r->reach_is < 0 ? "<" : r->reach_is > 0 ? ">" : "";
    const RaceResult *first = &race->result[0];
    char text[NUMBER_MAX] = "-", of_first[NUMBER_MAX] = "-";

    if (r->reach > 0) {
        snprintf(text, sizeof text, "%s%.3f", sign, r->reach);
        if (first->reach > 0)
            snprintf(of_first, sizeof of_first, "%s%.2f", sign, r->reach / first->reach);
    }
    printf("%14s%10s\n", text, of_first);
}

static void print_methods(const Race *race, int width)
{
    char head[40];

    snprintf(head, sizeof head, "CPU s to %.3g", race->goal);
    printf("\n%-*s  %-14s%9s%20s%18s%10s\n", width, "method", "sampler", "slope",
           "95 % interval", head, "of first");
    for (int i = 0; i < race->n; i++) {
        const RaceResult *r = &race->result[i];
        char interval[TEXT] = "-";
        print_name(r->label, width);
        printf("  %-14.14s", r->sampler);
        print_figure(9, 3, r->fit.n > 1 ? r->fit.slope : INFINITY);
        if (r->fit.error < INFINITY)
            snprintf(interval, sizeof interval, "%.3f to %.3f", r->fit.lo, r->fit.hi);
        printf("%20s    ", interval);
        print_reach(race, r);
    }
}

void race_table_print(const RaceOrder *o, const Race *race)
{
    int width = name_width(race);

    if (!race->n)
        return;
    print_head(o, race);
    if (print_checkpoints(race, width))
        printf("* below the noise of the reference: doubtful, and left out of the slope\n");
    print_methods(race, width);
}

/* ---- CSV ---- */

/* In quotes where it must be. */
static void csv_text(Out *o, const char *s)
{
    bool quotes = strpbrk(s, ",\"\r\n") != NULL;

    if (quotes)
        out_text(o, "\"");
    for (; *s; s++)
        out_write(o, *s == '"' ? "\"\"" : s, *s == '"' ? 2 : 1);
    out_text(o, quotes ? "\"," : ",");
}

/* Empty where it is not known. */
static void csv_number(Out *o, bool known, double v, const char *after)
{
    char text[NUMBER_MAX] = "";
    if (known && v - v == 0)
        number_print_double(text, v);
    out_text(o, text);
    out_text(o, after);
}

static void csv_row(Out *out, const RaceOrder *o, const Race *race, int i, const RacePoint *p)
{
    const RaceResult *r = &race->result[i];

    csv_text(out, o->scene);
    csv_text(out, r->label);
    csv_text(out, r->sampler);
    csv_number(out, true, race->w, ",");
    csv_number(out, true, race->h, ",");
    csv_number(out, true, (double)race->seed, ",");
    csv_number(out, true, race->threads, ",");
    csv_text(out, race->reference == REFERENCE_PAIR ? "pair"
                  : race->reference == REFERENCE_AUTO ? "auto" : o->reference_file[0]);
    csv_number(out, race->noise_known, race->noise_over_mu, ",");
    csv_number(out, true, p->spp, ",");
    csv_number(out, true, p->seconds, ",");
    csv_number(out, true, p->cpu_seconds, ",");
    csv_number(out, true, p->sigma_over_mu, ",");
    csv_number(out, true, p->relmse, ",");
    csv_number(out, true, p->mean, ",");
    csv_number(out, true, ratio(race, p), ",");
    csv_number(out, true, p->doubtful, ",");
    csv_number(out, r->fit.n > 1, r->fit.slope, ",");
    csv_number(out, true, r->fit.lo, ",");
    csv_number(out, true, r->fit.hi, ",");
    csv_number(out, r->reach > 0 && !r->reach_is, r->reach, "\n");
}

bool race_csv_write(const RaceOrder *o, const Race *race, const char *path)
{
    Out *out = out_open(path);

    if (!out)
        return false;
    out_text(out, "scene,method,sampler,width,height,seed,threads,reference,"
                  "reference_sigma_over_mu,spp,seconds,cpu_seconds,sigma_over_mu,relmse,mean,"
                  "mean_ratio,doubtful,slope,slope_lo,slope_hi,cpu_seconds_to_goal\n");
    for (int i = 0; i < race->n; i++)
        for (int k = 0; k < race->result[i].n; k++)
            csv_row(out, o, race, i, &race->result[i].point[k]);
    return out_close(out);
}

/* ---- the plot ---- */

/* What the curves borrow. */
typedef struct {
    double x[2][RACE_METHODS][RACE_LOOKS + 1], y[RACE_METHODS][RACE_LOOKS + 1];
    char   note[RACE_METHODS][TEXT];
    PlotCurve curve[2][RACE_METHODS];
} PlotRoom;

static void fill_curves(PlotRoom *room, const Race *race, int i)
{
    const RaceResult *r = &race->result[i];

    if (r->fit.error < INFINITY)
        snprintf(room->note[i], TEXT, "slope %.2f (%.2f to %.2f)", r->fit.slope, r->fit.lo,
                 r->fit.hi);
    for (int k = 0; k < r->n; k++) {
        room->x[0][i][k] = r->point[k].spp;
        room->x[1][i][k] = r->point[k].seconds;
        room->y[i][k] = r->point[k].sigma_over_mu;
    }
    for (int panel = 0; panel < 2; panel++)
        room->curve[panel][i] = (PlotCurve){ r->label, room->note[i], room->x[panel][i],
                                             room->y[i], r->n };
}

bool race_plot_write(const RaceOrder *o, const Race *race, const char *path)
{
    PlotRoom *room = MEM_NEW(PlotRoom);
    PlotPanel panels[2];
    char title[TEXT];
    bool ok;

    if (!room)
        return false;
    for (int i = 0; i < race->n; i++)
        fill_curves(room, race, i);
    panels[0] = (PlotPanel){ "samples a pixel", "error, sigma/mu", room->curve[0], race->n, -0.5,
                             "slope -1/2" };
    panels[1] = (PlotPanel){ "seconds", "error, sigma/mu", room->curve[1], race->n, -0.5,
                             "slope -1/2" };
    snprintf(title, sizeof title, "%.100s, %lu x %lu pixels, %d thread%s", o->scene,
             (unsigned long)race->w, (unsigned long)race->h, race->threads,
             race->threads > 1 ? "s" : "");
    ok = plot_write(path, title, panels, 2);
    mem_free(room);
    return ok;
}
