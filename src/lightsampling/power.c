/* power.c -- the light sampler `power`: a light in proportion to its power.
 *
 * Source      [Cline07 4.4.2]. Lights of power 0 are never asked. Where all have power 0 (or there
 *             is none) no light is picked. */
#include "base/mem.h"
#include "lightsampling/lightsampler.h"
#include "sampling/table.h"

typedef struct {
    LightSampler base;
    Table table;                /* owned; by the scene's order of lights */
    bool  single;               /* one light, with power: there is nothing to choose */
} Power;

static void close_power(LightSampler *base)
{
    Power *ls = (Power *)base;
    table_clear(&ls->table);
    mem_free(ls);
}

static LightSampler *open_power(const Scene *s, const Opts *o)
{
    Power *ls = MEM_NEW(Power);
    float *weight = MEM_ARRAY(float, s->nlights);
    bool ok = ls && weight;

    (void)o;
    for (size_t i = 0; ok && i < s->nlights; i++)
        weight[i] = rgb_lum(s->lights[i]->kind->power(s->lights[i]));
    ok = ok && table_init(&ls->table, weight, s->nlights);
    mem_free(weight);
    if (!ok) {
        mem_free(ls);
        return NULL;
    }
    ls->base.scene = s;
    ls->single = s->nlights == 1 && table_total(&ls->table) > 0.0;
    return &ls->base;
}

static const Light *pick(const LightSampler *base, V3 p, V3 n, float u, float *pmf, float *left)
{
    const Power *ls = (const Power *)base;
    size_t i;

    (void)p;
    (void)n;
    if (LIKELY(ls->single)) {
        *pmf = 1.0f;
        *left = u;
        return base->scene->lights[0];
    }
    return table_sample(&ls->table, u, &i, pmf, left) ? base->scene->lights[i] : NULL;
}

static float pmf_of(const LightSampler *base, V3 p, V3 n, const Light *l)
{
    const Power *ls = (const Power *)base;

    (void)p;
    (void)n;
    return ls->single ? 1.0f : table_pmf(&ls->table, l->index);
}

const LightSamplerKind lightsampler_power = {
    .info = { "power", "Cline07 4.4.2", "a light in proportion to its power", NULL },
    .open = open_power, .pick = pick, .pmf = pmf_of, .close = close_power
};
