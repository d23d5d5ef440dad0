/* session.c -- the state of a session, and what may be done to it. See session.h. */
#include "view/inside.h"

#include "base/work.h"
#include "sampling/sampler.h"

#include <stdio.h>
#include <string.h>
#include <time.h>

/* ---- what is said ---- */

/* An answer's, or for all: once on standard error, and in the log. */
static void take_line(void *ctx, const char *line)
{
    Session *s = ctx;
    Asker *a;
    int k = 0;

    pthread_mutex_lock(&s->log_lock);
    for (a = s->askers; a && !pthread_equal(a->thread, pthread_self()); a = a->next)
        ;
    while (k < s->nlog && strncmp(s->log[k], line, LINE_MOST - 1))
        k++;
    if (a)
        snprintf(a->said, LINE_MOST, "%s", line);
    else if (k == s->nlog) {
        if (s->nlog == LOG_MOST)
            memmove(s->log[0], s->log[1], (size_t)--s->nlog * LINE_MOST);
        snprintf(s->log[s->nlog++], LINE_MOST, "%s", line);
        fprintf(stderr, "%s\n", line);
    }
    pthread_mutex_unlock(&s->log_lock);
}

/* What earlier requests did wrong is theirs. */
void session_ask(Session *s, Asker *a)
{
    err_forgive();
    a->thread = pthread_self();
    a->said[0] = 0;
    pthread_mutex_lock(&s->log_lock);
    a->next = s->askers;
    s->askers = a;
    pthread_mutex_unlock(&s->log_lock);
}

void session_asked(Session *s, Asker *a)
{
    Asker **at = &s->askers;

    pthread_mutex_lock(&s->log_lock);
    while (*at != a)
        at = &(*at)->next;
    *at = a->next;
    pthread_mutex_unlock(&s->log_lock);
}

/* ---- beginning and end ---- */

static void choose(Choice *c, const void *kind, const Opts *o)
{
    c->kind = kind;
    c->opts = *o;
}

/* What the middle of the picture shows, or a place as far away as the scene is. */
static V3 pivot_of(const Scene *scene, const RenderSettings *s)
{
    Camera *c = scene->camera;
    V2 middle = { 0.5f * (float)s->w, 0.5f * (float)s->h };
    Hit h;
    Ray r;
    float far;

    c->kind->film(c, s->w, s->h);
    r = c->kind->ray(c, middle, (V2){ 0.5f, 0.5f }, 0.0f);
    if (scene_nearest(scene, &r, &h))
        return v_mad(r.d, h.t, r.o);
    far = v_dot(v_sub(scene->centre, r.o), r.d);
    return v_mad(r.d, f_max(far, 0.1f * scene->radius), r.o);
}

static bool start_panes(Session *s)
{
    for (int k = 0; k < PANES; k++) {
        Pane *p = &s->pane[k];
        p->session = s;
        p->on = k == 0;
        choose(&p->integrator, s->base.integrator, &s->base.integrator_opts);
        p->started = work_thread(&p->thread, pane_run, p);
        if (!p->started)
            return err_output(NULL, "no thread to render on can be made");
    }
    return true;
}

Session *session_new(SceneFile *f, const RenderSettings *base)
{
    Session *s = MEM_NEW(Session);

    if (!s)
        return NULL;
    s->file = f;
    s->base = *base;
    pthread_mutex_init(&s->setting, NULL);
    pthread_mutex_init(&s->lock, NULL);
    pthread_mutex_init(&s->log_lock, NULL);
    pthread_cond_init(&s->changed, NULL);
    choose(&s->sampler, base->sampler, &base->sampler_opts);
    choose(&s->filter, base->filter, &base->filter_opts);
    choose(&s->accel, base->accel, &base->accel_opts);
    pose_init(&s->first, f->scene->camera, pivot_of(f->scene, base));
    s->pose = s->first;
    s->wanted = s->change = s->method = 1;
    messages_to(take_line, s);
    if (start_panes(s))
        return s;
    session_free(s);
    return NULL;
}

void session_quit(Session *s)
{
    pthread_mutex_lock(&s->lock);
    s->quit = true;
    s->change++;
    pthread_cond_broadcast(&s->changed);
    pthread_mutex_unlock(&s->lock);
}

bool session_has_quit(Session *s)
{
    bool quit;

    pthread_mutex_lock(&s->lock);
    quit = s->quit;
    pthread_mutex_unlock(&s->lock);
    return quit;
}

