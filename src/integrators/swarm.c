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
 *             which the film makes, and early passes, the noisy ones, are the shortest.
 * Departs     Maps are kept as they are, not inverted: see learned.h. A pixel whose samples were
 *             all black passes its maps on as they came. Maps are used where they are of
 *             use: see guide.h.
 * Windows     The pixels of a window are not those of the whole picture: they have had other
 *             neighbours. */
#include "base/mem.h"
#include "integrators/guide.h"
#include "integrators/lighting.h"

#include <string.h>

enum { NEIGHBOURS = 7, BEFORE = 1 };    /* BEFORE: the tile, as the last pass left it */

extern const IntegratorKind integrator_path;

typedef struct {
    Integrator base;
    Integrator *path;           /* owned */
    GuidePlan plan;
    uint32_t rows;              /* of tiles in a band */
    uint32_t passes;
    float *tiles;               /* owned: of each tile, what the pass before has learned; NULL:
                                 * there is but one pass */
} Swarm;

/* ---- a band ---- */

typedef struct {
    const Swarm *it;
    const Film *film;
    Guide   *guide;             /* owned */
    float   *row[2];            /* owned: maps of pixels, by the last bit of y */
    float   *none;              /* owned: of one that knows nothing */
    float   *sums;              /* owned: of each tile in the row at hand, sums of its pixels' maps;
                                 * NULL: nobody asks */
    uint32_t y0, y1, first;     /* rows; the first one, of practice, is not the band's */
} Band;

static float *maps_at(const Band *b, uint32_t y, int64_t x)
{
    return b->row[y & 1] + (size_t)x * (size_t)b->it->plan.floats;
}

static float *tile_at(const Band *b, float *row_of_tiles, uint32_t x)
{
    return row_of_tiles + (size_t)((x - b->film->x0) / FILM_TILE) * (size_t)b->it->plan.floats;
}

/* Of the tiles in the row that holds y; those above the band, which another one changes, are as
 * its first. */
static float *tiles_of_row(const Band *b, uint32_t y)
{
    uint32_t row = ((y < b->y0 ? b->y0 : y) - b->film->y0) / FILM_TILE;
    return b->it->tiles + (size_t)row * b->film->tiles_x * (size_t)b->it->plan.floats;
}

/* The pixels that are done of those seven, `step` being the way of the row at hand: how many. */
static int neighbours(const Band *b, uint32_t x, uint32_t y, int step, const float **of)
{
    int64_t w = b->film->w, at = (int64_t)x - b->film->x0;
    int n = 0;

    for (int k = 1; k <= 2; k++)
        if (at - k * step >= 0 && at - k * step < w)
            of[n++] = maps_at(b, y, at - k * step);
    for (int64_t k = at - 2; k <= at + 2 && y > b->first; k++)
        if (k >= 0 && k < w)
            of[n++] = maps_at(b, y - 1, k);
    return n;
}

/* Samples of a pass: their numbers, and whether they are for the picture. */
typedef struct { uint32_t first, n; bool keep; } Batch;

static void take_pixel(const Band *b, uint32_t x, uint32_t y, int step, const Batch *s,
                       const Taker *taker)
{
    const Swarm *it = b->it;
    const float *of[NEIGHBOURS + BEFORE];
    float *maps = guide_maps(b->guide);
    size_t floats = (size_t)it->plan.floats;
    int count = neighbours(b, x, y, step, of);

    if (it->tiles && s->first)
        of[count++] = tile_at(b, tiles_of_row(b, y), x);
    if (!count)
        of[count++] = b->none;
    learned_mean(maps, of, count, (int)floats);
    guide_pixel(b->guide, taker->tracer, x, y);
    for (uint32_t i = 0; i < s->n; i++)
        taker->take(taker->ctx, taker->tracer, x, y, s->first + i, s->keep);
    guide_learns(b->guide, taker->tracer);
    memcpy(maps_at(b, y, (int64_t)x - b->film->x0), maps, floats * sizeof *maps);
    if (b->sums && s->keep)
        learned_sum(tile_at(b, b->sums, x), maps, (int)floats);
}

