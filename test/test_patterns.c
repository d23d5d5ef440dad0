/* test_patterns.c -- what defines each pattern: one sample in each stratum, row, column and
 * elementary box; a least distance; permutations without bias; and blocks, rounding and names. */
#include "base/file.h"
#include "render/plot.h"
#include "render/render.h"
#include "sampling/darts.h"
#include "sampling/directions.h"
#include "sampling/pattern.h"
#include "test/chi2.h"
#include "test/pictures.h"

#include <stdio.h>
#include <string.h>

enum { MOST = 1024 };                   /* points of a pattern here */

/* A sampler by text, "halton:randomize=none"; *spp as planned and as rounded. */
static Sampler pattern_of(const char *text, uint32_t *spp)
{
    Arena arena = { 0 };
    Sampler s;
    Opts o;
    const SamplerKind *kind = kind_from_text(samplers, "sampler", text, &o, &arena);

    messages_quiet(true);
    memset(&s, 0, sizeof s);
    REQUIRE(kind && sampler_init(&s, kind, &o, 5, spp), "%s", text);
    arena_clear(&arena);
    return s;
}

/* The points of decision d, samples [first, first + n) of a pixel. */
static void points(Sampler *s, uint32_t pixel, Decision d, uint32_t first, uint32_t n, V2 *u)
{
    sampler_pixel(s, pixel % 100, pixel / 100);
    for (uint32_t i = 0; i < n; i++) {
        sampler_start(s, first + i);
        u[i] = sample_2d(s, d);
    }
}

static void numbers(Sampler *s, uint32_t pixel, Decision d, uint32_t first, uint32_t n, V2 *u)
{
    sampler_pixel(s, pixel % 100, pixel / 100);
    for (uint32_t i = 0; i < n; i++) {
        sampler_start(s, first + i);
        u[i] = (V2){ sample_1d(s, d), 0 };
    }
}

/* ---- strata ---- */

/* Which of n strata. A number stands for all from it to the next multiple of 2^-24: where a border
 * lies between, which is rare, the stratum is not known: -1. */
static int stratum(float x, uint32_t n)
{
    uint64_t k = (uint64_t)(x * 0x1p24f);
    uint64_t lo = k * n >> 24, hi = ((k + 1) * n - 1) >> 24;
    return lo == hi ? (int)lo : -1;
}

/* Whether the n points fill nx x ny cells, one each (n of them, if there are more). -1: not known.
 * `exact`: points that stand on the borders themselves, and so count for the stratum above. */
static int fill(const V2 *u, uint32_t n, uint32_t nx, uint32_t ny, bool exact)
{
    static unsigned char seen[MOST * MOST];

    memset(seen, 0, (size_t)nx * ny);
    for (uint32_t i = 0; i < n; i++) {
        float half = exact ? 0x1p-24f : 0;
        int x = stratum(f_min(u[i].x + half, ONE_MINUS_ULP), nx);
        int y = stratum(f_min(u[i].y + half, ONE_MINUS_ULP), ny);
        if (x < 0 || y < 0)
            return -1;
        if (seen[(uint32_t)y * nx + (uint32_t)x]++)
            return 0;
    }
    return 1;
}

/* Counts what is known; at least nine tenths must be. */
typedef struct { int known, all; } Known;

static void expect_filled(Known *k, int filled, const char *text, uint32_t n, uint32_t nx,
                          uint32_t ny)
{
    k->all++;
    k->known += filled >= 0;
    EXPECT(filled, "%s: %lu points in %lu x %lu cells", text, (unsigned long)n, (unsigned long)nx,
           (unsigned long)ny);
}

/* Each pattern of N planned samples, what it rounds them to and its cells, of 2-D decisions: nx x
 * ny, and if fine also 1 x N and N x 1. */
typedef struct { const char *text; uint32_t planned, n, nx, ny; bool fine; } Strata;

