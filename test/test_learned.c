/* test_learned.c -- densities that are learned: what tables draw is what they say, and maps are
 * added to, mixed and averaged as a plain twin does it. */
#include "sampling/learned.h"
#include "test/chi2.h"
#include "test/test.h"

#include <stdlib.h>
#include <string.h>

enum { MOST = 1024, ROOM = 1200 };

typedef struct { Inverted table; float map[MOST], room[ROOM]; bool line; } Drawn;

/* Roots of masses over eight orders of magnitude, and some that are next to nothing. */
static void drawn_init(Drawn *d, LearnedShape s, uint64_t seed, float part)
{
    float worth[MOST] = { 0 };
    Rng r = rng_seed(seed);

    for (int i = 0; i < learned_cells(s); i++) {
        float u = rng_unit(&r);
        worth[i] = u < 0.3f ? 0.0f : m_pow(10.0f, -16.0f * u);
    }
    memset(d->map, 0, sizeof d->map);
    learned_merge(d->map, worth, learned_cells(s), learned_cells(s));
    REQUIRE(inverted_size(s) <= ROOM, "room");
    inverted_make(&d->table, s, d->map, part, d->room);
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
    static const LearnedShape shapes[] = { { 32, 32, NULL, false }, { 16, 4, NULL, false },
                                           { 128, 1, NULL, false }, { 7, 12, NULL, false } };

    for (size_t k = 0; k < sizeof shapes / sizeof *shapes; k++)
        for (int even = 0; even < 2; even++) {
            Drawn d;
            drawn_init(&d, shapes[k], k, even ? 0.7f : 1.0f);
            chi2_expect(&(Chi2){ draw, density, &d, .square = true, .draws = 200000, .seed = k,
                                 .rows = 32, .cols = 64, .halvings = 3 }, "learned");
        }
}

