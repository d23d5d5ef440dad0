/* implicit.c -- closed meshes of the surfaces where a function of space is 0.
 *
 * Source      Marching tetrahedra over a cubic lattice whose cubes are cut into six about the
 *             diagonal [Doi91]. Each tetrahedron has 0, 1 or 2 triangles, decided by the signs of
 *             its corners alone, so neighbours agree about the side they share: no cracks, no
 *             choices, for any function.
 * Vertices    One for each edge of the lattice that changes sign: where it does, but not in the
 *             outer twelfths (no slivers), and then moved onto the surface by steps of Newton.
 *             Known by point and direction of the edge, so that all triangles about it have the
 *             same.
 * Counting    The lattice is the finest that gives no more triangles than asked; the rest come of
 *             cutting triangles, evenly chosen, into three. A closed mesh has an even number.
 * Skipping    Space is walked in blocks; a block in whose middle the function is larger than its
 *             slope can make up for has no zeros. */
#include "geometry/implicit.h"

#include "base/random.h"
#include "geometry/lookup.h"

enum { BLOCK = 8, SIDE = BLOCK + 1 };

typedef struct {
    const Implicit *f;
    double h;                   /* side of a cube */
    uint32_t n[3];              /* cubes along the axes */
    Mesh *m;                    /* borrowed; vertices and triangles are appended */
    size_t cap_p, cap_tri, cap_key;
    size_t nverts, ntris, nkeys;
    uint64_t *key;              /* owned; of each vertex: point and direction of its edge */
    Lookup seen;                /* owned; from keys to vertices */
    uint32_t first[3];          /* cube of the present block */
    float value[SIDE * SIDE * SIDE];
} March;

static double value_at(const Implicit *f, const double p[3]) { return f->at(f->ctx, p); }

/* By central differences; returns its squared length. */
static double gradient(const Implicit *f, const double p[3], double h, double g[3])
{
    double len2 = 0;
    for (int k = 0; k < 3; k++) {
        double a[3] = { p[0], p[1], p[2] }, b[3] = { p[0], p[1], p[2] };
        a[k] -= h;
        b[k] += h;
        g[k] = (value_at(f, b) - value_at(f, a)) / (2 * h);
        len2 += g[k] * g[k];
    }
    return len2;
}

/* Onto the surface by steps of Newton, but not further than `reach` in all: about a feature thinner
 * than the lattice, points of both its sides must not meet. */
static void settle(const Implicit *f, double h, double reach, double p[3])
{
    for (int step = 0; step < 3; step++) {
        double g[3], v = value_at(f, p), len2 = gradient(f, p, 0.05 * h, g), s, len;
        if (!(len2 > 1e-12))
            return;
        s = v / len2;
        len = fabs(v) / sqrt(len2);
        if (len > reach) {
            s *= reach / len;
            len = reach;
        }
        reach -= len;
        for (int k = 0; k < 3; k++)
            p[k] -= s * g[k];
    }
}

/* Where the function is 0 between p, value a, and p + d, value b of the other sign: false position,
 * the end that stays counted half [Illinois]. */
static double crossing(const Implicit *f, const double p[3], const double d[3], double a, double b)
{
    double lo = 0, hi = 1, t = a / (a - b);

    for (int step = 0; step < 4; step++) {
        double q[3] = { p[0] + t * d[0], p[1] + t * d[1], p[2] + t * d[2] }, v = value_at(f, q);
        if (v == 0)
            break;
        if ((v < 0) == (a < 0)) {
            lo = t;
            a = v;
            b *= 0.5;
        } else {
            hi = t;
            b = v;
            a *= 0.5;
        }
        t = lo + (hi - lo) * (a / (a - b));
    }
    return t;
}

/* ---- vertices ---- */

/* The lattice begins a part of a cube before the box, another along each axis: with round numbers
 * its planes would lie in flat sides of the surface, where signs are those of rounding errors. */