static void strata(void)
{
    static const Strata all[] = {
        { "stratified", 1, 1, 1, 1, false },     { "stratified", 2, 2, 1, 2, false },
        { "stratified", 5, 6, 2, 3, false },     { "stratified", 7, 8, 2, 4, false },
        { "stratified", 64, 64, 8, 8, false },   { "stratified", 96, 96, 8, 12, false },
        { "stratified:xsamples=3,ysamples=5", 20, 30, 3, 5, false },
        { "stratified:jitter=false", 16, 16, 4, 4, false },
        { "uncorrelated", 2, 4, 2, 2, false },   { "uncorrelated", 30, 36, 6, 6, false },
        { "uncorrelated", 256, 256, 16, 16, false },
        { "uncorrelated:match=permuted", 3, 3, 1, 3, false },
        { "uncorrelated:match=permuted", 32, 32, 4, 8, false },
        { "nrooks", 1, 1, 1, 1, true },          { "nrooks", 17, 17, 1, 17, true },
        { "nrooks", 100, 100, 100, 1, true },
        { "multijittered", 16, 16, 4, 4, true }, { "multijittered", 7, 8, 2, 4, true },
        { "multijittered", 100, 100, 10, 10, true },
        { "cmj", 16, 16, 4, 4, true },           { "cmj", 100, 100, 10, 10, true },
        { "cmj", 7, 7, 1, 7, false },            { "cmj", 72, 72, 8, 9, true },
        { "hammersley:randomize=owen", 64, 64, 8, 8, true },
    };
    static V2 u[MOST];

    for (size_t k = 0; k < sizeof all / sizeof all[0]; k++) {
        const Strata *a = &all[k];
        uint32_t spp = a->planned;
        Sampler s = pattern_of(a->text, &spp);
        Known known = { 0, 0 };
        EXPECT(spp == a->n, "%s: %lu samples became %lu", a->text, (unsigned long)a->planned,
               (unsigned long)spp);
        for (uint32_t pixel = 0; pixel < 60; pixel++) {
            uint32_t block = s.block, first = pixel % 3 * block;
            Decision d = pixel * 5 % 7 + pixel % 4 * DECIDE_KINDS;
            points(&s, pixel, d, first, block, u);
            expect_filled(&known, fill(u, block, a->nx, a->ny, false), a->text, block, a->nx,
                          a->ny);
            if (a->fine) {
                expect_filled(&known, fill(u, block, block, 1, false), a->text, block, block, 1);
                expect_filled(&known, fill(u, block, 1, block, false), a->text, block,
                              1, block);
            }
            numbers(&s, pixel, d, first, block, u);
            expect_filled(&known, fill(u, block, block, 1, false), a->text, block, block, 0);
        }
        EXPECT(10 * known.known >= 9 * known.all, "%s: %d of %d known", a->text, known.known,
               known.all);
        sampler_clear(&s);
    }
}

/* Rotated points of Hammersley: all at the same place between the borders of N columns, one in
 * each; where N is a power of two, so with the rows. */
static void rotated(void)
{
    static const uint32_t counts[] = { 1, 2, 9, 16, 25, 64, 100 };
    static V2 u[MOST];

    for (int k = 0; k < 7; k++)
        for (uint32_t pixel = 0; pixel < 50; pixel++) {
            uint32_t spp = counts[k], n = spp;
            Sampler s = pattern_of("hammersley", &spp);
            static unsigned char seen[2][MOST];
            memset(seen, 0, sizeof seen);
            points(&s, pixel, pixel % 8, pixel % 3 * n, n, u);
            for (uint32_t i = 0; i < n; i++)
                for (int axis = 0; axis < 2; axis++) {
                    double x = axis ? (double)u[i].y - u[0].y : (double)u[i].x - u[0].x;
                    double at = (x < 0 ? x + 1 : x) * n, cell = floor(at + 0.5);
                    if (axis && (n & (n - 1)))
                        continue;
                    EXPECT(fabs(at - cell) < n * 0x1p-22 && !seen[axis][(int)cell % (int)n]++,
                           "%lu points, axis %d: one at %g", (unsigned long)n, axis, at);
                }
        }
}

/* Where the number is not known, the blocks 1, 1, 2, 4, 8, ... are patterns each. */
static void blocks_unknown(void)
{
    static const char *const text[] = { "stratified", "multijittered", "cmj", "nrooks",
                                        "uncorrelated", "hammersley:randomize=owen" };
    static V2 u[MOST];

    for (int k = 0; k < 6; k++) {
        uint32_t spp = 0;
        Sampler s = pattern_of(text[k], &spp);
        EXPECT(spp == 0, "%s plans", text[k]);
        for (uint32_t n = 1; n <= 512; n *= 2)
            for (uint32_t pixel = 0; pixel < 20; pixel++) {
                bool rooks = k >= 1 && k != 4;
                points(&s, pixel, pixel % 9, n, n, u);
                EXPECT(rooks || s.nx * s.ny == n, "strata");
                EXPECT(k == 3 || k == 5 || fill(u, n, s.nx, s.ny, false) == 1, "%s: %lu in cells",
                       text[k], (unsigned long)n);
                EXPECT(!rooks || (fill(u, n, n, 1, false) == 1 && fill(u, n, 1, n, false) == 1),
                       "%s: %lu rooks", text[k], (unsigned long)n);
            }
        sampler_clear(&s);
    }
}

