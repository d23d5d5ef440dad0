/* render.c -- the driver. See render.h.
 *
 * Time is cut into passes, passes into phases and these into units that threads take from a queue.
 * Of camera samples a unit is a tile of pixels and a pass some samples of each; integrators say
 * themselves what the units of their own phases are. Order cannot matter: random numbers come from
 * the pixel and the sample's index, and the film's sums are exact. Budgets are looked at after
 * every unit, so an interrupt or a limit of time leaves a whole picture, some of whose tiles have
 * had a pass more than others. */
#include "render/render.h"

#include "base/clock.h"
#include "base/progress.h"
#include "base/work.h"

#include <string.h>

enum { PASS_MOST = 64 };                /* most samples a pixel in one pass */
enum { SAMPLES = -1 };

typedef struct {
    const RenderSettings *settings;
    const Scene *scene;
    Integrator  *integrator;
    Film        *film;
    Filter       filter;
    Canvas       canvas;                /* where splats go, if there are any */
    bool         blurs;                 /* the scene moves while the shutter is open */
    float        time;                  /* else: of all rays */
    Tracer      *tracers;               /* one a worker */
    Tally       *tallies;               /* one a worker; NULL: not wanted */
    Adaptive     adaptive;
    bool         adapts;                /* it says what is done; else all pixels get the same */
    uint32_t     first, count;          /* samples of this pass */
    double       so_far, coming;        /* samples a pixel: before this pass, and in it */
    double       expected;              /* in all, as far as one can tell; 0: not */
    uint32_t     pass;
    int          phase;                 /* of the integrator; SAMPLES: camera samples */
    uint64_t     phase_units, rays;     /* rays: under the queue's mutex */
    uint64_t     first_unit;            /* those before it are done */
    int          looked_spp, looked_seconds;    /* entries of the watch that are behind */
    bool         paused;                /* somebody wants to look */
    uint64_t    *rays_seen, *shots_seen;        /* of each worker, counted already */
    Progress     progress;
    double       start, cpu;            /* clocks at the start, later by what looking took */
    bool         ended;                 /* a budget or an interrupt ended it early */
} Job;

/* ---- units of camera samples ---- */

/* keep: it goes on the film. Returns its luminance, 0 of what is no number. */
static float camera_sample(void *ctx, Tracer *t, uint32_t x, uint32_t y, uint32_t index, bool keep)
{
    Job *j = ctx;
    const RenderSettings *s = j->settings;
    const Camera *c = j->scene->camera;
    Rgb values[1 + AOVS_MAX];
    V2 off, lens = { 0, 0 };
    float time = j->time, weight;
    Ray r;

    sampler_start(&t->sampler, index);
    off = filter_sample(&j->filter, sample_2d(&t->sampler, DECISION(DECIDE_PIXEL, 0)), &weight);
    if (c->has_lens)
        lens = sample_2d(&t->sampler, DECISION(DECIDE_LENS, 0));
    if (j->blurs && !j->integrator->kind->moment)
        time = scene_time(j->scene, sample_1d(&t->sampler, DECISION(DECIDE_TIME, 0)));
    r = c->kind->ray(c, (V2){ (float)x + 0.5f + off.x, (float)y + 0.5f + off.y }, lens, time);
    if (t->tally)
        memset(t->tally, 0, sizeof *t->tally);
    t->x = x;
    t->y = y;
    t->kept = keep;
    values[0] = j->integrator->kind->radiance(j->integrator, &r, t);
    if (s->naovs)
        aov_values(s->aovs, s->naovs, &r, t, values + 1);
    for (int k = 0; weight != 1.0f && k <= s->naovs; k++)
        values[k] = rgb_scale(values[k], weight);
    if (keep)
        film_add(j->film, x, y, index, values);
    return film_takes(values[0]) ? rgb_lum(values[0]) : 0.0f;
}

static void camera_tile(Job *j, Tracer *t, uint32_t tile)
{
    uint32_t x0, y0, x1, y1;

    film_tile(j->film, tile, &x0, &y0, &x1, &y1);
    for (uint32_t y = y0; y < y1; y++)
        for (uint32_t x = x0; x < x1; x++) {
            sampler_pixel(&t->sampler, x, y);
            for (uint32_t i = 0; i < j->count; i++)
                camera_sample(j, t, x, y, j->first + i, true);
        }
}

static bool is_late(void *ctx)
{
    const Job *j = ctx;
    const RenderSettings *s = j->settings;
    return (s->stop && *s->stop) || (s->seconds > 0 && clock_wall() - j->start >= s->seconds);
}

/* ---- the queue's side ---- */

