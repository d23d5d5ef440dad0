/* spot.c -- the light `spot`: a point light within a cone, full within an inner cone and falling
 * to 0 at the outer one by a cubic step in the cosine. Source: [PBRT4 12.2.1]. */
#include "scene/scene.h"

typedef struct {
    Light base;
    V3    p, axis;              /* axis unit */
    Rgb   I;
    float cos_inner, cos_outer;
} Spot;

static float falloff(const Spot *l, float c)
{
    float x = clamp01((c - l->cos_outer) / (l->cos_inner - l->cos_outer));
    if (c >= l->cos_inner)
        return 1.0f;
    return c <= l->cos_outer ? 0.0f : x * x * (3.0f - 2.0f * x);
}

/* Integral of the falloff over directions: 2 pi ((1 - inner) + (inner - outer) / 2), since the
 * cubic step has mean 1/2. */
static float solid_angle(const Spot *l)
{
    return 2.0f * PI_F * ((1.0f - l->cos_inner) + 0.5f * (l->cos_inner - l->cos_outer));
}

static Light *make(const Making *m, const Opts *o)
{
    Spot *l = arena_take(&m->scene->arena, 1, sizeof *l);
    float cone = opt_float(o, "coneangle"), delta = opt_float(o, "conedeltaangle");
    float power = opt_float(o, "power"), lum;

    if (!l)
        return NULL;
    l->p = xf_point(&m->to_world, opt_point(o, "from"));
    l->axis = v_unit(v_sub(xf_point(&m->to_world, opt_point(o, "to")), l->p));
    if (v_len2(l->axis) == 0.0f) {
        err_at(m->at, "a spot light's \"from\" and \"to\" are one point, two were expected");
        return NULL;
    }
    l->I = rgb_mul(opt_rgb(o, "I"), opt_rgb(o, "scale"));
    l->cos_outer = (float)md_cos(cone * PI / 180);
    l->cos_inner = (float)md_cos((delta < cone ? cone - delta : 0.0) * PI / 180);
    lum = rgb_lum(l->I) * solid_angle(l);
    if (power > 0.0f && lum > 0.0f)
        l->I = rgb_scale(l->I, power / lum);
    return &l->base;
}

static bool sample(const Light *base, V3 from, V2 u, LightSample *s)
{
    const Spot *l = (const Spot *)base;
    V3 d = v_sub(l->p, from);
    float d2 = v_len2(d), f;

    (void)u;
    if (!(d2 > 0.0f))
        return false;
    s->dist = sqrtf(d2);
    s->wi = v_scale(d, 1.0f / s->dist);
    f = falloff(l, -v_dot(s->wi, l->axis));
    if (f == 0.0f)
        return false;
    s->L = rgb_scale(l->I, f / d2);
    s->pdf_w = 1.0f;
    s->p = l->p;
    s->err = s->n = v_all(0.0f);
    return true;
}

static Rgb power(const Light *base)
{
    const Spot *l = (const Spot *)base;
    return rgb_scale(l->I, solid_angle(l));
}

static const OptDef options[] = {
    { .key = "I", .type = OPT_RGB, .num = 1, .help = "radiant intensity on the axis, W/sr" },
    { .key = "scale", .type = OPT_RGB, .num = 1, .help = "factor of I" },
    { .key = "power", .type = OPT_FLOAT, .num = 0, .lo = 0, .hi = 1e30,
      .help = "W (by luminance); sets I if above 0" },
    { .key = "from", .type = OPT_POINT, .num = 0, .help = "position" },
    { .key = "to", .type = OPT_POINT, .str = "0 0 1", .help = "a point on the axis" },
    { .key = "coneangle", .type = OPT_FLOAT, .num = 30, .lo = 1e-3, .hi = 180,
      .help = "degrees from the axis at which the light ends" },
    { .key = "conedeltaangle", .type = OPT_FLOAT, .num = 5, .lo = 1e-4, .hi = 180,
      .also = "conedelta", .help = "degrees over which it falls off, within the cone" },
    { .key = NULL }
};

const LightKind light_spot = {
    .info = { "spot", "PBRT4 12.2.1", "a point light within a cone", options },
    .delta = true, .make = make, .sample = sample, .pdf_w = delta_pdf_w,
    .radiance = delta_radiance, .power = power
};
