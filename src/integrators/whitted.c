/* whitted.c -- ray tracing as it was at first: trees of mirror images, no chance anywhere.
 *
 * Source      [Shirley91 5.3, fig. 5.5] after Whitted; errata 001.3. Ambient light: 5.2.1, see
 *             ambient.h; lights as points: centre.h.
 * Idea        A ray that meets a mirror goes on as its reflection, at glass both as reflection and
 *             as refraction, each weighted by Fresnel's share. Where a surface scatters otherwise,
 *             the direct light of each lamp's centre is added, unless a ray to it meets anything
 *             (glass too), and the ambient light times the surface's albedo.
 * Ends        At maxdepth events; or, after Hall and Greenberg, when the product of all weights
 *             falls below `cutoff`, as what is left out then can hardly be seen.
 * Work        The weights of one vertex add up to 1 or less, so of each depth at most 1/cutoff rays
 *             are followed, however bushy the tree: at most maxdepth/cutoff in all.
 * Departs     Surfaces may be both: a clear coat reflects and its base is lit. The scale of
 *             radiance in glass is taken out of the product that is compared with the cutoff.
 * Samples     Each is the same ray tree; only its place on the pixel, lens and moment differ. */
#include "base/mem.h"
#include "integrators/ambient.h"
#include "integrators/beam.h"
#include "integrators/centre.h"

typedef struct {
    Integrator base;
    Centres lights;             /* owned */
    Rgb   ambient;              /* radiance */
    int   maxdepth;
    float cutoff;
} Whitted;

static Rgb tallied(Tracer *t, int edges, Strategy how, Rgb c)
{
    tracer_tally(t, edges, how, c);
    return c;
}

/* Direct light of all lamps. */
static Rgb lamps(const Whitted *it, const Beam *b, const Vertex *v, Tracer *t)
{
    Rgb sum = rgb_all(0.0f);

    for (size_t i = 0; i < it->lights.n; i++) {
        LightSample ls;
        V3 local;
        Rgb c;
        if (!centre_shines(&it->lights, i, v->s.p, &ls) || !vertex_local(v, ls.wi, &local))
            continue;
        c = rgb_mul(rgb_mul(b->throughput, vertex_f_cos(v, local)), ls.L);
        if (!rgb_black(c) &&
            centre_arrives(&it->lights, i, v, &ls, medium_beyond(&v->s, ls.wi, b->medium), t, &c))
            sum = rgb_add(sum, c);
    }
    return tallied(t, b->depth + 2, STRATEGY_EXPLICIT, sum);
}

/* What the surface makes of light that is the same from everywhere, without its delta events: these
 * are followed. */
static Rgb ambient(const Whitted *it, const Beam *b, const Vertex *v, const BsdfSample *event,
                   int events, Tracer *t)
{
    Rgb albedo = v->b->kind->albedo(v->b, v->wo);

    for (int i = 0; i < events; i++)
        albedo = rgb_sub(albedo, rgb_scale(event[i].weight, event[i].eta * event[i].eta));
    albedo = rgb(f_max(albedo.r, 0.0f), f_max(albedo.g, 0.0f), f_max(albedo.b, 0.0f));
    return tallied(t, b->depth + 3, STRATEGY_EXPLICIT,
                   rgb_mul(b->throughput, rgb_mul(albedo, it->ambient)));
}

/* Light along the beam, as the eye gets it. */
static Rgb tree(const Whitted *it, Beam *b, Tracer *t)
{
    BsdfSample event[BSDF_DELTAS];
    const Light *l;
    Rgb sum = rgb_all(0.0f);
    int events;
    Vertex v;

    if (!beam_meets(b, &v.s, t))
        return beam_shows_beyond(b, t);
    l = scene_light_of(it->base.scene, &v.s);
    if (l)
        sum = beam_shows(b, l, &v.s, t);
    if (b->depth >= it->maxdepth)
        return sum;
    vertex_make(&v, it->base.scene, b->ray.d);
    events = bsdf_deltas(v.b, v.wo, event);
    if (vertex_is_smooth(&v)) {
        sum = rgb_add(sum, lamps(it, b, &v, t));
        sum = rgb_add(sum, ambient(it, b, &v, event, events, t));
    }
    for (int i = 0; i < events; i++) {
        Beam next = *b;
        if (!vertex_turns(&v, &event[i]))
            continue;
        beam_turn(&next, &v, &event[i]);
        if (beam_strength(&next) >= it->cutoff)
            sum = rgb_add(sum, tree(it, &next, t));
    }
    return sum;
}

static Rgb radiance(const Integrator *base, const Ray *r, Tracer *t)
{
    Beam b = beam_from_eye(r, base->scene);
    return tree((const Whitted *)base, &b, t);
}

static bool glows(const Integrator *base)
{
    return !rgb_black(((const Whitted *)base)->ambient);
}

static void close_whitted(Integrator *base)
{
    Whitted *it = (Whitted *)base;
    centres_clear(&it->lights);
    mem_free(it);
}

static Integrator *open_whitted(const Scene *s, const Opts *o)
{
    Whitted *it = warn_of_scattering(s, "whitted") ? MEM_NEW(Whitted) : NULL;

    if (!it || !centres_init(&it->lights, s)) {
        mem_free(it);
        return NULL;
    }
    it->base.scene = s;
    it->maxdepth = (int)opt_int(o, "maxdepth");
    it->cutoff = opt_float(o, "cutoff");
    it->ambient = ambient_light(s, o, true);
    return &it->base;
}

static const OptDef options[] = {
    { .key = "maxdepth", .type = OPT_INT, .num = 9, .lo = 0, .hi = 100,
      .help = "most events along a branch, the last of which is direct light" },
    { .key = "cutoff", .type = OPT_FLOAT, .num = 0.005, .lo = 1e-6, .hi = 1,
      .help = "branches whose weight falls below this are not followed" },
    AMBIENT_OPTIONS("estimate"),
    { .key = NULL }
};

const IntegratorKind integrator_whitted = {
    .info = { "whitted", "Shirley91 5.3, 5.2.1",
              "trees of mirror images, lights as points, no noise", options },
    .truth = BIASED,
    .misses = "soft shadows, indirect and environment light (ambient instead), reflections of "
              "glossy surfaces, light through glass, and light scattered by media",
    .open = open_whitted, .close = close_whitted, .radiance = radiance, .glows = glows
};
