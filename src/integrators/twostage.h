/* twostage.h -- two stage importance sampling for the light of a turn: the light beyond the scene
 * that has a map is asked by partitions of it, all others as ever.
 *
 * Source: [Cline07 5], see lightsampling/partition.h. */
#ifndef INTEGRATORS_TWOSTAGE_H
#define INTEGRATORS_TWOSTAGE_H

#include "integrators/lighting.h"
#include "lightsampling/partition.h"

typedef struct {
    const Light *light;         /* borrowed; of the map. NULL: none has one, all go as ever */
    SkyMap   map;               /* owned; if there is a light */
    Scene    rest;              /* as the scene, without that light: borrowed but for its lists */
    Light    dark;              /* stands for it in the list there */
    bool     any;               /* there are other lights */
    bool     lamps;             /* and some of them can be met by chance */
    Lighting others;            /* owned; of `rest` */
    int      splits;            /* of a partition; 0: by the number of samples */
    bool     sampled;           /* peaks are found by sampling the surface */
} TwoStage;

/* By the options `splits` and `peaks`, and those of lighting_init. Other lights are judged by cast
 * rays; samples of them are directions if that is wanted. False: reported. */
bool twostage_init(TwoStage *it, const Scene *s, const Opts *o, bool directions);
void twostage_clear(TwoStage *it);

#define TWOSTAGE_SPLITS(least)                                                 \
    { .key = "splits", .type = OPT_INT, .num = least, .lo = 0, .hi = PARTITION_LEAVES, \
      .help = "twostage: rectangles of the sky are split so often where the product is worst " \
              "known; 0: half as often as it is sampled, up to 16 samples once for each" }
#define TWOSTAGE_PEAKS                                                         \
    { .key = "peaks", .type = OPT_CHOICE, .str = "known", .choices = "known sampled",  \
      .help = "twostage: where rectangles are split first: at peaks that the surface's model " \
              "knows, or that a quarter as many samples of it find" }

/* For `samples` directions at the turn. False: the map's light brings nothing. */
bool twostage_partition(const TwoStage *it, const Turn *u, int samples, Tracer *t, Partition *p);
/* One of n samples: what the map's light would add. False: nothing. */
bool twostage_candidate(const TwoStage *it, const PartitionSample *s, const Turn *u, float n,
                        Candidate *c);

#endif
