/* test_driver.c -- what a picture depends on: scene, settings, seed; not threads, not the window.
 *
 * Films are compared bit by bit. Integrators made for the purpose count what the driver does: that
 * all units of a phase end before the next begins, that each is run once, that budgets and
 * interrupts end a render with a whole picture. */
#include "base/mem.h"
#include "geometry/generate.h"
#include "test/pictures.h"

#include <string.h>

enum { W = 45, H = 35 };                /* no multiple of a tile */
static const int THREADS[] = { 1, 2, 3, 7, 16 };
enum { COUNTS = sizeof THREADS / sizeof *THREADS };

static void small_scene(Lab *l)
{
    uint32_t grey;
    Mesh m = { 0 };

    lab_init(l);
    grey = lab_material(l, "diffuse", "reflectance=0.7/0.5/0.3");
    lab_quad(l, v3(-3, -3, 0), v3(6, 0, 0), v3(0, 6, 0), grey);
    REQUIRE(mesh_blob(&m, 3), "blob");
    mesh_move(&m, 0.6f, v3(0, 0, 0.7f));
    lab_mesh(l, &m, lab_material(l, "coateddiffuse", ""), false);
    lab_sphere(l, v3(1, -1, 0.4f), 0.4f, lab_material(l, "dielectric", ""), false);
    lab_shine(l, lab_quad(l, v3(-1, -1, 3), v3(0, 2, 0), v3(2, 0, 0), grey), "L=5/4/3");
    lab_light(l, "infinite", "L=0.2/0.3/0.4", NULL);
    lab_camera(l, v3(0, -5, 2), v3(0, 0, 0.5f), 40, "lensradius=0.05,focaldistance=5");
    lab_build(l);
}

/* ---- same bytes ---- */

static void expect_same_for_threads(Lab *l, RenderSettings *s, const char *what)
{
    RenderReport report;
    Film first, film;

    s->threads = 1;
    picture_render(l, s, &first, &report);
    for (int k = 1; k < COUNTS; k++) {
        s->threads = THREADS[k];
        picture_render(l, s, &film, &report);
        EXPECT(films_equal(&first, &film), "%s: %d threads give another picture", what, THREADS[k]);
        film_clear(&film);
    }
    film_clear(&first);
}

static void threads(void)
{
    static const char *const methods[] = { "path", "ao" };
    Lab l;

    small_scene(&l);
    for (int m = 0; m < 2; m++)
        for (int k = 0; samplers[k]; k++) {
            RenderSettings s;
            picture_settings(&l, &s, "", W, H, 5);
            s.integrator = kind_find(integrators, methods[m]);
            opts_default(&s.integrator_opts, s.integrator->info.options);
            s.sampler = samplers[k];
            opts_default(&s.sampler_opts, s.sampler->info.options);
            REQUIRE(aov_parse(&s.aovs[0], "normal=a.pfm"), "normal");
            REQUIRE(aov_parse(&s.aovs[1], "length:3=b.pfm"), "length");
            s.naovs = 2;
            expect_same_for_threads(&l, &s, s.sampler->info.name);
        }
    lab_clear(&l);
}

/* Another seed is another picture; the same one the same. */
static void seeds(void)
{
    RenderSettings s;
    RenderReport report;
    Film a, b, c;
    Lab l;

    small_scene(&l);
    picture_settings(&l, &s, "", W, H, 2);
    picture_render(&l, &s, &a, &report);
    picture_render(&l, &s, &b, &report);
    s.seed = 1;
    picture_render(&l, &s, &c, &report);
    EXPECT(films_equal(&a, &b), "the same seed gives another picture");
    EXPECT(!films_equal(&a, &c), "another seed gives the same picture");
    EXPECT(report.samples == (uint64_t)W * H * 2 && report.rays > report.samples,
           "%.0f samples, %.0f rays", (double)report.samples, (double)report.rays);
    film_clear(&a);
    film_clear(&b);
    film_clear(&c);
    lab_clear(&l);
}

