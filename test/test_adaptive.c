/* test_adaptive.c -- pixels with counts of their own: that the mean stays what it is where a policy
 * says so, that the error at which they stop is the error they have, that least and most are kept,
 * and that threads do not matter.
 *
 * Light is made by rule here, where its mean is known: rare spikes, as erratum 5.7 has them, and
 * half-planes, on which patterns in strata do better than independent numbers. */
#include "base/mem.h"
#include "base/random.h"
#include "test/cli_help.h"
#include "test/image_help.h"
#include "test/pictures.h"

#include <string.h>

/* ---- light made by rule ---- */

static Integrator *open_rule(const Scene *s, const Opts *o)
{
    Integrator *it = MEM_NEW(Integrator);
    (void)o;
    if (it)
        it->scene = s;
    return it;
}
static void close_rule(Integrator *it) { mem_free(it); }

/* 2 % spikes of 50 over 0.5: mean 1.49. Two decisions have a share in it, so that strata of either
 * do not help. */
static const double SPIKES = 0.02 * 50 + 0.98 * 0.5;
static Rgb spikes(const Integrator *it, const Ray *r, Tracer *t)
{
    float u = sample_1d(&t->sampler, DECISION(DECIDE_LIGHT, 0)) +
              sample_1d(&t->sampler, DECISION(DECIDE_LOBE, 3));
    (void)it;
    (void)r;
    return rgb_all(u - (u >= 1 ? 1.0f : 0.0f) < 0.02f ? 50.0f : 0.5f);
}

/* A half-plane of the light's square, whose border turns and moves from pixel to pixel; in the
 * lower half of the picture a smooth ramp of a twentieth of the contrast. */
static Rgb edges(const Integrator *it, const Ray *r, Tracer *t)
{
    V2 u = sample_2d(&t->sampler, DECISION(DECIDE_LIGHT_POINT, 0));
    float a = 20 * r->d.x + 13 * r->d.z;
    (void)it;
    if (r->d.z < 0)
        return rgb_all(1 + 0.1f * u.x);
    return rgb_all((u.x - 0.5f) * m_cos(a) + (u.y - 0.5f) * m_sin(a) > 0.2f ? 2.0f : 0.2f);
}

static Rgb even(const Integrator *it, const Ray *r, Tracer *t)
{
    (void)it;
    (void)r;
    t->rays++;
    return rgb_all(0.7f);
}

/* Noise on one side only, which the camera has on the left. */
static Rgb cliff(const Integrator *it, const Ray *r, Tracer *t)
{
    float u = sample_1d(&t->sampler, DECISION(DECIDE_LIGHT, 0));
    (void)it;
    return rgb_all(r->d.x > 0 ? 2 * u : 0.99f + 0.02f * u);
}

static Rgb black(const Integrator *it, const Ray *r, Tracer *t)
{
    (void)it;
    (void)r;
    t->rays++;
    return rgb_all(0);
}

#define RULE(name) static const IntegratorKind name##_kind = {                              \
    .info = { #name, "", "", NULL }, .truth = UNBIASED, .misses = "", .open = open_rule,    \
    .close = close_rule, .radiance = name }
RULE(spikes);
RULE(edges);
RULE(even);
RULE(black);
RULE(cliff);

static void lab_empty(Lab *l)
{
    lab_init(l);
    lab_light(l, "infinite", "L=1", NULL);
    lab_camera(l, v_all(0), v3(0, 1, 0), 60, "");
    lab_build(l);
}

/* policy: "neighbours:min=8", or "" for none at all. */
static void settings(Lab *l, RenderSettings *s, const IntegratorKind *kind, const char *policy,
                     uint32_t w, uint32_t h)
{
    picture_settings(l, s, "", w, h, 0);
    s->integrator = kind;
    opts_default(&s->integrator_opts, NULL);
    s->adaptive = NULL;
    if (*policy) {
        s->adaptive = kind_from_text(adaptives, "policy", policy, &s->adaptive_opts, &l->arena);
        REQUIRE(s->adaptive, "%s", policy);
    }
}

