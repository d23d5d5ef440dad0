/* cmd_list.c -- the command `list`: every member of every open set, with its options. It walks the
 * same lists that the program chooses from, so it cannot be wrong. */
#include "base/number.h"
#include "cli/args.h"
#include "image/denoise.h"
#include "lightsampling/lightsampler.h"
#include "render/render.h"
#include "scenefile/scenefile.h"

#include <stdio.h>
#include <string.h>

static const struct { const char *name; const void *list; } sets[] = {
    { "integrators", integrators }, { "accelerators", accels }, { "samplers", samplers },
    { "materials", bsdfs },         { "lights", lights },       { "lightsamplers", lightsamplers },
    { "media", medium_kinds },      { "shapes", shape_readers }, { "cameras", cameras },
    { "filters", filters },         { "adaptives", adaptives },     { "aovs", aovs },
    { "formats", image_formats },   { "tonemaps", tonemaps }, { "meters", meters },
    { "denoisers", denoisers },
};
enum { SETS = sizeof sets / sizeof sets[0] };

static const char *const type_names[] = { "bool", "integer", "float", "rgb", "point3", "floats",
                                          "string", "choice" };

static void print_default(const OptDef *d)
{
    char v[NUMBER_MAX];

    switch (d->type) {
    case OPT_BOOL:    printf("%s", d->num != 0 ? "true" : "false"); break;
    case OPT_NUMBERS: printf("-"); break;
    case OPT_STRING:
    case OPT_CHOICE:  printf("%s", d->str && d->str[0] ? d->str : "-"); break;
    case OPT_POINT:
        if (d->str) {
            printf("%s", d->str);
            break;
        }                       /* else as numbers */
    /* fallthrough */
    case OPT_INT: case OPT_FLOAT: case OPT_RGB:
        number_print_double(v, d->num);
        printf("%s", v);
    }
}

static void print_option(const OptDef *d)
{
    char lo[NUMBER_MAX], hi[NUMBER_MAX];

    printf("    %-18s %-8s ", d->key, type_names[d->type]);
    print_default(d);
    if (d->type == OPT_CHOICE)
        printf("  {%s}", d->choices);
    else if (d->lo < d->hi) {
        number_print_double(lo, d->lo);
        number_print_double(hi, d->hi);
        printf("  [%s, %s]", lo, hi);
    }
    if (d->help)
        printf("  %s", d->help);
    if (d->also)
        printf("  (also: %s)", d->also);
    printf("\n");
}

/* What only some sets say: whether a method is unbiased, and what it cannot find; which conditions
 * of [Shirley91 5.1] a filter meets. */
static void print_truth(const void *list, size_t k)
{
    if (list == (const void *)integrators) {
        const IntegratorKind *it = integrators[k];
        printf("    %s", truth_names[it->truth]);
        if (it->misses[0])
            printf("; cannot find: %s", it->misses);
        printf("\n");
    } else if (list == (const void *)adaptives)
        printf("    %s\n", truth_names[adaptives[k]->truth]);
    else if (list == (const void *)filters) {
        const char *fails = filters[k]->fails;
        printf("    %s%s\n", fails[0] ? "fails of Shirley's five conditions: "
                                      : "meets Shirley's five conditions", fails);
    }
}

static void print_set(int s)
{
    const KindInfo *info;

    printf("%s\n", sets[s].name);
    for (size_t k = 0; (info = kind_info(sets[s].list, k)) != NULL; k++) {
        printf("  %-14s %s  [%s]\n", info->name, info->summary, info->source);
        print_truth(sets[s].list, k);
        for (int i = 0; info->options && info->options[i].key; i++)
            print_option(&info->options[i]);
    }
}

static bool set(void *ctx, int k, const char *value)
{
    const char *names[SETS];
    char have[200] = "", hint[HINT_MAX];

    (void)k;
    if (*(int *)ctx >= 0)
        return err_usage("list takes one kind");
    for (int s = 0; s < SETS; s++) {
        size_t n = strlen(value);
        names[s] = sets[s].name;
        strcat(strcat(have, s ? " " : ""), names[s]);
        /* the singular does as well: "list light" */
        if (!strcmp(value, sets[s].name) ||
            (n + 1 == strlen(sets[s].name) && !strncmp(value, sets[s].name, n))) {
            *(int *)ctx = s;
            return true;
        }
    }
    return err_usage("unknown kind '%s'%s (have: %s)", value,
                     hint_nearest(hint, value, names, SETS), have);
}

static const ArgDef args[] = { { NULL, NULL, NULL } };
static int run(int argc, char **argv);

const Command command_list = {
    "list", "[KIND]", "every integrator, accelerator, sampler, ... with its options", args, run
};

static int run(int argc, char **argv)
{
    int only = -1;

    if (!args_parse(&command_list, argc, argv, set, &only))
        return failed_status();
    for (int s = 0; s < SETS; s++)
        if (only < 0 || only == s)
            print_set(s);
    return STATUS_OK;
}
