/* light.c -- the list of lights and what they share. See light.h. */
#include "scene/light.h"

#include "sampling/warp.h"
#include "scene/scene.h"

#define LIGHTS(X)                                                              \
    X(point) X(spot) X(goniometric) X(projection)       /* at a point */       \
    X(distant)                          /* parallel */                         \
    X(diffuse)                          /* shapes that shine, area.c */        \
    X(infinite) X(sky)                  /* all round */
#define DECLARE(name) extern const LightKind light_##name;
#define ENTRY(name) &light_##name,
LIGHTS(DECLARE)
const LightKind *const lights[] = { LIGHTS(ENTRY) NULL };

#define ESTIMATE_MOST 1e30f     /* sums of many lights stay finite */

float delta_pdf_w(const Light *l, V3 from, V3 wi, const Surface *hit)
{
    (void)l;
    (void)from;
    (void)wi;
    (void)hit;
    return 0.0f;
}

Rgb delta_radiance(const Light *l, V3 wi, const Surface *hit)
{
    (void)l;
    (void)wi;
    (void)hit;
    return rgb_all(0.0f);
}

float light_estimate(const Light *l, V3 p, V3 n)
{
    LightSample s;

    if (l->kind->estimate)
        return f_min(l->kind->estimate(l, p, n), ESTIMATE_MOST);
    if (!l->kind->sample(l, p, (V2){ 0.5f, 0.5f }, &s))
        return 0.0f;
    return f_min(rgb_lum(s.L) * estimate_cosine(n, s.wi, 0.0f), ESTIMATE_MOST);
}

/* The cosine at its centre, with the sine of half the angle that it fills. A thousandth more than
 * the ball hides the roundings. */
float estimate_cosine(V3 n, V3 to, float radius)
{
    float d = v_len(to);

    if (v_len2(n) == 0.0f || d <= radius)
        return 1.0f;
    return estimate_above(v_dot(n, to) / d, radius / d + 1e-3f);
}

float power_factor(float wanted, Rgb own)
{
    float lum = rgb_lum(own);
    return wanted > 0.0f && lum > 0.0f ? wanted / lum : 1.0f;
}

bool frame_of_light(const Making *m, const char *what, Affine *to_world, Affine *to_light)
{
    double scale;

    if (!xf_is_similarity(&m->to_world, &scale))
        return err_at(m->at, "%s transform must be a rotation", what);
    *to_light = *to_world = xf_affine(&m->to_world);
    for (int i = 0; i < 3; i++)                         /* take the scale factor out */
        for (int j = 0; j < 3; j++) {
            to_world->m[i][j] = (float)(m->to_world.m[i][j] / scale);
            to_light->m[j][i] = to_world->m[i][j];
        }
    return true;
}

float sample_at_point(V3 p, V3 from, LightSample *s)
{
    V3 d = v_sub(p, from);
    float d2 = v_len2(d);

    if (!(d2 > 0.0f))
        return 0.0f;
    s->dist = sqrtf(d2);
    s->wi = v_scale(d, 1.0f / s->dist);
    s->pdf_w = 1.0f;
    s->p = p;
    s->err = s->n = v_all(0.0f);
    return d2;
}

void emit_from_point(V3 p, V3 d, Rgb I, float pdf_w, Emission *e)
{
    e->p = p;
    e->err = e->n = v_all(0.0f);
    e->d = d;
    e->L = I;
    e->cosine = e->pdf_a = 1.0f;
    e->pdf_w = pdf_w;
}

Stage stage_of(const Scene *s) { return (Stage){ s->centre, s->radius }; }

float stage_pdf_a(const Stage *s) { return 1.0f / (PI_F * s->radius * s->radius); }

/* The disc stands two radii before the centre, so that nothing is behind it by rounding. */
bool beyond_emit(const Light *l, V2 u, V2 v, Emission *e)
{
    const Stage *s = &((const Beyond *)l)->stage;
    V2 q = warp_disk_concentric(u);
    LightSample from;
    Frame f;

    if (!l->kind->sample(l, s->centre, v, &from))
        return false;
    e->d = v_neg(from.wi);
    f = frame_about(e->d);
    e->p = frame_out(&f, v3(q.x * s->radius, q.y * s->radius, -2.0f * s->radius));
    e->p = v_add(s->centre, e->p);
    e->err = e->n = v_all(0.0f);
    e->L = from.L;
    e->cosine = 1.0f;
    e->pdf_a = stage_pdf_a(s);
    e->pdf_w = from.pdf_w;
    return true;
}

void beyond_emit_pdf(const Light *l, const Surface *hit, V3 d, float *pdf_a, float *pdf_w)
{
    const Stage *s = &((const Beyond *)l)->stage;

    *pdf_a = stage_pdf_a(s);
    *pdf_w = l->kind->delta ? 1.0f : l->kind->pdf_w(l, s->centre, v_neg(d), hit);
}
