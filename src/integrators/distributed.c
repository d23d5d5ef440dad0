/* distributed.c -- ray tracing with all that is a mean over something sampled: pixel, lens, time,
 * lights' surfaces, reflections. But light that a matt surface reflects is direct light only.
 *
 * Source      [Shirley91 5.4.1, figs 5.6 to 5.9] after Cook, Porter and Carpenter. Pixel, lens and
 *             time are drawn by the driver.
 * Paths       Those on which light is scattered once in any way and then, on its way to the eye,
 *             only by deltas and lobes (what is not BSDF_MATT): of these the mean is right. Of matt
 *             samples the ray only looks whether it meets a light.
 * Weights     Direct light by points of lights and by directions of the BSDF, n_l and n_b times:
 *             each has weight (n p)^2 over the sum of both, [Veach97 9.2.4].
 * Splitting   lightsamples and bsdfsamples are taken at the first surface on a beam that is more
 *             than a delta, and 1 of each at the later ones: the tree is no wider than bsdfsamples.
 * Jittering   Uncorrelated: every decision of a tree is stratified over all samples of the pixel
 *             and all branches by itself, and decisions are matched by permutations: sampler_part.
 * Departs     Instead of tracing reflection and refraction both, one is chosen, again evenly. */
#include "base/mem.h"
#include "integrators/ambient.h"
#include "integrators/beam.h"
#include "integrators/lighting.h"

#include <string.h>

enum { DEPTH_MOST = 100, NUMBERS = 128 };       /* decisions of one light are so many after those of
                                                 * the last one */

typedef struct {
    Integrator base;
    LightSampler *lights;       /* owned; NULL: all are asked */
    Rgb   ambient;              /* radiance */
    bool  meetable;             /* there are lights that rays can meet */
    int   maxdepth, roulette;
    int   lightsamples, bsdfsamples;
} Distributed;

/* A beam, and what the density of having found the same light in another way depends on. */
typedef struct {
    Beam  beam;
    V3    p, n;                 /* last vertex, as light samplers take it */
    float pdf_w;                /* of the direction times samples taken; 0: the eye or a delta */
    int   asked;                /* samples of lights taken there */
    bool  split;                /* past the surface that took more than one sample */
    bool  ends;                 /* the beam only looks for lights */
} Branch;

/* ---- lights that a beam meets ---- */

static float pmf(const Distributed *it, const Branch *e, const Light *l)
{
    return it->lights ? it->lights->kind->pmf(it->lights, e->p, e->n, l) : 1.0f;
}

static Rgb met(const Distributed *it, const Branch *e, const Light *l, const Surface *hit,
               Tracer *t)
{
    Rgb c = rgb_mul(e->beam.throughput, l->kind->radiance(l, e->beam.ray.d, hit));

    if (rgb_black(c))
        return c;
    if (e->pdf_w > 0.0f)
        c = rgb_scale(c, mis_weight(true, e->pdf_w,
                                   (float)e->asked * pmf(it, e, l) *
                                       l->kind->pdf_w(l, e->p, e->beam.ray.d, hit)));
    tracer_tally(t, e->beam.depth + 1, STRATEGY_IMPLICIT, c);
    return c;
}

static Rgb met_beyond(const Distributed *it, const Branch *e, Tracer *t)
{
    const Scene *s = it->base.scene;
    Rgb sum = rgb_all(0.0f);

    for (size_t i = 0; i < s->ninfinite; i++)
        sum = rgb_add(sum, met(it, e, s->infinite[i], NULL, t));
    return sum;
}

/* ---- lights that are asked ---- */

/* One sample of a light that was chosen with probability p, one of n such samples; dirs: samples
 * of directions that might find it too. */