static bool same_pixel(const Film *all, const Film *part, uint32_t x, uint32_t y)
{
    size_t i = film_pixel(all, x, y), k = film_pixel(part, x, y);
    size_t n = (size_t)all->w * all->h, m = (size_t)part->w * part->h;

    for (int layer = 0; layer < all->layers; layer++)
        if (memcmp(all->sums + (n * (size_t)layer + i) * 3,
                   part->sums + (m * (size_t)layer + k) * 3, 3 * sizeof *all->sums))
            return false;
    return all->counts[i] == part->counts[k];
}

/* A window is that part of the whole picture, whatever its corners. */
static void crop(void)
{
    static const uint32_t windows[][4] = { { 0, 0, W, H }, { 7, 3, 8, 4 }, { 10, 5, 40, 33 },
                                           { 0, 20, W, 21 }, { 44, 0, 45, H }, { 16, 16, 32, 32 } };
    Lab l;

    small_scene(&l);
    for (int f = 0; filters[f]; f++) {
        RenderSettings s;
        RenderReport report;
        Film all, part;
        picture_settings(&l, &s, "", W, H, 3);
        s.filter = filters[f];
        opts_default(&s.filter_opts, s.filter->info.options);
        REQUIRE(aov_parse(&s.aovs[0], "depth=a.pfm"), "aov");
        s.naovs = 1;
        picture_render(&l, &s, &all, &report);
        for (size_t k = 0; k < sizeof windows / sizeof *windows; k++) {
            bool same = true;
            memcpy(s.crop, windows[k], sizeof s.crop);
            s.threads = 1 + (int)(k % 3);
            picture_render(&l, &s, &part, &report);
            for (uint32_t y = part.y0; y < part.y1; y++)
                for (uint32_t x = part.x0; x < part.x1; x++)
                    same = same && same_pixel(&all, &part, x, y);
            EXPECT(same, "%s: window %d is not that part of the picture", s.filter->info.name,
                   (int)k);
            film_clear(&part);
        }
        film_clear(&all);
    }
    lab_clear(&l);
}

/* Where samples fall: a bright half-plane ends at 3.25 pixels from the left, or from the top, of 8.
 * A box filter shows a quarter of pixel 3; a tent over two pixels, centred in 3.5, sees left of
 * 3.25 the share (1 - 0.25)^2 / 2 = 9/32 of itself, in 2.5 1 - 1/32, in 4.5 0. */
static void places(void)
{
    static const double box[8] = { 1, 1, 1, 0.25, 0, 0, 0, 0 };
    static const double tent[8] = { 1, 1, 1 - 1 / 32.0, 9 / 32.0, 0, 0, 0, 0 };

    for (int k = 0; k < 4; k++) {
        const double *truth = k / 2 ? tent : box;
        float edge = 2 * 3.25f / 8 - 1;         /* on the screen of 90 degrees at distance 1 */
        RenderSettings s;
        RenderReport report;
        uint32_t shape;
        Image im;
        Film film;
        Lab l;

        lab_init(&l);                   /* the camera looks along y; z is up, x to the left */
        shape = k % 2 ? lab_quad(&l, v3(-9, 1, -edge), v3(18, 0, 0), v3(0, 0, 9), 0)
                      : lab_quad(&l, v3(-edge, 1, -9), v3(9, 0, 0), v3(0, 0, 18), 0);
        lab_shine(&l, shape, "L=1,twosided");
        lab_camera(&l, v_all(0), v3(0, 1, 0), 90, "");
        lab_build(&l);
        picture_settings(&l, &s, "maxdepth=0", 8, 8, 1024);
        s.filter = kind_find(filters, k / 2 ? "triangle" : "box");
        opts_default(&s.filter_opts, s.filter->info.options);
        picture_render(&l, &s, &film, &report);
        REQUIRE(image_init(&im, 8, 8), "memory");
        film_picture(&film, 0, &im);
        for (uint32_t i = 0; i < 8; i++) {      /* of 1024 samples in strata: off by 2^-10 of one */
            double is = (double)(k % 2 ? image_at(&im, 2, i) : image_at(&im, i, 2))->g;
            EXPECT(fabs(is - truth[i]) <= 0.0015, "%s, pixel %d: %.4f, it is %.4f",
                   s.filter->info.name, (int)i, is, truth[i]);
        }
        image_clear(&im);
        film_clear(&film);
        lab_clear(&l);
    }
}

