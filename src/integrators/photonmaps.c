/* photonmaps.c -- the code of `photonmaps.h` */
#include "integrators/photonmaps.h"

#define CAP_USUAL 0.1f                  /* of the scene's radius, where nobody says */
#define CAP_CAUSTIC 0.2f                /* of the other one */

/* ---- what photons tell ---- */

Rgb photonmaps_radiance(const PhotonMaps *m, const Vertex *v)
{
    return photonstore_radiance(&m->photons, &m->look, v, NULL);
}

Rgb photonmaps_caustics(const PhotonMaps *m, const Vertex *v)
{
    return m->caustics.n ? photonstore_radiance(&m->caustics, &m->look_caustics, v, NULL)
                         : rgb_all(0.0f);
}

Rgb photonmaps_gathered(const PhotonMaps *m, const Vertex *v, float *r2)
{
    static const V3 up = { 0, 0, 1 }, down = { 0, 0, -1 };
    V3 n = v_dot(frame_out(&v->frame, v->wo), v->s.ng) < 0.0f ? v_neg(v->s.ng) : v->s.ng;
    Rgb E;

    if (v->b->kind == &bsdf_diffuse &&
        photonrecords_irradiance(&m->records, &m->look, v->s.p, n, &E, r2))
        return rgb_mul(E, v->b->kind->eval(v->b, v->wo, v->wo.z < 0.0f ? down : up, false));
    return photonstore_radiance(&m->photons, &m->look, v, r2);
}

/* ---- stages: both maps, side by side; irradiance ---- */

uint64_t photonmaps_units(PhotonMaps *m, int stage, bool *failed)
{
    uint64_t n = 0;

    if (stage < PHOTONSTORE_STAGES) {
        m->first = photonstore_units(&m->photons, stage);
        n = m->first + photonstore_units(&m->caustics, stage);
    } else if (m->gather)
        n = photonrecords_units(&m->records, &m->photons, stage - PHOTONSTORE_STAGES);
    *failed = m->photons.failed || m->caustics.failed || m->records.failed;
    return *failed ? 0 : n;
}

void photonmaps_run(PhotonMaps *m, int stage, uint64_t unit, Tracer *t)
{
    if (stage >= PHOTONSTORE_STAGES)
        photonrecords_run(&m->records, &m->photons, &m->look, stage - PHOTONSTORE_STAGES, unit);
    else if (unit < m->first)
        photonstore_run(&m->photons, stage, unit, t);
    else
        photonstore_run(&m->caustics, stage, unit - m->first, t);
}

/* ---- opening ---- */

void photonmaps_clear(PhotonMaps *m)
{
    photonrecords_clear(&m->records);
    photonstore_clear(&m->photons);
    photonstore_clear(&m->caustics);
    lightsampler_close(m->lights);
    memset(m, 0, sizeof *m);
}

static void choose_look(PhotonMaps *m, const Scene *s, const Opts *o)
{
    float cap = opt_float(o, "radius"), caustic = opt_float(o, "causticradius");

    if (!(cap > 0.0f))
        cap = CAP_USUAL * s->radius;
    if (!(caustic > 0.0f))
        caustic = CAP_CAUSTIC * cap;
    m->look.kernel = opt_is(o, "kernel", "constant") ? KERNEL_CONSTANT
                     : opt_is(o, "kernel", "cone") ? KERNEL_CONE : KERNEL_EPANECHNIKOV;
    m->look.k = (uint32_t)opt_int(o, "neighbours");
    m->look.radius2 = f_min(f_sqr(cap), 1e30f);
    m->look_caustics = m->look;
    m->look_caustics.radius2 = f_min(f_sqr(caustic), 1e30f);
}

static bool has_deltas(const Scene *s)
{
    for (size_t i = 0; i < s->nmaterials; i++)
        if (s->materials[i].kind->flags & BSDF_SPECULAR)
            return true;
    return false;
}

bool photonmaps_open(PhotonMaps *m, const Scene *s, const Opts *o, int maxdepth, int roulette,
                     bool gather)
{
    uint32_t caustics = has_deltas(s) ? (uint32_t)opt_int(o, "caustics") : 0;
    PhotonLight light = gather ? PHOTONS_ALL : caustics ? PHOTONS_ROUGH : PHOTONS_INDIRECT;

    memset(m, 0, sizeof *m);
    m->gather = gather;
    m->lights = lightsampler_open("power", s);
    if (!m->lights)
        return false;
    choose_look(m, s, o);
    photonstore_init(&m->photons, m->lights, light, (uint32_t)opt_int(o, "photons"),
                     maxdepth - (gather ? 2 : 1), roulette);
    photonstore_init(&m->caustics, m->lights, PHOTONS_CAUSTIC, caustics, maxdepth - 1, roulette);
    return true;
}