static Rgb ask(const Branch *e, const Vertex *v, const Light *l, float p, int n, int dirs, V2 u,
               Tracer *t)
{
    LightSample ls;
    float pdf;
    V3 local;
    Ray r;
    Rgb c;

    if (!l->kind->sample(l, v->s.p, u, &ls) || !vertex_local(v, ls.wi, &local))
        return rgb_all(0.0f);
    pdf = (float)n * p * ls.pdf_w;
    c = rgb_scale(rgb_mul(rgb_mul(e->beam.throughput, vertex_f_cos(v, local)), ls.L), 1.0f / pdf);
    if (rgb_black(c))
        return c;
    if (!l->kind->delta)
        c = rgb_scale(c, mis_weight(true, pdf, (float)dirs * vertex_pdf_w(v, local)));
    r = shadow_ray(&v->s, &ls);
    if (!tracer_passes(t, &r, medium_beyond(&v->s, ls.wi, e->beam.medium), &c))
        return rgb_all(0.0f);
    tracer_tally(t, e->beam.depth + 2, STRATEGY_EXPLICIT, c);
    return c;
}

static Rgb ask_one(const Distributed *it, const Branch *e, const Vertex *v, int n, int dirs,
                   Tracer *t)
{
    float p, left, u = 0.0f;
    const Light *l;

    if (it->base.scene->nlights > 1)
        u = sample_1d(&t->sampler, DECISION(DECIDE_LIGHT, e->beam.depth));
    l = it->lights->kind->pick(it->lights, v->s.p, vertex_up(v), u, &p, &left);
    if (!l)
        return rgb_all(0.0f);
    return ask(e, v, l, p, n, dirs,
               sample_2d(&t->sampler, DECISION(DECIDE_LIGHT_POINT, e->beam.depth)), t);
}

static Rgb ask_all(const Distributed *it, const Branch *e, const Vertex *v, int n, int dirs,
                   Tracer *t)
{
    const Scene *s = it->base.scene;
    Rgb sum = rgb_all(0.0f);

    for (size_t i = 0; i < s->nlights; i++) {
        Decision d = DECISION(DECIDE_LIGHT_POINT, (size_t)e->beam.depth + NUMBERS * i);
        sum = rgb_add(sum, ask(e, v, s->lights[i], 1.0f, n, dirs, sample_2d(&t->sampler, d), t));
    }
    return sum;
}

static Rgb direct(const Distributed *it, const Branch *e, const Vertex *v, int n, int dirs,
                  Tracer *t)
{
    Sampler whole = t->sampler;
    Rgb sum = rgb_all(0.0f);

    for (int k = 0; k < n; k++) {
        t->sampler = sampler_part(&whole, (uint32_t)n, (uint32_t)k);
        sum = rgb_add(sum, (it->lights ? ask_one : ask_all)(it, e, v, n, dirs, t));
    }
    t->sampler = whole;
    return sum;
}

/* ---- branches ---- */

static Rgb seen(const Distributed *it, Branch *e, Tracer *t);

/* One of n directions in which the branch goes on; asked: samples of lights that were taken. */
static Rgb branch(const Distributed *it, const Branch *e, const Vertex *v, int n, int asked,
                  Tracer *t)
{
    Branch next = *e;
    Rgb sum = rgb_all(0.0f);
    BsdfSample bs;

    if (!vertex_sample(v, t, e->beam.depth, &bs))
        return sum;
    bs.weight = rgb_scale(bs.weight, 1.0f / (float)n);
    beam_turn(&next.beam, v, &bs);
    next.p = v->s.p;
    next.n = vertex_up(v);
    next.pdf_w = (float)n * bs.pdf_w;
    next.asked = asked;
    next.split = next.split || vertex_is_smooth(v);
    next.ends = (bs.flags & BSDF_MATT) != 0;
    if (next.ends) {
        sum = rgb_mul(next.beam.throughput, it->ambient);
        tracer_tally(t, next.beam.depth + 2, STRATEGY_EXPLICIT, sum);
        if (!it->meetable)
            return sum;
    } else if (!beam_survives(&next.beam, it->roulette, t))
        return sum;
    return rgb_add(sum, seen(it, &next, t));
}

