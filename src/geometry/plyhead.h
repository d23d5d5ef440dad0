/* plyhead.h -- the header of a PLY file: what elements follow and how their values are stored. */
#ifndef GEOMETRY_PLYHEAD_H
#define GEOMETRY_PLYHEAD_H

#include "base/text.h"

typedef enum { PLY_I8, PLY_U8, PLY_I16, PLY_U16, PLY_I32, PLY_U32, PLY_F32, PLY_F64 } PlyType;

extern const unsigned char ply_size[];          /* bytes of each type */

/* What the reader does with a property. Up to PLY_V the places in a row of vertex values. */
typedef enum { PLY_X, PLY_Y, PLY_Z, PLY_NX, PLY_NY, PLY_NZ, PLY_U, PLY_V, PLY_INDICES, PLY_UNUSED }
    PlyUse;

typedef struct {
    Word    name;
    bool    is_list;
    PlyType type, count_type;                   /* of the values; of a list's count */
    PlyUse  use;
} PlyProperty;

typedef enum { PLY_VERTICES, PLY_FACES, PLY_STRIPS, PLY_OTHER } PlyKind;

typedef struct {
    Word     name;
    Place    at;
    PlyKind  kind;
    uint64_t count;                             /* as the file claims */
    size_t   first, n;                          /* its properties in PlyHead.property */
    unsigned uses;                              /* bit PlyUse: some property has it */
    bool     has_list;
    uint64_t least;                             /* fewest bytes of a record, binary */
} PlyElement;

typedef enum { PLY_ASCII, PLY_LITTLE, PLY_BIG } PlyFormat;

typedef struct {
    PlyFormat    format;
    PlyElement  *element;                       /* owned */
    PlyProperty *property;                      /* owned */
    size_t       n, cap, nproperties, cap_properties;
    PlyElement  *vertices;                      /* the element of kind PLY_VERTICES */
    bool         has_n, has_uv;                 /* all of nx ny nz; both of u v */
    Text         body;                          /* what follows the header */
} PlyHead;

/* Every type fits a double, so one kind of function loads them all. By PlyType; NULL for text. */
typedef double PlyLoad(const unsigned char *);
PlyLoad *const *ply_loaders(PlyFormat format);

/* Names point into `bytes`. False: reported, *h empty. */
bool ply_head_read(PlyHead *h, const char *path, const char *bytes, size_t n);
void ply_head_clear(PlyHead *h);

#endif
