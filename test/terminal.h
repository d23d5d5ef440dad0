/* terminal.h -- a terminal for tests: a pseudo terminal that a run of the program has as its
 * standard error, and a screen that takes what comes from it, as far as this program may send. */
#ifndef TEST_TERMINAL_H
#define TEST_TERMINAL_H

#include "test/cli_help.h"

#include <stdint.h>

enum { TERMINAL_COLUMNS = 250, TERMINAL_ROWS = 80 };

/* What a cell shows: a half block or another character, and its colours as 0xRRGGBB, or -1 for
 * those that the user has chosen. */
typedef struct { int32_t ink, ground; char c; bool block; } TermCell;
typedef struct { TermCell cell[TERMINAL_ROWS][TERMINAL_COLUMNS]; } TermPage;

typedef struct {
    int      fd;                        /* our end */
    int      columns, rows;
    TermPage page[2];                   /* the usual one, and that for programs */
    int      other;                     /* which is shown */
    bool     cursor, wraps;
    int32_t  ink, ground;               /* of what comes */
    int      x, y, kept_x, kept_y;      /* kept: of the usual page */
    char     pending[64];               /* a sequence that is not whole yet */
    size_t   npending;
    unsigned frames;                    /* times the cursor went to the top left */
    int      most_x, most_y;            /* half blocks of this frame reach so far */
    int      whole_x, whole_y;          /* and those of the frame before */
} Terminal;

/* variables: "TERM=... COLORTERM=..." of the program. */
void terminal_open(Terminal *t, int columns, int rows, const char *variables);
/* In the new process: the terminal becomes its standard error. */
void terminal_take(void);
void terminal_resize(Terminal *t, int columns, int rows);
/* Takes what comes until so many more frames have begun, or, with 0, until the program has ended;
 * true when it has. */
bool terminal_read(Terminal *t, unsigned frames);
void terminal_close(Terminal *t);
/* As the program found it: the usual page, cursor, wrapping, colours. */
bool terminal_is_restored(const Terminal *t);
/* The line of the usual page, without blanks at its end. Static buffer. */
const char *terminal_line(const Terminal *t, int row);

#endif
