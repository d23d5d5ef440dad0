/* lookup.h -- from a hash to the ids of things that have it, so that things are kept once. The
 * things stand elsewhere; the caller compares.
 *
 * Open addressing with linear probing at a load of at most 1/2. A probe sequence never runs beyond
 * LOOKUP_PROBES slots: with a fair hash a longer one has a chance below e^-49 a search
 * (clusters decay as e^(-0.193 k) at load 1/2), and with hashes that a hostile file made collide
 * the search stays short. What finds no slot is not entered, so that its next occurrence is taken
 * for new: the caller must bear duplicates. */
#ifndef GEOMETRY_LOOKUP_H
#define GEOMETRY_LOOKUP_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum { LOOKUP_PROBES = 256 };
#define LOOKUP_NONE 0xFFFFFFFFu                         /* no id */

typedef struct { uint32_t hash, id; } LookupSlot;
typedef struct { LookupSlot *slot; size_t size, used; } Lookup; /* owned; {0} is empty */

/* The next id entered under `hash`, or LOOKUP_NONE. *probe is 0 for the first and kept between. */
uint32_t lookup_next(const Lookup *l, uint32_t hash, uint32_t *probe);
bool lookup_add(Lookup *l, uint32_t hash, uint32_t id); /* false: out of memory, reported */
void lookup_clear(Lookup *l);

uint32_t lookup_hash_bytes(const char *s, size_t n);

#endif