/* ---- permutations ---- */

static void expect_even(const uint64_t *count, size_t n, uint64_t draws, const char *what,
                        uint32_t of)
{
    static double expected[MOST * 64];
    double p;

    for (size_t i = 0; i < n; i++)
        expected[i] = (double)draws / (double)n;
    p = chi2_counts(expected, count, n);
    EXPECT(p >= CHI2_P_MIN, "%s of %lu: p = %g", what, (unsigned long)of, p);
}

static void permutations(void)
{
    static const uint32_t sizes[] = { 1, 2, 3, 5, 16, 17, 31, 32, 33, 64, 100, 1000, 1023 };
    static unsigned char seen[MOST];

    for (size_t k = 0; k < sizeof sizes / sizeof sizes[0]; k++)
        for (uint64_t key = 0; key < 200; key++) {
            uint32_t n = sizes[k];
            memset(seen, 0, n);
            for (uint32_t i = 0; i < n; i++) {
                uint32_t to = permuted(i, n, mix64(key));
                EXPECT(to < n && !seen[to]++, "%lu of %lu goes to %lu", (unsigned long)i,
                       (unsigned long)n, (unsigned long)to);
            }
        }
    for (uint32_t i = 0; i < 1000; i++)
        EXPECT(permuted(i, UINT32_MAX, 3) < UINT32_MAX, "of very many");
}

/* The places of two things: all pairs alike often; of three things, all six orders. */
static void permutations_even(void)
{
    static const uint32_t sizes[] = { 3, 4, 7, 16, 17, 24, 32, 64, 200 };
    enum { DRAWS = 400000 };

    for (size_t k = 0; k < sizeof sizes / sizeof sizes[0]; k++) {
        static uint64_t count[200 * 200];
        uint32_t n = sizes[k];
        for (uint32_t step = 1; step < n; step += n / 3) {
            memset(count, 0, sizeof count);
            for (uint64_t key = 0; key < DRAWS; key++) {
                uint64_t hashed = key_with(77, key);
                uint32_t a = permuted(0, n, hashed), b = permuted(step, n, hashed);
                count[a * (n - 1) + (b > a ? b - 1 : b)]++;
            }
            expect_even(count, (size_t)n * (n - 1), DRAWS, "pairs", n);
        }
    }
}

/* ---- uncorrelated jittering ---- */

/* Which stratum (part, within) of m parts, m = a b, a point is in: the inverse of in_cell. */
static uint32_t part_of(V2 u, uint32_t m, uint32_t a)
{
    uint32_t b = m / a, column = (uint32_t)(u.x * (float)m), row = (uint32_t)(u.y * (float)m);
    return (row / a * a + column / b) * m + (row % a * b + column % b);
}

static void uncorrelated(void)
{
    enum { M = 4, N = 16, A = 2, PIXELS = 200000 };
    static uint64_t pairs[N * N], ones[N * N];
    static V2 p[N], q[N], r[N];
    uint32_t spp = N;
    Sampler s = pattern_of("uncorrelated", &spp);

    for (uint32_t pixel = 0; pixel < PIXELS; pixel++) {
        unsigned parts = 0, spans = 0;
        points(&s, pixel, DECISION(DECIDE_PIXEL, 0), 0, N, p);
        points(&s, pixel, DECISION(DECIDE_LENS, 0), 0, N, q);
        numbers(&s, pixel, DECISION(DECIDE_TIME, 0), 0, N, r);
        for (int i = 0; i < N; i++) {
            uint32_t from = part_of(p[i], M, A), to = part_of(q[i], M, A);
            uint32_t at = (uint32_t)(r[i].x * N);
            pairs[from * N + to]++;
            ones[from * N + at]++;
            parts |= 1u << (from / M * M + to / M);
            spans |= 1u << (from / M * M + at / M);
        }
        EXPECT(parts == 0xFFFF && spans == 0xFFFF, "a part of the pixel misses one of the lens");
    }
    expect_even(pairs, N * N, (uint64_t)PIXELS * N, "pairs of strata", N);
    expect_even(ones, N * N, (uint64_t)PIXELS * N, "strata and spans", N);
}

