/* direct.h -- the integrator `direct` and its strategies: their list, and one file for each. */
#ifndef INTEGRATORS_DIRECT_H
#define INTEGRATORS_DIRECT_H

#include "integrators/beam.h"
#include "integrators/lighting.h"

typedef struct Direct Direct;

typedef struct {
    const char *name;
    bool finds_deltas;          /* point and distant lights */
    /* Looks at the options; the Direct is there but for `own`. False: reported. NULL: nothing. */
    bool (*open)(Direct *it, const Opts *o);
    void (*close)(Direct *it);  /* NULL: nothing is owned */
    /* One estimate of the light that the turn scatters towards the viewer without delta events,
     * having come straight from a light. */
    Rgb (*light)(const Direct *it, const Turn *u, Tracer *t);
    /* Before the first sample of a picture: see integrator.h. Sets how many units there are to run.
     * NULL: nothing to do. */
    bool (*prepare)(Direct *it, const Film *f, uint64_t seed, uint64_t *units);
    void (*run)(const Direct *it, uint64_t unit, Tracer *t);
    /* As those of an integrator. NULL: nothing lasts. */
    void (*save)(const Direct *it, Saving *s);
    bool (*load)(Direct *it, Loading *l);
} DirectStrategy;

#define DIRECT_STRATEGIES(X)                                                   \
    X(uniform)                  /* directions all alike */                     \
    X(brdf) X(light) X(mis)     /* by the surface, by the lights, by both */   \
    X(ris)                      /* many tentatively, few of them looked at */  \
    X(twostage)                 /* the sky by its product with the surface */  \
    X(triple)                   /* and with what is known of shadows */        \
    X(cut) X(sir)               /* by point lights that stand for all light */
#define DIRECT_DECLARE(name) extern const DirectStrategy direct_##name;
DIRECT_STRATEGIES(DIRECT_DECLARE)
extern const DirectStrategy *const direct_strategies[];         /* ends with NULL */

/* Their names, with blanks between: the choices of an option `strategy`. */
#define DIRECT_WORD(name) " " #name
#define DIRECT_CHOICES (&(DIRECT_STRATEGIES(DIRECT_WORD))[1])

enum { SIR_MOST = 4096 };        /* tentative samples of sir */

typedef enum { LIGHTS_CHOSEN, LIGHTS_ALL, LIGHTS_WARD, LIGHTS_SHIRLEY } WhichLights;

struct Direct {
    Integrator base;
    Lighting lighting;          /* owned */
    const DirectStrategy *strategy;
    int   lightsamples, bsdfsamples;
    int   maxdepth;             /* most scattering events between eye and light */
    WhichLights which;
    float tolerance;            /* of ward and shirley: a share of all, untested */
    Resampling resampling;
    void *own;                  /* of the strategy */
    uint64_t units;             /* of its preparation */
};

/* For other methods: what its strategy finds at a turn of the beam. */
Rgb direct_scattered(const Direct *it, const Beam *b, const Turn *u, Tracer *t);
extern const IntegratorKind integrator_direct;

#endif
