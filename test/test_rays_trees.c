/* test_rays_trees.c -- the structures themselves: their checks pass on every mesh and notice every
 * change made behind their back; building ends, in bounded depth and time, whatever the input; rays
 * that are no rays do no harm; a failed build leaves nothing behind. */
#include "accel/forest.h"
#include "base/mem.h"
#include "test/ray_help.h"

#include <stdlib.h>
#include <string.h>

enum { DEPTH_MOST = 80 };       /* the stacks of queries are sized by it */

static void check_tree(const Setting *s, const Accel *a, const char *what)
{
    char why[120] = "";
    EXPECT(accel_validate(a, why, sizeof why), "%s, %s: %s", s->name, what, why);
    EXPECT(a->depth >= 0 && a->depth <= DEPTH_MOST, "%s, %s: depth %d", s->name, what, a->depth);
    EXPECT(a->leaves <= a->nodes || a->leaves <= geometry_prims(a->geo) + (uint64_t)1,
           "%s, %s: %lu leaves of %lu primitives", s->name, what, (unsigned long)a->leaves,
           (unsigned long)geometry_prims(a->geo));
}

static void build_all(Mesh *m, const char *what)
{
    Geometry g;
    geometry_of(&g, m);
    for (const Setting *s = settings_all(); s->kind; s++) {
        Accel *a = setting_build(s, &g);
        check_tree(s, a, what);
        accel_free(a);
    }
    geometry_clear(&g);
}

static void large(void)
{
    Mesh m = { 0 };
    REQUIRE(mesh_bumpy(&m, 24, 5), "memory");
    build_all(&m, "bumpy sphere");
    REQUIRE(mesh_soup(&m, 20000, 0.1f, 5), "memory");
    build_all(&m, "soup");
    REQUIRE(mesh_grid(&m, 100, 100), "memory");
    build_all(&m, "grid");
}

/* ---- every small number ---- */

/* n triangles strewn about. */
static void strew(Mesh *m, uint32_t n, Rng *rng)
{
    mesh_of(m, 3 * n, n);
    for (uint32_t i = 0; i < 3 * n; i++)
        m->p[i] = v_mad(rng_direction(rng), 0.3f, v3((float)(i / 3 % 7), (float)(i / 21 % 7),
                                                     (float)(i / 147)));
    for (uint32_t i = 0; i < n; i++)
        m->tri[i] = (Tri){ { 3 * i, 3 * i + 1, 3 * i + 2 } };
}

/* Nodes of a complete tree with at least so many leaves, reckoned by adding one inner node after
 * another, each of which makes a leaf into `arity`. */
static uint64_t complete_nodes(uint64_t leaves, uint64_t arity)
{
    uint64_t nodes = 1, have = 1;
    for (; have < leaves; have += arity - 1)
        nodes += arity;
    return nodes;
}

/* Blocks of memory of a forest, and what the allocator adds to each at most. */
enum { BLOCKS = 5, BLOCK_HEAD = 32 };

/* Of a forest over n triangles of one mesh: nodes by their number, bytes by that number too, 6
 * planes a node but the roots, besides the headers of trees and the level above. bytes: of memory
 * that was taken. */
static void expect_sizes(const Setting *s, const Accel *a, uint32_t n, size_t bytes)
{
    bool wide = !strcmp(s->kind->info.name, "lbvh") && opt_is(&s->opts, "bits", "16");
    uint64_t leaf = (uint64_t)opt_int(&s->opts, "leaf"), most = opt_int(&s->opts, "pieces") ?
                    (uint64_t)opt_int(&s->opts, "pieces") : n, pieces = (n + most - 1) / most;
    uint64_t top = 2 * pieces - 1, want = top, headers;

    for (uint64_t i = 0; i < pieces; i++) {
        uint64_t count = n * (i + 1) / pieces - n * i / pieces;
        want += complete_nodes((count + leaf - 1) / leaf, (uint64_t)opt_int(&s->opts, "arity"));
    }
    headers = sizeof(Forest) + pieces * (sizeof(Tree) + sizeof(uint32_t)) +
              top * sizeof(SkipNode) + SIBLINGS_PAD;
    EXPECT(a->nodes == want, "%s has %lu nodes for %lu triangles, expected %lu", s->name,
           (unsigned long)a->nodes, (unsigned long)n, (unsigned long)want);
    EXPECT(a->bytes == headers + (want - top - pieces) * (wide ? 12 : 6),
           "%s has %lu bytes in %lu nodes", s->name, (unsigned long)a->bytes, (unsigned long)want);
    EXPECT(a->bytes <= bytes && bytes <= a->bytes + BLOCKS * BLOCK_HEAD,
           "%s says %lu bytes, %lu are taken", s->name, (unsigned long)a->bytes,
           (unsigned long)bytes);
}

