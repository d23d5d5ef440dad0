/* progress.c -- see progress.h. */
#include "base/progress.h"

#include "base/clock.h"
#include "base/error.h"

#include <stdio.h>
#include <unistd.h>

#define REDRAW_SECONDS 0.1              /* as often as the eye wants */
#define LINE_SECONDS   5.0              /* in a log: not more than that */

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
    char a[32], b[32];

    if (p->quiet)
        return;
    now = clock_wall();
    if (now - p->last < (p->terminal ? REDRAW_SECONDS : LINE_SECONDS))
        return;
    p->last = now;
    elapsed = now - p->start;
    clock_text(a, sizeof a, elapsed);
    clock_text(b, sizeof b, fraction > 0 ? elapsed * (1 - fraction) / fraction : 0);
    fprintf(stderr, "%s%3d%%  %.0f samples a pixel  %.2f Mrays/s  %s elapsed  %s left%s",
            p->terminal ? "\r" : "", (int)(fraction * 100), spp,
            elapsed > 0 ? (double)rays * 1e-6 / elapsed : 0, a, b, p->terminal ? "   " : "\n");
    if (p->terminal)
        fflush(stderr);
    p->drawn = true;
}

void progress_end(Progress *p)
{
    if (p->drawn && p->terminal)
        fprintf(stderr, "\r%78s\r", "");
}
