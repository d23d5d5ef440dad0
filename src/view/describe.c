/* describe.c -- tables and states as JSON: describe.h, and session_describe of session.h. */
#include "view/describe.h"

#include "base/number.h"
#include "image/denoise.h"
#include "view/inside.h"

#include <stdio.h>
#include <string.h>

/* ---- tables ---- */

static void number(Json *j, const char *key, double v)
{
    json_key(j, key);
    json_number(j, v);
}

static void string(Json *j, const char *key, const char *v)
{
    json_key(j, key);
    json_string(j, v);
}

/* As the command line would have it: "0.5", "true", "1/0.5/0.2", "sah". */
static void value_text(const OptDef *d, const OptValue *v, char *out, size_t room)
{
    char n[3][NUMBER_MAX];

    number_print_double(n[0], v->num);
    if (d->type == OPT_BOOL)
        snprintf(out, room, "%s", v->num != 0 ? "true" : "false");
    else if (d->type == OPT_INT || d->type == OPT_FLOAT)
        snprintf(out, room, "%s", n[0]);
    else if (d->type == OPT_RGB || d->type == OPT_POINT) {
        number_print_float(n[0], v->rgb.r);
        number_print_float(n[1], v->rgb.g);
        number_print_float(n[2], v->rgb.b);
        snprintf(out, room, "%s/%s/%s", n[0], n[1], n[2]);
    } else
        snprintf(out, room, "%s", v->str ? v->str : "");
}

static void describe_option(Json *j, const OptDef *d, const OptValue *v)
{
    char text[200];

    json_open(j, '{');
    string(j, "key", d->key);
    string(j, "type", opt_type_names[d->type]);
    value_text(d, v, text, sizeof text);
    string(j, "value", text);
    if (d->type == OPT_CHOICE)
        string(j, "choices", d->choices);
    if (d->lo < d->hi) {
        number(j, "lo", d->lo);
        number(j, "hi", d->hi);
    }
    string(j, "help", d->help);
    json_close(j, '}');
}

static void describe_kind(Json *j, const KindInfo *kind)
{
    Opts o;

    opts_default(&o, kind->options);
    json_open(j, '{');
    string(j, "name", kind->name);
    string(j, "summary", kind->summary);
    json_key(j, "options");
    json_open(j, '[');
    for (int i = 0; o.defs && o.defs[i].key; i++)
        if (o.defs[i].type != OPT_NUMBERS)      /* those are for scene files */
            describe_option(j, &o.defs[i], &o.value[i]);
    json_close(j, ']');
    json_close(j, '}');
}

void describe_tables(Json *j)
{
    static const struct { const char *name; const void *list; } SETS[] = {
        { "integrators", integrators }, { "accelerators", accels }, { "samplers", samplers },
        { "filters", filters }, { "tonemaps", tonemaps }, { "meters", meters },
        { "denoisers", denoisers },
    };

    json_open(j, '{');
    for (size_t s = 0; s < sizeof SETS / sizeof *SETS; s++) {
        json_key(j, SETS[s].name);
        json_open(j, '[');
        for (size_t k = 0; kind_info(SETS[s].list, k); k++)
            describe_kind(j, kind_info(SETS[s].list, k));
        json_close(j, ']');
    }
    json_close(j, '}');
}

/* ---- the state ---- */

static void describe_choice(Json *j, const char *key, const Choice *c)
{
    char text[200];

    json_key(j, key);
    json_open(j, '{');
    string(j, "name", c->kind->name);
    json_key(j, "values");
    json_open(j, '{');
    for (int i = 0; c->opts.defs && c->opts.defs[i].key; i++) {
        value_text(&c->opts.defs[i], &c->opts.value[i], text, sizeof text);
        string(j, c->opts.defs[i].key, text);
    }
    json_close(j, '}');
    json_close(j, '}');
}

static void describe_pane(Json *j, const Pane *p)
{
    const RenderReport *r = &p->report;

    json_open(j, '{');
    describe_choice(j, "integrator", &p->integrator);
    number(j, "of", (double)p->of);
    number(j, "shown", (double)p->shown);
    number(j, "scale", p->scale);
    json_key(j, "fresh");
    json_bool(j, p->fresh);
    json_key(j, "busy");
    json_bool(j, p->busy);
    number(j, "passes", r->passes);
    number(j, "spp", r->spp);
    number(j, "samples", (double)r->samples);
    number(j, "rays", (double)r->rays);
    number(j, "seconds", r->seconds);
    number(j, "cpu", r->cpu_seconds);
    json_close(j, '}');
}

/* "Transform [...]", the world to the camera by columns: what a scene file has before its Camera to
 * let it stand here. */
static void describe_camera(Json *j, const Pose *p)
{
    char text[20 * NUMBER_MAX] = "Transform [", n[NUMBER_MAX];
    size_t at = strlen(text);
    double m[4][4];
    Transform t;

    pose_matrix(p, m);
    if (!xf_from(&t, m))
        return;
    for (int k = 0; k < 16; k++) {
        number_print_float(n, (float)t.inv[k % 4][k / 4]);
        at += (size_t)snprintf(text + at, sizeof text - at, "%s%s", k ? " " : "", n);
    }
    snprintf(text + at, sizeof text - at, "]");
    string(j, "transform", text);
}

static void describe_log(Json *j, Session *s)
{
    json_key(j, "messages");
    json_open(j, '[');
    pthread_mutex_lock(&s->log_lock);
    for (int k = 0; k < s->nlog; k++)
        json_string(j, s->log[k]);
    pthread_mutex_unlock(&s->log_lock);
    json_close(j, ']');
}

static void describe_scene(Json *j, const Session *s)
{
    const Scene *scene = s->file->scene;
    const uint32_t *c = s->base.crop;

    number(j, "w", c[2] - c[0]);
    number(j, "h", c[3] - c[1]);
    number(j, "spp", s->base.spp);
    number(j, "threads", s->base.threads);
    number(j, "lights", (double)scene->nlights);
    number(j, "primitives", scene->accel && !s->held ? (double)geometry_prims(scene->accel->geo)
                                                     : 0);
}

void session_describe(Session *s, Json *j)
{
    pthread_mutex_lock(&s->lock);
    json_open(j, '{');
    number(j, "change", (double)s->change);
    number(j, "wanted", (double)s->wanted);
    describe_scene(j, s);
    json_key(j, "split");
    json_bool(j, s->split);
    json_key(j, "building");
    json_bool(j, s->held);
    describe_choice(j, "accel", &s->accel);
    describe_choice(j, "sampler", &s->sampler);
    describe_choice(j, "filter", &s->filter);
    json_key(j, "panes");
    json_open(j, '[');
    for (int k = 0; k < PANES; k++)
        describe_pane(j, &s->pane[k]);
    json_close(j, ']');
    number(j, "views", s->nviews);
    number(j, "view", s->at);
    describe_camera(j, &s->pose);
    describe_log(j, s);
    json_close(j, '}');
    pthread_mutex_unlock(&s->lock);
}
