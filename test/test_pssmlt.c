/* test_pssmlt.c -- numbers that move, and the pictures that chains of them make.
 *
 * Numbers     Steps have the lengths that they should, both ways, and come back around the end.
 * Balance     A toy that asks for more or fewer numbers, by what the first ones say, and whose
 *             light is known: chains that begin as light is spread stay so, and go from one part
 *             of the space to another as often as back.
 * Pictures    Against `path`, in every light, through lenses, in fog, in motion, for windows and
 *             wide filters; over `light` where that finds all.
 * Same        Windows of crops, layers by length. */
#include "base/mem.h"
#include "sampling/primary.h"
#include "test/chi2.h"
#include "test/lamp_help.h"

#include <stdio.h>
#include <string.h>

/* ---- numbers ---- */

static Primary *primary_new(PrimaryKernel *k)
{
    Primary *p = MEM_NEW(Primary);

    REQUIRE(p, "memory");
    primary_kernel(k, 1 / 1024.0f, 1 / 64.0f);
    p->kernel = k;
    return p;
}

/* Log-lengths of steps are even, signs too, and the number that wraps around is the same number. */
static void steps(void)
{
    enum { BINS = 32, N = 200000 };
    double expected[2 * BINS];
    uint64_t count[2 * BINS] = { 0 };
    PrimaryKernel kernel;
    Primary *p = primary_new(&kernel);
    bool wrapped = false;

    for (int i = 0; i < 2 * BINS; i++)
        expected[i] = N / (2.0 * BINS);
    for (uint64_t k = 0; k < N; k++) {
        Sampler s = primary_sampler(p);
        float u, v, d;
        primary_propose(p, rng_seed(k).key, true);
        u = k % 2 ? sample_1d(&s, 5) : sample_2d(&s, 6).y;
        primary_accept(p);
        primary_propose(p, rng_seed(~k).key, false);
        v = k % 2 ? sample_1d(&s, 5) : sample_2d(&s, 6).y;
        EXPECT(u >= 0 && u < 1 && v >= 0 && v < 1, "%g, %g", u, v);
        wrapped |= fabsf(v - u) > 0.5f;
        d = v - u - floorf(v - u + 0.5f);
        if (fabsf(d) < 1 / 1024.0f || fabsf(d) > 1 / 64.0f) {
            EXPECT(false, "a step of %g", d);
            continue;
        }
        count[(int)f_min(BINS - 1, m_log2(fabsf(d) * 1024) / 4 * BINS) + (d < 0 ? BINS : 0)]++;
    }
    EXPECT(wrapped, "no number wraps around");
    EXPECT(chi2_counts(expected, count, 2 * BINS) >= CHI2_P_MIN, "steps are not even: p = %g",
           chi2_counts(expected, count, 2 * BINS));
    mem_free(p);
}

/* One answer to each question, in any order, also beyond what is kept; another stream asks others;
 * what was not asked for of the present sample is fresh. */
static void answers(void)
{
    enum { MANY = PRIMARY_MOST + 300 };
    static float first[MANY];
    PrimaryKernel kernel;
    Primary *p = primary_new(&kernel);
    Sampler s = primary_sampler(p), other = s;
    int near = 0, far = 0;

    sampler_pixel(&other, UINT32_MAX, 0);
    sampler_start(&other, 7);
    primary_propose(p, 1, true);
    for (uint32_t k = 0; k < MANY; k++)
        first[k] = sample_1d(&s, k);
    EXPECT(sample_1d(&other, 3) != first[3], "another stream has the same number");
    for (uint32_t k = MANY; k-- > 0;)
        EXPECT(sample_1d(&s, k) == first[k], "another answer to %lu", (unsigned long)k);
    primary_accept(p);
    primary_propose(p, 2, false);
    for (uint32_t k = 0; k < MANY; k++) {
        float d = fabsf(sample_1d(&s, k) - first[k]);
        bool is_near = d < 1 / 63.0f || d > 1 - 1 / 63.0f;
        near += k < PRIMARY_MOST && is_near;
        far += k >= PRIMARY_MOST && !is_near;
    }
    EXPECT(near == PRIMARY_MOST, "%d numbers are near", near);
    EXPECT(far > 270, "%d of 300 are fresh", far);
    mem_free(p);
}

/* ---- balance ---- */

