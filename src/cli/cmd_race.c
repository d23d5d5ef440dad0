/* cmd_race.c -- the command `race`: several methods on one scene, error against samples and time.
 * The race comes from the command line, or from a file (racefile.c) that options then change. */
#include "base/number.h"
#include "base/work.h"
#include "cli/args.h"
#include "cli/interrupt.h"
#include "cli/outputs.h"
#include "cli/racetable.h"
#include "cli/sceneargs.h"

#include <stdio.h>
#include <string.h>

enum {
    ARG_WITH, ARG_SPP, ARG_TIME, ARG_REFERENCE, ARG_REFERENCE_WITH, ARG_REFERENCE_SPP,
    ARG_REFERENCE_TIME, ARG_OUTPUT, ARG_AUTOSAVE, ARG_CSV, ARG_PLOT, ARG_SCENE
};

static const ArgDef args[] = {
    { "--with", "METHOD", "INTEGRATOR[:KEY=VALUE,...][@SAMPLER[:KEY=VALUE,...]]; again for more" },
    { "--spp", "N|N,N,...", "checkpoints: 1, 2, 4, ... N samples a pixel, or these" },
    { "--time", "S|S,S,...", "checkpoints: S/128, S/64, ... S seconds, or these; the last ends" },
    { "--reference", "FILE|auto|pair", "the truth (two: their mean); rendered; none, the default" },
    { "--reference-with", "METHOD", "of auto; default path" },
    { "--reference-spp", "N", "of auto, each of two halves; default 16 x the last checkpoint" },
    { "--reference-time", "S", "likewise; default 4 x the last checkpoint by time" },
    { "-o", "FILE", "write each method's picture, as FILE with its number and name put in" },
    { "--autosave", "S,S,...", "write them also after so many seconds of rendering" },
    { "--csv", "FILE", "write all checkpoints, for programs" },
    { "--plot", "FILE.svg", "write a plot of error against samples and seconds" },
    SCENE_ARGS,
    { NULL, NULL, NULL }
};

typedef struct {
    const char *file;
    bool        limits_only;            /* the first of two passes over the options */
    bool        budget, reference;      /* the command line has its own */
    ReadLimits  limits;
    RaceOrder   order;
    const volatile sig_atomic_t *stop;
} Line;

/* ---- options ---- */

/* "a,b,c" */
static bool set_list(RaceOrder *o, int k, const char *value,
                     bool (*take)(RaceOrder *, const double *, int))
{
    const char *s = value, *end = value + strlen(value);
    double v[RACE_LOOKS];
    int n = 0;
    size_t used = 1;

    for (; used && n < RACE_LOOKS; s++) {
        used = number_double(s, end, &v[n]);
        s += used;
        n += used > 0;
        if (*s != ',')
            break;
    }
    return (used && s == end && take(o, v, n)) ||
           err_usage("%s '%s' is not right, expected %s that rise, with commas between (at most "
                     "%d)", args[k].name, value, k == ARG_SPP ? "whole numbers" : "seconds",
                     RACE_LOOKS);
}

/* The first one of the command line puts away what a file said. */
static bool set_budget(Line *l, int k, const char *value)
{
    if (!l->budget)
        l->order.nspp = l->order.nseconds = 0;
    l->budget = true;
    return set_list(&l->order, k, value, k == ARG_SPP ? race_spp_set : race_seconds_set);
}

static bool set_reference(Line *l, const char *value)
{
    RaceOrder *o = &l->order;
    bool word = !strcmp(value, "auto") || !strcmp(value, "pair");

    if (l->reference && (word || o->reference != REFERENCE_FILES || o->reference_file[1]))
        return err_usage("--reference '%s' is one too many, expected auto, pair, one file or two",
                         value);
    if (!l->reference)
        o->reference_file[0] = o->reference_file[1] = NULL;
    l->reference = true;
    o->reference = !word ? REFERENCE_FILES : value[0] == 'a' ? REFERENCE_AUTO : REFERENCE_PAIR;
    if (!word)
        o->reference_file[o->reference_file[0] != NULL] = value;
    return true;
}

static bool set_rest(Line *l, int k, const char *value)
{
    RaceOrder *o = &l->order;
    const char *name = args[k].name;
    int64_t n = 0;

    switch (k) {
    case ARG_WITH:           return race_add_method(o, value);
    case ARG_SPP:
    case ARG_TIME:           return set_budget(l, k, value);
    case ARG_REFERENCE:      return set_reference(l, value);
    case ARG_REFERENCE_WITH: return race_method_parse(&o->reference_method, value, &o->arena);
    case ARG_REFERENCE_SPP:  if (!arg_int(name, value, 1, UINT32_MAX - 1, &n))
                                 return false;
                             o->reference_spp = (uint32_t)n;
                             return true;
    case ARG_REFERENCE_TIME: return arg_number(name, value, 1e-3, 1e9, &o->reference_seconds);
    case ARG_OUTPUT:         return output_add(o->outputs, &o->noutputs, value);
    case ARG_AUTOSAVE:       return set_list(o, k, value, race_autosave_set);
    case ARG_CSV:            o->csv = value; return true;
    case ARG_PLOT:           o->plot = value; return true;
    default:                 return scene_arg_set((SceneArg)(k - ARG_SCENE), value, &o->request,
                                                  &l->limits);
    }
}

