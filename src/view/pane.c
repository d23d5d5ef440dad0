/* pane.c -- the thread behind a picture: it renders what is wanted, first small and then whole.
 *
 * Idea        After a change the picture comes at once, of so few pixels that a sample of each is
 *             a matter of some hundredths of a second; then of four times as many, until all are
 *             there and get more and more samples. The small one is finished even if the camera has
 *             moved on meanwhile: somebody who drags it would else see nothing till the end.
 * Sharing     Renders share what is in the scene, which does not change; each has a copy of the
 *             camera.
 * Asking      Every few milliseconds a render looks up whether it is still wanted (RenderWatch). */
#include "view/inside.h"

#include "base/clock.h"

#include <string.h>

#define LOOK_SECONDS 0.01               /* at most so long an unwanted render goes on */
#define FIRST_SECONDS 0.035             /* for the small picture */
enum { SCALE_MOST = 16, SCALE_FIRST = 8 };

/* A render of a pane. */
typedef struct {
    Pane     *pane;
    RenderSettings settings;
    Opts      integrator;
    Scene     scene;            /* a copy, with its own camera */
    uint64_t  wanted, method;   /* when it began */
    uint32_t  scale;
    bool      first;            /* the small picture */
    double    start, show_at;
} Shot;

/* ---- what is wanted ---- */

static bool still_wanted(const Shot *shot)
{
    Session *s = shot->pane->session;
    bool yes;

    pthread_mutex_lock(&s->lock);
    yes = !s->quit && !s->held && shot->pane->on && s->method == shot->method &&
          (shot->first || s->wanted == shot->wanted);
    pthread_mutex_unlock(&s->lock);
    return yes;
}

/* All that a render needs, under the lock. False: reported. */
static bool shot_init(Shot *shot, Pane *pane)
{
    Session *s = pane->session;
    const Scene *scene = s->file->scene;
    Camera *camera = mem_array(scene->camera->kind->bytes, 1);

    memset(shot, 0, sizeof *shot);
    shot->pane = pane;
    shot->settings = s->base;
    shot->settings.integrator = (const IntegratorKind *)pane->integrator.kind;
    shot->settings.integrator_opts = pane->integrator.opts;
    shot->settings.sampler = (const SamplerKind *)s->sampler.kind;
    shot->settings.sampler_opts = s->sampler.opts;
    shot->settings.filter = (const FilterKind *)s->filter.kind;
    shot->settings.filter_opts = s->filter.opts;
    shot->settings.threads = s->split && s->base.threads > 1 ? s->base.threads / 2
                                                             : s->base.threads;
    shot->wanted = s->wanted;
    shot->method = s->method;
    shot->scene = *scene;
    shot->scene.camera = camera;
    if (!camera)
        return false;
    memcpy(camera, scene->camera, scene->camera->kind->bytes);
    return true;
}

/* Where it stands, and in what: not under the lock, since it casts rays. */
static void place_camera(Shot *shot, const Pose *pose, bool moved)
{
    Scene *scene = &shot->scene;

    if (!moved || !pose_put(pose, scene->camera))
        return;
    if (scene->nmedia)
        scene->around = scene_medium_at(scene, v3((float)pose->eye[0], (float)pose->eye[1],
                                                  (float)pose->eye[2]), 0.0f);
}

/* ---- what is shown ---- */

static void show(const Shot *shot, const Film *film, const RenderReport *r)
{
    Pane *p = shot->pane;
    Session *s = p->session;
    Image im, old;

    if (!image_init(&im, film->w, film->h))
        return;
    film_picture(film, 0, &im);
    pthread_mutex_lock(&s->lock);
    old = p->image;
    p->image = im;
    p->scale = shot->scale;
    p->report = *r;
    p->of = shot->wanted;
    p->fresh = s->wanted == shot->wanted && shot->scale == 1;
    p->shown = ++s->change;
    pthread_cond_broadcast(&s->changed);
    pthread_mutex_unlock(&s->lock);
    image_clear(&old);
}

