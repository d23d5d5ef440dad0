/* path.c -- path tracing.
 *
 * Source      [Cline07 7.4, 4.4.3], [GIRT 2.2.2], [Veach97] for the power heuristic.
 * Idea        An eye path grows by sampling the BSDF. At each vertex it may be completed in two
 *             ways: implicitly, by meeting a light, and explicitly, by a connection to a sampled
 *             point of one. Each path that both ways can make is weighted by the heuristic on the
 *             two densities per solid angle, so that the weights of a path sum to 1. Or one
 *             connection is kept of many candidates by both ways, see resample.c, and implicit
 *             paths count only where there was none to make: after delta events. Or the sky has a
 *             connection of its own at each vertex, see twostage.h, and so have lamps with
 *             pictures: they are met only after delta events; other lights go by both ways then.
 *             What a guide has learned may have a say in all decisions, see guide.h and swarm.c.
 * Where       implicit paths: [Cline07 fig. 7.5]; explicit: [Cline07 fig. 7.6]; p_length: roulette
 * Invariants  throughput = product of f |cos| / pdf_w / roulette so far, so an implicit path adds
 *             throughput * Le. E[radiance] = L for every strategy that can find the light.
 * Departs     Roulette uses the largest channel of the throughput (with the radiance scale of
 *             refraction taken out), not the reflectance of one vertex: dark chains end sooner.
 *             Directions that the shading normal allows and the geometric one does not are black.
 * Read first  integrator.h, then lightsampling/power.c and bsdf/diffuse.c. */
#include "base/mem.h"
#include "integrators/glints.h"
#include "integrators/guide.h"
#include "integrators/lighting.h"
#include "integrators/twostage.h"

typedef enum { IMPLICIT, EXPLICIT, MIS } Ways;

typedef struct {
    Integrator base;
    LightSampler *lights;       /* owned by `lighting` */
    Lighting lighting;          /* owned */
    Ways  ways;
    bool  power;                /* power heuristic; else balance */
    int   maxdepth;             /* most vertices between eye and light */
    int   roulette;             /* first bounce that may end the path */
    Glints glints;              /* owned */
    bool  resamples;            /* explicit paths are resampled: */
    Resampling resampling;
    bool  maps;                 /* the sky is asked by its map: */
    TwoStage two;               /* owned, if so; `lights` is that of its others then */
} Path;

/* The path so far: what the next vertex needs to know of the last one. */
typedef struct {
    Beam beam;
    V3   p, n;                  /* last vertex, for the density of having asked for a light there */
    float pdf_w;                /* of the last direction; 0: the eye or a delta event */
    float glint;                /* of the light by delta events after a smooth one: this share */
} Eye;

/* Weight of an implicit path that ends on light l, met along the last direction. *asked: where that
 * could have been asked for, the density with which the light is, by itself; else as it was. */
static float implicit_weight(const Path *it, const Eye *e, const Light *l, const Surface *hit,
                             const Tracer *t, float *asked)
{
    float pdf;

    if (e->pdf_w == 0.0f)
        return e->glint;        /* no other way could have made it */
    if (it->ways == IMPLICIT)
        return 1.0f;
    if (it->ways == EXPLICIT || (it->maps && twostage_asks(&it->two, l)))
        return 0.0f;
    pdf = LIKELY(!t->guide) ? it->lights->kind->pmf(it->lights, e->p, e->n, l)
                            : guide_light_pmf(t->guide, it->lights, e->p, e->n, l) *
                              guide_point_pdf(t->guide, l, it->lighting.beside, e->beam.ray.d);
    *asked = light_pdf_w(l, it->lighting.beside, e->p, e->beam.ray.d, hit);
    return mis_weight(it->power, e->pdf_w, pdf * *asked);
}

static Rgb implicit_light(const Path *it, const Eye *e, const Light *l, const Surface *hit,
                          Tracer *t)
{
    Rgb L = l->kind->radiance(l, e->beam.ray.d, hit), c;
    float asked = 0.0f;

    if (rgb_black(L))
        return L;
    c = rgb_scale(rgb_mul(e->beam.throughput, L), implicit_weight(it, e, l, hit, t, &asked));
    tracer_tally(t, e->beam.depth + 1, STRATEGY_IMPLICIT, c);
    if (UNLIKELY(t->guide != NULL) && asked > 0.0f)
        guide_met(t->guide, l, it->lighting.beside, e->beam.ray.d, e->pdf_w / asked, c);
    return c;
}

