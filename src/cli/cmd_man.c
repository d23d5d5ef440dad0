/* cmd_man.c -- the command `man`: the program's page for man(1), from the same tables that command
 * lines are read by. */
#include "base/version.h"
#include "cli/args.h"
#include "cli/kindsets.h"

#include <stdio.h>

/* Text as it is: what a line begins with, and signs that roff would change. */
static void text(const char *s)
{
    printf("\\&");
    for (; *s; s++) {
        if (*s == '-')
            printf("\\-");
        else if (*s == '\\')
            printf("\\e");
        else
            putchar(*s);
    }
}

static void option(const ArgDef *a)
{
    printf(".TP\n\\fB");
    text(a->name);
    printf("\\fR");
    if (a->arg) {
        printf(" \\fI");
        text(a->arg);
        printf("\\fR");
    }
    printf("\n");
    text(a->help);
    printf("\n");
}

static void command(const Command *c)
{
    printf(".SS ");
    text(c->name);
    printf(" ");
    text(c->usage);
    printf("\n");
    text(c->summary);
    printf("\n");
    for (const ArgDef *a = c->args; a->name; a++)
        option(a);
}

static void names(const KindSet *set)
{
    const KindInfo *info;

    printf(".SS ");
    text(set->name);
    printf("\n");
    for (size_t k = 0; (info = kind_info(set->list, k)) != NULL; k++) {
        printf(".TP\n.B ");
        text(info->name);
        printf("\n");
        text(info->summary);
        printf("\n");
    }
}

static bool set(void *ctx, int k, const char *value)
{
    (void)ctx;
    (void)k;
    return err_usage("man takes nothing, got '%s'", value);
}

static const ArgDef args[] = { { NULL, NULL, NULL } };
static int run(int argc, char **argv);

const Command command_man = {
    "man", "", "the manual page, for man(1)", args, run
};

static int run(int argc, char **argv)
{
    if (!args_parse(&command_man, argc, argv, set, NULL))
        return failed_status();
    printf(".TH RUSHLIGHT 1 \"\" \"rushlight " RUSHLIGHT_VERSION "\"\n.SH NAME\nrushlight \\- a "
           "physically based renderer\n.SH SYNOPSIS\n.B rushlight\n.I SCENE\n[options]\n.br\n"
           ".B rushlight\n.I COMMAND\n\\&...\n.SH DESCRIPTION\nRenders a scene (.pbrt, .obj, "
           ".ply) to a picture, measures structures for rays, and sets methods of light transport "
           "against each other. A first word that is a file means render. Options may stand "
           "anywhere, as \\-\\-name value or \\-\\-name=value.\n.SH COMMANDS\n");
    for (int i = 0; commands[i]; i++)
        command(commands[i]);
    printf(".SH NAMES\nEach with its options:\n.B rushlight list\n");
    for (int s = 0; s < KIND_SETS; s++)
        names(&kind_sets[s]);
    printf(".SH EXIT STATUS\n0 done, 1 a comparison failed, 2 wrong command line, 3 wrong input, 4 "
           "output not written or out of memory, 130 interrupted (what there was is written)\n");
    return STATUS_OK;
}
