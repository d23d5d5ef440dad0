/* quadric_mesh.h -- triangles for the shapes of revolution that rays are not cast against
 * themselves: cylinders, cones, tori, any turned outline, and spheres and discs that a transform
 * distorts. */
#ifndef GEOMETRY_QUADRIC_MESH_H
#define GEOMETRY_QUADRIC_MESH_H

#include "geometry/mesh.h"

typedef enum {
    QUADRIC_SPHERE, QUADRIC_DISK, QUADRIC_CYLINDER, QUADRIC_CONE, QUADRIC_PARABOLOID,
    QUADRIC_HYPERBOLOID, QUADRIC_TORUS
} QuadricKind;

/* The parameters of the scene language; each kind has its own (see quadric_mesh.c; inner is the
 * radius of the tube of a torus). All finite; radius > 0, 0 < phimax <= 360 degrees. */
typedef struct {
    QuadricKind kind;
    double radius, inner, zmin, zmax, height, phimax;
    V3     p1, p2;
} Quadric;

uint32_t quadric_triangles(const Quadric *q);           /* at most so many */

/* A mesh with unit normals and the (u, v) of the language, *m empty before. False: out of memory,
 * reported; *m is to be cleared in any case. */
bool quadric_mesh(Mesh *m, const Quadric *q);

/* Points (x, z) with x >= 0, joined by a polygon or (smooth) by the curve of Catmull and Rom, and
 * turned about the z axis. A point that is given twice in a row is a corner: the curve ends and
 * begins anew. Normals are on the right hand of who walks along the outline with z up, so that an
 * outline that goes up on the outside has them outside. */
typedef struct {
    const V2 *p;                /* borrowed; n of them, finite */
    uint32_t n;
    bool     smooth;
    double   phimax;            /* degrees */
    uint32_t around;            /* steps of a full turn, 3 at least */
} Outline;

uint64_t outline_triangles(const Outline *o);           /* at most so many */
/* As quadric_mesh. */
bool outline_mesh(Mesh *m, const Outline *o);

#endif
