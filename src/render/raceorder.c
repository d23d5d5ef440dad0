/* raceorder.c -- what is asked of a race: methods and checkpoints, from their texts. See race.h. */
#include "render/race.h"

#include "base/number.h"

#include <stdio.h>
#include <string.h>

enum { DOUBLINGS = 7 };                 /* of a single time: t / 2^7 ... t */

void race_order_clear(RaceOrder *o)
{
    arena_clear(&o->arena);
    memset(o, 0, sizeof *o);
}

bool race_method_parse(RaceMethod *m, const char *text, Arena *arena)
{
    const char *at = strrchr(text, '@');
    char *name = arena_string(arena, text, at ? (size_t)(at - text) : strlen(text));

    memset(m, 0, sizeof *m);
    m->label = arena_string(arena, text, strlen(text));
    if (!name || !m->label)
        return false;
    m->integrator = kind_from_text(integrators, "integrator", name, &m->integrator_opts, arena);
    if (m->integrator && at)
        m->sampler = kind_from_text(samplers, "sampler", at + 1, &m->sampler_opts, arena);
    return m->integrator && (!at || m->sampler);
}

bool race_add_method(RaceOrder *o, const char *text)
{
    if (o->nmethods == RACE_METHODS)
        return err_usage("at most %d methods can race", RACE_METHODS);
    return race_method_parse(&o->method[o->nmethods++], text, &o->arena);
}

static bool rises(const double *v, int n, double least, double most)
{
    for (int i = 0; i < n; i++)
        if (!(v[i] >= least && v[i] <= most) || (i && !(v[i] > v[i - 1])))
            return false;
    return n > 0 && n <= RACE_LOOKS;
}

bool race_spp_set(RaceOrder *o, const double *v, int n)
{
    if (!rises(v, n, 1, UINT32_MAX - 1))
        return false;
    for (int i = 0; i < n; i++)
        if (v[i] != floor(v[i]))
            return false;
    o->nspp = 0;
    for (double k = 1; n == 1 && k < v[0]; k *= 2)
        o->spp[o->nspp++] = (uint32_t)k;
    for (int i = 0; i < n; i++)
        o->spp[o->nspp++] = (uint32_t)v[i];
    return true;
}

bool race_seconds_set(RaceOrder *o, const double *v, int n)
{
    if (!rises(v, n, 1e-3, 1e9))
        return false;
    o->nseconds = 0;
    for (int k = DOUBLINGS; n == 1 && k > 0; k--)
        o->seconds[o->nseconds++] = v[0] / (double)(1 << k);
    for (int i = 0; i < n; i++)
        o->seconds[o->nseconds++] = v[i];
    return true;
}

bool race_autosave_set(RaceOrder *o, const double *v, int n)
{
    if (!rises(v, n, 1e-3, 1e9))
        return false;
    memcpy(o->autosave, v, (size_t)n * sizeof *v);
    o->nautosave = n;
    return true;
}

/* ---- names of pictures ---- */

static bool is_plain(char c)
{
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '-';
}

char *race_picture_name(const char *output, int method, const char *label, double seconds)
{
    enum { LABEL_MOST = 60 };
    size_t n = strlen(output), ext = strlen(path_extension(output)), label_n = strlen(label);
    size_t room = n + LABEL_MOST + 2 * NUMBER_MAX, at;
    char *name = mem_array(room, 1), text[NUMBER_MAX];

    if (!name)
        return NULL;
    at = ext && ext < n ? n - ext - 1 : n;
    memcpy(name, output, at);
    at += (size_t)snprintf(name + at, room - at, "-%d-", method + 1);
    for (size_t i = 0; i < label_n && i < LABEL_MOST; i++)
        name[at++] = is_plain(label[i]) ? label[i] : '_';
    if (seconds >= 0) {
        number_print_double(text, seconds);
        at += (size_t)snprintf(name + at, room - at, "-%ss", text);
    }
    memcpy(name + at, output + n - (ext && ext < n ? ext + 1 : 0), ext && ext < n ? ext + 1 : 0);
    return name;
}
