/* bidirectional.h -- a path from a lamp, a path from the eye, and all ways of joining them: what
 * bdpt, bpm and vcm share.
 *
 * Source      [Cline07 7.9, fig. 7.18], [GIRT 2.2.3, (2.59) to (2.65), 2.3.5, 3, alg. 5; errata 4,
 *             7.9], [Veach97 10], [Georgiev12].
 * Ways        The eye's path meets a lamp (implicit), asks one (explicit: its own choice, not the
 *             point where the light path began), is connected to each vertex of a light path, or
 *             merged with vertices of all of them; each vertex of a light path is shown to the
 *             lens. What each way brings is weighed by odds.h. Lamps in plain view are met only.
 * Connection  between a vertex y of flux F, n paths, and one z of throughput T:
 *                 T f(z) |cos z| F f*(y) |cos y| / |y - z|^2
 * Merger      T f(z) F |cos ns| / |cos ng| / (pi r^2 n), with f at the eye's vertex (errata 4.5).
 * Density     of asking a lamp may depend on who asks (by solid angle, by contribution): so it is
 *             taken at the second vertex of a light path, when that is known.
 * Lens        What light paths show to it falls into pixels by chance alone; the eye's paths are
 *             spread evenly in each. So one of the former counts as a third of the latter in
 *             weights: on the wall of scenes/s5 that left 0.74 of relMSE, and a tenth 0.88.
 * Straight    Light that comes straight from lamps is not merged if it can be asked for: that has
 *             less noise than its density says, as it is spread evenly, too.
 * Visibility  is what connections cost. Those that bring little are tried by chance only
 *             ([Cline07 7.9.2]).
 * Splitting   What lies between mirrors or panes on both sides is joined with nothing but what is
 *             beyond them: the eye's path alone finds the light there, rarely, and bright. So the
 *             first smooth vertex that the eye sees by way of deltas sends several rays. Those that
 *             meet a delta next all go on, and count by their number; of what meets anything else
 *             only the first ray's counts, whole. Each kind keeps its mean, so weights need not
 *             know ([Arvo90]).
 * Media       take light away; what they scatter is left out, with a warning.
 * Files       bidirectional_light.c has the light's half, bidirectional.c the eye's, ends.h what
 *             both must agree on. */
#ifndef INTEGRATORS_BIDIRECTIONAL_H
#define INTEGRATORS_BIDIRECTIONAL_H

#include "integrators/beam.h"
#include "integrators/lighting.h"
#include "integrators/odds.h"
#include "integrators/particle.h"

enum { DEPTH_MOST = 255 };              /* most scattering events of a path */

/* Of a light path, where it may be joined. */
typedef struct {
    Vertex   v;
    Rgb      flux;
    Odds     odds;
    V3       d;                 /* unit, the way the light came */
    Hit      hit;               /* the same point, for those who keep it */
    uint32_t medium;            /* it came through */
    int      edges;             /* from the lamp */
} LightVertex;

typedef struct LightStore LightStore;

/* Which techniques there are. Those of one kind alone have weight 1. */
typedef enum {
    JOINS_ALL,                  /* as Techniques says */
    JOINS_FIRST_MERGER,         /* where the eye's path first meets no delta: photon maps */
    JOINS_LENS                  /* light tracing */
} Joins;

typedef struct {
    const Scene *scene;         /* borrowed */
    LightSampler *asked;        /* owned: which lamp is asked */
    LightSampler *sending;      /* owned: which one sends a path, by power */
    Techniques techniques;
    Joins joins;
    int   maxdepth, roulette, split;
    bool  beside;               /* lamps are asked beside directions by the surface, light_sample */
    float shown;                /* light paths for each of the eye's, as weights count them: fewer
                                 * than there are, see Lens */
    float little;               /* part of what is found: see the option */
    const LightStore *store;    /* borrowed: what is merged with, if eta > 0 */
    int   radii;                /* pictures by as many radii, the first of them the picture's: */
    struct { float radius, eta; } by[TALLY_RADII];
} Bidirectional;

/* Of a zeroed *b, by the options below. False: reported, not cleared. */
bool bidirectional_open(Bidirectional *b, const char *name, const Scene *s, const Opts *o);
void bidirectional_clear(Bidirectional *b);

/* A path from a lamp, by the tracer's sampler: its vertices are shown to the lens, and written down
 * where they are no deltas. Returns how many: at most maxdepth. */
int  bidirectional_light(const Bidirectional *b, float time, LightVertex *path, Tracer *t);

/* What comes along a camera sample's ray, by a path from the eye joined with that one. */
Rgb  bidirectional_look(const Bidirectional *b, const Ray *r, const LightVertex *path, int n,
                        Tracer *t);

/* split: see above; what pays where nothing is merged. */
#define BIDIRECTIONAL_OPTIONS(parts)                                           \
    { .key = "maxdepth", .type = OPT_INT, .num = 9, .lo = 0, .hi = DEPTH_MOST, \
      .help = "most scattering events of a path; 0 shows lights only" },       \
    { .key = "roulette", .type = OPT_INT, .num = 1, .lo = 1, .hi = 100000, .also = "rrdepth", \
      .help = "scattering event of each of the two paths after which it may end by chance" }, \
    { .key = "weights", .type = OPT_CHOICE, .str = "balance",                  \
      .choices = "balance power uniform",                                      \
      .help = "of the ways in which a path can be made; uniform: all alike, which is noisier" }, \
    { .key = "little", .type = OPT_FLOAT, .num = 0.03, .lo = 0, .hi = 1,     \
      .help = "connections that bring less than this part of what the sample has found are tried " \
              "by chance; 0: all are tried" },                                 \
    { .key = "split", .type = OPT_INT, .num = parts, .lo = 1, .hi = 256,          \
      .help = "rays from the first vertex seen by way of mirrors or panes; those that meet " \
              "others go on" },                                                \
    LIGHTING_LIGHTSAMPLER

#endif
