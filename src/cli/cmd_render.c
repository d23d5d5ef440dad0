/* cmd_render.c -- the command `render`: the main job. */
#include "base/clock.h"
#include "base/number.h"
#include "cli/displayargs.h"
#include "cli/interrupt.h"
#include "cli/outputs.h"
#include "cli/preview.h"
#include "cli/sceneargs.h"

#include <stdio.h>
#include <string.h>

enum {
    ARG_OUTPUT, ARG_INTEGRATOR, ARG_SPP, ARG_TIME, ARG_ERROR, ARG_ADAPTIVE, ARG_AOV, ARG_DENOISE,
    ARG_FIREFLIES, ARG_AUTOSAVE, ARG_RESUME, ARG_SHARD, ARG_PREVIEW, ARG_DISPLAY,
    ARG_SCENE = ARG_DISPLAY + DISPLAY_ARGS_N
};

static const ArgDef args[] = {
    { "-o", "FILE", "picture, its format by the extension, or state (.part); may be given again" },
    { "--integrator", "NAME[:KEY=VALUE,...]", "how light travels; see list integrators" },
    { "--spp", "N", "samples a pixel; with --error the most, with --adaptive alone the mean" },
    { "--time", "SECONDS", "of rendering, instead of a sample count" },
    { "--error", "X", "stop at this estimated sigma/mu" },
    { "--adaptive", "NAME[:KEY=VALUE,...]", "samples where they are wanted; see list adaptives" },
    { "--aov", "NAME=FILE", "extra picture; see list aovs; those in one .exr are its layers" },
    DENOISING_ARGS,
    { "--autosave", "SECONDS", "write the picture, and the state in FILE.part, now and then" },
    { "--resume", "FILE.part", "go on from that state, by the same command" },
    { "--shard", "I/N", "the I-th share of N of the samples, to a .part; see help merge" },
    { "--preview", NULL, "shows the picture in the terminal while it is rendered" },
    DISPLAY_ARGS,
    SCENE_ARGS,
    { NULL, NULL, NULL }
};

static int run(int argc, char **argv);

const Command command_render = {
    "render", "SCENE [-o FILE] [options]", "renders a scene (.pbrt, .obj, .ply) to a picture", args,
    run
};

typedef struct {
    SceneLine asked;
    Outputs outputs;
    const char *state;          /* where it goes; NULL: nobody said */
    bool preview;
    bool keeps;                 /* it is written, however the render ends */
    double autosave;            /* seconds between states; 0: none */
    const volatile sig_atomic_t *stop;
    Arena arena;                /* of options */
} Line;

static bool set_aov(Line *l, const char *value)
{
    if (l->asked.request.naovs == AOVS_ASKED)
        return err_usage("at most %d --aov are possible", AOVS_ASKED);
    l->asked.request.aovs[l->asked.request.naovs++] = value;
    return true;
}

static bool is_state(const char *path) { return !strcmp(path_extension(path), "part"); }

static bool set_output(Line *l, const char *value)
{
    if (!is_state(value))
        return output_add(l->outputs.pictures, &l->outputs.n, value);
    if (l->state)
        return err_usage("a render has one state, got '%s' and '%s'", l->state, value);
    l->state = value;
    return true;
}

static bool set_number(Line *l, int k, const char *value)
{
    RenderRequest *q = &l->asked.request;
    const char *name = args[k].name;
    int64_t n = 0;
    bool ok = true;

    switch (k) {
    case ARG_SPP:      ok = arg_int(name, value, 1, UINT32_MAX, &n); q->spp = (uint32_t)n; break;
    case ARG_TIME:     ok = arg_number(name, value, 1e-3, 1e9, &q->seconds); break;
    case ARG_ERROR:    ok = arg_number(name, value, 1e-9, 1e9, &q->error); break;
    case ARG_AUTOSAVE: ok = arg_number(name, value, 1e-3, 1e9, &l->autosave); break;
    case ARG_SHARD:    ok = arg_part(name, value, &q->shard, &q->shards); q->shard--; break;
    default: break;
    }
    return ok;
}

