/* lamp_help.h -- lamps of every kind, and things for them to shine on: for methods that follow
 * light from the lamps. */
#ifndef TEST_LAMP_HELP_H
#define TEST_LAMP_HELP_H

#include "test/pictures.h"

/* quad, ball, point, spot, distant, infinite (constant) or picture (a sky). */
void lamp_add(Lab *l, const char *lamp);

/* A matt floor and wall, a glossy ball and a matt one whose shading normals are far from its flat
 * sides. */
void lamp_things(Lab *l);

#endif