static double film_mean(const Film *f)
{
    double sum = 0;
    Image im;

    REQUIRE(image_init(&im, f->w, f->h), "memory");
    film_picture(f, 0, &im);
    for (size_t i = 0; i < (size_t)f->w * f->h; i++)
        sum += (double)im.pixels[i].g;
    image_clear(&im);
    return sum / ((double)f->w * f->h);
}

static double mean_count(const Film *f)
{
    return (double)film_samples(f) / ((double)f->w * f->h);
}

static void least_most(const Film *f, uint32_t *least, uint32_t *most)
{
    *least = UINT32_MAX;
    *most = 0;
    for (size_t i = 0; i < (size_t)f->w * f->h; i++) {
        *least = f->counts[i] < *least ? f->counts[i] : *least;
        *most = f->counts[i] > *most ? f->counts[i] : *most;
    }
}

/* ---- the mean ---- */

typedef struct {
    const char *policy, *sampler;
    uint32_t w, h, spp;
    double error;
    int runs;
    double low;                 /* the mean comes out so much too low; 0: not at all */
} Fair;

/* Means of the spikes' pictures, run by run. */
static Stat spikes_mean(Lab *l, const Fair *c)
{
    int runs = test_is_long() ? 16 * c->runs : c->runs;
    Stat st = { 0, 0, 0, 0, 0 };
    RenderReport report;
    RenderSettings s;
    Film film;

    settings(l, &s, &spikes_kind, c->policy, c->w, c->h);
    s.sampler = kind_find(samplers, c->sampler);
    opts_default(&s.sampler_opts, s.sampler->info.options);
    s.spp = c->spp;
    s.error = c->error;
    for (int i = 0; i < runs; i++) {
        s.seed = (uint64_t)i + 1;
        picture_render(l, &s, &film, &report);
        stat_add_block(&st, film_mean(&film), (double)c->w * c->h, 0);
        film_clear(&film);
    }
    st.n = runs;
    return st;
}

/* Where nothing may be off, the mean is right to 5.6 standard errors, which are small enough to see
 * 4 % of it (in small pictures, where counts depend on little, 10 %). */
static void fair(void)
{
    static const Fair cases[] = {
        { "neighbours:min=8", "random", 24, 24, 0, 0.8, 120, 0 },
        { "neighbours:min=8", "zerotwo", 24, 24, 0, 0.8, 120, 0 },
        { "neighbours", "random", 24, 24, 48, 0, 60, 0 },
        { "neighbours", "zerotwo", 24, 24, 48, 0, 60, 0 },
        { "neighbours", "random", 24, 24, 40, 0.1, 60, 0 },
        { "neighbours:min=4", "random", 8, 8, 0, 0.9, 1000, 0 },
        { "neighbours:min=4", "random", 1, 1, 0, 0.9, 45000, 0 },
        { "neighbours:min=4", "random", 2, 1, 0, 0.9, 20000, 0 },
        { "variable:pilot=64", "random", 24, 24, 24, 0, 120, 0 },
        { "variable:pilot=64", "zerotwo", 24, 24, 24, 0, 120, 0 },
        { "none", "random", 24, 24, 0, 0.8, 120, 0 },
    };
    Lab l;

    lab_empty(&l);
    for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
        const Fair *c = &cases[k];
        Stat st = spikes_mean(&l, c);
        double e = sqrt(st.squares / (st.n - 1) / st.n), off = st.mean - SPIKES;
        EXPECT(fabs(off) <= 5.6 * e, "%s, %s, %lux%lu, error %g: mean %.4f, it is %.4f +- %.4f",
               c->policy, c->sampler, (unsigned long)c->w, (unsigned long)c->h, c->error, st.mean,
               SPIKES, e);
        EXPECT(8.7 * e <= (c->w < 24 ? 0.1 : 0.04) * SPIKES, "%s, %s, %lux%lu: +- %.4f, coarse",
               c->policy, c->sampler, (unsigned long)c->w, (unsigned long)c->h, e);
    }
    lab_clear(&l);
}

