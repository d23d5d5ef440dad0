/* cells.h -- cells of space with lists of the primitives in them: what structures that divide space
 * have in common. A primitive may stand in many lists, in each once, and lists ascend. */
#ifndef ACCEL_CELLS_H
#define ACCEL_CELLS_H

#include "accel/accel.h"

/* What a query has tested already, but for collisions. [Amanatides87] */
typedef struct { uint32_t prim[64]; } Mailbox;

void mailbox_init(Mailbox *m);
INLINE bool mailbox_takes(Mailbox *m, uint32_t prim)
{
    bool first = m->prim[prim % 64] != prim;
    m->prim[prim % 64] = prim;
    return first;
}

bool list_ascends(const uint32_t *list, size_t n);
bool list_holds(const uint32_t *list, size_t n, uint32_t prim);

/* Whether the cells that hold p list the primitive. */
typedef bool Listed(const Accel *a, uint32_t prim, const double p[3]);

/* For validate(): all primitives are in the box, and of each, points in it are in cells that list
 * it. */
bool cells_validate(const Accel *a, Box box, Listed *listed, char *why, size_t room);

#endif
