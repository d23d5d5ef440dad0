/* ray_help.h -- what the suites of rays share: every accelerator in every setting, a zoo of meshes,
 * and rays of every awkward class. */
#ifndef TEST_RAY_HELP_H
#define TEST_RAY_HELP_H

#include "accel/accel.h"
#include "base/random.h"
#include "geometry/generate.h"
#include "test/test.h"

/* ---- vectors in double, for what must be right ---- */

typedef struct { double x, y, z; } D3;
INLINE D3 d3(V3 v) { return (D3){ v.x, v.y, v.z }; }
INLINE D3 d3_sub(D3 a, D3 b) { return (D3){ a.x - b.x, a.y - b.y, a.z - b.z }; }
INLINE double d3_dot(D3 a, D3 b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
INLINE D3 d3_cross(D3 a, D3 b)
{
    return (D3){ a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x };
}
/* |a| . b: how far errors b of the coordinates reach along a. */
INLINE double d3_reach(D3 a, D3 b) { return fabs(a.x) * b.x + fabs(a.y) * b.y + fabs(a.z) * b.z; }

/* Where a unit shape is put: the size it gets, and its place. */
typedef struct { double scale; V3 offset; } Where;
enum { PLACES_SANE = 7 };
extern const Where places_sane[PLACES_SANE];    /* all leave a shape two digits or more */

/* ---- accelerators ---- */

typedef struct {
    const AccelKind *kind;
    Opts opts;
    char name[100];             /* as on the command line */
} Setting;

/* All accelerators but `brute`, each with every combination of its words and switches and of the
 * least, the usual and a large value of its whole numbers. Ends at kind NULL. */
const Setting *settings_all(void);
/* The same, each accelerator once as it comes, and after them `brute`. */
const Setting *settings_usual(void);
const Setting *setting_brute(void);

Accel *setting_build(const Setting *s, const Geometry *g);      /* never NULL; may end the case */
Accel *setting_arrange(const Setting *s, Geometry *g);          /* the same by accel_build */
/* Is it of complete trees (accel/forest.h)? */
bool setting_is_forest(const Setting *s);
/* What a query of a flat world may test at most. */
uint64_t prims_most(const Accel *a);

/* ---- meshes ---- */

typedef struct { const char *name; void (*make)(Mesh *m); } ZooMesh;
extern const ZooMesh zoo_tame[];        /* a few hundred triangles each; both end at name NULL */
extern const ZooMesh zoo_wild[];        /* degenerate in one way or another */

void mesh_of(Mesh *m, uint32_t nverts, uint32_t ntris);         /* room, all 0 */
/* p becomes scale p + offset, in double and rounded once. */
void mesh_place(Mesh *m, double scale, V3 offset);
/* A finished geometry of this mesh alone, which is emptied. */
void geometry_of(Geometry *g, Mesh *m);

/* ---- rays ---- */

typedef enum {
    RAY_RANDOM,                 /* from around the box to a point in it */
    RAY_INSIDE,                 /* from a point in the box, any direction */
    RAY_AXIS,                   /* along an axis, the other components 0 or -0 */
    RAY_PLANE,                  /* one component 0 or -0; origins on planes of vertices */
    RAY_TINY,                   /* components between 0 and 1, denormal ones among them */
    RAY_ON_VERTEX,              /* the origin is a vertex; half of them run to another vertex */
    RAY_ON_FACE,                /* the origin is a point of an edge or face, rounded */
    RAY_TO_VERTEX, RAY_TO_EDGE, RAY_TO_CENTRE,
    RAY_GRAZING,                /* within the plane of a triangle, or along an edge */
    RAY_SHORT,                  /* tmax a step around the distance of a hit */
    RAY_LENGTH,                 /* directions of length 2^-60 .. 2^60 */
    RAY_EXTREME,                /* directions of length 2^-130 .. 2^126 */
    RAY_NEIGHBOUR,              /* near the one before it, but for every 32nd; of many kinds */
    RAY_CLASSES
} RayClass;
extern const char *const ray_class_names[RAY_CLASSES];

typedef struct {
    const Geometry *g;          /* borrowed */
    const Accel *truth;         /* borrowed; for RAY_SHORT */
    Box box;
    Rng rng;
    Rng times;
    float time;                 /* of the ray that is made, which is aimed at things where they are
                                 * then */
    Ray first;                  /* of the neighbours */
    int neighbours;             /* still to come */
} RayMaker;

RayMaker ray_maker(const Geometry *g, const Accel *truth, uint64_t seed);
Ray ray_make(RayMaker *m, RayClass c);

float rng_between(Rng *r, float lo, float hi);
V3    rng_direction(Rng *r);                    /* uniform, unit to rounding */
V3    rng_in_box(Rng *r, Box b);
V3    rng_barycentric(Rng *r);                  /* uniform over a triangle */
/* a weights.x + b weights.y + c weights.z, rounded once. */
V3    blend(V3 a, V3 b, V3 c, V3 weights);
float float_after(float x);                     /* the next larger float; x finite */
float float_before(float x);

/* "o (x y z) d (x y z) tmax time" with all digits, for messages. In one of four static buffers. */
const char *ray_text(const Ray *r);

#endif
