/* point.c -- the light `point`: radiant intensity I (W/sr) alike in all directions from one point.
 * Source: [Cline07 4.4.2], [PBRT4 12.2]. */
#include "sampling/warp.h"
#include "scene/scene.h"

typedef struct {
    Light base;
    V3  p;
    Rgb I;
} Point;

static Light *make(const Making *m, const Opts *o)
{
    Point *l = arena_take(&m->scene->arena, 1, sizeof *l);
    float factor;

    if (!l)
        return NULL;
    l->p = xf_point(&m->to_world, opt_point(o, "from"));
    l->I = rgb_mul(opt_rgb(o, "I"), opt_rgb(o, "scale"));
    factor = power_factor(opt_float(o, "power"), rgb_scale(l->I, 4.0f * PI_F));
    l->I = rgb_scale(l->I, factor);
    return &l->base;
}

static bool sample(const Light *base, V3 from, V2 u, LightSample *s)
{
    const Point *l = (const Point *)base;
    float d2 = sample_at_point(l->p, from, s);

    (void)u;
    if (d2 == 0.0f)
        return false;
    s->L = rgb_scale(l->I, 1.0f / d2);
    return true;
}

static bool emit(const Light *base, V2 u, V2 v, Emission *e)
{
    const Point *l = (const Point *)base;

    (void)u;
    emit_from_point(l->p, warp_sphere(v), l->I, warp_sphere_pdf(), e);
    return true;
}

static void emit_pdf(const Light *l, const Surface *hit, V3 d, float *pdf_a, float *pdf_w)
{
    (void)l;
    (void)hit;
    (void)d;
    *pdf_a = 1.0f;
    *pdf_w = warp_sphere_pdf();
}

static Rgb power(const Light *l) { return rgb_scale(((const Point *)l)->I, 4.0f * PI_F); }

static const OptDef options[] = {
    INTENSITY_OPTIONS("radiant intensity"),
    { .key = "from", .type = OPT_POINT, .num = 0, .help = "position" },
    { .key = NULL }
};

const LightKind light_point = {
    .info = { "point", "PBRT4 12.2", "shines alike in all directions from one point", options },
    .delta = DELTA_PLACE, .make = make, .sample = sample, .pdf_w = delta_pdf_w,
    .radiance = delta_radiance, .emit = emit, .emit_pdf = emit_pdf, .power = power
};
