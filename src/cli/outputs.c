/* outputs.c -- see outputs.h. */
#include "cli/outputs.h"

#include "base/file.h"
#include "image/exr.h"

#include <string.h>

/* Output k: first the pictures, then the extra ones. */
static int outputs_n(const Outputs *o, const RenderSettings *s) { return o->n + s->naovs; }

static const char *file_of(const Outputs *o, const RenderSettings *s, int k)
{
    return k < o->n ? o->pictures[k] : s->aovs[k - o->n].file;
}

static const Aov *aov_of(const Outputs *o, const RenderSettings *s, int k)
{
    return k < o->n ? NULL : &s->aovs[k - o->n];
}

bool output_add(const char **outputs, int *n, const char *value)
{
    if (*n == OUTPUTS_MAX)
        return err_usage("at most %d -o are possible", OUTPUTS_MAX);
    outputs[(*n)++] = value;
    return image_format_for_writing(value) != NULL;
}

bool outputs_possible(const Outputs *o, const RenderSettings *s)
{
    for (int k = 0; k < outputs_n(o, s); k++)
        if (file_of(o, s, k) && !out_possible(file_of(o, s, k)))
            return false;
    return true;
}

/* ---- what filters want ---- */

/* A layer of denoising.h as an extra picture. */
static AovKind kind_of(int layer, int *which)
{
    static const AovKind parts[PARTS] = { AOV_PICTURE, AOV_EMISSION, AOV_DIRECT, AOV_INDIRECT };
    static const AovKind guides[] = { AOV_ALBEDO, AOV_NORMAL, AOV_DEPTH };

    *which = layer >= GUIDE_VARIANCE ? (int)parts[layer - GUIDE_VARIANCE] : 0;
    return layer < PARTS ? parts[layer] : layer < GUIDE_VARIANCE ? guides[layer - GUIDE_ALBEDO]
                                                                 : AOV_VARIANCE;
}

/* Where light comes in splats nobody knows the variance of parts. */
static bool has_layer(const Outputs *o, const RenderSettings *s, int layer)
{
    return denoising_wants(&o->denoising, layer) &&
           !(s->integrator->splats && layer > GUIDE_VARIANCE);
}

void outputs_prepare(const Outputs *o, RenderSettings *s)
{
    for (int layer = PART_EMISSION; layer < LAYERS; layer++) {
        int which;
        AovKind kind = kind_of(layer, &which);
        if (has_layer(o, s, layer))
            settings_aov(s, kind, which);
    }
}

/* False: reported. */
static bool make_picture(const Film *f, const RenderSettings *s, const Aov *a, Image *im)
{
    if (!image_init(im, f->w, f->h))
        return false;
    if (a)
        aov_picture(a, f, (int)(a - s->aovs), im);
    else
        film_picture(f, 0, im);
    return true;
}

/* The picture as it is to be written. False: reported, *im empty. */
static bool finish_picture(const Outputs *o, const RenderSettings *s, const Film *f, Image *im)
{
    RenderSettings copy = *s;   /* in which what is there is found */
    Image layers[LAYERS] = { { 0 } };
    bool ok = true;

    for (int k = 0; ok && k < LAYERS; k++) {
        int which;
        AovKind kind = kind_of(k, &which);
        if (k == PART_PICTURE || has_layer(o, s, k))
            ok = make_picture(f, s, k ? &s->aovs[settings_aov(&copy, kind, which)] : NULL,
                              &layers[k]);
    }
    ok = ok && denoising_run(&o->denoising, layers);
    *im = layers[PART_PICTURE];
    for (int k = ok; k < LAYERS; k++)
        image_clear(&layers[k]);
    if (!ok)
        *im = (Image){ 0 };
    return ok;
}

/* ---- files ---- */

static bool write_alone(const Outputs *o, const RenderSettings *s, const Film *f, int k)
{
    const ImageFormat *format = image_format_for_writing(file_of(o, s, k));
    const Aov *a = aov_of(o, s, k);
    Image im;
    bool ok = format && (a ? make_picture(f, s, a, &im) : finish_picture(o, s, f, &im));

    if (!ok)
        return false;
    if (a && !format->linear)
        aov_display(a, &im);
    ok = format->write(&im, file_of(o, s, k), &o->display);
    image_clear(&im);
    return ok;
}

static bool same_file(const Outputs *o, const RenderSettings *s, int a, int b)
{
    const char *x = file_of(o, s, a), *y = file_of(o, s, b);
    return x && y && !strcmp(x, y);
}

/* Of those that go to the same file: whether k is the first one, or what it is the layer of. */
static bool is_first(const Outputs *o, const RenderSettings *s, int k)
{
    for (int i = 0; i < k; i++)
        if (same_file(o, s, i, k))
            return false;
    return true;
}

/* All outputs of the file of output k, which is the first of them, as layers. */
static bool write_layers(const Outputs *o, const RenderSettings *s, const Film *f, int k)
{
    enum { MOST = OUTPUTS_MAX + AOVS_MAX };
    ExrLayer layers[MOST];
    Image images[MOST];
    char names[MOST][EXR_NAME];
    int n = 0;
    bool ok = true;

    for (int i = k; ok && i < outputs_n(o, s); i++) {
        const Aov *a = aov_of(o, s, i);
        if (!same_file(o, s, i, k) || (i > k && !a))
            continue;
        ok = a ? make_picture(f, s, a, &images[n]) : finish_picture(o, s, f, &images[n]);
        layers[n] = (ExrLayer){ a ? aov_layer(a, names[n], EXR_NAME) : "",
                                a ? aov_channels(a) : "RGB", &images[n] };
        n += ok;
    }
    ok = ok && exr_write(file_of(o, s, k), layers, n, !o->display.uncompressed);
    while (n > 0)
        image_clear(&images[--n]);
    return ok;
}

bool outputs_write(const Outputs *o, const RenderSettings *s, const Film *f)
{
    bool ok = true;

    for (int k = 0; k < outputs_n(o, s); k++) {
        const char *path = file_of(o, s, k);
        bool layered = path && !strcmp(image_format_for_writing(path)->info.name, "exr");
        if (path && (!layered || is_first(o, s, k)))
            ok = (layered ? write_layers(o, s, f, k) : write_alone(o, s, f, k)) && ok;
    }
    return ok;
}
