/* interrupt.h -- SIGINT and SIGTERM ask a command to end soon and to write what it has. */
#ifndef CLI_INTERRUPT_H
#define CLI_INTERRUPT_H

#include <signal.h>

/* From now on the first of these signals sets the flag, the second ends the program at once. The
 * flag is 0 again. SIGPIPE is ignored: a closed pipe is an error of writing. */
const volatile sig_atomic_t *interrupts_catch(void);

/* What the second one writes to standard error before it ends the program, by one who has changed
 * the terminal; a text that lasts. NULL: nothing. */
void interrupts_farewell(const char *text);

#endif
