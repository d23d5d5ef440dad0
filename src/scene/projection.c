/* projection.c -- the light `projection`: a projector. It stands in the origin of its frame and
 * looks along +z; its picture's rows run along +x and its columns, from the top, along +y (so where
 * y is up the slide stands on its head, as the scene language has it). A pixel is an intensity, the
 * same in the middle and at the edges: a wall across the beam gets darker outwards as cos^3, a
 * sphere about the projector does not. Source: [PBRT4 12.2.2], [Wang09 5]; the mapping is `window`
 * of panorama.h. */
#include "scene/lamp.h"

/* Degrees across the shorter side; versions 3 and 4 of the scene language have other defaults. */
static double field(const Opts *o)
{
    return mapping_is_v3(o) && !opt_given(o, "fov") ? 45.0 : (double)opt_float(o, "fov");
}

static Light *make(const Making *m, const Opts *o)
{
    const Image *image;
    Lamp *l = lamp_make(m, o, "a projection light's", &image);
    double half = field(o) * PI / 360.0;
    Mapping window = { MAPPING_WINDOW, 0, 0 };

    if (!l)
        return NULL;
    window.half_x = window.half_y = (float)(md_sin(half) / md_cos(half));
    if (image && image->w > image->h)
        window.half_x *= (float)image->w / (float)image->h;
    else if (image)
        window.half_y *= (float)image->h / (float)image->w;
    return lamp_finish(l, o, image, window);
}

static const OptDef options[] = {
    LAMP_OPTIONS,
    { .key = "fov", .type = OPT_FLOAT, .num = 90, .lo = 1e-3, .hi = 179,
      .help = "degrees across the shorter side of the picture; 45 beside mapname" },
    { .key = NULL }
};

const LightKind light_projection = {
    .info = { "projection", "PBRT4 12.2.2; Wang09 5", "a projector", options },
    LAMP_FUNCTIONS
};