static void lattice_point(const March *w, const uint32_t at[3], double p[3])
{
    static const double before[3] = { 0.618034, 0.414214, 0.732051 };
    for (int k = 0; k < 3; k++)
        p[k] = w->f->lo[k] + (at[k] - before[k]) * w->h;
}

static bool new_vertex(March *w, uint64_t key, const double p[3])
{
    V3 v = v3((float)p[0], (float)p[1], (float)p[2]);
    return w->nverts < MESH_MAX && MEM_PUSH(w->m->p, w->nverts, w->cap_p, v) &&
           MEM_PUSH(w->key, w->nkeys, w->cap_key, key);
}

/* The vertex between corners i and j of the cube at `at` (bits of a corner: x, y, z), i a part of
 * j, with the values a and b. */
static bool vertex(March *w, const uint32_t at[3], unsigned i, unsigned j, float a, float b,
                   uint32_t *id)
{
    uint32_t from[3], probe = 0, hash;
    double p[3], d[3], t;
    uint64_t key;

    for (unsigned k = 0; k < 3; k++)
        from[k] = at[k] + (i >> k & 1);
    key = (((uint64_t)from[2] * (w->n[1] + 1) + from[1]) * (w->n[0] + 1) + from[0]) << 3 | (i ^ j);
    hash = (uint32_t)(mix64(key) >> 32);
    while ((*id = lookup_next(&w->seen, hash, &probe)) != LOOKUP_NONE)
        if (w->key[*id] == key)
            return true;
    lattice_point(w, from, p);
    for (unsigned k = 0; k < 3; k++)
        d[k] = ((i ^ j) >> k & 1) * w->h;
    t = d_min(d_max(crossing(w->f, p, d, a, b), 1.0 / 12), 11.0 / 12);
    for (unsigned k = 0; k < 3; k++)
        p[k] += t * d[k];
    settle(w->f, w->h, 0.15 * w->h, p);                 /* sqrt(3) twelfths, and a little */
    *id = (uint32_t)w->nverts;
    return new_vertex(w, key, p) && lookup_add(&w->seen, hash, *id);
}

/* ---- tetrahedra ---- */

static bool odd_order(const unsigned o[4])
{
    bool odd = false;
    for (int a = 0; a < 4; a++)
        for (int b = a + 1; b < 4; b++)
            odd ^= o[a] > o[b];
    return odd;
}

static bool triangle(March *w, const uint32_t id[4], int a, int b, int c)
{
    return w->ntris < MESH_MAX &&
           MEM_PUSH(w->m->tri, w->ntris, w->cap_tri, ((Tri){ { id[a], id[b], id[c] } }));
}

/* Corners c, each a part of the next, with values v; `turned`: they are left-handed. With the
 * corners apart from the others first, and in right-handed order, all triangles are as they are
 * here, or turned round where those corners are outside. */
static bool tetrahedron(March *w, const uint32_t at[3], const unsigned c[4], const float v[4],
                        bool turned)
{
    unsigned in[4], out[4], o[4], nin = 0, nout = 0, apart;
    uint32_t id[4];

    for (unsigned k = 0; k < 4; k++)
        if (v[k] < 0)
            in[nin++] = k;
        else
            out[nout++] = k;
    if (!nin || !nout)
        return true;
    turned ^= nin == 3;
    apart = nin == 2 ? 2 : 1;
    for (unsigned k = 0; k < 4; k++)
        o[k] = nin == 3 ? (k < 1 ? out[0] : in[k - 1]) : k < nin ? in[k] : out[k - nin];
    turned ^= odd_order(o);
    for (unsigned e = 0; e < (apart == 2 ? 4u : 3u); e++) {     /* 02 03 13 12, or 01 02 03 */
        unsigned a = apart == 2 ? o[e >> 1] : o[0];
        unsigned b = apart == 2 ? o[2 + ((e + (e >> 1)) & 1)] : o[e + 1];
        if (a > b) {
            unsigned t = a;
            a = b;
            b = t;
        }
        if (!vertex(w, at, c[a], c[b], v[a], v[b], &id[e]))
            return false;
    }
    if (apart == 1)
        return turned ? triangle(w, id, 0, 2, 1) : triangle(w, id, 0, 1, 2);
    return turned ? triangle(w, id, 0, 2, 1) && triangle(w, id, 0, 3, 2)
                  : triangle(w, id, 0, 1, 2) && triangle(w, id, 0, 2, 3);
}

