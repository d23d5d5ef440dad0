/* guideinner.h -- what the parts of a guide share: guide.c has its maps and how they learn,
 * guidelights.c the choice of lights, guidescatter.c where light goes on. */
#ifndef INTEGRATORS_GUIDEINNER_H
#define INTEGRATORS_GUIDEINNER_H

#include "integrators/guide.h"

enum { FORKS_MOST = 64 };

/* What a sample has decided, for each map: where, and how much light there was before. */
typedef struct {
    bool  used;
    V2    place;
    V3    way;                  /* of directions in maps that are left alone, instead of place: to
                                 * look for that takes long, and is for those that bring light */
    float own, map;             /* densities without the map, and by it alone */
    float before, gained;       /* light so far; of a connection */
} Decided;

typedef struct { bool used, refracts; float before; } Fork;

struct Guide {
    const GuidePlan *plan;      /* borrowed */
    Sampler inner;              /* the pixel's own */
    float  *maps;               /* borrowed: of the pixel */
    float  *worth;              /* owned: what its samples were worth */
    float  *room;               /* owned: of inverted tables */
    Inverted table[GUIDE_MAPS];
    float   share[GUIDE_MAPS];  /* of what is by the map, the remainder being as without */
    Decided decided[GUIDE_MAPS];                /* by the sample at hand */
    Fork    fork[FORKS_MOST];
    float   pending;            /* over the density of warped numbers, not yet in the throughput */
    float   point_density;
    const Light *met;           /* borrowed: the light that was asked last for the number of a */
    V3      met_wi;             /* direction, this one: */
    V2      met_number;
    int     order, here;        /* of vertices that are guided; here: -1, this one is not */
    int     depth;              /* of the vertex at hand */
    int     direction, forked;  /* decided at this event: a map's number, a fork's; -1: not */
};

/* Finds place and density by the map of a direction's way. */
void guide_places(const Guide *g, int map, Decided *d);

INLINE bool guide_has(const Guide *g, int map) { return g->plan->shape[map].w != 0; }

/* The vertex's own map of lights, points or directions; -1: there is none. */
INLINE int guide_map_here(const Guide *g, GuideKind k)
{
    int map = g->here >= 0 ? guide_map(k, g->here) : -1;
    return map >= 0 && guide_has(g, map) ? map : -1;
}

#endif
