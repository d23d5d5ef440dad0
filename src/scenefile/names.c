/* names.c -- see names.h. */
#include "scenefile/names.h"

#include "base/error.h"

#include <string.h>

static NameEntry *find(const Names *t, const char *name, uint32_t hash)
{
    uint32_t probe = 0, id;
    while ((id = lookup_next(&t->lookup, hash, &probe)) != LOOKUP_NONE)
        if (!strcmp(t->entry[id].name, name))
            return &t->entry[id];
    return NULL;
}

uint32_t names_find(const Names *t, const char *name)
{
    const NameEntry *e = find(t, name, lookup_hash_bytes(name, strlen(name)));
    return e ? e->value : NAME_NONE;
}

bool names_set(Names *t, Arena *arena, const char *name, uint32_t value)
{
    size_t n = strlen(name);
    uint32_t hash = lookup_hash_bytes(name, n);
    NameEntry *e = find(t, name, hash), fresh;

    if (e) {
        e->value = value;
        return true;
    }
    fresh.name = arena_string(arena, name, n);
    fresh.value = value;
    return fresh.name && lookup_add(&t->lookup, hash, (uint32_t)t->n) &&
           MEM_PUSH(t->entry, t->n, t->cap, fresh);
}

const char *names_hint(const Names *t, const char *name, char hint[HINT_MAX])
{
    enum { MOST = 100 };
    const char *some[MOST];
    size_t n = t->n < MOST ? t->n : MOST;
    for (size_t i = 0; i < n; i++)
        some[i] = t->entry[i].name;
    return hint_nearest(hint, name, some, n);
}

void names_clear(Names *t)
{
    lookup_clear(&t->lookup);
    mem_free(t->entry);
    *t = (Names){ { NULL, 0, 0 }, NULL, 0, 0 };
}
