/* json.c -- the code of `json.h`. Source: RFC 8259. */
#include "view/json.h"

#include "base/number.h"

#include <stdio.h>
#include <string.h>

static void put(Json *j, const char *s, size_t n)
{
    j->failed = j->failed || !mem_grow(&j->text, &j->cap, j->n + n + 1, 1);
    if (j->failed)
        return;
    memcpy(j->text + j->n, s, n);
    j->n += n;
    j->text[j->n] = 0;
}

/* Values and keys stand behind a comma, unless a bracket or the key is before them. */
static void begin(Json *j)
{
    if (j->comma)
        put(j, ",", 1);
    j->comma = true;
}

void json_open(Json *j, char bracket)
{
    begin(j);
    put(j, &bracket, 1);
    j->comma = false;
}

void json_close(Json *j, char bracket)
{
    put(j, &bracket, 1);
    j->comma = true;
}

/* Bytes above 127 are taken for the UTF-8 that they should be. */
void json_string(Json *j, const char *s)
{
    char code[8];

    begin(j);
    if (!s) {
        put(j, "null", 4);
        return;
    }
    put(j, "\"", 1);
    for (; *s; s++) {
        unsigned char c = (unsigned char)*s;
        if (c < 32 || c == '"' || c == '\\' || c == '<')
            put(j, code, (size_t)snprintf(code, sizeof code, "\\u%04x", c));
        else
            put(j, s, 1);
    }
    put(j, "\"", 1);
}

void json_key(Json *j, const char *key)
{
    json_string(j, key);
    put(j, ":", 1);
    j->comma = false;
}

void json_number(Json *j, double v)
{
    char text[NUMBER_MAX] = "null";

    begin(j);
    if (v - v == 0)                     /* else it is infinite or no number */
        number_print_double(text, v);
    put(j, text, strlen(text));
}

void json_bool(Json *j, bool v)
{
    begin(j);
    put(j, v ? "true" : "false", v ? 4 : 5);
}

void json_clear(Json *j)
{
    mem_free(j->text);
    *j = (Json){ 0 };
}
