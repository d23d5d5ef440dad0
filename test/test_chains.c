/* test_chains.c -- chains on a handful of states, where all that they should find is known. */
#include "base/maths.h"
#include "integrators/chains.h"
#include "test/test.h"

#include <stdio.h>
#include <string.h>

/* ---- a world of nine states: the pixels of a picture, of these lights ---- */

enum { STATES = 9 };
static const Rgb light_of[STATES] = {
    { 1, 0.5f, 0.25f }, { 0, 0, 0 }, { 4, 4, 1 }, { 0.125f, 2, 0 }, { 30, 20, 10 }, { 0, 0, 3 },
    { 0.5f, 0.5f, 0.5f }, { 8, 0, 0 }, { 1, 1, 1 }
};

/* A small step goes to the next state with 1/2, to the one before with 1/4, else anywhere. */
static float transition(int from, int to)
{
    float t = 0.25f / STATES;

    if (to == (from + 1) % STATES)
        t += 0.5f;
    if (from == (to + 1) % STATES)
        t += 0.25f;
    return t;
}

typedef struct { Chain base; int at; } Walker;

static bool walker_init(Chains *cs, Chain *c)
{
    (void)cs;
    ((Walker *)c)->at = -1;
    return true;
}

static void walker_clear(Chain *c) { (void)c; }

/* A sample is a state drawn evenly, of density 1 / STATES: so is its brightness divided by that. */
static float brightness_of(int k) { return STATES * rgb_lum(light_of[k]); }

static int anywhere(float u) { return (int)(u * STATES); }

static float walker_start(Chains *cs, Chain *c, uint64_t number, Tracer *t)
{
    uint64_t bits = draw64(key_with(cs->seed, 99), number);

    (void)t;
    ((Walker *)c)->at = anywhere(unit_of((uint32_t)(bits >> 32)));
    return brightness_of(((Walker *)c)->at);
}

static void show_state(int k, float weight, Tracer *t)
{
    V2 place = { (float)(k % 3) + 0.5f, (float)(k / 3) + 0.5f };

    tracer_splat(t, place, 1, STRATEGY_LENS, rgb_scale(light_of[k], weight));
}

static void walker_show(Chains *cs, Chain *c, float weight, Tracer *t)
{
    (void)cs;
    show_state(((Walker *)c)->at, weight, t);
}

static void walker_step(Chains *cs, Chain *c, Tracer *t)
{
    Walker *w = (Walker *)c;
    Rng r = { key_with(c->key, c->steps), 0 };
    bool large = rng_unit(&r) < cs->kind.large;
    int to, from = w->at;
    float u = rng_unit(&r), I, a;
    Step s;

    if (large)
        to = anywhere(rng_unit(&r));
    else
        to = u < 0.5f ? (from + 1) % STATES : u < 0.75f ? (from + STATES - 1) % STATES
                                                      : anywhere(rng_unit(&r));
    I = brightness_of(to);
    a = c->brightness > 0.0f && !large
            ? I * transition(to, from) / (c->brightness * transition(from, to))
            : chain_accepts(c, I);
    s = chain_steps(cs, c, I, f_min(a, 1.0f), large, rng_unit(&r));
    if (s.left > 0)
        show_state(s.moves ? from : to, (float)s.left, t);
    if (s.moves)
        w->at = to;
}

static const OptDef walker_options[] = { CHAINS_OPTIONS, { .key = NULL } };
static const IntegratorKind walkers = { .info = { "walkers", "", "", walker_options } };

/* The picture after so many passes, as nine numbers of each channel. */
typedef struct { uint32_t chains, bootstrap, passes; float large; uint64_t seed; } Walk;

