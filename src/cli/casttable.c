/* casttable.c -- what `cast` prints: small tables for people, with one row a structure, or CSV. */
#include "cli/casttable.h"

#include "base/number.h"

#include <stdio.h>
#include <string.h>

enum { NAME_LEAST = 9, NAME_MOST = 24, ACROSS = 5 };    /* ACROSS: ray sets beside each other */

/* ---- for people ---- */

static int name_width(const CastTable *t)
{
    int width = NAME_LEAST;
    for (int i = 0; i < t->nrows; i++) {
        int n = (int)strlen(t->configs[i].text);
        width = n > width && n <= NAME_MOST ? n : width;
    }
    return width;
}

/* A name that is too long gets a line of its own. */
static void print_name(const char *name, int width)
{
    if ((int)strlen(name) > width)
        printf("%s\n%*s", name, width, "");
    else
        printf("%-*s", width, name);
}

static void print_cell(int width, int digits, bool known, double v)
{
    if (known)
        printf("%*.*f", width, digits, v);
    else
        printf("%*s", width, "-");
}

/* The kind, with a number where several files have the same. */
static void print_label(const CastTable *t, int k, int width)
{
    char label[40];
    int same = 0;

    for (int i = 0; i < t->nsets; i++)
        same += !strcmp(t->sets[i].kind, t->sets[k].kind);
    if (same > 1)
        snprintf(label, sizeof label, "%.6s#%d", t->sets[k].kind, k + 1);
    else
        snprintf(label, sizeof label, "%.9s", t->sets[k].kind);
    printf("%*s", width, label);
}

static void print_sum(const RaySet *s, double sum, int width)
{
    char text[NUMBER_MAX];
    if (s->any)
        strcpy(text, "-");
    else
        snprintf(text, sizeof text, "%.9g", sum);
    printf("%*s", width, text);
}

static void print_rays(const CastTable *t)
{
    bool files = t->nsets && t->sets[0].file;

    printf("\n%-9s%11s%11s%18s", "rays", "number", "hits", "sum of distances");
    printf(files ? "%12s%18s\n" : "\n", "file: hits", "sum of distances");
    for (int k = 0; k < t->nsets; k++) {
        const RaySet *s = &t->sets[k];
        print_label(t, k, -9);
        printf("%11lu%11lu", (unsigned long)s->n, (unsigned long)s->hits);
        print_sum(s, s->sum_t, 18);
        if (files) {
            printf("%12.0f", (double)s->file_hits);
            print_sum(s, s->file_sum_t, 18);
        }
        printf("\n");
    }
}

/* Of the geometry beside which structure i stands. */
static size_t geometry_bytes(const CastTable *t, int i)
{
    return t->configs[i].regular ? t->scene->regular_bytes : t->scene->bytes;
}

static void print_builds(const CastTable *t, int width)
{
    double prims = (double)t->scene->prims;
    char all[24];

    snprintf(all, sizeof all, "%d thread%s", t->order->threads, t->order->threads > 1 ? "s" : "");
    printf("\n%*s%20s%11s%24s\n", width, "", "seconds to build", "", "bytes a triangle");
    printf("%-*s%10s%10s%11s%8s%8s%8s\n", width, "structure", "1 thread", all, "nodes", "alone",
           "in all", "peak");
    for (int i = 0; i < t->nrows; i++) {
        const CastRow *r = &t->rows[i];
        bool any = prims > 0;
        print_name(t->configs[i].text, width);
        printf("%10.4f%10.4f%11lu", r->build_one, r->build_all, (unsigned long)r->nodes);
        print_cell(8, 1, any, (double)r->bytes / prims);
        print_cell(8, 1, any, (double)(r->bytes + geometry_bytes(t, i)) / prims);
        print_cell(8, 1, any, (double)r->peak / prims);
        printf("\n");
    }
}

typedef enum { SINGLE, BATCH, TESTS } Figure;

static void print_figure(const CastTable *t, int row, int k, Figure what)
{
    const CastRow *r = &t->rows[row];
    double v = what == SINGLE ? r->sets[k].single : r->sets[k].batch;
    char both[40] = "-";

    if (what != TESTS) {
        print_cell(11, 2, v > 0, v);
        return;
    }
    if (t->sets[k].n)
        snprintf(both, sizeof both, "%.1f/%.1f", r->sets[k].nodes, r->sets[k].prims);
    printf("%11s", both);
}

