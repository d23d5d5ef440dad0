/* test_swarm_subsets.c -- sample swarming on the scenes of [Cline07 figures 9.3 to 9.9, 9.11 to
 * 9.14], small, with every subset of the seven maps: the mean is that of path tracing.
 *
 * Subsets     A map that a scene has no use for changes no bit, and without maps swarming is path
 *             tracing, bit by bit: both are looked at. What is left of the 127 subsets are those of
 *             the k maps that the scene has a use for, 2^k, and all of them are rendered: a full
 *             factorial. So each sample serves many questions: of one subset; of each map, by the
 *             half of all samples that had it; of each pair, by a quarter.
 * Error       of a mean, from runs of different seeds, tile by tile: pixels of unbiased estimates
 *             are not correlated, even where one has learned from the other, so variances of tiles
 *             add up. Pools of subsets are plain means: weights by variances that are guessed from
 *             the values would be biased themselves.
 * Power       is declared for the mean of one map, `delta` of the scene (a quarter of that under
 *             --long, see physics.h), which sets the number of runs: (8.7 s / delta)^2 samples,
 *             where s is sigma/mu of one sample of the picture. Means of fewer samples find what is
 *             larger by the root of that. No test passes without it.
 * Tails       No pixel of a run may be above 1 % of the sum. */
#include "integrators/guide.h"
#include "test/chi2.h"
#include "test/pictures.h"

#include <stdio.h>
#include <string.h>

enum { SIDE = 32, ACROSS = SIDE / TILE, TILES = ACROSS * ACROSS, SUBSETS = 1 << GUIDE_KINDS };

typedef struct {
    const char *name, *options;
    uint32_t spp;
    uint32_t runs, truth;       /* of each subset; of path tracing: 16 times as many with --long */
    double delta;               /* relative bias of a map that is surely found */
    unsigned idle;              /* maps that find nothing to do here, if they are the only one */
} Figure;

/* ---- means ---- */

typedef struct { double mean, variance; } Mean;         /* variance of the mean */

typedef struct {
    Mean whole, tile[TILES];
    double runs, total, largest;        /* of pixels of runs */
} Estimate;

static uint32_t runs_of(uint32_t runs) { return test_is_long() ? 16 * runs : runs; }

static void add_run(Estimate *e, Stat tile[TILES], const Image *im)
{
    double sum[TILES] = { 0 };

    for (uint32_t y = 0; y < SIDE; y++)
        for (uint32_t x = 0; x < SIDE; x++) {
            double v = (double)rgb_lum(*image_at(im, x, y));
            sum[y / TILE * ACROSS + x / TILE] += v;
            e->total += v;
            e->largest = v > e->largest ? v : e->largest;
        }
    for (int k = 0; k < TILES; k++)
        stat_add(&tile[k], sum[k] / (TILE * TILE));
}

static Estimate estimate(Lab *l, const char *method, uint32_t spp, uint32_t runs, uint64_t seed)
{
    Estimate e;
    Stat tile[TILES];
    RenderSettings settings;
    RenderReport report;
    Image im;
    Film film;

    memset(&e, 0, sizeof e);
    memset(tile, 0, sizeof tile);
    REQUIRE(image_init(&im, SIDE, SIDE), "memory");
    picture_settings(l, &settings, method, SIDE, SIDE, spp);
    for (uint32_t run = 0; run < runs; run++) {
        settings.seed = (seed << 32) + run;
        picture_render(l, &settings, &film, &report);
        film_picture(&film, 0, &im);
        add_run(&e, tile, &im);
        film_clear(&film);
    }
    image_clear(&im);
    e.runs = runs;
    for (int k = 0; k < TILES; k++) {
        double error = stat_error(&tile[k]);
        e.tile[k] = (Mean){ tile[k].mean, error * error };
        e.whole.mean += e.tile[k].mean / TILES;
        e.whole.variance += e.tile[k].variance / TILES / TILES;
    }
    return e;
}

static void mean_add(Mean *a, const Mean *b, double share)
{
    a->mean += share * b->mean;
    a->variance += share * share * b->variance;
}

