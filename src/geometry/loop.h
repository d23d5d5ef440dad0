/* loop.h -- Loop subdivision: smooth surfaces from coarse triangle meshes. */
#ifndef GEOMETRY_LOOP_H
#define GEOMETRY_LOOP_H

#include "geometry/mesh.h"

typedef enum {
    LOOP_DONE,
    LOOP_NOT_MANIFOLD,          /* *m untouched: an edge of three triangles, a bow tie, or
                                 * neighbours that disagree about the front */
    LOOP_NO_MEMORY              /* reported; *m is to be cleared */
} LoopResult;

/* Replaces the mesh by its subdivision, 4^levels times as many triangles, moved to the limit
 * surface with the limit's normals. Only positions and triangles are read. levels >= 0. */
LoopResult loop_subdivide(Mesh *m, int levels);

#endif