static void run_unit(void *ctx, uint64_t unit, int worker)
{
    Job *j = ctx;
    Tracer *t = &j->tracers[worker];
    Integrator *it = j->integrator;
    Taker taker = { camera_sample, is_late, j, t };

    unit += j->first_unit;
    if (j->phase != SAMPLES)
        it->kind->run(it, j->film, j->pass, j->phase, unit, t);
    else if (j->adapts)
        adaptive_run(&j->adaptive, (uint32_t)unit, &taker);
    else if (it->kind->walk)
        it->kind->walk(it, j->film, (uint32_t)unit, j->first, j->count, &taker);
    else
        camera_tile(j, t, (uint32_t)unit);
}

/* How far the whole render is, by the budget that is nearest to its end. */
static double fraction_done(const Job *j, double pass_done)
{
    const RenderSettings *s = j->settings;
    double f = 0, g;

    if (j->expected > 0)
        f = (j->so_far + j->coming * pass_done) / j->expected;
    if (s->seconds > 0) {
        g = (clock_wall() - j->start) / s->seconds;
        f = g > f ? g : f;
    }
    return f < 1 ? f : 1;
}

static void report_now(const Job *j, RenderReport *r)
{
    r->seconds = clock_wall() - j->start;
    r->cpu_seconds = clock_cpu() - j->cpu;
    r->samples = j->adapts ? adaptive_taken(&j->adaptive)
               : j->film->splats ? j->film->splats->shots : film_samples(j->film);
    r->rays = j->rays;
    r->spp = !j->integrator->kind->radiance
                 ? j->first : (double)r->samples / ((double)j->film->w * j->film->h);
    r->interrupted = j->settings->stop && *j->settings->stop;
}

/* Somebody wants to see what there is by now. */
static bool time_to_look(const Job *j)
{
    const RenderWatch *w = j->settings->watch;
    return w && j->looked_seconds < w->nseconds &&
           clock_wall() - j->start >= w->seconds[j->looked_seconds];
}

static bool samples_to_look(const Job *j)
{
    const RenderWatch *w = j->settings->watch;
    return w && j->looked_spp < w->nspp && j->first >= w->spp[j->looked_spp];
}

/* Between units, when no thread works. */
static void look(Job *j)
{
    const RenderWatch *w = j->settings->watch;
    double wall, cpu;
    RenderReport r;

    j->paused = false;
    report_now(j, &r);
    while (j->looked_seconds < w->nseconds && r.seconds >= w->seconds[j->looked_seconds])
        j->looked_seconds++;
    while (samples_to_look(j))
        j->looked_spp++;
    wall = clock_wall();
    cpu = clock_cpu();
    if (!w->look(w->ctx, j->film, &r))
        j->ended = true;
    j->start += clock_wall() - wall;
    j->cpu += clock_cpu() - cpu;
}

static void count_up(Job *j, int worker)
{
    const Tracer *t = &j->tracers[worker];

    j->rays += t->rays - j->rays_seen[worker];
    j->rays_seen[worker] = t->rays;
    if (j->integrator->kind->splats)
        film_shots(j->film, t->shots - j->shots_seen[worker]);
    j->shots_seen[worker] = t->shots;
}

static bool after_unit(void *ctx, uint64_t done, int worker)
{
    Job *j = ctx;
    double pass_done = (double)(j->first_unit + done) / (double)j->phase_units;

    count_up(j, worker);
    progress_show(&j->progress, fraction_done(j, pass_done), j->so_far + j->coming * pass_done,
                  j->rays);
    j->integrator->failed = j->integrator->failed || j->tracers[worker].failed;
    if (is_late(j) || j->integrator->failed)
        j->ended = true;
    else if (j->pass && j->integrator->kind->radiance && time_to_look(j))
        j->paused = true;
    return !j->ended && !j->paused;
}

static uint64_t units_of(const Job *j)
{
    if (j->phase != SAMPLES)
        return j->integrator->kind->units(j->integrator, j->film, j->pass, j->phase);
    if (j->adapts)
        return adaptive_units(&j->adaptive);
    return j->integrator->kind->walks ? j->integrator->kind->walks(j->integrator, j->film)
                                      : film_ntiles(j->film);
}

static void run_phase(Job *j, int phase)
{
    Work w = { 0, run_unit, after_unit, NULL };

    w.ctx = j;
    j->phase = phase;
    j->phase_units = units_of(j);
    j->paused = false;
    for (j->first_unit = 0; j->first_unit < j->phase_units && !j->ended;) {
        w.units = j->phase_units - j->first_unit;
        j->first_unit += work_run(&w, j->settings->threads);
        if (j->paused && !j->ended && j->first_unit < j->phase_units)
            look(j);
    }
    j->first_unit = 0;
    j->ended = j->ended || j->integrator->failed;
}