/* The six orders of the axes: from corner 0 to 7 along each. Every second one is left-handed. */
static bool cube(March *w, const uint32_t at[3], const float v[8])
{
    static const unsigned char order[6][2] = { { 1, 3 }, { 1, 5 }, { 4, 5 }, { 4, 6 }, { 2, 6 },
                                               { 2, 3 } };
    unsigned inside = 0;

    for (int k = 0; k < 8; k++)
        inside += v[k] < 0;
    if (inside == 0 || inside == 8)
        return true;
    for (int k = 0; k < 6; k++) {
        unsigned c[4] = { 0, order[k][0], order[k][1], 7 };
        float u[4] = { v[0], v[c[1]], v[c[2]], v[7] };
        if (!tetrahedron(w, at, c, u, k & 1))
            return false;
    }
    return true;
}

static bool block(March *w)
{
    double mid[3], half = 0.5 * BLOCK * w->h, p[3];
    uint32_t at[3], n[3];
    size_t i = 0;

    lattice_point(w, w->first, mid);
    for (int k = 0; k < 3; k++) {
        mid[k] += half;
        n[k] = w->n[k] - w->first[k] < BLOCK ? w->n[k] - w->first[k] : BLOCK;
    }
    /* sqrt(3) and a little */
    if (fabs(value_at(w->f, mid)) > 1.7321 * half * w->f->steepest)
        return true;
    for (uint32_t z = 0; z <= n[2]; z++)
        for (uint32_t y = 0; y <= n[1]; y++)
            for (uint32_t x = 0; x <= n[0]; x++) {
                i = (z * SIDE + y) * (size_t)SIDE + x;
                at[0] = w->first[0] + x;
                at[1] = w->first[1] + y;
                at[2] = w->first[2] + z;
                lattice_point(w, at, p);
                w->value[i] = (float)value_at(w->f, p);
            }
    for (uint32_t z = 0; z < n[2]; z++)
        for (uint32_t y = 0; y < n[1]; y++)
            for (uint32_t x = 0; x < n[0]; x++) {
                float v[8];
                i = (z * SIDE + y) * (size_t)SIDE + x;
                for (unsigned c = 0; c < 8; c++)
                    v[c] = w->value[i + (c & 1) + SIDE * (c >> 1 & 1) + SIDE * SIDE * (c >> 2)];
                at[0] = w->first[0] + x;
                at[1] = w->first[1] + y;
                at[2] = w->first[2] + z;
                if (!cube(w, at, v))
                    return false;
            }
    return true;
}

/* ---- the whole ---- */

/* With `cubes` along the longest side of the box. */
static bool march(Mesh *m, const Implicit *f, uint32_t cubes, double *h)
{
    March *w = MEM_NEW(March);
    double longest = 0;
    bool ok = w != NULL;

    *m = (Mesh){ 0 };
    if (!ok)
        return false;
    w->f = f;
    w->m = m;
    for (int k = 0; k < 3; k++)
        longest = d_max(longest, f->hi[k] - f->lo[k]);
    *h = w->h = longest / cubes;
    for (int k = 0; k < 3; k++)
        w->n[k] = (uint32_t)ceil((f->hi[k] - f->lo[k]) / w->h + 0.75);
    for (w->first[2] = 0; ok && w->first[2] < w->n[2]; w->first[2] += BLOCK)
        for (w->first[1] = 0; ok && w->first[1] < w->n[1]; w->first[1] += BLOCK)
            for (w->first[0] = 0; ok && w->first[0] < w->n[0]; w->first[0] += BLOCK)
                ok = block(w);
    m->nverts = (uint32_t)w->nverts;
    m->ntris = (uint32_t)w->ntris;
    lookup_clear(&w->seen);
    mem_free(w->key);
    mem_free(w);
    if (!ok)
        mesh_clear(m);
    return ok;
}

