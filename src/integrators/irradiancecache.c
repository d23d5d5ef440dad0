/* irradiancecache.c -- indirect light of matt surfaces from records of irradiance.
 *
 * Source      [Cline07 7.5, errata 7.15], [Ward88], [WardHeckbert92]. Most stands in recordcache.h:
 *             here glossy events are followed, so models without a matt part are path traced.
 * Lazy        overture=false shows what Ward's lazy evaluation leaves: each tile of the film makes
 *             records where its pixels, in their order, find none. */
#include "base/mem.h"
#include "integrators/recordcache.h"

enum { TILE_RECORDS = 48 };     /* most records of a tile, without overture */

/* The lazy cache of a tile of the film. */
typedef struct { IrradianceRecord records[TILE_RECORDS]; int n; } Tile;

typedef struct {
    RecordCache base;
    Tile *tiles;                /* owned: of each tile, without overture */
    uint32_t tiles_across;
} IrradianceCache;

static bool ask_list(const RecordCache *it, const IrradianceRecord *r, int n, const Spot *at,
                     Rgb *E)
{
    IrradianceSum sum = { 0, { 0, 0, 0 } };

    for (int i = 0; i < n; i++)
        irradiance_add(&sum, &r[i].at, &r[i].of, at->p, at->n, it->a, it->gradients);
    return irradiance_mean(&sum, E);
}

/* As Ward did: a place that no record knows gets one. Only samples that the film takes own their
 * tile; and only beams by deltas alone are worth it. */
static bool ask_tile(const RecordCache *it, const Beam *b, const Vertex *v, const Spot *at,
                     Tracer *t, Rgb *E)
{
    const IrradianceCache *cache = (const IrradianceCache *)it;
    Tile *tile = &cache->tiles[(t->y - it->y0) / FILM_TILE * cache->tiles_across +
                               (t->x - it->x0) / FILM_TILE];

    if (!t->kept)
        return false;
    if (ask_list(it, tile->records, tile->n, at, E))
        return true;
    if (b->way < 0.0f || tile->n == TILE_RECORDS)
        return false;
    tile->records[tile->n++] = recordcache_make(it, v, at, b->medium, 1 + t->sampler.index, t);
    return ask_list(it, tile->records + tile->n - 1, 1, at, E);
}

static bool prepare(Integrator *base, const Film *f, uint64_t seed)
{
    IrradianceCache *cache = (IrradianceCache *)base;

    if (!cache->base.overture) {
        cache->tiles_across = (f->w + FILM_TILE - 1) / FILM_TILE;
        cache->tiles = MEM_ARRAY(Tile, film_ntiles(f));
        if (!cache->tiles)
            return false;
    }
    return recordcache_prepare(base, f, seed);
}

static void close_cache(Integrator *base)
{
    IrradianceCache *cache = (IrradianceCache *)base;

    recordcache_clear(&cache->base);
    mem_free(cache->tiles);
    mem_free(cache);
}

static Integrator *open_cache(const Scene *s, const Opts *o)
{
    IrradianceCache *cache = MEM_NEW(IrradianceCache);

    if (!cache)
        return NULL;
    if (recordcache_open(&cache->base, "irradiancecache", s, o)) {
        cache->base.overture = opt_bool(o, "overture");
        if (!cache->base.overture)
            cache->base.ask = ask_tile;
        return &cache->base.base;
    }
    close_cache(&cache->base.base);
    return NULL;
}

static const OptDef options[] = {
    RECORDCACHE_OPTIONS,
    { .key = "overture", .type = OPT_BOOL, .num = 1,
      .help = "all records are made before the picture; false: when a pixel lacks one, by tiles "
              "of the film, whose edges show" },
    { .key = NULL }
};

const IntegratorKind integrator_irradiancecache = {
    .info = { "irradiancecache", "Cline07 7.5; Ward88; WardHeckbert92",
              "indirect light of matt surfaces, interpolated between few places", options },
    .truth = BIASED, .misses = "detail of indirect light between its records",
    .open = open_cache, .close = close_cache, .prepare = prepare,
    .radiance = recordcache_radiance, .phases = RECORDCACHE_PHASES, .units = recordcache_units,
    .run = recordcache_run
};