static bool set(void *ctx, int k, const char *value)
{
    Line *l = ctx;
    bool limit = k >= ARG_SCENE + SCENE_QUIET;

    if (k >= 0)
        return limit != l->limits_only || set_rest(l, k, value);
    if (!l->limits_only)
        return true;
    if (l->file)
        return err_usage("race takes one scene or one file of a race, got '%s' and '%s'", l->file,
                         value);
    l->file = value;
    return true;
}

/* ---- what is asked for ---- */

static bool read_order(Line *l, const Command *c, int argc, char **argv)
{
    RaceOrder *o = &l->order;

    l->limits_only = true;
    if (!args_parse(c, argc, argv, set, l))
        return false;
    if (!l->file)
        return err_usage("race takes a scene (.pbrt, .obj or .ply) or a file of a race; see "
                         "rushlight help race");
    if (scenefile_is_scene(l->file))
        o->scene = l->file;
    else if (!race_file_read(o, l->file, &l->limits))
        return false;
    l->limits_only = false;
    if (!args_parse(c, argc, argv, set, l))
        return false;
    if (!o->nmethods)
        return err_usage("race takes methods, as --with path --with path:strategy=implicit@random");
    if (o->nautosave && !o->noutputs)
        return err_usage("automatic saves want a picture to write: -o FILE");
    if (o->nautosave && !o->nspp && !o->nseconds)       /* the last of them ends each render */
        return race_seconds_set(o, &o->autosave[o->nautosave - 1], 1);
    return true;
}

/* Before the hours of rendering, not after them. */
static bool all_possible(const RaceOrder *o)
{
    if ((o->csv && !out_possible(o->csv)) || (o->plot && !out_possible(o->plot)))
        return false;
    for (int i = 0; i < o->noutputs; i++)
        for (int k = 0; k < o->nmethods; k++) {
            char *name = race_picture_name(o->outputs[i], k, o->method[k].label, -1);
            bool ok = name && out_possible(name);
            mem_free(name);
            if (!ok)
                return false;
        }
    return true;
}

/* What the file says of all methods stands for what the scene says. */
static bool resolve(RaceOrder *o, SceneFile *f, RenderSettings *s)
{
    double spp;

    o->request.integrator = INTEGRATOR_DEFAULT;         /* that of the scene is no matter */
    if (o->sampler.name)
        f->sampler = o->sampler;
    if (o->filter.name)
        f->filter = o->filter;
    if (o->accelerator.name)
        f->accelerator = o->accelerator;
    if (!settings_resolve(s, &o->request, f) || !settings_camera(f))
        return false;
    spp = s->spp;
    return o->nspp || o->nseconds || race_spp_set(o, &spp, 1);
}

static bool report(const RaceOrder *o, const Race *race)
{
    bool ok = true;

    race_table_print(o, race);
    if (o->csv && race->n)
        ok = race_csv_write(o, race, o->csv);
    if (o->plot && race->n)
        ok = race_plot_write(o, race, o->plot) && ok;
    return ok;
}

static bool race_scene(Line *l, SceneFile *f, Race *race)
{
    RenderSettings s;
    bool ok;

    if (!resolve(&l->order, f, &s) || !all_possible(&l->order) ||
        !scene_build(f->scene, s.accel, &s.accel_opts, s.threads))
        return false;
    s.stop = l->stop;
    ok = race_run(&l->order, f->scene, &s, race);
    return report(&l->order, race) && ok;
}

static int run(int argc, char **argv);

const Command command_race = {
    "race", "SCENE|FILE [--with METHOD]", "error of methods as samples and time pass", args, run
};

static bool run_race(Line *l, Race *race, int argc, char **argv)
{
    SceneFile f;
    bool ok;

    if (!read_order(l, &command_race, argc, argv))
        return false;
    l->order.request.max_pixels = l->limits.max_pixels;
    if (!l->order.request.threads)
        l->order.request.threads = processors();
    l->stop = interrupts_catch();
    if (!scenefile_read(&f, l->order.scene, &l->limits))
        return false;
    ok = race_scene(l, &f, race);
    scenefile_clear(&f);
    return ok;
}

static int run(int argc, char **argv)
{
    ReadLimits limits = READ_LIMITS_DEFAULT;
    Line *l = MEM_NEW(Line);
    Race *race = MEM_NEW(Race);
    int status = STATUS_OUTPUT;

    if (l && race) {
        l->limits = limits;
        status = run_race(l, race, argc, argv) && err_status() == STATUS_OK
                     ? race->interrupted ? STATUS_INTERRUPTED : STATUS_OK : failed_status();
        race_order_clear(&l->order);
    }
    mem_free(race);
    mem_free(l);
    return status;
}
