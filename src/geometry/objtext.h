/* objtext.h -- lines of OBJ and MTL files: words, numbers, names, comments, and lines that a
 * backslash at their end continues. A continuation counts as a blank. */
#ifndef GEOMETRY_OBJTEXT_H
#define GEOMETRY_OBJTEXT_H

#include "base/text.h"

/* The next word of the logical line; n = 0 at its end and before a comment. */
Word obj_word(Text *t);

/* The rest of the logical line from its next word to its last one, blanks inside included: names
 * of materials and of files may hold some. n = 0: nothing there. */
Word obj_rest(Text *t);

/* False, reported: the name on the present line holds a byte 0, where a C string would end. */
bool obj_check_name(const Text *t, Word name);

/* The next word, a number, which may be infinite or not a number. False: reported, with `what`
 * saying what it was to be. */
bool obj_number(Text *t, const char *what, float *v);

/* Goes to the start of the next logical line. */
void obj_next_line(Text *t);

#endif
