/* learned.h -- densities that are learned while they are in use: tables of cells over [0,1) or over
 * the unit square, or one entry a choice, as [Cline07 9.2.3] has them.
 *
 * Mass        A map is an array of cells whose masses sum to 1; where it is used for sampling, its
 *             density at a place is the mass of the cell times the number of cells.
 * Learning    What samples have been worth is added to an empty array, each sample to the cell of
 *             its place and to those around it. learned_merge makes that a map, with a constant
 *             added so that no place is forgotten, and mixes it with the map in use.
 * Means       of masses are masses: maps are averaged cell by cell and inverted afterwards. Rows of
 *             inverted tables, each divided by its own sum, would not average [errata 9.1].
 * Inversion   Running sums of the rows and within each row; a look-up is two searches by halves.
 *             A density is the difference of the very sums that the search compares. */
#ifndef SAMPLING_LEARNED_H
#define SAMPLING_LEARNED_H

#include "base/vec.h"

#include <stdbool.h>

enum { LEARNED_SIDE_MOST = 256 };       /* cells along a side */

typedef struct {
    int   w, h;                 /* cells; h 1: of one number */
    bool  around;               /* the columns close to a ring */
    bool  single;               /* entries are no places: none has neighbours */
} LearnedShape;

INLINE int learned_cells(LearnedShape s) { return s.w * s.h; }

/* Adds what a sample at the place was worth to its cell and to those next to it: 3 or 3 x 3. Not
 * finite or not above 0: nothing. */
void learned_add(float *worth, LearnedShape s, V2 place, float value);

/* map = (map + m) / 2, with m = (worth / its sum + constant), over its own sum. False: the worth
 * is 0 everywhere, and the map is left as it is. */
bool learned_merge(float *map, const float *worth, int cells, float constant);
void learned_uniform(float *map, int cells);
/* The density of a map at a place, not inverted. */
float learned_density(const float *map, LearnedShape s, V2 place);

/* mean[i] of n arrays, n >= 1. */
void learned_mean(float *mean, const float *const *of, int n, int cells);

/* sum[i] += a[i] */
void learned_sum(float *sum, const float *a, int cells);

/* ---- inverted ---- */

typedef struct {
    LearnedShape shape;
    float *row;                 /* borrowed: h + 1 running sums of rows, */
    float *cell;                /* and w + 1 of each row */
} Inverted;

INLINE int inverted_size(LearnedShape s) { return s.h + 1 + s.h * (s.w + 1); }
/* Of `part` of the map, the remainder being even. room: inverted_size() floats. */
void  inverted_make(Inverted *t, LearnedShape s, const float *map, float part, float *room);
/* u warped to the density, in multiples of 2^-24 as samplers give them; *density of the place. */
V2    inverted_sample(const Inverted *t, V2 u, float *density);
float inverted_density(const Inverted *t, V2 place);
/* One of the entries of a table without rows; *rest: what u still holds of chance, in [0,1]. */
int   inverted_choose(const Inverted *t, float u, float *rest);
float inverted_pmf(const Inverted *t, int entry);

#endif
