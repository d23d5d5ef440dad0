/* state.c -- a render in a file, to go on another day or to be added to others.
 *
 * File        "rushlight state" and a format number; a text of lines "word value" that tells what
 *             is rendered; the film; where the render is; what the policy and the method keep. All
 *             as base/archive.h has it. Shares of a render are such files too: merge reads the text
 *             and the film, and no more.
 * Same render A state is taken by a render that its own text equals, but for what may change
 *             between two days: threads, budgets, names of outputs. How many samples there shall be
 *             is in it only where some number depends on that: the sampler's, a policy's, or which
 *             samples are this share's. The scene is known by a digest of all its files.
 * When        Units are whole or, if they are tiles, left between two pixels (Job.done), so the
 *             samples of the render that goes on are those that would have come, and as sums are
 *             exact, its bytes are the same. What phases make for the camera samples of a pass is
 *             not kept but made again (see `save` in integrator.h). */
#include "render/state.h"

#include "base/clock.h"
#include "base/number.h"
#include "base/text.h"
#include "base/version.h"
#include "render/job.h"

#include <stdarg.h>
#include <stdio.h>
#include <string.h>

static const char MAGIC[] = "rushlight state";          /* with its final 0: 16 bytes */
enum { FORMAT = 1, TEXT_MOST = 1 << 16 };

/* ---- what is rendered ---- */

/* A line of the text, or a part of it; false: no memory, reported. */
static bool say(Identity *t, const char *fmt, ...) PRINTF_LIKE(2, 3);
static bool say(Identity *t, const char *fmt, ...)
{
    char part[400];
    va_list args;
    size_t n;

    va_start(args, fmt);
    vsnprintf(part, sizeof part, fmt, args);
    va_end(args);
    n = strlen(part);
    if (!mem_grow(&t->text, &t->cap, t->n + n + 1, 1))
        return false;
    memcpy(t->text + t->n, part, n + 1);
    t->n += n;
    return true;
}

static const char *number(char text[NUMBER_MAX], double v)
{
    number_print_double(text, v);
    return text;
}

static bool say_option(Identity *t, const OptDef *d, const OptValue *v)
{
    char a[NUMBER_MAX], b[NUMBER_MAX], c[NUMBER_MAX];

    switch (d->type) {
    case OPT_RGB: case OPT_POINT:
        return say(t, " %s=%s,%s,%s", d->key, number(a, (double)v->rgb.r),
                   number(b, (double)v->rgb.g), number(c, (double)v->rgb.b));
    case OPT_STRING: case OPT_CHOICE:
        return say(t, " %s=%.300s", d->key, v->str ? v->str : "");
    case OPT_NUMBERS:
        return true;            /* of scene files alone, whose digest there is */
    default:
        return say(t, " %s=%s", d->key, number(a, v->num));
    }
}

static bool say_kind(Identity *t, const char *what, const KindInfo *kind, const Opts *o)
{
    if (!say(t, "%s %s", what, kind->name))
        return false;
    for (int i = 0; kind->options && kind->options[i].key; i++)
        if (!say_option(t, &kind->options[i], &o->value[i]))
            return false;
    return say(t, "\n");
}

static bool say_picture(Identity *t, const RenderSettings *s)
{
    if (!say(t, "picture %lux%lu window %lu,%lu,%lu,%lu\nlayers", (unsigned long)s->w,
             (unsigned long)s->h, (unsigned long)s->crop[0], (unsigned long)s->crop[1],
             (unsigned long)s->crop[2], (unsigned long)s->crop[3]))
        return false;
    for (int i = 0; i < s->naovs; i++) {
        char name[AOV_NAME];
        if (!say(t, " %s", aov_layer(&s->aovs[i], name, sizeof name)))
            return false;
    }
    return say(t, "\n");
}

