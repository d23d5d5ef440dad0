/* adaptive.c -- the list of policies and what they share. See adaptive.h. */
#include "render/adaptive.h"

#include <string.h>

enum { STEP_MOST = 26 };                /* that matters to any policy */

#define POLICIES(X)                                                                     \
    X(neighbours)               /* by the other half of the pixels; unbiased */         \
    X(variable)                 /* by the pixels before it on the way; unbiased */      \
    X(own)                      /* each by itself; biased */                            \
    X(none)                     /* all alike */
#define DECLARE(name) extern const AdaptiveKind adaptive_##name;
#define ENTRY(name) &adaptive_##name,
POLICIES(DECLARE)
const AdaptiveKind *const adaptives[] = { POLICIES(ENTRY) NULL };

bool adaptive_init(Adaptive *a, const AdaptiveKind *kind, const Opts *o, Film *film, uint32_t spp,
                   double error, uint64_t seed)
{
    uint32_t least = (uint32_t)opt_int(o, "min");

    memset(a, 0, sizeof *a);
    a->kind = kind;
    a->opts = *o;
    a->film = film;
    a->seed = seed;
    a->n = film->w * film->h;
    a->error = error;
    a->mean = error > 0 ? 0 : spp;
    a->most = error > 0 && spp ? spp : UINT32_MAX;
    for (a->least = 1; a->least < least; a->least *= 2)
        ;
    if (!kind->plan)
        return true;
    a->seen = MEM_ARRAY(Seen, a->n);
    a->room = MEM_ARRAY(float, (size_t)a->n * 2);
    a->way = MEM_ARRAY(double, film->tiles_y);
    if (a->seen && a->room && a->way && (!kind->start || kind->start(a))) {
        for (uint32_t i = 0; i < a->n; i++)
            a->seen[i].keep = UINT32_MAX;
        return true;
    }
    adaptive_clear(a);
    return false;
}

void adaptive_clear(Adaptive *a)
{
    mem_free(a->seen);
    mem_free(a->room);
    mem_free(a->way);
    mem_free(a->pilot);
    memset(a, 0, sizeof *a);
}

static bool pending(const Seen *s, uint32_t n)
{
    for (uint32_t i = 0; s && i < n; i++)
        if (s[i].taken < s[i].want)
            return true;
    return false;
}

bool adaptive_next(Adaptive *a)
{
    while (!pending(a->seen, a->n) && !pending(a->pilot, a->npilot))
        if (!a->kind->plan(a))
            return false;
    a->slice = !a->slice ? 1 : a->slice < PASS_MOST ? 2 * a->slice : PASS_MOST;
    return true;
}

uint32_t adaptive_units(const Adaptive *a)
{
    return a->kind->units ? a->kind->units(a) : film_ntiles(a->film);
}

static void look_at(Seen *s, double lum)
{
    s->sum += lum;
    s->squares += lum * lum;
    s->taken++;
    if ((s->taken & (s->taken - 1)) == 0) {
        int k = 0;
        while (s->taken >> k != 1)
            k++;
        s->mark[k % SEEN_MARKS] = (float)(s->sum / s->taken);
    }
}

void adaptive_take(Seen *s, Taker *t, uint32_t x, uint32_t y, uint32_t most, bool pilot)
{
    Sampler *sampler = &t->tracer->sampler;
    uint64_t seed = sampler->seed;

    if (pilot)
        sampler->seed = key_with(seed, 1);      /* other patterns in all pixels */
    sampler_pixel(sampler, x, y);
    for (; most && s->taken < s->want; most--)
        look_at(s, (double)t->take(t->ctx, t->tracer, x, y, s->dropped + s->taken,
                                   !pilot && s->taken < s->keep));
    sampler->seed = seed;
}

void adaptive_tile(Adaptive *a, uint32_t tile, Taker *t)
{
    uint32_t x0, y0, x1, y1, w;

    film_tile(a->film, tile, &x0, &y0, &x1, &y1);
    w = x1 - x0;
    while (*t->done < w * (y1 - y0)) {
        uint32_t x = x0 + *t->done % w, y = y0 + *t->done / w;
        size_t i = film_pixel(a->film, x, y);
        if (a->pilot && !a->kind->run)
            adaptive_take(&a->pilot[i], t, x, y, a->slice, true);
        adaptive_take(&a->seen[i], t, x, y, a->slice, false);
        ++*t->done;
        if (t->late(t->ctx))
            return;
    }
    *t->done = UNIT_DONE;
}

void adaptive_run(Adaptive *a, uint32_t unit, Taker *t)
{
    if (a->kind->run)
        a->kind->run(a, unit, t);
    else
        adaptive_tile(a, unit, t);
}

