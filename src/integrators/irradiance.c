/* irradiance.c -- the code of `irradiance.h` */
#include "integrators/irradiance.h"

#include "base/mem.h"

/* A place lies behind a record if it is so much of the radius below: on a curved or bumpy surface
 * some of that is due to rounding and to normals that are interpolated. */
#define BEHIND 0.02f

static float gradient_of(const Irradiance *of)
{
    V3 g = v_add(v_scale(of->move[0], 0.299f), v_add(v_scale(of->move[1], 0.587f),
                                                     v_scale(of->move[2], 0.114f)));
    return v_len(g);
}

IrradianceRecord irradiance_record(V3 p, V3 n, const Irradiance *of, float least, float most)
{
    IrradianceRecord r = { p, n, most, least, *of };
    float gradient = gradient_of(of), E = rgb_lum(of->E);

    if (of->inv_distance * most > 1.0f)
        r.radius = 1.0f / of->inv_distance;
    if (gradient * r.radius > E)
        r.radius = E / gradient;
    if (r.radius < least) {     /* it reaches beyond what its gradient is good for: less of that */
        for (int k = 0; k < 3; k++)
            r.of.move[k] = v_scale(r.of.move[k], r.radius / least);
        r.radius = least;
    }
    return r;
}

float irradiance_error(const IrradianceRecord *r, V3 p, V3 n)
{
    V3 d = v_sub(p, r->p);

    if (0.5f * v_dot(d, v_add(n, r->n)) < -BEHIND * r->radius)
        return INFINITY;
    return v_len(d) / r->radius + sqrtf(f_max(0.0f, 1.0f - v_dot(n, r->n)));
}

void irradiance_add(IrradianceSum *s, const IrradianceRecord *r, V3 p, V3 n, float a,
                    bool gradients)
{
    const float E[3] = { r->of.E.r, r->of.E.g, r->of.E.b };
    float e = irradiance_error(r, p, n);
    V3 turned, moved;
    double w;

    if (!(e < a))
        return;
    w = 1.0 / d_max(e, 1e-4 * (double)a) - 1.0 / (double)a;     /* the same place: all of it */
    turned = v_cross(r->n, n);
    moved = v_sub(p, r->p);
    s->weight += w;
    for (int k = 0; k < 3; k++) {
        float here = E[k];
        if (gradients)
            here += v_dot(turned, r->of.turn[k]) + v_dot(moved, r->of.move[k]);
        s->E[k] += w * (double)f_max(here, 0.0f);
    }
}

bool irradiance_mean(const IrradianceSum *s, Rgb *E)
{
    if (!(s->weight > 0.0))
        return false;
    *E = rgb((float)(s->E[0] / s->weight), (float)(s->E[1] / s->weight),
             (float)(s->E[2] / s->weight));
    return true;
}

/* ---- many ---- */

bool irradiance_init(IrradianceStore *s, Box around, float a)
{
    memset(s, 0, sizeof *s);
    s->a = a;
    return balltree_init(&s->tree, around);
}

void irradiance_clear(IrradianceStore *s)
{
    balltree_clear(&s->tree);
    mem_free(s->records);
    memset(s, 0, sizeof *s);
}

/* The balls of neighbours that shrink stay as large as they were: whoever asks sees by itself. */
static void clamp_neighbours(IrradianceStore *s, IrradianceRecord *r)
{
    for (int way = 0; way < 2; way++) {         /* first the record by them, then they by it */
        BallWalk walk = balltree_ask(&s->tree, r->p);
        uint32_t id;
        while (balltree_next(&walk, &id)) {
            IrradianceRecord *other = &s->records[id], *by = way ? r : other;
            IrradianceRecord *it = way ? other : r;
            float most = by->radius + v_len(v_sub(r->p, other->p));
            if (irradiance_error(other, r->p, r->n) < s->a && most < it->radius)
                it->radius = f_max(most, it->least);
        }
    }
}

bool irradiance_insert(IrradianceStore *s, const IrradianceRecord *r)
{
    IrradianceRecord in = *r;

    clamp_neighbours(s, &in);
    return MEM_PUSH(s->records, s->n, s->cap, in) &&
           balltree_add(&s->tree, in.p, in.radius * s->a, (uint32_t)(s->n - 1));
}

bool irradiance_at(const IrradianceStore *s, V3 p, V3 n, float a, bool gradients, Rgb *E)
{
    IrradianceSum sum = { 0, { 0, 0, 0 } };
    BallWalk walk = balltree_ask(&s->tree, p);
    uint32_t id;

    while (balltree_next(&walk, &id))
        irradiance_add(&sum, &s->records[id], p, n, a, gradients);
    return irradiance_mean(&sum, E);
}
