/* figures.h -- bodies for scenes, made by rule: a rock, a knot, and figures that read as a skull, a
 * statue, a hare, a dragon. The same arguments give the same bytes on every machine. */
#ifndef GEOMETRY_FIGURES_H
#define GEOMETRY_FIGURES_H

#include "geometry/mesh.h"

typedef enum {
    FIGURE_ROCK, FIGURE_KNOT, FIGURE_SKULL, FIGURE_STATUE, FIGURE_HARE, FIGURE_DRAGON
} FigureKind;

/* Closed, with unit normals, counter-clockwise from outside, of ntris triangles, 1000 at least (an
 * odd number becomes one less). All are about 1 high, stand on z = 0 (the knot lies about the
 * origin, 2 wide) and look towards -y. `seed` gives other rocks. With fewer than 40,000 triangles
 * the thinnest parts (tips of spines, gaps of teeth) may come apart or close. *m must be empty;
 * false: reported, *m empty. */
bool figure_mesh(Mesh *m, FigureKind kind, uint32_t ntris, uint64_t seed);

#endif
