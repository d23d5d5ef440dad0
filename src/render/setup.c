/* setup.c -- a job made ready for its first sample, and cleared away after the last: which samples
 * are those of a share, tracers, samplers, the film. See job.h. */
#include "render/job.h"

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
    const RenderSettings *s = &j->settings;
    bool can = s->adaptive && integrator_adapts(s->integrator);
    const AdaptiveKind *kind = can ? s->adaptive : &adaptive_none;
    Opts o;

    if (kind == s->adaptive)
        o = s->adaptive_opts;
    else
        opts_default(&o, kind->info.options);
    return adaptive_init(&j->adaptive, kind, &o, j->film, s->spp, s->error, s->seed);
}

static bool stretch_canvas(Job *j)
{
    const RenderSettings *s = &j->settings;

    j->canvas.film = j->film;
    j->canvas.filter = &j->filter;
    aov_layers(s->aovs, s->naovs, &j->canvas);
    return film_accepts_splats(j->film);
}

/* ---- shares of a render ---- */

/* Whether a pass builds on what passes before it have left behind, or a pixel on those before it:
 * then a share is not some of the samples of the whole but a render of its own, with numbers of its
 * own. */
static bool has_own_numbers(const Job *j)
{
    const IntegratorKind *k = j->settings.integrator;
    return j->adapts || k->walk || (k->save && phases_are_anew(k));
}

/* The part i of n of so many; n at most as many. */
static uint32_t part_of(uint32_t all, uint32_t i, uint32_t n)
{
    return (uint32_t)((uint64_t)all * (i + 1) / n) - (uint32_t)((uint64_t)all * i / n);
}

/* Its number of samples and its seed, before the sampler plans with them. False: reported. */
static bool choose_own(Job *j)
{
    RenderSettings *s = &j->settings;

    if (!s->shards)
        return true;
    if (s->spp && s->spp < s->shards)
        return err_usage("--shard: %lu samples a pixel cannot be shared among %lu",
                         (unsigned long)s->spp, (unsigned long)s->shards);
    s->error *= sqrt(s->shards);
    if (!has_own_numbers(j))
        return true;
    s->spp = part_of(s->spp, s->shard, s->shards);
    s->seed = key_with(s->seed, (uint64_t)s->shards << 32 | s->shard);
    return true;
}

/* Otherwise, which samples of the whole. Where nobody knows how many these are, each share has a
 * run that is a power of two long and begins at a multiple of that, as patterns like it. */
static void choose_samples(Job *j)
{
    RenderSettings *s = &j->settings;
    uint32_t all = s->spp, run = 1;
    int bits = 32;

    j->planned = has_own_numbers(j) && s->shards ? j->asked->spp : all;
    j->most = UINT32_MAX;
    if (!s->shards || has_own_numbers(j))
        return;
    if (all) {
        j->base = (uint32_t)((uint64_t)all * s->shard / s->shards);
        s->spp = part_of(all, s->shard, s->shards);
        return;
    }
    for (; run < s->shards; run *= 2)
        bits--;
    j->most = bits < 32 ? (uint32_t)1 << bits : UINT32_MAX;
    j->base = bits < 32 ? s->shard << bits : 0;
}

/* ---- the job as a whole ---- */

static bool init_tracers(Job *j)
{
    const RenderSettings *s = &j->settings;
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
        if (j->tallies)
            j->tallies[i].by_technique = aov_needs_techniques(s->aovs, s->naovs);
        j->tracers[i].canvas = s->integrator->splats ? &j->canvas : NULL;
    }
    return true;
}

static bool init_samplers(Job *j)
{
    RenderSettings *s = &j->settings;
    Sampler *first = &j->tracers[0].sampler;

    if (!choose_own(j) || !sampler_init(first, s->sampler, &s->sampler_opts, s->seed, &s->spp))
        return false;
    choose_samples(j);
    for (int i = 1; i < s->threads; i++)
        j->tracers[i].sampler = *first;
    return true;
}

bool job_init(Job *j)
{
    RenderSettings *s = &j->settings;

    if (!init_tracers(j))
        return false;
    filter_init(&j->filter, s->filter, &s->filter_opts);
    j->integrator = integrator_open(s->integrator, j->scene, &s->integrator_opts);
    if (!j->integrator)
        return false;
    j->adapts = s->adaptive && s->adaptive->plan && integrator_adapts(s->integrator);
    return init_samplers(j) && film_init(j->film, s->w, s->h, s->crop, 1 + s->naovs) &&
           (!s->integrator->splats || stretch_canvas(j)) && adapt(j);
}

void job_clear(Job *j)
{
    integrator_close(j->integrator);
    if (j->tracers)
        sampler_clear(&j->tracers[0].sampler);
    adaptive_clear(&j->adaptive);
    job_clear_state(j);
    mem_free(j->tracers);
    mem_free(j->tallies);
    mem_free(j->rays_seen);
    mem_free(j->shots_seen);
    mem_free(j->done);
}