/* Those that say that they are biased are: by this much of the mean. */
static void unfair(void)
{
    static const Fair cases[] = {
        { "own", "random", 24, 24, 0, 0.5, 40, 0.48 },
        { "variable:rerender=true", "random", 24, 24, 16, 0, 120, 0.28 },
    };
    Lab l;

    lab_empty(&l);
    for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
        const Fair *c = &cases[k];
        Stat st = spikes_mean(&l, c);
        double e = sqrt(st.squares / (st.n - 1) / st.n), low = 1 - st.mean / SPIKES;
        EXPECT(fabs(low - c->low) < 0.1, "%s: %.3f +- %.3f too low, it was %.2f", c->policy, low, e,
               c->low);
    }
    lab_clear(&l);
}

/* ---- the error ---- */

/* Deviation of the pixels of many renders, over the mean; and what each said of itself. */
static double true_error(Lab *l, RenderSettings *s, int runs, double *stated, double *count)
{
    size_t n = (size_t)s->w * s->h;
    double *sum = MEM_ARRAY(double, n * 2), variance = 0, mean = 0;
    RenderReport report;
    Image im;
    Film film;

    REQUIRE(sum && image_init(&im, s->w, s->h), "memory");
    *stated = *count = 0;
    for (int r = 0; r < runs; r++) {
        s->seed = (uint64_t)r + 1;
        picture_render(l, s, &film, &report);
        film_picture(&film, 0, &im);
        for (size_t i = 0; i < n; i++) {
            double v = rgb_lum(im.pixels[i]);
            sum[2 * i] += v;
            sum[2 * i + 1] += v * v;
        }
        *stated += film_error(&film) / runs;
        *count += mean_count(&film) / runs;
        film_clear(&film);
    }
    for (size_t i = 0; i < n; i++) {
        variance += (sum[2 * i + 1] - sum[2 * i] * sum[2 * i] / runs) / (runs - 1);
        mean += sum[2 * i] / runs;
    }
    image_clear(&im);
    mem_free(sum);
    return sqrt(variance * (double)n) / mean;
}

static const IntegratorKind *const noisy[] = { &edges_kind, &spikes_kind };
static const double wanted[] = { 0.05, 0.5 };

/* What a picture states is what it has, within a fifth, at powers of two and between them. */
static void stated_error(void)
{
    static const uint32_t counts[] = { 16, 32, 64, 100 };
    static const char *const names[] = { "random", "zerotwo" };
    Lab l;

    lab_empty(&l);
    for (int k = 0; k < 2; k++)
        for (int m = 0; m < 2; m++)
            for (size_t c = 0; c < sizeof counts / sizeof *counts; c++) {
                double is, stated, count;
                RenderSettings s;
                settings(&l, &s, noisy[k], "", 32, 32);
                s.sampler = kind_find(samplers, names[m]);
                opts_default(&s.sampler_opts, s.sampler->info.options);
                s.spp = counts[c];
                is = true_error(&l, &s, 24, &stated, &count);
                EXPECT(fabs(stated / is - 1) < 0.2, "%s, %s, %lu samples: states %.4f, has %.4f",
                       noisy[k]->info.name, names[m], (unsigned long)counts[c], stated, is);
            }
    lab_clear(&l);
}

/* Where they stop is near the error that was asked for: within a fifth of it, or below by a third
 * where a pattern does better than was assumed. All pixels alike stop at
 * the next power of two or multiple of 64 only. And pixels that differ need less samples so. */
static void stops(void)
{
    static const char *const names[] = { "random", "zerotwo" };
    Lab l;

    lab_empty(&l);
    for (int k = 0; k < 2; k++)
        for (int m = 0; m < 2; m++) {
            double is, stated, count, alike;
            RenderSettings s;
            settings(&l, &s, noisy[k], "neighbours", 32, 32);
            s.sampler = kind_find(samplers, names[m]);
            opts_default(&s.sampler_opts, s.sampler->info.options);
            s.error = wanted[k];
            is = true_error(&l, &s, 24, &stated, &count);
            EXPECT(is / s.error < 1.2 && is / s.error > (m ? 0.67 : 0.8),
                   "%s, %s: stops at %.4f, not %.4f",
                   noisy[k]->info.name, names[m], is, s.error);
            EXPECT(fabs(stated / is - 1) < 0.2, "%s, %s: states %.4f, has %.4f",
                   noisy[k]->info.name, names[m], stated, is);
            s.adaptive = NULL;
            s.error = 0;
            s.spp = (uint32_t)(count + 0.5);
            alike = true_error(&l, &s, 12, &stated, &count);
            EXPECT(k || is < 0.95 * alike, "%s: %.4f with pixels that differ, %.4f with %.0f "
                   "samples for each", names[m], is, alike, count);
        }
    lab_clear(&l);
}

