/* work.c -- the work queue. See work.h. */
#include "base/work.h"

#include <unistd.h>

static struct { pthread_mutex_t lock; unsigned long calls, fail_at; } fault = {
    PTHREAD_MUTEX_INITIALIZER, 0, 0
};

typedef struct {
    const Work *work;
    pthread_mutex_t lock;
    uint64_t next, done;
    bool stop;
} Queue;

typedef struct { Queue *queue; int worker; pthread_t thread; } Worker;

static void *worker_main(void *arg)
{
    Worker *me = arg;
    Queue *q = me->queue;

    pthread_mutex_lock(&q->lock);
    while (!q->stop && q->next < q->work->units) {
        uint64_t unit = q->next++;
        pthread_mutex_unlock(&q->lock);
        q->work->run(q->work->ctx, unit, me->worker);
        pthread_mutex_lock(&q->lock);
        q->done++;
        if (q->work->after && !q->work->after(q->work->ctx, q->done, me->worker))
            q->stop = true;
    }
    pthread_mutex_unlock(&q->lock);
    return NULL;
}

/* Methods keep what they need for one sample on the stack, up to a few hundred kB: more than some
 * C libraries give a thread that asks for nothing. */
#define STACK_BYTES ((size_t)2 << 20)

bool work_thread(pthread_t *thread, void *(*run)(void *), void *arg)
{
    pthread_attr_t attr;
    bool fail, started = false;

    pthread_mutex_lock(&fault.lock);
    fail = fault.fail_at && ++fault.calls == fault.fail_at;
    pthread_mutex_unlock(&fault.lock);
    if (fail || pthread_attr_init(&attr))
        return false;
    started = !pthread_attr_setstacksize(&attr, STACK_BYTES) &&
              !pthread_create(thread, &attr, run, arg);
    pthread_attr_destroy(&attr);
    return started;
}

uint64_t work_run(const Work *work, int threads)
{
    Queue q = { work, PTHREAD_MUTEX_INITIALIZER, 0, 0, false };
    Worker workers[WORKERS_MAX];
    int n = 1;

    if (threads > WORKERS_MAX)
        threads = WORKERS_MAX;
    if ((uint64_t)threads > work->units)
        threads = (int)work->units;
    for (; n < threads; n++) {
        workers[n].queue = &q;
        workers[n].worker = n;
        if (!work_thread(&workers[n].thread, worker_main, &workers[n]))
            break;
    }
    workers[0].queue = &q;
    workers[0].worker = 0;
    worker_main(&workers[0]);
    for (int i = 1; i < n; i++)
        pthread_join(workers[i].thread, NULL);
    pthread_mutex_destroy(&q.lock);
    return q.done;
}

int processors(void)
{
    long n = 1;
#ifdef _SC_NPROCESSORS_ONLN             /* not in POSIX.1-2008, but everywhere */
    n = sysconf(_SC_NPROCESSORS_ONLN);
#endif
    return n < 1 ? 1 : n > WORKERS_MAX ? WORKERS_MAX : (int)n;
}

void work_fail_at(unsigned long k)
{
    pthread_mutex_lock(&fault.lock);
    fault.calls = 0;
    fault.fail_at = k;
    pthread_mutex_unlock(&fault.lock);
}
