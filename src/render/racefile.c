/* racefile.c -- a file that holds a whole race. See race.h.
 *
 * Source   [GIRT] appendix C: size, scene, methods with their parameters, times of automatic saves,
 *          in a file of its own, so that a measurement can be repeated.
 * Grammar  That of scene files: directives with quoted words, numbers, typed parameters, and
 *          comments from # to the end of the line.
 *
 *     Scene "plates.pbrt"              beside this file, as references are
 *     Size 240 170                     pixels; Crop x0 y0 x1 y1: a window of them
 *     Spp 256                          checkpoints 1, 2, 4, ... 256; or a list [ 1 10 100 ]
 *     Time 20                          or by seconds: 20/128, 20/64, ... 20; or a list
 *     Seed 1   Threads 2
 *     Sampler "zerotwo"                of all methods, as are Filter, Accelerator
 *     Method "both"                    the directives up to the next one are of this method:
 *         Integrator "path" "string strategy" "mis"
 *         Sampler "random"
 *     Reference "auto" "integer spp" 4096      or "pair", "file.pfm", "half.pfm" "other.pfm"
 *         Integrator "path"            of the reference, like those of a method
 *     Output "plates.pfm" "plates.png" pictures, names of methods are put into these names
 *     Autosave [ 1 5 20 ]              pictures at these seconds too
 *     Csv "plates.csv"   Plot "plates.svg"
 *
 * Departs  The original's "exit after the last automatic save" is a race without Spp and Time: the
 *          last Autosave ends each render. What is not known is an error, never left out: a race
 *          of other methods than were meant is worse than none. */
#include "render/race.h"

#include "base/work.h"
#include "scenefile/reader.h"

#include <string.h>

typedef struct {
    Reader     *reader;
    RaceOrder  *order;
    RaceMethod *method;         /* whom Integrator and Sampler are of; NULL: all */
    Place       at;             /* the directive that is read */
    Place       method_at;
    Place       reference_at;
    unsigned    seen;           /* directives, by index */
} RaceReader;

typedef bool (*Step)(RaceReader *r);
typedef struct { const char *name; Step run; bool again; } Entry;

/* ---- pieces ---- */

static char *take_string(RaceReader *r, const char *what)
{
    Token t;
    if (!reader_string(r->reader, what, &t))
        return NULL;
    if (!t.n) {
        err_at(t.at, "expected %s, the string is empty", what);
        return NULL;
    }
    return reader_keep(&r->order->arena, &t);
}

static bool take_count(RaceReader *r, double lo, double hi, double *v)
{
    Token t;
    if (!reader_next(r->reader, &t))
        return false;
    *v = t.number;
    if (t.kind == TOKEN_NUMBER && *v == floor(*v) && *v >= lo && *v <= hi)
        return true;
    return err_at(t.at, "expected a whole number from %.0f to %.0f", lo, hi);
}

/* One number, or several in brackets. The place is that of the first. */
static bool take_list(RaceReader *r, double *v, int *n, Place *at)
{
    bool list;
    Token t;

    *n = 0;
    if (!reader_next(r->reader, &t))
        return false;
    *at = t.at;
    list = t.kind == TOKEN_OPEN;
    if (list && !reader_next(r->reader, &t))
        return false;
    for (;;) {
        if (list && t.kind == TOKEN_CLOSE && *n)
            return true;
        if (t.kind != TOKEN_NUMBER)
            return err_at(t.at, "expected a number%s", list ? " or ']'" : " or a list of them");
        if (*n == RACE_LOOKS)
            return err_at(t.at, "more than %d numbers", RACE_LOOKS);
        v[(*n)++] = t.number;
        if (!list)
            return true;
        if (!reader_next(r->reader, &t))
            return false;
    }
}

/* ---- directives of the whole ---- */

/* As seen from the file of the race. */
static bool take_path(RaceReader *r, const char *what, const char **path)
{
    char *name = take_string(r, what), *beside = NULL;

    if (name)
        beside = path_beside(r->reader->main_path, name);
    *path = beside ? arena_string(&r->order->arena, beside, strlen(beside)) : NULL;
    mem_free(beside);
    return *path != NULL;
}

