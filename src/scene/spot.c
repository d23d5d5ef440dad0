/* spot.c -- the light `spot`: a point light within a cone, full within an inner cone and falling
 * to 0 at the outer one by a cubic step in the cosine. Source: [PBRT4 12.2.1]. */
#include "sampling/warp.h"
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
    l->I = rgb_scale(l->I, power_factor(opt_float(o, "power"), rgb_scale(l->I, solid_angle(l))));
    return &l->base;
}

static bool sample(const Light *base, V3 from, V2 u, LightSample *s)
{
    const Spot *l = (const Spot *)base;
    float d2 = sample_at_point(l->p, from, s), f;

    (void)u;
    if (d2 == 0.0f)
        return false;
    f = falloff(l, -v_dot(s->wi, l->axis));
    if (f == 0.0f)
        return false;
    s->L = rgb_scale(l->I, f / d2);
    return true;
}

/* x in [0,1] with a density in proportion to the cubic step: the root of 2 x^3 - x^4 = u. Newton's
 * steps, from above the root where the curve bends upwards, do not leave [0,1]; six leave no error
 * that a float could show. */
static double step_inverse(double u)
{
    double x = md_pow(u, 1.0 / 3.0);            /* (2 - x) x^3 >= x^3: the root is not above */

    for (int i = 0; i < 6 && x > 0.0; i++)
        x -= (x * x * x * (2.0 - x) - u) / (2.0 * x * x * (3.0 - 2.0 * x));
    return x;
}

/* Directions in proportion to the intensity. The inner cone is uniform, so is the azimuth; between
 * the cones the cosine follows the step. */
static bool emit(const Light *base, V2 u, V2 v, Emission *e)
{
    const Spot *l = (const Spot *)base;
    float inner = 2.0f * PI_F * (1.0f - l->cos_inner) / solid_angle(l);
    Frame axis = frame_about(l->axis);
    float c, f;
    V3 d;

    (void)u;
    if (v.x < inner) {
        v.x = f_min(v.x / inner, ONE_MINUS_ULP);
        d = warp_cone(v, 1.0f - l->cos_inner);
    } else {
        float sine, cosine, x = (float)step_inverse((v.x - inner) / (1.0f - inner));
        m_sincos_turn(v.y, &sine, &cosine);
        c = l->cos_outer + x * (l->cos_inner - l->cos_outer);
        x = sqrtf(f_max(0.0f, (1.0f - c) * (1.0f + c)));
        d = v3(x * cosine, x * sine, c);
    }
    d = v_unit(frame_out(&axis, d));
    f = falloff(l, v_dot(d, l->axis));
    emit_from_point(l->p, d, rgb_scale(l->I, f), f / solid_angle(l), e);
    return f > 0.0f;
}

static void emit_pdf(const Light *base, const Surface *hit, V3 d, float *pdf_a, float *pdf_w)
{
    const Spot *l = (const Spot *)base;

    (void)hit;
    *pdf_a = 1.0f;
    *pdf_w = falloff(l, v_dot(d, l->axis)) / solid_angle(l);
}

static Rgb power(const Light *base)
{
    const Spot *l = (const Spot *)base;
    return rgb_scale(l->I, solid_angle(l));
}

static const OptDef options[] = {
    INTENSITY_OPTIONS("radiant intensity on the axis"),
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
    .delta = DELTA_PLACE, .make = make, .sample = sample, .pdf_w = delta_pdf_w,
    .radiance = delta_radiance, .emit = emit, .emit_pdf = emit_pdf, .power = power
};
