/* test_sampling.c -- warps and tables draw what they say, exactly also at the ends. */
#include "base/mem.h"
#include "base/random.h"
#include "sampling/table.h"
#include "sampling/warp.h"
#include "test/chi2.h"
#include "test/test.h"

#include <string.h>

#define LAST_UNIT (1.0 - 0x1p-53)               /* the largest double below 1 */

static V2 unit2(Rng *rng)
{
    float x = rng_unit(rng);
    return (V2){ x, rng_unit(rng) };
}

/* ---- warps ---- */

/* The disc, the triangle and the tent are looked at in the unit square around them. */
static bool draw_disk(const void *of, Rng *rng, V3 *w)
{
    V2 d = warp_disk_concentric(unit2(rng));
    (void)of;
    *w = v3(0.5f + 0.5f * d.x, 0.5f + 0.5f * d.y, 0.0f);
    return true;
}
static double pdf_disk(const void *of, V3 w)
{
    double x = 2.0 * w.x - 1.0, y = 2.0 * w.y - 1.0;
    (void)of;
    return x * x + y * y < 1.0 ? 4.0 / PI : 0.0;
}

static bool draw_triangle(const void *of, Rng *rng, V3 *w)
{
    (void)of;
    *w = warp_triangle(unit2(rng));
    return true;
}
static double pdf_triangle(const void *of, V3 w)
{
    (void)of;
    return w.x + w.y < 1.0f ? 2.0 : 0.0;
}

static bool draw_tent(const void *of, Rng *rng, V3 *w)
{
    V2 u = unit2(rng);
    (void)of;
    *w = v3(0.5f + 0.5f * warp_tent(u.x), 0.5f + 0.5f * warp_tent(u.y), 0.0f);
    return true;
}
static double pdf_tent(const void *of, V3 w)
{
    (void)of;
    return 4.0 * (1.0 - fabs(2.0 * w.x - 1.0)) * (1.0 - fabs(2.0 * w.y - 1.0));
}

static bool draw_cosine(const void *of, Rng *rng, V3 *w)
{
    (void)of;
    *w = warp_cosine(unit2(rng));
    return true;
}
static double pdf_cosine(const void *of, V3 w)
{
    (void)of;
    return warp_cosine_pdf(w.z);
}

static bool draw_cone(const void *of, Rng *rng, V3 *w)
{
    *w = warp_cone(unit2(rng), *(const float *)of);
    return true;
}
static double pdf_cone(const void *of, V3 w)
{
    float h = *(const float *)of;
    return w.z > 1.0f - h - 1e-7f ? warp_cone_pdf(h) : 0.0;     /* z near 1 has steps of 6e-8 */
}

static bool draw_sphere(const void *of, Rng *rng, V3 *w)
{
    (void)of;
    *w = warp_sphere(unit2(rng));
    return true;
}
static double pdf_sphere(const void *of, V3 w)
{
    (void)of, (void)w;
    return warp_sphere_pdf();
}

static bool draw_hemisphere(const void *of, Rng *rng, V3 *w)
{
    (void)of;
    *w = warp_hemisphere(unit2(rng));
    return true;
}
static double pdf_hemisphere(const void *of, V3 w)
{
    (void)of;
    return w.z > 0.0f ? warp_hemisphere_pdf() : 0.0;
}

static void test_warps(void)
{
    /* Heights whose rim is an edge of the bins: quadrature then meets no jump. */
    float cones[] = { 1.0f, (float)(1.0 - md_cos(PI * 20 / 64)),
                      (float)(1.0 - md_cos(PI * 3 / 64)) };

    chi2_expect(&(Chi2){ draw_disk, pdf_disk, NULL, .square = true, .seed = 1, .halvings = 3 },
                "disk");
    chi2_expect(&(Chi2){ draw_triangle, pdf_triangle, NULL, .square = true, .seed = 2,
                         .halvings = 3 }, "triangle");
    chi2_expect(&(Chi2){ draw_tent, pdf_tent, NULL, .square = true, .seed = 3 }, "tent");
    chi2_expect(&(Chi2){ draw_cosine, pdf_cosine, NULL, .seed = 4 }, "cosine");
    chi2_expect(&(Chi2){ draw_hemisphere, pdf_hemisphere, NULL, .seed = 5 }, "hemisphere");
    chi2_expect(&(Chi2){ draw_sphere, pdf_sphere, NULL, .seed = 6 }, "sphere");
    for (size_t k = 0; k < sizeof cones / sizeof *cones; k++)
        chi2_expect(&(Chi2){ draw_cone, pdf_cone, &cones[k], .seed = 7 + k }, "cone");
}

