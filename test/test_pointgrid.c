/* test_pointgrid.c -- grids of points against looking at every point, and however they are built.
 *
 * Near        Points in a ball, on a plane, in clusters, on the borders of cells, far from the
 *             origin and all in one place; radii of a part of a cell up to many; what is found is
 *             what brute force finds, each once, with the same distance.
 * Cells       A ball no wider than a cell touches two of them along each axis [errata 9].
 * Built       by any chunks: the same bytes.
 * Nearest     The k-th nearest against sorting. */
#include "geometry/pointgrid.h"

#include "base/mem.h"
#include "base/random.h"
#include "integrators/photonpass.h"
#include "test/test.h"

#include <stdlib.h>
#include <string.h>

enum { POINTS = 3000, CLOUDS = 7 };

static float spread(Rng *r, float by) { return (rng_unit(r) - 0.5f) * by; }

static V3 point_of(int cloud, Rng *r)
{
    V3 p = { spread(r, 2), spread(r, 2), spread(r, 2) };

    switch (cloud) {
    case 1: return v3(p.x, 0.25f, p.z);
    case 2: return v3(p.x, p.y, -1e-30f);
    case 3: return v_add(v_scale(p, 0.01f), v3((float)rng_below(r, 3), (float)rng_below(r, 3), 0));
    case 4: return v3(0.125f * (float)rng_below(r, 9), 0.125f * (float)rng_below(r, 9) - 0.5f,
                      0.125f * (float)rng_below(r, 9));
    case 5: return v_add(p, v3(3e5f, -2e4f, 7e6f));
    case 6: return rng_below(r, 20) ? v3(1, 2, 3) : v_scale(p, 1e30f);
    default: return p;
    }
}

static void fill(V3 *at, size_t n, int cloud, Rng *r)
{
    for (size_t i = 0; i < n; i++)
        at[i] = point_of(cloud, r);
}

/* By brute force, in the same arithmetic. */
static bool is_near(V3 a, V3 p, float r, float *d2)
{
    float x = a.x - p.x, y = a.y - p.y, z = a.z - p.z;

    *d2 = x * x + y * y + z * z;
    return *d2 < r * r;
}

static void expect_near(const PointGrid *g, const V3 *at, size_t n, V3 p, float r, int cloud)
{
    static unsigned char times[POINTS];
    PointWalk w = pointgrid_walk(g, p, r);
    const PlacedPoint *q;
    float d2, truth;

    memset(times, 0, sizeof times);
    if (!w.all && r * g->scale <= 0.4999f && v_max3(v_abs(p)) < 100)
        EXPECT(w.x1 - w.x0 <= 1 && w.y1 - w.y0 <= 1 && w.z1 - w.z <= 1, "more than 8 cells");
    while ((q = pointgrid_next(&w, &d2))) {
        EXPECT(is_near(at[q->id], p, r, &truth) && d2 == truth, "cloud %d: point %u", cloud, q->id);
        times[q->id]++;
    }
    for (size_t i = 0; i < n; i++)
        EXPECT(times[i] == is_near(at[i], p, r, &truth),
               "cloud %d, radius %g, edge %g: point %zu is found %d times", cloud, (double)r,
               1 / (double)g->scale, i, times[i]);
}

static void near_points(void)
{
    static const float edges[] = { 0.02f, 0.25f, 1, 50 }, radii[] = { 0.01f, 0.125f, 0.3f, 5 };
    static V3 at[POINTS];
    PointGrid g = { 0 };
    Rng r = rng_seed(3);

    for (int cloud = 0; cloud < CLOUDS; cloud++) {
        fill(at, POINTS, cloud, &r);
        for (int e = 0; e < 4; e++) {
            REQUIRE(pointgrid_build(&g, at, POINTS, edges[e]), "memory");
            for (int k = 0; k < 80; k++) {
                V3 p = k % 2 ? at[rng_below(&r, POINTS)] : point_of(cloud, &r);
                expect_near(&g, at, POINTS, p, radii[k / 2 % 4], cloud);
            }
        }
    }
    REQUIRE(pointgrid_build(&g, at, 0, 1), "memory");
    expect_near(&g, at, 0, v3(0, 0, 0), 100, 0);
    pointgrid_clear(&g);
}

