/* test_state.c -- renders that stop and go on another day.
 *
 * A render is kept at moments of which there are as many as pixels in all its passes, ends there,
 * and goes on from its file in a render that knows nothing else. However often it stops, and with
 * however many threads it goes on: in the end the film has the bits of one that never stopped. */
#include "base/mem.h"
#include "base/random.h"
#include "render/merge.h"
#include "test/pictures.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { W = 18, H = 3, STOPS = 5 };      /* two tiles, of different sizes */
enum { POLICY_H = 17 };                 /* and four */

/* A sky with something in it, a lamp, glass, something that moves. */
static Rgb sky(V3 w) { return w.z > 0.6f && w.x > 0.2f ? rgb(9, 8, 6) : rgb_all(0.3f); }

static void small_scene(Lab *l)
{
    uint32_t grey;

    lab_init(l);
    grey = lab_material(l, "diffuse", "reflectance=0.7/0.5/0.3");
    lab_quad(l, v3(-3, -3, 0), v3(6, 0, 0), v3(0, 6, 0), grey);
    lab_sphere(l, v3(0, 0, 0.8f), 0.8f, lab_material(l, "coateddiffuse", ""), false);
    lab_sphere(l, v3(1.2f, -1, 0.4f), 0.4f, lab_material(l, "dielectric", ""), false);
    lab_shine(l, lab_quad(l, v3(-1, -1, 3), v3(0, 2, 0), v3(2, 0, 0), grey), "L=5/4/3");
    lab_sky(l, 16, 8, sky, NULL);
    lab_camera(l, v3(0, -5, 2), v3(0, 0, 0.5f), 40, "lensradius=0.05,focaldistance=5");
    lab_build(l);
}

static const char *path_of(const char *name)
{
    static char path[2][300];
    char *p = path[name[0] == 'b'];
    snprintf(p, sizeof path[0], "%s/%s", test_folder(), name);
    return p;
}

/* ---- stopping ---- */

typedef struct {
    const char *path;
    volatile sig_atomic_t stop;
    long moments, at;           /* at the at-th the state is written, and no more is rendered */
    bool kept;
} Stopper;

static void keep(void *ctx, const Job *job, const Film *f, const RenderReport *r, bool last)
{
    Stopper *s = ctx;

    (void)f, (void)r;
    s->moments += !last;
    if (!last && s->moments == s->at) {
        REQUIRE(state_write(job, s->path), "the state is not written");
        s->kept = true;
        s->stop = 1;
    }
}

/* Up to moment number at, which may not come; true: it came, and the state is in the file. */
static bool render_to(Lab *l, const RenderSettings *settings, const char *from, Stopper *stopper,
                      Film *film)
{
    RenderKeeper keeper = { stopper, 1e-9, keep };
    RenderSettings s = *settings;
    RenderReport report;

    stopper->stop = 0;
    stopper->moments = 0;
    stopper->kept = false;
    s.keeper = &keeper;
    s.stop = &stopper->stop;
    s.resume = from;
    s.max_file = 1 << 30;
    picture_render(l, &s, film, &report);
    EXPECT(report.interrupted == stopper->kept, "it ended otherwise");
    return stopper->kept;
}

/* The whole of it in STOPS + 1 days. */
static void expect_goes_on(Lab *l, RenderSettings *s, const char *what)
{
    Stopper stopper = { path_of("a.part"), 0, 0, -1, false };
    Rng rng = rng_seed(7);
    RenderReport report;
    Film whole, film;
    long moments;

    picture_render(l, s, &whole, &report);
    render_to(l, s, NULL, &stopper, &film);
    moments = stopper.moments;
    EXPECT(moments > 2 * STOPS, "%s: %ld moments", what, moments);
    EXPECT(films_equal(&whole, &film), "%s: who is kept renders something else", what);
    film_clear(&film);
    for (int day = 0; day <= STOPS; day++) {
        bool more;
        stopper.at = 1 + (long)rng_below(&rng, (uint32_t)(2 * moments / STOPS));
        s->threads = day % 2 ? 2 : 1;
        more = render_to(l, s, day ? path_of("a.part") : NULL, &stopper, &film);
        if (day == STOPS && more) {
            film_clear(&film);
            stopper.at = -1;
            more = render_to(l, s, path_of("a.part"), &stopper, &film);
        }
        if (!more) {
            EXPECT(films_equal(&whole, &film), "%s: after %d days another picture", what, day + 1);
            EXPECT(film_error(&whole) == film_error(&film), "%s: another error", what);
            film_clear(&film);
            break;
        }
        film_clear(&film);
    }
    film_clear(&whole);
}

