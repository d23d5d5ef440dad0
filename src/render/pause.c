/* pause.c -- a render at rest: who looks at the picture while it is made, who keeps it, and what is
 * reported to them. See RenderWatch and RenderKeeper in render.h.
 *
 * Pauses      are between units, when no thread works; units that have a say end early for them.
 * Clocks      Job.start and Job.cpu move on by what a pause takes: it is not rendering. */
#include "render/job.h"

#include "base/clock.h"

/* ---- what there is ---- */

void job_report(const Job *j, RenderReport *r)
{
    r->seconds = clock_wall() - j->start;
    r->cpu_seconds = clock_cpu() - j->cpu;
    r->samples = j->adapts ? adaptive_taken(&j->adaptive)
               : j->film->splats ? j->film->splats->shots : film_samples(j->film);
    r->rays = j->rays;
    r->passes = j->pass;
    r->before = j->before;
    r->spp = !j->integrator->kind->radiance
                 ? j->first + (j->midway ? j->count : 0)
                 : (double)r->samples / ((double)j->film->w * j->film->h);
    r->interrupted = j->settings.stop && *j->settings.stop;
}

void job_report_work(const Job *j, RenderReport *r)
{
    for (int i = 0; i < j->settings.threads; i++) {
        const PathWork *w = &j->tracers[i].work;
        r->work.from_lamps += w->from_lamps;
        r->work.from_eye += w->from_eye;
        r->work.lamp_edges += w->lamp_edges;
        r->work.eye_edges += w->eye_edges;
        r->work.joins += w->joins;
        r->work.mergers += w->mergers;
    }
}

/* ---- who wants to see it ---- */

/* The next of its times has come. */
static bool time_to_look(const Job *j)
{
    const RenderWatch *w = j->settings.watch;
    return w && j->looked_seconds < w->nseconds &&
           clock_wall() - j->start >= w->seconds[j->looked_seconds];
}

/* Of pixels some of which have had a sample more than others. */
static bool time_to_look_within(const Job *j)
{
    return j->pass && j->integrator->kind->radiance && time_to_look(j);
}

static bool samples_to_look(const Job *j)
{
    const RenderWatch *w = j->settings.watch;
    return w && j->looked_spp < w->nspp && j->first >= w->spp[j->looked_spp];
}

bool job_wants_pause(const Job *j)
{
    double now = clock_wall();

    return (j->midway && now >= j->keep_at) || now >= j->look_at || time_to_look_within(j);
}

void job_plan_pause(Job *j)
{
    double end = j->settings.seconds > 0 ? j->start + j->settings.seconds : INFINITY;

    j->pause_at = j->midway && j->keep_at < end ? j->keep_at : end;
    if (j->look_at < j->pause_at)
        j->pause_at = j->look_at;
}

/* ---- pauses ---- */

static void look(Job *j)
{
    const RenderWatch *w = j->settings.watch;
    RenderReport r;

    job_report(j, &r);
    while (j->looked_seconds < w->nseconds && r.seconds >= w->seconds[j->looked_seconds])
        j->looked_seconds++;
    while (samples_to_look(j))
        j->looked_spp++;
    if (!w->look(w->ctx, j->film, &r))
        j->ended = true;
}

void job_keep(Job *j, bool last)
{
    const RenderKeeper *k = j->settings.keeper;
    RenderReport r;

    job_report(j, &r);
    k->keep(k->ctx, j, j->film, &r, last);
    j->keep_at = k->every > 0 ? clock_wall() + k->every : INFINITY;
}

static void plan_look(Job *j)
{
    const RenderWatch *w = j->settings.watch;
    j->look_at = w && w->every > 0 ? clock_wall() + w->every : INFINITY;
}

void job_pause(Job *j, bool whole)
{
    double wall = clock_wall(), cpu = clock_cpu();
    bool wanted = whole ? samples_to_look(j) || time_to_look(j) : time_to_look_within(j);

    wanted = wanted || wall >= j->look_at;
    j->paused = false;
    if (wall >= j->keep_at && (whole || j->midway))
        job_keep(j, false);
    if (wanted) {
        look(j);
        plan_look(j);
    }
    j->start += clock_wall() - wall;
    j->cpu += clock_cpu() - cpu;
}

void job_start_clocks(Job *j)
{
    const RenderKeeper *k = j->settings.keeper;

    j->cpu += clock_cpu();
    j->start += clock_wall();
    j->keep_at = k && k->every > 0 ? clock_wall() + k->every : INFINITY;
    plan_look(j);
}
