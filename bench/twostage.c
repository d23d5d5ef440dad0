/* twostage.c -- two stage importance sampling against its publication, [Cline07 5].
 *
 * cost       a partition and 32 points warped by it, against the 32 shadow rays that they serve, at
 *            what the eye sees of a scene of 120,000 triangles under a probe. */
#include "bench/bench.h"
#include "integrators/twostage.h"

#include <stdio.h>
#include <string.h>

/* ---- what partitions cost ---- */

enum { COST_SIDE = 192, CHUNK = 64, POINTS = 32 };

typedef struct {
    Vertex v[CHUNK];
    V3     d[CHUNK];
    Ray    ray[CHUNK * POINTS];
    Partition part;
    int    n, rays;
    uint64_t hits, shadow, leaves, blocked;
    double make, warp, cast;
} Cost;

/* What the chunk's vertices take, in three rounds so that the clock is read seldom. */
static void chunk(Cost *c, const TwoStage *two, Tracer *t)
{
    double start = clock_cpu(), made;
    PartitionSample s[POINTS];
    V2 point[POINTS];

    c->rays = 0;
    for (int i = 0; i < c->n; i++) {
        Turn u = turn_on(&c->v[i], c->d[i], NO_MEDIUM, 0);
        c->leaves += twostage_partition(two, &u, POINTS, t, &c->part) ? (c->part.n + 1u) / 2 : 0;
    }
    made = clock_cpu();
    c->make += made - start;
    for (int i = 0; i < c->n; i++) {
        Turn u = turn_on(&c->v[i], c->d[i], NO_MEDIUM, 0);
        if (!twostage_partition(two, &u, POINTS, t, &c->part))
            continue;
        for (uint32_t k = 0; k < POINTS; k++)
            point[k] = (V2){ (float)k / POINTS, (float)(k * 5 % POINTS) / POINTS };
        partition_warp_many(&c->part, point, s, POINTS);
        for (uint32_t k = 0; k < POINTS; k++)
            c->ray[c->rays++] = turn_ray(&u, s[k].wi);
    }
    c->warp += clock_cpu() - made - (made - start);
    start = clock_cpu();
    for (int i = 0; i < c->rays; i++)
        c->blocked += scene_blocked(t->scene, &c->ray[i]);
    c->cast += clock_cpu() - start;
    c->hits += (uint64_t)c->n;
    c->shadow += (uint64_t)c->rays;
    c->n = 0;
}

static void cost_of(const char *name, Cost *c, SceneFile *f)
{
    const IntegratorKind *direct = kind_find(integrators, "direct");
    TwoStage two;
    Opts o;
    Tracer t;

    memset(&t, 0, sizeof t);
    t.scene = f->scene;
    opts_default(&o, direct->info.options);
    if (!twostage_init(&two, f->scene, &o, false))
        return;
    f->scene->camera->kind->film(f->scene->camera, COST_SIDE, COST_SIDE);
    for (int i = 0; i < COST_SIDE * COST_SIDE; i++) {
        V2 pixel = { (float)(i % COST_SIDE), (float)(i / COST_SIDE) }, lens = { 0.5f, 0.5f };
        Ray r = f->scene->camera->kind->ray(f->scene->camera, pixel, lens, 0);
        if (!vertex_meet(&c->v[c->n], &r, &t))
            continue;
        vertex_make(&c->v[c->n], f->scene, r.d);
        c->d[c->n++] = r.d;
        if (c->n == CHUNK)
            chunk(c, &two, &t);
    }
    printf("cost\t%s\thits %lu\tleaves %.1f\tmake us %.2f\twarp us %.2f\tshadow rays us %.2f\t"
           "blocked %.2f\tpartition and points over rays %.2f\n", name, (unsigned long)c->hits,
           (double)c->leaves / (double)c->hits, 1e6 * c->make / (double)c->hits,
           1e6 * c->warp / (double)c->hits, 1e6 * c->cast / (double)c->hits,
           (double)c->blocked / (double)c->shadow, (c->make + c->warp) / c->cast);
    twostage_clear(&two);
}

static void cost(const char *scene)
{
    ReadLimits limits = READ_LIMITS_DEFAULT;
    RenderSettings s;
    RenderRequest q;
    SceneFile f;
    Cost *c = MEM_NEW(Cost);

    memset(&q, 0, sizeof q);
    q.spp = 1;
    q.threads = 1;
    q.max_pixels = limits.max_pixels;
    if (c && scenefile_read(&f, scene, &limits)) {
        if (settings_resolve(&s, &q, &f) && scene_build(f.scene, s.accel, &s.accel_opts, 1))
            cost_of(scene, c, &f);
        scenefile_clear(&f);
    }
    mem_free(c);
}

void bench_twostage(void)
{
    cost("scenes/statue.pbrt");
    cost("scenes/hare.pbrt");
    cost("scenes/floor-glossy.pbrt");
}
