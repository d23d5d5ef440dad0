/* recordcache.h -- what irradiancecache and radiancecache share: pictures whose indirect light is
 * worked out at few places and interpolated between them.
 *
 * Source      [Cline07 7.5, errata 7.15], [Ward88], [WardHeckbert92], [Krivanek05].
 * Idea        Light that comes straight from lamps, or by mirrors and glass, is found at each
 *             point as ever; light that surfaces scattered before changes slowly from place to
 *             place, so it is worked out well at few places and interpolated between them.
 * Record      light without what lamps bring themselves: a ray in each cell of the hemisphere,
 *             and along it the estimate of a path with direct light at each vertex.
 * Matt        What a model draws from its matt part (BSDF_MATT) brings E / pi in place of the
 *             radiance of its direction.
 * Glossy      With bands > 0, any other event that is no delta, and whose direction has a density
 *             of at most `sharpest`, brings what records of radiance say of that direction. All
 *             else is followed as by `path`, and what is found there uses the records again.
 * Overture    Before the first sample, sets of pixels on ever finer grids are looked at: where
 *             records lack, new ones are made, side by side, and taken in by the order of pixels.
 *             All pixels then interpolate between the same records, and a little wider, so none of
 *             them leaves an edge.
 * Elsewhere   Where a sample meets a place that no record knows (behind a lobe, past an edge) the
 *             path goes on by one direction, as `path` does: noisy, not wrong, nothing is stored.
 * Photons     With photons > 0, what arrives where a ray of a record ends is looked up in a photon
 *             map, unless that is blurred from as far as the ray is long; with caustics > 0, light
 *             by mirrors and glass alone is looked up where the eye sees it.
 * Misses      The detail of caustics (unless they have photons) and of whatever is smaller than the
 *             distance of records.
 *             Paths that reach a record by d deltas may have d events more than maxdepth.
 * Motion      A record is made at one moment, and serves all. */
#ifndef INTEGRATORS_RECORDCACHE_H
#define INTEGRATORS_RECORDCACHE_H

#include "integrators/beam.h"
#include "integrators/irradiance.h"
#include "integrators/lighting.h"
#include "integrators/photonmaps.h"
#include "integrators/radiance.h"

typedef struct RecordCache RecordCache;

/* An event about to ask: where, on the side from which its light comes. */
typedef struct { V3 p, n; float width; } Spot;
typedef enum { ASKS_NOTHING, ASKS_MATT, ASKS_GLOSSY } Asks;

/* The irradiance that records tell of for a matt event at the beam's end. False: none knows. */
typedef bool AskMatt(const RecordCache *it, const Beam *b, const Vertex *v, const Spot *at,
                     Tracer *t, Rgb *E);

struct RecordCache {
    Integrator base;
    Lighting lighting;          /* owned */
    PhotonMaps maps;            /* owned */
    AskMatt *ask;
    int   maxdepth, roulette, rays;
    float a, overlap;           /* accuracy of records, and times that when pixels ask */
    float least, most;          /* spacing of records in pixels */
    bool  gradients, overture;
    int   bands;                /* 0: glossy events are followed */
    float sharpest;
    /* the picture */
    uint32_t x0, y0, w, h;
    float pixel;                /* width of one where the beam's is not known */
    IrradianceStore matt;       /* owned */
    RadianceStore glossy;       /* owned */
    uint8_t *wanted;            /* owned: Asks of pixels at which records lack */
    uint64_t *places;           /* owned: those pixels by number, matt ones first, */
    size_t n, nmatt, cap_places;
    IrradianceRecord *made;     /* and their records; all owned */
    Reach *reaches;
    Radiance *shine;
    size_t cap_made, cap_reaches, cap_shine;
};

/* Of a zeroed *it: all but what depends on the picture. False: reported, not cleared. */
bool recordcache_open(RecordCache *it, const char *name, const Scene *s, const Opts *o);
void recordcache_clear(RecordCache *it);

/* Of the kind: prepare, radiance, phases, units, run. */
enum { RECORDCACHE_SETS = 13, RECORDCACHE_PHASES = PHOTONMAPS_STAGES + 2 * RECORDCACHE_SETS + 1 };
bool recordcache_prepare(Integrator *it, const Film *f, uint64_t seed);
Rgb  recordcache_radiance(const Integrator *it, const Ray *r, Tracer *t);
uint64_t recordcache_units(Integrator *it, const Film *f, uint32_t pass, int phase);
void recordcache_run(Integrator *it, Film *f, uint32_t pass, int phase, uint64_t unit, Tracer *t);

/* The record at a vertex that a beam has come to. Its numbers follow from the pixel and `number`,
 * its count there; paths keep no tally. */
IrradianceRecord recordcache_make(const RecordCache *it, const Vertex *v, const Spot *at,
                                  uint32_t medium, uint32_t number, Tracer *t);

#define RECORDCACHE_OPTIONS                                                    \
    { .key = "accuracy", .type = OPT_FLOAT, .num = 0.2, .lo = 0.01, .hi = 1,   \
      .help = "error at which a record ends, by Ward's estimate: less of it, more records" }, \
    { .key = "rays", .type = OPT_INT, .num = 512, .lo = 1, .hi = HEMISPHERE_RAYS_MOST, \
      .help = "about so many for each record" },                               \
    { .key = "gradients", .type = OPT_BOOL, .num = 1,                          \
      .help = "records say how the light changes when one turns or moves" },   \
    { .key = "overlap", .type = OPT_FLOAT, .num = 1.5, .lo = 1, .hi = 4,       \
      .help = "pixels use records so much further than where the overture wants a new one" }, \
    { .key = "minspacing", .type = OPT_FLOAT, .num = 6, .lo = 0.01, .hi = 1e6, \
      .help = "least reach of a record, pixels" },                             \
    { .key = "maxspacing", .type = OPT_FLOAT, .num = 64, .lo = 0.01, .hi = 1e6, \
      .help = "most reach of a record, pixels" },                              \
    { .key = "maxdepth", .type = OPT_INT, .num = 9, .lo = 0, .hi = 100000,     \
      .help = "most scattering events of a path; 0 shows lights only, 1 uses no records" }, \
    ROULETTE_OPTION(4),                                                        \
    PHOTONMAPS_OPTIONS(0, 0, "rays of records are paths"),                     \
    LIGHTING_HEURISTIC,                                                        \
    LIGHTING_SKY,                                                              \
    LIGHTING_LIGHTSAMPLER

#endif
