/* merl.h -- tables of measured isotropic BRDFs, and their files.
 *
 * Source  [Matusik03] and the file format of its database: three 32-bit counts nh, nd, np (90, 90,
 *         180), then nh nd np doubles for red, as many for green and for blue, little-endian. Rows
 *         are half-vector angles, columns difference angles, and azimuths of the difference run
 *         fastest [Rusinkiewicz98]: theta_h in steps of its square root up to a right angle,
 *         theta_d evenly up to a right angle, phi_d evenly up to half a turn, after which it
 *         repeats by reciprocity. Values are f times 1500, 1500/1.15 and 1500/1.66; negative ones
 *         say that nothing was measured, and count as 0. */
#ifndef BSDF_MERL_H
#define BSDF_MERL_H

#include "base/error.h"
#include "base/vec.h"

#include <stddef.h>
#include <stdint.h>

typedef struct {
    uint32_t nh, nd, np;
    Rgb *f;                     /* owned; nh nd np of them, phi_d runs fastest */
} Merl;

enum { MERL_MOST = 1024 };      /* of each count */

bool merl_read(Merl *m, const char *path, const unsigned char *bytes, size_t n);  /* false: told */
void merl_clear(Merl *m);

/* f of directions above the surface, linear between the middles of cells. */
Rgb merl_f(const Merl *m, V3 wo, V3 wi);

#endif
