/* text.c -- a cursor over text. See text.h. */
#include "base/text.h"

#include "base/number.h"

#include <string.h>

void text_init(Text *t, const char *file, const char *bytes, size_t n)
{
    t->at = bytes;
    t->end = bytes + n;
    if (n >= 3 && !memcmp(bytes, "\xEF\xBB\xBF", 3))
        t->at += 3;
    t->line_start = t->at;
    t->file = file;
    t->line = 1;
}

Place text_place_of(const Text *t, const char *at)
{
    return (Place){ t->file, t->line, (int)(at - t->line_start) + 1 };
}

Place text_place(const Text *t) { return text_place_of(t, t->at); }

bool text_done(const Text *t) { return t->at >= t->end; }

int text_peek(const Text *t) { return t->at < t->end ? (unsigned char)*t->at : -1; }

/* Steps over one line end at t->at, if there is one. */
static void end_line(Text *t)
{
    if (t->at < t->end && *t->at == '\r')
        t->at++;
    if (t->at < t->end && *t->at == '\n' && (t->at == t->line_start || t->at[-1] != '\n'))
        t->at++;
    t->line++;
    t->line_start = t->at;
}

bool text_line(Text *t, Text *line)
{
    if (text_done(t))
        return false;
    *line = *t;
    line->line_start = t->at;
    while (t->at < t->end && *t->at != '\n' && *t->at != '\r')
        t->at++;
    line->end = t->at;
    if (t->at < t->end)
        end_line(t);
    return true;
}

static bool blank(char c) { return c == ' ' || c == '\t' || c == '\v' || c == '\f'; }
static bool white(char c) { return blank(c) || c == '\n' || c == '\r'; }

void text_blanks(Text *t)
{
    while (t->at < t->end && blank(*t->at))
        t->at++;
}

void text_space(Text *t)
{
    while (t->at < t->end && white(*t->at)) {
        if (*t->at == '\n' || *t->at == '\r')
            end_line(t);
        else
            t->at++;
    }
}

Word text_word(Text *t)
{
    Word w;
    text_blanks(t);
    w.s = t->at;
    while (t->at < t->end && !white(*t->at))
        t->at++;
    w.n = (size_t)(t->at - w.s);
    return w;
}

static bool ends_here(const Text *t, const char *p) { return p >= t->end || white(*p); }

bool text_float(Text *t, float *v)
{
    float x;
    size_t n;

    text_blanks(t);
    n = number_float(t->at, t->end, &x);
    if (!n || !ends_here(t, t->at + n))
        return false;
    t->at += n;
    *v = x;
    return true;
}

bool text_int(Text *t, int64_t *v)
{
    int64_t x;
    size_t n;

    text_blanks(t);
    n = number_int(t->at, t->end, &x, NULL);
    if (!n || !ends_here(t, t->at + n))
        return false;
    t->at += n;
    *v = x;
    return true;
}

bool word_is(Word w, const char *s) { return w.n == strlen(s) && !memcmp(w.s, s, w.n); }

bool word_is_nocase(Word w, const char *s)
{
    if (w.n != strlen(s))
        return false;
    for (size_t i = 0; i < w.n; i++) {
        char a = w.s[i], b = s[i];
        if (a >= 'A' && a <= 'Z') a = (char)(a + 32);
        if (b >= 'A' && b <= 'Z') b = (char)(b + 32);
        if (a != b)
            return false;
    }
    return true;
}

char *word_copy(char *out, size_t room, Word w)
{
    size_t n = w.n < room - 1 ? w.n : room - 1;
    memcpy(out, w.s, n);
    out[n] = 0;
    return out;
}