/* ---- passes of phases of units ---- */

enum { FIRST_UNITS = 37, TILES_MOST = 64 };

/* Each unit writes its own entries only. */
typedef struct {
    Integrator base;
    float    value[FIRST_UNITS];
    uint32_t first_runs[FIRST_UNITS], second_runs[TILES_MOST];  /* passes done */
    bool     early[FIRST_UNITS + TILES_MOST];   /* a unit that began before it should */
    int      spins;
} Toy;

static Toy *toy;                        /* of this case's process, to look at afterwards */

static Integrator *open_toy(const Scene *s, const Opts *o)
{
    (void)o;
    toy->base.scene = s;
    return &toy->base;
}

static void close_toy(Integrator *it) { (void)it; }

static uint64_t units_toy(Integrator *it, const Film *f, uint32_t pass, int phase)
{
    (void)it;
    (void)pass;
    return phase == 0 ? FIRST_UNITS : film_ntiles(f);
}

/* A while of work that the compiler cannot drop, longer for some units than for others. */
static void dawdle(Toy *t, uint64_t unit)
{
    volatile double x = 1;
    for (uint64_t i = 0; i < (unit * 7919 % 13) * (uint64_t)t->spins; i++)
        x = x * 1.0000001;
}

static void first_phase(Toy *t, const Film *f, uint32_t pass, uint64_t unit, Tracer *tr)
{
    for (uint32_t k = 0; k < film_ntiles(f); k++)
        t->early[unit] = t->early[unit] || t->second_runs[k] != pass;
    dawdle(t, unit);
    sampler_pixel(&tr->sampler, (uint32_t)unit, pass);
    sampler_start(&tr->sampler, 0);
    t->value[unit] = sample_1d(&tr->sampler, DECISION(DECIDE_LIGHT, 0));
    t->first_runs[unit]++;
}

static void second_phase(Toy *t, Film *f, uint32_t pass, uint64_t unit)
{
    uint32_t x0, y0, x1, y1;
    bool *early = &t->early[FIRST_UNITS + unit];
    float sum = 0;

    for (int k = 0; k < FIRST_UNITS; k++) {
        *early = *early || t->first_runs[k] != pass + 1;
        sum += t->value[k];
    }
    dawdle(t, unit);
    film_tile(f, (uint32_t)unit, &x0, &y0, &x1, &y1);
    for (uint32_t y = y0; y < y1; y++)
        for (uint32_t x = x0; x < x1; x++) {
            Rgb c = rgb(sum, t->value[(x + y) % FIRST_UNITS], 1);
            film_add(f, x, y, pass, &c);
        }
    t->second_runs[unit]++;
}

static void run_toy(Integrator *it, Film *f, uint32_t pass, int phase, uint64_t unit, Tracer *t)
{
    if (phase == 0)
        first_phase((Toy *)it, f, pass, unit, t);
    else
        second_phase((Toy *)it, f, pass, unit);
}

static const IntegratorKind toy_kind = {
    .info = { "toy", "", "two phases", NULL }, .truth = UNBIASED, .misses = "", .open = open_toy,
    .close = close_toy, .phases = 2, .units = units_toy, .run = run_toy
};

static void toy_settings(Lab *l, RenderSettings *s, const IntegratorKind *kind)
{
    picture_settings(l, s, "", W, H, 8);
    s->integrator = kind;
    opts_default(&s->integrator_opts, NULL);
}

