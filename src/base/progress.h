/* progress.h -- one line that tells how far a render is: redrawn ten times a second on a terminal,
 * written as a plain line now and then elsewhere, silent with --quiet. Standard error. On a
 * terminal it is cut to the width, for what wraps cannot be drawn over. */
#ifndef BASE_PROGRESS_H
#define BASE_PROGRESS_H

#include <stdbool.h>
#include <stdint.h>

typedef struct {
    double start, last;
    bool   terminal, quiet, drawn;
    int    width;               /* columns of the terminal, when it was looked at last */
} Progress;

void progress_start(Progress *p);
/* fraction in [0,1]; spp: samples a pixel so far; rays: cast so far. Cheap when not due. */
void progress_show(Progress *p, double fraction, double spp, uint64_t rays);
void progress_end(Progress *p);         /* clears the line */

/* Of the terminal on standard error; where nobody knows, 80 by 24. */
void terminal_size(int *columns, int *rows);

#endif
