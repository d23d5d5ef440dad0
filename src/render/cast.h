/* cast.h -- acceleration structures measured: the same rays go through each of them over the same
 * scene, after all have been seen to give the same answers. The rays are made by rule, or come from
 * files that other programs read, too. */
#ifndef RENDER_CAST_H
#define RENDER_CAST_H

#include "scene/scene.h"

/* ---- rays ---- */

/* Rays that are cast together. {0} is the empty set. */
typedef struct {
    char   kind[17];            /* "primary", ...: printable */
    const char *file;           /* borrowed: whence they came; NULL: made by rule */
    bool   any;                 /* asks whether anything is hit, not for the nearest */
    Ray   *rays;                /* owned */
    float *tmin;                /* owned, of files: rays begin there, and what is t of a Ray counts
                                 * from there; NULL: 0 */
    size_t n;
    float *t;                   /* owned, set by cast_reference: t of the nearest hit (0 for any);
                                 * -1: none */
    uint64_t hits;              /* set by cast_reference */
    double sum_t;               /* of the nearest hits, from the origin; 0 for any */
    uint64_t file_hits;         /* what the file says of these two */
    double file_sum_t;
} RaySet;

void rayset_clear(RaySet *s);

/* Files of rays, as other measuring programs write them: char magic[4] "RAYS"; uint32 version (1);
 * char kind[16]; uint32 query (0 nearest, 1 any); uint32 0; uint64 count; uint64 hits; double
 * sum_t; then of each ray float ox oy oz dx dy dz tmin tmax. All in the byte order of the machine
 * that wrote it, which the version tells.
 *
 * A Ray begins at t = 0, so one with another tmin is cast from the point there, o + tmin d in
 * floats; a warning says so. False: reported (with what is wrong: a size that does not fit the
 * count, no number, no direction, tmin above tmax), *s empty. limit: bytes of a file. */
bool rayset_read(RaySet *s, const char *path, uint64_t limit);
/* With tmin 0, and with hits and sum_t. False: reported. */
bool rayset_write(const RaySet *s, const char *path);

enum { RAYS_PRIMARY, RAYS_BOUNCE, RAYS_SHADOW, RAYS_AO, RAYS_RANDOM, RAYS_KINDS };
extern const char *const rays_names[RAYS_KINDS];

/* What the rules leave open. */
typedef struct {
    uint32_t w, h;              /* of the picture of primary rays; as many random ones */
    bool     camera_given, light_given;
    V3       eye, target;       /* if camera_given; else all is framed, seen from the front, from
                                 * above, from the right, with y upwards */
    float    fov;               /* degrees from top to bottom; if camera_given */
    V3       light;             /* if light_given; else above the viewer's right shoulder */
    float    ao;                /* length of ambient-occlusion rays, in diagonals of the box */
    uint64_t seed;
} RayRules;

/* Makes sets of all five kinds for the scene, whose structures must be built:
 *   primary   nearest, one a pixel through its centre, row by row
 *   bounce    nearest, one a primary hit, by the cosine about its normal on the viewer's side
 *   shadow    any, one a primary hit that faces the point light
 *   ao        any, one a primary hit, by the cosine, short
 *   random    nearest, from a sphere around all to points in the box
 * Origins are moved 1e-5 diagonals off the surface. Rays that floats cannot hold are left out.
 * False: memory, reported; all sets empty. */
bool rays_make(const Scene *s, const RayRules *rules, RaySet set[RAYS_KINDS]);

/* ---- structures ---- */

enum { CAST_SETS = 16, CAST_RUNS = 100 };       /* most ray sets, and runs, of one measurement */

typedef struct {
    const AccelKind *kind;
    Opts opts;
    const char *text;           /* borrowed: "lbvh:bits=8" */
    bool regular;               /* tessellations stay grids of points, under boxes of their own
                                 * (accel/regular.h); else their triangles stand in a list */
} CastConfig;

/* A scene whose geometry can be had again as it came. */
typedef struct {
    Scene *scene;               /* borrowed */
    const char *name;           /* borrowed: for messages */
    Geometry *original;         /* owned: a copy of each geometry as it came */
    Geometry *listed;           /* owned: the same with tessellations as lists of triangles; NULL:
                                 * there are no tessellations */
    uint64_t tris, prims, verts;        /* of all geometries, tessellations too; prims: also
                                         * spheres, instances, ... */
    size_t bytes;               /* of points, triangles and other primitives, in lists */
    size_t regular_bytes;       /* the same with tessellations as grids of points */
} CastScene;

bool cast_init(CastScene *c, Scene *s, const char *name);       /* false: memory, reported */
void cast_clear(CastScene *c);          /* the scene stays, with the structure built last */

/* Builds one structure over the geometry as it came. False: reported. */
bool cast_build(CastScene *c, const CastConfig *config, int threads);
/* The structure that others are compared with: the default one. */
CastConfig cast_default(void);

/* Casts all rays by the structure that is built, sets t, hits and sum_t, and asks brute about some
 * of them. False: reported (memory, or disagreement), and then *differs tells which. */
bool cast_reference(CastScene *c, RaySet *sets, int n, bool *differs);

typedef struct {
    int threads;                /* that "all threads" means */
    int runs;                   /* the median of so many after a warm-up; 0: no speed */
    size_t batch;               /* rays a call of the batched queries; 0: none is made */
} CastOrder;

typedef struct {
    double build_one, build_all;        /* seconds with one thread (CPU time), with all (wall) */
    uint64_t nodes;
    int    depth;
    size_t bytes, peak;         /* of the structure; most held by its build beside the scene */
    struct {
        double single, batch;   /* million rays a CPU-second, one or many a call; 0: not measured */
        double nodes, prims;    /* box and primitive tests a ray; 0 if there are no rays */
    } sets[CAST_SETS];
} CastRow;

/* Builds a structure, compares its answers to every ray with those of cast_reference, bit for bit,
 * and then measures. False: reported, as for cast_reference. */
bool cast_measure(CastScene *c, const CastConfig *config, const CastOrder *order,
                  const RaySet *sets, int n, CastRow *row, bool *differs);

#endif
