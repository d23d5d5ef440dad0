/* product.h -- samples in proportion to the product of a light's map and what a turn makes of it,
 * for lamps with pictures and for maps of colour: two stage importance sampling where a partition
 * of the sky by luminance is not enough.
 *
 * Source      [Cline07 5], which has environment maps "or large light sources", and in 5.7 the idea
 *             of a summed area table of colour with values of f in colour.
 * Lamps       A map is the lamp's picture by area. f is what goes with a place: f |cos| of the
 *             turn, the cosine at the lamp, with its focus, over the squared distance.
 * Colour      Each channel has a map and a partition of its own; a sample goes by one of them,
 *             chosen by how much luminance it has of the product's integral, and its density is
 *             the mean of all three: that of the product of colours, by luminance. Densities of two
 *             partitions must be looked up for every sample: it pays where lights and surfaces are
 *             coloured, and differ. */
#ifndef INTEGRATORS_PRODUCT_H
#define INTEGRATORS_PRODUCT_H

#include "integrators/lighting.h"
#include "lightsampling/partition.h"

typedef struct {
    const Light *light;         /* borrowed */
    int    channels;            /* 1: by luminance; 3: by colour */
    SkyMap map[3];              /* owned, so many */
} LightMap;

/* lamp NULL: a light from beyond the scene that has `picture`. False: memory, reported. */
bool lightmap_init(LightMap *it, const Light *l, const LightRectangle *lamp, bool colour);
void lightmap_clear(LightMap *it);

/* About 330 kB, of which only what is used is written. */
typedef struct {
    const LightMap *of;         /* borrowed */
    float  share[3];            /* of the samples, by channel; together 1 */
    Partition part[3];
} Product;

/* peak, n: directions from the turn in which its factor is large, or where it has been tried; as
 * PartitionOrder has them. False: the light brings nothing. */
bool  product_make(Product *p, const LightMap *of, const Turn *u, const V3 *peak, int n,
                   bool tried, int splits);
/* wi: of a lamp, the point. pdf_w: of a lamp, per unit square of its places. */
void  product_draw(const Product *p, V2 u, PartitionSample *s);
/* The density of a place of the map, as product_draw has it. */
float product_pdf(const Product *p, V2 place);
/* One of n samples of the sky by a partition of its map: what the light would add. False:
 * nothing. */
bool  skymap_candidate(const SkyMap *m, const PartitionSample *s, const Turn *u, float n,
                       Candidate *c);
/* The same of a product. */
bool  product_candidate(const Product *p, const PartitionSample *s, const Turn *u, float n,
                        Candidate *c);

#endif
