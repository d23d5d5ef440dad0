/* photons.c -- brute force: photons fly about until something takes them; the lens counts its own.
 *
 * Source      [Cline07 7.2, figs 7.2, 7.3].
 * Idea        Nothing is steered. A lamp sends a photon of one band of the spectrum; surfaces
 *             scatter it or take it, by chance; if it comes upon the lens, it is counted where the
 *             lens shows whence it came. Everything there is to see comes out, alike in quality,
 *             after as many photons as one can wait for.
 * Counting    A photon of flux F that the lens takes at a place l from the direction d adds
 *             F We(l, d) to the mean of all pixels, in its band, which had the share p of the
 *             lamp's flux: F is the whole flux over all bands, so no 1 / p is left.
 * Bands       Red, green and blue: the noise is coloured.
 * Lens        The camera's own, where it has one: what is out of focus is blurred, as it is for
 *             other methods, and the mean is the same. Around a pinhole a ball of radius R takes
 *             photons, to each of which it shows an area of pi R^2: they count F pdf_w / (pi R^2)
 *             where the pinhole shows the last place that they came from. So all is in focus, and
 *             what is wrong by parallax goes as R / distance. */
#include "base/mem.h"
#include "integrators/particle.h"
#include "scene/camera.h"

#define BALL_USUAL 0.02f                /* of the scene's radius, where nobody says */
enum { UNIT = 4096 };                   /* photons */

typedef struct {
    Integrator base;
    LightSampler *lights;       /* owned: by power */
    int   maxdepth;
    float ball;                 /* its radius, for pinholes */
} Photons;

/* What takes photons at a moment: a disc that looks along n, or a ball about a pinhole. */
typedef struct {
    V3    middle, n;
    float radius;
    bool  ball;
} Trap;

static Trap trap_at(const Photons *it, float time)
{
    static const V2 pixel = { 0, 0 }, middle = { 0.5f, 0.5f }, edge = { 0.0f, 0.5f };
    const Camera *c = it->base.scene->camera;
    Affine to_world, to_camera;
    Trap trap = { .radius = it->ball, .ball = c->point };

    camera_at(c, time, &to_world, &to_camera);
    trap.n = v_unit(affine_vector(&to_world, v3(0, 0, 1)));
    trap.middle = c->kind->ray(c, pixel, middle, time).o;
    if (!trap.ball)
        trap.radius = v_len(v_sub(c->kind->ray(c, pixel, edge, time).o, trap.middle));
    return trap;
}

/* Whether the photon's line comes upon the trap from in front: how far on, and where. */
static bool comes_upon(const Trap *trap, const Ray *r, float *t, V3 *at)
{
    V3 to = v_sub(trap->middle, r->o);
    float down = trap->ball ? 1.0f : -v_dot(r->d, trap->n);

    if (!(down > 0.0f))
        return false;
    *t = trap->ball ? v_dot(to, r->d) : -v_dot(to, trap->n) / down;
    *at = v_mad(r->d, *t, r->o);
    return *t > 0.0f && v_len2(v_sub(*at, trap->middle)) < trap->radius * trap->radius;
}

/* Counts the photon if it comes upon the trap, and says how far that is; else INFINITY. */
static float count(const Trap *trap, const Particle *p, Tracer *t)
{
    const Camera *c = t->scene->camera;
    Ray r = p->ray, seen = { .tmax = INFINITY, .time = r.time };
    Rgb flux = p->flux;
    CameraView v;
    V3 at;

    if (!comes_upon(trap, &r, &r.tmax, &at) || !tracer_passes(t, &r, p->medium, &flux))
        return INFINITY;
    seen.o = trap->ball ? trap->middle : at;
    seen.d = trap->ball ? v_unit(v_sub(r.o, trap->middle)) : v_neg(r.d);
    if (c->kind->view(c, &seen, &v))
        tracer_splat(t, v.pixel, p->depth + 1, STRATEGY_LENS,
                     rgb_scale(flux, !trap->ball ? v.we : v.pdf_w / (PI_F * trap->radius *
                                                                    trap->radius)));
    return r.tmax;
}

/* All of its flux in one band, which has as good a chance as it had flux. */
static void choose_band(Particle *p, Tracer *t)
{
    float sum = p->flux.r + p->flux.g + p->flux.b;
    float u = sample_1d(&t->sampler, DECISION(DECIDE_BAND, 0)) * sum;

    p->flux = u < p->flux.r ? rgb(sum, 0, 0) : u < p->flux.r + p->flux.g ? rgb(0, sum, 0)
                                                                       : rgb(0, 0, sum);
}