/* ---- least and most ---- */

static void expect_counts(Lab *l, const IntegratorKind *kind, const char *policy, uint32_t spp,
                          double error, uint32_t least, uint32_t most)
{
    RenderReport report;
    RenderSettings s;
    uint32_t is_least, is_most;
    Film film;

    settings(l, &s, kind, policy, 21, 18);
    s.spp = spp;
    s.error = error;
    picture_render(l, &s, &film, &report);
    least_most(&film, &is_least, &is_most);
    EXPECT(is_least >= least && is_most <= most, "%s, %s, %lu samples, error %g: from %lu to %lu "
           "samples, not %lu to %lu", kind->info.name, policy, (unsigned long)spp, error,
           (unsigned long)is_least, (unsigned long)is_most, (unsigned long)least,
           (unsigned long)most);
    EXPECT(report.samples >= film_samples(&film), "%.0f samples", (double)report.samples);
    film_clear(&film);
}

static void limits(void)
{
    static const char *const all[] = { "neighbours", "variable", "own", "none" };
    Lab l;

    lab_empty(&l);
    for (int k = 0; k < 4; k++) {
        char text[40];
        expect_counts(&l, &even_kind, all[k], 0, 0.01, 16, k == 1 ? 32 : 16);
        expect_counts(&l, &black_kind, all[k], 0, 0.01, 16, k == 1 ? 32 : 16);
        expect_counts(&l, &even_kind, all[k], 3, 0.01, k == 1 ? 2 : 3, 3);
        expect_counts(&l, &spikes_kind, all[k], 1, 0.01, 1, k == 1 ? 2 : 1);
        expect_counts(&l, &spikes_kind, all[k], 100, 0.01, k == 2 ? 16 : 50, 100);
        snprintf(text, sizeof text, "%s:min=%d", all[k], 33);
        expect_counts(&l, &even_kind, text, 0, 0.01, 64, k == 1 ? 128 : 64);
    }
    expect_counts(&l, &even_kind, "neighbours", 32, 0, 16, 32);
    expect_counts(&l, &black_kind, "variable", 32, 0, 16, 32);
    expect_counts(&l, &spikes_kind, "neighbours", 1, 0, 1, 1);
    expect_counts(&l, &spikes_kind, "neighbours", 5, 0, 2, 64);
    lab_clear(&l);
}

/* Without an error the mean is what was asked for. */
static void budget(void)
{
    static const uint32_t counts[] = { 16, 48, 200 };
    Lab l;

    lab_empty(&l);
    for (size_t k = 0; k < 3; k++) {
        RenderReport report;
        RenderSettings s;
        Film film;
        settings(&l, &s, &edges_kind, "neighbours", 40, 33);
        s.spp = counts[k];
        picture_render(&l, &s, &film, &report);
        EXPECT(fabs(mean_count(&film) / counts[k] - 1) < 0.05, "%.2f samples of %lu",
               mean_count(&film), (unsigned long)counts[k]);
        film_clear(&film);
    }
    lab_clear(&l);
}

/* Rows that run one way and rows that run the other lag behind a change alike: on either side of it
 * every second row has as many samples as those between, but for those at the top of bands. */
static void rows(void)
{
    double n[2][2] = { { 0, 0 }, { 0, 0 } };    /* left, right; even, odd */
    RenderReport report;
    RenderSettings s;
    Film film;
    Lab l;

    lab_empty(&l);
    settings(&l, &s, &cliff_kind, "variable", 64, 4 * FILM_TILE);
    s.spp = 64;
    picture_render(&l, &s, &film, &report);
    for (uint32_t y = 0; y < film.h; y++)
        for (uint32_t x = 0; x < 64; x++)
            if (y % FILM_TILE > 1)
                n[x >= 32][y % 2] += film.counts[film_pixel(&film, x, y)];
    for (int side = 0; side < 2; side++)
        EXPECT(fabs(n[side][0] / n[side][1] - 1) < 0.02, "even and odd rows have %.0f and %.0f",
               n[side][0], n[side][1]);
    EXPECT(n[0][0] > 1.5 * n[1][0], "the noisy side, the left one, has no more samples");
    film_clear(&film);
    lab_clear(&l);
}

