/* lighttree.h -- a binary tree over point lights, and cuts through it: sets of nodes that hold
 * every light once, within each of which light is much the same.
 *
 * Source      [Wang09 3.2, (4), (5)]; errata 002.5.
 * Values      What a light's value v is: its luminance times its size, scaled so that for lights of
 *             equal size it is the luminance. Areas are compared with solid angles as if seen from
 *             twice the radius of the scene's sphere.
 * Nodes       In preorder: the first child follows its parent. The lights of a node are a run of
 *             the tree's order. Lights beyond the scene and those within never share a node but
 *             the root.
 * Distance    Places by their distance; those that face differently are farther apart, by up to a
 *             quarter of the scene's radius, so the two sides of a wall are soon separate. */
#ifndef LIGHTSAMPLING_LIGHTTREE_H
#define LIGHTSAMPLING_LIGHTTREE_H

#include "lightsampling/pointlights.h"

typedef struct {
    V3     centre;              /* mean place by value; beyond: mean direction, unit */
    float  radius;              /* of the ball about the centre that holds the box */
    V3     normal;              /* sum of size times normal: 0 for lights with two sides */
    float  turned;              /* its length; -1 for lights with two sides, or beyond */
    V3     half;                /* from the centre, how far the box goes along each axis */
    float  deep;                /* the same along the normal; 0 if there is none */
    float  lum;                 /* luminance, the mean over the size */
    uint32_t first, count;      /* lights in the tree's order */
    uint32_t second;            /* the other child; 0: this is a leaf */
    Box    box;                 /* of the discs that lights stand for; beyond: of directions */
    double sum, squares;        /* of values; of their deviations from the mean */
    double size;                /* area, or solid angle */
    double light;               /* luminance times size */
    bool   beyond, within;      /* what lights there are */
} LightNode;

typedef struct {
    const PointLights *lights;  /* borrowed */
    LightNode *node;            /* owned; [0] is the root */
    size_t nnodes;              /* 0: no lights */
    uint32_t *order;            /* owned: numbers of lights */
    double *running;            /* owned: n + 1 sums of values, in order */
} LightTree;

bool lighttree_init(LightTree *t, const PointLights *points);   /* false: memory, reported */
void lighttree_clear(LightTree *t);

enum { CUT_MOST = 4096 };

typedef struct {
    size_t most;                /* nodes, at most CUT_MOST */
    float  sigma;               /* (5): no node is divided whose squares are below its square */
    float  extent;              /* weight of a node's extent, beside its squares, when the next to
                                 * divide is chosen. 0: as in the source */
} CutRule;

/* Nodes of the cut, in the tree's order; how many. Those beyond come first. */
size_t lighttree_cut(const LightTree *t, const CutRule *rule, uint32_t *node);

#endif
