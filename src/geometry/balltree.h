/* balltree.h -- balls in space, in an octree: which of them hold a point?
 *
 * A ball stands in all cells that it comes near to, of the level whose cells are about its size: at
 * least as wide as it and, but at the root, less than twice that. So it is in at most eight, and a
 * question walks down one way. Outermost cells reach to infinity: there is no bound to keep.
 * Whoever asks gets some more than hold the point, and looks himself. */
#ifndef GEOMETRY_BALLTREE_H
#define GEOMETRY_BALLTREE_H

#include "base/vec.h"

typedef struct { uint32_t child[8]; uint32_t first; } BallCell;         /* 0: none */
typedef struct { uint32_t next, id; } BallEntry;
typedef struct {
    V3    centre;
    float half;                 /* of the root's width */
    BallCell  *cells;           /* owned; [0] is the root */
    BallEntry *entries;         /* owned; [0] is none */
    size_t ncells, cap_cells, nentries, cap_entries;
} BallTree;

/* For balls around places of this box, roughly. False: memory, reported. */
bool balltree_init(BallTree *t, Box around);
void balltree_clear(BallTree *t);
bool balltree_add(BallTree *t, V3 p, float radius, uint32_t id);        /* radius > 0 */

/* The question: balltree_next gives the ids one by one, in an order that follows from that of
 * adding them. */
typedef struct {
    const BallTree *tree;       /* borrowed */
    V3    p, centre;            /* of the cell */
    float half;
    uint32_t cell, entry;
} BallWalk;

INLINE BallWalk balltree_ask(const BallTree *t, V3 p)
{
    return (BallWalk){ t, p, t->centre, t->half, 0, t->ncells ? t->cells[0].first : 0 };
}

/* The part k of a cell, bit 0: upper half along x, and so on. */
INLINE V3 ball_centre(V3 centre, float half, int k)
{
    half *= 0.5f;
    return v3(centre.x + (k & 1 ? half : -half), centre.y + (k & 2 ? half : -half),
              centre.z + (k & 4 ? half : -half));
}

INLINE bool balltree_next(BallWalk *w, uint32_t *id)
{
    if (!w->tree->ncells)
        return false;
    while (!w->entry) {
        int k = (w->p.x >= w->centre.x) | (w->p.y >= w->centre.y) << 1 |
                (w->p.z >= w->centre.z) << 2;
        w->cell = w->tree->cells[w->cell].child[k];
        if (!w->cell)
            return false;
        w->centre = ball_centre(w->centre, w->half, k);
        w->half *= 0.5f;
        w->entry = w->tree->cells[w->cell].first;
    }
    *id = w->tree->entries[w->entry].id;
    w->entry = w->tree->entries[w->entry].next;
    return true;
}

#endif