void session_free(Session *s)
{
    if (!s)
        return;
    session_quit(s);
    for (int k = 0; k < PANES; k++) {
        if (s->pane[k].started)
            pthread_join(s->pane[k].thread, NULL);
        image_clear(&s->pane[k].image);
        arena_clear(&s->pane[k].integrator.arena);
    }
    messages_to(NULL, NULL);
    arena_clear(&s->sampler.arena);
    arena_clear(&s->filter.arena);
    arena_clear(&s->accel.arena);
    pthread_cond_destroy(&s->changed);
    pthread_mutex_destroy(&s->setting);
    pthread_mutex_destroy(&s->lock);
    pthread_mutex_destroy(&s->log_lock);
    mem_free(s);
}

/* ---- changes ---- */

/* Under the lock. method: not only the camera. */
static void want(Session *s, bool method)
{
    s->wanted++;
    s->change++;
    if (method)
        s->method++;
    pthread_cond_broadcast(&s->changed);
}

/* False: said. */
static bool parse_choice(Choice *c, const void *list, const char *what, const char *text)
{
    memset(c, 0, sizeof *c);
    c->kind = kind_from_text(list, what, text, &c->opts, &c->arena);
    if (!c->kind)
        arena_clear(&c->arena);
    return c->kind != NULL;
}

/* Nobody renders from here to release. Under the lock, which is given away meanwhile. */
static void hold(Session *s)
{
    s->held = true;
    while (s->pane[0].busy || s->pane[1].busy)
        pthread_cond_wait(&s->changed, &s->lock);
}

static void release(Session *s)
{
    s->held = false;
    want(s, true);
}

/* Options of a choice are borrowed by renders: they end before it goes. */
static void set_choice(Session *s, Choice *old, Choice *c)
{
    hold(s);
    arena_clear(&old->arena);
    *old = *c;
    s->pane[0].rate = s->pane[1].rate = 0;
    release(s);
}

/* If there is no room for new structures, the old ones are made again. Not under the lock: others
 * may look on. */
static bool build(Session *s, const Choice *c, const Choice *old)
{
    Scene *scene = s->file->scene;
    int threads = s->base.threads;
    bool ok;

    pthread_mutex_unlock(&s->lock);
    ok = scene_build_accels(scene, (const AccelKind *)c->kind, &c->opts, threads);
    if (!ok && !scene_build_accels(scene, (const AccelKind *)old->kind, &old->opts, threads))
        session_quit(s);                /* nothing is left that could be rendered */
    pthread_mutex_lock(&s->lock);
    return ok;
}

static bool set_accel(Session *s, Choice *c)
{
    Choice old = s->accel;
    bool ok;

    hold(s);
    ok = build(s, c, &old);
    if (ok)
        s->accel = *c;
    arena_clear(ok ? &old.arena : &c->arena);
    release(s);
    return ok;
}

static bool set_split(Session *s, const char *text)
{
    bool on = !strcmp(text, "on");

    if (!on && strcmp(text, "off"))
        return err_usage("split is on or off, not '%s'", text);
    s->split = on;
    s->pane[1].on = on;
    want(s, true);
    return true;
}

/* The list that a choice is made from, and where it is kept. */
typedef struct { const char *name, *what; const void *list; Choice *choice; } Setter;

static bool set_locked(Session *s, const char *what, const char *text)
{
    const Setter setters[] = {
        { "integrator", "integrator", integrators, &s->pane[0].integrator },
        { "integrator2", "integrator", integrators, &s->pane[1].integrator },
        { "sampler", "sampler", samplers, &s->sampler },
        { "filter", "filter", filters, &s->filter },
        { "accel", "accelerator", accels, &s->accel },
    };
    Choice c;

    if (!strcmp(what, "split"))
        return set_split(s, text);
    for (size_t k = 0; k < sizeof setters / sizeof *setters; k++)
        if (!strcmp(what, setters[k].name)) {
            if (!parse_choice(&c, setters[k].list, setters[k].what, text))
                return false;
            if (setters[k].choice == &s->accel)
                return set_accel(s, &c);
            set_choice(s, setters[k].choice, &c);
            return true;
        }
    return err_usage("there is no '%s' to be set", what);
}

bool session_set(Session *s, const char *what, const char *text)
{
    bool ok;

    pthread_mutex_lock(&s->setting);
    pthread_mutex_lock(&s->lock);
    ok = set_locked(s, what, text);
    pthread_mutex_unlock(&s->lock);
    pthread_mutex_unlock(&s->setting);
    return ok;
}

/* ---- the camera ---- */

/* How far the heights of the picture reach at the pivot, and the angle that one spans: by the rays
 * of a camera that stands as the pose says. */
