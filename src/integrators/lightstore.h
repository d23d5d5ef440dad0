/* lightstore.h -- the vertices of all light paths of a pass, kept small, and a grid of where they
 * are.
 *
 * Source      [GIRT 4.2, 5.4], [Georgiev12].
 * Small       64 bytes a vertex: what was hit, so that the vertex can be made again for
 *             connections, and what mergers need. The grid adds 16.
 * Straight    What comes straight from lamps is not in the grid unless it is merged: at most one
 *             vertex of a path, the first.
 * Order       Vertices stand by path, so that each of the eye's paths finds that one of its own. */
#ifndef INTEGRATORS_LIGHTSTORE_H
#define INTEGRATORS_LIGHTSTORE_H

#include "integrators/arrivals.h"
#include "integrators/bidirectional.h"

typedef struct {
    float    p[3];
    float    way[2];            /* that the light came, see kept_way */
    float    u, v;              /* of the hit */
    uint32_t outer, prim;
    float    flux[3];
    float    last, early, merged;   /* its odds */
    uint32_t medium : 24, edges : 8;
} KeptVertex;

INLINE Odds kept_odds(const KeptVertex *k)
{
    return (Odds){ k->last, k->early, k->merged, 0.0f };
}

struct LightStore {
    Arrivals arrivals;          /* owned */
    KeptVertex *straight;       /* owned: of each path, edges 0 if there is none; NULL: merged */
    uint32_t *first;            /* owned: of each path, the others, within its batch */
    float    radius;            /* of mergers, in this pass */
};

/* For so many light paths a pass; straight: what comes straight from lamps is merged, too. False:
 * reported, and nothing has to be cleared. */
bool lightstore_init(LightStore *s, const Scene *scene, uint64_t paths, bool straight);
void lightstore_clear(LightStore *s);

/* A pass: its light paths are traced and shown to the lens, then sorted into the grid. `merges`:
 * the grid is wanted. */
enum { LIGHTSTORE_PHASES = 1 + ARRIVALS_PHASES };
uint64_t lightstore_units(const LightStore *s, int phase, bool merges);
void     lightstore_run(LightStore *s, const Bidirectional *b, uint32_t pass, int phase,
                        uint64_t unit, Tracer *t);

/* The vertices of a path, made again. Returns how many: at most DEPTH_MOST. */
int lightstore_path(const LightStore *s, uint64_t number, LightVertex *path, Tracer *t);

/* The way the light came, unit. */
V3  kept_way(const KeptVertex *k);

#endif
