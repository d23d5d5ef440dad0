/* test_partition.c -- the sky map's sums, and partitions of it: they tile the map, draw what they
 * state, and find their way back. */
#include "base/mem.h"
#include "base/random.h"
#include "lightsampling/partition.h"
#include "sampling/warp.h"
#include "test/chi2.h"
#include "test/partition_help.h"
#include "test/physics.h"

#include <stdio.h>
#include <string.h>

/* ---- skies ---- */

static Rgb constant(V3 w) { (void)w; return rgb(1, 2, 3); }
static Rgb smooth(V3 w) { return rgb(1.2f + w.x, 1.1f + w.y * w.z, 0.3f); }
static Rgb half_black(V3 w) { return rgb_all(w.x > 0.0f ? 1.0f + w.z : 0.0f); }
static Rgb one_bright(V3 w)
{
    return rgb_all(v_dot(w, v_unit(v3(0.5f, -0.6f, 0.62f))) > 0.9996f ? 1e5f : 0.25f);
}

typedef struct { const char *name; uint32_t w, h; Rgb (*f)(V3 w); const char *options; } Sky;
static const Sky skies[] = {
    { "1 x 1", 1, 1, constant, "mapping=latlong" },
    { "smooth", 128, 64, smooth, "" },
    { "odd", 37, 23, smooth, "" },
    { "half black", 256, 128, half_black, "" },
    { "one bright", 128, 64, one_bright, "" },
    { "octahedral", 64, 64, smooth, "mapping=octahedral" },
};
enum { NSKIES = sizeof skies / sizeof *skies };

typedef struct { Lab lab; SkyMap map; } Setting;

static void sky_make(Setting *p, const Sky *sky, const Transform *t)
{
    lab_init(&p->lab);
    lab_sky_as(&p->lab, sky->w, sky->h, sky->f, t, sky->options);
    lab_build(&p->lab);
    REQUIRE(skymap_light(p->lab.scene) == p->lab.scene->lights[0], "the light of the map");
    REQUIRE(skymap_init(&p->map, p->lab.scene->lights[0], BY_LUMINANCE), "%s", sky->name);
}

static void sky_clear(Setting *p)
{
    skymap_clear(&p->map);
    lab_clear(&p->lab);
}

/* ---- factors: a cosine and a lobe of any width ---- */

typedef struct { V3 n, lobe; float exponent, share; } Lobe;

static float lobe_f(const void *of, V3 wi)
{
    const Lobe *l = of;
    float c = v_dot(l->n, wi), a = v_dot(l->lobe, wi);

    if (c <= 0.0f && v_len2(l->n) > 0.0f)
        return 0.0f;
    c = v_len2(l->n) > 0.0f ? c : 1.0f;
    return c * (1.0f - l->share + (a > 0.0f ? l->share * m_pow(a, l->exponent) : 0.0f));
}

static const V3 normals[] = {
    { 0, 0, 1 }, { 0, 0, -1 }, { 1, 0, 0 }, { -1, 0, 0 }, { 0, 1, 0 }, { 0.6f, 0, 0.8f },
    { 0.48f, -0.64f, 0.6f }, { 0.7071f, -1e-4f, -0.7071f }, { 0, 0, 0 }
};
enum { NNORMALS = sizeof normals / sizeof *normals };

static Lobe lobe_about(V3 n, float exponent, float share)
{
    Lobe l = { n, v_unit(v_add(n, v3(0.5f, -0.2f, 0.1f))), exponent, share };
    return l;
}

static bool grow(Partition *p, const SkyMap *m, const Lobe *l, int splits)
{
    PartitionOrder o = { lobe_f, l, l->n, &l->lobe, 1, NULL, 0, splits };
    return partition_make(p, m, &o);
}

/* ---- sums ---- */

