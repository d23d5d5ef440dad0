/* render.c -- the driver. See render.h.
 *
 * Time is cut into passes, passes into phases and these into units that threads take from a queue.
 * Of camera samples a unit is a tile of pixels and a pass some samples of each; integrators say
 * themselves what the units of their own phases are. Order cannot matter: random numbers come from
 * the pixel and the sample's index, and the film's sums are exact. Budgets are looked at after
 * every unit and between the pixels of a tile, so an interrupt or a limit of time leaves a whole
 * picture soon, some of whose pixels have had a pass more than others; what is done of each unit is
 * noted, so that the rest may follow, now (pause.c) or another day (state.c). A share of a render
 * has some of its samples, by number, or its own random numbers where samples build on each
 * other. */
#include "render/job.h"

#include "base/clock.h"
#include "base/work.h"

#include <string.h>

/* ---- units of camera samples ---- */

/* The other pictures' values of the tracer's pixel. */
static void extra_values(const Job *j, Tracer *t, AovSample s, bool keep, Rgb *values)
{
    const Camera *c = j->scene->camera;
    V2 middle = { (float)t->x + 0.5f, (float)t->y + 0.5f };

    s.first = keep && !j->film->counts[film_pixel(j->film, t->x, t->y)];
    if (s.first)
        s.middle = c->kind->ray(c, middle, (V2){ 0.5f, 0.5f }, j->time);
    aov_values(j->settings.aovs, j->settings.naovs, &s, t, values);
}

/* keep: it goes on the film. Returns its luminance, 0 of what is no number. */
static float camera_sample(void *ctx, Tracer *t, uint32_t x, uint32_t y, uint32_t index, bool keep)
{
    Job *j = ctx;
    const RenderSettings *s = &j->settings;
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
        tally_clear(t->tally);
    t->x = x;
    t->y = y;
    t->kept = keep;
    values[0] = j->integrator->kind->radiance(j->integrator, &r, t);
    if (s->naovs)
        extra_values(j, t, (AovSample){ .ray = r, .weight = weight }, keep, values);
    else if (weight != 1.0f)
        values[0] = rgb_scale(values[0], weight);
    if (keep)
        film_add(j->film, x, y, index, values);
    return film_takes(values[0]) ? rgb_lum(values[0]) : 0.0f;
}

/* Asked for between pixels: a signal, the time that the render has, somebody who waits. */
static bool is_late(void *ctx)
{
    const Job *j = ctx;
    const RenderSettings *s = &j->settings;
    return (s->stop && *s->stop) || (j->pause_at < INFINITY && clock_wall() >= j->pause_at);
}

static void camera_tile(Job *j, Tracer *t, uint32_t tile, uint32_t *done)
{
    uint32_t x0, y0, x1, y1, w;

    film_tile(j->film, tile, &x0, &y0, &x1, &y1);
    w = x1 - x0;
    while (*done < w * (y1 - y0)) {
        uint32_t x = x0 + *done % w, y = y0 + *done / w;
        sampler_pixel(&t->sampler, x, y);
        for (uint32_t i = 0; i < j->count; i++)
            camera_sample(j, t, x, y, j->base + j->first + i, true);
        ++*done;
        if (is_late(j))         /* not before, or somebody who is always late gets nowhere */
            return;
    }
    *done = UNIT_DONE;
}

/* ---- the queue's side ---- */

/* Passes of one sample are counted by samples, so that those of all shares have other numbers. */
static uint32_t pass_number(const Job *j)
{
    return phases_are_anew(j->integrator->kind) ? j->base + j->pass : 0;
}

/* A unit that was run before the state was left, and is again for what it makes beside splats,
 * gives no splats. */
static void run_integrator(Job *j, uint64_t unit, Tracer *t)
{
    bool again = j->left_at && (j->phase != j->left_phase || j->left_at[unit] == UNIT_DONE);
    const Canvas *canvas = t->canvas;
    uint64_t shots = t->shots;

    if (again)
        t->canvas = NULL;
    j->integrator->kind->run(j->integrator, j->film, pass_number(j), j->phase, unit, t);
    t->canvas = canvas;
    if (again)
        t->shots = shots;
}