static bool read_scene(RaceReader *r)
{
    return take_path(r, "the name of the scene's file", &r->order->scene);
}

static bool read_size(RaceReader *r)
{
    double w, h;
    if (!take_count(r, 1, INT32_MAX, &w) || !take_count(r, 1, INT32_MAX, &h))
        return false;
    r->order->request.w = (uint32_t)w;
    r->order->request.h = (uint32_t)h;
    return true;
}

static bool read_crop(RaceReader *r)
{
    uint32_t *c = r->order->request.crop;
    double v;
    for (int i = 0; i < 4; i++) {
        if (!take_count(r, 0, INT32_MAX, &v))
            return false;
        c[i] = (uint32_t)v;
    }
    if (c[0] >= c[2] || c[1] >= c[3])
        return err_at(r->at, "Crop is not right, expected x0 y0 x1 y1 with x0 < x1 and y0 < y1");
    r->order->request.crop_given = true;
    return true;
}

static bool read_seed(RaceReader *r)
{
    double v;
    if (!take_count(r, 0, 9007199254740992.0, &v))
        return false;
    r->order->request.seed = (uint64_t)v;
    r->order->request.seed_given = true;
    return true;
}

static bool read_threads(RaceReader *r)
{
    double v;
    if (!take_count(r, 1, WORKERS_MAX, &v))
        return false;
    r->order->request.threads = (int)v;
    return true;
}

/* A list that `set` takes; else the message is of the place of its first number. */
static bool set_list(RaceReader *r, bool (*set)(RaceOrder *, const double *, int),
                     const char *wrong)
{
    double v[RACE_LOOKS];
    Place at;
    int n;
    return take_list(r, v, &n, &at) && (set(r->order, v, n) || err_at(at, "%s", wrong));
}

static bool read_spp(RaceReader *r)
{
    return set_list(r, race_spp_set,
                    "Spp is not right, expected whole numbers from 1 on that rise");
}

static bool read_time(RaceReader *r)
{
    return set_list(r, race_seconds_set,
                    "Time is not right, expected seconds from 0.001 to 1e9 that rise");
}

static bool read_autosave(RaceReader *r)
{
    return set_list(r, race_autosave_set,
                    "Autosave is not right, expected seconds from 0.001 to 1e9 that rise");
}

/* ---- outputs ---- */

/* By its extension. */
static bool is_picture(Place at, const char *path)
{
    char have[IMAGE_EXTENSIONS];
    return image_format_of(path) ||
           err_at(at, "'%.200s' is of no format that can be written, one of these was expected: %s",
                  path, image_extensions(have));
}

static bool read_output(RaceReader *r)
{
    RaceOrder *o = r->order;
    Token t;

    do {
        char *name;
        if (!reader_peek(r->reader, &t) || !(name = take_string(r, "the name of a picture")))
            return false;
        if (o->noutputs == OUTPUTS_MAX)
            return err_at(t.at, "more than %d pictures", OUTPUTS_MAX);
        if (!is_picture(t.at, name))
            return false;
        o->outputs[o->noutputs++] = name;
        if (!reader_peek(r->reader, &t))
            return false;
    } while (t.kind == TOKEN_STRING);
    return true;
}

static bool read_csv(RaceReader *r)
{
    return (r->order->csv = take_string(r, "the name of a file")) != NULL;
}

static bool read_plot(RaceReader *r)
{
    return (r->order->plot = take_string(r, "the name of a file")) != NULL;
}

/* ---- methods ---- */

static bool end_method(const RaceReader *r)
{
    if (r->method && !r->method->integrator && r->method != &r->order->reference_method)
        return err_at(r->method_at, "the method \"%.60s\" has no Integrator", r->method->label);
    return true;
}

static bool read_method(RaceReader *r)
{
    RaceOrder *o = r->order;

    if (!end_method(r))
        return false;
    if (o->nmethods == RACE_METHODS)
        return err_at(r->at, "more than %d methods", RACE_METHODS);
    r->method = &o->method[o->nmethods++];
    r->method_at = r->at;
    memset(r->method, 0, sizeof *r->method);
    return (r->method->label = take_string(r, "what the method is called")) != NULL;
}

