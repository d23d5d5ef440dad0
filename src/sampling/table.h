/* table.h -- choosing in proportion to given weights: one of many things, or a point of a picture.
 *
 * Source  cumulative tables with binary search, in 2-D one for the rows and one within each,
 *         [Cline07 9.2.3]; the alias method as built by [Vose91].
 *
 * A weight that is negative or not finite counts as 0. A table whose weights are all 0 (or that is
 * empty) is legal: it samples nothing and all its probabilities are 0. Sums are doubles.
 *
 * What a table says is what it does: pmf and pdf are computed from the very numbers that the
 * search compares, so a thing lost to rounding (below 1e-16 of the whole) has probability 0, a
 * thing that is sampled has not, and the value `sample` gives is the same bits as that of `pmf`.
 * A leftover number (`rest`) is canonical again: in [0,1), never 1. It has lost as many bits as the
 * choice used; the 1-D tables take a double so that a caller may pass more than a float's 24. */
#ifndef SAMPLING_TABLE_H
#define SAMPLING_TABLE_H

#include "base/vec.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* ---- one of n, by a cumulative table: O(log n), keeps the order of u (so also stratification) */

typedef struct {
    size_t  n;
    double *sum;                /* owned: n + 1 running sums, from 0 to the total */
} Table;

bool   table_init(Table *t, const float *weight, size_t n);     /* false: memory, reported */
void   table_clear(Table *t);
double table_total(const Table *t);
/* False if there is nothing to sample. pmf and rest may be NULL. */
bool   table_sample(const Table *t, double u, size_t *index, float *pmf, float *rest);
float  table_pmf(const Table *t, size_t index);

/* ---- one of n, by an alias table: O(1), order is lost */

typedef struct {
    double   keep;              /* of a 1/n share of u, this part is the bin's own, */
    uint32_t other;             /* the remainder that of this one */
    float    pmf;
} AliasBin;

typedef struct {
    uint32_t  n;
    double    total;
    AliasBin *bin;              /* owned */
} AliasTable;

bool   alias_init(AliasTable *t, const float *weight, uint32_t n);
void   alias_clear(AliasTable *t);
bool   alias_sample(const AliasTable *t, double u, uint32_t *index, float *pmf, float *rest);
float  alias_pmf(const AliasTable *t, uint32_t index);

/* ---- a point of the unit square, density constant in each of w x h cells */

enum { TABLE2_MOST = 1 << 20 }; /* cells along a side: a float must tell neighbours apart */

typedef struct {
    uint32_t w, h;
    double  *row;               /* owned: h + 1 running sums of whole rows */
    double  *cell;              /* owned: for each row w + 1 running sums */
} Table2;

/* weight[y * w + x] belongs to u in [x/w, (x+1)/w), v in [y/h, (y+1)/h); it is the mean density
 * there, not density times the area of anything. */
bool   table2_init(Table2 *t, const float *weight, uint32_t w, uint32_t h);
void   table2_clear(Table2 *t);
double table2_total(const Table2 *t);
/* pdf is per unit square. The point lies in the cell chosen, also after rounding. */
bool   table2_sample(const Table2 *t, V2 u, V2 *point, float *pdf);
float  table2_pdf(const Table2 *t, V2 point);
/* The numbers for which table2_sample gives the point, but for rounding. */
V2     table2_numbers(const Table2 *t, V2 point);

#endif
