/* archive.h -- numbers in a file, in one byte order on all machines: what is written there is read
 * back bit by bit. The digest of all bytes stands at the end, so that a file that was cut or
 * damaged is known before anything in it is believed. */
#ifndef BASE_ARCHIVE_H
#define BASE_ARCHIVE_H

#include "base/bits.h"
#include "base/digest.h"
#include "base/file.h"

/* ---- writing ---- */

typedef struct { Out *out; uint64_t sum; } Saving;

bool save_begin(Saving *s, const char *path);           /* false: reported */
void save_bytes(Saving *s, const void *bytes, size_t n);
void save_u32(Saving *s, uint32_t v);
void save_u64(Saving *s, uint64_t v);
INLINE void save_float(Saving *s, float v) { save_u32(s, bits_of_float(v)); }
INLINE void save_double(Saving *s, double v) { save_u64(s, bits_of(v)); }
bool save_end(Saving *s);       /* false: reported, nothing left behind, the old file untouched */

/* ---- reading ---- */

/* Beyond the end there are zeros, and `beyond` says that somebody has been there. */
typedef struct {
    FileBytes file;             /* owned */
    const unsigned char *at, *end;
    bool beyond;
} Loading;

/* Reads a file. False: reported, nothing to clear. */
bool load_begin(Loading *l, const char *path, uint64_t limit);
/* Whether save_end ended it and it is as it was then: to be asked before anything in it is believed
 * but what kind of file it is. False: reported. */
bool load_whole(const Loading *l, const char *path);
void load_clear(Loading *l);
uint32_t load_u32(Loading *l);
uint64_t load_u64(Loading *l);
INLINE float load_float(Loading *l) { return float_of(load_u32(l)); }
INLINE double load_double(Loading *l) { return double_of(load_u64(l)); }
/* The next n bytes, borrowed; NULL if there are no more so many. */
const char *load_bytes(Loading *l, size_t n);
INLINE size_t load_left(const Loading *l) { return (size_t)(l->end - l->at); }

#endif
