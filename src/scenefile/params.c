/* params.c -- typed parameter lists: "float radius" 1 "rgb L" [1 1 1] "spectrum k" "metal-Cu-k".
 *
 * Both versions of the language are read: version 3 writes "color", "point" and "vector" where
 * version 4 has "rgb", "point3" and "vector3". A string without a type declares a parameter whose
 * type its first value tells. Spectra leave here as three numbers (see spectrum.c).
 *
 * While a list is read, strings and numbers go to pools that may move; pointers into them are set
 * when the list is complete. A pool never holds more than one directive gave it. */
#include "scenefile/reader.h"

#include <string.h>

typedef enum { FORM_PLAIN, FORM_RGB, FORM_XYZ, FORM_SPECTRUM, FORM_BLACKBODY, FORM_UNTYPED } Form;

typedef struct { const char *name; ParamType kind; Form form; size_t group; } TypeName;

static const TypeName type_names[] = {
    { "float", PARAM_FLOAT, FORM_PLAIN, 1 },      { "integer", PARAM_INT, FORM_PLAIN, 1 },
    { "string", PARAM_STRING, FORM_PLAIN, 1 },    { "texture", PARAM_TEXTURE, FORM_PLAIN, 1 },
    { "bool", PARAM_BOOL, FORM_PLAIN, 1 },        { "rgb", PARAM_FLOAT, FORM_RGB, 3 },
    { "point3", PARAM_FLOAT, FORM_PLAIN, 3 },     { "point2", PARAM_FLOAT, FORM_PLAIN, 2 },
    { "vector3", PARAM_FLOAT, FORM_PLAIN, 3 },    { "vector2", PARAM_FLOAT, FORM_PLAIN, 2 },
    { "normal", PARAM_FLOAT, FORM_PLAIN, 3 },     { "spectrum", PARAM_FLOAT, FORM_SPECTRUM, 1 },
    { "blackbody", PARAM_FLOAT, FORM_BLACKBODY, 1 }, { "point", PARAM_FLOAT, FORM_PLAIN, 3 },
    { "vector", PARAM_FLOAT, FORM_PLAIN, 3 },     { "normal3", PARAM_FLOAT, FORM_PLAIN, 3 },
    { "color", PARAM_FLOAT, FORM_RGB, 3 },        { "xyz", PARAM_FLOAT, FORM_XYZ, 3 }
};
enum { NTYPES = sizeof type_names / sizeof *type_names };
#define INT_MOST 9007199254740992.0             /* 2^53: beyond it a double skips whole numbers */
static const TypeName untyped = { "", PARAM_FLOAT, FORM_UNTYPED, 1 };

void pool_clear(ParamPool *p)
{
    mem_free(p->p);
    mem_free(p->span);
    mem_free(p->numbers);
    mem_free(p->strings);
    mem_free(p->string_at);
    mem_free(p->text);
    memset(p, 0, sizeof *p);
}

static bool pool_text(ParamPool *pool, const Token *t, size_t *at)
{
    if (t->n > UINT32_MAX - 1 - pool->ntext)
        return err_at(t->at, "the strings of one directive have more than 4294967295 bytes");
    if (!mem_grow(&pool->text, &pool->cap_text, pool->ntext + t->n + 1, 1))
        return false;
    *at = pool->ntext;
    pool->ntext += token_text(t, pool->text + pool->ntext) + 1;
    return true;
}

static bool pool_number(ParamPool *pool, double v)
{
    return MEM_PUSH(pool->numbers, pool->nnumbers, pool->cap_numbers, v);
}

/* ---- the declaration: "type name" ---- */

static bool unknown_type(Place at, const char *word)
{
    const char *names[NTYPES];
    char hint[HINT_MAX];
    for (size_t i = 0; i < NTYPES; i++)
        names[i] = type_names[i].name;
    return err_at(at, "unknown parameter type '%.60s'%s", word,
                  hint_nearest(hint, word, names, NTYPES));
}

/* Cuts the next blank-separated word out of s and ends it with a 0. */
static char *cut_word(char **s)
{
    char *word = *s + strspn(*s, " \t");
    size_t n = strcspn(word, " \t");
    *s = word + n + (word[n] ? 1 : 0);
    word[n] = 0;
    return word;
}

