/* cast.c -- structures built, compared and timed. See cast.h.
 *
 * Truth     A structure may put the triangles into another order, so they are not compared by their
 *           numbers, and of two with the same t either may be met: t must be the same float, and
 *           the triangle that is told must give this t when it is tested alone.
 *           A tessellation and the list of its triangles are compared in the same way.
 * Fairness  Every build starts from the geometry as the file has it. Speeds are of CPU time of the
 *           one thread that casts, so that other work on the machine disturbs them less. */
#include "render/cast.h"

#include "base/clock.h"
#include "base/statistics.h"
#include "geometry/triangle.h"

#include <stdio.h>
#include <string.h>

#define BUILD_SECONDS 1.0       /* a build is repeated for its median while all took less */
#define BRUTE_TESTS   3e7       /* of primitives, a ray set, by brute: some tenths of a second */

static size_t bytes_of(const Geometry *g)
{
    size_t bytes = g->ntris * sizeof(Tri) + g->nverts * sizeof(V3) + g->nodd * sizeof(Shape);

    for (size_t k = 0; k < g->ntessellated; k++)
        bytes += tessellation_bytes(g->shapes[g->tessellated[k]].as.tessellation);
    return bytes;
}

/* Copies geometry k, and makes lists of its tessellations if any geometry has some. */
static bool take_geometry(CastScene *c, size_t k)
{
    const Geometry *g = &c->scene->geometries[k];

    if (!geometry_copy(&c->original[k], g) ||
        (c->listed && (!geometry_copy(&c->listed[k], g) || !geometry_list(&c->listed[k]))))
        return false;
    g = c->listed ? &c->listed[k] : g;
    c->tris += g->ntris;
    c->prims += g->ntris + g->nodd;
    c->verts += g->nverts;
    c->bytes += bytes_of(g);
    c->regular_bytes += bytes_of(&c->original[k]);
    return true;
}

bool cast_init(CastScene *c, Scene *s, const char *name)
{
    size_t tessellations = 0;
    bool ok;

    memset(c, 0, sizeof *c);
    c->scene = s;
    c->name = name;
    for (size_t k = 0; k < s->ngeometries; k++)
        tessellations += s->geometries[k].ntessellated;
    c->original = MEM_ARRAY(Geometry, s->ngeometries);
    c->listed = tessellations ? MEM_ARRAY(Geometry, s->ngeometries) : NULL;
    ok = c->original && (c->listed || !tessellations);
    for (size_t k = 0; ok && k < s->ngeometries; k++)
        ok = take_geometry(c, k);
    if (!ok)
        cast_clear(c);
    return ok;
}

void cast_clear(CastScene *c)
{
    for (size_t k = 0; c->original && k < c->scene->ngeometries; k++)
        geometry_clear(&c->original[k]);
    for (size_t k = 0; c->listed && k < c->scene->ngeometries; k++)
        geometry_clear(&c->listed[k]);
    mem_free(c->original);
    mem_free(c->listed);
    memset(c, 0, sizeof *c);
}

CastConfig cast_default(void)
{
    CastConfig d;

    memset(&d, 0, sizeof d);
    d.kind = kind_find(accels, ACCEL_DEFAULT);
    d.text = ACCEL_DEFAULT;
    opts_default(&d.opts, d.kind->info.options);
    return d;
}

/* ---- building ---- */

/* A structure may have put triangles and vertices into another order. */
static bool put_back(CastScene *c, const CastConfig *config)
{
    const Geometry *from = c->listed && !config->regular ? c->listed : c->original;
    bool ok = true;

    scene_drop_accels(c->scene);
    for (size_t k = 0; ok && k < c->scene->ngeometries; k++) {
        geometry_clear(&c->scene->geometries[k]);
        ok = geometry_copy(&c->scene->geometries[k], &from[k]);
    }
    return ok;
}

bool cast_build(CastScene *c, const CastConfig *config, int threads)
{
    return put_back(c, config) &&
           scene_build_accels(c->scene, config->kind, &config->opts, threads);
}

/* Seconds of CPU time for one thread, by the wall for more. */
static bool time_build(CastScene *c, const CastConfig *config, int threads, int runs, CastRow *row,
                       double *seconds)
{
    double (*now)(void) = threads > 1 ? clock_wall : clock_cpu;
    double v[CAST_RUNS], total = 0;
    int n = 0;

    do {
        double start;
        size_t before, peak;
        if (!put_back(c, config))
            return false;
        before = mem_bytes();
        mem_peak_restart();
        start = now();
        if (!scene_build_accels(c->scene, config->kind, &config->opts, threads))
            return false;
        v[n] = now() - start;
        total += v[n++];
        peak = mem_peak() - before;
        row->peak = peak > row->peak ? peak : row->peak;
    } while (n < runs && total < BUILD_SECONDS);
    *seconds = median(v, n);
    return true;
}