static void run_unit(void *ctx, uint64_t unit, int worker)
{
    Job *j = ctx;
    Tracer *t = &j->tracers[worker];
    Integrator *it = j->integrator;
    Taker taker;
    uint32_t *done;

    unit += j->first_unit;
    done = &j->done[unit];
    if (*done == UNIT_DONE)
        return;
    taker = (Taker){ camera_sample, is_late, j, t, done };
    if (j->phase == SAMPLES && j->adapts) {
        adaptive_run(&j->adaptive, (uint32_t)unit, &taker);
    } else if (j->phase == SAMPLES && !it->kind->walk) {
        camera_tile(j, t, (uint32_t)unit, done);
    } else if (j->phase == SAMPLES) {
        it->kind->walk(it, j->film, (uint32_t)unit, j->base + j->first, j->count, &taker);
    } else {
        run_integrator(j, unit, t);
        *done = UNIT_DONE;
    }
}

/* How far the whole render is, by the budget that is nearest to its end. */
static double fraction_done(const Job *j, double pass_done)
{
    const RenderSettings *s = &j->settings;
    double f = 0, g;

    if (j->expected > 0)
        f = (j->so_far + j->coming * pass_done) / j->expected;
    if (s->seconds > 0) {
        g = (clock_wall() - j->start) / s->seconds;
        f = g > f ? g : f;
    }
    return f < 1 ? f : 1;
}

/* ---- units, phases, passes ---- */

static bool out_of_time(const Job *j)
{
    const RenderSettings *s = &j->settings;
    return (s->stop && *s->stop) || (s->seconds > 0 && clock_wall() - j->start >= s->seconds);
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
    if (out_of_time(j) || j->integrator->failed)
        j->ended = true;
    else if (job_wants_pause(j))
        j->paused = true;
    return !j->ended && !j->paused;
}

static uint64_t units_of(const Job *j)
{
    if (j->phase != SAMPLES)
        return j->integrator->kind->units(j->integrator, j->film, pass_number(j), j->phase);
    if (j->adapts)
        return adaptive_units(&j->adaptive);
    return j->integrator->kind->walks ? j->integrator->kind->walks(j->integrator, j->film)
                                      : film_ntiles(j->film);
}

static void forget_left(Job *j)
{
    mem_free(j->left_at);
    j->left_at = NULL;
}

/* What is done of the phase's units: nothing, or what was when the state was left. False:
 * reported. */
static bool begin_phase(Job *j, int phase)
{
    j->phase = phase;
    j->phase_units = units_of(j);
    j->first_unit = 0;
    if (j->integrator->failed || j->phase_units > SIZE_MAX / sizeof *j->done ||
        !mem_grow(&j->done, &j->cap_done, (size_t)j->phase_units + 1, sizeof *j->done))
        return false;
    memset(j->done, 0, (size_t)j->phase_units * sizeof *j->done);
    j->midway = phase_lasts(j->integrator->kind, phase);
    if (!j->left_at || phase != j->left_phase)
        return true;
    if (j->nleft != j->phase_units)
        return err_at((Place){ j->settings.resume, 0, 0 }, "does not fit this render");
    if (phase == last_stage(j->integrator->kind) || keeps_all(j->integrator->kind)) {
        memcpy(j->done, j->left_at, (size_t)j->nleft * sizeof *j->done);
        forget_left(j);
    }
    return true;
}

static void run_phase(Job *j, int phase)
{
    Work w = { 0, run_unit, after_unit, NULL };
    double start = clock_wall();

    w.ctx = j;
    if (!begin_phase(j, phase)) {
        j->integrator->failed = j->ended = true;
        return;
    }
    do {
        if (j->paused)
            job_pause(j, false);
        job_plan_pause(j);
        while (j->first_unit < j->phase_units && j->done[j->first_unit] == UNIT_DONE)
            j->first_unit++;
        w.units = j->phase_units - j->first_unit;
        if (!j->ended)
            work_run(&w, j->settings.threads);
    } while (j->paused && !j->ended);
    if (phase != SAMPLES)
        j->before += clock_wall() - start;
    j->ended = j->ended || j->integrator->failed;
    if (!j->ended && phase == j->left_phase)
        forget_left(j);
}

/* Of a state that was left midway, phases before its own are run again only for what they made. */
static int first_phase(const Job *j)
{
    const IntegratorKind *k = j->integrator->kind;

    if (!j->left_at || !keeps_all(k))
        return 0;
    return j->left_phase == SAMPLES ? k->phases : j->left_phase;
}

