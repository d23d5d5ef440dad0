/* lexer.c -- see lexer.h. Source: the file formats of pbrt, versions 3 and 4. */
#include "scenefile/lexer.h"

#include "base/maths.h"
#include "base/number.h"

#include <float.h>
#include <string.h>

void lexer_init(Lexer *l, const char *file, const char *bytes, size_t n)
{
    memset(l, 0, sizeof *l);
    text_init(&l->text, file, bytes, n);
}

static bool is_white(char c)
{
    return c == ' ' || c == '\t' || c == '\n' || c == '\r' || c == '\v' || c == '\f';
}

static bool is_letter(char c)
{
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_';
}
static bool is_digit(char c) { return c >= '0' && c <= '9'; }
static bool ends_word(char c)
{
    return is_white(c) || c == '"' || c == '[' || c == ']' || c == '#';
}

static void skip_to_token(Text *t)
{
    for (;;) {
        text_space(t);
        if (text_peek(t) != '#')
            return;
        while (t->at < t->end && *t->at != '\n' && *t->at != '\r')
            t->at++;
    }
}

/* The escapes of a string and what they stand for. */
static const char escapes[] = "bfnrt\\'\"", meanings[] = "\b\f\n\r\t\\'\"";

static bool take_string(Text *t, Token *k)
{
    k->kind = TOKEN_STRING;
    k->s = ++t->at;
    for (; t->at < t->end && *t->at != '"'; t->at++) {
        if (*t->at == '\n' || *t->at == '\r')
            return err_at(k->at, "the string has no end on its line, expected '\"'");
        if (*t->at == 0)
            return err_at(text_place(t), "a zero byte stands in a string");
        if (*t->at != '\\')
            continue;
        if (++t->at == t->end)
            break;
        if (*t->at == 0 || !strchr(escapes, *t->at))
            return err_at(text_place_of(t, t->at - 1),
                          "unknown escape in a string, expected a \\ and one of %s", escapes);
    }
    if (t->at >= t->end)
        return err_at(k->at, "the string has no end, expected '\"'");
    k->n = (size_t)(t->at++ - k->s);
    return true;
}

static bool take_number(Text *t, Token *k)
{
    k->kind = TOKEN_NUMBER;
    if (number_double(k->s, k->s + k->n, &k->number) != k->n)
        return err_at(k->at, "'%.*s' is not a number", k->n < 40 ? (int)k->n : 40, k->s);
    if (!(fabs(k->number) <= FLT_MAX))
        return err_at(k->at, "'%.*s' is out of range, expected at most 3.4e38 either way",
                      k->n < 40 ? (int)k->n : 40, k->s);
    t->at += k->n;
    return true;
}

static bool take_name(Text *t, Token *k)
{
    k->kind = TOKEN_NAME;
    for (size_t i = 0; i < k->n; i++)
        if (!is_letter(k->s[i]) && !is_digit(k->s[i]))
            return err_at(text_place_of(t, k->s + i), "unexpected byte 0x%02x in a name",
                          (unsigned)(unsigned char)k->s[i]);
    t->at += k->n;
    return true;
}

static bool take(Lexer *l, Token *k)
{
    Text *t = &l->text;
    const char *p;

    skip_to_token(t);
    *k = (Token){ TOKEN_END, t->at, 0, 0, text_place(t) };
    if (text_done(t))
        return true;
    if (*t->at == '"')
        return take_string(t, k);
    if (*t->at == '[' || *t->at == ']') {
        k->kind = *t->at++ == '[' ? TOKEN_OPEN : TOKEN_CLOSE;
        k->n = 1;
        return true;
    }
    for (p = t->at; p < t->end && !ends_word(*p); p++)
        ;
    k->n = (size_t)(p - t->at);
    if (is_letter(*t->at))
        return take_name(t, k);
    if (is_digit(*t->at) || *t->at == '+' || *t->at == '-' || *t->at == '.')
        return take_number(t, k);
    return err_at(k->at, "unexpected byte 0x%02x, expected a directive, a string or a number",
                  (unsigned)(unsigned char)*t->at);
}

bool lexer_next(Lexer *l, Token *t)
{
    if (!l->looked)
        return take(l, t);
    l->looked = false;
    *t = l->ahead;
    return true;
}

bool lexer_peek(Lexer *l, Token *t)
{
    if (!l->looked && !take(l, &l->ahead))
        return false;
    l->looked = true;
    *t = l->ahead;
    return true;
}

size_t token_text(const Token *t, char *out)
{
    size_t n = 0;
    for (size_t i = 0; i < t->n; i++)
        out[n++] = t->kind == TOKEN_STRING && t->s[i] == '\\'
                       ? meanings[strchr(escapes, t->s[++i]) - escapes]
                       : t->s[i];
    out[n] = 0;
    return n;
}

bool token_is(const Token *t, const char *s)
{
    return (t->kind == TOKEN_STRING || t->kind == TOKEN_NAME) && t->n == strlen(s) &&
           !memcmp(t->s, s, t->n);
}

bool token_unknown(const Token *t, const char *const *names, size_t n)
{
    char word[60], hint[HINT_MAX];

    word_copy(word, sizeof word, (Word){ t->s, t->n });
    return err_at(t->at, "unknown directive '%s'%s", word, hint_nearest(hint, word, names, n));
}
