/* loop.c -- Loop subdivision with boundaries, limit positions and limit normals.
 *
 * Source      [Loop87] "Smooth Subdivision Surfaces Based on Triangles", with Warren's weights
 *             beta(n) = 3/16 for n = 3, 3/(8n) else, and the boundary rules and tangent masks of
 *             [Hoppe94] and Biermann, Levin, Zorin 2000, as in [PBRT3 3.8].
 * Idea        Half-edges: number 3f + k runs from corner k of triangle f to the next one. The twin
 *             of each is found by sorting them by their end points. Around a vertex one walks
 *             counter-clockwise from triangle to triangle.
 * Departs     The source's limit weight 1/5 at boundaries is not that of its rules 1/8, 3/4, 1/8.
 * Invariants  Twins run in opposite directions, and the triangles of a vertex form one fan or one
 *             ring: checked for the first mesh, and kept by each step. */
#include "geometry/loop.h"

#include "base/d3.h"

#include <stdlib.h>
#include <string.h>

#define NONE 0xFFFFFFFFu

typedef struct { uint32_t lo, hi, half; } Key;
typedef struct {
    const Mesh *m;              /* borrowed */
    uint32_t *twin;             /* owned; by half-edge, NONE at a boundary */
    uint32_t *edge;             /* owned; by half-edge: the number of its edge */
    uint32_t *start;            /* owned; by vertex: an outgoing half-edge, the clockwise-most one
                                 * at a boundary; NONE if no triangle has the vertex */
    uint32_t nedges;
} Topology;

static uint32_t next_of(uint32_t h) { return h % 3 == 2 ? h - 2 : h + 1; }
static uint32_t prev_of(uint32_t h) { return h % 3 == 0 ? h + 2 : h - 1; }
static uint32_t from(const Mesh *m, uint32_t h) { return m->tri[h / 3].v[h % 3]; }
static uint32_t to(const Mesh *m, uint32_t h) { return from(m, next_of(h)); }

static void topology_clear(Topology *t)
{
    mem_free(t->twin);
    mem_free(t->edge);
    mem_free(t->start);
}

static int by_ends(const void *a, const void *b)
{
    const Key *x = a, *y = b;
    if (x->lo != y->lo)
        return x->lo < y->lo ? -1 : 1;
    if (x->hi != y->hi)
        return x->hi < y->hi ? -1 : 1;
    return x->half < y->half ? -1 : x->half > y->half;
}

/* Neighbours in the sorted list are one edge. False: more than two, or two in one direction. */
static bool pair_up(Topology *t, const Key *key, uint32_t n)
{
    for (uint32_t i = 0; i < n; t->nedges++) {
        uint32_t a = key[i].half, count = 1;
        while (i + count < n && key[i + count].lo == key[i].lo && key[i + count].hi == key[i].hi)
            count++;
        t->edge[a] = t->nedges;
        t->twin[a] = NONE;
        if (count > 2 || key[i].lo == key[i].hi)
            return false;
        if (count == 2) {
            uint32_t b = key[i + 1].half;
            if (from(t->m, a) == from(t->m, b))
                return false;
            t->edge[b] = t->nedges;
            t->twin[a] = b;
            t->twin[b] = a;
        }
        i += count;
    }
    return true;
}

/* The outgoing half-edge of the next triangle, counter-clockwise; NONE at a boundary. */
static uint32_t around(const Topology *t, uint32_t h) { return t->twin[prev_of(h)]; }

/* True if the triangles of each vertex are all met by walking around it from its start. */
static bool one_fan_each(const Topology *t, uint32_t *count)
{
    uint32_t n = 3 * t->m->ntris;

    for (uint32_t h = 0; h < n; h++)
        count[from(t->m, h)]++;
    for (uint32_t v = 0; v < t->m->nverts; v++) {
        uint32_t h = t->start[v], seen = 0;
        if (h == NONE)
            continue;
        do {
            seen++;
            h = around(t, h);
        } while (h != NONE && h != t->start[v] && seen <= count[v]);
        if (seen != count[v])
            return false;
    }
    return true;
}

