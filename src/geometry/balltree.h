/* balltree.h -- balls in space, in an octree: which of them hold a point?
 *
 * A ball stands in all cells that it comes near to, of the level whose cells are about its size: at
 * least as wide as it and, but at the root, less than twice that. So it is in at most eight, and a
 * question walks down one way. Outermost cells reach to infinity: there is no bound to keep.
 * Balls stand with their numbers, and several of a cell together: of a hundred that a question
 * passes, it looks no further at those that do not hold its point. */
#ifndef GEOMETRY_BALLTREE_H
#define GEOMETRY_BALLTREE_H

#include "base/vec.h"

enum { BALLS_TOGETHER = 6 };
typedef struct { float x, y, z, r2; uint32_t id; } Ball;
typedef struct { Ball ball[BALLS_TOGETHER]; uint32_t n, next; } Balls;  /* next 0: none */
typedef struct { uint32_t child[8]; uint32_t first; } BallCell;         /* 0: none */
typedef struct {
    V3    centre;
    float half;                 /* of the root's width */
    BallCell *cells;            /* owned; [0] is the root */
    Balls    *balls;            /* owned; [0] is none */
    size_t ncells, cap_cells, nballs, cap_balls;
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
    uint32_t cell, balls, at;
} BallWalk;

INLINE BallWalk balltree_ask(const BallTree *t, V3 p)
{
    return (BallWalk){ t, p, t->centre, t->half, 0, t->ncells ? t->cells[0].first : 0, 0 };
}

/* The part k of a cell, bit 0: upper half along x, and so on. */
INLINE V3 ball_centre(V3 centre, float half, int k)
{
    half *= 0.5f;
    return v3(centre.x + (k & 1 ? half : -half), centre.y + (k & 2 ? half : -half),
              centre.z + (k & 4 ? half : -half));
}

/* On to the cell below that has the point. False: there is none. */
INLINE bool balltree_down(BallWalk *w)
{
    int k = (w->p.x >= w->centre.x) | (w->p.y >= w->centre.y) << 1 | (w->p.z >= w->centre.z) << 2;

    w->cell = w->tree->cells[w->cell].child[k];
    if (!w->cell)
        return false;
    w->centre = ball_centre(w->centre, w->half, k);
    w->half *= 0.5f;
    w->balls = w->tree->cells[w->cell].first;
    return true;
}

INLINE bool balltree_next(BallWalk *w, uint32_t *id)
{
    if (!w->tree->ncells)
        return false;
    do {
        while (w->balls) {
            const Balls *some = &w->tree->balls[w->balls];
            while (w->at < some->n) {
                const Ball *b = &some->ball[w->at++];
                float x = b->x - w->p.x, y = b->y - w->p.y, z = b->z - w->p.z;
                *id = b->id;
                if (x * x + y * y + z * z <= b->r2)
                    return true;
            }
            w->balls = some->next;
            w->at = 0;
        }
    } while (balltree_down(w));
    return false;
}

#endif
