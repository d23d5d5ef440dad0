/* photonpass.c -- see photonpass.h. */
#include "integrators/photonpass.h"

#include "base/mem.h"

#include <string.h>

enum { TRACE, BEGIN, SORT = ARRIVALS_PHASES };  /* phases: the second and the last of arrivals.h */

typedef struct {
    float  at[3];
    PassPhoton photon;
} Arrival;

bool photonpass_init(PhotonPass *pp, const Scene *s, int maxdepth, int roulette, bool matt)
{
    memset(pp, 0, sizeof *pp);
    pp->scene = s;
    pp->maxdepth = maxdepth;
    pp->roulette = roulette;
    pp->matt = matt;
    pp->lights = lightsampler_open("power", s);
    return pp->lights != NULL;
}

bool photonpass_particles(PhotonPass *pp, uint64_t n)
{
    return arrivals_init(&pp->arrivals, sizeof(Arrival), n);
}

void photonpass_clear(PhotonPass *pp)
{
    arrivals_clear(&pp->arrivals);
    mem_free(pp->photons);
    if (pp->lights)
        lightsampler_close(pp->lights);
    memset(pp, 0, sizeof *pp);
}

/* ---- one particle ---- */

/* Whether paths of the eye end on such a surface. */
static bool takes(const PhotonPass *pp, const Vertex *v)
{
    return vertex_is_smooth(v) && (!pp->matt || (v->b->flags & BSDF_MATT));
}

/* False: there is no memory for it, reported. */
static bool leave(ArrivalBatch *b, const Particle *p, const Vertex *v)
{
    V3 wi = v_neg(p->ray.d);
    float up = v_absdot(wi, v->s.ng), cosine = up > 0.0f ? fabsf(v->wo.z) / up : 0.0f;
    Arrival a = { { v->s.p.x, v->s.p.y, v->s.p.z },
                  { { p->flux.r * cosine, p->flux.g * cosine, p->flux.b * cosine },
                    { wi.x, wi.y, wi.z }, (uint32_t)p->depth } };

    return arrivals_add(b, sizeof a, &a);
}

/* What media scatter is left out, as it is by the eye's paths. */
static bool meets(Particle *p, Vertex *v, Tracer *t)
{
    if (!ray_meets(t, &p->ray, &p->medium, &p->flux, &v->s))
        return false;
    vertex_make(v, t->scene, p->ray.d);
    return true;
}

static bool shoot(const PhotonPass *pp, ArrivalBatch *b, Tracer *t)
{
    Particle p;
    Emission e;

    if (!particle_leaves(&p, pp->lights, t->moment, t, &e))
        return true;
    while (p.depth < pp->maxdepth) {
        Vertex v;
        if (!meets(&p, &v, t))
            return true;
        if (p.depth > 0 && takes(pp, &v) && !leave(b, &p, &v))
            return false;
        if (p.depth + 1 >= pp->maxdepth || !particle_scatters(&p, &v, t) ||
            !particle_survives(&p, pp->roulette, t))
            return true;
    }
    return true;
}

/* Particle number (pass * particles + its own) of one sequence: see light.c. */
static void trace(PhotonPass *pp, uint32_t pass, uint64_t unit, Tracer *t)
{
    ArrivalBatch *b = &pp->arrivals.batches[unit];
    uint64_t end = arrivals_end(&pp->arrivals, unit);

    b->n = 0;
    for (uint64_t i = arrivals_first(unit); i < end; i++) {
        uint64_t number = (uint64_t)pass * pp->arrivals.paths + i;
        sampler_pixel(&t->sampler, UINT32_MAX, (uint32_t)(number >> 32));
        sampler_start(&t->sampler, (uint32_t)number);
        if (!shoot(pp, b, t)) {
            t->failed = true;
            return;
        }
    }
}

/* ---- into the grid ---- */

/* The photons of a part of the grid, in its order. */
static void arrange(PhotonPass *pp, uint32_t part)
{
    const PointGrid *g = &pp->arrivals.grid;
    size_t end = pointgrid_part(g, part + 1);

    for (size_t i = pointgrid_part(g, part); i < end; i++) {
        const Arrival *a = arrivals_record(&pp->arrivals, g->points[i].id);
        pp->photons[i] = a->photon;
    }
}

uint64_t photonpass_units(const PhotonPass *pp, int phase)
{
    return phase == TRACE ? pp->arrivals.nbatches : arrivals_units(&pp->arrivals, phase - 1);
}

void photonpass_run(PhotonPass *pp, uint32_t pass, int phase, uint64_t unit, float edge, Tracer *t)
{
    if (phase == TRACE) {
        trace(pp, pass, unit, t);
        return;
    }
    t->failed |= !arrivals_run(&pp->arrivals, phase - 1, unit, edge);
    if (phase == BEGIN)
        t->failed |= !mem_grow(&pp->photons, &pp->cap, photonpass_found(pp), sizeof *pp->photons);
    else if (phase == SORT)
        arrange(pp, (uint32_t)unit);
}

/* ---- the nearest ---- */

/* Puts d2 into a heap of at most k, the largest on top. */
static void keep(float *heap, int *n, int k, float d2)
{
    int i;

    if (*n < k) {
        for (i = (*n)++; i && heap[(i - 1) / 2] < d2; i = (i - 1) / 2)
            heap[i] = heap[(i - 1) / 2];
        heap[i] = d2;
        return;
    }
    if (d2 >= heap[0])
        return;
    for (i = 0; 2 * i + 1 < k;) {
        int child = 2 * i + 1;
        child += child + 1 < k && heap[child + 1] > heap[child];
        if (heap[child] <= d2)
            break;
        heap[i] = heap[child];
        i = child;
    }
    heap[i] = d2;
}

float photonpass_reach(const PhotonPass *pp, V3 p, int k, float most)
{
    float heap[NEAREST_MOST], r = f_min(0.5f / pp->arrivals.grid.scale, most), d2;

    for (;;) {
        PointWalk w = pointgrid_walk(&pp->arrivals.grid, p, r);
        int n = 0;
        while (pointgrid_next(&w, &d2))
            keep(heap, &n, k, d2);
        if (n == k) {           /* not a rounding more: it would be within, one too many */
            r = sqrtf(heap[0]);
            return r * r > heap[0] ? r * (1.0f - 0x1p-23f) : r;
        }
        if (r >= most)
            return most;
        r = f_min(2.0f * r, most);
    }
}