static void phases(void)
{
    RenderSettings s;
    RenderReport report;
    Film first, film;
    Lab l;

    small_scene(&l);
    toy_settings(&l, &s, &toy_kind);
    memset(&first, 0, sizeof first);
    for (int k = 0; k < COUNTS; k++) {
        uint32_t passes;
        Toy t;
        memset(&t, 0, sizeof t);
        toy = &t;
        t.spins = 3000;
        s.threads = THREADS[k];
        picture_render(&l, &s, &film, &report);
        passes = t.first_runs[0];
        EXPECT(passes >= 2, "%lu passes", (unsigned long)passes);
        for (int i = 0; i < FIRST_UNITS + TILES_MOST; i++)
            EXPECT(!t.early[i], "%d threads: unit %d began before the phase before had ended",
                   THREADS[k], i);
        for (int i = 0; i < FIRST_UNITS; i++)
            EXPECT(t.first_runs[i] == passes, "%d threads: unit %d of phase 0 ran %lu times in %lu "
                   "passes", THREADS[k], i, (unsigned long)t.first_runs[i], (unsigned long)passes);
        for (uint32_t i = 0; i < film_ntiles(&film); i++)
            EXPECT(t.second_runs[i] == passes, "%d threads: unit %lu of phase 1 ran %lu times",
                   THREADS[k], (unsigned long)i, (unsigned long)t.second_runs[i]);
        if (k == 0)
            first = film;
        else {
            EXPECT(films_equal(&first, &film), "%d threads give another picture", THREADS[k]);
            film_clear(&film);
        }
    }
    film_clear(&first);
    lab_clear(&l);
}

/* ---- budgets and interrupts ---- */

static volatile sig_atomic_t stop;
static long calls, stop_at;             /* of one thread */

static Integrator *open_counter(const Scene *s, const Opts *o)
{
    Integrator *it = MEM_NEW(Integrator);
    (void)o;
    if (it)
        it->scene = s;
    return it;
}
static void close_counter(Integrator *it) { mem_free(it); }

/* A uniform number; asks to stop in call number stop_at. */
static Rgb count_call(const Integrator *it, const Ray *r, Tracer *t)
{
    (void)it;
    (void)r;
    if (++calls == stop_at)
        stop = 1;
    t->rays++;
    return rgb_all(sample_1d(&t->sampler, DECISION(DECIDE_LIGHT, 0)));
}

static const IntegratorKind counter_kind = {
    .info = { "counter", "", "counts", NULL }, .truth = UNBIASED, .misses = "",
    .open = open_counter, .close = close_counter, .radiance = count_call
};

/* An interrupt in the first pass, a later one, or before all: the unit in hand ends, no more. */
static void interrupt(void)
{
    static const long at[] = { 1, 100, W * H + 1, 3 * W * H };
    RenderReport report;
    RenderSettings s;
    Film film;
    Lab l;

    small_scene(&l);
    toy_settings(&l, &s, &counter_kind);
    s.stop = &stop;
    for (size_t k = 0; k < sizeof at / sizeof *at; k++) {
        stop = 0;
        calls = 0;
        stop_at = at[k];
        picture_render(&l, &s, &film, &report);
        EXPECT(report.interrupted && report.samples == (uint64_t)calls,
               "interrupt in sample %ld: %.0f samples of %ld calls", at[k], (double)report.samples,
               calls);
        EXPECT(calls >= at[k] && calls < at[k] + FILM_TILE * FILM_TILE * 4,
               "interrupt in sample %ld ended at %ld", at[k], calls);
        film_clear(&film);
    }
    s.threads = 7;                      /* the flag is up already: one unit a thread at most */
    calls = stop_at = 0;
    s.integrator = kind_find(integrators, "path");
    opts_default(&s.integrator_opts, s.integrator->info.options);
    stop = 1;
    picture_render(&l, &s, &film, &report);
    EXPECT(report.interrupted && report.samples <= 7 * FILM_TILE * FILM_TILE,
           "%.0f samples after an interrupt", (double)report.samples);
    film_clear(&film);
    lab_clear(&l);
}

/* What a watch saw. */
enum { LOOKS = 5 };
static const uint32_t look_spp[LOOKS] = { 1, 3, 4, 7, 20 };
typedef struct { Film film[LOOKS]; int n, end_at; } Watched;

