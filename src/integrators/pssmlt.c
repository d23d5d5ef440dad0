/* pssmlt.c -- Metropolis light transport in the space of the numbers that paths are made of.
 *
 * Source      [Kelemen02], [Cline07 7.13; errata 7.13], [Veach97 11].
 * Idea        Another method makes light of decisions, each answered by numbers in [0, 1). All its
 *             numbers, and those that choose the place on the picture, the lens and the moment, are
 *             the state of a chain: what it splats and what it sees along the ray of the eye is
 *             f(x), the sum of luminances I(x). Small steps change all numbers a little, so that a
 *             path that found much light is followed by many of its like; large ones, whose turn
 *             comes whatever the state is, are new samples. Both are symmetric (see primary.h), so
 *             what has to be known of the other method is nothing at all.
 * Weights     See chains.h.
 * Techniques  A sample of bdpt makes paths in all ways that there are; or, with techniques=one, in
 *             a single way, which is a number of the sample as well, and counts for all the others:
 *             a length k with a probability in proportion to 1/k, one of the ways of making it with
 *             equal ones. That is multiplexing as in [Hachisuka14], and far less work a step. In
 *             small steps the way stays the same.
 * Direct      Light that was scattered once at most can be left to `path`, one sample a pixel and
 *             pass, which covers the picture evenly; chains then leave out what has so few edges,
 *             and spend their steps where they are needed.
 * Evenly      Large steps come at equal distances. All chains' together, the m-th of chain k of n
 *             being number m n + k, go to each of N cells of the picture, a pixel each, before any
 *             has its turn again, in an order of their own each time: so they cover it as samples
 *             of a pixel do: in equal time relMSE of s5 is 0.8 of that with places by chance. But a
 *             proposal must not depend on its own chain's past, and a chain that has had v turns
 *             since the order was made knows v cells that will not come. So with the probability
 *             v / N it goes to one of these, any of them, instead of the next: then all are alike
 *             likely, whatever it has seen. */
#include "base/mem.h"
#include "integrators/chains.h"
#include "sampling/pattern.h"
#include "sampling/primary.h"

#include <string.h>

enum { DIRECT_EDGES = 2 };              /* of a path from the eye by a surface to a light */

typedef struct {
    Chains chains;
    Integrator *over;           /* owned: makes the samples */
    Integrator *direct;         /* owned: shows what they leave out; NULL: nothing */
    PrimaryKernel kernel;
    int  shortest, longest;     /* edges of paths made by one technique a sample; 0, 0: by all */
    bool tallies;               /* light is held as it is tallied, since some is left out */
    uint32_t x0, y0, w, h;      /* the film's window */
} Pssmlt;

typedef struct {
    Chain base;
    Primary primary;
    SplatList light[2];         /* owned: as primary.vector */
} Walk;

/* ---- where samples look, and what is kept of them ---- */

/* The sample's place on the picture, by its own numbers. */
static void choose_place(SplatList *l, Tracer *t)
{
    Places where = canvas_places(t->canvas);

    l->place = places_at(where, sample_2d(&t->sampler, DECISION(DECIDE_PIXEL, 0)));
    l->area = places_share(where);
}

static Ray eye_ray(const Scene *s, V2 place, Tracer *t)
{
    const Camera *c = s->camera;
    V2 lens = { 0, 0 };
    float u = 0.0f;

    if (c->has_lens)
        lens = sample_2d(&t->sampler, DECISION(DECIDE_LENS, 0));
    if (scene_blurs(s))
        u = sample_1d(&t->sampler, DECISION(DECIDE_TIME, 0));
    return c->kind->ray(c, place, lens, scene_time(s, u));
}

/* Whether pixels of the window may look at the place. */
static bool is_looked_at(const Film *f, const Filter *by, V2 place)
{
    double rx = by->axis[0].radius - 0.5, ry = by->axis[1].radius - 0.5;

    return place.x >= f->x0 - rx && place.x <= f->x1 + rx && place.y >= f->y0 - ry &&
           place.y <= f->y1 + ry;
}

/* Keeps of what was found what can be seen, and returns its brightness. What the film would refuse
 * is given to it at once, so that it is counted, and is no more: no chain will take to it. pmf: of
 * having tried to find it. */
static float brightness_of(SplatList *l, float pmf, Tracer *t)
{
    Film *f = t->canvas->film;
    const Filter *by = t->canvas->filter;
    size_t n = l->n;
    double sum = 0;

    l->n = 0;
    for (size_t i = 0; i < n; i++) {
        Splat s = l->splats[i];
        s.c = rgb_scale(s.c, 1.0f / pmf);
        if (UNLIKELY(!film_takes(s.c)))
            film_splat(f, by, s.place, s.layers, s.c);
        else if (is_looked_at(f, by, s.place)) {
            l->splats[l->n++] = s;
            sum += s.layers & 1 ? rgb_lum(s.c) : 0.0f;
        }
    }
    return sum > 0 ? (float)sum : 0.0f;
}