/* Light of a sample that asks for two numbers, and for up to three more by what the first says. */
enum { CELLS = 24 };
static double toy(Sampler *s, int *cell)
{
    float x = sample_1d(s, DECISION(DECIDE_LOBE, 0));
    V2 y = sample_2d(s, DECISION(DECIDE_DIRECTION, 0));
    int more = (int)(x * 4);
    double f = 0.5 + (double)y.x + 2.0 * y.y * y.y;

    for (int k = 0; k < more; k++)
        f *= 0.25 + 2.5 * (double)sample_1d(s, DECISION(DECIDE_ROULETTE, k));
    *cell = more * 6 + (int)(y.x * 3) * 2 + (int)(y.y * 2);
    return y.x < 0.1f ? 0 : f;
}

/* Integral of the toy over a cell, per mean of it. */
static double toy_share(int cell)
{
    double mean = 0, own = 0;

    for (int k = 0; k < CELLS; k++) {
        double a = d_max(k / 2 % 3 / 3.0, 0.1), b = (k / 2 % 3 + 1) / 3.0, c = k % 2 / 2.0, f = 1;
        for (int i = 0; i < k / 6; i++)
            f *= 0.25 + 2.5 / 2;
        f *= 0.5 * ((b - a) * 0.5 + (b * b - a * a) / 2) +
             (b - a) * 2 / 3 * ((c + 0.5) * (c + 0.5) * (c + 0.5) - c * c * c);
        mean += f;
        own = k == cell ? f : own;
    }
    return own / mean;
}

/* A state as light is spread: by rejection. */
static double toy_start(Primary *p, Rng *r, int *cell)
{
    const double most = 3.5 * 2.75 * 2.75 * 2.75;

    for (;;) {
        Sampler s = primary_sampler(p);
        double f;
        primary_propose(p, rng_bits(r), true);
        f = toy(&s, cell);
        if (rng_unit(r) * most < f) {
            primary_accept(p);
            return f;
        }
    }
}

static void toy_step(Primary *p, Rng *r, double *f, int *cell)
{
    Sampler s = primary_sampler(p);
    int to;
    double g;

    primary_propose(p, rng_bits(r), rng_unit(r) < 0.2f);
    g = toy(&s, &to);
    if (rng_unit(r) * *f < g) {
        primary_accept(p);
        *f = g;
        *cell = to;
    }
}

static void balance(void)
{
    enum { N = 60000, STEPS = 6 };
    static uint64_t from[CELLS][CELLS];
    double expected[CELLS], statistic = 0, p;
    uint64_t ended[CELLS] = { 0 };
    PrimaryKernel kernel;
    Primary *v = primary_new(&kernel);
    int dof = 0;

    primary_kernel(&kernel, 1 / 16.0f, 0.5f);           /* large ones, so that cells are left */
    for (uint64_t k = 0; k < N; k++) {
        Rng r = rng_seed(k);
        int at, first;
        double f = toy_start(v, &r, &at);
        first = at;
        toy_step(v, &r, &f, &at);
        from[first][at]++;
        for (int i = 1; i < STEPS; i++)
            toy_step(v, &r, &f, &at);
        ended[at]++;
    }
    for (int i = 0; i < CELLS; i++)
        for (int j = 0; j < i; j++) {
            double there = (double)from[i][j], back = (double)from[j][i];
            if (there + back >= 20) {
                statistic += (there - back) * (there - back) / (there + back);
                dof++;
            }
        }
    p = chi2_tail(statistic, dof);
    EXPECT(dof > 60 && p >= CHI2_P_MIN, "there is not as often as back: %d pairs, p = %g", dof, p);
    for (int i = 0; i < CELLS; i++)
        expected[i] = N * toy_share(i);
    p = chi2_counts(expected, ended, CELLS);
    EXPECT(p >= CHI2_P_MIN, "chains drift: p = %g", p);
    mem_free(v);
}

/* ---- pictures ---- */

static void compare(Lab *l, const char *method, const char *truth, uint32_t spp, uint32_t more,
                    double delta, const char *what)
{
    Series a, b;

    series_render(l, &a, method, 32, spp, 5);
    series_render(l, &b, truth, 32, more, 6);
    series_expect_same(&a, &b, delta, what);
    series_clear(&a);
    series_clear(&b);
}

static const char PATH[] = "path:maxdepth=4,roulette=2";
#define FEW "bootstrap=2000,chains=20,maxdepth=4,roulette=2"

/* Ways of having samples. The third misses what deltas show; none is seen here. */
static const char *const ways[] = {
    "pssmlt:over=path,direct=0," FEW, "pssmlt:" FEW, "pssmlt:over=light,direct=0," FEW,
    "pssmlt:techniques=one,direct=0," FEW, "pssmlt:over=path," FEW, "pssmlt:techniques=one," FEW
};
enum { WAYS = sizeof ways / sizeof *ways };

