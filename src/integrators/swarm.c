/* swarm.c -- sample swarming: path tracing whose decisions are guided by maps that neighbouring
 * pixels have learned.
 *
 * Source      [Cline07 9]; errata 9.1 to 9.5. The maps: guide.h, learned.h; the paths: path.c.
 * Idea        Where a sample has been bright, later ones swarm to. A pixel's maps are the mean of
 *             those of seven pixels done before, two behind it and five in the row above
 *             [Cline07 fig. 9.10]; rows run back and forth. Its samples are drawn by that mean;
 *             what they were worth is mixed into it, and that is what the next pixels see.
 * Order       The picture is cut into bands of whole rows of tiles, which know nothing of each
 *             other, so that threads do not matter. So that a band does not begin knowing nothing,
 *             it practises on the row above, without keeping what it sees.
 * Memory      Two rows of maps for each band under way, so for each thread; maps of 32 x 32 cells
 *             take 4 KB each: 28 KB for each pixel of width with every map on.
 * Passes      All samples of a pixel are taken at once. With passes=n, in n passes of counts that
 *             double, and a pass keeps, for each tile, the mean of its pixels' maps, which is an
 *             eighth neighbour to all pixels of the tile in the pass after: so what has been found
 *             gets to all sides, also upwards, which [Cline07 9.4] misses. A pass is unbiased by
 *             itself, whatever the one before has found; so is their mean by count of samples,
 *             which the film makes, and early passes, the noisy ones, are the shortest. Weights by
 *             inverse variance would have to be guessed from the same few samples, and what knows
 *             of the values that it weighs is biased.
 * Departs     Maps are kept as they are, not inverted, and are of squares, not of means, nor are
 *             they normalised: see learned.h. A pixel whose samples were all black passes its maps
 *             on as they came. Maps are used where they are of use: see guide.h; the even part of
 *             preimage maps is what that leaves, at the default share no less than the constant
 *             1/n makes it.
 * Direct      With over=direct the maps of time, lens and distance guide direct light alone: those
 *             that are wrappers over the sampler's decisions before the first vertex.
 * Windows     The pixels of a window are not those of the whole picture: they have had other
 *             neighbours. */
#include "base/mem.h"
#include "integrators/lighting.h"
#include "integrators/swarmbands.h"

extern const IntegratorKind integrator_path, integrator_direct;

typedef struct {
    Integrator base;
    Integrator *over;           /* owned: whose decisions are guided */
    Bands bands;                /* owned */
    uint32_t passes;
} Swarm;

static uint32_t walks(const Integrator *base, const Film *f)
{
    (void)f;
    return ((const Swarm *)base)->bands.n;
}

static void walk(Integrator *base, const Film *f, uint32_t unit, uint32_t first, uint32_t n,
                 const Taker *taker)
{
    (void)f;
    bands_walk(&((Swarm *)base)->bands, unit, first, n, taker);
}

/* Without a plan, passes double from few samples to many. */
static uint32_t batch(const Integrator *base, uint32_t first, uint32_t spp)
{
    enum { FEW = 4, MANY = 64 };
    const Swarm *it = (const Swarm *)base;
    uint32_t n = first ? first : spp >> (it->passes - 1), left = spp - first;

    if (!spp)
        return first < FEW ? FEW : first < MANY ? first : MANY;
    if (it->passes == 1 || left < 2 * n)
        return left;
    return n ? n : 1;
}

static bool prepare(Integrator *base, const Film *f, uint64_t seed)
{
    Swarm *it = (Swarm *)base;

    (void)seed;
    return bands_prepare(&it->bands, f, it->passes > 1);
}

static void save(const Integrator *base, Saving *s)
{
    bands_save(&((const Swarm *)base)->bands, s);
}

static bool load(Integrator *base, Loading *l) { return bands_load(&((Swarm *)base)->bands, l); }

static Rgb radiance(const Integrator *base, const Ray *r, Tracer *t)
{
    const Swarm *it = (const Swarm *)base;
    Rgb L = integrator_radiance(it->over, r, t);

    if (t->guide)
        guide_ends(t->guide, L);
    return L;
}

static void close_swarm(Integrator *base)
{
    Swarm *it = (Swarm *)base;

    integrator_close(it->over);
    bands_clear(&it->bands);
    mem_free(it);
}

