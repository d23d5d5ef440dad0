/* lamp.h -- a light at a point whose intensity is a picture of directions: what the lights
 * `goniometric` and `projection` share. */
#ifndef SCENE_LAMP_H
#define SCENE_LAMP_H

#include "scene/panorama.h"

typedef struct {
    Light    base;
    V3       p;
    Rgb      I;                 /* factor of the picture, W/sr */
    Affine   to_world, to_lamp; /* directions, of the picture's frame */
    Panorama picture;           /* owned */
} Lamp;

/* By the options I, scale, power and filename, all but the picture. NULL: reported. */
Lamp *lamp_make(const Making *m, const Opts *o, const char *what, const Image **image);
/* Takes the picture (NULL: white) and sets the power wanted. NULL: memory, reported. */
Light *lamp_finish(Lamp *l, const Opts *o, const Image *image, Mapping mapping);

void lamp_clear(Light *l);
bool lamp_sample(const Light *l, V3 from, V2 u, LightSample *s);
bool lamp_emit(const Light *l, V2 u, V2 v, Emission *e);
void lamp_emit_pdf(const Light *l, const Surface *hit, V3 d, float *pdf_a, float *pdf_w);
Rgb  lamp_power(const Light *l);

#define LAMP_OPTIONS                                                                               \
    INTENSITY_OPTIONS("intensity where the picture is 1"),                                         \
    { .key = "filename", .type = OPT_STRING, .str = "", .also = "mapname",                         \
      .help = "picture (PFM, HDR, PNG, ...); none: white" }
#define LAMP_FUNCTIONS                                                                             \
    .delta = DELTA_PLACE, .make = make, .clear = lamp_clear, .sample = lamp_sample,                \
    .pdf_w = delta_pdf_w, .radiance = delta_radiance, .emit = lamp_emit,                           \
    .emit_pdf = lamp_emit_pdf, .power = lamp_power

#endif
