/* chains.c -- the code of `chains.h`. */
#include "integrators/chains.h"

#include "base/mem.h"

enum { LEAST_STARTS = 64 };             /* samples a chain */

void chains_open(Chains *cs, const ChainKind *kind, const Opts *o)
{
    cs->kind = *kind;
    cs->n = (size_t)opt_int(o, "chains");
    cs->asked = (uint64_t)opt_int(o, "bootstrap");
}

void chains_clear(Chains *cs)
{
    for (size_t k = 0; k < cs->inited; k++)
        cs->kind.clear(chains_at(cs, k));
    mem_free(cs->chains);
    mem_free(cs->brightness);
}

bool chains_prepare(Integrator *it, const Film *f, uint64_t seed)
{
    Chains *cs = (Chains *)it;

    cs->seed = key_with(0, seed);
    cs->pixels = (uint64_t)f->w * f->h;
    cs->total = cs->asked ? cs->asked : cs->pixels;
    if (!cs->asked && cs->total < LEAST_STARTS * cs->n)
        cs->total = LEAST_STARTS * cs->n;
    cs->brightness = MEM_ARRAY(float, cs->total);
    cs->chains = mem_array(cs->n, cs->kind.size);
    if (!cs->brightness || !cs->chains)
        return false;
    for (size_t k = 0; k < cs->n; k++) {
        Chain *c = chains_at(cs, k);
        c->key = key_with(cs->seed, k);
        cs->inited++;
        if (!cs->kind.init(cs, c))
            return false;
    }
    return true;
}

/* ---- starts ---- */

/* Of `whole` things the k-th of n parts is first .. last-1. */
static void part_of(uint64_t whole, uint64_t k, uint64_t n, uint64_t *first, uint64_t *last)
{
    *first = whole / n * k + (k < whole % n ? k : whole % n);
    *last = *first + whole / n + (k < whole % n);
}

/* Some of the samples, with the storage of a chain. */
static void try_starts(Chains *cs, size_t k, Tracer *t)
{
    uint64_t first, last;

    part_of(cs->total, k, cs->n, &first, &last);
    for (uint64_t i = first; i < last; i++)
        cs->brightness[i] = cs->kind.start(cs, chains_at(cs, k), i, t);
}

/* Which sample each chain begins with: numbers of samples, kept in Chain.steps till it does. */
static bool choose_starts(Chains *cs)
{
    double step, sum = 0, at;
    uint64_t i = 0;

    for (uint64_t k = 0; k < cs->total; k++)
        cs->found += cs->brightness[k];
    cs->tries = cs->total;
    step = cs->found / (double)cs->n;
    at = step * unit_of((uint32_t)(draw64(cs->seed, 0) >> 32));
    for (size_t k = 0; k < cs->n; k++, at += step) {
        while (i < cs->total - 1 && sum + cs->brightness[i] <= at)
            sum += cs->brightness[i++];
        chains_at(cs, k)->steps = i;
    }
    mem_free(cs->brightness);
    cs->brightness = NULL;
    cs->c = cs->found > 0 ? cs->found / (double)cs->total : 1;
    return cs->found > 0 ||
           warn_at((Place){ NULL, 0, 0 }, "%s found no light in %.0f samples to start with: the "
                   "picture may be black", cs->base.kind->info.name, (double)cs->total);
}

static void start_chain(Chains *cs, Chain *c, Tracer *t)
{
    c->brightness = cs->kind.start(cs, c, c->steps, t);
    c->steps = 0;
}

/* ---- passes ---- */

/* Before the chains go on: what their large steps say of b, in the order of the chains. */
static void refine(Chains *cs)
{
    for (size_t k = 0; k < cs->n; k++) {
        Chain *c = chains_at(cs, k);
        cs->found += c->found;
        cs->tries += c->tries;
        c->found = 0;
        c->tries = 0;
    }
    cs->b = cs->found / (double)cs->tries;
}

uint64_t chains_units(Integrator *it, const Film *f, uint32_t pass, int phase)
{
    Chains *cs = (Chains *)it;

    (void)f;
    if (phase == 0)
        return pass ? 0 : cs->n;
    if (cs->begun == pass + 1)
        return cs->n;           /* of a state that was left in the middle of it */
    cs->begun = pass + 1;
    if (pass == 0)
        it->failed = !choose_starts(cs);
    refine(cs);
    return cs->n;
}

Step chain_steps(const Chains *cs, Chain *c, float brightness, float a, bool large, float u)
{
    Step s = { u < a, 0 };

    if (brightness > 0)
        s.left = a * chains_visit(cs, brightness) + (large ? chains_try(cs, brightness) : 0);
    if (c->brightness > 0)
        c->weight += (1 - (double)a) * chains_visit(cs, c->brightness);
    if (large) {
        c->found += brightness;
        c->tries++;
    }
    if (s.moves) {
        double left = c->weight;
        c->weight = s.left;
        c->brightness = brightness;
        s.left = left;
    }
    return s;
}

static void go_on(Chains *cs, uint32_t pass, size_t k, Tracer *t)
{
    Chain *c = chains_at(cs, k);
    uint64_t first, last;

    part_of(cs->pixels, (k + pass) % cs->n, cs->n, &first, &last);
    for (; first < last; first++, c->steps++) {
        t->shots++;
        cs->kind.step(cs, c, t);
    }
    if (c->weight > 0)
        cs->kind.show(cs, c, (float)c->weight, t);
    c->weight = 0;
}

void chains_run(Integrator *it, Film *f, uint32_t pass, int phase, uint64_t unit, Tracer *t)
{
    Chains *cs = (Chains *)it;

    (void)f;
    if (phase == 0)
        try_starts(cs, (size_t)unit, t);
    else {
        if (pass == 0)
            start_chain(cs, chains_at(cs, (size_t)unit), t);
        go_on(cs, pass, (size_t)unit, t);
    }
}

/* ---- what lasts ---- */

void chains_save(const Integrator *it, Saving *s)
{
    const Chains *cs = (const Chains *)it;

    save_u32(s, cs->begun);
    save_double(s, cs->found);
    save_u64(s, cs->tries);
    save_double(s, cs->b);
    save_double(s, cs->c);
    for (uint64_t i = 0; cs->brightness && i < cs->total; i++)
        save_float(s, cs->brightness[i]);
    for (size_t k = 0; k < cs->n; k++) {
        const Chain *c = chains_at(cs, k);
        save_u64(s, c->steps);
        save_float(s, c->brightness);
        save_double(s, c->weight);
        save_double(s, c->found);
        save_u64(s, c->tries);
        cs->kind.save(cs, c, s);
    }
}

bool chains_load(Integrator *it, Loading *l)
{
    Chains *cs = (Chains *)it;
    bool ok = true;

    cs->begun = load_u32(l);
    cs->found = load_double(l);
    cs->tries = load_u64(l);
    cs->b = load_double(l);
    cs->c = load_double(l);
    if (cs->begun) {            /* chains have been chosen */
        mem_free(cs->brightness);
        cs->brightness = NULL;
    }
    for (uint64_t i = 0; cs->brightness && i < cs->total; i++)
        cs->brightness[i] = load_float(l);
    for (size_t k = 0; ok && k < cs->n; k++) {
        Chain *c = chains_at(cs, k);
        c->steps = load_u64(l);
        c->brightness = load_float(l);
        c->weight = load_double(l);
        c->found = load_double(l);
        c->tries = load_u64(l);
        ok = cs->kind.load(cs, c, l);
    }
    return ok && !l->beyond;
}
