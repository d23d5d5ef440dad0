/* cmd_merge.c -- the command `merge`: shares of a render, added up. */
#include "base/number.h"
#include "cli/args.h"
#include "cli/displayargs.h"
#include "cli/outputs.h"
#include "cli/sceneargs.h"
#include "render/merge.h"

enum {
    ARG_OUTPUT, ARG_AOV, ARG_DISPLAY, ARG_QUIET = ARG_DISPLAY + DISPLAY_ARGS_N, ARG_STRICT,
    ARG_MAX_PIXELS, ARG_MAX_MEMORY, ARG_MAX_FILE
};

static const ArgDef args[] = {
    { "-o", "FILE", "picture to write; the extension picks the format; may be given again" },
    { "--aov", "NAME=FILE", "extra picture, that the parts were rendered with" },
    DISPLAY_ARGS,
    { "--quiet", NULL, "no summary" },
    { "--strict", NULL, "warnings are errors: a part that is missing" },
    { "--max-pixels", "N", "of the picture; default 268435456" },
    { "--max-memory", "MIB", "held at once; default: no limit" },
    { "--max-file", "MIB", "size of one part; default 8192" },
    { NULL, NULL, NULL }
};

typedef struct {
    char **parts;               /* borrowed from the command line: */
    int nparts;                 /* moved to its front */
    const char *aovs[AOVS_ASKED];
    int naovs;
    Outputs outputs;
    ReadLimits limits;
    Arena arena;                /* of options */
} Line;

static bool set(void *ctx, int k, const char *value)
{
    static const SceneArg shared[] = { SCENE_QUIET, SCENE_STRICT, SCENE_MAX_PIXELS,
                                       SCENE_MAX_MEMORY, SCENE_MAX_FILE };
    Line *l = ctx;

    if (k >= ARG_DISPLAY && k < ARG_QUIET)
        return display_arg_set((DisplayArg)(k - ARG_DISPLAY), value, &l->outputs.display,
                               &l->arena);
    switch (k) {
    case -1:
        l->parts[l->nparts++] = (char *)value;
        return true;
    case ARG_OUTPUT: return output_add(l->outputs.pictures, &l->outputs.n, value);
    case ARG_AOV:
        if (l->naovs == AOVS_ASKED)
            return err_usage("at most %d --aov are possible", AOVS_ASKED);
        l->aovs[l->naovs++] = value;
        return true;
    default: return scene_arg_set(shared[k - ARG_QUIET], value, NULL, &l->limits);
    }
}

static int run(int argc, char **argv);

const Command command_merge = {
    "merge", "PART... -o OUT", "adds up shares of a render (--shard), exactly", args, run
};

static bool write_all(const Line *l, const Merge *m)
{
    RenderSettings s = { .naovs = 0 };

    if (!merge_aovs(m, &s))
        return false;
    for (int i = 0; i < l->naovs; i++)
        if (!merge_want(m, &s, l->aovs[i]))
            return false;
    return outputs_write(&l->outputs, &s, &m->film);
}

static bool merge(const Line *l, Merge *m)
{
    double pixels, error;
    uint32_t missing;
    char e[NUMBER_MAX];

    for (int i = 0; i < l->nparts; i++)
        if (!merge_add(m, l->parts[i], &l->limits))
            return false;
    missing = merge_missing(m);
    if (missing && !warn_at((Place){ NULL, 0, 0 }, "%lu shares are missing: the picture has fewer "
                            "samples", (unsigned long)missing))
        return false;
    if (!write_all(l, m))
        return false;
    pixels = (double)m->film.w * m->film.h;
    error = merge_error(m);
    number_print_fixed(e, error, 4);
    note("%s: %d parts, %.1f samples a pixel, estimated sigma/mu %s",
         l->outputs.n ? l->outputs.pictures[0] : "parts", l->nparts, m->samples / pixels,
         error < INFINITY ? e : "unknown");
    return true;
}

static int run(int argc, char **argv)
{
    const ReadLimits limits = READ_LIMITS_DEFAULT;
    Line l = { 0 };
    Merge m = { 0 };
    bool ok;

    l.parts = argv;
    l.limits = limits;
    ok = args_parse(&command_merge, argc, argv, set, &l);
    if (ok && (!l.nparts || (!l.outputs.n && !l.naovs)))
        ok = err_usage("merge takes parts (.part) and -o, the picture to write; see rushlight "
                       "help merge");
    ok = ok && merge(&l, &m);
    merge_clear(&m);
    arena_clear(&l.arena);
    return ok ? STATUS_OK : failed_status();
}
