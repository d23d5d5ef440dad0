/* erpt.c -- energy redistribution path tracing: a path tracer whose light is spread over the
 * picture by chains of moved paths.
 *
 * Source      [Cline07 8.3, 8.4, figs 8.5 to 8.7, (8.3) to (8.7); errata 8.1 to 8.6].
 * Idea        A sample's light is energy at a path. Energy may flow from path to path so long as
 *             as much flows from x to y as from y to x (8.5): no picture's expectation changes,
 *             and a spike becomes a smooth patch.
 * Flow        equal      fig. 8.6: an energy e starts about e / (m e_d) chains of m moves, each of
 *                        which leaves e_d wherever it is after each move;
 *             detailed   as many moves from the sample alone; each takes its share times q away,
 *                        what is left stays;
 *             iterated   the same again from each of the two places, and so on: a tree of about m
 *                        leaves, where all energy ends.
 * e_d         is the mean energy of a sample over the moves that a pixel is to have (8.7). Its
 *             value is free: errors of the mean change the number of moves alone.
 * q           min(1, F(y) T(y>x) / (F(x) T(x>y))), (8.6), by mutations.h. F is the measurement, not
 *             the sampler's estimate, errata 8.3.
 * Samples     stand one in each pixel's part of the picture, in every pass; each pass by itself is
 *             right, errata 8.1. They are whole paths from the eye, whose energies differ little.
 *             Where some light is found in no other way, a path from a lamp is joined with each,
 *             see bothpaths.h, and a sample is all that both come to. Elsewhere that brings
 *             nothing, or less than it costs: in equal time relMSE was 0.013, not 0.007, in
 *             scenes/s5.pbrt, and the same in scenes/ajar-door.pbrt.
 * Departs     Of each move of equal flow both ends get their part of e_d, q and 1 - q: the mean
 *             over the decision. */
#include "integrators/bothpaths.h"
#include "integrators/mutations.h"
#include "integrators/proposals.h"

#include "base/mem.h"

typedef enum { FLOW_DETAILED, FLOW_ITERATED, FLOW_EQUAL } Flow;

enum { SAMPLES = 1 << 14, UNITS = 64 };         /* samples that tell e_d, in so many units */
enum { LEVELS_MOST = 10 };              /* of a tree: each stands on the stack */

typedef struct {
    Integrator base;
    BothPaths paths;            /* owned */
    Mutator mutator;
    Flow  flow;
    int   length;               /* m */
    int   levels;               /* of a tree with about m leaves */
    float each;                 /* moves a pixel in a pass */
    int   repeats;              /* deposits in one pixel in a row that count; 0: all */
    Proposals *proposals;       /* owned; NULL: not wanted */
    bool  median;               /* how they are smoothed, and over what square */
    int   side;
    double found[UNITS];        /* energy of each unit of samples, */
    double deposit;             /* e_d; 0: no light was found */
    uint32_t x0, y0, w, h;      /* window of the film */
} Erpt;

/* ---- flow ---- */

/* A path with rooms of its own. */
typedef struct {
    LightPath p;
    Vertex *rooms[LIGHTPATH_MOST], storage[LIGHTPATH_MOST];
} Roomy;

static void roomy_opens(Roomy *s)
{
    for (int i = 0; i < LIGHTPATH_MOST; i++)
        s->p.v[i].at = s->rooms[i] = &s->storage[i];
}

/* One move from x by some mutation: q. */
static double moved(const Erpt *it, const LightPath *x, LightPath *y, Vertex *const *rooms,
                    Rng *r, Tracer *t)
{
    double q = mutation_tried(&it->mutator, x, y, rooms, r, t);

    if (it->proposals && q > 0.0)
        proposals_add(it->proposals, y->pixel);
    return q;
}

/* How often in a row a chain has been in a pixel. */
typedef struct { int x, y, times; } Stay;

/* Whether what is deposited after one step more still counts, 8.4.4. */
static bool counts(const Erpt *it, Stay *s, V2 at)
{
    int x = (int)at.x, y = (int)at.y;

    s->times = x == s->x && y == s->y ? s->times + 1 : 1;
    s->x = x;
    s->y = y;
    return !it->repeats || s->times <= it->repeats;
}

