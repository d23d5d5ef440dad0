/* cmd_cast.c -- the command `cast`: memory and speed of acceleration structures on the user's own
 * meshes. */
#include "base/work.h"
#include "cli/args.h"
#include "cli/casttable.h"
#include "scenefile/scenefile.h"

#include <stdio.h>
#include <string.h>

enum {
    ARG_ACCEL, ARG_RAYS, ARG_RAYS_OUT, ARG_SIZE, ARG_CAM, ARG_LIGHT, ARG_AO, ARG_SEED, ARG_THREADS,
    ARG_RUNS, ARG_BATCH, ARG_CSV, ARG_QUIET, ARG_MAX_FILE
};

static const ArgDef args[] = {
    { "--accel", "NAME[:KEY=VALUE,...]", "structure to measure; may be given again; default: all" },
    { "--rays", "FILE", "cast the rays of this file; may be given again" },
    { "--rays-out", "PREFIX", "write PREFIX.KIND.rays: rays, hits and sum of distances" },
    { "--size", "WxH", "of the picture of primary rays; default 1024x1024" },
    { "--cam", "X,Y,Z,TX,TY,TZ,FOV", "eye, target, degrees from top to bottom" },
    { "--light", "X,Y,Z", "where shadow rays go" },
    { "--ao", "R", "length of ao rays, in diagonals of the mesh; default 0.1" },
    { "--seed", "N", "of the rays; default 1" },
    { "--threads", "N", "of the second build; default: all processors" },
    { "--runs", "N", "speeds are the median of N runs; default 3; 0: no speeds" },
    { "--batch", "N", "rays a call of the batched queries; default 256" },
    { "--csv", NULL, "a line for each structure and kind of rays, for programs" },
    { "--quiet", NULL, "no notes" },
    { "--max-file", "MIB", "size of one input file; default 8192" },
    { NULL, NULL, NULL }
};

enum { MESHES = 256, CONFIGS = 64 };
#define REGULAR " regular"               /* behind the name of a structure: over tessellations */
#define BRUTE_MOST 1e8          /* primitive tests a ray set: above it brute has to be asked for */

typedef struct {
    const char *mesh[MESHES], *rays[CAST_SETS], *rays_out;
    CastConfig  config[CONFIGS];
    int         nmeshes, nrays, nconfigs;
    RayRules    rules;
    CastOrder   order;
    ReadLimits  limits;
    bool        csv;
    Arena       arena;          /* strings of the configurations */
    RaySet      file[CAST_SETS];        /* the rays of files */
} Line;

/* ---- words ---- */

static bool add_config(Line *l, const char *text)
{
    CastConfig *c = &l->config[l->nconfigs];

    if (l->nconfigs == CONFIGS)
        return err_usage("at most %d --accel are possible", CONFIGS);
    c->text = text;
    c->kind = kind_from_text(accels, "accelerator", text, &c->opts, &l->arena);
    l->nconfigs += c->kind != NULL;
    return c->kind != NULL;
}

static bool add_rays(Line *l, const char *file)
{
    if (l->nrays == CAST_SETS)
        return err_usage("at most %d --rays are possible", CAST_SETS);
    l->rays[l->nrays++] = file;
    return true;
}

static bool add_mesh(Line *l, const char *path)
{
    if (l->nmeshes == MESHES)
        return err_usage("cast takes at most %d meshes", MESHES);
    l->mesh[l->nmeshes++] = path;
    return true;
}

static bool set_camera(RayRules *r, const char *value)
{
    float v[7];

    if (!arg_floats("--cam", value, args[ARG_CAM].arg, v, 7))
        return false;
    r->camera_given = true;
    r->eye = v3(v[0], v[1], v[2]);
    r->target = v3(v[3], v[4], v[5]);
    r->fov = v[6];
    if (!(v_max3(v_abs(v_sub(r->target, r->eye))) > 0.0f) || !(r->fov > 0.0f && r->fov < 180.0f))
        return err_usage("--cam '%s' is not right, expected a target that is not the eye, and "
                         "degrees between 0 and 180", value);
    return true;
}

static bool set_light(RayRules *r, const char *value)
{
    float v[3];

    if (!arg_floats("--light", value, args[ARG_LIGHT].arg, v, 3))
        return false;
    r->light_given = true;
    r->light = v3(v[0], v[1], v[2]);
    return true;
}

