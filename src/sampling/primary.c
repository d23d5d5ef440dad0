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

static PrimaryNumber number_of(Sampler *s, Decision d)
{
    Primary *p = s->state;
    PrimaryVector *next = &p->vector[!p->now];
    const PrimaryVector *now = &p->vector[p->now];
    uint64_t key = draw64(s->key, d), bits = mix64(key ^ p->draw);
    PrimaryNumber x = { key, { (uint32_t)(bits >> 40), (uint32_t)bits >> 8 } };
    uint32_t slot, old = p->fresh ? 0 : now->slots[slot_of(now, key)];

    if (old && d % DECIDE_KINDS == DECIDE_TECHNIQUE)
        x = now->numbers[old - 1];
    else if (old) {
        const PrimaryNumber *was = &now->numbers[old - 1];
        x.u[0] = moved(p->kernel, was->u[0], (uint32_t)(bits >> 32));
        x.u[1] = moved(p->kernel, was->u[1], (uint32_t)bits);
    }
    slot = slot_of(next, key);
    if (!next->slots[slot] && next->n < PRIMARY_MOST) {
        next->numbers[next->n++] = x;
        next->slots[slot] = (uint16_t)next->n;
    }
    return x;
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