/* Cones from the whole sphere down to 1e-6 radians: within the cap, unit, and in the plane across
 * as uniform as in the widest one. The sine, not the cosine, has the digits. */
static void test_small_cones(void)
{
    for (float h = 2.0f; h > 1e-12f; h *= 0.1f) {
        Rng rng = rng_seed(11);
        double rim2 = (double)h * (2.0 - h), sum = 0.0;
        int n = 20000;
        for (int k = 0; k < n; k++) {
            V3 w = warp_cone(unit2(&rng), h);
            double sin2 = (double)w.x * w.x + (double)w.y * w.y;
            /* 1 - cos, out of the sine where that is accurate */
            double down = w.z > 0.5f ? sin2 / (1.0 + sqrt(1.0 - sin2)) : 1.0 - (double)w.z;
            EXPECT(fabs(v_len(w) - 1.0f) < 1e-6f, "height %g: length %.9g", h, v_len(w));
            EXPECT(h > 1.0f || sin2 <= rim2 * (1.0 + 1e-6), "height %g: sin^2 %g", h, sin2);
            sum += down / h;
        }
        /* uniform in (0,1): variance 1/12 */
        EXPECT(fabs(sum / n - 0.5) < 5.6 * sqrt(1.0 / 12.0 / n), "height %g: mean %g", h, sum / n);
        EXPECT(fabs(warp_cone_pdf(h) * 2.0 * PI * h - 1.0) < 1e-6, "density of height %g", h);
        if (h <= 1.0f)
            EXPECT(fabs(warp_cone_height((float)rim2) / h - 1.0) < 3e-7 / (1.0001 - h),
                   "height from the sine: %g for %g", warp_cone_height((float)rim2), h);
    }
}

/* What comes out for the ends of [0,1), and the identities that callers lean on. */
static void test_warp_ends(void)
{
    const float end[] = { 0.0f, 0x1p-24f, 1e-30f, 0.25f, 0.5f, 0x1.fffffep-2f, ONE_MINUS_ULP };
    for (int i = 0; i < 7; i++)
        for (int j = 0; j < 7; j++) {
            V2 u = { end[i], end[j] }, d = warp_disk_concentric(u);
            V3 c = warp_cosine(u), s = warp_sphere(u), b = warp_triangle(u);
            EXPECT(d.x * d.x + d.y * d.y <= 1.0f, "disk leaves at %g %g", u.x, u.y);
            EXPECT(c.z > 0.0f && fabsf(v_len(c) - 1.0f) < 1e-6f, "cosine at %g %g", u.x, u.y);
            EXPECT(fabsf(v_len(s) - 1.0f) < 1e-6f, "sphere at %g %g", u.x, u.y);
            EXPECT(b.x >= 0.0f && b.y >= 0.0f && b.z >= 0.0f &&
                   fabsf(b.x + b.y + b.z - 1.0f) < 2e-7f, "triangle at %g %g: %g %g %g",
                   u.x, u.y, b.x, b.y, b.z);
        }
    EXPECT(warp_tent(0.0f) == -1.0f && warp_tent(0.5f) == 0.0f, "tent's ends");
    EXPECT(warp_tent(ONE_MINUS_ULP) < 1.0f, "tent reaches 1");
}

/* Neighbours stay neighbours. The concentric map stretches by at most 2 sqrt(5)/2 < 2.3 (its rows
 * have length 2, its columns pi/2 sqrt(1 + ...)); a polar map tears the square at phi = 0. */
