/* photonmap.c -- photon maps: light is sent out from the lamps once and kept; then the eye looks it
 * up.
 *
 * Source      [Cline07 7.7, figs 7.12 to 7.14; errata 7.7, 7.8], [GIRT 2.3.2].
 * Parts       Where the eye's ray ends, mirrors and glass followed: what comes straight from lamps
 *             is `direct`'s business, by any of its strategies. What comes by way of mirrors and
 *             glass alone is looked up in a map of its own, the caustic map, which has photons
 *             where that light is bright. The rest is indirect light, of which there are two views:
 * Direct view looks it up, too, in a map of all photons but those. It is smooth, blotchy, and dark
 *             in corners, by what the document's figure shows.
 * Gather      sends out rays by the surface, `gather` of them, and looks up there what all photons
 *             tell: blotches are averaged over whatever is around. Matt surfaces have their
 *             irradiance ready at one photon in eight [Christensen99]; where a ray ends nearer than
 *             that was blurred, the light there is found with a ray more instead.
 * Caustics    caustics=0: their photons are the direct view's other photons; gathering rays find
 *             them by chance, without bias and with noise.
 * Bias        Blur; of photons with the radius, see photonstore.h. Depths: a photon that was
 *             scattered n times is seen by at least one event more, by two in the gather, so with
 *             those, maxdepth is what it is to `path`; mirrors before the eye come on top.
 * Misses      What media scatter. */
#include "base/mem.h"
#include "integrators/direct.h"
#include "integrators/photonstore.h"

#define CAP_USUAL 0.1f                  /* of the scene's radius, where nobody says */
#define CAP_CAUSTIC 0.2f                /* of the other one */

typedef struct {
    Integrator base;
    Direct *direct;             /* owned */
    LightSampler *lights;       /* owned: by power */
    PhotonStore photons, caustics;      /* owned */
    PhotonRecords records;      /* owned: of photons */
    PhotonLook look, look_caustics;
    int   gather;               /* rays; 0: direct view */
    int   maxdepth;
    uint64_t first;             /* units of a phase that are of photons; then caustics' */
} PhotonMap;

/* ---- final gather ---- */

static Rgb gathered(const PhotonMap *it, const Beam *b, const Vertex *v, int n, Tracer *t);

/* What all photons tell of the light towards the viewer; *r2: how far they were looked for. */
static Rgb looked_up(const PhotonMap *it, const Vertex *v, float *r2)
{
    static const V3 up = { 0, 0, 1 }, down = { 0, 0, -1 };
    V3 n = v_dot(frame_out(&v->frame, v->wo), v->s.ng) < 0.0f ? v_neg(v->s.ng) : v->s.ng;
    Rgb E;

    if (v->b->kind == &bsdf_diffuse &&
        photonrecords_irradiance(&it->records, &it->look, v->s.p, n, &E, r2))
        return rgb_mul(E, v->b->kind->eval(v->b, v->wo, v->wo.z < 0.0f ? down : up, false));
    return photonstore_radiance(&it->photons, &it->look, v, r2);
}

/* What comes straight from lamps, and by deltas alone. */
static Rgb lit(const PhotonMap *it, const Beam *b, const Vertex *v, Tracer *t)
{
    Turn u = turn_on(v, b->ray.d, b->medium, b->depth);
    Rgb sum = direct_scattered(it->direct, b, &u, t);

    if (it->caustics.n)
        sum = rgb_add(sum, rgb_mul(b->throughput, photonstore_radiance(&it->caustics,
                                                                       &it->look_caustics, v,
                                                                       NULL)));
    return sum;
}

/* Along a gathering ray from the place: lamps that it finds by deltas are the caustic map's, if
 * there is one, and those that it comes upon at once direct light's. */
