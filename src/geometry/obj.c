/* obj.c -- Wavefront OBJ files.
 *
 * Source  Wavefront Advanced Visualizer, appendix B1 (object files): v, vt, vn, f, usemtl, mtllib.
 *
 * The text is read twice: first the lists of v, vt and vn, then the faces, which may refer to what
 * stands below them. A file without vt and vn keeps its vertices as they stand. In all others a
 * corner is a triple (v, vt, vn), and each distinct triple becomes one vertex of the mesh, in order
 * of first use.
 *
 * An index of a position must exist; one of a normal or a texture coordinate that does not is left
 * out and counted, because many exporters are wrong there and the shape is not. Lines, points and
 * free-form surfaces are counted as not supported; groups (o, g, s) mean nothing to a renderer. */
#include "geometry/meshfile.h"

#include "base/number.h"
#include "base/random.h"
#include "geometry/lookup.h"
#include "geometry/objtext.h"
#include "geometry/polygon.h"

#include <string.h>

#define ABSENT 0xFFFFFFFFu                              /* no such attribute at this corner */

typedef struct { uint32_t p, uv, n; } Corner;           /* indices into the three lists */
typedef struct { uint32_t tri, group; } Run;            /* group of the triangles from tri on */

typedef struct {
    Text     t;
    ObjFile *f;
    V3      *p, *n;                                     /* owned: the lists */
    V2      *uv;
    size_t   np, nn, nuv, cap_p, cap_n, cap_uv;
    size_t   seen_p, seen_n, seen_uv;                   /* above this line, in the second reading */
    bool     plain;                                     /* positions only */
    Corner  *corner;                                    /* owned: of each vertex, unless plain */
    size_t   ncorners, cap_corners;
    Lookup   corners, groups, libs;
    Word     material;                                  /* of the faces to come */
    bool     material_new;                              /* no face had it yet */
    Run     *run;                                       /* owned */
    size_t   nruns, cap_runs;
    Polygon  polygon;
    Skipped  skipped;
} Obj;

/* ---- the lists ---- */

static bool read_v3(Text *t, const char *what, V3 *v)
{
    return obj_number(t, what, &v->x) && obj_number(t, what, &v->y) && obj_number(t, what, &v->z);
}

static bool read_position(Obj *o)
{
    Place at;
    V3 p;

    text_blanks(&o->t);
    at = text_place(&o->t);
    if (!read_v3(&o->t, "coordinate of a vertex", &p))
        return false;
    if (!v_finite(p))
        return err_at(at, "vertex that is infinite or not a number, finite ones were expected");
    return MEM_PUSH(o->p, o->np, o->cap_p, p);
}

static bool read_normal(Obj *o)
{
    V3 n;
    if (!read_v3(&o->t, "coordinate of a normal", &n))
        return false;
    n = v_finite(n) ? v_unit(n) : v_all(0.0f);
    return MEM_PUSH(o->n, o->nn, o->cap_n, n);
}

/* One to three numbers, of which the third is of no use for surfaces. */
static bool read_uv(Obj *o)
{
    V2 uv = { 0.0f, 0.0f };
    Text back;

    if (!obj_number(&o->t, "texture coordinate", &uv.x))
        return false;
    back = o->t;
    if (obj_word(&o->t).n) {
        o->t = back;
        if (!obj_number(&o->t, "texture coordinate", &uv.y))
            return false;
    }
    if (!is_finite(uv.x) || !is_finite(uv.y))
        uv = (V2){ 0.0f, 0.0f };
    return MEM_PUSH(o->uv, o->nuv, o->cap_uv, uv);
}

static bool read_lists(Obj *o)
{
    while (!text_done(&o->t)) {
        Word w = obj_word(&o->t);
        if ((word_is(w, "v") && !read_position(o)) || (word_is(w, "vn") && !read_normal(o)) ||
            (word_is(w, "vt") && !read_uv(o)))
            return false;
        obj_next_line(&o->t);
    }
    if (o->np > MESH_MAX || o->nn > MESH_MAX || o->nuv > MESH_MAX)
        return err_at((Place){ o->t.file, 0, 0 }, "more than %lu vertices in one mesh",
                      (unsigned long)MESH_MAX);
    return true;
}

/* ---- corners of faces ---- */

/* Reads an index at [*s, end) and makes it count from 0; `seen` of a list of n stand above. False:
 * no index there; out of range gives ABSENT. */
static bool take_index(const char **s, const char *end, size_t seen, size_t n, uint32_t *index)
{
    int64_t i;
    size_t taken = number_int(*s, end, &i, NULL);

    if (!taken)
        return false;
    *s += taken;
    i = i > 0 ? i - 1 : i < 0 && i >= -(int64_t)seen ? i + (int64_t)seen : (int64_t)n;
    *index = i < (int64_t)n ? (uint32_t)i : ABSENT;
    return true;
}

