/* job.h -- a render while it goes on: what the driver and those who keep its state share. */
#ifndef RENDER_JOB_H
#define RENDER_JOB_H

#include "base/progress.h"
#include "render/render.h"
#include "render/state.h"

enum { SAMPLES = -1 };                  /* the phase of camera samples */

struct Job {
    const RenderSettings *asked;
    RenderSettings settings;            /* of this share of it */
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
    uint32_t     planned;               /* samples of all shares, as the sampler has them; 0: it is
                                         * not known */
    uint32_t     base, most;            /* number of this share's first sample; most it may have */
    uint32_t     first, count;          /* samples of this pass: behind base, and how many */
    double       so_far, coming;        /* samples a pixel: before this pass, and in it */
    double       expected;              /* in all, as far as one can tell; 0: not */
    uint32_t     pass;
    double       before;                /* seconds of phases before camera samples */
    int          phase;                 /* of the integrator; SAMPLES: camera samples */
    uint64_t     phase_units, rays;     /* rays: under the queue's mutex */
    uint64_t     first_unit;            /* those before it are done */
    uint32_t    *done;                  /* owned: how many pixels of each unit of the phase are
                                         * done, or UNIT_DONE */
    size_t       cap_done;
    bool         midway;                /* a phase that changes what lasts, the film or what the
                                         * method keeps, has begun, and its pass is not whole */
    uint32_t    *left_at;               /* owned: of a state that was left midway, `done` of */
    uint64_t     nleft;                 /* phase left_phase; NULL: there is none, or all is */
    int          left_phase;            /* again as it was then */
    int          looked_spp, looked_seconds;    /* entries of the watch that are behind */
    bool         paused;                /* somebody wants to look */
    double       keep_at, look_at;      /* clock: of the next autosave; of the next regular look; */
    double       pause_at;              /* of the next pause */
    uint64_t    *rays_seen, *shots_seen;        /* of each worker, counted already */
    Progress     progress;
    double       start, cpu;            /* clocks at the start, later by what looking took */
    bool         ended;                 /* a budget or an interrupt ended it early */
    Identity     identity;              /* owned: what is rendered */
    Loading      state;                 /* owned: to go on from, */
    bool         pending;               /* which has not been taken over as a whole yet */
};

/* What an integrator has in every pass, as against once before all camera samples. */
INLINE bool phases_are_anew(const IntegratorKind *k) { return k->anew || !k->radiance; }
/* What a pass ends with. */
INLINE int last_stage(const IntegratorKind *k) { return k->radiance ? SAMPLES : k->phases - 1; }
/* Whether no phase has to be run again for what it made. */
INLINE bool keeps_all(const IntegratorKind *k) { return k->keeps_all || !k->radiance; }
/* Whether the film may change in that phase; see `save` in integrator.h. */
INLINE bool phase_lasts(const IntegratorKind *k, int phase)
{
    return phase == last_stage(k) || (k->anew && k->radiance);
}

/* ---- setup.c ---- */

/* From asked, settings, scene and film, all else being 0. False: reported. In any case
 * job_clear. */
bool job_init(Job *j);
void job_clear(Job *j);         /* the film stays */

/* ---- pause.c ---- */

void job_start_clocks(Job *j);  /* at the first sample, or where the state was left */
void job_report(const Job *j, RenderReport *r);         /* by now; all but the work */
void job_report_work(const Job *j, RenderReport *r);
/* Whether units that have no say shall wait till somebody has looked or kept. */
bool job_wants_pause(const Job *j);
/* Sets when units that have a say shall end for that. */
void job_plan_pause(Job *j);
/* What they do then is not counted as rendering. whole: between passes. */
void job_pause(Job *j, bool whole);
void job_keep(Job *j, bool last);

/* ---- state.c ---- */

/* Reads the state that was asked for, sees that it is of this render, and takes the film over and
 * where the render was. False: reported. */
bool job_find_state(Job *j);
/* The rest, once all is as it was before the first pass. False: reported. */
bool job_take_state(Job *j);
void job_clear_state(Job *j);

#endif
