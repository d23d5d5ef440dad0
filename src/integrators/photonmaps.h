/* photonmaps.h -- the photon maps of a picture: one of all photons or of indirect light, one of
 * caustics, and irradiance ready where gathering rays end.
 *
 * Source      [Cline07 7.7], [GIRT 2.3.2]. What a map holds and tells: photonstore.h.
 * Caustics    light that comes by mirrors and glass alone has a map of its own, with photons where
 *             it is bright. Whoever asks that map must not find the same light by following deltas
 *             from there to lamps. */
#ifndef INTEGRATORS_PHOTONMAPS_H
#define INTEGRATORS_PHOTONMAPS_H

#include "integrators/photonstore.h"

typedef struct {
    LightSampler *lights;       /* owned: by power */
    PhotonStore photons, caustics;      /* owned */
    PhotonRecords records;      /* owned: of photons */
    PhotonLook look, look_caustics;
    bool gather;                /* photons are of all light, and have records */
    uint64_t first;             /* units of a phase that are of photons; then caustics' */
} PhotonMaps;

/* By the options below. maxdepth: of the paths of light and eye together, of which the eye's are
 * two events with `gather`, else one. False: reported, not cleared. */
bool photonmaps_open(PhotonMaps *m, const Scene *s, const Opts *o, int maxdepth, int roulette,
                     bool gather);
void photonmaps_clear(PhotonMaps *m);                   /* {0} is cleared */

enum { PHOTONMAPS_STAGES = PHOTONSTORE_STAGES + PHOTONRECORDS_STAGES };
uint64_t photonmaps_units(PhotonMaps *m, int stage, bool *failed);
void     photonmaps_run(PhotonMaps *m, int stage, uint64_t unit, Tracer *t);

/* Radiance towards the viewer, by the photons at the vertex. *r2: squared radius of the disc. */
Rgb photonmaps_radiance(const PhotonMaps *m, const Vertex *v);
Rgb photonmaps_caustics(const PhotonMaps *m, const Vertex *v);
Rgb photonmaps_gathered(const PhotonMaps *m, const Vertex *v, float *r2);       /* quickly */

#define PHOTONMAPS_OPTIONS(photons_usual, caustics_usual, without)            \
    { .key = "photons", .type = OPT_INT, .num = photons_usual, .lo = 0, .hi = 1e8, \
      .help = "photons to be kept, more or less, at 21 bytes; 0: " without }, \
    { .key = "caustics", .type = OPT_INT, .num = caustics_usual, .lo = 0, .hi = 1e8, \
      .help = "photons of the map of light that comes by mirrors and glass alone; 0: none such" }, \
    { .key = "neighbours", .type = OPT_INT, .num = 64, .lo = 2, .hi = PHOTONS_NEAREST_MOST, \
      .help = "photons of an estimate: more are smoother, and more blurred", .also = "k" }, \
    { .key = "radius", .type = OPT_FLOAT, .num = 0, .lo = 0, .hi = 1e30,       \
      .help = "of an estimate, at most, in scene units; 0: 0.1 of the scene's radius" }, \
    { .key = "causticradius", .type = OPT_FLOAT, .num = 0, .lo = 0, .hi = 1e30, \
      .help = "the same in the map of caustics; 0: 0.2 of the other one" },    \
    { .key = "kernel", .type = OPT_CHOICE, .str = "epanechnikov",              \
      .choices = "constant cone epanechnikov",                                 \
      .help = "weight of photons by their distance" }

#endif