static bool build(CastScene *c, const CastConfig *config, const CastOrder *o, CastRow *row)
{
    if (!time_build(c, config, 1, o->runs, row, &row->build_one))
        return false;
    row->build_all = row->build_one;
    if (o->threads > 1 && !time_build(c, config, o->threads, o->runs, row, &row->build_all))
        return false;
    for (size_t k = 0; k < c->scene->ngeometries; k++) {
        const Accel *a = c->scene->accels[k];
        row->nodes += a->nodes;
        row->bytes += a->bytes;
        row->depth = a->depth > row->depth ? a->depth : row->depth;
    }
    return true;
}

/* ---- agreement ---- */

/* What is compared: t of the nearest hit, or 0 for any; -1: none. */
static float answer(const Accel *a, const RaySet *s, size_t i, Hit *h, Steps *steps)
{
    const Ray *r = &s->rays[i];

    if (s->any)
        return a->kind->blocked(a, r, steps) ? 0.0f : -1.0f;
    return a->kind->nearest(a, r, h, steps) ? h->t : -1.0f;
}

/* Whether the triangle that a hit tells gives its t. */
static bool is_of_triangle(const Accel *a, const Ray *r, const Hit *h)
{
    Probe p;
    Hit own;

    if (!geometry_is_tri(a->geo, h->outer))
        return true;
    hit_none(&own, r->tmax);
    probe_init(&p, r);
    return triangle_nearest(a->geo, h->prim, &p, &own) && own.t == h->t;
}

static const char *say(char *out, size_t room, const RaySet *s, float t)
{
    if (t < 0.0f || s->any)
        snprintf(out, room, "%s", t < 0.0f ? "nothing" : "something");
    else
        snprintf(out, room, "t = %.9g", (double)t);
    return out;
}

static bool disagree(const CastScene *c, const RaySet *s, size_t i, const char *who, float t,
                     const char *other, float other_t)
{
    char x[40], y[40];
    return err_at((Place){ c->name, 0, 0 }, "%s ray %lu: %s finds %s, %s finds %s", s->kind,
                  (unsigned long)i, who, say(x, sizeof x, s, t), other,
                  say(y, sizeof y, s, other_t));
}

/* One ray a call; with and without counting, which may be different code. */
static bool agrees_singly(const CastScene *c, const char *who, const RaySet *s, Steps *steps)
{
    const Accel *a = c->scene->accel;

    for (size_t i = 0; i < s->n; i++) {
        Hit h;
        float t = answer(a, s, i, &h, steps);
        if (t == s->t[i])
            t = answer(a, s, i, &h, NULL);
        if (t != s->t[i])
            return disagree(c, s, i, who, t, ACCEL_DEFAULT, s->t[i]);
        if (!s->any && t > 0.0f && !is_of_triangle(a, &s->rays[i], &h))
            return err_at((Place){ c->name, 0, 0 }, "%s ray %lu: %s finds t = %.9g, but not by the "
                          "triangle that it tells", s->kind, (unsigned long)i, who, (double)t);
    }
    return true;
}

typedef struct { Hit *hits; bool *yes; size_t n; } Batch;

/* Casts the rays from i on that a batch holds; returns how many. */
static size_t cast_batch(const Accel *a, const RaySet *s, size_t i, Batch *b)
{
    size_t n = s->n - i < b->n ? s->n - i : b->n;

    if (s->any)
        accel_blocked_many(a, s->rays + i, b->yes, n);
    else
        accel_nearest_many(a, s->rays + i, b->hits, b->yes, n);
    return n;
}

static bool agrees_in_batches(const CastScene *c, const char *who, const RaySet *s, Batch *b)
{
    size_t n;

    for (size_t i = 0; i < s->n; i += n) {
        n = cast_batch(c->scene->accel, s, i, b);
        for (size_t k = 0; k < n; k++) {
            float t = !b->yes[k] ? -1.0f : s->any ? 0.0f : b->hits[k].t;
            char name[120];
            if (t == s->t[i + k])
                continue;
            snprintf(name, sizeof name, "%.80s in batches of %lu", who, (unsigned long)b->n);
            return disagree(c, s, i + k, name, t, ACCEL_DEFAULT, s->t[i + k]);
        }
    }
    return true;
}

