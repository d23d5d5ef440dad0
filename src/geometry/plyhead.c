/* plyhead.c -- the header of a PLY file.
 *
 * Source  [Turk94], and what came to be written since: the names with a width (int8 ... float64),
 *         obj_info, and texture coordinates under four names.
 *
 * Any order of elements and properties is legal; what is not known is read over. */
#include "geometry/plyhead.h"

#include "base/mem.h"

#include <string.h>

const unsigned char ply_size[] = { 1, 1, 2, 2, 4, 4, 4, 8 };

static const struct { const char *name; PlyType type; } types[] = {
    { "char", PLY_I8 },   { "int8", PLY_I8 },     { "uchar", PLY_U8 },   { "uint8", PLY_U8 },
    { "short", PLY_I16 }, { "int16", PLY_I16 },   { "ushort", PLY_U16 }, { "uint16", PLY_U16 },
    { "int", PLY_I32 },   { "int32", PLY_I32 },   { "uint", PLY_U32 },   { "uint32", PLY_U32 },
    { "float", PLY_F32 }, { "float32", PLY_F32 }, { "double", PLY_F64 }, { "float64", PLY_F64 },
    { NULL, PLY_F32 }
};

static const struct { const char *name; PlyUse use; } uses[] = {
    { "x", PLY_X },         { "y", PLY_Y },         { "z", PLY_Z },
    { "nx", PLY_NX },       { "ny", PLY_NY },       { "nz", PLY_NZ },
    { "u", PLY_U },         { "v", PLY_V },         { "s", PLY_U },         { "t", PLY_V },
    { "texture_u", PLY_U }, { "texture_v", PLY_V }, { "texture_s", PLY_U }, { "texture_t", PLY_V },
    { NULL, PLY_UNUSED }
};

static bool fail(Word w, const Text *line, const char *what)
{
    char copy[40];
    Place at = text_place_of(line, w.s);
    return w.n ? err_at(at, "'%s', %s was expected", word_copy(copy, sizeof copy, w), what)
               : err_at(at, "the line ends, %s was expected", what);
}

static bool read_type(Text *line, PlyType *type)
{
    Word w = text_word(line);
    for (int k = 0; types[k].name; k++)
        if (word_is(w, types[k].name)) {
            *type = types[k].type;
            return true;
        }
    return fail(w, line, "a type (char, uchar, short, ushort, int, uint, float, double)");
}

static bool read_format(PlyHead *h, Text *line)
{
    Word w = text_word(line), version;

    if (word_is(w, "ascii"))
        h->format = PLY_ASCII;
    else if (word_is(w, "binary_little_endian"))
        h->format = PLY_LITTLE;
    else if (word_is(w, "binary_big_endian"))
        h->format = PLY_BIG;
    else
        return fail(w, line, "ascii, binary_little_endian or binary_big_endian");
    version = text_word(line);
    return word_is(version, "1.0") || fail(version, line, "version 1.0");
}

static bool read_element(PlyHead *h, Text *line, Place at)
{
    PlyElement e = { { NULL, 0 }, at, PLY_OTHER, 0, h->nproperties, 0, 0, false, 0 };
    int64_t count;
    Text back;

    e.name = text_word(line);
    if (!e.name.n)
        return fail(e.name, line, "the name of an element");
    back = *line;
    if (!text_int(line, &count) || count < 0)
        return fail(text_word(&back), line, "the number of records");
    e.count = (uint64_t)count;
    if (word_is(e.name, "vertex"))
        e.kind = PLY_VERTICES;
    else if (word_is(e.name, "face"))
        e.kind = PLY_FACES;
    else if (word_is(e.name, "tristrips"))
        e.kind = PLY_STRIPS;
    for (size_t k = 0; e.kind == PLY_VERTICES && k < h->n; k++)
        if (h->element[k].kind == PLY_VERTICES)
            return err_at(at, "a second element 'vertex', only one was expected");
    return MEM_PUSH(h->element, h->n, h->cap, e);
}

/* The use of a property of element e; the first of several for one use counts. */
static PlyUse use_of(const PlyElement *e, const PlyProperty *p)
{
    PlyUse use = PLY_UNUSED;

    if (e->kind == PLY_VERTICES && !p->is_list) {
        int k = 0;
        while (uses[k].name && !word_is(p->name, uses[k].name))
            k++;
        use = uses[k].use;
    } else if (e->kind != PLY_OTHER && e->kind != PLY_VERTICES &&
               (word_is(p->name, "vertex_indices") || word_is(p->name, "vertex_index")))
        use = PLY_INDICES;
    return use != PLY_UNUSED && (e->uses & 1u << use) ? PLY_UNUSED : use;
}

