/* enumerate.c -- a Sampler that goes through all outcomes. See enumerate.h. */
#include "test/enumerate.h"

#include "test/test.h"

#include <string.h>

static const uint32_t UNITS = 1u << 24;         /* canonical numbers */
#define MOST_RUNS 100000000u

typedef struct { double v[ENUMERATE_VALUES]; } Values;
typedef struct { Enumeration *e; Enumerated f; void *of; } Task;

/* ---- the sampler ---- */

V2 enumerate_fixed(const Enumeration *e, Decision d)
{
    uint64_t bits = draw64(mix64(e->seed + 1), d);
    return (V2){ unit_of((uint32_t)(bits >> 32)), unit_of((uint32_t)bits) };
}

static float one(Sampler *s, Decision d)
{
    Enumeration *e = s->state;

    if (e->rule[d % DECIDE_KINDS] == FIXED)
        return enumerate_fixed(e, d).x;
    for (int k = 0; k < e->seen; k++)
        if (e->met[k].id == d)
            return e->met[k].u;
    REQUIRE(e->seen < ENUMERATE_DEPTH, "more than %d decisions", ENUMERATE_DEPTH);
    e->met[e->seen].id = d;
    e->met[e->seen].u = 0.0f;
    return e->met[e->seen++].u;
}

static V2 two(Sampler *s, Decision d) { return enumerate_fixed(s->state, d); }

static const SamplerKind sampler_enumerate = {
    .info = { "enumerate", "", "all outcomes of discrete decisions", NULL }, .one = one, .two = two
};

/* ---- the mean over decisions from number `level` on, those before being decided ---- */

static Values mean_from(const Task *t, int level);

static Values with(const Task *t, int level, Decision id, uint32_t unit)
{
    Enumeration *e = t->e;
    e->met[level].id = id;
    e->met[level].u = (float)unit * 0x1p-24f;
    return mean_from(t, level + 1);
}

static void add(Values *sum, const Values *x, double weight)
{
    for (int k = 0; k < ENUMERATE_VALUES; k++)
        sum->v[k] += weight * x->v[k];
}

/* Adds the integral over the units a .. b - 1, given the values at a and b. */
static void add_steps(const Task *t, int level, Decision id, uint32_t a, const Values *at_a,
                      uint32_t b, const Values *at_b, Values *sum)
{
    uint32_t m = a + (b - a) / 2;
    Values at_m;

    if (b - a == 1 || !memcmp(at_a, at_b, sizeof *at_a)) {
        add(sum, at_a, (double)(b - a) / UNITS);
        return;
    }
    at_m = with(t, level, id, m);
    add_steps(t, level, id, a, at_a, m, &at_m, sum);
    add_steps(t, level, id, m, &at_m, b, at_b, sum);
}

static Values mean_of(const Task *t, int level, Decision id)
{
    const Enumeration *e = t->e;
    uint32_t n = e->n[id % DECIDE_KINDS];
    Values sum = { { 0 } }, first, next;

    if (e->rule[id % DECIDE_KINDS] == CELLS) {
        for (uint32_t i = 0; i < n; i++) {
            next = with(t, level, id, (uint32_t)((i + 0.5) / n * UNITS));
            add(&sum, &next, 1.0 / n);
        }
        return sum;
    }
    first = with(t, level, id, 0);
    for (uint32_t i = 0; i < n; i++) {
        uint32_t a = (uint32_t)((double)i / n * UNITS), b = (uint32_t)((i + 1.0) / n * UNITS);
        b -= i + 1 == n;                        /* the last number itself is added below */
        next = with(t, level, id, b);
        add_steps(t, level, id, a, &first, b, &next, &sum);
        first = next;
    }
    add(&sum, &first, 1.0 / UNITS);
    return sum;
}

static Values mean_from(const Task *t, int level)
{
    Enumeration *e = t->e;
    Sampler s;
    Values v = { { 0 } };

    memset(&s, 0, sizeof s);
    s.kind = &sampler_enumerate;
    s.state = e;
    e->seen = level;
    REQUIRE(++e->runs <= MOST_RUNS, "no end of outcomes: something is continuous");
    t->f(t->of, &s, v.v);
    return e->seen == level ? v : mean_of(t, level, e->met[level].id);
}

void enumerate_mean(Enumeration *e, Enumerated f, void *of, double *mean)
{
    Task t = { e, f, of };
    Values v = mean_from(&t, 0);
    memcpy(mean, v.v, sizeof v.v);
}
