/* vcm.c -- vertex connection and merging: bidirectional path tracing and photon maps as one method,
 * each path weighed by all the ways in which both could have made it.
 *
 * Source      [GIRT 3, 4.2], [Georgiev12]. See vcm.h for its passes, odds.h for its weights.
 * Limits      mode: its techniques in part, as the methods that it is made of have them. */
#include "integrators/vcm.h"

#include "base/maths.h"
#include "base/mem.h"

bool vcm_prepare(Integrator *base, const Film *f, uint64_t seed)
{
    Vcm *it = (Vcm *)base;

    (void)seed;
    it->full_w = f->full_w;
    return lightstore_init(&it->store, base->scene,
                           (uint64_t)f->full_w * f->full_h * it->multiple,
                           it->both.techniques.straight);
}

uint32_t vcm_moment(const Integrator *base, uint32_t pass)
{
    (void)base;
    return pass;
}

/* Sets the radius, and with it how likely mergers are. */
static void begin_pass(Vcm *it, uint32_t pass)
{
    float r = it->radius * m_pow((float)pass + 1.0f, 0.5f * (it->alpha - 1.0f)); /* [GIRT (3.8)] */

    it->store.radius = r;
    for (int k = 0; k < it->radii; k++, r *= 0.5f) {
        it->both.by[k].radius = r;
        it->both.by[k].eta = (float)((double)PI * r * r *              /* [GIRT (3.3)] */
                                     (double)it->store.arrivals.paths);
    }
    it->both.techniques.eta = it->merges ? it->both.by[0].eta : 0.0f;
    it->both.radii = it->merges ? it->radii : 0;
}

uint64_t vcm_units(Integrator *base, const Film *f, uint32_t pass, int phase)
{
    Vcm *it = (Vcm *)base;

    (void)f;
    if (phase == 0)
        begin_pass(it, pass);
    return lightstore_units(&it->store, phase, it->merges);
}

void vcm_run(Integrator *base, Film *f, uint32_t pass, int phase, uint64_t unit, Tracer *t)
{
    Vcm *it = (Vcm *)base;

    (void)f;
    lightstore_run(&it->store, &it->both, pass, phase, unit, t);
}

/* Of several light paths of a pixel, one is connected. */
Rgb vcm_radiance(const Integrator *base, const Ray *r, Tracer *t)
{
    const Vcm *it = (const Vcm *)base;
    uint64_t pixel = (uint64_t)t->y * it->full_w + t->x;
    LightVertex path[DEPTH_MOST];
    int n = 0;

    if (it->both.techniques.connects)
        n = lightstore_path(&it->store, pixel * it->multiple, path, t);
    return bidirectional_look(&it->both, r, path, n, t);
}

void vcm_close(Integrator *base)
{
    Vcm *it = (Vcm *)base;

    lightstore_clear(&it->store);
    bidirectional_clear(&it->both);
    mem_free(it);
}

Integrator *vcm_open(const char *name, const Scene *s, const Opts *o)
{
    Vcm *it = MEM_NEW(Vcm);

    if (!it)
        return NULL;
    it->base.scene = s;
    it->merges = true;
    it->radius = opt_float(o, "radius");
    if (it->radius == 0.0f)
        it->radius = opt_float(o, "share") * s->radius;
    it->alpha = opt_float(o, "alpha");
    it->radii = (int)opt_int(o, "radii");
    it->multiple = (uint32_t)opt_int(o, "paths");
    it->both.store = &it->store;
    it->both.techniques.first = opt_bool(o, "first");
    if (bidirectional_open(&it->both, name, s, o)) {
        it->both.shown *= (float)it->multiple;
        return &it->base;
    }
    vcm_close(&it->base);
    return NULL;
}

static Integrator *open_vcm(const Scene *s, const Opts *o)
{
    Vcm *it = (Vcm *)vcm_open("vcm", s, o);

    if (!it)
        return NULL;
    it->merges = !opt_is(o, "mode", "bdpt") && !opt_is(o, "mode", "lighttracing");
    it->both.techniques.connects = opt_is(o, "mode", "vcm") || opt_is(o, "mode", "bdpt");
    it->both.techniques.straight = !it->both.techniques.connects;
    if (opt_is(o, "mode", "lighttracing"))
        it->both.joins = JOINS_LENS;
    if (opt_is(o, "mode", "ppm")) {
        it->both.joins = JOINS_FIRST_MERGER;
        it->both.techniques.first = true;
    }
    return &it->base;
}

static const OptDef options[] = {
    { .key = "mode", .type = OPT_CHOICE, .str = "vcm", .choices = "vcm bdpt bpm ppm lighttracing",
      .help = "all techniques; connections; mergers; those where the eye's paths first meet what "
              "is no delta; light shown to the lens" },
    VCM_OPTIONS,
    { .key = NULL }
};

const IntegratorKind integrator_vcm = {
    .info = { "vcm", "GIRT 3, 4.2; Georgiev12",
              "paths from the lamps and from the eye, connected and merged", options },
    .truth = CONSISTENT, .misses = "light that media scatter", .splats = true,
    .open = open_vcm, .close = vcm_close, .prepare = vcm_prepare, .radiance = vcm_radiance,
    .anew = true, .moment = vcm_moment, .phases = LIGHTSTORE_PHASES, .units = vcm_units,
    .run = vcm_run
};
