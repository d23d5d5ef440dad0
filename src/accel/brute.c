/* brute.c -- every primitive against every ray: the reference that all others must agree with, and
 * page one for readers. */
#include "accel/accel.h"
#include "accel/prim.h"
#include "base/mem.h"

static Accel *build(const Geometry *g, const Opts *o, int threads)
{
    Accel *a = MEM_NEW(Accel);
    (void)o;
    (void)threads;
    if (!a)
        return NULL;
    a->geo = g;
    a->leaves = 1;
    return a;
}

static bool nearest(const Accel *a, const Ray *r, Hit *h, Steps *steps)
{
    Probe p;

    hit_none(h, r->tmax);
    probe_init(&p, r);
    for (uint32_t i = 0; i < geometry_prims(a->geo); i++)
        prim_nearest(a, i, r, &p, h, steps);
    if (steps)
        steps->prims += geometry_prims(a->geo);
    return h->outer != NO_PRIM;
}

static bool blocked(const Accel *a, const Ray *r, Steps *steps)
{
    Probe p;

    probe_init(&p, r);
    for (uint32_t i = 0; i < geometry_prims(a->geo); i++) {
        if (steps)
            steps->prims++;
        if (prim_blocks(a, i, r, &p, steps))
            return true;
    }
    return false;
}

static bool validate(const Accel *a, char *why, size_t room)
{
    (void)a;
    (void)why;
    (void)room;
    return true;                        /* there is no structure that could be wrong */
}

static void drop(Accel *a) { mem_free(a); }

const AccelKind accel_brute = {
    .info = { "brute", "GIRT 4.1.2.1", "no structure: every primitive for every ray", NULL },
    .plain = true, .build = build, .nearest = nearest, .blocked = blocked, .validate = validate,
    .free = drop
};
