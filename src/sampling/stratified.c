/* stratified.c -- the sampler `stratified`: one sample in each cell of a grid.
 *
 * Source      [Cline07 4.5.2], jittered samples; the strata may be given, as scene files do.
 * Idea        Where the integrand is smooth within cells, their means hardly differ from what one
 *             sample says: variance N^-2 for smooth integrands, N^-1.5 where an edge crosses them,
 *             N^-1 where every cell has all of the figure, and never above that of independent
 *             samples. Each decision has a grid for itself, taken in an order of its own.
 * Counts      Rounded up to nx x ny with nx <= 2 ny <= 4 nx. */
#include "sampling/pattern.h"

enum { JITTERED, CENTRES };             /* ways */
enum { ALONE = 4 };                     /* strata along the other side, if one is given */

static bool init(Sampler *s, const Opts *o, uint32_t *spp)
{
    uint32_t nx = (uint32_t)opt_int(o, "xsamples"), ny = (uint32_t)opt_int(o, "ysamples");
    uint64_t n;

    s->way = opt_bool(o, "jitter") ? JITTERED : CENTRES;
    s->fixed = opt_is(o, "randomize", "none");
    nx = nx || !ny ? nx : ALONE;
    ny = ny || !nx ? ny : ALONE;
    /* A count on the command line goes before strata of the scene file. */
    if (!nx || (*spp % (nx * ny) && (opt_param(o, "xsamples") || opt_param(o, "ysamples")))) {
        plan_strata(s, spp);
        return true;
    }
    s->nx = nx;
    s->ny = ny;
    s->block = nx * ny;
    n = ((uint64_t)*spp + s->block - 1) / s->block * s->block;
    if (n > UINT32_MAX)
        n = *spp;
    if (n > *spp)
        note("stratified: %lu samples a pixel instead of %lu, for %lu x %lu strata",
             (unsigned long)n, (unsigned long)*spp, (unsigned long)s->nx, (unsigned long)s->ny);
    *spp = (uint32_t)n;
    return true;
}

#define MIDDLE 0x80000000u

static float one(Sampler *s, Decision d)
{
    if (s->way == JITTERED)
        return stratified_one(s, d);
    return in_stratum(permuted(s->at, s->size, draw64(s->pattern, d | THIRD)), s->size, MIDDLE);
}

static V2 two(Sampler *s, Decision d)
{
    uint32_t k = permuted(s->at, s->size, draw64(s->pattern, d));
    uint64_t place = draw64(s->key, d);

    if (s->way == CENTRES)
        place = (uint64_t)MIDDLE << 32 | MIDDLE;
    return (V2){ in_stratum(k % s->nx, s->nx, (uint32_t)(place >> 32)),
                 in_stratum(k / s->nx, s->ny, (uint32_t)place) };
}

static const OptDef options[] = {
    { .key = "xsamples", .type = OPT_INT, .lo = 0, .hi = 32767,
      .help = "strata across, of 2-D decisions; 0: 4, or by the sample count" },
    { .key = "ysamples", .type = OPT_INT, .lo = 0, .hi = 32767,
      .help = "strata down; 0: 4, or by the sample count" },
    { .key = "jitter", .type = OPT_BOOL, .num = 1,
      .help = "a random place in each stratum; else its middle, which is biased" },
    PIXEL_OPTION,
    { .key = NULL }
};

const SamplerKind sampler_stratified = {
    .info = { "stratified", "Cline07 4.5.2",
              "one sample in each cell of a grid, jittered; counts are rounded up to 3 or a "
              "product a b with a <= b <= 2 a", options },
    .plans = true, .init = init, .start = pattern_start, .one = one, .two = two
};
