/* image_shapes.h -- geometry images made by rule: closed and open surfaces over a grid.
 *
 * Each fills *t with `side` cells (triangular: rows of triangles) a side, mapped by `place` into
 * the geometry's space (NULL: left as they are), 16 or 32 bits a number. False: reported, nothing
 * is owned. Borders that meet are of the same bits, so closed surfaces have no seam; triangles are
 * counter-clockwise from outside, if `place` does not mirror. */
#ifndef GEOMETRY_IMAGE_SHAPES_H
#define GEOMETRY_IMAGE_SHAPES_H

#include "geometry/tessellation.h"

typedef struct {
    bool     triangular;
    uint32_t side;
    int      bits;
    const Transform *place;     /* borrowed; or NULL */
} ImageForm;

/* Sphere about the origin. The square is folded as an octahedron is unfolded, the triangle as a
 * tetrahedron: each side onto itself, all corners in one point. side >= 2. */
bool image_sphere(Tessellation *t, ImageForm f, float radius);

/* Torus about the z axis, as mesh_torus; rectangular, side >= 3. */
bool image_torus(Tessellation *t, ImageForm f, float major, float minor);

/* The unit square, or its half x <= y, displaced by waves that lean over: no height field. */
bool image_patch(Tessellation *t, ImageForm f);

#endif