/* Chooses a technique; returns the probability of having done so. */
static float choose_technique(const Pssmlt *it, float u, Technique *q)
{
    float sum = 0.0f, p, ways;
    int k = it->shortest, i;

    for (int n = it->shortest; n <= it->longest; n++)
        sum += 1.0f / (float)n;
    for (u *= sum; k < it->longest && u >= 1.0f / (float)k; k++)
        u -= 1.0f / (float)k;
    p = 1.0f / (float)k;
    ways = k > 1 ? (float)k + 1.0f : 1.0f;              /* lamps in plain view are met only */
    i = (int)f_min(u / p * ways, ways - 1.0f);
    *q = i == k || k == 1 ? (Technique){ k, 0, true } : (Technique){ i, k - 1 - i, false };
    return p / (sum * ways);
}

/* ---- places that cover the picture evenly ---- */

enum { STARTS = 1, STEPS = 2 };

static uint32_t cells(const Pssmlt *it) { return it->w * it->h; }

/* The cell whose turn it is: number i of the order. */
static uint32_t cell_at(const Pssmlt *it, int what, uint64_t order, uint32_t i)
{
    return permuted(i, cells(it), key_with(key_with(it->chains.seed, order), (uint64_t)what));
}

/* The cell of the m-th large step of chain k. */
static uint32_t cell_of_step(const Pssmlt *it, uint64_t k, uint64_t m, Rng *r)
{
    uint64_t n = it->chains.n, number = m * n + k;
    uint32_t i = (uint32_t)(number % cells(it)), had = (uint32_t)(i / n);
    uint32_t back = rng_below(r, cells(it));

    if (back < had)
        i -= (back + 1) * (uint32_t)n;
    return cell_at(it, STEPS, number / cells(it), i);
}

static void settle_cell(const Pssmlt *it, Walk *w, uint32_t cell)
{
    Sampler s = primary_sampler(&w->primary);

    primary_settle(&s, DECISION(DECIDE_PIXEL, 0), cell % it->w, cell / it->w, it->w, it->h);
}

/* ---- samples ---- */

/* Makes the sample that the chain's sampler proposes, and keeps back what light it brings. Returns
 * its brightness. The tracer is as it was, but for the rays that were cast. */
static float sample(const Pssmlt *it, Walk *w, Tracer *t)
{
    SplatList *l = &w->light[!w->primary.now];
    Tracer was = *t;
    Technique only;
    float pmf = 1.0f;
    Tally tally;
    Ray r;
    Rgb seen;

    l->n = 0;
    t->held = l;
    t->sampler = primary_sampler(&w->primary);
    t->x = it->x0;
    t->y = it->y0;
    t->kept = false;
    if (it->longest) {
        pmf = choose_technique(it, sample_1d(&t->sampler, DECISION(DECIDE_TECHNIQUE, 0)), &only);
        t->only = &only;
    }
    choose_place(l, t);
    film_awaits_splat(t->canvas->film, l->place);
    r = eye_ray(it->chains.base.scene, l->place, t);
    if (it->tallies)
        memset(&tally, 0, sizeof tally);
    t->tally = it->tallies ? &tally : NULL;
    seen = integrator_radiance(it->over, &r, t);
    if (!it->tallies)
        tracer_holds(t, l->place, 0, STRATEGY_IMPLICIT, rgb_scale(seen, l->area));
    was.rays = t->rays;
    was.failed = t->failed;
    *t = was;
    return brightness_of(l, pmf, t);
}

/* ---- what chains ask for ---- */

static bool walk_init(Chains *cs, Chain *c)
{
    const Pssmlt *it = (const Pssmlt *)cs;
    Walk *w = (Walk *)c;

    w->primary.kernel = &it->kernel;
    w->light[0].least = w->light[1].least = it->direct ? DIRECT_EDGES + 1 : 0;
    return true;
}

static void walk_clear(Chain *c)
{
    mem_free(((Walk *)c)->light[0].splats);
    mem_free(((Walk *)c)->light[1].splats);
}

static float walk_start(Chains *cs, Chain *c, uint64_t number, Tracer *t)
{
    Walk *w = (Walk *)c;
    const Pssmlt *it = (const Pssmlt *)cs;
    float brightness;

    primary_propose(&w->primary, key_with(cs->seed, ~number), true);
    settle_cell(it, w, cell_at(it, STARTS, number / cells(it), (uint32_t)(number % cells(it))));
    brightness = sample(it, w, t);
    primary_accept(&w->primary);
    return brightness;
}