static bool keep_film(void *ctx, const Film *film, const RenderReport *so_far)
{
    Watched *w = ctx;
    size_t n = (size_t)film->w * film->h;
    Film *copy = &w->film[w->n];
    const uint32_t crop[4] = { film->x0, film->y0, film->x1, film->y1 };

    REQUIRE(w->n < LOOKS && film_init(copy, film->full_w, film->full_h, crop, 1), "a look");
    memcpy(copy->sums, film->sums, 3 * n * sizeof *copy->sums);
    memcpy(copy->counts, film->counts, n * sizeof *copy->counts);
    EXPECT(so_far->spp == look_spp[w->n] && so_far->samples == look_spp[w->n] * n &&
           so_far->rays > 0, "look %d after %g samples", w->n, so_far->spp);
    return ++w->n != w->end_at;
}

/* A picture that is looked at is that of a render which ends there; so is the last one. */
static void watch(void)
{
    RenderReport report;
    RenderSettings s;
    Film film, alone;
    Watched seen = { .n = 0 };
    RenderWatch w = { &seen, keep_film, look_spp, NULL, LOOKS, 0, 0 };
    Lab l;

    small_scene(&l);
    picture_settings(&l, &s, "", W, H, 21);
    s.threads = 2;
    s.watch = &w;
    picture_render(&l, &s, &film, &report);
    EXPECT(seen.n == LOOKS && report.spp == 21, "%d looks, %g samples", seen.n, report.spp);
    s.watch = NULL;
    for (int k = 0; k <= LOOKS; k++) {
        s.spp = k < LOOKS ? look_spp[k] : 21;
        picture_render(&l, &s, &alone, &report);
        EXPECT(films_equal(k < LOOKS ? &seen.film[k] : &film, &alone), "%d samples", (int)s.spp);
        film_clear(&alone);
        if (k < LOOKS)
            film_clear(&seen.film[k]);
    }
    film_clear(&film);
    seen.n = 0;                         /* who looks can end it */
    seen.end_at = 2;
    s.watch = &w;
    picture_render(&l, &s, &film, &report);
    EXPECT(seen.n == 2 && report.spp == 3 && !report.interrupted, "ended at %g", report.spp);
    film_clear(&seen.film[0]);
    film_clear(&seen.film[1]);
    film_clear(&film);
    lab_clear(&l);
}

typedef struct { int n; double last; } Moments;

static bool count_moment(void *ctx, const Film *film, const RenderReport *so_far)
{
    Moments *m = ctx;
    for (size_t i = 0; i < (size_t)film->w * film->h; i++)
        EXPECT(film->counts[i] > 0, "look %d: pixel %d has no sample", m->n, (int)i);
    EXPECT(so_far->seconds > m->last && so_far->cpu_seconds >= 0, "look %d goes back", m->n);
    m->last = so_far->seconds;
    m->n++;
    return true;
}

/* Moments within a pass: units go on where they stopped, so no sample is lost or taken twice. All
 * moments lie before the end, however slow the machine is: the first two come as soon as may be. */
static void watch_clock(void)
{
    static const double seconds[] = { 1e-9, 2e-9, 1e-4, 2e-4, 5e-4, 1e-3, 1e9 };
    RenderReport report;
    RenderSettings s;
    Film film, alone;
    Moments seen = { 0, -1 };
    RenderWatch w = { &seen, count_moment, NULL, seconds, 0, 7, 0 };
    Lab l;

    small_scene(&l);
    picture_settings(&l, &s, "", W, H, 24);
    s.threads = 2;
    picture_render(&l, &s, &alone, &report);
    s.watch = &w;
    picture_render(&l, &s, &film, &report);
    EXPECT(seen.n > 0 && seen.n < 7, "%d looks", seen.n);
    EXPECT(films_equal(&film, &alone), "another picture");
    film_clear(&film);
    film_clear(&alone);
    lab_clear(&l);
}

static bool count_looks(void *ctx, const Film *film, const RenderReport *so_far)
{
    int *n = ctx;

    (void)film;
    (void)so_far;
    ++*n;
    return true;
}

