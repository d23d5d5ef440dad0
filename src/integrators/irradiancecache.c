/* irradiancecache.c -- indirect light of matt surfaces from records of irradiance.
 *
 * Source      [Cline07 7.5, errata 7.15], [Ward88], [WardHeckbert92].
 * Idea        Light that comes straight from lamps, or by mirrors and glass, is found at each
 *             point as ever; light that surfaces scattered before changes slowly from place to
 *             place, so it is worked out well at few places and interpolated between them.
 * Record      irradiance without what lamps bring themselves: a ray in each cell of the hemisphere,
 *             and along it the estimate of a path with direct light at each vertex.
 * Events      What a model draws from its matt part (BSDF_MATT) brings E / pi in place of the
 *             radiance of its direction. Lobes and deltas are followed as by `path`, and what is
 *             found there uses the records again. Models without a matt part are path traced.
 * Overture    Before the first sample, sets of pixels on ever finer grids are looked at: where
 *             records lack, new ones are made, side by side, and taken in by the order of pixels.
 *             All pixels then interpolate between the same records, and a little wider, so none of
 *             them leaves an edge. overture=false shows what Ward's lazy evaluation leaves: each
 *             tile of the film makes records where its pixels, in their order, find none.
 * Elsewhere   Where a sample meets a place that no record knows (behind a lobe, past an edge) the
 *             path goes on by one direction, as `path` does: noisy, not wrong, nothing is stored.
 * Misses      The detail of caustics and of whatever is smaller than the distance of records.
 *             Paths that reach a record by d deltas may have d events more than maxdepth.
 * Motion      A record is made at one moment, and serves all. */
#include "base/mem.h"
#include "integrators/beam.h"
#include "integrators/irradiance.h"
#include "integrators/lighting.h"
#include "scene/camera.h"

enum { COARSEST = 64, SETS = 13, PHASES = 2 * SETS + 1 };
enum { TILE_RECORDS = 48 };     /* most records of a tile, without overture */
enum { RECORDS_OF = 1 << 30 };  /* added to a pixel's x: the numbers of its records */

/* The lazy cache of a tile of the film. */
typedef struct { IrradianceRecord records[TILE_RECORDS]; int n; } Tile;

typedef struct {
    Integrator base;
    Lighting lighting;          /* owned */
    int   maxdepth, roulette, rays;
    float a, overlap;           /* accuracy of records, and times that when pixels ask */
    float least, most;          /* spacing of records in pixels */
    bool  gradients, overture;
    /* the picture */
    uint32_t x0, y0, w, h;
    float pixel;                /* width of one where the beam's is not known */
    IrradianceStore store;      /* owned */
    bool *wanted;               /* owned: pixels at which records lack */
    uint64_t *places;           /* owned: those pixels by number, */
    IrradianceRecord *made;     /* and their records, n of them */
    size_t n, cap_places, cap_made;
    Tile *tiles;                /* owned: of each tile, without overture; ntiles of them */
    size_t ntiles;
    uint32_t tiles_across;
} IrradianceCache;

/* A matt event about to ask the cache. */
typedef struct { V3 p, n; float width; } Spot;

/* ---- light along a path ---- */

/* By one direction towards a lamp and one by the surface. */
static Rgb direct(const IrradianceCache *it, const Turn *u, Tracer *t)
{
    Draw light = draw_first(t, u, DECIDE_LIGHT, DECIDE_LIGHT_POINT);
    Draw scattering = draw_first(t, u, DECIDE_LOBE, DECIDE_DIRECTION);
    Rgb sum = rgb_all(0.0f);
    Candidate c;

    if (candidate_by_light(&it->lighting, u, &light, 1.0f, 1.0f, t, &c))
        sum = candidate_light(&c, u, t);
    if (candidate_by_scattering(&it->lighting, u, &scattering, 1.0f, 1.0f, t, &c))
        sum = rgb_add(sum, candidate_light(&c, u, t));
    return sum;
}

/* The place of a matt event that goes the way s->wi: the side from which its light comes. */
static Spot place_of(const IrradianceCache *it, const Vertex *v, const BsdfSample *s)
{
    float side = v_dot(s->wi, v->frame.n);
    return (Spot){ v->s.p, side < 0.0f ? v_neg(v->frame.n) : v->frame.n,
                    v->s.width > 0.0f ? v->s.width : it->pixel };
}

