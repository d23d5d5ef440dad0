/* error.h -- how the program says what is wrong.
 *
 * Every message is one line, `rushlight: FILE:LINE:COLUMN: text`, written in one piece to standard
 * error. A fault of the user is reported once, by the code that knows the place; its callers only
 * pass `false` (or NULL) up. The class of the first error becomes the exit status. Faults of ours
 * are ASSERTs: they print the source place and abort.
 *
 * The report (how many warnings, which class of error, whether warnings are fatal, who takes the
 * lines) is, with the fault counters of mem.h and file.h, the only mutable state of the process. A
 * mutex guards it. */
#ifndef BASE_ERROR_H
#define BASE_ERROR_H

#include "base/platform.h"

#include <stdbool.h>
#include <stddef.h>

/* Where in the input. line and column count from 1; 0 leaves that part out. file is borrowed. */
typedef struct { const char *file; int line, column; } Place;

/* The exit statuses of the program. */
typedef enum {
    STATUS_OK = 0,
    STATUS_DIFFERENT = 1,     /* a comparison failed */
    STATUS_USAGE = 2,         /* the command line is wrong */
    STATUS_INPUT = 3,         /* an input is wrong */
    STATUS_OUTPUT = 4,        /* an output could not be written, or memory ran out */
    STATUS_INTERRUPTED = 130
} Status;

/* Each prints one line and returns false, so that callers can `return err_at(...)`. */
bool err_at(Place at, const char *fmt, ...) PRINTF_LIKE(2, 3);            /* STATUS_INPUT */
bool err_usage(const char *fmt, ...) PRINTF_LIKE(1, 2);                   /* STATUS_USAGE */
bool err_output(const char *file, const char *fmt, ...) PRINTF_LIKE(2, 3);/* STATUS_OUTPUT */
bool err_memory(size_t bytes);           /* STATUS_OUTPUT; only the first one prints */

/* A warning says what is used instead. After warnings_fatal(true) it is an error (--strict).
 * Returns true if the caller may go on. */
bool warn_at(Place at, const char *fmt, ...) PRINTF_LIKE(2, 3);

/* A line for the user that is neither; silent after messages_quiet(true). */
void note(const char *fmt, ...) PRINTF_LIKE(1, 2);

void     warnings_fatal(bool on);
void     messages_quiet(bool on);        /* no notes, no progress; errors and warnings stay */
bool     messages_are_quiet(void);
/* From now on lines go, one at a time and without their end, to take(), which says nothing itself,
 * and not to standard error; NULL: to standard error again. For those who have drawn there, or
 * answer to somebody else. */
void     messages_to(void (*take)(void *ctx, const char *line), void *ctx);
unsigned warnings_count(void);
Status   err_status(void);               /* class of the first error so far, or STATUS_OK */
void     err_forgive(void);              /* what failed has been made good: there was no error */
void     err_reset(void);                /* forget: a new run of the program in one process */

/* The entry of names[0..n) nearest to `word` by edit distance, or NULL if none is near.
 * Case does not count. Borrowed from names. */
const char *nearest_name(const char *word, const char *const *names, size_t n);
/* ", did you mean 'that entry'?", or "" if none is near: what a message about an unknown word goes
 * on with. Returns hint. */
enum { HINT_MAX = 160 };
const char *hint_nearest(char hint[HINT_MAX], const char *word, const char *const *names,
                         size_t n);

void err_bug(const char *file, int line, const char *what);              /* prints, then abort() */
#define ASSERT(c) ((c) ? (void)0 : err_bug(__FILE__, __LINE__, #c))

#endif