/* One chain of fig. 8.6 from x, which it moves; rooms: for what is tried. What is deposited at a
 * path is added up till it is left. */
static void chain(const Erpt *it, LightPath *x, Vertex **rooms, Rng *r, Tracer *t)
{
    Stay stay = { -1, -1, 0 };
    double kept = 0.0;
    LightPath y;

    for (int i = 0; i < it->length; i++) {
        double q = moved(it, x, &y, rooms, r, t);
        bool moves = rng_unit(r) < q;
        double e = counts(it, &stay, moves ? y.pixel : x->pixel) ? it->deposit : 0.0;
        kept += (1.0 - q) * e;
        if (moves) {
            path_shows(x, kept, t);
            path_moves(x, &y, rooms);
            kept = q * e;
        } else
            path_shows(&y, q * e, t);
    }
    path_shows(x, kept, t);
}

static void flow_equally(const Erpt *it, const LightPath *from, int chains, Rng *r, Tracer *t)
{
    Roomy x, y;

    for (int i = 0; i < chains; i++) {
        roomy_opens(&x);
        roomy_opens(&y);
        path_copies(&x.p, from, x.rooms, t->scene);
        chain(it, &x.p, y.rooms, r, t);
    }
}

/* So many parts of the energy e look for another place, each from the sample itself. */
static void flow_in_detail(const Erpt *it, const LightPath *x, double e, int moves, Rng *r,
                           Tracer *t)
{
    double left = 0.0, part = e / moves;
    Roomy y;

    roomy_opens(&y);
    for (int i = 0; i < moves; i++) {
        double q = moved(it, x, &y.p, y.rooms, r, t);
        path_shows(&y.p, part * q, t);
        left += part * (1.0 - q);
    }
    path_shows(x, left, t);
}

/* What flows to y, and what stays at x, flows on. */
static void flow_again(const Erpt *it, const LightPath *x, double e, int levels, Rng *r, Tracer *t)
{
    Roomy y;
    double q;

    if (!levels) {
        path_shows(x, e, t);
        return;
    }
    roomy_opens(&y);
    q = moved(it, x, &y.p, y.rooms, r, t);
    if (q > 0.0)
        flow_again(it, &y.p, e * q, levels - 1, r, t);
    if (q < 1.0)
        flow_again(it, x, e * (1.0 - q), levels - 1, r, t);
}

/* ---- samples ---- */

enum { CHAINS_MOST = 1 << 20 };         /* of one sample: beyond, the rest of its energy stays */

static void redistribute(const Erpt *it, const LightPath *p, double e, Rng *r, Tracer *t)
{
    double parts = floor(rng_unit(r) + d_min(e / (it->length * it->deposit), CHAINS_MOST));
    int n = (int)parts;

    if (it->flow == FLOW_EQUAL)
        flow_equally(it, p, n, r, t);
    else if (it->flow == FLOW_DETAILED)
        flow_in_detail(it, p, e, it->length * (n > 1 ? n : 1), r, t);
    else
        flow_again(it, p, e, it->levels, r, t);
}

/* What is done with each path that a sample finds. */
typedef struct { const Erpt *it; Rng r; double found; } Use;

static void used(void *ctx, const LightPath *p, int by, double scale, Tracer *t)
{
    Use *u = ctx;
    double e = bothpath_brightness(&u->it->paths, p, scale, canvas_places(t->canvas));

    (void)by;
    u->found += e;
    if (e > 0.0 && u->it->deposit > 0.0)
        redistribute(u->it, p, e, &u->r, t);
}

/* A sample from a place of the window, from 0 to 1 across. */
static void sample_at(const Erpt *it, V2 at, Use *use, Tracer *t)
{
    Places where = canvas_places(t->canvas);
    Vertex storage[LIGHTPATH_MOST], *back[LIGHTPATH_MOST];
    Roomy s;

    for (int i = 0; i < LIGHTPATH_MOST; i++)
        back[i] = &storage[i];
    roomy_opens(&s);
    s.p.pixel = places_at(where, at);
    eyepath_begins(it->base.scene, &s.p, t);
    bothpath_traced(&it->paths, &s.p, s.rooms, back, where, t, used, use);
}