static void test_warps_keep_neighbours(void)
{
    enum { N = 64 };
    const float step = 1.0f / N;
    for (int i = 0; i + 1 < N; i++)
        for (int j = 0; j < N; j++) {
            V2 a = { i * step, j * step }, b = { (i + 1) * step, j * step };
            V2 c = { j * step, i * step }, e = { j * step, (i + 1) * step };
            V2 p = warp_disk_concentric(a), q = warp_disk_concentric(b),
               r = warp_disk_concentric(c), s = warp_disk_concentric(e);
            float d2 = f_sqr(p.x - q.x) + f_sqr(p.y - q.y);
            float e2 = f_sqr(r.x - s.x) + f_sqr(r.y - s.y);
            EXPECT(d2 <= f_sqr(2.6f * step) && e2 <= f_sqr(2.6f * step), "torn at %d %d", i, j);
            EXPECT(v_len(v_sub(warp_triangle(a), warp_triangle(b))) <= 1.5f * step,
                   "triangle torn at %d %d", i, j);
        }
}

/* ---- 1-D tables ---- */

enum { N_WEIGHTS = 300 };

/* Weights of many sizes, with zeros at both ends and inside. */
static void weights_make(float *w, size_t n, uint64_t seed)
{
    Rng rng = rng_seed(seed);
    for (size_t i = 0; i < n; i++) {
        float x = rng_unit(&rng);
        w[i] = x < 0.3f ? 0.0f : x * x * x * (x > 0.98f ? 1000.0f : 1.0f);
    }
    if (n > 2)
        w[0] = w[n - 1] = 0.0f;
}

typedef struct { const char *name; Table *table; AliasTable *alias; } Chooser;

static bool choose(const Chooser *c, double u, size_t *i, float *pmf, float *rest)
{
    uint32_t k = 0;
    if (c->table)
        return table_sample(c->table, u, i, pmf, rest);
    if (!alias_sample(c->alias, u, &k, pmf, rest))
        return false;
    *i = k;
    return true;
}
static float pmf_of(const Chooser *c, size_t i)
{
    return c->table ? table_pmf(c->table, i) : alias_pmf(c->alias, (uint32_t)i);
}

/* Counts against pmf, pmf against weights, leftovers against the uniform distribution. */
static void check_chooser(const Chooser *c, const float *w, size_t n)
{
    enum { DRAWS = 1000000, PARTS = 100 };
    double *expected = MEM_ARRAY(double, n), total = 0.0, sum = 0.0, part[PARTS];
    uint64_t *count = MEM_ARRAY(uint64_t, n), in_part[PARTS] = { 0 };
    Rng rng = rng_seed(n);

    REQUIRE(expected && count, "memory");
    for (size_t i = 0; i < n; i++)
        total += w[i];
    for (size_t i = 0; i < n; i++) {
        double p = w[i] / total;
        EXPECT(fabs(pmf_of(c, i) - p) <= 1e-6 * p + 1e-16 * n, "%s: pmf(%d) = %g, not %g", c->name,
               (int)i, pmf_of(c, i), p);
        EXPECT(w[i] > 0.0f || pmf_of(c, i) == 0.0f, "%s: pmf(%d) of weight 0", c->name, (int)i);
        expected[i] = DRAWS * (double)pmf_of(c, i);
        sum += pmf_of(c, i);
    }
    EXPECT(fabs(sum - 1.0) < 1e-5, "%s: pmf adds up to %.9f", c->name, sum);
    for (int k = 0; k < DRAWS; k++) {
        double u = (double)(rng_bits(&rng) >> 11) * 0x1p-53;
        size_t i = n;
        float pmf, rest;
        REQUIRE(choose(c, u, &i, &pmf, &rest) && i < n, "%s: no choice for %g", c->name, u);
        EXPECT(pmf == pmf_of(c, i), "%s: pmf %g, sampled with %g", c->name, pmf_of(c, i), pmf);
        EXPECT(rest >= 0.0f && rest < 1.0f, "%s: leftover %g", c->name, rest);
        count[i]++;
        in_part[(int)(rest * PARTS)]++;
    }
    EXPECT(chi2_counts(expected, count, n) >= CHI2_P_MIN, "%s of %d: counts and pmf differ",
           c->name, (int)n);
    for (int k = 0; k < PARTS; k++)
        part[k] = (double)DRAWS / PARTS;
    EXPECT(chi2_counts(part, in_part, PARTS) >= CHI2_P_MIN, "%s: leftovers not uniform", c->name);
    mem_free(expected);
    mem_free(count);
}

