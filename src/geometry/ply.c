/* ply.c -- PLY files: ascii, binary little- and big-endian.
 *
 * Source  [Turk94]; `tristrips` as in the Stanford archive.
 *
 * Elements may come in any order. Vertices are read first, wherever they stand, because polygons
 * are cut by the positions of their corners; what stands above them is read over and, if it holds
 * faces, read again. Every PLY type fits a double, so one table of loaders serves all values. The
 * records of binary vertices without lists follow a plan made once. A walk over the counts of a
 * binary file first finds the number of triangles, and whether the file was cut.
 *
 * Places of faults: line and column in text; the byte in binary files. */
#include "geometry/meshfile.h"

#include "geometry/plyhead.h"
#include "geometry/polygon.h"

#include <stdarg.h>
#include <stdio.h>
#include <string.h>

#define FLOAT_MAX 0x1.fffffep127                /* the largest finite float */

typedef struct {
    Mesh       *mesh;
    PlyHead     head;
    Text        t;                      /* what is left; of a binary body, only at and end count */
    const char *bytes;                  /* of the whole file */
    PlyLoad *const *load;               /* by PlyType; NULL: ascii */
    const PlyElement *e;                /* being read */
    uint64_t    record;
    Polygon     polygon;
    Skipped     skipped;
} Ply;

/* What is no finite float (for C, a double beyond them is undefined as one) becomes infinite. */
static float narrow(double v) { return fabs(v) <= FLOAT_MAX ? (float)v : INFINITY; }

/* ---- faults ---- */

static bool fail(const Ply *r, const char *at, const char *fmt, ...) PRINTF_LIKE(3, 4);

/* At `at`, within the present record. */
static bool fail(const Ply *r, const char *at, const char *fmt, ...)
{
    char text[300], name[40];
    unsigned long long record = (unsigned long long)r->record + 1;
    va_list args;

    va_start(args, fmt);
    vsnprintf(text, sizeof text, fmt, args);
    va_end(args);
    word_copy(name, sizeof name, r->e->name);
    if (!r->load)
        return err_at(text_place_of(&r->t, at), "record %llu of element '%s': %s", record, name,
                      text);
    return err_at((Place){ r->t.file, 0, 0 }, "byte %llu, record %llu of element '%s': %s",
                  (unsigned long long)(at - r->bytes), record, name, text);
}

static bool fail_end(const Ply *r)
{
    return fail(r, r->t.end, "the file ends here, %llu records were expected",
                (unsigned long long)r->e->count);
}

static bool fail_word(Ply *r, const char *at, const char *expected)
{
    char copy[40];
    Word w = text_word(&r->t);

    return w.n ? fail(r, at, "'%s', %s was expected", word_copy(copy, sizeof copy, w), expected)
               : fail_end(r);
}

/* Room for `count` things of at least `least` bytes each in what is left. */
static bool holds(const Ply *r, uint64_t count, uint64_t least)
{
    uint64_t left = (uint64_t)(r->t.end - r->t.at);
    return !least || count <= left / least;
}

/* The claimed count of the present element against the bytes left. In text a value takes two
 * bytes, only the last of all may lack its white space. */
static bool check_count(Ply *r)
{
    const PlyElement *e = r->e;
    uint64_t left = (uint64_t)(r->t.end - r->t.at);
    bool ok = r->load ? holds(r, e->count, e->least)
                      : !e->n || e->count <= (left + 1) / (2 * (uint64_t)e->n);
    char name[40];

    return ok || err_at(e->at, "%llu records of element '%s' do not fit into the %llu bytes left",
                        (unsigned long long)e->count, word_copy(name, sizeof name, e->name),
                        (unsigned long long)left);
}

/* ---- one value ---- */

/* Where the next value begins. */
static const char *next_value(Ply *r)
{
    if (!r->load)
        text_space(&r->t);
    return r->t.at;
}