/* With less to do before the first sample, which is done again on each day. */
static const char *quick(const char *name)
{
    return !strcmp(name, "photonmap") ? "photonmap:photons=2000,caustics=500,gather=2"
         : !strcmp(name, "irradiancecache") ? "irradiancecache:rays=64"
         : !strcmp(name, "pssmlt") ? "pssmlt:chains=40,bootstrap=80"
         : !strcmp(name, "swarm") ? "swarm:band=1,point=8,lens=8,direction=8"
         : !strcmp(name, "mlt") ? "mlt:chains=40,bootstrap=80,mutations=2"
         : !strcmp(name, "instantradiosity") ? "instantradiosity:lights=16" : name;
}

static void methods(void)
{
    static const char *const more[] = {
        "direct:strategy=triple", "direct:strategy=triple,lazy=true",
        "direct:strategy=light,lights=ward,occlusion=points",
        "direct:strategy=cut", "irradiancecache:overture=false,rays=64",
        "pssmlt:direct=false,over=path,chains=3",
        "mlt:direct=false,chains=3,newpath=0.1", "erpt:even=median,repeats=3,length=10",
        "sppm:photons=5000",
        "sppm:glossy=follow,k=8", "ppm:samples=2", "path@halton", "light@stratified",
        "photonmap:view=direct,strategy=triple,photons=2000,caustics=500,gather=2",
        "swarm:passes=3,bounces=2",
    };
    RenderSettings s;
    Lab l;

    small_scene(&l);
    for (int k = 0; integrators[k]; k++) {
        if (integrators[k]->unkept)
            continue;
        picture_settings(&l, &s, quick(integrators[k]->info.name), W, H, 8);
        expect_goes_on(&l, &s, integrators[k]->info.name);
    }
    for (size_t k = 0; k < sizeof more / sizeof *more; k++) {
        picture_settings(&l, &s, more[k], W, H, 8);
        expect_goes_on(&l, &s, more[k]);
    }
    lab_clear(&l);
}

static void set_policy(Lab *l, RenderSettings *s, const char *text)
{
    s->adaptive = kind_from_text(adaptives, "policy", text, &s->adaptive_opts, &l->arena);
    REQUIRE(s->adaptive, "%s", text);
}

static void policies(void)
{
    static const struct { const char *text; double error; uint32_t spp; } of[] = {
        { "neighbours", 0, 16 }, { "neighbours:min=4", 0.2, 64 }, { "variable:pilot=50", 0, 16 },
        { "variable:pilot=50,rerender=true", 0, 16 }, { "variable:min=2,pilot=20", 0.3, 0 },
        { "own:min=4", 0.5, 64 }, { "none:min=4", 0.2, 0 },
    };
    RenderSettings s;
    Lab l;

    small_scene(&l);
    for (size_t k = 0; k < sizeof of / sizeof *of; k++) {
        picture_settings(&l, &s, "path", W, POLICY_H, of[k].spp);
        set_policy(&l, &s, of[k].text);
        s.error = of[k].error;
        expect_goes_on(&l, &s, of[k].text);
    }
    lab_clear(&l);
}

/* ---- files that are refused ---- */

static bool resumes(Lab *l, const RenderSettings *settings, const char *path)
{
    RenderSettings s = *settings;
    RenderReport report;
    Film film;
    bool ok;

    s.resume = path;
    s.max_file = 1 << 30;
    messages_quiet(true);
    fflush(stderr);
    ok = render(l->scene, &s, &film, &report);
    film_clear(&film);
    return ok;
}

