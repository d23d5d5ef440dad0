/* interrupt.c -- see interrupt.h. The flag is all that a handler may touch. */
#include "cli/interrupt.h"

#include "base/error.h"

#include <string.h>
#include <unistd.h>

static volatile sig_atomic_t interrupted;

static void on_signal(int sig)
{
    (void)sig;
    if (interrupted)
        _exit(STATUS_INTERRUPTED);              /* asked twice: at once */
    interrupted = 1;
}

const volatile sig_atomic_t *interrupts_catch(void)
{
    struct sigaction a;

    interrupted = 0;
    memset(&a, 0, sizeof a);
    a.sa_handler = on_signal;
    sigaction(SIGINT, &a, NULL);
    sigaction(SIGTERM, &a, NULL);
    a.sa_handler = SIG_IGN;
    sigaction(SIGPIPE, &a, NULL);
    return &interrupted;
}
