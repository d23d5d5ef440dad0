/* cmd_view.c -- the command `view`: a scene looked at in a browser. */
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

static int run(int argc, char **argv);

const Command command_view = {
    "view", "SCENE [options]",
    "serves a viewer for browsers of this machine, at the address that it prints", args, run
};

typedef struct {
    SceneLine asked;
    int port;
} Line;

static bool set(void *ctx, int k, const char *value)
{
    Line *l = ctx;
    int64_t n = 0;
    bool ok = true;

    switch (k) {
    case -1:             return scene_line_set(&l->asked, &command_view, k, value);
    case ARG_INTEGRATOR: l->asked.request.integrator = value; break;
    case ARG_SPP:        ok = arg_int("--spp", value, 1, UINT32_MAX, &n);
                         l->asked.request.spp = (uint32_t)n; break;
    case ARG_PORT:       ok = arg_int("--port", value, 0, 65535, &n); l->port = (int)n; break;
    default:             return scene_line_set(&l->asked, &command_view, k - ARG_SCENE, value);
    }
    return ok;
}

/* False: reported. */
static bool view_scene(Line *l, SceneFile *f)
{
    const volatile sig_atomic_t *stop = interrupts_catch();
    RenderSettings s;
    Session *session;
    bool ok;

    if (!settings_resolve(&s, &l->asked.request, f) || !settings_camera(f) ||
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

/* What goes wrong in the browser is told there: only what keeps the viewer from its work counts. */
static int run(int argc, char **argv)
{
    Line l = { .asked.request.spp = SPP_MOST };
    SceneFile f;
    bool ok;

    if (!scene_line_parse(&l.asked, &command_view, argc, argv, set, &l) ||
        !scenefile_read(&f, l.asked.scene, &l.asked.limits))
        return failed_status();
    ok = view_scene(&l, &f);
    scenefile_clear(&f);
    return ok ? STATUS_OK : failed_status();
}
