/* cmd_completion.c -- the command `completion`: what shells need to complete command lines, from
 * the same tables that command lines are read by. */
#include "cli/args.h"
#include "cli/kindsets.h"

#include <stdio.h>
#include <string.h>

/* ---- what all shells want to know ---- */

static void print_names(const void *list)
{
    const KindInfo *info;

    for (size_t k = 0; (info = kind_info(list, k)) != NULL; k++)
        printf("%s%s", k ? " " : "", info->name);
}

static void print_commands(const char *but)
{
    for (int i = 0; commands[i]; i++)
        if (strcmp(commands[i]->name, but))
            printf(" %s", commands[i]->name);
}

static void print_all_commands(void) { print_commands(""); }
static void print_shells(void) { printf("bash zsh fish"); }

static void print_sets(void)
{
    for (int s = 0; s < KIND_SETS; s++)
        printf("%s%s", s ? " " : "", kind_sets[s].name);
}

/* Words that a command takes instead of files. */
static const struct { const char *command; void (*print)(void); } words[] = {
    { "list", print_sets }, { "help", print_all_commands }, { "completion", print_shells }
};

/* NULL: it takes none. */
static void (*words_of(const Command *c))(void)
{
    for (size_t k = 0; k < sizeof words / sizeof words[0]; k++)
        if (!strcmp(words[k].command, c->name))
            return words[k].print;
    return NULL;
}

static bool takes_file(const ArgDef *a) { return strstr(a->arg, "FILE") != NULL; }

/* ---- bash ---- */

static void bash_command(const Command *c)
{
    printf("    %s)\n        options=\"--help", c->name);
    for (const ArgDef *a = c->args; a->name; a++)
        printf(" %s", a->name);
    printf("\"\n        words=\"");
    if (words_of(c))
        words_of(c)();
    printf("\" ;;\n");
}

/* Options that take a name come first; after one that takes something else there is nothing to
 * complete but files. */
static void bash(void)
{
    printf("# made by: rushlight completion bash\n_rushlight()\n{\n"
           "    local cur=${COMP_WORDS[COMP_CWORD]} prev=${COMP_WORDS[COMP_CWORD-1]}\n"
           "    local options words command=render\n    COMPREPLY=()\n"
           "    case \"${COMP_WORDS[1]}\" in\n    ");
    for (int i = 0; commands[i]; i++)
        printf("%s%s", i ? "|" : "", commands[i]->name);
    printf(") command=${COMP_WORDS[1]} ;;\n    esac\n    case $command in\n");
    for (int i = 0; commands[i]; i++)
        bash_command(commands[i]);
    printf("    esac\n    if [ \"$COMP_CWORD\" = 1 ]; then words=\"");
    print_commands("");
    printf("\"; fi\n    case $prev in\n");
    for (int s = 0; s < KIND_SETS; s++)
        if (kind_sets[s].options[0]) {
            printf("    ");
            for (const char *p = kind_sets[s].options; *p; p++)
                printf(*p == ' ' ? "|" : "%c", *p);
            printf(") options= words=\"");
            print_names(kind_sets[s].list);
            printf("\" ;;\n");
        }
    printf("    esac\n    case $cur in\n    -*) words=$options ;;\n    esac\n"
           "    COMPREPLY=($(compgen -W \"$words\" -- \"$cur\"))\n}\n"
           "complete -o default -o bashdefault -F _rushlight rushlight\n");
}

/* ---- zsh ---- */

/* Within single quotes; brackets and colons mean something to _arguments. */
static void zsh_text(const char *s)
{
    for (; *s; s++) {
        if (*s == '\'')
            printf("'\\''");
        else if (strchr("[]:\\", *s))
            printf("\\%c", *s);
        else
            putchar(*s);
    }
}

static void zsh_option(const ArgDef *a)
{
    const KindSet *set = kind_set_of(a->name);

    printf(" \\\n        '*%s[", a->name);
    zsh_text(a->help);
    printf("]");
    if (a->arg) {
        printf(":");
        zsh_text(a->arg);
        printf(":");
        if (set) {
            printf("(");
            print_names(set->list);
            printf(")");
        } else
            printf(takes_file(a) ? "_files" : " ");
    }
    printf("'");
}