static void test_choice(void)
{
    const size_t sizes[] = { 1, 2, 3, 7, N_WEIGHTS };
    for (int k = 0; k < 5; k++) {
        float w[N_WEIGHTS];
        Table t;
        AliasTable a;
        weights_make(w, sizes[k], 40 + (uint64_t)k);
        w[sizes[k] / 2] = 2.0f;                         /* not all zero */
        REQUIRE(table_init(&t, w, sizes[k]) && alias_init(&a, w, (uint32_t)sizes[k]), "memory");
        check_chooser(&(Chooser){ "table", &t, NULL }, w, sizes[k]);
        check_chooser(&(Chooser){ "alias table", NULL, &a }, w, sizes[k]);
        table_clear(&t);
        alias_clear(&a);
    }
}

/* What the bins of an alias table really draw, added up, is the pmf to a few roundings. */
static void test_alias_is_exact(void)
{
    enum { N = 5000 };
    static float w[N];
    for (int shape = 0; shape < 20; shape++) {
        static double really[N];
        AliasTable a;
        weights_make(w, N, 77 + (uint64_t)shape);
        for (int i = 0; i < N; i++)
            w[i] = shape == 1 ? 1.0f : shape == 2 ? (i ? 1e-7f : 1.0f)
                 : shape == 3 ? 1.0f + (float)i * 0x1p-23f : w[i];
        REQUIRE(alias_init(&a, w, N), "memory");
        memset(really, 0, sizeof really);
        for (int i = 0; i < N; i++) {
            really[i] += a.bin[i].keep / N;
            really[a.bin[i].other] += (1.0 - a.bin[i].keep) / N;
            EXPECT(a.bin[i].keep >= 0.0 && a.bin[i].keep <= 1.0, "keep %g", a.bin[i].keep);
        }
        for (int i = 0; i < N; i++)
            EXPECT(w[i] > 0.0f || really[i] == 0.0, "shape %d: weight 0 is drawn", shape);
        for (int i = 0; i < N; i++)
            EXPECT(fabs(really[i] - a.bin[i].pmf) <= 1e-6 * a.bin[i].pmf, "shape %d: %d is drawn "
                   "%g, pmf %g", shape, i, really[i], a.bin[i].pmf);
        alias_clear(&a);
    }
}

/* The largest numbers below 1 (of a float and of a double), weights of 0 around the choice. */
static void test_choice_ends(void)
{
    const float w[] = { 0.0f, 0.0f, 3.0f, 0.0f, 1e-3f, 0.1f, 0.0f };
    const double end[] = { 0.0, ONE_MINUS_ULP, LAST_UNIT, 0x1p-24, 5e-324 };
    Table t;
    AliasTable a;

    REQUIRE(table_init(&t, w, 7) && alias_init(&a, w, 7), "memory");
    for (int c = 0; c < 2; c++)
        for (int k = 0; k < 5; k++) {
            Chooser chooser = { c ? "alias table" : "table", c ? NULL : &t, &a };
            size_t i = 7;
            float pmf, rest;
            REQUIRE(choose(&chooser, end[k], &i, &pmf, &rest) && i < 7, "%s", chooser.name);
            EXPECT(w[i] > 0.0f && pmf > 0.0f, "%s: weight 0 was chosen", chooser.name);
            EXPECT(rest >= 0.0f && rest < 1.0f, "%s: leftover %g", chooser.name, rest);
        }
    EXPECT(table_total(&t) > 3.1, "total %g", table_total(&t));
    table_clear(&t);
    alias_clear(&a);

    /* erratum 5.2: in float, (s - p) / (1 - p) reaches 1 for many p */
    for (int k = 1; k < 4000; k++) {
        float pair[2] = { (float)k, (float)(4001 - k) }, rest;
        size_t i;
        REQUIRE(table_init(&t, pair, 2), "memory");
        for (int e = 1; e < 3; e++)
            EXPECT(table_sample(&t, end[e], &i, NULL, &rest) && i == 1 && rest < 1.0f &&
                   rest > 0.99f, "leftover %.9g of %d", rest, k);
        table_clear(&t);
    }
}