static bool is_matt(const BsdfSample *s)
{
    return (s->flags & (BSDF_MATT | BSDF_SMOOTH)) == (BSDF_MATT | BSDF_SMOOTH);
}

/* Whether a matt event at the beam's end may use light that was scattered before. */
static bool may_ask(const IrradianceCache *it, const Beam *b)
{
    return b->depth + 2 <= it->maxdepth;
}

typedef bool Ask(const IrradianceCache *it, const Beam *b, const Vertex *v, const Spot *at,
                 Tracer *t, Rgb *E);

/* What leaves the vertex along the beam, but for its own light. ask: the cache, or NULL. */
static Rgb leaves(const IrradianceCache *it, Beam *b, Vertex *v, Ask *ask, Tracer *t)
{
    const Scene *scene = it->base.scene;
    Rgb sum = rgb_all(0.0f), E;

    while (b->depth < it->maxdepth) {
        BsdfSample s;
        bool delta;
        vertex_make(v, scene, b->ray.d);
        if (vertex_is_smooth(v)) {
            Turn u = turn_on(v, b->ray.d, b->medium, b->depth);
            sum = rgb_add(sum, rgb_mul(b->throughput, direct(it, &u, t)));
        }
        if (!vertex_sample(v, t, b->depth, &s))
            break;
        if (ask && is_matt(&s) && may_ask(it, b)) {
            Spot at = place_of(it, v, &s);
            if (ask(it, b, v, &at, t, &E)) {
                E = rgb_mul(rgb_mul(b->throughput, s.weight), rgb_scale(E, INV_PI));
                tracer_tally(t, b->depth + 3, STRATEGY_EXPLICIT, E);
                return rgb_add(sum, E);
            }
        }
        delta = s.pdf_w == 0.0f;
        beam_turn(b, v, &s);
        if (!beam_survives(b, it->roulette, t))
            break;
        if (!beam_meets(b, &v->s, t))
            return delta ? rgb_add(sum, beam_shows_beyond(b, t)) : sum;
        if (delta && v->s.shape->light != NO_LIGHT)
            sum = rgb_add(sum, beam_shows(b, scene_light_of(scene, &v->s), &v->s, t));
    }
    return sum;
}

/* ---- making a record ---- */

/* What comes along a ray of the record's, which has been scattered once already. */
static Rgb arrives(const IrradianceCache *it, const Vertex *from, uint32_t medium, V3 wi, Tracer *t,
                   float *inv_distance)
{
    Beam b = { .throughput = { 1, 1, 1 }, .eta2 = 1.0f, .way = -1.0f, .depth = 1 };
    Vertex v;

    *inv_distance = 0.0f;
    if (v_dot(wi, from->s.ng) * v_dot(wi, from->frame.n) <= 0.0f)
        return rgb_all(0.0f);   /* the surface is in the way */
    b.ray = vertex_ray(from, wi);
    b.medium = medium_beyond(&from->s, wi, medium);
    if (!beam_meets(&b, &v.s, t))
        return rgb_all(0.0f);
    *inv_distance = 1.0f / f_max(v_len(v_sub(v.s.p, from->s.p)), 1e-30f);
    return leaves(it, &b, &v, NULL, t);
}

/* The record at a vertex that a beam has come to. Its numbers follow from the pixel and `number`,
 * its count there; paths keep no tally. */
static IrradianceRecord make_record(const IrradianceCache *it, const Vertex *v, const Spot *at,
                                    uint32_t medium, uint32_t number, Tracer *t)
{
    Frame f = frame_about(at->n);
    Sampler before = t->sampler;
    Tally *tally = t->tally;
    Irradiance of;
    Hemisphere h;
    float inv;

    t->tally = NULL;
    sampler_pixel(&t->sampler, t->x + RECORDS_OF, t->y);
    hemisphere_start(&h, it->rays);
    for (int k = 0; k < h.sectors; k++)
        for (int j = 0; j < h.rings; j++) {
            V3 d;
            Rgb L;
            sampler_start(&t->sampler, (number * (uint32_t)h.sectors + (uint32_t)k) *
                                       (uint32_t)h.rings + (uint32_t)j);
            d = hemisphere_direction(&h, j, k, sample_2d(&t->sampler,
                                                         DECISION(DECIDE_DIRECTION, 0)));
            L = arrives(it, v, medium, frame_out(&f, d), t, &inv);
            hemisphere_take(&h, j, k, L, inv);
        }
    hemisphere_end(&h, &f, &of);
    t->sampler = before;
    t->tally = tally;
    return irradiance_record(at->p, at->n, &of, it->least * at->width / it->a,
                             it->most * at->width / it->a);
}

