/* reader.c -- the state of a reading: open files, tokens across them, paths, counted warnings.
 *
 * Paths       A relative name is looked for beside the main file, as pbrt does, and then beside the
 *             file that names it.
 * Places      point to texts that live as long as the scene, since lights keep theirs. */
#include "scenefile/reader.h"

#include <string.h>

bool reader_init(Reader *r, SceneFile *out, const char *path, const ReadLimits *limits)
{
    memset(r, 0, sizeof *r);
    r->out = out;
    r->scene = out->scene;
    r->limits = limits;
    r->state.ctm = r->state.end = xf_identity();
    r->state.at_start = r->state.at_end = true;
    r->state.inside = r->state.outside = NO_MEDIUM;
    r->main_path = arena_string(&r->scene->arena, path, strlen(path));
    return r->main_path != NULL;
}

void reader_clear(Reader *r)
{
    for (size_t i = 0; i < r->nsources; i++)
        file_clear(&r->sources[i].bytes);
    mem_free(r->sources);
    mem_free(r->stack);
    names_clear(&r->materials);
    names_clear(&r->float_textures);
    names_clear(&r->colour_textures);
    names_clear(&r->systems);
    names_clear(&r->objects);
    names_clear(&r->media);
    mem_free(r->masked);
    mem_free(r->textures);
    mem_free(r->transforms);
    mem_free(r->movers);
    pool_clear(&r->pool);
    mem_free(r->cie);
}

bool reader_finish(Reader *r)
{
    Transform none = xf_identity();

    if (!movers_place(r, (Place){ r->main_path, 0, 0 }, 0, &none, &none))
        return false;
    if (!r->degenerate)
        return true;
    return warn_at(r->degenerate_at,
                   "%lu triangle%s of zero area left out (this mesh has the first)",
                   (unsigned long)r->degenerate, r->degenerate == 1 ? " is" : "s are");
}

bool reader_once(Reader *r, Once what)
{
    bool first = !(r->said & what);
    r->said |= what;
    return first;
}

/* ---- tokens ---- */

bool reader_next(Reader *r, Token *t) { return lexer_next(&r->sources[r->nsources - 1].lexer, t); }
bool reader_peek(Reader *r, Token *t) { return lexer_peek(&r->sources[r->nsources - 1].lexer, t); }

bool reader_string(Reader *r, const char *what, Token *t)
{
    if (!reader_next(r, t))
        return false;
    if (t->kind != TOKEN_STRING)
        return err_at(t->at, "expected %s in quotes", what);
    return true;
}

bool reader_numbers(Reader *r, const char *what, size_t n, double *v)
{
    Token t;
    bool open;

    if (!reader_peek(r, &t))
        return false;
    open = t.kind == TOKEN_OPEN;
    if (open && !reader_next(r, &t))
        return false;
    for (size_t i = 0; i < n; i++) {
        if (!reader_next(r, &t))
            return false;
        if (t.kind != TOKEN_NUMBER)
            return err_at(t.at, "expected a number: %s takes %lu", what, (unsigned long)n);
        v[i] = t.number;
    }
    if (open && !reader_next(r, &t))
        return false;
    if (open && t.kind != TOKEN_CLOSE)
        return err_at(t.at, "expected ']': %s takes %lu numbers", what, (unsigned long)n);
    return true;
}

char *reader_keep(Arena *arena, const Token *t)
{
    char *s = arena_take(arena, t->n + 1, 1);
    if (s)
        token_text(t, s);
    return s;
}

char *reader_text(Reader *r, const Token *t)
{
    if (!mem_grow(&r->pool.text, &r->pool.cap_text, t->n + 1, 1))
        return NULL;
    token_text(t, r->pool.text);
    return r->pool.text;
}

/* ---- files ---- */

bool reader_file(Reader *r, Place at, const char *path, FileBytes *f)
{
    uint64_t left = r->limits->max_file - r->bytes_read;

    f->bytes = NULL;
    f->size = 0;
    if (at.file && !file_exists(path))
        return err_at(at, "the file %s cannot be found", path);
    if (!file_read(path, left, f))
        return false;
    r->bytes_read += f->size;
    return true;
}

char *reader_path(Reader *r, Place at, const char *name)
{
    char *beside_main = path_beside(r->main_path, name), *beside_it;

    if (!beside_main || !at.file || at.file == r->main_path || file_exists(beside_main))
        return beside_main;
    beside_it = path_beside(at.file, name);
    if (beside_it && file_exists(beside_it)) {
        mem_free(beside_main);
        return beside_it;
    }
    mem_free(beside_it);
    return beside_main;
}

bool reader_making(const Reader *r, Place at, const char *name, Making *m)
{
    char *path;

    memset(m, 0, sizeof *m);
    m->scene = r->scene;
    m->to_world = r->state.ctm;
    m->at = at;
    m->max_file = r->limits->max_file;
    m->max_pixels = r->limits->max_pixels;
    m->geometry = r->object;
    if (!name || !at.file || at.file == r->main_path)
        return true;
    path = path_beside(r->main_path, name);
    if (path && file_exists(path))
        m->at.file = r->main_path;
    mem_free(path);
    return path != NULL;
}

const Cie *reader_cie(Reader *r)
{
    if (!r->cie && (r->cie = MEM_NEW(Cie)) != NULL)
        cie_init(r->cie);
    return r->cie;
}

bool reader_generate(Reader *r, Place at, uint64_t ntriangles)
{
    if (ntriangles > GENERATED_MAX - r->generated)
        return err_at(at, "the curved shapes of the scene become more than %lu triangles",
                      (unsigned long)GENERATED_MAX);
    r->generated += ntriangles;
    return true;
}
