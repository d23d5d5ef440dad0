/* clock.h -- time, for budgets, progress and measurements: no picture depends on it. Seconds. */
#ifndef BASE_CLOCK_H
#define BASE_CLOCK_H

#include <stddef.h>

double clock_wall(void);                /* since some fixed moment */
double clock_cpu(void);                 /* used by all threads of the process */
/* "3.2 s", "4:05", "1:02:03" */
char  *clock_text(char *out, size_t room, double seconds);

#endif
