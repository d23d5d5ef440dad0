/* sampler.c -- the list of samplers and what they share. See sampler.h. */
#include "sampling/sampler.h"

#define SAMPLERS(X)                                                            \
    X(random)                   /* independent numbers */                      \
    X(zerotwo)                  /* (0,2)-sequences, scrambled */
#define DECLARE(name) extern const SamplerKind sampler_##name;
#define ENTRY(name) &sampler_##name,
SAMPLERS(DECLARE)
const SamplerKind *const samplers[] = { SAMPLERS(ENTRY) NULL };

bool sampler_init(Sampler *s, const SamplerKind *kind, const Opts *o, uint64_t seed, uint32_t *spp)
{
    s->kind = kind;
    s->seed = key_with(0, seed);
    s->state = NULL;
    s->spp = *spp;
    if (kind->init && !kind->init(s, o, spp))
        return false;
    s->spp = *spp;
    sampler_pixel(s, 0, 0);
    sampler_start(s, 0);
    return true;
}

void sampler_pixel(Sampler *s, uint32_t x, uint32_t y)
{
    s->pixel = key_with(s->seed, (uint64_t)y << 32 | x);
}

void sampler_start(Sampler *s, uint32_t index)
{
    s->index = index;
    s->key = key_with(s->pixel, index);
    if (s->kind->start)
        s->kind->start(s);
}
