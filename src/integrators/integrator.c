/* integrator.c -- the list of integrators and what they share. See integrator.h. */
#include "integrators/integrator.h"

#include "base/error.h"
#include "base/mem.h"

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
    X(irradiancecache)          /* indirect light interpolated */              \
    X(radiancecache)            /* the same for glossy surfaces */             \
    X(bdpt)                     /* paths from both ends, connected */          \
    X(bpm)                      /* the same, merged */                         \
    X(vcm)                      /* both */                                     \
    X(pssmlt)                   /* chains of the numbers paths are made of */  \
    X(mlt)                      /* chains of paths */                          \
    X(erpt)                     /* samples spread by such chains */
#define DECLARE(name) extern const IntegratorKind integrator_##name;
#define ENTRY(name) &integrator_##name,
INTEGRATORS(DECLARE)
const IntegratorKind *const integrators[] = { INTEGRATORS(ENTRY) NULL };

const char *const strategy_names[STRATEGIES] = { "implicit", "explicit", "lens", "merge",
                                               "connect" };
const char *const truth_names[3] = { "unbiased", "consistent", "biased" };

Integrator *integrator_open(const IntegratorKind *k, const Scene *s, const Opts *o)
{
    Integrator *it = k->open(s, o);

    if (it)
        it->kind = k;
    return it;
}

Integrator *integrator_open_sharing(const IntegratorKind *k, const Scene *s, const Opts *of)
{
    Opts o;

    opts_default(&o, k->info.options);
    for (int i = 0; o.defs[i].key; i++)
        for (int j = 0; of->defs[j].key; j++)
            if (!strcmp(o.defs[i].key, of->defs[j].key))
                o.value[i] = of->value[j];
    return integrator_open(k, s, &o);
}

void integrator_close(Integrator *it)
{
    if (it)
        it->kind->close(it);
}

/* What comes to the same place of the same layers as the one before, is one with that. */
void tracer_holds(Tracer *t, V2 place, int edges, Strategy how, Rgb c)
{
    SplatList *l = t->held;
    Splat s = { place, c, canvas_layers(t->canvas, edges, how) };
    Splat *last = l->n ? &l->splats[l->n - 1] : NULL;

    if (edges < l->least || rgb_black(c))
        return;
    if (last && last->layers == s.layers && last->place.x == place.x && last->place.y == place.y)
        last->c = rgb_add(last->c, c);
    else if (!MEM_PUSH(l->splats, l->n, l->cap, s))
        t->failed = true;
}

void tracer_splat_list(Tracer *t, const SplatList *l, float weight)
{
    const Canvas *k = t->canvas;

    for (size_t i = 0; i < l->n; i++)
        film_splat(k->film, k->filter, l->splats[i].place, l->splats[i].layers,
                   rgb_scale(l->splats[i].c, weight * canvas_pixels(k)));
}

bool warn_of_scattering(const Scene *s, const char *method)
{
    for (size_t i = 0; i < s->nmedia; i++)
        if (!rgb_black(s->media[i].scattering))
            return warn_at((Place){ NULL, 0, 0 }, "%s leaves out the light that media scatter, "
                           "here the medium '%s'; path and direct show it", method,
                           s->media[i].name);
    return true;
}
