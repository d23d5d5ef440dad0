/* state.h -- renders in files: what stands before a film. See state.c. */
#ifndef RENDER_STATE_H
#define RENDER_STATE_H

#include "image/film.h"

/* What is rendered, as a text: see state.c. */
typedef struct { char *text; size_t n, cap; } Identity;         /* owned */

typedef struct {
    const char *text;           /* borrowed from the file, of ntext bytes */
    size_t    ntext;
    FilmShape shape;
    Loading   rest;             /* owned: at the film */
} StateHead;

/* False: reported, nothing to clear. Else load_clear(&h->rest). */
bool state_read_head(StateHead *h, const char *path, uint64_t limit);

#endif