/* Against sums over the cells one by one: every sky, some rectangles. */
static void sums(void)
{
    for (int k = 0; k < NSKIES; k++) {
        Setting s;
        Rng rng;
        sky_make(&s, &skies[k], NULL);
        rng = rng_seed(7 + (uint64_t)k * 16u);
        EXPECT(s.map.w >= 128 && s.map.h >= 64, "%s: %u x %u cells", skies[k].name, s.map.w,
               s.map.h);
        EXPECT(fabs(skymap_sum(&s.map, 0, 0, s.map.w, s.map.h) - 1) < 1e-12, "the whole");
        for (int i = 0; i < 8; i++) {
            uint32_t x0 = (uint32_t)(rng_unit(&rng) * (float)s.map.w / 2), x1 = x0 + s.map.w / 3;
            uint32_t y0 = (uint32_t)(rng_unit(&rng) * (float)s.map.h / 2), y1 = y0 + s.map.h / 4;
            double sum = 0, is = skymap_sum(&s.map, x0, y0, x1, y1), want = 0, j;
            for (uint32_t y = y0; y < y1; y++)
                for (uint32_t x = x0; x < x1; x++) {
                    float jacobian;
                    V2 q = { ((float)x + 0.5f) / (float)s.map.w,
                             ((float)y + 0.5f) / (float)s.map.h };
                    V3 wi = skymap_direction(&s.map, q, &jacobian);
                    j = (double)jacobian / ((double)s.map.w * s.map.h);
                    sum += skymap_sum(&s.map, x, y, x + 1, y + 1);
                    want += j * (double)rgb_lum(skymap_radiance(&s.map, q, wi)) /
                            s.map.light_in_all;
                }
            EXPECT(fabs(is - sum) < 1e-12, "%s: sum %.15g, of cells %.15g", skies[k].name, is, sum);
            EXPECT(fabs(is - want) < (s.map.exact ? 1e-6 : 0.02) * want + 1e-9,
                   "%s: share of light %.9g, expected %.9g", skies[k].name, is, want);
        }
        sky_clear(&s);
    }
}

/* ---- tiling ---- */

static void expect_tiles(const Partition *p, const Lobe *l, const char *what)
{
    const PartitionNode *root = &p->node[0];
    uint32_t w = p->map->w, h = p->map->h;
    unsigned char *seen = MEM_ARRAY(unsigned char, (size_t)w * h);
    double sum = 0, parts = 0;
    int wrong = 0, strange = 0, strange_parts = 0;

    for (int i = 0; i < p->n; i++) {
        const PartitionNode *r = &p->node[i];
        const PartitionPart *q = &p->part[i];
        V3 c[4] = { skymap_corner(p->map, r->x0, r->y0), skymap_corner(p->map, r->x1, r->y0),
                    skymap_corner(p->map, r->x0, r->y1), skymap_corner(p->map, r->x1, r->y1) };
        if (r->child)
            continue;
        parts += (q->end[0] - q->at[0]) * (q->end[1] - q->at[1]);
        strange_parts += !(fabs((q->end[0] - q->at[0]) * (q->end[1] - q->at[1]) -
                                r->weight / root->weight) < 1e-12);
        EXPECT(r->x0 < r->x1 && r->y0 < r->y1, "%s: an empty leaf", what);
        sum += r->weight;
        for (int k = 0; k < 4; k++)
            strange += !(fabsf(r->f[k] - f_max(lobe_f(l, c[k]), p->floor)) <= 0.0f);
        for (uint32_t y = r->y0; y < r->y1; y++)
            for (uint32_t x = r->x0; x < r->x1; x++)
                seen[(size_t)y * w + x]++;
    }
    for (uint32_t y = 0; y < h; y++)
        for (uint32_t x = 0; x < w; x++)
            wrong += seen[(size_t)y * w + x] != (y >= root->y0 && y < root->y1);
    EXPECT(wrong == 0, "%s: %d cells are not in exactly one leaf", what, wrong);
    EXPECT(strange == 0, "%s: %d corners have another f", what, strange);
    EXPECT(fabs(sum - root->weight) < 1e-9 * root->weight, "%s: weights", what);
    EXPECT(strange_parts == 0 && fabs(parts - 1) < 1e-9, "%s: of the unit square %d leaves have "
           "not what their weight is, all together %.12g", what, strange_parts, parts);
    mem_free(seen);
}

