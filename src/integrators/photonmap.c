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
 * Tally       Photons do not say how often they were scattered: what is looked up counts as the
 *             shortest path that it may be of. So direct and indirect light are told apart, lengths
 *             above that are not.
 * Misses      What media scatter. */
#include "base/mem.h"
#include "integrators/direct.h"
#include "integrators/photonmaps.h"

typedef struct {
    Integrator base;
    Direct *direct;             /* owned */
    PhotonMaps maps;            /* owned */
    int   gather;               /* rays; 0: direct view */
    int   maxdepth;
} PhotonMap;

/* ---- final gather ---- */

static Rgb gathered(const PhotonMap *it, const Beam *b, const Vertex *v, int n, Tracer *t);

/* Radiance by photons at the beam's end, as the eye gets it, by paths of at least so many edges. */
static Rgb looked_up(const Beam *b, Rgb L, int edges, Tracer *t)
{
    L = rgb_mul(b->throughput, L);
    tracer_tally(t, edges, STRATEGY_MERGE, L);
    return L;
}

/* What comes straight from lamps, and by deltas alone. */
static Rgb lit(const PhotonMap *it, const Beam *b, const Vertex *v, Tracer *t)
{
    Turn u = turn_on(v, b->ray.d, b->medium, b->depth);
    Rgb direct = direct_scattered(it->direct, b, &u, t);
    return rgb_add(direct, looked_up(b, photonmaps_caustics(&it->maps, v), b->depth + 3, t));
}

/* Along a gathering ray from the place: lamps that it finds by deltas are the caustic map's, if
 * there is one, and those that it comes upon at once direct light's. */
static Rgb gathered_along(const PhotonMap *it, Beam *g, V3 from, Tracer *t)
{
    Rgb sum = rgb_all(0.0f);
    bool deltas = false, caustics = it->maps.caustics.wanted > 0;

    for (;;) {
        Vertex v;
        if (!beam_meets(g, &v.s, t))
            return deltas && !caustics ? rgb_add(sum, beam_shows_beyond(g, t)) : sum;
        if (deltas && !caustics && v.s.shape->light != NO_LIGHT)
            sum = rgb_add(sum, beam_shows(g, scene_light_of(t->scene, &v.s), &v.s, t));
        if (g->depth >= it->maxdepth)
            return sum;
        vertex_make(&v, t->scene, g->ray.d);
        if (vertex_is_smooth(&v)) {
            float r2 = 0.0f;
            Rgb L = photonmaps_gathered(&it->maps, &v, &r2);
            if (deltas || v_len2(v_sub(v.s.p, from)) >= r2)
                sum = rgb_add(sum, looked_up(g, L, g->depth + 2, t));
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
    return looked_up(b, photonmaps_radiance(&it->maps, v), b->depth + 3, t);
}

/* What the beam finds until it ends or forks. */
static Rgb found(const PhotonMap *it, Beam *b, Forks *forks, Tracer *t)
{
    Rgb sum = rgb_all(0.0f);

    for (;;) {
        Vertex v;
        if (!beam_meets(b, &v.s, t))
            return rgb_add(sum, beam_shows_beyond(b, t));
        if (v.s.shape->light != NO_LIGHT)
            sum = rgb_add(sum, beam_shows(b, scene_light_of(t->scene, &v.s), &v.s, t));
        if (b->depth >= it->maxdepth)
            return sum;
        vertex_make(&v, t->scene, b->ray.d);
        if (vertex_is_smooth(&v))
            sum = rgb_add(sum, rgb_add(lit(it, b, &v, t), indirect(it, b, &v, t)));
        if (beam_forks(forks, b, &v, t) || !beam_turns_by_delta(b, &v, t))
            return sum;
    }
}

static Rgb radiance(const Integrator *base, const Ray *r, Tracer *t)
{
    Beam b = beam_from_eye(r, t->scene);
    Forks forks = { .n = 0 };
    Rgb sum = rgb_all(0.0f);

    do
        sum = rgb_add(sum, found((const PhotonMap *)base, &b, &forks, t));
    while (forks_next(&forks, &b));
    return sum;
}

/* ---- phases: what direct light prepares, then the maps ---- */

enum { PHASES = 1 + PHOTONMAPS_STAGES };

static bool prepare(Integrator *base, const Film *f, uint64_t seed)
{
    PhotonMap *it = (PhotonMap *)base;
    return integrator_direct.prepare(&it->direct->base, f, seed);
}

static uint64_t units(Integrator *base, const Film *f, uint32_t pass, int phase)
{
    PhotonMap *it = (PhotonMap *)base;

    if (phase == 0)
        return integrator_direct.units(&it->direct->base, f, pass, phase);
    return photonmaps_units(&it->maps, phase - 1, &base->failed);
}

static void run(Integrator *base, Film *f, uint32_t pass, int phase, uint64_t unit, Tracer *t)
{
    PhotonMap *it = (PhotonMap *)base;

    if (phase == 0)
        integrator_direct.run(&it->direct->base, f, pass, phase, unit, t);
    else
        photonmaps_run(&it->maps, phase - 1, unit, t);
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

    integrator_close((Integrator *)it->direct);
    photonmaps_clear(&it->maps);
    mem_free(it);
}

static Integrator *open_photonmap(const Scene *s, const Opts *o)
{
    PhotonMap *it = MEM_NEW(PhotonMap);

    if (!it)
        return NULL;
    it->base.scene = s;
    it->maxdepth = (int)opt_int(o, "maxdepth");
    it->gather = opt_is(o, "view", "gather") ? (int)opt_int(o, "gather") : 0;
    if (warn_of_scattering(s, "photonmap") &&
        (opt_int(o, "photons") > 0 ||
         warn_at((Place){ NULL, 0, 0 }, "photonmap: photons=0 leaves out indirect light")) &&
        photonmaps_open(&it->maps, s, o, it->maxdepth, (int)opt_int(o, "roulette"),
                        it->gather > 0)) {
        it->direct = (Direct *)integrator_open_sharing(&integrator_direct, s, o);
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
    PHOTONMAPS_OPTIONS(200000, 100000, "no indirect light"),
    { .key = "gather", .type = OPT_INT, .num = 8, .lo = 1, .hi = 65536,
      .help = "view=gather: rays from each point" },
    { .key = "strategy", .type = OPT_CHOICE, .str = "mis",
      .choices = DIRECT_CHOICES,
      .help = "how direct light is found: see direct" },
    { .key = "lightsamples", .type = OPT_INT, .num = 1, .lo = 1, .hi = 65536,
      .help = "samples of lights at each point" },
    { .key = "bsdfsamples", .type = OPT_INT, .num = 1, .lo = 1, .hi = 65536,
      .help = "directions to lights from each point" },
    LIGHTING_HEURISTIC,
    LIGHTING_SKY,
    LIGHTING_LIGHTSAMPLER,
    MAXDEPTH_OPTION,
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