static bool set_size(RayRules *r, const char *value)
{
    return arg_size("--size", value, &r->w, &r->h) &&
           ((uint64_t)r->w * r->h <= IMAGE_PIXELS_DEFAULT ||
            err_usage("--size '%s' is not right, at most %lu pixels were expected", value,
                      (unsigned long)IMAGE_PIXELS_DEFAULT));
}

static bool set_number(Line *l, int k, const char *value)
{
    const char *name = args[k].name;
    int64_t n = 0;
    double x = 0;
    bool ok = true;

    switch (k) {
    case ARG_AO:       ok = arg_number(name, value, 1e-9, 1e9, &x); l->rules.ao = (float)x; break;
    case ARG_SEED:     ok = arg_int(name, value, 0, INT64_MAX, &n);
                       l->rules.seed = (uint64_t)n; break;
    case ARG_THREADS:  ok = arg_int(name, value, 1, WORKERS_MAX, &n);
                       l->order.threads = (int)n; break;
    case ARG_RUNS:     ok = arg_int(name, value, 0, CAST_RUNS, &n); l->order.runs = (int)n; break;
    case ARG_BATCH:    ok = arg_int(name, value, 1, 1 << 20, &n);
                       l->order.batch = (size_t)n; break;
    case ARG_MAX_FILE: ok = arg_int(name, value, 1, (int64_t)1 << 30, &n);
                       l->limits.max_file = (uint64_t)n << 20; break;
    default: break;
    }
    return ok;
}

static bool set(void *ctx, int k, const char *value)
{
    Line *l = ctx;

    switch (k) {
    case -1:           return add_mesh(l, value);
    case ARG_ACCEL:    return add_config(l, value);
    case ARG_RAYS:     return add_rays(l, value);
    case ARG_RAYS_OUT: l->rays_out = value; return true;
    case ARG_SIZE:     return set_size(&l->rules, value);
    case ARG_CAM:      return set_camera(&l->rules, value);
    case ARG_LIGHT:    return set_light(&l->rules, value);
    case ARG_CSV:      l->csv = true; return true;
    case ARG_QUIET:    messages_quiet(true); return true;
    default:           return set_number(l, k, value);
    }
}

static bool check(const Line *l)
{
    if (!l->nmeshes)
        return err_usage("cast takes meshes (.ply, .obj), scenes, or shapes made by rule "
                         "(geometryimage:side=512); see rushlight help cast");
    if (l->rays_out && l->nmeshes > 1)
        return err_usage("--rays-out takes one mesh, got '%s' and '%s'", l->mesh[0], l->mesh[1]);
    if (l->rays_out && l->nrays)
        return err_usage("--rays-out writes rays that are made, --rays '%s' has made ones",
                         l->rays[0]);
    return true;
}

/* ---- files of rays ---- */

static bool read_rays(Line *l)
{
    for (int k = 0; k < l->nrays; k++)
        if (!rayset_read(&l->file[k], l->rays[k], l->limits.max_file))
            return false;
    return true;
}

/* Asks whether they can be written (sets NULL), or writes them. */
static bool rays_out(const Line *l, const RaySet *sets)
{
    size_t room = strlen(l->rays_out) + 32;
    char *path = mem_array(room, 1);
    bool ok = path != NULL;

    for (int k = 0; ok && k < RAYS_KINDS; k++) {
        snprintf(path, room, "%s.%s.rays", l->rays_out, rays_names[k]);
        ok = sets ? rayset_write(&sets[k], path) : out_possible(path);
    }
    mem_free(path);
    return ok;
}

/* ---- measuring ---- */

/* Every structure, without options; brute only where that is no matter of hours. */
static int default_configs(CastConfig *configs, const CastScene *c, const RaySet *sets, int n)
{
    size_t most = 0;
    int count = 0;

    for (int k = 0; k < n; k++)
        most = sets[k].n > most ? sets[k].n : most;
    for (int i = 0; accels[i] && count < CONFIGS; i++) {
        CastConfig *config = &configs[count];
        config->kind = accels[i];
        config->text = accels[i]->info.name;
        opts_default(&config->opts, accels[i]->info.options);
        count += strcmp(config->text, "brute") ||
                 (double)most * (double)c->prims <= BRUTE_MOST;
    }
    return count;
}

static void print(const Line *l, const CastTable *t)
{
    if (l->csv) {
        cast_csv_print(t);
        return;
    }
    cast_table_print(t);
    if (!l->nconfigs && strcmp(t->configs[0].text, "brute"))
        printf("\nbrute is left out, it would take long: --accel brute asks for it\n");
    printf("\n");
}

/* A structure that has boxes of its own over tessellations is measured over these, too, beside the
 * list of their triangles. *n grows; configs has room for twice as many. */
