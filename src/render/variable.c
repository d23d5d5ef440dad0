/* variable.c -- the policy `variable`: the number of samples of a pixel follows the deviation seen
 * in the pixels just before it.
 *
 * Source      [Cline07 5.5 (5.8), (5.9)]; deviations are those of single samples.
 * Rule        s_p, the deviation to be expected, is a running average over the pixels on the way:
 *                 s_p = 0.75 s_p + 0.25 s_pixel                                   (5.8)
 *             and the next pixel gets M = N/2 (1 + s_p / s_ave) samples.          (5.9)
 *             Everyone has N/2 of them before; s_ave is the mean deviation of 1024 pixels.
 * Way         Through bands as high as a tile of the film, so that threads can share the work; row
 *             by row within them, to and fro, so that neighbours follow one another.
 * Departs     The source goes through one picture and begins it with s_p = 0. Here each band begins
 *             with s_ave, or its first pixels would all be short of samples. An average over the
 *             pixels before lags three of them behind; in rows to and fro the lags are apart by
 *             twice that, and every other row would stand out: on scenes/swarm-probe.pbrt, counts
 *             less their mean over 9 x 9 pixels had the correlation -0.74 with the row above. So M
 *             follows the mean of s_p here and in the row above, which ran the other way: +0.27,
 *             and half of the deviation. The pixels for s_ave are sampled for that purpose only:
 *             then it is independent of the picture. Without a count N is doubled, and the rule
 *             used again on what has been taken so far, until the picture's error is low enough.
 * Truth       Unbiased: a count looks at pixels before it on the way, and these at pixels before
 *             them; none looks at itself. (Where N is doubled: but for its end, as with `none`.)
 *             With `rerender`, pixels whose deviation is above s_p + s_ave are thrown away and done
 *             again with s_p = s_pixel. That is biased: it throws away what is bright more often
 *             than what is dark. With 2 % of the samples 50, the others 0.5, at N = 16 the mean
 *             comes out 28 % low.
 * Looks       Counts follow the way, 0.8 being their correlation along it, and each band starts
 *             anew. */
#include "render/adaptive.h"

enum { CHUNK = 32 };                    /* pixels of the pilot in a unit */
enum { PILOT, BASE, REST };             /* steps */

/* Pixel number k of the pilot: one of each of npilot parts of the window, by chance. */
static uint32_t pilot_pixel(const Adaptive *a, uint32_t k)
{
    uint64_t lo = (uint64_t)a->n * k / a->npilot, hi = (uint64_t)a->n * (k + 1) / a->npilot;
    return (uint32_t)(lo + (draw64(key_with(a->seed, 2), k) >> 32) * (hi - lo) / 0x100000000u);
}

static bool start(Adaptive *a)
{
    uint32_t n = (uint32_t)opt_int(&a->opts, "pilot"), base = a->mean ? a->mean / 2 : a->least;

    a->npilot = n < a->n ? n : a->n;
    a->pilot = MEM_ARRAY(Seen, a->npilot);
    for (uint32_t k = 0; a->pilot && k < a->npilot; k++)
        a->pilot[k].want = base < 2 ? 2 : base < 64 ? base : 64;
    return a->pilot != NULL;
}

static uint32_t units(const Adaptive *a)
{
    return a->step == PILOT ? (a->npilot + CHUNK - 1) / CHUNK
         : a->step == BASE  ? film_ntiles(a->film) : a->film->tiles_y;
}

static void run_pilot(Adaptive *a, uint32_t unit, Taker *t)
{
    for (uint32_t k = unit * CHUNK; k < a->npilot && k < (unit + 1) * CHUNK; k++) {
        uint32_t i = pilot_pixel(a, k);
        adaptive_take(&a->pilot[k], t, a->film->x0 + i % a->film->w, a->film->y0 + i / a->film->w,
                      UINT32_MAX, true);
    }
    *t->done = UNIT_DONE;
}

static uint32_t count(const Adaptive *a, double expected)
{
    double n = 0.5 * a->level * (1 + (a->average > 0 ? expected / a->average : 1)) + 0.5;
    return n < 2 ? 2 : n < a->most ? (uint32_t)n : a->most;         /* [Cline07 (5.9)] */
}

