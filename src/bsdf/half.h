/* half.h -- what models share that sample a half vector, the direction h half-way between two, and
 * reflect at it. Directions lie above the surface (z > 0).
 *
 * A density p of h gives p / (4 h.wo) of the direction that wo is reflected to. Half vectors are
 * kept in double, and not of unit length: near the mirrored direction of grazing light they are
 * what is left of two floats that all but cancel. */
#ifndef BSDF_HALF_H
#define BSDF_HALF_H

#include "base/maths.h"
#include "base/platform.h"
#include "base/vec.h"
#include "bsdf/bsdf.h"
#include "sampling/warp.h"

typedef struct {
    double x, y, z;             /* wo + wi, both made exactly unit */
    double length2;
    double cosine;              /* between either and h: half the length; never 0 */
} Half;

INLINE Half half_of(V3 wo, V3 wi)
{
    double a = unit_factor(wo), b = unit_factor(wi);
    Half h = { a * wo.x + b * wi.x, a * wo.y + b * wi.y, a * wo.z + b * wi.z, 0.0, 0.0 };

    h.length2 = h.x * h.x + h.y * h.y + h.z * h.z;
    h.cosine = d_max(0.5 * sqrt(h.length2), 1e-12);     /* two grazing ones may cancel altogether */
    return h;
}

/* wo reflected at the direction h, of any length. */
INLINE V3 half_reflect(V3 wo, double x, double y, double z)
{
    double k = 2.0 * (wo.x * x + wo.y * y + wo.z * z) / (x * x + y * y + z * z);
    return v_unit((V3){ (float)(k * x - wo.x), (float)(k * y - wo.y), (float)(k * z - wo.z) });
}

/* Of Schlick's approximation: (1 - c)^5. */
INLINE double schlick5(double c)
{
    double m = d_min(d_max(1.0 - c, 0.0), 1.0), m2 = m * m;
    return m2 * m2 * m;
}

/* A point of the unit circle, and one minus the square of the radius of a point on the disc: both
 * from one canonical pair, the second uniform on (0, 1). */
INLINE V2 circle_and(V2 u, double *rest)
{
    float r;
    V2 d = warp_disk_radius(u, &r);
    *rest = (1.0 - (double)r) * (1.0 + (double)r);
    return (V2){ d.x / r, d.y / r };
}

#endif
