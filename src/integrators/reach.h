/* reach.h -- places at which something about light is known, and how far around it holds.
 *
 * Source      [Ward88] and errata 7.15 for the error of what is known, at another place,
 *                 e = |x - xi| / Ri + sqrt(1 - n.ni),  used where e < a;
 *             [Krivanek06] for the radii of neighbours.
 * Weight      1 / e - 1 / a, not Ward's 1 / e: it is 0 where a record ends, so no edge shows.
 * Radius      Ri is the harmonic mean of the distances to what is around, but no more than the way
 *             on which the value changes by itself, and within bounds that the maker of the record
 *             gives (of its size on the picture). Neighbours may not differ in it by more than
 *             their distance: a crack that one of many rays found matters to the others too.
 * Behind      Records that lie in front of the place, by the mean of both normals, may see what it
 *             does not: passed over. */
#ifndef INTEGRATORS_REACH_H
#define INTEGRATORS_REACH_H

#include "geometry/balltree.h"

typedef struct {
    V3    p, n;
    float radius, least;        /* Ri; its lower bound */
} Reach;

/* Sets the radius, within least and most: for a value with a slope. Returns the part of the slope
 * that is good for so far: less than 1 where the least radius is more than was right. */
float reach_limit(Reach *r, float inv_distance, float value, float slope, float least, float most);
/* Error there; INFINITY if the record lies in front. */
float reach_error(const Reach *r, V3 p, V3 n);
/* 0: not used. */
double reach_weight(const Reach *r, V3 p, V3 n, float a);

typedef struct {
    Reach *at;                  /* owned */
    size_t n, cap;
    BallTree tree;              /* owned: balls of radius a Ri */
    float a;                    /* of the widest question */
} Reaches;

bool reaches_init(Reaches *s, Box around, float a);             /* false: reported */
void reaches_clear(Reaches *s);
/* Takes it in; its radius and its neighbours' are clamped against each other. False: memory,
 * reported. */
bool reaches_insert(Reaches *s, const Reach *r);

#endif