/* A list gives a name twice: the later one counts, as in version 3. */
static bool forget_earlier(ParamPool *pool, Place at, const char *name)
{
    for (size_t i = 0; i < pool->n; i++)
        if (!strcmp(pool->text + pool->span[i].name, name)) {
            if (!warn_at(at, "'%s' was given before in this list; this one is used", name))
                return false;
            pool->n--;
            memmove(pool->p + i, pool->p + i + 1, (pool->n - i) * sizeof *pool->p);
            memmove(pool->span + i, pool->span + i + 1, (pool->n - i) * sizeof *pool->span);
            return true;
        }
    return true;
}

static bool read_declaration(Reader *r, const Token *t, ParamSpan *span, const TypeName **type)
{
    ParamPool *pool = &r->pool;
    char *rest, *first, *second;
    size_t i;

    if (!pool_text(pool, t, &span->type))
        return false;
    rest = pool->text + span->type;
    first = cut_word(&rest);
    second = cut_word(&rest);
    if (!*first || *cut_word(&rest))
        return err_at(t->at,
                      "a parameter is declared by its type and its name, as in \"float fov\"");
    *type = &untyped;
    if (*second) {
        for (i = 0; i < NTYPES && strcmp(first, type_names[i].name); i++)
            ;
        if (i == NTYPES)
            return unknown_type(t->at, first);
        *type = &type_names[i];
        span->type = (size_t)(first - pool->text);
    } else {
        second = first;
        span->type = (size_t)(first - pool->text) + strlen(first);      /* the empty string */
    }
    span->name = (size_t)(second - pool->text);
    return forget_earlier(pool, t->at, second);
}

/* ---- values ---- */

static bool wrong_value(const Token *t, const char *expected)
{
    static const char *const what[] = { "the end of the file", "a name", "a string", "a number",
                                        "'['", "']'" };
    return err_at(t->at, "%s stands where %s was expected", what[t->kind], expected);
}

static bool take_string(Reader *r, Param *p, const Token *t)
{
    ParamPool *pool = &r->pool;
    size_t at = 0;
    if (t->kind != TOKEN_STRING)
        return wrong_value(t, "a string");
    p->n++;
    return pool_text(pool, t, &at) &&
           MEM_PUSH(pool->string_at, pool->nstrings, pool->cap_at, (uint32_t)at);
}

static bool take_bool(Reader *r, Param *p, const Token *t)
{
    bool yes = token_is(t, "true");
    if (!yes && !token_is(t, "false"))
        return wrong_value(t, "true or false");
    p->n++;
    return pool_number(&r->pool, yes);
}

static bool take_number(Reader *r, Param *p, const Token *t)
{
    if (t->kind != TOKEN_NUMBER)
        return wrong_value(t, p->kind == PARAM_INT ? "a whole number" : "a number");
    if (p->kind == PARAM_INT && (t->number != floor(t->number) || fabs(t->number) > INT_MOST))
        return err_at(t->at, "'%.*s' is not right, expected a whole number",
                      t->n < 40 ? (int)t->n : 40, t->s);
    p->n++;
    return pool_number(&r->pool, t->number);
}

static bool take_value(Reader *r, Param *p, Form *form, const Token *t)
{
    if (*form == FORM_UNTYPED) {                /* the first value tells */
        *form = FORM_PLAIN;
        p->kind = t->kind == TOKEN_STRING ? PARAM_STRING
                  : t->kind == TOKEN_NAME ? PARAM_BOOL : PARAM_FLOAT;
    }
    if (*form == FORM_SPECTRUM && p->n == 0 && t->kind == TOKEN_STRING)
        p->kind = PARAM_STRING;
    switch (p->kind) {
    case PARAM_BOOL:   return take_bool(r, p, t);
    case PARAM_INT:
    case PARAM_FLOAT:  return take_number(r, p, t);
    case PARAM_STRING:
    case PARAM_TEXTURE: break;
    }
    return take_string(r, p, t);
}

/* A list in brackets, or one value without. */
static bool read_values(Reader *r, Param *p, Form form)
{
    Token open, t;

    if (!reader_next(r, &open))
        return false;
    if (open.kind != TOKEN_OPEN)
        return take_value(r, p, &form, &open);
    for (;;) {
        if (!reader_next(r, &t))
            return false;
        if (t.kind == TOKEN_CLOSE)
            break;
        if (t.kind == TOKEN_END || (t.kind == TOKEN_NAME && p->kind != PARAM_BOOL &&
                                    form != FORM_UNTYPED))
            return err_at(t.at,
                          "the list that begins in line %d has no end, expected a value or ']'",
                          open.at.line);
        if (!take_value(r, p, &form, &t))
            return false;
    }
    if (!p->n)
        return err_at(open.at, "the list is empty, expected a value");
    return true;
}

