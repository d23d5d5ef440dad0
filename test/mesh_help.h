/* mesh_help.h -- what the suites of meshes share: reading from a block of exactly the file's size
 * (so that a sanitizer sees one byte too many), counting messages, and the invariants of mesh.h. */
#ifndef TEST_MESH_HELP_H
#define TEST_MESH_HELP_H

#include "geometry/meshfile.h"
#include "test/test.h"

typedef enum { FILE_PLY, FILE_OBJ, FILE_MTL } MeshFileKind;

/* What came of reading. */
typedef struct {
    bool    ok;
    Mesh    mesh;               /* of PLY and OBJ; that of obj */
    ObjFile obj;
    MtlFile mtl;
} MeshFile;

/* Reads n bytes in place. */
MeshFile mesh_file_read(MeshFileKind kind, const char *name, const unsigned char *bytes, size_t n);
void mesh_file_clear(MeshFileKind kind, MeshFile *f);

/* The invariants of mesh.h; NULL, or what is broken. */
const char *mesh_fault(const Mesh *m);
const char *mesh_file_fault(MeshFileKind kind, const MeshFile *f);

/* Every edge in exactly two triangles, once each way; every vertex used; V - E + F as given. */
void mesh_check_closed(const char *name, const Mesh *m, long euler);
double mesh_volume(const Mesh *m);
double mesh_area(const Mesh *m);
/* Makes one of all vertices at the same place: normals and uv are then of no use. */
void mesh_weld(Mesh *m);

Mesh mesh_of_ply(const char *path);             /* the case ends if it cannot be read */
bool v3_is(V3 v, float x, float y, float z);

/* From now on standard error goes to a file of the case's folder, or (quiet) nowhere. */
void messages_start(void);
void messages_nowhere(void);
/* How many lines came since the last call; the first one is copied to line. */
int messages_take(char *line, size_t room);

#endif