static Rgb gathered_along(const PhotonMap *it, Beam *g, V3 from, Tracer *t)
{
    Rgb sum = rgb_all(0.0f);
    bool deltas = false;

    for (;;) {
        Vertex v;
        if (!beam_meets(g, &v.s, t))
            return deltas && !it->caustics.wanted ? rgb_add(sum, beam_shows_beyond(g, t)) : sum;
        if (deltas && !it->caustics.wanted && v.s.shape->light != NO_LIGHT)
            sum = rgb_add(sum, beam_shows(g, scene_light_of(t->scene, &v.s), &v.s, t));
        if (g->depth >= it->maxdepth)
            return sum;
        vertex_make(&v, t->scene, g->ray.d);
        if (vertex_is_smooth(&v)) {
            float r2 = 0.0f;
            Rgb L = looked_up(it, &v, &r2);
            if (deltas || v_len2(v_sub(v.s.p, from)) >= r2)
                sum = rgb_add(sum, rgb_mul(g->throughput, L));
            else
                sum = rgb_add(sum, rgb_add(lit(it, g, &v, t), gathered(it, g, &v, 1, t)));
        }
        if (!beam_turns_by_delta(g, &v, t))
            return sum;
        deltas = true;
    }
}

/* By n rays, each with numbers of its own. */
static Rgb gathered(const PhotonMap *it, const Beam *b, const Vertex *v, int n, Tracer *t)
{
    Sampler whole = t->sampler;
    Rgb sum = rgb_all(0.0f);

    for (int k = 0; k < n; k++) {
        float lobe = 0.0f;
        Beam g = *b;
        BsdfSample s;
        V2 u;
        t->sampler = sampler_part(&whole, (uint32_t)n, (uint32_t)k);
        if (v->b->flags & BSDF_LOBES)
            lobe = sample_1d(&t->sampler, DECISION(DECIDE_TRY_LOBE, b->depth));
        u = sample_2d(&t->sampler, DECISION(DECIDE_TRY_DIRECTION, b->depth));
        if (!vertex_sample_by(v, lobe, u, &s) || s.pdf_w == 0.0f)
            continue;
        beam_turn(&g, v, &s);
        g.throughput = rgb_scale(g.throughput, 1.0f / (float)n);
        sum = rgb_add(sum, gathered_along(it, &g, v->s.p, t));
    }
    t->sampler = whole;
    return sum;
}

/* ---- from the eye ---- */

static Rgb indirect(const PhotonMap *it, const Beam *b, const Vertex *v, Tracer *t)
{
    if (it->gather)
        return b->depth + 1 < it->maxdepth ? gathered(it, b, v, it->gather, t) : rgb_all(0.0f);
    return rgb_mul(b->throughput, photonstore_radiance(&it->photons, &it->look, v, NULL));
}

static Rgb radiance(const Integrator *base, const Ray *r, Tracer *t)
{
    const PhotonMap *it = (const PhotonMap *)base;
    Beam b = beam_from_eye(r, t->scene);
    Rgb sum = rgb_all(0.0f);

    for (;;) {
        Vertex v;
        if (!beam_meets(&b, &v.s, t))
            return rgb_add(sum, beam_shows_beyond(&b, t));
        if (v.s.shape->light != NO_LIGHT)
            sum = rgb_add(sum, beam_shows(&b, scene_light_of(t->scene, &v.s), &v.s, t));
        if (b.depth >= it->maxdepth)
            return sum;
        vertex_make(&v, t->scene, b.ray.d);
        if (vertex_is_smooth(&v))
            sum = rgb_add(sum, rgb_add(lit(it, &b, &v, t), indirect(it, &b, &v, t)));
        if (!beam_turns_by_delta(&b, &v, t))
            return sum;
    }
}

/* ---- phases: what direct light prepares; both maps, stage by stage; irradiance ---- */

enum { PHASES = 1 + PHOTONSTORE_STAGES + PHOTONRECORDS_STAGES };

static bool prepare(Integrator *base, const Film *f, uint64_t seed)
{
    PhotonMap *it = (PhotonMap *)base;
    return integrator_direct.prepare(&it->direct->base, f, seed);
}

