/* race.c -- runs the methods of a race one after the other and measures them. See race.h.
 *
 * A render is looked at while it goes on (RenderWatch), so each sample is taken once; time that
 * measuring takes is not counted. Only a sampler whose numbers depend on how many samples are
 * planned is rendered anew for each checkpoint.
 *
 * With a reference r of its own noise, E|a - r|^2 = var a + var r + bias^2: var r is taken off, as
 * its two halves tell it [Cline07 (4.14)]. Without one, two renders of each method do: the first
 * one's pictures are kept until the second reaches the same checkpoints. */
#include "render/race.h"

#include "image/compare.h"

#include <string.h>

enum { SEED_SECOND = 1, SEED_REFERENCE = 2 };   /* keys of seeds that are not the user's */

typedef struct {
    const RaceOrder *order;
    const Scene     *scene;
    RenderSettings   base;
    Race            *race;
    Image     reference;        /* owned; empty without one */
    double    noise2, noise_rel;/* its own: sigma^2, relmse */
    Image     now;              /* owned: the film as a picture */
    Image     kept[RACE_LOOKS + 1];     /* owned: of the first of two renders */
    RacePoint first[RACE_LOOKS + 1];    /* and what was known of it */
    /* the render that runs */
    int       method, next, next_save;
    bool      second, saves;
    bool      failed;
} Runner;

static bool by_samples(const RaceOrder *o) { return o->nspp > 0; }
static int  looks(const RaceOrder *o) { return by_samples(o) ? o->nspp : o->nseconds; }
static bool in_pairs(const Runner *r) { return r->order->reference == REFERENCE_PAIR; }

/* ---- measuring ---- */

static bool film_whole(const Film *f)
{
    for (size_t i = 0; i < (size_t)f->w * f->h; i++)
        if (!f->counts[i])
            return false;
    return true;
}

static bool against_reference(Runner *r, RacePoint *p)
{
    ImageDifference d;
    double sigma2;

    if (!image_compare(&r->now, "the picture", &r->reference, "the reference", &d))
        return false;
    sigma2 = d.sigma * d.sigma - r->noise2;
    p->doubtful = r->noise2 > 0 && sigma2 < r->noise2;
    p->sigma_over_mu = sqrt(d_max(sigma2, 0)) / fabs(d.mean_r);
    p->relmse = d_max(d.relmse - r->noise_rel, 0);
    p->mean = d.mean_a;
    return true;
}

/* The second of two renders meets what was kept of the first. Budgets may differ a little where
 * time ends them: var a + var b = v/n + v/m is twice the variance at their harmonic mean. */
static bool against_first(Runner *r, int slot, RacePoint *p)
{
    const RacePoint *f = &r->first[slot];
    ImageNoise e;

    if (!f->known) {
        p->known = false;
        return true;
    }
    if (!image_noise(&r->now, "the picture", &r->kept[slot], "the first", &e))
        return false;
    p->sigma_over_mu = e.sigma_over_mu;                         /* [Cline07 (4.15)] */
    p->relmse = INFINITY;
    p->mean = 0.5 * (e.mean_a + e.mean_b);
    p->spp = 2 / (1 / p->spp + 1 / f->spp);
    p->seconds = 0.5 * (p->seconds + f->seconds);
    p->cpu_seconds = 0.5 * (p->cpu_seconds + f->cpu_seconds);
    return true;
}

static bool measure(Runner *r, int slot, const Film *film, const RenderReport *so_far)
{
    RacePoint p = { 0 };

    p.known = true;
    p.spp = so_far->spp;
    p.seconds = so_far->seconds;
    p.cpu_seconds = so_far->cpu_seconds;
    if (in_pairs(r) && !r->second) {
        if (!r->kept[slot].pixels && !image_init(&r->kept[slot], film->w, film->h))
            return false;
        film_picture(film, 0, &r->kept[slot]);
        r->first[slot] = p;
        return true;
    }
    film_picture(film, 0, &r->now);
    if (!(in_pairs(r) ? against_first(r, slot, &p) : against_reference(r, &p)))
        return false;
    r->race->result[r->method].point[slot] = p;
    return true;
}

