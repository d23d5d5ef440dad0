/* test_completion.c -- what shells are told of command lines, asked as the shells ask; and the page
 * for man(1). Shells that are not here are skipped. */
#include "cli/args.h"
#include "cli/kindsets.h"
#include "test/cli_help.h"

#include <stdlib.h>
#include <string.h>

static bool shell_is_here(const char *shell)
{
    char line[100];
    snprintf(line, sizeof line, "command -v %s > /dev/null", shell);
    return system(line) == 0;
}

/* What the shell says to a script; the functions for it are in the file `functions`. */
static char *ask(const char *shell, const char *script)
{
    char line[800];
    size_t n;
    char *said;

    cli_write_text("script", script);
    snprintf(line, sizeof line, "cd '%s' && %s script > answer 2>&1", test_folder(), shell);
    EXPECT(system(line) == 0, "%s fails: %s", shell, script);
    said = cli_read("answer", &n);
    return said ? said : (char *)"";
}

static void functions_of(const char *shell)
{
    Cli c;
    if (!shell_is_here(shell))
        test_skip("no %s is here", shell);
    c = CLI_WORKS("completion %s", shell);
    cli_write_text("functions", c.out);
}

/* A blank before and after each word that is wanted. */
static void expect_word(const char *shell, const char *said, const char *word)
{
    size_t n = strlen(word);
    for (const char *p = said; (p = strstr(p, word)) != NULL; p += n)
        if ((p == said || strchr(" \n", p[-1])) && strchr(" \n\t", p[n]))
            return;
    EXPECT(false, "%s: no %s among: %.300s", shell, word, said);
}

/* The last word is completed. */
static char *bash_completes(const char *words)
{
    return ask("bash", cli_text(". ./functions\nCOMP_WORDS=(%s)\nCOMP_CWORD=$((${#COMP_WORDS[@]} - "
                                "1))\n_rushlight\necho \"${COMPREPLY[*]}\" \"\"\n", words));
}

static void bash(void)
{
    const KindInfo *info;

    functions_of("bash");
    for (int i = 0; commands[i]; i++) {
        char words[80], *said;
        expect_word("bash", bash_completes("rushlight ''"), commands[i]->name);
        snprintf(words, sizeof words, "rushlight %s -", commands[i]->name);
        said = bash_completes(words);
        for (const ArgDef *a = commands[i]->args; a->name; a++)
            expect_word("bash", said, a->name);
    }
    for (size_t k = 0; (info = kind_info(kind_set_of("--sampler")->list, k)) != NULL; k++)
        expect_word("bash", bash_completes("rushlight a.pbrt --sampler ''"), info->name);
    expect_word("bash", bash_completes("rushlight a.pbrt --autos"), "--autosave");
    expect_word("bash", bash_completes("rushlight list integ"), "integrators");
    EXPECT(!strcmp(bash_completes("rushlight merge a.part --int"), " \n"), "merge has no such");
}

static void zsh(void)
{
    functions_of("zsh");
    EXPECT(!strcmp(ask("zsh -n", cli_read("functions", &(size_t){ 0 })), ""), "not zsh: %s",
           cli_read("answer", &(size_t){ 0 }));
}

static void fish(void)
{
    functions_of("fish");
    for (int i = 0; commands[i]; i++) {
        char *said = ask("fish", cli_text("source ./functions\ncomplete -C 'rushlight %s -'\n",
                                          commands[i]->name));
        for (const ArgDef *a = commands[i]->args; a->name; a++)
            expect_word("fish", said, a->name);
    }
    expect_word("fish", ask("fish", "source ./functions\ncomplete -C 'rushlight merg'\n"), "merge");
    expect_word("fish", ask("fish", "source ./functions\ncomplete -C 'rushlight a --filter '\n"),
                "mitchell");
}

/* Every command and option stands on it, and roff has nothing to complain of. */
static void man(void)
{
    Cli c = CLI_WORKS("man");

    for (int i = 0; commands[i]; i++) {
        EXPECT(strstr(c.out, cli_text(".SS \\&%s", commands[i]->name)), "no %s", commands[i]->name);
        for (const ArgDef *a = commands[i]->args; a->name; a++)
            EXPECT(a->name[1] != '-' ||
                   strstr(c.out, cli_text("\\fB\\&\\-\\-%.3s", a->name + 2)), "no %s", a->name);
    }
    CLI_FAILS(STATUS_USAGE, "man takes nothing, got 'x'", "man x");
    CLI_FAILS(STATUS_USAGE, "unknown shell 'csh' (have: bash zsh fish)", "completion csh");
    CLI_FAILS(STATUS_USAGE, "completion takes a shell: bash, zsh or fish", "completion");
    if (!shell_is_here("groff"))
        test_skip("no groff is here");
    cli_write_text("page", c.out);
    EXPECT(!strcmp(ask("sh", "groff -man -ww -Tascii page 2>&1 > /dev/null\n"), ""), "groff: %s",
           cli_read("answer", &(size_t){ 0 }));
}

const TestCase test_completion[] = {
    { "bash", bash, false },
    { "zsh", zsh, false },
    { "fish", fish, false },
    { "man", man, false },
    { NULL, NULL, false }
};