static bool agrees_with_brute(const CastScene *c, const RaySet *s, bool *differs)
{
    const AccelKind *kind = kind_find(accels, "brute");
    size_t step = (size_t)((double)s->n * (double)c->prims / BRUTE_TESTS) + 1;
    Accel *brute = accel_build_as_is(kind, c->scene->accel->geo, NULL, 1);

    if (!brute)
        return false;
    for (size_t i = 0; !*differs && i < s->n; i += step) {
        Hit h;
        float t = answer(brute, s, i, &h, NULL);
        *differs = t != s->t[i] && !disagree(c, s, i, ACCEL_DEFAULT, s->t[i], "brute", t);
    }
    accel_free(brute);
    return !*differs;
}

bool cast_reference(CastScene *c, RaySet *sets, int n, bool *differs)
{
    *differs = false;
    for (int k = 0; k < n; k++) {
        RaySet *s = &sets[k];
        mem_free(s->t);
        s->t = MEM_ARRAY(float, s->n);
        if (!s->t)
            return false;
        s->hits = 0;
        s->sum_t = 0;
        for (size_t i = 0; i < s->n; i++) {
            Hit h;
            s->t[i] = answer(c->scene->accel, s, i, &h, NULL);
            if (s->t[i] < 0.0f)
                continue;
            s->hits++;
            s->sum_t += s->any ? 0 : (double)s->t[i] + (s->tmin ? (double)s->tmin[i] : 0);
        }
        if (!agrees_with_brute(c, s, differs))
            return false;
    }
    return true;
}

/* ---- speed ---- */

/* All rays once, one a call or (b not NULL) in batches. Returns the hits, so that the work cannot
 * be left out. */
static uint64_t cast_all(const Accel *a, const RaySet *s, Batch *b)
{
    uint64_t hits = 0;
    size_t n;
    Hit h;

    if (b)
        for (size_t i = 0; i < s->n; i += n) {
            n = cast_batch(a, s, i, b);
            for (size_t k = 0; k < n; k++)
                hits += b->yes[k];
        }
    else if (s->any)
        for (size_t i = 0; i < s->n; i++)
            hits += accel_blocked(a, &s->rays[i]);
    else
        for (size_t i = 0; i < s->n; i++)
            hits += accel_nearest(a, &s->rays[i], &h);
    return hits;
}

/* Million rays a second; 0: not measured, or too few for the clock. What was compared before has
 * warmed it up. */
static double speed(const Accel *a, const RaySet *s, int runs, Batch *b)
{
    double v[CAST_RUNS], seconds;

    if (!runs || !s->n)
        return 0;
    for (int k = 0; k < runs; k++) {
        double start = clock_cpu();
        uint64_t hits = cast_all(a, s, b);
        v[k] = clock_cpu() - start;
        ASSERT(hits == s->hits);
    }
    seconds = median(v, runs);
    return seconds > 0 ? (double)s->n * 1e-6 / seconds : 0;
}

static bool measure_set(CastScene *c, const CastConfig *config, const CastOrder *o,
                        const RaySet *s, int k, Batch *b, CastRow *row)
{
    const Accel *a = c->scene->accel;
    Steps steps = { 0, 0 };

    if (!agrees_singly(c, config->text, s, &steps))
        return false;
    row->sets[k].single = speed(a, s, o->runs, NULL);
    if (b->n) {
        if (!agrees_in_batches(c, config->text, s, b))
            return false;
        row->sets[k].batch = speed(a, s, o->runs, b);
    }
    if (s->n) {
        row->sets[k].nodes = (double)steps.nodes / (double)s->n;
        row->sets[k].prims = (double)steps.prims / (double)s->n;
    }
    return true;
}

bool cast_measure(CastScene *c, const CastConfig *config, const CastOrder *o, const RaySet *sets,
                  int n, CastRow *row, bool *differs)
{
    Batch b = { NULL, NULL, o->batch };
    bool ok;

    *differs = false;
    memset(row, 0, sizeof *row);
    ok = build(c, config, o, row);
    if (ok) {
        b.hits = MEM_ARRAY(Hit, b.n);
        b.yes = MEM_ARRAY(bool, b.n);
        ok = b.hits && b.yes;
    }
    for (int k = 0; ok && k < n; k++) {
        ok = measure_set(c, config, o, &sets[k], k, &b, row);
        *differs = !ok;
    }
    mem_free(b.hits);
    mem_free(b.yes);
    return ok;
}
