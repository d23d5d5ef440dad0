/* filter.h -- pixel filters, by sampling: the place of a camera sample is drawn from the filter
 * around the pixel's centre, so a sample belongs to one pixel and pixels stay independent.
 * Source: [Shirley91 5.1, 5.4.1]. One struct a filter; filter.c has the list. */
#ifndef IMAGE_FILTER_H
#define IMAGE_FILTER_H

#include "base/kind.h"
#include "base/vec.h"

typedef struct {
    KindInfo info;
    /* Offset from the pixel's centre, in pixels, for half widths r. */
    V2 (*sample)(V2 u, V2 r);
    V2 radius;                                          /* usual half widths */
} FilterKind;

extern const FilterKind *const filters[];               /* ends with NULL */
#define FILTER_DEFAULT "box"

#endif