/* Pictures of all pixels: after the first pass, and then ever more rarely, up to once a second. */
static bool look(void *ctx, const Film *film, const RenderReport *r)
{
    Shot *shot = ctx;
    double now = clock_wall();

    if (!still_wanted(shot))
        return false;
    if (shot->scale == 1 && r->passes && now >= shot->show_at) {
        show(shot, film, r);
        shot->show_at = now + d_min(1.0, 0.1 + 0.1 * (now - shot->start));
    }
    return shot->scale > 1 || r->spp < shot->settings.spp;
}

/* ---- the render ---- */

static uint32_t scaled(uint32_t n, uint32_t scale) { return n / scale + (n % scale != 0); }

/* Methods that make passes by a plan of the whole would show nothing for long: they get none, and
 * look() ends them. */
static void set_size(RenderSettings *s, uint32_t scale)
{
    s->w = scaled(s->w, scale);
    s->h = scaled(s->h, scale);
    s->crop[0] /= scale;
    s->crop[1] /= scale;
    s->crop[2] = scaled(s->crop[2], scale);
    s->crop[3] = scaled(s->crop[3], scale);
    if (scale > 1)
        s->spp = 1;
    else if (s->integrator->batch)
        s->spp = 0;
}

static double pixels_of(const Shot *shot, uint32_t scale)
{
    const uint32_t *c = shot->settings.crop;
    return (double)scaled(c[2] - c[0], scale) * scaled(c[3] - c[1], scale);
}

static uint32_t first_scale(const Shot *shot)
{
    double rate = shot->pane->rate;
    uint32_t scale = 1;

    if (!(rate > 0))
        return SCALE_FIRST;
    while (scale < SCALE_MOST && pixels_of(shot, scale) > FIRST_SECONDS * rate)
        scale *= 2;
    return scale;
}

/* At one size. False: it is not wanted any more, or has failed, which is reported. */
static bool render_at(Shot *shot, uint32_t scale)
{
    RenderSettings s = shot->settings;
    RenderWatch watch = { shot, look, NULL, NULL, 0, 0, LOOK_SECONDS };
    RenderReport report;
    Film film;
    bool wanted;

    set_size(&s, scale);
    s.watch = &watch;
    shot->scale = scale;
    shot->start = clock_wall();
    shot->show_at = 0;
    if (!render(&shot->scene, &s, &film, &report))
        return false;
    wanted = still_wanted(shot) && report.passes;
    if (wanted)
        show(shot, &film, &report);
    if (wanted && shot->first)
        shot->pane->rate = pixels_of(shot, scale) / (clock_wall() - shot->start);
    film_clear(&film);
    return wanted;
}

static void render_all(Shot *shot)
{
    uint32_t scale = first_scale(shot);

    shot->first = true;
    for (; scale && render_at(shot, scale); scale /= 2)
        shot->first = false;
}

/* ---- the thread ---- */

/* Called and left under the lock. */
static void work(Pane *p)
{
    Session *s = p->session;
    Pose pose = s->pose;
    bool moved = s->moved;
    Shot shot;
    bool ok = shot_init(&shot, p);

    p->busy = true;
    p->done = shot.wanted;
    p->fresh = false;
    pthread_mutex_unlock(&s->lock);
    if (ok) {
        place_camera(&shot, &pose, moved);
        render_all(&shot);
    }
    mem_free(shot.scene.camera);
    pthread_mutex_lock(&s->lock);
    p->busy = false;
    pthread_cond_broadcast(&s->changed);
}

void *pane_run(void *arg)
{
    Pane *p = arg;
    Session *s = p->session;

    pthread_mutex_lock(&s->lock);
    while (!s->quit) {
        if (p->on && !s->held && p->done != s->wanted)
            work(p);
        else
            pthread_cond_wait(&s->changed, &s->lock);
    }
    pthread_mutex_unlock(&s->lock);
    return NULL;
}
