/* bothpaths.h -- paths by chance from both ends, each with all its vertices: what eyepaths.h is
 * from the eye alone.
 *
 * Source      [Cline07 7.9, 7.10, 7.12.1 "new path mutations"; errata 7.3, 7.10], [Veach97 10.2,
 *             11.4.2].
 * Ways        A path of n edges can be made in n ways: BY_EYE as eyepaths.h does it, and for each
 *             vertex j from 0, the lens, to n-2 by a path of the eye that ends there and one from a
 *             lamp that ends at vertex j+1, joined: that is way j+1.
 * Density     of way j+1, in the measure of the eye [Veach97 (8.9)]:
 *                 prod_{i<j} c_i  *  p_l prod_{i>j+1} c*_i  / J,
 *             c_i and c*_i being chances of what happens at vertex i by the eye and by the lamp,
 *             p_l the density of the lamp's point and direction, and J the change from what the
 *             lamp draws to directions as the eye has them, path_turn of all vertices from j+1
 *             on, path_ending, and 1 / d^2 of the edge that joins, or path_lens.
 * Traced      bothpath_traced follows one path from each end and joins them in all ways, weighed by
 *             the balance heuristic over all of them.
 * Single      bothpath_new makes one path of a given number of edges in a given way.
 * Chances     Of numbers of edges and ways, for single paths: half of them by the root of the mean
 *             square of what traced ones brought so, half evenly. Where colours over densities
 *             differ most, more are needed, or a chain stays for long at the largest of them.
 * Missing     A lamp that is a point, or shines in one direction, and is seen from the last smooth
 *             vertex by delta events alone, is found from the lamp only: so if the eye also sees
 *             that vertex by delta events alone, by no way. */
#ifndef INTEGRATORS_BOTHPATHS_H
#define INTEGRATORS_BOTHPATHS_H

#include "integrators/eyepaths.h"
#include "integrators/lighting.h"

typedef struct {
    EyePaths eye;
    LightSampler *asked;        /* owned: by paths of the eye */
    LightSampler *sending;      /* owned; NULL: only the eye makes paths */
    Integrator *direct;         /* owned: shows direct light; NULL: these paths do */
    int    least;               /* edges that are wanted */
} BothPaths;

/* For the integrator of that name, by the options below; from_lamps: whether paths begin there,
 * too. False: reported; to be closed all the same. */
bool bothpaths_open(BothPaths *it, const char *name, const Scene *s, const Opts *o,
                    bool from_lamps);
void bothpaths_close(BothPaths *it);

/* The luminance that a path brings to the mean of the picture: 0 if that is direct's to show, or
 * beyond what a film takes. */
double bothpath_brightness(const BothPaths *it, const LightPath *p, double scale, Places where);

/* Numbers by edges, and ways to make paths of so many. */
typedef struct {
    double of[LIGHTPATH_MOST + 1][LIGHTPATH_MOST];
    double all[LIGHTPATH_MOST + 1];     /* chances of all ways to make as many edges */
} ByWay;

/* Ways for paths of so many edges. */
INLINE int bothpath_ways(const BothPaths *it, int edges) { return it->sending ? edges : 1; }

/* As eyepath_traced; back: as many rooms, for the lamp's path, and room 0. where: places on the
 * picture that there are. */
void bothpath_traced(const BothPaths *it, LightPath *p, Vertex *const *rooms, Vertex *const *back,
                     Places where, Tracer *t, EyePathFound *found, void *ctx);

/* One path of p->edges edges, from p's pixel unless it is way 1. False: it comes to nothing. */
bool bothpath_new(const BothPaths *it, LightPath *p, int way, Vertex *const *rooms, Places where,
                  Tracer *t);
/* The densities with which each way makes it, once it is chosen: of BY_EYE that of bothpath_new,
 * or, whole, of eyepath_traced. */
void bothpath_densities(const BothPaths *it, const LightPath *p, bool whole, Places where,
                        double *density);

void byway_add(const BothPaths *it, ByWay *to, const ByWay *x);
/* Sums of squares become probabilities. */
void byway_becomes_chances(const BothPaths *it, ByWay *x);
void byway_save(const BothPaths *it, const ByWay *x, Saving *s);
void byway_load(const BothPaths *it, ByWay *x, Loading *l);

/* A path of some number of edges, made some way: both by u. */
bool bothpath_some(const BothPaths *it, const ByWay *chance, double u, LightPath *p,
                   Vertex *const *rooms, Places where, Tracer *t);
/* The density with which that makes it. */
double bothpath_density(const BothPaths *it, const ByWay *chance, const LightPath *p, Places where);

#define BOTHPATHS_DIRECT                                                       \
    { .key = "direct", .type = OPT_BOOL, .num = 1,                             \
      .help = "direct light is apart, as that of the integrator direct" }
/* samples: what bothpath_traced makes, as the method calls it. */
#define BOTHPATHS_OPTIONS(samples)                                             \
    { .key = "maxdepth", .type = OPT_INT, .num = 9, .lo = 0, .hi = LIGHTPATH_MOST - 2, \
      .help = "most scattering events of a path; 0 shows lights only" },       \
    { .key = "roulette", .type = OPT_INT, .num = 4, .lo = 1, .hi = 100000, .also = "rrdepth", \
      .help = "first scattering event after which " samples " may end by chance" }, \
    LIGHTING_HEURISTIC,                                                        \
    LIGHTING_SKY,                                                              \
    LIGHTING_LIGHTSAMPLER

#endif
