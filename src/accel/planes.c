/* planes.c -- planes of boxes to small whole numbers and back. See planes.h. */
#include "accel/planes.h"

#include <string.h>

uint32_t planes_below(float base, float step, float x, uint32_t range, bool equal)
{
    double guess = ((double)x - base) / step;
    uint32_t lo = 0, hi = range + 1;

    if (guess >= 0 && guess < range) {          /* most are found at once; the rest by halving */
        uint32_t q = (uint32_t)guess;
        if (plane_at(base, step, q) < x && x < plane_at(base, step, q + 1))
            return q + 1;
    }
    while (lo < hi) {
        uint32_t mid = (lo + hi) / 2;
        float plane = plane_at(base, step, mid);
        if (plane < x || (equal && plane == x))
            lo = mid + 1;
        else
            hi = mid;
    }
    return lo;
}

/* ---- fractions of a box ---- */

/* The steps are a little larger than the box needs, so that the last plane is outside for sure: for
 * that (3.2) takes one from the range. */
bool fractions_init(Fractions *f, Box b, uint32_t range)
{
    for (int k = 0; k < 3; k++) {
        double extent = (double)v_axis(b.hi, k) - v_axis(b.lo, k);
        f->lo[k] = v_axis(b.lo, k);                     /* [Cline07 (3.1)], signs turned */
        f->step[k] = (float)(extent / (range - 1));     /* [Cline07 (3.2)], inverse */
        while (is_finite(f->lo[k]) && is_finite(f->step[k]) &&
               plane_at(f->lo[k], f->step[k], range) < v_axis(b.hi, k))
            f->step[k] = f_max(f->step[k] * 1.01f, 0x1p-120f);  /* no denormal number grows */
        if (!is_finite(plane_at(f->lo[k], f->step[k], range)))
            return false;
    }
    return true;
}

Box fractions_box(const Fractions *f, uint32_t range)
{
    float hi[3];

    for (int k = 0; k < 3; k++)
        hi[k] = plane_at(f->lo[k], f->step[k], range);
    return (Box){ v3(f->lo[0], f->lo[1], f->lo[2]), v3(hi[0], hi[1], hi[2]) };
}

/* The largest plane not above x, or (upper) the least not below it; for x within the box. */
static uint32_t encode(const Fractions *f, int axis, float x, uint32_t range, bool upper)
{
    return upper ? planes_below(f->lo[axis], f->step[axis], x, range, false)
                 : planes_below(f->lo[axis], f->step[axis], x, range, true) - 1;
}

/* ---- siblings ---- */

static unsigned char *place_of(Sibling s, int side, int axis)
{
    return s.planes + ((size_t)(3 * side + axis) * s.n + s.k) * ((size_t)s.bits / 8);
}

uint32_t sibling_plane(Sibling s, int side, int axis)
{
    uint16_t q;

    if (s.bits == 8)
        return *place_of(s, side, axis);
    memcpy(&q, place_of(s, side, axis), 2);
    return q;
}

void sibling_plane_set(Sibling s, int side, int axis, uint32_t q)
{
    uint16_t wide = (uint16_t)q;

    if (s.bits == 8)
        *place_of(s, side, axis) = (unsigned char)q;
    else
        memcpy(place_of(s, side, axis), &wide, 2);
}

void sibling_encode(Sibling s, const Fractions *f, Box b)
{
    uint32_t range = planes_range(s.bits);
    bool none = box_is_empty(b);

    for (int k = 0; k < 3; k++) {
        sibling_plane_set(s, 0, k, none ? range : encode(f, k, v_axis(b.lo, k), range, false));
        sibling_plane_set(s, 1, k, none ? 0 : encode(f, k, v_axis(b.hi, k), range, true));
    }
}

/* What is rounded outwards stays in order. */
void sibling_join(Sibling s, Sibling child)
{
    for (int axis = 0; axis < 3; axis++) {
        uint32_t lo = planes_range(s.bits), hi = 0;
        for (child.k = 0; child.k < child.n; child.k++) {
            uint32_t a = sibling_plane(child, 0, axis), b = sibling_plane(child, 1, axis);
            lo = a < lo ? a : lo;
            hi = b > hi ? b : hi;
        }
        sibling_plane_set(s, 0, axis, lo);
        sibling_plane_set(s, 1, axis, hi);
    }
}

Box sibling_box(Sibling s, const Fractions *f)
{
    float p[2][3];

    for (int side = 0; side < 2; side++)
        for (int axis = 0; axis < 3; axis++)
            p[side][axis] = plane_at(f->lo[axis], f->step[axis], sibling_plane(s, side, axis));
    return (Box){ v3(p[0][0], p[0][1], p[0][2]), v3(p[1][0], p[1][1], p[1][2]) };
}
