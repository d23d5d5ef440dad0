/* options.c -- tables of options and the values set from them. See options.h. */
#include "base/options.h"

#include "base/number.h"
#include "base/text.h"

#include <stdio.h>
#include <string.h>

const char *const opt_type_names[] = { "bool", "integer", "float", "rgb", "point3", "floats",
                                       "string", "choice" };

/* Which of the blank-separated words of `list` the word is; -1: none. */
static int place_in_words(const char *list, const char *word, size_t n)
{
    for (int place = 0; list && *list; place++) {
        size_t k = strcspn(list, " ");
        if (k == n && !memcmp(list, word, n))
            return place;
        list += k;
        list += strspn(list, " ");
    }
    return -1;
}

static bool in_words(const char *list, const char *word, size_t n)
{
    return place_in_words(list, word, n) >= 0;
}

Param *params_find(const Params *ps, const char *name, const char *also)
{
    for (size_t i = 0; i < ps->n; i++) {
        Param *p = &ps->p[i];
        if (!strcmp(p->name, name) || in_words(also, p->name, strlen(p->name))) {
            p->used = true;
            return p;
        }
    }
    return NULL;
}

/* "x y z" of a table: our own text, so a fault in it is our bug. */
static Rgb three_of(const char *text)
{
    double x[3];
    const char *end = text + strlen(text);
    for (int i = 0; i < 3; i++) {
        size_t n = number_double(text, end, &x[i]);
        ASSERT(n > 0);
        text += n + (text + n < end);
    }
    return rgb((float)x[0], (float)x[1], (float)x[2]);
}

void opts_default(Opts *o, const OptDef *defs)
{
    memset(o, 0, sizeof *o);
    o->defs = defs;
    for (int i = 0; defs && defs[i].key; i++) {
        ASSERT(i < OPT_MAX);
        o->value[i].num = defs[i].num;
        o->value[i].rgb = rgb_all((float)defs[i].num);
        o->value[i].str = defs[i].str;
        if (defs[i].type == OPT_POINT && defs[i].str)
            o->value[i].rgb = three_of(defs[i].str);
    }
}

static int index_of(const OptDef *defs, const char *key, size_t n)
{
    for (int i = 0; defs && defs[i].key; i++)
        if ((strlen(defs[i].key) == n && !memcmp(defs[i].key, key, n)) ||
            in_words(defs[i].also, key, n))
            return i;
    return -1;
}

static const char *hint_key(char hint[HINT_MAX], const OptDef *defs, const char *key)
{
    const char *names[OPT_MAX];
    size_t n = 0;
    for (; defs && defs[n].key; n++)
        names[n] = defs[n].key;
    return hint_nearest(hint, key, names, n);
}

/* "[0, 100]" or "true or false" and the like, for messages. */
static const char *expected(const OptDef *d, char *buf, size_t room)
{
    switch (d->type) {
    case OPT_BOOL:   return "true or false";
    case OPT_STRING: return "a string";
    case OPT_RGB:    return "one number or three";
    case OPT_POINT:  return "three numbers";
    case OPT_NUMBERS: return "numbers";
    case OPT_CHOICE: snprintf(buf, room, "one of %s", d->choices); return buf;
    case OPT_INT: case OPT_FLOAT: break;
    }
    if (d->lo < d->hi) {
        char lo[NUMBER_MAX], hi[NUMBER_MAX];
        number_print_double(lo, d->lo);
        number_print_double(hi, d->hi);
        snprintf(buf, room, "%s from %s to %s", d->type == OPT_INT ? "a whole number" : "a number",
                 lo, hi);
        return buf;
    }
    return d->type == OPT_INT ? "a whole number" : "a number";
}

static bool in_range(const OptDef *d, double v)
{
    return v - v == 0.0 && (d->lo == d->hi || (v >= d->lo && v <= d->hi));
}

/* ---- from the command line ---- */

static bool parse_numbers(const char *s, size_t n, double *v, int want)
{
    const char *end = s + n;
    for (int i = 0; i < want; i++) {
        size_t k = number_double(s, end, &v[i]);
        if (!k)
            return false;
        s += k;
        if (i + 1 < want) {             /* components are separated by '/' : rgb=1/0.5/0.2 */
            if (s >= end || *s != '/')
                return false;
            s++;
        }
    }
    return s == end;
}

static bool set_from_text(const OptDef *d, OptValue *v, const char *s, size_t n, Arena *arena)
{
    double x[3];
    switch (d->type) {
    case OPT_BOOL:
        if (in_words("true yes on 1", s, n))
            v->num = 1;
        else if (in_words("false no off 0", s, n))
            v->num = 0;
        else
            return false;
        return true;
    case OPT_INT:
    case OPT_FLOAT:
        if (!parse_numbers(s, n, x, 1) || !in_range(d, x[0]) ||
            (d->type == OPT_INT && x[0] != floor(x[0])))
            return false;
        v->num = x[0];
        return true;
    case OPT_RGB:
    case OPT_POINT:
        if (!parse_numbers(s, n, x, 3)) {
            if (d->type == OPT_POINT || !parse_numbers(s, n, x, 1))
                return false;
            x[1] = x[2] = x[0];
        }
        v->rgb = rgb((float)x[0], (float)x[1], (float)x[2]);
        return in_range(d, x[0]) && in_range(d, x[1]) && in_range(d, x[2]);
    case OPT_CHOICE:
    case OPT_STRING:
        if (d->type == OPT_CHOICE && !in_words(d->choices, s, n))
            return false;
        v->str = arena_string(arena, s, n);
        return v->str != NULL;
    case OPT_NUMBERS:
        break;
    }
    return false;
}

