/* sceneargs.c -- see sceneargs.h. */
#include "cli/sceneargs.h"

#include "base/work.h"

static bool set_memory(const char *value)
{
    int64_t n;

    if (!arg_int("--max-memory", value, 1, (int64_t)1 << 30, &n))
        return false;
    mem_limit((uint64_t)n > SIZE_MAX >> 20 ? SIZE_MAX : (size_t)n << 20);
    return true;
}

static bool set_limit(SceneArg k, const char *value, ReadLimits *l)
{
    int64_t n = 0;
    bool ok = true;

    switch (k) {
    case SCENE_QUIET:       messages_quiet(true); break;
    case SCENE_STRICT:      warnings_fatal(true); break;
    case SCENE_MAX_PIXELS:  ok = arg_int("--max-pixels", value, 1, (int64_t)1 << 40, &n);
                            l->max_pixels = (uint64_t)n; break;
    case SCENE_MAX_MEMORY:  ok = set_memory(value); break;
    case SCENE_MAX_INCLUDE: ok = arg_int("--max-include", value, 1, 10000, &n);
                            l->max_include = (int)n; break;
    case SCENE_MAX_FILE:    ok = arg_int("--max-file", value, 1, (int64_t)1 << 30, &n);
                            l->max_file = (uint64_t)n << 20; break;
    default: break;
    }
    return ok;
}

bool scene_arg_set(SceneArg k, const char *value, RenderRequest *q, ReadLimits *limits)
{
    int64_t n = 0;
    bool ok = true;

    switch (k) {
    case SCENE_ACCEL:   q->accel = value; break;
    case SCENE_SAMPLER: q->sampler = value; break;
    case SCENE_FILTER:  q->filter = value; break;
    case SCENE_SIZE:    ok = arg_size("--size", value, &q->w, &q->h); break;
    case SCENE_CROP:    q->crop_given = true; ok = arg_window("--crop", value, q->crop); break;
    case SCENE_THREADS: ok = arg_int("--threads", value, 1, WORKERS_MAX, &n);
                        q->threads = (int)n; break;
    case SCENE_SEED:    ok = arg_int("--seed", value, 0, INT64_MAX, &n); q->seed = (uint64_t)n;
                        q->seed_given = true; break;
    default:            ok = set_limit(k, value, limits); break;
    }
    return ok;
}

/* ---- one scene ---- */

bool scene_line_set(SceneLine *l, const Command *c, int k, const char *value)
{
    if (k >= 0)
        return scene_arg_set((SceneArg)k, value, &l->request, &l->limits);
    if (l->scene)
        return err_usage("%s takes one scene, got '%s' and '%s'", c->name, l->scene, value);
    l->scene = value;
    return true;
}

bool scene_line_parse(SceneLine *l, const Command *c, int argc, char **argv,
                      bool (*set)(void *ctx, int k, const char *value), void *ctx)
{
    l->limits = (ReadLimits)READ_LIMITS_DEFAULT;
    l->request.threads = processors();
    if (!args_parse(c, argc, argv, set, ctx))
        return false;
    l->request.max_pixels = l->limits.max_pixels;
    return l->scene || err_usage("%s takes a scene (.pbrt, .obj or .ply); see rushlight help %s",
                                 c->name, c->name);
}