static bool set(void *ctx, int k, const char *value)
{
    Line *l = ctx;
    RenderRequest *q = &l->asked.request;

    switch (k) {
    case -1:             return scene_line_set(&l->asked, &command_render, k, value);
    case ARG_OUTPUT:     return set_output(l, value);
    case ARG_RESUME:     q->resume = value; return true;
    case ARG_PREVIEW:    l->preview = true; return true;
    case ARG_INTEGRATOR: q->integrator = value; return true;
    case ARG_ADAPTIVE:   q->adaptive = value; return true;
    case ARG_AOV:        return set_aov(l, value);
    case ARG_DENOISE:    return denoising_set(&l->outputs.denoising, value, &l->arena);
    case ARG_FIREFLIES:  return denoising_set_fireflies(&l->outputs.denoising, value);
    default:
        if (k < ARG_DISPLAY)
            return set_number(l, k, value);
        if (k < ARG_SCENE)
            return display_arg_set((DisplayArg)(k - ARG_DISPLAY), value, &l->outputs.display,
                                   &l->arena);
        return scene_line_set(&l->asked, &command_render, k - ARG_SCENE, value);
    }
}

/* ---- the job ---- */

static void summary(const RenderReport *r, const Film *f, const Line *l)
{
    char t[32], e[NUMBER_MAX];
    double error = film_error(f);

    number_print_fixed(e, error, 4);
    if (l->outputs.n && denoising_any(&l->outputs.denoising))
        note("%s: filtered, and so biased: it is no longer a mean of samples",
             l->outputs.pictures[0]);
    note("%s%s: %.1f samples a pixel in %s, %.2f Mrays/s, %.2f Mpaths a CPU-second, "
         "estimated sigma/mu %s",
         l->outputs.n ? l->outputs.pictures[0] : l->state,
         r->interrupted ? " (interrupted)" : "", (double)r->samples / ((double)f->w * f->h),
         clock_text(t, sizeof t, r->seconds),
         r->seconds > 0 ? (double)r->rays * 1e-6 / r->seconds : 0,
         r->cpu_seconds > 0 ? (double)r->samples * 1e-6 / r->cpu_seconds : 0,
         error < INFINITY ? e : "unknown");
}

/* [GIRT table 5.3], for methods that have paths from lamps and from the eye. */
static void summary_of_paths(const RenderReport *r)
{
    const PathWork *w = &r->work;

    if (w->from_lamps && w->from_eye)
        note("%.2f edges a path from the lamps, %.2f from the eye, each with %.1f connections and "
             "%.1f mergers; a pass took %.3f s, %.3f of it before the eye's paths",
             (double)w->lamp_edges / (double)w->from_lamps,
             (double)w->eye_edges / (double)w->from_eye,
             (double)w->joins / (double)w->from_eye, (double)w->mergers / (double)w->from_eye,
             r->passes ? r->seconds / r->passes : r->seconds,
             r->passes ? r->before / r->passes : r->before);
}

/* The name with another ending, in the arena. NULL: no memory, reported. */
static const char *with_ending(SceneFile *f, const char *name, const char *ending)
{
    size_t n = strlen(name) - strlen(path_extension(name)), more = strlen(ending) + 1;
    char *made;

    if (n && name[n - 1] == '.')
        n--;
    made = arena_take(&f->arena, n + more, 1);
    if (!made)
        return NULL;
    memcpy(made, name, n);
    memcpy(made + n, ending, more);
    return made;
}

static const char *base_name(const char *path)
{
    const char *slash = strrchr(path, '/');
    return slash ? slash + 1 : path;
}

/* Where the picture goes if the command line does not say: the scene's own name for it if we can
 * write that, else the scene's name with .png. Beside the current folder, as people expect. */
static bool choose_output(Line *l, SceneFile *f)
{
    const char *name = settings_filename(f);

    if (l->asked.request.shards && l->outputs.n)
        return err_usage("--shard gives a share of a picture: -o takes FILE.part, and merge makes "
                         "%s", l->outputs.pictures[0]);
    if (l->outputs.n || l->state || l->asked.request.shards)
        return true;
    if (name && image_format_of(name)) {
        l->outputs.pictures[l->outputs.n++] = name;
        return true;
    }
    l->outputs.pictures[l->outputs.n] = with_ending(f, name ? name : base_name(l->asked.scene),
                                                    ".png");
    return l->outputs.pictures[l->outputs.n++] != NULL;
}

/* Where the state goes: where it came from, else beside the picture. */
static bool choose_state(Line *l, SceneFile *f)
{
    const RenderRequest *q = &l->asked.request;
    char ending[60] = ".part";

    l->keeps = l->state || q->resume || q->shards || l->autosave > 0;
    if (!l->state)
        l->state = q->resume;
    if (q->shards)
        snprintf(ending, sizeof ending, "-%lu-of-%lu.part", (unsigned long)q->shard + 1,
                 (unsigned long)q->shards);
    if (!l->state)
        l->state = with_ending(f, l->outputs.n ? l->outputs.pictures[0]
                                               : base_name(l->asked.scene), ending);
    return l->state != NULL;
}

