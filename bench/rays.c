/* rays.c -- loading, building and casting. */
#include "base/file.h"
#include "bench/bench.h"
#include "geometry/generate.h"
#include "sampling/warp.h"

#include <stdio.h>
#include <string.h>
#include <unistd.h>

enum { SUBDIVISIONS = 224, RUNS = 5, RAYS = 1 << 18, CHECKED = 200 };

/* 20 * 224^2: 1,003,520 triangles of a bumpy closed body. */
static bool make_mesh(Mesh *m)
{
    memset(m, 0, sizeof *m);
    return mesh_bumpy(m, SUBDIVISIONS, 7);
}

void bench_load(void)
{
    char name[64];
    ReadLimits limits = READ_LIMITS_DEFAULT;
    const AccelKind *kind = kind_find(accels, ACCEL_DEFAULT);
    double read[RUNS], built[RUNS];
    SceneFile f;
    Mesh m;
    Opts o;

    snprintf(name, sizeof name, "/tmp/rushlight-bench-%ld.ply", (long)getpid());
    if (!make_mesh(&m) || !ply_write(&m, name))
        return;
    mesh_clear(&m);
    opts_default(&o, kind->info.options);
    for (int i = 0; i < RUNS; i++) {
        double start = clock_wall();
        if (!scenefile_read(&f, name, &limits))
            break;
        read[i] = clock_wall() - start;
        if (!scene_build(f.scene, kind, &o, processors()))
            break;
        built[i] = clock_wall() - start - read[i];
        if (i == RUNS - 1)
            printf("load\tmillion-triangles\tread s %.3f\tbuild s %.3f\tbytes a triangle %.1f\n",
                   median(read, RUNS), median(built, RUNS),
                   (double)f.scene->accel->bytes / geometry_prims(f.scene->accel->geo));
        scenefile_clear(&f);
    }
    unlink(name);
}

/* ---- rays ---- */

/* Primary: a square picture of the body. Diffuse: off what those hit. Random: through its box. */
static size_t primary(Ray *r)
{
    size_t side = 512, n = 0;
    for (size_t y = 0; y < side; y++)
        for (size_t x = 0; x < side; x++) {
            V3 d = v3(((float)x / (float)side - 0.5f) * 0.9f,
                      ((float)y / (float)side - 0.5f) * 0.9f,
                      -1.0f);
            r[n].o = v3(0, 0, 3.2f);
            r[n].d = v_unit(d);
            r[n++].tmax = INFINITY;
        }
    return n;
}

static size_t diffuse(const Accel *a, const Ray *from, size_t n, Ray *r)
{
    Rng rng = rng_seed(5);
    size_t out = 0;
    for (size_t i = 0; i < n; i++) {
        Surface s;
        Frame f;
        V2 u;
        Hit h;
        if (!accel_nearest(a, &from[i], &h))
            continue;
        accel_surface(a, &from[i], &h, &s);
        f = frame_about(s.ng);
        u.x = rng_unit(&rng);
        u.y = rng_unit(&rng);
        r[out].d = frame_out(&f, warp_cosine(u));
        r[out].o = ray_origin(s.p, s.err, s.ng, r[out].d);
        r[out++].tmax = INFINITY;
    }
    return out;
}

static size_t random_rays(Ray *r)
{
    Rng rng = rng_seed(6);
    for (size_t i = 0; i < RAYS; i++) {
        V2 u, v;
        u.x = rng_unit(&rng);
        u.y = rng_unit(&rng);
        v.x = rng_unit(&rng);
        v.y = rng_unit(&rng);
        r[i].o = v_scale(warp_sphere(u), 3.0f);
        r[i].d = v_unit(v_sub(v_scale(warp_sphere(v), 0.9f), r[i].o));
        r[i].tmax = INFINITY;
    }
    return RAYS;
}

static bool right(const Accel *a, const Accel *brute, const Ray *r, size_t n)
{
    for (size_t i = 0; i < n; i += n / CHECKED + 1) {
        Hit h, g;
        bool x = accel_nearest(a, &r[i], &h), y = accel_nearest(brute, &r[i], &g);
        if (x != y || (x && (h.t != g.t || h.prim != g.prim)) || accel_blocked(a, &r[i]) != y)
            return false;
    }
    return true;
}

static void cast(const char *kind, const Accel *a, const Accel *brute, const Ray *r, size_t n)
{
    double near[RUNS], any[RUNS];
    Steps steps = { 0, 0 };
    bool ok = right(a, brute, r, n);
    volatile size_t hits = 0;
    Hit h;

    for (int k = -1; k < RUNS; k++) {
        double t0 = clock_cpu(), t1;
        for (size_t i = 0; i < n; i++)
            hits += accel_nearest(a, &r[i], &h);
        t1 = clock_cpu();
        for (size_t i = 0; i < n; i++)
            hits += accel_blocked(a, &r[i]);
        if (k >= 0) {
            near[k] = (double)n * 1e-6 / (t1 - t0);
            any[k] = (double)n * 1e-6 / (clock_cpu() - t1);
        }
    }
    for (size_t i = 0; i < n; i++)
        a->kind->nearest(a, &r[i], &h, &steps);
    printf("rays\t%s\t%s\tnearest Mrays/s %.2f\tblocked Mrays/s %.2f\tnodes %.1f\tprims %.1f\t"
           "bytes a triangle %.1f\t%s\n", a->kind->info.name, kind, median(near, RUNS),
           median(any, RUNS), (double)steps.nodes / (double)n, (double)steps.prims / (double)n,
           (double)a->bytes / (double)a->geo->ntris, ok ? "ok" : "WRONG");
}

/* Each kind gets the triangles as they were, and may put them into the order it likes. */
static Accel *build(const AccelKind *kind, Geometry *g, const Tri *tris)
{
    Opts o;

    opts_default(&o, kind->info.options);
    memcpy(g->tri, tris, g->ntris * sizeof *tris);
    return accel_build(kind, g, &o, processors());
}

static void cast_each(const Accel *a, const Accel *brute, Ray *first, Ray *second)
{
    size_t n = primary(first), n2 = diffuse(a, first, n, second);

    cast("primary", a, brute, first, n);
    cast("diffuse", a, brute, second, n2);
    cast("random", a, brute, first, random_rays(first));
}

void bench_rays(void)
{
    const AccelKind *reference = kind_find(accels, "brute");
    ShapeTraits traits = { 0, NO_LIGHT, false };
    Ray *first = MEM_ARRAY(Ray, RAYS), *second = MEM_ARRAY(Ray, RAYS);
    Tri *tris = NULL;
    Geometry g;
    Mesh m;

    memset(&g, 0, sizeof g);
    if (first && second && make_mesh(&m) && geometry_add_mesh(&g, &m, traits, NULL) &&
        geometry_finish(&g) && (tris = MEM_ARRAY(Tri, g.ntris)) != NULL)
        memcpy(tris, g.tri, g.ntris * sizeof *tris);
    for (int k = 0; tris && accels[k]; k++) {
        Accel *a = accels[k] == reference ? NULL : build(accels[k], &g, tris);
        Accel *brute = a ? accel_build_as_is(reference, &g, NULL, 1) : NULL;
        if (a && brute)
            cast_each(a, brute, first, second);
        accel_free(brute);
        accel_free(a);
    }
    geometry_clear(&g);
    mem_free(tris);
    mem_free(first);
    mem_free(second);
}
