/* transform.h -- affine and projective maps with their inverses, in double, so that a deep stack
 * of transforms costs no digits that a float could show. */
#ifndef BASE_TRANSFORM_H
#define BASE_TRANSFORM_H

#include "base/vec.h"

typedef struct { double m[4][4], inv[4][4]; } Transform;        /* column vectors: p' = m p */

Transform xf_identity(void);
Transform xf_translate(double x, double y, double z);
Transform xf_scale(double x, double y, double z);
Transform xf_rotate(double degrees, double x, double y, double z);
/* World to camera, left-handed as in the scene language: camera looks along +z, x to the right.
 * False if the three vectors do not span a frame. */
bool      xf_look_at(Transform *t, V3 eye, V3 at, V3 up);
/* False if m cannot be inverted or is not finite. */
bool      xf_from(Transform *t, double m[4][4]);
Transform xf_then(const Transform *a, const Transform *b);      /* a after b: m = a.m b.m */
Transform xf_inverse(const Transform *t);

V3 xf_point(const Transform *t, V3 p);
V3 xf_vector(const Transform *t, V3 v);
V3 xf_normal(const Transform *t, V3 n);         /* by the inverse transpose; not made unit */
bool xf_swaps_hands(const Transform *t);        /* mirrors: determinant of the 3x3 part < 0 */
bool xf_is_identity(const Transform *t);
/* True if the map is a rotation, a mirror image, a translation and one scale factor (returned). */
bool xf_is_similarity(const Transform *t, double *scale);

/* The affine part in float, for rays: 12 numbers. */
typedef struct { float m[3][4]; } Affine;
Affine xf_affine(const Transform *t);
Affine xf_affine_inverse(const Transform *t);
INLINE V3 affine_point(const Affine *a, V3 p)
{
    const float (*m)[4] = a->m;
    return v3(m[0][0] * p.x + m[0][1] * p.y + m[0][2] * p.z + m[0][3],
              m[1][0] * p.x + m[1][1] * p.y + m[1][2] * p.z + m[1][3],
              m[2][0] * p.x + m[2][1] * p.y + m[2][2] * p.z + m[2][3]);
}
INLINE V3 affine_vector(const Affine *a, V3 v)
{
    const float (*m)[4] = a->m;
    return v3(m[0][0] * v.x + m[0][1] * v.y + m[0][2] * v.z,
              m[1][0] * v.x + m[1][1] * v.y + m[1][2] * v.z,
              m[2][0] * v.x + m[2][1] * v.y + m[2][2] * v.z);
}
/* n times the transpose of a: with the inverse map, how normals go. */
INLINE V3 affine_transposed(const Affine *a, V3 n)
{
    const float (*m)[4] = a->m;
    return v3(m[0][0] * n.x + m[1][0] * n.y + m[2][0] * n.z,
              m[0][1] * n.x + m[1][1] * n.y + m[2][1] * n.z,
              m[0][2] * n.x + m[1][2] * n.y + m[2][2] * n.z);
}
/* Box of a box's corners after the map, and the roundings of the map. */
Box affine_box(const Affine *m, Box b);

#endif
