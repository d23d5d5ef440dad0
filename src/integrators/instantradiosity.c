/* instantradiosity.c -- all light by virtual point lights: a few hundred paths from the lamps leave
 * points that shine, and every place that is seen is lit by each of them.
 *
 * Source      [Keller97], [Cline07 7.8, fig. 7.15; errata 7.7]; compensation [Kollig04].
 * Idea        See virtuallights.h. A point x that the eye sees, itself or by delta events, has
 *                 sum over i of f_x |cos x| I_i(x) V(x, i) / d^2,
 *             I_i being the intensity of light i towards x: without bias, and without noise from
 *             pixel to pixel, since all have the same lights. What there is of error one sees as
 *             shadows of single lights, and as spots near those in corners.
 * Others      Lights beyond the scene and delta lights are asked by each point themselves, as by
 *             `direct` with lights=all; the former also by a direction of the surface's own.
 * Interleave  n: pixels of a square of n x n have different lights: n^2 times as many in all, for
 *             the same time, and patterns of the n x n pixels.
 * Clamp       With the geometric term G = |cos x| |cos i| / d^2 (normals of the geometry) each
 *             light brings min(1, b / G) of what it is worth, for the bound b. Light in corners
 *             is lost. clamp is b times the squared radius of the scene, which has no unit.
 * Cut         See virtualcuts.h: many lights for the time of few, for an error that each point's
 *             own light hides.
 * Compensate  What was lost is the integral over all places y of max(0, 1 - b / G(x, y)) times
 *             what y sends to x. A ray by the model at x finds y: light that y shines or scatters
 *             is taken times that share, the latter by all virtual lights and, in turn, by a ray
 *             from y. G is below b everywhere but near by, so chains are short. The expected value
 *             is that of no bound, the variance is finite: near x it is not lights that are drawn
 *             by area, but directions.
 *             A virtual light is at no delta surface, so if the ray meets one, it is followed with
 *             the share 1: caustics are found as `path` finds them.
 * Misses      Without compensate: light that comes to what is seen by way of delta surfaces. */
#include "base/mem.h"
#include "integrators/beam.h"
#include "integrators/lighting.h"
#include "integrators/virtualcuts.h"

enum { BATCH = 64 };                    /* shadow rays at once */

typedef struct {
    Integrator base;
    VirtualLights lights;       /* owned */
    VirtualCuts cuts;           /* owned */
    Lighting lighting;          /* owned: how others are asked */
    const Light **other;        /* owned: that have to be */
    size_t nothers;
    uint32_t side;              /* sets are side * side */
    int   maxdepth, roulette;
    float bound;                /* of G; 0: none */
    bool  compensates;
} Radiosity;

/* ---- virtual lights at a point ---- */

typedef struct {
    Ray  ray[BATCH];
    Rgb  c[BATCH];              /* with the throughput to the eye */
    int  edges[BATCH];
    size_t n;
} Shadows;

static Rgb shadows_cast(Shadows *b, Tracer *t)
{
    bool blocked[BATCH];
    Rgb sum = rgb_all(0.0f);

    tracer_blocked_many(t, b->ray, blocked, b->n);
    for (size_t i = 0; i < b->n; i++)
        if (!blocked[i]) {
            tracer_tally(t, b->edges[i], STRATEGY_EXPLICIT, b->c[i]);
            sum = rgb_add(sum, b->c[i]);
        }
    b->n = 0;
    return sum;
}

/* By lights that make no longer paths than wanted: n of the run, or of those that `which` names. */
static Rgb lit_by_each(const Radiosity *it, const Beam *b, const Vertex *v, const VirtualLight *run,
                       const uint32_t *which, size_t n, Tracer *t)
{
    Rgb sum = rgb_all(0.0f);
    Shadows s;

    s.n = 0;
    for (size_t i = 0; i < n; i++) {
        const VirtualLight *l = &run[which ? which[i] : i];
        Rgb *c = &s.c[s.n];
        if (b->depth + 1 + (int64_t)l->depth > it->maxdepth)
            break;
        if (!virtuallight_reaches(&it->lights, l, v, it->bound, c, &s.ray[s.n]))
            continue;
        *c = rgb_mul(*c, b->throughput);
        s.edges[s.n] = b->depth + 2 + (int)l->depth;
        if (UNLIKELY(it->base.scene->nmedia)) {
            uint32_t medium = medium_beyond(&v->s, v_sub(l->p, v->s.p), b->medium);
            if (tracer_passes(t, &s.ray[s.n], medium, c)) {
                tracer_tally(t, s.edges[s.n], STRATEGY_EXPLICIT, *c);
                sum = rgb_add(sum, *c);
            }
        } else if (++s.n == BATCH)
            sum = rgb_add(sum, shadows_cast(&s, t));
    }
    return rgb_add(sum, shadows_cast(&s, t));
}