/* ---- threads, windows, time ---- */

static void threads(void)
{
    static const char *const policies[] = {
        "neighbours", "variable:pilot=100", "variable:pilot=100,rerender=true", "own", "none"
    };
    Lab l;

    lab_empty(&l);
    for (size_t k = 0; k < 5; k++)
        for (int budget = 0; budget < 3; budget++) {
            RenderReport report;
            RenderSettings s;
            Film one, many;
            settings(&l, &s, &edges_kind, policies[k], 51, 40);
            memcpy(s.crop, (uint32_t[4]){ 3, 2, budget == 2 ? 8 : 50, budget == 2 ? 6 : 40 },
                   sizeof s.crop);
            s.spp = budget ? 0 : 20;
            s.error = budget || k == 3 ? 0.06 : 0;
            picture_render(&l, &s, &one, &report);
            s.threads = 5;
            picture_render(&l, &s, &many, &report);
            EXPECT(films_equal(&one, &many), "%s: 5 threads give another picture", policies[k]);
            EXPECT(film_error(&one) == film_error(&many), "another error");
            film_clear(&one);
            film_clear(&many);
        }
    lab_clear(&l);
}

/* Time ends it with a whole picture, whatever the policy was at. */
static void time_budget(void)
{
    static const char *const policies[] = { "neighbours", "variable:pilot=20", "own" };
    Lab l;

    lab_empty(&l);
    for (int k = 0; k < 3; k++)
        for (int error = k == 2; error < 2; error++) {
            RenderReport report;
            RenderSettings s;
            uint32_t least, most;
            Film film;
            settings(&l, &s, &spikes_kind, policies[k], 20, 20);
            s.seconds = 0.1;
            s.error = error ? 1e-6 : 0;
            picture_render(&l, &s, &film, &report);
            least_most(&film, &least, &most);
            EXPECT(least >= 1 && !report.interrupted, "%s: %lu samples in a pixel", policies[k],
                   (unsigned long)least);
            film_clear(&film);
        }
    lab_clear(&l);
}

/* ---- passes over all pixels ---- */

static uint64_t units_all(Integrator *it, const Film *f, uint32_t pass, int phase)
{
    (void)it;
    (void)pass;
    (void)phase;
    return film_ntiles(f);
}

static void run_all(Integrator *it, Film *f, uint32_t pass, int phase, uint64_t unit, Tracer *t)
{
    uint32_t x0, y0, x1, y1;
    (void)it;
    (void)phase;
    film_tile(f, (uint32_t)unit, &x0, &y0, &x1, &y1);
    for (uint32_t y = y0; y < y1; y++)
        for (uint32_t x = x0; x < x1; x++) {
            Rgb c;
            sampler_pixel(&t->sampler, x, y);
            sampler_start(&t->sampler, pass);
            c = rgb_all(sample_1d(&t->sampler, DECISION(DECIDE_LIGHT, 0)));
            film_add(f, x, y, pass, &c);
        }
}

static const IntegratorKind passes_kind = {
    .info = { "passes", "", "", NULL }, .truth = UNBIASED, .misses = "", .open = open_rule,
    .close = close_rule, .phases = 1, .units = units_all, .run = run_all
};

/* An integrator without rays of pixels stops as a whole. */
static void whole(void)
{
    RenderReport report;
    RenderSettings s;
    Film a, b;
    Lab l;

    lab_empty(&l);
    settings(&l, &s, &passes_kind, "neighbours", 20, 20);
    s.error = 0.1;
    picture_render(&l, &s, &a, &report);
    settings(&l, &s, &passes_kind, "none", 20, 20);
    s.error = 0.1;
    picture_render(&l, &s, &b, &report);
    EXPECT(films_equal(&a, &b) && film_error(&a) <= 0.1, "%.3f", film_error(&a));
    film_clear(&a);
    film_clear(&b);
    lab_clear(&l);
}

