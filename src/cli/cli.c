/* cli.c -- the list of commands and how a command line is told to be one of them. */
#include "base/file.h"
#include "base/mem.h"
#include "base/version.h"
#include "cli/args.h"
#include "cli/interrupt.h"

#include <fcntl.h>
#include <float.h>
#include <stdio.h>
#include <string.h>

#define COMMANDS(X) X(render) X(view) X(merge) X(cast) X(race) X(compare) X(convert) X(info) \
    X(list) X(completion) X(man) X(help)
#define DECLARE(name) extern const Command command_##name;
#define ENTRY(name) &command_##name,
COMMANDS(DECLARE)
const Command *const commands[] = { COMMANDS(ENTRY) NULL };

static const Command *find(const char *name)
{
    for (int i = 0; commands[i]; i++)
        if (!strcmp(commands[i]->name, name))
            return commands[i];
    return NULL;
}

/* "render" if the word names a file or looks like one, else an error with the nearest command. */
static const Command *command_for(const char *word, bool *is_file)
{
    const Command *c = find(word);
    const char *names[16];
    char hint[HINT_MAX];
    size_t n = 0;

    *is_file = false;
    if (c)
        return c;
    if (word[0] == '-' || strchr(word, '.') || strchr(word, '/') || file_exists(word)) {
        *is_file = true;
        return find("render");
    }
    for (; commands[n] && n < 16; n++)
        names[n] = commands[n]->name;
    hint_nearest(hint, word, names, n);
    err_usage("unknown command '%s'%s; see rushlight help", word,
              hint[0] ? hint : ", and there is no file of that name");
    return NULL;
}

/* The promise of equal results rests on float arithmetic being just that. volatile: the compiler
 * must compute, not fold. (1 + u) (1 - u) - 1 is 0 in two roundings, -u^2 with a fused one. */
static bool arithmetic_is_right(void)
{
    volatile float a = 1.0f + FLT_EPSILON, b = 1.0f - FLT_EPSILON;
    float c = a * b - 1.0f;
    volatile float big = 16777216.0f, one = 1.0f;
    float sum = big + one;

    if (c != 0.0f)
        return warn_at((Place){ NULL, 0, 0 }, "this build fuses multiplications and additions: "
                       "pictures differ in the last bits from those of other builds");
    if (sum - big != 0.0f)
        return warn_at((Place){ NULL, 0, 0 }, "this build computes floats in excess precision: "
                       "pictures differ in the last bits from those of other builds");
    return true;
}

/* A stream that is closed stays closed: its number must not go to a file or a socket, into which
 * messages would be written then. What holds its place cannot be written to, or read from. */
static void hold_streams(void)
{
    for (int fd = 0; fd < 3; fd++)
        if (fcntl(fd, F_GETFD) < 0 && open("/dev/null", fd ? O_RDONLY : O_WRONLY) != fd)
            return;
}

static bool asks_help(const char *word) { return !strcmp(word, "--help") || !strcmp(word, "-h"); }

static int print_version(void)
{
    printf("rushlight " RUSHLIGHT_VERSION "\n");
    return STATUS_OK;
}

static int run(int argc, char **argv)
{
    const Command *c;
    bool is_file;

    if (argc < 2)
        return find("help")->run(0, argv);
    if (!strcmp(argv[1], "--version"))
        return print_version();
    if (asks_help(argv[1]))
        return find("help")->run(argc - 2, argv + 2);
    c = command_for(argv[1], &is_file);
    if (!c)
        return STATUS_USAGE;
    for (int i = 2; i < argc && strcmp(argv[i], "--"); i++) {
        char *name[1];
        name[0] = (char *)c->name;
        if (asks_help(argv[i]))
            return find("help")->run(1, name);
        if (!strcmp(argv[i], "--version"))
            return print_version();
    }
    return is_file ? c->run(argc - 1, argv + 1) : c->run(argc - 2, argv + 2);
}

int cli_run(int argc, char **argv)
{
    int status;

    err_reset();
    mem_limit(0);
    arithmetic_is_right();
    hold_streams();
    limits_are_errors();
    status = run(argc, argv);
    return output_flush() || status != STATUS_OK ? status : STATUS_OUTPUT;
}