/* ---- what is kept ---- */

/* Before the hours of rendering, not after them. */
static bool all_possible(const Line *l, const RenderSettings *s)
{
    return outputs_possible(&l->outputs, s) && (!l->keeps || out_possible(l->state));
}

/* Those of a share are for merge to make. */
static bool write_pictures(const Film *f, const Line *l, const RenderSettings *s)
{
    return s->shards || outputs_write(&l->outputs, s, f);
}

typedef struct {
    const Line *line;
    const RenderSettings *settings;
    bool written;               /* the last state and, between states, the pictures with it */
    bool failed;                /* an earlier one was not */
} Keeping;

/* What cannot be written now may be written the next time: the render goes on. */
static void keep(void *ctx, const Job *job, const Film *f, const RenderReport *r, bool last)
{
    Keeping *k = ctx;

    k->failed = k->failed || !k->written;
    if (last && !k->line->keeps && !r->interrupted)
        return;
    k->written = state_write(job, k->line->state);
    if (!last)
        k->written = write_pictures(f, k->line, k->settings) && k->written;
}

/* What remains to be done when the render has ended. */
static bool finish(const Line *l, const RenderSettings *s, const Film *film, const Keeping *k,
                   const RenderReport *report)
{
    if (!write_pictures(film, l, s))
        return false;
    if (k->written && k->failed)
        err_forgive();
    summary(report, film, l);
    summary_of_paths(report);
    if (report->interrupted && k->written && s->keeper)
        note("%s has its state; the same command with --resume %s goes on", l->state, l->state);
    return k->written;
}

/* False: reported, *film empty. */
static bool render_seen(const Line *l, const Scene *scene, RenderSettings *s, Film *film,
                        RenderReport *report)
{
    Preview preview;
    bool ok;

    if (!l->preview)
        return render(scene, s, film, report);
    if (!preview_start(&preview, &l->outputs.display, s))
        return false;
    ok = render(scene, s, film, report);
    preview_end(&preview);
    return ok;
}

static bool render_scene(Line *l, SceneFile *f, uint64_t digest, int *status)
{
    RenderSettings s;
    Keeping keeping = { l, &s, true, false };
    RenderKeeper keeper = { &keeping, l->autosave, keep };
    RenderReport report;
    Film film;
    double start = clock_wall();
    char t[32];
    bool ok;

    if (!settings_resolve(&s, &l->asked.request, f) || !settings_camera(f) ||
        !choose_output(l, f) || !choose_state(l, f) || !all_possible(l, &s))
        return false;
    if (s.integrator->unkept && l->keeps)
        return err_usage("%s: what it knows cannot be kept in a file; without --autosave, "
                         "--resume, --shard and .part it can be rendered",
                         s.integrator->info.name);
    s.stop = l->stop;
    l->outputs.denoising.threads = s.threads;
    outputs_prepare(&l->outputs, &s);
    s.keeper = s.integrator->unkept ? NULL : &keeper;
    s.scene_digest = digest;
    s.max_file = l->asked.limits.max_file;
    if (!scene_build(f->scene, s.accel, &s.accel_opts, s.threads))
        return false;
    note("%s: %lu primitives, %lu lights, built in %s, %.1f MiB", l->asked.scene,
         (unsigned long)geometry_prims(f->scene->accel->geo), (unsigned long)f->scene->nlights,
         clock_text(t, sizeof t, clock_wall() - start), (double)mem_bytes() / 1048576.0);
    if (!render_seen(l, f->scene, &s, &film, &report))
        return false;
    ok = finish(l, &s, &film, &keeping, &report);
    if (report.interrupted)
        *status = STATUS_INTERRUPTED;
    film_clear(&film);
    return ok;
}

static int render_file(Line *l)
{
    SceneFile f;
    uint64_t digest;
    int status = STATUS_OK;
    bool ok;

    l->stop = interrupts_catch();
    file_digest_start();
    ok = scenefile_read(&f, l->asked.scene, &l->asked.limits);
    digest = file_digest();
    if (!ok)
        return failed_status();
    ok = render_scene(l, &f, digest, &status);
    scenefile_clear(&f);
    return ok && err_status() == STATUS_OK ? status : failed_status();
}

static int run(int argc, char **argv)
{
    Line l = { .state = NULL };
    bool ok = scene_line_parse(&l.asked, &command_render, argc, argv, set, &l);
    int status = ok ? render_file(&l) : failed_status();

    arena_clear(&l.arena);
    return status;
}
