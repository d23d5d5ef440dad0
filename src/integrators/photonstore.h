/* photonstore.h -- photons that are kept where they come upon surfaces, and the light that they
 * tell of.
 *
 * Source      [Cline07 7.7.1, 7.7.2, figs 7.12, 7.13; errata 7.7, 7.8], [GIRT 2.3.2].
 * Photon      20 bytes, and less than 1.3 in the tree: place, flux with one exponent for all bands,
 *             rounded up or down by chance so that its mean is right [Ward91b]; whence it came to
 *             0.2 degrees, and the surface's normal there to 4. Its flux is what the lamp's whole
 *             power would be if all its paths were this one; the 1 / paths stands outside.
 * Shading     A photon counts times |wi.ns| / |wi.ng|: what light does at a surface with shading
 *             normals goes by the cosine to these, how many photons meet it by the true one.
 * Kept        Decided by which light the store is to hold. What is kept follows from the numbers of
 *             the paths alone: some are tried, which say how many are needed for so many photons,
 *             and how many are needed does not depend on what they bring, so nothing is biased.
 * Estimate    Sum of f flux kernel(d / r) / (pi r^2) over photons nearer than r: the k-th nearest
 *             photon is at r and does not count, which is what the factor (k - 1) / k does in the
 *             mean; or r is the cap, and fewer than k are within, which all count.
 * Bias        For a density with second derivatives: its Laplacian times mean(d^2) / 4, where d^2
 *             by the kernel is on average r^2 / 2, 3 r^2 / 10 or r^2 / 3; so with the same k it
 *             falls as 1 / photons, with the same r not at all. At edges as r itself.
 * Time        Photons of all times are in one store: what moves is lit by where it was. */
#ifndef INTEGRATORS_PHOTONSTORE_H
#define INTEGRATORS_PHOTONSTORE_H

#include "geometry/pointtree.h"
#include "integrators/particle.h"

typedef struct { float p[3]; uint32_t flux, ways; } Photon;

/* ---- packing ---- */

/* wi: back along its way; n: of the surface, unit both. */
Photon photon_of(V3 p, Rgb flux, V3 wi, V3 n);
INLINE V3 photon_place(const Photon *p) { return v3(p->p[0], p->p[1], p->p[2]); }
Rgb photon_flux(const Photon *p);
V3  photon_wi(const Photon *p);
V3  photon_normal(const Photon *p);

/* ---- stores ---- */

typedef enum {
    PHOTONS_ALL,                /* of all light */
    PHOTONS_INDIRECT,           /* not straight from lamps */
    PHOTONS_ROUGH,              /* nor by delta events alone */
    PHOTONS_CAUSTIC             /* by delta events alone, at least one */
} PhotonLight;

typedef struct { Photon *photons; size_t n, room; } PhotonBatch;

typedef struct {
    const LightSampler *lights; /* borrowed */
    PhotonLight light;
    uint32_t wanted;            /* photons, more or less */
    int   maxdepth, roulette;   /* most scattering events before a photon is kept */
    uint64_t paths;             /* in all */
    PhotonBatch *batches;       /* owned: one a unit of paths */
    uint64_t nbatches;
    uint64_t *before;           /* owned: photons of the batches before each */
    Photon *photons;            /* owned: in the tree's order */
    uint32_t n;
    PointTree tree;             /* owned */
    bool     failed;            /* memory ran out, which is reported */
} PhotonStore;

/* An empty store, which is filled by its stages: the units of a stage in any order, after all of
 * the stage before. Where memory runs out, that is reported, and the store says that it failed, or
 * a unit's tracer does. */
void photonstore_init(PhotonStore *s, const LightSampler *by, PhotonLight light,
                      uint32_t wanted, int maxdepth, int roulette);
void photonstore_clear(PhotonStore *s);
enum { PHOTONSTORE_STAGES = 5 };
uint64_t photonstore_units(PhotonStore *s, int stage);
void     photonstore_run(PhotonStore *s, int stage, uint64_t unit, Tracer *t);
size_t   photonstore_bytes(const PhotonStore *s);       /* when it is filled */

/* ---- estimates ---- */

typedef enum { KERNEL_CONSTANT, KERNEL_CONE, KERNEL_EPANECHNIKOV } Kernel;
enum { PHOTONS_NEAREST_MOST = 1024 };

typedef struct {
    Kernel kernel;
    uint32_t k;                 /* neighbours, 2 .. PHOTONS_NEAREST_MOST */
    float  radius2;             /* squared cap of the radius */
} PhotonLook;

/* Radiance towards the viewer of the light that the store's photons tell of; *r2: squared radius of
 * the disc (NULL: not wanted). */
Rgb photonstore_radiance(const PhotonStore *s, const PhotonLook *look, const Vertex *v,
                         float *r2);

/* Irradiance of matt surfaces, estimated beforehand for final gather [Christensen99]: where one
 * photon in RECORD_STEP is, chosen by chance, from all others, so that neither the photon itself
 * nor the room around it can make the estimate brighter or darker. Records are as photons are, but
 * with irradiance as flux, and with the radius of the estimate in the place of where light comes
 * from. */
typedef struct {
    Photon *records;            /* owned: in the tree's order */
    uint32_t n;
    PointTree tree;             /* owned */
    bool     failed;            /* as a store's */
} PhotonRecords;

enum { PHOTONRECORDS_STAGES = 2, RECORD_STEP = 8 };
void photonrecords_clear(PhotonRecords *r);
uint64_t photonrecords_units(PhotonRecords *r, const PhotonStore *s, int stage);
void     photonrecords_run(PhotonRecords *r, const PhotonStore *s, const PhotonLook *look,
                           int stage, uint64_t unit);
/* The irradiance of the nearest one within the cap that looks about the way of n. *r2: the squared
 * radius of its estimate. False: there is none. */
bool photonrecords_irradiance(const PhotonRecords *r, const PhotonLook *look, V3 p, V3 n, Rgb *E,
                              float *r2);

#endif
