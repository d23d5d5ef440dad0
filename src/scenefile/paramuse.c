/* paramuse.c -- what is done with a list of parameters once it is read: copies that last, defaults
 * from Attribute, single values by name, and the fit to a table of options. See reader.h. */
#include "scenefile/reader.h"

#include <string.h>

/* ---- copies ---- */

static bool keep_strings(Arena *arena, Param *p)
{
    const char **strings = arena_take(arena, p->n, sizeof *strings);
    size_t bytes = 0;
    char *text;

    for (size_t i = 0; i < p->n; i++)
        bytes += strlen(p->strings[i]) + 1;
    text = strings ? arena_take(arena, bytes, 1) : NULL;
    if (!text)
        return false;
    for (size_t i = 0; i < p->n; i++) {
        size_t n = strlen(p->strings[i]) + 1;
        strings[i] = memcpy(text, p->strings[i], n);
        text += n;
    }
    p->strings = strings;
    return true;
}

static bool keep_values(Arena *arena, Param *p)
{
    double *numbers;
    if (p->kind == PARAM_STRING || p->kind == PARAM_TEXTURE)
        return keep_strings(arena, p);
    numbers = arena_take(arena, p->n, sizeof *numbers);
    if (!numbers)
        return false;
    p->numbers = memcpy(numbers, p->numbers, p->n * sizeof *numbers);
    return true;
}

bool params_keep(Arena *arena, const Params *ps, const char *file, Params *out)
{
    out->n = ps->n;
    out->p = arena_take(arena, ps->n, sizeof *out->p);
    if (!out->p)
        return false;
    for (size_t i = 0; i < ps->n; i++) {
        Param *p = &out->p[i];
        *p = ps->p[i];
        if (file)
            p->at.file = file;
        p->name = arena_string(arena, p->name, strlen(p->name));
        p->type = arena_string(arena, p->type, strlen(p->type));
        if (!p->name || !p->type || !keep_values(arena, p))
            return false;
    }
    return true;
}

void params_with_defaults(const Reader *r, Target target, const Params *ps, Param *list,
                          Params *out)
{
    size_t n = ps->n;
    if (n)
        memcpy(list, ps->p, n * sizeof *list);
    for (const Defaults *d = r->state.defaults[target]; d; d = d->next)
        for (size_t i = 0; i < d->params.n; i++) {
            list[n] = d->params.p[i];
            list[n++].used = true;              /* it is no fault if this directive has no use */
        }
    *out = (Params){ list, n };
}

/* ---- taking values out ---- */

bool params_string(const Params *ps, const char *name, const char *otherwise, const char **s)
{
    const Param *p = params_find(ps, name, NULL);
    *s = otherwise;
    if (!p)
        return true;
    if (p->kind != PARAM_STRING || p->n != 1)
        return err_at(p->at, "\"%s\" is not right, expected one string", name);
    *s = p->strings[0];
    return true;
}

bool params_numbers(const Params *ps, const char *name, size_t n, double *v)
{
    const Param *p = params_find(ps, name, NULL);
    if (!p)
        return true;
    if ((p->kind != PARAM_FLOAT && p->kind != PARAM_INT) || p->n != n)
        return err_at(p->at, "\"%s\" is not right, expected %lu number%s", name, (unsigned long)n,
                      n == 1 ? "" : "s");
    memcpy(v, p->numbers, n * sizeof *v);
    return true;
}

bool params_given(const Params *ps, const char *name)
{
    const Param *p = params_find(ps, name, NULL);
    bool given = p && (p->kind == PARAM_TEXTURE || p->kind == PARAM_STRING);

    for (size_t i = 0; p && !given && i < p->n; i++)
        given = p->numbers[i] != 0;
    return given;
}

static bool in_list(const char *const *list, const char *name)
{
    while (*list && strcmp(*list, name))
        list++;
    return *list != NULL;
}

static const OptDef *def_of(const OptDef *defs, Param *p)
{
    Params one = { p, 1 };
    for (; defs && defs->key; defs++) {
        bool used = p->used, found = params_find(&one, defs->key, defs->also) != NULL;
        p->used = used;
        if (found)
            return defs;
    }
    return NULL;
}

/* A colour as a table wants it, in v[3]: its mean where a number is expected; within the range
 * where it was computed from a spectrum, since no spectrum fits the primaries exactly. */
static void fit_colour(Param *p, const OptDef *d, double *v)
{
    static const char *const computed[] = { "spectrum", "xyz", "blackbody", NULL };

    memcpy(v, p->numbers, 3 * sizeof *v);
    if (d->type == OPT_FLOAT) {
        v[0] = (v[0] + v[1] + v[2]) / 3;
        p->n = 1;
    }
    for (size_t k = 0; k < p->n && d->lo < d->hi && in_list(computed, p->type); k++)
        v[k] = v[k] < d->lo ? d->lo : v[k] > d->hi ? d->hi : v[k];
    p->numbers = v;
}

void params_fit(Params *ps, const OptDef *defs, double (*room)[3])
{
    static const char *const how[] = { "remaproughness", "nsamples", "samples", "shutteropen",
                                       "shutterclose", NULL };
    static const char *const colours[] = { "rgb", "color", "spectrum", "xyz", "blackbody", NULL };

    for (size_t i = 0; i < ps->n; i++) {
        Param *p = &ps->p[i];
        const OptDef *d = def_of(defs, p);
        if (!d && in_list(how, p->name))
            p->used = true;
        if (d && (d->type == OPT_FLOAT || d->type == OPT_RGB) && p->kind == PARAM_FLOAT &&
            p->n == 3 && in_list(colours, p->type))
            fit_colour(p, d, room[i]);
    }
}
