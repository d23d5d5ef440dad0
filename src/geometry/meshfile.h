/* meshfile.h -- files of meshes: PLY, OBJ, and MTL, which says what the materials of an OBJ file
 * are.
 *
 * Each reader takes the file's bytes (n of them; no 0 need follow) and its name for messages.
 * False: one error with its place was reported and what it would fill is empty. What a user would
 * rather go on without (faces of two corners, unknown keywords, ...) is left out and counted in one
 * warning a file. Memory stays below 16 n + 1 MiB whatever the counts in the file claim. Non-finite
 * positions are errors; degenerate triangles are dropped by the caller. */
#ifndef GEOMETRY_MESHFILE_H
#define GEOMETRY_MESHFILE_H

#include "geometry/mesh.h"

bool ply_read(Mesh *m, const char *path, const unsigned char *bytes, size_t n);

/* Writes a binary little-endian PLY: positions, normals and texture coordinates if there are any,
 * triangles. Groups are not written. False: reported, an older file untouched. */
bool ply_write(const Mesh *m, const char *path);

typedef enum {
    MTL_KD, MTL_KS, MTL_KE, MTL_NS, MTL_D, MTL_BUMP, MTL_NORM, MTL_ROUGHNESS, MTL_METALLIC
} MtlMapKind;
typedef struct MtlMap { const struct MtlMap *next; const char *name; MtlMapKind kind; } MtlMap;

/* A material as an MTL file gives it; `at` says where (its file is the path given, borrowed).
 * Colours linear as written. What is not given: kd, ks, ke 0 (see has_*); tf 1; ns 0; ni 1; d 1;
 * bump 1; roughness, metallic -1; coat, coat_roughness, aniso 0. Strings belong to the MtlFile;
 * map names are as written, relative to the MTL file. */
typedef struct {
    const char *name;
    const MtlMap *maps;         /* the MtlFile's; newest first. See mtl_map */
    Place at;
    Rgb   kd, ks, ke, tf;
    float ns, ni, d;
    float bump;                 /* option -bm of map_bump or norm: multiplies the heights */
    float roughness, metallic, coat, coat_roughness, aniso;     /* Pr, Pm, Pc, Pcr, aniso */
    signed char illum;          /* -1: not given */
    bool  has_kd, has_ks, has_ke;
} MtlMaterial;

typedef struct { MtlMaterial *m; size_t n, cap; Arena strings; } MtlFile;       /* owned */
const char *mtl_map(const MtlMaterial *m, MtlMapKind kind);     /* "" if none */
bool mtl_read(MtlFile *f, const char *path, const unsigned char *bytes, size_t n);
void mtl_clear(MtlFile *f);

/* An OBJ file: one mesh, its triangles labelled by the `usemtl` in force. Only names that label a
 * triangle are groups; they are numbered in order of first use. All owned. */
typedef struct {
    Mesh   mesh;
    const char **group_names;   /* name of the usemtl of mesh.group k, "" before the first */
    size_t ngroups, cap_groups; /* 0 if there are no triangles */
    const char **mtllibs;       /* names as written, relative to the OBJ file, each once */
    size_t nmtllibs, cap_mtllibs;
    Arena  strings;             /* holds the names */
} ObjFile;
bool obj_read(ObjFile *f, const char *path, const unsigned char *bytes, size_t n);
void obj_clear(ObjFile *f);

#endif