static void zsh_command(const Command *c)
{
    printf("    %s) _arguments", c->name);
    for (const ArgDef *a = c->args; a->name; a++)
        zsh_option(a);
    printf(" \\\n        '*:word:");
    if (words_of(c)) {
        printf("(");
        words_of(c)();
        printf(")");
    } else
        printf("_files");
    printf("' ;;\n");
}

static void zsh(void)
{
    printf("#compdef rushlight\n# made by: rushlight completion zsh\n_rushlight()\n{\n"
           "    local command=render\n    local -a commands\n    commands=(\n");
    for (int i = 0; commands[i]; i++) {
        printf("        '%s:", commands[i]->name);
        zsh_text(commands[i]->summary);
        printf("'\n");
    }
    printf("    )\n    if (( CURRENT == 2 )); then\n        _describe command commands\n"
           "        _files\n        return\n    fi\n    case $words[2] in\n    ");
    for (int i = 0; commands[i]; i++)
        printf("%s%s", i ? "|" : "", commands[i]->name);
    printf(") command=$words[2]; shift words; (( CURRENT-- )) ;;\n    esac\n"
           "    case $command in\n");
    for (int i = 0; commands[i]; i++)
        zsh_command(commands[i]);
    printf("    esac\n}\n_rushlight \"$@\"\n");
}

/* ---- fish ---- */

static void fish_text(const char *s)
{
    putchar('\'');
    for (; *s; s++)
        printf(strchr("'\\", *s) ? "\\%c" : "%c", *s);
    putchar('\'');
}

/* A line that is of no other command is render's. */
static void fish_condition(const Command *c)
{
    bool render = !strcmp(c->name, "render");

    printf("complete -c rushlight -n '%s__fish_seen_subcommand_from", render ? "not " : "");
    if (render)
        print_commands("render");
    else
        printf(" %s", c->name);
    printf("'");
}

static void fish_option(const Command *c, const ArgDef *a)
{
    const KindSet *set = kind_set_of(a->name);

    fish_condition(c);
    printf(a->name[1] == '-' ? " -l %s" : " -s %s", a->name + (a->name[1] == '-' ? 2 : 1));
    if (a->arg)
        printf(takes_file(a) ? " -r" : " -x");
    if (set) {
        printf(" -a '");
        print_names(set->list);
        printf("'");
    }
    printf(" -d ");
    fish_text(a->help);
    printf("\n");
}

static void fish(void)
{
    printf("# made by: rushlight completion fish\n");
    for (int i = 0; commands[i]; i++) {
        const Command *c = commands[i];
        printf("complete -c rushlight -n __fish_use_subcommand -a %s -d ", c->name);
        fish_text(c->summary);
        printf("\n");
        for (const ArgDef *a = c->args; a->name; a++)
            fish_option(c, a);
        if (words_of(c)) {
            fish_condition(c);
            printf(" -f -a '");
            words_of(c)();
            printf("'\n");
        }
    }
}

/* ---- the command ---- */

static const struct { const char *name; void (*print)(void); } shells[] = {
    { "bash", bash }, { "zsh", zsh }, { "fish", fish }
};
enum { SHELLS = sizeof shells / sizeof shells[0] };

static bool set(void *ctx, int k, const char *value)
{
    int *shell = ctx;

    (void)k;
    if (*shell >= 0)
        return err_usage("completion takes one shell");
    for (int i = 0; i < SHELLS; i++)
        if (!strcmp(shells[i].name, value))
            *shell = i;
    return *shell >= 0 || err_usage("unknown shell '%s' (have: bash zsh fish)", value);
}

static const ArgDef args[] = { { NULL, NULL, NULL } };
static int run(int argc, char **argv);

const Command command_completion = {
    "completion", "bash|zsh|fish", "what a shell needs to complete command lines", args, run
};

static int run(int argc, char **argv)
{
    int shell = -1;

    if (!args_parse(&command_completion, argc, argv, set, &shell))
        return failed_status();
    if (shell < 0) {
        err_usage("completion takes a shell: bash, zsh or fish");
        return STATUS_USAGE;
    }
    shells[shell].print();
    return STATUS_OK;
}
