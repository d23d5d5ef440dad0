/* sweep.h -- curves in space as triangles: tubes and ribbons. */
#ifndef GEOMETRY_SWEEP_H
#define GEOMETRY_SWEEP_H

#include "geometry/mesh.h"

typedef struct {
    const V3 *p;                /* borrowed; control points, finite */
    uint32_t  n, degree;        /* degree 2 or 3 */
    bool      bspline;          /* uniform B-spline; else Bezier curves end to end */
    const V3 *normals;          /* borrowed; segments + 1: a ribbon across them; NULL: a tube */
    float     width0, width1;   /* diameter at the ends, linear between */
} Sweep;

/* How many polynomials follow each other; 0: the number of points fits none. */
uint32_t sweep_segments(const Sweep *s);
uint64_t sweep_triangles(const Sweep *s);               /* at most so many */

/* A mesh with unit normals; u runs along the curve, v around the tube or across the ribbon. Tubes
 * have flat ends where they have any width. *m empty before. False: out of memory, reported; *m is
 * to be cleared in any case. A curve without length has no triangles. */
bool sweep_mesh(Mesh *m, const Sweep *s);

#endif
