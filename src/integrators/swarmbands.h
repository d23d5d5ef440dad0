/* swarmbands.h -- bands of a picture, in each of which pixels learn from those before them: their
 * maps, who is whose neighbour, and the order of samples.
 *
 * Source      [Cline07 9.2.3, fig. 9.10].
 * Invariants  A band knows nothing of others but what tiles have kept of the pass before, so it is
 *             all the same which thread does what when. It may stop after any pixel and go on
 *             later, also from a file, which has of its two rows what pixels to come may look
 *             at. */
#ifndef INTEGRATORS_SWARMBANDS_H
#define INTEGRATORS_SWARMBANDS_H

#include "integrators/guide.h"

typedef struct Band Band;

typedef struct {
    GuidePlan plan;
    const Film *film;           /* borrowed */
    uint32_t rows;              /* of tiles in a band */
    uint32_t n;                 /* bands */
    Band   **open;              /* owned: of each band what it knows amid a pass; NULL: it has not
                                 * begun, or is done */
    float   *tiles;             /* owned: of each tile, what the pass before has learned; NULL:
                                 * nobody asks */
    bool    *known;             /* owned: the same of which rows of tiles, */
    uint32_t ntiles_y;          /* so many */
} Bands;

/* All but the plan and the rows. across: passes learn from each other. False: memory, reported. */
bool bands_prepare(Bands *all, const Film *f, bool across);
void bands_clear(Bands *all);

/* Samples first .. first + n - 1 of the pixels of a band, or of those of them that are left. */
void bands_walk(Bands *all, uint32_t unit, uint32_t first, uint32_t n, const Taker *taker);

void bands_save(const Bands *all, Saving *s);
bool bands_load(Bands *all, Loading *l);

#endif