/* Rays at the middle of each triangle and past it. */
static void expect_hits(const Setting *s, const Accel *a, const Accel *brute, Rng *rng)
{
    for (uint32_t i = 0; i < geometry_prims(a->geo); i++) {
        V3 c[3], d = rng_direction(rng);
        Hit want, got;
        Ray r = { .tmax = INFINITY };
        bool is;
        geometry_corners(a->geo, i, c);
        r.o = v_mad(d, -3.0f, blend(c[0], c[1], c[2], rng_barycentric(rng)));
        r.d = d;
        is = accel_nearest(brute, &r, &want);
        EXPECT(accel_nearest(a, &r, &got) == is && (!is || !memcmp(&got, &want, sizeof got)),
               "%s, %lu triangles: another hit for ray %s", s->name,
               (unsigned long)geometry_prims(a->geo), ray_text(&r));
    }
}

/* Implicit trees, whose leaves nothing but arithmetic tells, before and after arranging. */
static void small(void)
{
    Rng rng = rng_seed(43);

    for (uint32_t n = 0; n <= 300; n++) {
        Geometry g;
        Mesh m;
        strew(&m, n, &rng);
        geometry_of(&g, &m);
        for (const Setting *s = settings_all(); s->kind; s++) {
            Accel *a, *brute;
            size_t before = mem_bytes(), bytes;
            if (!s->kind->arrange)
                continue;
            a = setting_arrange(s, &g);
            bytes = mem_bytes() - before;
            brute = setting_build(setting_brute(), &g);
            check_tree(s, a, "small");
            if (n && setting_is_forest(s))
                expect_sizes(s, a, n, bytes);
            if (n < 40 || n % 10 == 0)
                expect_hits(s, a, brute, &rng);
            accel_free(a);
            accel_free(brute);
        }
        geometry_clear(&g);
    }
}

/* ---- arranging ---- */

/* What rays from all around cost that pass within `near` of the middle. */
static Steps costs(const Accel *a, int rays, float near)
{
    Rng rng = rng_seed(44);
    Steps steps = { 0, 0 };

    for (int i = 0; i < rays; i++) {
        Ray r = { .tmax = INFINITY };
        Hit h;
        r.o = v_scale(rng_direction(&rng), 3.0f);
        r.d = v_sub(v_scale(rng_direction(&rng), near), r.o);
        a->kind->nearest(a, &r, &h, &steps);
    }
    return steps;
}

static double tests_a_ray(const Setting *s, const Geometry *g)
{
    Accel *a = setting_build(s, g);
    Steps steps = costs(a, 2000, 0.5f);

    accel_free(a);
    return (double)(steps.nodes + steps.prims) / 2000;
}

typedef struct { V3 corner[3]; } Corners;

static int compare_corners(const void *a, const void *b) { return memcmp(a, b, sizeof(Corners)); }

/* What the triangles are, in an order of its own. */
static Corners *corners_of(const Geometry *g)
{
    Corners *c = MEM_ARRAY(Corners, g->ntris);

    REQUIRE(c != NULL, "memory");
    for (uint32_t i = 0; i < g->ntris; i++)
        geometry_corners(g, i, c[i].corner);
    qsort(c, g->ntris, sizeof *c, compare_corners);
    return c;
}