typedef struct { const Radiosity *it; const Beam *b; const Vertex *v; Tracer *t; } Asking;

static Rgb ask(void *ctx, uint32_t root, uint32_t light)
{
    const Asking *a = ctx;
    const VirtualLight *l = &a->it->lights.light[light];
    Rgb c;
    Ray r;

    (void)root;
    if (!virtuallight_reaches(&a->it->lights, l, a->v, a->it->bound, &c, &r) ||
        !tracer_passes(a->t, &r, medium_beyond(&a->v->s, v_sub(l->p, a->v->s.p), a->b->medium),
                       &c))
        return rgb_all(0.0f);
    return c;
}

/* The same by a cut, and by each of those that are in no tree. */
static Rgb lit_by_cut(const Radiosity *it, const Beam *b, const Vertex *v, uint32_t set, Tracer *t)
{
    const VirtualCuts *cuts = &it->cuts;
    const uint32_t *other = cuts->other + cuts->others[set];
    Rgb sum = lit_by_each(it, b, v, it->lights.light, other,
                          cuts->others[set + 1] - cuts->others[set], t);
    float throughput = rgb_max(b->throughput);
    Asking asking = { it, b, v, t };
    CutAsk q = { .ask = ask, .ctx = &asking };
    CutCluster cut[CLUSTERS_MOST];
    size_t n;

    if (!(throughput > 0.0f))
        return sum;
    q.besides = rgb_lum(sum) / throughput;
    n = virtualcut(cuts, v, set, it->maxdepth - b->depth - 1, it->bound, &q, cut);
    for (size_t i = 0; i < n; i++) {
        Rgb c = rgb_mul(b->throughput, rgb_scale(cut[i].unit, cut[i].node->power));
        const VirtualTree *tree = &cuts->tree[cuts->trees[set] + cut[i].root];
        tracer_tally(t, b->depth + 2 + (int)tree->depth, STRATEGY_EXPLICIT, c);
        sum = rgb_add(sum, c);
    }
    return sum;
}

/* ---- others ---- */

/* By a direction of the surface's own, what is beyond the scene. */
static Rgb lit_from_beyond(const Radiosity *it, const Turn *u, Tracer *t)
{
    Draw d = draw_first(t, u, DECIDE_TRY_LOBE, DECIDE_TRY_DIRECTION);
    BsdfSample bs;
    Candidate c;

    if (!turn_sample(u, d.choice, d.point, &bs) || !(bs.pdf_w > 0.0f) ||
        !candidate_beyond(&it->lighting, u, bs.wi, rgb_scale(bs.weight, bs.pdf_w), bs.pdf_w, 1.0f,
                          t, &c))
        return rgb_all(0.0f);
    return candidate_light(&c, u, t);
}

static Rgb lit_by_others(const Radiosity *it, const Beam *b, const Vertex *v, Tracer *t)
{
    Turn u = turn_on(v, b->ray.d, b->medium, b->depth);
    Rgb sum = rgb_all(0.0f);
    Draw first;

    if (!it->nothers)
        return sum;
    u.to_eye = b->throughput;
    first = draw_first(t, &u, DECIDE_LIGHT, DECIDE_LIGHT_POINT);
    for (size_t i = 0; i < it->nothers; i++) {
        Draw d = draw_number(&first, (uint32_t)i);
        Candidate c;
        if (candidate_of_light(&it->lighting, &u, it->other[i], 1.0f, d.point, 1.0f, 1.0f, t, &c))
            sum = rgb_add(sum, candidate_light(&c, &u, t));
    }
    if (it->base.scene->ninfinite)
        sum = rgb_add(sum, lit_from_beyond(it, &u, t));
    return rgb_mul(sum, b->throughput);
}

/* ---- the eye's path ---- */

/* Where it is: `from` is its last vertex if it went on from there by a smooth event. */
typedef struct {
    Beam beam;
    bool smooth;
    V3   from, n;
} Eye;