/* Another render does not go on from the state; one that differs in what does not matter does. */
static void other_renders(void)
{
    Stopper stopper = { path_of("a.part"), 0, 0, 100, false };
    RenderSettings s, t;
    Film film;
    Lab l;

    small_scene(&l);
    picture_settings(&l, &s, "path", W, H, 8);
    REQUIRE(render_to(&l, &s, NULL, &stopper, &film), "no state");
    film_clear(&film);
    t = s; t.threads = 3; t.spp = 40;
    EXPECT(resumes(&l, &t, path_of("a.part")), "more samples, more threads");
    t = s; t.seed = 1;
    EXPECT(!resumes(&l, &t, path_of("a.part")), "another seed");
    t = s; t.w = W - 1; t.crop[2] = W - 1;
    EXPECT(!resumes(&l, &t, path_of("a.part")), "another size");
    t = s; t.crop[0] = 1;
    EXPECT(!resumes(&l, &t, path_of("a.part")), "another window");
    t = s; t.scene_digest = 1;
    EXPECT(!resumes(&l, &t, path_of("a.part")), "another scene");
    t = s; t.shards = 2;
    EXPECT(!resumes(&l, &t, path_of("a.part")), "a share");
    t = s; set_policy(&l, &t, "neighbours");
    EXPECT(!resumes(&l, &t, path_of("a.part")), "a policy");
    picture_settings(&l, &t, "path:maxdepth=3", W, H, 8);
    EXPECT(!resumes(&l, &t, path_of("a.part")), "other options");
    picture_settings(&l, &t, "path@random", W, H, 8);
    EXPECT(!resumes(&l, &t, path_of("a.part")), "another sampler");
    picture_settings(&l, &t, "path@@triangle", W, H, 8);
    EXPECT(!resumes(&l, &t, path_of("a.part")), "another filter");
    picture_settings(&l, &s, "path@stratified", W, H, 16);
    REQUIRE(render_to(&l, &s, NULL, &stopper, &film), "no state");
    film_clear(&film);
    t = s; t.spp = 64;
    EXPECT(!resumes(&l, &t, path_of("a.part")), "other samples of a sampler that plans");
    EXPECT(resumes(&l, &s, path_of("a.part")), "the same");
    lab_clear(&l);
}

/* Whether a sampler plans, as it says of itself and as its numbers tell. */
static void plans(void)
{
    for (int k = 0; samplers[k]; k++) {
        uint32_t few = 16, many = 64;
        bool differ = false;
        Sampler a, b;
        Opts o;
        messages_quiet(true);
        opts_default(&o, samplers[k]->info.options);
        REQUIRE(sampler_init(&a, samplers[k], &o, 1, &few) &&
                sampler_init(&b, samplers[k], &o, 1, &many), "%s", samplers[k]->info.name);
        sampler_pixel(&a, 3, 4);
        sampler_pixel(&b, 3, 4);
        for (uint32_t i = 0; i < 16; i++)
            for (int d = 0; d < DECIDE_KINDS; d++) {
                V2 u, v;
                sampler_start(&a, i);
                sampler_start(&b, i);
                u = sample_2d(&a, (Decision)d);
                v = sample_2d(&b, (Decision)d);
                differ = differ || u.x != v.x || u.y != v.y ||
                         sample_1d(&a, (Decision)d) != sample_1d(&b, (Decision)d);
            }
        EXPECT(differ == samplers[k]->plans, "%s: plans %d, but differs %d",
               samplers[k]->info.name, samplers[k]->plans, differ);
        sampler_clear(&a);
        sampler_clear(&b);
    }
}

/* ---- broken files ---- */

static char *read_all(const char *path, size_t *n)
{
    FileBytes f;
    char *copy;

    REQUIRE(file_read(path, 1 << 30, &f), "%s", path);
    copy = malloc(f.size + 8);
    REQUIRE(copy, "memory");
    memcpy(copy, f.bytes, f.size);
    *n = f.size;
    file_clear(&f);
    return copy;
}

static void seal(char *bytes, size_t n)
{
    uint64_t sum = digest(DIGEST_NOTHING, bytes, n - 8);
    for (int k = 0; k < 8; k++)
        bytes[n - 8 + (size_t)k] = (char)(sum >> 8 * k);
}

