/* lightsampler.h -- which light to ask from a point. One file a method; lightsampler.c has the
 * list. The probability of a choice is part of every explicit path's density, and of the weight of
 * every implicit one, so `pmf` must be exactly what `pick` does. */
#ifndef LIGHTSAMPLING_LIGHTSAMPLER_H
#define LIGHTSAMPLING_LIGHTSAMPLER_H

#include "base/kind.h"
#include "scene/scene.h"

typedef struct LightSampler LightSampler;

typedef struct {
    KindInfo info;
    LightSampler *(*open)(const Scene *s, const Opts *o);       /* NULL: reported */
    /* Picks by u in [0,1) for the point p, of which n is the normal on the side from which light is
     * wanted (0: from all round, as in media and through surfaces that transmit); *pmf its
     * probability, > 0. *left: what u still holds of chance, again in [0,1). NULL: no light is
     * worth asking. */
    const Light *(*pick)(const LightSampler *ls, V3 p, V3 n, float u, float *pmf, float *left);
    float (*pmf)(const LightSampler *ls, V3 p, V3 n, const Light *l);
    void (*close)(LightSampler *ls);
} LightSamplerKind;

struct LightSampler {           /* first member of every concrete one */
    const LightSamplerKind *kind;
    const Scene *scene;         /* borrowed */
};

extern const LightSamplerKind *const lightsamplers[];           /* ends with NULL */
#define LIGHTSAMPLER_DEFAULT "auto"
/* By name. auto: by contribution where lights are few enough to look at each for each choice (64),
 * since that is never much noisier than any other and often far less; else by power. One light is
 * no choice: whether it can be seen, sampling it tells. */
const LightSamplerKind *lightsampler_named(const char *name, const Scene *s);
/* Opens the one of that name. NULL: reported. Closing NULL does nothing. */
LightSampler *lightsampler_open(const char *name, const Scene *s);
void lightsampler_close(LightSampler *ls);

#endif
