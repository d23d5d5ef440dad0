/* generate.h -- meshes made by rule, for tests, demonstrations and benchmarks. The same arguments
 * give the same bytes on every machine.
 *
 * Each fills *m, which must be empty. False: reported (an argument out of range, too many
 * triangles, out of memory), *m empty.
 *
 * The closed ones (all but box, soup and grid) are watertight in their indices: every edge belongs
 * to exactly two triangles that run through it in opposite directions, and triangles are
 * counter-clockwise from outside. */
#ifndef GEOMETRY_GENERATE_H
#define GEOMETRY_GENERATE_H

#include "geometry/mesh.h"

/* Side 1 about the origin: 8 vertices, 12 triangles. */
bool mesh_cube(Mesh *m);

/* The box between a and b, a below b: 24 vertices, four for each side, with uv from 0 to 1 on each.
 * Edges are closed in space, not in indices. */
bool mesh_box(Mesh *m, V3 a, V3 b);

/* Unit sphere about the origin from an icosahedron whose edges are cut into n parts:
 * 10 n^2 + 2 vertices, 20 n^2 triangles. n from 1 to 10000. */
bool mesh_icosphere(Mesh *m, uint32_t n);

/* Unit sphere by longitude (nu >= 3 parts) and latitude (nv >= 2), poles on the z axis:
 * nu (nv - 1) + 2 vertices, 2 nu (nv - 1) triangles. */
bool mesh_uvsphere(Mesh *m, uint32_t nu, uint32_t nv);

/* Torus about the z axis: ring of radius `major` in nu >= 3 parts, tube of radius `minor`, smaller,
 * in nv >= 3 parts: nu nv vertices, 2 nu nv triangles. */
bool mesh_torus(Mesh *m, uint32_t nu, uint32_t nv, float major, float minor);

/* An icosphere whose radius varies between 0.7 and 1.3 by random waves. */
bool mesh_bumpy(Mesh *m, uint32_t n, uint64_t seed);

/* The same with exactly ntris triangles, 80 at least: some of the icosphere's are cut into three.
 * An odd number leaves a hole of one triangle. */
bool mesh_bumpy_of(Mesh *m, uint32_t ntris, uint64_t seed);

/* A lumpy body of 102 vertices and 200 triangles, radius between 0.7 and 1.3. */
bool mesh_blob(Mesh *m, uint64_t seed);

/* L-shaped room 2 x 2 x 1, a quarter of which is missing, with a corner at the origin: 12
 * vertices, 20 triangles, volume 3, area 14. Meant to be seen from within. */
bool mesh_room(Mesh *m);

/* n triangles with corners of their own, each within a cube of the given side, whose centres are
 * random in the unit cube. */
bool mesh_soup(Mesh *m, uint32_t n, float side, uint64_t seed);

/* The unit square z = 0, facing +z, in nx by ny quadrangles, with uv = (x, y). */
bool mesh_grid(Mesh *m, uint32_t nx, uint32_t ny);

#endif
