/* ppm.c -- progressive photon mapping: paths of the eye end at fixed points, which gather photons
 * for ever, each within a radius of its own, which shrinks.
 *
 * Source      [GIRT 2.3.3, algorithm 4], [Hachisuka08]. All else stands in progressive.h.
 * Points      Each of the first passes gives a pixel a ray of the eye; they are kept, with the
 *             numbers that lead their paths, and followed anew in each pass: a ray or two are
 *             cheaper than a vertex is large. Each gathers in every pass; the pass's value is their
 *             mean. In a scene that moves they take turns instead: each belongs to a moment, and
 *             gathers in passes of that.
 * Departs     Direct light at the points is not of photons: it has new samples in each pass.
 * Limits      What converges is the picture of these points: edges are as smooth as so many samples
 *             make them, and what is glossy, out of focus or in motion is as noisy as these leave
 *             it. */
#include "base/mem.h"
#include "integrators/progressive.h"

typedef struct { Ray ray; uint32_t index; } HitPoint;

typedef struct {
    Progressive shared;
    uint32_t samples;
    bool blurs;                 /* the scene moves while the shutter is open */
    HitPoint *points;           /* owned: [pixel][samples] */
} Ppm;

static bool prepare(Integrator *base, const Film *f, uint64_t seed)
{
    Ppm *it = (Ppm *)base;

    (void)seed;
    if (!progressive_prepare(&it->shared, f, it->samples))
        return false;
    it->points = MEM_ARRAY(HitPoint, it->shared.nrefined);
    return it->points != NULL;
}

/* The tally wants what is added to the picture: the mean of the points. */
static void tally_mean(Tally *tally, float share)
{
    for (int k = 0; k < TALLY_LENGTHS; k++)
        tally->length[k] = rgb_scale(tally->length[k], share);
    for (int k = 0; k < STRATEGIES; k++)
        tally->strategy[k] = rgb_scale(tally->strategy[k], share);
}

static Rgb radiance(const Integrator *base, const Ray *r, Tracer *t)
{
    const Ppm *it = (const Ppm *)base;
    Sampler now = t->sampler;
    Refined *m = progressive_of(&it->shared, t, 0);
    HitPoint *p = it->points + (m - it->shared.refined);
    uint32_t first = 0, end = now.index < it->samples ? now.index + 1 : it->samples;
    Rgb sum = rgb_all(0.0f);

    if (now.index < it->samples)
        p[now.index] = (HitPoint){ *r, now.index };
    if (it->blurs) {
        first = now.index % it->samples;
        end = first + 1;
    }
    for (uint32_t i = first; i < end; i++) {
        Sampler light = sampler_part(&now, end - first, i - first);
        t->sampler = now;
        sampler_start(&t->sampler, p[i].index);
        sum = rgb_add(sum, progressive_look(&it->shared, &p[i].ray, &m[i], &light, t));
    }
    t->sampler = now;
    if (t->tally)
        tally_mean(t->tally, 1.0f / (float)(end - first));
    return rgb_scale(sum, 1.0f / (float)(end - first));
}

static uint32_t moment(const Integrator *base, uint32_t pass)
{
    return pass % ((const Ppm *)base)->samples;
}

static void save(const Integrator *base, Saving *s)
{
    const Ppm *it = (const Ppm *)base;

    progressive_save(base, s);
    for (size_t i = 0; i < it->shared.nrefined; i++) {
        const Ray *r = &it->points[i].ray;
        const float v[] = { r->o.x, r->o.y, r->o.z, r->tmax, r->d.x, r->d.y, r->d.z, r->time };
        for (int k = 0; k < 8; k++)
            save_float(s, v[k]);
        save_u32(s, it->points[i].index);
    }
}

static bool load(Integrator *base, Loading *l)
{
    Ppm *it = (Ppm *)base;

    if (!progressive_load(base, l))
        return false;
    for (size_t i = 0; i < it->shared.nrefined; i++) {
        float v[8];
        for (int k = 0; k < 8; k++)
            v[k] = load_float(l);
        it->points[i].ray = (Ray){ { v[0], v[1], v[2] }, v[3], { v[4], v[5], v[6] }, v[7] };
        it->points[i].index = load_u32(l);
    }
    return !l->beyond;
}

static void close_ppm(Integrator *base)
{
    Ppm *it = (Ppm *)base;

    progressive_clear(&it->shared);
    mem_free(it->points);
    mem_free(it);
}

static Integrator *open_ppm(const Scene *s, const Opts *o)
{
    Ppm *it = MEM_NEW(Ppm);

    if (!it)
        return NULL;
    it->blurs = scene_blurs(s);
    it->samples = (uint32_t)opt_int(o, "samples");
    if (progressive_open(&it->shared, "ppm", s, o))
        return &it->shared.base;
    close_ppm(&it->shared.base);
    return NULL;
}

static const OptDef options[] = {
    { .key = "samples", .type = OPT_INT, .num = 4, .lo = 1, .hi = 1024,
      .help = "points a pixel that gather photons" },
    PROGRESSIVE_OPTIONS,
    { .key = NULL }
};

const IntegratorKind integrator_ppm = {
    .info = { "ppm", "GIRT 2.3.3; Hachisuka08",
              "photons gathered for ever at points that stay, in radii that shrink", options },
    .truth = CONSISTENT,
    .misses = "edges and blurs finer than its points; light that media scatter",
    .open = open_ppm, .close = close_ppm, .prepare = prepare, .radiance = radiance, .anew = true,
    .moment = moment, .phases = PROGRESSIVE_PHASES, .units = progressive_units,
    .run = progressive_run, .save = save, .load = load
};
