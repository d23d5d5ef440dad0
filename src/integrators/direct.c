/* direct.c -- direct light: what lights show, and what has been scattered once on its way from a
 * light to the eye.
 *
 * Source      [Cline07 4], all of it. The strategies stand in files of their own, see direct.h.
 * Idea        The eye's ray ends on a light, whose radiance it brings, or where light scatters:
 *             there a strategy estimates the light of one scattering, with samples of its own.
 * Specular    Mirrors and glass show what is in them: delta events are followed, up to maxdepth
 *             scattering events in all. With maxdepth=1 the picture is that of path:maxdepth=1,
 *             to the last term; above, only those paths are added of which all events but the last
 *             are delta.
 * Media       Scatter as surfaces do: the eye's ray may end in one, and lights shine through them.
 * Invariants  E[radiance] is the same for every strategy, for scenes without delta lights (uniform
 *             and brdf cannot find those, and say so); but for lights=ward, and for options of
 *             which the table says that they are biased. */
#include "integrators/direct.h"

#include "base/mem.h"
#include "integrators/guide.h"
#include "integrators/twostage.h"
#include "lightsampling/visibility.h"

#define ENTRY(name) &direct_##name,
const DirectStrategy *const direct_strategies[] = { DIRECT_STRATEGIES(ENTRY) NULL };
extern const DirectStrategy direct_sorted;      /* strategy=light with lights=ward or shirley */

Rgb direct_scattered(const Direct *it, const Beam *b, const Turn *u, Tracer *t)
{
    Turn seen = *u;

    seen.to_eye = b->throughput;
    return rgb_mul(b->throughput, it->strategy->light(it, &seen, t));
}

static Rgb radiance(const Integrator *base, const Ray *r, Tracer *t)
{
    const Direct *it = (const Direct *)base;
    const Scene *scene = base->scene;
    Beam b = beam_from_eye(r, scene);
    Rgb sum = rgb_all(0.0f);

    for (;;) {
        Vertex v;
        V3 p = { 0, 0, 0 };                     /* of a scattering in a medium */
        Turn u;
        Event event = beam_flies(&b, &v.s, &p, t);
        if (UNLIKELY(t->guide != NULL))
            guide_flies(t->guide, &b, sum);
        if (event == ESCAPES)
            return rgb_add(sum, beam_shows_beyond(&b, t));
        if (event == ARRIVES && v.s.shape->light != NO_LIGHT)
            sum = rgb_add(sum, beam_shows(&b, scene_light_of(scene, &v.s), &v.s, t));
        if (b.depth >= it->maxdepth)
            return sum;
        if (event == SCATTERS) {
            u = turn_within(scene, p, b.ray.d, b.ray.time, b.medium, b.depth);
            return rgb_add(sum, direct_scattered(it, &b, &u, t));
        }
        vertex_make(&v, scene, b.ray.d);
        if (vertex_is_smooth(&v)) {
            u = turn_on(&v, b.ray.d, b.medium, b.depth);
            sum = rgb_add(sum, direct_scattered(it, &b, &u, t));
        }
        if (!beam_turns_by_delta(&b, &v, t))
            return sum;
    }
}

/* ---- before the first sample ---- */

static bool prepare(Integrator *base, const Film *f, uint64_t seed)
{
    Direct *it = (Direct *)base;

    return !it->strategy->prepare || it->strategy->prepare(it, f, seed, &it->units);
}

static uint64_t units(Integrator *base, const Film *f, uint32_t pass, int phase)
{
    (void)f;
    (void)pass;
    (void)phase;
    return ((Direct *)base)->units;
}

static void run(Integrator *base, Film *f, uint32_t pass, int phase, uint64_t unit, Tracer *t)
{
    const Direct *it = (const Direct *)base;

    (void)f;
    (void)pass;
    (void)phase;
    it->strategy->run(it, unit, t);
}

static void save(const Integrator *base, Saving *s)
{
    const Direct *it = (const Direct *)base;

    if (it->strategy->save)
        it->strategy->save(it, s);
}

static bool load(Integrator *base, Loading *l)
{
    Direct *it = (Direct *)base;

    return !it->strategy->load || it->strategy->load(it, l);
}

/* ---- opening ---- */

static void close_direct(Integrator *base)
{
    Direct *it = (Direct *)base;

    if (it->strategy && it->strategy->close)
        it->strategy->close(it);
    lighting_clear(&it->lighting);
    mem_free(it);
}