static LoopResult topology_init(Topology *t, const Mesh *m)
{
    uint32_t n = 3 * m->ntris, *count = MEM_ARRAY(uint32_t, m->nverts);
    Key *key = MEM_ARRAY(Key, n);
    LoopResult result = LOOP_NO_MEMORY;

    memset(t, 0, sizeof *t);
    t->m = m;
    t->twin = MEM_ARRAY(uint32_t, n);
    t->edge = MEM_ARRAY(uint32_t, n);
    t->start = MEM_ARRAY(uint32_t, m->nverts);
    if (count && key && t->twin && t->edge && t->start) {
        for (uint32_t h = 0; h < n; h++) {
            uint32_t a = from(m, h), b = to(m, h);
            key[h] = (Key){ a < b ? a : b, a < b ? b : a, h };
        }
        qsort(key, n, sizeof *key, by_ends);
        result = LOOP_NOT_MANIFOLD;
        if (pair_up(t, key, n)) {
            memset(t->start, 0xFF, m->nverts * sizeof *t->start);
            for (uint32_t h = 0; h < n; h++)
                if (t->start[from(m, h)] == NONE || t->twin[h] == NONE)
                    t->start[from(m, h)] = h;
            if (one_fan_each(t, count))
                result = LOOP_DONE;
        }
    }
    mem_free(key);
    mem_free(count);
    return result;
}

/* ---- sums over the neighbours of a vertex ---- */

static bool at_boundary(const Topology *t, uint32_t v) { return t->twin[t->start[v]] == NONE; }

/* How many neighbours; at a boundary there is one more than there are triangles. */
static uint32_t valence(const Topology *t, uint32_t v)
{
    uint32_t h = t->start[v], n = 0;
    do {
        n++;
        h = around(t, h);
    } while (h != NONE && h != t->start[v]);
    return h == NONE ? n + 1 : n;
}

/* The sum of the neighbours, two tangents that they span, and how many they are: n. */
typedef struct { D3 sum, s, t; uint32_t n; bool boundary; } Ring;

/* The tangent across a boundary, weight of neighbour k of n; the vertex itself has *own.
 * [PBRT3 3.8.3] after Hoppe: exact for the regular valence 4, fitted for others. */
static double across(uint32_t k, uint32_t n, double *own)
{
    static const double four[4] = { -1, 2, 2, -1 };
    double angle;

    *own = 0;
    if (n == 2) {
        *own = -2;
        return 1;
    }
    if (n == 3) {
        *own = -1;
        return k == 1 ? 1 : 0;
    }
    if (n == 4) {
        *own = -2;
        return four[k];
    }
    angle = PI / (n - 1);
    if (k == 0 || k == n - 1)
        return -md_sin(angle);
    return (2 - 2 * md_cos(angle)) * md_sin(k * angle);
}

/* Adds neighbour k, counter-clockwise: to the plain sum (a boundary: only its two ends), and to the
 * two tangents. */
static void ring_add(Ring *r, uint32_t k, D3 p)
{
    double a = 2 * PI * k / r->n, own;
    if (!r->boundary) {
        r->sum = d3_mad(p, 1, r->sum);
        r->s = d3_mad(p, md_cos(a), r->s);
        r->t = d3_mad(p, md_sin(a), r->t);
        return;
    }
    if (k == 0 || k == r->n - 1) {
        r->sum = d3_mad(p, 1, r->sum);
        r->s = d3_mad(p, k == 0 ? 1 : -1, r->s);
    }
    r->t = d3_mad(p, across(k, r->n, &own), r->t);
}

static Ring ring_of(const Topology *t, uint32_t v)
{
    Ring r = { { 0, 0, 0 }, { 0, 0, 0 }, { 0, 0, 0 }, valence(t, v), at_boundary(t, v) };
    uint32_t h = t->start[v], k = 0, last = h;
    double own = 0;

    do {
        ring_add(&r, k++, d3_of(t->m->p[to(t->m, h)]));
        last = h;
        h = around(t, h);
    } while (h != NONE && h != t->start[v]);
    if (r.boundary) {
        ring_add(&r, k, d3_of(t->m->p[from(t->m, prev_of(last))]));
        across(0, r.n, &own);
        r.t = d3_mad(d3_of(t->m->p[v]), own, r.t);
    }
    return r;
}

static double beta(uint32_t n) { return n == 3 ? 3.0 / 16 : 3.0 / (8.0 * n); }

/* (1 - k w) p + w sum, k terms in the sum. */
static V3 blend(V3 p, const Ring *r, double w)
{
    double k = r->boundary ? 2 : r->n;
    return d3_rounded(d3_mad(r->sum, w, d3_scale(d3_of(p), 1 - k * w)));
}

