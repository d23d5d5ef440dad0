/* quadric_mesh.h -- triangles for the shapes of revolution that rays are not cast against
 * themselves: cylinders, cones, and spheres and discs that a transform distorts. */
#ifndef GEOMETRY_QUADRIC_MESH_H
#define GEOMETRY_QUADRIC_MESH_H

#include "geometry/mesh.h"

typedef enum {
    QUADRIC_SPHERE, QUADRIC_DISK, QUADRIC_CYLINDER, QUADRIC_CONE, QUADRIC_PARABOLOID,
    QUADRIC_HYPERBOLOID
} QuadricKind;

/* The parameters of the scene language; each kind has its own (see quadric_mesh.c). All finite;
 * radius > 0, 0 < phimax <= 360 degrees. */
typedef struct {
    QuadricKind kind;
    double radius, inner, zmin, zmax, height, phimax;
    V3     p1, p2;
} Quadric;

uint32_t quadric_triangles(const Quadric *q);           /* at most so many */

/* A mesh with unit normals and the (u, v) of the language, *m empty before. False: out of memory,
 * reported; *m is to be cleared in any case. */
bool quadric_mesh(Mesh *m, const Quadric *q);

#endif
