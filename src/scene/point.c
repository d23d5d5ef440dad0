/* point.c -- the light `point`: radiant intensity I (W/sr) alike in all directions from one point.
 * Source: [Cline07 4.4.2], [PBRT4 12.2]. */
#include "scene/scene.h"

typedef struct {
    Light base;
    V3  p;
    Rgb I;
} Point;

static Light *make(const Making *m, const Opts *o)
{
    Point *l = arena_take(&m->scene->arena, 1, sizeof *l);
    float power = opt_float(o, "power"), lum;

    if (!l)
        return NULL;
    l->p = xf_point(&m->to_world, opt_point(o, "from"));
    l->I = rgb_mul(opt_rgb(o, "I"), opt_rgb(o, "scale"));
    lum = rgb_lum(l->I);
    if (power > 0.0f && lum > 0.0f)                     /* of the whole sphere of directions */
        l->I = rgb_scale(l->I, power / (4.0f * PI_F * lum));
    return &l->base;
}

static bool sample(const Light *base, V3 from, V2 u, LightSample *s)
{
    const Point *l = (const Point *)base;
    V3 d = v_sub(l->p, from);
    float d2 = v_len2(d);

    (void)u;
    if (!(d2 > 0.0f))
        return false;
    s->dist = sqrtf(d2);
    s->wi = v_scale(d, 1.0f / s->dist);
    s->L = rgb_scale(l->I, 1.0f / d2);
    s->pdf_w = 1.0f;
    s->p = l->p;
    s->err = s->n = v_all(0.0f);
    return true;
}

static Rgb power(const Light *l) { return rgb_scale(((const Point *)l)->I, 4.0f * PI_F); }

static const OptDef options[] = {
    { .key = "I", .type = OPT_RGB, .num = 1, .help = "radiant intensity, W/sr" },
    { .key = "scale", .type = OPT_RGB, .num = 1, .help = "factor of I" },
    { .key = "power", .type = OPT_FLOAT, .num = 0, .lo = 0, .hi = 1e30,
      .help = "W (by luminance); sets I if above 0" },
    { .key = "from", .type = OPT_POINT, .num = 0, .help = "position" },
    { .key = NULL }
};

const LightKind light_point = {
    .info = { "point", "PBRT4 12.2", "shines alike in all directions from one point", options },
    .delta = true, .make = make, .sample = sample, .pdf_w = delta_pdf_w,
    .radiance = delta_radiance, .power = power
};