static uint64_t units(Integrator *base, const Film *f, uint32_t pass, int phase)
{
    PhotonMap *it = (PhotonMap *)base;
    uint64_t n = 0;

    if (phase == 0)
        return integrator_direct.units(&it->direct->base, f, pass, phase);
    if (phase <= PHOTONSTORE_STAGES) {
        it->first = photonstore_units(&it->photons, phase - 1);
        n = it->first + photonstore_units(&it->caustics, phase - 1);
    } else if (it->gather)
        n = photonrecords_units(&it->records, &it->photons, phase - 1 - PHOTONSTORE_STAGES);
    base->failed = it->photons.failed || it->caustics.failed || it->records.failed;
    return base->failed ? 0 : n;
}

static void run(Integrator *base, Film *f, uint32_t pass, int phase, uint64_t unit, Tracer *t)
{
    PhotonMap *it = (PhotonMap *)base;

    if (phase == 0)
        integrator_direct.run(&it->direct->base, f, pass, phase, unit, t);
    else if (phase <= PHOTONSTORE_STAGES) {
        if (unit < it->first)
            photonstore_run(&it->photons, phase - 1, unit, t);
        else
            photonstore_run(&it->caustics, phase - 1, unit - it->first, t);
    } else
        photonrecords_run(&it->records, &it->photons, &it->look, phase - 1 - PHOTONSTORE_STAGES,
                          unit);
}

static void save(const Integrator *base, Saving *s)
{
    integrator_direct.save(&((const PhotonMap *)base)->direct->base, s);
}

static bool load(Integrator *base, Loading *l)
{
    return integrator_direct.load(&((PhotonMap *)base)->direct->base, l);
}

/* ---- opening ---- */

static void close_photonmap(Integrator *base)
{
    PhotonMap *it = (PhotonMap *)base;

    if (it->direct)
        integrator_direct.close(&it->direct->base);
    photonrecords_clear(&it->records);
    photonstore_clear(&it->photons);
    photonstore_clear(&it->caustics);
    lightsampler_close(it->lights);
    mem_free(it);
}

static void choose_look(PhotonMap *it, const Scene *s, const Opts *o)
{
    float cap = opt_float(o, "radius"), caustic = opt_float(o, "causticradius");

    if (!(cap > 0.0f))
        cap = CAP_USUAL * s->radius;
    if (!(caustic > 0.0f))
        caustic = CAP_CAUSTIC * cap;
    it->look.kernel = opt_is(o, "kernel", "constant") ? KERNEL_CONSTANT
                      : opt_is(o, "kernel", "cone") ? KERNEL_CONE : KERNEL_EPANECHNIKOV;
    it->look.k = (uint32_t)opt_int(o, "neighbours");
    it->look.radius2 = f_min(f_sqr(cap), 1e30f);
    it->look_caustics = it->look;
    it->look_caustics.radius2 = f_min(f_sqr(caustic), 1e30f);
}

static bool has_deltas(const Scene *s)
{
    for (size_t i = 0; i < s->nmaterials; i++)
        if (s->materials[i].kind->flags & BSDF_SPECULAR)
            return true;
    return false;
}

static void plan_maps(PhotonMap *it, const Scene *s, const Opts *o)
{
    uint32_t caustics = has_deltas(s) ? (uint32_t)opt_int(o, "caustics") : 0;
    int roulette = (int)opt_int(o, "roulette");

    photonstore_init(&it->photons, it->lights, it->gather ? PHOTONS_ALL
                                               : caustics ? PHOTONS_ROUGH : PHOTONS_INDIRECT,
                     (uint32_t)opt_int(o, "photons"), it->maxdepth - (it->gather ? 2 : 1),
                     roulette);
    photonstore_init(&it->caustics, it->lights, PHOTONS_CAUSTIC, caustics, it->maxdepth - 1,
                     roulette);
}

