/* plyload.c -- values of binary PLY files out of their bytes, whatever the machine's byte order. */
#include "geometry/plyhead.h"

#include "base/bits.h"

/* A word of x + 1 bytes has its k-th byte, least significant first, at b[k ^ x] if big-endian; at
 * b[k ^ 0] else. Compilers make one load of it, and one swap. */

static uint32_t bits16(const unsigned char *b, int x)
{
    return (uint32_t)b[0 ^ x] | (uint32_t)b[1 ^ x] << 8;
}

static uint32_t bits32(const unsigned char *b, int x)
{
    return (uint32_t)b[0 ^ x] | (uint32_t)b[1 ^ x] << 8 | (uint32_t)b[2 ^ x] << 16 |
           (uint32_t)b[3 ^ x] << 24;
}

static double real64(uint32_t low, uint32_t high) { return double_of((uint64_t)high << 32 | low); }

/* Two's complement without leaving the range of the types. */
static double signed_of(uint32_t bits, uint32_t sign)
{
    return (double)bits - (bits & sign ? 2.0 * (double)sign : 0.0);
}

static double load_u8(const unsigned char *b) { return b[0]; }
static double load_i8(const unsigned char *b) { return signed_of(b[0], 0x80); }
static double load_u16_le(const unsigned char *b) { return bits16(b, 0); }
static double load_u16_be(const unsigned char *b) { return bits16(b, 1); }
static double load_i16_le(const unsigned char *b) { return signed_of(bits16(b, 0), 0x8000); }
static double load_i16_be(const unsigned char *b) { return signed_of(bits16(b, 1), 0x8000); }
static double load_u32_le(const unsigned char *b) { return bits32(b, 0); }
static double load_u32_be(const unsigned char *b) { return bits32(b, 3); }
static double load_i32_le(const unsigned char *b) { return signed_of(bits32(b, 0), 0x80000000u); }
static double load_i32_be(const unsigned char *b) { return signed_of(bits32(b, 3), 0x80000000u); }
static double load_f32_le(const unsigned char *b) { return float_of(bits32(b, 0)); }
static double load_f32_be(const unsigned char *b) { return float_of(bits32(b, 3)); }
static double load_f64_le(const unsigned char *b) { return real64(bits32(b, 0), bits32(b + 4, 0)); }
static double load_f64_be(const unsigned char *b) { return real64(bits32(b + 4, 3), bits32(b, 3)); }

static PlyLoad *const little[] = { load_i8, load_u8, load_i16_le, load_u16_le, load_i32_le,
                                   load_u32_le, load_f32_le, load_f64_le };
static PlyLoad *const big[] = { load_i8, load_u8, load_i16_be, load_u16_be, load_i32_be,
                                load_u32_be, load_f32_be, load_f64_be };

PlyLoad *const *ply_loaders(PlyFormat format)
{
    return format == PLY_ASCII ? NULL : format == PLY_LITTLE ? little : big;
}
