/* digest.h -- a sum of bytes, in 64 bits, that tells two files apart unless somebody means them to
 * have the same: one byte that differs always shows.
 *
 * Source  FNV-1a, by G. Fowler, L. C. Noll, K.-P. Vo. */
#ifndef BASE_DIGEST_H
#define BASE_DIGEST_H

#include "base/platform.h"

#include <stddef.h>
#include <stdint.h>

#define DIGEST_NOTHING 0xCBF29CE484222325u      /* of no bytes */

/* Goes on from the sum of the bytes before. */
INLINE uint64_t digest(uint64_t sum, const void *bytes, size_t n)
{
    const unsigned char *p = bytes;
    for (size_t i = 0; i < n; i++)
        sum = (sum ^ p[i]) * 0x100000001B3u;
    return sum;
}

#endif