/* ---- distances ---- */

/* The most that n points can have on a torus without borders: the hexagonal lattice. */
static double most_apart(uint32_t n) { return sqrt(2 / (sqrt(3.0) * n)); }

static void expect_apart(const V2 *u, uint32_t n, double least, const char *what)
{
    static TorusPoint p[MOST];
    double d;

    for (uint32_t i = 0; i < n; i++)
        p[i] = (TorusPoint){ (uint32_t)(u[i].x * 0x1p24f) << 8, (uint32_t)(u[i].y * 0x1p24f) << 8 };
    d = darts_distance(p, n);
    EXPECT(n == 1 || d >= least * most_apart(n), "%s: %lu points at %g of the most", what,
           (unsigned long)n, d / most_apart(n));
}

/* Of random points, some pair is as near as 1 / N. */
static void distances(void)
{
    static const struct { const char *text; double least; } all[] = {
        { "poisson:method=darts", 0.63 }, { "poisson", 0.5 },
        { "poisson:method=darts,relax=20", 0.69 }, { "poisson:relax=20", 0.69 },
        { "poisson:randomize=tile", 0.5 }, { "poisson:randomize=none", 0.5 }
    };
    static const uint32_t counts[] = { 1, 2, 3, 4, 16, 37, 0 };
    static V2 u[MOST];

    for (size_t k = 0; k < sizeof all / sizeof all[0]; k++)
        for (int c = 0; c < (k == 1 ? 7 : 6); c++) {
            uint32_t spp = counts[c], n = spp ? spp : 128;
            Sampler s = pattern_of(all[k].text, &spp);
            for (uint32_t pixel = 0; pixel < 30; pixel++) {
                points(&s, pixel, pixel % 3 * 4, spp ? pixel % 2 * spp : n, n, u);
                expect_apart(u, n, all[k].least, all[k].text);
            }
            sampler_clear(&s);
        }
}

/* Several sets where one would be too large; and all over the picture one pattern. */
static void tiles(void)
{
    static V2 u[MOST];
    uint32_t spp = 1500, few = 9;
    Sampler s = pattern_of("poisson", &spp), t = pattern_of("poisson:randomize=tile", &few);

    EXPECT(spp == 1500 && s.block == 750, "1500 in sets of %lu", (unsigned long)s.block);
    points(&s, 3, 4, 750, 750, u);
    expect_apart(u, 750, 0.5, "the second set");
    for (uint32_t pixel = 0; pixel < 36; pixel++) {     /* 6 x 6 of them, as one square */
        sampler_pixel(&t, pixel % 6, pixel / 6);
        for (uint32_t i = 0; i < 9; i++) {
            V2 *v = &u[pixel * 9 + i];
            sampler_start(&t, i);
            *v = sample_2d(&t, DECISION(DECIDE_PIXEL, 0));
            *v = (V2){ (v->x + (float)(pixel % 6)) / 6, (v->y + (float)(pixel / 6)) / 6 };
        }
    }
    expect_apart(u, 36 * 9, 0.5, "36 pixels");
    sampler_clear(&s);
    sampler_clear(&t);
}

/* ---- sequences ---- */

