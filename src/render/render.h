/* render.h -- the driver: it owns threads, budgets, film and progress, and runs an integrator's
 * units of work. What it makes depends on scene, settings and seed alone, not on threads. */
#ifndef RENDER_RENDER_H
#define RENDER_RENDER_H

#include "image/filter.h"
#include "integrators/integrator.h"
#include "render/adaptive.h"
#include "render/aov.h"
#include "scenefile/scenefile.h"

#include <signal.h>

/* ---- settings ---- */

enum { OUTPUTS_MAX = 8, AOVS_ASKED = 16 };
enum { AOVS_MAX = 30 };                 /* with what those asked for need: a bit of 31 each */

typedef struct {
    double   seconds, cpu_seconds;      /* of rendering alone */
    uint64_t samples, rays;             /* with splats, shots are what is counted */
    double   spp;                       /* samples a pixel: their mean; of whole passes, if the
                                         * integrator does not give radiance along a ray */
    uint32_t passes;                    /* whole ones */
    double   before;                    /* seconds of phases before camera samples */
    PathWork work;                      /* of this run, known when it is over */
    bool     interrupted;
} RenderReport;

/* Somebody who looks at the picture while it is made, at whole passes after which each pixel has
 * spp[k] samples, and (from the first whole pass on, and within a pass only if the integrator gives
 * radiance along a ray) when seconds[k] of rendering have passed: some tiles then have had samples
 * that others have not yet had. What `look` takes itself is not counted as rendering. Both lists
 * rise and are borrowed.
 * With `every`, besides, so many seconds after each look, wherever the render is, if it has not
 * taken a single sample yet: for those who show the picture to somebody, or may want to end it. */
typedef struct {
    void *ctx;
    bool (*look)(void *ctx, const Film *film, const RenderReport *so_far);    /* false: end */
    const uint32_t *spp;
    const double   *seconds;
    int nspp, nseconds;
    double every;               /* 0: no */
} RenderWatch;

/* Somebody who keeps what there is, so that nothing is lost and the render can go on another day:
 * called every so often seconds, between units, and once at the end, however that came; there is
 * nobody to call before the first sample. Seconds are counted as by RenderWatch. */
typedef struct Job Job;
typedef struct {
    void *ctx;
    double every;               /* 0: at the end alone */
    void (*keep)(void *ctx, const Job *state, const Film *film, const RenderReport *so_far,
                 bool last);
} RenderKeeper;

typedef struct {
    const IntegratorKind *integrator;   Opts integrator_opts;
    const SamplerKind    *sampler;      Opts sampler_opts;
    const FilterKind     *filter;       Opts filter_opts;
    const AccelKind      *accel;        Opts accel_opts;
    const AdaptiveKind   *adaptive;     Opts adaptive_opts;     /* NULL: all pixels alike */
    uint32_t w, h, crop[4];             /* picture; window x0 y0 x1 y1, half open */
    uint32_t spp;                       /* samples a pixel, where it adapts their mean or, with an
                                         * error to reach, the most; 0: another budget ends it */
    double   seconds;                   /* of rendering; 0: no limit */
    double   error;                     /* stop at this estimated sigma/mu; 0: do not */
    int      threads;
    uint64_t seed;
    Aov      aovs[AOVS_MAX];
    int      naovs;
    const volatile sig_atomic_t *stop;  /* nonzero: end soon; NULL: nobody asks */
    const RenderWatch *watch;           /* NULL: nobody looks */
    const RenderKeeper *keeper;         /* NULL: nobody keeps anything */
    uint64_t scene_digest;              /* of its files, for states */
    const char *resume;                 /* state to go on from, or NULL; borrowed */
    uint64_t max_file;                  /* bytes of that */
    uint32_t shard, shards;             /* share number `shard` of so many; 0: the whole */
} RenderSettings;

/* What the command line asked for, as text; NULL or 0 where it said nothing. */
typedef struct {
    const char *integrator, *sampler, *filter, *accel, *adaptive;
    const char *aovs[AOVS_ASKED];
    int      naovs;
    uint32_t w, h, crop[4];
    bool     crop_given, seed_given;
    uint32_t spp;
    double   seconds, error;
    int      threads;
    uint64_t seed, max_pixels;
    const char *resume;
    uint32_t shard, shards;             /* from 0 on, of so many; 0: the whole */
} RenderRequest;

/* Command line before scene file before defaults. Fills the camera's film size. False: reported. */
bool settings_resolve(RenderSettings *s, const RenderRequest *q, SceneFile *f);
/* A part of that: the policy, for the integrator that s has. Text of options goes to the arena. */
bool settings_adaptive(RenderSettings *s, const RenderRequest *q, Arena *arena);
/* Sees to it that the scene has a camera (a bare mesh gets a sky too). False: reported. */
bool settings_camera(SceneFile *f);
/* The file name that the scene gives for its picture, or NULL. Borrowed from f. */
const char *settings_filename(const SceneFile *f);

/* The number of the aov of this kind; if there is none, one without a file is added, for what
 * else needs it. At most 12 such. */
int settings_aov(RenderSettings *s, AovKind kind, int which);
/* Whether the integrator can give those that were asked for; adds what they need. False: usage
 * error reported. */
bool settings_aovs_fit(RenderSettings *s);

/* Renders into *film, which it makes (layer 0: the picture; 1 + k: aov k). The scene must be
 * built. False: reported, *film empty. */
bool render(const Scene *scene, const RenderSettings *s, Film *film, RenderReport *report);

/* ---- states and shares in files: see state.c ---- */

/* Writes what a render has by now: the film, and what it needs to go on as if never stopped.
 * False: reported, an old file is as it was. */
bool state_write(const Job *j, const char *path);

#endif