/* The row of tiles is done: what the next pass begins with. */
static void keep_tiles(const Band *b, uint32_t y)
{
    uint32_t first = y - (y - b->film->y0) % FILM_TILE, w = b->film->w;
    float *tiles = tiles_of_row(b, y);
    int floats = b->it->plan.floats;

    for (uint32_t k = 0; k < b->film->tiles_x; k++) {
        uint32_t across = w - k * FILM_TILE < FILM_TILE ? w - k * FILM_TILE : FILM_TILE;
        float share = 1.0f / (float)(across * (y + 1 - first));
        for (int i = 0; i < floats; i++)
            tiles[(size_t)k * (size_t)floats + (size_t)i] = share *
                b->sums[(size_t)k * (size_t)floats + (size_t)i];
    }
    memset(b->sums, 0, (size_t)b->film->tiles_x * (size_t)floats * sizeof *b->sums);
}

static void take_row(const Band *b, uint32_t y, const Batch *s, const Taker *taker)
{
    const Film *f = b->film;
    bool back = y & 1;

    for (uint32_t k = 0; k < f->w; k++)
        take_pixel(b, back ? f->x1 - 1 - k : f->x0 + k, y, back ? -1 : 1, s, taker);
    if (b->sums && s->keep && ((y + 1 - f->y0) % FILM_TILE == 0 || y + 1 == f->y1))
        keep_tiles(b, y);
}

static void band_clear(Band *b)
{
    guide_free(b->guide);
    mem_free(b->row[0]);
    mem_free(b->row[1]);
    mem_free(b->none);
    mem_free(b->sums);
}

/* False: memory, reported. */
static bool band_init(Band *b, const Swarm *it, const Film *f, uint32_t unit)
{
    size_t floats = (size_t)it->plan.floats;

    memset(b, 0, sizeof *b);
    b->it = it;
    b->film = f;
    b->y0 = f->y0 + unit * it->rows * FILM_TILE;
    b->y1 = f->y1 - b->y0 > it->rows * FILM_TILE ? b->y0 + it->rows * FILM_TILE : f->y1;
    b->first = unit ? b->y0 - 1 : b->y0;
    b->guide = guide_new(&it->plan);
    b->none = MEM_ARRAY(float, floats);
    for (int k = 0; k < 2; k++)
        b->row[k] = mem_array(f->w, floats * sizeof *b->row[k]);
    if (it->tiles)
        b->sums = mem_array(f->tiles_x, floats * sizeof *b->sums);
    if (!b->guide || !b->none || !b->row[0] || !b->row[1] || (it->tiles && !b->sums)) {
        band_clear(b);
        return false;
    }
    guide_forget(&it->plan, b->none);
    return true;
}

/* ---- the integrator ---- */

static uint32_t walks(const Integrator *base, const Film *f)
{
    const Swarm *it = (const Swarm *)base;
    return (f->tiles_y + it->rows - 1) / it->rows;
}

static void walk(Integrator *base, const Film *f, uint32_t unit, uint32_t first, uint32_t n,
                 const Taker *taker)
{
    Batch samples = { first, n, true }, practice = { first, n, false };
    Band b;

    if (!band_init(&b, (const Swarm *)base, f, unit)) {
        taker->tracer->failed = true;
        return;
    }
    if (b.first < b.y0)
        take_row(&b, b.first, &practice, taker);
    for (uint32_t y = b.y0; y < b.y1; y++)
        take_row(&b, y, &samples, taker);
    band_clear(&b);
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
    if (it->passes == 1)
        return true;
    it->tiles = mem_array(film_ntiles(f), (size_t)it->plan.floats * sizeof *it->tiles);
    return it->tiles != NULL;
}

static Rgb radiance(const Integrator *base, const Ray *r, Tracer *t)
{
    const Swarm *it = (const Swarm *)base;
    Rgb L = integrator_path.radiance(it->path, r, t);

    if (t->guide)
        guide_ends(t->guide, L);
    return L;
}

static void close_swarm(Integrator *base)
{
    Swarm *it = (Swarm *)base;

    if (it->path)
        integrator_path.close(it->path);
    mem_free(it->tiles);
    mem_free(it);
}

