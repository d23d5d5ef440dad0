/* mlt.c -- Metropolis light transport: chains of paths that move about the picture.
 *
 * Source      [Cline07 7.11, 7.12, figs 7.23, 7.24; errata 7.3, 7.4, 7.5, 7.10], [Veach97 11].
 * Idea        A chain goes from path to path: by a small move, see mutations.h, or now and then to
 *             a new path, see bothpaths.h; it comes to each in proportion to the luminance of its
 *             colour. So where light is found it is looked at from near by, pixel after pixel.
 * New paths   have a number of edges and a way to be made first, by chances that the samples among
 *             which chains begin have told, see bothpaths.h. Their density is the sum over all
 *             ways, each with its chance. Their mean goes on to refine how bright the picture is.
 * States      count alike, whatever their colour, for it is as states of this one measure that
 *             their mutations are weighed: Chain.brightness is 1, or 0 before any light is found.
 * Direct      light is left to `direct` with direct=yes, one sample of each pixel a pass: paths are
 *             those of which another event than the last is smooth. Direct light is found well by
 *             sampling, and chains would spend most of their time on it.
 * Invariants  Everything but the b of chains.h is unbiased at every step. */
#include "integrators/bothpaths.h"
#include "integrators/chains.h"
#include "integrators/mutations.h"

#include "base/mem.h"

typedef struct {
    Chains chains;
    BothPaths paths;            /* owned */
    Mutator mutator;
    float fresh;                /* share of new paths */
    int   each;                 /* steps a pixel in a pass */
    ByWay chance;               /* of being chosen for a new path */
} Mlt;

typedef struct {
    Chain base;
    LightPath x;                /* the state, */
    double now;                 /* and its as_new(); below 0: not worked out yet */
    Vertex *storage;            /* owned: rooms for three paths */
    Vertex *rooms[LIGHTPATH_MOST], *back[LIGHTPATH_MOST];       /* those that x has not */
    ByWay  squares;             /* of the brightness of the first samples */
} PathChain;

/* ---- storage ---- */

static int rooms_of(const Mlt *it) { return it->paths.eye.maxdepth + 2; }

static bool init_chain(Chains *cs, Chain *base)
{
    PathChain *c = (PathChain *)base;
    int n = rooms_of((Mlt *)cs);

    c->storage = MEM_ARRAY(Vertex, 3 * (size_t)n);
    if (!c->storage)
        return false;
    for (int i = 0; i < n; i++) {
        c->x.v[i].at = &c->storage[i];
        c->rooms[i] = &c->storage[n + i];
        c->back[i] = &c->storage[2 * n + i];
    }
    return true;
}

static void clear_chain(Chain *base) { mem_free(((PathChain *)base)->storage); }

static void anywhere(const Mlt *it, LightPath *p, Places where, Tracer *t)
{
    p->pixel = places_at(where, sample_2d(&t->sampler, DECISION(DECIDE_PIXEL, 0)));
    eyepath_begins(it->chains.base.scene, p, t);
}

/* ---- samples to start with ---- */

/* One of all paths that a sample finds is kept, by its brightness. */
typedef struct {
    const Mlt *it;
    PathChain *c;
    Rng   r;
    double sum;
} Choice;

static void consider(void *ctx, const LightPath *p, int by, double scale, Tracer *t)
{
    Choice *choice = ctx;
    PathChain *c = choice->c;
    double light = bothpath_brightness(&choice->it->paths, p, scale, canvas_places(t->canvas));

    choice->sum += light;
    c->squares.of[p->edges][by] += light * light;
    if (rng_unit(&choice->r) * choice->sum < light) {
        Vertex *mine[LIGHTPATH_MOST];
        for (int i = 1; i < p->edges; i++)
            mine[i] = c->x.v[i].at;
        path_copies(&c->x, p, mine, t->scene);
    }
}

static float start(Chains *cs, Chain *base, uint64_t number, Tracer *t)
{
    PathChain *c = (PathChain *)base;
    const Mlt *it = (const Mlt *)cs;
    Choice choice = { it, c, { key_with(cs->seed, ~number), 0 }, 0.0 };
    Places where = canvas_places(t->canvas);
    LightPath p;

    sampler_pixel(&t->sampler, UINT32_MAX, (uint32_t)(number >> 32));
    sampler_start(&t->sampler, (uint32_t)number);
    anywhere(it, &p, where, t);
    c->now = -1.0;
    bothpath_traced(&it->paths, &p, c->rooms, c->back, where, t, consider, &choice);
    return (float)choice.sum;
}

/* By what the samples brought, in the order of the chains. */
static void learn_chances(Mlt *it)
{
    for (size_t k = 0; k < it->chains.n; k++)
        byway_add(&it->paths, &it->chance, &((PathChain *)chains_at(&it->chains, k))->squares);
    byway_becomes_chances(&it->paths, &it->chance);
}

static uint64_t units(Integrator *base, const Film *f, uint32_t pass, int phase)
{
    Mlt *it = (Mlt *)base;

    if (pass == 0 && phase == 1 && !it->chains.begun)
        learn_chances(it);
    return chains_units(base, f, pass, phase);
}

/* ---- steps ---- */

/* Brightness over density: the same for all states that new paths come to. */
static double as_new(const Mlt *it, const LightPath *p, Places where)
{
    double density = bothpath_density(&it->paths, &it->chance, p, where);
    return density > 0.0 ? bothpath_brightness(&it->paths, p, 1.0 / density, where) : 0.0;
}