static void test_nothing_to_choose(void)
{
    const float none[4] = { 0.0f, -1.0f, INFINITY, NAN };
    for (uint32_t n = 0; n <= 4; n += 4) {
        Table t;
        AliasTable a;
        Table2 s;
        size_t i;
        uint32_t k;
        V2 p;
        float pdf;
        REQUIRE(table_init(&t, none, n) && alias_init(&a, none, n) &&
                table2_init(&s, none, n / 2, 2), "tables of nothing are legal");
        EXPECT(!table_sample(&t, 0.5, &i, NULL, NULL), "table of %d samples", (int)n);
        EXPECT(!alias_sample(&a, 0.5, &k, NULL, NULL), "alias table of %d samples", (int)n);
        EXPECT(!table2_sample(&s, (V2){ 0.5f, 0.5f }, &p, &pdf), "2-D table of %d samples", (int)n);
        EXPECT(table2_pdf(&s, (V2){ 0.5f, 0.5f }) == 0.0f, "density without weight");
        for (uint32_t j = 0; j < n; j++)
            EXPECT(table_pmf(&t, j) == 0.0f && alias_pmf(&a, j) == 0.0f, "pmf without weight");
        EXPECT(table_total(&t) == 0.0 && table2_total(&s) == 0.0, "total without weight");
        table_clear(&t);
        alias_clear(&a);
        table2_clear(&s);
    }
}

/* Weights whose ratio is beyond double: what is sampled has a pmf, what has a pmf is sampled. */
static void test_extreme_weights(void)
{
    const float w[] = { 1e-45f, 3e38f, 1e-45f, 1.0f, 3e38f, 1e-30f };
    Rng rng = rng_seed(5);
    Table t;
    AliasTable a;
    REQUIRE(table_init(&t, w, 6) && alias_init(&a, w, 6), "memory");
    for (int k = 0; k < 100000; k++) {
        size_t i = 0;
        uint32_t j = 0;
        float p, q, rest;
        REQUIRE(table_sample(&t, rng_unit(&rng), &i, &p, &rest), "no sample");
        REQUIRE(alias_sample(&a, rng_unit(&rng), &j, &q, &rest), "no sample");
        EXPECT(p > 0.0f && q > 0.0f && is_finite(p) && is_finite(q), "pmf %g %g", p, q);
    }
    table_clear(&t);
    alias_clear(&a);
    REQUIRE(table_init(&t, w, 1), "memory");            /* a total that is denormal as a float */
    EXPECT(table_pmf(&t, 0) == 1.0f, "pmf of one thing");
    table_clear(&t);
}

/* ---- 2-D tables ---- */

static bool draw_table2(const void *of, Rng *rng, V3 *w)
{
    V2 p;
    float pdf;
    if (!table2_sample(of, unit2(rng), &p, &pdf))
        return false;
    EXPECT(pdf == table2_pdf(of, p), "sampled with %g, pdf %g", pdf, table2_pdf(of, p));
    EXPECT(p.x >= 0.0f && p.x < 1.0f && p.y >= 0.0f && p.y < 1.0f, "point %g %g", p.x, p.y);
    *w = v3(p.x, p.y, 0.0f);
    return true;
}
static double pdf_table2(const void *of, V3 w) { return table2_pdf(of, (V2){ w.x, w.y }); }

static void test_table2(void)
{
    const uint32_t size[][2] = { { 1, 1 }, { 8, 4 }, { 1, 32 }, { 32, 1 }, { 64, 64 } };
    for (int k = 0; k < 5; k++) {
        static float w[64 * 64];
        uint32_t nx = size[k][0], ny = size[k][1], zero_row = ny / 2;
        Table2 t;
        weights_make(w, (size_t)nx * ny, 90 + (uint64_t)k);
        for (uint32_t x = 0; x < nx && ny > 1; x++)
            w[zero_row * nx + x] = 0.0f;
        w[0] = 1.0f;
        REQUIRE(table2_init(&t, w, nx, ny), "memory");
        chi2_expect(&(Chi2){ draw_table2, pdf_table2, &t, .square = true, .seed = 30 + (uint64_t)k,
                             .rows = 64, .cols = 64 }, "2-D table");
        table2_clear(&t);
    }
}