/* One of the attributes after a slash; an empty one is absent. */
static bool take_attribute(Obj *o, const char **s, Word w, size_t seen, size_t n, uint32_t *index)
{
    const char *end = w.s + w.n;

    *index = ABSENT;
    if (*s >= end || **s != '/')
        return true;
    ++*s;
    if (*s >= end || **s == '/')
        return true;
    if (!take_index(s, end, seen, n, index))
        return false;
    if (*index == ABSENT)
        skipped_note(&o->skipped, SKIPPED_ATTRIBUTE, text_place_of(&o->t, w.s));
    return true;
}

/* v, v/vt, v//vn or v/vt/vn */
static bool parse_corner(Obj *o, Word w, Corner *c)
{
    const char *s = w.s;
    char copy[40];

    if (!take_index(&s, w.s + w.n, o->seen_p, o->np, &c->p) ||
        !take_attribute(o, &s, w, o->seen_uv, o->nuv, &c->uv) ||
        !take_attribute(o, &s, w, o->seen_n, o->nn, &c->n) || s != w.s + w.n)
        return err_at(text_place_of(&o->t, w.s),
                      "corner '%s', v, v/vt, v//vn or v/vt/vn with integers was expected",
                      word_copy(copy, sizeof copy, w));
    if (c->p == ABSENT)
        return err_at(text_place_of(&o->t, w.s),
                      "corner '%s', but there are %lu vertices (%lu above); indices count from 1",
                      word_copy(copy, sizeof copy, w), (unsigned long)o->np,
                      (unsigned long)o->seen_p);
    return true;
}

/* The vertex of the mesh that is corner c. False: out of memory. */
static bool vertex_of(Obj *o, Corner c, uint32_t *vertex)
{
    uint32_t hash = (uint32_t)(mix64(((uint64_t)c.p << 32 | c.uv) + mix64(c.n)) >> 32);
    uint32_t probe = 0, id;

    while ((id = lookup_next(&o->corners, hash, &probe)) != LOOKUP_NONE) {
        const Corner *k = &o->corner[id];
        if (k->p == c.p && k->uv == c.uv && k->n == c.n) {
            *vertex = id;
            return true;
        }
    }
    if (o->ncorners >= MESH_MAX)
        return err_at(text_place(&o->t), "more than %lu vertices in one mesh",
                      (unsigned long)MESH_MAX);
    *vertex = (uint32_t)o->ncorners;
    return MEM_PUSH(o->corner, o->ncorners, o->cap_corners, c) &&
           lookup_add(&o->corners, hash, *vertex);
}

/* ---- names ---- */

/* Number of `name` in the list, which it joins if it is new. */
static bool name_index(Obj *o, Lookup *l, const char ***names, size_t *n, size_t *cap, Word name,
                       size_t *index)
{
    uint32_t hash = lookup_hash_bytes(name.s, name.n), probe = 0, id;
    const char *copy;

    while ((id = lookup_next(l, hash, &probe)) != LOOKUP_NONE)
        if (word_is(name, (*names)[id])) {
            *index = id;
            return true;
        }
    copy = arena_string(&o->f->strings, name.s, name.n);
    if (!copy || !mem_grow(names, cap, *n + 1, sizeof **names))
        return false;
    *index = (*n)++;
    (*names)[*index] = copy;
    return lookup_add(l, hash, (uint32_t)*index);
}

static bool add_library(Obj *o, const char *s, const char *end)
{
    ObjFile *f = o->f;
    Word name = { s, (size_t)(end - s) };
    size_t index;
    return obj_check_name(&o->t, name) &&
           name_index(o, &o->libs, &f->mtllibs, &f->nmtllibs, &f->cap_mtllibs, name, &index);
}

/* Names are separated by blanks, but exporters write names with blanks in them: a name ends where
 * ".mtl" does, and only words after the last ".mtl" of the line are names of their own. */
static bool read_libraries(Obj *o)
{
    const char *start = NULL;
    Text back = o->t;
    Word w;

    while ((w = obj_word(&o->t)).n) {
        start = start ? start : w.s;
        if (w.n < 4 || !word_is_nocase((Word){ w.s + w.n - 4, 4 }, ".mtl"))
            continue;
        if (!add_library(o, start, w.s + w.n))
            return false;
        start = NULL;
        back = o->t;
    }
    if (!start)
        return true;
    o->t = back;
    while ((w = obj_word(&o->t)).n)
        if (!add_library(o, w.s, w.s + w.n))
            return false;
    return true;
}

/* Before the triangles of a face: its material becomes a group when it is new. */
static bool begin_group(Obj *o)
{
    ObjFile *f = o->f;
    Run run = { f->mesh.ntris, 0 };
    size_t index;

    if (!o->material_new)
        return true;
    o->material_new = false;
    if (!name_index(o, &o->groups, &f->group_names, &f->ngroups, &f->cap_groups, o->material,
                    &index))
        return false;
    run.group = (uint32_t)index;
    return MEM_PUSH(o->run, o->nruns, o->cap_runs, run);
}

/* ---- faces and the other statements ---- */