/* Adds `cuts` vertices in the middles of triangles evenly chosen. */
static bool cut(Mesh *m, const Implicit *f, double h, uint32_t cuts)
{
    uint32_t whole = m->ntris;
    size_t cap_p = m->nverts, cap_tri = m->ntris;

    if (!cuts)
        return true;
    if (!mem_grow(&m->p, &cap_p, (size_t)m->nverts + cuts, sizeof *m->p) ||
        !mem_grow(&m->tri, &cap_tri, (size_t)whole + 2 * (size_t)cuts, sizeof *m->tri))
        return false;
    for (uint32_t i = 0; i < cuts; i++) {
        Tri *t = &m->tri[(uint64_t)i * whole / cuts];
        V3 a = m->p[t->v[0]], b = m->p[t->v[1]], c = m->p[t->v[2]];
        double p[3] = { ((double)a.x + b.x + c.x) / 3, ((double)a.y + b.y + c.y) / 3,
                        ((double)a.z + b.z + c.z) / 3 };
        uint32_t v = m->nverts++;
        settle(f, h, 0.5 * h, p);
        m->p[v] = v3((float)p[0], (float)p[1], (float)p[2]);
        m->tri[m->ntris++] = (Tri){ { t->v[1], t->v[2], v } };
        m->tri[m->ntris++] = (Tri){ { t->v[2], t->v[0], v } };
        t->v[2] = v;
    }
    return true;
}

static bool add_normals(Mesh *m, const Implicit *f, double h)
{
    m->n = MEM_ARRAY(V3, m->nverts);
    for (uint32_t i = 0; m->n && i < m->nverts; i++) {
        double p[3] = { m->p[i].x, m->p[i].y, m->p[i].z }, g[3];
        gradient(f, p, 0.5 * h, g);            /* what the triangles can show of it */
        m->n[i] = v_unit(v3((float)g[0], (float)g[1], (float)g[2]));
    }
    return m->n != NULL;
}

/* With the finest lattice that gives no more than ntris triangles; its cubes have the side h. The
 * number goes with the square of the lattice: two rounds come near, then step by step. */
static bool march_to(Mesh *m, const Implicit *f, uint32_t ntris, double *h)
{
    uint32_t cubes = 16;

    if (!march(m, f, cubes, h))
        return false;
    for (int round = 0; round < 2; round++) {
        uint32_t next = (uint32_t)(cubes * sqrt((double)ntris / (m->ntris + 1.0)));
        if (next == cubes || next < 4)
            break;
        cubes = next;
        mesh_clear(m);
        if (!march(m, f, cubes, h))
            return false;
    }
    while (m->ntris > ntris && cubes > 4) {
        mesh_clear(m);
        if (!march(m, f, --cubes, h))
            return false;
    }
    return true;
}

bool implicit_mesh(Mesh *m, const Implicit *f, uint32_t ntris)
{
    double h;
    bool ok = true;

    *m = (Mesh){ 0 };
    if (ntris < IMPLICIT_LEAST || ntris > 2000000000)
        return err_usage("a body of %lu triangles, %d to 2000000000 were expected",
                         (unsigned long)ntris, IMPLICIT_LEAST);
    if (!march_to(m, f, ntris, &h))
        return false;
    if (m->ntris == 0 || m->ntris > ntris) {
        mesh_clear(m);
        return err_usage("the body cannot be made of %lu triangles", (unsigned long)ntris);
    }
    while (ok && m->ntris + 1 < ntris) {                        /* a round can cut each once */
        uint32_t cuts = (ntris - m->ntris) / 2;
        ok = cut(m, f, h, cuts < m->ntris ? cuts : m->ntris);
    }
    ok = ok && add_normals(m, f, h);
    if (!ok)
        mesh_clear(m);
    return ok;
}
