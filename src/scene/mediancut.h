/* mediancut.h -- a picture of directions cut into regions of like light.
 *
 * Source  [Debevec05]: the picture is halved again and again, each part across its longer side
 *         where the light on both sides is the same. After k cuts there are 2^k regions, each of
 *         which stands for a light in its middle (weighed by light). Departs: lengths are those of
 *         the picture, not of the sphere; a part of one cell is not cut: its other half is empty */
#ifndef SCENE_MEDIANCUT_H
#define SCENE_MEDIANCUT_H

#include "sampling/table.h"

typedef struct {
    uint32_t x0, y0, x1, y1;    /* cells [x0, x1) by [y0, y1) */
    V2 middle;                  /* in the unit square, by light */
} Region;

enum { CUTS_MOST = 12 };        /* 4096 regions */

typedef struct {
    uint32_t w, h;              /* cells of the picture */
    int      cuts;
    Region  *node;              /* owned: 2^(cuts + 1), a heap from 1; the last half are regions */
    Table    table;             /* owned: the light of each region */
} MedianCut;

/* weight[y * w + x]: the light of a cell. False: memory, reported. */
bool mediancut_init(MedianCut *m, const float *weight, uint32_t w, uint32_t h, int cuts);
void mediancut_clear(MedianCut *m);

/* The region that the place is in, and the density there, per unit square, of sampling regions by
 * their light and places within them uniformly. */
uint32_t mediancut_find(const MedianCut *m, V2 place);
float    mediancut_pdf(const MedianCut *m, V2 place);
/* Chooses a region; the place is its middle, or anywhere in it. *pdf as mediancut_pdf has it. */
bool     mediancut_sample(const MedianCut *m, V2 u, bool jitter, V2 *place, float *pdf);

#endif
