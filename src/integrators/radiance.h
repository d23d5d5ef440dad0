/* radiance.h -- records of the light that comes from all directions of a hemisphere, and what they
 * say of the places between them.
 *
 * Source      [Cline07 7.5.4], [Krivanek05]; gradients by what moves in front of what, as for
 *             irradiance, with a basis function in the place of the cosine [Krivanek05b].
 * Record      Coefficients of the harmonics (harmonics.h), in the frame about its normal, and how
 *             they change along the two tangents.
 * Rays        One in each of cells of equal solid angle: what comes along the surface is as much
 *             to a glossy one as what comes from above.
 * Turned      [Krivanek05] turn the coefficients into the frame of the place that asks, for the
 *             product with those of its BSDF. Here the BSDF is sampled: so one direction is turned
 *             into the frame of the record, which is the same function without a matrix.
 * Negative    Sums of few harmonics swing below 0. What is below is cut off, which makes a glossy
 *             room brighter by less than a thousandth: nobody wants pixels below 0. */
#ifndef INTEGRATORS_RADIANCE_H
#define INTEGRATORS_RADIANCE_H

#include "integrators/harmonics.h"
#include "integrators/hemisphere.h"
#include "integrators/reach.h"

/* One coefficient. */
typedef struct { Rgb value, along[2]; } Radiance;

/* ---- making a record ---- */

typedef struct {
    const Harmonics *basis;     /* borrowed */
    int    rings, sectors;
    HemisphereCell first[RINGS_MOST], last[RINGS_MOST];         /* sectors */
    Radiance of[HARMONICS_MOST];
    double inv;
} Dome;

/* About `rays` cells, as a Hemisphere has. */
void dome_start(Dome *d, const Harmonics *basis, int rays);
V3   dome_direction(const Dome *d, int j, int k, V2 u);
/* What comes along that direction of the cell: in the order of hemisphere_take. */
void dome_take(Dome *d, int j, int k, V3 w, Rgb L, float inv_distance);
/* The record's coefficients, as many as the basis has, and its reach at p, n, which they set. */
Reach dome_end(Dome *d, V3 p, V3 n, float least, float most, Radiance *of);

/* ---- many ---- */

typedef struct {
    Harmonics basis;
    Reaches   reaches;          /* owned */
    Radiance *of;               /* owned: basis.n for each of them */
    size_t    cap;              /* records for which it has room */
} RadianceStore;

bool radiance_init(RadianceStore *s, Box around, float a, int bands);   /* false: reported */
void radiance_clear(RadianceStore *s);
bool radiance_insert(RadianceStore *s, const Reach *r, const Radiance *of);
/* Whether any record has an error below a. */
bool radiance_known(const RadianceStore *s, V3 p, V3 n, float a);
/* What comes along wi. False: no record knows. */
bool radiance_at(const RadianceStore *s, V3 p, V3 n, V3 wi, float a, bool gradients, Rgb *L);

#endif
