/* resolve.c -- what to render and how: the command line's word, else the scene file's, else the
 * default. Names that this program does not have get a warning and a stand-in. See render.h. */
#include "render/render.h"

#include <string.h>

enum { SPP_DEFAULT = 64, WIDTH_DEFAULT = 1280, HEIGHT_DEFAULT = 720, BARE_SIZE = 800 };

/* A stand-in takes the parameters it knows; the others were meant for another method. */
static void mark_used(Params *ps)
{
    for (size_t i = 0; i < ps->n; i++)
        ps->p[i].used = true;
}

static const void *from_setting(const void *list, const char *what, Setting *s,
                                const char *fallback, Opts *o)
{
    const KindInfo *kind = s->name ? kind_find(list, s->name) : kind_find(list, fallback);

    if (!kind) {
        kind = kind_find(list, fallback);
        if (!warn_at(s->at, "%s \"%s\" is not known; \"%s\" is used", what, s->name, fallback))
            return NULL;
        mark_used(&s->params);
    }
    opts_default(o, kind->options);
    return opts_params(o, kind->name, &s->params) ? kind : NULL;
}

static const void *resolve(const void *list, const char *what, const char *text, Setting *s,
                           const char *fallback, Opts *o, Arena *arena)
{
    return text ? kind_from_text(list, what, text, o, arena)
                : from_setting(list, what, s, fallback, o);
}

/* The film's table: what a scene file may say of it. */
static const OptDef film_options[] = {
    { .key = "xresolution", .type = OPT_INT, .num = WIDTH_DEFAULT, .lo = 1, .hi = 1e9 },
    { .key = "yresolution", .type = OPT_INT, .num = HEIGHT_DEFAULT, .lo = 1, .hi = 1e9 },
    { .key = "filename", .type = OPT_STRING, .str = "" },
    { .key = "cropwindow", .type = OPT_NUMBERS },
    { .key = "diagonal", .type = OPT_FLOAT, .num = 35 },
    { .key = "iso", .type = OPT_FLOAT, .num = 100 },
    { .key = "whitebalance", .type = OPT_FLOAT },
    { .key = "sensor", .type = OPT_STRING, .str = "" },
    { .key = "scale", .type = OPT_FLOAT, .num = 1 },
    { .key = "maxcomponentvalue", .type = OPT_FLOAT },
    { .key = "maxsampleluminance", .type = OPT_FLOAT },
    { .key = "savefp16", .type = OPT_BOOL },
    { .key = NULL }
};

const char *settings_filename(const SceneFile *f)
{
    const Param *p = params_find(&f->film.params, "filename", NULL);
    return p && p->kind == PARAM_STRING && p->n == 1 ? p->strings[0] : NULL;
}

/* "float cropwindow" [x0 x1 y0 y1] in fractions of the picture. */
static bool crop_from_scene(RenderSettings *s, const Opts *o)
{
    const Param *p = opt_param(o, "cropwindow");
    double size[2];

    if (!p)
        return true;
    size[0] = s->w;
    size[1] = s->h;
    if (p->n != 4)
        return err_at(p->at, "\"cropwindow\" is not right, expected four numbers x0 x1 y0 y1");
    for (int k = 0; k < 2; k++) {
        double lo = p->numbers[2 * k], hi = p->numbers[2 * k + 1];
        if (!(lo >= 0) || !(hi <= 1) || !(lo < hi))
            return err_at(p->at, "\"cropwindow\" is not right, expected 0 <= x0 < x1 <= 1");
        s->crop[k] = (uint32_t)ceil(lo * size[k]);
        s->crop[k + 2] = (uint32_t)ceil(hi * size[k]);
        if (s->crop[k] >= s->crop[k + 2])
            return err_at(p->at, "\"cropwindow\" leaves no pixel");
    }
    return true;
}