/* A mesh whose triangles come in no order, and whose texture coordinates say where vertices are. */
static void shuffled_mesh(Mesh *m, Rng *rng)
{
    memset(m, 0, sizeof *m);
    REQUIRE(mesh_bumpy(m, 16, 5), "memory");
    for (uint32_t i = m->ntris; i > 1; i--) {
        uint32_t j = rng_below(rng, i);
        Tri swap = m->tri[i - 1];
        m->tri[i - 1] = m->tri[j];
        m->tri[j] = swap;
    }
    mem_free(m->uv);
    m->uv = MEM_ARRAY(V2, m->nverts);
    REQUIRE(m->uv != NULL, "memory");
    for (uint32_t i = 0; i < m->nverts; i++) {
        m->uv[i].x = m->p[i].x;
        m->uv[i].y = m->p[i].y;
    }
}

/* The same triangles of the same corners, in an order that makes a tree of the shuffled ones a good
 * one, or one that needs no list. */
static void arranged(void)
{
    for (const Setting *s = settings_all(); s->kind; s++) {
        Rng rng = rng_seed(45);
        Corners *before, *after;
        Geometry g;
        Mesh m;
        Accel *a;
        double shuffled;
        size_t bytes;
        bool ok = true;

        if (!s->kind->arrange)
            continue;
        shuffled_mesh(&m, &rng);
        geometry_of(&g, &m);
        before = corners_of(&g);
        shuffled = tests_a_ray(s, &g);
        a = setting_build(s, &g);
        bytes = a->bytes;
        accel_free(a);
        a = setting_arrange(s, &g);
        after = corners_of(&g);
        EXPECT(!memcmp(before, after, g.ntris * sizeof *before), "%s: other triangles", s->name);
        EXPECT(tests_a_ray(s, &g) < 0.2 * shuffled || a->bytes == bytes - 4 * g.ntris ||
               strstr(s->name, "auto") || strstr(s->name, "fast"),
               "%s: %g tests a ray, %g before", s->name, tests_a_ray(s, &g), shuffled);
        for (size_t i = 0; i < g.nverts; i++)
            ok = ok && g.shapes[0].uv[i].x == g.p[i].x && g.shapes[0].uv[i].y == g.p[i].y;
        EXPECT(ok, "%s: vertices and what belongs to them went to different places", s->name);
        mem_free(before);
        mem_free(after);
        accel_free(a);
        geometry_clear(&g);
    }
}

/* ---- threads ---- */

/* The tree, as far as rays can tell. */
static Steps costs_built(const Setting *s, int threads, size_t *bytes)
{
    Mesh m = { 0 };
    Geometry g;
    Accel *a;
    Steps steps;

    REQUIRE(mesh_bumpy(&m, 60, 5), "memory");
    geometry_of(&g, &m);
    a = accel_build(s->kind, &g, &s->opts, threads);
    REQUIRE(a != NULL, "%s cannot be built", s->name);
    *bytes = a->bytes;
    steps = costs(a, 3000, 0.9f);
    check_tree(s, a, "threads");
    accel_free(a);
    geometry_clear(&g);
    return steps;
}

/* However many threads build it, it is the same tree. */
static void threads(void)
{
    for (const Setting *s = settings_usual(); s->kind; s++) {
        size_t one, many;
        Steps a, b;
        if (!strcmp(s->kind->info.name, "brute"))
            continue;
        a = costs_built(s, 1, &one);
        b = costs_built(s, 7, &many);
        EXPECT(one == many && a.nodes == b.nodes && a.prims == b.prims,
               "%s: another tree with seven threads", s->name);
    }
}

/* ---- input made to be hard ---- */

/* Triangle i of n as small as 1 at place(i, n) on a line along (1, 1, 1). */
static void line_up(Mesh *m, uint32_t n, float (*place)(uint32_t i, uint32_t n))
{
    mesh_of(m, 3 * n, n);
    for (uint32_t i = 0; i < n; i++) {
        float x = place(i, n);
        m->p[3 * i] = v3(x, x, x);
        m->p[3 * i + 1] = v3(x + 0.5f, x, x);
        m->p[3 * i + 2] = v3(x, x + 0.5f, x);
        m->tri[i] = (Tri){ { 3 * i, 3 * i + 1, 3 * i + 2 } };
    }
}