void seen_drop(Seen *s)
{
    s->dropped += s->taken;
    s->sum = s->squares = 0;
    s->taken = 0;
}

uint64_t adaptive_taken(const Adaptive *a)
{
    uint64_t n = 0;
    for (uint32_t i = 0; i < a->n; i++)
        n += (uint64_t)a->seen[i].dropped + a->seen[i].taken;
    for (uint32_t i = 0; i < a->npilot; i++)
        n += a->pilot[i].taken;
    return n;
}

double adaptive_coming(const Adaptive *a)
{
    double n = 0;
    for (uint32_t i = 0; i < a->n; i++) {
        uint32_t left = a->seen[i].want - a->seen[i].taken;
        n += left < a->slice ? left : a->slice;
    }
    return n;
}

void adaptive_want(Adaptive *a, uint32_t n)
{
    for (uint32_t i = 0; i < a->n; i++)
        if (a->seen[i].want < n)
            a->seen[i].want = n < a->most ? n : a->most;
}

double adaptive_mean(const Adaptive *a)
{
    double sum = 0;
    for (uint32_t i = 0; i < a->n; i++)
        sum += a->seen[i].sum / a->seen[i].taken;
    return sum / a->n;
}

double seen_variance(const Seen *s)
{
    double n = s->taken, v = (s->squares - s->sum * s->sum / n) / (n - 1);
    return v > 0 ? v : 0;
}

double seen_q(const Seen *s, int k)
{
    double d = (double)s->mark[k % SEEN_MARKS] - (double)s->mark[(k - 1) % SEEN_MARKS];
    return d * d;
}

/* ---- in files ---- */

static void save_seen(const Seen *seen, uint32_t n, Saving *s)
{
    for (uint32_t i = 0; i < n; i++) {
        save_double(s, seen[i].sum);
        save_double(s, seen[i].squares);
        for (int k = 0; k < SEEN_MARKS; k++)
            save_float(s, seen[i].mark[k]);
        save_u32(s, seen[i].taken);
        save_u32(s, seen[i].want);
        save_u32(s, seen[i].dropped);
        save_u32(s, seen[i].keep);
    }
}

static void load_seen(Seen *seen, uint32_t n, Loading *l)
{
    for (uint32_t i = 0; i < n; i++) {
        seen[i].sum = load_double(l);
        seen[i].squares = load_double(l);
        for (int k = 0; k < SEEN_MARKS; k++)
            seen[i].mark[k] = load_float(l);
        seen[i].taken = load_u32(l);
        seen[i].want = load_u32(l);
        seen[i].dropped = load_u32(l);
        seen[i].keep = load_u32(l);
    }
}

void adaptive_save(const Adaptive *a, Saving *s)
{
    save_seen(a->seen, a->n, s);
    save_seen(a->pilot, a->npilot, s);
    for (size_t i = 0; i < (size_t)a->n * 2; i++)
        save_float(s, a->room[i]);
    for (uint32_t i = 0; i < a->film->tiles_y; i++)
        save_double(s, a->way[i]);
    save_u32(s, a->slice);
    save_u32(s, (uint32_t)(a->step < STEP_MOST ? a->step : STEP_MOST));
    save_double(s, a->level);
    save_double(s, a->average);
    save_double(s, a->expected);
    for (int k = 0; k < 2; k++)
        save_u32(s, a->done[k]);
}

bool adaptive_load(Adaptive *a, Loading *l)
{
    uint32_t step;

    load_seen(a->seen, a->n, l);
    load_seen(a->pilot, a->npilot, l);
    for (size_t i = 0; i < (size_t)a->n * 2; i++)
        a->room[i] = load_float(l);
    for (uint32_t i = 0; i < a->film->tiles_y; i++)
        a->way[i] = load_double(l);
    a->slice = load_u32(l);
    step = load_u32(l);
    a->step = (int)(step < STEP_MOST ? step : STEP_MOST);
    a->level = load_double(l);
    a->average = load_double(l);
    a->expected = load_double(l);
    for (int k = 0; k < 2; k++)
        a->done[k] = load_u32(l) != 0;
    return !l->beyond && step <= STEP_MOST;
}

/* ---- the policy `none` ---- */

/* Every pixel gets the same; the whole picture stops when its estimated error is low enough. That
 * looks at all samples, so a pixel has a share in its own end, one of as many as there are pixels:
 * the bias is of the order of its deviation over the pixels of the picture, and in a picture of one
 * pixel that of `own`. */
static const OptDef none_options[] = { ADAPTIVE_LEAST, { .key = NULL } };

const AdaptiveKind adaptive_none = {
    .info = { "none", "Cline07 4.6.3", "all pixels alike; the whole picture stops", none_options },
    .truth = CONSISTENT
};
