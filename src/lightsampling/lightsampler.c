/* lightsampler.c -- the list of ways to choose a light. See lightsampler.h. */
#include "lightsampling/lightsampler.h"

#define LIGHTSAMPLERS(X)                                                       \
    X(power)                    /* in proportion to power */                   \
    X(uniform)                  /* all alike */                               \
    X(contribution)             /* by what they would bring to the point */
#define DECLARE(name) extern const LightSamplerKind lightsampler_##name;
#define ENTRY(name) &lightsampler_##name,
LIGHTSAMPLERS(DECLARE)
const LightSamplerKind *const lightsamplers[] = { LIGHTSAMPLERS(ENTRY) NULL };