static bool resolve_film(RenderSettings *s, const RenderRequest *q, SceneFile *f)
{
    bool bare = f->bare && !f->film.name;
    Opts o;

    opts_default(&o, film_options);
    if (!opts_params(&o, "Film", &f->film.params))
        return false;
    s->w = bare ? BARE_SIZE : (uint32_t)opt_int(&o, "xresolution");
    s->h = bare ? BARE_SIZE : (uint32_t)opt_int(&o, "yresolution");
    if (q->w) {
        s->w = q->w;
        s->h = q->h;
    }
    s->crop[0] = s->crop[1] = 0;
    s->crop[2] = s->w;
    s->crop[3] = s->h;
    if (q->crop_given) {
        memcpy(s->crop, q->crop, sizeof s->crop);
        if (s->crop[2] > s->w || s->crop[3] > s->h)
            return err_usage("--crop ends at %lu,%lu, the picture is %lux%lu",
                             (unsigned long)s->crop[2], (unsigned long)s->crop[3],
                             (unsigned long)s->w, (unsigned long)s->h);
    } else if (!crop_from_scene(s, &o))
        return false;
    if ((uint64_t)(s->crop[2] - s->crop[0]) * (s->crop[3] - s->crop[1]) > q->max_pixels)
        return err_usage("a picture of %lux%lu pixels is above the limit of %.0f (--max-pixels)",
                         (unsigned long)s->w, (unsigned long)s->h, (double)q->max_pixels);
    return true;
}

/* Sample counts that scene files give in several ways. */
static bool resolve_spp(RenderSettings *s, const RenderRequest *q, SceneFile *f)
{
    static const OptDef counts[] = {
        { .key = "pixelsamples", .type = OPT_INT, .num = SPP_DEFAULT, .lo = 1, .hi = 4294967295.0 },
        { .key = "xsamples", .type = OPT_INT, .num = 4, .lo = 1, .hi = 65535 },
        { .key = "ysamples", .type = OPT_INT, .num = 4, .lo = 1, .hi = 65535 },
        { .key = NULL }
    };
    Params *ps = &f->sampler.params;
    Opts o;

    opts_default(&o, counts);
    for (int i = 0; counts[i].key; i++) {
        Param *p = params_find(ps, counts[i].key, NULL);
        Params one = { p, 1 };
        if (p && !opts_params(&o, "Sampler", &one))
            return false;
    }
    s->spp = opt_given(&o, "xsamples") || opt_given(&o, "ysamples")
                 ? (uint32_t)(opt_int(&o, "xsamples") * opt_int(&o, "ysamples"))
                 : (uint32_t)opt_int(&o, "pixelsamples");
    if (q->spp)
        s->spp = q->spp;
    else if (q->seconds > 0 || q->error > 0)
        s->spp = 0;
    s->seconds = q->seconds;
    s->error = q->error;
    return true;
}

static bool resolve_seed(RenderSettings *s, const RenderRequest *q, SceneFile *f)
{
    const Param *p = params_find(&f->sampler.params, "seed", NULL);
    s->seed = q->seed_given ? q->seed
              : p && p->kind == PARAM_INT && p->n ? (uint64_t)p->numbers[0] : 0;
    return true;
}

/* Samplers of other programs that are the same as one here, by another name; and those that are
 * not, with what comes nearest. */
static const char *sampler_stand_in(Setting *s)
{
    static const struct { const char *name, *here; bool same; } names[] = {
        { "independent", "random", true },    { "02sequence", "zerotwo", true },
        { "paddedsobol", "zerotwo", true },   { "lowdiscrepancy", "zerotwo", true },
        { "latinhypercube", "nrooks", true }, { "bestcandidate", "poisson", true },
        { "zsobol", "sobol", false },         { "pmj02bn", "zerotwo", false },
        { "maxmindist", "zerotwo", false },
    };

    for (size_t k = 0; s->name && k < sizeof names / sizeof names[0]; k++)
        if (!strcmp(s->name, names[k].name)) {
            if (names[k].same)
                s->name = names[k].here;
            return names[k].here;
        }
    return SAMPLER_DEFAULT;
}

/* Without a word about it: with an error to reach the default, else all pixels alike. Not every
 * integrator has pixels that can stop. */