/* Light from beyond the scene. */
static Rgb implicit_sky(const Path *it, const Eye *e, Tracer *t)
{
    const Scene *s = it->base.scene;
    Rgb sum = rgb_all(0.0f);

    for (size_t i = 0; i < s->ninfinite; i++) {
        const Light *l = s->infinite[i];
        if (it->maps && e->pdf_w > 0.0f && l == it->two.light)
            l = it->two.remainder;            /* the rest of it was asked for */
        if (l)
            sum = rgb_add(sum, implicit_light(it, e, l, NULL, t));
    }
    return sum;
}

/* ---- explicit paths ---- */

/* An explicit path of so many edges, which adds c unless anything stands in the ray's way. */
typedef struct {
    Ray  ray;
    Rgb  c;
    int  edges;
    uint32_t medium;            /* that the ray starts in */
    bool known;                 /* that nothing does */
} Connection;

/* A direction to one light from p; n as light samplers take it. *pdf: that of having chosen this
 * light and this direction. NULL: none. */
INLINE const Light *towards_light(const Path *it, const Eye *e, V3 p, V3 n, Tracer *t,
                                  LightSample *ls, float *pdf)
{
    float pmf, left;
    float u = it->base.scene->nlights > 1
                  ? sample_1d(&t->sampler, DECISION(DECIDE_LIGHT, e->beam.depth)) : 0.0f;
    const Light *l = LIKELY(!t->guide) ? it->lights->kind->pick(it->lights, p, n, u, &pmf, &left)
                                       : guide_light(t->guide, it->lights, p, n, u, &pmf);

    if (!l || !light_sample(l, it->lighting.beside, p,
                            sample_2d(&t->sampler, DECISION(DECIDE_LIGHT_POINT, e->beam.depth)),
                            ls))
        return NULL;
    *pdf = pmf * ls->pdf_w;
    if (UNLIKELY(t->guide != NULL))
        guide_points(t->guide, l, it->lighting.beside, ls, pdf);
    return l;
}

/* Density with which the path goes on from the vertex that way. */
static float scatter_pdf_w(const Vertex *v, V3 wi, V3 local, const Tracer *t)
{
    float pdf_w = vertex_pdf_w(v, local);
    return LIKELY(!t->guide) ? pdf_w : guide_pdf_w(t->guide, wi, pdf_w);
}

/* Connects the vertex to one light. False: that would add nothing. */
static bool connect(const Path *it, const Eye *e, const Vertex *v, Tracer *t, Connection *to)
{
    LightSample ls;
    float weight = 1.0f, pdf;
    const Light *l = towards_light(it, e, v->s.p, vertex_up(v), t, &ls, &pdf);
    Rgb f_cos;
    V3 local;

    if (!l || !vertex_local(v, ls.wi, &local))
        return false;
    f_cos = vertex_f_cos(v, local);
    if (rgb_black(f_cos))
        return false;
    if (it->ways == MIS && !l->kind->delta)
        weight = mis_weight(it->power, pdf, scatter_pdf_w(v, ls.wi, local, t));
    to->c = rgb_scale(rgb_mul(rgb_mul(e->beam.throughput, f_cos), ls.L), weight / pdf);
    to->ray = shadow_ray(&v->s, &ls);
    to->edges = e->beam.depth + 2;
    to->medium = medium_beyond(&v->s, ls.wi, e->beam.medium);
    return true;
}

/* The same from a scattering at p. Its phase function is both f |cos| and the density. */
static bool connect_in_medium(const Path *it, const Eye *e, V3 p, Tracer *t, Connection *to)
{
    Surface s = { .p = p, .time = e->beam.ray.time };
    LightSample ls;
    float phase, weight = 1.0f, pdf;
    const Light *l = towards_light(it, e, p, s.ns, t, &ls, &pdf);

    if (!l)
        return false;
    phase = phase_pdf_w(it->base.scene->media[e->beam.medium].g, e->beam.ray.d, ls.wi);
    if (it->ways == MIS && !l->kind->delta)
        weight = mis_weight(it->power, pdf, phase);
    to->c = rgb_scale(rgb_mul(e->beam.throughput, ls.L), phase * weight / pdf);
    to->ray = shadow_ray(&s, &ls);
    to->edges = e->beam.depth + 2;
    to->medium = e->beam.medium;
    return true;
}

