/* interrupt.c -- see interrupt.h. A handler may touch flags, and write. */
#include "cli/interrupt.h"

#include "base/error.h"

#include <string.h>
#include <unistd.h>

static volatile sig_atomic_t interrupted;
static const char *volatile farewell;

static void on_signal(int sig)
{
    const char *text = farewell;

    (void)sig;
    if (interrupted && text && write(2, text, strlen(text)) < 0)
        text = NULL;                            /* nobody is left to read it */
    if (interrupted)
        _exit(STATUS_INTERRUPTED);              /* asked twice: at once */
    interrupted = 1;
}

void interrupts_farewell(const char *text) { farewell = text; }

static void handle(int sig, void (*handler)(int))
{
    struct sigaction a;

    memset(&a, 0, sizeof a);
    a.sa_handler = handler;
    sigaction(sig, &a, NULL);
}

const volatile sig_atomic_t *interrupts_catch(void)
{
    interrupted = 0;
    handle(SIGINT, on_signal);
    handle(SIGTERM, on_signal);
    handle(SIGPIPE, SIG_IGN);
    return &interrupted;
}

void limits_are_errors(void) { handle(SIGXFSZ, SIG_IGN); }
