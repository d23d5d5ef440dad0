/* glints.h -- light that a vertex gets by way of delta events (a lamp in a mirror, a caustic of
 * glass): of all that there is the hardest to find for a method that follows rays from the eye.
 *
 * Source      Splitting, [Arvo90].
 * Idea        A path that leaves a vertex by a smooth event tries many directions instead of one
 *             for the light that comes through delta events alone, and goes on by the first of
 *             them. So of that light each of n candidates brings 1/n: the first one as the path
 *             itself, the others here. A candidate is cheap where it cannot meet anything that
 *             glints, which is known before it is followed.
 * Worth it    where small bright lights meet mirrors and glass: with n = 4 the same error in a half
 *             to a third of the time. Where the light by deltas is no noisier than the rest (a sky
 *             in a mirror) the candidates only cost.
 * Invariants  E[share of the path + glints()] is the light by delta events that the path alone
 *             would bring; all else of the path stays as it is. */
#ifndef INTEGRATORS_GLINTS_H
#define INTEGRATORS_GLINTS_H

#include "integrators/beam.h"
#include "scene/subset.h"

typedef struct {
    const Scene *scene;         /* borrowed */
    Subset shapes;              /* owned: those that glint */
    int    n;                   /* candidates of a vertex, the path among them */
    int    maxdepth;            /* most scattering events */
} Glints;

enum { GLINTS_MOST = 64 };

/* False: reported. */
bool glints_init(Glints *g, const Scene *s, int n, int maxdepth);
void glints_clear(Glints *g);

/* The part of a path's light by delta events that the path itself brings. */
INLINE float glints_share(const Glints *g) { return 1.0f / (float)g->n; }

/* What the other candidates bring of it, from a vertex with smooth events: b has come there. The
 * path takes its event by decisions LOBE and DIRECTION number b->depth. */
Rgb glints_light(const Glints *g, const Vertex *v, const Beam *b, Tracer *t);

#endif
