/* patterns.c -- stub */
#include "bench/bench.h"
void bench_patterns(void) { }