static float same(uint32_t i, uint32_t n) { (void)i; (void)n; return 1.0f; }
static float rising(uint32_t i, uint32_t n) { (void)n; return (float)i; }
static float falling(uint32_t i, uint32_t n) { return (float)(n - i); }
static float up_and_down(uint32_t i, uint32_t n) { return (float)(i < n / 2 ? i : n - i); }
static float down_and_up(uint32_t i, uint32_t n) { return (float)(i < n / 2 ? n - i : i); }
static float two_rows(uint32_t i, uint32_t n) { return (float)(i % (n / 2)); }
static float many_rows(uint32_t i, uint32_t n) { (void)n; return (float)(i % 300); }
static float even_then_odd(uint32_t i, uint32_t n)
{
    return (float)(i < n / 2 ? 2 * i : 2 * (i - n / 2) + 1);
}
static float far_apart(uint32_t i, uint32_t n)  /* each twice as far as the last, around 0 */
{
    float x = 1.0f;
    (void)n;
    for (uint32_t k = 0; k < i % 100; k++)
        x *= 2.0f;
    return i / 100 % 2 ? x : -x;
}

/* A selection by pivots takes quadratic time on one or the other of these: at 1e5, minutes. */
static void orders(void)
{
    static const struct { const char *name; float (*place)(uint32_t i, uint32_t n); } order[] = {
        { "same", same }, { "rising", rising }, { "falling", falling },
        { "up and down", up_and_down }, { "down and up", down_and_up }, { "two rows", two_rows },
        { "many rows", many_rows }, { "even then odd", even_then_odd }, { "far apart", far_apart }
    };
    Mesh m;

    for (size_t k = 0; k < sizeof order / sizeof *order; k++) {
        line_up(&m, test_is_long() ? 1000000 : 10000, order[k].place);
        build_all(&m, order[k].name);
    }
}

/* Boxes within boxes, sizes 2^-100 to 2^100: a heuristic would split off one at a time. */
static void nested(void)
{
    float x = 0x1p-100f;
    Mesh m;

    mesh_of(&m, 3 * 201, 201);
    for (uint32_t i = 0; i < 201; i++, x *= 2.0f) {
        m.p[3 * i] = v3(x, x, x);
        m.p[3 * i + 1] = v3(2.0f * x, x, x);
        m.p[3 * i + 2] = v3(x, 2.0f * x, 2.0f * x);
        m.tri[i] = (Tri){ { 3 * i, 3 * i + 1, 3 * i + 2 } };
    }
    build_all(&m, "nested");
}

static void equal_boxes(void)
{
    Mesh m;
    line_up(&m, 50000, same);
    build_all(&m, "equal boxes");
}

/* ---- checks that can fail ---- */

static void expect_noticed(const Setting *s, const Accel *a, const char *what)
{
    char why[120] = "";
    EXPECT(!accel_validate(a, why, sizeof why), "%s did not notice: %s", s->name, what);
    EXPECT(why[0] && !strchr(why, '\n'), "%s gave no reason: %s", s->name, what);
}

/* One triangle less, or the last one back, in a geometry of one mesh. */
static void resize(Geometry *g, int by)
{
    g->ntris += (size_t)by;
    g->shapes[0].count += (uint32_t)by;
}

/* Changes the geometry under a finished structure, and back. */
static void corrupt(const Setting *s, Geometry *g, Rng *rng)
{
    Accel *a = setting_build(s, g);
    uint32_t v = rng_below(rng, (uint32_t)g->nverts);
    V3 was = g->p[v];

    g->p[v] = v_mad(rng_direction(rng), 5.0f, was);     /* a unit mesh: out of every box */
    expect_noticed(s, a, "a vertex moved");
    g->p[v] = was;
    resize(g, -1);
    expect_noticed(s, a, "a triangle gone");
    resize(g, 1);
    check_tree(s, a, "as it was");
    accel_free(a);
    resize(g, -1);
    a = setting_build(s, g);
    resize(g, 1);
    expect_noticed(s, a, "a triangle more");
    accel_free(a);
}

