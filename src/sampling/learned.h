/* learned.h -- densities that are learned while they are in use: tables of cells over [0,1) or over
 * the unit square, or one entry a choice, as [Cline07 9.2.3] has them.
 *
 * Mass        Of each cell, the integral of the square of what is to be integrated, as far as it
 *             has been seen: a sample of value v found at density p is worth v^2 p. Where it is
 *             used for sampling, a cell's density is in proportion to the root of its mass: the
 *             best there is for cells within which one knows nothing. [Cline07] takes the means of
 *             values: then a cell that is bright in one corner gets too few samples, each worth
 *             too much.
 * Learning    What samples have been worth is added to an empty array, each sample to the cell of
 *             its place and to those around it; learned_merge adds that to the map in use, of
 *             which half is forgotten. Nothing is normalised, as it is in the source: there, a
 *             pixel that has met with one dim sample changes the map as much as a bright one.
 * Means       of masses are masses: maps are averaged cell by cell and inverted afterwards. Rows of
 *             inverted tables, each divided by its own sum, would not average [errata 9.1].
 * Spheres     Cells of longitude and latitude are narrow near the poles: the footprint has as many
 *             more columns there, so that it is as wide in angle as at the equator.
 * Inversion   Running sums of the rows and within each row; a look-up is two searches by halves.
 *             A density is the difference of the very sums that the search compares. */
#ifndef SAMPLING_LEARNED_H
#define SAMPLING_LEARNED_H

#include "base/vec.h"

#include <stdbool.h>

/* A row of a sphere's cells: how many columns on either side a footprint has, and the sine of the
 * angle to the pole. */
typedef struct { int reach; float sine; } LearnedRing;

typedef struct {
    int   w, h;                 /* cells; h 1: of one number */
    const LearnedRing *rings;   /* borrowed: of rows that are latitudes, columns being longitudes;
                                 * NULL: they are not */
    bool  single;               /* entries are no places: none has neighbours */
} LearnedShape;

void learned_rings(LearnedRing *r, int h);

INLINE int learned_cells(LearnedShape s) { return s.w * s.h; }

/* Adds v^2 p of a sample at the place to its cell and to those next to it: 3 or 3 x 3; on a sphere
 * p is per solid angle. Not finite or not above 0: nothing. */
void learned_add(float *worth, LearnedShape s, V2 place, float square);

/* The density of what is decided by a map, in a share of all decisions, or as without it. */
INLINE float learned_both(float share, float by_map, float own)
{
    return share * by_map + (1.0f - share) * own;               /* [Cline07 (9.2)] */
}

/* Adds what a value, whose square is given, would have been to the second moment with each of n
 * shares: of value v found at density p, that of density p_k would make v p / p_k, p / p_k times as
 * seldom. now: p. */
void learned_moments(float *moment, const float *share, int n, float by_map, float own, float now,
                     float square);

/* Half of map, and worth, of n floats, the first of which are the map's cells. The worth is 0 in
 * all cells, or more than maps may hold: the map is left as it is. No float of it, nor of sums of
 * thousands of maps, gets beyond LEARNED_MOST. */
#define LEARNED_MOST 1e34f
void learned_merge(float *map, const float *worth, int cells, int n);

/* mean[i] of n arrays, n >= 1. */
void learned_mean(float *mean, const float *const *of, int n, int cells);

/* sum[i] += a[i] */
void learned_sum(float *sum, const float *a, int cells);

/* ---- inverted ---- */

typedef struct {
    LearnedShape shape;
    const float *mass;          /* borrowed */
    float  alone;               /* over the root of a mass, for the density by the map alone */
    bool   even;                /* there are no sums: the part was 0 */
    float *row;                 /* borrowed: h + 1 running sums of rows, */
    float *cell;                /* and w + 1 of each row */
} Inverted;

INLINE int inverted_size(LearnedShape s) { return s.h + 1 + s.h * (s.w + 1); }
/* Of `part` of the map, the remainder being even. A map without mass is even. By part 0 numbers
 * stay what they are, and nothing is to be chosen. room: inverted_size() floats. */
void  inverted_make(Inverted *t, LearnedShape s, const float *mass, float part, float *room);
/* u warped to the density, in multiples of 2^-24 as samplers give them; *density of the place. */
V2    inverted_sample(const Inverted *t, V2 u, float *density);
float inverted_density(const Inverted *t, V2 place);
/* The same of the map alone, whatever its part. */
float inverted_alone(const Inverted *t, V2 place);
/* One of the entries of a table without rows; *rest: what u still holds of chance, in [0,1]. */
int   inverted_choose(const Inverted *t, float u, float *rest);
float inverted_pmf(const Inverted *t, int entry);

#endif
