/* report.h -- what benchmarks print and draw, as one HTML page that needs no other file. */
#ifndef BENCH_REPORT_H
#define BENCH_REPORT_H

#include <stdbool.h>

/* Begins a page. False: reported. */
bool report_begin(const char *path);
/* Runs a benchmark: what it prints goes to the page too, and so do pictures that it tells of. */
void report_section(const char *name, void (*run)(void));
/* A benchmark has written this picture (.png, .svg), which stays where it is. */
void report_picture(const char *path);
/* False: reported, there is no page. */
bool report_end(void);

#endif