/* A query where points are millions of cells away must not walk through these. */
static void far_apart(void)
{
    static V3 at[POINTS];
    PointGrid g = { 0 };
    Rng r = rng_seed(4);

    fill(at, POINTS, 0, &r);
    REQUIRE(pointgrid_build(&g, at, POINTS, 1e-9f), "memory");
    for (int k = 0; k < 20; k++)
        expect_near(&g, at, POINTS, at[k], 0.5f * (float)k, 0);
    expect_near(&g, at, POINTS, v_all(NAN), 1, 0);
    expect_near(&g, at, POINTS, v_all(0), INFINITY, 0);
    pointgrid_clear(&g);
}

static void chunks(void)
{
    static const size_t sizes[] = { 1, 7, 1000, 2999 };
    static V3 at[POINTS];
    PointGrid whole = { 0 }, parts = { 0 };
    Rng r = rng_seed(5);

    fill(at, POINTS, 3, &r);
    REQUIRE(pointgrid_build(&whole, at, POINTS, 0.004f), "memory");
    for (int s = 0; s < 4; s++) {
        size_t n = sizes[s], count = (POINTS + n - 1) / n;
        REQUIRE(pointgrid_begin(&parts, POINTS, count, 0.004f), "memory");
        for (size_t c = count; c-- > 0;)
            pointgrid_count(&parts, c, &at[c * n].x, sizeof *at,
                            c + 1 < count ? n : POINTS - c * n);
        pointgrid_arrange(&parts);
        for (size_t c = count; c-- > 0;)
            pointgrid_place(&parts, c, &at[c * n].x, sizeof *at, c + 1 < count ? n : POINTS - c * n,
                            (uint32_t)(c * n));
        for (uint32_t k = POINTGRID_PARTS; k-- > 0;)
            pointgrid_sort(&parts, k);
        EXPECT(!memcmp(whole.points, parts.points, POINTS * sizeof *whole.points) &&
               !memcmp(whole.start, parts.start, ((size_t)whole.mask + 2) * sizeof *whole.start),
               "chunks of %zu give another grid", n);
    }
    for (uint32_t k = 0; k < POINTGRID_PARTS; k++)
        EXPECT(pointgrid_part(&whole, k) <= pointgrid_part(&whole, k + 1), "parts out of order");
    EXPECT(pointgrid_part(&whole, POINTGRID_PARTS) == POINTS, "points are missing");
    pointgrid_clear(&whole);
    pointgrid_clear(&parts);
}

static int by_size(const void *a, const void *b)
{
    float x = *(const float *)a, y = *(const float *)b;
    return (x > y) - (x < y);
}

static void nearest(void)
{
    static V3 at[POINTS];
    static float d2[POINTS];
    PhotonPass pp = { 0 };
    Rng r = rng_seed(6);

    for (int cloud = 0; cloud < 5; cloud++) {
        fill(at, POINTS, cloud, &r);
        REQUIRE(pointgrid_build(&pp.arrivals.grid, at, POINTS, 0.1f), "memory");
        for (int k = 1; k < 200; k += 11) {
            V3 p = point_of(cloud, &r);
            float most = k % 2 ? 0.3f : 10, reach = photonpass_reach(&pp, p, k, most);
            for (size_t i = 0; i < POINTS; i++)
                is_near(at[i], p, 1, &d2[i]);
            qsort(d2, POINTS, sizeof *d2, by_size);
            EXPECT(fabsf(reach - f_min(sqrtf(d2[k - 1]), most)) <= 2e-7f * reach &&
                   reach * reach <= d2[k - 1], "cloud %d: number %d is at %g, not %g", cloud, k,
                   (double)reach, sqrt((double)d2[k - 1]));
        }
    }
    EXPECT(photonpass_reach(&pp, v3(0, 0, 0), NEAREST_MOST, 0.01f) == 0.01f, "few are near");
    pointgrid_clear(&pp.arrivals.grid);
}

static void no_memory(void)
{
    V3 at[3] = { { 0, 0, 0 } };
    PointGrid g = { 0 };

    messages_quiet(true);
    for (unsigned long k = 1; k <= 4; k++) {
        mem_fail_at(k, false);
        EXPECT(!pointgrid_build(&g, at, 3, 1), "allocation %lu", k);
        EXPECT(!g.n && !g.points, "something is left");
    }
    mem_fail_at(0, false);
    EXPECT(!pointgrid_begin(&g, UINT32_MAX, 1, 1), "too many points");
    EXPECT(mem_blocks() == 0, "blocks are left");
}

const TestCase test_pointgrid[] = {
    { "near_points", near_points, false },
    { "far_apart", far_apart, false },
    { "chunks", chunks, false },
    { "nearest", nearest, false },
    { "no_memory", no_memory, false },
    { NULL, NULL, false }
};
