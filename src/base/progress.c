/* progress.c -- see progress.h. */
#include "base/progress.h"

#include "base/clock.h"
#include "base/error.h"

#include <stdio.h>
#include <sys/ioctl.h>
#include <unistd.h>

#define REDRAW_SECONDS 0.1              /* as often as the eye wants */
#define LINE_SECONDS   5.0              /* in a log: not more than that */

void terminal_size(int *columns, int *rows)
{
    struct winsize size;
    bool known = ioctl(2, TIOCGWINSZ, &size) == 0 && size.ws_col > 0 && size.ws_row > 0;

    *columns = known ? size.ws_col : 80;
    *rows = known ? size.ws_row : 24;
}

void progress_start(Progress *p)
{
    p->start = p->last = clock_wall();
    p->terminal = isatty(2) == 1;
    p->quiet = messages_are_quiet();
    p->drawn = false;
}

void progress_show(Progress *p, double fraction, double spp, uint64_t rays)
{
    double now, elapsed;
    int rows;
    char a[32], b[32], line[200];

    if (p->quiet)
        return;
    now = clock_wall();
    if (now - p->last < (p->terminal ? REDRAW_SECONDS : LINE_SECONDS))
        return;
    p->last = now;
    elapsed = now - p->start;
    clock_text(a, sizeof a, elapsed);
    clock_text(b, sizeof b, fraction > 0 ? elapsed * (1 - fraction) / fraction : 0);
    snprintf(line, sizeof line, "%3d%%  %.0f samples a pixel  %.2f Mrays/s  %s elapsed  %s left",
             (int)(fraction * 100), spp, elapsed > 0 ? (double)rays * 1e-6 / elapsed : 0, a, b);
    if (p->terminal) {          /* padded: the line before may have been longer */
        terminal_size(&p->width, &rows);
        fprintf(stderr, "\r%-*.*s", p->width - 1, p->width - 1, line);
    } else
        fprintf(stderr, "%s\n", line);
    fflush(stderr);
    p->drawn = true;
}

void progress_end(Progress *p)
{
    if (p->drawn && p->terminal)
        fprintf(stderr, "\r%*s\r", p->width - 1, "");
}