static bool read_face(Obj *o, Place at)
{
    Word w;

    while ((w = obj_word(&o->t)).n) {
        Corner c = { 0, 0, 0 };
        uint32_t vertex;
        if (!parse_corner(o, w, &c))
            return false;
        vertex = c.p;
        if (!o->plain && !vertex_of(o, c, &vertex))
            return false;
        if (o->polygon.n == 2 && !begin_group(o))
            return false;
        if (!polygon_corner(&o->polygon, vertex, o->p[c.p]))
            return false;
    }
    return polygon_end(&o->polygon, at);
}

static bool is_one_of(Word w, const char *const *names)
{
    for (; *names; names++)
        if (word_is(w, *names))
            return true;
    return false;
}

static bool read_statement(Obj *o, Word w, Place at)
{
    static const char *const ignored[] = { "o", "g", "s", "mg", "bevel", "c_interp", "d_interp",
                                           "lod", "shadow_obj", "trace_obj", "vp", NULL };
    if (word_is(w, "v"))
        o->seen_p++;
    else if (word_is(w, "vt"))
        o->seen_uv++;
    else if (word_is(w, "vn"))
        o->seen_n++;
    else if (word_is(w, "f") || word_is(w, "fo"))
        return read_face(o, at);
    else if (word_is(w, "usemtl")) {
        o->material = obj_rest(&o->t);
        o->material_new = true;
        return obj_check_name(&o->t, o->material);
    } else if (word_is(w, "mtllib"))
        return read_libraries(o);
    else if (!is_one_of(w, ignored))
        skipped_keyword(&o->skipped, at, w);
    return true;
}

static bool read_faces(Obj *o)
{
    while (!text_done(&o->t)) {
        Word w = obj_word(&o->t);
        if (w.n && !read_statement(o, w, text_place_of(&o->t, w.s)))
            return false;
        obj_next_line(&o->t);
    }
    return true;
}

/* ---- the mesh ---- */

/* Gives each vertex what its corner names, and lists that no corner names to none. */
static bool gather_vertices(Obj *o)
{
    Mesh *m = &o->f->mesh;
    bool any_uv = false, any_n = false;

    lookup_clear(&o->corners);
    for (size_t i = 0; i < o->ncorners; i++) {
        any_uv |= o->corner[i].uv != ABSENT;
        any_n |= o->corner[i].n != ABSENT;
    }
    m->p = MEM_ARRAY(V3, o->ncorners);
    m->uv = any_uv ? MEM_ARRAY(V2, o->ncorners) : NULL;
    m->n = any_n ? MEM_ARRAY(V3, o->ncorners) : NULL;
    if (!m->p || (any_uv && !m->uv) || (any_n && !m->n))
        return false;
    for (size_t i = 0; i < o->ncorners; i++) {
        Corner c = o->corner[i];
        m->p[i] = o->p[c.p];
        if (c.uv != ABSENT)
            m->uv[i] = o->uv[c.uv];
        if (c.n != ABSENT)
            m->n[i] = o->n[c.n];
    }
    m->nverts = (uint32_t)o->ncorners;
    return true;
}

static bool label_triangles(Obj *o)
{
    Mesh *m = &o->f->mesh;

    if (o->f->ngroups < 2)
        return true;
    m->group = MEM_ARRAY(uint32_t, m->ntris);
    if (!m->group)
        return false;
    for (size_t r = 0; r < o->nruns; r++) {
        uint32_t end = r + 1 < o->nruns ? o->run[r + 1].tri : m->ntris;
        for (uint32_t i = o->run[r].tri; i < end; i++)
            m->group[i] = o->run[r].group;
    }
    return true;
}

static bool read_all(Obj *o)
{
    Mesh *m = &o->f->mesh;
    Text start = o->t;

    if (!read_lists(o))
        return false;
    o->plain = !o->nuv && !o->nn;
    o->t = start;
    if (!read_faces(o))
        return false;
    if (o->plain) {
        m->p = o->p;
        m->nverts = (uint32_t)o->np;
        o->p = NULL;
    } else if (!gather_vertices(o))
        return false;
    if (!m->ntris)
        skipped_note(&o->skipped, SKIPPED_ALL, (Place){ o->t.file, 0, 0 });
    return label_triangles(o) && skipped_report(&o->skipped);
}

bool obj_read(ObjFile *f, const char *path, const unsigned char *bytes, size_t n)
{
    Obj o = { 0 };
    bool ok;

    memset(f, 0, sizeof *f);
    o.f = f;
    o.material = (Word){ "", 0 };
    o.material_new = true;
    text_init(&o.t, path, (const char *)bytes, n);
    polygon_init(&o.polygon, &f->mesh, &o.skipped, path, n);
    ok = read_all(&o);
    mem_free(o.p);
    mem_free(o.n);
    mem_free(o.uv);
    mem_free(o.corner);
    mem_free(o.run);
    lookup_clear(&o.corners);
    lookup_clear(&o.groups);
    lookup_clear(&o.libs);
    polygon_clear(&o.polygon);
    if (!ok)
        obj_clear(f);
    return ok;
}

void obj_clear(ObjFile *f)
{
    mesh_clear(&f->mesh);
    mem_free(f->group_names);
    mem_free(f->mtllibs);
    arena_clear(&f->strings);
    memset(f, 0, sizeof *f);
}
