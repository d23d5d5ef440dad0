/* objtext.c -- lines of OBJ and MTL files. See objtext.h. */
#include "geometry/objtext.h"

#include "base/number.h"

#include <string.h>

static bool ends_line(const char *p, const char *end)
{
    return p >= end || *p == '\n' || *p == '\r';
}

/* Steps over the line end at t->at: LF, CRLF or CR. */
static void step_line(Text *t)
{
    if (t->at < t->end && *t->at == '\r')
        t->at += t->end - t->at > 1 && t->at[1] == '\n';
    t->at += t->at < t->end;
    t->line++;
    t->line_start = t->at;
}

static bool continued(const Text *t, const char *p)
{
    return *p == '\\' && ends_line(p + 1, t->end);
}

static void skip_blanks(Text *t)
{
    text_blanks(t);
    while (t->at < t->end && continued(t, t->at)) {
        t->at++;
        step_line(t);
        text_blanks(t);
    }
}

Word obj_word(Text *t)
{
    Word w;

    skip_blanks(t);
    if (text_peek(t) == '#')
        return (Word){ t->at, 0 };
    w = text_word(t);
    if (w.n > 1 && continued(t, w.s + w.n - 1)) {       /* 2\ at the end of a line is 2 */
        w.n--;
        t->at--;
    }
    return w;
}

Word obj_rest(Text *t)
{
    Word rest = obj_word(t), w = rest;
    while (w.n) {
        rest.n = (size_t)(w.s + w.n - rest.s);
        w = obj_word(t);
    }
    return rest;
}

bool obj_check_name(const Text *t, Word name)
{
    return !memchr(name.s, 0, name.n) ||
           err_at(text_place_of(t, name.s), "a name with a byte 0, text was expected");
}

bool obj_number(Text *t, const char *what, float *v)
{
    Word w = obj_word(t);
    char copy[40];

    if (w.n && number_float(w.s, w.s + w.n, v) == w.n)
        return true;
    if (!w.n)
        return err_at(text_place_of(t, w.s), "%s is missing, a number was expected", what);
    return err_at(text_place_of(t, w.s), "%s is '%s', a number was expected", what,
                  word_copy(copy, sizeof copy, w));
}

/* A '#' begins a comment where it begins a word. */
static bool begins_comment(const Text *t)
{
    return *t->at == '#' && (t->at == t->line_start || t->at[-1] == ' ' || t->at[-1] == '\t');
}

void obj_next_line(Text *t)
{
    bool comment = false, more = true;

    while (more && !text_done(t)) {
        const char *start = t->at;
        while (!ends_line(t->at, t->end)) {
            comment |= begins_comment(t);
            t->at++;
        }
        more = !comment && t->at > start && t->at[-1] == '\\';
        step_line(t);
    }
}
