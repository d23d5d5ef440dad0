/* lightcut.h -- one cut through the tree of point lights, as a point that is shaded wants it: its
 * clusters in arrays, each given a probability for the point, and a light chosen by them.
 *
 * Source      [Wang09 3.3, (6) to (9)], errata 002.1 to 002.5.
 * Importance  of a cluster for a point is what it would bring unhindered, about:
 *                 lobes     <l> e_k, where e_k is the part of the energy of rays by the BSDF that
 *                           go into the cluster: N_k / N_p [Wang09 (7)]. f cos is in it already,
 *                           the solid angle too: no r^2 / A (errata 002.3, 002.4);
 *                 matt      <l> (k_d / pi) cos omega_k, omega_k clamped to 2 pi.
 *             Where rays are few for the clusters that a lobe covers, most clusters have none and
 *             would be lost (errata 002.1). So energy goes down the tree from the root: of what a
 *             node has, its children have parts in proportion to what rays say, and to their solid
 *             angles as if `prior` more rays had fallen evenly. Many rays tell what they tell;
 *             between few, energy is spread. prior = 0: as in the source.
 *             The cosine is a mean over the cluster's ball, above 0 while any of it can be above
 *             the horizon, and the patch is turned as its mean normal says; both depart.
 * Rays        find clusters within the scene by boxes over the cut, four at a time; those beyond by
 *             the cell that they run into, which is exact, or by boxes as well, as in the source.
 * Unbiased    A share of the choices goes by light alone, so no light has probability 0. */
#ifndef LIGHTSAMPLING_LIGHTCUT_H
#define LIGHTSAMPLING_LIGHTCUT_H

#include "lightsampling/lighttree.h"

/* Four boxes side by side. child: another four, or ~k for cluster k; no child: an empty box. */
typedef struct { float lo[3][4], hi[3][4]; int32_t child[4]; } FourBoxes;

/* How a light of a cluster is chosen: each alike, as in the source; by its value; or, within the
 * scene, down the tree as long as nodes are near, at each by what its children would bring, and
 * then by value: lights near the point are very unlike each other. */
typedef enum { WITHIN_EVEN, WITHIN_BY_LIGHT, WITHIN_BY_TREE } WithinCluster;

/* The tree above the cut, in preorder. */
typedef struct { uint32_t second; int32_t cluster; } CutNode;   /* second 0: it is a cluster */

typedef struct {
    const LightTree *tree;      /* borrowed */
    CutNode *above;             /* owned: 2 n - 1 */
    size_t n, nbeyond;          /* clusters; the first of them are beyond the scene */
    /* Owned, by cluster. In the scene: place, how far the box goes from there along each axis, and
     * along the normal; normal times area, its length, area. Beyond: direction, the box in units of
     * the sphere's radius, solid angle. */
    float *x, *y, *z, *hx, *hy, *hz, *deep, *nx, *ny, *nz, *turned, *size;
    float *lum;                 /* mean over the size */
    float *share;               /* of all light: the pmf by light alone */
    uint32_t *first;            /* owned: n + 1 runs of the tree's order */
    uint16_t *of_cell;          /* owned: of a cell of the sphere, or NO_CLUSTER */
    FourBoxes *four[2];         /* owned: over clusters within, over those beyond; or NULL */
    uint32_t *node;             /* owned: of the tree, by cluster */
    WithinCluster within;
} LightCut;

#define NO_CLUSTER UINT16_MAX

/* boxes: rays find clusters beyond by boxes, not by cells. False: memory, reported. */
bool lightcut_init(LightCut *c, const LightTree *t, const CutRule *rule, bool boxes,
                   WithinCluster within);
void lightcut_clear(LightCut *c);

/* Adds `energy` to energy[k] of all clusters that the ray runs into, which are out of sight of
 * nothing. d unit. */
void lightcut_count(const LightCut *c, V3 p, V3 d, float energy, float *energy_of);

/* Adds what clusters would bring a matt surface at p, of the reflectance kd above the unit normal
 * n, and below it, times pi. */
void lightcut_matt(const LightCut *c, V3 p, V3 n, float above, float below, float *weight);
/* Turns energies of rays, each of which brought `one`, into importance. */
void lightcut_lobes(const LightCut *c, V3 p, float prior, float one, float *energy);
/* The middle of cluster k as seen from p, and its clamped solid angle there. */
float lightcut_middle(const LightCut *c, size_t k, V3 p, V3 *wi);

/* Turns importance into a pmf, of which `safe` goes by light alone; all of it where there is no
 * importance at all. */
void lightcut_normalize(const LightCut *c, float safe, float *weight);

/* For whom lights are chosen: n is the normal on the side that they shine on, 0 for both. */
typedef struct { V3 p, n; } LitPoint;

/* The light at the place x of [0, 1), laid out in the tree's order. *k, *before: the cluster where
 * the search begins and the sum of those before it; 0 and 0 for the first, and then as they are
 * left for larger x. *pmf is exactly the probability if those of clusters add up to 1; 0: none. */
size_t lightcut_choose(const LightCut *c, const LitPoint *lit, const float *pmf_of, double x,
                       size_t *k, double *before, float *pmf);
/* The probability of light number `at` of the tree's order, in cluster k. */
float lightcut_pmf(const LightCut *c, const LitPoint *lit, const float *pmf_of, size_t k,
                   size_t at);

#endif
