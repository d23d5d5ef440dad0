/* scenefile.c -- reading a scene by the extension of its file. See scenefile.h. */
#include "scenefile/reader.h"

#include "scenefile/shapes.h"

#include <string.h>

static bool read_pbrt(Reader *r, const char *path)
{
    FileBytes f;
    bool ok = reader_file(r, (Place){ NULL, 0, 0 }, path, &f);

    ok = ok && source_push(r, r->main_path, f.bytes, f.size) && parser_run(r);
    file_clear(&f);
    return ok;
}

static bool read_obj(Reader *r, const char *path)
{
    return objfile_add(r, (Place){ NULL, 0, 0 }, path);
}

static bool read_ply(Reader *r, const char *path)
{
    FileBytes f;
    Mesh m;
    bool ok;

    if (!file_read(path, r->limits->max_file, &f))
        return false;
    ok = ply_read(&m, path, (const unsigned char *)f.bytes, f.size);
    file_clear(&f);
    return ok && shape_add_mesh(r, (Place){ r->main_path, 0, 0 }, &m, 0, NULL);
}

static const struct {
    const char *extension;
    bool (*read)(Reader *r, const char *path);
} formats[] = { { "pbrt", read_pbrt }, { "obj", read_obj }, { "ply", read_ply } };
enum { NFORMATS = sizeof formats / sizeof *formats };

/* Which of them a file is by its name; NFORMATS: none. */
static int format_of(const char *path)
{
    const char *ext = path_extension(path);
    int i = 0;
    while (i < NFORMATS && !word_is_nocase((Word){ ext, strlen(ext) }, formats[i].extension))
        i++;
    return i;
}

bool scenefile_is_scene(const char *path) { return format_of(path) < NFORMATS; }

static bool read_any(Reader *r, const char *path)
{
    int i = format_of(path);
    return i < NFORMATS ? formats[i].read(r, path)
                        : err_at((Place){ path, 0, 0 },
                                 "a scene was expected: .pbrt, .obj or .ply");
}

/* ---- a shape by its name ---- */

bool scenefile_is_shape(const char *text)
{
    size_t n = strcspn(text, ":");

    for (int k = 0; shape_readers[k]; k++) {
        const char *name = shape_readers[k]->info.name;
        if (strlen(name) == n && !memcmp(name, text, n))
            return true;
    }
    return false;
}

static bool read_shape(Reader *r, const char *text)
{
    const Params none = { NULL, 0 };
    Place at = { r->main_path, 0, 0 };
    Opts o;
    const ShapeReader *shape = kind_from_text(shape_readers, "shape", text, &o, &r->scene->arena);

    return shape && (shape->read ? shape->read(r, at, &none, &o)
                                 : err_at(at, "the shape is not supported"));
}

/* ---- any ---- */

static bool read_text(Reader *r, const char *text, size_t n)
{
    return source_push(r, r->main_path, text, n) && parser_run(r);
}

/* What is at hand: a file, a text of the scene language, a shape's name. */
typedef enum { FROM_FILE, FROM_TEXT, FROM_SHAPE } From;

static bool read_with(SceneFile *f, const char *path, From from, const char *text, size_t n,
                      const ReadLimits *limits)
{
    Reader *r = MEM_NEW(Reader);
    bool ok;

    memset(f, 0, sizeof *f);
    f->scene = r ? scene_new() : NULL;
    ok = f->scene && reader_init(r, f, path, limits);
    if (ok)
        ok = from == FROM_FILE ? read_any(r, path) : from == FROM_TEXT ? read_text(r, text, n)
                                                                       : read_shape(r, text);
    ok = ok && reader_finish(r);
    if (r)
        reader_clear(r);
    mem_free(r);
    if (!ok) {
        scenefile_clear(f);
        return false;
    }
    f->bare = !f->scene->camera && !f->scene->nlights;
    return true;
}

bool scenefile_read(SceneFile *f, const char *path, const ReadLimits *limits)
{
    return read_with(f, path, FROM_FILE, NULL, 0, limits);
}

bool scenefile_parse(SceneFile *f, const char *path, const char *text, size_t n,
                     const ReadLimits *limits)
{
    return read_with(f, path, FROM_TEXT, text, n, limits);
}

bool scenefile_shape(SceneFile *f, const char *text, const ReadLimits *limits)
{
    return read_with(f, text, FROM_SHAPE, text, 0, limits);
}

void scenefile_clear(SceneFile *f)
{
    scene_free(f->scene);
    arena_clear(&f->arena);
    memset(f, 0, sizeof *f);
}