/* ---- one step ---- */

static V3 edge_point(const Topology *t, uint32_t h)
{
    const Mesh *m = t->m;
    D3 a = d3_of(m->p[from(m, h)]), b = d3_of(m->p[to(m, h)]);
    uint32_t o = t->twin[h];

    if (o == NONE)
        return d3_rounded(d3_mad(b, 0.5, d3_scale(a, 0.5)));
    a = d3_mad(b, 0.375, d3_scale(a, 0.375));
    a = d3_mad(d3_of(m->p[from(m, prev_of(h))]), 0.125, a);
    return d3_rounded(d3_mad(d3_of(m->p[from(m, prev_of(o))]), 0.125, a));
}

static void split(const Topology *t, Mesh *fine)
{
    const Mesh *m = t->m;

    for (uint32_t v = 0; v < m->nverts; v++) {
        fine->p[v] = m->p[v];
        if (t->start[v] != NONE) {
            Ring r = ring_of(t, v);
            fine->p[v] = blend(m->p[v], &r, r.boundary ? 0.125 : beta(r.n));
        }
    }
    for (uint32_t h = 0; h < 3 * m->ntris; h++)
        fine->p[m->nverts + t->edge[h]] = edge_point(t, h);
    for (uint32_t f = 0; f < m->ntris; f++) {
        Tri c = m->tri[f], *out = fine->tri + 4 * f;
        uint32_t e0 = m->nverts + t->edge[3 * f], e1 = m->nverts + t->edge[3 * f + 1];
        uint32_t e2 = m->nverts + t->edge[3 * f + 2];
        out[0] = (Tri){ { c.v[0], e0, e2 } };
        out[1] = (Tri){ { e0, c.v[1], e1 } };
        out[2] = (Tri){ { e2, e1, c.v[2] } };
        out[3] = (Tri){ { e0, e1, e2 } };
    }
}

static LoopResult refine(Mesh *m)
{
    Topology t;
    Mesh fine;
    LoopResult result = topology_init(&t, m);

    memset(&fine, 0, sizeof fine);
    if (result == LOOP_DONE) {
        if (mesh_alloc(&fine, m->nverts + (size_t)t.nedges, 4 * (size_t)m->ntris, false, false)) {
            fine.nverts = m->nverts + t.nedges;
            fine.ntris = 4 * m->ntris;
            split(&t, &fine);
            mesh_clear(m);
            *m = fine;
        } else
            result = LOOP_NO_MEMORY;
    }
    topology_clear(&t);
    return result;
}

/* ---- the limit ---- */

static V3 normal_of(const Ring *r)
{
    D3 n = d3_cross(r->s, r->t);
    return d3_dot(n, n) < INFINITY ? d3_rounded(d3_unit(n)) : v_all(0.0f);
}

/* Limit weight of each neighbour: 1 / (n + 3/(8 beta)); at a boundary 1/6, that of cubic B-splines,
 * which the boundary is. */
static LoopResult to_limit(Mesh *m)
{
    Topology t;
    LoopResult result = topology_init(&t, m);
    V3 *p = MEM_ARRAY(V3, m->nverts), *n = MEM_ARRAY(V3, m->nverts);

    if (!p || !n)
        result = LOOP_NO_MEMORY;
    for (uint32_t v = 0; result == LOOP_DONE && v < m->nverts; v++) {
        p[v] = m->p[v];
        if (t.start[v] != NONE) {
            Ring r = ring_of(&t, v);
            p[v] = blend(m->p[v], &r, r.boundary ? 1.0 / 6 : 1 / (r.n + 3 / (8 * beta(r.n))));
            n[v] = normal_of(&r);
        }
    }
    topology_clear(&t);
    if (result != LOOP_DONE) {
        mem_free(p);
        mem_free(n);
        return result;
    }
    mem_free(m->p);
    mem_free(m->n);
    m->p = p;
    m->n = n;
    return LOOP_DONE;
}

LoopResult loop_subdivide(Mesh *m, int levels)
{
    LoopResult result = LOOP_DONE;
    for (int i = 0; i < levels && result == LOOP_DONE; i++)
        result = refine(m);
    return result == LOOP_DONE ? to_limit(m) : result;
}
