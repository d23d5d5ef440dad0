/* lookup.c -- the hash table of lookup.h. */
#include "geometry/lookup.h"

#include "base/mem.h"
#include "base/random.h"

uint32_t lookup_next(const Lookup *l, uint32_t hash, uint32_t *probe)
{
    while (l->size && *probe < LOOKUP_PROBES) {
        const LookupSlot *s = &l->slot[(hash + (*probe)++) & (l->size - 1)];
        if (s->id == LOOKUP_NONE)
            break;
        if (s->hash == hash)
            return s->id;
    }
    *probe = LOOKUP_PROBES;
    return LOOKUP_NONE;
}

static void enter(Lookup *l, uint32_t hash, uint32_t id)
{
    for (uint32_t k = 0; k < LOOKUP_PROBES; k++) {
        LookupSlot *s = &l->slot[(hash + k) & (l->size - 1)];
        if (s->id == LOOKUP_NONE) {
            *s = (LookupSlot){ hash, id };
            l->used++;
            return;
        }
    }
}

static bool rebuild(Lookup *l, size_t size)
{
    Lookup grown = { MEM_ARRAY(LookupSlot, size), size, 0 };

    if (!grown.slot)
        return false;
    for (size_t k = 0; k < size; k++)
        grown.slot[k].id = LOOKUP_NONE;
    for (size_t k = 0; k < l->size; k++)
        if (l->slot[k].id != LOOKUP_NONE)
            enter(&grown, l->slot[k].hash, l->slot[k].id);
    mem_free(l->slot);
    *l = grown;
    return true;
}

bool lookup_add(Lookup *l, uint32_t hash, uint32_t id)
{
    if (2 * (l->used + 1) > l->size && !rebuild(l, l->size ? 2 * l->size : 16))
        return false;
    enter(l, hash, id);
    return true;
}

void lookup_clear(Lookup *l)
{
    mem_free(l->slot);
    *l = (Lookup){ NULL, 0, 0 };
}

uint32_t lookup_hash_bytes(const char *s, size_t n)
{
    uint64_t h = n;
    for (size_t k = 0; k < n; k++)
        h = mix64(h ^ (unsigned char)s[k]);
    return (uint32_t)(h >> 32);
}