static void run_phases(Job *j)
{
    for (int phase = first_phase(j); phase < j->integrator->kind->phases && !j->ended; phase++)
        run_phase(j, phase);
}

/* What an integrator does before the first pass. False: reported. */
static bool prepare(Job *j)
{
    const IntegratorKind *k = j->integrator->kind;

    if (k->prepare && !k->prepare(j->integrator, j->film, j->settings.seed))
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
    uint32_t spp = j->settings.spp ? j->settings.spp : j->most;
    const RenderWatch *w = j->settings.watch;

    if (k->batch)
        n = k->batch(j->integrator, j->first, j->settings.spp);
    if (w && j->looked_spp < w->nspp && w->spp[j->looked_spp] < spp)
        spp = w->spp[j->looked_spp];
    return n < spp - j->first ? n : spp - j->first;
}

/* All pixels alike: at an error, of which only the least number of samples has to be sure, the
 * picture as a whole stops. */
static bool good_enough(Job *j)
{
    const RenderSettings *s = &j->settings;
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
    Rng seed = rng_seed(j->settings.seed);
    uint32_t n = j->integrator->kind->moment(j->integrator, pass_number(j));
    float u = rng_unit(&seed), half = 0.5f;

    for (; n; n >>= 1, half *= 0.5f)
        u += n & 1 ? half : 0.0f;
    if (j->blurs)
        j->time = scene_time(j->scene, u < 1.0f ? u : u - 1.0f);
    for (int i = 0; i < j->settings.threads; i++)
        j->tracers[i].moment = j->time;
}

static void run_passes(Job *j)
{
    const RenderSettings *s = &j->settings;
    const IntegratorKind *k = j->integrator->kind;

    j->expected = s->spp;
    while (!j->ended && j->first < (s->spp ? s->spp : j->most)) {
        if (!j->left_at)
            j->count = next_count(j);
        j->so_far = j->first;
        j->coming = j->count;
        if (k->moment)
            choose_moment(j);
        if (phases_are_anew(k))
            run_phases(j);
        if (k->radiance && !j->ended)
            run_phase(j, SAMPLES);
        if (j->ended)
            break;
        j->first += j->count;
        j->pass++;
        j->midway = false;
        if (k->splats)
            film_pass(j->film);
        job_pause(j, true);
        if (good_enough(j))
            break;
    }
}

/* The policy says what each pixel shall have. */
static void run_adaptive(Job *j)
{
    Adaptive *a = &j->adaptive;

    while (!j->ended && (j->left_at || adaptive_next(a))) {
        j->so_far = (double)adaptive_taken(a) / a->n;
        j->coming = adaptive_coming(a) / a->n;
        j->expected = a->expected / a->n;
        run_phase(j, SAMPLES);
        j->midway = j->ended;
    }
}

/* ---- the job as a whole ---- */

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

/* From the first sample on, or from where the state was left. False: reported. */
static bool run(Job *j)
{
    job_start_clocks(j);
    if (!prepare(j))
        return false;
    if (j->pending && !j->ended && !job_take_state(j))
        return false;
    if (j->adapts)
        run_adaptive(j);
    else
        run_passes(j);
    if (j->integrator->failed)
        return false;
    if (j->settings.keeper && !j->pending)
        job_keep(j, true);
    return true;
}

bool render(const Scene *scene, const RenderSettings *settings, Film *film, RenderReport *report)
{
    Job j;
    bool ok;

    memset(&j, 0, sizeof j);
    memset(film, 0, sizeof *film);
    memset(report, 0, sizeof *report);
    j.asked = settings;
    j.settings = *settings;
    j.scene = scene;
    j.film = film;
    scene->camera->kind->film(scene->camera, settings->w, settings->h);
    j.blurs = scene_blurs(scene);
    j.time = scene_time(scene, 0.0f);
    ok = job_init(&j) && warn_if_dark(scene, j.integrator) && job_find_state(&j);
    if (ok) {
        progress_start(&j.progress);
        ok = run(&j);
        if (ok && j.integrator->kind->finish)
            ok = j.integrator->kind->finish(j.integrator, film);
        job_report(&j, report);
        job_report_work(&j, report);
        progress_end(&j.progress);
        ok = ok && report_refused(film);
    }
    job_clear(&j);
    if (!ok)
        film_clear(film);
    return ok;
}
