/* mtl.c -- Wavefront MTL files: the materials that an OBJ file names.
 *
 * Source  Wavefront, "MTL material format" (Lightwave, OBJ), v4.2, October 1995; norm, Ke, and the
 *         P-words, which say how rough, metallic and coated a surface is, as exporters write them.
 *
 * Keywords are taken in any case. Colours are RGB; those given as `spectral` or `xyz` are left out
 * with a warning. Tr is read as 1 - d, and gives way to d where a material has both, because
 * exporters disagree about Tr and agree about d. Options of maps are read over, but -bm. */
#include "geometry/meshfile.h"

#include "base/number.h"
#include "geometry/objtext.h"
#include "geometry/skipped.h"

#include <string.h>

typedef enum { S_COLOUR, S_NUMBER, S_DISSOLVE, S_TRANSPARENT, S_ILLUM, S_MAP, S_IGNORED } Kind;

typedef struct {
    const char *keyword;
    Kind   kind;
    size_t field, has;                  /* where it goes; `has` of 0: no flag. S_MAP: its kind */
} Statement;

#define FIELD(f) offsetof(MtlMaterial, f)

static const Statement statements[] = {
    { "Kd", S_COLOUR, FIELD(kd), FIELD(has_kd) },
    { "Ks", S_COLOUR, FIELD(ks), FIELD(has_ks) },
    { "Ke", S_COLOUR, FIELD(ke), FIELD(has_ke) },
    { "Tf", S_COLOUR, FIELD(tf), 0 },
    { "Ns", S_NUMBER, FIELD(ns), 0 },
    { "Ni", S_NUMBER, FIELD(ni), 0 },
    { "d", S_DISSOLVE, FIELD(d), 0 },
    { "Tr", S_TRANSPARENT, FIELD(d), 0 },
    { "illum", S_ILLUM, FIELD(illum), 0 },
    { "map_Kd", S_MAP, MTL_KD, 0 },
    { "map_d", S_MAP, MTL_D, 0 },
    { "map_Ks", S_MAP, MTL_KS, 0 },
    { "map_Ke", S_MAP, MTL_KE, 0 },
    { "map_Ns", S_MAP, MTL_NS, 0 },
    { "Pr", S_NUMBER, FIELD(roughness), 0 },
    { "Pm", S_NUMBER, FIELD(metallic), 0 },
    { "Pc", S_NUMBER, FIELD(coat), 0 },
    { "Pcr", S_NUMBER, FIELD(coat_roughness), 0 },
    { "aniso", S_NUMBER, FIELD(aniso), 0 },
    { "map_Pr", S_MAP, MTL_ROUGHNESS, 0 },
    { "map_Pm", S_MAP, MTL_METALLIC, 0 },
    { "norm", S_MAP, MTL_NORM, 0 },
    { "map_bump", S_MAP, MTL_BUMP, 0 },
    { "bump", S_MAP, MTL_BUMP, 0 },
    { "Ka", S_IGNORED, 0, 0 },          /* ambient light and its kin have no physical meaning */
    { "map_Ka", S_IGNORED, 0, 0 },
    { "sharpness", S_IGNORED, 0, 0 },
    { NULL, S_IGNORED, 0, 0 }
};

/* Options of maps and the most words each takes; only those of one to three numbers vary. */
static const struct { const char *name; int words; bool numbers; } options[] = {
    { "-blendu", 1, false }, { "-blendv", 1, false }, { "-cc", 1, false },
    { "-clamp", 1, false },  { "-imfchan", 1, false }, { "-type", 1, false },
    { "-bm", 1, true },      { "-boost", 1, true },    { "-texres", 1, true },
    { "-mm", 2, true },      { "-o", 3, true },        { "-s", 3, true },
    { "-t", 3, true },       { NULL, 0, false }
};

typedef struct {
    Text     t;
    MtlFile *f;
    MtlMaterial *m;                     /* the one being described, NULL before the first */
    bool     has_d;
    Skipped  skipped;
} Mtl;