/* The event at hand: at the vertex, or (v NULL) at p in a medium. */
static Turn turn_of(const Path *it, const Eye *e, const Vertex *v, V3 p)
{
    const Beam *b = &e->beam;

    return v ? turn_on(v, b->ray.d, b->medium, b->depth)
             : turn_within(it->base.scene, p, b->ray.d, b->ray.time, b->medium, b->depth);
}

/* By one of many candidates. Those by the BSDF stand for implicit paths, which count only after
 * delta events then, as for strategy=explicit. */
static bool connect_resampled(const Path *it, const Eye *e, const Turn *u, Tracer *t,
                              Connection *to)
{
    Candidate c;

    if (!resample_one(&it->lighting, &it->resampling, u, t, &c))
        return false;
    to->c = rgb_mul(e->beam.throughput, c.c);
    to->ray = c.ray;
    to->edges = e->beam.depth + 2;
    to->medium = c.medium;
    to->known = c.known;
    return true;
}

static bool connect_any(const Path *it, const Eye *e, const Vertex *v, Tracer *t, Connection *to)
{
    Turn u;

    to->known = false;
    if (LIKELY(!it->resamples))
        return connect(it, e, v, t, to);
    u = turn_of(it, e, v, v->s.p);
    return connect_resampled(it, e, &u, t, to);
}

static bool connect_any_in_medium(const Path *it, const Eye *e, V3 p, Tracer *t, Connection *to)
{
    Turn u;

    to->known = false;
    if (LIKELY(!it->resamples))
        return connect_in_medium(it, e, p, t, to);
    u = turn_of(it, e, NULL, p);
    return connect_resampled(it, e, &u, t, to);
}

/* The connection to the sky by its map, beside that to another light; v NULL: in a medium. */
static bool connect_to_sky(const Path *it, const Eye *e, const Vertex *v, V3 p, Tracer *t,
                           Connection *to)
{
    Turn u = turn_of(it, e, v, p);
    PartitionSample s;
    Partition part;
    Candidate c;

    if (!twostage_partition(&it->two, &u, 1, t, &part))
        return false;
    partition_warp(&part, sample_2d(&t->sampler, DECISION(DECIDE_SKY, e->beam.depth)), &s);
    if (!twostage_candidate(&it->two, &s, &u, 1.0f, &c))
        return false;
    *to = (Connection){ c.ray, rgb_mul(e->beam.throughput, c.c), e->beam.depth + 2, c.medium,
                        false };
    return true;
}

/* Light that the connection brings. */
static Rgb connection_light(Connection *to, Tracer *t)
{
    if (!to->known && !tracer_passes(t, &to->ray, to->medium, &to->c))
        return rgb_all(0.0f);
    tracer_tally(t, to->edges, STRATEGY_EXPLICIT, to->c);
    if (UNLIKELY(t->guide != NULL))
        guide_connected(t->guide, to->c);
    return to->c;
}

/* Lamps with pictures, and the sky by colour: each has a connection. */
static Rgb asked(const Path *it, const Eye *e, const Vertex *v, V3 p, Tracer *t)
{
    Turn u = turn_of(it, e, v, p);
    Rgb sum = rgb_all(0.0f);
    Candidate c;

    for (int k = 0; k < it->two.nasked; k++)
        if (twostage_asked_candidate(&it->two, k, &u, t, &c)) {
            Connection to = { c.ray, rgb_mul(e->beam.throughput, c.c), e->beam.depth + 2, c.medium,
                              false };
            sum = rgb_add(sum, connection_light(&to, t));
        }
    return sum;
}

/* ---- implicit paths ---- */

/* What deltas bring by directions that the path does not take. */
static Rgb glints(const Path *it, const Eye *e, const Vertex *v, Tracer *t)
{
    Beam b = e->beam;

    b.way = -1.0f;
    return glints_light(&it->glints, v, &b, t);
}