static Integrator *open_over(const Scene *s, const Opts *o)
{
    if (opt_is(o, "over", "path"))
        return integrator_open_sharing(&integrator_path, s, o);
    if (!opt_is(o, "strategy", "mis")) {
        err_usage("swarm: over=direct has no strategy=%s", opt_string(o, "strategy"));
        return NULL;
    }
    return integrator_open_sharing(&integrator_direct, s, o);
}

/* Whether the map's decisions are made by whoever follows rays, and not by path.c's vertices. */
static bool asks_before_vertices(int kind)
{
    return kind == GUIDE_TIME || kind == GUIDE_LENS || kind == GUIDE_DISTANCE;
}

static Integrator *open_swarm(const Scene *s, const Opts *o)
{
    Swarm *it = MEM_NEW(Swarm);
    int cells[GUIDE_KINDS];

    if (!it)
        return NULL;
    it->base.scene = s;
    it->bands.rows = (uint32_t)opt_int(o, "band");
    it->passes = (uint32_t)opt_int(o, "passes");
    for (int k = 0; k < GUIDE_KINDS; k++)
        cells[k] = opt_is(o, "over", "path") || asks_before_vertices(k)
                       ? (int)opt_int(o, guide_names[k]) : 0;
    guide_plan(&it->bands.plan, s, cells, (int)opt_int(o, "bounces"), opt_float(o, "share"),
               opt_bool(o, "coin"));
    it->over = open_over(s, o);
    if (it->over)
        return &it->base;
    close_swarm(&it->base);
    return NULL;
}

#define MAP(name, n, most, what)                                               \
    { .key = name, .type = OPT_INT, .num = n, .lo = 0, .hi = most, .help = what }

static const OptDef options[] = {
    { .key = "over", .type = OPT_CHOICE, .str = "path", .choices = "path direct",
      .help = "whose decisions are guided; direct: those of time, lens and distance, and what it "
              "misses is missed" },
    MAP("time", 64, 256, "map of moments of the shutter: cells; 0, here and below: none"),
    MAP("lens", 32, 128, "map of the lens: cells each way"),
    MAP("distance", 64, 256, "map of how far light gets in a medium: cells"),
    MAP("bifurcation", 16, 64, "map of reflecting or refracting: scattering events"),
    MAP("light", 256, 4096, "map of which light: entries; of more lights, several share one"),
    MAP("point", 32, 128, "map of points on lights: cells each way"),
    MAP("direction", 16, 128, "map of scattered directions, by latitude and longitude: cells each "
        "way"),
    { .key = "share", .type = OPT_FLOAT, .num = 0.5, .lo = 0, .hi = 0.95,
      .help = "of decisions, made by maps" },
    { .key = "bounces", .type = OPT_INT, .num = 1, .lo = 1, .hi = GUIDE_BOUNCES,
      .help = "scattering events with maps of their own" },
    { .key = "coin", .type = OPT_BOOL, .num = 0,
      .help = "reflect and refract evenly where no map says otherwise, not by energy" },
    { .key = "passes", .type = OPT_INT, .num = 1, .lo = 1, .hi = 16,
      .help = "of counts that double, each of which knows from the one before what all pixels "
              "around a tile have found" },
    { .key = "band", .type = OPT_INT, .num = 4, .lo = 1, .hi = 65536,
      .help = "rows of tiles that learn from each other, one thread's work" },
    MAXDEPTH_OPTION,
    { .key = "strategy", .type = OPT_CHOICE, .str = "mis", .choices = "implicit explicit mis",
      .help = "how paths are completed: by meeting lights, by asking for them, by both" },
    LIGHTING_HEURISTIC,
    LIGHTING_SKY,
    ROULETTE_OPTION(4),
    LIGHTING_LIGHTSAMPLER,
    { .key = NULL }
};

const IntegratorKind integrator_swarm = {
    .info = { "swarm", "Cline07 9",
              "path tracing guided by maps that neighbouring pixels have learned", options },
    .truth = UNBIASED, .misses = "point and distant lights seen through delta surfaces",
    .open = open_swarm, .close = close_swarm, .prepare = prepare, .radiance = radiance,
    .walks = walks, .walk = walk, .batch = batch, .save = save, .load = load
};