/* Of a binary file. */
static bool take_bytes(Ply *r, PlyType type, double *v)
{
    if (!holds(r, 1, ply_size[type]))
        return fail_end(r);
    *v = r->load[type]((const unsigned char *)r->t.at);
    r->t.at += ply_size[type];
    return true;
}

static bool take_integer(Ply *r, PlyType type, int64_t *v)
{
    const char *at = next_value(r);
    double x = 0.0;

    if (r->load) {
        if (!take_bytes(r, type, &x))
            return false;
        *v = (int64_t)x;
        return true;
    }
    return text_int(&r->t, v) || fail_word(r, at, "an integer");
}

static bool take_float(Ply *r, PlyType type, float *v)
{
    const char *at = next_value(r);
    double x = 0.0;

    if (r->load) {
        if (!take_bytes(r, type, &x))
            return false;
        *v = narrow(x);
        return true;
    }
    return text_float(&r->t, v) || fail_word(r, at, "a number");
}

/* Reads over n values. */
static bool skip_values(Ply *r, PlyType type, uint64_t n)
{
    if (r->load) {
        if (!holds(r, n, ply_size[type]))
            return fail_end(r);
        r->t.at += n * ply_size[type];
        return true;
    }
    for (; n; n--) {
        next_value(r);
        if (!text_word(&r->t).n)
            return fail_end(r);
    }
    return true;
}

/* The count of a list, which the bytes left can hold. */
static bool take_count(Ply *r, const PlyProperty *p, uint64_t *n)
{
    const char *at = next_value(r);
    int64_t v;

    if (!take_integer(r, p->count_type, &v))
        return false;
    if (v < 0)
        return fail(r, at, "a list of %lld values, a count from 0 was expected", (long long)v);
    *n = (uint64_t)v;
    return holds(r, *n, r->load ? ply_size[p->type] : 1) ||
           fail(r, at, "a list of %llu values does not fit into the %llu bytes left",
                (unsigned long long)*n, (unsigned long long)(r->t.end - r->t.at));
}

static bool skip_property(Ply *r, const PlyProperty *p)
{
    uint64_t n = 1;
    return (!p->is_list || take_count(r, p, &n)) && skip_values(r, p->type, n);
}

/* A record of text fills its lines. */
static bool end_record(Ply *r)
{
    int c;

    if (r->load)
        return true;
    text_blanks(&r->t);
    c = text_peek(&r->t);
    return c < 0 || c == '\n' || c == '\r' || fail_word(r, r->t.at, "the end of the line");
}

/* ---- elements ---- */

static const PlyProperty *properties(const Ply *r) { return r->head.property + r->e->first; }

/* The records of e come next. */
static bool begin_element(Ply *r, const PlyElement *e)
{
    r->e = e;
    r->record = 0;
    return check_count(r);
}

/* Reads over element e. Sets *triangles to the most that its lists of indices can give. */
static bool skip_element(Ply *r, const PlyElement *e, uint64_t *triangles)
{
    const PlyProperty *p;

    *triangles = 0;
    if (!begin_element(r, e))
        return false;
    if (!e->n || (r->load && !e->has_list)) {
        r->t.at += e->count * e->least;
        return true;
    }
    p = properties(r);
    for (; r->record < e->count; r->record++) {
        for (size_t k = 0; k < e->n; k++) {
            uint64_t n = 1;
            if ((p[k].is_list && !take_count(r, &p[k], &n)) || !skip_values(r, p[k].type, n))
                return false;
            if (p[k].use == PLY_INDICES && n > 2)
                *triangles += n - 2;
        }
        if (!end_record(r))
            return false;
    }
    return true;
}

static void store_vertex(Mesh *m, size_t i, const float *row)
{
    m->p[i] = v3(row[PLY_X], row[PLY_Y], row[PLY_Z]);
    if (m->n) {
        V3 n = v3(row[PLY_NX], row[PLY_NY], row[PLY_NZ]);
        m->n[i] = v_finite(n) ? v_unit(n) : v_all(0.0f);
    }
    if (m->uv && is_finite(row[PLY_U]) && is_finite(row[PLY_V]))
        m->uv[i] = (V2){ row[PLY_U], row[PLY_V] };
}

