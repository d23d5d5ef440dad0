/* ends.h -- what both halves of a bidirectional path must agree on: how likely lamps are asked and
 * send paths, and which vertices are merged. */
#ifndef INTEGRATORS_ENDS_H
#define INTEGRATORS_ENDS_H

#include "integrators/bidirectional.h"

/* The density with which the vertex asks the lamp for what comes along -wi: per solid angle, or 1
 * of a delta. there: the lamp's surface, if it has any. */
INLINE float asked_pdf(const Bidirectional *b, const Light *l, V3 p, V3 up, V3 wi,
                       const Surface *there)
{
    float pmf = b->asked->kind->pmf(b->asked, p, up, l);

    return l->kind->delta ? pmf : pmf * light_pdf_w(l, b->beside, p, wi, there);
}

/* The same per area of the lamp, where it has one. n: its normal. */
INLINE float per_area(const Light *l, float pdf, V3 n, V3 wi, float d2)
{
    return lamp_is_shape(l) ? pdf * v_absdot(n, wi) / d2 : pdf;
}

/* The density with which the lamp sends a path from there the way d, per area and solid angle. */
INLINE float sent_pdf(const Bidirectional *b, const Light *l, const Surface *there, V3 d)
{
    float a, w;

    l->kind->emit_pdf(l, there, d, &a, &w);
    return b->sending->kind->pmf(b->sending, v_all(0.0f), v_all(0.0f), l) * a * w;
}

/* Whether what is at the light path's vertex is merged. */
INLINE bool merges_light(const Bidirectional *b, int edges)
{
    return b->techniques.straight || edges > 1;
}

#endif
