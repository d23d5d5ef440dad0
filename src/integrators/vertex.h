/* vertex.h -- a point of a surface at which a path turns: the surface, its model and the direction
 * from which the point is seen, ready to be asked about others.
 *
 * Directions are of the world unless a name says `local`. Those that the shading normal allows and
 * the geometric one does not, or the other way round, are black: light would pass through. */
#ifndef INTEGRATORS_VERTEX_H
#define INTEGRATORS_VERTEX_H

#include "integrators/integrator.h"

typedef struct {
    Surface  s;
    const Bsdf *b;              /* in room */
    Frame    frame;
    V3       wo;                /* local, unit, back along the ray that found the point */
    BsdfRoom room;
} Vertex;

/* Of a point met by a ray of direction d, unit: all but s, which is there. */
INLINE void vertex_make(Vertex *v, const Scene *scene, V3 d)
{
    const Material *m = &scene->materials[v->s.shape->material];

    v->b = material_bsdf(m, &v->s, &v->room);
    v->frame = material_frame(m, &v->s);
    v->wo = frame_in(&v->frame, v_neg(d));
}

/* What the ray meets, as a vertex. False: nothing. */
INLINE bool vertex_meet(Vertex *v, const Ray *r, Tracer *t)
{
    Hit h;

    if (!tracer_nearest(t, r, &h))
        return false;
    accel_surface(t->scene->accel, r, &h, &v->s);
    vertex_make(v, t->scene, r->d);
    return true;
}

/* Not a delta as a whole: eval and pdf_w of the model mean something. */
INLINE bool vertex_is_smooth(const Vertex *v) { return (v->b->flags & BSDF_SMOOTH) != 0; }

/* The direction as the model takes it. False: light from there would pass through the surface. */
INLINE bool vertex_local(const Vertex *v, V3 wi, V3 *local)
{
    *local = frame_in(&v->frame, wi);
    return v_dot(wi, v->s.ng) * local->z > 0.0f;
}

/* f |cos|, and the density with which vertex_sample takes the direction. */
INLINE Rgb vertex_f_cos(const Vertex *v, V3 local)
{
    return rgb_scale(v->b->kind->eval(v->b, v->wo, local, false), fabsf(local.z));
}
INLINE float vertex_pdf_w(const Vertex *v, V3 local)
{
    return v->b->kind->pdf_w(v->b, v->wo, local);
}

/* Turns s->wi from local to the world. False: light from there would pass through the surface. */
INLINE bool vertex_turns(const Vertex *v, BsdfSample *s)
{
    float z = s->wi.z;
    s->wi = frame_out(&v->frame, s->wi);
    return v_dot(s->wi, v->s.ng) * z > 0.0f;
}

/* The normal on the side from which light can reach the viewer, who is where wo points, local; 0:
 * that may be both sides. For light samplers. */
INLINE V3 vertex_up_from(const Vertex *v, V3 wo)
{
    if (v->b->flags & BSDF_TRANSMIT)
        return v_all(0.0f);
    return wo.z < 0.0f ? v_neg(v->frame.n) : v->frame.n;
}
INLINE V3 vertex_up(const Vertex *v) { return vertex_up_from(v, v->wo); }

/* Scatters by given numbers. s->wi is of the world. False: absorbed. */
INLINE bool vertex_sample_by(const Vertex *v, float lobe, V2 u, BsdfSample *s)
{
    return v->b->kind->sample(v->b, v->wo, lobe, u, false, s) && vertex_turns(v, s);
}

/* The same by decisions LOBE and DIRECTION number `at`. */
INLINE bool vertex_sample(const Vertex *v, Tracer *t, int at, BsdfSample *s)
{
    V2 u = { 0, 0 };
    float lobe = 0.0f;

    if (v->b->flags & BSDF_LOBES)
        lobe = sample_1d(&t->sampler, DECISION(DECIDE_LOBE, at));
    if (v->b->flags & BSDF_SMOOTH)
        u = sample_2d(&t->sampler, DECISION(DECIDE_DIRECTION, at));
    return vertex_sample_by(v, lobe, u, s);
}

/* The ray that leaves that way. */
INLINE Ray vertex_ray(const Vertex *v, V3 wi)
{
    return (Ray){ .o = ray_origin(v->s.p, v->s.err, v->s.ng, wi), .d = wi, .tmax = INFINITY,
                  .time = v->s.time };
}

#endif
