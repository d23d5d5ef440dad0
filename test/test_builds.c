/* test_builds.c -- the tree as a whole: its rules (tree.sh), and builds of it by every compiler
 * that is here (builds.sh, which says what each of them runs). */
#include "test/test.h"

#include <stdio.h>
#include <stdlib.h>
#include <sys/wait.h>

enum { SKIPPED = 77 };

static void script(const char *line)
{
    int status;
    fflush(stdout);
    status = system(line);
    if (status != -1 && WIFEXITED(status) && WEXITSTATUS(status) == SKIPPED)
        test_skip("%s", line);
    EXPECT(status == 0, "%s: status %d", line, status);
}

static void tree(void) { script("sh test/tree.sh"); }

#define BUILDS(X) X(gcc0) X(gcc2) X(gcc3) X(native) X(clang) X(clang0) X(portable) X(plain) \
    X(debug) X(tcc) X(musl) X(m32) X(s390x) X(bmake) X(oneline) X(headers) X(asan) X(tsan)
#define DEFINE(name) static void name(void) { script("sh test/builds.sh " #name); }
#define ENTRY(name) { #name, name, true },
BUILDS(DEFINE)

const TestCase test_builds[] = {
    { "tree", tree, false },
    BUILDS(ENTRY)
    { NULL, NULL, false }
};