/* One pixel on the way, of which s_p = *expected, or what comes in its place if it is done again;
 * returns its deviation. */
static double step_on(Adaptive *a, Taker *t, uint32_t x, uint32_t y, double *expected)
{
    Seen *s = &a->seen[film_pixel(a->film, x, y)];
    uint32_t n = count(a, *expected);
    double deviation;

    s->want = n > s->taken ? n : s->taken;
    adaptive_take(s, t, x, y, UINT32_MAX, false);
    deviation = sqrt(seen_variance(s));
    if (opt_bool(&a->opts, "rerender") && deviation > *expected + a->average) {
        *expected = deviation;
        film_drop(a->film, x, y, s->sum, s->squares);
        seen_drop(s);
        s->want = count(a, deviation);
        adaptive_take(s, t, x, y, UINT32_MAX, false);
        deviation = sqrt(seen_variance(s));
    }
    return deviation;
}

/* The pixel number i of the band that begins at row y0, with s_p = *way before it and after. */
static void next_pixel(Adaptive *a, Taker *t, uint32_t y0, uint32_t i, double *way)
{
    const Film *f = a->film;
    uint32_t y = y0 + i / f->w, x = (y - y0) % 2 ? f->x1 - 1 - i % f->w : f->x0 + i % f->w;
    size_t pixel = film_pixel(f, x, y);
    double expected = *way, given, deviation;

    if (y > y0)
        expected = 0.5 * (expected + (double)a->room[pixel - f->w]);
    a->room[pixel] = (float)*way;
    given = expected;
    deviation = step_on(a, t, x, y, &expected);
    if (expected != given)
        *way = expected;
    *way = 0.75 * *way + 0.25 * deviation;                          /* [Cline07 (5.8)] */
}

static void run_band(Adaptive *a, uint32_t band, Taker *t)
{
    const Film *f = a->film;
    uint32_t y0 = f->y0 + band * FILM_TILE, h = f->y1 - y0 > FILM_TILE ? FILM_TILE : f->y1 - y0;

    if (*t->done == 0)
        a->way[band] = a->average;
    while (*t->done < f->w * h) {
        next_pixel(a, t, y0, (*t->done)++, &a->way[band]);
        if (t->late(t->ctx))
            return;
    }
    *t->done = UNIT_DONE;
}

static void run(Adaptive *a, uint32_t unit, Taker *t)
{
    if (a->step == PILOT)
        run_pilot(a, unit, t);
    else if (a->step == BASE)
        adaptive_tile(a, unit, t);
    else
        run_band(a, unit, t);
}

static void look_at_pilot(Adaptive *a)
{
    for (uint32_t k = 0; k < a->npilot; k++)
        a->average += sqrt(seen_variance(&a->pilot[k])) / a->npilot;
    a->level = a->mean ? a->mean : 2.0 * a->least;
}

static bool plan(Adaptive *a)
{
    if (a->step == BASE) {
        a->step = REST;
        for (uint32_t i = 0; i < a->n; i++)     /* until its turn comes */
            a->seen[i].want = a->seen[i].taken + 1;
        return true;
    }
    if (a->step == PILOT)
        look_at_pilot(a);
    else if (a->mean || 0.5 * a->level >= a->most ||
             (a->error > 0 && film_error(a->film) <= a->error))
        return false;
    else
        a->level *= 2;
    a->step = BASE;
    a->expected = a->mean ? (double)a->mean * a->n : 0;
    adaptive_want(a, a->level < 4 ? 2 : a->level < 0x1p32 ? (uint32_t)(0.5 * a->level) : 1u << 31);
    return true;
}

static const OptDef options[] = {
    ADAPTIVE_LEAST,
    { .key = "pilot", .type = OPT_INT, .num = 1024, .lo = 1, .hi = 16777216,
      .help = "pixels for the mean deviation" },
    { .key = "rerender", .type = OPT_BOOL,
      .help = "pixels that deviate more than expected are done again; biased: 2 % dark under a "
              "probe, 28 % where light is rare bright samples" },
    { .key = NULL }
};

const AdaptiveKind adaptive_variable = {
    .info = { "variable", "Cline07 5.5", "by the deviation of the pixels before; half of the mean "
              "or more, at least two", options },
    .truth = UNBIASED, .start = start, .plan = plan, .units = units, .run = run
};