/* ---- asking ---- */

static bool ask_store(const IrradianceCache *it, const Beam *b, const Vertex *v, const Spot *at,
                      Tracer *t, Rgb *E)
{
    (void)b, (void)v, (void)t;
    return irradiance_at(&it->store, at->p, at->n, it->a * it->overlap, it->gradients, E);
}

static bool ask_list(const IrradianceCache *it, const IrradianceRecord *r, int n, const Spot *at,
                     Rgb *E)
{
    IrradianceSum sum = { 0, { 0, 0, 0 } };

    for (int i = 0; i < n; i++)
        irradiance_add(&sum, &r[i], at->p, at->n, it->a, it->gradients);
    return irradiance_mean(&sum, E);
}

/* As Ward did: a place that no record knows gets one. Only samples that the film takes own their
 * tile; and only beams by deltas alone are worth it. */
static bool ask_tile(const IrradianceCache *it, const Beam *b, const Vertex *v, const Spot *at,
                     Tracer *t, Rgb *E)
{
    Tile *tile = &it->tiles[(t->y - it->y0) / FILM_TILE * it->tiles_across +
                            (t->x - it->x0) / FILM_TILE];

    if (!t->kept)
        return false;
    if (ask_list(it, tile->records, tile->n, at, E))
        return true;
    if (b->way < 0.0f || tile->n == TILE_RECORDS)
        return false;
    tile->records[tile->n++] = make_record(it, v, at, b->medium, 1 + t->sampler.index, t);
    return ask_list(it, tile->records + tile->n - 1, 1, at, E);
}

/* ---- camera samples ---- */

static Rgb radiance(const Integrator *base, const Ray *r, Tracer *t)
{
    const IrradianceCache *it = (const IrradianceCache *)base;
    Beam b = beam_from_eye(r, base->scene);
    Rgb sum = rgb_all(0.0f);
    Vertex v;

    if (!beam_meets(&b, &v.s, t))
        return beam_shows_beyond(&b, t);
    if (v.s.shape->light != NO_LIGHT)
        sum = beam_shows(&b, scene_light_of(base->scene, &v.s), &v.s, t);
    return rgb_add(sum, leaves(it, &b, &v, it->overture ? ask_store : ask_tile, t));
}

/* ---- overture ----
 *
 * The sets: pixels of a grid, then the middles of its cells, then the next grid, half as wide. Each
 * has two phases, of which the first says where records lack and the second makes them; they are
 * taken in before the next one begins. */

/* Where a sample of the pixel would ask, if anywhere. */
static bool seek(const IrradianceCache *it, uint32_t x, uint32_t y, Tracer *t, Beam *b, Vertex *v,
                 Spot *at)
{
    const Scene *scene = it->base.scene;
    V2 lens = { 0.5f, 0.5f }, middle = { (float)x + 0.5f, (float)y + 0.5f };
    float u = 0.0f;
    BsdfSample s;
    Ray r;

    t->x = x;
    t->y = y;
    sampler_pixel(&t->sampler, x, y);
    sampler_start(&t->sampler, 0);
    if (scene->camera->has_lens)
        lens = sample_2d(&t->sampler, DECISION(DECIDE_LENS, 0));
    if (scene_blurs(scene))
        u = sample_1d(&t->sampler, DECISION(DECIDE_TIME, 0));
    r = scene->camera->kind->ray(scene->camera, middle, lens, scene_time(scene, u));
    for (*b = beam_from_eye(&r, scene); may_ask(it, b); beam_turn(b, v, &s)) {
        if (!beam_meets(b, &v->s, t))
            return false;
        vertex_make(v, scene, b->ray.d);
        if (!vertex_sample(v, t, b->depth, &s))
            return false;
        *at = place_of(it, v, &s);
        if (is_matt(&s) || (s.flags & BSDF_SMOOTH))
            return is_matt(&s);
    }
    return false;
}