/* Elementary boxes b1^-k1 x b2^-k2 of any aligned b1^k1 b2^k2 samples. */
static void halton_boxes(void)
{
    static const struct { Decision d; uint32_t b1, b2; } pairs[] = {
        { DECISION(DECIDE_PIXEL, 0), 2, 3 }, { DECISION(DECIDE_DIRECTION, 0), 5, 7 },
        { DECISION(DECIDE_LIGHT_POINT, 0), 11, 13 }, { DECISION(DECIDE_DIRECTION, 3), 2, 3 }
    };
    static const char *const text[] = { "halton:dimensions=8",
                                        "halton:dimensions=8,randomize=permutedigits",
                                        "halton:dimensions=8,randomize=none" };
    static V2 u[MOST];
    Known known = { 0, 0 };

    for (int way = 0; way < 3; way++)
        for (int p = 0; p < 3 + (way < 2); p++)
            for (uint32_t nx = 1; nx <= 16; nx *= pairs[p].b1)
                for (uint32_t ny = 1; nx * ny <= 432; ny *= pairs[p].b2) {
                    /* of its own pattern, the fourth pair has blocks of the planned size */
                    uint32_t n = nx * ny, spp = p == 3 ? n : 432;
                    Sampler s = pattern_of(text[way], &spp);
                    for (uint32_t pixel = 0; pixel < 10; pixel++) {
                        uint32_t first = pixel % 3 * n;
                        points(&s, pixel, pairs[p].d, first + n <= spp ? first : 0, n, u);
                        expect_filled(&known, fill(u, n, nx, ny, way == 2), text[way], n, nx, ny);
                    }
                    sampler_clear(&s);
                }
    EXPECT(10 * known.known >= 9 * known.all, "%d of %d known", known.known, known.all);
}

/* All shapes of boxes, for those that are nets in base 2, in each way that keeps them. */
static void nets(void)
{
    static const char *const text[] = {
        "zerotwo", "zerotwo:randomize=permutedigits", "zerotwo:randomize=none",
        "hammersley:randomize=owen", "hammersley:randomize=permutedigits",
        "hammersley:randomize=none", "sobol", "sobol:randomize=permutedigits",
        "sobol:randomize=none", "sobol:dimensions=0"
    };
    static V2 u[MOST];

    for (int k = 0; k < 10; k++)
        for (uint32_t m = 0; m <= 8; m++) {
            uint32_t n = 1u << m, spp = n;
            Sampler s = pattern_of(text[k], &spp);
            for (uint32_t pixel = 0; pixel < 20; pixel++) {
                Decision d = pixel % 2 ? DECISION(DECIDE_PIXEL, 0) : DECISION(DECIDE_LENS, 2);
                points(&s, pixel, d, pixel % 3 * n, n, u);
                for (uint32_t a = 0; a <= m; a++)
                    EXPECT(fill(u, n, 1u << a, n >> a, false) == 1, "%s: %lu in %lu columns",
                           text[k], (unsigned long)n, (unsigned long)1 << a);
            }
            sampler_clear(&s);
        }
}

/* Boxes of 2^(t - m) hold 2^t of the first 2^m points: the definition, by counting. */
static bool is_net(const uint32_t *a, const uint32_t *b, int m, int t)
{
    for (int k = 0; k <= m - t; k++) {
        static uint32_t count[MOST];
        memset(count, 0, sizeof count);
        for (uint32_t i = 0; i < 1u << m; i++) {
            uint32_t x = 0, y = 0;
            for (int bit = 0; bit < m; bit++)
                if (i >> bit & 1) {
                    x ^= a[bit];
                    y ^= b[bit];
                }
            count[(uint32_t)((uint64_t)x >> (32 - k)) << (m - t - k) |
                  (uint32_t)((uint64_t)y >> (32 - (m - t - k)))]++;
        }
        for (uint32_t c = 0; c < 1u << (m - t); c++)
            if (count[c] != 1u << t)
                return false;
    }
    return true;
}

/* t of two dimensions is at most the sum of their degrees less 1 each [Sobol67]: that depends on
 * the polynomials and on the recurrence. */
static void directions(void)
{
    enum { N = 48 };
    static const int degree[N] = { 1, 1, 2, 3, 3, 4, 4, 5, 5, 5, 5, 5, 5, 6, 6, 6, 6, 6, 6, 7, 7, 7,
                                   7, 7, 7, 7, 7, 7, 7, 7, 7, 7, 7, 7, 7, 7, 7, 8, 8, 8, 8, 8, 8, 8,
                                   8, 8, 8, 8 };
    static uint32_t v[N][DIRECTION_BITS];
    double mean = 0;

    directions_find(v, N);
    for (int i = 0; i < N; i++)
        for (int j = 0; j < i; j++) {
            int t = directions_t(v[i], v[j], 8), big = directions_t(v[i], v[j], 14);
            EXPECT(is_net(v[i], v[j], 8, t), "dimensions %d and %d are no (%d,8)-net", i, j, t);
            EXPECT(t == 0 || !is_net(v[i], v[j], 8, t - 1), "%d and %d: t < %d", i, j, t);
            EXPECT(big <= degree[i] - 1 + degree[j] - 1, "%d and %d: t = %d", i, j, big);
            EXPECT(i % 2 == 0 || j != i - 1 || t <= 3, "decision %d, %d: t = %d", j, i, t);
            mean += 2.0 * t / (N * (N - 1));
        }
    EXPECT(directions_t(v[0], v[1], 16) == 0, "the first two");
    EXPECT(mean < 2.5, "t is %g in the mean", mean);
}