static Integrator *open_photonmap(const Scene *s, const Opts *o)
{
    PhotonMap *it = MEM_NEW(PhotonMap);

    if (!it)
        return NULL;
    it->base.scene = s;
    it->maxdepth = (int)opt_int(o, "maxdepth");
    it->gather = opt_is(o, "view", "gather") ? (int)opt_int(o, "gather") : 0;
    it->lights = lightsampler_open("power", s);
    choose_look(it, s, o);
    if (it->lights && warn_of_scattering(s, "photonmap") &&
        (opt_int(o, "photons") > 0 ||
         warn_at((Place){ NULL, 0, 0 }, "photonmap: photons=0 leaves out indirect light"))) {
        plan_maps(it, s, o);
        it->direct = (Direct *)direct_open(s, o);
        if (it->direct)
            return &it->base;
    }
    close_photonmap(&it->base);
    return NULL;
}

static const OptDef options[] = {
    { .key = "view", .type = OPT_CHOICE, .str = "gather", .choices = "gather direct",
      .help = "how indirect light is seen: by rays that look up photons where they end, or by "
              "those at the point itself" },
    { .key = "photons", .type = OPT_INT, .num = 200000, .lo = 0, .hi = 1e8,
      .help = "photons to be kept, more or less, at 21 bytes; 0: no indirect light" },
    { .key = "caustics", .type = OPT_INT, .num = 100000, .lo = 0, .hi = 1e8,
      .help = "photons of the map of light that comes by mirrors and glass alone; 0: none such" },
    { .key = "neighbours", .type = OPT_INT, .num = 64, .lo = 2, .hi = PHOTONS_NEAREST_MOST,
      .help = "photons of an estimate: more are smoother, and more blurred", .also = "k" },
    { .key = "radius", .type = OPT_FLOAT, .num = 0, .lo = 0, .hi = 1e30,
      .help = "of an estimate, at most, in scene units; 0: 0.1 of the scene's radius" },
    { .key = "causticradius", .type = OPT_FLOAT, .num = 0, .lo = 0, .hi = 1e30,
      .help = "the same in the map of caustics; 0: 0.2 of the other one" },
    { .key = "kernel", .type = OPT_CHOICE, .str = "epanechnikov",
      .choices = "constant cone epanechnikov",
      .help = "weight of photons by their distance" },
    { .key = "gather", .type = OPT_INT, .num = 16, .lo = 1, .hi = 65536,
      .help = "view=gather: rays from each point" },
    { .key = "strategy", .type = OPT_CHOICE, .str = "mis",
      .choices = "uniform brdf light mis ris twostage triple cut sir",
      .help = "how direct light is found: see direct" },
    { .key = "lightsamples", .type = OPT_INT, .num = 1, .lo = 1, .hi = 65536,
      .help = "samples of lights at each point" },
    { .key = "bsdfsamples", .type = OPT_INT, .num = 1, .lo = 1, .hi = 65536,
      .help = "directions to lights from each point" },
    LIGHTING_HEURISTIC,
    LIGHTING_SKY,
    LIGHTING_LIGHTSAMPLER,
    { .key = "maxdepth", .type = OPT_INT, .num = 9, .lo = 0, .hi = 100000,
      .help = "most scattering events of a path; 0 shows lights only" },
    { .key = "roulette", .type = OPT_INT, .num = 1, .lo = 1, .hi = 100000, .also = "rrdepth",
      .help = "first scattering event after which a photon may end by chance" },
    { .key = NULL }
};

const IntegratorKind integrator_photonmap = {
    .info = { "photonmap", "Cline07 7.7; GIRT 2.3.2",
              "photon maps, seen by a final gather or as they are", options },
    .truth = BIASED, .misses = "details that photons blur; light that media scatter",
    .open = open_photonmap, .close = close_photonmap, .prepare = prepare, .radiance = radiance,
    .phases = PHASES, .units = units, .run = run, .save = save, .load = load
};
