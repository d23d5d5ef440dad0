/* beam.c -- the code of `beam.h` */
#include "integrators/beam.h"

#include "integrators/event.h"

/* The beam of a pixel is as wide as the way from the eye is long. Past an event that spreads it,
 * textures are seen sharp, as `path` sees them. */
bool beam_meets(Beam *b, Surface *s, Tracer *t)
{
    V3 from = b->ray.o;

    if (!ray_meets(t, &b->ray, &b->medium, &b->throughput, s))
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
