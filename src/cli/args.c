/* args.c -- see args.h. */
#include "cli/args.h"

#include "base/number.h"

#include <errno.h>
#include <stdio.h>
#include <string.h>

static bool unknown(const Command *c, const char *word, size_t n)
{
    const char *names[64] = { "--help", "--version" };
    char name[64], hint[HINT_MAX];
    size_t count = 2;

    for (const ArgDef *a = c->args; a->name && count < 64; a++)
        names[count++] = a->name;
    snprintf(name, sizeof name, "%.*s", (int)n, word);
    return err_usage("%s: unknown option '%s'%s; see rushlight help %s", c->name, name,
                     hint_nearest(hint, name, names, count), c->name);
}

bool args_parse(const Command *c, int argc, char **argv,
                bool (*set)(void *ctx, int k, const char *value), void *ctx)
{
    bool options = true;

    for (int i = 0; i < argc; i++) {
        const char *word = argv[i], *value = NULL;
        size_t n = strcspn(word, "=");
        int k = 0;

        if (!options || word[0] != '-' || !word[1]) {
            if (!set(ctx, -1, word))
                return false;
            continue;
        }
        if (!strcmp(word, "--")) {
            options = false;
            continue;
        }
        if (word[1] != '-')                     /* -oFILE is not taken; -o FILE is */
            n = strlen(word);
        while (c->args[k].name &&
               (strlen(c->args[k].name) != n || memcmp(c->args[k].name, word, n)))
            k++;
        if (!c->args[k].name)
            return unknown(c, word, n);
        if (word[n] == '=')
            value = word + n + 1;
        if (c->args[k].arg && !value) {
            if (++i == argc)
                return err_usage("%s: %s takes %s", c->name, c->args[k].name, c->args[k].arg);
            value = argv[i];
        } else if (!c->args[k].arg && value)
            return err_usage("%s: %s takes no value", c->name, c->args[k].name);
        if (!set(ctx, k, value))
            return false;
    }
    return true;
}

bool arg_int(const char *name, const char *value, int64_t lo, int64_t hi, int64_t *v)
{
    const char *end = value + strlen(value);
    if (number_int(value, end, v, NULL) == (size_t)(end - value) && end > value && *v >= lo &&
        *v <= hi)
        return true;
    return err_usage("%s '%s' is not right, expected a whole number from %lld to %lld", name, value,
                     (long long)lo, (long long)hi);
}

bool arg_number(const char *name, const char *value, double lo, double hi, double *v)
{
    const char *end = value + strlen(value);
    char a[NUMBER_MAX], b[NUMBER_MAX];
    if (number_double(value, end, v) == (size_t)(end - value) && end > value && *v >= lo &&
        *v <= hi)
        return true;
    number_print_double(a, lo);
    number_print_double(b, hi);
    return err_usage("%s '%s' is not right, expected a number from %s to %s", name, value, a, b);
}

bool arg_floats(const char *name, const char *value, const char *form, float *v, int n)
{
    const char *s = value, *end = value + strlen(value);

    for (int i = 0; i < n; i++) {
        size_t k = number_float(s, end, &v[i]);
        s += k;
        if (!k || v[i] - v[i] != 0.0f || (i + 1 < n ? *s++ != ',' : s != end))
            return err_usage("%s '%s' is not right, expected %s", name, value, form);
    }
    return true;
}

/* n whole numbers below 2^31 with `between` between them, and nothing else. */
static bool whole_numbers(const char *s, uint32_t *v, int n, char between)
{
    const char *end = s + strlen(s);
    for (int i = 0; i < n; i++) {
        int64_t x;
        size_t k = *s >= '0' && *s <= '9' ? number_int(s, end, &x, NULL) : 0;
        if (!k || x > INT32_MAX)
            return false;
        v[i] = (uint32_t)x;
        s += k;
        if (i + 1 < n && *s++ != between)
            return false;
    }
    return s == end;
}

bool arg_size(const char *name, const char *value, uint32_t *w, uint32_t *h)
{
    uint32_t v[2];
    if (!whole_numbers(value, v, 2, 'x') || !v[0] || !v[1])
        return err_usage("%s '%s' is not right, expected WxH in pixels, as 640x480", name, value);
    *w = v[0];
    *h = v[1];
    return true;
}

bool arg_part(const char *name, const char *value, uint32_t *i, uint32_t *n)
{
    uint32_t v[2];
    if (!whole_numbers(value, v, 2, '/') || v[0] < 1 || v[0] > v[1])
        return err_usage("%s '%s' is not right, expected I/N with I from 1 to N", name, value);
    *i = v[0];
    *n = v[1];
    return true;
}

bool arg_window(const char *name, const char *value, uint32_t window[4])
{
    if (!whole_numbers(value, window, 4, ',') || window[0] >= window[2] || window[1] >= window[3])
        return err_usage("%s '%s' is not right, expected X0,Y0,X1,Y1 in pixels with X0 < X1 and "
                         "Y0 < Y1", name, value);
    return true;
}

int failed_status(void)
{
    Status s = err_status();
    return s == STATUS_OK ? STATUS_INPUT : (int)s;
}

/* An earlier failure has left its mark on the stream, but no longer in errno. */
bool output_flush(void)
{
    errno = 0;
    if (!fflush(stdout) && !ferror(stdout))
        return true;
    if (err_status() == STATUS_OUTPUT)
        return false;                   /* somebody has said so before */
    return err_output("standard output", "cannot be written%s%s", errno ? ": " : "",
                      errno ? strerror(errno) : "");
}