/* Light along the branch, as the eye gets it. */
static Rgb seen(const Distributed *it, Branch *e, Tracer *t)
{
    Sampler whole = t->sampler;
    Rgb sum = rgb_all(0.0f);
    int asked = 0, n = 1;
    const Light *l;
    Vertex v;

    if (!beam_meets(&e->beam, &v.s, t))
        return met_beyond(it, e, t);
    l = scene_light_of(it->base.scene, &v.s);
    if (l)
        sum = met(it, e, l, &v.s, t);
    if (e->ends || e->beam.depth >= it->maxdepth)
        return sum;
    vertex_make(&v, it->base.scene, e->beam.ray.d);
    if (vertex_is_smooth(&v)) {
        n = e->split ? 1 : it->bsdfsamples;
        asked = e->split ? 1 : it->lightsamples;
        sum = rgb_add(sum, direct(it, e, &v, asked, n, t));
    }
    for (int k = 0; k < n; k++) {
        t->sampler = sampler_part(&whole, (uint32_t)n, (uint32_t)k);
        sum = rgb_add(sum, branch(it, e, &v, n, asked, t));
    }
    t->sampler = whole;
    return sum;
}

static Rgb radiance(const Integrator *base, const Ray *r, Tracer *t)
{
    Branch e = { .beam = beam_from_eye(r, base->scene) };
    return seen((const Distributed *)base, &e, t);
}

static bool glows(const Integrator *base)
{
    return !rgb_black(((const Distributed *)base)->ambient);
}

static void close_distributed(Integrator *base)
{
    Distributed *it = (Distributed *)base;
    lightsampler_close(it->lights);
    mem_free(it);
}

static bool open_lights(Distributed *it, const Scene *s, const char *name)
{
    if (!strcmp(name, "all"))
        return true;
    it->lights = lightsampler_open(name, s);
    return it->lights != NULL;
}

static Integrator *open_distributed(const Scene *s, const Opts *o)
{
    Distributed *it = warn_of_scattering(s, "distributed") ? MEM_NEW(Distributed) : NULL;

    if (!it)
        return NULL;
    it->base.scene = s;
    it->maxdepth = (int)opt_int(o, "maxdepth");
    it->roulette = (int)opt_int(o, "roulette");
    it->lightsamples = (int)opt_int(o, "lightsamples");
    it->bsdfsamples = (int)opt_int(o, "bsdfsamples");
    it->ambient = ambient_light(s, o, false);
    for (size_t i = 0; i < s->nlights; i++)
        it->meetable = it->meetable || s->lights[i]->kind->delta == DELTA_NONE;
    if (!open_lights(it, s, opt_string(o, "lightsampler"))) {
        mem_free(it);
        return NULL;
    }
    return &it->base;
}

static const OptDef options[] = {
    { .key = "maxdepth", .type = OPT_INT, .num = 9, .lo = 0, .hi = DEPTH_MOST,
      .help = "most scattering events of a path; 0 shows lights only" },
    { .key = "lightsamples", .type = OPT_INT, .num = 1, .lo = 1, .hi = 65536,
      .help = "samples of lights at the first surface that is no mirror and no clear glass" },
    { .key = "bsdfsamples", .type = OPT_INT, .num = 1, .lo = 1, .hi = 65536,
      .help = "directions from there" },
    { .key = "lightsampler", .type = OPT_CHOICE, .str = LIGHTSAMPLER_DEFAULT,
      .choices = "auto power uniform contribution all", .also = "lightsamplestrategy",
      .help = "how a light is chosen; all: each gets the samples" },
    ROULETTE_OPTION(4),
    AMBIENT_OPTIONS("none"),
    { .key = NULL }
};

const IntegratorKind integrator_distributed = {
    .info = { "distributed", "Shirley91 5.4.1; Veach97 9.2.4",
              "lens, time, lights and glossy reflections sampled; no indirect diffuse light",
              options },
    .truth = BIASED,
    .misses = "light that a matt surface reflects after another surface did (caustics too), and "
              "light scattered by media",
    .open = open_distributed, .close = close_distributed, .radiance = radiance, .glows = glows
};
