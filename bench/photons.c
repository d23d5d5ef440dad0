/* photons.c -- photon maps: how long a million photons take, how many bytes; nearest neighbours and
 * balls against a look at all points; a pass of sppm beside passes of path. */
#include "base/mem.h"
#include "base/random.h"
#include "bench/bench.h"
#include "geometry/pointgrid.h"
#include "integrators/photonstore.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { MILLION = 1000000, BUILDS = 5, K = 50, ASKED = 20000, CHECKED = 40, PASSES = 5 };

/* A closed box with a lamp, and a hare of a hundred thousand triangles. */
static const char ROOM[] =
    "LookAt 0 -3 1.2  0 0 1  0 0 1 Camera \"perspective\" \"float fov\" 60 WorldBegin "
    "Material \"diffuse\" \"rgb reflectance\" [ 0.6 0.5 0.4 ] "
    "AttributeBegin ReverseOrientation Shape \"box\" \"point3 from\" [ -2 -3.5 0 ] "
    "\"point3 to\" [ 2 2 3 ] AttributeEnd "
    "AttributeBegin Scale 1.3 1.3 1.3 Shape \"generated\" \"string kind\" \"hare\" "
    "\"integer triangles\" 100000 AttributeEnd "
    "AttributeBegin Translate 0 -0.5 2.9 Rotate 180 1 0 0 "
    "AreaLightSource \"diffuse\" \"rgb L\" [ 9 8 7 ] Shape \"disk\" \"float radius\" 0.5 "
    "AttributeEnd";

/* ---- a million photons ---- */

typedef struct {
    PhotonStore store;
    Tracer *tracers;
    int stage;
} Filling;

static void run_unit(void *ctx, uint64_t unit, int worker)
{
    Filling *f = ctx;
    photonstore_run(&f->store, f->stage, unit, &f->tracers[worker]);
}

/* All stages, on so many threads. The sampler is of the tracers. */
static void fill(Filling *f, int threads)
{
    for (f->stage = 0; f->stage < PHOTONSTORE_STAGES; f->stage++) {
        Work w = { photonstore_units(&f->store, f->stage), run_unit, NULL, f };
        work_run(&w, threads);
    }
}

static void report_build(const PhotonStore *s, const Scene *scene, int threads, double *wall,
                         double *cpu)
{
    double n = s->n, best = wall[0];

    for (int i = 1; i < BUILDS; i++)
        best = d_min(best, wall[i]);
    printf("photons\t%.0f photons, %.0f paths, %.0f triangles, %d threads: traced and their map "
           "built in %.2f s (best %.2f), %.2f CPU-seconds; asked: 2 s\t%.2f bytes a photon with "
           "its tree; asked: at most 24\n", n, (double)s->paths,
           (double)scene->geometries[0].ntris, threads, median(wall, BUILDS), best,
           median(cpu, BUILDS), (double)photonstore_bytes(s) / n);
}

/* ---- neighbours ---- */

/* Near another photon, as far from it as the hundredth part of the room. */
static V3 question(const PhotonStore *s, Rng *r)
{
    V3 p = photon_place(&s->photons[rng_below(r, s->n)]);
    float x = rng_unit(r), y = rng_unit(r), z = rng_unit(r);
    return v_mad(v3(x - 0.5f, y - 0.5f, z - 0.5f), 0.08f, p);
}

/* Nearer is first; of the same distance, the smaller number. */
static bool before(const Near *a, const Near *b)
{
    return a->d2 < b->d2 || (a->d2 == b->d2 && a->i < b->i);
}

static int compare(const void *a, const void *b)
{
    return before(a, b) ? -1 : before(b, a);
}

