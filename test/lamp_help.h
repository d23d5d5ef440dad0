/* lamp_help.h -- lamps of every kind, and things for them to shine on: for methods that follow
 * light from the lamps. */
#ifndef TEST_LAMP_HELP_H
#define TEST_LAMP_HELP_H

#include "test/pictures.h"

/* quad, ball, point, spot, distant, infinite (constant) or picture (a sky). */
enum { LAMPS = 7 };
extern const char *const lamp_names[LAMPS];
void lamp_add(Lab *l, const char *lamp);
Rgb lamp_sky(V3 w);                     /* the picture */

/* A matt floor and wall, a glossy ball and a matt one whose shading normals are far from its flat
 * sides. */
void lamp_things(Lab *l);

/* A lamp, the things, and the camera before them; lens: its options. */
void lamp_scene(Lab *l, const char *lamp, const char *lens);

/* A ball of glass over a floor, and a lamp above of some size, so that paths meet it by chance. */
void lamp_glass(Lab *l);

#endif
