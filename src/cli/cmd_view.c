/* cmd_view.c -- the command `view`: a scene looked at in a browser. */
#include "base/work.h"
#include "cli/args.h"
#include "cli/interrupt.h"
#include "cli/sceneargs.h"
#include "view/server.h"

enum { ARG_INTEGRATOR, ARG_SPP, ARG_PORT, ARG_SCENE };
enum { SPP_MOST = 4096 };               /* a machine that nobody looks at shall come to rest */

static const ArgDef args[] = {
    { "--integrator", "NAME[:KEY=VALUE,...]", "how light travels at first; see list integrators" },
    { "--spp", "N", "samples a pixel after which a picture rests; default 4096" },
    { "--port", "N", "of 127.0.0.1; default 0: any that is free" },
    SCENE_ARGS,
    { NULL, NULL, NULL }
};

typedef struct {
    const char *scene;
    RenderRequest request;
    ReadLimits limits;
    int port;
} Line;

static bool set(void *ctx, int k, const char *value)
{
    Line *l = ctx;
    RenderRequest *q = &l->request;
    int64_t n = 0;
    bool ok;

    switch (k) {
    case -1:
        if (l->scene)
            return err_usage("view takes one scene, got '%s' and '%s'", l->scene, value);
        l->scene = value;
        return true;
    case ARG_INTEGRATOR:
        q->integrator = value;
        return true;
    case ARG_SPP:
        ok = arg_int("--spp", value, 1, UINT32_MAX, &n);
        q->spp = (uint32_t)n;
        return ok;
    case ARG_PORT:
        ok = arg_int("--port", value, 0, 65535, &n);
        l->port = (int)n;
        return ok;
    default:
        return scene_arg_set((SceneArg)(k - ARG_SCENE), value, q, &l->limits);
    }
}

/* False: reported. */
static bool view_scene(Line *l, SceneFile *f)
{
    const volatile sig_atomic_t *stop = interrupts_catch();
    RenderSettings s;
    Session *session;
    bool ok;

    if (!settings_resolve(&s, &l->request, f) || !settings_camera(f) ||
        !scene_build(f->scene, s.accel, &s.accel_opts, s.threads))
        return false;
    messages_quiet(true);               /* progress is shown in the page */
    session = session_new(f, &s);
    if (!session)
        return false;
    ok = serve(session, l->port, stop);
    session_free(session);
    return ok;
}

static int run(int argc, char **argv);

const Command command_view = {
    "view", "SCENE [options]",
    "serves a viewer for browsers of this machine, at the address that it prints", args, run
};

/* What goes wrong in the browser is told there: only what keeps the viewer from its work counts. */
static int run(int argc, char **argv)
{
    Line l = { 0 };
    ReadLimits limits = READ_LIMITS_DEFAULT;
    SceneFile f;
    bool ok;

    l.limits = limits;
    l.request.threads = processors();
    l.request.spp = SPP_MOST;
    if (!args_parse(&command_view, argc, argv, set, &l))
        return failed_status();
    if (!l.scene) {
        err_usage("view takes a scene (.pbrt, .obj or .ply); see rushlight help view");
        return failed_status();
    }
    l.request.max_pixels = l.limits.max_pixels;
    if (!scenefile_read(&f, l.scene, &l.limits))
        return failed_status();
    ok = view_scene(&l, &f);
    scenefile_clear(&f);
    return ok ? STATUS_OK : failed_status();
}
