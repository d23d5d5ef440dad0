/* line.c -- where a ray may be. See line.h. */
#include "accel/line.h"

double line_slack(Box b)
{
    double slack = 0;

    for (int k = 0; k < 3; k++) {
        double lo = v_axis(b.lo, k), hi = v_axis(b.hi, k);
        slack = d_max(slack, 0x1p-24 * (16 * (hi - lo) + 4 * d_max(fabs(lo), fabs(hi))));
    }
    return slack;
}

bool line_init(Line *l, const Ray *r, double slack)
{
    const float *o = &r->o.x, *d = &r->d.x;
    bool moves = false;

    l->slack = slack;
    for (int k = 0; k < 3; k++) {
        l->o[k] = o[k];
        l->d[k] = d[k];
        if (d[k] != 0.0f && !is_finite(1.0f / d[k]))
            return false;
        moves = moves || d[k] != 0.0f;
    }
    return moves && v_finite(r->o) && v_finite(r->d);
}
