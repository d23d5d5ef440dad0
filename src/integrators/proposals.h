/* proposals.h -- how many moved paths were tried in each pixel, and the noise filter made of that.
 *
 * Source      [Cline07 8.4.4, fig. 8.9; errata 8.6].
 * Idea        Energy that flows about is uneven for a part because pixels are tried unevenly often.
 *             The counts are smoothed to what may have been expected, by a mean or a median over a
 *             square, and what landed in a pixel is multiplied by expected / counted.
 * Limits      Biased: the expectation is not even over the square. Where nothing was tried the
 *             pixel is left as it is. */
#ifndef INTEGRATORS_PROPOSALS_H
#define INTEGRATORS_PROPOSALS_H

#include "image/splats.h"

enum { PROPOSALS_SIDE = 15 };           /* most pixels across the square */

typedef struct {
    Film   film;                /* owned: a splat of 1 for each */
    Filter box;
    bool   median;              /* else the mean */
    int    side;                /* of the square; odd */
} Proposals;

/* For the window of that film. False: reported, to be cleared all the same. */
bool proposals_init(Proposals *p, const Film *f, bool median, int side);
void proposals_clear(Proposals *p);

/* One was tried there. Any number of threads at once. */
INLINE void proposals_add(Proposals *p, V2 at)
{
    film_splat(&p->film, &p->box, at, 1, rgb_all(1.0f));
}

/* Multiplies the film's splats. False: memory, reported. */
bool proposals_even_out(const Proposals *p, Film *f);

#endif
