/* polygon.h -- polygons in space, of any number of corners, cut into triangles of a mesh.
 *
 * A reader hands over corner after corner. A polygon of n corners always gives n - 2 triangles over
 * its own corners, whatever its shape. Convex ones give the fan about the first corner. Simple ones
 * that are flat, or nearly so, are cut by ear clipping in the plane of their Newell normal, so that
 * concave ones are covered exactly; corners in the middle of a straight side give no triangle
 * without area. What has no such cut (self-crossing, no area) still ends after n - 2 triangles.
 *
 * Ear clipping takes O(n r) tests, r of the n corners being reflex. Two bounds keep a hostile file
 * from using this: a polygon of more than POLYGON_CARE corners becomes a fan, and so does what is
 * left when a file has used up its allowance of tests, which is linear in its size. Both are
 * counted as SKIPPED_CARE. */
#ifndef GEOMETRY_POLYGON_H
#define GEOMETRY_POLYGON_H

#include "geometry/mesh.h"
#include "geometry/skipped.h"

enum { POLYGON_CARE = 4096 };           /* most corners of a polygon that is cut with care */

typedef struct PolygonCorner PolygonCorner;

typedef struct {
    Mesh    *mesh;                      /* borrowed: its triangles are appended to */
    size_t   cap;                       /* of mesh->tri */
    Skipped *skipped;                   /* borrowed */
    const char *file;                   /* borrowed: for messages */
    uint64_t n;                         /* corners of the present polygon so far */
    uint32_t first, last;               /* of a polygon beyond POLYGON_CARE */
    PolygonCorner *c;                   /* owned: the corners up to POLYGON_CARE */
    size_t   cap_c;
    uint64_t tests;                     /* left of the allowance */
} Polygon;

void polygon_init(Polygon *g, Mesh *m, Skipped *skipped, const char *file, size_t file_bytes);
void polygon_clear(Polygon *g);         /* not the mesh */

/* Makes room for n more triangles at once. False: reported. */
bool polygon_room(Polygon *g, uint64_t n);

/* Appends a triangle. False: out of memory or beyond MESH_MAX, reported. */
bool polygon_triangle(Polygon *g, uint32_t a, uint32_t b, uint32_t c);

/* The next corner: vertex `id` at p, which is finite. False: reported. */
bool polygon_corner(Polygon *g, uint32_t id, V3 p);

/* Ends the polygon, which stands at `at`; fewer than three corners are noted as skipped. */
bool polygon_end(Polygon *g, Place at);

#endif
