/* sceneargs.h -- options of every command that reads a scene and renders it: a command's table
 * holds its own ones, then SCENE_ARGS; the numbers of those go to scene_arg_set. */
#ifndef CLI_SCENEARGS_H
#define CLI_SCENEARGS_H

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
/* One more of at most OUTPUTS_MAX pictures to write; borrowed. False: reported. */
bool output_add(const char **outputs, int *n, const char *value);

#endif