bool settings_adaptive(RenderSettings *s, const RenderRequest *q, Arena *arena)
{
    bool can = integrator_adapts(s->integrator);

    if (q->adaptive)
        s->adaptive = kind_from_text(adaptives, "adaptive policy", q->adaptive, &s->adaptive_opts,
                                     arena);
    else {
        s->adaptive = q->error > 0 && can ? kind_find(adaptives, ADAPTIVE_DEFAULT) : &adaptive_none;
        opts_default(&s->adaptive_opts, s->adaptive->info.options);
    }
    if (!s->adaptive)
        return false;
    if (s->adaptive->plan && !can) {
        if (!warn_at((Place){ NULL, 0, 0 }, "--adaptive %s wants samples pixel by pixel, %s has "
                     "passes over all; the whole picture stops", s->adaptive->info.name,
                     s->integrator->info.name))
            return false;
        s->adaptive = &adaptive_none;
        opts_default(&s->adaptive_opts, s->adaptive->info.options);
    }
    return true;
}

int settings_aov(RenderSettings *s, AovKind kind, int which)
{
    int k = s->naovs;

    for (int i = 0; i < k; i++)
        if (s->aovs[i].kind == kind && s->aovs[i].which == which)
            return i;
    ASSERT(k < AOVS_MAX);
    s->naovs++;
    s->aovs[k] = (Aov){ .kind = kind, .which = which };
    if (kind == AOV_VARIANCE && which != AOV_PICTURE)
        s->aovs[k].of = 1 + settings_aov(s, (AovKind)which, 0);
    return k;
}

bool settings_aovs_fit(RenderSettings *s)
{
    for (int k = 0, n = s->naovs; k < n; k++) {
        Aov *a = &s->aovs[k];
        bool part = a->kind == AOV_VARIANCE && a->which != AOV_PICTURE;
        if (s->integrator->splats && (part || a->kind == AOV_EDGES))
            return err_usage("--aov %s wants samples that are a pixel's own, %s has others",
                             part ? "variance:NAME" : "edges", s->integrator->info.name);
        if (part)
            a->of = 1 + settings_aov(s, (AovKind)a->which, 0);
    }
    return true;
}

bool settings_resolve(RenderSettings *s, const RenderRequest *q, SceneFile *f)
{
    memset(s, 0, sizeof *s);
    s->threads = q->threads;
    s->resume = q->resume;
    s->shard = q->shard;
    s->shards = q->shards;
    if (!resolve_spp(s, q, f) || !resolve_seed(s, q, f))
        return false;
    s->integrator = resolve(integrators, "integrator", q->integrator, &f->integrator,
                            INTEGRATOR_DEFAULT, &s->integrator_opts, &f->arena);
    if (!s->integrator)
        return false;
    s->sampler = resolve(samplers, "sampler", q->sampler, &f->sampler,
                         sampler_stand_in(&f->sampler), &s->sampler_opts, &f->arena);
    if (!s->sampler)
        return false;
    s->filter = resolve(filters, "filter", q->filter, &f->filter, FILTER_DEFAULT, &s->filter_opts,
                        &f->arena);
    if (!s->filter)
        return false;
    s->accel = resolve(accels, "accelerator", q->accel, &f->accelerator, ACCEL_DEFAULT,
                       &s->accel_opts, &f->arena);
    if (!s->accel || !settings_adaptive(s, q, &f->arena) || !resolve_film(s, q, f))
        return false;
    for (; s->naovs < q->naovs; s->naovs++)
        if (!aov_parse(&s->aovs[s->naovs], q->aovs[s->naovs]))
            return false;
    return settings_aovs_fit(s);
}

bool settings_camera(SceneFile *f)
{
    if (f->bare && !f->scene->geometries[0].nshapes &&
        !warn_at((Place){ NULL, 0, 0 }, "there is no shape and no light; the picture shows a sky"))
        return false;
    if (f->bare)
        return scene_frame(f->scene);
    if (f->scene->camera)
        return true;
    return warn_at((Place){ NULL, 0, 0 }, "the scene has no camera; one that frames it is used") &&
           scene_frame_camera(f->scene);
}
