/* number.h -- numbers from text and back, without the locale and without the machine's libc.
 * Parsing is correctly rounded (nearest, ties to even); printing gives the shortest decimal that
 * parses back to the same value. Pure functions of their arguments. */
#ifndef BASE_NUMBER_H
#define BASE_NUMBER_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* Each reads the longest number at [s, end) and returns the bytes it took; 0: no number there, *v
 * untouched. Grammar of reals: [+-] (digits [. digits*] | . digits) [(e|E) [+-] digits]; also
 * inf, infinity and nan in any case, with a sign. An exponent without digits is not taken.
 * Too large gives infinity, too small a denormal or 0, as rounding demands. */
size_t number_float(const char *s, const char *end, float *v);
size_t number_double(const char *s, const char *end, double *v);

/* [+-] digits. Out of the range of int64_t: takes all the digits, gives the nearest end and sets
 * *clipped (if clipped is not NULL). */
size_t number_int(const char *s, const char *end, int64_t *v, bool *clipped);

enum { NUMBER_MAX = 40 };               /* room that any printed number needs, with the final 0 */
/* The fewest digits that read back as v, and of those the nearest to it: plain ("0.00025", "1500")
 * from 1e-5 up to below 1e16, else with an exponent ("2.5e-6"); "inf", "-inf", "nan". Returns the
 * length. */
size_t number_print_float(char out[NUMBER_MAX], float v);
size_t number_print_double(char out[NUMBER_MAX], double v);
/* With `digits` (0..17) after the point, correctly rounded, for |v| < 1e15; else as above. */
size_t number_print_fixed(char out[NUMBER_MAX], double v, int digits);

#endif
