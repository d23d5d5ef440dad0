/* lightsources.c -- LightSource and AreaLightSource. Which kinds of light there are, and what their
 * parameters mean, is the business of scene/. */
#include "scenefile/reader.h"

#include <string.h>

/* A ray can meet an area light in the scene; all others are made by LightSource. */
static bool is_area(const LightKind *k) { return !k->delta && !k->infinite; }

static const LightKind *find_kind(const char *name, bool area)
{
    for (size_t i = 0; lights[i]; i++)
        if (is_area(lights[i]) == area && !strcmp(lights[i]->info.name, name))
            return lights[i];
    return NULL;
}

static bool unknown_light(Place at, const char *name, bool area)
{
    enum { MOST = 32 };
    const char *names[MOST];
    char hint[HINT_MAX];
    size_t n = 0;
    for (size_t i = 0; lights[i] && n < MOST; i++)
        if (is_area(lights[i]) == area)
            names[n++] = lights[i]->info.name;
    return warn_at(at, "the %slight '%.60s' is not known%s; it is left out", area ? "area " : "",
                   name, hint_nearest(hint, name, names, n));
}

static const char *file_of(const Params *ps)
{
    for (size_t i = 0; i < ps->n; i++)
        if (ps->p[i].kind == PARAM_STRING && ps->p[i].n == 1 &&
            (!strcmp(ps->p[i].name, "filename") || !strcmp(ps->p[i].name, "mapname")))
            return ps->p[i].strings[0];
    return NULL;
}

static bool add_light(Reader *r, const LightKind *kind, const Making *m, const Opts *o,
                      uint32_t *index)
{
    Light *l = kind->make(m, o);
    if (!l)
        return false;
    l->kind = kind;
    l->at = m->at;
    return scene_add_light(r->scene, l, index);
}

static bool make_light(Reader *r, Place at, const LightKind *kind, Params *ps)
{
    Param list[PARAMS_MAX + DEFAULTS_MAX];
    double room[PARAMS_MAX + DEFAULTS_MAX][3];
    Params all;
    Making m;
    Opts o;

    params_with_defaults(r, TARGET_LIGHT, ps, list, &all);
    params_fit(&all, kind->info.options, room);
    opts_default(&o, kind->info.options);
    return opts_params(&o, kind->info.name, &all) && reader_making(r, at, file_of(&all), &m) &&
           add_light(r, kind, &m, &o, NULL);
}

bool do_light_source(Reader *r, Place at)
{
    Token t;
    Params ps;
    char *name;
    const LightKind *kind;

    if (!reader_string(r, "the kind of light", &t) || !(name = reader_text(r, &t)))
        return false;
    kind = find_kind(name, false);
    if (!kind && !unknown_light(t.at, name, false))
        return false;
    if (!params_read(r, SPECTRUM_LIGHT, &ps))
        return false;
    if (kind && reader_moves(r) && reader_once(r, ONCE_MOTION) &&
        !warn_at(at, "lights do not move; they stand as at their start"))
        return false;
    return !kind || make_light(r, at, kind, &ps);
}

/* ---- area lights ---- */

/* The parameters are checked here, once; every shape to come makes a light of them. */
bool do_area_light_source(Reader *r, Place at)
{
    Token t;
    Params ps, all;
    Param list[PARAMS_MAX + DEFAULTS_MAX];
    double room[PARAMS_MAX + DEFAULTS_MAX][3];
    char *name;
    AreaLight *a;
    const LightKind *kind;
    Opts o;

    if (!reader_string(r, "the kind of area light", &t) || !(name = reader_text(r, &t)))
        return false;
    kind = find_kind(!strcmp(name, "area") ? "diffuse" : name, true);   /* "area": version 2 */
    if (!kind && !unknown_light(t.at, name, true))
        return false;
    if (!params_read(r, SPECTRUM_LIGHT, &ps))
        return false;
    r->state.area = NULL;
    if (!kind)
        return true;
    params_with_defaults(r, TARGET_LIGHT, &ps, list, &all);
    params_fit(&all, kind->info.options, room);
    opts_default(&o, kind->info.options);
    if (!opts_params(&o, "area light", &all))
        return false;
    for (size_t i = 0; i < all.n; i++)
        all.p[i].used = true;
    a = arena_take(&r->out->arena, 1, sizeof *a);
    if (!a || !params_keep(&r->out->arena, &all, NULL, &a->params))
        return false;
    a->kind = kind;
    a->at = at;
    r->state.area = a;
    return true;
}

bool lightsource_shine(Reader *r, const AreaLight *area, uint32_t shape, Place at)
{
    Making m;
    Opts o;
    uint32_t index;

    if (!area)
        return true;
    if (r->object)
        return !reader_once(r, ONCE_OBJECT_LIGHT) ||
               warn_at(at, "shapes of objects cannot be lights; they do not shine");
    opts_default(&o, area->kind->info.options);
    if (!opts_params(&o, "area light", &area->params) ||
        !reader_making(r, area->at, file_of(&area->params), &m))
        return false;
    m.shape = shape;
    if (!add_light(r, area->kind, &m, &o, &index))
        return false;
    r->scene->geometries[r->object].shapes[shape].light = index;
    return true;
}
