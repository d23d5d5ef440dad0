/* random.c -- the sampler `random`: independent numbers, the yardstick for all patterns.
 * Source: [Cline07 4.5.1]. Any number of samples. */
#include "sampling/sampler.h"

static float one(Sampler *s, Decision d) { return unit_of((uint32_t)(draw64(s->key, d) >> 32)); }

static V2 two(Sampler *s, Decision d)
{
    uint64_t bits = draw64(s->key, d);
    return (V2){ unit_of((uint32_t)(bits >> 32)), unit_of((uint32_t)bits) };
}

const SamplerKind sampler_random = {
    .info = { "random", "Cline07 4.5.1", "independent numbers; any sample count", NULL },
    .one = one, .two = two
};
