/* test_bugs.c -- the tests are tested: bugs.sh puts known faults into a copy of the tree. */
#include "test/test.h"

#include <stdio.h>
#include <stdlib.h>

static void seeded(void)
{
    int status = system("sh test/bugs.sh");
    EXPECT(status == 0, "a seeded bug was not caught, see above");
}

const TestCase test_bugs[] = { { "seeded", seeded, true }, { NULL, NULL, false } };