/* Set 0, 2, ...: the grids; 1, 3, ...: middles of cells. Pixels of earlier sets are left out. */
static bool is_of_set(uint32_t x, uint32_t y, int set)
{
    uint32_t s = (uint32_t)COARSEST >> (set / 2), inside = s - 1, wide = 2 * s - 1;

    if (set % 2)
        return (x & inside) == s / 2 && (y & inside) == s / 2;
    if ((x & inside) || (y & inside))
        return false;
    return set == 0 || ((x & wide) == s) != ((y & wide) == s);
}

static void look(IrradianceCache *it, int set, uint32_t row, Tracer *t)
{
    for (uint32_t x = 0; x < it->w; x++) {
        Spot at;
        Vertex v;
        Beam b;
        Rgb E;
        it->wanted[(size_t)row * it->w + x] =
            is_of_set(x, row, set) && seek(it, it->x0 + x, it->y0 + row, t, &b, &v, &at) &&
            !irradiance_at(&it->store, at.p, at.n, it->a, it->gradients, &E);
    }
}

static void make(IrradianceCache *it, uint64_t unit, Tracer *t)
{
    uint64_t pixel = it->places[unit];
    Spot at;
    Vertex v;
    Beam b;

    if (seek(it, it->x0 + (uint32_t)(pixel % it->w), it->y0 + (uint32_t)(pixel / it->w), t, &b, &v,
             &at))
        it->made[unit] = make_record(it, &v, &at, b.medium, 0, t);
}

/* Between phases, when no other thread works. False: memory, reported. */
static bool list_places(IrradianceCache *it)
{
    it->n = 0;
    for (uint64_t i = 0; i < (uint64_t)it->w * it->h; i++)
        if (it->wanted[i] && !MEM_PUSH(it->places, it->n, it->cap_places, i))
            return false;
    return mem_grow(&it->made, &it->cap_made, it->n, sizeof *it->made);
}

static bool take_in(IrradianceCache *it)
{
    for (size_t i = 0; i < it->n; i++)
        if (!irradiance_insert(&it->store, &it->made[i]))
            return false;
    it->n = 0;
    return true;
}

static uint64_t units(Integrator *base, const Film *f, uint32_t pass, int phase)
{
    IrradianceCache *it = (IrradianceCache *)base;

    (void)f, (void)pass;
    if (!it->overture || base->failed)
        return 0;
    base->failed = !(phase % 2 ? list_places(it) : take_in(it));
    return base->failed ? 0 : phase == PHASES - 1 ? 0 : phase % 2 ? it->n : it->h;
}

static void run(Integrator *base, Film *f, uint32_t pass, int phase, uint64_t unit, Tracer *t)
{
    IrradianceCache *it = (IrradianceCache *)base;

    (void)f, (void)pass;
    if (phase % 2)
        make(it, unit, t);
    else
        look(it, phase / 2, (uint32_t)unit, t);
}

/* ---- what lasts: the records of tiles; those of the overture are made again ---- */

enum { RECORD_FLOATS = sizeof(IrradianceRecord) / sizeof(float) };

static void save(const Integrator *base, Saving *s)
{
    const IrradianceCache *it = (const IrradianceCache *)base;

    for (size_t k = 0; k < it->ntiles; k++) {
        save_u32(s, (uint32_t)it->tiles[k].n);
        for (int i = 0; i < it->tiles[k].n; i++) {
            float v[RECORD_FLOATS];
            memcpy(v, &it->tiles[k].records[i], sizeof v);
            for (int j = 0; j < RECORD_FLOATS; j++)
                save_float(s, v[j]);
        }
    }
}

static bool load(Integrator *base, Loading *l)
{
    IrradianceCache *it = (IrradianceCache *)base;

    for (size_t k = 0; k < it->ntiles; k++) {
        uint32_t n = load_u32(l);
        if (n > TILE_RECORDS)
            return false;
        it->tiles[k].n = (int)n;
        for (uint32_t i = 0; i < n; i++) {
            float v[RECORD_FLOATS];
            for (int j = 0; j < RECORD_FLOATS; j++)
                v[j] = load_float(l);
            memcpy(&it->tiles[k].records[i], v, sizeof v);
        }
    }
    return !l->beyond;
}

/* ---- opening ---- */

