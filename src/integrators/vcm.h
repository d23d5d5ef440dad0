/* vcm.h -- passes of light paths, whose vertices eye paths are merged with: what vcm and bpm share.
 *
 * Source      [GIRT 3, 4.2, 5.4, 5.5, alg. 5, (3.6), (3.8); errata 4.5 to 4.10], [Georgiev12].
 * Pass        1. light paths are traced, shown to the lens and kept (lightstore.h); 2. their
 *             vertices are sorted into a grid; 3. each camera sample has a path from the eye, which
 *             is connected to its own light path and merged with all.
 * Radius      r_i = r_1 i^((alpha-1)/2) in pass i = 1, 2, ...  (3.8): the variance that mergers
 *             leave in the mean falls as N^-alpha, their squared bias as N^(2 alpha - 2).
 * Radii       Weights are linear in eta (odds.h), so one set of paths makes pictures by several
 *             radii [GIRT 5.5]: the largest is searched, the others take what is near enough.
 * Bias        Only mergers blur, and their weight is the less the smaller the radius.
 * Crops       have as many light paths as the whole picture has: mergers look the same.
 * Time        A pass has one moment, at which all of its rays are. */
#ifndef INTEGRATORS_VCM_H
#define INTEGRATORS_VCM_H

#include "integrators/lightstore.h"

typedef struct {
    Integrator base;
    Bidirectional both;         /* owned */
    LightStore store;           /* owned */
    bool  merges;
    float radius, alpha;        /* of the first pass; how it shrinks */
    int   radii;
    uint32_t multiple;          /* light paths, for each pixel */
    uint32_t full_w;            /* the whole picture's */
} Vcm;

/* By the options below. NULL: reported. */
Integrator *vcm_open(const char *name, const Scene *s, const Opts *o);
void     vcm_close(Integrator *base);
bool     vcm_prepare(Integrator *base, const Film *f, uint64_t seed);
uint32_t vcm_moment(const Integrator *base, uint32_t pass);
uint64_t vcm_units(Integrator *base, const Film *f, uint32_t pass, int phase);
void     vcm_run(Integrator *base, Film *f, uint32_t pass, int phase, uint64_t unit, Tracer *t);
Rgb      vcm_radiance(const Integrator *base, const Ray *r, Tracer *t);

#define VCM_OPTIONS                                                            \
    BIDIRECTIONAL_OPTIONS(1),                                                  \
    { .key = "radius", .type = OPT_FLOAT, .num = 0, .lo = 0, .hi = 1e30,       \
      .help = "of mergers in the first pass; 0: by share" },                   \
    { .key = "share", .type = OPT_FLOAT, .num = 0.005, .lo = 1e-7, .hi = 1,    \
      .help = "the same as a share of the scene's radius" },                   \
    { .key = "radii", .type = OPT_INT, .num = 1, .lo = 1, .hi = TALLY_RADII,   \
      .help = "pictures by as many radii, each half of the one before, from the same paths: " \
              "--aov radius:K" },                                              \
    { .key = "alpha", .type = OPT_FLOAT, .num = 2.0 / 3, .lo = 0.01, .hi = 1,  \
      .help = "the radius falls by (alpha-1)/2 powers of the pass; 1: it stays" }, \
    { .key = "paths", .type = OPT_INT, .num = 1, .lo = 1, .hi = 64,            \
      .help = "light paths of a pass, for each pixel" },                       \
    { .key = "first", .type = OPT_BOOL, .num = 1,                              \
      .help = "mergers where the eye's paths first meet a surface, too" }

#endif
