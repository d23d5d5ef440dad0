/* cmd_render.c -- the command `render`: the main job. */
#include "base/clock.h"
#include "base/number.h"
#include "base/work.h"
#include "cli/args.h"
#include "cli/displayargs.h"
#include "cli/interrupt.h"
#include "cli/outputs.h"
#include "cli/sceneargs.h"

#include <stdio.h>
#include <string.h>

enum {
    ARG_OUTPUT, ARG_INTEGRATOR, ARG_SPP, ARG_TIME, ARG_ERROR, ARG_ADAPTIVE, ARG_AOV, ARG_DENOISE,
    ARG_FIREFLIES, ARG_DISPLAY,
    ARG_SCENE = ARG_DISPLAY + DISPLAY_ARGS_N
};

static const ArgDef args[] = {
    { "-o", "FILE", "picture to write; the extension picks the format; may be given again" },
    { "--integrator", "NAME[:KEY=VALUE,...]", "how light travels; see list integrators" },
    { "--spp", "N", "samples a pixel; with --error the most, with --adaptive alone the mean" },
    { "--time", "SECONDS", "of rendering, instead of a sample count" },
    { "--error", "X", "stop at this estimated sigma/mu" },
    { "--adaptive", "NAME[:KEY=VALUE,...]", "samples where they are wanted; see list adaptives" },
    { "--aov", "NAME=FILE", "extra picture; see list aovs; those in one .exr are its layers" },
    DENOISING_ARGS,
    DISPLAY_ARGS,
    SCENE_ARGS,
    { NULL, NULL, NULL }
};

typedef struct {
    const char *scene;
    Outputs outputs;
    RenderRequest request;
    ReadLimits limits;
    const volatile sig_atomic_t *stop;
    Arena arena;                /* of options */
} Line;

static bool set_aov(Line *l, const char *value)
{
    if (l->request.naovs == AOVS_ASKED)
        return err_usage("at most %d --aov are possible", AOVS_ASKED);
    l->request.aovs[l->request.naovs++] = value;
    return true;
}

static bool set_number(Line *l, int k, const char *value)
{
    RenderRequest *q = &l->request;
    const char *name = args[k].name;
    int64_t n = 0;
    bool ok = true;

    switch (k) {
    case ARG_SPP:      ok = arg_int(name, value, 1, UINT32_MAX, &n); q->spp = (uint32_t)n; break;
    case ARG_TIME:     ok = arg_number(name, value, 1e-3, 1e9, &q->seconds); break;
    case ARG_ERROR:    ok = arg_number(name, value, 1e-9, 1e9, &q->error); break;
    default: break;
    }
    return ok;
}

static bool set(void *ctx, int k, const char *value)
{
    Line *l = ctx;
    RenderRequest *q = &l->request;

    switch (k) {
    case -1:
        if (l->scene)
            return err_usage("render takes one scene, got '%s' and '%s'", l->scene, value);
        l->scene = value;
        return true;
    case ARG_OUTPUT:     return output_add(l->outputs.pictures, &l->outputs.n, value);
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
        return scene_arg_set((SceneArg)(k - ARG_SCENE), value, q, &l->limits);
    }
}

/* ---- the job ---- */

static void summary(const RenderReport *r, const Film *f, const Line *l)
{
    char t[32], e[NUMBER_MAX];
    double error = film_error(f);

    number_print_fixed(e, error, 4);
    if (denoising_any(&l->outputs.denoising))
        note("%s: filtered, and so biased: it is no longer a mean of samples",
             l->outputs.pictures[0]);
    note("%s%s%s: %.1f samples a pixel in %s, %.2f Mrays/s, %.2f Mpaths a CPU-second, "
         "estimated sigma/mu %s",
         l->outputs.n ? l->outputs.pictures[0] : "", l->outputs.n ? "" : "picture",
         r->interrupted ? " (interrupted)" : "", (double)r->samples / ((double)f->w * f->h),
         clock_text(t, sizeof t, r->seconds),
         r->seconds > 0 ? (double)r->rays * 1e-6 / r->seconds : 0,
         r->cpu_seconds > 0 ? (double)r->samples * 1e-6 / r->cpu_seconds : 0,
         error < INFINITY ? e : "unknown");
}

/* Where the picture goes if the command line does not say: the scene's own name for it if we can
 * write that, else the scene's name with .png. Beside the current folder, as people expect. */
static bool choose_output(Line *l, SceneFile *f)
{
    const char *name = settings_filename(f), *base = strrchr(l->scene, '/');
    size_t n;
    char *made;

    if (l->outputs.n)
        return true;
    if (name) {
        const char *ext = path_extension(name);
        for (int i = 0; image_formats[i]; i++)
            if (image_formats[i]->write && !strcmp(image_formats[i]->info.name, ext)) {
                l->outputs.pictures[l->outputs.n++] = name;
                return true;
            }
    } else
        name = base ? base + 1 : l->scene;
    n = strlen(name) - strlen(path_extension(name));
    if (n && name[n - 1] == '.')
        n--;
    made = arena_take(&f->arena, n + 5, 1);
    if (!made)
        return false;
    memcpy(made, name, n);
    memcpy(made + n, ".png", 5);
    l->outputs.pictures[l->outputs.n++] = made;
    return true;
}

static bool render_scene(Line *l, SceneFile *f, int *status)
{
    RenderSettings s;
    RenderReport report;
    Film film;
    double start = clock_wall();
    char t[32];
    bool ok;

    if (!settings_resolve(&s, &l->request, f) || !settings_camera(f) || !choose_output(l, f) ||
        !outputs_possible(&l->outputs, &s))
        return false;
    s.stop = l->stop;
    l->outputs.denoising.threads = s.threads;
    outputs_prepare(&l->outputs, &s);
    if (!scene_build(f->scene, s.accel, &s.accel_opts, s.threads))
        return false;
    note("%s: %lu primitives, %lu lights, built in %s, %.1f MiB", l->scene,
         (unsigned long)geometry_prims(f->scene->accel->geo), (unsigned long)f->scene->nlights,
         clock_text(t, sizeof t, clock_wall() - start), (double)mem_bytes() / 1048576.0);
    if (!render(f->scene, &s, &film, &report))
        return false;
    ok = outputs_write(&l->outputs, &s, &film);
    if (ok)
        summary(&report, &film, l);
    if (report.interrupted)
        *status = STATUS_INTERRUPTED;
    film_clear(&film);
    return ok;
}

static int run(int argc, char **argv);

const Command command_render = {
    "render", "SCENE [-o FILE] [options]", "renders a scene (.pbrt, .obj, .ply) to a picture", args,
    run
};

static int render_file(Line *l)
{
    SceneFile f;
    int status = STATUS_OK;
    bool ok;

    l->request.max_pixels = l->limits.max_pixels;
    l->stop = interrupts_catch();
    if (!scenefile_read(&f, l->scene, &l->limits))
        return failed_status();
    ok = render_scene(l, &f, &status);
    scenefile_clear(&f);
    return ok && err_status() == STATUS_OK ? status : failed_status();
}

static int run(int argc, char **argv)
{
    Line l = { 0 };
    ReadLimits limits = READ_LIMITS_DEFAULT;
    bool ok;
    int status;

    l.limits = limits;
    l.request.threads = processors();
    ok = args_parse(&command_render, argc, argv, set, &l);
    if (ok && !l.scene)
        ok = err_usage("render takes a scene (.pbrt, .obj or .ply); see rushlight help render");
    status = ok ? render_file(&l) : failed_status();
    arena_clear(&l.arena);
    return status;
}