static bool choose_strategy(Direct *it, const Opts *o)
{
    const char *name = opt_string(o, "strategy");

    it->which = (WhichLights)opt_choice(o, "lights");
    for (int i = 0; !it->strategy; i++)
        if (!strcmp(direct_strategies[i]->name, name))
            it->strategy = direct_strategies[i];
    it->lighting.all = it->which == LIGHTS_ALL;
    if (it->which == LIGHTS_ALL && (strcmp(name, "light") && strcmp(name, "mis")))
        return err_usage("direct: lights=all goes with strategy=light or mis, not with %s", name);
    if (it->which >= LIGHTS_WARD) {
        if (strcmp(name, "light") || it->lighting.directions)
            return err_usage("direct: lights=%s goes with strategy=light and occlusion=points, "
                             "nothing else", opt_string(o, "lights"));
        it->strategy = &direct_sorted;
    }
    if (it->which == LIGHTS_WARD &&
        !warn_at((Place){ NULL, 0, 0 }, "lights=ward is biased: %g of the light goes untested",
                 (double)it->tolerance))
        return false;
    return it->strategy->finds_deltas || lighting_warn_of_deltas(it->base.scene, name);
}

static Integrator *open_direct(const Scene *s, const Opts *o)
{
    Direct *it = MEM_NEW(Direct);

    if (!it)
        return NULL;
    it->base.scene = s;
    it->maxdepth = (int)opt_int(o, "maxdepth");
    it->lightsamples = (int)opt_int(o, "lightsamples");
    it->bsdfsamples = (int)opt_int(o, "bsdfsamples");
    it->tolerance = opt_float(o, "tolerance");
    if (lighting_init(&it->lighting, s, o, opt_is(o, "strategy", "ris"),
                      opt_is(o, "occlusion", "directions"))) {
        if (choose_strategy(it, o) && (!it->strategy->open || it->strategy->open(it, o)))
            return &it->base;
    }
    it->strategy = NULL;
    close_direct(&it->base);
    return NULL;
}