/* The k nearest by a look at all; sorted. */
static void brute(const PhotonStore *s, V3 p, Near *found)
{
    uint32_t n = 0;

    for (uint32_t i = 0; i < s->n; i++) {
        V3 d = v_sub(photon_place(&s->photons[i]), p);
        Near now = { v_len2(d), i };
        uint32_t at = n;
        if (n == K && !before(&now, &found[K - 1]))
            continue;
        for (at = n < K ? n++ : K - 1; at > 0 && before(&now, &found[at - 1]); at--)
            found[at] = found[at - 1];
        found[at] = now;
    }
}

typedef struct { uint32_t n; uint64_t sum; } Ball;
static float count(void *ctx, uint32_t i, float d2, float r2)
{
    Ball *b = ctx;
    (void)d2;
    b->n++;
    b->sum += i;
    return r2;
}

/* How many of the answers of the tree differ from a look at all; seconds of that look, each. */
static int wrong_nearest(const PhotonStore *s, double *seconds)
{
    Near tree[K], all[K];
    Rng r = rng_seed(5);
    double start = clock_cpu();
    int wrong = 0;

    for (int q = 0; q < CHECKED; q++) {
        V3 p = question(s, &r);
        uint32_t n = pointtree_nearest(&s->tree, p, INFINITY, K, tree);
        qsort(tree, n, sizeof *tree, compare);
        brute(s, p, all);
        wrong += n != K;
        for (uint32_t i = 0; i < n && i < K; i++)
            wrong += tree[i].i != all[i].i || tree[i].d2 != all[i].d2;
    }
    *seconds = (clock_cpu() - start) / CHECKED;
    return wrong;
}

/* The points of tree, grid and a look at all, of balls about as large as hold K photons. */
static int wrong_balls(const PhotonStore *s, const PointGrid *g, float radius)
{
    Rng r = rng_seed(6);
    int wrong = 0;

    for (int q = 0; q < CHECKED; q++) {
        V3 p = question(s, &r);
        PointWalk walk = pointgrid_walk(g, p, radius);
        const PlacedPoint *at;
        Ball tree = { 0, 0 }, grid = { 0, 0 }, all = { 0, 0 };
        float d2;
        /* the tree's balls have their rim, the grid's have none */
        pointtree_within(&s->tree, p, radius * radius, count, &tree);
        while ((at = pointgrid_next(&walk, &d2)) != NULL)
            count(&grid, at->id, d2, 0);
        for (uint32_t i = 0; i < s->n; i++) {
            d2 = v_len2(v_sub(photon_place(&s->photons[i]), p));
            if (d2 < radius * radius)
                count(&all, i, d2, 0);
        }
        wrong += grid.n != all.n || grid.sum != all.sum;
        wrong += tree.n < all.n || tree.n > all.n + 1;
    }
    return wrong;
}

static double mean_radius(const PhotonStore *s)
{
    Near found[K];
    Rng r = rng_seed(7);
    double sum = 0;

    for (int q = 0; q < ASKED; q++) {
        pointtree_nearest(&s->tree, question(s, &r), INFINITY, K, found);
        sum += sqrt(found[0].d2) / ASKED;
    }
    return sum;
}

static double seconds_of_balls(const PhotonStore *s, const PointGrid *g, float radius)
{
    double start = clock_cpu(), found = 0;
    Rng r = rng_seed(8);
    Ball ball = { 0, 0 };
    float d2;

    for (int q = 0; q < ASKED; q++) {
        V3 p = question(s, &r);
        if (g) {
            PointWalk walk = pointgrid_walk(g, p, radius);
            while (pointgrid_next(&walk, &d2))
                found++;
        } else
            pointtree_within(&s->tree, p, radius * radius, count, &ball);
    }
    return found + ball.n > 0 ? (clock_cpu() - start) / ASKED : 0;
}