static bool read_property(PlyHead *h, Text *line, Place at)
{
    PlyProperty p = { { NULL, 0 }, false, PLY_F32, PLY_U8, PLY_UNUSED };
    PlyElement *e = h->n ? &h->element[h->n - 1] : NULL;
    Text back = *line;

    if (!e)
        return err_at(at, "property before any element, an element was expected");
    p.is_list = word_is(text_word(line), "list");
    if (!p.is_list)
        *line = back;
    if (p.is_list) {
        back = *line;
        if (!read_type(line, &p.count_type))
            return false;
        if (p.count_type >= PLY_F32)
            return fail(text_word(&back), line, "an integer type for the count");
    }
    back = *line;
    if (!read_type(line, &p.type))
        return false;
    p.name = text_word(line);
    if (!p.name.n)
        return fail(p.name, line, "the name of a property");
    p.use = use_of(e, &p);
    if (p.use == PLY_INDICES && (!p.is_list || p.type >= PLY_F32))
        return fail(text_word(&back), line, "a list of an integer type for indices");
    e->n++;
    e->uses |= 1u << p.use;
    e->has_list |= p.is_list;
    e->least += ply_size[p.is_list ? p.count_type : p.type];
    return MEM_PUSH(h->property, h->nproperties, h->cap_properties, p);
}

static bool has_all(const PlyElement *e, unsigned wanted)
{
    return (e->uses & wanted) == wanted;
}

/* What must hold before anything can be read. */
static bool check(PlyHead *h, bool has_format, Place at)
{
    if (!has_format)
        return err_at(at, "header without a format line, one was expected");
    for (size_t k = 0; k < h->n; k++) {
        PlyElement *e = &h->element[k];
        if (e->kind == PLY_VERTICES)
            h->vertices = e;
        else if (e->kind != PLY_OTHER && !has_all(e, 1u << PLY_INDICES)) {
            if (e->count)
                return err_at(e->at, "no list 'vertex_indices' or 'vertex_index' in this "
                              "element, one was expected");
            e->kind = PLY_OTHER;
        }
    }
    if (!h->vertices)
        return err_at(at, "header without an element 'vertex', one was expected");
    for (int u = PLY_X; u <= PLY_Z; u++)
        if (h->vertices->count && !has_all(h->vertices, 1u << u))
            return err_at(h->vertices->at, "element 'vertex' without a property '%s', x, y and z "
                          "were expected", uses[u].name);
    h->has_n = has_all(h->vertices, 1u << PLY_NX | 1u << PLY_NY | 1u << PLY_NZ);
    h->has_uv = has_all(h->vertices, 1u << PLY_U | 1u << PLY_V);
    return true;
}

static bool read_lines(PlyHead *h, Text *t)
{
    bool has_format = false;
    Text line;

    while (text_line(t, &line)) {
        Word w = text_word(&line);
        Place at = text_place_of(&line, w.s);
        bool ok = true;
        if (word_is(w, "end_header")) {
            h->body = *t;
            return check(h, has_format, at);
        }
        if (!w.n || word_is(w, "comment") || word_is(w, "obj_info"))
            continue;
        if (word_is(w, "format") && !has_format)
            ok = has_format = read_format(h, &line);
        else if (word_is(w, "element"))
            ok = read_element(h, &line, at);
        else if (word_is(w, "property"))
            ok = read_property(h, &line, at);
        else
            ok = fail(w, &line, "one of format (once), element, property, comment, obj_info, "
                      "end_header");
        w = ok ? text_word(&line) : (Word){ NULL, 0 };
        if (!ok || (w.n && !fail(w, &line, "the end of the line")))
            return false;
    }
    return err_at(text_place(t), "the file ends within the header, end_header was expected");
}

bool ply_head_read(PlyHead *h, const char *path, const char *bytes, size_t n)
{
    Text t, line;
    const char *end;
    bool lone_cr;

    memset(h, 0, sizeof *h);
    text_init(&t, path, bytes, n);
    if (!text_line(&t, &line) || !word_is(text_word(&line), "ply") || text_word(&line).n)
        return err_at((Place){ path, 1, 1 }, "not a PLY file, 'ply' alone on line 1 was expected");
    /* Where lines end in CR alone, a binary body may well begin with the byte of LF. */
    lone_cr = line.end < t.at && t.at - line.end == 1 && *line.end == '\r';
    if (!read_lines(h, &t)) {
        ply_head_clear(h);
        return false;
    }
    end = h->body.at;
    if (lone_cr && end - bytes >= 2 && end[-1] == '\n' && end[-2] == '\r')
        h->body.at--;
    return true;
}

void ply_head_clear(PlyHead *h)
{
    mem_free(h->element);
    mem_free(h->property);
    memset(h, 0, sizeof *h);
}
