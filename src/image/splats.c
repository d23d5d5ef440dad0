/* splats.c -- see splats.h. */
#include "image/splats.h"

#include "base/mem.h"

#include <pthread.h>

enum { LOCKS = 64 };                    /* a power of two */

typedef struct SplatLock {
    pthread_mutex_t mutex;
    bool     made;
    uint64_t refused;
    uint32_t bad_x, bad_y;              /* the first one refused */
} Lock;

bool film_accepts_splats(Film *f)
{
    Splats *s = MEM_NEW(Splats);

    f->splats = s;
    if (!s)
        return false;
    s->sums = MEM_ARRAY(Exact, (size_t)f->w * f->h * 3 * (size_t)f->layers);
    s->lock = MEM_ARRAY(Lock, LOCKS);
    if (!s->sums || !s->lock)
        return false;
    for (int k = 0; k < LOCKS; k++) {
        s->lock[k].made = pthread_mutex_init(&s->lock[k].mutex, NULL) == 0;
        if (!s->lock[k].made)
            return err_memory(sizeof(Lock));
    }
    return true;
}

void splats_free(Splats *s)
{
    if (!s)
        return;
    for (int k = 0; s->lock && k < LOCKS; k++)
        if (s->lock[k].made)
            pthread_mutex_destroy(&s->lock[k].mutex);
    mem_free(s->lock);
    mem_free(s->gain);
    mem_free(s->sums);
    mem_free(s);
}

void film_shots(Film *f, uint64_t n) { f->splats->shots += n; }

/* Neighbouring tiles have different locks. */
static Lock *lock_of(Splats *s, uint32_t x, uint32_t y)
{
    return &s->lock[(x / FILM_TILE + 13 * (y / FILM_TILE)) % LOCKS];
}

static void add_to_pixel(Film *f, uint32_t x, uint32_t y, uint32_t layers, Rgb c)
{
    Splats *s = f->splats;
    Lock *lock = lock_of(s, x, y);
    size_t pixel = film_pixel(f, x, y), n = (size_t)f->w * f->h;

    pthread_mutex_lock(&lock->mutex);
    if (LIKELY(film_takes(c))) {
        for (int k = 0; k < f->layers; k++)
            if (layers >> k & 1) {
                Exact *sum = s->sums + ((size_t)k * n + pixel) * 3;
                exact_add(&sum[0], c.r);
                exact_add(&sum[1], c.g);
                exact_add(&sum[2], c.b);
            }
    } else if (!lock->refused++) {
        lock->bad_x = x;
        lock->bad_y = y;
    }
    pthread_mutex_unlock(&lock->mutex);
}

/* The pixels first .. last-1 of [low, high) whose centres are in (x - r, x + r]: by halves, so that
 * each place has just one pixel in a box of a pixel's size. */
static void span(double x, double r, uint32_t low, uint32_t high, uint32_t *first, uint32_t *last)
{
    double a = floor(x - r - 0.5) + 1.0, b = floor(x + r - 0.5) + 1.0;

    *first = a > low ? a < high ? (uint32_t)a : high : low;
    *last = b > low ? b < high ? (uint32_t)b : high : low;
}

void film_splat(Film *f, const Filter *filter, V2 place, uint32_t layers, Rgb c)
{
    uint32_t x0, x1, y0, y1;

    if (!is_finite(place.x) || !is_finite(place.y))
        return;
    span(place.x, filter->axis[0].radius, f->x0, f->x1, &x0, &x1);
    span(place.y, filter->axis[1].radius, f->y0, f->y1, &y0, &y1);
    for (uint32_t y = y0; y < y1; y++)
        for (uint32_t x = x0; x < x1; x++) {
            double w = filter_eval(filter, place.x - (x + 0.5), place.y - (y + 0.5));
            if (w != 0.0)
                add_to_pixel(f, x, y, layers, rgb_scale(c, (float)w));
        }
}

void film_awaits_splat(const Film *f, V2 place)
{
    if (place.x >= (float)f->x0 && place.x < (float)f->x1 && place.y >= (float)f->y0 &&
        place.y < (float)f->y1)
        PREFETCH(f->splats->sums + 3 * film_pixel(f, (uint32_t)place.x, (uint32_t)place.y));
}

void film_multiply_splats(Film *f, float *gain)
{
    mem_free(f->splats->gain);
    f->splats->gain = gain;
}

Rgb splats_mean(const Splats *s, size_t sum, size_t pixel)
{
    double n = (s->shots ? (double)s->shots : 1.0) / (s->gain ? (double)s->gain[pixel] : 1.0);
    const Exact *e = s->sums + sum * 3;

    return rgb((float)(exact_value(&e[0]) / n), (float)(exact_value(&e[1]) / n),
               (float)(exact_value(&e[2]) / n));
}

uint64_t splats_refused(const Splats *s, uint32_t *x, uint32_t *y)
{
    uint64_t n = 0;

    for (int k = 0; k < LOCKS; k++) {
        if (s->lock[k].refused && !n) {
            *x = s->lock[k].bad_x;
            *y = s->lock[k].bad_y;
        }
        n += s->lock[k].refused;
    }
    return n;
}

/* ---- in files ---- */

void splats_save(const Splats *s, size_t n, Saving *to)
{
    exact_save(s->sums, n, to);
    save_u64(to, s->shots);
    for (int k = 0; k < LOCKS; k++) {
        save_u64(to, s->lock[k].refused);
        save_u32(to, s->lock[k].bad_x);
        save_u32(to, s->lock[k].bad_y);
    }
}

void splats_load(Splats *s, size_t n, Loading *from)
{
    exact_load(s->sums, n, from);
    s->shots = load_u64(from);
    for (int k = 0; k < LOCKS; k++) {
        s->lock[k].refused = load_u64(from);
        s->lock[k].bad_x = load_u32(from);
        s->lock[k].bad_y = load_u32(from);
    }
}

void splats_join(Splats *s, const Splats *other, size_t n)
{
    for (size_t i = 0; i < n; i++)
        exact_join(&s->sums[i], &other->sums[i]);
    s->shots += other->shots;
    for (int k = 0; k < LOCKS; k++) {
        Lock *a = &s->lock[k], *b = &other->lock[k];
        if (!a->refused && b->refused) {
            a->bad_x = b->bad_x;
            a->bad_y = b->bad_y;
        }
        a->refused += b->refused;
    }
}