/* ---- what the user says ---- */

/* As many samples as there can be, planned or not, and the last of them. */
static void very_many(void)
{
    static const char *const more[] = { "uncorrelated:match=permuted", "halton:dimensions=32",
                                        "halton:randomize=rotation", "sobol:dimensions=32" };

    for (int k = 0; k < 4 || samplers[k - 4]; k++)
        for (int planned = 0; planned < 2; planned++) {
            uint32_t spp = planned ? UINT32_MAX : 0;
            Sampler s = pattern_of(k < 4 ? more[k] : samplers[k - 4]->info.name, &spp);
            for (uint32_t i = 0; i < 2000; i++) {
                Decision d = i % 70;
                V2 u;
                float x;
                sampler_pixel(&s, i, 3);
                sampler_start(&s, i % 3 ? UINT32_MAX - i : i * 2000003u);
                u = sample_2d(&s, d);
                x = sample_1d(&s, d);
                EXPECT(u.x >= 0 && u.x < 1 && u.y >= 0 && u.y < 1 && x >= 0 && x < 1,
                       "%s: %g, %g; %g", s.kind->info.name, (double)u.x, (double)u.y, (double)x);
            }
            sampler_clear(&s);
        }
}

/* Without randomizing all pixels are alike; with it none. */
static void fixed(void)
{
    for (int k = 0; samplers[k]; k++) {
        const char *name = samplers[k]->info.name;
        char text[60];
        if (!samplers[k]->info.options)
            continue;
        for (int k2 = 0; k2 < 2; k2++) {
            bool none = k2 == 1;
            uint32_t spp = 16;
            V2 a[16], b[16];
            Sampler s;
            snprintf(text, sizeof text, "%s%s", name, none ? ":randomize=none" : "");
            s = pattern_of(text, &spp);
            points(&s, 1, DECISION(DECIDE_LIGHT_POINT, 1), 0, 16, a);
            points(&s, 2, DECISION(DECIDE_LIGHT_POINT, 1), 0, 16, b);
            EXPECT((memcmp(a, b, sizeof a) == 0) == none, "%s: pixels", text);
            points(&s, 1, DECISION(DECIDE_LIGHT_POINT, 2), 0, 16, b);
            EXPECT(memcmp(a, b, sizeof a), "%s: decisions are alike", text);
            sampler_clear(&s);
        }
    }
}

/* Names of other programs. */
static void names(void)
{
    static const struct { const char *text, *name; unsigned warnings; uint32_t spp; } all[] = {
        { "\"halton\" \"integer pixelsamples\" 9 \"string randomization\" \"permutedigits\"",
          "halton", 0, 9 },
        { "\"independent\" \"integer pixelsamples\" 7 \"integer seed\" 3", "random", 0, 7 },
        { "\"02sequence\"", "zerotwo", 0, 64 },
        { "\"paddedsobol\" \"string randomization\" \"fastowen\"", "zerotwo", 0, 64 },
        { "\"sobol\" \"string randomization\" \"none\"", "sobol", 0, 64 },
        { "\"stratified\" \"integer xsamples\" 3 \"integer ysamples\" 5 \"bool jitter\" true",
          "stratified", 0, 15 },
        { "\"zsobol\" \"string randomization\" \"owen\"", "sobol", 1, 64 },
        { "\"pmj02bn\" \"integer pixelsamples\" 16", "zerotwo", 1, 16 },
        { "\"nothing\"", SAMPLER_DEFAULT, 1, 64 },
    };

    for (size_t k = 0; k < sizeof all / sizeof all[0]; k++) {
        ReadLimits limits = READ_LIMITS_DEFAULT;
        RenderRequest q = { .threads = 1, .max_pixels = limits.max_pixels };
        RenderSettings s;
        SceneFile f;
        char path[600], text[200];
        err_reset();
        snprintf(path, sizeof path, "%s/a.pbrt", test_folder());
        snprintf(text, sizeof text, "Sampler %s WorldBegin Shape \"sphere\"", all[k].text);
        REQUIRE(file_write(path, text, strlen(text)) && scenefile_read(&f, path, &limits), "scene");
        REQUIRE(settings_resolve(&s, &q, &f), "%s", text);
        EXPECT(!strcmp(s.sampler->info.name, all[k].name) && s.spp == all[k].spp,
               "%s: %s, %lu samples", all[k].text, s.sampler->info.name, (unsigned long)s.spp);
        EXPECT(warnings_count() == all[k].warnings, "%s: %u warnings", all[k].text,
               warnings_count());
        scenefile_clear(&f);
    }
}