static Rgb radiance(const Integrator *base, const Ray *r, Tracer *t)
{
    const Erpt *it = (const Erpt *)base;
    V2 u = sample_2d(&t->sampler, DECISION(DECIDE_PIXEL, 0));
    Use use = { it, { key_with(t->sampler.key, t->sampler.index), 0 }, 0.0 };

    t->shots++;
    u.x = ((float)(t->x - it->x0) + u.x) / (float)it->w;
    u.y = ((float)(t->y - it->y0) + u.y) / (float)it->h;
    if (it->deposit > 0.0)
        sample_at(it, u, &use, t);
    return integrator_radiance(it->paths.direct, r, t);
}

/* ---- what is learned first ---- */

enum { FIND = 0, SETTLE = 1, PHASES = 2 };

static void settle_deposit(Erpt *it)
{
    double sum = 0.0;

    for (int k = 0; k < UNITS; k++)
        sum += it->found[k];
    it->deposit = sum / ((double)SAMPLES * it->each);           /* [Cline07 (8.7)] */
}

/* Each phase begins when all units of the one before have ended; the last has no other work. */
static uint64_t units(Integrator *base, const Film *f, uint32_t pass, int phase)
{
    Erpt *it = (Erpt *)base;

    (void)f, (void)pass;
    if (phase == SETTLE)
        settle_deposit(it);
    return phase == FIND ? UNITS : 0;
}

static void run(Integrator *base, Film *f, uint32_t pass, int phase, uint64_t unit, Tracer *t)
{
    Erpt *it = (Erpt *)base;
    Use use = { it, { 0, 0 }, 0.0 };

    (void)f, (void)pass;
    for (uint64_t i = unit; i < SAMPLES; i += UNITS) {
        V2 u;
        sampler_pixel(&t->sampler, UINT32_MAX, (uint32_t)phase);
        sampler_start(&t->sampler, (uint32_t)i);
        u = sample_2d(&t->sampler, DECISION(DECIDE_PIXEL, 0));
        sample_at(it, u, &use, t);
    }
    it->found[unit] = use.found;
}

/* ---- the integrator ---- */

static bool prepare(Integrator *base, const Film *f, uint64_t seed)
{
    Erpt *it = (Erpt *)base;

    (void)seed;
    mutator_prepare(&it->mutator, f);
    it->x0 = f->x0;
    it->y0 = f->y0;
    it->w = f->w;
    it->h = f->h;
    return !it->proposals || proposals_init(it->proposals, f, it->median, it->side);
}

static bool finish(Integrator *base, Film *f)
{
    const Proposals *p = ((const Erpt *)base)->proposals;
    return !p || proposals_even_out(p, f);
}

/* ---- what lasts ---- */

/* e_d, and what was tried. */
static void save_erpt(const Integrator *base, Saving *s)
{
    const Erpt *it = (const Erpt *)base;

    save_double(s, it->deposit);
    for (int k = 0; k < UNITS; k++)
        save_double(s, it->found[k]);
    if (it->proposals)
        film_save(&it->proposals->film, s);
}

static bool load_erpt(Integrator *base, Loading *l)
{
    Erpt *it = (Erpt *)base;

    it->deposit = load_double(l);
    for (int k = 0; k < UNITS; k++)
        it->found[k] = load_double(l);
    return !it->proposals || film_load(&it->proposals->film, l);
}

/* ---- opening ---- */

static void close_erpt(Integrator *base)
{
    Erpt *it = (Erpt *)base;

    if (it->proposals)
        proposals_clear(it->proposals);
    mem_free(it->proposals);
    bothpaths_close(&it->paths);
    mem_free(it);
}

