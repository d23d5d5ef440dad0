/* sobol.c -- the sampler `sobol`: the digital sequence of many dimensions, scrambled.
 *
 * Source      [Sobol67], [Cline07 4.5.6]; scrambling by hashing is [Burley20].
 * Idea        Each number is the sum modulo 2 of the direction numbers that the bits of the index
 *             select. A few first dimensions of one sequence serve the decisions that matter most,
 *             so that also pairs of them, as pixel and light, are even; the others have a
 *             (0,2)-sequence each, as `zerotwo`, in an order of its own. The (0,2)-sequence is the
 *             best in 2-D: how many dimensions should be joint is a matter of the scene.
 * Counts      Any; powers of two are best. */
#include "base/mem.h"
#include "sampling/directions.h"
#include "sampling/pattern.h"

enum { DIMENSIONS = 32 };

typedef struct { uint32_t v[DIMENSIONS][DIRECTION_BITS]; } Sobol;

static bool init(Sampler *s, const Opts *o, uint32_t *spp)
{
    Sobol *table = MEM_NEW(Sobol);

    (void)spp;
    if (!table)
        return false;
    s->way = (int)randomize_of(o);
    s->fixed = s->way == FIXED;
    s->dimensions = (int)opt_int(o, "dimensions");
    directions_find(table->v, s->dimensions);
    s->state = table;
    return true;
}

static void clear(Sampler *s) { mem_free(s->state); }

static void start(Sampler *s) { s->reversed = reverse_bits(s->index); }

static float number(const Sampler *s, int k, uint32_t key)
{
    const uint32_t *v = ((const Sobol *)s->state)->v[k];
    uint32_t x = 0;

    for (uint32_t i = s->index; i; i &= i - 1)
        x ^= v[LOWEST_BIT(i)];
    return unit_of(randomized((Randomize)s->way, x, key));
}

static float one(Sampler *s, Decision d)
{
    int k = joint_dimension(d, false, s->dimensions);

    if (k < 0)
        return sampler_zerotwo.one(s, d);
    return number(s, k, (uint32_t)draw64(s->pixel, d | THIRD));
}

static V2 two(Sampler *s, Decision d)
{
    int k = joint_dimension(d, true, s->dimensions);
    uint64_t key;

    if (k < 0)
        return sampler_zerotwo.two(s, d);
    key = draw64(s->pixel, d | THIRD);
    return (V2){ number(s, k, (uint32_t)(key >> 32)), number(s, k + 1, (uint32_t)key) };
}

static const OptDef options[] = {
    RANDOMIZE_OPTION("owen"),
    { .key = "dimensions", .type = OPT_INT, .num = 8, .lo = 0, .hi = DIMENSIONS,
      .help = "of one sequence: pixel, then of each bounce direction, light point, light, lobe" },
    { .key = NULL }
};

const SamplerKind sampler_sobol = {
    .info = { "sobol", "Sobol67; Burley20; Cline07 4.5.6",
              "Sobol's sequence, scrambled, joint for the first decisions; any sample count, "
              "powers of two are best", options },
    .init = init, .clear = clear, .start = start, .one = one, .two = two
};
