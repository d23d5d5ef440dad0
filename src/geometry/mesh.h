/* mesh.h -- triangle meshes as they come from files or generators. */
#ifndef GEOMETRY_MESH_H
#define GEOMETRY_MESH_H

#include "base/error.h"
#include "base/vec.h"

#include <stddef.h>
#include <stdint.h>

typedef struct { uint32_t v[3]; } Tri;                  /* counter-clockwise from the front */

/* All arrays owned. n and uv are NULL or hold nverts entries. {0} is the empty mesh.
 * Invariants after a reader: every index < nverts; every position finite; normals are unit or
 * (0,0,0) for "none here". */
typedef struct {
    uint32_t nverts, ntris;
    V3  *p;                     /* scene units */
    V3  *n;
    V2  *uv;
    Tri *tri;
    /* Group of each triangle, or NULL if there is one group only: index into `groups`. */
    uint32_t *group;
} Mesh;

void mesh_clear(Mesh *m);

/* Drops triangles of zero area (two equal corners, or corners on a line so that the computed area
 * is 0) and returns how many they were. Keeps order. */
uint32_t mesh_drop_degenerate(Mesh *m);

/* ---- readers ----
 * Each takes the file's bytes and its name for messages. False: one error with its place was
 * reported and *m is empty. Memory stays below a small multiple of n whatever the counts in the
 * file claim. Non-finite positions are errors; degenerate triangles are dropped by the caller. */

bool ply_read(Mesh *m, const char *path, const unsigned char *bytes, size_t n);

/* A material as an MTL file gives it; `file` and `line` say where. Colours linear as written. */
typedef struct {
    char  name[128];
    Place at;
    Rgb   kd, ks, ke, tf;
    float ns, ni, d;
    int   illum;                /* -1: not given */
    bool  has_kd, has_ks, has_ke;
    char  map_kd[256], map_d[256], map_bump[256];       /* "" if none */
} MtlMaterial;

typedef struct { MtlMaterial *m; size_t n, cap; } MtlFile;      /* owned */
bool mtl_read(MtlFile *f, const char *path, const unsigned char *bytes, size_t n);
void mtl_clear(MtlFile *f);

/* An OBJ file: one mesh, its triangles labelled by `usemtl` group. */
typedef struct {
    Mesh   mesh;
    char (*group_names)[128];   /* owned; name of the usemtl of mesh.group k, "" before the first */
    size_t ngroups, cap_groups;
    char (*mtllibs)[256];       /* owned; names as written, relative to the OBJ file */
    size_t nmtllibs, cap_mtllibs;
} ObjFile;
bool obj_read(ObjFile *f, const char *path, const unsigned char *bytes, size_t n);
void obj_clear(ObjFile *f);

#endif