/* ---- pictures ---- */

static bool save(const Runner *r, const Film *film, double seconds)
{
    const RaceOrder *o = r->order;
    Display plain = { 0 };
    Image im;
    bool ok;

    if (!o->noutputs)
        return true;
    ok = image_init(&im, film->w, film->h);
    if (ok)
        film_picture(film, 0, &im);
    for (int i = 0; ok && i < o->noutputs; i++) {
        char *name = race_picture_name(o->outputs[i], r->method, o->method[r->method].label,
                                       seconds);
        ok = name && image_write(&im, name, &plain);
        mem_free(name);
    }
    image_clear(&im);
    return ok;
}

/* ---- one render ---- */

static bool save_due(Runner *r, const Film *film, const RenderReport *so_far)
{
    const RaceOrder *o = r->order;

    for (; r->saves && r->next_save < o->nautosave && so_far->seconds >= o->autosave[r->next_save];
         r->next_save++)
        if (!save(r, film, o->autosave[r->next_save]))
            r->failed = true;
    return !r->failed;
}

static bool look(void *ctx, const Film *film, const RenderReport *so_far)
{
    Runner *r = ctx;
    const RaceOrder *o = r->order;
    int before = r->next, n = looks(o);

    while (r->next < n && (by_samples(o) ? so_far->spp >= o->spp[r->next]
                                         : so_far->seconds >= o->seconds[r->next]))
        r->next++;
    if (r->next > before && !measure(r, r->next - 1, film, so_far))
        r->failed = true;
    return save_due(r, film, so_far) && !r->failed && !(by_samples(o) && r->next == n);
}

/* Where the last picture of a render counts: at the checkpoint that it was on its way to. */
static bool last_look(Runner *r, const Film *film, const RenderReport *report)
{
    int n = looks(r->order), slot = r->next < n ? r->next : n - 1;

    if (!film_whole(film) || (by_samples(r->order) && r->next == n) ||
        (in_pairs(r) && report->interrupted))
        return true;
    return measure(r, by_samples(r->order) ? slot : report->interrupted ? slot : n - 1, film,
                   report);
}

static void use_method(RenderSettings *s, const RaceMethod *m)
{
    s->integrator = m->integrator;
    s->integrator_opts = m->integrator_opts;
    if (m->sampler) {
        s->sampler = m->sampler;
        s->sampler_opts = m->sampler_opts;
    }
}

/* Moments to look at: checkpoints but the last, which ends the render, and those of autosave. */
static int moments(const Runner *r, double *v)
{
    const RaceOrder *o = r->order;
    int n = 0, i = 0, k = 0, ends = by_samples(o) ? 0 : o->nseconds - 1;
    int saves = r->saves ? o->nautosave : 0;

    while (i < ends || k < saves)
        v[n++] = k == saves || (i < ends && o->seconds[i] <= o->autosave[k]) ? o->seconds[i++]
                                                                          : o->autosave[k++];
    return n;
}

static bool run_once(Runner *r, uint64_t seed)
{
    const RaceOrder *o = r->order;
    RenderSettings s = r->base;
    double seconds[2 * RACE_LOOKS];
    RenderWatch w = { r, look, o->spp, seconds, o->nspp, 0, 0 };
    RenderReport report;
    Film film;
    bool ok;

    use_method(&s, &o->method[r->method]);
    s.seed = seed;
    s.spp = by_samples(o) ? o->spp[o->nspp - 1] : 0;
    s.seconds = o->nseconds ? o->seconds[o->nseconds - 1] : 0;
    s.watch = &w;
    r->next = r->next_save = 0;
    r->saves = !r->second && o->noutputs;
    w.nseconds = moments(r, seconds);
    if (!render(r->scene, &s, &film, &report))
        return false;
    ok = !r->failed && last_look(r, &film, &report) && (r->second || save(r, &film, -1));
    r->race->interrupted = report.interrupted;
    film_clear(&film);
    return ok;
}

static bool look_to_save(void *ctx, const Film *film, const RenderReport *so_far)
{
    return save_due(ctx, film, so_far);
}

