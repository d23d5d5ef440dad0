/* integrator.c -- the list of integrators and what they share. See integrator.h. */
#include "integrators/integrator.h"

#define INTEGRATORS(X)                                                         \
    X(path)                     /* eye paths */                                \
    X(whitted)                  /* trees of mirror images, no noise */         \
    X(distributed)              /* blur and gloss, no indirect diffuse light */ \
    X(ao)                       /* how open the surroundings are */            \
    X(direct)                   /* light scattered once */
#define DECLARE(name) extern const IntegratorKind integrator_##name;
#define ENTRY(name) &integrator_##name,
INTEGRATORS(DECLARE)
const IntegratorKind *const integrators[] = { INTEGRATORS(ENTRY) NULL };

const char *const strategy_names[STRATEGIES] = { "implicit", "explicit" };
const char *const truth_names[3] = { "unbiased", "consistent", "biased" };
