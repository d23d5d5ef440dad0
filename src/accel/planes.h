/* planes.h -- planes of boxes in small whole numbers, and a ray against siblings made of such.
 *
 * Source      [Cline07 3.3.1], eqs 3.1 and 3.2.
 * Planes      Plane q is base + q step. For planes that are fractions of one box these are the
 *             box's; nested ones have them made anew for each node, see hlbvh.c.
 * Rounding    Outwards, so that the box as decoded, in float, holds what it was made for. Rays stay
 *             in world space and meet decoded planes; with [Cline07]'s ray in the space of the
 *             fractions its roundings would need bounds. */
#ifndef ACCEL_PLANES_H
#define ACCEL_PLANES_H

#include "base/simd.h"
#include "geometry/ray.h"

/* The largest whole number that a plane of 8 or 16 bits may be. */
INLINE uint32_t planes_range(int bits) { return bits == 8 ? 255 : 65535; }

/* The value of plane q, for the builders; queries do the same in lanes. It rises with q, in floats
 * too. */
INLINE float plane_at(float base, float step, uint32_t q) { return base + (float)q * step; }

/* How many of the planes 0 .. range are below x or, if so wanted, equal to it. */
uint32_t planes_below(float base, float step, float x, uint32_t range, bool equal);

/* ---- fractions of a box ---- */

/* Plane q of axis k is lo[k] + q step[k]. */
typedef struct { float lo[3], step[3]; } Fractions;

/* Planes 0 .. range across b: the first is not above it, the last not below. False: a box without
 * an end, or so large that floats have no last plane; it cannot be divided. */
bool fractions_init(Fractions *f, Box b, uint32_t range);

/* From plane 0 to plane `range`. */
Box fractions_box(const Fractions *f, uint32_t range);

/* ---- siblings ----
 *
 * Boxes side by side, planes of 8 or 16 bits. Those of one side (0: lower) and axis stand together,
 * of all n children in a row: plane (side, axis) of child k is number (3 side + axis) n + k. */

enum { SIBLINGS_MOST = 8, SIBLINGS_PAD = 32 };  /* PAD: eight are read where there may be fewer */

/* The bytes of n siblings. */
INLINE size_t siblings_bytes(uint32_t n, int bits) { return n * (size_t)6 * ((size_t)bits / 8); }

/* Child k of n siblings, whose planes begin at `planes`. */
typedef struct { unsigned char *planes; uint32_t n, k; int bits; } Sibling;

uint32_t sibling_plane(Sibling s, int side, int axis);
void     sibling_plane_set(Sibling s, int side, int axis, uint32_t q);

/* By planes that are fractions of a box: makes the child's hold b, which lies within that. An empty
 * b gets planes that no ray is between. */
void sibling_encode(Sibling s, const Fractions *f, Box b);
/* Makes them hold those of its own children, of which `child` is one. */
void sibling_join(Sibling s, Sibling child);
Box  sibling_box(Sibling s, const Fractions *f);

/* ---- a ray against siblings, one lane each ---- */

/* Sides: 0 is the one that the ray meets first, 1 the other. */
typedef struct {
    F8 o[3], inv[3];
    F8 base[2][3], step[2][3];
    size_t row[2][3];                   /* where in a group of siblings the planes are, in bytes */
} Siblings;

/* Decoded planes of siblings, by side and axis. */
typedef union { float plane[2][3][SIBLINGS_MOST]; F8 align; } Decoded;

INLINE void siblings_init(Siblings *s, const Fractions *f, uint32_t n, int bits, const Probe *p)
{
    const float *o = &p->ray->o.x, *inv = &p->inv.x;
    size_t row = siblings_bytes(n, bits) / 6;

    for (int k = 0; k < 3; k++) {
        int down = inv[k] < 0.0f;
        s->o[k] = f8_all(o[k]);
        s->inv[k] = f8_all(inv[k]);
        for (int side = 0; side < 2; side++) {
            s->row[side][k] = (size_t)(3 * (side ^ down) + k) * row;
            s->base[side][k] = f8_all(f->lo[k]);
            s->step[side][k] = f8_all(f->step[k]);
        }
    }
}

/* Eight planes decoded, of which those of the siblings are of use. */
INLINE F8 planes_load(const Siblings *s, const unsigned char *group, int side, int axis, int bits)
{
    const unsigned char *p = group + s->row[side][axis];
    F8 whole = bits == 8 ? f8_load_u8(p) : f8_load_u16((const uint16_t *)(const void *)p);
    return f8_add(s->base[side][axis], f8_mul(whole, s->step[side][axis]));
}

/* Bit k: the ray enters child k of n before it leaves it and not beyond tmax; near[k] says where.
 * The arithmetic on decoded planes is that of slabs() in geometry/ray.h. `keep` gets them; or
 * NULL. */
INLINE int siblings_enter(const Siblings *s, const unsigned char *group, uint32_t n, int bits,
                          float tmax, float near[SIBLINGS_MOST], Decoded *keep)
{
    F8 enter = f8_all(0.0f), leave = f8_all(INFINITY);

    for (int k = 0; k < 3; k++) {
        F8 a = planes_load(s, group, 0, k, bits), b = planes_load(s, group, 1, k, bits);
        enter = f8_max(f8_mul(f8_sub(a, s->o[k]), s->inv[k]), enter);
        leave = f8_min(f8_mul(f8_sub(b, s->o[k]), s->inv[k]), leave);
        if (keep) {
            f8_store(keep->plane[0][k], a);
            f8_store(keep->plane[1][k], b);
        }
    }
    f8_store(near, enter);
    return f8_at_most(enter, f8_mul(leave, f8_all(SLAB_WIDEN))) &
           f8_at_most(enter, f8_all(tmax)) & ((1 << n) - 1);
}

#endif
