/* lightstore.c -- see lightstore.h. */
#include "integrators/lightstore.h"

#include "base/error.h"
#include "base/mem.h"
#include "sampling/warp.h"

#include <string.h>

enum { TRACE };                         /* the first phase; the others are those of arrivals.h */
enum { NO_KEPT_MEDIUM = 0xffffff };

bool lightstore_init(LightStore *s, const Scene *scene, uint64_t paths, bool straight)
{
    memset(s, 0, sizeof *s);
    if (scene->nmedia >= NO_KEPT_MEDIUM)
        return err_at((Place){ NULL, 0, 0 }, "the scene has %lu media, expected less than %d",
                      (unsigned long)scene->nmedia, NO_KEPT_MEDIUM);
    if (!arrivals_init(&s->arrivals, sizeof(KeptVertex), paths))
        return false;
    s->first = MEM_ARRAY(uint32_t, s->arrivals.nbatches * (ARRIVALS_BATCH + 1));
    if (s->first && !straight)
        s->straight = MEM_ARRAY(KeptVertex, (size_t)paths);
    if (s->first && (straight || s->straight))
        return true;
    lightstore_clear(s);
    return false;
}

void lightstore_clear(LightStore *s)
{
    mem_free(s->straight);
    mem_free(s->first);
    arrivals_clear(&s->arrivals);
    memset(s, 0, sizeof *s);
}

/* ---- one vertex ---- */

/* Two numbers tell a unit vector to the last bits, see octahedron_fold. */
static void way_fold(V3 d, float way[2])
{
    float s = 1.0f / (fabsf(d.x) + fabsf(d.y) + fabsf(d.z));

    way[0] = d.x * s;
    way[1] = d.y * s;
    if (d.z < 0.0f)
        octahedron_fold(&way[0], &way[1]);
}

V3 kept_way(const KeptVertex *k)
{
    float x = k->way[0], y = k->way[1], z = 1.0f - fabsf(x) - fabsf(y);

    if (z < 0.0f)
        octahedron_fold(&x, &y);
    return v_unit(v3(x, y, z));
}

static KeptVertex keep(const LightVertex *y)
{
    KeptVertex k = { { y->v.s.p.x, y->v.s.p.y, y->v.s.p.z }, { 0, 0 }, y->hit.u, y->hit.v,
                     y->hit.outer, y->hit.prim, { y->flux.r, y->flux.g, y->flux.b },
                     y->odds.last, y->odds.early, y->odds.merged + y->odds.latest,
                     y->medium == NO_MEDIUM ? NO_KEPT_MEDIUM : y->medium, (uint32_t)y->edges };

    way_fold(y->d, k.way);
    return k;
}

/* The ray that is at its end already: nothing is lost along the way. */
static void make_again(const KeptVertex *k, LightVertex *y, Tracer *t)
{
    Ray r = { .o = v3(k->p[0], k->p[1], k->p[2]), .d = kept_way(k), .tmax = INFINITY,
              .time = t->moment };

    y->hit = (Hit){ 0.0f, k->u, k->v, k->outer, k->prim };
    accel_surface(t->scene->accel, &r, &y->hit, &y->v.s);
    vertex_make(&y->v, t->scene, r.d);
    y->flux = rgb(k->flux[0], k->flux[1], k->flux[2]);
    y->odds = kept_odds(k);
    y->d = r.d;
    y->medium = k->medium == NO_KEPT_MEDIUM ? NO_MEDIUM : k->medium;
    y->edges = (int)k->edges;
}

/* ---- a pass ---- */

/* A path has a pattern of its own, over the passes: it is joined with the paths of one pixel alone,
 * which must see all of the lamps in turn. */
static bool trace(LightStore *s, const Bidirectional *b, uint32_t pass, uint64_t path,
                  ArrivalBatch *batch, Tracer *t)
{
    LightVertex y[DEPTH_MOST];
    int n, i = 0;

    sampler_pixel(&t->sampler, (uint32_t)path, (uint32_t)(path >> 32));
    sampler_start(&t->sampler, pass);
    sampler_other(&t->sampler, PATH_FROM_LAMP);
    n = bidirectional_light(b, t->moment, y, t);
    if (s->straight) {
        s->straight[path].edges = 0;
        if (n && y[0].edges == 1)
            s->straight[path] = keep(&y[i++]);
    }
    for (; i < n; i++) {
        KeptVertex k = keep(&y[i]);
        if (!arrivals_add(batch, sizeof k, &k))
            return false;
    }
    return true;
}

static void trace_batch(LightStore *s, const Bidirectional *b, uint32_t pass, uint64_t unit,
                        Tracer *t)
{
    ArrivalBatch *batch = &s->arrivals.batches[unit];
    uint32_t *first = s->first + unit * (ARRIVALS_BATCH + 1);
    uint64_t end = arrivals_end(&s->arrivals, unit);

    batch->n = 0;
    *first = 0;
    for (uint64_t i = arrivals_first(unit); i < end; i++) {
        if (!trace(s, b, pass, i, batch, t)) {
            t->failed = true;
            return;
        }
        *++first = (uint32_t)batch->n;
    }
}

uint64_t lightstore_units(const LightStore *s, int phase, bool merges)
{
    return phase == TRACE ? s->arrivals.nbatches
                          : merges ? arrivals_units(&s->arrivals, phase - 1) : 0;
}

void lightstore_run(LightStore *s, const Bidirectional *b, uint32_t pass, int phase,
                    uint64_t unit, Tracer *t)
{
    if (phase == TRACE)
        trace_batch(s, b, pass, unit, t);
    else
        t->failed |= !arrivals_run(&s->arrivals, phase - 1, unit, 2.0f * s->radius);
}

int lightstore_path(const LightStore *s, uint64_t number, LightVertex *path, Tracer *t)
{
    uint64_t unit = number / ARRIVALS_BATCH, i = number % ARRIVALS_BATCH;
    const uint32_t *first = s->first + unit * (ARRIVALS_BATCH + 1) + i;
    const KeptVertex *k = (const KeptVertex *)(const void *)s->arrivals.batches[unit].records;
    int n = 0;

    if (s->straight && s->straight[number].edges)
        make_again(&s->straight[number], &path[n++], t);
    for (uint32_t j = first[0]; j < first[1]; j++)
        make_again(&k[j], &path[n++], t);
    return n;
}
