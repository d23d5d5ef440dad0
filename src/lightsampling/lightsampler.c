/* lightsampler.c -- the list of ways to choose a light. See lightsampler.h. */
#include "lightsampling/lightsampler.h"

#include <string.h>

#define LIGHTSAMPLERS(X)                                                       \
    X(power)                    /* in proportion to power */                   \
    X(uniform)                  /* all alike */                               \
    X(contribution)             /* by what they would bring to the point */
#define DECLARE(name) extern const LightSamplerKind lightsampler_##name;
#define ENTRY(name) &lightsampler_##name,
LIGHTSAMPLERS(DECLARE)
const LightSamplerKind *const lightsamplers[] = { LIGHTSAMPLERS(ENTRY) NULL };

enum { FEW = 64 };

const LightSamplerKind *lightsampler_named(const char *name, const Scene *s)
{
    if (!strcmp(name, "auto"))
        name = s->nlights == 1 ? "uniform" : s->nlights <= FEW ? "contribution" : "power";
    return kind_find(lightsamplers, name);
}

LightSampler *lightsampler_open(const char *name, const Scene *s)
{
    const LightSamplerKind *k = lightsampler_named(name, s);
    LightSampler *ls;
    Opts none;

    opts_default(&none, k->info.options);
    ls = k->open(s, &none);
    if (ls)
        ls->kind = k;
    return ls;
}

void lightsampler_close(LightSampler *ls)
{
    if (ls)
        ls->kind->close(ls);
}
