/* parser.c -- the grammar of the scene language: which directives there are, where they may stand,
 * and the files that Include and Import open.
 *
 * Source   The file formats of pbrt, versions 3 and 4 (and names of version 2 that still occur).
 * Departs  A file without a Camera may begin with shapes: it is taken as a part of a world, so that
 *          pieces that scenes include can be looked at by themselves. */
#include "scenefile/reader.h"

#include <string.h>

typedef enum { ANYWHERE, OPTIONS_ONLY, WORLD_ONLY } Where;
typedef struct { const char *name; Directive run; Where where; } Entry;

static bool do_world_begin(Reader *r, Place at);
static bool do_world_end(Reader *r, Place at);
static bool do_include(Reader *r, Place at);
static bool do_import(Reader *r, Place at);

static const Entry directives[] = {
    { "Accelerator", do_accelerator, OPTIONS_ONLY },
    { "ActiveTransform", do_active_transform, ANYWHERE },
    { "AreaLightSource", do_area_light_source, WORLD_ONLY },
    { "Attribute", do_attribute, ANYWHERE },
    { "AttributeBegin", do_attribute_begin, ANYWHERE },
    { "AttributeEnd", do_attribute_end, ANYWHERE },
    { "Camera", do_camera, OPTIONS_ONLY },
    { "ColorSpace", do_color_space, ANYWHERE },
    { "ConcatTransform", do_concat_transform, ANYWHERE },
    { "CoordinateSystem", do_coordinate_system, ANYWHERE },
    { "CoordSysTransform", do_coord_sys_transform, ANYWHERE },
    { "Film", do_film, OPTIONS_ONLY },
    { "Identity", do_identity, ANYWHERE },
    { "Import", do_import, WORLD_ONLY },
    { "Include", do_include, ANYWHERE },
    { "Integrator", do_integrator, OPTIONS_ONLY },
    { "LightSource", do_light_source, WORLD_ONLY },
    { "LookAt", do_look_at, ANYWHERE },
    { "MakeNamedMaterial", do_make_named_material, WORLD_ONLY },
    { "MakeNamedMedium", do_make_named_medium, ANYWHERE },
    { "Material", do_material, WORLD_ONLY },
    { "MediumInterface", do_medium_interface, ANYWHERE },
    { "NamedMaterial", do_named_material, WORLD_ONLY },
    { "ObjectBegin", do_object_begin, WORLD_ONLY },
    { "ObjectEnd", do_object_end, WORLD_ONLY },
    { "ObjectInstance", do_object_instance, WORLD_ONLY },
    { "Option", do_option, OPTIONS_ONLY },
    { "PixelFilter", do_pixel_filter, OPTIONS_ONLY },
    { "ReverseOrientation", do_reverse_orientation, ANYWHERE },
    { "Rotate", do_rotate, ANYWHERE },
    { "Sampler", do_sampler, OPTIONS_ONLY },
    { "Scale", do_scale, ANYWHERE },
    { "Shape", do_shape, WORLD_ONLY },
    { "SurfaceIntegrator", do_integrator, OPTIONS_ONLY },
    { "Texture", do_texture, WORLD_ONLY },
    { "Transform", do_transform, ANYWHERE },
    { "TransformBegin", do_transform_begin, ANYWHERE },
    { "TransformEnd", do_transform_end, ANYWHERE },
    { "TransformTimes", do_transform_times, ANYWHERE },
    { "Translate", do_translate, ANYWHERE },
    { "VolumeIntegrator", do_volume_integrator, OPTIONS_ONLY },
    { "WorldBegin", do_world_begin, OPTIONS_ONLY },
    { "WorldEnd", do_world_end, ANYWHERE },
};
enum { NDIRECTIVES = sizeof directives / sizeof *directives };

/* ---- files ---- */

/* Says how the file came to be included from within itself. */
static bool tell_cycle(Reader *r, Place at, size_t first, const char *path)
{
    char chain[600] = "";
    for (size_t i = first; i < r->nsources; i++) {
        size_t used = strlen(chain), n = strlen(r->sources[i].path);
        if (used + n + 12 > sizeof chain)
            break;
        memcpy(chain + used, r->sources[i].path, n);
        memcpy(chain + used + n, " includes ", 11);
    }
    return err_at(at, "a file includes itself: %s%.200s", chain, path);
}