/* Parameters that the table has not are errors here. */
static bool all_known(const char *what, const OptDef *defs, Params *ps)
{
    for (size_t i = 0; i < ps->n; i++) {
        Params one = { &ps->p[i], 1 };
        const char *names[OPT_MAX] = { NULL };
        char hint[HINT_MAX];
        size_t n = 0;
        bool known = false;
        for (; defs && defs[n].key; n++) {
            names[n] = defs[n].key;
            known = known || params_find(&one, defs[n].key, defs[n].also);
        }
        if (ps->p[i].kind == PARAM_TEXTURE)
            return err_at(ps->p[i].at, "%s takes no textures", what);
        if (!known)
            return err_at(ps->p[i].at, "%s has no parameter '%.60s'%s", what, ps->p[i].name,
                          hint_nearest(hint, ps->p[i].name, names, n));
    }
    return true;
}

/* Name and parameters, checked against a list of kinds. */
static const void *take_kind(RaceReader *r, const void *list, const char *what, Setting *s)
{
    Arena *arena = &r->order->arena;
    const KindInfo *kind;
    Token t;
    Params ps;
    char *name;

    if (!reader_string(r->reader, "a name", &t) || !(name = reader_keep(arena, &t)) ||
        !params_read(r->reader, SPECTRUM_ALBEDO, &ps))
        return NULL;
    kind = kind_find_at(t.at, list, what, name);
    if (!kind || !all_known(kind->name, kind->options, &ps))
        return NULL;
    s->name = name;
    s->at = t.at;
    s->at.file = arena_string(arena, t.at.file, strlen(t.at.file));
    return s->at.file && params_keep(arena, &ps, s->at.file, &s->params) ? kind : NULL;
}

static bool take_opts(const void *kind, Setting *s, Opts *o)
{
    const KindInfo *info = kind;
    if (!kind)
        return false;
    opts_default(o, info->options);
    return opts_params(o, info->name, &s->params);
}

static bool read_integrator(RaceReader *r)
{
    Setting s;
    if (!r->method)
        return err_at(r->at, "Integrator stands before any Method");
    r->method->integrator = take_kind(r, integrators, "integrator", &s);
    return take_opts(r->method->integrator, &s, &r->method->integrator_opts);
}

static bool read_sampler(RaceReader *r)
{
    RaceOrder *o = r->order;
    Setting s;
    Opts opts;
    if (!r->method)
        return take_opts(take_kind(r, samplers, "sampler", &o->sampler), &o->sampler, &opts);
    r->method->sampler = take_kind(r, samplers, "sampler", &s);
    return take_opts(r->method->sampler, &s, &r->method->sampler_opts);
}

static bool read_filter(RaceReader *r)
{
    return take_kind(r, filters, "filter", &r->order->filter) != NULL;
}

static bool read_accelerator(RaceReader *r)
{
    return take_kind(r, accels, "accelerator", &r->order->accelerator) != NULL;
}

/* ---- the reference ---- */

static const OptDef reference_options[] = {
    { .key = "spp", .type = OPT_INT, .lo = 1, .hi = 4294967294.0, .help = "of each half" },
    { .key = "seconds", .type = OPT_FLOAT, .lo = 1e-3, .hi = 1e9, .help = "of each half" },
    { .key = NULL }
};

/* A string with a blank in it declares a parameter. */
static bool is_name(const Token *t)
{
    return t->kind == TOKEN_STRING && !memchr(t->s, ' ', t->n);
}

static bool take_reference_options(RaceReader *r, Place at)
{
    RaceOrder *o = r->order;
    Params ps;
    Opts opts;

    opts_default(&opts, reference_options);
    if (!params_read(r->reader, SPECTRUM_ALBEDO, &ps) ||
        !all_known("Reference", reference_options, &ps) || !opts_params(&opts, "Reference", &ps))
        return false;
    if (ps.n && o->reference != REFERENCE_AUTO)
        return err_at(at, "only the reference \"auto\" has parameters");
    o->reference_spp = opt_given(&opts, "spp") ? (uint32_t)opt_int(&opts, "spp") : 0;
    o->reference_seconds = opt_given(&opts, "seconds") ? opt_float(&opts, "seconds") : 0;
    return true;
}