/* ---- pictures ---- */

/* Every sampler makes the picture of independent samples, also with a count that suits few of
 * them: a lamp behind a lens out of focus, over a glossy floor. */
static void pictures(void)
{
    enum { SIDE = 32, SPP = 13 };
    Series truth, other;
    uint32_t matt;
    char method[100];
    Lab l;

    lab_init(&l);
    matt = lab_material(&l, "diffuse", "reflectance=0.6");
    lab_quad(&l, v3(-3, -3, 0), v3(6, 0, 0), v3(0, 6, 0),
             lab_material(&l, "phong", "reflectance=0.4,specular=0.4,exponent=20"));
    lab_sphere(&l, v3(-0.4f, 0, 0.5f), 0.5f, matt, false);
    lab_shine(&l, lab_quad(&l, v3(-1, -1, 2), v3(0, 2, 0), v3(2, 0, 0), matt), "L=4");
    lab_shine(&l, lab_sphere(&l, v3(0.8f, -0.5f, 0.4f), 0.2f, matt, false), "L=6");
    lab_camera(&l, v3(0, -4, 1.5f), v3(0, 0, 0.5f), 40, "lensradius=0.1,focaldistance=3");
    lab_build(&l);
    series_render(&l, &truth, "path:maxdepth=3@random", SIDE, 4 * SPP, 900);
    for (int k = 1; samplers[k]; k++) {
        snprintf(method, sizeof method, "path:maxdepth=3@%s", samplers[k]->info.name);
        series_render(&l, &other, method, SIDE, SPP, 901 + (uint64_t)k);
        series_expect_same(&other, &truth, 0.025, method);
        series_clear(&other);
    }
    series_clear(&truth);
    lab_clear(&l);
}

/* ---- their picture ---- */

/* A circle for each point, where it should be, lines of the grid, and a title that is no markup. */
static void picture(void)
{
    static const float xy[] = { 0.25f, 0.75f, 0, 0, 0.5f, 0.125f };
    static const PlotPoints sets[] = { { "a < b & c", xy, 3, 2, 4 }, { "one", xy, 1, 1, 1 } };
    char path[300], *text;
    int circles = 0, lines = 0;
    FileBytes f;

    snprintf(path, sizeof path, "%s/p.svg", test_folder());
    REQUIRE(plot_write_points(path, sets, 2, 1), "not written");
    REQUIRE(file_read(path, 1 << 20, &f), "not read");
    text = f.bytes;                             /* a byte 0 stands behind the last */
    for (const char *at = text; (at = strstr(at, "<circle")); at++)
        circles++;
    for (const char *at = text; (at = strstr(at, "<line")); at++)
        lines++;
    EXPECT(circles == 4 && lines == 3 + 5 + 2 + 2, "%d circles, %d lines", circles, lines);
    EXPECT(strstr(text, "a &lt; b &amp; c") != NULL, "the title is markup");
    EXPECT(strstr(text, "cx=\"80.00\" cy=\"80.00\"") != NULL, "the first point is elsewhere");
    file_clear(&f);
}

const TestCase test_patterns[] = {
    { "strata", strata, false }, { "rotated", rotated, false },
    { "blocks_unknown", blocks_unknown, false },
    { "permutations", permutations, false }, { "permutations_even", permutations_even, false },
    { "uncorrelated", uncorrelated, false }, { "distances", distances, false },
    { "tiles", tiles, false }, { "halton_boxes", halton_boxes, false }, { "nets", nets, false },
    { "directions", directions, false }, { "very_many", very_many, false },
    { "fixed", fixed, false }, { "names", names, false },
    { "pictures", pictures, false }, { "picture", picture, false }, { NULL, NULL, false }
};
