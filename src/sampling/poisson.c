/* poisson.c -- the sampler `poisson`: points that keep a distance from each other.
 *
 * Source      [Cline07 4.5.3]; see darts.c for how sets are made.
 * Idea        Some sets of N points are made on the torus before the render and shared by all
 *             threads. A decision takes one of them, moved by a random vector in each pixel
 *             (`rotation`), in an order of its own: each point is then uniform, and the distance
 *             is kept across the borders of the square, since the torus has none.
 * Tiling      `tile` moves the points on the pixel by the same vector in all pixels, so that they
 *             keep the distance all over the picture, which they tile [Cline07 4.5.3, tiled point
 *             sets]. A tile is one pixel: with larger ones some pixels would have more points than
 *             others. `none` does not move them at all: patterns show, and the picture is biased.
 * 1-D         Strata.
 * Counts      Any. One set has at most 1024 points; more samples take several sets. */
#include "base/mem.h"
#include "sampling/darts.h"
#include "sampling/pattern.h"

enum { SETS = 8, POINTS_MOST = 1024 };
enum { MOVED, TILED, UNMOVED };         /* ways */

/* Sets one after the other; each has N points or, if N is not known, 1 + 2 + 4 + ... of them. */
typedef struct { uint32_t stride; TorusPoint *p; } Sets;

static void clear(Sampler *s)
{
    Sets *sets = s->state;
    mem_free(sets->p);
    mem_free(sets);
}

static bool make_sets(const Sampler *s, const Opts *o)
{
    Sets *sets = s->state;
    DartMethod method = opt_is(o, "method", "darts") ? DARTS_THROWN : DARTS_BEST;
    int relax = (int)opt_int(o, "relax");

    for (uint32_t k = 0; k < SETS; k++) {
        Rng rng = rng_seed(k);
        TorusPoint *p = sets->p + (size_t)k * sets->stride;
        if (s->block && !darts_make(p, s->block, method, relax, &rng))
            return false;
        for (uint32_t n = 1; !s->block && n <= POINTS_MOST; n *= 2)
            if (!darts_make(p + n - 1, n, method, relax, &rng))
                return false;
    }
    return true;
}

static bool init(Sampler *s, const Opts *o, uint32_t *spp)
{
    Sets *sets = MEM_NEW(Sets);

    if (!sets)
        return false;
    s->way = opt_is(o, "randomize", "rotation") ? MOVED
             : opt_is(o, "randomize", "tile") ? TILED : UNMOVED;
    s->fixed = s->way == UNMOVED;
    s->state = sets;
    plan_blocks(s, *spp, POINTS_MOST);
    sets->stride = s->block ? s->block : 2 * POINTS_MOST - 1;
    sets->p = MEM_ARRAY(TorusPoint, (size_t)SETS * sets->stride);
    if (!sets->p || !make_sets(s, o)) {
        clear(s);
        s->state = NULL;
        return false;
    }
    if (*spp > s->block && *spp)
        note("poisson: %lu samples a pixel are taken from sets of %lu", (unsigned long)*spp,
             (unsigned long)s->block);
    return true;
}

static V2 two(Sampler *s, Decision d)
{
    const Sets *sets = s->state;
    uint64_t by = draw64(s->pattern, d | SECOND);
    uint32_t first = s->index - s->at, set = (uint32_t)draw64(s->pattern, d | THIRD) % SETS;
    TorusPoint q;

    if (s->way != MOVED && d == DECISION(DECIDE_PIXEL, 0)) {
        uint64_t common = draw64(s->seed, SECOND | first);
        set = (uint32_t)(common >> 13) % SETS;
        by = s->way == TILED || first ? common : 0;
    }
    q = sets->p[(size_t)set * sets->stride + (s->block ? 0 : s->size - 1) +
                permuted(s->at, s->size, draw64(s->pattern, d))];
    return (V2){ unit_of(q.x + (uint32_t)(by >> 32)), unit_of(q.y + (uint32_t)by) };
}

static const OptDef options[] = {
    { .key = "method", .type = OPT_CHOICE, .str = "best", .choices = "best darts",
      .help = "the best of several candidates, or dart throwing" },
    { .key = "relax", .type = OPT_INT, .lo = 0, .hi = 100,
      .help = "steps of Lloyd's relaxation after that" },
    { .key = "randomize", .type = OPT_CHOICE, .str = "rotation", .choices = "rotation tile none",
      .help = "a shift for each pixel; on the pixel the same one for all; or none" },
    { .key = NULL }
};

const SamplerKind sampler_poisson = {
    .info = { "poisson", "Cline07 4.5.3; Mitchell91",
              "Poisson disk: points keep a distance; any sample count, from sets of at most 1024",
              options },
    .plans = true, .init = init, .clear = clear, .start = pattern_start, .one = stratified_one,
    .two = two
};
