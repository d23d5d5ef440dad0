/* denoising.c -- see denoising.h.
 *
 * Parts       [GIRT 4.1.2.5] filters components of a picture apart: indirect light may be blurred
 *             where direct light must not. The picture then is what it was, less the parts as they
 *             were, and with the parts as they are filtered. */
#include "cli/denoising.h"

#include "cli/args.h"

#include <string.h>

const char *denoising_layer(int layer)
{
    static const char *const names[LAYERS] = {
        "", "emission", "direct", "indirect", "albedo", "normal", "depth", "variance",
        "variance.emission", "variance.direct", "variance.indirect"
    };
    return names[layer];
}

bool denoising_set(Denoising *d, const char *value, Arena *arena)
{
    size_t n = strcspn(value, "=:");
    int part = PART_PICTURE;

    if (value[n] == '=') {
        for (part = PART_EMISSION; part < PARTS; part++)
            if (strlen(denoising_layer(part)) == n && !memcmp(denoising_layer(part), value, n))
                break;
        if (part == PARTS)
            return err_usage("--denoise PART=NAME takes emission, direct or indirect");
        value += n + 1;
    }
    d->kind[part] = kind_from_text(denoisers, "noise filter", value, &d->opts[part], arena);
    if (!d->kind[part])
        return false;
    for (int k = PART_EMISSION; d->kind[PART_PICTURE] && k < PARTS; k++)
        if (d->kind[k])
            return err_usage("--denoise filters the picture or parts of it, not both");
    return true;
}

bool denoising_set_fireflies(Denoising *d, const char *value)
{
    double x = 0;

    if (!arg_number("--fireflies", value, 1, 1e9, &x))
        return false;
    d->fireflies = (float)x;
    return true;
}

static bool filters(const Denoising *d)
{
    for (int k = 0; k < PARTS; k++)
        if (d->kind[k])
            return true;
    return false;
}

bool denoising_any(const Denoising *d) { return d->fireflies > 0.0f || filters(d); }

bool denoising_wants(const Denoising *d, int layer)
{
    if (layer >= GUIDE_VARIANCE)
        return d->kind[layer - GUIDE_VARIANCE] != NULL;
    if (layer >= GUIDE_ALBEDO)
        return filters(d);
    if (layer == PART_EMISSION && d->kind[PART_PICTURE])
        return true;            /* which is left out, see filter_part */
    return layer == PART_PICTURE || d->kind[layer];
}

static const Image *if_there(const Image *im) { return im->pixels ? im : NULL; }

/* A file may hold what no render gives. */
static void drop_not_finite(Image *im)
{
    for (size_t i = 0; im->pixels && i < (size_t)im->w * im->h; i++)
        if (!rgb_finite(im->pixels[i]))
            im->pixels[i] = rgb_all(0.0f);
}

/* From a - b, or if `back` to a + b; where there is no b, a. */
static void leave_out(Image *a, const Image *b, bool back)
{
    for (size_t i = 0; b->pixels && i < (size_t)a->w * a->h; i++)
        a->pixels[i] = back ? rgb_add(a->pixels[i], b->pixels[i])
                            : rgb_sub(a->pixels[i], b->pixels[i]);
}

/* The filtered part in place of the part. Of the picture, what is seen of lamps themselves is left
 * out if it is known: there is little noise in it, and much light, which must not leak. */
static bool filter_part(const Denoising *d, Image im[LAYERS], int part)
{
    static const Image none = { 0 };
    const Image *seen = part == PART_PICTURE ? &im[PART_EMISSION] : &none;
    Image *variance = &im[GUIDE_VARIANCE + part], *whole = &im[PART_PICTURE], out;
    Noisy in = { &im[part], if_there(variance), if_there(&im[GUIDE_ALBEDO]),
                 if_there(&im[GUIDE_NORMAL]), if_there(&im[GUIDE_DEPTH]), d->threads };
    bool ok = image_init(&out, im[part].w, im[part].h);

    leave_out(&im[part], seen, false);
    ok = ok && d->kind[part]->run(&in, &d->opts[part], &out);
    for (size_t i = 0; ok && i < (size_t)out.w * out.h; i++) {
        Rgb rest = part == PART_PICTURE ? rgb_all(0.0f)
                                        : rgb_sub(whole->pixels[i], im[part].pixels[i]);
        whole->pixels[i] = rgb_add(rest, out.pixels[i]);
    }
    leave_out(whole, seen, true);
    image_clear(&out);
    return ok;
}

/* Parts lose what they are above the brightest beside them, and the picture loses as much. */
static bool clamp_part(const Denoising *d, Image im[LAYERS], int part)
{
    Image *variance = &im[GUIDE_VARIANCE + part], *whole = &im[PART_PICTURE];
    size_t n = (size_t)whole->w * whole->h;
    Image before = { 0 };
    bool ok = part == PART_PICTURE || image_init(&before, whole->w, whole->h);

    for (size_t i = 0; before.pixels && i < n; i++)
        before.pixels[i] = im[part].pixels[i];
    ok = ok && fireflies_clamp(&im[part], variance->pixels ? variance : NULL, d->fireflies);
    for (size_t i = 0; ok && before.pixels && i < n; i++)
        whole->pixels[i] = rgb_add(whole->pixels[i],
                                   rgb_sub(im[part].pixels[i], before.pixels[i]));
    image_clear(&before);
    return ok;
}

bool denoising_run(const Denoising *d, Image im[LAYERS])
{
    bool ok = true, parts = filters(d) && !d->kind[PART_PICTURE];

    for (int k = 0; k < LAYERS; k++)
        drop_not_finite(&im[k]);
    for (int k = 0; ok && d->fireflies > 0.0f && k < PARTS; k++)
        if (parts ? d->kind[k] != NULL : k == PART_PICTURE)
            ok = clamp_part(d, im, k);
    for (int k = 0; ok && k < PARTS; k++)
        if (d->kind[k])
            ok = filter_part(d, im, k);
    return ok;
}