static void run_walk(const Walk *w, float *picture, double *b)
{
    static const uint32_t crop[4] = { 0, 0, 3, 3 };
    const FilterKind *box = kind_find(filters, "box");
    ChainKind kind = { sizeof(Walker), w->large, walker_init, walker_clear, walker_start,
                       walker_step, walker_show };
    Chains cs;
    Tracer t;
    Canvas canvas;
    Filter filter;
    Film f;
    Image im;
    Opts o;

    memset(&cs, 0, sizeof cs);
    memset(&t, 0, sizeof t);
    memset(&canvas, 0, sizeof canvas);
    opts_default(&o, box->info.options);
    filter_init(&filter, box, &o);
    REQUIRE(film_init(&f, 3, 3, crop, 1) && film_accepts_splats(&f) && image_init(&im, 3, 3),
            "memory");
    canvas = (Canvas){ .film = &f, .filter = &filter };
    canvas.layers[1][STRATEGY_LENS] = 1;
    t.canvas = &canvas;
    cs.base.kind = &walkers;
    opts_default(&o, walker_options);
    opt_set_number(&o, "chains", w->chains);
    opt_set_number(&o, "bootstrap", w->bootstrap);
    chains_open(&cs, &kind, &o);
    REQUIRE(chains_prepare(&cs.base, &f, w->seed), "memory");
    for (uint32_t pass = 0; pass < w->passes; pass++) {
        for (int phase = 0; phase < CHAINS_PHASES; phase++) {
            uint64_t n = chains_units(&cs.base, &f, pass, phase);
            for (uint64_t k = 0; k < n; k++)
                chains_run(&cs.base, &f, pass, phase, k, &t);
        }
    }
    EXPECT(t.shots == w->passes * STATES, "%.0f steps", (double)t.shots);
    film_shots(&f, t.shots);
    film_picture(&f, 0, &im);
    memcpy(picture, im.pixels, STATES * sizeof(Rgb));
    *b = cs.b;
    chains_clear(&cs);
    film_clear(&f);
    image_clear(&im);
}

/* The mean of many walks is the picture, in each channel of each state. One in 60 million normal
 * numbers is 5.7 off. */
static void expect_picture(const Walk *like, int n)
{
    double sum[STATES * 3] = { 0 }, squares[STATES * 3] = { 0 }, b;
    float got[STATES * 3];
    const float *want = &light_of[0].r;
    Walk w = *like;

    for (int k = 0; k < n; k++) {
        w.seed = (uint64_t)k;
        run_walk(&w, got, &b);
        for (int i = 0; i < STATES * 3; i++) {
            sum[i] += got[i];
            squares[i] += (double)got[i] * got[i];
        }
    }
    for (int i = 0; i < STATES * 3; i++) {
        double mean = sum[i] / n, var = (squares[i] / n - mean * mean) / (n - 1);
        EXPECT(fabs(mean - want[i]) <= 5.7 * sqrt(var) + 1e-6 * want[i],
               "%u chains, %u passes, large %g: state %d, channel %d: %g, not %g, error %g",
               (unsigned)w.chains, (unsigned)w.passes, w.large, i / 3, i % 3, mean, want[i],
               sqrt(var));
    }
}

/* With the b of its start alone, one pass is right in the mean, long before any chain can have
 * forgotten where it began: so are two, with b refined, as near as the tests can tell. */
static void starts_without_bias(void)
{
    expect_picture(&(Walk){ 3, 40, 1, 0.0f, 0 }, 20000);
    expect_picture(&(Walk){ 1, 300, 1, 0.0f, 0 }, 4000);
    expect_picture(&(Walk){ 20, 40, 1, 0.0f, 0 }, 20000);
}

static void chains_find_the_picture(void)
{
    expect_picture(&(Walk){ 4, 20000, 50, 0.0f, 0 }, 60);
    expect_picture(&(Walk){ 4, 20000, 50, 0.3f, 0 }, 60);
    expect_picture(&(Walk){ 4, 20000, 50, 1.0f, 0 }, 60);
}

const TestCase test_chains[] = {
    { "starts_without_bias", starts_without_bias, false },
    { "chains_find_the_picture", chains_find_the_picture, false },
    { NULL, NULL, false }
};
