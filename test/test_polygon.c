/* test_polygon.c -- polygons cut into triangles: exact cover of simple ones, an end for all. */
#include "test/mesh_help.h"

#include "base/random.h"
#include "geometry/polygon.h"

#include <stdlib.h>
#include <string.h>

enum { MOST = 400 };

typedef struct { unsigned n; V3 p[MOST]; } Shape;

/* Feeds the corners in order; ids are positions in the array. */
static bool feed(Polygon *g, const V3 *p, size_t n)
{
    for (size_t i = 0; i < n; i++)
        if (!polygon_corner(g, (uint32_t)i, p[i]))
            return false;
    return polygon_end(g, (Place){ "polygon", 1, 1 });
}

typedef struct { double x, y, z; } D3;

/* Twice the vector area of abc. */
static D3 area2(V3 a, V3 b, V3 c)
{
    double ux = (double)b.x - a.x, uy = (double)b.y - a.y, uz = (double)b.z - a.z;
    double wx = (double)c.x - a.x, wy = (double)c.y - a.y, wz = (double)c.z - a.z;
    return (D3){ uy * wz - uz * wy, uz * wx - ux * wz, ux * wy - uy * wx };
}

static double along(D3 v, int axis) { return axis == 0 ? v.x : axis == 1 ? v.y : v.z; }

/* Cuts p and checks the cover: n - 2 triangles, none turned over as seen along the largest axis of
 * the polygon's vector area (strict: none without area), so that their areas sum to the
 * polygon's: the sum with signs is an identity, so overlap would need a negative one. */
static void check_cover(const char *name, const V3 *p, unsigned n, bool strict)
{
    Mesh m = { 0 };
    Skipped skipped = { 0 };
    Polygon g;
    D3 whole = { 0, 0, 0 };
    double sum = 0.0, size;
    unsigned seen[MOST] = { 0 }, wrong = 0;
    int axis;

    for (unsigned i = 1; i + 1 < n; i++) {
        D3 t = area2(p[0], p[i], p[i + 1]);
        whole = (D3){ whole.x + t.x, whole.y + t.y, whole.z + t.z };
    }
    axis = fabs(whole.x) >= fabs(whole.y) && fabs(whole.x) >= fabs(whole.z) ? 0
           : fabs(whole.y) >= fabs(whole.z)                                 ? 1
                                                                            : 2;
    size = along(whole, axis);
    polygon_init(&g, &m, &skipped, name, 1000);
    REQUIRE(feed(&g, p, n), "%s: refused", name);
    EXPECT(m.ntris == n - 2, "%s: %lu triangles of %u corners", name, (unsigned long)m.ntris, n);
    for (uint32_t i = 0; i < m.ntris; i++) {
        const uint32_t *v = m.tri[i].v;
        double a;
        REQUIRE(v[0] < n && v[1] < n && v[2] < n, "%s: corner out of range", name);
        a = along(area2(p[v[0]], p[v[1]], p[v[2]]), axis) / size;
        wrong += strict ? !(a > 0.0) : a < 0.0;
        sum += fabs(a);
        for (int k = 0; k < 3; k++)
            seen[v[k]]++;
    }
    for (unsigned i = 0; i < n; i++)
        EXPECT(seen[i], "%s: corner %u of %u in no triangle", name, i, n);
    EXPECT(!wrong, "%s: %u of %u triangles turned over or empty", name, wrong, n - 2);
    /* n terms, each of a few roundings of 2^-53 of what may be n times the polygon's area */
    EXPECT(fabs(sum - 1.0) < 1e-15 * n * n + 1e-14, "%s: area off by %g", name, sum - 1.0);
    EXPECT(!skipped.n[SKIPPED_CARE], "%s: cut without care", name);
    polygon_clear(&g);
    mesh_clear(&m);
}

/* ---- shapes in the plane z = 0, counter-clockwise ---- */

