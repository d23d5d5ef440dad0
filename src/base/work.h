/* work.h -- units of work on several threads: one queue under one mutex, no atomics. A unit is a
 * number; which thread takes it must not matter to its result. */
#ifndef BASE_WORK_H
#define BASE_WORK_H

#include <pthread.h>
#include <stdbool.h>
#include <stdint.h>

enum { WORKERS_MAX = 256 };

typedef struct {
    uint64_t units;                                         /* numbered 0 .. units-1 */
    void (*run)(void *ctx, uint64_t unit, int worker);      /* worker: 0 .. threads-1 */
    /* Called by the same thread after each unit, under the queue's mutex, with the count done so
     * far; false: give out no more units. NULL: always go on. */
    bool (*after)(void *ctx, uint64_t done, int worker);
    void *ctx;
} Work;

/* Runs the units on `threads` threads (the caller's is one of them) and waits. Where threads
 * cannot be made it goes on with fewer. Returns how many units were done. */
uint64_t work_run(const Work *w, int threads);

/* A thread with a stack that renders can run on. False: there is none; not reported. */
bool work_thread(pthread_t *thread, void *(*run)(void *), void *arg);

int  processors(void);                                      /* online now; at least 1 */
void work_fail_at(unsigned long k);     /* tests: thread creation k from now fails; 0: none */

#endif