/* What of the light of the vertex at the beam's end no virtual light has brought. */
static float share_missing(const Radiosity *it, const Eye *e, const Surface *s)
{
    if (!e->smooth)
        return 1.0f;
    return 1.0f - bound_leaves(it->bound, e->n, s->ng, e->beam.ray.d,
                               v_len2(v_sub(s->p, e->from)));
}

/* Light of the vertex itself, and what it scatters. */
static Rgb light_of(const Radiosity *it, const Eye *e, const Vertex *v, float share, Tracer *t)
{
    const Scene *s = it->base.scene;
    uint32_t set = t->y % it->side * it->side + t->x % it->side;
    Rgb sum = rgb_all(0.0f);
    Beam b = e->beam;

    b.throughput = rgb_scale(b.throughput, share);
    if (v->s.shape->light != NO_LIGHT)
        sum = beam_shows(&b, scene_light_of(s, &v->s), &v->s, t);
    if (b.depth >= it->maxdepth || !vertex_is_smooth(v))
        return sum;
    if (virtualcuts_can(&it->cuts, v))
        sum = rgb_add(sum, lit_by_cut(it, &b, v, set, t));
    else
        sum = rgb_add(sum, lit_by_each(it, &b, v, it->lights.light + it->lights.set[set].first,
                                       NULL, it->lights.set[set].n, t));
    return rgb_add(sum, lit_by_others(it, &b, v, t));
}

/* On from the vertex. False: nothing comes from there that has not come already. */
static bool goes_on(const Radiosity *it, Eye *e, const Vertex *v, float share, Tracer *t)
{
    BsdfSample bs;

    if (e->beam.depth >= it->maxdepth || !vertex_sample(v, t, e->beam.depth, &bs))
        return false;
    e->smooth = bs.pdf_w > 0.0f;
    if (e->smooth && (!it->compensates || !(share > 0.0f)))
        return false;
    if (e->smooth)
        e->beam.throughput = rgb_scale(e->beam.throughput, share);
    e->from = v->s.p;
    e->n = v->s.ng;
    beam_turn(&e->beam, v, &bs);
    return beam_lasts(&e->beam, it->roulette, t);
}

/* Whether it forks at the vertex: not where it could also go on by an event that is no delta. */
static bool forks_at(const Radiosity *it, const Beam *b, const Vertex *v, Forks *forks, Tracer *t)
{
    return b->depth < it->maxdepth && !(it->compensates && vertex_is_smooth(v)) &&
           beam_forks(forks, b, v, t);
}

/* What the path finds until it ends or forks. */
static Rgb found(const Radiosity *it, const Beam *b, Forks *forks, Tracer *t)
{
    Eye e = { .beam = *b };
    Rgb sum = rgb_all(0.0f);

    for (;;) {
        Vertex v;
        float share;
        if (!beam_meets(&e.beam, &v.s, t))
            return e.smooth ? sum : rgb_add(sum, beam_shows_beyond(&e.beam, t));
        vertex_make(&v, it->base.scene, e.beam.ray.d);
        share = share_missing(it, &e, &v.s);
        if (share > 0.0f)
            sum = rgb_add(sum, light_of(it, &e, &v, share, t));
        if (forks_at(it, &e.beam, &v, forks, t) || !goes_on(it, &e, &v, share, t))
            return sum;
    }
}

static Rgb radiance(const Integrator *base, const Ray *r, Tracer *t)
{
    Beam b = beam_from_eye(r, base->scene);
    Forks forks = { .n = 0 };
    Rgb sum = rgb_all(0.0f);

    do
        sum = rgb_add(sum, found((const Radiosity *)base, &b, &forks, t));
    while (forks_next(&forks, &b));
    return sum;
}

/* ---- phases ---- */

static uint64_t units(Integrator *base, const Film *f, uint32_t pass, int phase)
{
    const Radiosity *it = (const Radiosity *)base;

    (void)f, (void)pass;
    return phase < VIRTUAL_PHASES ? virtuallights_units(&it->lights, phase)
                                  : virtualcuts_units(&it->cuts, phase - VIRTUAL_PHASES);
}

static void run(Integrator *base, Film *f, uint32_t pass, int phase, uint64_t unit, Tracer *t)
{
    Radiosity *it = (Radiosity *)base;

    (void)f, (void)pass;
    if (phase < VIRTUAL_PHASES ? !virtuallights_run(&it->lights, phase, unit, t)
                               : !virtualcuts_run(&it->cuts, phase - VIRTUAL_PHASES, unit))
        base->failed = true;
}

