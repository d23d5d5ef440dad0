/* irradiance.c -- the code of `irradiance.h` */
#include "integrators/irradiance.h"

#include "base/mem.h"

static float gradient_of(const Irradiance *of)
{
    V3 g = v_add(v_scale(of->move[0], 0.299f), v_add(v_scale(of->move[1], 0.587f),
                                                     v_scale(of->move[2], 0.114f)));
    return v_len(g);
}

IrradianceRecord irradiance_record(V3 p, V3 n, const Irradiance *of, float least, float most)
{
    IrradianceRecord r = { { p, n, most, least }, *of };
    float kept = reach_limit(&r.at, of->inv_distance, rgb_lum(of->E), gradient_of(of), least, most);

    for (int k = 0; k < 3; k++)
        r.of.move[k] = v_scale(r.of.move[k], kept);
    return r;
}

void irradiance_add(IrradianceSum *s, const Reach *at, const Irradiance *of, V3 p, V3 n, float a,
                    bool gradients)
{
    const float E[3] = { of->E.r, of->E.g, of->E.b };
    double w = reach_weight(at, p, n, a);
    V3 turned, moved;

    if (!(w > 0.0))
        return;
    turned = v_cross(at->n, n);
    moved = v_sub(p, at->p);
    s->weight += w;
    for (int k = 0; k < 3; k++) {
        float here = E[k];
        if (gradients)
            here += v_dot(turned, of->turn[k]) + v_dot(moved, of->move[k]);
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
    return reaches_init(&s->reaches, around, a);
}

void irradiance_clear(IrradianceStore *s)
{
    reaches_clear(&s->reaches);
    mem_free(s->of);
    memset(s, 0, sizeof *s);
}

bool irradiance_insert(IrradianceStore *s, const IrradianceRecord *r)
{
    return MEM_PUSH(s->of, s->n, s->cap, r->of) && reaches_insert(&s->reaches, &r->at);
}

bool irradiance_at(const IrradianceStore *s, V3 p, V3 n, float a, bool gradients, Rgb *E)
{
    IrradianceSum sum = { 0, { 0, 0, 0 } };
    BallWalk walk = balltree_ask(&s->reaches.tree, p);
    uint32_t id;

    while (balltree_next(&walk, &id))
        irradiance_add(&sum, &s->reaches.at[id], &s->of[id], p, n, a, gradients);
    return irradiance_mean(&sum, E);
}
