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

/* tessellated.c: adds one made of triangles; and what a stretched sphere or disc becomes. */
bool shape_add_quadric(Reader *r, Place at, const Quadric *q);
bool shape_distorted_sphere(Reader *r, Place at, const Opts *o, float zmin, float zmax);
bool shape_distorted_disk(Reader *r, Place at, const Opts *o);

/* ---- options that several have ---- */

#define SHAPE_RADIUS \
    { .key = "radius", .type = OPT_FLOAT, .num = 1, .lo = 1e-30, .hi = 1e30, \
      .help = "scene units" }
#define SHAPE_PHIMAX \
    { .key = "phimax", .type = OPT_FLOAT, .num = 360, .lo = 1e-3, .hi = 360, \
      .help = "how far round it goes, degrees" }
#define SHAPE_ALONG_Z(key_, num_, help_) \
    { .key = key_, .type = OPT_FLOAT, .num = num_, .lo = -1e30, .hi = 1e30, .help = help_ }

/* ---- those of other files than shapes.c ---- */

extern const ShapeReader shape_curve, shape_torus, shape_box, shape_lathe, shape_generated;
extern const ShapeReader shape_cylinder, shape_cone, shape_paraboloid, shape_hyperboloid;
extern const ShapeReader shape_loopsubdiv, shape_bilinearmesh;          /* tessellated.c */
extern const ShapeReader shape_heightfield, shape_geometryimage;        /* tessellations.c */

#endif