/* So it says, if single pixels were asked for, and if it may; without a word about a policy, or
 * with one for the whole picture, nothing. */
static void passes_warn(void)
{
    static const struct { const char *policy; double error; bool warns; } cases[] = {
        { "neighbours", 0, true }, { "variable:pilot=9", 0, true }, { "own", 0.1, true },
        { "none", 0.1, false }, { NULL, 0.1, false }, { NULL, 0, false }
    };
    Arena arena = { 0 };

    for (size_t k = 0; k < sizeof cases / sizeof cases[0]; k++)
        for (int strict = 0; strict < 2; strict++) {
            unsigned before = warnings_count();
            RenderSettings s;
            RenderRequest q;
            bool ok;
            memset(&s, 0, sizeof s);
            memset(&q, 0, sizeof q);
            s.integrator = &passes_kind;
            q.adaptive = cases[k].policy;
            q.error = cases[k].error;
            warnings_fatal(strict);
            ok = settings_adaptive(&s, &q, &arena);
            warnings_fatal(false);
            EXPECT(ok == !(strict && cases[k].warns), "policy %d: %d", (int)k, ok);
            EXPECT(!ok || s.adaptive == kind_find(adaptives, "none"), "policy %d: not the whole "
                   "picture", (int)k);
            EXPECT(strict || warnings_count() - before == cases[k].warns, "policy %d: %u warnings",
                   (int)k, warnings_count() - before);
            err_reset();
        }
    arena_clear(&arena);
}

/* ---- the command line ---- */

static void options(void)
{
    double sum = 0;
    Image im;

    cli_scene();
    CLI_FAILS(2, NULL, "tiny.pbrt --quiet -o a.pfm --error 0");
    CLI_FAILS(2, NULL, "tiny.pbrt --quiet -o a.pfm --error -1");
    CLI_FAILS(2, NULL, "tiny.pbrt --quiet -o a.pfm --error nan");
    CLI_FAILS(2, NULL, "tiny.pbrt --quiet -o a.pfm --adaptive neighbors");
    CLI_FAILS(2, NULL, "tiny.pbrt --quiet -o a.pfm --adaptive neighbours:min=0");
    CLI_FAILS(2, NULL, "tiny.pbrt --quiet -o a.pfm --adaptive variable:pilot=-3");
    CLI_FAILS(2, "--adaptive own stops pixels at an error; expected --error X",
              "tiny.pbrt --quiet -o a.pfm --adaptive own");
    CLI_WORKS("tiny.pbrt --quiet -o a.pfm --error 0.3");
    CLI_WORKS("tiny.pbrt --quiet -o b.pfm --error 0.3 --adaptive neighbours --threads 3");
    EXPECT(cli_same_file("a.pfm", "b.pfm"), "the default policy is another");
    CLI_WORKS("tiny.pbrt --quiet -o a.pfm --adaptive variable --spp 24 --aov samples=n.pfm");
    REQUIRE(image_read(&im, cli_path("n.pfm"), IMAGE_PIXELS_DEFAULT), "n.pfm");
    for (size_t i = 0; i < (size_t)im.w * im.h; i++) {
        sum += (double)im.pixels[i].g / ((double)im.w * im.h);
        EXPECT(im.pixels[i].g >= 12, "%g samples", (double)im.pixels[i].g);
    }
    EXPECT(sum > 16 && sum < 40, "%g samples on average", sum);
    image_clear(&im);
}

const TestCase test_adaptive[] = {
    { "fair", fair, false },
    { "unfair", unfair, false },
    { "stated_error", stated_error, false },
    { "stops", stops, false },
    { "limits", limits, false },
    { "budget", budget, false },
    { "rows", rows, false },
    { "threads", threads, false },
    { "time_budget", time_budget, false },
    { "whole", whole, false },
    { "passes_warn", passes_warn, false },
    { "options", options, false },
    { NULL, NULL, false }
};