static void run_phases(Job *j)
{
    for (int phase = 0; phase < j->integrator->kind->phases && !j->ended; phase++)
        run_phase(j, phase);
}

/* In every pass, as against once before all camera samples. */
static bool phases_are_anew(const IntegratorKind *k) { return k->anew || !k->radiance; }

/* What an integrator does before the first pass. False: reported. */
static bool prepare(Job *j)
{
    const IntegratorKind *k = j->integrator->kind;

    if (k->prepare && !k->prepare(j->integrator, j->film, j->settings->seed))
        return false;
    if (!phases_are_anew(k))
        run_phases(j);
    return !j->integrator->failed;
}

/* Samples of the next pass: few at first, for an early picture, then twice as many as before. */
static uint32_t next_count(const Job *j)
{
    const IntegratorKind *k = j->integrator->kind;
    bool single = phases_are_anew(k) || k->splats;
    uint32_t n = j->pass == 0 || single ? 1 : j->first < PASS_MOST ? j->first : PASS_MOST;
    uint32_t spp = j->settings->spp ? j->settings->spp : UINT32_MAX;
    const RenderWatch *w = j->settings->watch;

    if (k->batch)
        n = k->batch(j->integrator, j->first, j->settings->spp);
    if (w && j->looked_spp < w->nspp && w->spp[j->looked_spp] < spp)
        spp = w->spp[j->looked_spp];
    return n < spp - j->first ? n : spp - j->first;
}

/* All pixels alike: at an error, of which only the least number of samples has to be sure, the
 * picture as a whole stops. */
static bool good_enough(Job *j)
{
    const RenderSettings *s = j->settings;
    double e;

    if (!(s->error > 0) || j->first < j->adaptive.least)
        return false;
    e = film_error(j->film);
    j->expected = j->first * (e / s->error) * (e / s->error);   /* as of independent samples */
    if (s->spp && j->expected > s->spp)
        j->expected = s->spp;
    return e <= s->error;
}

/* The time of all rays of the pass: radical inverses of its moment's number, from a start that the
 * seed gives, so that moments are spread evenly over the shutter's opening. */
static void choose_moment(Job *j)
{
    Rng seed = rng_seed(j->settings->seed);
    float u = rng_unit(&seed), half = 0.5f;

    for (uint32_t n = j->integrator->kind->moment(j->integrator, j->pass); n; n >>= 1, half *= 0.5f)
        u += n & 1 ? half : 0.0f;
    if (j->blurs)
        j->time = scene_time(j->scene, u < 1.0f ? u : u - 1.0f);
    for (int i = 0; i < j->settings->threads; i++)
        j->tracers[i].moment = j->time;
}

static void run_passes(Job *j)
{
    const RenderSettings *s = j->settings;
    const IntegratorKind *k = j->integrator->kind;

    j->expected = s->spp;
    while (!j->ended && (s->spp == 0 || j->first < s->spp)) {
        j->count = next_count(j);
        j->so_far = j->first;
        j->coming = j->count;
        if (k->moment)
            choose_moment(j);
        if (phases_are_anew(k))
            run_phases(j);
        if (k->radiance && !j->ended)
            run_phase(j, SAMPLES);
        j->first += j->count;
        j->pass++;
        j->paused = false;
        if (k->splats && !j->ended)
            film_pass(j->film);
        if (!j->ended && (samples_to_look(j) || time_to_look(j)))
            look(j);
        if (good_enough(j) || j->first == UINT32_MAX)
            break;
    }
}

/* The policy says what each pixel shall have. */
static void run_adaptive(Job *j)
{
    Adaptive *a = &j->adaptive;

    while (!j->ended && adaptive_next(a)) {
        j->so_far = (double)adaptive_taken(a) / a->n;
        j->coming = adaptive_coming(a) / a->n;
        j->expected = a->expected / a->n;
        run_phase(j, SAMPLES);
    }
}

/* ---- setting up ---- */

/* Angle between the rays through the middle of the picture and one pixel beside it. Between
 * parallel rays of an orthographic camera it is 0. */
static float spread_of(const RenderSettings *s, const Camera *c)
{
    V2 at = { 0.5f * (float)s->w, 0.5f * (float)s->h }, beside = { at.x + 1.0f, at.y };
    V2 middle = { 0.5f, 0.5f };
    return v_len(v_sub(c->kind->ray(c, beside, middle, 0.0f).d,
                       c->kind->ray(c, at, middle, 0.0f).d));
}

