/* distant.c -- the light `distant`: parallel rays from infinitely far, with L the irradiance on a
 * surface that faces them. Source: [PBRT4 12.3]. */
#include "scene/scene.h"

typedef struct {
    Beyond beyond;
    V3    to_light;             /* unit */
    Rgb   E;                    /* irradiance on a facing surface */
} Distant;

static Light *make(const Making *m, const Opts *o)
{
    Distant *l = arena_take(&m->scene->arena, 1, sizeof *l);
    V3 d = v_sub(opt_point(o, "from"), opt_point(o, "to"));

    if (!l)
        return NULL;
    l->to_light = v_unit(xf_vector(&m->to_world, d));
    if (v_len2(l->to_light) == 0.0f) {
        err_at(m->at, "a distant light's \"from\" and \"to\" are one point, two were expected");
        return NULL;
    }
    l->E = rgb_mul(opt_rgb(o, "L"), opt_rgb(o, "scale"));
    l->E = rgb_scale(l->E, power_factor(opt_float(o, "illuminance"), l->E));
    return &l->beyond.base;
}

static bool prepare(Light *base, const Scene *s)
{
    ((Beyond *)base)->stage = stage_of(s);
    return true;
}

static bool sample(const Light *base, V3 from, V2 u, LightSample *s)
{
    const Distant *l = (const Distant *)base;
    (void)from;
    (void)u;
    sample_beyond(s);
    s->wi = l->to_light;
    s->L = l->E;
    s->pdf_w = 1.0f;
    return true;
}

/* What passes through the disc that the scene's sphere shows. */
static Rgb power(const Light *base)
{
    const Distant *l = (const Distant *)base;
    float radius = l->beyond.stage.radius;
    return rgb_scale(l->E, PI_F * radius * radius);
}

static const OptDef options[] = {
    { .key = "L", .type = OPT_RGB, .num = 1, .help = "irradiance on a facing surface, W/m^2" },
    { .key = "scale", .type = OPT_RGB, .num = 1, .help = "factor of L" },
    { .key = "illuminance", .type = OPT_FLOAT, .num = 0, .lo = 0, .hi = 1e30,
      .help = "luminance of the irradiance; sets L if above 0" },
    { .key = "from", .type = OPT_POINT, .num = 0, .help = "light travels from here" },
    { .key = "to", .type = OPT_POINT, .str = "0 0 1", .help = "to here" },
    { .key = NULL }
};

const LightKind light_distant = {
    .info = { "distant", "PBRT4 12.3", "parallel rays from infinitely far", options },
    .delta = DELTA_DIRECTION, .make = make, .prepare = prepare, .sample = sample,
    .pdf_w = delta_pdf_w, .radiance = delta_radiance, .emit = beyond_emit,
    .emit_pdf = beyond_emit_pdf, .power = power
};
