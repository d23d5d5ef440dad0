/* mem.h -- the one allocator. Arithmetic is checked, failure is reported once (err_memory) and
 * returned as NULL; callers pass it up. Zero sizes are legal and give a pointer that may be freed.
 *
 * Owner rules of the tree: scene arena, one scratch arena a thread, x_new/x_free pairs. */
#ifndef BASE_MEM_H
#define BASE_MEM_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* Bytes behind every block that may be read, so that the last three floats of an array can be
 * loaded as four. What they are is of no concern. */
enum { MEM_BEYOND = 16 };

void *mem_array(size_t n, size_t size);                 /* n * size bytes, zeroed */
#define MEM_NEW(T)      ((T *)mem_array(1, sizeof(T)))
#define MEM_ARRAY(T, n) ((T *)mem_array((n), sizeof(T)))

/* Makes room for `need` elements of `size` bytes in *array (which may be NULL) of capacity *cap,
 * growing by half. New elements are not set. On failure false: reported, *array unchanged. */
bool mem_grow(void *array, size_t *cap, size_t need, size_t size);

void mem_free(void *p);                                 /* NULL is allowed */

/* Where in a block the first line of the processor's cache begins. What is to stand there takes
 * MEM_LINE - 1 bytes more. */
enum { MEM_LINE = 64 };
static inline void *mem_line(void *block)
{
    return (char *)block + (MEM_LINE - (uintptr_t)block % MEM_LINE) % MEM_LINE;
}
char *mem_string(const char *s, size_t length);         /* a copy with a final 0 */

/* Appends x to the array a of n elements with capacity cap: false when memory ran out. */
#define MEM_PUSH(a, n, cap, x) \
    (mem_grow(&(a), &(cap), (n) + 1, sizeof *(a)) ? ((a)[(n)++] = (x), true) : false)

/* Fault counter, for tests: the k-th call from now (counting from 1) fails, and with `on` every
 * later one too. k = 0: none. The count runs on in any case and is read by mem_calls(). */
void          mem_fail_at(unsigned long k, bool on);
unsigned long mem_calls(void);
long          mem_blocks(void);                         /* blocks not yet freed */
size_t        mem_bytes(void);                          /* bytes in them */
size_t        mem_peak(void);                           /* most held since mem_peak_restart */
void          mem_peak_restart(void);                   /* so does mem_fail_at */
void          mem_limit(size_t bytes);                  /* more than that at once fails; 0: none */

/* An arena: many small allocations with one life. Blocks never move. */
typedef struct ArenaBlock ArenaBlock;
typedef struct { ArenaBlock *head; size_t used, size; } Arena;  /* {0} is an empty arena */

void *arena_take(Arena *a, size_t n, size_t size);      /* zeroed; NULL: reported */
char *arena_string(Arena *a, const char *s, size_t length);
void  arena_clear(Arena *a);

#endif