/* Whether the chain's next step is large; *m: how many were before it. Each chain begins elsewhere
 * in the rhythm. */
static bool is_large(const Chains *cs, const Chain *c, uint64_t *m)
{
    double begin = unit_of((uint32_t)key_with(c->key, UINT64_MAX)), p = cs->kind.large;

    *m = (uint64_t)((double)c->steps * p + begin);
    return (uint64_t)((double)(c->steps + 1) * p + begin) > *m;
}

static void walk_step(Chains *cs, Chain *c, Tracer *t)
{
    const Pssmlt *it = (const Pssmlt *)cs;
    Walk *w = (Walk *)c;
    Rng rng = { key_with(c->key, c->steps), 0 };
    uint64_t m;
    bool large = is_large(cs, c, &m);
    const SplatList *proposed = &w->light[!w->primary.now], *present = &w->light[w->primary.now];
    float brightness;
    Step s;

    primary_propose(&w->primary, rng_bits(&rng), large || c->brightness == 0.0f);
    if (large)
        settle_cell(it, w, cell_of_step(it, chains_index(cs, c), m, &rng));
    brightness = sample(it, w, t);
    s = chain_steps(cs, c, brightness, chain_accepts(c, brightness), large, rng_unit(&rng));
    if (s.left > 0)
        tracer_splat_list(t, s.moves ? present : proposed, (float)s.left);
    if (s.moves)
        primary_accept(&w->primary);
}

static void walk_show(Chains *cs, Chain *c, float weight, Tracer *t)
{
    const Walk *w = (const Walk *)c;

    (void)cs;
    tracer_splat_list(t, &w->light[w->primary.now], weight);
}

/* Numbers and light of the present sample; proposals are made anew. */
static void walk_save(const Chains *cs, const Chain *c, Saving *s)
{
    const Walk *w = (const Walk *)c;
    const SplatList *l = &w->light[w->primary.now];

    (void)cs;
    primary_save(&w->primary, s);
    save_u64(s, l->n);
    save_float(s, l->place.x);
    save_float(s, l->place.y);
    save_float(s, l->area);
    for (size_t i = 0; i < l->n; i++) {
        const Splat *p = &l->splats[i];
        const float v[] = { p->place.x, p->place.y, p->c.r, p->c.g, p->c.b };
        for (int k = 0; k < 5; k++)
            save_float(s, v[k]);
        save_u32(s, p->layers);
    }
}

static bool walk_load(const Chains *cs, Chain *c, Loading *from)
{
    Walk *w = (Walk *)c;
    SplatList *l = &w->light[w->primary.now];
    uint64_t n;

    (void)cs;
    if (!primary_load(&w->primary, from))
        return false;
    n = load_u64(from);
    l->place.x = load_float(from);
    l->place.y = load_float(from);
    l->area = load_float(from);
    if (n > load_left(from) / 24 || !mem_grow(&l->splats, &l->cap, (size_t)n, sizeof *l->splats))
        return false;
    l->n = (size_t)n;
    for (size_t i = 0; i < l->n; i++) {
        float v[5];
        for (int k = 0; k < 5; k++)
            v[k] = load_float(from);
        l->splats[i] = (Splat){ { v[0], v[1] }, { v[2], v[3], v[4] }, load_u32(from) };
    }
    return true;
}

/* ---- direct light apart ---- */

static Rgb radiance(const Integrator *base, const Ray *r, Tracer *t)
{
    return integrator_radiance(((const Pssmlt *)base)->direct, r, t);
}

/* ---- opening ---- */

static bool prepare(Integrator *base, const Film *f, uint64_t seed)
{
    Pssmlt *it = (Pssmlt *)base;
    const IntegratorKind *k = it->over->kind;

    it->x0 = f->x0;
    it->y0 = f->y0;
    it->w = f->w;
    it->h = f->h;
    it->tallies = it->direct || f->layers > 1;
    return (!k->prepare || k->prepare(it->over, f, seed)) && chains_prepare(base, f, seed);
}

static void close_pssmlt(Integrator *base)
{
    Pssmlt *it = (Pssmlt *)base;

    chains_clear(&it->chains);
    integrator_close(it->over);
    integrator_close(it->direct);
    mem_free(it);
}

/* Sets an option that the other integrator may have, within what it takes. */
static void set_for(Opts *own, const char *key, double value)
{
    const OptDef *d = own->defs;

    while (d && d->key && strcmp(d->key, key))
        d++;
    if (d && d->key)
        opt_set_number(own, key, d_min(value, d->hi));
}

