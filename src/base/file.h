/* file.h -- the one way to the file system. Inputs are read whole, up to a limit; outputs are
 * written beside their final name and renamed when whole, so that an old file is never half
 * overwritten. Every system call that can fail goes through a fault counter for tests. */
#ifndef BASE_FILE_H
#define BASE_FILE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#define FILE_LIMIT_DEFAULT ((uint64_t)8 << 30)          /* bytes of one input file */

/* Owned bytes of a file, with a 0 after the last one. file_clear frees them. */
typedef struct { char *bytes; size_t size; } FileBytes;

/* Reads a regular file of at most `limit` bytes. False: reported (not there, a folder, a device,
 * too large, unreadable), *f empty. */
bool file_read(const char *path, uint64_t limit, FileBytes *f);
void file_clear(FileBytes *f);
bool file_exists(const char *path);

/* A digest of the contents of all files that are read from now on, in the order in which they are;
 * their names are of no concern. file_digest ends it. */
void     file_digest_start(void);
uint64_t file_digest(void);

/* An output file being written. */
typedef struct Out Out;
Out *out_open(const char *path);                        /* NULL: reported */
void out_write(Out *o, const void *bytes, size_t n);    /* a failure is kept for out_close */
void out_text(Out *o, const char *s);
void out_u32be(Out *o, uint32_t v);
/* Makes the file appear under its name. False: reported once, nothing left behind, the old file
 * untouched. Frees o in any case. */
bool out_close(Out *o);
void out_abort(Out *o);                                 /* gives up and leaves nothing behind */
/* Whether out_open(path) would work, to be asked before the work that makes the contents. False:
 * reported. Devices and pipes are not opened for the question. */
bool out_possible(const char *path);

/* Whole-file convenience with the same promise. */
bool file_write(const char *path, const void *bytes, size_t n);

/* Path of `name` as seen from the file `from`: absolute names stay, others are taken relative to
 * the folder of `from`. Owned by the caller. NULL: out of memory, reported. */
char *path_beside(const char *from, const char *name);
const char *path_extension(const char *path);           /* after the last dot, or "" */

/* Fault counter, for tests: the k-th file operation from now fails with errno `code`, and with
 * `on` every later one too. k = 0: none. */
void          file_fail_at(unsigned long k, bool on, int code);
unsigned long file_calls(void);

#endif
