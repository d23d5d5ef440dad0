/* displayargs.c -- see displayargs.h. */
#include "cli/displayargs.h"

#include "cli/args.h"

bool display_arg_set(DisplayArg k, const char *value, Display *d, Arena *arena)
{
    double x = 0;

    switch (k) {
    case DISPLAY_TONEMAP:
        d->tonemap = kind_from_text(tonemaps, "tone mapper", value, &d->tonemap_opts, arena);
        return d->tonemap != NULL;
    case DISPLAY_EXPOSURE:
        if (!arg_number("--exposure", value, -100, 100, &x))
            return false;
        d->exposure = (float)x;
        return true;
    case DISPLAY_AUTO:
        d->meter = kind_from_text(meters, "meter", value, &d->meter_opts, arena);
        return d->meter != NULL;
    case DISPLAY_DITHER:
        d->dither = true;
        return true;
    default:
        d->uncompressed = true;
        return true;
    }
}
