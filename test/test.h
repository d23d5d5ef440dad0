/* test.h -- the runner's interface: a suite is a table of cases; each case runs in a process of its
 * own under a time limit, so that a crash or a hang is one failure. */
#ifndef TEST_TEST_H
#define TEST_TEST_H

#include "base/error.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

typedef struct {
    const char *name;
    void (*run)(void);
    bool slow;                  /* only with --long (make check-long) */
} TestCase;

typedef struct { const char *name; const TestCase *cases; } TestSuite;  /* cases end at name NULL */

/* Records a failure of the running case, with file, line and message, and goes on. */
void test_fail(const char *file, int line, const char *fmt, ...) PRINTF_LIKE(3, 4);
#define EXPECT(cond, ...) ((cond) ? (void)0 : test_fail(__FILE__, __LINE__, __VA_ARGS__))
/* Ends the case if the condition is false. */
void test_stop(void);
#define REQUIRE(cond, ...) \
    ((cond) ? (void)0 : (test_fail(__FILE__, __LINE__, __VA_ARGS__), test_stop()))
/* Ends the case as skipped, saying why (data that is not there). */
void test_skip(const char *fmt, ...) PRINTF_LIKE(1, 2);
bool test_is_long(void);        /* running under --long: a case may take more samples */

/* Goes on from the hash h of what stands before: one that no bit of the numbers can change alone
 * without being seen. */
uint64_t test_hash(uint64_t h, const float *x, size_t n);

/* Path of `name` under the folder of test data (RUSHLIGHT_DATA or ../shared/data), or the case is
 * skipped. Result in a static buffer of the case's process. */
const char *test_data(const char *name);
/* A folder for this case's files, removed afterwards. */
const char *test_folder(void);

#endif