static void neighbours(const PhotonStore *s)
{
    double brute_seconds, start = clock_cpu(), tree;
    float radius = (float)mean_radius(s);
    int wrong = wrong_nearest(s, &brute_seconds);
    V3 *at = MEM_ARRAY(V3, s->n);
    PointGrid g = { 0 };

    start = clock_cpu();
    mean_radius(s);
    tree = (clock_cpu() - start) / ASKED;
    printf("photons\tthe %d nearest of %.0f: tree %.2f us, a look at all %.0f us\t%s\n", K,
           (double)s->n, 1e6 * tree, 1e6 * brute_seconds, wrong ? "WRONG" : "the same");
    for (uint32_t i = 0; at && i < s->n; i++)
        at[i] = photon_place(&s->photons[i]);
    if (at && pointgrid_build(&g, at, s->n, 2 * radius)) {
        wrong = wrong_balls(s, &g, radius);
        printf("photons\tthose within %.3g, a ball of about as many: tree %.2f us, grid %.2f us\t"
               "%s\n", (double)radius, 1e6 * seconds_of_balls(s, NULL, radius),
               1e6 * seconds_of_balls(s, &g, radius), wrong ? "WRONG" : "the same");
    }
    pointgrid_clear(&g);
    mem_free(at);
}

/* ---- both, in the room ---- */

static void in_the_room(Scene *scene, const LightSampler *by, Tracer *tracers, int threads)
{
    double wall[BUILDS], cpu[BUILDS];
    Filling f;

    memset(&f, 0, sizeof f);
    f.tracers = tracers;
    for (int i = 0; i < BUILDS; i++) {
        photonstore_clear(&f.store);
        photonstore_init(&f.store, by, PHOTONS_ALL, MILLION, 8, 1);
        cpu[i] = clock_cpu();
        wall[i] = clock_wall();
        fill(&f, threads);
        wall[i] = clock_wall() - wall[i];
        cpu[i] = clock_cpu() - cpu[i];
    }
    report_build(&f.store, scene, threads, wall, cpu);
    if (f.store.n > K)
        neighbours(&f.store);
    photonstore_clear(&f.store);
}

static void room(int threads)
{
    const SamplerKind *kind = kind_find(samplers, "zerotwo");
    ReadLimits limits = READ_LIMITS_DEFAULT;
    const AccelKind *accel = kind_find(accels, ACCEL_DEFAULT);
    Tracer *tracers = MEM_ARRAY(Tracer, (size_t)threads);
    LightSampler *by = NULL;
    uint32_t spp = 1;
    SceneFile file;
    Opts none;

    if (tracers && scenefile_parse(&file, "room", ROOM, strlen(ROOM), &limits)) {
        opts_default(&none, accel->info.options);
        if (scene_build(file.scene, accel, &none, threads))
            by = lightsampler_open("power", file.scene);
        opts_default(&none, kind->info.options);
        if (by && sampler_init(&tracers[0].sampler, kind, &none, 1, &spp)) {
            tracers[0].scene = file.scene;
            for (int i = 1; i < threads; i++)
                tracers[i] = tracers[0];
            in_the_room(file.scene, by, tracers, threads);
            sampler_clear(&tracers[0].sampler);
        }
        lightsampler_close(by);
        scenefile_clear(&file);
    }
    mem_free(tracers);
}

/* ---- passes ---- */

/* Sixteen passes of sppm, of as many light paths as pixels, and of path. */
static void passes(void)
{
    double own[PASSES], path[PASSES], ratio;
    RenderReport r;

    for (int i = 0; i < PASSES; i++) {
        if (!bench_render("scenes/s5.pbrt", "sppm", NULL, 0, 16, 1, 0, NULL, &r))
            return;
        own[i] = r.cpu_seconds / 16;
        if (!bench_render("scenes/s5.pbrt", "path", NULL, 0, 16, 1, 0, NULL, &r))
            return;
        path[i] = r.cpu_seconds / 16;
    }
    ratio = median(own, PASSES) / median(path, PASSES);
    printf("photons\ta pass of sppm in s5: %.4f CPU-seconds, of path: %.4f: %.2f of them; asked: "
           "at most 2\n", median(own, PASSES), median(path, PASSES), ratio);
}

void bench_photons(void)
{
    room(processors());
    passes();
}
