/* hemisphere.h -- irradiance and how it changes, from one ray in each cell of the hemisphere.
 *
 * Source      [Ward88], [WardHeckbert92]: m rings of equal parts of the cosine, n sectors.
 * Gradients   By turning: each cell brings more by the tangent of its angle; taken is the mean of
 *             that over the cell, which is finite in the lowest ring, where the tangent of a drawn
 *             angle has no variance. By moving: what is near moves against what is beyond, so the
 *             borders of cells move, those that the nearer of both sides shows; with the exact
 *             integral of the cosine along the border between sectors.
 * Signs       E(n, x + dx) = E + dx . move; E(n', x) = E + (n x n') . turn, to first order.
 * Order       Cells are taken sector by sector, the lowest angle first: the last sector and the
 *             first are all that has to be remembered. */
#ifndef INTEGRATORS_HEMISPHERE_H
#define INTEGRATORS_HEMISPHERE_H

#include "base/vec.h"

typedef struct {
    Rgb   E;                    /* irradiance */
    V3    turn[3], move[3];     /* of red, green and blue */
    float inv_distance;         /* mean of 1 / distance: one over the harmonic mean */
} Irradiance;

enum { RINGS_MOST = 160, HEMISPHERE_RAYS_MOST = 65536 };
typedef struct { Rgb L; float inv_distance; } HemisphereCell;
typedef struct {
    int    rings, sectors;
    HemisphereCell first[RINGS_MOST], last[RINGS_MOST];         /* sectors */
    float  tangent[RINGS_MOST]; /* mean of the tangent over the ring, by cosine */
    double E[3], turn[3][2], move[3][2], inv;   /* local x and y */
} Hemisphere;

/* How to make about so many cells, nearly square ones; at least 3 sectors. */
void hemisphere_cells(int rays, int *rings, int *sectors);
void hemisphere_start(Hemisphere *h, int rays);
/* A direction, local with the normal along z, of ring j and sector k. */
V3   hemisphere_direction(const Hemisphere *h, int j, int k, V2 u);
/* What comes from there: for each sector, for each ring, each once. inv_distance 0: from beyond. */
void hemisphere_take(Hemisphere *h, int j, int k, Rgb L, float inv_distance);
void hemisphere_end(Hemisphere *h, const Frame *f, Irradiance *out);

#endif
