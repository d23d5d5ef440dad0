/* glints.c -- see glints.h. */
#include "integrators/glints.h"

#include "integrators/lighting.h"

bool glints_init(Glints *g, const Scene *s, int n, int maxdepth)
{
    memset(g, 0, sizeof *g);
    g->scene = s;
    g->n = n;
    g->maxdepth = maxdepth;
    if (n == 1)
        return true;
    if (!subset_init(&g->shapes, s, shape_glints))
        return false;
    if (g->shapes.none)
        g->n = 1;
    return true;
}

void glints_clear(Glints *g) { subset_clear(&g->shapes); }

/* ---- a candidate ---- */

/* Numbers i of the decisions on the event at this depth. */
static Draw numbers(Tracer *t, int depth, uint32_t i)
{
    Turn u = { .at = depth };
    Draw first = draw_first(t, &u, DECIDE_LOBE, DECIDE_DIRECTION);

    return draw_number(&first, i);
}

/* Through the deltas that the beam meets, with the light that it sees after one of them. */
static Rgb followed(const Glints *g, Beam *b, uint32_t i, Tracer *t)
{
    Rgb sum = rgb_all(0.0f);

    for (bool delta = false;; delta = true) {
        Vertex v;
        BsdfSample s;
        Draw draw;
        if (!beam_meets(b, &v.s, t))
            return delta ? rgb_add(sum, beam_shows_beyond(b, t)) : sum;
        if (delta && v.s.shape->light != NO_LIGHT)
            sum = rgb_add(sum, beam_shows(b, scene_light_of(g->scene, &v.s), &v.s, t));
        vertex_make(&v, g->scene, b->ray.d);
        if (!(v.b->flags & BSDF_SPECULAR) || b->depth == g->maxdepth)
            return sum;
        draw = numbers(t, b->depth, i);
        if (!vertex_sample_by(&v, draw.choice, draw.point, &s) || s.pdf_w > 0.0f)
            return sum;
        beam_turn(b, &v, &s);
    }
}

Rgb glints_light(const Glints *g, const Vertex *v, const Beam *b, Tracer *t)
{
    Draw first = numbers(t, b->depth, 0);
    Rgb sum = rgb_all(0.0f);

    for (int i = 1; i < g->n; i++) {
        Draw draw = draw_number(&first, (uint32_t)i);
        Beam on = *b;
        BsdfSample s;
        if (!vertex_sample_by(v, draw.choice, draw.point, &s) || !(s.pdf_w > 0.0f))
            continue;
        beam_turn(&on, v, &s);
        if (!subset_near(&g->shapes, &on.ray))
            continue;
        on.throughput = rgb_scale(on.throughput, glints_share(g));
        sum = rgb_add(sum, followed(g, &on, (uint32_t)i, t));
    }
    return sum;
}