static void noticed(void)
{
    Rng rng = rng_seed(41);
    Geometry g;
    Mesh m = { 0 };

    REQUIRE(mesh_icosphere(&m, 3), "memory");
    geometry_of(&g, &m);
    for (const Setting *s = settings_all(); s->kind; s++)
        for (int i = 0; i < 50; i++)
            corrupt(s, &g, &rng);
    geometry_clear(&g);
}

/* ---- rays that are none ---- */

static float odd_number(Rng *rng)
{
    const float odd[10] = { NAN, INFINITY, -INFINITY, 0.0f, -0.0f, 0x1p-149f, 3.4e38f, -3.4e38f,
                            1.0f, 0.5f };
    return odd[rng_below(rng, 10)];
}

/* Nothing is promised of the answer, but there is one, and the bounds of steps hold. */
static void garbage_ray(const Accel *a, Rng *rng, const char *what)
{
    Ray r;
    Steps near = { 0, 0 }, any = { 0, 0 };
    Hit h;
    bool is;

    r.o = v3(odd_number(rng), odd_number(rng), odd_number(rng));
    r.d = v3(odd_number(rng), odd_number(rng), odd_number(rng));
    r.tmax = odd_number(rng);
    is = a->kind->nearest(a, &r, &h, &near);
    a->kind->blocked(a, &r, &any);
    EXPECT(!is || (h.prim < geometry_prims(a->geo) && h.t > 0.0f && !(h.t > r.tmax)),
           "%s: hit of %lu at %a for %s", what, (unsigned long)h.prim, (double)h.t, ray_text(&r));
    EXPECT(near.nodes <= a->nodes && any.nodes <= a->nodes &&
           near.prims <= prims_most(a) && any.prims <= prims_most(a),
           "%s: too many steps for %s", what, ray_text(&r));
}

static void garbage(void)
{
    Rng rng = rng_seed(42);

    for (const ZooMesh *z = zoo_wild; z->name; z++) {
        Geometry g;
        Mesh m;
        z->make(&m);
        geometry_of(&g, &m);
        for (const Setting *s = settings_all(); s->kind; s++) {
            Accel *a = setting_build(s, &g);
            for (int i = 0; i < 1000; i++)
                garbage_ray(a, &rng, s->name);
            accel_free(a);
        }
        geometry_clear(&g);
    }
}

/* ---- memory ---- */

static void out_of_memory(void)
{
    Geometry g;
    Mesh m = { 0 };

    REQUIRE(mesh_icosphere(&m, 8), "memory");
    geometry_of(&g, &m);
    for (const Setting *s = settings_usual(); s->kind; s++) {
        long before = mem_blocks();
        unsigned long k = 1;
        Accel *a;
        for (;; k++) {
            mem_fail_at(k, k % 2);
            a = s->kind->build(&g, &s->opts, 1);
            mem_fail_at(0, false);
            if (a)
                break;
            EXPECT(mem_blocks() == before, "%s: blocks left after failure %lu", s->name, k);
            REQUIRE(k < 1000, "%s: never succeeds", s->name);
        }
        a->kind = s->kind;
        EXPECT(k > 1, "%s: no memory was asked for", s->name);
        EXPECT(a->bytes <= mem_bytes(), "%s: says %lu bytes", s->name, (unsigned long)a->bytes);
        check_tree(s, a, "after failures");
        accel_free(a);
        EXPECT(mem_blocks() == before, "%s: blocks left in the end", s->name);
    }
    geometry_clear(&g);
}

const TestCase test_rays_trees[] = {
    { "large", large, false }, { "small", small, false }, { "arranged", arranged, false },
    { "threads", threads, false },
    { "orders", orders, false }, { "nested", nested, false },
    { "equal_boxes", equal_boxes, false }, { "noticed", noticed, false },
    { "garbage", garbage, false }, { "out_of_memory", out_of_memory, false },
    { NULL, NULL, false }
};
