/* aov.c -- extra pictures: what the eye ray meets first, and the light apart by path length and by
 * strategy. See render.h. */
#include "render/render.h"

#include "base/number.h"
#include "base/text.h"

#include <string.h>

static const char *const names[] = { "normal", "depth", "albedo", "length", "strategy", "samples" };
enum { NAMES = sizeof names / sizeof names[0] };

static bool parse_which(Aov *a, const char *arg, size_t n)
{
    int64_t v;

    if (a->kind == AOV_LENGTH) {
        if (!n || number_int(arg, arg + n, &v, NULL) != n || v < 1 || v >= TALLY_LENGTHS)
            return err_usage("--aov length:N takes N from 1 to %d edges", TALLY_LENGTHS - 1);
        a->which = (int)v;
        return true;
    }
    for (int k = 0; k < STRATEGIES; k++)
        if (strlen(strategy_names[k]) == n && !memcmp(strategy_names[k], arg, n)) {
            a->which = k;
            return true;
        }
    return err_usage("--aov strategy:NAME takes implicit, explicit, lens or merge");
}

bool aov_parse(Aov *a, const char *text)
{
    size_t name = strcspn(text, ":="), all = strcspn(text, "=");
    char word[40], hint[HINT_MAX];

    if (!text[all] || !text[all + 1])
        return err_usage("--aov takes NAME=FILE, with NAME one of normal depth albedo length:N "
                         "strategy:NAME samples");
    a->text = text;
    a->file = text + all + 1;
    if (!image_format_for_writing(a->file))
        return false;
    for (int k = 0; k < NAMES; k++)
        if (strlen(names[k]) == name && !memcmp(names[k], text, name)) {
            bool takes = k == AOV_LENGTH || k == AOV_STRATEGY;
            a->kind = (AovKind)k;
            a->which = 0;
            if (takes)
                return parse_which(a, text + name + (name < all), all - name - (name < all));
            return name == all || err_usage("--aov %s takes nothing after ':'", names[k]);
        }
    word_copy(word, sizeof word, (Word){ text, name });
    return err_usage("unknown --aov '%s'%s (have: normal depth albedo length:N strategy:NAME "
                     "samples)", word, hint_nearest(hint, word, names, NAMES));
}

bool aov_needs_tally(const Aov *a, int n)
{
    for (int i = 0; i < n; i++)
        if (a[i].kind == AOV_LENGTH || a[i].kind == AOV_STRATEGY)
            return true;
    return false;
}

void aov_layers(const Aov *a, int n, Canvas *c)
{
    for (int edges = 0; edges < TALLY_LENGTHS; edges++)
        for (int how = 0; how < STRATEGIES; how++) {
            c->layers[edges][how] = 1;
            for (int k = 0; k < n; k++)
                if ((a[k].kind == AOV_LENGTH && a[k].which == edges) ||
                    (a[k].kind == AOV_STRATEGY && a[k].which == how))
                    c->layers[edges][how] |= (uint32_t)2 << k;
        }
}

bool aov_needs_hit(const Aov *a, int n)
{
    for (int i = 0; i < n; i++)
        if (a[i].kind == AOV_NORMAL || a[i].kind == AOV_DEPTH || a[i].kind == AOV_ALBEDO)
            return true;
    return false;
}

/* The shading normal, bumps included. */
static Rgb normal_at(const Tracer *t, const Surface *s)
{
    V3 n = material_frame(&t->scene->materials[s->shape->material], s).n;
    return rgb(n.x, n.y, n.z);
}

static Rgb albedo_at(const Tracer *t, const Ray *r, const Surface *s)
{
    const Material *m = &t->scene->materials[s->shape->material];
    Frame f = material_frame(m, s);
    BsdfRoom room;
    const Bsdf *b = material_bsdf(m, s, &room);
    return b->kind->albedo(b, frame_in(&f, v_neg(r->d)));
}

void aov_values(const Aov *a, int n, const Ray *r, Tracer *t, Rgb *values)
{
    Surface s;
    bool hit = false;
    Hit h;

    if (aov_needs_hit(a, n)) {
        hit = tracer_nearest(t, r, &h);
        if (hit)
            accel_surface(t->scene->accel, r, &h, &s);
    }
    for (int i = 0; i < n; i++) {
        values[i] = rgb_all(0.0f);
        switch (a[i].kind) {
        case AOV_NORMAL:   if (hit) values[i] = normal_at(t, &s); break;
        case AOV_DEPTH:    if (hit) values[i] = rgb_all(h.t); break;
        case AOV_ALBEDO:   if (hit) values[i] = albedo_at(t, r, &s); break;
        case AOV_LENGTH:   values[i] = t->tally->length[a[i].which]; break;
        case AOV_SAMPLES:  break;
        case AOV_STRATEGY: values[i] = t->tally->strategy[a[i].which]; break;
        }
    }
}

void aov_picture(const Aov *a, const Film *f, int k, Image *im)
{
    if (a->kind == AOV_SAMPLES)
        film_counts(f, im);
    else
        film_picture(f, 1 + k, im);
}

void aov_display(const Aov *a, Image *im)
{
    size_t n = (size_t)im->w * im->h;
    bool scaled = a->kind == AOV_DEPTH || a->kind == AOV_SAMPLES;
    float most = 0.0f;

    for (size_t i = 0; i < n && scaled; i++)
        most = f_max(most, im->pixels[i].r);
    for (size_t i = 0; i < n; i++) {
        Rgb *p = &im->pixels[i];
        if (a->kind == AOV_NORMAL && !rgb_black(*p))
            *p = rgb(0.5f + 0.5f * p->r, 0.5f + 0.5f * p->g, 0.5f + 0.5f * p->b);
        else if (scaled && most > 0.0f)
            *p = rgb_scale(*p, 1.0f / most);
    }
}