static bool add_regular(CastConfig *configs, int *n, Arena *arena)
{
    int count = *n;

    for (int i = 0; i < count; i++) {
        CastConfig *config = &configs[*n];
        size_t room = strlen(configs[i].text) + sizeof REGULAR;
        char *text;
        if (!configs[i].kind->regular)
            continue;
        text = arena_take(arena, room, 1);
        if (!text)
            return false;
        *config = configs[i];
        config->regular = true;
        config->text = text;
        snprintf(text, room, "%s%s", configs[i].text, REGULAR);
        (*n)++;
    }
    return true;
}

static bool measure(Line *l, CastScene *c, const RaySet *sets, int nsets, bool *differs)
{
    CastConfig *configs = MEM_ARRAY(CastConfig, 2 * CONFIGS);
    CastRow *rows = MEM_ARRAY(CastRow, 2 * CONFIGS);
    CastTable t = { c, &l->order, sets, nsets, configs, rows, 0 };
    bool ok = configs && rows;

    if (ok && l->nconfigs) {
        memcpy(configs, l->config, (size_t)l->nconfigs * sizeof *configs);
        t.nrows = l->nconfigs;
    } else if (ok)
        t.nrows = default_configs(configs, c, sets, nsets);
    if (ok && c->listed)
        ok = add_regular(configs, &t.nrows, &l->arena);
    for (int i = 0; ok && i < t.nrows; i++) {
        ok = cast_measure(c, &configs[i], &l->order, sets, nsets, &rows[i], differs);
        if (ok)
            note("%s: %s is measured, %d of %d", c->name, configs[i].text, i + 1, t.nrows);
    }
    if (ok)
        print(l, &t);
    mem_free(configs);
    mem_free(rows);
    return ok;
}

/* made: room for the sets that are made where no file brings any. */
static bool cast_scene(Line *l, Scene *scene, const char *path, RaySet *made, bool *differs)
{
    CastConfig reference = cast_default();
    RaySet *sets = l->nrays ? l->file : made;
    int nsets = l->nrays ? l->nrays : RAYS_KINDS;
    CastScene c;
    bool ok;

    if (!cast_init(&c, scene, path))
        return false;
    ok = cast_build(&c, &reference, l->order.threads) &&
         (l->nrays || rays_make(scene, &l->rules, made)) &&
         cast_reference(&c, sets, nsets, differs) && (!l->rays_out || rays_out(l, sets)) &&
         measure(l, &c, sets, nsets, differs);
    cast_clear(&c);
    return ok;
}

static bool cast_mesh(Line *l, const char *path, bool *differs)
{
    RaySet made[RAYS_KINDS];
    SceneFile f;
    bool ok;

    if (!(scenefile_is_shape(path) ? scenefile_shape(&f, path, &l->limits)
                                   : scenefile_read(&f, path, &l->limits)))
        return false;
    memset(made, 0, sizeof made);
    ok = cast_scene(l, f.scene, path, made, differs);
    for (int k = 0; k < RAYS_KINDS; k++)
        rayset_clear(&made[k]);
    scenefile_clear(&f);
    return ok;
}

static int run(int argc, char **argv);

const Command command_cast = {
    "cast", "MESH... [options]", "memory and speed of every accelerator on a mesh", args, run
};

static bool cast_all(Line *l, int argc, char **argv, bool *differs)
{
    if (!args_parse(&command_cast, argc, argv, set, l) || !check(l) ||
        (l->rays_out && !rays_out(l, NULL)) || !read_rays(l))
        return false;
    if (l->csv)
        cast_csv_head();
    for (int i = 0; i < l->nmeshes; i++)
        if (!cast_mesh(l, l->mesh[i], differs))
            return false;
    return true;
}

static int run(int argc, char **argv)
{
    ReadLimits limits = READ_LIMITS_DEFAULT;
    Line *l = MEM_NEW(Line);
    bool ok, differs = false;

    if (!l)
        return failed_status();
    l->limits = limits;
    l->rules.w = l->rules.h = 1024;
    l->rules.ao = 0.1f;
    l->rules.seed = 1;
    l->order = (CastOrder){ .threads = processors(), .runs = 3, .batch = 256 };
    ok = cast_all(l, argc, argv, &differs);
    for (int k = 0; k < l->nrays; k++)
        rayset_clear(&l->file[k]);
    arena_clear(&l->arena);
    mem_free(l);
    return ok ? STATUS_OK : differs ? STATUS_DIFFERENT : failed_status();
}