/* What it aims at, as far as that has a part in any number. */
static bool say_aim(Identity *t, const Job *j)
{
    const RenderSettings *s = j->asked;
    char error[NUMBER_MAX];

    if (j->adapts)
        return say(t, "samples %lu error %s\n", (unsigned long)j->planned,
                   number(error, s->error));
    if (s->sampler->plans || s->shards)
        return say(t, "samples %lu\n", (unsigned long)j->planned);
    return say(t, "samples as many as wanted\n");
}

/* In lines of a word and a value. False: no memory, reported. */
static bool identify(Job *j)
{
    const RenderSettings *s = j->asked;
    Identity *t = &j->identity;

    return say(t, "version " RUSHLIGHT_VERSION "\nscene %08lx%08lx\n",
               (unsigned long)(s->scene_digest >> 32),
               (unsigned long)(s->scene_digest & 0xFFFFFFFFu)) &&
           say_kind(t, "integrator", &s->integrator->info, &s->integrator_opts) &&
           say_kind(t, "sampler", &s->sampler->info, &s->sampler_opts) &&
           say_kind(t, "filter", &s->filter->info, &s->filter_opts) &&
           say_kind(t, "accelerator", &s->accel->info, &s->accel_opts) &&
           say_kind(t, "adaptive", &j->adaptive.kind->info, &j->adaptive.opts) &&
           say_picture(t, s) && say_aim(t, j) &&
           say(t, "seed %llu\n", (unsigned long long)s->seed) &&
           (!s->shards || say(t, "shard %lu/%lu\n", (unsigned long)s->shard + 1,
                              (unsigned long)s->shards));
}

/* ---- writing ---- */

static void save_head(const Job *j, Saving *s)
{
    save_bytes(s, MAGIC, sizeof MAGIC);
    save_u32(s, FORMAT);
    save_u32(s, (uint32_t)j->identity.n);
    save_bytes(s, j->identity.text, j->identity.n);
    film_save_shape(j->film, s);
}

/* Where the render is: the pass, and what is done of it. */
static void save_place(const Job *j, Saving *s)
{
    uint64_t n = j->left_at ? j->nleft : j->midway ? j->phase_units : 0;

    save_double(s, clock_wall() - j->start);
    save_double(s, clock_cpu() - j->cpu);
    save_u64(s, j->rays);
    save_u32(s, j->pass);
    save_u32(s, j->first);
    save_u32(s, j->count);
    save_u32(s, n ? (uint32_t)((j->left_at ? j->left_phase : j->phase) + 1) : 0);
    save_u64(s, n);
    for (uint64_t i = 0; i < n; i++) {
        bool again = j->left_at && (j->phase != j->left_phase || j->done[i] != UNIT_DONE);
        save_u32(s, again ? j->left_at[i] : j->done[i]);
    }
}

bool state_write(const Job *j, const char *path)
{
    const IntegratorKind *k = j->integrator->kind;
    Saving s;

    if (!save_begin(&s, path))
        return false;
    save_head(j, &s);
    film_save(j->film, &s);
    save_place(j, &s);
    if (j->adapts)
        adaptive_save(&j->adaptive, &s);
    if (k->save)
        k->save(j->integrator, &s);
    return save_end(&s);
}

/* ---- reading ---- */

static bool read_head(StateHead *h, const char *path)
{
    Place at = { path, 0, 0 };
    const char *magic = load_bytes(&h->rest, sizeof MAGIC);
    uint32_t format = load_u32(&h->rest);

    if (!magic || memcmp(magic, MAGIC, sizeof MAGIC))
        return err_at(at, "is not the state of a render");
    if (!load_whole(&h->rest, path))
        return false;
    if (format != FORMAT)
        return err_at(at, "has format %lu, this program writes and reads %d",
                      (unsigned long)format, FORMAT);
    h->ntext = load_u32(&h->rest);
    if (h->ntext > TEXT_MOST || !(h->text = load_bytes(&h->rest, h->ntext)) ||
        !film_load_shape(&h->shape, &h->rest) ||
        film_bytes_saved(&h->shape) > (double)load_left(&h->rest))
        return err_at(at, "is not whole");
    return true;
}