static void push(Shape *s, double x, double y)
{
    s->p[s->n++] = v3((float)x, (float)y, 0.0f);
}

/* A corner in each sector about the origin: simple, with deep notches. */
static void star(Shape *s, Rng *rng, unsigned n)
{
    s->n = 0;
    for (unsigned k = 0; k < n; k++) {
        float x, y, r = 0.05f + rng_unit(rng);
        m_sincos_turn((float)k / (float)n + rng_unit(rng) * 0.9f / (float)n, &y, &x);
        push(s, (double)(r * x), (double)(r * y));
    }
}

/* A lower chain from x = 0 to 1 and an upper one back, both jagged, n >= 4. */
static void jagged(Shape *s, Rng *rng, unsigned n)
{
    unsigned low = 2 + rng_below(rng, n - 3), up = n - low;

    s->n = 0;
    for (unsigned k = 0; k < low; k++)
        push(s, k == 0 ? 0.0 : k == low - 1 ? 1.0 : (k + 0.8 * (double)rng_unit(rng)) / low,
             0.49 * (double)rng_unit(rng));
    for (unsigned k = up; k-- > 0;)
        push(s, k == 0 ? 0.0 : k == up - 1 ? 1.0 : (k + 0.8 * (double)rng_unit(rng)) / up,
             0.5 + 0.5 * (double)rng_unit(rng));
}

/* A band wound about the origin, 0.5 wide where the turns lie 1 apart. */
static void spiral(Shape *s, unsigned n)
{
    unsigned half = n / 2;
    s->n = 0;
    for (unsigned k = 0; k < 2 * half; k++) {
        double turn = 1.0 + (k < half ? k : 2 * half - 1 - k) / 16.0;
        double r = k < half ? turn : turn - 0.5;
        float x, y;
        m_sincos_turn((float)(turn - floor(turn)), &y, &x);
        push(s, r * (double)x, r * (double)y);
    }
}

/* Columns of unit width and random heights from `low`, with a corner at every integer point of the
 * rim: most corners lie in the middle of a straight side. */
static void histogram(Shape *s, Rng *rng, unsigned columns, unsigned low)
{
    int at = 0;
    s->n = 0;
    for (unsigned k = 0; k < columns; k++)
        push(s, k, 0);
    for (unsigned k = columns; k-- > 0;) {
        int h = k ? (int)(low + rng_below(rng, 6)) : 5;
        while (at != h) {
            push(s, k + 1, at);
            at += at < h ? 1 : -1;
        }
        push(s, k + 1, h);
    }
    while (at > 0)
        push(s, 0, at--);
}

/* ---- placing in space ---- */

static void turn_about(Shape *s, Rng *rng)
{
    V3 n = v_unit(v3(rng_unit(rng) - 0.5f, rng_unit(rng) - 0.5f, rng_unit(rng) - 0.5f));
    Frame f = frame_about(n);
    float scale = m_exp(10.0f * rng_unit(rng) - 5.0f);
    V3 far = v3(rng_unit(rng), rng_unit(rng), rng_unit(rng));

    for (unsigned i = 0; i < s->n; i++)
        s->p[i] = v_scale(v_add(frame_out(&f, s->p[i]), far), scale);
}

/* One of the 48 ways to lay the axes on the axes: exact. */
static void lay(Shape *s, unsigned way)
{
    for (unsigned i = 0; i < s->n; i++) {
        V3 p = s->p[i];
        float c[3] = { p.x, p.y, p.z }, q[3];
        for (unsigned k = 0; k < 3; k++)
            q[k] = c[(k * (way & 1 ? 2 : 1) + way / 2) % 3] * (way >> (3 + k) & 1 ? -1.0f : 1.0f);
        s->p[i] = v3(q[0], q[1], q[2]);
    }
}

static void roll(Shape *s, unsigned by)         /* starts at another corner */
{
    V3 p[MOST];
    for (unsigned i = 0; i < s->n; i++)
        p[i] = s->p[(i + by) % s->n];
    memcpy(s->p, p, s->n * sizeof *p);
}

