/* sceneargs.h -- options of every command that reads a scene and renders it: a command's table
 * holds its own ones, then SCENE_ARGS; the numbers of those go to scene_arg_set. A command that
 * takes one scene and no other word has a SceneLine. */
#ifndef CLI_SCENEARGS_H
#define CLI_SCENEARGS_H

#include "cli/args.h"
#include "render/render.h"

/* In the order of SCENE_ARGS. From SCENE_QUIET on: how the program goes about it, not what it
 * makes. */
typedef enum {
    SCENE_ACCEL, SCENE_SAMPLER, SCENE_FILTER, SCENE_SIZE, SCENE_CROP, SCENE_THREADS, SCENE_SEED,
    SCENE_QUIET, SCENE_STRICT, SCENE_MAX_PIXELS, SCENE_MAX_MEMORY, SCENE_MAX_INCLUDE,
    SCENE_MAX_FILE
} SceneArg;

#define SCENE_ARGS \
    { "--accel", "NAME[:KEY=VALUE,...]", "structure for rays; see list accelerators" }, \
    { "--sampler", "NAME[:KEY=VALUE,...]", "where samples go; see list samplers" }, \
    { "--filter", "NAME[:KEY=VALUE,...]", "pixel filter; see list filters" }, \
    { "--size", "WxH", "of the picture, pixels" }, \
    { "--crop", "X0,Y0,X1,Y1", "render this window only (half open)" }, \
    { "--threads", "N", "default: all processors" }, \
    { "--seed", "N", "of the random numbers; default 0" }, \
    { "--quiet", NULL, "no progress, no summary" }, \
    { "--strict", NULL, "warnings are errors" }, \
    { "--max-pixels", "N", "of any image; default 268435456" }, \
    { "--max-memory", "MIB", "held at once; default: no limit" }, \
    { "--max-include", "N", "depth of Include; default 64" }, \
    { "--max-file", "MIB", "size of one input file; default 8192" }

/* value is borrowed. False: usage error reported. */
bool scene_arg_set(SceneArg k, const char *value, RenderRequest *q, ReadLimits *limits);

/* What a command line asks for of one scene. All borrowed from it. */
typedef struct {
    const char *scene;
    RenderRequest request;
    ReadLimits limits;
} SceneLine;

/* Option k of SCENE_ARGS, or with k = -1 the scene itself. False: usage error reported. */
bool scene_line_set(SceneLine *l, const Command *c, int k, const char *value);
/* Reads the words by args_parse, from the usual limits and number of threads on. False: usage error
 * reported, which it also is if they name no scene. */
bool scene_line_parse(SceneLine *l, const Command *c, int argc, char **argv,
                      bool (*set)(void *ctx, int k, const char *value), void *ctx);

#endif
