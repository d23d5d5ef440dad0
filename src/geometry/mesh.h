/* mesh.h -- triangle meshes, as they come from files or are made by rule. */
#ifndef GEOMETRY_MESH_H
#define GEOMETRY_MESH_H

#include "base/error.h"
#include "base/mem.h"
#include "base/vec.h"

#include <stddef.h>
#include <stdint.h>

#define MESH_MAX 0xFFFFFFFEu    /* most vertices, and most triangles, of one mesh */

typedef struct { uint32_t v[3]; } Tri;                  /* counter-clockwise from the front */

/* All arrays owned. n and uv are NULL or hold nverts entries. {0} is the empty mesh.
 * Invariants after a reader: every index < nverts; every position finite; normals are unit or
 * (0,0,0) for "none here"; texture coordinates are finite. */
typedef struct {
    uint32_t nverts, ntris;
    V3  *p;                     /* scene units */
    V3  *n;
    V2  *uv;
    Tri *tri;
    /* Group of each triangle, or NULL if there is one group only: index into `groups`. */
    uint32_t *group;
} Mesh;

/* Makes room in a mesh that is empty: for points and triangles and, if so wanted, for normals and
 * texture coordinates, all 0. How many there are stays 0. False: no memory, reported, *m empty. */
bool mesh_alloc(Mesh *m, size_t nverts, size_t ntris, bool normals, bool uv);
void mesh_clear(Mesh *m);

/* Drops triangles of zero area (two equal corners, or corners on a line so that the area computed
 * in double is 0) and returns how many they were. Keeps order. */
uint32_t mesh_drop_degenerate(Mesh *m);

#endif
