/* geometry.h -- the primitives of one space: triangles of any number of meshes in one array, then
 * spheres, discs, tessellations and instances. Accelerators index these by number; shading finds
 * the shape that a primitive belongs to.
 *
 * Invariants (after geometry_finish): primitives 0 .. ntris-1 are triangles; ntris .. nprims-1 are
 * `odd` ones, each a shape of its own. Shapes of kind mesh are in order of their first triangle.
 * The triangles of tessellations are no primitives, but hits name them by numbers that go on after
 * those of all primitives: the `faces`. */
#ifndef GEOMETRY_GEOMETRY_H
#define GEOMETRY_GEOMETRY_H

#include "base/motion.h"
#include "geometry/mesh.h"
#include "geometry/ray.h"
#include "geometry/tessellation.h"

typedef enum {
    SHAPE_MESH, SHAPE_SPHERE, SHAPE_DISK, SHAPE_TESSELLATION, SHAPE_INSTANCE
} ShapeKind;

/* A part of a sphere, as the scene language has it: z and phi in the frame of the sphere. */
typedef struct {
    V3    centre;
    float radius;
    Frame frame;                /* z of the shape is n; phi runs from s to t; orthonormal but may
                                 * be left-handed where the transform mirrors */
    float zmin, zmax, phimax;
    bool  whole;                /* nothing is cut off */
} Sphere;

typedef struct {
    V3    centre;
    Frame frame;                /* n is the disc's normal */
    float radius, inner, phimax;
} Disk;

struct Accel;
typedef struct {
    const struct Accel *accel;  /* borrowed: over the geometry that is instanced */
    uint32_t child;             /* which geometry of the scene that is */
    Affine to_world, to_object; /* of one that moves: at time 0 */
    Motion *motion;             /* owned; NULL: it stands still */
    Box bounds;                 /* around it at all times; set when accel is */
} Instance;

#define NO_LIGHT UINT32_MAX
#define NO_MEDIUM UINT32_MAX    /* nothing that would absorb or scatter */

typedef struct {
    ShapeKind kind;
    uint32_t  first, count;     /* its primitives */
    uint32_t  material;         /* index into the scene's materials */
    uint32_t  light;            /* index into the scene's lights, or NO_LIGHT */
    bool      flip;             /* the geometric normal is turned round (ReverseOrientation) */
    bool      plain;            /* nothing looks at uv and its derivatives: surfaces leave them 0 */
    bool      separates;        /* it is the border of media: */
    uint32_t  inside, outside;  /* in the scene's media, or NO_MEDIUM; ng points outside */
    uint32_t  first_vertex;     /* meshes: n and uv start there */
    uint32_t *place;            /* owned; of lamps whose triangles were put into another order:
                                 * where each is now, from `first`; else NULL */
    V3       *n;                /* owned; per vertex, unit or 0; NULL: none */
    V2       *uv;               /* owned; NULL: none */
    union {
        Sphere sphere;
        Disk disk;
        Tessellation *tessellation;     /* owned */
        Instance *instance;             /* owned: larger than the others */
    } as;
} Shape;

typedef struct {
    V3       *p;                /* owned */
    Tri      *tri;              /* owned */
    Shape    *shapes;           /* owned */
    uint32_t *odd;              /* owned; shape of primitive ntris + k */
    uint32_t *firsts;           /* owned; first triangle of each mesh shape, for searching */
    uint32_t *mesh_shapes;      /* owned; the shape that firsts[k] belongs to */
    uint32_t *tessellated;      /* owned; the shapes that are tessellations, in order */
    size_t nverts, ntris, nshapes, nodd, nmeshes, ntessellated;
    size_t nfaces;              /* triangles of all tessellations */
    size_t cap_p, cap_tri, cap_shapes, cap_odd, cap_tessellated;
} Geometry;

/* What all shapes have in common when they are added. */
typedef struct { uint32_t material, light; bool flip; } ShapeTraits;

void geometry_clear(Geometry *g);
/* Makes *to, which need not be set, a copy that shares nothing with *from but the structures of its
 * instances. False: memory, reported, *to empty. */
bool geometry_copy(Geometry *to, const Geometry *from);

/* Each adds one shape and gives its index in *shape (may be NULL). False: memory or the counts of
 * 32 bits ran out, reported. The mesh is emptied: its arrays are taken over or copied; so is the
 * tessellation. Points must be in the geometry's space already. */
