/* cmd_help.c -- the command `help`. */
#include "base/version.h"
#include "cli/args.h"

#include <stdio.h>
#include <string.h>

static void overview(void)
{
    printf("rushlight " RUSHLIGHT_VERSION ": a physically based renderer\n\n"
           "  rushlight SCENE [options]         render a scene (.pbrt, .obj, .ply) to a picture\n"
           "  rushlight COMMAND ...\n\ncommands:\n");
    for (int i = 0; commands[i]; i++)
        printf("  %-10s %-26s %s\n", commands[i]->name, commands[i]->usage, commands[i]->summary);
    printf("\nrushlight help COMMAND tells the options of a command; --version the version.\n"
           "exit status: 0 done, 1 a comparison failed, 2 wrong command line, 3 wrong input,\n"
           "4 output not written or out of memory, 130 interrupted (what there was is written)\n");
}

static void describe(const Command *c)
{
    printf("rushlight %s %s\n  %s\n", c->name, c->usage, c->summary);
    if (c->args[0].name)
        printf("\noptions:\n");
    for (const ArgDef *a = c->args; a->name; a++) {
        char left[64];
        snprintf(left, sizeof left, "%s%s%s", a->name, a->arg ? " " : "", a->arg ? a->arg : "");
        printf("  %-36s %s\n", left, a->help);
    }
}

static bool set(void *ctx, int k, const char *value)
{
    const char *names[16];
    char hint[HINT_MAX];
    size_t n = 0;

    (void)k;
    if (*(const Command **)ctx)
        return err_usage("help takes one command");
    for (; commands[n] && n < 16; n++) {
        names[n] = commands[n]->name;
        if (!strcmp(names[n], value)) {
            *(const Command **)ctx = commands[n];
            return true;
        }
    }
    return err_usage("unknown command '%s'%s; see rushlight help", value,
                     hint_nearest(hint, value, names, n));
}

static const ArgDef args[] = { { NULL, NULL, NULL } };
static int run(int argc, char **argv);

const Command command_help = {
    "help", "[COMMAND]", "this page, or a command's options", args, run
};

static int run(int argc, char **argv)
{
    const Command *c = NULL;

    if (!args_parse(&command_help, argc, argv, set, &c))
        return failed_status();
    if (c)
        describe(c);
    else
        overview();
    return STATUS_OK;
}
