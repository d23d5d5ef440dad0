/* test_pointtree.c -- trees of points against a search through all of them: the same answers to the
 * last tie, whatever the points. */
#include "base/random.h"
#include "geometry/pointtree.h"
#include "test/test.h"

#include "base/mem.h"

#include <string.h>

typedef struct { float p[3]; uint32_t own, more; } Record;

/* ---- points ---- */

typedef enum { CUBE, PLANE, LATTICE, ONE_PLACE, LINE, FAR_APART, CLOUDS } Kind;
static const char *const kinds[] = { "cube", "plane", "lattice", "one place", "line", "far apart",
                                     "clouds" };

static V3 some_point(Kind k, Rng *r)
{
    float x = rng_unit(r), y = rng_unit(r), z = rng_unit(r);

    switch (k) {
    case CUBE:      return v3(x, y, z);
    case PLANE:     return v3(x, y, 0.5f);
    case LATTICE:   return v3((float)(int)(4 * x), (float)(int)(4 * y), (float)(int)(4 * z));
    case ONE_PLACE: return v3(1, 2, 3);
    case LINE:      return v3(x, x, -x);
    case FAR_APART: return v3(3e38f * (x - 0.5f), 1e-30f * y, z < 0.5f ? -3e38f : 3e38f);
    case CLOUDS:    return v3(x * x * x * x, (float)(int)(3 * y), z * z);
    }
    return v_all(0);
}

static Record *some_points(Kind k, uint32_t n, uint64_t seed)
{
    Record *p = MEM_ARRAY(Record, n);
    Rng r = rng_seed(seed);

    REQUIRE(p, "memory");
    for (uint32_t i = 0; i < n; i++) {
        V3 at = some_point(k, &r);
        p[i] = (Record){ { at.x, at.y, at.z }, i, ~i };
    }
    return p;
}

/* ---- the plain way ---- */

static float distance2(const Record *r, V3 from)
{
    float x = r->p[0] - from.x, y = r->p[1] - from.y, z = r->p[2] - from.z;
    return (x * x + y * y) + z * z;
}

static bool nearer(Near a, Near b) { return a.d2 < b.d2 || (a.d2 == b.d2 && a.i < b.i); }

/* Into place among n that are in order already, of which k are kept. */
static uint32_t keep(Near *best, uint32_t n, uint32_t k, Near x)
{
    uint32_t i = n < k ? n : k;

    if (n == k && (!k || !nearer(x, best[k - 1])))
        return n;
    if (n == k)
        i--;
    for (; i > 0 && nearer(x, best[i - 1]); i--)
        best[i] = best[i - 1];
    best[i] = x;
    return n < k ? n + 1 : n;
}

static uint32_t plain_nearest(const Record *p, uint32_t n, V3 from, float r2, uint32_t k,
                              Near *best)
{
    uint32_t found = 0;

    for (uint32_t i = 0; i < n; i++)
        if (distance2(&p[i], from) <= r2)
            found = keep(best, found, k, (Near){ distance2(&p[i], from), i });
    return found;
}

/* ---- comparing ---- */

enum { MOST = 40 };

static void compare_nearest(const PointTree *t, const Record *p, V3 from, float r2, uint32_t k,
                            const char *what)
{
    Near best[MOST], found[MOST], sorted[MOST];
    uint32_t n = plain_nearest(p, t->n, from, r2, k, best), in_order = 0;
    uint32_t m = pointtree_nearest(t, from, r2, k, found);

    REQUIRE(n == m, "%s: %u of %u nearest of %u, not %u", what, m, k, t->n, n);
    for (uint32_t i = 0; i < m; i++)
        in_order = keep(sorted, in_order, m, found[i]);
    for (uint32_t i = 0; i < m; i++)
        EXPECT(sorted[i].i == best[i].i && sorted[i].d2 == best[i].d2,
               "%s: number %u is point %u, not %u", what, i, sorted[i].i, best[i].i);
    if (m == k && k)
        EXPECT(found[0].i == best[k - 1].i, "%s: the first is not the farthest", what);
}

typedef struct { uint32_t n, left; uint64_t sum; } Count;