static void tiles(void)
{
    static const int splits[] = { 0, 1, 32, 256 };
    static Partition p;

    for (int k = 0; k < NSKIES; k++) {
        Setting s;
        sky_make(&s, &skies[k], NULL);
        for (int n = 0; n < NNORMALS; n++)
            for (int i = 0; i < 4; i++) {
                Lobe l = lobe_about(normals[n], n % 2 ? 2000.0f : 20.0f, 0.7f);
                char what[80];
                snprintf(what, sizeof what, "%s, normal %d, %d splits", skies[k].name, n,
                         splits[i]);
                REQUIRE(grow(&p, &s.map, &l, splits[i]), "%s: nothing to draw", what);
                expect_tiles(&p, &l, what);
            }
        sky_clear(&s);
    }
}

/* ---- drawing ---- */

/* Bins are the map's cells, or cut them where those are not. */
static void draws(void)
{
    static Partition p;

    for (int k = 1; k < NSKIES; k++)
        for (int n = 0; n < NNORMALS; n += test_is_long() ? 1 : 4) {
            Lobe l = lobe_about(normals[n], 50.0f, 0.8f);
            Chi2 c = { partition_draw, partition_density, &p, false, 200000, (uint64_t)n,
                       64, 128, 2, 0 };
            Setting s;
            char what[80];
            sky_make(&s, &skies[k], NULL);
            snprintf(what, sizeof what, "%s, normal %d", skies[k].name, n);
            REQUIRE(grow(&p, &s.map, &l, 32), "%s", what);
            if (s.map.w % 128 || s.map.h % 64)
                c.rows = (int)s.map.h / 4 * 4, c.cols = (int)s.map.w / 4 * 4;
            if (s.map.w == 128 || s.map.w == 256)
                chi2_expect(&c, what);
            sky_clear(&s);
        }
}

/* warp, density and way back agree; on a rotated map as well. */
static void back(void)
{
    static Partition p;
    Transform one = xf_rotate(40, 1, 2, 3), other = xf_rotate(70, 0, 1, 0);
    Transform turn = xf_then(&one, &other);

    for (int k = 0; k < NSKIES; k++)
        for (int n = 0; n < NNORMALS; n++) {
            Lobe l = lobe_about(normals[n], 300.0f, 0.8f);
            int off = 0, astray = 0;
            Setting s;
            Rng rng;
            sky_make(&s, &skies[k], n % 2 ? &turn : NULL);
            rng = rng_seed(5 + (uint64_t)n * 16u);
            REQUIRE(grow(&p, &s.map, &l, 64), "%s", skies[k].name);
            for (int i = 0; i < 2000; i++) {
                PartitionSample a;
                float pdf_w, far;
                V2 u, v;
                u.x = rng_unit(&rng);
                u.y = rng_unit(&rng);
                partition_warp(&p, u, &a);
                EXPECT(a.pdf_w > 0 && fabsf(v_len(a.wi) - 1) < 1e-5f, "%s", skies[k].name);
                if (!partition_unwarp(&p, a.wi, &v, &pdf_w) || fabsf(pdf_w / a.pdf_w - 1) > 1e-3f)
                    astray++;           /* wi was rounded into the next cell */
                /* wi errs by 2e-7: so far on the square, if all of that is along one side */
                far = 1e-5f + 1e-6f * sqrtf(a.pdf_w) * (float)s.map.h;
                off += fabsf(u.x - v.x) > far || fabsf(u.y - v.y) > far;
            }
            EXPECT(astray <= 4 && off <= 4, "%s, normal %d: %d densities differ, %d points",
                   skies[k].name, n, astray, off);
            sky_clear(&s);
        }
}

/* Points that go side by side come where each would come alone, to the last bit, whatever their
 * number. */
