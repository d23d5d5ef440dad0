/* photonpass.c -- see photonpass.h. */
#include "integrators/photonpass.h"

#include "base/error.h"
#include "base/mem.h"

#include <string.h>

enum { BATCH = 1024 };          /* particles */
enum { TRACE, BEGIN, COUNT, ARRANGE, PLACE, SORT };     /* phases: see pointgrid.h */

typedef struct {
    float  at[3];
    PassPhoton photon;
} Arrival;

struct PassBatch {
    Arrival *arrivals;          /* owned */
    size_t n, cap;
};

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
    uint64_t batches = (n + BATCH - 1) / BATCH;

    pp->particles = n;
    if (batches > SIZE_MAX)
        return err_memory(SIZE_MAX);
    pp->nbatches = (size_t)batches;
    pp->batches = MEM_ARRAY(PassBatch, pp->nbatches);
    if (!pp->batches)
        pp->nbatches = 0;
    return pp->batches != NULL;
}

void photonpass_clear(PhotonPass *pp)
{
    for (size_t i = 0; i < pp->nbatches; i++)
        mem_free(pp->batches[i].arrivals);
    mem_free(pp->batches);
    mem_free(pp->photons);
    pointgrid_clear(&pp->grid);
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
static bool leave(PassBatch *b, const Particle *p, const Vertex *v)
{
    V3 wi = v_neg(p->ray.d);
    float up = v_absdot(wi, v->s.ng), cosine = up > 0.0f ? fabsf(v->wo.z) / up : 0.0f;
    Arrival a = { { v->s.p.x, v->s.p.y, v->s.p.z },
                  { { p->flux.r * cosine, p->flux.g * cosine, p->flux.b * cosine },
                    { wi.x, wi.y, wi.z }, (uint32_t)p->depth } };

    return MEM_PUSH(b->arrivals, b->n, b->cap, a);
}

/* What media scatter is left out, as it is by the eye's paths. */
static bool meets(Particle *p, Vertex *v, Tracer *t)
{
    if (!ray_meets(t, &p->ray, &p->medium, &p->flux, &v->s))
        return false;
    vertex_make(v, t->scene, p->ray.d);
    return true;
}

static bool shoot(const PhotonPass *pp, PassBatch *b, Tracer *t)
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
    PassBatch *b = &pp->batches[unit];
    uint64_t i = unit * BATCH, end = i + BATCH < pp->particles ? i + BATCH : pp->particles;

    b->n = 0;
    for (; i < end; i++) {
        uint64_t number = (uint64_t)pass * pp->particles + i;
        sampler_pixel(&t->sampler, UINT32_MAX, (uint32_t)(number >> 32));
        sampler_start(&t->sampler, (uint32_t)number);
        if (!shoot(pp, b, t)) {
            t->failed = true;
            return;
        }
    }
}

/* ---- into the grid ---- */

size_t photonpass_found(const PhotonPass *pp)
{
    size_t n = 0;

    for (size_t i = 0; i < pp->nbatches; i++)
        n += pp->batches[i].n;
    return n;
}

/* The number of a photon has that of its batch in its upper bits. */
static bool begin(PhotonPass *pp, float edge)
{
    size_t n = photonpass_found(pp), most = 0;

    for (size_t i = 0; i < pp->nbatches; i++)
        most = pp->batches[i].n > most ? pp->batches[i].n : most;
    for (pp->bits = 0; most >> pp->bits; pp->bits++) {}
    if (pp->nbatches && (uint64_t)(pp->nbatches - 1) > UINT32_MAX >> pp->bits)
        return err_at((Place){ NULL, 0, 0 }, "a pass has more photons than can be numbered, "
                      "expected a smaller value of 'photons'");
    return mem_grow(&pp->photons, &pp->cap, n, sizeof *pp->photons) &&
           pointgrid_begin(&pp->grid, n, pp->nbatches, edge);
}

static void sort(PhotonPass *pp, uint32_t part)
{
    const PointGrid *g = &pp->grid;
    uint32_t within = ((uint32_t)1 << pp->bits) - 1;
    size_t end;

    pointgrid_sort(&pp->grid, part);
    end = pointgrid_part(g, part + 1);
    for (size_t i = pointgrid_part(g, part); i < end; i++) {
        uint32_t id = g->points[i].id;
        pp->photons[i] = pp->batches[id >> pp->bits].arrivals[id & within].photon;
    }
}

uint64_t photonpass_units(const PhotonPass *pp, int phase)
{
    return phase == BEGIN || phase == ARRANGE ? 1 : phase == SORT ? POINTGRID_PARTS : pp->nbatches;
}

void photonpass_run(PhotonPass *pp, uint32_t pass, int phase, uint64_t unit, float edge, Tracer *t)
{
    const PassBatch *b = phase == SORT ? NULL : &pp->batches[unit];
    const float *at = b && b->arrivals ? b->arrivals->at : NULL;

    switch (phase) {
    case TRACE: trace(pp, pass, unit, t); break;
    case BEGIN: t->failed |= !begin(pp, edge); break;
    case COUNT: pointgrid_count(&pp->grid, (size_t)unit, at, sizeof(Arrival), b->n); break;
    case ARRANGE: pointgrid_arrange(&pp->grid); break;
    case PLACE:
        pointgrid_place(&pp->grid, (size_t)unit, at, sizeof(Arrival), b->n,
                        (uint32_t)unit << pp->bits);
        break;
    default: sort(pp, (uint32_t)unit);
    }
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
    float heap[NEAREST_MOST], r = f_min(0.5f / pp->grid.scale, most), d2;

    for (;;) {
        PointWalk w = pointgrid_walk(&pp->grid, p, r);
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
