/* pictures.c -- renders for the tests. See pictures.h. */
#include "test/pictures.h"

#include "base/mem.h"
#include "test/chi2.h"

#include <stdio.h>
#include <string.h>

void lab_camera(Lab *l, V3 eye, V3 at, float fov, const char *options)
{
    lab_camera_of(l, "perspective", eye, at, fov, options);
}

void lab_camera_of(Lab *l, const char *kind, V3 eye, V3 at, float fov, const char *options)
{
    const CameraKind *k = kind_find(cameras, kind);
    Transform view;
    Making m;
    Opts o;

    memset(&m, 0, sizeof m);
    m.scene = l->scene;
    REQUIRE(xf_look_at(&view, eye, at, v3(0, 0, 1)), "view");
    m.to_world = xf_inverse(&view);
    opts_default(&o, k->info.options);
    REQUIRE(opts_parse(&o, kind, options, &l->arena), "camera %s", options);
    if (!strcmp(kind, "perspective"))
        opt_set_number(&o, "fov", fov);
    l->scene->camera = k->make(&m, &o);
    REQUIRE(l->scene->camera, "camera");
    l->scene->camera->kind = k;
}

/* Ends the text at its first '@' and gives what follows. */
static char *cut_at(char *text)
{
    char *at = text + strcspn(text, "@");

    if (*at)
        *at++ = 0;
    return at;
}

void picture_settings(Lab *l, RenderSettings *s, const char *method, uint32_t w, uint32_t h,
                      uint32_t spp)
{
    char text[400], *sampler, *filter;

    memset(s, 0, sizeof *s);
    snprintf(text, sizeof text, "%s", method);
    sampler = cut_at(text);
    filter = cut_at(sampler);
    s->integrator = lab_method(l, text, &s->integrator_opts);
    s->sampler = kind_from_text(samplers, "sampler", *sampler ? sampler : SAMPLER_DEFAULT,
                                &s->sampler_opts, &l->arena);
    s->filter = kind_from_text(filters, "filter", *filter ? filter : FILTER_DEFAULT,
                               &s->filter_opts, &l->arena);
    REQUIRE(s->sampler && s->filter, "%s", method);
    s->accel = kind_find(accels, ACCEL_DEFAULT);
    opts_default(&s->accel_opts, s->accel->info.options);
    s->w = s->crop[2] = w;
    s->h = s->crop[3] = h;
    s->spp = spp;
    s->threads = 1;
}

void picture_render(Lab *l, const RenderSettings *s, Film *film, RenderReport *report)
{
    messages_quiet(true);
    REQUIRE(render(l->scene, s, film, report), "the render failed");
}

bool films_equal(const Film *a, const Film *b)
{
    size_t n = (size_t)a->w * a->h;
    return a->w == b->w && a->h == b->h && a->layers == b->layers &&
           !memcmp(a->counts, b->counts, n * sizeof *a->counts) &&
           !memcmp(a->sums, b->sums, n * 3 * (size_t)a->layers * sizeof *a->sums) &&
           !a->splats == !b->splats &&
           (!a->splats || (a->splats->shots == b->splats->shots &&
                           !memcmp(a->splats->sums, b->splats->sums,
                                   n * 3 * (size_t)a->layers * sizeof *a->sums)));
}

/* ---- series ---- */

static void add_run(Series *s, int run, const Image *im)
{
    uint32_t across = im->w / TILE;

    for (uint32_t y = 0; y < im->h; y++)
        for (uint32_t x = 0; x < im->w; x++) {
            double v = rgb_lum(*image_at(im, x, y));
            s->tile[(y / TILE * across + x / TILE) * RUNS + (uint32_t)run] += v / (TILE * TILE);
        }
}

void series_render(Lab *l, Series *s, const char *method, uint32_t side, uint32_t spp,
                   uint64_t seed)
{
    RenderSettings settings;
    RenderReport report;
    Image im;
    Film film;

    memset(s, 0, sizeof *s);
    s->tiles = side / TILE * (side / TILE);
    s->tile = MEM_ARRAY(double, (size_t)s->tiles * RUNS);
    REQUIRE(s->tile && image_init(&im, side, side), "memory");
    picture_settings(l, &settings, method, side, side, test_is_long() ? 16 * spp : spp);
    s->tied = settings.integrator->splats || settings.integrator->anew;
    for (int run = 0; run < RUNS; run++) {
        settings.seed = seed * RUNS + (uint64_t)run;
        picture_render(l, &settings, &film, &report);
        film_picture(&film, 0, &im);
        add_run(s, run, &im);
        film_clear(&film);
    }
    image_clear(&im);
}

void series_clear(Series *s)
{
    mem_free(s->tile);
    memset(s, 0, sizeof *s);
}

static Stat tile_stat(const Series *s, uint32_t tile)
{
    Stat st = { 0, 0, 0, 0, 0 };
    for (int i = 0; i < RUNS; i++) /* one is a sixteenth of the sum: no question of tails */
        stat_add_block(&st, s->tile[(size_t)tile * RUNS + (size_t)i], 1, 0);
    return st;
}

/* The mean of the tiles. Where these are independent, their variances add up, and there are enough
 * of them for the normal distribution; else all there is are the runs. */
static Stat whole_stat(const Series *s)
{
    Stat st = { (double)s->tiles * RUNS, 0, 0, 1, 0 };
    double variance = 0;

    if (s->tied) {
        st = (Stat){ 0, 0, 0, 0, 0 };
        for (int run = 0; run < RUNS; run++) {
            double mean = 0;
            for (uint32_t k = 0; k < s->tiles; k++)
                mean += s->tile[(size_t)k * RUNS + (size_t)run] / s->tiles;
            stat_add_block(&st, mean, 1, 0);
        }
        return st;
    }
    for (uint32_t k = 0; k < s->tiles; k++) {
        Stat tile = tile_stat(s, k);
        st.mean += tile.mean / s->tiles;
        variance += stat_error(&tile) * stat_error(&tile);
    }
    st.squares = variance / s->tiles / s->tiles * st.n * (st.n - 1);
    return st;
}

/* p of Welch's t with Satterthwaite's degrees of freedom. */
static double welch(const Stat *a, const Stat *b)
{
    double va = a->squares / (a->n - 1) / a->n, vb = b->squares / (b->n - 1) / b->n, v = va + vb;

    if (!(v > 0))
        return a->mean == b->mean ? 1 : 0;
    return student_tail((a->mean - b->mean) / sqrt(v),
                        v * v / (va * va / (a->n - 1) + vb * vb / (b->n - 1)));
}

void series_expect_same(const Series *a, const Series *b, double delta, const char *what)
{
    enum { BINS = 20 };
    double expected[BINS], least = 1, p, even;
    uint64_t count[BINS] = { 0 };
    Stat whole_a = whole_stat(a), whole_b = whole_stat(b);

    for (uint32_t k = 0; k < a->tiles; k++) {
        Stat sa = tile_stat(a, k), sb = tile_stat(b, k);
        p = welch(&sa, &sb);
        count[p < 1 ? (int)(p * BINS) : BINS - 1]++;
        least = p < least ? p : least;
    }
    for (int k = 0; k < BINS; k++)
        expected[k] = (double)a->tiles / BINS;
    even = chi2_counts(expected, count, BINS);
    EXPECT(least >= CHI2_P_MIN / a->tiles, "%s: the worst tile has p = %.3g", what, least);
    EXPECT(even >= CHI2_P_MIN, "%s: p of the tiles is not uniform, p = %.3g", what, even);
    stat_expect_same(&whole_a, &whole_b, delta, what);
}
