/* clock.c -- see clock.h. */
#include "base/clock.h"

#include <stdio.h>
#include <time.h>

static double seconds(clockid_t id)
{
    struct timespec t;
    if (clock_gettime(id, &t))
        return 0;
    return (double)t.tv_sec + (double)t.tv_nsec * 1e-9;
}

double clock_wall(void) { return seconds(CLOCK_MONOTONIC); }
double clock_cpu(void) { return seconds(CLOCK_PROCESS_CPUTIME_ID); }

char *clock_text(char *out, size_t room, double s)
{
    long n = s < 1e9 ? (long)s : 1000000000;
    if (s < 60)
        snprintf(out, room, "%ld.%ld s", n, (long)(s * 10) % 10);
    else if (n < 3600)
        snprintf(out, room, "%ld:%02ld", n / 60, n % 60);
    else
        snprintf(out, room, "%ld:%02ld:%02ld", n / 3600, n / 60 % 60, n % 60);
    return out;
}