static float count_one(void *ctx, uint32_t i, float d2, float r2)
{
    Count *c = ctx;
    c->n++;
    c->sum += (uint64_t)i * i + 1;
    EXPECT(d2 <= r2, "a point too far");
    return --c->left ? r2 : -1.0f;
}

static void compare_within(const PointTree *t, const Record *p, V3 from, float r2, const char *what)
{
    Count c = { 0, UINT32_MAX, 0 }, one = { 0, 1, 0 }, plain = { 0, 0, 0 };

    for (uint32_t i = 0; i < t->n; i++)
        if (distance2(&p[i], from) <= r2) {
            plain.n++;
            plain.sum += (uint64_t)i * i + 1;
        }
    pointtree_within(t, from, r2, count_one, &c);
    EXPECT(c.n == plain.n && c.sum == plain.sum, "%s: %u within, not %u", what, c.n, plain.n);
    pointtree_within(t, from, r2, count_one, &one);
    EXPECT(one.n == (plain.n > 0), "%s: goes on after enough", what);
}

static void ask(const PointTree *t, const Record *p, Kind k, uint64_t seed)
{
    static const float radii[] = { INFINITY, 0.01f, 1.0f, 0.0f };
    static const uint32_t counts[] = { 1, 7, MOST, 0 };
    Rng r = rng_seed(seed);

    for (int i = 0; i < 24; i++) {
        V3 from = i % 3 ? some_point(k, &r) : v3(3 * rng_unit(&r), rng_unit(&r), rng_unit(&r));
        if (i % 5 == 4 && t->n)
            from = pointtree_at(t, rng_below(&r, t->n));
        for (int j = 0; j < 4; j++) {
            compare_nearest(t, p, from, radii[j], counts[i % 4], kinds[k]);
            compare_within(t, p, from, radii[j], kinds[k]);
        }
    }
}

static void against_all(void)
{
    static const uint32_t sizes[] = { 0, 1, 2, 8, 9, 31, 100, 1000, 4097 };

    for (int k = 0; k <= CLOUDS; k++)
        for (size_t s = 0; s < sizeof sizes / sizeof *sizes; s++) {
            Record *p = some_points((Kind)k, sizes[s], (uint64_t)k + 10);
            uint64_t sum = 0, moved = 0;
            PointTree t;
            REQUIRE(pointtree_init(&t, p, sizes[s], sizeof *p), "memory");
            pointtree_build(&t);
            for (uint32_t i = 0; i < sizes[s]; i++) {
                sum += mix64(i + 1);
                moved += mix64(p[i].own + 1);
                EXPECT(p[i].own == ~p[i].more, "a record is torn");
            }
            EXPECT(sum == moved, "records are lost");
            EXPECT(pointtree_bytes(&t) <= 16 + (size_t)sizes[s] * 5 / 4, "%u points: %u bytes",
                   sizes[s], (unsigned)pointtree_bytes(&t));
            ask(&t, p, (Kind)k, s);
            pointtree_clear(&t);
            mem_free(p);
        }
}

/* By units, in another order: the same bytes. */
static void units(void)
{
    enum { N = 5000 };
    Record *a = some_points(CLOUDS, N, 3), *b = some_points(CLOUDS, N, 3);
    PointTree whole, parts;

    REQUIRE(pointtree_init(&whole, a, N, sizeof *a) && pointtree_init(&parts, b, N, sizeof *b),
            "memory");
    pointtree_build(&whole);
    pointtree_start(&parts);
    for (uint32_t i = pointtree_units(&parts); i-- > 0;)
        pointtree_finish(&parts, i);
    EXPECT(!memcmp(a, b, N * sizeof *a), "another order of points");
    EXPECT(!memcmp(whole.plane + 1, parts.plane + 1, ((1u << whole.levels) - 1) * sizeof(float)) &&
           !memcmp(whole.axis, parts.axis, 1u << whole.levels), "other planes");
    pointtree_clear(&whole);
    pointtree_clear(&parts);
    mem_free(a);
    mem_free(b);
}

const TestCase test_pointtree[] = {
    { "against_all", against_all, false },
    { "units", units, false },
    { NULL, NULL, false }
};
