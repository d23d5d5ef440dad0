/* irradiance.h -- records of irradiance, and what they say of the places between them.
 *
 * Source      [Ward88] and errata 7.15 for the error of a record at another place,
 *                 e = |x - xi| / Ri + sqrt(1 - n.ni),  used where e < a;
 *             [WardHeckbert92] for the gradients; [Krivanek06] for the radii of neighbours.
 * Weight      1 / e - 1 / a, not Ward's 1 / e: it is 0 where a record ends, so no edge shows.
 * Radius      Ri is the harmonic mean of the distances to what is around, but no more than what
 *             the gradient allows, |E| / |move|, and within bounds that the maker of the record
 *             gives (of its size on the picture). Neighbours may not differ in it by more than
 *             their distance: a crack that one of many rays found matters to the others too.
 * Behind      Records that lie in front of the place, by the mean of both normals, may see what it
 *             does not: passed over. */
#ifndef INTEGRATORS_IRRADIANCE_H
#define INTEGRATORS_IRRADIANCE_H

#include "geometry/balltree.h"
#include "integrators/hemisphere.h"

typedef struct {
    V3    p, n;
    float radius, least;        /* Ri; its lower bound */
    Irradiance of;
} IrradianceRecord;

/* A record at p, n; the radius will be within least and most. */
IrradianceRecord irradiance_record(V3 p, V3 n, const Irradiance *of, float least, float most);

/* What records say about a place, added up. */
typedef struct { double weight, E[3]; } IrradianceSum;
/* Error of the record there; INFINITY if it lies in front. */
float irradiance_error(const IrradianceRecord *r, V3 p, V3 n);
/* Adds what the record says, if its error is below a. */
void  irradiance_add(IrradianceSum *s, const IrradianceRecord *r, V3 p, V3 n, float a,
                     bool gradients);
/* False: there is none that knows. */
bool  irradiance_mean(const IrradianceSum *s, Rgb *E);

typedef struct {
    IrradianceRecord *records;  /* owned */
    size_t n, cap;
    BallTree tree;              /* owned: balls of radius a Ri */
    float a;                    /* of the widest question */
} IrradianceStore;

bool irradiance_init(IrradianceStore *s, Box around, float a);          /* false: reported */
void irradiance_clear(IrradianceStore *s);
/* Takes the record in; its radius and its neighbours' are clamped against each other. False:
 * memory, reported. */
bool irradiance_insert(IrradianceStore *s, const IrradianceRecord *r);
/* By all records with an error below a, which is at most the store's. False: there is none. */
bool irradiance_at(const IrradianceStore *s, V3 p, V3 n, float a, bool gradients, Rgb *E);

#endif
