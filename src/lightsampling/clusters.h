/* clusters.h -- light from many points that face somewhere, by a few that stand for the others.
 *
 * Source      [Walter05 3 to 5].
 * Lights      Points of the intensity power * max(0, cos) about their normals, or |cos|.
 * Tree        Nodes in preorder: the first child follows its parent. The light that stands for a
 *             node is one of it, chosen with the probability of its power, and it stands for one of
 *             the node's children too, so only the other child has to be asked for.
 * Bound       Of cos_x cos_i / d^2 for any light of the node: over the nearest distance to its
 *             box; the cosine at x by the greatest height of the box above the horizon; that at the
 *             light by the cone of normals, made wider by the ball about the box.
 * Cut         From the roots on, the node that may be farthest off is replaced by its children,
 *             until none may be off by more than a part of the whole estimate. A node is off by
 *             less than its bound times its power: both what it is and what it is taken for lie
 *             between that and 0.
 * Departs     The tree is made from the top, by halves of the longest side in place and normals,
 *             not by joining pairs. */
#ifndef LIGHTSAMPLING_CLUSTERS_H
#define LIGHTSAMPLING_CLUSTERS_H

#include "base/vec.h"

#include <stddef.h>
#include <stdint.h>

typedef struct {
    V3    p, n;                 /* the place; unit */
    float power;                /* above 0 */
    bool  two_sided;
} OrientedLight;

typedef struct {
    Box   box;
    V3    axis;                 /* of the cone of normals, unit */
    float cosine, sine;         /* of its half angle */
    float power;                /* sum */
    uint32_t light;             /* that stands for it: its number */
    uint32_t second;            /* the other child, counted from this node; 0: this is a leaf */
} Cluster;

/* The tree over n > 0 lights in node, which has room for 2 n - 1; order has room for n. key: of the
 * choices. across: the distance that counts as much as opposite normals. */
void clusters_build(Cluster *node, uint32_t *order, const OrientedLight *l, uint32_t n,
                    float across, uint64_t key);

/* A matt point; n: on the side on which light is wanted. most: bound of cos_x cos_i / d^2 by other
 * means, or INFINITY. */
typedef struct { V3 p, n; float most; } LitMatt;
float cluster_bound(const Cluster *c, const LitMatt *at);

enum { CLUSTERS_MOST = 4096 };
typedef struct {
    const Cluster *node;
    Rgb   unit;                 /* what its light brings, over that light's power */
    float error;                /* most that it is off */
    uint32_t root;
} CutCluster;

typedef struct {
    LitMatt at;
    float f;                    /* most that a unit of power brings, over the bound */
    float tolerance;            /* part of the estimate */
    size_t most;                /* clusters, at most CLUSTERS_MOST */
    float besides;              /* light that comes otherwise: part of the estimate */
    Rgb (*ask)(void *ctx, uint32_t root, uint32_t light);       /* what it brings */
    void *ctx;
} CutAsk;

/* Clusters of the cut, in cut; how many. There are no more roots than `most`. */
size_t clusters_cut(const Cluster *const *root, size_t nroots, const CutAsk *q, CutCluster *cut);

#endif