/* The mean of those subsets that have all maps of `with`. *n: how many these are. */
static Estimate pool(const Estimate *of, const bool used[SUBSETS], unsigned with, int *n)
{
    Estimate e;

    memset(&e, 0, sizeof e);
    *n = 0;
    for (unsigned s = 0; s < SUBSETS; s++)
        *n += used[s] && (s & with) == with;
    for (unsigned s = 0; s < SUBSETS; s++) {
        if (!used[s] || (s & with) != with)
            continue;
        mean_add(&e.whole, &of[s].whole, 1.0 / *n);
        for (int k = 0; k < TILES; k++)
            mean_add(&e.tile[k], &of[s].tile[k], 1.0 / *n);
        e.runs += of[s].runs;
        e.total += of[s].total;
        e.largest = of[s].largest > e.largest ? of[s].largest : e.largest;
    }
    return e;
}

static Stat stat_of(const Estimate *e)
{
    double n = e->runs * TILES;
    return (Stat){ n, e->whole.mean, e->whole.variance * n * (n - 1), e->total, e->largest };
}

/* Tiles that are off up and down might leave the whole as it is. */
static void expect_same_tiles(const Estimate *a, const Estimate *b, const char *what)
{
    double sum = 0, p;

    for (int k = 0; k < TILES; k++) {
        double off = fabs(a->tile[k].mean - b->tile[k].mean) - ROUNDINGS(64) * b->tile[k].mean;
        if (off > 0)
            sum += off * off / (a->tile[k].variance + b->tile[k].variance);
    }
    p = chi2_tail(sum, TILES);
    EXPECT(p >= CHI2_P_MIN, "%s: tiles are off, p = %.3g", what, p);
}

static void expect_same(const Estimate *a, const Estimate *b, double delta, const char *what)
{
    Stat sa = stat_of(a), sb = stat_of(b);

    stat_expect_same(&sa, &sb, delta, what);
    if (test_is_long())                 /* else there are few runs to know a tile's variance by */
        expect_same_tiles(a, b, what);
}

/* ---- subsets ---- */

enum { CELLS = 16 };            /* along the side of a map */

static void name_subset(char text[300], const Figure *f, unsigned subset)
{
    int n = snprintf(text, 300, "swarm:%s", f->options);

    for (int map = 0; map < GUIDE_KINDS; map++)
        n += snprintf(text + n, 300 - (size_t)n, ",%s=%d", guide_names[map],
                      subset >> map & 1 ? CELLS : 0);
}

/* The maps that the scene has a use for. */
static unsigned maps_of(const Scene *s)
{
    int cells[GUIDE_KINDS];
    unsigned maps = 0;
    GuidePlan plan;

    for (int map = 0; map < GUIDE_KINDS; map++)
        cells[map] = CELLS;
    guide_plan(&plan, s, cells, 1, 0.5f, false);
    for (int map = 0; map < GUIDE_KINDS; map++)
        maps |= (plan.shape[guide_map((GuideKind)map, 0)].w ? 1u : 0u) << map;
    return maps;
}

static void render_once(Lab *l, const Figure *f, const char *method, Film *film)
{
    RenderSettings settings;
    RenderReport report;

    picture_settings(l, &settings, method, SIDE, SIDE, f->spp);
    picture_render(l, &settings, film, &report);
}

/* Whether two subsets, or path tracing and none, make the same bits. */
static bool same_bits(Lab *l, const Figure *f, unsigned a, unsigned b)
{
    char method[300];
    Film one, other;
    bool same;

    name_subset(method, f, a);
    render_once(l, f, method, &one);
    if (b)
        name_subset(method, f, b);
    else
        snprintf(method, sizeof method, "path:%s", f->options);
    render_once(l, f, method, &other);
    same = films_equal(&one, &other);
    film_clear(&one);
    film_clear(&other);
    return same;
}

/* Which maps do something, and which do nothing at all. */
static void expect_use(Lab *l, const Figure *f, unsigned maps)
{
    unsigned all = SUBSETS - 1;

    EXPECT(same_bits(l, f, 0, 0), "%s: no maps, but not path tracing", f->name);
    EXPECT(same_bits(l, f, all & ~maps, 0), "%s: maps without use do something", f->name);
    EXPECT(same_bits(l, f, all, maps), "%s: maps without use do something", f->name);
    for (int map = 0; map < GUIDE_KINDS; map++)
        EXPECT(!((maps & ~f->idle) >> map & 1) || !same_bits(l, f, 1u << map, 0),
               "%s: %s does nothing", f->name, guide_names[map]);
}