/* Records of any form, value by value. */
static bool read_vertices_freely(Ply *r)
{
    const PlyProperty *p = properties(r);
    float row[PLY_V + 1] = { 0 };

    for (; r->record < r->e->count; r->record++) {
        for (size_t k = 0; k < r->e->n; k++) {
            const char *at = next_value(r);
            if (p[k].use > PLY_V) {
                if (!skip_property(r, &p[k]))
                    return false;
                continue;
            }
            if (!take_float(r, p[k].type, &row[p[k].use]))
                return false;
            if (p[k].use <= PLY_Z && !is_finite(row[p[k].use]))
                return fail(r, at, "position that is not finite, finite ones were expected");
        }
        if (!end_record(r))
            return false;
        store_vertex(r->mesh, (size_t)r->record, row);
    }
    return true;
}

/* Binary records of one length, by a plan; check_count has seen that they are all there. */
static bool read_vertices_planned(Ply *r)
{
    struct { PlyLoad *load; size_t offset; PlyUse use; } plan[PLY_V + 1];
    const PlyProperty *p = properties(r);
    const unsigned char *b = (const unsigned char *)r->t.at;
    size_t n = 0, offset = 0;
    float row[PLY_V + 1] = { 0 };

    for (size_t k = 0; k < r->e->n; offset += ply_size[p[k++].type])
        if (p[k].use <= PLY_V) {
            plan[n].load = r->load[p[k].type];
            plan[n].offset = offset;
            plan[n++].use = p[k].use;
        }
    for (; r->record < r->e->count; r->record++, b += offset) {
        for (size_t k = 0; k < n; k++)
            row[plan[k].use] = narrow(plan[k].load(b + plan[k].offset));
        if (!is_finite(row[PLY_X]) || !is_finite(row[PLY_Y]) || !is_finite(row[PLY_Z]))
            return fail(r, (const char *)b, "position that is not finite, finite ones were "
                        "expected");
        store_vertex(r->mesh, (size_t)r->record, row);
    }
    r->t.at = (const char *)b;
    return true;
}

static bool read_vertices(Ply *r, const PlyElement *e)
{
    Mesh *m = r->mesh;
    size_t n = (size_t)e->count;

    if (!begin_element(r, e))
        return false;
    if (!n)
        return true;
    if (e->count > MESH_MAX)
        return err_at(e->at, "more than %lu vertices in one mesh", (unsigned long)MESH_MAX);
    m->p = MEM_ARRAY(V3, n);
    m->n = r->head.has_n ? MEM_ARRAY(V3, n) : NULL;
    m->uv = r->head.has_uv ? MEM_ARRAY(V2, n) : NULL;
    if (!m->p || (r->head.has_n && !m->n) || (r->head.has_uv && !m->uv))
        return false;
    m->nverts = (uint32_t)n;
    return r->load && !e->has_list ? read_vertices_planned(r) : read_vertices_freely(r);
}

static bool take_index(Ply *r, PlyType type, int64_t least, int64_t *v)
{
    const char *at = next_value(r);

    if (!take_integer(r, type, v))
        return false;
    return (*v >= least && *v < (int64_t)r->mesh->nverts) ||
           fail(r, at, "index %lld, %lu vertices from 0 were expected", (long long)*v,
                (unsigned long)r->mesh->nverts);
}

static bool read_polygon(Ply *r, const PlyProperty *p, uint64_t n)
{
    const Place at = r->load ? (Place){ r->t.file, 0, 0 } : text_place(&r->t);
    int64_t v;

    for (; n; n--)
        if (!take_index(r, p->type, 0, &v) ||
            !polygon_corner(&r->polygon, (uint32_t)v, r->mesh->p[v]))
            return false;
    return polygon_end(&r->polygon, at);
}

/* Each index beyond the second of a strip makes a triangle with the two before it, turned round
 * at every other one. -1 ends a strip. */
