/* interrupt.h -- signals: SIGINT and SIGTERM ask a command to end soon and to write what it has,
 * those of pipes and limits become errors of writing. */
#ifndef CLI_INTERRUPT_H
#define CLI_INTERRUPT_H

#include <signal.h>

/* From now on the first of these signals sets the flag, the second ends the program at once. The
 * flag is 0 again. SIGPIPE is ignored: a closed pipe is an error of writing. */
const volatile sig_atomic_t *interrupts_catch(void);

/* What the second one writes to standard error before it ends the program, by one who has changed
 * the terminal; a text that lasts. NULL: nothing. */
void interrupts_farewell(const char *text);

/* A file that would grow beyond what the shell allows (ulimit -f) is an error of writing: the
 * signal that would end the program at once, and leave the file's beginning, is ignored. */
void limits_are_errors(void);

#endif