static const OptDef options[] = {
    { .key = "strategy", .type = OPT_CHOICE, .str = "mis",
      .choices = DIRECT_CHOICES,
      .help = "directions all alike, by the surface, by lights, by both; resampled; twostage: of "
              "the sky, and of rectangles with pictures, by their product with the surface, of "
              "other lights as mis; triple: the same with maps of what hides the sky; cut: "
              "by point lights in clusters; sir: those resampled" },
    { .key = "lightsamples", .type = OPT_INT, .num = 1, .lo = 1, .hi = 65536,
      .help = "samples of lights at each point (light, mis; twostage: of those beside the sky)" },
    { .key = "bsdfsamples", .type = OPT_INT, .num = 1, .lo = 1, .hi = 65536,
      .help = "directions from each point (uniform, brdf, mis; twostage: to other lights)" },
    LIGHTING_HEURISTIC,
    LIGHTING_SKY,
    LIGHTING_LIGHTSAMPLER,
    { .key = "lights", .type = OPT_CHOICE, .str = "chosen", .choices = "chosen all ward shirley",
      .help = "asked at each point: one by lightsampler; each; the brightest and a guess at the "
              "rest (biased); the brightest and one of the rest" },
    { .key = "tolerance", .type = OPT_FLOAT, .num = 0.1, .lo = 0, .hi = 1,
      .help = "part of the light that ward and shirley leave to the rest; at 0.1 pixels by ward "
              "were off by 0.4 and 2 % in two scenes, at 0.4 by 8 and 2 %" },
    { .key = "tentative", .type = OPT_INT, .num = 64, .lo = 1, .hi = SIR_MOST,
      .help = "ris, sir: samples without shadow rays; of ris at most 256" },
    { .key = "samples", .type = OPT_INT, .num = 8, .lo = 1, .hi = SIR_MOST,
      .help = "ris, sir: how many of them are kept; twostage: directions to the sky, points of "
              "each lamp with a picture; cut: point lights chosen" },
    TWOSTAGE_SPLITS(0),
    TWOSTAGE_PEAKS,
    TWOSTAGE_F,
    { .key = "lightshare", .type = OPT_FLOAT, .num = 0.5, .lo = 0, .hi = 1,
      .help = "ris: part of the tentative samples that go by lights, the others by the surface" },
    { .key = "points", .type = OPT_INT, .num = 32768, .lo = 1, .hi = 1 << 24,
      .help = "cut, sir: point lights that stand for all light but delta lights" },
    { .key = "jitter", .type = OPT_BOOL, .num = 1,
      .help = "cut, sir: anywhere in the cell of a point light; false: at the point, biased" },
    { .key = "indirect", .type = OPT_CHOICE, .str = "no", .choices = "no yes only",
      .help = "cut, sir: light of one bounce as well, by points on surfaces (biased); or alone" },
    { .key = "brdf", .type = OPT_CHOICE, .str = "counts", .choices = "counts single none all",
      .help = "cut: clusters by counted rays, by the surface at their middles, by light alone; "
              "all: every point light is asked" },
    { .key = "rays", .type = OPT_INT, .num = 0, .lo = 0, .hi = 65536,
      .help = "cut: rays by the surface that are counted in clusters; 0: 64, or twice as many as "
              "there are samples" },
    { .key = "clusters", .type = OPT_INT, .num = 800, .lo = 1, .hi = 4096,
      .help = "cut: most clusters" },
    { .key = "sigma", .type = OPT_FLOAT, .num = 0, .lo = 0, .hi = 1e30,
      .help = "cut: clusters are divided until this is the root of their summed squares; 0: until "
              "there are as many as may be" },
    { .key = "extent", .type = OPT_FLOAT, .num = 1, .lo = 0, .hi = 1e6,
      .help = "cut: weight of clusters' extent when they are divided; 0: by light alone" },
    { .key = "safe", .type = OPT_FLOAT, .num = 0.1, .lo = 0, .hi = 1,
      .help = "cut: share of choices that go by light alone; 0: none, and no part of lobes counts "
              "as matt; with prior=0 light is lost, as in the source" },
    { .key = "prior", .type = OPT_FLOAT, .num = 2, .lo = 0, .hi = 1e6,
      .help = "cut: rays' worth of evenness by which counts are spread; 0: as the source has it" },
    { .key = "boxes", .type = OPT_BOOL, .num = 0,
      .help = "cut: rays find what is beyond the scene by boxes, not by cells" },
    { .key = "within", .type = OPT_CHOICE, .str = "tree", .choices = "even light tree",
      .help = "cut: lights of a cluster are chosen all alike, by their light, or down the tree" },
    { .key = "judged", .type = OPT_INT, .num = 1, .lo = 1, .hi = SIR_MOST,
      .help = "cut: lights tried for each that is kept, by what they would bring unhindered" },
    { .key = "occlusion", .type = OPT_CHOICE, .str = "points", .choices = "points directions",
      .help = "samples of lights are points of them, wasted if hidden, or directions, in which "
              "whatever shines counts" },
    { .key = "space", .type = OPT_CHOICE, .str = "preimage", .choices = "preimage world",
      .help = "triple: what maps of visibility are of: the numbers that become directions, or "
              "directions" },
    { .key = "lazy", .type = OPT_BOOL,
      .help = "triple: maps are not made beforehand, but of what samples find" },
    { .key = "a", .type = OPT_FLOAT, .num = 0.5, .lo = 0.01, .hi = 1,
      .help = "triple: part of the density in occluded texels that stays there" },
    { .key = "biased", .type = OPT_BOOL,
      .help = "triple: maps are believed, rays cast where they are uncertain only (biased)" },
    { .key = "dim", .type = OPT_BOOL,
      .help = "triple: no bright specks of light from where none was expected (biased)" },
    { .key = "size", .type = OPT_INT, .num = 16, .lo = 1, .hi = VISIBILITY_MOST,
      .help = "triple: texels across a map of visibility" },
    { .key = "spacing", .type = OPT_INT, .num = 8, .lo = 1, .hi = 65536,
      .help = "triple: pixels from map to map" },
    { .key = "maxdepth", .type = OPT_INT, .num = 9, .lo = 0, .hi = 100000,
      .help = "most scattering events, all but the last by perfect mirrors and glass" },
    { .key = NULL }
};

const IntegratorKind integrator_direct = {
    .info = { "direct", "Cline07 4", "direct light, by any of many strategies", options },
    .truth = BIASED, .misses = "light scattered more than once, but for mirrors and glass",
    .open = open_direct, .close = close_direct, .radiance = radiance, .prepare = prepare,
    .phases = 1, .units = units, .run = run, .save = save, .load = load
};