/* False: memory, reported. */
static bool set_filters(Erpt *it, const Opts *o)
{
    it->repeats = (int)opt_int(o, "repeats");
    it->median = opt_is(o, "even", "median");
    it->side = (int)opt_int(o, "side");
    if (opt_is(o, "even", "no"))
        return true;
    it->proposals = MEM_NEW(Proposals);
    return it->proposals != NULL;
}

static void set_flow(Erpt *it, const Opts *o)
{
    it->flow = (Flow)opt_choice(o, "flow");
    it->length = (int)opt_int(o, "length");
    it->each = opt_float(o, "mutations");
    while (2 << it->levels <= it->length && it->levels < LEVELS_MOST)
        it->levels++;
}

/* Whether some light may come by ways that only paths from the lamps find. */
static bool hides_lamps(const Scene *s)
{
    bool hidden = false, glints = false;

    for (size_t i = 0; i < s->nlights; i++)
        hidden = hidden || s->lights[i]->kind->delta;
    for (size_t i = 0; i < s->nmaterials; i++)
        glints = glints || material_glints(&s->materials[i]);
    return hidden && glints;
}

static Integrator *open_erpt(const Scene *s, const Opts *o)
{
    Erpt *it = MEM_NEW(Erpt);
    bool lamps = opt_is(o, "lamps", "yes") || (opt_is(o, "lamps", "auto") && hides_lamps(s));

    if (!it)
        return NULL;
    it->base.scene = s;
    mutator_init(&it->mutator, s, o);
    it->mutator.always_caustic = opt_is(o, "choice", "exclusive");
    set_flow(it, o);
    if (bothpaths_open(&it->paths, "erpt", s, o, lamps) && set_filters(it, o))
        return &it->base;
    close_erpt(&it->base);
    return NULL;
}

static const OptDef options[] = {
    { .key = "mutations", .type = OPT_FLOAT, .num = 4, .lo = 1e-3, .hi = 1e6,
      .help = "moves a pixel and sample, about; with flow=iterated: length moves for each path" },
    { .key = "length", .type = OPT_INT, .num = 100, .lo = 1, .hi = 1e6,
      .help = "moves of a chain" },
    { .key = "flow", .type = OPT_CHOICE, .str = "equal", .choices = "detailed iterated equal",
      .help = "how energy goes from a sample to paths beside it" },
    BOTHPATHS_DIRECT,
    { .key = "lamps", .type = OPT_CHOICE, .str = "auto", .choices = "auto yes no",
      .help = "paths begin at lamps, too, and are joined with those of the eye; auto: where there "
              "are point or distant lights and delta surfaces" },
    { .key = "choice", .type = OPT_CHOICE, .str = "mixed", .choices = "mixed exclusive",
      .help = "exclusive: caustic perturbations where light comes by delta events, and nowhere "
              "else, as in the source" },
    { .key = "repeats", .type = OPT_INT, .num = 0, .lo = 0, .hi = 1e6,
      .help = "a chain's deposits in one pixel in a row that count, 10 or 20 in the source "
              "(biased); 0: all" },
    { .key = "even", .type = OPT_CHOICE, .str = "no", .choices = "no box median",
      .help = "pixels in which more moves were tried than around them get less, others more "
              "(biased); by the mean or the median of a square" },
    { .key = "side", .type = OPT_INT, .num = 7, .lo = 1, .hi = PROPOSALS_SIDE,
      .help = "of that square, pixels" },
    MUTATION_OPTIONS(0.1, 0, 0),
    BOTHPATHS_OPTIONS("a sample"),
    { .key = NULL }
};

const IntegratorKind integrator_erpt = {
    .info = { "erpt", "Cline07 8", "samples of a path tracer, spread by chains of moved paths",
              options },
    .truth = UNBIASED,
    .misses = "point and distant lights through delta surfaces, seen through such (without lamps: "
              "all of that light through them); light that media scatter; with filters of noise "
              "(even, repeats) it is biased",
    .open = open_erpt, .close = close_erpt, .prepare = prepare, .radiance = radiance,
    .splats = true, .phases = PHASES, .units = units, .run = run, .finish = finish,
    .save = save_erpt, .load = load_erpt, .keeps_all = true
};
