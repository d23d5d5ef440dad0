/* cmd_convert.c -- the command `convert`: one image format to another. */
#include "cli/args.h"
#include "image/image.h"

#include <string.h>

enum { ARG_TONEMAP, ARG_EXPOSURE, ARG_LAYER, ARG_UNCOMPRESSED, ARG_MAX_PIXELS };

static const ArgDef args[] = {
    { "--tonemap", "NAME", "for display formats; see list tonemaps" },
    { "--exposure", "STOPS", "factor 2^STOPS" },
    { "--layer", "NAME", "of an EXR file; default: its picture" },
    { "--uncompressed", NULL, ".exr files are not packed" },
    { "--max-pixels", "N", "of an image; default 268435456" },
    { NULL, NULL, NULL }
};

typedef struct {
    const char *file[2];
    int nfiles;
    Display display;
    const char *layer;
    int64_t max_pixels;
} Line;

static bool set(void *ctx, int k, const char *value)
{
    Line *l = ctx;
    double x = 0;

    switch (k) {
    case ARG_TONEMAP:
        l->display.tonemap = kind_find_at((Place){ NULL, 0, 0 }, tonemaps, "tone mapper", value);
        return l->display.tonemap != NULL;
    case ARG_EXPOSURE:
        if (!arg_number("--exposure", value, -100, 100, &x))
            return false;
        l->display.exposure = (float)x;
        return true;
    case ARG_LAYER:        l->layer = value; return true;
    case ARG_UNCOMPRESSED: l->display.uncompressed = true; return true;
    case ARG_MAX_PIXELS:
        return arg_int("--max-pixels", value, 1, (int64_t)1 << 40, &l->max_pixels);
    default:
        if (l->nfiles == 2)
            return err_usage("convert takes two names, the image to read and the one to write");
        l->file[l->nfiles++] = value;
        return true;
    }
}

static int run(int argc, char **argv);

const Command command_convert = {
    "convert", "IN OUT", "between image formats; the extension of OUT picks one", args, run
};

/* Formats that hold floats keep what was read; the exposure asked for is applied to them too. */
static void expose(Image *im, float stops)
{
    float f = m_pow(2.0f, stops);
    for (size_t i = 0; i < (size_t)im->w * im->h; i++)
        im->pixels[i] = rgb_scale(im->pixels[i], f);
}

static int run(int argc, char **argv)
{
    Line l = { .max_pixels = (int64_t)IMAGE_PIXELS_DEFAULT };
    const ImageFormat *format;
    Image im = { 0 };
    bool ok;

    if (!args_parse(&command_convert, argc, argv, set, &l))
        return failed_status();
    if (l.nfiles != 2) {
        err_usage("convert takes two names, the image to read and the one to write");
        return STATUS_USAGE;
    }
    format = image_format_for_writing(l.file[1]);
    ok = format && (l.layer ? image_read_layer(&im, l.file[0], (uint64_t)l.max_pixels, l.layer)
                            : image_read(&im, l.file[0], (uint64_t)l.max_pixels));
    if (ok && im.alpha)
        ok = warn_at((Place){ l.file[0], 0, 0 }, "it has opacities (alpha), which no format that "
                     "is written has; they are left out");
    if (ok && format->linear && l.display.exposure != 0.0f)
        expose(&im, l.display.exposure);
    ok = ok && format->write(&im, l.file[1], &l.display);
    image_clear(&im);
    return ok ? STATUS_OK : failed_status();
}
