/* raceresult.c -- what follows from the measurements of a race. See race.h. */
#include "render/race.h"

/* ---- one method ---- */

/* The checkpoints whose error can be used in a fit, in x (log spp), y (log error) and tie; returns
 * how many. Errors at n and m > n samples of one render share the first n. For independent samples
 * the errors' correlation is sqrt(n/m), that of their squares, and of the logs of sigma, n/m: a
 * chain, as line_fit wants it. */
static int fit_points(const RaceResult *r, double *x, double *y, double *tie)
{
    int n = 0;

    for (int i = 0; i < r->n; i++) {
        const RacePoint *p = &r->point[i];
        if (p->doubtful || !(p->sigma_over_mu > 0 && p->sigma_over_mu < INFINITY))
            continue;
        x[n] = md_log(p->spp);
        y[n] = md_log(p->sigma_over_mu);
        tie[n] = n && !r->fresh && x[n] > x[n - 1] ? md_exp(x[n - 1] - x[n]) : 0;
        n++;
    }
    return n;
}

void race_finish(RaceResult *r)
{
    double x[RACE_LOOKS + 1], y[RACE_LOOKS + 1], tie[RACE_LOOKS + 1];

    for (int i = 0; i <= RACE_LOOKS; i++)
        if (r->point[i].known)
            r->point[r->n++] = r->point[i];
    r->fit = line_fit(x, y, tie, fit_points(r, x, y, tie), RACE_CONFIDENCE);
}

/* ---- all ---- */

/* CPU seconds to an error of `goal`, on the line between two checkpoints, in logs. */
static void find_reach(RaceResult *r, double goal)
{
    for (int i = 0; i < r->n; i++) {
        const RacePoint *p = &r->point[i], *q = i ? p - 1 : p;
        r->reach = p->cpu_seconds;
        r->reach_is = p->sigma_over_mu <= goal ? 0 : 1;
        if (r->reach_is)
            continue;
        if (!i)
            r->reach_is = p->sigma_over_mu < goal ? -1 : 0;
        else if (p->sigma_over_mu > 0 && p->sigma_over_mu < goal && q->cpu_seconds > 0)
            r->reach = q->cpu_seconds * md_pow(p->cpu_seconds / q->cpu_seconds,
                                               md_log(q->sigma_over_mu / goal) /
                                               md_log(q->sigma_over_mu / p->sigma_over_mu));
        return;
    }
}

void race_conclude(Race *race)
{
    const RaceResult *first = &race->result[0];

    if (!race->n)
        return;
    race->goal = first->point[first->n - 1].sigma_over_mu;
    if (race->reference == REFERENCE_PAIR)
        race->mean = first->point[first->n - 1].mean;
    for (int i = 0; race->goal > 0 && race->goal < INFINITY && i < race->n; i++)
        find_reach(&race->result[i], race->goal);
}