/* A new path; its probability to be accepted. */
static double renewed(const Mlt *it, PathChain *c, LightPath *y, double *as, Rng *r, Tracer *t)
{
    Places where = canvas_places(t->canvas);
    double light = 0.0;

    sampler_pixel(&t->sampler, (uint32_t)c->base.key, UINT32_MAX);
    sampler_start(&t->sampler, (uint32_t)c->base.steps);
    anywhere(it, y, where, t);
    if (bothpath_some(&it->paths, &it->chance, rng_unit(r), y, c->rooms, where, t))
        light = as_new(it, y, where);
    *as = light;
    c->base.found += light;
    c->base.tries++;
    if (!(light > 0.0) || c->base.brightness == 0.0f)
        return light > 0.0;
    if (c->now < 0.0)
        c->now = as_new(it, &c->x, where);
    return light < c->now ? light / c->now : 1.0;
}

static void show(Chains *cs, Chain *c, float weight, Tracer *t)
{
    (void)cs;
    path_shows(&((PathChain *)c)->x, weight, t);
}

static void step(Chains *cs, Chain *base, Tracer *t)
{
    const Mlt *it = (const Mlt *)cs;
    PathChain *c = (PathChain *)base;
    Rng r = { key_with(base->key, base->steps), 0 };
    double a, as = -1.0;
    LightPath y;
    Step s;

    base->brightness = base->brightness > 0.0f;
    a = base->brightness == 0.0f || rng_unit(&r) < it->fresh ? renewed(it, c, &y, &as, &r, t)
            : mutation_tried(&it->mutator, &c->x, &y, c->rooms, &r, t);
    s = chain_steps(cs, base, a > 0.0, (float)a, false, rng_unit(&r));
    path_shows(s.moves ? &c->x : &y, s.left, t);
    if (s.moves) {
        path_moves(&c->x, &y, c->rooms);
        c->now = as;
    }
}

/* ---- what lasts ---- */

static void save_chain(const Chains *cs, const Chain *base, Saving *s)
{
    const PathChain *c = (const PathChain *)base;

    if (base->brightness > 0.0f)
        path_save(&c->x, cs->base.scene, s);
    byway_save(&((const Mlt *)cs)->paths, &c->squares, s);
}

static bool load_chain(const Chains *cs, Chain *base, Loading *l)
{
    PathChain *c = (PathChain *)base;

    if (base->brightness > 0.0f &&
        !path_load(&c->x, rooms_of((const Mlt *)cs) - 1, cs->base.scene, l))
        return false;
    c->now = -1.0;
    byway_load(&((const Mlt *)cs)->paths, &c->squares, l);
    return true;
}

static void save_mlt(const Integrator *base, Saving *s)
{
    const Mlt *it = (const Mlt *)base;

    byway_save(&it->paths, &it->chance, s);
    chains_save(base, s);
}

static bool load_mlt(Integrator *base, Loading *l)
{
    Mlt *it = (Mlt *)base;

    byway_load(&it->paths, &it->chance, l);
    return chains_load(base, l);
}

/* ---- the integrator ---- */

static Rgb radiance(const Integrator *base, const Ray *r, Tracer *t)
{
    return integrator_radiance(((const Mlt *)base)->paths.direct, r, t);
}

static bool prepare(Integrator *base, const Film *f, uint64_t seed)
{
    Mlt *it = (Mlt *)base;

    if (!chains_prepare(base, f, seed))
        return false;
    it->chains.pixels *= (uint64_t)it->each;
    mutator_prepare(&it->mutator, f);
    return true;
}

static void close_mlt(Integrator *base)
{
    Mlt *it = (Mlt *)base;

    chains_clear(&it->chains);
    bothpaths_close(&it->paths);
    mem_free(it);
}

static const ChainKind kind = {
    .size = sizeof(PathChain), .init = init_chain, .clear = clear_chain, .start = start,
    .step = step, .show = show, .save = save_chain, .load = load_chain
};

static Integrator *open_mlt(const Scene *s, const Opts *o)
{
    Mlt *it = MEM_NEW(Mlt);

    if (!it)
        return NULL;
    it->chains.base.scene = s;
    chains_open(&it->chains, &kind, o);
    mutator_init(&it->mutator, s, o);
    it->fresh = opt_float(o, "newpath");
    it->each = (int)opt_int(o, "mutations");
    if (bothpaths_open(&it->paths, "mlt", s, o, opt_bool(o, "lamps")))
        return &it->chains.base;
    close_mlt(&it->chains.base);
    return NULL;
}

static const OptDef options[] = {
    CHAINS_OPTIONS,
    { .key = "mutations", .type = OPT_INT, .num = 4, .lo = 1, .hi = 1e6,
      .help = "steps a pixel in a pass, beside the one sample of direct light" },
    BOTHPATHS_DIRECT,
    { .key = "newpath", .type = OPT_FLOAT, .num = 0.5, .lo = 1e-3, .hi = 1,
      .help = "share of new paths among mutations" },
    { .key = "lamps", .type = OPT_BOOL, .num = 1,
      .help = "paths begin at lamps, too, and are joined with those of the eye" },
    MUTATION_OPTIONS(0.1, 0, 0),
    BOTHPATHS_OPTIONS("a sample to start with"),
    { .key = NULL }
};

const IntegratorKind integrator_mlt = {
    .info = { "mlt", "Veach97 11; Cline07 7.11, 7.12",
              "chains of paths that move about the picture", options },
    .truth = CONSISTENT,
    .misses = "point and distant lights through delta surfaces, seen through such (without lamps: "
              "all of that light through them); light that media scatter",
    .open = open_mlt, .close = close_mlt, .prepare = prepare, .radiance = radiance,
    .splats = true, .phases = CHAINS_PHASES, .anew = true, .units = units, .run = chains_run,
    .save = save_mlt, .load = load_mlt, .keeps_all = true
};
