/* integrator.c -- the list of integrators and what they share. See integrator.h. */
#include "integrators/integrator.h"

#include "base/error.h"

#define INTEGRATORS(X)                                                         \
    X(path)                     /* eye paths */                                \
    X(swarm)                    /* the same, guided by what pixels learn */    \
    X(whitted)                  /* trees of mirror images, no noise */         \
    X(distributed)              /* blur and gloss, no indirect diffuse light */ \
    X(ao)                       /* how open the surroundings are */            \
    X(direct)                   /* light scattered once */                     \
    X(light)                    /* paths from the lamps */                     \
    X(photons)                  /* the same by chance alone */                 \
    X(photonmap)                /* photons kept, and looked up */              \
    X(instantradiosity)         /* a few lights that stand for all */           \
    X(ppm)                      /* photons gathered where eye paths end */     \
    X(sppm)                     /* the same, eye paths anew each time */       \
    X(irradiancecache)          /* indirect light interpolated */
#define DECLARE(name) extern const IntegratorKind integrator_##name;
#define ENTRY(name) &integrator_##name,
INTEGRATORS(DECLARE)
const IntegratorKind *const integrators[] = { INTEGRATORS(ENTRY) NULL };

const char *const strategy_names[STRATEGIES] = { "implicit", "explicit", "lens", "merge" };
const char *const truth_names[3] = { "unbiased", "consistent", "biased" };

bool warn_of_scattering(const Scene *s, const char *method)
{
    for (size_t i = 0; i < s->nmedia; i++)
        if (!rgb_black(s->media[i].scattering))
            return warn_at((Place){ NULL, 0, 0 }, "%s leaves out the light that media scatter, "
                           "here the medium '%s'; path and direct show it", method,
                           s->media[i].name);
    return true;
}