static bool finite_number(Mtl *r, const char *what, float *v)
{
    Place at;
    text_blanks(&r->t);
    at = text_place(&r->t);
    if (!obj_number(&r->t, what, v))
        return false;
    return is_finite(*v) || err_at(at, "%s is infinite or not a number", what);
}

/* Sets the field at `offset` of the present material. */
static void store(Mtl *r, size_t offset, const void *v, size_t size)
{
    memcpy((char *)r->m + offset, v, size);
}

static bool read_number(Mtl *r, const Statement *s)
{
    float v;
    if (!finite_number(r, s->keyword, &v))
        return false;
    store(r, s->field, &v, sizeof v);
    return true;
}

/* One number is a grey. */
static bool read_colour(Mtl *r, const Statement *s)
{
    const bool given = true;
    Text back = r->t;
    Word w = obj_word(&r->t);
    Rgb c;

    if (word_is_nocase(w, "spectral") || word_is_nocase(w, "xyz")) {
        skipped_note(&r->skipped, SKIPPED_SPECTRUM, text_place_of(&r->t, w.s));
        return true;
    }
    r->t = back;
    if (!finite_number(r, s->keyword, &c.r))
        return false;
    back = r->t;
    c.g = c.b = c.r;
    if (obj_word(&r->t).n) {
        r->t = back;
        if (!finite_number(r, s->keyword, &c.g) || !finite_number(r, s->keyword, &c.b))
            return false;
    }
    store(r, s->field, &c, sizeof c);
    if (s->has)
        store(r, s->has, &given, sizeof given);
    return true;
}

/* d FACTOR, d -halo FACTOR, Tr FACTOR */
static bool read_dissolve(Mtl *r, const Statement *s)
{
    Text back = r->t;
    float v;

    if (!word_is_nocase(obj_word(&r->t), "-halo"))
        r->t = back;
    if (!finite_number(r, s->keyword, &v))
        return false;
    if (s->kind == S_DISSOLVE) {
        r->m->d = v;
        r->has_d = true;
    } else if (!r->has_d)
        r->m->d = 1.0f - v;
    return true;
}

static bool read_illum(Mtl *r)
{
    Word w = obj_word(&r->t);
    int64_t v;
    char copy[40];

    if (!w.n || number_int(w.s, w.s + w.n, &v, NULL) != w.n || v < 0 || v > 10)
        return err_at(text_place_of(&r->t, w.s), "illum is '%s', an integer from 0 to 10 was "
                      "expected", word_copy(copy, sizeof copy, w));
    r->m->illum = (signed char)v;
    return true;
}

/* Reads over one option, which has been found at place k of the table. The last word of the line
 * is the file's name, so numbers are taken only while something follows. */
static void skip_option(Text *t, int k)
{
    for (int i = 0; i < options[k].words; i++) {
        Text back = *t;
        Word w = obj_word(t), next;
        Text after = *t;
        float v;

        next = obj_word(t);
        *t = after;
        if (options[k].numbers && (number_float(w.s, w.s + w.n, &v) != w.n || !next.n)) {
            *t = back;
            return;
        }
    }
}

/* The number of -bm, which skip_option will read over; 1 if it is none. */
static void read_multiplier(Mtl *r)
{
    Text back = r->t;
    Word w = obj_word(&r->t);
    float v;

    if (number_float(w.s, w.s + w.n, &v) == w.n && w.n && is_finite(v))
        r->m->bump = v;
    r->t = back;
}

