/* test_learned.c -- densities that are learned: what tables draw is what they say, and maps are
 * added to, mixed and averaged as a plain twin does it. */
#include "sampling/learned.h"
#include "test/chi2.h"
#include "test/test.h"

#include <stdlib.h>
#include <string.h>

enum { MOST = 1024, ROOM = 1200 };

typedef struct { Inverted table; float map[MOST], room[ROOM]; bool line; } Drawn;

/* Masses over eight orders of magnitude, and some that are 0. */
static void drawn_init(Drawn *d, LearnedShape s, uint64_t seed, float constant)
{
    float worth[MOST] = { 0 };
    Rng r = rng_seed(seed);

    for (int i = 0; i < learned_cells(s); i++) {
        float u = rng_unit(&r);
        worth[i] = u < 0.3f ? 0.0f : m_pow(10.0f, -8.0f * u);
    }
    memset(d->map, 0, sizeof d->map);
    REQUIRE(learned_merge(d->map, worth, learned_cells(s), constant), "worth");
    REQUIRE(inverted_size(s) <= ROOM, "room");
    inverted_make(&d->table, s, d->map, constant > 0.0f ? 0.7f : 1.0f, d->room);
    d->line = s.h == 1;
}

static bool draw(const void *of, Rng *rng, V3 *w)
{
    const Drawn *d = of;
    V2 u = { rng_unit(rng), rng_unit(rng) }, q;
    float density;

    q = inverted_sample(&d->table, u, &density);
    EXPECT(density == inverted_density(&d->table, q), "a draw has %.9g, its place %.9g",
           (double)density, (double)inverted_density(&d->table, q));
    EXPECT(q.x >= 0 && q.x < 1 && q.y >= 0 && q.y < 1 && q.x * 0x1p24f == floorf(q.x * 0x1p24f),
           "place %.9g %.9g", (double)q.x, (double)q.y);
    *w = v3(q.x, d->line ? u.y : q.y, 0);
    return true;
}

static double density(const void *of, V3 w)
{
    const Drawn *d = of;
    return (double)inverted_density(&d->table, (V2){ w.x, d->line ? 0.0f : w.y });
}

static void inverted(void)
{
    static const LearnedShape shapes[] = { { 32, 32, false, false }, { 16, 4, true, false },
                                           { 64, 1, false, false }, { 7, 12, false, false } };

    for (size_t k = 0; k < sizeof shapes / sizeof *shapes; k++)
        for (int even = 0; even < 2; even++) {
            Drawn d;
            drawn_init(&d, shapes[k], k, even ? 1.0f / (float)learned_cells(shapes[k]) : 0.0f);
            chi2_expect(&(Chi2){ draw, density, &d, .square = true, .draws = 200000, .seed = k,
                                 .rows = 32, .cols = 64, .halvings = 3 }, "learned");
        }
}

static void chosen(void)
{
    enum { N = 22, DRAWS = 200000 };
    LearnedShape s = { N, 1, false, true };
    double expected[N], sum = 0, p;
    uint64_t count[N] = { 0 };
    Rng r = rng_seed(5);
    Drawn d;

    drawn_init(&d, s, 3, 0);
    for (int i = 0; i < DRAWS; i++) {
        float rest;
        count[inverted_choose(&d.table, rng_unit(&r), &rest)]++;
        EXPECT(rest >= 0 && rest <= 1, "rest %.9g", (double)rest);
    }
    for (int i = 0; i < N; i++) {
        expected[i] = DRAWS * (double)inverted_pmf(&d.table, i);
        sum += expected[i] / DRAWS;
    }
    p = chi2_counts(expected, count, N);
    EXPECT(p >= CHI2_P_MIN && fabs(sum - 1) < 1e-6, "p = %g, sum %g", p, sum);
}

