/* kind.h -- what every member of an open set (accelerators, BSDFs, lights, ...) says of itself.
 * A KindInfo is the first field of each such struct of functions, so that `list`, `help`, error
 * messages and tests can walk any of the lists without knowing more. */
#ifndef BASE_KIND_H
#define BASE_KIND_H

#include "base/error.h"
#include "base/options.h"

typedef struct {
    const char   *name;         /* what the user writes; also the name of its file */
    const char   *source;       /* reference key of src/README.md, with the section */
    const char   *summary;      /* one line for `list` */
    const OptDef *options;      /* ends at key == NULL; NULL: none */
} KindInfo;

/* The member called `name` of a list of kinds, or NULL. */
const void *kind_find(const void *list, const char *name);

/* The same, reporting an unknown name at `at` with the nearest one. what: "integrator". */
const void *kind_find_at(Place at, const void *list, const char *what, const char *name);

/* By "name" or "name:key=value,..." of the command line; *o gets its options, with strings in the
 * arena. NULL: reported as a usage error. */
const void *kind_from_text(const void *list, const char *what, const char *text, Opts *o,
                           Arena *arena);

/* The k-th member's info, or NULL past the end. */
const KindInfo *kind_info(const void *list, size_t k);

#endif
