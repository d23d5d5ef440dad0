/* progressive.c -- see progressive.h. */
#include "integrators/progressive.h"

#include "base/error.h"
#include "base/mem.h"

/* ---- photons ---- */

/* What photons within the radius bring, and how many they are. [GIRT (2.79)] */
static Rgb gather(const Progressive *it, const Beam *b, const Vertex *v, float radius,
                  float *found, Tracer *t)
{
    PointWalk w = pointgrid_walk(&it->pass.arrivals.grid, v->s.p, radius);
    float area = (float)((double)PI * radius * radius * (double)it->pass.arrivals.paths), d2;
    Rgb sum = rgb_all(0.0f);
    const PlacedPoint *q;

    while ((q = pointgrid_next(&w, &d2))) {
        const PassPhoton *p = photonpass_photon(&it->pass, q);
        V3 wi = v3(p->wi[0], p->wi[1], p->wi[2]), local;
        Rgb c;
        if ((int)p->events + b->depth >= it->maxdepth || !vertex_local(v, wi, &local))
            continue;
        c = v->b->kind->eval(v->b, v->wo, local, false);
        if (rgb_black(c))
            continue;
        c = rgb_mul(c, rgb(p->flux[0], p->flux[1], p->flux[2]));
        sum = rgb_add(sum, c);
        *found += 1.0f;
        if (UNLIKELY(t->tally != NULL))
            tracer_tally(t, (int)p->events + b->depth + 2, STRATEGY_MERGE,
                         rgb_scale(rgb_mul(b->throughput, c), 1.0f / area));
    }
    return rgb_scale(rgb_mul(b->throughput, sum), 1.0f / area);
}

/* [GIRT (2.74), (2.75); errata 3]: without photons nothing changes. */
static void refine(Refined *m, float alpha, float found)
{
    float kept = m->photons + alpha * found;

    if (found > 0.0f) {
        m->radius *= sqrtf(kept / (m->photons + found));
        m->photons = kept;
    }
}

static float first_radius(const Progressive *it, V3 p)
{
    if (it->radius > 0.0f)
        return it->radius;
    return f_max(photonpass_reach(&it->pass, p, it->k, it->most), it->least);
}

/* ---- the eye's path ---- */

/* Direct light by a point of a light and a direction of the surface, weighed. */
static Rgb direct(const Progressive *it, const Beam *b, const Vertex *v, Tracer *t)
{
    static const struct {
        CandidateBy *by;
        DecisionKind choice, point;
    } ways[2] = { { candidate_by_light, DECIDE_LIGHT, DECIDE_LIGHT_POINT },
                  { candidate_by_scattering, DECIDE_LOBE, DECIDE_DIRECTION } };
    Turn u = turn_on(v, b->ray.d, b->medium, b->depth);
    Rgb sum = rgb_all(0.0f);
    Candidate c;

    for (int i = 0; i < 2; i++) {
        Draw d = draw_first(t, &u, ways[i].choice, ways[i].point);
        if (!ways[i].by(&it->lighting, &u, &d, 1.0f, 1.0f, t, &c))
            continue;
        c.c = rgb_mul(b->throughput, c.c);
        sum = rgb_add(sum, candidate_light(&c, &u, t));
    }
    return sum;
}

/* On from the vertex by an event of delta, or where photons are not gathered by any. False: the
 * path ends. */
static bool follow(const Progressive *it, Beam *b, const Vertex *v, bool gathers, bool *delta,
                   Tracer *t)
{
    BsdfSample bs;

    if (gathers && !(v->b->flags & BSDF_SPECULAR))
        return false;
    if (!vertex_sample(v, t, b->depth, &bs) || (gathers && bs.pdf_w > 0.0f))
        return false;
    *delta = bs.pdf_w == 0.0f;
    beam_turn(b, v, &bs);
    return !rgb_black(b->throughput) && beam_lasts(b, it->roulette, t);
}

/* What is gathered at a vertex, and how much. */
static Rgb gathered(const Progressive *it, const Beam *b, const Vertex *v, Refined *m,
                    float *found, Tracer *t)
{
    if (m->radius == 0.0f)
        m->radius = first_radius(it, v->s.p);
    return gather(it, b, v, m->radius, found, t);
}

/* What the path finds until it ends or forks. */
static Rgb along(const Progressive *it, Beam *b, Refined *m, const Sampler *light, Forks *forks,
                 float *found, Tracer *t)
{
    Sampler path = t->sampler;
    Rgb sum = rgb_all(0.0f);
    bool delta = true;          /* no direct light has been found for the last vertex */
    Vertex v;

    for (;;) {
        bool gathers, smooth;
        if (!beam_meets(b, &v.s, t))
            return delta ? rgb_add(sum, beam_shows_beyond(b, t)) : sum;
        if (delta && v.s.shape->light != NO_LIGHT)
            sum = rgb_add(sum, beam_shows(b, scene_light_of(it->base.scene, &v.s), &v.s, t));
        if (b->depth >= it->maxdepth)
            return sum;
        vertex_make(&v, it->base.scene, b->ray.d);
        smooth = vertex_is_smooth(&v);
        gathers = smooth && (!it->through || (v.b->flags & BSDF_MATT));
        if (smooth) {
            t->sampler = *light;
            sum = rgb_add(sum, direct(it, b, &v, t));
            t->sampler = path;
        }
        if (gathers)
            sum = rgb_add(sum, gathered(it, b, &v, m, found, t));
        if ((gathers == smooth && beam_forks(forks, b, &v, t)) ||
            !follow(it, b, &v, gathers, &delta, t))
            return sum;
    }
}

