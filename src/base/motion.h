/* motion.h -- an affine map that changes from time 0 to time 1.
 *
 * Source      [PBRT4 3.10.4], [Shoemake92]: the linear part of the map is divided into a rotation R
 *             and a stretch S, and translation and stretch change linearly, the rotation about one
 *             axis at one speed, the shorter way round.
 * Why         Not by adding matrices: half way between two that are a turn by an angle a apart,
 *             their mean is smaller by cos(a / 2), and flat if the turn is a half one. S is
 *             positive definite at both ends (or, where the map mirrors, negative definite), and
 *             so it is between them: the map is never flat. */
#ifndef BASE_MOTION_H
#define BASE_MOTION_H

#include "base/transform.h"

typedef struct { double m[3][3]; } Linear;

typedef struct {
    double from[3], way[3];             /* translation: from + t way */
    bool   slides;                      /* nothing changes but that: R, S, axis, angle are unused */
    Linear turned;                      /* R at the start */
    double axis[3], angle;              /* by which it goes on turning, in [0, pi] */
    Linear stretch, growth;             /* S: stretch + t growth */
    double back_from[3], back_way[3];   /* translation of the inverse map, where it slides */
    Affine to_world, to_object;         /* at the start */
} Motion;

/* False if the map mirrors at one end only, or is flat at one: nothing is between. */
bool motion_init(Motion *m, const Transform *start, const Transform *end);

/* The map and its inverse at a time in [0, 1], each number rounded once. */
void motion_at(const Motion *m, float time, Affine *to_world, Affine *to_object);

/* Holds where the box is at any time. */
Box motion_box(const Motion *m, Box b);

#endif
