/* big.h -- whole numbers of bounded size, kept by value on the stack, and the one question that
 * number.c asks of them: the integer part of a ratio. */
#ifndef BASE_BIG_H
#define BASE_BIG_H

#include <stdbool.h>
#include <stdint.h>

/* The size is what number.c needs: 5^1123 and an integer of 800 digits have 2658 bits at most, the
 * scaling of ratio_floor adds 61 and 31. To exceed it is our bug (ASSERT). */
enum { BIG_LIMBS = 88 };

typedef struct { int n; uint32_t d[BIG_LIMBS]; } Big;   /* low limbs first, d[n - 1] != 0 */

int  bit_length(uint64_t x);                            /* 0 of 0 */
int  big_bits(const Big *a);                            /* its length */
void big_set(Big *a, uint64_t x);
void big_muladd(Big *a, uint32_t m, uint32_t add);      /* a <- a * m + add */
void big_times_power_of_5(Big *a, int k);

/* The integer part, below 2^61, of num / den * 2^e; *more: something is left over. Uses both up. */
uint64_t ratio_floor(Big *num, Big *den, int e, bool *more);

#endif
