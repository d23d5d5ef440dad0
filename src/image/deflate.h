/* deflate.h -- lossless compression for the formats that need it, and their checksums. */
#ifndef IMAGE_DEFLATE_H
#define IMAGE_DEFLATE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* Makes a zlib stream [RFC1950] of bytes[0..n). *out is owned by the caller (mem_free). The
 * stream is at most n + n / 3000 + 16 bytes long. False: out of memory, reported, *out NULL. */
bool zlib_compress(const unsigned char *bytes, size_t n, unsigned char **out, size_t *out_n);

/* Both go on from the sum of the bytes before: start with crc 0, adler 1. */
uint32_t checksum_crc32(uint32_t crc, const unsigned char *bytes, size_t n);
uint32_t checksum_adler32(uint32_t adler, const unsigned char *bytes, size_t n);

#endif
