/* arrivals.h -- where the light of one pass arrives: records of one size, written down by many
 * threads in batches of paths, and a grid of where they are.
 *
 * Record      Its first three members are the place, as floats. Behind it, what the method wants.
 * Order       Batches are of so many paths each, and threads take them in any order; the grid is
 *             that of the batches one after another. So nothing depends on who did what. */
#ifndef INTEGRATORS_ARRIVALS_H
#define INTEGRATORS_ARRIVALS_H

#include "geometry/pointgrid.h"

#include <stdbool.h>

enum { ARRIVALS_BATCH = 1024 };         /* paths */

typedef struct { char *records; size_t n, cap; } ArrivalBatch;

typedef struct {
    size_t   size;              /* of a record, bytes */
    uint64_t paths;             /* of a pass */
    ArrivalBatch *batches;      /* owned */
    size_t   nbatches;
    int      bits;              /* of a number within its batch */
    PointGrid grid;             /* owned */
} Arrivals;                     /* {0} is empty */

/* Of so many paths a pass. False: reported, and a is empty. */
bool arrivals_init(Arrivals *a, size_t size, uint64_t paths);
void arrivals_clear(Arrivals *a);

/* Of a batch: its paths, and room at its end. */
INLINE uint64_t arrivals_first(uint64_t batch) { return batch * ARRIVALS_BATCH; }
INLINE uint64_t arrivals_end(const Arrivals *a, uint64_t batch)
{
    uint64_t end = (batch + 1) * ARRIVALS_BATCH;
    return end < a->paths ? end : a->paths;
}
/* Adds a record. False: memory, reported. */
bool arrivals_add(ArrivalBatch *b, size_t size, const void *record);

/* When all batches are full: phases of units, see pointgrid.h. `edge` of cells matters to the first
 * of them, which is one unit. False: memory, or too many records to be numbered, reported. */
enum { ARRIVALS_PHASES = 5 };
uint64_t arrivals_units(const Arrivals *a, int phase);
bool     arrivals_run(Arrivals *a, int phase, uint64_t unit, float edge);
size_t   arrivals_found(const Arrivals *a);

/* Of a point of the grid. */
INLINE const void *arrivals_record(const Arrivals *a, uint32_t id)
{
    uint32_t within = ((uint32_t)1 << a->bits) - 1;
    return a->batches[id >> a->bits].records + (id & within) * a->size;
}

#endif