/* One table a group of ray sets that fit beside each other. */
static void print_figures(const CastTable *t, int width, const char *title, Figure what)
{
    for (int first = 0; first < t->nsets; first += ACROSS) {
        int end = first + ACROSS < t->nsets ? first + ACROSS : t->nsets;
        printf("\n%s\n%-*s", title, width, "structure");
        for (int k = first; k < end; k++)
            print_label(t, k, 11);
        printf("\n");
        for (int i = 0; i < t->nrows; i++) {
            print_name(t->configs[i].text, width);
            for (int k = first; k < end; k++)
                print_figure(t, i, k, what);
            printf("\n");
        }
    }
}

void cast_table_print(const CastTable *t)
{
    int width = name_width(t);
    char title[100];

    printf("%s: %lu triangles, %lu vertices", t->scene->name, (unsigned long)t->scene->tris,
           (unsigned long)t->scene->verts);
    if (t->scene->prims > t->scene->tris)
        printf(", %lu other primitives, counted as triangles",
               (unsigned long)(t->scene->prims - t->scene->tris));
    printf("\n");
    print_rays(t);
    print_builds(t, width);
    if (t->order->runs) {
        print_figures(t, width, "million rays a second, one thread, one ray a call", SINGLE);
        snprintf(title, sizeof title, "million rays a second, one thread, %lu rays a call",
                 (unsigned long)t->order->batch);
        print_figures(t, width, title, BATCH);
    }
    print_figures(t, width, "box tests / primitive tests a ray", TESTS);
}

/* ---- CSV ---- */

void cast_csv_head(void)
{
    printf("mesh,triangles,vertices,structure,threads,build_s_one,build_s_all,nodes,depth,bytes,"
           "bytes_per_triangle,bytes_per_triangle_all,peak_bytes_per_triangle,rays,query,count,"
           "hits,sum_t,file_hits,file_sum_t,runs,batch,mrays_single,mrays_batch,boxes_per_ray,"
           "prims_per_ray\n");
}

/* In quotes where it must be. */
static void csv_text(const char *s)
{
    if (!strpbrk(s, ",\"\r\n")) {
        printf("%s,", s);
        return;
    }
    putchar('"');
    for (; *s; s++)
        printf(*s == '"' ? "\"\"" : "%c", *s);
    printf("\",");
}

/* Empty where it is not known. */
static void csv_number(bool known, double v, char after)
{
    char text[NUMBER_MAX] = "";
    if (known)
        number_print_double(text, v);
    printf("%s%c", text, after);
}

static void csv_structure(const CastTable *t, int i)
{
    const CastScene *c = t->scene;
    const CastRow *r = &t->rows[i];
    double prims = (double)c->prims;

    csv_text(c->name);
    printf("%lu,%lu,", (unsigned long)c->tris, (unsigned long)c->verts);
    csv_text(t->configs[i].text);
    printf("%d,", t->order->threads);
    csv_number(true, r->build_one, ',');
    csv_number(true, r->build_all, ',');
    printf("%lu,%d,%lu,", (unsigned long)r->nodes, r->depth, (unsigned long)r->bytes);
    csv_number(prims > 0, (double)r->bytes / prims, ',');
    csv_number(prims > 0, (double)(r->bytes + geometry_bytes(t, i)) / prims, ',');
    csv_number(prims > 0, (double)r->peak / prims, ',');
}

static void csv_rays(const CastTable *t, int i, int k)
{
    const RaySet *s = &t->sets[k];
    double single = t->rows[i].sets[k].single, batch = t->rows[i].sets[k].batch;

    csv_text(s->file ? s->file : s->kind);
    printf("%s,%lu,%lu,", s->any ? "any" : "nearest", (unsigned long)s->n, (unsigned long)s->hits);
    csv_number(true, s->sum_t, ',');
    csv_number(s->file != NULL, (double)s->file_hits, ',');
    csv_number(s->file != NULL, s->file_sum_t, ',');
    printf("%d,%lu,", t->order->runs, (unsigned long)t->order->batch);
    csv_number(single > 0, single, ',');
    csv_number(batch > 0, batch, ',');
    csv_number(s->n > 0, t->rows[i].sets[k].nodes, ',');
    csv_number(s->n > 0, t->rows[i].sets[k].prims, '\n');
}

void cast_csv_print(const CastTable *t)
{
    for (int i = 0; i < t->nrows; i++)
        for (int k = 0; k < t->nsets; k++) {
            csv_structure(t, i);
            csv_rays(t, i, k);
        }
}