static bool adapt(Job *j)
{
    const RenderSettings *s = j->settings;
    bool can = s->adaptive && integrator_adapts(s->integrator);
    const AdaptiveKind *kind = can ? s->adaptive : &adaptive_none;
    Opts o;

    if (kind == s->adaptive)
        o = s->adaptive_opts;
    else
        opts_default(&o, kind->info.options);
    j->adapts = kind->plan != NULL;
    return adaptive_init(&j->adaptive, kind, &o, j->film, s->spp, s->error, s->seed);
}

static bool stretch_canvas(Job *j)
{
    const RenderSettings *s = j->settings;

    j->canvas.film = j->film;
    j->canvas.filter = &j->filter;
    aov_layers(s->aovs, s->naovs, &j->canvas);
    return film_accepts_splats(j->film);
}

static bool job_init(Job *j, uint32_t *spp)
{
    const RenderSettings *s = j->settings;
    float spread = spread_of(s, j->scene->camera);
    int n = s->threads;

    j->tracers = MEM_ARRAY(Tracer, n);
    j->rays_seen = MEM_ARRAY(uint64_t, n);
    j->shots_seen = MEM_ARRAY(uint64_t, n);
    if (!j->tracers || !j->rays_seen || !j->shots_seen)
        return false;
    if (aov_needs_tally(s->aovs, s->naovs)) {
        j->tallies = MEM_ARRAY(Tally, n);
        if (!j->tallies)
            return false;
    }
    for (int i = 0; i < n; i++) {
        j->tracers[i].scene = j->scene;
        j->tracers[i].spread = spread;
        j->tracers[i].tally = j->tallies ? &j->tallies[i] : NULL;
        j->tracers[i].canvas = s->integrator->splats ? &j->canvas : NULL;
    }
    if (!sampler_init(&j->tracers[0].sampler, s->sampler, &s->sampler_opts, s->seed, spp))
        return false;
    for (int i = 1; i < n; i++)
        j->tracers[i].sampler = j->tracers[0].sampler;
    filter_init(&j->filter, s->filter, &s->filter_opts);
    j->integrator = s->integrator->open(j->scene, &s->integrator_opts);
    if (!j->integrator)
        return false;
    j->integrator->kind = s->integrator;
    return film_init(j->film, s->w, s->h, s->crop, 1 + s->naovs) &&
           (!s->integrator->splats || stretch_canvas(j)) && adapt(j);
}

static void job_clear(Job *j)
{
    if (j->integrator)
        j->integrator->kind->close(j->integrator);
    if (j->tracers)
        sampler_clear(&j->tracers[0].sampler);
    adaptive_clear(&j->adaptive);
    mem_free(j->tracers);
    mem_free(j->tallies);
    mem_free(j->rays_seen);
    mem_free(j->shots_seen);
}

/* A light that gives nothing, or none at all, is no error, but worth a word. */
static bool warn_if_dark(const Scene *s, const Integrator *it)
{
    float sum = 0.0f;

    if (it->kind->glows && it->kind->glows(it))
        return true;
    for (size_t i = 0; i < s->nlights; i++)
        sum += rgb_lum(s->lights[i]->kind->power(s->lights[i]));
    if (sum > 0.0f)
        return true;
    return warn_at((Place){ NULL, 0, 0 }, "%s: the picture is black",
                   s->nlights ? "the lights have no power" : "there is no light");
}

static bool report_refused(const Film *f)
{
    uint32_t x = 0, y = 0, index = 0;
    uint64_t n = film_refused(f, &x, &y, &index);

    return !n || warn_at((Place){ NULL, 0, 0 },
                         "%.0f samples were not finite or too large and count as black; the first: "
                         "pixel %lu,%lu, sample %lu", (double)n, (unsigned long)x, (unsigned long)y,
                         (unsigned long)index);
}

bool render(const Scene *scene, const RenderSettings *settings, Film *film, RenderReport *report)
{
    RenderSettings s = *settings;
    Job j;
    bool ok;

    memset(&j, 0, sizeof j);
    memset(film, 0, sizeof *film);
    memset(report, 0, sizeof *report);
    j.settings = &s;
    j.scene = scene;
    j.film = film;
    scene->camera->kind->film(scene->camera, s.w, s.h);
    j.blurs = scene_blurs(scene);
    j.time = scene_time(scene, 0.0f);
    ok = job_init(&j, &s.spp) && warn_if_dark(scene, j.integrator);
    if (ok) {
        progress_start(&j.progress);
        j.cpu = clock_cpu();
        j.start = clock_wall();
        ok = prepare(&j);
        if (ok && j.adapts)
            run_adaptive(&j);
        else if (ok)
            run_passes(&j);
        report_now(&j, report);
        progress_end(&j.progress);
        ok = ok && !j.integrator->failed && report_refused(film);
    }
    job_clear(&j);
    if (!ok)
        film_clear(film);
    return ok;
}