/* A render for each checkpoint; the pictures are those of the last. */
static bool run_fresh(Runner *r, uint64_t seed)
{
    const RaceOrder *o = r->order;
    RenderWatch w = { r, look_to_save, NULL, o->autosave, 0, o->nautosave, 0 };
    RenderReport report;
    Film film;

    r->next_save = 0;
    for (int k = 0; k < o->nspp && !r->race->interrupted; k++) {
        RenderSettings s = r->base;
        bool ok, last = k == o->nspp - 1;
        use_method(&s, &o->method[r->method]);
        s.seed = seed;
        s.spp = o->spp[k];
        s.seconds = o->nseconds ? o->seconds[o->nseconds - 1] : 0;
        r->saves = !r->second && o->noutputs && last;
        s.watch = r->saves ? &w : NULL;
        if (!render(r->scene, &s, &film, &report))
            return false;
        ok = !r->failed &&
             (report.interrupted || !film_whole(&film) || measure(r, k, &film, &report));
        if (ok && !r->second && (last || report.interrupted))
            ok = save(r, &film, -1);
        r->race->interrupted = report.interrupted;
        film_clear(&film);
        if (!ok)
            return false;
    }
    return true;
}

/* ---- the reference ---- */

static bool read_reference(Runner *r, int k, Image *im)
{
    const char *path = r->order->reference_file[k];

    if (!image_read(im, path, r->order->request.max_pixels))
        return false;
    if (im->w == r->now.w && im->h == r->now.h)
        return true;
    return err_at((Place){ path, 0, 0 }, "has %lu x %lu pixels, %lu x %lu as are rendered were "
                  "expected", (unsigned long)im->w, (unsigned long)im->h, (unsigned long)r->now.w,
                  (unsigned long)r->now.h);
}

static bool render_half(Runner *r, int k, Image *im)
{
    const RaceOrder *o = r->order;
    RenderSettings s = r->base;
    RenderReport report;
    Film film;
    uint64_t spp = (uint64_t)REFERENCE_TIMES * (by_samples(o) ? o->spp[o->nspp - 1] : 0);

    if (o->reference_method.integrator)
        use_method(&s, &o->reference_method);
    s.seed = key_with(key_with(s.seed, SEED_REFERENCE), (uint64_t)k);
    s.spp = o->reference_spp ? o->reference_spp : spp > UINT32_MAX ? UINT32_MAX : (uint32_t)spp;
    s.seconds = o->reference_seconds;
    if (s.seconds > 0 && !o->reference_spp)
        s.spp = 0;
    if (!s.spp && !(s.seconds > 0))
        s.seconds = REFERENCE_TIMES_SECONDS * o->seconds[o->nseconds - 1];
    note("reference, half %d of 2: %s, %s", k + 1, s.integrator->info.name, s.sampler->info.name);
    if (!render(r->scene, &s, &film, &report))
        return false;
    r->race->interrupted = report.interrupted;
    if (!image_init(im, film.w, film.h)) {
        film_clear(&film);
        return false;
    }
    film_picture(&film, 0, im);
    film_clear(&film);
    return true;
}

/* The mean of two pictures is the reference; each has half its variance in the mean. */
static bool join_halves(Runner *r, const Image *b)
{
    Image *a = &r->reference;
    ImageNoise e;

    if (!image_noise(a, "a half of the reference", b, "the other", &e))
        return false;
    for (size_t i = 0; i < (size_t)a->w * a->h; i++)
        a->pixels[i] = rgb_scale(rgb_add(a->pixels[i], b->pixels[i]), 0.5f);
    r->noise2 = 0.5 * e.sigma * e.sigma;                        /* [Cline07 (4.14)] */
    r->noise_rel = 0.5 * e.relmse;
    r->race->noise_known = true;
    r->race->noise_over_mu = e.sigma_over_mu * sqrt(0.5);
    return true;
}

