/* displayargs.h -- options of every command that writes pictures: a command's table holds its own
 * ones, then DISPLAY_ARGS; the numbers of those go to display_arg_set. */
#ifndef CLI_DISPLAYARGS_H
#define CLI_DISPLAYARGS_H

#include "image/image.h"

/* In the order of DISPLAY_ARGS. */
typedef enum {
    DISPLAY_TONEMAP, DISPLAY_EXPOSURE, DISPLAY_AUTO, DISPLAY_DITHER, DISPLAY_UNCOMPRESSED,
    DISPLAY_ARGS_N
} DisplayArg;

#define DISPLAY_ARGS \
    { "--tonemap", "NAME[:KEY=VALUE,...]", "for display formats; see list tonemaps" }, \
    { "--exposure", "STOPS", "for display formats: factor 2^STOPS" }, \
    { "--auto-exposure", "NAME[:KEY=VALUE,...]", "by the picture itself; see list meters" }, \
    { "--dither", NULL, "display formats: no bands in slow gradients" }, \
    { "--uncompressed", NULL, ".exr files are not packed" }

/* False: usage error reported. */
bool display_arg_set(DisplayArg k, const char *value, Display *d, Arena *arena);

#endif
