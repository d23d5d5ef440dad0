/* twostage.h -- two stage importance sampling for the light of a turn: the light beyond the scene
 * that has a map is asked by partitions of it, and so are lamps that are rectangles with pictures;
 * all others as ever.
 *
 * Source: [Cline07 5], see lightsampling/partition.h; lamps, and maps of colour: product.h. */
#ifndef INTEGRATORS_TWOSTAGE_H
#define INTEGRATORS_TWOSTAGE_H

#include "integrators/product.h"

enum { TWOSTAGE_LAMPS = 4 };    /* with maps: those of most power */

typedef struct {
    const Light *light;         /* borrowed; of the map. NULL: none has one */
    SkyMap   map;               /* owned; if there is a light, and colours are not wanted */
    const Light *remainder;     /* borrowed; what the map leaves out of its light. NULL: nothing */
    LightMap asked[1 + TWOSTAGE_LAMPS]; /* owned: of lamps; before them the light's, */
    int      nasked;            /* if colours are wanted */
    bool     colour;
    Scene    rest;              /* as the scene, without those: borrowed but for its lists */
    Light    dark;              /* stands for each in the list there */
    bool     any;               /* there are other lights */
    bool     lamps;             /* and some of them can be met by chance */
    Lighting others;            /* owned; of `rest` */
    int      splits;            /* of a partition; 0: by the number of samples */
    bool     sampled;           /* peaks are found by sampling the surface */
} TwoStage;

/* By the options `splits`, `peaks` and `f`, and those of lighting_init. Other lights are judged by
 * cast rays; samples of them are directions if that is wanted. False: reported. */
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
#define TWOSTAGE_F                                                             \
    { .key = "f", .type = OPT_CHOICE, .str = "luminance", .choices = "luminance colour", \
      .help = "twostage: samples go by the product of luminances, or by that of colours, which " \
              "takes three maps and at least twice as long: for coloured light on coloured " \
              "things" }

enum { TWOSTAGE_PEAKS_MOST = 128 };
/* Directions in which the turn's factor is large, or, if it->sampled, where it has been tried. */
int   twostage_peaks(const TwoStage *it, const Turn *u, int samples, Tracer *t,
                     V3 peak[TWOSTAGE_PEAKS_MOST]);
/* Of a partition for so many samples. */
int   twostage_splits(const TwoStage *it, int samples);

/* ---- lights with products of their own: twostage_asked.c ---- */

/* Finds them; the light is known. False: memory, reported. */
bool  twostage_find_asked(TwoStage *it, const Scene *s);
/* Whether a map of any kind asks for the light: who meets it by chance does not count it. */
bool  twostage_asks(const TwoStage *it, const Light *l);
/* What they bring to the turn, by so many samples of each. */
Rgb   twostage_asked_light(const TwoStage *it, const Turn *u, int samples, Tracer *t);
/* A single sample of number k. False: nothing. */
bool  twostage_asked_candidate(const TwoStage *it, int k, const Turn *u, Tracer *t, Candidate *c);

/* ---- the light beyond the scene, by luminance ---- */

/* For `samples` directions at the turn. False: the map's light brings nothing. */
bool twostage_partition(const TwoStage *it, const Turn *u, int samples, Tracer *t, Partition *p);
/* One of n samples: what the map's light would add. False: nothing. */
bool twostage_candidate(const TwoStage *it, const PartitionSample *s, const Turn *u, float n,
                        Candidate *c);

#endif
