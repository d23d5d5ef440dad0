/* primary.c -- see primary.h. */
#include "sampling/primary.h"

#include <string.h>

enum { ONE = 1 << 24 };                 /* what numbers wrap around at */

void primary_kernel(PrimaryKernel *k, float least, float largest)
{
    double ratio = md_log((double)largest / least);

    for (int i = 0; i <= PRIMARY_KNOTS; i++)
        k->at[i] = (uint32_t)(ONE * (least * md_exp(ratio * i / PRIMARY_KNOTS)) + 0.5);
}

void primary_propose(Primary *p, uint64_t draw, bool large)
{
    PrimaryVector *v = &p->vector[!p->now];

    v->n = 0;
    memset(v->slots, 0, sizeof v->slots);
    p->draw = draw;
    p->fresh = large;
}

/* Of 32 random bits: 6 choose the piece of the kernel, 17 the place in it, 1 the sign. */
static uint32_t moved(const PrimaryKernel *k, uint32_t u, uint32_t bits)
{
    const uint32_t *piece = &k->at[bits >> 26];
    uint64_t place = bits >> 9 & 0x1FFFF;
    uint32_t step = piece[0] + (uint32_t)(((piece[1] - piece[0]) * place) >> 17);

    return (bits & 1 ? u + step : u - step) & (ONE - 1);
}

/* The slot of the key in the vector: its own, or an empty one. */
INLINE uint32_t slot_of(const PrimaryVector *v, uint64_t key)
{
    uint32_t s = (uint32_t)(key >> 32) % PRIMARY_SLOTS;

    while (v->slots[s] && v->numbers[v->slots[s] - 1].key != key)
        s = (s + 1) % PRIMARY_SLOTS;
    return s;
}

/* The proposal's number for a decision that it has not made so far. */
INLINE PrimaryNumber proposed(const Primary *p, Decision d, uint64_t key)
{
    const PrimaryVector *now = &p->vector[p->now];
    uint64_t bits = mix64(key ^ p->draw);
    uint32_t old = p->fresh ? 0 : now->slots[slot_of(now, key)];
    const PrimaryNumber *was;

    if (!old)
        return (PrimaryNumber){ key, { (uint32_t)(bits >> 40), (uint32_t)bits >> 8 } };
    was = &now->numbers[old - 1];
    if (d % DECIDE_KINDS == DECIDE_TECHNIQUE)
        return *was;
    return (PrimaryNumber){ key, { moved(p->kernel, was->u[0], (uint32_t)(bits >> 32)),
                                   moved(p->kernel, was->u[1], (uint32_t)bits) } };
}

static void keep(PrimaryVector *v, uint32_t slot, const PrimaryNumber *x)
{
    if (v->n >= PRIMARY_MOST)
        return;
    v->numbers[v->n++] = *x;
    v->slots[slot] = (uint16_t)v->n;
}

static PrimaryNumber number_of(Sampler *s, Decision d)
{
    Primary *p = s->state;
    PrimaryVector *next = &p->vector[!p->now];
    uint64_t key = draw64(s->key, d);
    uint32_t slot = slot_of(next, key);
    PrimaryNumber x;

    if (next->slots[slot])
        return next->numbers[next->slots[slot] - 1];
    x = proposed(p, d, key);
    keep(next, slot, &x);
    return x;
}

/* Number u of piece k of n: each result has alike many. */
static uint32_t in_piece(uint32_t k, uint32_t n, uint32_t u)
{
    return (uint32_t)(((uint64_t)k * ONE + u) / n);
}

void primary_settle(Sampler *s, Decision d, uint32_t x, uint32_t y, uint32_t nx, uint32_t ny)
{
    Primary *p = s->state;
    PrimaryVector *next = &p->vector[!p->now];
    PrimaryNumber u = proposed(p, d, draw64(s->key, d));

    u.u[0] = in_piece(x, nx, u.u[0]);
    u.u[1] = in_piece(y, ny, u.u[1]);
    keep(next, slot_of(next, u.key), &u);
}

static float one(Sampler *s, Decision d) { return (float)number_of(s, d).u[0] * 0x1p-24f; }

static V2 two(Sampler *s, Decision d)
{
    PrimaryNumber x = number_of(s, d);
    return (V2){ (float)x.u[0] * 0x1p-24f, (float)x.u[1] * 0x1p-24f };
}

/* Not in the list of samplers: nobody can choose it. */
static const SamplerKind kind = { .info = { "primary", "", "", NULL }, .one = one, .two = two };

Sampler primary_sampler(Primary *p)
{
    Sampler s;

    memset(&s, 0, sizeof s);
    s.kind = &kind;
    s.state = p;
    sampler_pixel(&s, 0, 0);
    sampler_start(&s, 0);
    return s;
}

/* ---- in files ---- */

void primary_save(const Primary *p, Saving *s)
{
    const PrimaryVector *v = &p->vector[p->now];

    save_u32(s, v->n);
    for (int i = 0; i < PRIMARY_SLOTS; i++)
        save_u32(s, v->slots[i]);
    for (uint32_t i = 0; i < v->n; i++) {
        save_u64(s, v->numbers[i].key);
        save_u32(s, v->numbers[i].u[0]);
        save_u32(s, v->numbers[i].u[1]);
    }
}

bool primary_load(Primary *p, Loading *l)
{
    PrimaryVector *v = &p->vector[p->now];

    v->n = load_u32(l);
    if (v->n > PRIMARY_MOST)
        return false;
    for (int i = 0; i < PRIMARY_SLOTS; i++) {
        uint32_t slot = load_u32(l);
        if (slot > v->n)
            return false;
        v->slots[i] = (uint16_t)slot;
    }
    for (uint32_t i = 0; i < v->n; i++) {
        v->numbers[i].key = load_u64(l);
        for (int k = 0; k < 2; k++)
            v->numbers[i].u[k] = load_u32(l) & 0xFFFFFFu;
    }
    return !l->beyond;
}