/* ---- cases ---- */

static void random_simple(void)
{
    Rng rng = rng_seed(1);
    Shape s;

    for (unsigned k = 0; k < 3000; k++) {
        unsigned n = 5 + rng_below(&rng, k % 10 ? 30 : MOST - 5);
        star(&s, &rng, n);
        lay(&s, k);
        check_cover("star", s.p, s.n, true);
        jagged(&s, &rng, n);
        roll(&s, rng_below(&rng, n));
        turn_about(&s, &rng);
        check_cover("jagged", s.p, s.n, true);
    }
    for (unsigned n = 8; n <= 160; n += 4) {
        spiral(&s, n);
        roll(&s, rng_below(&rng, n));
        turn_about(&s, &rng);
        check_cover("spiral", s.p, s.n, true);
    }
}

/* Corners on straight sides must not cost triangles without area: dropped, those would open
 * cracks to the neighbours. */
static void straight_sides(void)
{
    Rng rng = rng_seed(2);
    Shape s;

    for (unsigned k = 0; k < 3000; k++) {
        histogram(&s, &rng, 1 + rng_below(&rng, 30), 1);
        roll(&s, rng_below(&rng, s.n));
        lay(&s, k);
        check_cover("histogram", s.p, s.n, true);
    }
}

/* Where columns have no height, the rim runs to and fro on one line: islands on a thread. */
static void touching_sides(void)
{
    Rng rng = rng_seed(7);
    Shape s;

    for (unsigned k = 0; k < 3000; k++) {
        histogram(&s, &rng, 1 + rng_below(&rng, 30), 0);
        roll(&s, rng_below(&rng, s.n));
        lay(&s, k);
        check_cover("islands", s.p, s.n, false);
    }
}

static void quads(void)
{
    static const V2 arrow[4] = { { 0, 0 }, { 4, -1 }, { 1, 0 }, { 4, 1 } };
    Shape s;

    for (unsigned way = 0; way < 48; way++)
        for (unsigned by = 0; by < 4; by++) {
            s.n = 0;
            for (int k = 0; k < 4; k++)
                push(&s, (double)arrow[k].x, (double)arrow[k].y);
            roll(&s, by);
            lay(&s, way);
            check_cover("arrow", s.p, s.n, true);
        }
}

/* A plate with square holes in a row, each joined to the lower side by a slit, so that four corners
 * a hole stand in one place with another; others lie in the middle of straight sides. */
static void holes(Shape *s, unsigned n)
{
    s->n = 0;
    push(s, 0, 0);
    for (unsigned k = 0; k < n; k++) {
        double x = 3.0 * k + 1.0;
        push(s, x, 0);
        push(s, x, 1);
        push(s, x, 2);
        push(s, x + 0.5, 2);
        push(s, x + 1.0, 2);
        push(s, x + 1.0, 1);
        push(s, x, 1);
        push(s, x, 0);
    }
    push(s, 3.0 * n, 0);
    for (unsigned k = 3 * n; k; k--)
        push(s, k, 3);
    push(s, 0, 3);
}

static void slits(void)
{
    Rng rng = rng_seed(6);
    Shape s;

    for (unsigned k = 0; k < 1000; k++) {
        holes(&s, 1 + k % 20);
        roll(&s, rng_below(&rng, s.n));
        lay(&s, k);
        check_cover("holes", s.p, s.n, true);
    }
}

