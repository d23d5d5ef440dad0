/* cmd_compare.c -- the command `compare`: how far one image is from another. */
#include "base/number.h"
#include "cli/args.h"
#include "image/compare.h"

#include <stdio.h>
#include <string.h>

enum { ARG_MAX, ARG_FAMILY, ARG_DIFF, ARG_SCALE, ARG_MAX_PIXELS };
#define ALPHA_DEFAULT 0.01

static const ArgDef args[] = {
    { "--max", "X", "exit with status 1 if sigma/mu is above X" },
    { "--family", "ALPHA", "exit with status 1 if a tile differs, at this family-wise rate" },
    { "--diff", "FILE", "write a picture of the difference: red where A is brighter, blue darker" },
    { "--scale", "X", "factor of that picture; default 1" },
    { "--max-pixels", "N", "of an image; default 268435456" },
    { NULL, NULL, NULL }
};

typedef struct {
    const char *file[2], *diff;
    int nfiles;
    double max, family, scale;          /* max, family below 0: not asked for */
    int64_t max_pixels;
} Line;

static bool set(void *ctx, int k, const char *value)
{
    Line *l = ctx;
    switch (k) {
    case ARG_MAX:        return arg_number("--max", value, 0, 1e300, &l->max);
    case ARG_FAMILY:     return arg_number("--family", value, 1e-12, 0.5, &l->family);
    case ARG_SCALE:      return arg_number("--scale", value, 0, 1e30, &l->scale);
    case ARG_MAX_PIXELS: return arg_int("--max-pixels", value, 1, (int64_t)1 << 40, &l->max_pixels);
    case ARG_DIFF:       l->diff = value; return image_format_for_writing(value) != NULL;
    default:
        if (l->nfiles == 2)
            return err_usage("compare takes two images, an image and its reference");
        l->file[l->nfiles++] = value;
        return true;
    }
}

static void print(const char *name, double v)
{
    char text[NUMBER_MAX];
    number_print_double(text, v);
    printf("%-14s %s\n", name, text);
}

static void print_difference(const ImageDifference *d, const FamilyTest *f)
{
    print("sigma/mu", d->sigma_over_mu);
    print("rmse", d->rmse);
    print("relmse", d->relmse);
    print("mean", d->mean_a);
    print("mean-ref", d->mean_r);
    print("mean-ratio", d->ratio);
    print("max", d->max);
    printf("%-14s %lu,%lu %s\n", "max-at", (unsigned long)d->max_at.x, (unsigned long)d->max_at.y,
           d->max_channel == 0 ? "red" : d->max_channel == 1 ? "green" : "blue");
    print("z-max", d->z_max);
    printf("%-14s %lu,%lu\n", "z-max-at", (unsigned long)d->z_max_at.x,
           (unsigned long)d->z_max_at.y);
    print("z-mean", d->z_mean);
    print("tiles", (double)d->tiles);
    print("tiles-differ", (double)f->differ);
    print("family-p", f->p);
    print("not-finite", (double)(d->not_finite_a + d->not_finite_r));
}

static bool write_difference(const Line *l, const Image *a, const Image *b)
{
    const ImageFormat *format = image_format_for_writing(l->diff);
    Display plain = { 0 };
    Image im;
    bool ok;

    if (!image_difference(a, l->file[0], b, l->file[1], DIFFERENCE_SIGNED, l->scale, &im))
        return false;
    ok = format->write(&im, l->diff, &plain);
    image_clear(&im);
    return ok;
}

static int run(int argc, char **argv);

const Command command_compare = {
    "compare", "IMAGE REFERENCE", "how far an image is from a reference: sigma/mu, RMSE, ...", args,
    run
};

static int run(int argc, char **argv)
{
    Line l = { { NULL, NULL }, NULL, 0, -1, -1, 1, (int64_t)IMAGE_PIXELS_DEFAULT };
    Image a = { 0 }, b = { 0 };
    ImageDifference d;
    FamilyTest f;
    int status = STATUS_OK;

    if (!args_parse(&command_compare, argc, argv, set, &l))
        return failed_status();
    if (l.nfiles != 2) {
        err_usage("compare takes two images, an image and its reference");
        return STATUS_USAGE;
    }
    if (image_read(&a, l.file[0], (uint64_t)l.max_pixels) &&
        image_read(&b, l.file[1], (uint64_t)l.max_pixels) &&
        image_compare(&a, l.file[0], &b, l.file[1], &d) &&
        image_family_test(&a, l.file[0], &b, l.file[1], l.family > 0 ? l.family : ALPHA_DEFAULT,
                          &f)) {
        print_difference(&d, &f);
        if ((l.max >= 0 && !(d.sigma_over_mu <= l.max)) || (l.family > 0 && (f.differ || !f.tiles)))
            status = STATUS_DIFFERENT;
        if (l.diff && !write_difference(&l, &a, &b))
            status = failed_status();
    } else
        status = failed_status();
    image_clear(&a);
    image_clear(&b);
    return status;
}
