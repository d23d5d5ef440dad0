/* ambient.h -- one colour in place of all light that was scattered more than once.
 *
 * Source  [Shirley91 5.2.1]; errata 001.5: L_ambient is a radiance, which a surface multiplies by
 *         its albedo. */
#ifndef INTEGRATORS_AMBIENT_H
#define INTEGRATORS_AMBIENT_H

#include "scene/scene.h"

/* For an integrator's table; `choice` is its default. */
#define AMBIENT_OPTIONS(choice)                                                                  \
    { .key = "ambient", .type = OPT_CHOICE, .str = choice, .choices = "none constant estimate",  \
      .help = "light scattered more than once: left out, L0 from everywhere, or from the "       \
              "scene's mean reflectance; with it pictures by whitted had 0.7 to 1.4 times the "  \
              "light of path's" },                                                               \
    { .key = "L0", .type = OPT_RGB, .num = 0.1, .lo = 0, .hi = 1e9,                              \
      .help = "radiance of the ambient light, where it is constant" }

/* The radiance that surfaces see from everywhere, besides what a method finds itself. sky: the
 * method does not ask environment lights, so that what arrives straight from them is part of the
 * estimate. Of a scene that is built. */
Rgb ambient_light(const Scene *s, const Opts *o, bool sky);

/* What the estimate is made of: the area of all surfaces that scatter other than as a delta, and
 * their mean reflectance by area. */
typedef struct { double area, reflectance[3]; } Walls;
Walls ambient_walls(const Scene *s);

#endif