static void convex_is_fan(void)
{
    for (unsigned n = 3; n < 60; n++) {
        Mesh m = { 0 };
        Skipped skipped = { 0 };
        Polygon g;
        polygon_init(&g, &m, &skipped, "convex", 0);
        for (unsigned k = 0; k < n; k++) {
            float x, y;
            m_sincos_turn((float)k / (float)n, &y, &x);
            REQUIRE(polygon_corner(&g, k, v3(x, y, 0.0f)), "refused");
        }
        REQUIRE(polygon_end(&g, (Place){ 0 }), "refused");
        for (uint32_t k = 0; k < m.ntris; k++)
            EXPECT(m.tri[k].v[0] == 0 && m.tri[k].v[1] == k + 1 && m.tri[k].v[2] == k + 2,
                   "triangle %lu of %u corners", (unsigned long)k, n);
        EXPECT(m.ntris == n - 2, "%lu triangles of %u corners", (unsigned long)m.ntris, n);
        polygon_clear(&g);
        mesh_clear(&m);
    }
}

/* What no cut covers: on a line, in a point, crossing itself, going round many times. */
static V3 hopeless(Rng *rng, unsigned kind, unsigned i)
{
    float x = rng_unit(rng), y = rng_unit(rng);
    switch (kind) {
    case 0: return v3(1.0f, 2.0f, 3.0f);
    case 1: return v3(x, 2.0f * x, -x);
    case 2: return v3(x, y, rng_unit(rng));
    case 3: return v3((float)(i & 1), (float)(i >> 1 & 1), 0.0f);
    case 4: return v3((float)(i % 3), (float)(i % 5), (float)(i % 7));
    case 5: return v3(x * 3e38f, -y * 3e38f, x * 3e38f);
    case 6: return v3(x * 1e-44f, y * 1e-44f, 0.0f);
    default: return v3((float)(i % 2), (float)(i / 2), 0.0f);
    }
}

static void hopeless_shapes(void)
{
    Rng rng = rng_seed(3);

    for (unsigned k = 0; k < 4000; k++) {
        unsigned n = rng_below(&rng, k % 50 ? 40 : 1000);
        Mesh m = { 0 };
        Skipped skipped = { 0 };
        Polygon g;
        polygon_init(&g, &m, &skipped, "hopeless", 0);
        for (unsigned i = 0; i < n; i++) {
            V3 corner = hopeless(&rng, k & 7, i);
            REQUIRE(polygon_corner(&g, i, corner), "refused");
        }
        REQUIRE(polygon_end(&g, (Place){ "hopeless", 1, 1 }), "refused");
        EXPECT(m.ntris == (n > 2 ? n - 2 : 0), "%lu triangles of %u corners",
               (unsigned long)m.ntris, n);
        for (uint32_t i = 0; i < m.ntris; i++)
            for (int c = 0; c < 3; c++)
                EXPECT(m.tri[i].v[c] < n, "corner out of range");
        EXPECT(skipped.n[SKIPPED_FACE] == (n < 3), "short faces");
        polygon_clear(&g);
        mesh_clear(&m);
    }
    EXPECT(mem_blocks() == 0, "%ld blocks left", mem_blocks());
}

/* A polygon of n random corners; returns the tests it took. */
static uint64_t random_polygon(Polygon *g, Rng *rng, uint32_t n)
{
    uint64_t before = g->tests;
    uint32_t had = g->mesh->ntris;

    for (uint32_t i = 0; i < n; i++)
        REQUIRE(polygon_corner(g, i, v3(rng_unit(rng), rng_unit(rng), 0.0f)), "refused");
    REQUIRE(polygon_end(g, (Place){ "large", 1, 1 }), "refused");
    EXPECT(g->mesh->ntris - had == n - 2, "%lu triangles of %lu corners",
           (unsigned long)(g->mesh->ntris - had), (unsigned long)n);
    return before - g->tests;
}

/* Work is bounded: by 7 n^2 tests for one polygon (each corner once and two more for each cut, each
 * with a second chance, against n corners; and n / 2 on average to find the least harm), by the
 * allowance for all of a file; beyond both there are fans. */