bool geometry_add_mesh(Geometry *g, Mesh *m, ShapeTraits traits, uint32_t *shape);
bool geometry_add_sphere(Geometry *g, const Sphere *s, ShapeTraits traits, uint32_t *shape);
bool geometry_add_disk(Geometry *g, const Disk *d, ShapeTraits traits, uint32_t *shape);
bool geometry_add_tessellation(Geometry *g, Tessellation *t, ShapeTraits traits, uint32_t *shape);
bool geometry_add_instance(Geometry *g, uint32_t child, const Transform *to_world, uint32_t *shape);
bool geometry_add_moving(Geometry *g, uint32_t child, const Motion *motion, uint32_t *shape);
/* Ends adding: makes the tables that geometry_shape and accelerators need. */
bool geometry_finish(Geometry *g);

/* Puts the triangles of a mesh into another order: the new k-th is the order[k]-th. Its vertices
 * follow, by first use: what is near is near in memory. Lamps remember the old order, so that
 * pictures stay the same. False: memory ran out, nothing changed. */
bool geometry_arrange(Geometry *g, size_t shape, const uint32_t *order);

/* Tessellations become meshes: their triangles, of the same numbers in turn, stand in a list, and
 * follow those of all meshes. For comparing; how things are shaded is lost. False: memory or the
 * counts ran out, reported, and *g is good for geometry_clear only. */
bool geometry_list(Geometry *g);

INLINE uint32_t geometry_prims(const Geometry *g) { return (uint32_t)(g->ntris + g->nodd); }
Box geometry_box(const Geometry *g, uint32_t prim);             /* conservative bounds */
/* The shape of a primitive or face. */
const Shape *geometry_shape(const Geometry *g, uint32_t prim);
INLINE bool geometry_is_tri(const Geometry *g, uint32_t prim) { return prim < g->ntris; }
INLINE void geometry_corners(const Geometry *g, uint32_t prim, V3 c[3])
{
    const Tri *t = &g->tri[prim];
    c[0] = g->p[t->v[0]];
    c[1] = g->p[t->v[1]];
    c[2] = g->p[t->v[2]];
}

/* The maps of an instance at a time. */
INLINE void instance_at(const Instance *in, float time, Affine *to_world, Affine *to_object)
{
    if (UNLIKELY(in->motion != NULL))
        motion_at(in->motion, time, to_world, to_object);
    else {
        *to_world = in->to_world;
        *to_object = in->to_object;
    }
}

/* Around an instance at all times, of what its object is bounded by. */
Box instance_box(const Instance *in, Box object);

/* What shading needs to know of a hit. */
typedef struct {
    V3 p, err;                  /* the point, and a bound of the error of each coordinate */
    V3 ng;                      /* geometric normal, unit: the front, whence area lights shine */
    V3 ns;                      /* shading normal, unit, on the side of ng */
    V2 uv;
    V3 dpdu, dpdv;              /* how p moves with u and v; 0 where that is not known */
    float width;                /* of the beam that is followed, here; 0: a ray. From geometry: 0 */
    const Shape *shape;         /* borrowed */
    uint32_t prim;              /* or face; within the shape's geometry */
    float time;                 /* of the ray that met it: rays that leave it have the same */
} Surface;

/* The corners of a triangle of a mesh or a tessellation. */
void geometry_face(const Geometry *g, uint32_t prim, V3 c[3]);

/* Its point with weights u, v of its second and third corner, and the bound of its error. */
void geometry_point(const Geometry *g, uint32_t prim, float u, float v, V3 *p, V3 *err);

/* Its unit normal, by the order of its corners. */
V3 geometry_normal(const Geometry *g, uint32_t prim);

/* Surface of a hit on primitive or face h->prim of g (not an instance), for a ray in the space of
 * g. */
void geometry_surface(const Geometry *g, const Ray *r, const Hit *h, Surface *s);

/* ---- one primitive against one ray ---- */

/* t of the first crossing with t > 0; 0: none. In double, rounded once. */
float sphere_cross(const Sphere *s, const Ray *r);
float disk_cross(const Disk *d, const Ray *r);
Box  sphere_box(const Sphere *s);
Box  disk_box(const Disk *d);

/* Makes a sphere or disc of the scene language out of its parameters, if the transform keeps it
 * one (rotation, translation, one scale, mirror). False otherwise: use an instance instead. */
bool sphere_init(Sphere *s, const Transform *t, float radius, float zmin, float zmax,
                 float phimax_degrees);
bool disk_init(Disk *d, const Transform *t, float height, float radius, float inner,
               float phimax_degrees);

#endif