/* What is left of the flux is the chance to be left. A model whose samples may weigh more than 1
 * makes the photon stand for more. False: taken. */
static bool is_left(Particle *p, float before, Tracer *t)
{
    float q = rgb_max(p->flux) / before;

    if (!(q > 0.0f) || (q < 1.0f && sample_1d(&t->sampler, DECISION(DECIDE_ROULETTE,
                                                                    p->depth)) >= q))
        return false;
    if (q < 1.0f)
        p->flux = rgb_scale(p->flux, 1.0f / q);
    return true;
}

/* On to where something takes it: the lens, unless something stands before it. */
static void fly(const Photons *it, const Trap *trap, Particle *p, Tracer *t)
{
    for (;;) {
        V3 from = p->ray.o, end = { 0, 0, 0 };
        float before = rgb_max(p->flux), taken = count(trap, p, t);
        Vertex v;
        Event event = particle_flies(p, &v.s, &end, t);
        if (event == ESCAPES || p->depth == it->maxdepth ||
            v_len(v_sub(event == ARRIVES ? v.s.p : end, from)) > taken)
            return;
        if (event == SCATTERS)
            particle_scatters_within(p, end, t);
        else {
            vertex_make(&v, t->scene, p->ray.d);
            if (!particle_scatters(p, &v, t))
                return;
        }
        if (!is_left(p, before, t))
            return;
    }
}

static void shoot(const Photons *it, Tracer *t)
{
    float u = scene_blurs(t->scene) ? sample_1d(&t->sampler, DECISION(DECIDE_TIME, 0)) : 0.0f;
    float time = scene_time(t->scene, u);
    Trap trap = trap_at(it, time);
    Particle p;
    Emission e;

    t->shots++;
    if (particle_leaves(&p, it->lights, time, t, &e)) {
        choose_band(&p, t);
        fly(it, &trap, &p, t);
    }
}

/* ---- passes: as many photons as pixels ---- */

static uint64_t units(Integrator *base, const Film *f, uint32_t pass, int phase)
{
    (void)base, (void)pass, (void)phase;
    return ((uint64_t)f->w * f->h + UNIT - 1) / UNIT;
}

static void run(Integrator *base, Film *f, uint32_t pass, int phase, uint64_t unit, Tracer *t)
{
    uint64_t end = (uint64_t)f->w * f->h, n = (unit + 1) * UNIT < end ? UNIT : end - unit * UNIT;

    (void)phase;
    for (uint64_t i = 0; i < n; i++) {
        uint64_t number = (uint64_t)pass * UNIT + i;
        sampler_pixel(&t->sampler, (uint32_t)unit, (uint32_t)(number >> 32));
        sampler_start(&t->sampler, (uint32_t)number);
        shoot((const Photons *)base, t);
    }
}

/* ---- opening ---- */

static void close_photons(Integrator *base)
{
    Photons *it = (Photons *)base;

    lightsampler_close(it->lights);
    mem_free(it);
}

/* False: reported. */
static bool choose_ball(Photons *it, const Scene *s, const Opts *o)
{
    it->ball = opt_float(o, "ball");
    if (!(it->ball > 0.0f))
        it->ball = BALL_USUAL * s->radius;
    return !s->camera->parallel ||
           err_usage("photons cannot come upon the lens of the camera '%s', which looks in one "
                     "direction from each place", s->camera->kind->info.name);
}

static Integrator *open_photons(const Scene *s, const Opts *o)
{
    Photons *it = MEM_NEW(Photons);

    if (!it)
        return NULL;
    it->base.scene = s;
    it->maxdepth = (int)opt_int(o, "maxdepth");
    it->lights = lightsampler_open("power", s);
    if (it->lights && choose_ball(it, s, o))
        return &it->base;
    close_photons(&it->base);
    return NULL;
}

static const OptDef options[] = {
    { .key = "ball", .type = OPT_FLOAT, .num = 0, .lo = 0, .hi = 1e30,
      .help = "radius of what takes photons around a pinhole, scene units: large ones take more, "
              "small ones have less parallax; 0: 0.02 of the scene's radius" },
    { .key = "maxdepth", .type = OPT_INT, .num = 1000, .lo = 0, .hi = 100000,
      .help = "most scattering events of a photon" },
    { .key = NULL }
};

const IntegratorKind integrator_photons = {
    .info = { "photons", "Cline07 7.2", "photons one by one, until they come upon the lens",
              options },
    .truth = CONSISTENT, .misses = "without a lens: what is as near as its ball is large",
    .splats = true,
    .open = open_photons, .close = close_photons, .phases = 1, .units = units, .run = run
};