/* What both tables have. */
static Integrator *open_path(const Scene *s, const Opts *o)
{
    Opts p;

    opts_default(&p, integrator_path.info.options);
    for (int i = 0; p.defs[i].key; i++)
        for (int k = 0; o->defs[k].key; k++)
            if (!strcmp(p.defs[i].key, o->defs[k].key))
                p.value[i] = o->value[k];
    return integrator_path.open(s, &p);
}

static Integrator *open_swarm(const Scene *s, const Opts *o)
{
    Swarm *it = MEM_NEW(Swarm);
    int cells[GUIDE_KINDS];

    if (!it)
        return NULL;
    it->base.scene = s;
    it->rows = (uint32_t)opt_int(o, "band");
    it->passes = (uint32_t)opt_int(o, "passes");
    for (int k = 0; k < GUIDE_KINDS; k++)
        cells[k] = (int)opt_int(o, guide_names[k]);
    guide_plan(&it->plan, s, cells, (int)opt_int(o, "bounces"), opt_float(o, "share"),
               opt_bool(o, "coin"));
    it->path = open_path(s, o);
    if (it->path)
        return &it->base;
    close_swarm(&it->base);
    return NULL;
}

#define MAP(name, n, most, what)                                               \
    { .key = name, .type = OPT_INT, .num = n, .lo = 0, .hi = most, .help = what }

static const OptDef options[] = {
    MAP("time", 64, 256, "map of moments of the shutter: cells; 0, here and below: none"),
    MAP("lens", 32, 128, "map of the lens: cells each way"),
    MAP("distance", 64, 256, "map of how far light gets in a medium: cells"),
    MAP("bifurcation", 16, 64, "map of reflecting or refracting: scattering events"),
    MAP("light", 256, 4096, "map of which light: entries; of more lights, several share one"),
    MAP("point", 32, 128, "map of points on lights: cells each way"),
    MAP("direction", 32, 128, "map of scattered directions, by latitude and longitude: cells each "
        "way"),
    { .key = "share", .type = OPT_FLOAT, .num = 0.5, .lo = 0, .hi = 0.95,
      .help = "of decisions about lights, directions and bifurcations, made by maps" },
    { .key = "bounces", .type = OPT_INT, .num = 1, .lo = 1, .hi = GUIDE_BOUNCES,
      .help = "scattering events with maps of their own" },
    { .key = "coin", .type = OPT_BOOL, .num = 0,
      .help = "reflect and refract evenly where no map says otherwise, not by energy" },
    { .key = "passes", .type = OPT_INT, .num = 1, .lo = 1, .hi = 16,
      .help = "of counts that double, each of which knows from the one before what all pixels "
              "around a tile have found" },
    { .key = "band", .type = OPT_INT, .num = 4, .lo = 1, .hi = 65536,
      .help = "rows of tiles that learn from each other, one thread's work" },
    { .key = "maxdepth", .type = OPT_INT, .num = 9, .lo = 0, .hi = 100000,
      .help = "most scattering events of a path; 0 shows lights only" },
    { .key = "strategy", .type = OPT_CHOICE, .str = "mis", .choices = "implicit explicit mis",
      .help = "how paths are completed: by meeting lights, by asking for them, by both" },
    LIGHTING_HEURISTIC,
    LIGHTING_SKY,
    { .key = "roulette", .type = OPT_INT, .num = 4, .lo = 1, .hi = 100000, .also = "rrdepth",
      .help = "first scattering event after which a path may end by chance" },
    LIGHTING_LIGHTSAMPLER,
    { .key = NULL }
};

const IntegratorKind integrator_swarm = {
    .info = { "swarm", "Cline07 9",
              "path tracing guided by maps that neighbouring pixels have learned", options },
    .truth = UNBIASED, .misses = "point and distant lights seen through delta surfaces",
    .open = open_swarm, .close = close_swarm, .prepare = prepare, .radiance = radiance,
    .walks = walks, .walk = walk, .batch = batch, .unkept = true
};