static bool read_map(Mtl *r, const Statement *s)
{
    Word name;
    const char *copy;
    MtlMap *map;

    for (;;) {
        Text back = r->t;
        Word w = obj_word(&r->t);
        int k = 0;
        while (options[k].name && !word_is_nocase(w, options[k].name))
            k++;
        if (options[k].name) {
            if (!strcmp(options[k].name, "-bm") && (s->field == MTL_BUMP || s->field == MTL_NORM))
                read_multiplier(r);
            skip_option(&r->t, k);
            continue;
        }
        if (w.n > 1 && w.s[0] == '-') {
            skipped_note(&r->skipped, SKIPPED_OPTION, text_place_of(&r->t, w.s));
            return true;
        }
        r->t = back;
        break;
    }
    name = obj_rest(&r->t);
    if (!name.n)
        return err_at(text_place_of(&r->t, name.s), "%s without a file, a name was expected",
                      s->keyword);
    copy = obj_check_name(&r->t, name) ? arena_string(&r->f->strings, name.s, name.n) : NULL;
    map = copy ? arena_take(&r->f->strings, 1, sizeof *map) : NULL;
    if (!map)
        return false;
    *map = (MtlMap){ r->m->maps, copy, (MtlMapKind)s->field };
    r->m->maps = map;
    return true;
}

static bool read_statement(Mtl *r, Word w)
{
    Place at = text_place_of(&r->t, w.s);
    const Statement *s = statements;

    while (s->keyword && !word_is_nocase(w, s->keyword))
        s++;
    if (!s->keyword) {
        skipped_keyword(&r->skipped, at, w);
        return true;
    }
    if (!r->m) {
        skipped_note(&r->skipped, SKIPPED_ORPHAN, at);
        return true;
    }
    switch (s->kind) {
    case S_COLOUR:      return read_colour(r, s);
    case S_NUMBER:      return read_number(r, s);
    case S_DISSOLVE:
    case S_TRANSPARENT: return read_dissolve(r, s);
    case S_ILLUM:       return read_illum(r);
    case S_MAP:         return read_map(r, s);
    case S_IGNORED:     break;
    }
    return true;
}

static bool begin_material(Mtl *r, Place at)
{
    static const MtlMaterial fresh = { .tf = { 1, 1, 1 },
                                       .bump = 1.0f, .ni = 1.0f, .d = 1.0f, .illum = -1,
                                       .roughness = -1.0f, .metallic = -1.0f };
    Word name = obj_rest(&r->t);

    if (!name.n)
        return err_at(at, "newmtl without a name, one was expected");
    if (!obj_check_name(&r->t, name))
        return false;
    if (!mem_grow(&r->f->m, &r->f->cap, r->f->n + 1, sizeof *r->f->m))
        return false;
    r->m = &r->f->m[r->f->n++];
    *r->m = fresh;
    r->m->at = at;
    r->m->name = arena_string(&r->f->strings, name.s, name.n);
    r->has_d = false;
    return r->m->name != NULL;
}

/* A material is large against the text that begins one, so room is made for as many as there are
 * and no more. */
static size_t count_materials(Text t)
{
    size_t n = 0;
    while (!text_done(&t)) {
        n += word_is_nocase(obj_word(&t), "newmtl");
        obj_next_line(&t);
    }
    return n;
}

static bool read_all(Mtl *r)
{
    if (!mem_grow(&r->f->m, &r->f->cap, count_materials(r->t), sizeof *r->f->m))
        return false;
    while (!text_done(&r->t)) {
        Word w = obj_word(&r->t);
        if (word_is_nocase(w, "newmtl")) {
            if (!begin_material(r, text_place_of(&r->t, w.s)))
                return false;
        } else if (w.n && !read_statement(r, w))
            return false;
        obj_next_line(&r->t);
    }
    return skipped_report(&r->skipped);
}

bool mtl_read(MtlFile *f, const char *path, const unsigned char *bytes, size_t n)
{
    Mtl r = { 0 };

    memset(f, 0, sizeof *f);
    r.f = f;
    text_init(&r.t, path, (const char *)bytes, n);
    if (read_all(&r))
        return true;
    mtl_clear(f);
    return false;
}

const char *mtl_map(const MtlMaterial *m, MtlMapKind kind)
{
    for (const MtlMap *map = m->maps; map; map = map->next)
        if (map->kind == kind)
            return map->name;
    return "";
}

void mtl_clear(MtlFile *f)
{
    mem_free(f->m);
    arena_clear(&f->strings);
    memset(f, 0, sizeof *f);
}