bool state_read_head(StateHead *h, const char *path, uint64_t limit)
{
    memset(h, 0, sizeof *h);
    if (!load_begin(&h->rest, path, limit))
        return false;
    if (read_head(h, path))
        return true;
    load_clear(&h->rest);
    return false;
}

/* The lines in which two texts differ first; false: in none. n: bytes of each, without its end. */
static bool first_difference(const char *a, size_t na, const char *b, size_t nb, Word line[2])
{
    Text t[2], rest[2];

    text_init(&t[0], NULL, a, na);
    text_init(&t[1], NULL, b, nb);
    for (;;) {
        bool more = false;
        for (int k = 0; k < 2; k++) {
            line[k] = (Word){ "", 0 };
            if (text_line(&t[k], &rest[k])) {
                line[k] = (Word){ rest[k].at, (size_t)(rest[k].end - rest[k].at) };
                more = true;
            }
        }
        if (!more)
            return false;
        if (line[0].n != line[1].n || memcmp(line[0].s, line[1].s, line[0].n))
            return true;
    }
}

static bool is_of_this_render(const Job *j, const StateHead *h)
{
    Place at = { j->settings.resume, 0, 0 };
    Word line[2];
    char his[200], ours[200];

    if (!first_difference(h->text, h->ntext, j->identity.text, j->identity.n, line))
        return film_has_shape(j->film, &h->shape) || err_at(at, "does not fit this render");
    if (line[0].n > 6 && !memcmp(line[0].s, "scene ", 6))
        return err_at(at, "is of another scene, or a file of the scene has changed since");
    return err_at(at, "is of another render: it has '%s', this one '%s'",
                  word_copy(his, sizeof his, line[0]), word_copy(ours, sizeof ours, line[1]));
}

static bool load_place(Job *j, Loading *l)
{
    uint32_t phase;

    j->start = -load_double(l);
    j->cpu = -load_double(l);
    j->rays = load_u64(l);
    j->pass = load_u32(l);
    j->first = load_u32(l);
    j->count = load_u32(l);
    phase = load_u32(l);
    j->left_phase = (int)(phase & 0xFFFF) - 1;
    j->nleft = load_u64(l);
    if (l->beyond || (int64_t)phase > j->integrator->kind->phases ||
        j->nleft > load_left(l) / sizeof *j->left_at || !(j->start <= 0) || !(j->cpu <= 0) ||
        j->count > UINT32_MAX - j->first)
        return err_at((Place){ j->settings.resume, 0, 0 }, "does not fit this render");
    if (!j->nleft)
        return true;
    j->left_at = MEM_ARRAY(uint32_t, (size_t)j->nleft);
    for (uint64_t i = 0; j->left_at && i < j->nleft; i++)
        j->left_at[i] = load_u32(l);
    return j->left_at != NULL;
}

bool job_find_state(Job *j)
{
    const RenderSettings *s = &j->settings;
    StateHead h;

    if (!s->keeper && !s->resume)
        return true;
    if (!identify(j))
        return false;
    if (!s->resume)
        return true;
    if (!state_read_head(&h, s->resume, s->max_file))
        return false;
    j->state = h.rest;
    j->pending = true;
    if (!is_of_this_render(j, &h))
        return false;
    return (film_load(j->film, &j->state) ||
            err_at((Place){ s->resume, 0, 0 }, "is not whole")) && load_place(j, &j->state);
}

bool job_take_state(Job *j)
{
    const IntegratorKind *k = j->integrator->kind;
    bool fits = (!j->adapts || adaptive_load(&j->adaptive, &j->state)) &&
                (!k->load || k->load(j->integrator, &j->state)) &&
                !j->state.beyond && load_left(&j->state) == 0;

    load_clear(&j->state);
    j->pending = false;
    return fits || err_at((Place){ j->settings.resume, 0, 0 }, "does not fit this render");
}

void job_clear_state(Job *j)
{
    load_clear(&j->state);
    mem_free(j->identity.text);
    mem_free(j->left_at);
}