static bool may_open(Reader *r, Place at, const char *path)
{
    for (size_t i = 0; i < r->nsources; i++)
        if (!strcmp(r->sources[i].path, path))
            return tell_cycle(r, at, i, path);
    if (r->nsources > (size_t)(r->limits->max_include > 0 ? r->limits->max_include : 0))
        return err_at(at, "files include each other more than %d deep", r->limits->max_include);
    if (r->includes++ >= INCLUDES_MAX)
        return err_at(at, "more than %d files are included", INCLUDES_MAX);
    return true;
}

bool source_push(Reader *r, const char *path, const char *text, size_t n)
{
    Source *s;

    if (!mem_grow(&r->sources, &r->cap_sources, r->nsources + 1, sizeof *r->sources))
        return false;
    s = &r->sources[r->nsources++];
    memset(s, 0, sizeof *s);
    s->path = path;
    s->depth = r->nstack;
    lexer_init(&s->lexer, path, text, n);
    return true;
}

static bool open_file(Reader *r, Place at, const char *path, bool import)
{
    FileBytes f;
    char *kept;

    if (!may_open(r, at, path) || !reader_file(r, at, path, &f))
        return false;
    kept = arena_string(&r->scene->arena, path, strlen(path));
    if (!kept || (import && !stack_push(r, SAVED_IMPORT, at)) ||
        !source_push(r, kept, f.bytes, f.size)) {
        file_clear(&f);
        return false;
    }
    r->sources[r->nsources - 1].bytes = f;
    r->sources[r->nsources - 1].import = import;
    return true;
}

static bool source_close(Reader *r)
{
    Source *s = &r->sources[--r->nsources];
    bool ok = !s->import || stack_unwind(r, s->depth - 1);
    file_clear(&s->bytes);
    return ok;
}

static bool open_named(Reader *r, Place at, bool import)
{
    Token t;
    char *name, *path;
    bool ok;

    if (!reader_string(r, "the name of the file", &t))
        return false;
    name = reader_text(r, &t);
    path = name ? reader_path(r, at, name) : NULL;
    ok = path && open_file(r, t.at, path, import);
    mem_free(path);
    return ok;
}

static bool do_include(Reader *r, Place at) { return open_named(r, at, false); }
static bool do_import(Reader *r, Place at) { return open_named(r, at, true); }

/* ---- the world ---- */

static bool do_world_begin(Reader *r, Place at)
{
    if (!stack_unwind(r, 0))
        return false;
    (void)at;
    r->world = true;
    r->state.ctm = r->state.end = xf_identity();
    r->state.at_start = r->state.at_end = true;
    return system_set(r, "world", &r->state.ctm, &r->state.end);
}

static bool do_world_end(Reader *r, Place at)
{
    if (!r->world)
        return err_at(at, "WorldEnd without WorldBegin");
    return true;
}

/* A directive of the world where none has begun. */
static bool begin_silently(Reader *r, Place at, const char *name)
{
    if (r->camera_seen)
        return err_at(at, "%s stands before WorldBegin", name);
    r->world = true;
    if (!system_set(r, "world", &r->state.ctm, &r->state.end))
        return false;
    return warn_at(at, "%s stands before WorldBegin; this is read as a part of a world", name);
}

/* ---- the loop ---- */

static bool unknown(const Token *t)
{
    const char *names[NDIRECTIVES];

    for (size_t i = 0; i < NDIRECTIVES; i++)
        names[i] = directives[i].name;
    return token_unknown(t, names, NDIRECTIVES);
}

static bool run_one(Reader *r, const Token *t)
{
    const Entry *e = directives, *end = directives + NDIRECTIVES;

    if (t->kind != TOKEN_NAME)
        return err_at(t->at, "expected a directive");
    while (e < end && !token_is(t, e->name))
        e++;
    if (e == end)
        return unknown(t);
    if (e->where == OPTIONS_ONLY && r->world)
        return err_at(t->at, "%s stands after WorldBegin, expected before", e->name);
    if (e->where == WORLD_ONLY && !r->world && !begin_silently(r, t->at, e->name))
        return false;
    return e->run(r, t->at);
}

bool parser_run(Reader *r)
{
    Token t;

    while (r->nsources) {
        if (!reader_next(r, &t))
            return false;
        if (t.kind == TOKEN_END) {
            if (r->nsources == 1 && !stack_unwind(r, 0))
                return false;
            if (!source_close(r))
                return false;
        } else if (!run_one(r, &t))
            return false;
    }
    return true;
}