static bool read_strip(Ply *r, const PlyProperty *p, uint64_t n)
{
    uint64_t length = 0;
    uint32_t a = 0, b = 0;
    int64_t v;

    for (; n; n--) {
        if (!take_index(r, p->type, -1, &v))
            return false;
        if (v < 0) {
            length = 0;
            continue;
        }
        if (++length > 2 && !(length & 1 ? polygon_triangle(&r->polygon, a, b, (uint32_t)v)
                                         : polygon_triangle(&r->polygon, b, a, (uint32_t)v)))
            return false;
        a = b;
        b = (uint32_t)v;
    }
    return true;
}

static bool read_list(Ply *r, const PlyProperty *p)
{
    uint64_t n;
    if (!take_count(r, p, &n))
        return false;
    return r->e->kind == PLY_STRIPS ? read_strip(r, p, n) : read_polygon(r, p, n);
}

static bool read_faces(Ply *r, const PlyElement *e)
{
    const PlyProperty *p;

    if (!begin_element(r, e))
        return false;
    p = properties(r);
    for (; r->record < e->count; r->record++) {
        for (size_t k = 0; k < e->n; k++)
            if (!(p[k].use == PLY_INDICES ? read_list(r, &p[k]) : skip_property(r, &p[k])))
                return false;
        if (!end_record(r))
            return false;
    }
    return true;
}

static bool read_element(Ply *r, const PlyElement *e)
{
    uint64_t triangles;
    return e->kind == PLY_FACES || e->kind == PLY_STRIPS ? read_faces(r, e)
                                                         : skip_element(r, e, &triangles);
}

/* ---- the file ---- */

static void note_rest(Ply *r)
{
    text_space(&r->t);
    if (text_done(&r->t))
        return;
    skipped_note(&r->skipped, SKIPPED_TAIL, r->load ? (Place){ r->t.file, 0, 0 }
                                                    : text_place(&r->t));
    r->skipped.n[SKIPPED_TAIL] = (size_t)(r->t.end - r->t.at);
}

/* A walk over a binary file: it is whole, and there is room for its triangles. An index may take
 * one byte and a triangle twelve, so no more room than that. */
static bool walk(Ply *r)
{
    uint64_t all = 0, triangles;

    for (size_t k = 0; k < r->head.n; k++, all += triangles)
        if (!skip_element(r, &r->head.element[k], &triangles))
            return false;
    r->t = r->head.body;
    return polygon_room(&r->polygon, all);
}

static bool read_body(Ply *r)
{
    const PlyElement *e = r->head.element, *end = e + r->head.n;
    uint64_t triangles;
    bool faces_above = false;

    if (r->load && !walk(r))
        return false;
    for (; e != r->head.vertices; e++) {
        faces_above |= e->kind != PLY_OTHER;
        if (!skip_element(r, e, &triangles))
            return false;
    }
    if (!read_vertices(r, e++))
        return false;
    if (faces_above) {
        r->t = r->head.body;
        e = r->head.element;
    }
    for (; e != end; e++)
        if (!read_element(r, e))
            return false;
    note_rest(r);
    if (!r->mesh->ntris)
        skipped_note(&r->skipped, SKIPPED_ALL, (Place){ r->t.file, 0, 0 });
    return skipped_report(&r->skipped);
}

bool ply_read(Mesh *m, const char *path, const unsigned char *bytes, size_t n)
{
    Ply r = { 0 };
    bool ok;

    *m = (Mesh){ 0 };
    r.mesh = m;
    r.bytes = (const char *)bytes;
    if (!ply_head_read(&r.head, path, r.bytes, n))
        return false;
    r.t = r.head.body;
    r.load = ply_loaders(r.head.format);
    polygon_init(&r.polygon, m, &r.skipped, path, n);
    ok = read_body(&r);
    polygon_clear(&r.polygon);
    ply_head_clear(&r.head);
    if (!ok)
        mesh_clear(m);
    return ok;
}
