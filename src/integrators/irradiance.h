/* irradiance.h -- records of irradiance, and what they say of the places between them.
 *
 * Source      [Ward88], [WardHeckbert92] for the gradients; how far a record reaches and how much
 *             it counts: reach.h. */
#ifndef INTEGRATORS_IRRADIANCE_H
#define INTEGRATORS_IRRADIANCE_H

#include "integrators/hemisphere.h"
#include "integrators/reach.h"

typedef struct {
    Reach at;
    Irradiance of;
} IrradianceRecord;

/* A record at p, n; the radius will be within least and most. */
IrradianceRecord irradiance_record(V3 p, V3 n, const Irradiance *of, float least, float most);

/* What records say about a place, added up. */
typedef struct { double weight, E[3]; } IrradianceSum;
/* Adds what the record says, if its error is below a. */
void  irradiance_add(IrradianceSum *s, const Reach *at, const Irradiance *of, V3 p, V3 n, float a,
                     bool gradients);
/* False: there is none that knows. */
bool  irradiance_mean(const IrradianceSum *s, Rgb *E);

typedef struct {
    Reaches reaches;            /* owned */
    Irradiance *of;             /* owned: of each of them */
    size_t n, cap;
} IrradianceStore;

bool irradiance_init(IrradianceStore *s, Box around, float a);          /* false: reported */
void irradiance_clear(IrradianceStore *s);
bool irradiance_insert(IrradianceStore *s, const IrradianceRecord *r);  /* see reaches_insert */
/* By all records with an error below a, which is at most the store's. False: there is none. */
bool irradiance_at(const IrradianceStore *s, V3 p, V3 n, float a, bool gradients, Rgb *E);

#endif
