/* beam.c -- the code of `beam.h` */
#include "integrators/beam.h"

enum { BORDERS_MOST = 65536 };          /* of media, to the next surface; a beam beyond is lost */

static bool meets_past_borders(Beam *b, Surface *s, Tracer *t)
{
    const Scene *scene = t->scene;

    for (int n = 0; n < BORDERS_MOST; n++) {
        Hit h;
        Met met = scene_meets(scene, &b->ray, true, &h, s);
        t->rays++;
        if (b->medium != NO_MEDIUM)
            b->throughput = rgb_mul(b->throughput,
                                    medium_transmittance(&scene->media[b->medium], h.t));
        if (rgb_black(b->throughput))
            return false;
        if (met != MET_BORDER)
            return met == MET_SURFACE;
        b->medium = medium_beyond(s, b->ray.d, b->medium);
        b->ray.o = ray_origin(s->p, s->err, s->ng, b->ray.d);
    }
    b->throughput = rgb_all(0.0f);
    return false;
}

/* The beam of a pixel is as wide as the way from the eye is long. Past an event that spreads it,
 * textures are seen sharp, as `path` sees them. */
bool beam_meets(Beam *b, Surface *s, Tracer *t)
{
    V3 from = b->ray.o;
    Hit h;

    if (UNLIKELY(t->scene->nmedia)) {
        if (!meets_past_borders(b, s, t))
            return false;
    } else if (tracer_nearest(t, &b->ray, &h))
        accel_surface(t->scene->accel, &b->ray, &h, s);
    else
        return false;
    if (b->way >= 0.0f) {
        b->way += v_len(v_sub(s->p, from));
        s->width = b->way * t->spread;
    }
    return true;
}

void beam_turn(Beam *b, const Vertex *v, const BsdfSample *s)
{
    b->ray = vertex_ray(v, s->wi);
    b->throughput = rgb_mul(b->throughput, s->weight);
    b->eta2 *= s->eta * s->eta;
    if (s->flags & BSDF_SMOOTH)
        b->way = -1.0f;
    b->depth++;
    b->medium = medium_beyond(&v->s, s->wi, b->medium);
}
