/* pictures.c -- the code of `pictures.h`. */
#include "cli/pictures.h"

bool layer_write(const Film *f, int layer, const Aov *aov, const char *path,
                 const Display *display)
{
    const ImageFormat *format = image_format_for_writing(path);
    Image im;
    bool ok;

    if (!format || !image_init(&im, f->w, f->h))
        return false;
    if (aov)
        aov_picture(aov, f, layer - 1, &im);
    else
        film_picture(f, layer, &im);
    if (aov && !format->linear)
        aov_display(aov, &im);
    ok = format->write(&im, path, display);
    image_clear(&im);
    return ok;
}
