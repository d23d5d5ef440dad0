/* area_emission.c -- light on its way from a shape that shines: a point uniform by area, a
 * direction in proportion to cos^(exponent + 1) [GIRT appendix B]. */
#include "sampling/warp.h"
#include "scene/area.h"

static float direction_pdf(const Area *l, float c)
{
    float pdf = l->exponent > 0.0f
                    ? (l->exponent + 2.0f) * 0.5f * INV_PI * m_pow(c, l->exponent + 1.0f)
                    : warp_cosine_pdf(c);
    return l->two_sided ? 0.5f * pdf : pdf;
}

/* About +z: cos^(exponent + 2) is uniform in u. */
static V3 direction_about(const Area *l, V2 u)
{
    float c, sine, sn, cs;

    if (!(l->exponent > 0.0f))
        return warp_cosine(u);
    c = m_pow(1.0f - u.x, 1.0f / (l->exponent + 2.0f));         /* u.x < 1: above 0 */
    sine = sqrtf(f_max(0.0f, (1.0f - c) * (1.0f + c)));
    m_sincos_turn(u.y, &sn, &cs);
    return v3(sine * cs, sine * sn, c);
}

bool area_emit(const Light *base, V2 u, V2 v, Emission *e)
{
    const Area *l = (const Area *)base;
    bool back = l->two_sided && v.x >= 0.5f;
    Frame f;
    AreaPoint at;

    if (!(l->area > 0.0f) || !area_point(l, u, &at))
        return false;
    if (l->two_sided)
        v.x = back ? 2.0f * v.x - 1.0f : 2.0f * v.x;
    e->p = at.p;
    e->err = at.err;
    e->uv = at.uv;
    e->n = back ? v_neg(at.n) : at.n;
    f = frame_about(e->n);
    e->d = v_unit(frame_out(&f, direction_about(l, v)));
    e->cosine = v_dot(e->n, e->d);
    if (!(e->cosine > 0.0f))
        return false;
    e->L = area_masked(l, &at, area_emitted(l, at.uv, e->cosine));
    e->pdf_a = 1.0f / l->area;
    e->pdf_w = direction_pdf(l, e->cosine);
    return e->pdf_w > 0.0f;
}

void area_emit_pdf(const Light *base, const Surface *hit, V3 d, float *pdf_a, float *pdf_w)
{
    const Area *l = (const Area *)base;
    float c = v_dot(hit->ng, d);

    if (l->two_sided)
        c = fabsf(c);
    *pdf_a = l->area > 0.0f ? 1.0f / l->area : 0.0f;
    *pdf_w = c > 0.0f ? direction_pdf(l, c) : 0.0f;
}
