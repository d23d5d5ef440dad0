/* error.c -- messages, exit classes, nearest names. See error.h. */
#include "base/error.h"

#include <limits.h>
#include <pthread.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static struct {
    pthread_mutex_t lock;
    Status   status;
    unsigned warnings;
    bool     strict, quiet, said_memory;
} report = { PTHREAD_MUTEX_INITIALIZER, STATUS_OK, 0, false, false, false };

static struct {
    pthread_mutex_t lock;
    void (*take)(void *ctx, const char *line);
    void *ctx;
} listener = { PTHREAD_MUTEX_INITIALIZER, NULL, NULL };

static void put_line(const char *line)
{
    pthread_mutex_lock(&listener.lock);
    if (listener.take)
        listener.take(listener.ctx, line);
    else
        fprintf(stderr, "%s\n", line);
    pthread_mutex_unlock(&listener.lock);
}

void messages_to(void (*take)(void *ctx, const char *line), void *ctx)
{
    pthread_mutex_lock(&listener.lock);
    listener.take = take;
    listener.ctx = ctx;
    pthread_mutex_unlock(&listener.lock);
}

/* Control characters of hostile names and files must not reach the terminal, and a message is one
 * line whatever stands in it. Bytes above 127 pass: they are the user's UTF-8. */
static void make_printable(char *s)
{
    for (; *s; s++)
        if ((unsigned char)*s < 32 || *s == 127)
            *s = '?';
}

/* Formats the whole line first and writes it once, so that lines of two threads do not mix. */
static void say(Place at, const char *kind, const char *fmt, va_list args)
{
    char line[1400], text[900], where[360] = "";

    if (at.file && !at.file[0])
        at.file = "''";
    vsnprintf(text, sizeof text, fmt, args);
    if (at.file && at.line > 0 && at.column > 0)
        snprintf(where, sizeof where, "%.320s:%d:%d: ", at.file, at.line, at.column);
    else if (at.file && at.line > 0)
        snprintf(where, sizeof where, "%.320s:%d: ", at.file, at.line);
    else if (at.file)
        snprintf(where, sizeof where, "%.320s: ", at.file);
    snprintf(line, sizeof line, "rushlight: %s%s%s", where, kind, text);
    make_printable(line);
    put_line(line);
}

static void raise_status(Status s)
{
    pthread_mutex_lock(&report.lock);
    if (report.status == STATUS_OK)
        report.status = s;
    pthread_mutex_unlock(&report.lock);
}

bool err_at(Place at, const char *fmt, ...)
{
    va_list args;
    va_start(args, fmt);
    say(at, "", fmt, args);
    va_end(args);
    raise_status(STATUS_INPUT);
    return false;
}

bool err_usage(const char *fmt, ...)
{
    va_list args;
    va_start(args, fmt);
    say((Place){ NULL, 0, 0 }, "", fmt, args);
    va_end(args);
    raise_status(STATUS_USAGE);
    return false;
}

bool err_output(const char *file, const char *fmt, ...)
{
    va_list args;
    va_start(args, fmt);
    say((Place){ file, 0, 0 }, "", fmt, args);
    va_end(args);
    raise_status(STATUS_OUTPUT);
    return false;
}

bool err_memory(size_t bytes)
{
    char line[100];
    bool first;

    pthread_mutex_lock(&report.lock);
    first = !report.said_memory;
    report.said_memory = true;
    pthread_mutex_unlock(&report.lock);
    snprintf(line, sizeof line, "rushlight: out of memory: %lu bytes were asked for",
             (unsigned long)bytes);
    if (first)
        put_line(line);
    raise_status(STATUS_OUTPUT);
    return false;
}

bool warn_at(Place at, const char *fmt, ...)
{
    bool strict;
    va_list args;

    pthread_mutex_lock(&report.lock);
    strict = report.strict;
    report.warnings++;
    pthread_mutex_unlock(&report.lock);
    va_start(args, fmt);
    say(at, strict ? "" : "warning: ", fmt, args);
    va_end(args);
    if (strict)
        raise_status(STATUS_INPUT);
    return !strict;
}

