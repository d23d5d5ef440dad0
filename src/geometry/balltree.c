/* balltree.c -- the code of `balltree.h` */
#include "geometry/balltree.h"

#include "base/mem.h"

enum { DEPTH_MOST = 24 };       /* cells of floats are not halved much more often */

bool balltree_init(BallTree *t, Box around)
{
    BallCell root = { { 0 }, 0 };
    Balls none = { .n = 0 };
    V3 size = v_sub(around.hi, around.lo);

    memset(t, 0, sizeof *t);
    t->centre = box_centre(around);
    t->half = 0.5f * v_max3(size);
    if (MEM_PUSH(t->cells, t->ncells, t->cap_cells, root) &&
        MEM_PUSH(t->balls, t->nballs, t->cap_balls, none))
        return true;
    balltree_clear(t);
    return false;
}

void balltree_clear(BallTree *t)
{
    mem_free(t->cells);
    mem_free(t->balls);
    memset(t, 0, sizeof *t);
}

static bool enter(BallTree *t, uint32_t cell, const Ball *b)
{
    uint32_t first = t->cells[cell].first;

    if (!first || t->balls[first].n == BALLS_TOGETHER) {
        Balls some = { .n = 0, .next = first };
        if (!MEM_PUSH(t->balls, t->nballs, t->cap_balls, some))
            return false;
        first = t->cells[cell].first = (uint32_t)(t->nballs - 1);
    }
    t->balls[first].ball[t->balls[first].n++] = *b;
    return true;
}

static uint32_t child_of(BallTree *t, uint32_t cell, int k)
{
    BallCell none = { { 0 }, 0 };

    if (!t->cells[cell].child[k] && MEM_PUSH(t->cells, t->ncells, t->cap_cells, none))
        t->cells[cell].child[k] = (uint32_t)(t->ncells - 1);
    return t->cells[cell].child[k];
}

/* Whether the ball's box comes to the side `upper` of a plane across an axis. */
static bool comes_to(float p, float radius, float plane, bool upper)
{
    return upper ? p + radius >= plane : p - radius < plane;
}

static bool add_below(BallTree *t, uint32_t cell, V3 centre, float half, const Ball *b,
                      float radius, int depth)
{
    if (depth == DEPTH_MOST || half < 2.0f * radius)    /* halves would be narrower than the ball */
        return enter(t, cell, b);
    for (int k = 0; k < 8; k++) {
        uint32_t child;
        if (!comes_to(b->x, radius, centre.x, k & 1) || !comes_to(b->y, radius, centre.y, k & 2) ||
            !comes_to(b->z, radius, centre.z, k & 4))
            continue;
        child = child_of(t, cell, k);
        if (!child || !add_below(t, child, ball_centre(centre, half, k), 0.5f * half, b, radius,
                                 depth + 1))
            return false;
    }
    return true;
}

bool balltree_add(BallTree *t, V3 p, float radius, uint32_t id)
{
    Ball b = { p.x, p.y, p.z, radius * radius, id };

    return add_below(t, 0, t->centre, t->half, &b, radius, 0);
}