/* ---- spectra ---- */

/* The numbers of a file of lines "nm value", in *v, which the caller frees in any case. */
static bool read_pairs(Text *t, double **v, size_t *n)
{
    static const char what[] = "a spectrum file holds pairs of wavelength (nm) and value";
    size_t cap = 0;

    for (;;) {
        Place here;
        float x;
        text_space(t);
        here = text_place(t);
        if (text_peek(t) == '#') {
            Text comment;
            text_line(t, &comment);
            continue;
        }
        if (text_done(t))
            break;
        if (!text_float(t, &x) || !is_finite(x))
            return err_at(here, "%s", what);
        if (*n % 2 == 0 && *n && x <= (*v)[*n - 2])
            return err_at(here, "wavelengths must rise");
        if (!MEM_PUSH(*v, *n, cap, x))
            return false;
    }
    return (*n >= 2 && *n % 2 == 0) || err_at((Place){ t->file, 0, 0 }, "%s", what);
}

/* Such a file. */
static bool read_spd(Reader *r, Place at, const char *name, SpectrumUse use, double rgb[3])
{
    char *path = reader_path(r, at, name);
    FileBytes f;
    Text t;
    double *pairs = NULL;
    size_t n = 0;
    bool ok = path && reader_file(r, at, path, &f);

    if (!ok) {
        mem_free(path);
        return false;
    }
    text_init(&t, path, f.bytes, f.size);
    ok = read_pairs(&t, &pairs, &n);
    if (ok)
        spectrum_from_samples(r->cie, pairs, n / 2, use, rgb);
    mem_free(pairs);
    file_clear(&f);
    mem_free(path);
    return ok;
}

/* *known false: warned of, the parameter is to be left out. */
static bool spectrum_of_string(Reader *r, const Param *p, SpectrumUse use, double rgb[3],
                               bool *known)
{
    const char *name = r->pool.text + r->pool.string_at[r->pool.nstrings - 1];
    char hint[HINT_MAX];

    *known = true;
    if (p->n != 1)
        return err_at(p->at, "%lu spectra are given, expected one", (unsigned long)p->n);
    if (spectrum_named(r->cie, name, use, rgb))
        return true;
    if (*path_extension(name))
        return read_spd(r, p->at, name, use, rgb);
    *known = false;
    return warn_at(p->at, "unknown spectrum '%.80s'%s; the parameter is left out", name,
                   spectrum_hint(name, hint));
}

static bool spectrum_of_numbers(Reader *r, const Param *p, SpectrumUse use, const double *v,
                                double rgb[3])
{
    if (p->n % 2)
        return err_at(p->at, "%lu numbers are given, a spectrum has pairs of wavelength (nm) and "
                      "value", (unsigned long)p->n);
    for (size_t i = 2; i < p->n; i += 2)
        if (v[i] <= v[i - 2])
            return err_at(p->at, "the wavelengths of a spectrum must rise");
    spectrum_from_samples(r->cie, v, p->n / 2, use, rgb);
    return true;
}

static bool blackbody_of(Reader *r, const Param *p, const double *v, double rgb[3])
{
    if (p->n > 2)
        return err_at(p->at,
                      "a black body is given by its temperature, expected one number (or two, "
                      "with a scale)");
    if (!(v[0] >= KELVIN_LEAST && v[0] <= KELVIN_MOST))
        return err_at(p->at, "the temperature of a black body is from 100 to 10000000 kelvin");
    spectrum_from_kelvin(r->cie, v[0], p->n == 2 ? &v[1] : NULL, rgb);
    return true;
}

/* Colours that our primaries cannot make lose what is negative; a reflectance stays one. */
static void to_our_space(const Reader *r, const double v[3], double rgb[3])
{
    const double (*m)[3] = r->state.space;
    bool albedo = v[0] <= 1 && v[1] <= 1 && v[2] <= 1;

    memcpy(rgb, v, 3 * sizeof *v);
    for (int i = 0; m && i < 3; i++) {
        rgb[i] = m[i][0] * v[0] + m[i][1] * v[1] + m[i][2] * v[2];
        rgb[i] = rgb[i] < 0 ? 0 : albedo && rgb[i] > 1 ? 1 : rgb[i];
    }
}

