/* devtools.h -- a browser without a window, driven by its own protocol: Chromium, if there is one.
 * Texts go through a WebSocket [RFC 6455]; answers are not parsed but searched. */
#ifndef TEST_DEVTOOLS_H
#define TEST_DEVTOOLS_H

#include "test/test.h"

#include <sys/types.h>

typedef struct {
    pid_t    pid;
    int      fd;
    unsigned id;                /* of the last command */
    unsigned complaints;        /* errors of pages so far */
    char     complaint[300];    /* the first one */
    char    *answer;            /* owned: the last one */
    size_t   room;
} Browser;

/* Ends the case as skipped if there is no browser. */
void browser_open(Browser *b, int width, int height, bool dark);
void browser_close(Browser *b);
/* params: what stands between the brackets. The answer lasts until the next command. */
const char *browser_do(Browser *b, const char *method, const char *params);
void browser_visit(Browser *b, const char *address);
/* What a piece of script gives, as text of at most `room` - 1 bytes. */
void browser_ask(Browser *b, const char *script, char *out, size_t room);
/* Asks until it is "true"; a minute at most. */
void browser_await(Browser *b, const char *script);
/* "mousePressed", "mouseMoved", "mouseReleased" with the left button. */
void browser_mouse(Browser *b, const char *what, int x, int y);

#endif