/* Takes the path one scattering event further. False: it ends here. */
static bool scatter(const Path *it, Eye *e, const Vertex *v, Tracer *t)
{
    BsdfSample bs;

    if (LIKELY(!t->guide) ? !vertex_sample(v, t, e->beam.depth, &bs)
                          : !guide_scatters(t->guide, v, t, &e->beam, &bs))
        return false;
    if (bs.pdf_w > 0.0f)
        e->glint = glints_share(&it->glints);
    e->p = v->s.p;
    e->n = vertex_up(v);
    e->pdf_w = bs.pdf_w;
    beam_turn(&e->beam, v, &bs);
    return beam_survives(&e->beam, it->roulette, t);
}

static bool scatter_in_medium(const Path *it, Eye *e, V3 p, Tracer *t)
{
    float g = t->scene->media[e->beam.medium].g;
    V3 wi = phase_sample(g, e->beam.ray.d, sample_2d(&t->sampler,
                                                DECISION(DECIDE_DIRECTION, e->beam.depth)));

    e->pdf_w = phase_pdf_w(g, e->beam.ray.d, wi);
    e->beam.ray.o = e->p = p;
    e->n = v_all(0.0f);
    e->glint = 1.0f;
    e->beam.way = -1.0f;
    e->beam.ray.d = wi;
    e->beam.ray.tmax = INFINITY;
    e->beam.depth++;
    return beam_survives(&e->beam, it->roulette, t);
}

/* What is decided at one event: both connections first, then their rays: the processor works on the
 * two side by side. */
typedef struct {
    Connection to, sky;
    bool connects, shows_sky, goes_on;
} Step;

/* Returns light that needs no more rays. */
INLINE Rgb step_on_surface(const Path *it, Eye *e, Vertex *v, Tracer *t, Step *s)
{
    Rgb sum = rgb_all(0.0f);
    bool smooth;

    vertex_make(v, it->base.scene, e->beam.ray.d);
    smooth = vertex_is_smooth(v);
    if (UNLIKELY(t->guide != NULL))
        guide_turns(t->guide, &e->beam, smooth);
    s->connects = it->ways != IMPLICIT && smooth && connect_any(it, e, v, t, &s->to);
    if (it->glints.n > 1 && smooth)
        sum = rgb_add(sum, glints(it, e, v, t));
    s->shows_sky = it->maps && smooth && connect_to_sky(it, e, v, v->s.p, t, &s->sky);
    if (it->two.nasked && smooth)
        sum = rgb_add(sum, asked(it, e, v, v->s.p, t));
    s->goes_on = scatter(it, e, v, t);
    return sum;
}

INLINE Rgb step_in_medium(const Path *it, Eye *e, V3 p, Tracer *t, Step *s)
{
    Rgb sum = rgb_all(0.0f);

    if (UNLIKELY(t->guide != NULL))
        guide_turns(t->guide, &e->beam, true);
    s->connects = it->ways != IMPLICIT && connect_any_in_medium(it, e, p, t, &s->to);
    s->shows_sky = it->maps && connect_to_sky(it, e, NULL, p, t, &s->sky);
    if (it->two.nasked)
        sum = asked(it, e, NULL, p, t);
    s->goes_on = scatter_in_medium(it, e, p, t);
    return sum;
}

static Rgb radiance(const Integrator *base, const Ray *r, Tracer *t)
{
    const Path *it = (const Path *)base;
    const Scene *scene = base->scene;
    Eye e = { .beam = beam_from_eye(r, scene), .p = r->o, .glint = 1.0f };
    Rgb sum = rgb_all(0.0f);

    if (UNLIKELY(t->guide != NULL))
        guide_starts(t->guide, &e.beam);
    for (;;) {
        Vertex v;
        V3 p = { 0, 0, 0 };                     /* of a scattering in a medium */
        Step s;
        Event event = beam_flies(&e.beam, &v.s, &p, t);
        if (UNLIKELY(t->guide != NULL))
            guide_flies(t->guide, &e.beam, sum);
        if (event == ESCAPES)
            return rgb_add(sum, implicit_sky(it, &e, t));
        if (event == ARRIVES && v.s.shape->light != NO_LIGHT)
            sum = rgb_add(sum, implicit_light(it, &e, scene_light_of(scene, &v.s), &v.s, t));
        if (e.beam.depth >= it->maxdepth)
            return sum;
        sum = rgb_add(sum, event == ARRIVES ? step_on_surface(it, &e, &v, t, &s)
                                            : step_in_medium(it, &e, p, t, &s));
        if (s.connects)
            sum = rgb_add(sum, connection_light(&s.to, t));
        if (s.shows_sky)
            sum = rgb_add(sum, connection_light(&s.sky, t));
        if (UNLIKELY(t->guide != NULL))
            guide_leaves(t->guide, sum);
        if (!s.goes_on)
            return sum;
    }
}

