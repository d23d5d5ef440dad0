/* sampler.c -- the list of samplers and what they share. See sampler.h. */
#include "sampling/sampler.h"

#include <string.h>

#define SAMPLERS(X)                                                            \
    X(random)                   /* independent numbers */                      \
    X(zerotwo)                  /* (0,2)-sequences, scrambled */               \
    X(stratified)               /* one sample a stratum of a grid */           \
    X(uncorrelated)             /* the same, strata matched as Cook does */    \
    X(nrooks)                   /* one sample a row and a column */            \
    X(multijittered)            /* both */                                     \
    X(cmj)                      /* both, with one order for all rows */        \
    X(poisson)                  /* a least distance between points */          \
    X(halton)                   /* radical inverses in prime bases */          \
    X(hammersley)               /* i / N and a radical inverse */              \
    X(sobol)                    /* digital sequence of many dimensions */
#define DECLARE(name) extern const SamplerKind sampler_##name;
#define ENTRY(name) &sampler_##name,
SAMPLERS(DECLARE)
const SamplerKind *const samplers[] = { SAMPLERS(ENTRY) NULL };

bool sampler_init(Sampler *s, const SamplerKind *kind, const Opts *o, uint64_t seed, uint32_t *spp)
{
    memset(s, 0, sizeof *s);
    s->kind = kind;
    s->seed = key_with(0, seed);
    s->spp = *spp;
    if (kind->init && !kind->init(s, o, spp))
        return false;
    s->spp = *spp;
    sampler_pixel(s, 0, 0);
    sampler_start(s, 0);
    return true;
}

void sampler_clear(Sampler *s)
{
    if (s->state && s->kind->clear)
        s->kind->clear(s);
    s->state = NULL;
}

void sampler_pixel(Sampler *s, uint32_t x, uint32_t y)
{
    s->pixel = key_with(s->seed, s->fixed ? 0 : (uint64_t)y << 32 | x);
}

void sampler_other(Sampler *s, SamplerPath path)
{
    s->pixel = key_with(s->pixel, (uint64_t)path);
    sampler_start(s, s->index);
}

void sampler_start(Sampler *s, uint32_t index)
{
    s->index = index;
    s->key = key_with(s->pixel, index);
    if (s->kind->start)
        s->kind->start(s);
}