static bool prepare(Integrator *base, const Film *f, uint64_t seed)
{
    IrradianceCache *it = (IrradianceCache *)base;

    (void)seed;
    it->x0 = f->x0;
    it->y0 = f->y0;
    it->w = f->w;
    it->h = f->h;
    it->pixel = 2.0f * base->scene->radius / (float)f->full_w;
    if (!it->overture) {
        it->tiles_across = (f->w + FILM_TILE - 1) / FILM_TILE;
        it->tiles = MEM_ARRAY(Tile, film_ntiles(f));
        it->ntiles = film_ntiles(f);
        return it->tiles != NULL;
    }
    it->wanted = MEM_ARRAY(bool, (size_t)f->w * f->h);
    return it->wanted && irradiance_init(&it->store, base->scene->bounds, it->a * it->overlap);
}

static void close_cache(Integrator *base)
{
    IrradianceCache *it = (IrradianceCache *)base;

    irradiance_clear(&it->store);
    lighting_clear(&it->lighting);
    mem_free(it->wanted);
    mem_free(it->places);
    mem_free(it->made);
    mem_free(it->tiles);
    mem_free(it);
}

static Integrator *open_cache(const Scene *s, const Opts *o)
{
    IrradianceCache *it = MEM_NEW(IrradianceCache);

    if (!it)
        return NULL;
    it->base.scene = s;
    it->maxdepth = (int)opt_int(o, "maxdepth");
    it->roulette = (int)opt_int(o, "roulette");
    it->rays = (int)opt_int(o, "rays");
    it->a = opt_float(o, "accuracy");
    it->overlap = opt_float(o, "overlap");
    it->least = opt_float(o, "minspacing");
    it->most = f_max(it->least, opt_float(o, "maxspacing"));
    it->gradients = opt_bool(o, "gradients");
    it->overture = opt_bool(o, "overture");
    if (warn_of_scattering(s, "irradiancecache") &&
        lighting_init(&it->lighting, s, o, true, false)) {
        lighting_shares(&it->lighting, 1, 1);
        return &it->base;
    }
    close_cache(&it->base);
    return NULL;
}

static const OptDef options[] = {
    { .key = "accuracy", .type = OPT_FLOAT, .num = 0.2, .lo = 0.01, .hi = 1,
      .help = "error at which a record ends, by Ward's estimate: less of it, more records" },
    { .key = "rays", .type = OPT_INT, .num = 512, .lo = 1, .hi = HEMISPHERE_RAYS_MOST,
      .help = "about so many for each record" },
    { .key = "gradients", .type = OPT_BOOL, .num = 1,
      .help = "records say how the light changes when one turns or moves" },
    { .key = "overture", .type = OPT_BOOL, .num = 1,
      .help = "all records are made before the picture; false: when a pixel lacks one, by tiles "
              "of the film, whose edges show" },
    { .key = "overlap", .type = OPT_FLOAT, .num = 1.5, .lo = 1, .hi = 4,
      .help = "pixels use records so much further than where the overture wants a new one" },
    { .key = "minspacing", .type = OPT_FLOAT, .num = 3, .lo = 0.01, .hi = 1e6,
      .help = "least reach of a record, pixels" },
    { .key = "maxspacing", .type = OPT_FLOAT, .num = 64, .lo = 0.01, .hi = 1e6,
      .help = "most reach of a record, pixels" },
    { .key = "maxdepth", .type = OPT_INT, .num = 9, .lo = 0, .hi = 100000,
      .help = "most scattering events of a path; 0 shows lights only, 1 uses no records" },
    { .key = "roulette", .type = OPT_INT, .num = 4, .lo = 1, .hi = 100000, .also = "rrdepth",
      .help = "first scattering event after which a path may end by chance" },
    LIGHTING_HEURISTIC,
    LIGHTING_SKY,
    LIGHTING_LIGHTSAMPLER,
    { .key = NULL }
};

const IntegratorKind integrator_irradiancecache = {
    .info = { "irradiancecache", "Cline07 7.5; Ward88; WardHeckbert92",
              "indirect light of matt surfaces, interpolated between few places", options },
    .truth = BIASED, .misses = "detail of indirect light between its records",
    .open = open_cache, .close = close_cache, .prepare = prepare, .radiance = radiance,
    .phases = PHASES, .units = units, .run = run, .save = save, .load = load
};
