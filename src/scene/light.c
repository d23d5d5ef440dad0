/* light.c -- the list of lights. See scene.h. */
#include "scene/scene.h"

#define LIGHTS(X)                                                              \
    X(point) X(spot) X(distant)         /* delta lights */                     \
    X(diffuse)                          /* shapes that shine, area.c */        \
    X(infinite)                         /* the sky */
#define DECLARE(name) extern const LightKind light_##name;
#define ENTRY(name) &light_##name,
LIGHTS(DECLARE)
const LightKind *const lights[] = { LIGHTS(ENTRY) NULL };

float delta_pdf_w(const Light *l, V3 from, V3 wi, const Surface *hit)
{
    (void)l;
    (void)from;
    (void)wi;
    (void)hit;
    return 0.0f;
}

Rgb delta_radiance(const Light *l, V3 wi, const Surface *hit)
{
    (void)l;
    (void)wi;
    (void)hit;
    return rgb_all(0.0f);
}
