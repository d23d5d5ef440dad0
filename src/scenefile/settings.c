/* settings.c -- the camera, and the directives that concern the render: they are kept as written
 * for the rooms above, which know what integrators and samplers there are. */
#include "scenefile/reader.h"

#include <string.h>

/* The path of the file being read, in the arena of the SceneFile, which outlives the scene. */
static const char *kept_path(Reader *r)
{
    Source *s = &r->sources[r->nsources - 1];
    if (!s->kept)
        s->kept = arena_string(&r->out->arena, s->path, strlen(s->path));
    return s->kept;
}

static bool keep_setting(Reader *r, Place at, const char *what, Setting *setting)
{
    Token t;
    Params ps;
    char *name;
    const char *file = kept_path(r);

    if (!file || !reader_string(r, what, &t))
        return false;
    name = reader_keep(&r->out->arena, &t);
    if (!name || !params_read(r, SPECTRUM_ALBEDO, &ps))
        return false;
    setting->name = name;
    setting->at = at;
    setting->at.file = file;
    return params_keep(&r->out->arena, &ps, file, &setting->params);
}

bool do_film(Reader *r, Place at)
{
    return keep_setting(r, at, "the kind of film", &r->out->film);
}

bool do_sampler(Reader *r, Place at)
{
    return keep_setting(r, at, "the name of the sampler", &r->out->sampler);
}

bool do_pixel_filter(Reader *r, Place at)
{
    return keep_setting(r, at, "the name of the filter", &r->out->filter);
}

bool do_integrator(Reader *r, Place at)
{
    return keep_setting(r, at, "the name of the integrator", &r->out->integrator);
}

bool do_accelerator(Reader *r, Place at)
{
    return keep_setting(r, at, "the name of the accelerator", &r->out->accelerator);
}

/* ---- the camera ---- */

static const CameraKind *camera_kind(const char *name, bool *known)
{
    const CameraKind *kind = kind_find(cameras, name);

    *known = kind != NULL;
    return kind ? kind : kind_find(cameras, "perspective");
}

static bool camera_make(Reader *r, Place at, const CameraKind *kind, Params *ps, bool known)
{
    double room[PARAMS_MAX][3];
    Transform inverse = xf_inverse(&r->state.ctm), end = xf_inverse(&r->state.end);
    Making m;
    Opts o;

    params_fit(ps, kind->info.options, room);
    for (size_t i = 0; i < ps->n && !known; i++)
        ps->p[i].used = true;                   /* those of another camera: warned of as a whole */
    opts_default(&o, kind->info.options);
    if (!opts_params(&o, kind->info.name, ps) || !reader_making(r, at, NULL, &m))
        return false;
    m.to_world = inverse;
    m.to_world_end = end;
    m.moves = reader_moves(r);
    r->scene->camera = kind->make(&m, &o);
    if (!r->scene->camera)
        return false;
    r->scene->camera->kind = kind;
    return system_set(r, "camera", &inverse, &end);
}

bool do_camera(Reader *r, Place at)
{
    Token t;
    Params ps;
    const CameraKind *kind;
    char *name;
    bool known;

    if (!reader_string(r, "the name of the camera", &t) || !(name = reader_text(r, &t)))
        return false;
    kind = camera_kind(name, &known);
    if (!known && !warn_at(t.at, "the camera '%.60s' is not supported; perspective is used", name))
        return false;
    r->camera_seen = true;
    r->scene->around = r->state.outside;
    return params_read(r, SPECTRUM_ALBEDO, &ps) && camera_make(r, at, kind, &ps, known);
}

/* ---- what is left out ---- */

/* `Option "bool name" true` or, as pbrt itself reads it, `Option "name" true`. */
bool do_option(Reader *r, Place at)
{
    Params ps;

    if (!params_read(r, SPECTRUM_ALBEDO, &ps))
        return false;
    if (!ps.n)
        return err_at(at, "Option takes a name and a value");
    for (size_t i = 0; i < ps.n; i++)
        if (!warn_at(ps.p[i].at, "the option '%.60s' is left out", ps.p[i].name))
            return false;
    return true;
}

bool do_volume_integrator(Reader *r, Place at)
{
    Token t;
    Params ps;
    return reader_string(r, "the name of the volume integrator", &t) &&
           params_read(r, SPECTRUM_ALBEDO, &ps) &&
           warn_at(at, "VolumeIntegrator is left out: \"path\" follows light through media");
}
