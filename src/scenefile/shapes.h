/* shapes.h -- the shapes of the scene language. shapes.c has the list. */
#ifndef SCENEFILE_SHAPES_H
#define SCENEFILE_SHAPES_H

#include "geometry/quadric_mesh.h"
#include "scenefile/reader.h"

struct ShapeReader {
    KindInfo info;              /* options: single values; arrays (P, N, ...) are taken from ps */
    bool (*read)(Reader *r, Place at, const Params *ps, const Opts *o);  /* or NULL: unsupported */
};

/* ---- pieces that readers share; each false: reported ---- */

bool shape_points(const Params *ps, Place at, Mesh *m);             /* "P" */
bool shape_indices(const Params *ps, Place at, size_t corners, uint32_t nverts, const Param **out);
bool shape_triangles(const Params *ps, Place at, Mesh *m);          /* "indices" */
bool shape_normals(const Params *ps, Mesh *m);                      /* "N", "uv" or "st" */
/* Adds the mesh if ok, with the material and light of the moment; takes it over in any case. */
bool shape_finish(Reader *r, Place at, Mesh *m, bool ok);

/* Of a shape without triangles: what it has of the state of the moment. */
bool shape_traits(Reader *r, ShapeTraits *traits);
bool shape_not_finite(Place at, const char *what, size_t i);    /* false: reported, always */

/* ---- modelled.c ---- */

extern const ShapeReader shape_curve, shape_torus, shape_box, shape_lathe, shape_generated;

/* ---- tessellated.c ---- */

bool shape_add_quadric(Reader *r, Place at, const Quadric *q);
bool shape_distorted_sphere(Reader *r, Place at, const Opts *o, float zmin, float zmax);
bool shape_distorted_disk(Reader *r, Place at, const Opts *o);
bool shape_read_cylinder(Reader *r, Place at, const Params *ps, const Opts *o);
bool shape_read_cone(Reader *r, Place at, const Params *ps, const Opts *o);
bool shape_read_paraboloid(Reader *r, Place at, const Params *ps, const Opts *o);
bool shape_read_hyperboloid(Reader *r, Place at, const Params *ps, const Opts *o);
bool shape_read_loop(Reader *r, Place at, const Params *ps, const Opts *o);
bool shape_read_bilinear(Reader *r, Place at, const Params *ps, const Opts *o);

/* ---- tessellations.c ---- */

bool shape_read_heights(Reader *r, Place at, const Params *ps, const Opts *o);
bool shape_read_image(Reader *r, Place at, const Params *ps, const Opts *o);

#endif
