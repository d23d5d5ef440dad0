/* medium.h -- what fills space: absorbs light on its way and scatters it, alike everywhere.
 *
 * Source      [PBRT4 11], [HenyeyGreenstein41].
 * Coefficients are per scene unit and colour channel; extinction is their sum. */
#ifndef SCENE_MEDIUM_H
#define SCENE_MEDIUM_H

#include "base/vec.h"

typedef struct {
    const char *name;           /* borrowed from the scene's arena */
    Rgb   absorption, scattering;
    float g;                    /* mean cosine of a scattering, in (-1, 1): 0 is isotropic */
} Medium;

/* The part of the light that is left after `length` scene units. */
Rgb medium_transmittance(const Medium *m, float length);

/* Density per solid angle of light that travels along `from` going on along `to`; both unit. */
float phase_pdf_w(float g, V3 from, V3 to);
V3    phase_sample(float g, V3 from, V2 u);     /* with that density */

/* A flight from one event to the next, through any number of media. One channel says how far it
 * goes; it is drawn in proportion to the path's throughput, and weights use the mean over what all
 * channels would have done, so that none is large where channels differ. */
typedef struct {
    Rgb   chance;               /* of each channel, adding up to 1 */
    Rgb   left;                 /* transmittance so far */
    Rgb   chosen;               /* the same of media that scatter: the chance of getting so far */
    float depth;                /* optical depth at which the channel scatters */
    int   channel;
} Flight;

void flight_start(Flight *f, Rgb throughput, float u);
/* Through `length` units (INFINITY too) of a medium. True: it scatters at *at, and the path's
 * throughput is to be multiplied by *weight. */
bool flight_scatters(Flight *f, const Medium *m, float length, float *at, Rgb *weight);
/* The weight of a flight that got through to a surface, or out of the scene. */
Rgb  flight_arrives(const Flight *f);

#endif
