/* virtualcuts.h -- lightcuts over virtual lights: a tree for those of each set and depth.
 *
 * Source      [Walter05]; clusters.h.
 * Which       Matt lights, at matt points. Lights that are not matt have no bound that is worth
 *             its name, so each of them is asked; and so is every light at points that are not.
 * Depths      One tree each, so that paths are not too long where some of it went by mirrors. */
#ifndef INTEGRATORS_VIRTUALCUTS_H
#define INTEGRATORS_VIRTUALCUTS_H

#include "integrators/virtuallights.h"
#include "lightsampling/clusters.h"

typedef struct {
    uint32_t first, n;          /* of `matt`; its nodes begin at 2 first */
    uint32_t depth;
} VirtualTree;

typedef struct {
    const VirtualLights *lights;/* borrowed */
    float  tolerance;           /* 0: there are no cuts */
    size_t most;                /* clusters */
    OrientedLight *matt;        /* owned */
    uint32_t *which, *order;    /* owned; by matt: the virtual light; for building */
    Cluster *node;              /* owned */
    VirtualTree *tree;          /* owned; set after set */
    uint32_t *trees;            /* owned; sets + 1: the first of each set */
    uint32_t *other;            /* owned: lights that are not matt, set after set, by depth */
    uint32_t *others;           /* owned; sets + 1 */
} VirtualCuts;

void virtualcuts_init(VirtualCuts *c, const VirtualLights *l, float tolerance, size_t most);
void virtualcuts_clear(VirtualCuts *c);

/* After the lights are there, phases: 0 makes room (one unit; false: memory, reported), 1 builds
 * a tree each. */
enum { VIRTUAL_CUT_PHASES = 2 };
uint64_t virtualcuts_units(const VirtualCuts *c, int phase);
bool virtualcuts_run(VirtualCuts *c, int phase, uint64_t unit);

INLINE bool virtualcuts_can(const VirtualCuts *c, const Vertex *v)
{
    return c->tolerance > 0.0f && v->b->kind == &bsdf_diffuse;
}

/* What the matt lights of the set bring the vertex, those of at most so many scattering events; ask
 * is called with the number of a light in lights->light, and gives what that brings. bound: of the
 * geometric term, or 0. cut: where it is left, for tallies. q: see CutAsk; of it f, at and the
 * sizes are set here. The sum of cut[i].unit * power is what they bring. */
size_t virtualcut(const VirtualCuts *c, const Vertex *v, uint32_t set, int depth, float bound,
                  CutAsk *q, CutCluster cut[CLUSTERS_MOST]);

#endif
