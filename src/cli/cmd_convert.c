/* cmd_convert.c -- the command `convert`: one image format to another. */
#include "base/file.h"
#include "base/work.h"
#include "cli/args.h"
#include "cli/denoising.h"
#include "cli/displayargs.h"
#include "image/exr.h"
#include "image/tonemap.h"

#include <string.h>

enum { ARG_LAYER, ARG_GUIDE, ARG_MAX_PIXELS, ARG_DENOISE,
       ARG_FIREFLIES, ARG_DISPLAY };

static const ArgDef args[] = {
    { "--layer", "NAME", "of an EXR file; default: its picture" },
    { "--guide", "LAYER=FILE", "for --denoise, where IN is not an EXR file that has the layer: "
      "albedo normal depth variance emission direct indirect variance.direct ..." },
    { "--max-pixels", "N", "of an image; default 268435456" },
    DENOISING_ARGS,
    DISPLAY_ARGS,
    { NULL, NULL, NULL }
};

typedef struct {
    const char *file[2];
    int nfiles;
    Display display;
    Arena arena;
    Denoising denoising;
    const char *layer, *guides[LAYERS];
    int64_t max_pixels;
} Line;

static bool set_guide(Line *l, const char *value)
{
    size_t n = strcspn(value, "=");

    for (int k = PART_EMISSION; value[n] && k < LAYERS; k++)
        if (strlen(denoising_layer(k)) == n && !memcmp(denoising_layer(k), value, n)) {
            l->guides[k] = value + n + 1;
            return true;
        }
    return err_usage("--guide takes LAYER=FILE, with LAYER one of albedo normal depth variance "
                     "emission direct indirect variance.emission variance.direct "
                     "variance.indirect");
}

static bool set(void *ctx, int k, const char *value)
{
    Line *l = ctx;

    if (k >= ARG_DISPLAY)
        return display_arg_set((DisplayArg)(k - ARG_DISPLAY), value, &l->display, &l->arena);
    switch (k) {
    case ARG_LAYER:
        l->layer = value;
        return true;
    case ARG_GUIDE:
        return set_guide(l, value);
    case ARG_DENOISE:
        return denoising_set(&l->denoising, value, &l->arena);
    case ARG_FIREFLIES:
        return denoising_set_fireflies(&l->denoising, value);
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
static void expose(Image *im, const Display *d)
{
    float f = display_gain(d, im);
    for (size_t i = 0; i < (size_t)im->w * im->h; i++)
        im->pixels[i] = rgb_scale(im->pixels[i], f);
}

/* ---- filtering ---- */

/* Layers that an EXR file has and that are wanted. False: reported. */
static bool read_layers(const Line *l, const char *path, Image im[LAYERS])
{
    FileBytes f;
    const unsigned char *bytes;
    bool ok = true;

    if (!file_read(path, FILE_LIMIT_DEFAULT, &f))
        return false;
    bytes = (const unsigned char *)f.bytes;
    for (int k = PART_EMISSION; ok && k < LAYERS; k++)
        if (denoising_wants(&l->denoising, k) && exr_has(bytes, f.size, denoising_layer(k)))
            ok = exr_read(&im[k], path, bytes, f.size, (uint64_t)l->max_pixels,
                          denoising_layer(k));
    file_clear(&f);
    return ok;
}

/* Parts must be there, and all sizes the same. */
static bool layers_fit(const Line *l, const Image im[LAYERS])
{
    for (int k = PART_EMISSION; k < LAYERS; k++) {
        if (im[k].pixels && (im[k].w != im[0].w || im[k].h != im[0].h))
            return err_at((Place){ l->guides[k] ? l->guides[k] : l->file[0], 0, 0 },
                          "'%s' has %lux%lu pixels, the picture has %lux%lu", denoising_layer(k),
                          (unsigned long)im[k].w, (unsigned long)im[k].h, (unsigned long)im[0].w,
                          (unsigned long)im[0].h);
        if (k < PARTS && l->denoising.kind[k] && !im[k].pixels)
            return err_at((Place){ l->file[0], 0, 0 }, "has no layer '%s' to filter (--guide "
                          "%s=FILE gives one)", denoising_layer(k), denoising_layer(k));
    }
    return true;
}

static bool filter(Line *l, Image *picture)
{
    Image im[LAYERS] = { { 0 } };
    bool ok = read_layers(l, l->file[0], im);

    im[PART_PICTURE] = *picture;
    for (int k = PART_EMISSION; ok && k < LAYERS; k++)
        if (l->guides[k] && denoising_wants(&l->denoising, k)) {
            image_clear(&im[k]);
            ok = image_read(&im[k], l->guides[k], (uint64_t)l->max_pixels);
        }
    l->denoising.threads = processors();
    ok = ok && layers_fit(l, im) && denoising_run(&l->denoising, im);
    *picture = im[PART_PICTURE];
    for (int k = PART_EMISSION; k < LAYERS; k++)
        image_clear(&im[k]);
    return ok;
}

/* ---- the job ---- */

static bool convert(Line *l)
{
    const ImageFormat *format = image_format_for_writing(l->file[1]);
    uint64_t most = (uint64_t)l->max_pixels;
    Image im = { 0 };
    bool ok = format && (l->layer ? image_read_layer(&im, l->file[0], most, l->layer)
                                  : image_read(&im, l->file[0], most));

    if (ok && im.alpha)
        ok = warn_at((Place){ l->file[0], 0, 0 }, "it has opacities (alpha), which no format that "
                     "is written has; they are left out");
    if (ok && denoising_any(&l->denoising))
        ok = filter(l, &im);
    if (ok && format->linear && (l->display.exposure != 0.0f || l->display.meter))
        expose(&im, &l->display);
    ok = ok && format->write(&im, l->file[1], &l->display);
    image_clear(&im);
    return ok;
}

static int run(int argc, char **argv)
{
    Line l = { .max_pixels = (int64_t)IMAGE_PIXELS_DEFAULT };
    bool ok = args_parse(&command_convert, argc, argv, set, &l);

    if (ok && l.nfiles != 2)
        ok = err_usage("convert takes two names, the image to read and the one to write");
    ok = ok && convert(&l);
    arena_clear(&l.arena);
    return ok ? STATUS_OK : failed_status();
}
