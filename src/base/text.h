/* text.h -- reading text of any format: a cursor that knows its end, its line and its column.
 * Line ends are LF, CRLF or CR. Nothing is copied; words point into the text. */
#ifndef BASE_TEXT_H
#define BASE_TEXT_H

#include "base/error.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

typedef struct {
    const char *at, *end;        /* borrowed: what is left */
    const char *line_start;      /* for the column */
    const char *file;            /* borrowed: for messages */
    int line;
} Text;

typedef struct { const char *s; size_t n; } Word;       /* borrowed; n = 0: none */

void  text_init(Text *t, const char *file, const char *bytes, size_t n);  /* skips a UTF-8 BOM */
Place text_place(const Text *t);
Place text_place_of(const Text *t, const char *at);     /* a place on the present line */
bool  text_done(const Text *t);
int   text_peek(const Text *t);                          /* next byte, or -1 at the end */

/* Takes one line without its end into *line; false when nothing is left. */
bool text_line(Text *t, Text *line);
void text_blanks(Text *t);                  /* skips blanks and tabs */
void text_space(Text *t);                   /* skips blanks, tabs and line ends, counting lines */
/* The next run of bytes without white space on this line (blanks before it skipped). */
Word text_word(Text *t);
/* A number followed by white space or the end. False: nothing taken, not reported. */
bool text_float(Text *t, float *v);
bool text_int(Text *t, int64_t *v);

bool word_is(Word w, const char *s);
bool word_is_nocase(Word w, const char *s);
/* Copies into a fixed array, cut if too long: for messages and tables of names only. */
char *word_copy(char *out, size_t room, Word w);

#endif