/* Another integrator, with what it shares of these options. NULL: reported. */
static Integrator *open_other(const IntegratorKind *k, const Scene *s, const Opts *o, int maxdepth)
{
    Opts own;

    opts_default(&own, k->info.options);
    set_for(&own, "maxdepth", maxdepth);
    set_for(&own, "roulette", (double)opt_int(o, "roulette"));
    return integrator_open(k, s, &own);
}

/* Whether its samples can be changed, as these options ask. False: reported. */
static bool check_over(const IntegratorKind *k, const Opts *o)
{
    if (!k)
        return false;
    if (!k->radiance || k->phases)
        return err_usage("pssmlt: over=%s is made of more than single samples", k->info.name);
    return k->singles || opt_is(o, "techniques", "all") ||
           err_usage("pssmlt: %s has no techniques to choose one of", k->info.name);
}

/* Only what finds all that `path` does, can leave some of it to that. */
static bool open_over(Pssmlt *it, const Scene *s, const Opts *o)
{
    int maxdepth = (int)opt_int(o, "maxdepth");
    const IntegratorKind *k = kind_find_at((Place){ NULL, 0, 0 }, integrators, "integrator",
                                           opt_string(o, "over"));
    bool apart = opt_bool(o, "direct") && k && k->truth == UNBIASED;

    if (!check_over(k, o))
        return false;
    if (!opt_is(o, "techniques", "all")) {
        it->shortest = apart ? DIRECT_EDGES + 1 : 1;
        it->longest = maxdepth + 1 > it->shortest ? maxdepth + 1 : it->shortest;
    }
    it->over = open_other(k, s, o, maxdepth);
    if (it->over && apart)
        it->direct = open_other(kind_find(integrators, "path"), s, o,
                                maxdepth < DIRECT_EDGES - 1 ? maxdepth : DIRECT_EDGES - 1);
    return it->over && (it->direct || !apart);
}

static bool check_steps(const Opts *o)
{
    return opt_float(o, "least") <= opt_float(o, "largest") ||
           err_usage("pssmlt: least=%g is more than largest=%g", (double)opt_float(o, "least"),
                     (double)opt_float(o, "largest"));
}

static Integrator *open_pssmlt(const Scene *s, const Opts *o)
{
    Pssmlt *it = MEM_NEW(Pssmlt);
    ChainKind kind = { sizeof(Walk), opt_float(o, "large"), walk_init, walk_clear, walk_start,
                       walk_step, walk_show, walk_save, walk_load };

    if (!it)
        return NULL;
    it->chains.base.scene = s;
    chains_open(&it->chains, &kind, o);
    primary_kernel(&it->kernel, opt_float(o, "least"), opt_float(o, "largest"));
    if (check_steps(o) && open_over(it, s, o))
        return &it->chains.base;
    close_pssmlt(&it->chains.base);
    return NULL;
}

static const OptDef options[] = {
    { .key = "over", .type = OPT_STRING, .str = "bdpt",
      .help = "the integrator whose samples are changed" },
    { .key = "techniques", .type = OPT_CHOICE, .str = "all", .choices = "all one",
      .help = "over=bdpt: ways of making paths that a sample tries" },
    { .key = "direct", .type = OPT_BOOL, .num = 1,
      .help = "over unbiased methods: light scattered once at most is left to path, a sample for "
              "each pixel and pass" },
    { .key = "large", .type = OPT_FLOAT, .num = 0.5, .lo = 0.001, .hi = 1,
      .help = "share of steps to new samples" },
    { .key = "least", .type = OPT_FLOAT, .num = 1.0 / 1024, .lo = 1e-6, .hi = 0.5,
      .help = "shortest move of a number in a small step" },
    { .key = "largest", .type = OPT_FLOAT, .num = 1.0 / 64, .lo = 1e-6, .hi = 0.5,
      .help = "longest one" },
    CHAINS_OPTIONS,
    MAXDEPTH_OPTION,
    ROULETTE_OPTION(1),
    { .key = NULL }
};

const IntegratorKind integrator_pssmlt = {
    .info = { "pssmlt", "Kelemen02; Cline07 7.13",
              "Metropolis light transport: chains of the numbers that samples are made of",
              options },
    .truth = CONSISTENT, .misses = "what the integrator misses whose samples it changes",
    .splats = true, .open = open_pssmlt, .close = close_pssmlt, .prepare = prepare,
    .radiance = radiance, .phases = CHAINS_PHASES, .anew = true,
    .units = chains_units, .run = chains_run, .save = chains_save, .load = chains_load,
    .keeps_all = true
};
