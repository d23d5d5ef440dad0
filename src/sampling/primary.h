/* primary.h -- the numbers that one sample was made of, kept and changed: the primary sample space.
 *
 * Source      [Kelemen02], [Cline07 7.13; errata 7.13].
 * Idea        A path is made of the numbers that its decisions asked a sampler for. This sampler
 *             gives a proposal: decisions that the present sample made too are answered with nearly
 *             its numbers, all others, or all in a large step, with fresh ones. What comes of it
 *             becomes the present sample, or is dropped.
 * Symmetric   Numbers move by the same kernel both ways and wrap around, so a proposal and its
 *             reverse have equal densities. Of decisions that only one of the two samples makes,
 *             one way draws them afresh, of density 1, and the other leaves them undrawn, which is
 *             1 too. So a number that is no longer asked for is dropped, and nobody has to
 *             remember when it last changed, as [Kelemen02] does.
 * Kernel      Steps of either sign, their logarithm even between those of the least and the largest
 *             one. Numbers are whole multiples of 2^-24, and so are steps: what wraps around comes
 *             back exactly.
 *             DECIDE_TECHNIQUE does not move in small steps: among ways of making paths there is
 *             no near and far.
 * Settled     A decision of a large step can be answered beforehand, by a number that makes many
 *             proposals even: for this one alone it must be as random as any.
 * Pure        The proposal's numbers are functions of the present ones, of the proposal's key and
 *             the decision alone. A decision asked for twice gets the same answer. Those beyond
 *             PRIMARY_MOST are not kept but fresh in every proposal: symmetric too. */
#ifndef SAMPLING_PRIMARY_H
#define SAMPLING_PRIMARY_H

#include "base/archive.h"
#include "sampling/sampler.h"

enum { PRIMARY_MOST = 512, PRIMARY_SLOTS = 2 * PRIMARY_MOST, PRIMARY_KNOTS = 64 };

/* Steps at equal distances of their logarithm, in units of 2^-24; straight in between. */
typedef struct { uint32_t at[PRIMARY_KNOTS + 1]; } PrimaryKernel;

typedef struct {
    uint64_t key;               /* of the sampler's stream and the decision */
    uint32_t u[2];              /* below 2^24; one of a decision with one number */
} PrimaryNumber;

typedef struct {
    uint32_t n;
    uint16_t slots[PRIMARY_SLOTS];      /* a hash table: 1 + the number's place, or 0 */
    PrimaryNumber numbers[PRIMARY_MOST];
} PrimaryVector;

typedef struct {
    const PrimaryKernel *kernel;        /* borrowed */
    uint64_t draw;              /* key of the proposal */
    bool fresh;                 /* nothing of the present sample stays */
    int  now;                   /* which vector is the present one; the other is the proposal's */
    PrimaryVector vector[2];
} Primary;

/* least <= largest <= 1/2: lengths of steps. */
void primary_kernel(PrimaryKernel *k, float least, float largest);

/* Begins a proposal, random by `draw`; large: with no regard to the present sample. */
void primary_propose(Primary *p, uint64_t draw, bool large);
/* The proposal becomes the present sample. */
INLINE void primary_accept(Primary *p) { p->now ^= 1; }

/* The present sample, into a file and back, as the present one of p. False: it does not fit. */
void primary_save(const Primary *p, Saving *s);
bool primary_load(Primary *p, Loading *l);

/* A sampler that gives the proposal's numbers; copies of it give the same. Its streams are those of
 * sampler_pixel and sampler_start. */
Sampler primary_sampler(Primary *p);

/* Answers a decision of a large proposal: its two numbers are within cell (x, y) of nx x ny. */
void primary_settle(Sampler *s, Decision d, uint32_t x, uint32_t y, uint32_t nx, uint32_t ny);

#endif
