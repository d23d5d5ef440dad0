/* kindsets.h -- the open sets of the program by name, for those who tell the user what there is. */
#ifndef CLI_KINDSETS_H
#define CLI_KINDSETS_H

#include "base/kind.h"

typedef struct {
    const char *name;           /* "integrators" */
    const char *options;        /* of commands, that take one of them: "--integrator", ... */
    const void *list;
} KindSet;

enum { KIND_SETS = 16 };
extern const KindSet kind_sets[KIND_SETS];
/* The set that the option of a command takes its value from, or NULL. */
const KindSet *kind_set_of(const char *option);

#endif