/* The point drawn lies in the cell drawn, for awkward sizes and for the ends of every cell: the
 * density of `sample` is that of `pdf`, bit for bit, and cells of weight 0 are never entered. */
static void test_table2_cells(void)
{
    const uint32_t sizes[] = { 3, 7, 1000, 4095, 4096, 4097, 65535, 1u << 20 };
    for (int k = 0; k < 8; k++) {
        uint32_t n = sizes[k];
        float *w = MEM_ARRAY(float, n);
        Rng rng = rng_seed(n);
        REQUIRE(w, "memory");
        for (uint32_t i = 0; i < n; i++)
            w[i] = i & 1 ? 0.0f : (float)(1 + i % 5);   /* neighbours differ */
        for (int tall = 0; tall < 2; tall++) {
            Table2 t;
            REQUIRE(table2_init(&t, w, tall ? 1 : n, tall ? n : 1), "memory");
            for (int i = 0; i < 100000; i++) {
                float u = i == 0 ? 0.0f : i == 1 ? ONE_MINUS_ULP : rng_unit(&rng), pdf;
                V2 p;
                if (i & 1 && n <= 65536)                /* just below and at a cell's edge */
                    u = clamp01((float)rng_below(&rng, n) / (float)n) * ONE_MINUS_ULP;
                REQUIRE(table2_sample(&t, (V2){ u, u }, &p, &pdf), "no sample");
                EXPECT(pdf > 0.0f && pdf == table2_pdf(&t, p), "%u cells: sampled %g, pdf %g at "
                       "%.9g %.9g", (unsigned)n, pdf, table2_pdf(&t, p), p.x, p.y);
                EXPECT(p.x >= 0.0f && p.x < 1.0f && p.y >= 0.0f && p.y < 1.0f, "%g %g", p.x, p.y);
            }
            table2_clear(&t);
        }
        mem_free(w);
    }
}

/* ---- memory ---- */

static bool make_all(void)
{
    const float w[6] = { 1, 2, 3, 4, 5, 6 };
    Table t;
    AliasTable a;
    Table2 s;
    bool ok = table_init(&t, w, 6);
    table_clear(&t);
    ok = ok && alias_init(&a, w, 6);
    if (ok) {
        alias_clear(&a);
        ok = table2_init(&s, w, 3, 2);
        table2_clear(&s);
    }
    return ok;
}

static void test_memory(void)
{
    long blocks = mem_blocks();
    unsigned long k = 0;
    bool ok;
    do {
        mem_fail_at(++k, false);
        ok = make_all();
        EXPECT(mem_blocks() == blocks, "%ld blocks leak when allocation %lu fails",
               mem_blocks() - blocks, k);
    } while (!ok && k < 100);
    mem_fail_at(0, false);
    EXPECT(k == 6, "%lu allocations, expected 5 that can fail", k - 1);
}

/* ---- the same bits on every machine ---- */

static void test_same_bits(void)
{
    static float w[64 * 64];
    Rng rng = rng_seed(1234);
    uint64_t h = 0;
    Table t;
    AliasTable a;
    Table2 s;

    weights_make(w, 64 * 64, 5);
    REQUIRE(table_init(&t, w, 4096) && alias_init(&a, w, 4096) && table2_init(&s, w, 64, 64),
            "memory");
    for (int k = 0; k < 50000; k++) {
        V2 u = unit2(&rng), d = warp_disk_concentric(u), p = { 0, 0 };
        V3 c = warp_cosine(u), n = warp_cone(u, 1e-3f), g = warp_sphere(u), b = warp_triangle(u);
        size_t i = 0;
        uint32_t j = 0;
        float pmf[2] = { 0 }, rest[2] = { 0 }, pdf = 0;
        REQUIRE(table_sample(&t, u.x, &i, &pmf[0], &rest[0]) &&
                alias_sample(&a, u.y, &j, &pmf[1], &rest[1]) &&
                table2_sample(&s, u, &p, &pdf), "nothing to sample");
        h = test_hash(h, (float[]){ d.x, d.y, c.x, c.y, c.z, n.x, n.y, n.z, g.x, g.y, g.z,
                                      b.x, b.y, b.z, warp_tent(u.x), pmf[0], pmf[1], rest[0],
                                      rest[1], p.x, p.y, pdf, (float)i, (float)j }, 24);
    }
    table_clear(&t);
    alias_clear(&a);
    table2_clear(&s);
    EXPECT(h == 0xC239B85F2A09DAF2u, "hash %016llX", (unsigned long long)h);
}