/* Whoever renders, and in whatever phase somebody looks: the picture is the same. */
static void watch_always(void)
{
    static const char *const SOME[] = { "path", "swarm", "irradiancecache", "vcm", "pssmlt", "sppm",
                                        "photonmap:photons=2000", "instantradiosity:paths=20" };
    size_t n = 0;
    Lab l;

    small_scene(&l);
    while (integrators[n])
        n++;
    n = test_is_long() ? n : sizeof SOME / sizeof *SOME;
    for (size_t k = 0; k < n; k++) {
        const char *name = test_is_long() ? integrators[k]->info.name : SOME[k];
        RenderReport report;
        RenderSettings s;
        Film film, alone;
        int looks = 0;
        RenderWatch w = { &looks, count_looks, NULL, NULL, 0, 0, 1e-4 };
        picture_settings(&l, &s, name, 2 * FILM_TILE + 3, FILM_TILE + 5, 4);
        s.threads = 2;
        picture_render(&l, &s, &alone, &report);
        s.watch = &w;
        picture_render(&l, &s, &film, &report);
        EXPECT(looks > 0, "%s: nobody looks", name);
        EXPECT(films_equal(&film, &alone), "%s: another picture", name);
        film_clear(&film);
        film_clear(&alone);
    }
    lab_clear(&l);
}

/* Somebody who has seen enough ends it soon, though the first pass would take years. */
static bool see_once(void *ctx, const Film *film, const RenderReport *so_far)
{
    (void)film;
    (void)so_far;
    return --*(int *)ctx > 0;
}

static void watch_ends(void)
{
    int left = 3;
    RenderWatch w = { &left, see_once, NULL, NULL, 0, 0, 1e-3 };
    RenderReport report;
    RenderSettings s;
    Film film;
    Lab l;

    small_scene(&l);
    picture_settings(&l, &s, "", 1000, 1000, 1 << 20);
    s.watch = &w;
    picture_render(&l, &s, &film, &report);
    EXPECT(!left && report.passes == 0 && !report.interrupted, "%d looks left, %lu passes", left,
           (unsigned long)report.passes);
    film_clear(&film);
    lab_clear(&l);
}

/* An hour of samples ends after the time it was given. */
static void time_budget(void)
{
    RenderReport report;
    RenderSettings s;
    Film film;
    Lab l;

    small_scene(&l);
    toy_settings(&l, &s, &counter_kind);
    s.spp = 0;
    s.seconds = 0.05;
    picture_render(&l, &s, &film, &report);
    EXPECT(!report.interrupted && report.samples > 0, "%.0f samples", (double)report.samples);
    film_clear(&film);
    lab_clear(&l);
}

/* Samples uniform on [0,1): sigma/mu of a mean of n is 1 / sqrt(3 n). */
static void error_budget(void)
{
    RenderReport report;
    RenderSettings s;
    Film film;
    double n, is;
    Lab l;

    small_scene(&l);
    toy_settings(&l, &s, &counter_kind);
    s.sampler = kind_find(samplers, "random");
    s.spp = 64;
    picture_render(&l, &s, &film, &report);
    n = (double)W * H * 64;     /* the estimate's own deviation is about 1 / sqrt(n) of it */
    is = film_error_independent(&film) * sqrt(3.0 * 64);
    EXPECT(fabs(is - 1) < 5.6 / sqrt(n), "error %.4f of what it is", is);
    film_clear(&film);
    s.spp = 0;
    s.error = 0.09;                     /* 41 samples; passes end at powers of two */
    picture_render(&l, &s, &film, &report);
    EXPECT(film_error(&film) <= 0.09 && report.samples == (uint64_t)W * H * 64, "ended at %.4f "
           "with %.0f samples", film_error(&film), (double)report.samples);
    film_clear(&film);
    lab_clear(&l);
}

const TestCase test_driver[] = {
    { "threads", threads, false },
    { "seeds", seeds, false },
    { "crop", crop, false },
    { "places", places, false },
    { "phases", phases, false },
    { "interrupt", interrupt, false },
    { "watch", watch, false },
    { "watch_clock", watch_clock, false },
    { "watch_always", watch_always, false },
    { "watch_ends", watch_ends, false },
    { "time_budget", time_budget, false },
    { "error_budget", error_budget, false },
    { NULL, NULL, false }
};