/* One worth of 1 at every place of a grid finer than the cells: what gets to each cell. */
static void footprints(void)
{
    static const LearnedShape shapes[] = { { 5, 4, false, false }, { 5, 4, true, false },
                                           { 6, 1, false, false }, { 6, 1, false, true } };

    for (size_t k = 0; k < 4; k++)
        for (int at = 0; at < 40 * 40; at++) {
            LearnedShape s = shapes[k];
            V2 place = { ((float)(at % 40) + 0.5f) / 40, ((float)(at / 40) + 0.5f) / 40 };
            int cx = (2 * (at % 40) + 1) * s.w / 80, cy = (2 * (at / 40) + 1) * s.h / 80, wrong = 0;
            float map[24] = { 0 };
            learned_add(map, s, place, 3);
            for (int i = 0; i < s.w * s.h; i++) {
                int dx = abs(i % s.w - cx), dy = abs(i / s.w - cy), far = s.single ? 0 : 1;
                dx = s.around && s.w - dx < dx ? s.w - dx : dx;
                wrong += map[i] != (dx <= far && dy <= far ? 3.0f : 0.0f);
            }
            EXPECT(!wrong, "shape %d, place %d: %d cells are wrong", (int)k, at, wrong);
        }
}

/* Bad worth adds nothing; none at all leaves the map; else halves are mixed, and sums stay 1. */
static void merging(void)
{
    LearnedShape s = { 4, 4, false, false };
    float map[16], worth[16] = { 0 }, sum = 0;

    learned_uniform(map, 16);
    learned_add(worth, s, (V2){ 0.5f, 0.5f }, INFINITY);
    learned_add(worth, s, (V2){ 0.5f, 0.5f }, -1.0f);
    learned_add(worth, s, (V2){ 0.5f, 0.5f }, INFINITY - INFINITY);
    EXPECT(!learned_merge(map, worth, 16, 1.0f / 16) && map[3] == 1.0f / 16, "nothing to learn");
    worth[5] = 7;
    EXPECT(learned_merge(map, worth, 16, 1.0f / 16), "something to learn");
    for (int i = 0; i < 16; i++)
        sum += map[i];
    EXPECT(fabsf(sum - 1) < 1e-6f && fabsf(map[5] - (0.5f / 16 + 0.25f + 0.25f / 16)) < 1e-6f &&
           fabsf(map[6] - 0.75f / 16) < 1e-6f, "sum %.9g, cells %.9g, %.9g", (double)sum,
           (double)map[5], (double)map[6]);
}

/* Errata 9.1: two maps of 4 x 4 with spikes in opposite corners. The mean has half of each spike;
 * tables whose normalized rows were averaged would have 0.309, and leak 0.062 beside it. */
static void means(void)
{
    LearnedShape s = { 4, 4, false, false };
    float a[16], b[16], mean[16], room[40];
    const float *both[2] = { a, b };
    Inverted t;

    for (int i = 0; i < 16; i++) {
        a[i] = i == 0 ? 0.985f : 0.001f;
        b[i] = i == 15 ? 0.985f : 0.001f;
    }
    learned_mean(mean, both, 2, 16);
    inverted_make(&t, s, mean, 1.0f, room);
    EXPECT(fabsf(inverted_density(&t, (V2){ 0.1f, 0.1f }) / 16 - 0.493f) < 1e-5f &&
           fabsf(inverted_density(&t, (V2){ 0.9f, 0.9f }) / 16 - 0.493f) < 1e-5f &&
           fabsf(inverted_density(&t, (V2){ 0.9f, 0.1f }) / 16 - 0.001f) < 1e-5f,
           "%g, %g, %g", (double)inverted_density(&t, (V2){ 0.1f, 0.1f }) / 16,
           (double)inverted_density(&t, (V2){ 0.9f, 0.9f }) / 16,
           (double)inverted_density(&t, (V2){ 0.9f, 0.1f }) / 16);
}

const TestCase test_learned[] = {
    { "inverted", inverted, false },
    { "chosen", chosen, false },
    { "footprints", footprints, false },
    { "merging", merging, false },
    { "means", means, false },
    { NULL, NULL, false }
};