static void chosen(void)
{
    enum { N = 22, DRAWS = 200000 };
    LearnedShape s = { N, 1, NULL, true };
    double expected[N], sum = 0, p;
    uint64_t count[N] = { 0 };
    Rng r = rng_seed(5);
    Drawn d;

    drawn_init(&d, s, 3, 1);
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

/* What a cell gets of a worth of 3 in cell (cx, cy): all of it, as one of 3 or 3 x 3; on a sphere,
 * by the square of its row's sine, if it is no further off than half a cell and one of the
 * equator's. */
static double share_of(LearnedShape s, int x, int y, int cx, int cy)
{
    int dx = abs(x - cx), dy = abs(y - cy);
    double sine = sin(acos(-1.0) * (y + 0.5) / s.h);

    if (s.single)
        return dx || dy ? 0 : 3;
    if (!s.rings)
        return dx <= 1 && dy <= 1 ? 3 : 0;
    dx = s.w - dx < dx ? s.w - dx : dx;
    return dy <= 1 && dx * sine <= 1 + 0.5 * sine ? 3 * sine * sine : 0;
}

/* One worth at every place of a grid finer than the cells: what gets to each cell. */
static void footprints(void)
{
    LearnedRing rings[12];
    const LearnedShape shapes[] = { { 5, 4, NULL, false }, { 16, 12, rings, false },
                                    { 6, 1, NULL, false }, { 6, 1, NULL, true } };

    learned_rings(rings, 12);
    for (size_t k = 0; k < 4; k++)
        for (int at = 0; at < 40 * 40; at++) {
            LearnedShape s = shapes[k];
            V2 place = { ((float)(at % 40) + 0.5f) / 40, ((float)(at / 40) + 0.5f) / 40 };
            int cx = (2 * (at % 40) + 1) * s.w / 80, cy = (2 * (at / 40) + 1) * s.h / 80, wrong = 0;
            float map[16 * 12] = { 0 };
            learned_add(map, s, place, 3);
            for (int i = 0; i < s.w * s.h; i++)
                wrong += fabs((double)map[i] - share_of(s, i % s.w, i / s.w, cx, cy)) > 1e-6;
            EXPECT(!wrong, "shape %d, place %d: %d cells are wrong", (int)k, at, wrong);
        }
}

/* Bad worth adds nothing; none at all leaves the map; else half of the map stays, and less of one
 * that was far brighter; and so with what follows the cells. */
static void merging(void)
{
    LearnedShape s = { 4, 4, NULL, false };
    float map[17], worth[17] = { 0 };

    for (int i = 0; i < 17; i++)
        map[i] = 1;
    learned_add(worth, s, (V2){ 0.5f, 0.5f }, INFINITY);
    learned_add(worth, s, (V2){ 0.5f, 0.5f }, -1.0f);
    learned_add(worth, s, (V2){ 0.5f, 0.5f }, INFINITY - INFINITY);
    learned_merge(map, worth, 16, 17);
    EXPECT(map[3] == 1 && map[16] == 1, "nothing to learn");
    worth[5] = 8;
    worth[16] = 3;
    learned_merge(map, worth, 16, 17);
    EXPECT(fabsf(map[5] - 8.5f) < 1e-6f && fabsf(map[6] - 0.5f) < 1e-6f && map[16] == 3.5f,
           "%.9g, %.9g, %.9g", (double)map[5], (double)map[6], (double)map[16]);
    for (int i = 0; i < 16; i++)
        map[i] = 100;
    map[16] = 1;
    learned_merge(map, worth, 16, 17);          /* 1600, of which ten times 8 count */
    EXPECT(fabsf(map[5] - 10.5f) < 1e-5f && fabsf(map[6] - 2.5f) < 1e-5f &&
           fabsf(map[16] - 3.025f) < 1e-6f, "%.9g, %.9g, %.9g", (double)map[5], (double)map[6],
           (double)map[16]);
}

/* Errata 9.1: two maps of 4 x 4 with spikes in opposite corners. The table of their mean is that of
 * the means of masses, cell by cell; tables whose normalized rows were averaged would leak. */
static void means(void)
{
    LearnedShape s = { 4, 4, NULL, false };
    float a[16], b[16], mean[16], room[40];
    const float *both[2] = { a, b };
    double sum = 0;
    Inverted t;

    for (int i = 0; i < 16; i++) {
        a[i] = i == 0 ? 0.985f : 0.001f;
        b[i] = i == 15 ? 0.985f : 0.001f;
        sum += sqrt(0.5 * ((double)a[i] + (double)b[i]));
    }
    learned_mean(mean, both, 2, 16);
    inverted_make(&t, s, mean, 1.0f, room);
    for (int i = 0; i < 16; i++) {
        V2 place = { 0.25f * (float)(i % 4) + 0.1f, 0.25f * (float)(i / 4) + 0.1f };
        double truth = 16 * sqrt(0.5 * ((double)a[i] + (double)b[i])) / sum;
        EXPECT(fabs((double)inverted_density(&t, place) - truth) < 1e-5 * truth &&
               fabs((double)inverted_alone(&t, place) - truth) < 1e-5 * truth, "cell %d: %g, %g", i,
               (double)inverted_density(&t, place), truth);
    }
}

/* Of as many maps as a pixel may have. */
static void means_of_many(void)
{
    float maps[8][150], mean[150];
    const float *of[8];
    Rng r = rng_seed(5);

    for (int k = 0; k < 8; k++) {
        of[k] = maps[k];
        for (int i = 0; i < 150; i++)
            maps[k][i] = rng_unit(&r);
    }
    for (int n = 1; n <= 8; n++) {
        learned_mean(mean, of, n, 150);
        for (int i = 0; i < 150; i++) {
            double sum = 0;
            for (int k = 0; k < n; k++)
                sum += (double)maps[k][i];
            EXPECT(fabs((double)mean[i] - sum / n) < 1e-6, "%d maps, cell %d: %g", n, i,
                   (double)mean[i]);
        }
    }
}

/* What values would have been to second moments, by a plain twin; and a part of 0 leaves numbers
 * alone. */
static void moments(void)
{
    const float share[5] = { 0, 0.1f, 0.25f, 0.5f, 0.9f };
    float moment[5] = { 1, 1, 1, 1, 1 }, map[4] = { 1, 2, 3, 4 }, room[16], density;
    LearnedShape s = { 2, 2, NULL, false };
    V2 u = { 0.3f, 0.8f }, q;
    Inverted t;

    learned_moments(moment, share, 5, 4.0f, 0.5f, 2.0f, 9.0f);
    for (int k = 0; k < 5; k++) {
        double then = (double)share[k] * 4 + (1 - (double)share[k]) * 0.5;
        EXPECT(fabs((double)moment[k] - (1 + 9 * 2 / then)) < 1e-5, "share %g: %g",
               (double)share[k], (double)moment[k]);
    }
    inverted_make(&t, s, map, 0.0f, room);
    q = inverted_sample(&t, u, &density);
    EXPECT(q.x == u.x && q.y == u.y && density == 1.0f && inverted_density(&t, q) == 1.0f,
           "%g %g, density %g", (double)q.x, (double)q.y, (double)density);
    EXPECT(fabs((double)inverted_alone(&t, q) - 4 * sqrt(3.0) / (1 + sqrt(2.0) + sqrt(3.0) + 2)) <
           1e-6, "%g", (double)inverted_alone(&t, q));
}

const TestCase test_learned[] = {
    { "inverted", inverted, false },
    { "chosen", chosen, false },
    { "footprints", footprints, false },
    { "merging", merging, false },
    { "means", means, false },
    { "means_of_many", means_of_many, false },
    { "moments", moments, false },
    { NULL, NULL, false }
};
