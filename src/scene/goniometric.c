/* goniometric.c -- the light `goniometric`: a point that shines by a picture of all directions, as
 * goniophotometers measure lamps. The pole of the picture is y of the light's frame, not z as for
 * skies: lamps hang. Source: [PBRT4 12.2.3]; mappings: panorama.h. */
#include "scene/lamp.h"

/* The picture's z is the light's y, and the other way round. */
static void exchange_axes(Lamp *l)
{
    for (int i = 0; i < 3; i++) {
        float y = l->to_world.m[i][1];
        l->to_world.m[i][1] = l->to_lamp.m[1][i] = l->to_world.m[i][2];
        l->to_world.m[i][2] = l->to_lamp.m[2][i] = y;
    }
}

static Light *make(const Making *m, const Opts *o)
{
    const Image *image;
    Lamp *l = lamp_make(m, o, "a goniometric light's", &image);
    Mapping mapping = { MAPPING_OCTAHEDRAL, 0, 0 };

    if (!l)
        return NULL;
    exchange_axes(l);
    return lamp_finish(l, o, image, image ? mapping_option(o, image) : mapping);
}

static const OptDef options[] = {
    LAMP_OPTIONS,
    MAPPING_OPTION("where directions are; auto: octahedral if square, but mapname is latlong"),
    { .key = NULL }
};

const LightKind light_goniometric = {
    .info = { "goniometric", "PBRT4 12.2.3", "a point that shines by a picture of directions",
              options },
    LAMP_FUNCTIONS
};
