/* mem.c -- the one allocator. Each block carries its size in a header, so that the bytes held are
 * known and a limit can be kept. See mem.h. */
#include "base/mem.h"

#include "base/error.h"

#include <pthread.h>
#include <stdlib.h>
#include <string.h>

typedef union { size_t bytes; double align_d; void *align_p; long double align_l; } Header;

static struct {
    pthread_mutex_t lock;
    unsigned long calls, fail_at;
    bool   fail_on;
    long   blocks;
    size_t bytes, peak, limit;
} state = { PTHREAD_MUTEX_INITIALIZER, 0, 0, false, 0, 0, 0, 0 };

/* Counts a call that wants to hold `add` more bytes in place of `drop`. False: it must fail. */
static bool admit(size_t add, size_t drop)
{
    bool ok;
    pthread_mutex_lock(&state.lock);
    state.calls++;
    ok = !(state.fail_at && (state.calls == state.fail_at ||
                             (state.fail_on && state.calls > state.fail_at)));
    if (state.limit && state.bytes - drop + add > state.limit)
        ok = false;
    if (ok) {
        state.bytes += add - drop;
        if (state.bytes > state.peak)
            state.peak = state.bytes;
        if (!drop)
            state.blocks++;
    }
    pthread_mutex_unlock(&state.lock);
    return ok;
}

static void retire(size_t bytes, long blocks)
{
    pthread_mutex_lock(&state.lock);
    state.bytes -= bytes;
    state.blocks -= blocks;
    pthread_mutex_unlock(&state.lock);
}

void *mem_array(size_t n, size_t size)
{
    Header *h;
    size_t bytes;

    if (size && n > (SIZE_MAX / 2 - sizeof *h - MEM_BEYOND) / size) {
        err_memory(SIZE_MAX);
        return NULL;
    }
    bytes = n * size + sizeof *h + MEM_BEYOND;
    if (!admit(bytes, 0)) {
        err_memory(bytes);
        return NULL;
    }
    h = calloc(1, bytes);
    if (!h) {
        retire(bytes, 1);
        err_memory(bytes);
        return NULL;
    }
    h->bytes = bytes;
    return h + 1;
}

bool mem_grow(void *array, size_t *cap, size_t need, size_t size)
{
    void *old;
    Header *h, *grown;
    size_t room = *cap + *cap / 2 + 8, bytes, had;

    if (need <= *cap)
        return true;
    memcpy(&old, array, sizeof old);
    if (room < need)
        room = need;
    if (room > (SIZE_MAX / 2 - sizeof *h - MEM_BEYOND) / size)
        return err_memory(SIZE_MAX);
    h = old ? (Header *)old - 1 : NULL;
    had = h ? h->bytes : 0;
    bytes = room * size + sizeof *h + MEM_BEYOND;
    if (!admit(bytes, had))
        return err_memory(bytes);
    grown = realloc(h, bytes);
    if (!grown) {
        retire(bytes - had, h ? 0 : 1);
        return err_memory(bytes);
    }
    grown->bytes = bytes;
    old = grown + 1;
    memcpy(array, &old, sizeof old);
    *cap = room;
    return true;
}

void mem_free(void *p)
{
    Header *h;
    if (!p)
        return;
    h = (Header *)p - 1;
    retire(h->bytes, 1);
    free(h);
}

char *mem_string(const char *s, size_t length)
{
    char *copy = mem_array(length + 1, 1);
    if (copy)
        memcpy(copy, s, length);
    return copy;
}

void mem_fail_at(unsigned long k, bool on)
{
    pthread_mutex_lock(&state.lock);
    state.calls = 0;
    state.fail_at = k;
    state.fail_on = on;
    state.peak = state.bytes;
    pthread_mutex_unlock(&state.lock);
}

void mem_peak_restart(void)
{
    pthread_mutex_lock(&state.lock);
    state.peak = state.bytes;
    pthread_mutex_unlock(&state.lock);
}

void mem_limit(size_t bytes)
{
    pthread_mutex_lock(&state.lock);
    state.limit = bytes;
    pthread_mutex_unlock(&state.lock);
}

unsigned long mem_calls(void)
{
    unsigned long n;
    pthread_mutex_lock(&state.lock);
    n = state.calls;
    pthread_mutex_unlock(&state.lock);
    return n;
}

long mem_blocks(void)
{
    long n;
    pthread_mutex_lock(&state.lock);
    n = state.blocks;
    pthread_mutex_unlock(&state.lock);
    return n;
}

static size_t read_size(const size_t *what)
{
    size_t n;
    pthread_mutex_lock(&state.lock);
    n = *what;
    pthread_mutex_unlock(&state.lock);
    return n;
}

size_t mem_bytes(void) { return read_size(&state.bytes); }
size_t mem_peak(void) { return read_size(&state.peak); }

/* ---- arenas ---- */

struct ArenaBlock { ArenaBlock *next; Header data[1]; };

void *arena_take(Arena *a, size_t n, size_t size)
{
    size_t bytes, room;
    char *p;

    if (size && n > SIZE_MAX / 4 / size) {
        err_memory(SIZE_MAX);
        return NULL;
    }
    bytes = (n * size + sizeof(Header) - 1) / sizeof(Header) * sizeof(Header);
    if (!a->head || a->size - a->used < bytes) {
        ArenaBlock *b;
        room = bytes > 16000 ? bytes : 16000;
        b = mem_array(1, sizeof *b + room);
        if (!b)
            return NULL;
        b->next = a->head;
        a->head = b;
        a->used = 0;
        a->size = room;
    }
    p = (char *)a->head->data + a->used;
    a->used += bytes;
    return p;
}

char *arena_string(Arena *a, const char *s, size_t length)
{
    char *copy = arena_take(a, length + 1, 1);
    if (copy)
        memcpy(copy, s, length);
    return copy;
}

void arena_clear(Arena *a)
{
    while (a->head) {
        ArenaBlock *next = a->head->next;
        mem_free(a->head);
        a->head = next;
    }
    a->used = a->size = 0;
}
