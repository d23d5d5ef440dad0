/* spectrum.h -- spectra become linear RGB when they are read. See spectrum.c for how. */
#ifndef SCENEFILE_SPECTRUM_H
#define SCENEFILE_SPECTRUM_H

#include "base/error.h"

#include <stdbool.h>
#include <stddef.h>

/* What a spectrum is: light has a colour of its own; reflectances and refractive indices are what
 * they do to white, so that a flat one is grey. */
typedef enum { SPECTRUM_LIGHT, SPECTRUM_ALBEDO } SpectrumUse;

enum { CIE_SAMPLES = 95 };      /* 360 to 830 nm in steps of 5 */

/* The colour matching functions, tabulated once a reader. */
typedef struct { double bar[CIE_SAMPLES][3]; double flat[3]; } Cie;
void cie_init(Cie *c);

void spectrum_from_xyz(const double xyz[3], double rgb[3]);

/* n pairs (nm, value), nm rising; linear between them, constant beyond. A flat light of 1 has
 * luminance Y = 1. Values below 0 that the primaries cannot avoid become 0. */
void spectrum_from_samples(const Cie *c, const double *pairs, size_t n, SpectrumUse use,
                           double rgb[3]);

#define KELVIN_LEAST 100.0
#define KELVIN_MOST  1e7
/* Black body. With scale NULL its luminance is 1; else the spectrum is *scale at its peak. */
void spectrum_from_kelvin(const Cie *c, double kelvin, const double *scale, double rgb[3]);

/* "metal-Cu-eta", "glass-BK7", "stdillum-D65". False: unknown. */
bool spectrum_named(const Cie *c, const char *name, SpectrumUse use, double rgb[3]);
const char *spectrum_hint(const char *name, char hint[HINT_MAX]);       /* as hint_nearest */

/* m turns linear RGB of another space into ours; white stays white. False: unknown. */
bool spectrum_space(const char *name, double m[3][3]);
extern const char *const spectrum_spaces[];             /* ends with NULL */

#endif