static const char *const worlds[] = { "quad", "ball", "point", "spot", "distant", "infinite",
                                      "picture", "glass" };
enum { WORLDS = sizeof worlds / sizeof *worlds };

static void any_lamp(Lab *l, int world)
{
    lab_init(l);
    if (world < WORLDS - 1)
        lamp_add(l, worlds[world]);
    lamp_things(l);
    if (world == WORLDS - 1) {          /* and its caustic, by a lamp of some size */
        lab_sphere(l, v3(1, -1.5f, 0.7f), 0.5f, lab_material(l, "dielectric", ""), false);
        lab_shine(l, lab_disk(l, v3(-2, -1, 4.5f), v3(0.5f, 0, -0.8f), 1.5f, 0,
                              lab_material(l, "diffuse", "reflectance=0")), "L=3/2/1");
    }
    lab_camera(l, v3(0.5f, -7, 3), v3(0, 0, 1), 45, world % 2 ? "" :
               "lensradius=0.1,focaldistance=6");
    lab_build(l);
}

static void lamps(void)
{
    for (int i = 0; i < WORLDS - 1; i++) {
        Lab l;
        any_lamp(&l, i);
        compare(&l, ways[i % WAYS], PATH, i % WAYS == 3 ? 64 : 16, 8, 0.15, worlds[i]);
        lab_clear(&l);
    }
}

/* Sixteen times the steps, as everywhere under --long, and every way in every world. */
static void all_lamps(void)
{
    char what[200];

    for (int i = 0; i < WORLDS; i++) {
        Series truth;
        Lab l;
        any_lamp(&l, i);
        series_render(&l, &truth, PATH, 32, i == WORLDS - 1 ? 64 : 16, 6);
        for (int k = 0; k < WAYS; k++) {
            Series s;
            if (i == WORLDS - 1 && k == 2)
                continue;
            snprintf(what, sizeof what, "%s, %s", worlds[i], ways[k]);
            series_render(&l, &s, ways[k], 32, k == 3 ? 64 : 16, 5);
            series_expect_same(&s, &truth, i == WORLDS - 1 ? 0.4 : i == 1 ? 0.2 : 0.15, what);
            series_clear(&s);
        }
        series_clear(&truth);
        lab_clear(&l);
    }
}

static void any_scene(Lab *l)
{
    lab_init(l);
    lamp_add(l, "quad");
    lamp_add(l, "point");
    lamp_things(l);
    lab_camera(l, v3(0.5f, -7, 3), v3(0, 0, 1), 45, "");
    lab_build(l);
}

/* Mean luminance of a window of the picture, or (aov not NULL) of an extra one. */
static Stat window_mean(Lab *l, const char *method, const char *aov, uint32_t spp, uint64_t seed)
{
    Stat st = { 0, 0, 0, 0, 0 };
    RenderReport report;
    RenderSettings s;
    Image im;

    REQUIRE(image_init(&im, 5, 4), "memory");
    picture_settings(l, &s, method, 32, 32, spp);
    memcpy(s.crop, (uint32_t[4]){ 0, 14, 5, 18 }, sizeof s.crop);
    s.naovs = aov != NULL;
    REQUIRE(!aov || aov_parse(&s.aovs[0], aov), "%s", aov);
    for (int run = 0; run < 24; run++) {
        Film film;
        double sum = 0;
        s.seed = seed + (uint64_t)run;
        picture_render(l, &s, &film, &report);
        film_picture(&film, s.naovs, &im);
        for (int i = 0; i < 20; i++)
            sum += rgb_lum(im.pixels[i]) / 20;
        stat_add_block(&st, sum, 1, 0);
        film_clear(&film);
    }
    image_clear(&im);
    return st;
}

/* A window at the picture's border, with filters that look beyond it, and with none. */
static void windows(void)
{
    static const char *const filters_of[] = { "", "@@mitchell:xwidth=3", "@@gaussian" };
    char method[200];
    Lab l;

    any_scene(&l);
    for (int k = 0; k < 3; k++) {
        Stat a, b;
        snprintf(method, sizeof method, "pssmlt:direct=%d," FEW "%s", k == 1, filters_of[k]);
        a = window_mean(&l, method, NULL, 400, 100);
        snprintf(method, sizeof method, "path:maxdepth=4,roulette=2%s", filters_of[k]);
        b = window_mean(&l, method, NULL, 200, 200);
        stat_expect_same(&a, &b, 0.2, filters_of[k]);
    }
    lab_clear(&l);
}

