/* cmd_list.c -- the command `list`: every member of every open set, with its options. It walks the
 * same lists that the program chooses from, so it cannot be wrong. */
#include "base/number.h"
#include "cli/args.h"
#include "cli/kindsets.h"
#include "render/render.h"

#include <stdio.h>
#include <string.h>

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

    printf("    %-18s %-8s ", d->key, opt_type_names[d->type]);
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

    printf("%s\n", kind_sets[s].name);
    for (size_t k = 0; (info = kind_info(kind_sets[s].list, k)) != NULL; k++) {
        printf("  %-14s %s  [%s]\n", info->name, info->summary, info->source);
        print_truth(kind_sets[s].list, k);
        for (int i = 0; info->options && info->options[i].key; i++)
            print_option(&info->options[i]);
    }
}

static bool set(void *ctx, int k, const char *value)
{
    const char *names[KIND_SETS];
    char have[200] = "", hint[HINT_MAX];

    (void)k;
    if (*(int *)ctx >= 0)
        return err_usage("list takes one kind");
    for (int s = 0; s < KIND_SETS; s++) {
        size_t n = strlen(value);
        names[s] = kind_sets[s].name;
        strcat(strcat(have, s ? " " : ""), names[s]);
        /* the singular does as well: "list light" */
        if (!strcmp(value, kind_sets[s].name) ||
            (n + 1 == strlen(kind_sets[s].name) && !strncmp(value, kind_sets[s].name, n))) {
            *(int *)ctx = s;
            return true;
        }
    }
    return err_usage("unknown kind '%s'%s (have: %s)", value,
                     hint_nearest(hint, value, names, KIND_SETS), have);
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
    for (int s = 0; s < KIND_SETS; s++)
        if (only < 0 || only == s)
            print_set(s);
    return STATUS_OK;
}
