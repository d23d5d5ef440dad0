/* uniform.c -- the light sampler `uniform`: every light with the same probability.
 * Source: [Cline07 4.4.2]. */
#include "base/mem.h"
#include "lightsampling/lightsampler.h"

static LightSampler *open_uniform(const Scene *s, const Opts *o)
{
    LightSampler *ls = MEM_NEW(LightSampler);
    (void)o;
    if (ls)
        ls->scene = s;
    return ls;
}

static const Light *pick(const LightSampler *ls, V3 p, V3 n, float u, float *pmf, float *left)
{
    size_t count = ls->scene->nlights, k;
    double x = (double)u * (double)count;       /* exact: 24 bits times at most 29 more */

    (void)p;
    (void)n;
    if (!count)
        return NULL;
    k = (size_t)x;
    *left = f_min((float)(x - (double)k), ONE_MINUS_ULP);
    *pmf = 1.0f / (float)count;
    return ls->scene->lights[k];
}

static float pmf_of(const LightSampler *ls, V3 p, V3 n, const Light *l)
{
    (void)p;
    (void)n;
    (void)l;
    return 1.0f / (float)ls->scene->nlights;
}

static void close_uniform(LightSampler *ls) { mem_free(ls); }

const LightSamplerKind lightsampler_uniform = {
    .info = { "uniform", "Cline07 4.4.2", "every light with the same probability", NULL },
    .open = open_uniform, .pick = pick, .pmf = pmf_of, .close = close_uniform
};