/* Luminances of a picture's SIDE x SIDE pixels. */
enum { SIDE = 3 };

static void add_pictures(Lab *l, const char *method, uint32_t spp, uint64_t seed,
                         Stat pixel[SIDE * SIDE])
{
    memset(pixel, 0, SIDE * SIDE * sizeof *pixel);
    for (uint64_t run = 0; run < 40; run++) {
        RenderSettings s;
        RenderReport report;
        Film film;
        Image im;
        REQUIRE(image_init(&im, SIDE, SIDE), "memory");
        picture_settings(l, &s, method, SIDE, SIDE, spp);
        s.seed = seed + run;
        picture_render(l, &s, &film, &report);
        film_picture(&film, 0, &im);
        for (int i = 0; i < SIDE * SIDE; i++)
            stat_add_block(&pixel[i], rgb_lum(im.pixels[i]), 1, 0);
        film_clear(&film);
        image_clear(&im);
    }
}

/* A single chain, whose large steps go to nine cells in turn, so that its past tells much of what
 * would come next: it must not show. */
static void few_cells(void)
{
    Stat chain[SIDE * SIDE], path[SIDE * SIDE];
    char what[40];
    Lab l;

    any_scene(&l);
    add_pictures(&l, "pssmlt:over=path,direct=0,chains=1,maxdepth=4,roulette=2", 4000, 700, chain);
    add_pictures(&l, PATH, 4000, 800, path);
    for (int i = 0; i < SIDE * SIDE; i++) {
        snprintf(what, sizeof what, "pixel %d of nine", i);
        stat_expect_same(&chain[i], &path[i], 0.12, what);
    }
    lab_clear(&l);
}

/* Pictures by length and by strategy add up to the whole, for any number of threads. */
static void parts_of(Lab *l, const char *method)
{
    enum { AOVS = 9 };
    static const char *const asked[AOVS] = {
        "strategy:implicit=a.pfm", "strategy:explicit=b.pfm", "strategy:lens=c.pfm",
        "strategy:connect=i.pfm", "length:1=d.pfm", "length:2=e.pfm", "length:3=f.pfm",
        "length:4=g.pfm", "length:5=h.pfm"
    };
    RenderSettings s;
    RenderReport report;
    Film one, three;
    Image part[AOVS + 1];

    picture_settings(l, &s, method, 24, 20, 3);
    for (int k = 0; k < AOVS; k++)
        REQUIRE(aov_parse(&s.aovs[k], asked[k]), "%s", asked[k]);
    s.naovs = AOVS;
    picture_render(l, &s, &one, &report);
    s.threads = 3;
    picture_render(l, &s, &three, &report);
    EXPECT(films_equal(&one, &three), "%s: threads change the picture", method);
    for (int k = 0; k <= AOVS; k++) {
        REQUIRE(image_init(&part[k], 24, 20), "memory");
        film_picture(&one, k, &part[k]);
    }
    for (int i = 0; i < 24 * 20; i++) {
        float all = part[0].pixels[i].g, strategies = 0, lengths = 0;
        for (int k = 1; k <= AOVS; k++)
            *(k <= 4 ? &strategies : &lengths) += part[k].pixels[i].g;
        EXPECT(fabsf(all - strategies) <= 1e-5f * all && fabsf(all - lengths) <= 1e-5f * all,
               "%s: pixel %d: %g, by strategy %g, by length %g", method, i, (double)all,
               (double)strategies, (double)lengths);
    }
    for (int k = 0; k <= AOVS; k++)
        image_clear(&part[k]);
    film_clear(&one);
    film_clear(&three);
}

static void parts(void)
{
    Lab l;

    any_scene(&l);
    parts_of(&l, "pssmlt:direct=0," FEW);
    parts_of(&l, "pssmlt:over=path," FEW);
    parts_of(&l, "pssmlt:over=light,direct=0," FEW "@@gaussian");
    parts_of(&l, "pssmlt:over=bdpt," FEW);
    lab_clear(&l);
}

/* Each part is what it is of `path`. */
static void parts_alone(void)
{
    static const char *const asked[] = { "length:2=a.pfm", "length:3=a.pfm",
                                        "strategy:explicit=a.pfm" };
    Lab l;

    any_scene(&l);
    for (int k = 0; k < 3; k++) {
        Stat a = window_mean(&l, k ? "pssmlt:over=path,direct=0," FEW : "pssmlt:" FEW, asked[k],
                             100, 300);
        Stat b = window_mean(&l, PATH, asked[k], 100, 400);
        stat_expect_same(&a, &b, 0.4, asked[k]);
    }
    lab_clear(&l);
}

