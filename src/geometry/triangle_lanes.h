/* triangle_lanes.h -- triangles against a ray, side by side in lanes. triangle.h includes it twice,
 * with LANES 4 and 8, and it makes triangles4_... and triangles8_... of what is below.
 *
 * Truth       The arithmetic of each lane is that of triangle_nearest. What is passed over here is
 *             what triangle_accept would refuse, so hits do not depend on who is asked. */
#if LANES == 4
#define FLOATS F4
#define DO(name) f4_##name
#define OURS(name) triangles4_##name
#else
#define FLOATS F8
#define DO(name) f8_##name
#define OURS(name) triangles8_##name
#endif

/* The corners as the ray sees them: in that order. */
typedef struct { FLOATS x[3], y[3], z[3]; } OURS(View);

/* Corners as they are, but for the origin and the order of axes, are sheared. */
INLINE void OURS(shear)(OURS(View) *v, const Probe *r)
{
    FLOATS sx = DO(all)(r->sx), sy = DO(all)(r->sy);

    for (int k = 0; k < 3; k++) {
        v->x[k] = DO(sub)(v->x[k], DO(mul)(sx, v->z[k]));
        v->y[k] = DO(sub)(v->y[k], DO(mul)(sy, v->z[k]));
    }
}

INLINE FLOATS OURS(size)(const FLOATS a[3])
{
    return DO(add)(DO(abs)(a[0]), DO(add)(DO(abs)(a[1]), DO(abs)(a[2])));
}

/* Bit k: if all edge functions of triangle k have the same sign for sure, it is met behind the
 * origin. Where a ray leaves a surface, that of its origin is such a one.
 *
 * t has the sign of the mean of the depths, with the edge functions' magnitudes as weights. With X,
 * Y, Z the sums of the three |x|, |y|, |z|, roundings of the weights come to 4 u X Y Z in the mean,
 * those of products and sums to 3 u X Y Z (u: one rounding), and what falls below the range of
 * floats is less than `tiny` of Z and of 1. Where X Y Z is beyond that range nothing is certain:
 * the bound is infinite. */
INLINE int OURS(behind)(const OURS(View) *v, const FLOATS weight[3], const FLOATS depth[3])
{
    FLOATS tiny = DO(all)(0x1p-126f), err, mean;

    err = DO(add)(DO(mul)(OURS(size)(v->x), OURS(size)(v->y)), tiny);
    err = DO(mul)(DO(mul)(err, OURS(size)(depth)), DO(all)(ROUNDINGS(16)));
    mean = DO(add)(DO(add)(DO(mul)(weight[0], depth[0]), DO(mul)(weight[1], depth[1])),
                   DO(mul)(weight[2], depth[2]));
    return DO(less)(DO(add)(mean, DO(add)(err, tiny)), DO(all)(0.0f));
}

/* Bit k: triangle k of the first n has to be looked at more closely. Out are those that the ray
 * passes for sure, and those that are behind the origin. always: the latter are looked for without
 * asking whether any corner is there, which is best where that cannot be foretold. */
INLINE int OURS(test)(const OURS(View) *v, int n, float sz, bool always)
{
    const FLOATS *x = v->x, *y = v->y, *z = v->z;
    FLOATS forward = DO(all)(sz < 0.0f ? -1.0f : 1.0f), zero = DO(all)(0.0f);
    FLOATS e[3], weight[3], depth[3], least, most, first, last;
    int out, certain, lanes = (1 << n) - 1;

    e[0] = DO(sub)(DO(mul)(x[2], y[1]), DO(mul)(y[2], x[1]));
    e[1] = DO(sub)(DO(mul)(x[0], y[2]), DO(mul)(y[0], x[2]));
    e[2] = DO(sub)(DO(mul)(x[1], y[0]), DO(mul)(y[1], x[0]));
    least = DO(min)(e[0], DO(min)(e[1], e[2]));
    most = DO(max)(e[0], DO(max)(e[1], e[2]));
    for (int k = 0; k < 3; k++) {
        weight[k] = DO(abs)(e[k]);
        depth[k] = DO(mul)(z[k], forward);
    }
    first = DO(min)(depth[0], DO(min)(depth[1], depth[2]));
    last = DO(max)(depth[0], DO(max)(depth[1], depth[2]));
    certain = DO(less)(zero, DO(min)(weight[0], DO(min)(weight[1], weight[2])));
    out = (DO(less)(least, zero) & DO(less)(zero, most) & certain) | DO(at_most)(last, zero);
    if (always || DO(at_most)(first, zero) & lanes)
        out |= certain & OURS(behind)(v, weight, depth);
    return ~out & lanes;
}

#undef FLOATS
#undef DO
#undef OURS
#undef LANES