/* Turns the values just read into three numbers. */
static bool to_rgb(Reader *r, Param *p, size_t first, Form form, SpectrumUse use, bool *known)
{
    ParamPool *pool = &r->pool;
    const double *v = pool->numbers ? pool->numbers + first : NULL;
    double rgb[3] = { 0, 0, 0 };

    if ((form == FORM_RGB || form == FORM_XYZ) && p->n != 3)
        return err_at(p->at, "%lu numbers are given, a colour has three", (unsigned long)p->n);
    if (form == FORM_RGB)
        to_our_space(r, v, rgb);
    else if (form == FORM_XYZ)
        spectrum_from_xyz(v, rgb);
    else if (!reader_cie(r))
        return false;
    else if (form == FORM_BLACKBODY) {
        if (!blackbody_of(r, p, v, rgb))
            return false;
    } else if (p->kind == PARAM_STRING) {
        if (!spectrum_of_string(r, p, use, rgb, known))
            return false;
        pool->nstrings -= p->n;
    } else if (!spectrum_of_numbers(r, p, use, v, rgb))
        return false;
    p->kind = PARAM_FLOAT;
    p->n = 3;
    pool->nnumbers = first;
    for (int i = 0; i < 3; i++) {
        if (!(fabs(rgb[i]) <= 3.4e38))
            return err_at(p->at, "the spectrum is out of range");
        if (!pool_number(pool, rgb[i]))
            return false;
    }
    return true;
}

/* ---- lists ---- */

static bool read_param(Reader *r, const Token *t, SpectrumUse use)
{
    ParamPool *pool = &r->pool;
    const TypeName *type = &untyped;
    ParamSpan span;
    Param p;
    bool known = true;

    memset(&p, 0, sizeof p);
    p.at = t->at;
    if (!read_declaration(r, t, &span, &type))
        return false;
    if (pool->n == PARAMS_MAX)
        return err_at(t->at, "more than %d parameters", PARAMS_MAX);
    p.kind = type->kind;
    span.first = type->kind == PARAM_STRING || type->kind == PARAM_TEXTURE ? pool->nstrings
                                                                          : pool->nnumbers;
    if (!read_values(r, &p, type->form))
        return false;
    if (type->form == FORM_UNTYPED)
        span.first = p.kind == PARAM_STRING ? pool->nstrings - p.n : pool->nnumbers - p.n;
    else if (type->form != FORM_PLAIN && !to_rgb(r, &p, span.first, type->form, use, &known))
        return false;
    if (p.n % type->group)
        return err_at(p.at, "%lu numbers are given, expected groups of %lu", (unsigned long)p.n,
                      (unsigned long)type->group);
    if (!known)
        return true;
    if (!mem_grow(&pool->span, &pool->cap_span, pool->n + 1, sizeof *pool->span))
        return false;
    pool->span[pool->n] = span;
    return MEM_PUSH(pool->p, pool->n, pool->cap, p);
}

static bool set_pointers(ParamPool *pool)
{
    if (!mem_grow(&pool->strings, &pool->cap_strings, pool->nstrings, sizeof *pool->strings))
        return false;
    for (size_t i = 0; i < pool->nstrings; i++)
        pool->strings[i] = pool->text + pool->string_at[i];
    for (size_t i = 0; i < pool->n; i++) {
        Param *p = &pool->p[i];
        p->name = pool->text + pool->span[i].name;
        p->type = pool->text + pool->span[i].type;
        if (p->kind == PARAM_STRING || p->kind == PARAM_TEXTURE)
            p->strings = pool->strings + pool->span[i].first;
        else
            p->numbers = pool->numbers + pool->span[i].first;
    }
    return true;
}

bool params_read(Reader *r, SpectrumUse use, Params *out)
{
    ParamPool *pool = &r->pool;
    Token t;

    pool->n = pool->nnumbers = pool->nstrings = pool->ntext = 0;
    for (;;) {
        if (!reader_peek(r, &t))
            return false;
        if (t.kind != TOKEN_STRING)
            break;
        if (!reader_next(r, &t) || !read_param(r, &t, use))
            return false;
    }
    *out = (Params){ pool->p, pool->n };
    return set_pointers(pool);
}
