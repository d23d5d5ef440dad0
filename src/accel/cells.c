/* cells.c -- cells of space with lists of the primitives in them. See cells.h. */
#include "accel/cells.h"

#include <string.h>

void mailbox_init(Mailbox *m) { memset(m, 0xFF, sizeof *m); }

bool list_ascends(const uint32_t *list, size_t n)
{
    for (size_t i = 1; i < n; i++)
        if (list[i] <= list[i - 1])
            return false;
    return true;
}

bool list_holds(const uint32_t *list, size_t n, uint32_t prim)
{
    while (n > 1) {
        size_t half = n / 2;
        list += list[half] <= prim ? half : 0;
        n -= half;
    }
    return n && *list == prim;
}

/* Points of a triangle, its corners among them: u, v in sixths. */
static bool check_triangle(const Accel *a, uint32_t prim, Listed *listed)
{
    V3 c[3];

    geometry_corners(a->geo, prim, c);
    for (int u = 0; u <= 6; u++)
        for (int v = 0; u + v <= 6; v++) {
            double p[3];
            for (int k = 0; k < 3; k++)
                p[k] = ((6 - u - v) * (double)v_axis(c[0], k) + u * (double)v_axis(c[1], k) +
                        v * (double)v_axis(c[2], k)) / 6;
            if (!listed(a, prim, p))
                return false;
        }
    return true;
}

static bool check_box(const Accel *a, uint32_t prim, Listed *listed)
{
    Box b = geometry_box(a->geo, prim);

    for (int corner = 0; corner < 8; corner++) {
        double p[3] = { corner & 1 ? b.lo.x : b.hi.x, corner & 2 ? b.lo.y : b.hi.y,
                        corner & 4 ? b.lo.z : b.hi.z };
        if (!listed(a, prim, p))
            return false;
    }
    return true;
}

bool cells_validate(const Accel *a, Box box, Listed *listed, char *why, size_t room)
{
    for (uint32_t i = 0; i < geometry_prims(a->geo); i++) {
        if (!box_holds(box, geometry_box(a->geo, i)))
            return accel_bad(why, room, "a primitive sticks out of the cells", i);
        if (geometry_is_tri(a->geo, i) ? !check_triangle(a, i, listed) : !check_box(a, i, listed))
            return accel_bad(why, room, "a cell does not list a primitive that is in it", i);
    }
    return true;
}