static bool read_reference(RaceReader *r)
{
    RaceOrder *o = r->order;
    Token t;

    if (!end_method(r) || !reader_peek(r->reader, &t))
        return false;
    o->reference = REFERENCE_FILES;
    if (t.kind == TOKEN_STRING && (token_is(&t, "auto") || token_is(&t, "pair"))) {
        o->reference = token_is(&t, "auto") ? REFERENCE_AUTO : REFERENCE_PAIR;
        if (!reader_next(r->reader, &t))
            return false;
    } else {
        if (!take_path(r, "auto, pair or the name of a picture", &o->reference_file[0]) ||
            !reader_peek(r->reader, &t) ||
            (is_name(&t) && !take_path(r, "a picture", &o->reference_file[1])))
            return false;
    }
    r->method = &o->reference_method;
    r->method_at = r->reference_at = r->at;
    return take_reference_options(r, r->at);
}

/* ---- the file ---- */

static const Entry directives[] = {
    { "Accelerator", read_accelerator, false }, { "Autosave", read_autosave, false },
    { "Crop", read_crop, false },               { "Csv", read_csv, false },
    { "Filter", read_filter, false },           { "Integrator", read_integrator, true },
    { "Method", read_method, true },            { "Output", read_output, true },
    { "Plot", read_plot, false },               { "Reference", read_reference, false },
    { "Sampler", read_sampler, true },          { "Scene", read_scene, false },
    { "Seed", read_seed, false },               { "Size", read_size, false },
    { "Spp", read_spp, false },                 { "Threads", read_threads, false },
    { "Time", read_time, false },
};
enum { NDIRECTIVES = sizeof directives / sizeof *directives };

static bool unknown(const Token *t)
{
    const char *names[NDIRECTIVES];

    for (size_t i = 0; i < NDIRECTIVES; i++)
        names[i] = directives[i].name;
    return token_unknown(t, names, NDIRECTIVES);
}

static bool run_directive(RaceReader *r, const Token *t)
{
    int k = 0;

    if (t->kind != TOKEN_NAME)
        return err_at(t->at, "expected a directive");
    while (k < NDIRECTIVES && !token_is(t, directives[k].name))
        k++;
    if (k == NDIRECTIVES)
        return unknown(t);
    if (!directives[k].again && r->seen >> k & 1)
        return err_at(t->at, "%s was given before", directives[k].name);
    r->seen |= 1u << k;
    r->at = t->at;
    return directives[k].run(r);
}

static bool run_directives(RaceReader *r, const char *path)
{
    Place whole = { path, 0, 0 };
    Token t;

    for (;;) {
        if (!reader_next(r->reader, &t))
            return false;
        if (t.kind == TOKEN_END)
            break;
        if (!run_directive(r, &t))
            return false;
    }
    if (r->order->reference != REFERENCE_AUTO && r->order->reference_method.integrator)
        return err_at(r->reference_at, "only the reference \"auto\" has an Integrator");
    if (!r->order->scene)
        return err_at(whole, "the race has no Scene");
    return end_method(r);
}

/* The reader of scenes is used for its words and parameters; its scene stays empty. */
bool race_file_parse(RaceOrder *o, const char *path, const char *text, size_t n,
                     const ReadLimits *limits)
{
    RaceReader r = { 0 };
    SceneFile none;
    bool ok;

    memset(&none, 0, sizeof none);
    r.order = o;
    r.reader = MEM_NEW(Reader);
    none.scene = r.reader ? scene_new() : NULL;
    ok = none.scene && reader_init(r.reader, &none, path, limits) &&
         source_push(r.reader, r.reader->main_path, text, n) && run_directives(&r, path);
    if (r.reader)
        reader_clear(r.reader);
    mem_free(r.reader);
    scenefile_clear(&none);
    return ok;
}

bool race_file_read(RaceOrder *o, const char *path, const ReadLimits *limits)
{
    FileBytes f;
    bool ok;

    if (!file_read(path, limits->max_file, &f))
        return false;
    ok = race_file_parse(o, path, f.bytes, f.size, limits);
    file_clear(&f);
    return ok;
}