/* ---- the tester itself ---- */

typedef struct { double tilt; bool sideways; } Tilt;

/* Cosine density about z mixed with a share `tilt` of a uniform one that pdf does not know of. */
static bool draw_tilt(const void *of, Rng *rng, V3 *w)
{
    const Tilt *t = of;
    *w = rng_unit(rng) < t->tilt ? warp_hemisphere(unit2(rng)) : warp_cosine(unit2(rng));
    if (t->sideways)
        w->z = -w->z;
    return true;
}

/* The tail against known values, and faults of known size: 20 % are found, 0.1 % cannot be. */
static void test_chi2_itself(void)
{
    Tilt wrong = { 0.2, false }, right = { 0.0, false }, slight = { 0.001, false };
    Tilt down = { 0.0, true };
    Chi2Result r;
    EXPECT(fabs(chi2_tail(3.841458820694124, 1) - 0.05) < 1e-12, "1 degree");
    EXPECT(fabs(chi2_tail(18.307038053275146, 10) - 0.05) < 1e-12, "10 degrees");
    EXPECT(fabs(chi2_tail(1000.0, 1000) - 0.49405285382921195) < 1e-10, "1000 degrees");
    EXPECT(fabs(chi2_tail(2.0, 2) / 0.36787944117144233 - 1.0) < 1e-12, "exp(-1)");
    EXPECT(fabs(chi2_tail(60.0, 2) / 9.357622968840175e-14 - 1.0) < 1e-9, "far tail");
    r = chi2_run(&(Chi2){ draw_tilt, pdf_cosine, &right, .seed = 1 });
    EXPECT(r.ok && fabs(r.integral - 1.0) < 1e-6, "right: p %g, integral %g", r.p_fine, r.integral);
    r = chi2_run(&(Chi2){ draw_tilt, pdf_cosine, &slight, .seed = 1 });
    EXPECT(r.ok, "0.1 %% is below the noise: p %g", r.p_fine);
    r = chi2_run(&(Chi2){ draw_tilt, pdf_cosine, &wrong, .seed = 1 });
    EXPECT(!r.ok && r.p_coarse < 1e-30, "20 %% passes: p %g", r.p_coarse);
    r = chi2_run(&(Chi2){ draw_tilt, pdf_cosine, &down, .seed = 1, .draws = 1000 });
    EXPECT(!r.ok && r.astray == 1000, "draws where the density is 0 pass");
    r = chi2_run(&(Chi2){ draw_tilt, pdf_sphere, &right, .seed = 1, .draws = 1000 });
    EXPECT(!r.ok, "another density passes");
}

const TestCase test_sampling[] = {
    { "chi2_itself", test_chi2_itself, false },
    { "warps", test_warps, false },
    { "small_cones", test_small_cones, false },
    { "warp_ends", test_warp_ends, false },
    { "warps_keep_neighbours", test_warps_keep_neighbours, false },
    { "choice", test_choice, false },
    { "alias_is_exact", test_alias_is_exact, false },
    { "choice_ends", test_choice_ends, false },
    { "nothing_to_choose", test_nothing_to_choose, false },
    { "extreme_weights", test_extreme_weights, false },
    { "table2", test_table2, false },
    { "table2_cells", test_table2_cells, false },
    { "memory", test_memory, false },
    { "same_bits", test_same_bits, false },
    { NULL, NULL, false }
};
