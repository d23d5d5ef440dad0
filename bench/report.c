/* report.c -- see report.h. Tables stand as they were printed; PNG pictures are packed into the
 * page by base 64, SVG pictures are a part of it. */
#include "bench/report.h"

#include "base/error.h"
#include "base/file.h"

#include <stdio.h>
#include <string.h>
#include <unistd.h>

enum { PICTURES = 32, PATH = 200 };

static Out *page;
static char pictures[PICTURES][PATH];
static int npictures;

static const char head[] =
    "<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\">"
    "<title>rushlight bench</title>\n<style>"
    "body{font:15px sans-serif;margin:2em auto;max-width:70em;padding:0 1em;"
    "color:#222;background:#fff}pre{font:12px monospace;overflow-x:auto;background:#f4f4f4;"
    "padding:1em}img,svg{max-width:100%;height:auto}</style></head><body>\n"
    "<h1>rushlight bench</h1>\n";

/* Text as text: what HTML would take for its own is written by name. */
static void put_text(const char *s, size_t n)
{
    for (size_t i = 0; i < n; i++)
        switch (s[i]) {
        case '<': out_text(page, "&lt;"); break;
        case '>': out_text(page, "&gt;"); break;
        case '&': out_text(page, "&amp;"); break;
        default:  out_write(page, &s[i], 1);
        }
}

static void put_base64(const unsigned char *b, size_t n)
{
    static const char digits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";

    for (size_t i = 0; i < n; i += 3) {
        unsigned v = (unsigned)b[i] << 16 | (i + 1 < n ? (unsigned)b[i + 1] << 8 : 0) |
                     (i + 2 < n ? b[i + 2] : 0);
        char four[4] = { digits[v >> 18], digits[v >> 12 & 63],
                         i + 1 < n ? digits[v >> 6 & 63] : '=', i + 2 < n ? digits[v & 63] : '=' };
        out_write(page, four, 4);
    }
}

static void put_picture(const char *path)
{
    FileBytes f;
    const char *svg;

    if (!file_read(path, FILE_LIMIT_DEFAULT, &f))
        return;
    svg = strstr(f.bytes, "<svg");              /* what stands before it is not of a page */
    out_text(page, "<p>");
    if (!strcmp(path_extension(path), "svg") && svg)
        out_text(page, svg);
    else {
        out_text(page, "<img alt=\"\" src=\"data:image/png;base64,");
        put_base64((const unsigned char *)f.bytes, f.size);
        out_text(page, "\">");
    }
    out_text(page, "<br>");
    put_text(path, strlen(path));
    out_text(page, "</p>\n");
    file_clear(&f);
}

bool report_begin(const char *path)
{
    page = out_open(path);
    if (page)
        out_text(page, head);
    return page != NULL;
}

void report_picture(const char *path)
{
    if (page && npictures < PICTURES)
        snprintf(pictures[npictures++], PATH, "%s", path);
}

/* From the file that standard output went to: to the page, and out. */
static void pass_on(FILE *f)
{
    char line[1000];

    rewind(f);
    out_text(page, "<pre>");
    while (fgets(line, sizeof line, f)) {
        put_text(line, strlen(line));
        fputs(line, stdout);
    }
    out_text(page, "</pre>\n");
    fflush(stdout);
}

void report_section(const char *name, void (*run)(void))
{
    FILE *f = tmpfile();
    int out = dup(1);

    fflush(stdout);
    if (!f || out < 0 || dup2(fileno(f), 1) < 0) {
        err_output(name, "nothing can be caught of what it prints");
        return;
    }
    npictures = 0;
    run();
    fflush(stdout);
    dup2(out, 1);
    close(out);
    out_text(page, "<h2>");
    put_text(name, strlen(name));
    out_text(page, "</h2>\n");
    pass_on(f);
    fclose(f);
    for (int k = 0; k < npictures; k++)
        put_picture(pictures[k]);
}

bool report_end(void)
{
    Out *o = page;

    page = NULL;
    out_text(o, "</body></html>\n");
    return out_close(o);
}
