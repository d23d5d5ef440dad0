/* arrange.c -- the triangles of a mesh in another order: that of the leaves of a tree, which then
 * needs no list of them. See geometry_arrange in geometry.h. */
#include "geometry/geometry.h"

#include "base/mem.h"

#include <string.h>

static bool remember_places(Shape *s, const uint32_t *order)
{
    uint32_t *now = MEM_ARRAY(uint32_t, s->count), *place = MEM_ARRAY(uint32_t, s->count);

    if (!now || !place) {
        mem_free(now);
        mem_free(place);
        return false;
    }
    for (uint32_t k = 0; k < s->count; k++)
        now[order[k]] = k;
    for (uint32_t k = 0; k < s->count; k++)
        place[k] = now[s->place ? s->place[k] : k];
    mem_free(now);
    mem_free(s->place);
    s->place = place;
    return true;
}

/* Vertices of a mesh by first use: where each goes, counted from the mesh's first; *n: how many
 * there are up to the last that is used. NULL: memory ran out. */
static uint32_t *vertex_places(const Geometry *g, const Shape *s, const uint32_t *order,
                               uint32_t *n)
{
    uint32_t *place, next = 0;

    *n = 0;
    for (uint32_t i = s->first; i < s->first + s->count; i++)
        for (int c = 0; c < 3; c++)
            if (g->tri[i].v[c] - s->first_vertex >= *n)
                *n = g->tri[i].v[c] - s->first_vertex + 1;
    place = MEM_ARRAY(uint32_t, *n);
    if (!place)
        return NULL;
    memset(place, 0xFF, *n * sizeof *place);
    for (uint32_t k = 0; k < s->count; k++)
        for (int c = 0; c < 3; c++) {
            uint32_t v = g->tri[s->first + order[k]].v[c] - s->first_vertex;
            if (place[v] == UINT32_MAX)
                place[v] = next++;
        }
    for (uint32_t v = 0; v < *n; v++)
        if (place[v] == UINT32_MAX)
            place[v] = next++;
    return place;
}

/* Moves what n vertices have, `size` bytes each, to its places; room holds as much. */
INLINE void move_all(void *array, size_t size, uint32_t n, const uint32_t *place, void *room)
{
    char *to = array;
    const char *from = room;

    if (!array)
        return;
    memcpy(room, array, n * size);
    for (uint32_t v = 0; v < n; v++)
        memcpy(to + place[v] * size, from + v * size, size);
}

bool geometry_arrange(Geometry *g, size_t shape, const uint32_t *order)
{
    typedef union { Tri tri; V3 p; V2 uv; } Room;       /* of one triangle, or of one vertex */
    Shape *s = &g->shapes[shape];
    uint32_t n, *place = vertex_places(g, s, order, &n);
    Room *room = place ? MEM_ARRAY(Room, n > s->count ? n : s->count) : NULL;
    Tri *old;

    if (!room || (s->light != NO_LIGHT && !remember_places(s, order))) {
        mem_free(room);
        mem_free(place);
        return false;
    }
    old = &room->tri;
    memcpy(old, g->tri + s->first, s->count * sizeof *old);
    for (uint32_t k = 0; k < s->count; k++)
        for (int c = 0; c < 3; c++)
            g->tri[s->first + k].v[c] = place[old[order[k]].v[c] - s->first_vertex] +
                                        s->first_vertex;
    move_all(g->p + s->first_vertex, sizeof *g->p, n, place, room);
    move_all(s->n, sizeof *s->n, n, place, room);
    move_all(s->uv, sizeof *s->uv, n, place, room);
    mem_free(room);
    mem_free(place);
    return true;
}