/* Bytes that differ, ends that are missing: refused. With a digest that is right again whatever
 * comes of it is in order: a refusal, or a picture. */
static void broken(void)
{
    static const char *const of[] = { "path", "sppm:k=8", "irradiancecache:overture=false,rays=16",
                                      "light", "swarm:passes=16,point=4,lens=4,direction=4" };
    Stopper stopper = { path_of("a.part"), 0, 0, 70, false };
    Rng rng = rng_seed(3);
    RenderSettings s;
    Film film;
    Lab l;

    small_scene(&l);
    for (size_t m = 0; m < sizeof of / sizeof *of; m++) {
        char *good, *bad;
        size_t n, kept = 0;
        picture_settings(&l, &s, of[m], 5, 4, 8);
        if (m == 0)
            set_policy(&l, &s, "neighbours");
        REQUIRE(render_to(&l, &s, NULL, &stopper, &film), "%s: no state", of[m]);
        film_clear(&film);
        good = read_all(path_of("a.part"), &n);
        bad = malloc(n + 8);
        REQUIRE(bad && freopen("/dev/null", "w", stderr), "no room");
        for (int i = 0; i < (test_is_long() ? 20000 : 200); i++) {
            size_t at = rng_below(&rng, (uint32_t)n), size = i % 4 ? n : at;
            memcpy(bad, good, n);
            bad[at] = (char)(bad[at] + 1 + (char)rng_below(&rng, 255));
            REQUIRE(file_write(path_of("b.part"), bad, size), "b.part");
            EXPECT(!resumes(&l, &s, path_of("b.part")), "%s: byte %lu of %lu", of[m],
                   (unsigned long)at, (unsigned long)n);
            if (size < 8 || (i % 2 && at < 400))
                continue;
            s.spp = 8;
            seal(bad, size);
            REQUIRE(file_write(path_of("b.part"), bad, size), "b.part");
            s.seconds = 0.05;   /* a count may have become large */
            kept += resumes(&l, &s, path_of("b.part"));
            s.seconds = 0;
        }
        EXPECT(kept > 10, "%s: only %lu of the sealed ones were taken", of[m],
               (unsigned long)kept);
        free(good);
        free(bad);
    }
    lab_clear(&l);
}

/* What no map can have learned is refused, or who draws by it may never find a place. The last
 * float of a band amid a pass is one of a map. */
static void unlearned(void)
{
    const float of[] = { INFINITY - INFINITY, -1.0f, INFINITY, 1e38f, 2.0f };
    Stopper stopper = { path_of("a.part"), 0, 0, 7, false };
    RenderSettings s;
    Film film;
    char *bytes;
    size_t n;
    Lab l;

    small_scene(&l);
    picture_settings(&l, &s, "swarm:direction=4", 5, 4, 8);
    REQUIRE(render_to(&l, &s, NULL, &stopper, &film), "no state");
    film_clear(&film);
    bytes = read_all(path_of("a.part"), &n);
    REQUIRE(freopen("/dev/null", "w", stderr), "no room");
    for (size_t k = 0; k < sizeof of / sizeof *of; k++) {
        for (int i = 0; i < 4; i++)
            bytes[n - 12 + (size_t)i] = (char)(bits_of_float(of[k]) >> 8 * i);
        seal(bytes, n);
        REQUIRE(file_write(path_of("b.part"), bytes, n), "b.part");
        EXPECT(resumes(&l, &s, path_of("b.part")) == (of[k] == 2.0f), "%g", (double)of[k]);
    }
    free(bytes);
    lab_clear(&l);
}

/* ---- shares ---- */

static void keep_last(void *ctx, const Job *job, const Film *f, const RenderReport *r, bool last)
{
    (void)f, (void)r;
    REQUIRE(last && state_write(job, ctx), "the share is not written");
}

/* Share i of n, from 0 on, in a file of its own. */
static const char *share(Lab *l, const RenderSettings *settings, uint32_t i, uint32_t n)
{
    static char path[8][300];
    RenderKeeper keeper = { path[i], 0, keep_last };
    RenderSettings s = *settings;
    RenderReport report;
    Film film;

    snprintf(path[i], sizeof path[i], "%s/%lu.part", test_folder(), (unsigned long)i);
    s.keeper = &keeper;
    s.shard = i;
    s.shards = n;
    picture_render(l, &s, &film, &report);
    film_clear(&film);
    return path[i];
}

