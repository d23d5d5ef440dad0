/* racesampler.c -- what a race must know of a sampler before it measures: whether a render of fewer
 * samples is a part of one of more, and whether two seeds make two renders. Both are found by
 * asking it for numbers, not by its name. See race.h. */
#include "render/race.h"

/* Whether the two give other numbers in some samples of some pixels. */
static bool samplers_differ(Sampler *a, Sampler *b, uint32_t samples)
{
    for (uint32_t pixel = 0; pixel < 3; pixel++) {
        sampler_pixel(a, 5 * pixel, pixel);
        sampler_pixel(b, 5 * pixel, pixel);
        for (uint32_t i = 0; i < samples; i++) {
            sampler_start(a, i);
            sampler_start(b, i);
            for (int d = 0; d < 2 * DECIDE_KINDS; d++) {
                V2 u = sample_2d(a, (Decision)d), v = sample_2d(b, (Decision)d);
                if (u.x != v.x || u.y != v.y ||
                    sample_1d(a, (Decision)d) != sample_1d(b, (Decision)d))
                    return true;
            }
        }
    }
    return false;
}

/* Of the points that a decision has, whatever their order. */
static uint64_t points_key(Sampler *s, uint32_t samples, Decision d)
{
    uint64_t sum = 0;

    for (uint32_t i = 0; i < samples; i++) {
        V2 u;
        sampler_start(s, i);
        u = sample_2d(s, d);
        sum += key_with((uint64_t)(u.x * 0x1p24f), (uint64_t)(u.y * 0x1p24f));
    }
    return sum;
}

/* The two samplers of a question; both are to be cleared if it is true. */
static bool open_two(const RaceMethod *m, Sampler s[2], uint32_t spp[2], const uint64_t seed[2])
{
    if (!sampler_init(&s[0], m->sampler, &m->sampler_opts, seed[0], &spp[0]))
        return false;
    if (sampler_init(&s[1], m->sampler, &m->sampler_opts, seed[1], &spp[1]))
        return true;
    sampler_clear(&s[0]);
    return false;
}

bool race_sampler_seeded(const RaceMethod *m, uint32_t spp, bool *seeded)
{
    enum { UNKNOWN = 64 };
    const uint64_t seed[2] = { 1, 2 };
    uint32_t planned[2] = { spp, spp };
    Sampler s[2];

    *seeded = true;
    if (!open_two(m, s, planned, seed))
        return false;
    for (int d = 0; *seeded && d < 2 * DECIDE_KINDS; d++)
        *seeded = points_key(&s[0], spp ? planned[0] : UNKNOWN, (Decision)d) !=
                  points_key(&s[1], spp ? planned[1] : UNKNOWN, (Decision)d);
    sampler_clear(&s[0]);
    sampler_clear(&s[1]);
    return true;
}

bool race_sampler_plans(const RaceMethod *m, uint32_t few, uint32_t many, bool *plans)
{
    const uint64_t seed[2] = { 1, 1 };
    uint32_t planned[2] = { few, many };
    Sampler s[2];

    *plans = false;
    if (!open_two(m, s, planned, seed))
        return false;
    *plans = samplers_differ(&s[0], &s[1], planned[0] < 16 ? planned[0] : 16);
    sampler_clear(&s[0]);
    sampler_clear(&s[1]);
    return true;
}