/* Layers or none, the picture is the same but for rounding. */
static void tallies(void)
{
    Lab l;

    any_scene(&l);
    for (int k = 0; k < 2; k++) {
        RenderSettings s;
        RenderReport report;
        Image im[2];
        picture_settings(&l, &s, k ? "pssmlt:over=path,direct=0," FEW : "pssmlt:direct=0," FEW, 24,
                         20, 3);
        REQUIRE(aov_parse(&s.aovs[0], "length:3=x.pfm"), "length:3");
        for (s.naovs = 0; s.naovs < 2; s.naovs++) {
            Film f;
            picture_render(&l, &s, &f, &report);
            REQUIRE(image_init(&im[s.naovs], 24, 20), "memory");
            film_picture(&f, 0, &im[s.naovs]);
            film_clear(&f);
        }
        for (int i = 0; i < 24 * 20; i++) {
            float a = im[0].pixels[i].g, b = im[1].pixels[i].g;
            EXPECT(fabsf(a - b) <= 1e-4f * a + 1e-6f, "pixel %d: %g, with layers %g", i, (double)a,
                   (double)b);
        }
        image_clear(&im[0]);
        image_clear(&im[1]);
    }
    lab_clear(&l);
}

/* ---- input ---- */

static void refused(void)
{
    Lab l;

    messages_quiet(true);
    any_scene(&l);
    EXPECT(lab_opens(&l, "pssmlt:over=ao") && lab_opens(&l, "pssmlt:over=light"), "single samples");
    EXPECT(!lab_opens(&l, "pssmlt:over=pssmlt") && !lab_opens(&l, "pssmlt:over=sppm") &&
           !lab_opens(&l, "pssmlt:over=photonmap") &&
           !lab_opens(&l, "pssmlt:over=path,techniques=one"), "more than single samples");
    EXPECT(!lab_opens(&l, "pssmlt:over=paht") && !lab_opens(&l, "pssmlt:least=0.1,largest=0.01"),
           "no such thing");
    lab_clear(&l);
}

/* What does not tell its light apart by length has all of it in the chains. */
static void biased(void)
{
    Stat a, b;
    Lab l;

    any_scene(&l);
    a = window_mean(&l, "pssmlt:over=ao," FEW, NULL, 100, 500);
    b = window_mean(&l, "ao", NULL, 100, 600);
    stat_expect_same(&a, &b, 0.1, "ao");
    lab_clear(&l);
}

/* No light at all is black, and told once; what is rarely found is found, though no sample to start
 * with had any of it. */
static void dark(void)
{
    RenderSettings s;
    RenderReport report;
    unsigned before;
    Image im;
    Film f;
    Lab l;

    messages_quiet(true);
    lab_init(&l);
    lab_quad(&l, v3(-3, -3, 0), v3(6, 0, 0), v3(0, 6, 0), lab_material(&l, "diffuse", ""));
    lab_shine(&l, lab_quad(&l, v3(0, 0, 9), v3(0, 0.2f, 0), v3(0.2f, 0, 0),
                           lab_material(&l, "diffuse", "reflectance=0")), "L=1");
    lab_camera(&l, v3(0, -7, 4.5f), v3(0, 0, 4.5f), 120, "");
    lab_build(&l);
    REQUIRE(image_init(&im, 16, 16), "memory");
    for (int k = 0; k < 2; k++) {
        double sum = 0;
        before = warnings_count();
        picture_settings(&l, &s, k ? "pssmlt:maxdepth=0,direct=0,chains=2,bootstrap=2"
                                   : "pssmlt:maxdepth=0,chains=2,bootstrap=2", 16, 16, 2000);
        picture_render(&l, &s, &f, &report);
        EXPECT(warnings_count() == before + 1, "%u warnings", warnings_count() - before);
        film_picture(&f, 0, &im);
        for (int i = 0; i < 256; i++)
            sum += im.pixels[i].g;
        EXPECT(sum > 0, "nothing is found");
        film_clear(&f);
    }
    image_clear(&im);
    lab_clear(&l);
}

const TestCase test_pssmlt[] = {
    { "steps", steps, false },
    { "answers", answers, false },
    { "balance", balance, false },
    { "lamps", lamps, false },
    { "all_lamps", all_lamps, true },
    { "few_cells", few_cells, false },
    { "windows", windows, false },
    { "parts", parts, false },
    { "parts_alone", parts_alone, false },
    { "tallies", tallies, false },
    { "biased", biased, false },
    { "refused", refused, false },
    { "dark", dark, false },
    { NULL, NULL, false }
};
