/* photonpass.h -- the photons of one pass, in a grid: for methods that have new ones in each.
 *
 * Source      [Cline07 7.7.1], [GIRT 2.3.2 to 2.3.4].
 * What        Particles leave the lamps (particle.h); where they come upon a surface that is no
 *             delta as a whole, they leave a photon behind, but for the first time: what has come
 *             straight from a lamp is for direct light to find.
 * Flux        The mean over the pass's particles of what photons bring to a surface is the flux
 *             through it. Where the shading normal is another than the geometric one, they carry
 *             what makes |cos| of the first out of |cos| of the second, as the scattering of light
 *             has it in all methods (see particle.h).
 * Order       Photons stand by cell of the grid, then in the order of their particles. */
#ifndef INTEGRATORS_PHOTONPASS_H
#define INTEGRATORS_PHOTONPASS_H

#include "integrators/arrivals.h"
#include "integrators/particle.h"

typedef struct {
    float flux[3];              /* watts of the pass's particles, not divided by their number */
    float wi[3];                /* unit, whence it came */
    uint32_t events;            /* scattering events before it arrived, at least 1 */
} PassPhoton;

typedef struct {
    LightSampler *lights;       /* owned: by power */
    const Scene *scene;         /* borrowed */
    int      maxdepth, roulette;        /* most events of a path that ends with one at the eye's */
    bool     matt;              /* only where a surface scatters as matt ones do */
    Arrivals arrivals;          /* owned; of so many paths as there are particles */
    PassPhoton *photons;        /* owned: in the order of the grid's points */
    size_t   cap;
} PhotonPass;

/* All but how many particles, which comes next. False: reported, and nothing has to be cleared. */
bool photonpass_init(PhotonPass *pp, const Scene *s, int maxdepth, int roulette, bool matt);
bool photonpass_particles(PhotonPass *pp, uint64_t n);          /* False: reported */
void photonpass_clear(PhotonPass *pp);                          /* {0} is cleared */

/* A pass has these phases of units; see integrator.h. In between, whoever has it may choose the
 * edge of cells: photonpass_found tells how many photons there are, then photonpass_edge. */
enum { PHOTONPASS_PHASES = 1 + ARRIVALS_PHASES };
enum { PHOTONPASS_EDGE = 1 };           /* the phase of the one unit before which the edge is set */
uint64_t photonpass_units(const PhotonPass *pp, int phase);
void     photonpass_run(PhotonPass *pp, uint32_t pass, int phase, uint64_t unit, float edge,
                        Tracer *t);
INLINE size_t photonpass_found(const PhotonPass *pp) { return arrivals_found(&pp->arrivals); }

INLINE const PassPhoton *photonpass_photon(const PhotonPass *pp, const PlacedPoint *q)
{
    return &pp->photons[q - pp->arrivals.grid.points];
}

/* Distance to the k-th nearest photon, if that is less than `most`; else `most`. */
enum { NEAREST_MOST = 1024 };
float photonpass_reach(const PhotonPass *pp, V3 p, int k, float most);

#endif