bool opts_parse(Opts *o, const char *what, const char *text, Arena *arena)
{
    while (*text) {
        size_t n = strcspn(text, ","), k = 0;
        char key[64], buf[200], hint[HINT_MAX];
        int i;
        while (k < n && text[k] != '=')
            k++;
        word_copy(key, sizeof key, (Word){ text, k });
        i = index_of(o->defs, text, k);
        if (i < 0)
            return err_usage("%s has no option '%s'%s", what, key, hint_key(hint, o->defs, key));
        if (k == n && o->defs[i].type == OPT_BOOL)      /* a bare word switches on */
            o->value[i].num = 1;
        else if (k == n || !set_from_text(&o->defs[i], &o->value[i], text + k + 1, n - k - 1,
                                          arena)) {
            if (err_status() != STATUS_OK)
                return false;
            return err_usage("%s: '%.*s' is not right, expected %s=(%s)", what,
                             (int)(n < 80 ? n : 80), text, key,
                             expected(&o->defs[i], buf, sizeof buf));
        }
        o->value[i].given = true;
        text += n;
        if (*text == ',')
            text++;
    }
    return true;
}

/* ---- from a scene file ---- */

static bool set_from_param(const OptDef *d, OptValue *v, const Param *p)
{
    char buf[200];
    bool number = p->kind == PARAM_INT || p->kind == PARAM_FLOAT;
    size_t want = d->type == OPT_POINT || (d->type == OPT_RGB && p->n == 3) ? 3 : 1;
    bool ok = p->n == want;

    switch (d->type) {
    case OPT_BOOL:   ok = ok && p->kind == PARAM_BOOL; break;
    case OPT_INT:    ok = ok && number && p->numbers[0] == floor(p->numbers[0]); break;
    case OPT_FLOAT:
    case OPT_RGB:
    case OPT_POINT:  ok = ok && number; break;
    case OPT_NUMBERS: return number || err_at(p->at, "\"%s %s\" is not right, expected numbers",
                                              p->type, p->name);
    case OPT_STRING: ok = ok && p->kind == PARAM_STRING; break;
    case OPT_CHOICE:
        ok = ok && p->kind == PARAM_STRING &&
             in_words(d->choices, p->strings[0], strlen(p->strings[0]));
        break;
    }
    if (ok && p->kind != PARAM_STRING)
        for (size_t i = 0; i < want && d->type != OPT_BOOL; i++)
            ok = ok && in_range(d, p->numbers[i]);
    if (!ok)
        return err_at(p->at, "\"%s %s\" is not right, expected %s", p->type, p->name,
                      expected(d, buf, sizeof buf));
    if (p->kind == PARAM_STRING)
        v->str = p->strings[0];
    else {
        const double *x = p->numbers;
        v->num = x[0];
        v->rgb = want == 3 ? rgb((float)x[0], (float)x[1], (float)x[2]) : rgb_all((float)x[0]);
    }
    return true;
}

bool opts_params(Opts *o, const char *what, const Params *ps)
{
    for (int i = 0; o->defs && o->defs[i].key; i++) {
        const OptDef *d = &o->defs[i];
        const Param *p = params_find(ps, d->key, d->also);
        if (!p)
            continue;
        if (p->kind != PARAM_TEXTURE && !set_from_param(d, &o->value[i], p))
            return false;
        o->value[i].given = true;
        o->value[i].param = p;
    }
    for (size_t i = 0; i < ps->n; i++) {
        const Param *p = &ps->p[i];
        char hint[HINT_MAX];
        if (p->used)
            continue;
        if (!warn_at(p->at, "%s has no parameter '%s'%s; it is left out", what, p->name,
                     hint_key(hint, o->defs, p->name)))
            return false;
    }
    return true;
}

/* ---- values ---- */

static const OptValue *value_of(const Opts *o, const char *key)
{
    int i = index_of(o->defs, key, strlen(key));
    ASSERT(i >= 0);
    return &o->value[i];
}

bool        opt_bool(const Opts *o, const char *key) { return value_of(o, key)->num != 0; }
int64_t     opt_int(const Opts *o, const char *key) { return (int64_t)value_of(o, key)->num; }
float       opt_float(const Opts *o, const char *key) { return (float)value_of(o, key)->num; }
Rgb         opt_rgb(const Opts *o, const char *key) { return value_of(o, key)->rgb; }
const char *opt_string(const Opts *o, const char *key) { return value_of(o, key)->str; }
bool        opt_given(const Opts *o, const char *key) { return value_of(o, key)->given; }
const Param *opt_param(const Opts *o, const char *key) { return value_of(o, key)->param; }

void opt_set_number(Opts *o, const char *key, double v)
{
    int i = index_of(o->defs, key, strlen(key));
    ASSERT(i >= 0);
    o->value[i].num = v;
    o->value[i].rgb = rgb_all((float)v);
}

V3 opt_point(const Opts *o, const char *key)
{
    Rgb c = value_of(o, key)->rgb;
    return v3(c.r, c.g, c.b);
}

bool opt_is(const Opts *o, const char *key, const char *choice)
{
    const char *s = value_of(o, key)->str;
    return s && !strcmp(s, choice);
}

int opt_choice(const Opts *o, const char *key)
{
    const char *s = opt_string(o, key);
    int place = place_in_words(o->defs[index_of(o->defs, key, strlen(key))].choices, s, strlen(s));

    ASSERT(place >= 0);
    return place;
}
