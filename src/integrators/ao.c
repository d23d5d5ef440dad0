/* ao.c -- ambient occlusion: how much of the cosine-weighted hemisphere is open within a distance.
 *
 * Source      [Zhukov98]; equals the direct light of a uniform sky of radiance 1 on a white
 *             Lambertian surface when the distance is infinite, which is how it is tested.
 * Use         Cheap pictures of meshes: no lights or materials needed. */
#include "base/mem.h"
#include "integrators/integrator.h"
#include "sampling/warp.h"

typedef struct {
    Integrator base;
    int   samples;
    float distance;             /* scene units */
} Ao;

enum { BATCH = 32 };

/* How many of n rays into the hemisphere of the surface, the first of them sample `first`, get
 * away. */
static int open_ways(const Ao *it, const Surface *s, const Frame *frame, int first, int n,
                     Tracer *t)
{
    Ray ray[BATCH];
    bool blocked[BATCH];
    size_t rays = 0;
    int open = 0;

    for (int i = first; i < first + n; i++) {
        V2 u = sample_2d(&t->sampler, DECISION(DECIDE_DIRECTION, i));
        V3 d = frame_out(frame, warp_cosine(u));
        if (v_dot(d, s->ng) <= 0.0f)
            continue;
        ray[rays++] = (Ray){ .o = ray_origin(s->p, s->err, s->ng, d), .d = d,
                             .tmax = it->distance, .time = s->time };
    }
    tracer_blocked_many(t, ray, blocked, rays);
    for (size_t i = 0; i < rays; i++)
        open += !blocked[i];
    return open;
}

static Rgb radiance(const Integrator *base, const Ray *r, Tracer *t)
{
    const Ao *it = (const Ao *)base;
    int open = 0;
    Surface s;
    Frame frame;
    Hit h;
    Rgb L;

    if (!tracer_nearest(t, r, &h))
        return rgb_all(0.0f);
    accel_surface(base->scene->accel, r, &h, &s);
    if (v_dot(s.ns, r->d) > 0.0f) {             /* the side that is seen */
        s.ns = v_neg(s.ns);
        s.ng = v_neg(s.ng);
    }
    frame = frame_about(s.ns);
    for (int i = 0; i < it->samples; i += BATCH)
        open += open_ways(it, &s, &frame, i, it->samples - i < BATCH ? it->samples - i : BATCH, t);
    L = rgb_all((float)open / (float)it->samples);
    tracer_tally(t, 2, STRATEGY_EXPLICIT, L);   /* direct light of that sky */
    return L;
}

static bool glows(const Integrator *it)
{
    (void)it;
    return true;
}

static Integrator *open_ao(const Scene *s, const Opts *o)
{
    Ao *it = MEM_NEW(Ao);
    if (!it)
        return NULL;
    it->base.scene = s;
    it->samples = (int)opt_int(o, "samples");
    it->distance = opt_float(o, "distance");
    if (it->distance == 0.0f)
        it->distance = INFINITY;
    return &it->base;
}

static void close_ao(Integrator *it) { mem_free(it); }

static const OptDef options[] = {
    { .key = "samples", .type = OPT_INT, .num = 4, .lo = 1, .hi = 65536, .also = "nsamples",
      .help = "rays from each point that is seen" },
    { .key = "distance", .type = OPT_FLOAT, .num = 0, .lo = 0, .hi = 1e30, .also = "maxdistance",
      .help = "how far a thing may be and still cover, in scene units; 0: any distance" },
    { .key = NULL }
};

const IntegratorKind integrator_ao = {
    .info = { "ao", "Zhukov98", "ambient occlusion, for looking at meshes", options },
    .truth = BIASED, .misses = "everything but a uniform sky on white surfaces",
    .open = open_ao, .close = close_ao, .radiance = radiance, .glows = glows
};
