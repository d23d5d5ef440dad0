/* enumerate.h -- the enumerating twin of the Sampler: no chance, no noise.
 *
 * A function that asks for decisions is run again and again until every outcome of the discrete
 * ones has been seen, each weighted by the share of canonical numbers that leads to it; the mean
 * comes out as a finite sum. Decisions of some kinds are enumerated, all others get one fixed
 * number each.
 *   CELLS  n numbers in the middle of n equal cells, of weight 1/n: right where what depends on the
 *          number changes only at multiples of 1/n
 *   STEPS  what depends on the number is constant but for some steps, not closer than 1/n; they are
 *          found by bisection among the 2^24 canonical numbers, so weights are exact
 * Which decisions there are may depend on the outcome of others: they are met, not declared. */
#ifndef TEST_ENUMERATE_H
#define TEST_ENUMERATE_H

#include "sampling/sampler.h"

typedef enum { FIXED, CELLS, STEPS } EnumerateRule;
enum { ENUMERATE_VALUES = 4, ENUMERATE_DEPTH = 64 };

typedef struct {
    EnumerateRule rule[DECIDE_KINDS];   /* by kind of decision; 1-D ones only */
    uint32_t n[DECIDE_KINDS];           /* CELLS, STEPS */
    uint64_t seed;                      /* of the fixed numbers */
    uint64_t runs;                      /* so far */

    struct { Decision id; float u; } met[ENUMERATE_DEPTH];
    int seen;                   /* how many of them this run has met */
} Enumeration;

/* Computes values[0..ENUMERATE_VALUES) with decisions from s. */
typedef void (*Enumerated)(void *of, Sampler *s, double *values);

/* The mean of f. Ends the case after 10^8 runs. */
void enumerate_mean(Enumeration *e, Enumerated f, void *of, double *mean);

/* The fixed numbers of a decision: what FIXED ones get. */
V2 enumerate_fixed(const Enumeration *e, Decision d);

#endif
