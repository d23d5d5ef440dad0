/* radiancecache.c -- indirect light of matt and glossy surfaces from records of radiance.
 *
 * Source      [Cline07 7.5.4], [Krivanek05]. What is here and in recordcache.h differs from theirs:
 *             the BSDF is sampled, not projected, so every model and every texture will do, and the
 *             samples' noise goes with the camera's samples at the cost of no ray; and it is
 *             events, not surfaces, that are glossy: where a lobe is steeper than `sharpest`, its
 *             middle is followed as by `path`, and its skirts are looked up.
 * Bands       n bands of harmonics show details of about 180 / n degrees: light from sharper ones
 *             is spread, none is lost. */
#include "base/mem.h"
#include "integrators/recordcache.h"

static void close_cache(Integrator *base)
{
    recordcache_clear((RecordCache *)base);
    mem_free(base);
}

static Integrator *open_cache(const Scene *s, const Opts *o)
{
    RecordCache *it = MEM_NEW(RecordCache);

    if (!it)
        return NULL;
    if (recordcache_open(it, "radiancecache", s, o)) {
        it->bands = (int)opt_int(o, "bands");
        it->sharpest = opt_float(o, "sharpest");
        return &it->base;
    }
    close_cache(&it->base);
    return NULL;
}

static const OptDef options[] = {
    RECORDCACHE_OPTIONS,
    { .key = "bands", .type = OPT_INT, .num = 6, .lo = 1, .hi = HARMONIC_BANDS,
      .help = "of the harmonics that tell of radiance: more show more detail, and take memory" },
    { .key = "sharpest", .type = OPT_FLOAT, .num = 1.5, .lo = 0, .hi = 1e30,
      .help = "most density, a steradian, of directions whose light is looked up; beyond it they "
              "are followed" },
    { .key = NULL }
};

const IntegratorKind integrator_radiancecache = {
    .info = { "radiancecache", "Cline07 7.5.4; Krivanek05",
              "indirect light of matt and glossy surfaces, interpolated between few places",
              options },
    .truth = BIASED, .misses = "detail of indirect light between its records",
    .open = open_cache, .close = close_cache, .prepare = recordcache_prepare,
    .radiance = recordcache_radiance, .phases = RECORDCACHE_PHASES, .units = recordcache_units,
    .run = recordcache_run
};