/* The subset by itself (one: all its maps, and no others), or pools. */
static void compare(const Figure *f, const Estimate *of, const bool used[SUBSETS],
                    const Estimate *truth)
{
    char what[400];
    int half = 0, n;

    for (unsigned s = 0; s < SUBSETS; s++)
        half += used[s];
    half = (half + 1) / 2;              /* without the empty subset it is one less */
    for (unsigned s = 1; s < SUBSETS; s++) {
        Estimate with;
        if (!used[s])
            continue;
        name_subset(what, f, s);
        expect_same(&of[s], truth, f->delta * sqrt((double)half), what);
        with = pool(of, used, s, &n);
        if (n == 1)
            continue;
        snprintf(what, sizeof what, "%s, all with maps %#x", f->name, s);
        expect_same(&with, truth, f->delta * sqrt((double)half / n), what);
    }
}

static void subsets_of(const Figure *f)
{
    ReadLimits limits = READ_LIMITS_DEFAULT;
    static Estimate of[SUBSETS];
    bool used[SUBSETS] = { false };
    char text[300];
    Estimate truth;
    unsigned maps;
    SceneFile file;
    Lab l;

    memset(&l, 0, sizeof l);
    snprintf(text, sizeof text, "scenes/%s.pbrt", f->name);
    REQUIRE(scenefile_read(&file, text, &limits), "%s", text);
    l.scene = file.scene;
    lab_build(&l);
    maps = maps_of(l.scene);
    expect_use(&l, f, maps);
    snprintf(text, sizeof text, "path:%s", f->options);
    truth = estimate(&l, text, f->spp, runs_of(f->truth), SUBSETS);
    for (unsigned s = 1; s < SUBSETS; s++) {
        used[s] = !(s & ~maps);
        name_subset(text, f, s);
        if (used[s])
            of[s] = estimate(&l, text, f->spp, runs_of(f->runs), s);
    }
    compare(f, of, used, &truth);
    l.scene = NULL;
    lab_clear(&l);
    scenefile_clear(&file);
}

/* ---- scenes ---- */

#define IDLE(map) (1u << GUIDE_##map)
#define FIGURES(X)                                                                             \
    X(time, false, "swarm-time", "maxdepth=2,lightsampler=uniform", 64, 7, 26, 0.04, 0)        \
    X(lens, true, "swarm-lens", "maxdepth=2", 64, 18, 130, 0.08, IDLE(POINT))                  \
    X(caustic, true, "swarm-caustic", "maxdepth=4", 64, 25, 95, 0.08,                          \
      IDLE(BIFURCATION) | IDLE(POINT))                                                         \
    X(lights, false, "swarm-lights", "maxdepth=2,lightsampler=uniform", 64, 6, 18, 0.05, 0)    \
    X(glass, false, "swarm-glass", "maxdepth=7", 16, 4, 24, 0.025, IDLE(DIRECTION))            \
    X(fog, true, "swarm-fog", "maxdepth=1,lightsampler=uniform", 64, 38, 200, 0.08,            \
      IDLE(DIRECTION))                                                                         \
    X(probe, false, "swarm-probe", "maxdepth=3", 16, 12, 24, 0.02, 0)                          \
    X(hare, true, "hare", "maxdepth=4", 32, 16, 32, 0.05, 0)                                   \
    X(paperweight, true, "paperweight", "maxdepth=6", 64, 10, 56, 0.08, 0)                     \
    X(glasses, true, "glasses", "maxdepth=10", 16, 4, 16, 0.02, 0)                             \
    X(iguana, true, "iguana", "maxdepth=3", 16, 4, 8, 0.02, IDLE(LENS))

#define FUNCTION(id, slow, name, options, spp, runs, truth, delta, idle)                       \
    static void run_##id(void)                                                            \
    {                                                                                     \
        static const Figure f = { name, options, spp, runs, truth, delta, idle };               \
        subsets_of(&f);                                                                   \
    }
FIGURES(FUNCTION)

#define CASE(id, slow, name, options, spp, runs, truth, delta, idle) { #id, run_##id, slow },
const TestCase test_swarm_subsets[] = { FIGURES(CASE) { NULL, NULL, false } };
