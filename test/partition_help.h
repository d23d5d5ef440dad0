/* partition_help.h -- a partition as chi2.h wants what is drawn: of = Partition. */
#ifndef TEST_PARTITION_HELP_H
#define TEST_PARTITION_HELP_H

#include "base/random.h"
#include "lightsampling/partition.h"

INLINE bool partition_draw(const void *of, Rng *rng, V3 *w)
{
    PartitionSample s;
    V2 u;

    u.x = rng_unit(rng);
    u.y = rng_unit(rng);
    partition_warp(of, u, &s);
    *w = s.wi;
    return true;
}

INLINE double partition_density(const void *of, V3 w) { return (double)partition_pdf_w(of, w); }

#endif
