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

uint32_t plane_get(const unsigned char *p, int bits)
{
    uint16_t q;

    if (bits == 8)
        return *p;
    memcpy(&q, p, 2);
    return q;
}

void plane_set(unsigned char *p, int bits, uint32_t q)
{
    uint16_t wide = (uint16_t)q;

    if (bits == 8)
        *p = (unsigned char)q;
    else
        memcpy(p, &wide, 2);
}

/* The steps are a little larger than the box needs, so that the last plane is outside for sure (eq.
 * 3.2 takes one from the range for that). */
bool fractions_init(Fractions *f, Box b, uint32_t range)
{
    for (int k = 0; k < 3; k++) {
        double extent = (double)v_axis(b.hi, k) - v_axis(b.lo, k);
        f->lo[k] = v_axis(b.lo, k);
        f->step[k] = (float)(extent / (range - 1));
        while (is_finite(f->lo[k]) && is_finite(f->step[k]) &&
               plane_at(f->lo[k], f->step[k], range) < v_axis(b.hi, k))
            f->step[k] = f_max(f->step[k] * 1.01f, 0x1p-120f);  /* no denormal number grows */
        if (!is_finite(plane_at(f->lo[k], f->step[k], range)))
            return false;
    }
    return true;
}

uint32_t plane_encode(const Fractions *f, int axis, float x, uint32_t range, bool upper)
{
    return upper ? planes_below(f->lo[axis], f->step[axis], x, range, false)
                 : planes_below(f->lo[axis], f->step[axis], x, range, true) - 1;
}
