/* lamp.c -- a light at a point whose intensity is a picture of directions. See lamp.h. */
#include "scene/lamp.h"

Lamp *lamp_make(const Making *m, const Opts *o, const char *what, const Image **image)
{
    Lamp *l = arena_take(&m->scene->arena, 1, sizeof *l);
    const char *name = opt_string(o, "filename");

    *image = NULL;
    if (!l || !frame_of_light(m, what, &l->to_world, &l->to_lamp))
        return NULL;
    l->p = xf_point(&m->to_world, v_all(0.0f));
    l->I = rgb_mul(opt_rgb(o, "I"), opt_rgb(o, "scale"));
    if (name[0] && !(*image = scene_image(m->scene, m, name)))
        return NULL;
    return l;
}

Light *lamp_finish(Lamp *l, const Opts *o, const Image *image, Mapping mapping)
{
    if (!panorama_init(&l->picture, image, mapping))
        return NULL;
    l->I = rgb_scale(l->I, power_factor(opt_float(o, "power"), lamp_power(&l->base)));
    return &l->base;
}

void lamp_clear(Light *base) { panorama_clear(&((Lamp *)base)->picture); }

bool lamp_sample(const Light *base, V3 from, V2 u, LightSample *s)
{
    const Lamp *l = (const Lamp *)base;
    float d2 = sample_at_point(l->p, from, s);
    Rgb value;

    (void)u;
    if (d2 == 0.0f)
        return false;
    value = panorama_at(&l->picture, affine_vector(&l->to_lamp, v_neg(s->wi)));
    s->L = rgb_scale(rgb_mul(l->I, value), 1.0f / d2);
    return !rgb_black(value);
}

bool lamp_emit(const Light *base, V2 u, V2 v, Emission *e)
{
    const Lamp *l = (const Lamp *)base;
    float pdf;
    Rgb value;
    V3 d;

    (void)u;
    if (!panorama_sample(&l->picture, v, &d, &pdf, &value))
        return false;
    d = v_unit(affine_vector(&l->to_world, d));
    emit_from_point(l->p, d, rgb_mul(l->I, value), pdf, e);
    return true;
}

void lamp_emit_pdf(const Light *base, const Surface *hit, V3 d, float *pdf_a, float *pdf_w)
{
    const Lamp *l = (const Lamp *)base;

    (void)hit;
    *pdf_a = 1.0f;
    *pdf_w = panorama_pdf_w(&l->picture, affine_vector(&l->to_lamp, d));
}

Rgb lamp_power(const Light *base)
{
    const Lamp *l = (const Lamp *)base;
    return rgb_scale(rgb_mul(l->I, l->picture.mean),
                     (float)mapping_solid_angle(&l->picture.mapping));
}
