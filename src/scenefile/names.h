/* names.h -- from names that the user gave to numbers: textures, materials, objects and coordinate
 * systems of one scene. */
#ifndef SCENEFILE_NAMES_H
#define SCENEFILE_NAMES_H

#include "base/error.h"
#include "base/mem.h"
#include "geometry/lookup.h"

#define NAME_NONE UINT32_MAX

typedef struct { const char *name; uint32_t value; } NameEntry;     /* name: in an arena */
typedef struct {
    Lookup     lookup;          /* owned */
    NameEntry *entry;           /* owned */
    size_t     n, cap;
} Names;                        /* {0} is empty */

uint32_t names_find(const Names *t, const char *name);          /* NAME_NONE: not there */
/* Sets or replaces; the name is copied to the arena. False: out of memory, reported. */
bool names_set(Names *t, Arena *arena, const char *name, uint32_t value);
/* As hint_nearest, of the names in t; only the first ones are looked at. */
const char *names_hint(const Names *t, const char *name, char hint[HINT_MAX]);
void names_clear(Names *t);

#endif