static const ReadLimits limits = READ_LIMITS_DEFAULT;

/* In an order that the number of shares makes. */
static void add_shares(Lab *l, const RenderSettings *s, uint32_t n, Merge *m)
{
    const char *path[8];

    for (uint32_t i = 0; i < n; i++)
        path[i] = share(l, s, i, n);
    for (uint32_t i = 0; i < n; i++)
        REQUIRE(merge_add(m, path[(3 * i + 1) % n], &limits), "share %lu", (unsigned long)i);
    EXPECT(!merge_missing(m), "shares are missing");
}

/* Shares add up to the render that was shared, bit by bit; those of methods whose passes or pixels
 * build on each other to as many samples, none of which two shares have in common. */
static void shares(void)
{
    for (int k = 0; integrators[k]; k++) {
        const IntegratorKind *kind = integrators[k];
        bool own = kind->walk || (kind->save && (kind->anew || !kind->radiance));
        RenderSettings s;
        RenderReport report;
        Merge m = { 0 };
        Film whole;
        Lab l;
        if (kind->unkept)
            continue;
        small_scene(&l);
        picture_settings(&l, &s, quick(kind->info.name), W, H, 13);
        picture_render(&l, &s, &whole, &report);
        add_shares(&l, &s, k % 2 ? 8 : 5, &m);
        if (!own)
            EXPECT(films_equal(&whole, &m.film), "%s: the sum is another", kind->info.name);
        else
            EXPECT(!whole.splats ? !memcmp(whole.counts, m.film.counts,
                                           W * H * sizeof *whole.counts)
                                 : whole.splats->shots == m.film.splats->shots,
                   "%s: another number of samples", kind->info.name);
        EXPECT(m.samples == (double)report.samples, "%s: %g samples", kind->info.name, m.samples);
        merge_clear(&m);
        film_clear(&whole);
        lab_clear(&l);
    }
}

/* Where it is not known how many samples there will be, no two shares have one in common, whatever
 * they come to; a share that is made twice, or of another number of shares, is refused, as is one
 * of another render. */
static void shares_apart(void)
{
    RenderSettings s, t;
    Merge m = { 0 };
    Lab l;
    const char *part;

    small_scene(&l);
    picture_settings(&l, &s, "path", W, H, 0);
    s.error = 1;
    REQUIRE(merge_add(&m, share(&l, &s, 0, 3), &limits), "the first");
    for (uint32_t i = 1; i < 3; i++) {
        Film before = m.film;
        Merge one = { 0 };
        part = share(&l, &s, i, 3);
        EXPECT(merge_missing(&m) == 3 - i, "%lu shares are missing",
               (unsigned long)merge_missing(&m));
        REQUIRE(merge_add(&one, part, &limits) && merge_add(&m, part, &limits), "share");
        EXPECT(memcmp(one.film.sums, before.sums, W * H * 3 * sizeof *before.sums),
               "two shares are one");
        EXPECT(!merge_add(&m, part, &limits), "the same again");
        merge_clear(&one);
    }
    EXPECT(!merge_add(&m, share(&l, &s, 2, 4), &limits), "another number of shares");
    t = s; t.seed = 5;
    EXPECT(merge_add(&m, share(&l, &t, 2, 4), &limits) && merge_missing(&m) == 3, "another seed");
    picture_settings(&l, &t, "path:maxdepth=3", W, H, 0);
    t.error = 1;
    EXPECT(!merge_add(&m, share(&l, &t, 1, 4), &limits), "another method");
    merge_clear(&m);
    lab_clear(&l);
}

const TestCase test_state[] = {
    { "shares", shares, false },
    { "shares_apart", shares_apart, false },
    { "methods", methods, false },
    { "policies", policies, false },
    { "other_renders", other_renders, false },
    { "plans", plans, false },
    { "unlearned", unlearned, false },
    { "broken", broken, false },
    { NULL, NULL, false }
};