Rgb progressive_look(const Progressive *it, const Ray *r, Refined *m, const Sampler *light,
                     Tracer *t)
{
    Beam b = beam_from_eye(r, it->base.scene);
    Forks forks = { .n = 0 };
    Rgb sum = rgb_all(0.0f);
    float found = 0.0f;

    do
        sum = rgb_add(sum, along(it, &b, m, light, &forks, &found, t));
    while (forks_next(&forks, &b));
    refine(m, it->alpha, found);
    return sum;
}

/* ---- passes ---- */

uint64_t progressive_units(Integrator *base, const Film *f, uint32_t pass, int phase)
{
    (void)f;
    (void)pass;
    return photonpass_units(&((Progressive *)base)->pass, phase);
}

/* Cells for most of the radii: their mean; at first a guess, as if the photons were spread evenly
 * over the scene's box. */
static float edge_of_cells(const Progressive *it)
{
    double sum = 0, n = 0, found, guess;

    for (size_t i = 0; i < it->nrefined; i++) {
        sum += it->refined[i].radius;
        n += it->refined[i].radius > 0.0f;
    }
    if (n > 0)
        return (float)(2 * sum / n);
    if (it->radius > 0.0f)
        return 2.0f * it->radius;
    found = (double)photonpass_found(&it->pass);
    guess = sqrt((double)box_area(it->base.scene->bounds) * it->k / (PI * (found + 1)));
    return 2.0f * f_min(f_max((float)guess, it->least), it->most);
}

void progressive_run(Integrator *base, Film *f, uint32_t pass, int phase, uint64_t unit, Tracer *t)
{
    Progressive *it = (Progressive *)base;

    (void)f;
    if (phase == PHOTONPASS_EDGE && it->edge_of != pass + 1) {
        it->edge = edge_of_cells(it);
        it->edge_of = pass + 1;
    }
    photonpass_run(&it->pass, pass, phase, unit, it->edge, t);
}

void progressive_save(const Integrator *base, Saving *s)
{
    const Progressive *it = (const Progressive *)base;

    for (size_t i = 0; i < it->nrefined; i++) {
        save_float(s, it->refined[i].radius);
        save_float(s, it->refined[i].photons);
    }
    save_float(s, it->edge);
    save_u32(s, it->edge_of);
}

bool progressive_load(Integrator *base, Loading *l)
{
    Progressive *it = (Progressive *)base;

    for (size_t i = 0; i < it->nrefined; i++) {
        it->refined[i].radius = load_float(l);
        it->refined[i].photons = load_float(l);
    }
    it->edge = load_float(l);
    it->edge_of = load_u32(l);
    return !l->beyond;
}

bool progressive_prepare(Progressive *it, const Film *f, size_t each)
{
    it->x0 = f->x0;
    it->y0 = f->y0;
    it->w = f->w;
    it->each = each;
    if (f->h > SIZE_MAX / f->w / each)
        return err_memory(SIZE_MAX);
    it->nrefined = (size_t)f->w * f->h * each;
    it->refined = MEM_ARRAY(Refined, it->nrefined);
    return it->refined &&
           photonpass_particles(&it->pass, it->particles ? it->particles
                                                         : (uint64_t)f->full_w * f->full_h);
}

/* ---- opening ---- */

void progressive_clear(Progressive *it)
{
    lighting_clear(&it->lighting);
    photonpass_clear(&it->pass);
    mem_free(it->refined);
}

bool progressive_open(Progressive *it, const char *name, const Scene *s, const Opts *o)
{
    it->base.scene = s;
    it->maxdepth = (int)opt_int(o, "maxdepth");
    it->roulette = (int)opt_int(o, "roulette");
    it->through = opt_is(o, "glossy", "follow");
    it->alpha = opt_float(o, "alpha");
    it->radius = opt_float(o, "radius");
    it->k = (int)opt_int(o, "k");
    it->most = opt_float(o, "share") * s->radius;
    it->least = 1e-6f * s->radius;      /* where photons meet in a point: of the order of what
                                         * rounding moves them by */
    it->particles = (uint64_t)opt_int(o, "photons");
    if (it->radius > s->radius)
        return err_usage("%s: radius=%g is larger than the scene, expected at most %g", name,
                         (double)it->radius, (double)s->radius);
    if (!lighting_init(&it->lighting, s, o, true, false))
        return false;
    lighting_shares(&it->lighting, 1, 1);
    return photonpass_init(&it->pass, s, it->maxdepth, it->roulette, it->through) &&
           warn_of_scattering(s, name);
}