void note(const char *fmt, ...)
{
    va_list args;
    if (messages_are_quiet())
        return;
    va_start(args, fmt);
    say((Place){ NULL, 0, 0 }, "", fmt, args);
    va_end(args);
}

void warnings_fatal(bool on)
{
    pthread_mutex_lock(&report.lock);
    report.strict = on;
    pthread_mutex_unlock(&report.lock);
}

void messages_quiet(bool on)
{
    pthread_mutex_lock(&report.lock);
    report.quiet = on;
    pthread_mutex_unlock(&report.lock);
}

bool messages_are_quiet(void)
{
    bool q;
    pthread_mutex_lock(&report.lock);
    q = report.quiet;
    pthread_mutex_unlock(&report.lock);
    return q;
}

unsigned warnings_count(void)
{
    unsigned n;
    pthread_mutex_lock(&report.lock);
    n = report.warnings;
    pthread_mutex_unlock(&report.lock);
    return n;
}

Status err_status(void)
{
    Status s;
    pthread_mutex_lock(&report.lock);
    s = report.status;
    pthread_mutex_unlock(&report.lock);
    return s;
}

void err_forgive(void)
{
    pthread_mutex_lock(&report.lock);
    report.status = STATUS_OK;
    pthread_mutex_unlock(&report.lock);
}

void err_reset(void)
{
    pthread_mutex_lock(&report.lock);
    report.status = STATUS_OK;
    report.warnings = 0;
    report.strict = report.quiet = report.said_memory = false;
    pthread_mutex_unlock(&report.lock);
}

void err_bug(const char *file, int line, const char *what)
{
    fprintf(stderr, "rushlight: bug at %s:%d: %s\n", file, line, what);
    abort();
}

static int lower(int c) { return c >= 'A' && c <= 'Z' ? c + ('a' - 'A') : c; }

/* Edit distance with swaps of neighbours (optimal string alignment), of words below 64 bytes. */
static int edit_distance(const char *a, const char *b)
{
    enum { MAX = 64 };
    int row[3][MAX + 1], la = (int)strlen(a), lb = (int)strlen(b);

    if (la > MAX || lb > MAX)
        return INT_MAX;
    for (int j = 0; j <= lb; j++)
        row[0][j] = j;
    for (int i = 1; i <= la; i++) {
        int *now = row[i % 3], *up = row[(i + 2) % 3], *up2 = row[(i + 1) % 3];
        now[0] = i;
        for (int j = 1; j <= lb; j++) {
            int same = lower(a[i - 1]) == lower(b[j - 1]);
            int best = up[j - 1] + !same;
            if (up[j] + 1 < best)
                best = up[j] + 1;
            if (now[j - 1] + 1 < best)
                best = now[j - 1] + 1;
            if (i > 1 && j > 1 && lower(a[i - 1]) == lower(b[j - 2]) &&
                lower(a[i - 2]) == lower(b[j - 1]) && up2[j - 2] + 1 < best)
                best = up2[j - 2] + 1;
            now[j] = best;
        }
    }
    return row[la % 3][lb];
}

const char *nearest_name(const char *word, const char *const *names, size_t n)
{
    const char *best = NULL;
    int least = (int)strlen(word) / 2 + 1;       /* farther than that is no help */

    for (size_t i = 0; i < n; i++) {
        int d = edit_distance(word, names[i]);
        if (d < least) {
            least = d;
            best = names[i];
        }
    }
    return best;
}

const char *hint_nearest(char hint[HINT_MAX], const char *word, const char *const *names, size_t n)
{
    const char *near = nearest_name(word, names, n);

    hint[0] = 0;
    if (near)
        snprintf(hint, HINT_MAX, ", did you mean '%.100s'?", near);
    return hint;
}