/* ---- opening ---- */

static void close_radiosity(Integrator *base)
{
    Radiosity *it = (Radiosity *)base;

    virtualcuts_clear(&it->cuts);
    virtuallights_clear(&it->lights);
    lighting_clear(&it->lighting);
    mem_free(it->other);
    mem_free(it);
}

/* False: memory, reported. */
static bool find_others(Radiosity *it, const Scene *s)
{
    it->other = MEM_ARRAY(const Light *, s->nlights);
    if (!it->other)
        return false;
    for (size_t i = 0; i < s->nlights; i++)
        if (!lamp_is_shape(s->lights[i]))
            it->other[it->nothers++] = s->lights[i];
    it->lighting.all = true;
    lighting_shares(&it->lighting, 1, 1);
    return true;
}

static bool warn(const Scene *s)
{
    return warn_of_scattering(s, "instantradiosity") &&
           (!scene_blurs(s) ||
            warn_at((Place){ NULL, 0, 0 }, "instantradiosity: virtual lights stand still where the "
                    "middle of the shutter's time finds them; path shows motion right"));
}

static Integrator *open_radiosity(const Scene *s, const Opts *o)
{
    Radiosity *it = MEM_NEW(Radiosity);

    if (!it)
        return NULL;
    it->base.scene = s;
    it->maxdepth = (int)opt_int(o, "maxdepth");
    it->roulette = (int)opt_int(o, "roulette");
    it->side = (uint32_t)opt_int(o, "interleave");
    it->compensates = opt_bool(o, "compensate");
    it->bound = s->radius > 0.0f ? opt_float(o, "clamp") / f_sqr(s->radius) : 0.0f;
    virtualcuts_init(&it->cuts, &it->lights, opt_float(o, "cut"), (size_t)opt_int(o, "cutsize"));
    if (virtuallights_init(&it->lights, s, (uint32_t)opt_int(o, "lights"), it->side * it->side,
                           it->maxdepth, it->roulette) &&
        lighting_init_as(&it->lighting, s, "uniform", true, true, false, false) &&
        find_others(it, s) && warn(s))
        return &it->base;
    close_radiosity(&it->base);
    return NULL;
}

static const OptDef options[] = {
    { .key = "lights", .type = OPT_INT, .num = 256, .lo = 1, .hi = VIRTUAL_PATHS, .also = "paths",
      .help = "light paths of a set: each leaves a virtual light on its lamp, and one on each "
              "surface that it meets" },
    { .key = "interleave", .type = OPT_INT, .num = 1, .lo = 1, .hi = 16,
      .help = "n: each pixel of n x n has a set of lights of its own" },
    { .key = "clamp", .type = OPT_FLOAT, .num = 0, .lo = 0, .hi = 1e30,
      .help = "most that cosines over squared distance between point and light may be, 1 being "
              "that across the radius of the scene: 100 is a tenth of it; 0: no bound" },
    { .key = "compensate", .type = OPT_BOOL,
      .help = "what the bound takes away is found by rays, and so is light by way of mirrors and "
              "glass" },
    { .key = "cut", .type = OPT_FLOAT, .num = 0, .lo = 0, .hi = 1,
      .help = "part of the light of a matt point that a cluster of lights may be off by, 0.02 is "
              "usual: one light then stands for it; 0: each light is asked" },
    { .key = "cutsize", .type = OPT_INT, .num = 1000, .lo = 16, .hi = CLUSTERS_MOST,
      .help = "cut: most clusters of a point" },
    MAXDEPTH_OPTION,
    ROULETTE_OPTION(4),
    { .key = NULL }
};

const IntegratorKind integrator_instantradiosity = {
    .info = { "instantradiosity", "Keller97; Cline07 7.8; Kollig04; Walter05",
              "a few light paths leave points that shine on everything", options },
    .truth = UNBIASED,
    .misses = "without compensate: light that comes to what is seen by way of delta surfaces, and "
              "what a bound takes away; light that media scatter; motion",
    .open = open_radiosity, .close = close_radiosity, .radiance = radiance,
    .phases = VIRTUAL_PHASES + VIRTUAL_CUT_PHASES, .units = units, .run = run
};
