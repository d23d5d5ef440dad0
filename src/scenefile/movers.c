/* movers.c -- what moves: shapes and objects whose current transforms differ between the start and
 * the end.
 *
 * A shape that moves is read in its own space and becomes a part of a geometry of its own, which
 * shares the motion with the shapes just before it, if it does; an instance that moves puts it
 * into the world. Within ObjectBegin it waits for the object to be placed: then the maps of both at
 * the start, and at the end, are multiplied. (Where the object is placed by a map that keeps angles
 * that is the same as one motion within the other.) */
#include "scenefile/reader.h"

static bool same(const Transform *a, const Transform *b)
{
    for (int i = 0; i < 4; i++)
        for (int j = 0; j < 4; j++)
            if (a->m[i][j] != b->m[i][j])
                return false;
    return true;
}

bool reader_moves(const Reader *r) { return !same(&r->state.ctm, &r->state.end); }

static bool stands(Reader *r, Place at)
{
    return !reader_once(r, ONCE_INSIDE_OUT) ||
           warn_at(at, "the motion turns things inside out; they stand as at their start");
}

bool mover_place(Reader *r, Place at, uint32_t geometry, const Transform *start,
                 const Transform *end)
{
    Geometry *world = &r->scene->geometries[0];
    Motion motion;

    if (r->scene->geometries[geometry].nshapes == 0)
        return true;
    if (!same(start, end)) {
        if (motion_init(&motion, start, end))
            return geometry_add_moving(world, geometry, &motion, NULL);
        if (!stands(r, at))
            return false;
    }
    return geometry_add_instance(world, geometry, start, NULL);
}

bool movers_place(Reader *r, Place at, uint32_t object, const Transform *start,
                  const Transform *end)
{
    for (size_t i = 0; i < r->nmovers; i++) {
        const Mover *m = &r->movers[i];
        Transform first = xf_then(start, &m->start), last = xf_then(end, &m->end);
        if (m->object == object && !mover_place(r, at, m->geometry, &first, &last))
            return false;
    }
    return true;
}

/* The geometry that shapes of the current motion go to. */
static bool find_mover(Reader *r, uint32_t *geometry)
{
    const Mover *last = r->nmovers ? &r->movers[r->nmovers - 1] : NULL;
    Mover m = { r->object, 0, r->state.ctm, r->state.end };

    if (last && last->object == r->object && same(&last->start, &m.start) &&
        same(&last->end, &m.end)) {
        *geometry = last->geometry;
        return true;
    }
    if (!scene_add_geometry(r->scene, &m.geometry) ||
        !MEM_PUSH(r->movers, r->nmovers, r->cap_movers, m))
        return false;
    *geometry = m.geometry;
    return true;
}

bool mover_begin(Reader *r, Place at, Moved *was)
{
    Motion motion;
    uint32_t geometry;

    was->object = r->object;
    was->ctm = r->state.ctm;
    if (!reader_moves(r))
        return true;
    if (r->state.area)
        return !reader_once(r, ONCE_MOTION) ||
               warn_at(at, "lights do not move; they stand as at their start");
    if (!motion_init(&motion, &r->state.ctm, &r->state.end))
        return stands(r, at);
    if (!find_mover(r, &geometry))
        return false;
    r->object = geometry;
    r->state.ctm = xf_identity();
    return true;
}

void mover_end(Reader *r, const Moved *was)
{
    r->object = was->object;
    r->state.ctm = was->ctm;
}
