/* partition.h -- two stage importance sampling: the sky map cut into rectangles on which a factor f
 * of the integrand is as good as bilinear, and canonical points warped to the product of both.
 *
 * Source      [Cline07 5.2, 5.3], errata 5.1 to 5.6 and 5.8.
 * Stage one   partition_make, for one turn. The root is all of the map, or the rows that a
 *             hemisphere reaches. It is split at the normal and the column opposite, at the peaks
 *             of f, and where the product is worst known (5.3); splits go on into neighbours for
 *             which their f is large.
 * Stage two   partition_warp takes a point of the unit square down the tree by the weights of the
 *             leaves (5.5), then down to the cell by halves, and any place in that.
 * Exact       The density given is that of the cell that was drawn, over its own area; at wi it is
 *             what partition_pdf_w says, but for roundings of wi into the next cell.
 * Positive    f counts as at least what gives PARTITION_FLOOR of the samples to the map alone: no
 *             direction from which light comes within the root has density 0 (errata 5.3).
 * Lamps       Maps may be of lamps, see skymap.h: directions are points of the lamp then, densities
 *             are per unit square, and `up` is 0.
 * Memory      All of it stands in the Partition, about 110 kB, of which only what is used is
 *             written: on the stack, or one for each thread. */
#ifndef LIGHTSAMPLING_PARTITION_H
#define LIGHTSAMPLING_PARTITION_H

#include "lightsampling/skymap.h"

enum { PARTITION_LEAVES = 512, PARTITION_NODES = 2 * PARTITION_LEAVES - 1 };
#define PARTITION_FLOOR 0.02f

typedef struct {
    uint16_t x0, y0, x1, y1;    /* cells x0 .. x1 - 1 of rows y0 .. y1 - 1 */
    uint16_t child;             /* the first of two that stand together; 0: a leaf */
    uint16_t split;             /* the column or row that the second begins at */
    bool  by_x;                 /* by columns */
    float f[4];                 /* at the corners (x0, y0), (x1, y0), (x0, y1), (x1, y1) */
    double sum;                 /* of the map */
    double weight;              /* (5.5) */
} PartitionNode;

typedef struct { double at[2], end[2]; } PartitionPart;         /* of the unit square */

/* The same node for points on their way down: its second child takes them from `cut` on. A leaf
 * has itself for the first child, and no point is beyond its cut. */
typedef struct { double cut; uint16_t first; uint16_t by_y; } PartitionFork;

typedef struct {
    const SkyMap *map;          /* borrowed */
    float floor;                /* least f, see above */
    int   n;                    /* nodes; node[0] is the root */
    PartitionNode node[PARTITION_NODES];
    PartitionFork fork[PARTITION_NODES];
    PartitionPart part[PARTITION_NODES];        /* that is warped to the node */
    uint32_t key[PARTITION_NODES + 1];  /* of leaves by potential (5.3); of others 0 */
} Partition;

/* What a partition is made for. Directions are unit, of the world. */
typedef struct {
    /* The factor beside the map, at least 0 (what is not counts as 0): f |cos| by luminance. */
    float (*f)(const void *of, V3 wi);
    const void *of;
    V3    up;                   /* f is 0 but for the hemisphere about up; 0: it may be anywhere */
    const V3 *peak;             /* where f is large: splits, */
    int   peaks;
    const V3 *tried;            /* and more, each a split if f there is above the mean of the
                                 * corners around it */
    int   tries;
    int   splits;               /* by potential, while there is room for leaves */
} PartitionOrder;

/* False: no light comes from where f may be above 0. */
bool  partition_make(Partition *p, const SkyMap *m, const PartitionOrder *o);

typedef struct {
    V3    wi;
    float pdf_w;                /* 0 at the map's very poles, where it is infinite */
    V2    place;                /* on the map, see skymap_radiance */
} PartitionSample;

void  partition_warp(const Partition *p, V2 u, PartitionSample *s);
/* The same of n points, which go faster together. */
void  partition_warp_many(const Partition *p, const V2 *u, PartitionSample *s, int n);
/* The density of wi; 0 outside the root and where the map is black. */
float partition_pdf_w(const Partition *p, V3 wi);
/* That of a place of the map, exactly as partition_warp has it; jacobian: d omega / d place there.
 * With 1: per unit square. */
float partition_pdf_at(const Partition *p, V2 place, float jacobian);
/* The point that is warped to wi, and its density. False: no point is. */
bool  partition_unwarp(const Partition *p, V3 wi, V2 *u, float *pdf_w);

#endif
