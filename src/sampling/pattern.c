/* pattern.c -- blocks, strata and permutations. See pattern.h. */
#include "sampling/pattern.h"

#include <string.h>

Randomize randomize_of(const Opts *o)
{
    const char *word = opt_string(o, "randomize");
    return !strcmp(word, "rotation") ? ROTATION
           : !strcmp(word, "none") ? FIXED
           : !strcmp(word, "permutedigits") ? DIGITS : OWEN;
}

/* ---- blocks ---- */

void plan_blocks(Sampler *s, uint32_t spp, uint32_t most)
{
    uint32_t blocks = most && spp > most ? (spp - 1) / most + 1 : 1;

    s->block = spp ? (spp - 1) / blocks + 1 : 0;
    s->most = most ? most : 1u << 30;
}

/* The most even a x b of at least n strata, a <= b <= 2 a; exactly n if there are such. Three stay
 * 1 x 3. */
static void even_strata(uint32_t n, uint32_t *a, uint32_t *b)
{
    uint32_t root = 1;

    while ((uint64_t)(root + 1) * (root + 1) <= n)
        root++;
    for (uint32_t k = root; 2 * (uint64_t)k * k >= n; k--)
        if (n % k == 0) {
            *a = k;
            *b = n / k;
            return;
        }
    *a = root;
    *b = (n - 1) / root + 1;
}

void plan_strata(Sampler *s, uint32_t *spp)
{
    enum { STRATA_MOST = 1 << 30 };
    uint32_t n = *spp;

    plan_blocks(s, n <= STRATA_MOST ? n : 0, STRATA_MOST);
    if (!s->block)
        return;
    even_strata(n, &s->nx, &s->ny);
    s->block = *spp = s->nx * s->ny;
    if (*spp > n)
        note("%s: %lu samples a pixel instead of %lu, for %lu x %lu strata", s->kind->info.name,
             (unsigned long)*spp, (unsigned long)n, (unsigned long)s->nx, (unsigned long)s->ny);
}

void pattern_start(Sampler *s)
{
    uint32_t number = 0, k = 0;

    if (s->block) {
        number = s->index / s->block;
        s->size = s->block;
    } else if (s->index >= s->most) {
        number = 32 + s->index / s->most;
        s->size = s->most;
    } else {
        s->size = 1;
        for (; k < 31 && s->index >> (k + 1); k++)
            s->size *= 2;
        number = s->index ? k + 1 : 0;
    }
    s->at = s->index % s->size;
    if (!s->block)
        for (s->nx = 1; s->nx * s->nx <= s->size / 4; s->nx *= 2)
            ;
    if (!s->block)
        s->ny = s->size / s->nx;
    s->pattern = key_with(s->pixel, SECOND | number);
}

/* ---- orders ---- */

static uint64_t next_key(uint64_t key)
{
    return key * 6364136223846793005u + 1442695040888963407u;
}

/* Of few things every order alike often: Fisher and Yates, following the one place. */
static uint32_t permuted_few(uint32_t i, uint32_t n, uint64_t key)
{
    for (uint32_t k = n - 1; k > 0; k--) {
        uint32_t j;
        key = next_key(key);
        j = (uint32_t)((key >> 32) * (k + 1) >> 32);
        i = i == k ? j : i == j ? k : i;
    }
    return i;
}

/* A bijection of the numbers up to mask = 2^k - 1: sums, odd factors and shifts by half of k. Four
 * rounds are not enough for the places of two things to be independent; six are. */
static uint32_t mixed(uint32_t x, uint32_t mask, int half, uint64_t key)
{
    enum { ROUNDS = 6 };

    for (int r = 0; r < ROUNDS; r++) {
        key = next_key(key);
        x = (x + (uint32_t)(key >> 35)) & mask;
        x = x * ((uint32_t)(key >> 48) | 1) & mask;
        x ^= x >> half;
    }
    return x;
}

/* Of many, orders by hashing: what falls beyond n is hashed again until it is within, which keeps
 * the bijection [Kensler13 5]. The hash is of our own. The turn at the end makes every place of
 * one thing exactly alike often. */
uint32_t permuted(uint32_t i, uint32_t n, uint64_t key)
{
    enum { FEW = 16 };
    uint32_t mask = n - 1, turn;
    int half = 3;

    if (n <= 1)
        return 0;
    if (n <= FEW)
        return permuted_few(i, n, key);
    mask |= mask >> 1;
    mask |= mask >> 2;
    mask |= mask >> 4;
    mask |= mask >> 8;
    mask |= mask >> 16;
    while (mask >> (2 * half - 1) > 1)
        half++;
    if (n == mask + 1)          /* nothing is beyond, and the first sum is a turn */
        return mixed(i, mask, half, key);
    do
        i = mixed(i, mask, half, key);
    while (i >= n);
    turn = (uint32_t)((mix64(key) >> 32) * n >> 32);
    return i < n - turn ? i + turn : i - (n - turn);
}

float stratified_one(Sampler *s, Decision d)
{
    uint32_t k = permuted(s->at, s->size, draw64(s->pattern, d | THIRD));
    return in_stratum(k, s->size, (uint32_t)draw64(s->key, d | THIRD));
}

/* ---- joint dimensions ---- */

int joint_dimension(Decision d, bool two, int dimensions)
{
    /* Within the dimensions of a bounce; -1: never joint. Those of the lens and of time stand
     * behind the first bounce. */
    static const struct { signed char at, size; } place[DECIDE_KINDS] = {
        [DECIDE_PIXEL] = { 0, 2 },     [DECIDE_LENS] = { 8, 2 },  [DECIDE_TIME] = { 10, 1 },
        [DECIDE_LIGHT] = { 4, 1 },     [DECIDE_LIGHT_POINT] = { 2, 2 },
        [DECIDE_LOBE] = { 5, 1 },      [DECIDE_DIRECTION] = { 0, 2 },
    };
    enum { FIRST = 2, A_BOUNCE = 6, BEHIND_LENS = 11 };
    uint32_t kind = d % DECIDE_KINDS, bounce = d / DECIDE_KINDS;
    int at = place[kind].at;

    if (place[kind].size != 1 + two || bounce > 100)
        return -1;
    if (kind <= DECIDE_TIME) {
        if (bounce)
            return -1;
    } else
        at += bounce == 0 ? FIRST : BEHIND_LENS + ((int)bounce - 1) * A_BOUNCE;
    return at + 1 + two <= dimensions ? at : -1;
}