static void measure(const Session *s, double *height, double *angle)
{
    const Camera *c = s->file->scene->camera;
    float x = 0.5f * (float)s->base.w, h = (float)s->base.h;
    V2 lens = { 0.5f, 0.5f };
    Ray top = c->kind->ray(c, (V2){ x, 0 }, lens, 0.0f);
    Ray bottom = c->kind->ray(c, (V2){ x, h }, lens, 0.0f);
    float d = (float)pose_distance(&s->pose);
    V3 apart = v_sub(v_mad(top.d, d, top.o), v_mad(bottom.d, d, bottom.o));

    *height = v_len(apart);
    *angle = v_len(v_sub(top.d, bottom.d));
}

/* Under the lock. False: there is no such move. */
static bool move(Session *s, const char *how, double x, double y, double z)
{
    double height, angle, r = s->file->scene->radius;

    measure(s, &height, &angle);
    if (!strcmp(how, "orbit"))
        pose_orbit(&s->pose, x * PI, y * PI);
    else if (!strcmp(how, "turn"))
        pose_turn(&s->pose, -x * angle, -y * angle);
    else if (!strcmp(how, "pan"))
        pose_shift(&s->pose, -x * height, -y * height, 0, true);
    else if (!strcmp(how, "zoom"))
        pose_zoom(&s->pose, md_exp(-y));
    else if (!strcmp(how, "walk"))
        pose_shift(&s->pose, x * r, y * r, z * r, true);
    else
        return false;
    return true;
}

bool session_move(Session *s, const char *how, double x, double y, double z)
{
    Pose old;
    bool ok;

    pthread_mutex_lock(&s->lock);
    old = s->pose;
    ok = move(s, how, x, y, z);
    if (ok && !pose_is_usable(&s->pose))
        s->pose = old;
    s->moved = s->moved || ok;
    if (ok)
        want(s, false);
    pthread_mutex_unlock(&s->lock);
    return ok;
}

/* Under the lock. */
static bool change_view(Session *s, const char *what)
{
    bool back = !strcmp(what, "previous");

    if (!strcmp(what, "save")) {
        if (s->nviews == VIEWS_MOST)
            return false;
        s->at = s->nviews;
        s->views[s->nviews++] = s->pose;
        s->change++;
        return true;
    }
    if (!strcmp(what, "first"))
        s->pose = s->first;
    else if (!back && strcmp(what, "next"))
        return false;
    else if (s->nviews) {
        s->at = (s->at + (back ? s->nviews - 1 : 1)) % s->nviews;
        s->pose = s->views[s->at];
        s->moved = true;
    }
    s->moved = s->moved && strcmp(what, "first");
    want(s, false);
    return true;
}

bool session_view(Session *s, const char *what)
{
    bool ok;

    pthread_mutex_lock(&s->lock);
    ok = change_view(s, what);
    pthread_cond_broadcast(&s->changed);
    pthread_mutex_unlock(&s->lock);
    return ok;
}

/* ---- what there is ---- */

int session_threads(const Session *s) { return s->base.threads; }

uint64_t session_wait(Session *s, uint64_t since, double seconds)
{
    struct timespec end;
    uint64_t change;
    int late = 0;

    clock_gettime(CLOCK_REALTIME, &end);
    end.tv_sec += (time_t)seconds;
    end.tv_nsec += (long)((seconds - floor(seconds)) * 1e9);
    if (end.tv_nsec >= 1000000000) {
        end.tv_nsec -= 1000000000;
        end.tv_sec++;
    }
    pthread_mutex_lock(&s->lock);
    while (!s->quit && s->change <= since && !late)
        late = pthread_cond_timedwait(&s->changed, &s->lock, &end);
    change = s->change;
    pthread_mutex_unlock(&s->lock);
    return change;
}

bool session_snapshot(Session *s, int pane, Snapshot *copy)
{
    const Pane *p = &s->pane[pane];
    bool ok;

    memset(copy, 0, sizeof *copy);
    pthread_mutex_lock(&s->lock);
    ok = p->image.pixels && image_init(&copy->image, p->image.w, p->image.h);
    if (ok) {
        memcpy(copy->image.pixels, p->image.pixels,
               (size_t)p->image.w * p->image.h * sizeof *p->image.pixels);
        copy->scale = p->scale;
        copy->shown = p->shown;
    }
    pthread_mutex_unlock(&s->lock);
    return ok;
}

bool session_pixel(Session *s, int pane, double x, double y, Rgb *c)
{
    const Pane *p = &s->pane[pane];
    bool ok = false;

    pthread_mutex_lock(&s->lock);
    if (p->image.pixels && x >= 0 && y >= 0) {
        double across = x / p->scale, down = y / p->scale;
        ok = across < p->image.w && down < p->image.h;
        if (ok)
            *c = *image_at(&p->image, (uint32_t)across, (uint32_t)down);
    }
    pthread_mutex_unlock(&s->lock);
    return ok;
}
