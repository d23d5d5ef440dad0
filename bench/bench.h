/* bench.h -- what the benchmarks share. */
#ifndef BENCH_BENCH_H
#define BENCH_BENCH_H

#include "base/clock.h"
#include "base/work.h"
#include "render/render.h"

void bench_load(void);          /* reading and building a million triangles */
void bench_rays(void);          /* every accelerator over one mesh, by kind of ray */
void bench_paths(void);         /* paths a CPU-second on the Cornell boxes */
void bench_error(void);         /* error after 20 CPU-seconds, where a reference is at hand */

#endif
