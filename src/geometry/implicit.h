/* implicit.h -- closed meshes of the surfaces where a function of space is 0. */
#ifndef GEOMETRY_IMPLICIT_H
#define GEOMETRY_IMPLICIT_H

#include "geometry/mesh.h"

/* A function of space, below 0 inside, about a distance near its zeros. */
typedef struct {
    double (*at)(const void *ctx, const double p[3]);
    const void *ctx;            /* borrowed */
    double steepest;            /* |f(p) - f(q)| <= steepest |p - q| */
    double lo[3], hi[3];        /* the inside lies within this box, not on its sides */
} Implicit;

enum { IMPLICIT_LEAST = 400 };

/* A mesh of ntris triangles (IMPLICIT_LEAST or more; an odd number becomes one less) with unit
 * normals, counter-clockwise from outside. Every edge belongs to exactly two triangles, once each
 * way, whatever the function. *m must be empty. False: reported, *m empty. */
bool implicit_mesh(Mesh *m, const Implicit *f, uint32_t ntris);

#endif
