/* direct_twostage.h -- what the strategies twostage and triple share: the sky by partitions of its
 * map, other lights as strategy=mis has them. */
#ifndef INTEGRATORS_DIRECT_TWOSTAGE_H
#define INTEGRATORS_DIRECT_TWOSTAGE_H

#include "integrators/direct.h"
#include "integrators/twostage.h"

typedef struct {
    TwoStage two;               /* owned */
    Direct   rest;              /* strategy=mis for the other lights; its Lighting is that of two */
    int      samples;
} SkyAndRest;

bool skyrest_init(SkyAndRest *own, const Direct *it, const Opts *o);    /* false: reported */
void skyrest_clear(SkyAndRest *own);
/* The light that the turn scatters, but for that of the sky by luminance. */
Rgb  skyrest_others(const SkyAndRest *own, const Turn *u, Tracer *t);

#endif