static void bounded_work(void)
{
    const uint64_t n = POLYGON_CARE;
    Mesh m = { 0 };
    Skipped skipped = { 0 };
    Polygon g;
    Rng rng = rng_seed(4);

    polygon_init(&g, &m, &skipped, "large", (size_t)1 << 24);
    EXPECT(random_polygon(&g, &rng, POLYGON_CARE) <= 7 * n * n, "too many tests");
    EXPECT(!skipped.n[SKIPPED_CARE], "cut without care");
    EXPECT(random_polygon(&g, &rng, POLYGON_CARE + 1) == 0, "a fan needs no tests");
    EXPECT(random_polygon(&g, &rng, 1000000) == 0, "a fan needs no tests");
    EXPECT(skipped.n[SKIPPED_CARE] == 2, "%lu fans", (unsigned long)skipped.n[SKIPPED_CARE]);
    g.tests = 1000;
    EXPECT(random_polygon(&g, &rng, 200) == 1000, "the allowance");
    EXPECT(random_polygon(&g, &rng, 200) == 0, "the allowance");
    EXPECT(skipped.n[SKIPPED_CARE] == 4, "%lu fans", (unsigned long)skipped.n[SKIPPED_CARE]);
    polygon_clear(&g);
    mesh_clear(&m);
}

/* Corners that come when the care is over join the fan of those before. */
static void large_fans(void)
{
    for (uint32_t n = POLYGON_CARE - 1; n < POLYGON_CARE + 5; n++) {
        Mesh m = { 0 };
        Skipped skipped = { 0 };
        Polygon g;
        polygon_init(&g, &m, &skipped, "fan", 0);
        for (uint32_t i = 0; i < n; i++) {              /* on a parabola, so all convex */
            float x = (float)i / 8192.0f;
            REQUIRE(polygon_corner(&g, 7 + 2 * i, v3(x, x * x, 0.0f)), "refused");
        }
        REQUIRE(polygon_end(&g, (Place){ "fan", 1, 1 }), "refused");
        EXPECT(m.ntris == n - 2, "%lu triangles", (unsigned long)m.ntris);
        for (uint32_t i = 0; i < m.ntris; i++)
            EXPECT(m.tri[i].v[0] == 7 && m.tri[i].v[1] == 9 + 2 * i && m.tri[i].v[2] == 11 + 2 * i,
                   "triangle %lu of %lu", (unsigned long)i, (unsigned long)n);
        EXPECT(skipped.n[SKIPPED_CARE] == (n > POLYGON_CARE), "%lu corners with care",
               (unsigned long)n);
        polygon_clear(&g);
        mesh_clear(&m);
    }
}

static void out_of_memory(void)
{
    Rng rng = rng_seed(5);
    V3 *p = malloc(5000 * sizeof *p);
    bool ok = false;

    REQUIRE(p, "memory");
    messages_nowhere();
    for (int i = 0; i < 5000; i++)
        p[i] = v3(rng_unit(&rng), rng_unit(&rng), 0.0f);
    for (unsigned long k = 1; !ok && k < 1000; k++) {
        Mesh m = { 0 };
        Skipped skipped = { 0 };
        Polygon g;
        polygon_init(&g, &m, &skipped, "memory", 0);
        mem_fail_at(k, true);
        ok = feed(&g, p, 7) && feed(&g, p, 5000);
        mem_fail_at(0, false);
        polygon_clear(&g);
        mesh_clear(&m);
    }
    EXPECT(ok, "never enough memory");
    EXPECT(mem_blocks() == 0, "%ld blocks left", mem_blocks());
    free(p);
}

const TestCase test_polygon[] = {
    { "random-simple", random_simple, false },
    { "straight-sides", straight_sides, false },
    { "touching-sides", touching_sides, false },
    { "quads", quads, false },
    { "slits", slits, false },
    { "convex-is-fan", convex_is_fan, false },
    { "hopeless-shapes", hopeless_shapes, false },
    { "bounded-work", bounded_work, false },
    { "large-fans", large_fans, false },
    { "out-of-memory", out_of_memory, false },
    { NULL, NULL, false }
};