static void together(void)
{
    enum { MOST = 75 };
    static Partition p;

    for (int k = 0; k < NSKIES; k++) {
        Lobe l = lobe_about(normals[6], 300.0f, 0.8f);
        PartitionSample many[MOST], one;
        V2 u[MOST];
        Setting s;
        Rng rng;
        sky_make(&s, &skies[k], NULL);
        rng = rng_seed(15 + (uint64_t)k * 16u);
        REQUIRE(grow(&p, &s.map, &l, 40), "%s", skies[k].name);
        for (int i = 0; i < MOST; i++) {
            u[i].x = rng_unit(&rng);
            u[i].y = rng_unit(&rng);
        }
        for (int n = 1; n <= MOST; n += n < 40 ? 1 : 7) {
            int wrong = 0;
            partition_warp_many(&p, u, many, n);
            for (int i = 0; i < n; i++) {
                partition_warp(&p, u[i], &one);
                wrong += memcmp(&one.wi, &many[i].wi, sizeof one.wi) ||
                         memcmp(&one.pdf_w, &many[i].pdf_w, sizeof one.pdf_w) ||
                         memcmp(&one.place, &many[i].place, sizeof one.place);
            }
            EXPECT(!wrong, "%s: %d of %d differ", skies[k].name, wrong, n);
        }
        sky_clear(&s);
    }
}

/* A broad lobe about z, and another that no corner sees. [errata 5.3] */
static float two_lobes(const void *of, V3 wi)
{
    float a = f_max(0, wi.z), b = f_max(0, v_dot(wi, *(const V3 *)of));
    return m_pow(a, 20) + m_pow(b, 30);
}

/* What no corner sees is found all the same: the means are right. */
static void unseen(void)
{
    enum { N = 300000 };
    V3 lobe = v_unit(v3(-0.2f, 0.85f, -0.5f));
    static Partition p;
    PartitionOrder o = { two_lobes, &lobe, { 0, 0, 0 }, NULL, 0, NULL, 0, 2 };
    Stat sum = { 0 };
    Setting s;
    Rng rng = rng_seed(21);

    sky_make(&s, &skies[0], NULL);
    REQUIRE(partition_make(&p, &s.map, &o), "partition");
    for (int i = 0; i < N; i++) {
        PartitionSample a;
        V2 u;
        u.x = rng_unit(&rng);
        u.y = rng_unit(&rng);
        partition_warp(&p, u, &a);
        stat_add(&sum, (double)(two_lobes(&lobe, a.wi) / a.pdf_w));
    }
    stat_expect(&sum, 2 * PI / 21 + 2 * PI / 31, 0.3, "two lobes");
    sky_clear(&s);
}

/* More splits draw closer to the product: the estimate's variance falls. */
static void converges(void)
{
    static Partition p;
    double last = INFINITY;
    Setting s;
    Lobe l = lobe_about(normals[6], 200.0f, 0.9f);

    sky_make(&s, &skies[1], NULL);
    for (int splits = 4; splits <= 256; splits *= 4) {
        Stat sum = { 0 };
        Rng rng;
        double cv;
        rng = rng_seed(3 + 0);
        REQUIRE(grow(&p, &s.map, &l, splits), "partition");
        for (int i = 0; i < 20000; i++) {
            PartitionSample a;
            V2 u;
            u.x = rng_unit(&rng);
            u.y = rng_unit(&rng);
            partition_warp(&p, u, &a);
            stat_add(&sum, (double)(lobe_f(&l, a.wi) *
                                    rgb_lum(skymap_radiance(&s.map, a.place, a.wi)) / a.pdf_w));
        }
        cv = stat_error(&sum) * sqrt(20000) / sum.mean;
        EXPECT(cv < last && cv < 4.0 / sqrt(splits), "%d splits: deviation %.3f of the mean",
               splits, cv);
        last = cv;
    }
    sky_clear(&s);
}

const TestCase test_partition[] = {
    { "sums", sums, false }, { "tiles", tiles, false }, { "draws", draws, false },
    { "back", back, false }, { "together", together, false }, { "unseen", unseen, false },
    { "converges", converges, false }, { NULL, NULL, false }
};
