/* eyepaths.h -- paths from the eye by chance, each with all its vertices: where chains begin, and
 * new paths within them.
 *
 * Source      [Cline07 7.12.1 "new path mutations", 8.4.1, (8.9), (8.10)], [Veach97 11.4.2].
 * Whole       eyepath_traced follows one path and completes it at every vertex in two ways, by
 *             asking for a light and by meeting one, weighed by the balance heuristic.
 * Single      eyepath_new makes one path of a given number of edges; at the last surface it asks
 *             for a light, or goes on and must meet one, each by half: so its density is a product
 *             along the path and a sum of two at the end.
 * Measure     Densities are over directions at smooth vertices, see lightpath.h, so that colour /
 *             density is an estimate of the picture. Places on the picture are all alike. What
 *             happens at a vertex has the chances of chances.h. */
#ifndef INTEGRATORS_EYEPATHS_H
#define INTEGRATORS_EYEPATHS_H

#include "integrators/chances.h"
#include "lightsampling/lightsampler.h"

typedef struct {
    const Scene *scene;         /* borrowed */
    const LightSampler *lights; /* borrowed */
    int   maxdepth, roulette;
} EyePaths;

/* A complete path, whose colour times scale is a part of the estimate. Its storage is the caller's
 * to read, not to keep. by: the way it was made, of those of bothpaths.h. */
typedef void EyePathFound(void *ctx, const LightPath *p, int by, double scale, Tracer *t);
enum { BY_EYE = 0 };

/* How far a path was followed: surfaces met, and the probability that roulette let it come to each
 * of them. */
typedef struct {
    int    met;
    double let[LIGHTPATH_MOST];
} EyeTrace;

/* Follows a path from p's pixel, by the tracer's decisions. rooms[1] to rooms[maxdepth+1]
 * are for its vertices. */
void eyepath_traced(const EyePaths *it, LightPath *p, Vertex *const *rooms, Tracer *t,
                    EyePathFound *found, void *ctx, EyeTrace *how);
/* The density with which it makes a path but for roulette. before: the chance of all that happens
 * before the last vertex. */
double eyepath_whole_density(const EyePaths *it, const LightPath *p, double before);
/* Vertex i does something by chance, and the walk goes on; gives the chance. 0: it ends. */
double eyepath_turns(LightPath *p, int i, Walk *w, Tracer *t);
/* The light l is met by a ray to that point on it, with nothing in the way: it becomes the end. */
bool eyepath_meets_point(LightPath *p, const Light *l, V3 point, float dist, Walk *w, Tracer *t);

/* One path of p->edges edges from p's pixel. False: it comes to nothing. */
bool eyepath_new(const EyePaths *it, LightPath *p, Vertex *const *rooms, Tracer *t);
/* The density with which eyepath_new makes it from its pixel, once it has its number of edges. */
double eyepath_density(const EyePaths *it, const LightPath *p, double before);

/* A place on the lens and a time for p, by the tracer's decisions. */
void eyepath_begins(const Scene *s, LightPath *p, Tracer *t);

#endif