static bool prepare_reference(Runner *r)
{
    const RaceOrder *o = r->order;
    ImageDifference d;
    Image b = { 0 };
    bool ok;

    if (o->reference == REFERENCE_PAIR)
        return true;
    if (o->reference == REFERENCE_FILES)
        ok = read_reference(r, 0, &r->reference) &&
             (!o->reference_file[1] || (read_reference(r, 1, &b) && join_halves(r, &b)));
    else
        ok = render_half(r, 0, &r->reference) &&
             (r->race->interrupted || (render_half(r, 1, &b) && join_halves(r, &b)));
    image_clear(&b);
    if (ok && image_compare(&r->reference, "", &r->reference, "", &d)) {
        r->race->mean = d.mean_r;
        if (!(fabs(d.mean_r) > 0))
            return err_at((Place){ o->reference_file[0], 0, 0 },
                          "the reference is black: there is no error relative to it");
    }
    return ok;
}

/* ---- methods ---- */

/* Two renders that are not independent do not tell the error. */
static bool warn_if_fixed(const Runner *r, const RaceMethod *m)
{
    const RaceOrder *o = r->order;
    bool seeded;

    return race_sampler_seeded(m, by_samples(o) ? o->spp[o->nspp - 1] : 0, &seeded) &&
           (seeded || warn_at((Place){ NULL, 0, 0 }, "%s: points of the sampler do not depend on "
                              "the seed, so two renders do not tell the error; a reference does",
                              m->label));
}

static bool run_method(Runner *r)
{
    const RaceOrder *o = r->order;
    RaceResult *result = &r->race->result[r->method];
    RaceMethod m = o->method[r->method];
    uint64_t seed = r->base.seed;
    bool ok;

    if (!m.sampler) {
        m.sampler = r->base.sampler;
        m.sampler_opts = r->base.sampler_opts;
    }
    result->label = m.label;
    result->sampler = m.sampler->info.name;
    memset(r->first, 0, sizeof r->first);
    r->second = false;
    note("method %d of %d: %s, %s", r->method + 1, o->nmethods, m.label, result->sampler);
    if (o->nspp > 1 &&
        !race_sampler_plans(&m, o->spp[0], o->spp[o->nspp - 1], &result->fresh))
        return false;
    if (in_pairs(r) && !warn_if_fixed(r, &m))
        return false;
    ok = result->fresh ? run_fresh(r, seed) : run_once(r, seed);
    if (ok && in_pairs(r) && !r->race->interrupted) {
        r->second = true;
        seed = key_with(seed, SEED_SECOND);
        ok = result->fresh ? run_fresh(r, seed) : run_once(r, seed);
    }
    race_finish(result);
    return ok;
}

/* ---- all together ---- */

static void runner_clear(Runner *r)
{
    image_clear(&r->reference);
    image_clear(&r->now);
    for (int i = 0; i <= RACE_LOOKS; i++)
        image_clear(&r->kept[i]);
    mem_free(r);
}

static bool warn_of_same(const RaceResult *r)
{
    return !r->n || r->point[r->n - 1].sigma_over_mu > 0 ||
           warn_at((Place){ NULL, 0, 0 }, "%s: two renders with different seeds are the same "
                   "picture, so they cannot tell its error; a reference can", r->label);
}

bool race_run(const RaceOrder *o, const Scene *scene, const RenderSettings *base, Race *race)
{
    Runner *r = MEM_NEW(Runner);
    bool ok;

    memset(race, 0, sizeof *race);
    if (!r)
        return false;
    r->order = o;
    r->scene = scene;
    r->base = *base;
    r->race = race;
    race->w = base->crop[2] - base->crop[0];
    race->h = base->crop[3] - base->crop[1];
    race->seed = base->seed;
    race->threads = base->threads;
    race->reference = o->reference;
    ok = image_init(&r->now, race->w, race->h) && prepare_reference(r);
    for (r->method = 0; ok && !race->interrupted && r->method < o->nmethods; r->method++) {
        ok = run_method(r);
        race->n += race->result[race->n].n > 0;
        if (ok && in_pairs(r))
            ok = warn_of_same(&race->result[r->method]);
    }
    race_conclude(race);
    runner_clear(r);
    return ok;
}
