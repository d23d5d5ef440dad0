/* light.c -- light tracing: paths begin at the lamps, and each vertex is shown to the lens.
 *
 * Source      [Cline07 7.6, figs 7.9, 7.10; errata 7.2], [Veach97 10.3], [GIRT 2.3.1].
 * Idea        A particle leaves a lamp and scatters by its surfaces' models. From each vertex a
 *             connection goes to a place on the lens; what gets through is splatted where the lens
 *             shows the vertex. Its caustics are smooth where those of `path` are specks.
 * Eye         What the lens sees of lamps with nothing on the way comes along the camera's own
 *             rays, so no connection has to begin on a lamp.
 * Misses      Whatever is seen in a mirror or through glass: no connection gets there, unless the
 *             glass is so thin that it lets rays pass.
 * Seams       In pictures all around, a filter wider than a pixel does not reach over the edges.
 * Numbers     Particle number (sample index * pixels + pixel) of one sequence, so that lamps are
 *             covered as evenly as the sampler can, not only from pixel to pixel by chance. */
#include "base/mem.h"
#include "integrators/beam.h"
#include "integrators/lens.h"
#include "integrators/particle.h"

typedef struct {
    Integrator base;
    LightSampler *lights;       /* owned: by power */
    int   maxdepth, roulette;
    uint32_t x0, y0, w, h;      /* window of the film */
} LightTracer;

/* ---- the lens ---- */

static void show_vertex(const Particle *p, const Vertex *v, Tracer *t)
{
    CameraSample c;
    V3 local;

    if (lens_from(v->s.p, p->ray.time, p->depth + 1, t, &c) && vertex_local(v, c.wi, &local))
        lens_shows(&c, &v->s, medium_beyond(&v->s, c.wi, p->medium),
                   rgb_mul(p->flux, vertex_f_cos_of_light(v, c.wi, local)), p->depth + 2, t);
}

static void show_place(const Particle *p, V3 at, Tracer *t)
{
    Surface s = { .p = at, .time = p->ray.time };
    CameraSample c;

    if (lens_from(at, p->ray.time, p->depth + 1, t, &c))
        lens_shows(&c, &s, p->medium,
                   rgb_scale(p->flux, phase_pdf_w(t->scene->media[p->medium].g, p->ray.d, c.wi)),
                   p->depth + 2, t);
}

/* ---- one light path ---- */

static void shoot(const LightTracer *it, Tracer *t)
{
    float u = scene_blurs(t->scene) ? sample_1d(&t->sampler, DECISION(DECIDE_TIME, 0)) : 0.0f;
    Particle p;
    Emission e;

    t->shots++;
    if (!particle_leaves(&p, it->lights, scene_time(t->scene, u), t, &e))
        return;
    while (p.depth < it->maxdepth) {
        V3 at = { 0, 0, 0 };
        Vertex v;
        Event event = particle_flies(&p, &v.s, &at, t);
        if (event == ESCAPES)
            return;
        if (event == SCATTERS) {
            show_place(&p, at, t);
            particle_scatters_within(&p, at, t);
        } else {
            vertex_make(&v, t->scene, p.ray.d);
            if (vertex_is_smooth(&v))
                show_vertex(&p, &v, t);
            if (!particle_scatters(&p, &v, t))
                return;
        }
        if (!particle_survives(&p, it->roulette, t))
            return;
    }
}

/* ---- one camera sample ---- */

/* What lamps show themselves. */
static Rgb seen(const Ray *r, Tracer *t)
{
    Beam b = beam_from_eye(r, t->scene);
    Surface s;
    V3 at;
    Event event = beam_flies(&b, &s, &at, t);

    if (event == ESCAPES)
        return beam_shows_beyond(&b, t);
    if (event == ARRIVES && s.shape->light != NO_LIGHT)
        return beam_shows(&b, scene_light_of(t->scene, &s), &s, t);
    return rgb_all(0.0f);
}

static Rgb radiance(const Integrator *base, const Ray *r, Tracer *t)
{
    const LightTracer *it = (const LightTracer *)base;
    Sampler eye = t->sampler;
    Rgb sum = seen(r, t);
    uint64_t number = (uint64_t)eye.index * it->w * it->h + (uint64_t)(t->y - it->y0) * it->w +
                      (t->x - it->x0);

    sampler_pixel(&t->sampler, UINT32_MAX, (uint32_t)(number >> 32));
    sampler_start(&t->sampler, (uint32_t)number);
    shoot(it, t);
    t->sampler = eye;
    return sum;
}

/* ---- opening ---- */

static bool prepare(Integrator *base, const Film *f, uint64_t seed)
{
    LightTracer *it = (LightTracer *)base;

    (void)seed;
    it->x0 = f->x0;
    it->y0 = f->y0;
    it->w = f->w;
    it->h = f->h;
    return true;
}

static void close_light(Integrator *base)
{
    LightTracer *it = (LightTracer *)base;

    lightsampler_close(it->lights);
    mem_free(it);
}

static Integrator *open_light(const Scene *s, const Opts *o)
{
    LightTracer *it = MEM_NEW(LightTracer);

    if (!it)
        return NULL;
    it->base.scene = s;
    it->maxdepth = (int)opt_int(o, "maxdepth");
    it->roulette = (int)opt_int(o, "roulette");
    it->lights = lightsampler_open("power", s);
    if (it->lights)
        return &it->base;
    close_light(&it->base);
    return NULL;
}

static const OptDef options[] = {
    MAXDEPTH_OPTION,
    ROULETTE_OPTION(4),
    { .key = NULL }
};

const IntegratorKind integrator_light = {
    .info = { "light", "Cline07 7.6; GIRT 2.3.1", "light tracing: caustics, from the lamps",
              options },
    .truth = UNBIASED, .misses = "what is seen by way of delta surfaces", .splats = true,
    .open = open_light, .close = close_light, .prepare = prepare, .radiance = radiance
};
