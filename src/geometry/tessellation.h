/* tessellation.h -- regular tessellations: grids of points whose triangles stand in no list.
 *
 * Source      [Cline07 3.2.2, 3.3.3]; eq. 3.4 as [Cline07]'s rows from y = 0 want it.
 * Kinds       A height field keeps one number a point, the rest follows from its place: just over 2
 *             bytes a triangle. A geometry image keeps three: just over 6. As fractions of 16 bits
 *             it is half of that.
 * Points      Rectangular: (x, y) with x < nu, y < nv, in rows. Triangular: 0 <= x <= y < nv, nu =
 *             nv; point y (y + 1) / 2 + x [Cline07 (3.4)] (printed with y - 1, for rows from 1).
 * Triangles   Row y, between the points of rows y and y + 1, is a strip. Its points in turn are
 *             (0, y+1) (0, y) (1, y+1) (1, y) (2, y+1) ..., and any three neighbours in that order
 *             are a triangle: the one at position 2 x is (x, y) (x+1, y+1) (x, y+1), that at 2 x +
 *             1 is (x, y) (x+1, y) (x+1, y+1). Both kinds of subdivision have this; rows of a
 *             triangular one end with the triangle at 2 y.
 * Numbers     Rectangular: 2 (y (nu - 1) + x), and one more for the triangle at the even position,
 *             the order in which meshes are written. Triangular: y^2 + position.
 * Invariants  tessellation_point() alone says where a point is, so neighbours meet without a crack,
 *             and structures for rays find what a plain loop over the triangles finds.
 * Departs     Sides are not bound to 2^k + 1 points. */
#ifndef GEOMETRY_TESSELLATION_H
#define GEOMETRY_TESSELLATION_H

#include "base/transform.h"
#include "base/vec.h"

#include <stddef.h>
#include <stdint.h>

/* What lies beyond the border of the grid, for normals: nothing; the other end; the same side, run
 * the other way, as where a square is folded into a bag. */
typedef enum { BORDER_OPEN, BORDER_WRAPS, BORDER_FOLDS } TessellationBorder;

#define TESSELLATION_MOST (1u << 30)    /* points a side: twice as many fit an int */

typedef struct Tessellation {
    bool      triangular;
    bool      heights;          /* one number a point; else three */
    bool      smooth;           /* shading normals are the surface's, not the triangles' */
    TessellationBorder border;
    uint32_t  nu, nv;           /* points of a row (the longest), rows; at least 2 */
    float    *values;           /* owned; or NULL, and then: */
    uint16_t *fractions;        /* owned; q of axis k is lo[k] + q step[k]; heights are axis 2 */
    float     lo[3], step[3];
    double    map[3][4];        /* heights: from (x / (nu - 1), y / (nv - 1), height) to space */
    Box       bounds;           /* joins triangle_box of every triangle */
    uint32_t  first_face;       /* number of its first triangle in its geometry, see geometry.h */
    uint32_t  index;            /* among the tessellations of its geometry */
} Tessellation;

/* All points 0; fill `values`, in the order of points, and call tessellation_finish. A height field
 * lies over the unit square (or its half x <= y) of a space that `map` takes to the geometry's; an
 * affine map only. map NULL: a geometry image. False: too many triangles for numbers of 32 bits, or
 * no memory; reported, and nothing is owned. */
bool tessellation_init(Tessellation *t, bool triangular, uint32_t nu, uint32_t nv,
                       const Transform *map);
/* bits 16: values become fractions of the box of all. 32: they stay floats. Finds the bounds.
 * False: no memory, reported. */
bool tessellation_finish(Tessellation *t, int bits);
void tessellation_clear(Tessellation *t);
/* *to, which need not be set, shares nothing with *from. False: no memory, reported, *to empty. */
bool tessellation_copy(Tessellation *to, const Tessellation *from);

size_t   tessellation_points(const Tessellation *t);            /* their number */
uint32_t tessellation_faces(const Tessellation *t);             /* that of the triangles */
size_t   tessellation_bytes(const Tessellation *t);             /* of the points */

/* [Cline07 (3.4)] */
INLINE size_t tessellation_index(const Tessellation *t, uint32_t x, uint32_t y)
{
    return (t->triangular ? (size_t)y * (y + (size_t)1) / 2 : (size_t)y * t->nu) + x;
}

INLINE V2 tessellation_uv(const Tessellation *t, uint32_t x, uint32_t y)
{
    return (V2){ (float)x / (float)(t->nu - 1), (float)y / (float)(t->nv - 1) };
}

/* The point over (x, y): the arithmetic is that of xf_point. */
INLINE V3 tessellation_lift(const Tessellation *t, uint32_t x, uint32_t y, float height)
{
    const double (*m)[4] = t->map;
    V2 uv = tessellation_uv(t, x, y);
    double u = uv.x, v = uv.y, h = height;

    return v3((float)(m[0][0] * u + m[0][1] * v + m[0][2] * h + m[0][3]),
              (float)(m[1][0] * u + m[1][1] * v + m[1][2] * h + m[1][3]),
              (float)(m[2][0] * u + m[2][1] * v + m[2][2] * h + m[2][3]));
}

INLINE float tessellation_number(const Tessellation *t, size_t i, int axis)
{
    return t->values ? t->values[i] : t->lo[axis] + (float)t->fractions[i] * t->step[axis];
}

/* Point (x, y), in the geometry's space. */
INLINE V3 tessellation_point(const Tessellation *t, uint32_t x, uint32_t y)
{
    size_t i = tessellation_index(t, x, y);

    if (t->heights)
        return tessellation_lift(t, x, y, tessellation_number(t, i, 2));
    return v3(tessellation_number(t, 3 * i, 0), tessellation_number(t, 3 * i + 1, 1),
              tessellation_number(t, 3 * i + 2, 2));
}

/* Point k of the strip of row y. */
INLINE V3 tessellation_strip(const Tessellation *t, uint32_t y, uint32_t k)
{
    return tessellation_point(t, k / 2, y + !(k & 1));
}

/* The number of the triangle at a position of row y. */
INLINE uint32_t tessellation_face(const Tessellation *t, uint32_t y, uint32_t position)
{
    return t->triangular ? y * y + position : 2 * y * (t->nu - 1) + (position ^ 1);
}

/* Where the corners of triangle `face` are in the grid, and in space, counter-clockwise as seen
 * from where x runs to the right and y upwards. */
typedef struct { uint32_t x, y; } GridPoint;
void tessellation_places(const Tessellation *t, uint32_t face, GridPoint at[3]);
void tessellation_corners(const Tessellation *t, uint32_t face, V3 c[3]);

/* The normal of the surface at a point, by its neighbours, to the side from which triangles are
 * counter-clockwise. Not made unit; 0 where neighbours lie on a line. */
V3 tessellation_normal(const Tessellation *t, GridPoint at);

#endif