static void close_path(Integrator *base)
{
    Path *it = (Path *)base;

    glints_clear(&it->glints);
    twostage_clear(&it->two);
    lighting_clear(&it->lighting);
    mem_free(it);
}

/* By lights' maps, if there are lights that have some. */
static bool open_map(Path *it, const Scene *s, const Opts *o)
{
    if (!opt_is(o, "strategy", "twostage"))
        return true;
    if (!twostage_init(&it->two, s, o, false))
        return false;
    it->maps = it->two.light || it->two.nasked;
    it->lights = it->two.others.lights;
    return true;
}

static Integrator *open_path(const Scene *s, const Opts *o)
{
    Path *it = MEM_NEW(Path);

    if (!it)
        return NULL;
    it->base.scene = s;
    it->resamples = opt_is(o, "strategy", "ris");
    it->ways = opt_is(o, "strategy", "implicit") ? IMPLICIT
               : opt_is(o, "strategy", "explicit") || it->resamples ? EXPLICIT : MIS;
    it->power = opt_is(o, "heuristic", "power");
    it->maxdepth = (int)opt_int(o, "maxdepth");
    it->roulette = (int)opt_int(o, "roulette");
    it->resampling = resampling_of((int)opt_int(o, "tentative"), 1, opt_float(o, "lightshare"));
    if (lighting_init(&it->lighting, s, o, it->resamples, false)) {
        it->lights = it->lighting.lights;
        if (it->resamples)
            lighting_shares(&it->lighting, it->resampling.by_light, it->resampling.by_scattering);
        else if (it->ways == MIS)
            lighting_shares(&it->lighting, 1, 1);
        if (glints_init(&it->glints, s, (int)opt_int(o, "glints"), it->maxdepth) &&
            (it->ways != IMPLICIT || lighting_warn_of_deltas(s, "implicit")) && open_map(it, s, o))
            return &it->base;
    }
    close_path(&it->base);
    return NULL;
}

static const OptDef options[] = {
    MAXDEPTH_OPTION,
    { .key = "strategy", .type = OPT_CHOICE, .str = "mis",
      .choices = "implicit explicit mis ris twostage",
      .help = "how paths are completed: by meeting lights, by asking for them, by both; by one of "
              "many candidates; twostage: asking the sky, and rectangles with pictures, by their "
              "product with the surface, other lights as mis" },
    LIGHTING_HEURISTIC,
    LIGHTING_SKY,
    ROULETTE_OPTION(4),
    LIGHTING_LIGHTSAMPLER,
    { .key = "glints", .type = OPT_INT, .num = 1, .lo = 1, .hi = GLINTS_MOST,
      .help = "directions tried at a vertex for the light that comes by delta events alone; about "
              "4 where small lamps make caustics" },
    { .key = "tentative", .type = OPT_INT, .num = 8, .lo = 1, .hi = TENTATIVE_MOST,
      .help = "strategy=ris: candidates without shadow rays, of which one is kept" },
    { .key = "lightshare", .type = OPT_FLOAT, .num = 0.5, .lo = 0, .hi = 1,
      .help = "strategy=ris: part of the candidates that go by lights, the others by the surface" },
    TWOSTAGE_SPLITS(16),
    TWOSTAGE_PEAKS,
    TWOSTAGE_F,
    { .key = NULL }
};

const IntegratorKind integrator_path = {
    .info = { "path", "Cline07 7.4; GIRT 2.2.2",
              "path tracing, implicit and explicit light paths combined", options },
    .truth = UNBIASED, .misses = "point and distant lights seen through delta surfaces",
    .open = open_path, .close = close_path, .radiance = radiance
};
